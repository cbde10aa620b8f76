!> The range of motion of an independent coordinate while the others are held.
module mech9_motion_range
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_stop_request, only: stop_request_type
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_plan, only: plan_type, without_periods
  use mech9_state, only: state_type
  use mech9_special_position, only: dead_point
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  implicit none
  private
  public :: motion_range_type, end_type, find_range, ends_at_limit, ends_never, ends_round, ends_otherwise

  integer, parameter :: ends_at_limit = 1       !< the range ends at a dead point
  integer, parameter :: ends_never = 2          !< no end was found as far as the motion was tried
  integer, parameter :: ends_round = 3          !< after some turns the mechanism is in its starting position again
  integer, parameter :: ends_otherwise = 4      !< the motion cannot go on, for another reason than a dead point

  !> One end of a range.
  type :: end_type
    integer :: kind = ends_never                !< one of the kinds above
    real(wp) :: value = 0.0_wp                  !< the limit, or the value up to which the motion was tried [rad or m]
    integer :: block = 0                        !< number of the block at its dead point
    integer :: turns = 0                        !< number of turns after which the start is reached again
    type(error_type), allocatable :: failure    !< reason why the motion cannot go on
  end type end_type

  !> The range of a coordinate.
  type :: motion_range_type
    integer :: coordinate = 0                   !< number of the coordinate
    real(wp) :: start = 0.0_wp                  !< its value at the start [rad or m]
    type(end_type) :: lower                     !< end in the negative direction
    type(end_type) :: upper                     !< end in the positive direction
  end type motion_range_type

  !> Number of turns in each direction that are tried.
  integer, parameter :: most_turns = 4
  !> Distance in each direction that a slide is tried [lengths of the mechanism].
  real(wp), parameter :: most_lengths = 20.0_wp
  !> The start is reached again where all coordinates differ from it by less than this, in their units.
  real(wp), parameter :: same = 1.0e-6_wp

contains

  !> Move one independent coordinate in both directions from an assembled start.
  subroutine find_range(plan, start, coordinate, range, stop)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    integer, intent(in) :: coordinate   !< number of the coordinate that moves
    type(motion_range_type), intent(out) :: range   !< the range of the coordinate
    class(stop_request_type), intent(in), optional :: stop   !< is asked now and then whether the motion ends where it is

    range%coordinate = coordinate
    range%start = start%q(coordinate)
    call find_end(plan, start, coordinate, 1.0_wp, range%upper, stop)
    if (range%upper%kind == ends_round) then
      range%lower = range%upper
    else
      call find_end(plan, start, coordinate, -1.0_wp, range%lower, stop)
    end if
  end subroutine find_range

  !> Move a coordinate in one direction, at one unit per second.
  subroutine find_end(plan, start, coordinate, direction, found, stop)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    integer, intent(in) :: coordinate   !< number of the coordinate that moves
    real(wp), intent(in) :: direction   !< +1 for the upper end, -1 for the lower one
    type(end_type), intent(out) :: found   !< the end of the range
    class(stop_request_type), intent(in), optional :: stop   !< is asked before each turn whether the motion ends there
    type(drive_slot_type), allocatable :: drives(:)
    class(driven_motion_type), allocatable :: driven
    type(error_type), allocatable :: err
    real(wp) :: period
    integer :: turn

    allocate (driven)
    call drive_one(plan, start, coordinate, direction, drives)
    call start_driven_motion(drives, plan, start, 0.0_wp, driven, err)
    period = plan%steps(plan%step_of(coordinate))%period/plan%unit_of(coordinate)
    if (period > 0.0_wp) then
      do turn = 1, most_turns
        if (present(stop)) then
          if (stop%is_wanted()) exit
        end if
        if (.not. allocated(err)) call advance(drives, plan, driven, period*turn, err)
        if (allocated(err)) exit
        if (.not. has_come_round(plan, start, driven%state, coordinate)) cycle
        found%kind = ends_round
        found%turns = turn
        return
      end do
    else if (.not. allocated(err)) then
      call advance(drives, plan, driven, most_lengths, err)
    end if
    found%value = driven%state%q(coordinate)
    if (.not. allocated(err)) return
    found%kind = ends_otherwise
    found%failure = err
    if (driven%ahead%kind /= dead_point .or. .not. allocated(driven%limit)) return
    found%kind = ends_at_limit
    found%value = driven%limit(coordinate)
    found%block = driven%ahead%block
  end subroutine find_end

  !> Set drives that move one independent coordinate and hold the others.
  subroutine drive_one(plan, start, coordinate, direction, drives)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    integer, intent(in) :: coordinate   !< number of the coordinate that moves
    real(wp), intent(in) :: direction   !< +1 for the upper end, -1 for the lower one
    type(drive_slot_type), allocatable, intent(out) :: drives(:)   !< of all independent coordinates
    type(polynomial_law_type) :: drive
    integer :: i, k

    allocate (drives(size(plan%independent)))
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      drive%coordinate = k
      drive%coefficients = [start%q(k), 0.0_wp]
      if (k == coordinate) drive%coefficients(2) = direction*plan%unit_of(k)
      allocate (drives(i)%drive, source=drive)
    end do
  end subroutine drive_one

  !> Whether all other coordinates have their values at the start again, except for whole turns.
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
      change = without_periods(plan%steps(plan%step_of(k)), state%q(k) - start%q(k))
      if (abs(change) > same*plan%unit_of(k)) return
    end do
    has_come_round = .true.
  end function has_come_round
end module mech9_motion_range
