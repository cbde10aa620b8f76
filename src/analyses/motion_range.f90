!> How far each independent coordinate can go with the others held where they are.
module mech9_motion_range
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_polynomial_drive, only: polynomial_drive_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_special_position, only: dead_point
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  implicit none
  private
  public :: motion_range_type, end_type, find_range, ends_at_limit, ends_never, ends_round, ends_otherwise

  integer, parameter :: ends_at_limit = 1       !< a dead point
  integer, parameter :: ends_never = 2          !< none was found as far as was looked
  integer, parameter :: ends_round = 3          !< the mechanism comes round to where it began
  integer, parameter :: ends_otherwise = 4      !< it cannot be followed farther, for another reason

  !> One end of a range.
  type :: end_type
    integer :: kind = ends_never
    real(wp) :: value = 0.0_wp                  !< the limit, or how far was looked [rad or m]
    integer :: block = 0                        !< that is at its dead point
    integer :: turns = 0                        !< after which it comes round
    character(len=:), allocatable :: reason     !< why it cannot be followed
  end type end_type

  !> The range of a coordinate.
  type :: motion_range_type
    integer :: coordinate = 0
    real(wp) :: start = 0.0_wp                  !< [rad or m]
    type(end_type) :: lower, upper
  end type motion_range_type

  !> How far a coordinate without an end is followed: turns, or lengths of the mechanism.
  integer, parameter :: most_turns = 4
  real(wp), parameter :: most_lengths = 20.0_wp
  !> Come round: all coordinates within this of the start, in their units.
  real(wp), parameter :: same = 1.0e-6_wp

contains

  !> Follow one independent coordinate both ways from an assembled start.
  subroutine find_range(mechanism, plan, start, coordinate, range)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    integer, intent(in) :: coordinate   !< number of the coordinate that moves
    type(motion_range_type), intent(out) :: range   !< the range of the coordinate

    range%coordinate = coordinate
    range%start = start%q(coordinate)
    call find_end(mechanism, plan, start, coordinate, 1.0_wp, range%upper)
    if (range%upper%kind == ends_round) then
      range%lower = range%upper
    else
      call find_end(mechanism, plan, start, coordinate, -1.0_wp, range%lower)
    end if
  end subroutine find_range

  !> Follow a coordinate one way, at one unit a second.
  subroutine find_end(mechanism, plan, start, coordinate, direction, found)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    integer, intent(in) :: coordinate   !< number of the coordinate that moves
    real(wp), intent(in) :: direction   !< +1 for the upper end, -1 for the lower one
    type(end_type), intent(out) :: found   !< the end of the range
    type(mechanism_type) :: swept
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    logical :: turns
    integer :: turn

    swept = mechanism
    call drive_one(plan, start, coordinate, direction, swept)
    call start_driven_motion(swept, plan, start, 0.0_wp, driven, err)
    associate (step => plan%steps(plan%step_of(coordinate)))
      turns = step%is_screw .and. .not. abs(step%slide) > 0.0_wp
    end associate
    if (turns) then
      do turn = 1, most_turns
        if (.not. allocated(err)) call advance(swept, plan, driven, 2.0_wp*pi*turn, err)
        if (allocated(err)) exit
        if (.not. has_come_round(plan, start, driven%state, coordinate)) cycle
        found%kind = ends_round
        found%turns = turn
        return
      end do
    else if (.not. allocated(err)) then
      call advance(swept, plan, driven, most_lengths, err)
    end if
    found%value = driven%state%q(coordinate)
    if (.not. allocated(err)) return
    found%kind = ends_otherwise
    found%reason = err%message
    if (driven%ahead%kind /= dead_point .or. .not. allocated(driven%limit)) return
    found%kind = ends_at_limit
    found%value = driven%limit(coordinate)
    found%block = driven%ahead%block
  end subroutine find_end

  !> Drives that hold all independent coordinates but one.
  subroutine drive_one(plan, start, coordinate, direction, swept)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    integer, intent(in) :: coordinate   !< number of the coordinate that moves
    real(wp), intent(in) :: direction   !< +1 for the upper end, -1 for the lower one
    type(mechanism_type), intent(inout) :: swept   !< the mechanism; gets the drives
    type(polynomial_drive_type) :: drive
    integer :: i, k

    deallocate (swept%drives)
    allocate (swept%drives(size(plan%independent)))
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      drive%coordinate = k
      drive%coefficients = [start%q(k), 0.0_wp]
      if (k == coordinate) drive%coefficients(2) = direction*plan%unit_of(k)
      allocate (swept%drives(i)%drive, source=drive)
    end do
  end subroutine drive_one

  !> Whether all other coordinates are again what they were, whole turns of revolute pairs aside.
  pure logical function has_come_round(plan, start, state, coordinate)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    type(state_type), intent(in) :: state   !< the present position
    integer, intent(in) :: coordinate   !< number of the coordinate that moves
    real(wp) :: change
    integer :: k

    has_come_round = .false.
    do k = 1, plan%n_coordinates
      if (k == coordinate) cycle
      change = (state%q(k) - start%q(k))/plan%unit_of(k)
      associate (step => plan%steps(plan%step_of(k)))
        if (step%is_screw .and. .not. abs(step%slide) > 0.0_wp) change = change - 2.0_wp*pi*anint(change/(2.0_wp*pi))
      end associate
      if (abs(change) > same) return
    end do
    has_come_round = .true.
  end function has_come_round
end module mech9_motion_range
