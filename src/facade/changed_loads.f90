!> Numbers of loads and motors that change while a motion runs.
!>
!> The first change of a number reads the mechanism anew, and sees which number of which load follows it. Where that is the number
!> itself, before and after the change, and any value is allowed, later changes go to the load at once.
module mech9_changed_loads
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: lower
  use mech9_number_lists, only: same_numbers
  use mech9_load, only: load_type
  use mech9_model, only: model_type
  use mech9_item_check, only: is_sensible
  use mech9_named_number, only: number_place_type, takes_any
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: changed_loads_type

  !> A number of the data file that is a number of a load or a motor.
  type :: known_number_type
    character(len=:), allocatable :: name     !< as load(1).force(2)
    type(number_place_type) :: place          !< in the data file
    logical :: of_motor = .false.
    integer :: owner = 0                      !< number of the load or the motor
    integer :: position = 0                   !< among its numbers
  end type known_number_type

  !> The mechanism of a motion with its present numbers.
  type :: changed_loads_type
    private
    type(checked_mechanism_type) :: mechanism
    type(known_number_type), allocatable :: known(:)
  contains
    procedure :: begin
    procedure :: change
  end type changed_loads_type

contains

  !> Begin with a mechanism.
  subroutine begin(self, mechanism)
    class(changed_loads_type), intent(inout) :: self           !< forgets what it knew
    type(checked_mechanism_type), intent(in) :: mechanism      !< of the motion

    self%mechanism = mechanism
    if (allocated(self%known)) deallocate (self%known)
    allocate (self%known(0))
  end subroutine begin

  !> Give a number of a load or a motor of a model another value. The model stays as it is where this fails: with exit_usage for a
  !> number of another group, with exit_data for a name that is not known or a value out of its range.
  subroutine change(self, name, value, model, other_loads_act, err)
    class(changed_loads_type), intent(inout) :: self      !< begun
    character(len=*), intent(in) :: name                  !< of the number, as load(1).force(2)
    real(wp), intent(in) :: value                         !< in the unit of the data file
    type(model_type), intent(inout) :: model              !< of the motion; gets the value
    logical, intent(out) :: other_loads_act               !< a load became idle, or acts now
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(checked_mechanism_type) :: changed
    type(number_place_type) :: place
    type(model_type) :: anew
    integer, allocatable :: acting(:)
    real(wp) :: old_value
    logical :: is_done

    other_loads_act = .false.
    if (all(group_of(name) /= [character(len=5) :: 'load', 'motor'])) then
      call raise(err, exit_usage, 'numbers of &load and &motor alone can be changed while a motion runs, and not '//name)
      return
    end if
    call change_at_once(self, name, value, model, is_done)
    if (is_done) return
    changed = self%mechanism
    ! not a number where none was given so far
    call changed%number(name, old_value, err)
    call changed%set(name, value, err, place)
    if (.not. allocated(err)) call changed%take(model%program, anew, err)
    if (allocated(err)) return
    if (takes_any(place)) call learn(self, name, place, [old_value, value], model, anew)
    acting = model%mechanism%acting_loads()
    call move_alloc(anew%mechanism%loads, model%mechanism%loads)
    call move_alloc(anew%mechanism%motors, model%mechanism%motors)
    self%mechanism = changed
    other_loads_act = .not. same_numbers(acting, model%mechanism%acting_loads())
  end subroutine change

  !> Change a number that is known. It is not done for others, and where the load becomes idle, or acts from now on.
  subroutine change_at_once(self, name, value, model, is_done)
    type(changed_loads_type), intent(inout) :: self   !< begun
    character(len=*), intent(in) :: name              !< of the number
    real(wp), intent(in) :: value                     !< in the unit of the data file
    type(model_type), intent(inout) :: model          !< of the motion
    logical, intent(out) :: is_done                   !< the model has the value
    integer :: i

    is_done = .false.
    if (.not. is_sensible(value)) return
    do i = 1, size(self%known)
      if (self%known(i)%name /= name) cycle
      associate (number => self%known(i))
        if (number%of_motor) then
          call put(model%mechanism%motors(number%owner)%motor, number%position, value, is_done)
        else
          call put(model%mechanism%loads(number%owner)%load, number%position, value, is_done)
        end if
        if (is_done) call self%mechanism%put_number(number%place, value)
      end associate
      return
    end do
  end subroutine change_at_once

  !> Give a number of a load a value, unless the load becomes idle by it, or acts from then on.
  subroutine put(load, position, value, is_done)
    class(load_type), intent(inout) :: load    !< the load
    integer, intent(in) :: position            !< among its numbers
    real(wp), intent(in) :: value              !< the number
    logical, intent(out) :: is_done            !< the load has the value
    real(wp), allocatable :: numbers(:)
    real(wp) :: before
    logical :: was_idle

    call load%numbers(numbers)
    before = numbers(position)
    numbers(position) = value
    was_idle = load%is_idle()
    call load%take_numbers(numbers, is_done)
    if (.not. is_done .or. (load%is_idle() .eqv. was_idle)) return
    numbers(position) = before
    call load%take_numbers(numbers, is_done)
    is_done = .false.
  end subroutine put

  !> Learn which number of which load or motor a number of the data file is, from the change of this number.
  subroutine learn(self, name, place, values, before, after)
    type(changed_loads_type), intent(inout) :: self       !< gets to know the number
    character(len=*), intent(in) :: name                  !< of the number
    type(number_place_type), intent(in) :: place          !< in the data file
    real(wp), intent(in) :: values(2)                     !< its old value and its new one, in the unit of the data file
    type(model_type), intent(in) :: before                !< the model with the old value
    type(model_type), intent(in) :: after                 !< the model with the new one
    type(known_number_type) :: found
    integer :: changes, i

    changes = 0
    do i = 1, size(before%mechanism%loads)
      call compare(before%mechanism%loads(i)%load, after%mechanism%loads(i)%load, .false., i, values, found, changes)
    end do
    do i = 1, size(before%mechanism%motors)
      call compare(before%mechanism%motors(i)%motor, after%mechanism%motors(i)%motor, .true., i, values, found, changes)
    end do
    if (changes /= 1 .or. found%owner == 0) return
    found%name = name
    found%place = place
    self%known = [self%known, found]
  end subroutine learn

  !> Compare the numbers of a load before and after a change.
  subroutine compare(before, after, of_motor, owner, values, found, changes)
    class(load_type), intent(in) :: before             !< the load before the change
    class(load_type), intent(in) :: after              !< the load after it
    logical, intent(in) :: of_motor                    !< it is a motor
    integer, intent(in) :: owner                       !< its number
    real(wp), intent(in) :: values(2)                  !< old and new value of the number that changed
    type(known_number_type), intent(inout) :: found    !< gets the place of the number where the load takes both as they are
    integer, intent(inout) :: changes                  !< how many numbers changed so far
    real(wp), allocatable :: old(:), new(:), own(:)
    integer :: j

    call before%constants(old)
    call after%constants(new)
    ! the number of another load changed where those of this one are not known
    if (.not. (allocated(old) .and. allocated(new))) return
    if (size(old) /= size(new)) return
    call after%numbers(own)
    do j = 1, size(old)
      if (.not. abs(new(j) - old(j)) > 0.0_wp) cycle
      changes = changes + 1
      ! numbers behind those of the load are those of its law
      if (j > size(own)) cycle
      if (any(abs([old(j), new(j)] - values) > 0.0_wp)) cycle
      found%of_motor = of_motor
      found%owner = owner
      found%position = j
    end do
  end subroutine compare

  !> The group of the name of a number, in lower case.
  pure function group_of(name)
    character(len=*), intent(in) :: name   !< as load(1).force
    character(len=5) :: group_of

    group_of = lower(name(:scan(name//'.', '(.') - 1))
  end function group_of
end module mech9_changed_loads
