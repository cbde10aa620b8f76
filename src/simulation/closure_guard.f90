!> The last guard of a run: no row whose closed chains are open is ever recorded.
module mech9_closure_guard
  use mech9_kinds, only: wp
  use mech9_simulation_tolerances, only: largest_closure, hidden_part
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_simulation_failures, only: failure_open_position, failure_lost_link
  use mech9_plan, only: plan_type
  implicit none
  private
  public :: check_closure, closes_well

contains

  !> Fails with exit_singular where a position is not closed.
  subroutine check_closure(plan, t, gap, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: t                 !< time of the position [s]
    real(wp), intent(in) :: gap               !< largest closure error there [m, rotations times the mechanism's size]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: tolerance
    logical :: is_lost

    tolerance = max(largest_closure, plan%data_tolerance)*plan%length
    is_lost = gap > max(hidden_part*plan%least_length, plan%data_tolerance*plan%length)
    if (gap <= tolerance .and. .not. is_lost) return
    call raise(err, exit_singular, merge(failure_lost_link, failure_open_position, gap <= tolerance))
    err%failure%t = t
    err%failure%gap = gap
    err%failure%tolerance = tolerance
    err%failure%size = plan%length
    if (.not. gap <= tolerance) return
    err%failure%tolerance = hidden_part*plan%least_length
    err%failure%link = plan%shortest_link
    err%failure%distance = plan%least_length
  end subroutine check_closure

  !> Whether gaps are so far below those that would be taken for an open chain that no position needs this guard.
  pure logical function closes_well(plan, gap)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: gap           !< gaps that count as closed [rad, lengths of the mechanism]

    closes_well = gap*plan%length < 0.1_wp*hidden_part*plan%least_length
  end function closes_well
end module mech9_closure_guard
