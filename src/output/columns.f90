!> The columns of kinematic results: names, units, and a row of numbers from a state of motion.
!> Uses kinds, text, mechanism, plan, state, motion, poses.
module mech9_columns
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion, only: point_motion
  use mech9_poses, only: poses_type, poses_of
  implicit none
  private
  public :: columns_type, kinematic_columns

  !> Time, all coordinates, all rates, all accelerations, and nine columns for each point.
  type :: columns_type
    type(string_type), allocatable :: names(:)
    type(string_type), allocatable :: units(:)
    type(string_type), allocatable :: long_names(:)   !< a few words; the name where none were given
    integer :: count = 0
    real(wp), allocatable :: factors(:)     !< (M) from the program's units to those of the results
    type(poses_type) :: poses               !< columns behind the others, where they are asked for
  contains
    procedure :: append
    procedure :: width
    procedure :: fill
    procedure :: fill_poses
  end type columns_type

  character, parameter :: directions(3) = ['x', 'y', 'z']

contains

  !> The columns that every run records.
  function kinematic_columns(mechanism) result(columns)
    type(mechanism_type), intent(in) :: mechanism
    type(columns_type) :: columns
    character(len=4), parameter :: orders(3) = ['q   ', 'dq  ', 'ddq ']
    character(len=5), parameter :: per_time(3) = ['     ', '/s   ', '/s^2 ']
    character(len=2), parameter :: point_orders(3) = ['  ', 'v ', 'a ']
    character(len=:), allocatable :: angle, unit
    integer :: i, k, order

    angle = merge('rad', 'deg', abs(mechanism%angle_unit - 1.0_wp) <= 0.0_wp)
    allocate (columns%names(1 + 3*size(mechanism%pairs) + 9*size(mechanism%points)))
    allocate (columns%units(size(columns%names)), columns%long_names(size(columns%names)))
    allocate (columns%factors(size(mechanism%pairs)), source=1.0_wp)
    if (mechanism%output%poses) columns%poses = poses_of(mechanism)
    call columns%append('t', 's')
    do order = 1, 3
      do k = 1, size(mechanism%pairs)
        unit = 'm'
        if (mechanism%pairs(k)%pair%kind_name() == 'user') then
          unit = '1'
        else if (mechanism%pairs(k)%pair%angular) then
          unit = angle
          columns%factors(k) = 1.0_wp/mechanism%angle_unit
        end if
        call columns%append(trim(orders(order))//to_text(k), unit//trim(per_time(order)))
      end do
    end do
    do i = 1, size(mechanism%points)
      do order = 1, 3
        do k = 1, 3
          call columns%append(mechanism%points(i)%name//'.'//trim(point_orders(order))//directions(k), &
                              'm'//trim(per_time(order)))
        end do
      end do
    end do
  end function kinematic_columns

  !> One more column at the end.
  pure subroutine append(self, name, unit, long_name)
    class(columns_type), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    character(len=*), intent(in), optional :: long_name

    if (self%count == size(self%names)) then
      call grow(self%names)
      call grow(self%units)
      call grow(self%long_names)
    end if
    self%count = self%count + 1
    self%names(self%count)%text = name
    self%units(self%count)%text = unit
    self%long_names(self%count)%text = name
    if (present(long_name)) self%long_names(self%count)%text = long_name
  end subroutine append

  !> Room for a few more.
  pure subroutine grow(texts)
    type(string_type), allocatable, intent(inout) :: texts(:)
    type(string_type), allocatable :: grown(:)

    allocate (grown(size(texts) + 8))
    grown(:size(texts)) = texts
    call move_alloc(grown, texts)
  end subroutine grow

  !> Numbers in a row, poses included.
  pure integer function width(self)
    class(columns_type), intent(in) :: self

    width = self%count + self%poses%width()
  end function width

  !> The columns of the poses in a row, if there are any.
  pure subroutine fill_poses(self, plan, state, row)
    class(columns_type), intent(in) :: self
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    real(wp), intent(inout) :: row(:)

    if (self%poses%n_links > 0) call self%poses%fill(plan, state, row(self%count + 1:))
  end subroutine fill_poses

  !> The row of a state; `used` numbers are set.
  pure subroutine fill(self, mechanism, plan, state, row, used)
    class(columns_type), intent(in) :: self
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    real(wp), intent(inout) :: row(:)
    integer, intent(out) :: used
    integer :: m, i

    m = plan%n_coordinates
    row(1) = state%t
    row(2:m + 1) = state%q*self%factors
    row(m + 2:2*m + 1) = state%dq*self%factors
    row(2*m + 2:3*m + 1) = state%ddq*self%factors
    used = 3*m + 1
    do i = 1, size(mechanism%points)
      call point_motion(plan, state, mechanism%points(i), row(used + 1:used + 3), row(used + 4:used + 6), &
                        row(used + 7:used + 9))
      used = used + 9
    end do
  end subroutine fill
end module mech9_columns
