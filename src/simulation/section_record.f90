!> The section of a run: the points of the motion at which a coordinate or a column of the results has a value, or at the ends of periods.
!> A motion goes on by strides; a stride that passes the value is searched for the times of passing, and a row is filled at each.
module mech9_section_record
  use mech9_failure_units, only: tell_in_units
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type
  use mech9_long_term, only: section_type
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: simulation_type
  use mech9_section_search, only: watched_type, known_value_type, passing_type, levels_type, find_passings
  implicit none
  private
  public :: section_record_type, row_filler_type, new_section_record

  !> A value belongs to the side where the motion was within this part of its size: round-off of positions of well conditioned chains.
  real(wp), parameter :: round_off_of_values = 16.0_wp*epsilon(1.0_wp)
  !> A period that ends after the motion by less than this part of its duration ends with it: data files have 13 digits or more.
  real(wp), parameter :: round_off_of_periods = 1.0e-12_wp
  !> Points for which there is room at first.
  integer, parameter :: first_room = 64

  !> Who fills a row of results by the present position.
  type, abstract :: row_filler_type
  contains
    procedure(fill_interface), deferred :: fill_values
    procedure(width_interface), deferred :: width
  end type row_filler_type

  abstract interface
    !> Fill a row with the numbers of the present position, but for derivatives by parameters.
    subroutine fill_interface(self, row, err)
      import :: row_filler_type, wp, error_type
      class(row_filler_type), intent(inout) :: self         !< who fills it
      real(wp), intent(inout), contiguous :: row(:)         !< (columns) in the units of the results
      type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    end subroutine fill_interface

    !> Number of columns of a row.
    integer function width_interface(self)
      import :: row_filler_type
      class(row_filler_type), intent(in) :: self            !< who fills rows
    end function width_interface
  end interface

  !> The points so far, and the place of the motion between them.
  type :: section_record_type
    type(section_type) :: wanted                              !< as requested
    character(len=:), allocatable :: names(:), units(:)       !< headings of the columns: point, t and those of the run
    real(wp), allocatable :: points(:, :)                     !< (columns,room) the points, then room for more
    integer :: count = 0                                      !< points so far
    real(wp) :: range(2) = [huge(1.0_wp), -huge(1.0_wp)]      !< least and greatest value at the ends of strides behind the transient
    integer, private :: used = 0                              !< columns of the run, the first ones, that are recorded
    integer, private :: columns(0:2) = 0                      !< column of the value, and of its derivatives; 0: not known
    real(wp), private :: factor = 1.0_wp                      !< from the coordinate in the program's unit to that of the results
    real(wp), private :: start = 0.0_wp                       !< start of the motion [s]
    real(wp), private :: end = 0.0_wp                         !< its end [s]
    real(wp), private :: direction = 1.0_wp                   !< 1, or -1 where time runs backwards
    integer(long), private :: periods = 0                     !< periods that are over, with those before the transient's end
    logical, private :: begun = .false.                       !< the value at the start is known
    logical, private :: searched = .true.                     !< the last stride has been searched
    logical, private :: at_joint = .false.                    !< the last stride ended where rates may jump
    type(known_value_type), private :: first, last            !< the value at the ends of the last stride
    type(levels_type), private :: levels
    type(passing_type), allocatable, private :: passings(:)   !< those of the last stride
    integer, private :: next = 1                              !< number of the next one
    integer, private :: cell = 0                              !< cell behind those that were taken
    integer, private :: last_cell = 0                         !< cell at the end of the last stride
  contains
    procedure :: go_on
    procedure, private :: search
    procedure, private :: take_passings
    procedure, private :: pass_jump
    procedure, private :: take_periods
    procedure, private :: add_point
  end type section_record_type

  !> The value of a section on a motion.
  type, extends(watched_type) :: watched_motion_type
    class(simulation_type), pointer :: simulation => null()   !< not owned
    class(row_filler_type), pointer :: filler => null()       !< not owned
    integer :: coordinate = 0                                 !< 0: a column
    integer :: columns(0:2) = 0                               !< of the value and its derivatives
    real(wp) :: factor = 1.0_wp                               !< of the coordinate
    real(wp) :: value = 0.0_wp                                !< of the section
    real(wp), allocatable :: row(:)                           !< room for a row
  contains
    procedure :: value_at
    procedure :: know
  end type watched_motion_type

contains

  !> The record of the section that a model requests. A column that is not among those of the run is not found.
  subroutine new_section_record(model, names, units, n_motion, record, found)
    type(model_type), intent(in) :: model                  !< the model
    character(len=*), intent(in) :: names(:)               !< headings of the columns of the run that are recorded
    character(len=*), intent(in) :: units(:)               !< their units
    integer, intent(in) :: n_motion                        !< how many of them, the first ones, belong to time, coordinates and points
    type(section_record_type), intent(out) :: record       !< the record, without points
    logical, intent(out) :: found                          !< a column that gives the points is among them

    associate (wanted => model%request%section, time => model%request%time)
      record%wanted = wanted
      found = .true.
      record%used = size(names)
      allocate (character(len=max(len(names), 5)) :: record%names(record%used + 1))
      allocate (character(len=max(len(units), 1)) :: record%units(record%used + 1))
      record%names(1) = 'point'
      record%units(1) = '1'
      record%names(2:) = names
      record%units(2:) = units
      allocate (record%points(record%used + 1, first_room), record%passings(0))
      record%start = time%start
      record%end = time%end
      record%direction = sign(1.0_wp, time%end - time%start)
      if (wanted%coordinate > 0) then
        record%factor = 1.0_wp/unit_of(model%mechanism, wanted%coordinate)
        if (wanted%every_turn) record%levels%distance = 8.0_wp*atan(1.0_wp)
        if (wanted%every_turn .and. unit_name(model%mechanism, wanted%coordinate) == 'deg') record%levels%distance = 360.0_wp
      else if (wanted%column /= '') then
        call find_columns(names, units, n_motion, record)
        found = record%columns(0) > 0
      end if
      if (wanted%period > 0.0_wp) &
        record%periods = ceiling(wanted%transient/wanted%period*(1.0_wp - round_off_of_values), long)
    end associate
  end subroutine new_section_record

  !> Find the column of the value, and those of its derivatives.
  subroutine find_columns(names, units, n_motion, record)
    character(len=*), intent(in) :: names(:)               !< headings of the columns
    character(len=*), intent(in) :: units(:)               !< their units
    integer, intent(in) :: n_motion                        !< how many belong to time, coordinates and points
    type(section_record_type), intent(inout) :: record     !< gets the numbers of the columns
    character(len=:), allocatable :: name
    integer :: order, i

    name = record%wanted%column
    do order = 0, 2
      if (name == '') exit
      do i = 1, record%used
        if (names(i) /= name) cycle
        ! rates in turns per minute are not those of angles in their unit
        if (order > 0) then
          if (units(i) /= rate_of(trim(units(record%columns(max(order - 1, 0)))))) cycle
        end if
        record%columns(order) = i
      end do
      if (record%columns(order) == 0) exit
      if (record%columns(0) > n_motion) exit
      name = trim(derivative_of(name))
    end do
  end subroutine find_columns

  !> The unit of a derivative in time.
  pure function rate_of(unit) result(rate)
    character(len=*), intent(in) :: unit   !< the unit
    character(len=len(unit) + 2) :: rate

    rate = unit//'/s'
    if (len(unit) < 2) return
    if (unit(len(unit) - 1:) == '/s') rate = unit//'^2'
  end function rate_of

  !> The heading of the derivative of a column of the motion in time; '' where there is none.
  pure function derivative_of(name) result(derivative)
    character(len=*), intent(in) :: name   !< heading of the column
    character(len=len(name) + 1) :: derivative
    integer :: dot

    derivative = ''
    dot = index(name, '.', back=.true.)
    if (dot == 0) then
      if (name(1:1) == 'q' .or. name(1:min(2, len(name))) == 'dq') derivative = 'd'//name
    else if (len(name) == dot + 1) then
      derivative = name(:dot)//'v'//name(dot + 1:)
    else if (name(dot + 1:dot + 1) == 'v') then
      derivative = name(:dot)//'a'//name(dot + 2:)
    end if
  end function derivative_of

  !> Go on to a time, by strides that may go beyond it, and add the points up to there. The motion stands anywhere afterwards, at this time
  !> or within its last stride. A failure with exit_interrupted may be followed by another call. With `at_joint` one stride is made towards a
  !> time that the motion has not reached, and the points up to its start are added.
  subroutine go_on(self, simulation, filler, t, err, at_joint)
    class(section_record_type), intent(inout) :: self                !< the record
    class(simulation_type), intent(inout), target :: simulation      !< the motion, started
    class(row_filler_type), intent(inout), target :: filler          !< fills rows by its present position
    real(wp), intent(in) :: t                                        !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    logical, intent(out), optional :: at_joint                       !< rates may jump at the end of the stride
    type(watched_motion_type) :: watched
    real(wp) :: from, to

    if (self%wanted%period > 0.0_wp) then
      to = t
      if (present(at_joint)) to = simulation%end_of_stride(t)
      call self%take_periods(simulation, filler, to, err)
      if (present(at_joint) .and. .not. allocated(err)) then
        call simulation%stride(t, from, to, at_joint, err)
        call tell_in_units(err, simulation%model%mechanism)
      end if
      return
    end if
    watched%simulation => simulation
    watched%filler => filler
    watched%coordinate = self%wanted%coordinate
    watched%columns = self%columns
    watched%factor = self%factor
    watched%value = self%wanted%value
    if (.not. self%begun) call begin(self, watched, err)
    do while (.not. allocated(err))
      if (abs(simulation%end_of_stride(self%last%t) - self%last%t) > 0.0_wp) then
        ! the last stride was made anew, up to another time
        self%passings = [passing_type ::]
        self%next = 1
        self%last_cell = self%cell
        self%searched = .true.
        self%at_joint = .false.
        call watched%know(simulation%end_of_stride(self%last%t), self%last, err)
      end if
      if (.not. (self%searched .or. allocated(err))) call self%search(watched, err)
      if (.not. allocated(err)) call self%take_passings(simulation, filler, t, err)
      if (allocated(err)) return
      if (abs(simulation%end_of_stride(self%last%t) - self%last%t) > 0.0_wp) cycle
      if (self%next <= size(self%passings) .or. (self%last%t - t)*self%direction >= 0.0_wp) return
      if (self%at_joint) call self%pass_jump(watched, err)
      if (.not. allocated(err)) call make_stride(self, simulation, t, err)
      if (.not. present(at_joint)) cycle
      at_joint = self%at_joint
      return
    end do
  end subroutine go_on

  !> Begin at the start, where the motion stands. A motion that starts at the value does not pass it there: it was on the side to which it
  !> goes.
  subroutine begin(self, watched, err)
    class(section_record_type), intent(inout) :: self         !< the record
    type(watched_motion_type), intent(inout) :: watched       !< finds the value
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    real(wp) :: side
    integer :: i

    call watched%know(self%start, self%last, err)
    if (allocated(err)) return
    call set_round_off(self)
    side = self%last%numbers(0)
    if (self%levels%is_near(side)) then
      do i = self%last%derivatives, 1, -1
        if (abs(self%last%numbers(i)) > 0.0_wp) &
          side = self%last%numbers(0) + sign(max(2.0_wp*self%levels%round_off, tiny(side)), self%last%numbers(i)*self%direction**i)
      end do
    end if
    self%cell = self%levels%cell(side)
    self%last_cell = self%cell
    self%begun = .true.
  end subroutine begin

  !> Make the next stride, to be searched.
  subroutine make_stride(self, simulation, t, err)
    class(section_record_type), intent(inout) :: self         !< the record
    class(simulation_type), intent(inout) :: simulation       !< the motion
    real(wp), intent(in) :: t                                 !< time to go towards [s]
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    real(wp) :: from, to
    logical :: at_joint

    to = self%last%t
    call simulation%stride(t, from, to, at_joint, err)
    call tell_in_units(err, simulation%model%mechanism)
    if (allocated(err)) return
    self%first = self%last
    self%last%t = to
    self%at_joint = at_joint
    self%searched = .false.
  end subroutine make_stride

  !> Search the last stride for passings.
  subroutine search(self, watched, err)
    class(section_record_type), intent(inout) :: self         !< the record
    class(watched_type), intent(inout) :: watched             !< finds the value
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    select type (watched)
    type is (watched_motion_type)
      call watched%know((self%last%t), self%last, err)
    end select
    if (allocated(err)) return
    call set_round_off(self)
    self%next = 1
    if (abs(self%last%t - self%start) < self%wanted%transient) then
      self%passings = [passing_type ::]
      self%last_cell = self%levels%cell(self%last%numbers(0), self%cell)
    else
      self%range = [min(self%range(1), self%first%numbers(0), self%last%numbers(0)), &
                    max(self%range(2), self%first%numbers(0), self%last%numbers(0))]
      watched%levels = self%levels
      call find_passings(watched, self%first, self%last, self%cell, self%passings, self%last_cell, err)
      if (allocated(err)) return
    end if
    self%searched = .true.
  end subroutine search

  !> Set the round-off of the value.
  subroutine set_round_off(self)
    class(section_record_type), intent(inout) :: self   !< the record

    self%levels%round_off = round_off_of_values*maxval(abs([self%wanted%value, self%wanted%value + self%last%numbers(0), &
                                                            self%wanted%value + self%first%numbers(0)]))
    if (self%wanted%coordinate > 0) self%levels%round_off = max(self%levels%round_off, round_off_of_values)
  end subroutine set_round_off

  !> Take the passings of the last stride up to a time, those that are wanted as points.
  subroutine take_passings(self, simulation, filler, t, err)
    class(section_record_type), intent(inout) :: self         !< the record
    class(simulation_type), intent(inout) :: simulation       !< the motion
    class(row_filler_type), intent(inout) :: filler           !< fills rows by its present position
    real(wp), intent(in) :: t                                 !< time up to which [s]
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    do while (self%next <= size(self%passings))
      associate (passing => self%passings(self%next))
        if ((passing%t - t)*self%direction > 0.0_wp) return
        if (is_wanted(self, passing)) call self%add_point(simulation, filler, passing%t, err)
        if (allocated(err)) return
        self%cell = passing%behind
      end associate
      self%next = self%next + 1
      if (abs(simulation%end_of_stride(self%last%t) - self%last%t) > 0.0_wp) return
    end do
    self%cell = self%last_cell
  end subroutine take_passings

  !> Whether a passing is a point of the section. At the start itself, a value without known derivatives does not tell from which side it
  !> comes.
  pure logical function is_wanted(self, passing)
    class(section_record_type), intent(in) :: self   !< the record
    type(passing_type), intent(in) :: passing        !< the passing

    is_wanted = abs(passing%t - self%start) >= max(self%wanted%transient, tiny(passing%t))
    if (self%wanted%direction /= 0) &
      is_wanted = is_wanted .and. (passing%behind - passing%before)*self%wanted%direction*self%direction > 0.0_wp
  end function is_wanted

  !> Pass what ended the last stride. A value that jumps over a level there passes it.
  subroutine pass_jump(self, watched, err)
    class(section_record_type), intent(inout) :: self         !< the record
    type(watched_motion_type), intent(inout) :: watched       !< finds the value
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    integer :: next, step

    call watched%simulation%leave_joint(err)
    if (.not. allocated(err)) call watched%know((self%last%t), self%last, err)
    if (allocated(err)) return
    self%at_joint = .false.
    next = self%levels%cell(self%last%numbers(0), self%cell)
    step = sign(1, next - self%cell)
    do while (self%cell /= next)
      if (is_wanted(self, passing_type(self%last%t, self%cell, self%cell + step))) &
        call self%add_point(watched%simulation, watched%filler, self%last%t, err)
      if (allocated(err)) return
      self%cell = self%cell + step
    end do
    self%last_cell = self%cell
  end subroutine pass_jump

  !> Add the points at the ends of periods up to a time.
  subroutine take_periods(self, simulation, filler, t, err)
    class(section_record_type), intent(inout) :: self         !< the record
    class(simulation_type), intent(inout) :: simulation       !< the motion
    class(row_filler_type), intent(inout) :: filler           !< fills rows by its present position
    real(wp), intent(in) :: t                                 !< the time [s]
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    real(wp) :: next

    do
      next = self%start + self%direction*self%periods*self%wanted%period
      if ((next - self%end)*self%direction > 0.0_wp .and. &
          abs(next - self%end) <= round_off_of_periods*abs(self%end - self%start)) next = self%end
      if ((next - t)*self%direction > 0.0_wp) return
      call self%add_point(simulation, filler, next, err)
      if (allocated(err)) return
      self%periods = self%periods + 1
    end do
  end subroutine take_periods

  !> Add the point at a time.
  subroutine add_point(self, simulation, filler, t, err)
    class(section_record_type), intent(inout) :: self         !< the record
    class(simulation_type), intent(inout) :: simulation       !< the motion; it stands there afterwards
    class(row_filler_type), intent(inout) :: filler           !< fills rows by its present position
    real(wp), intent(in) :: t                                 !< the time [s]
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    real(wp), allocatable :: more(:, :), row(:)

    call simulation%visit(t, .false., err)
    if (allocated(err)) return
    allocate (row(filler%width()), source=0.0_wp)
    call filler%fill_values(row, err)
    if (allocated(err)) return
    if (self%count == size(self%points, 2)) then
      allocate (more(size(self%points, 1), 2*self%count))
      more(:, :self%count) = self%points
      call move_alloc(more, self%points)
    end if
    self%count = self%count + 1
    self%points(1, self%count) = self%count
    self%points(2:, self%count) = row(:self%used)
  end subroutine add_point

  !> The value at a time within the last stride.
  subroutine value_at(self, t, value, err)
    class(watched_motion_type), intent(inout) :: self   !< the value on a motion
    real(wp), intent(in) :: t                           !< the time [s]
    real(wp), intent(out) :: value                      !< above zero beyond the value of the section
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(known_value_type) :: known

    value = 0.0_wp
    call self%know(t, known, err)
    if (.not. allocated(err)) value = known%numbers(0)
  end subroutine value_at

  !> The value at a time within the last stride, with its derivatives as far as they are known.
  subroutine know(self, t, known, err)
    class(watched_motion_type), intent(inout) :: self     !< the value on a motion
    real(wp), intent(in) :: t                             !< the time [s]
    type(known_value_type), intent(inout) :: known        !< the value there
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    integer :: order

    call self%simulation%look_at(t, err)
    if (allocated(err)) return
    known = known_value_type(t=t)
    if (self%coordinate > 0) then
      call self%simulation%present(plan, state)
      known%derivatives = 2
      known%numbers = self%factor*[state%q(self%coordinate), state%dq(self%coordinate), state%ddq(self%coordinate)]
    else
      if (.not. allocated(self%row)) allocate (self%row(self%filler%width()), source=0.0_wp)
      call self%simulation%note_numbers()
      call self%filler%fill_values(self%row, err)
      if (allocated(err)) return
      known%derivatives = count(self%columns > 0) - 1
      do order = 0, known%derivatives
        known%numbers(order) = self%row(self%columns(order))
      end do
    end if
    known%numbers(0) = known%numbers(0) - self%value
  end subroutine know
end module mech9_section_record
