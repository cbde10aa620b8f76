!> Failures of events of a motion: what stops cannot do.
module mech9_event_failures
  implicit none
  private
  public :: failure_stop_violated, failure_event_sensitivity, failure_stop_start, last_event_failure

  !> Drives move or press a coordinate beyond a rigid stop: number (of the stop), coordinates, values (the limit, the rate), name (unit
  !> of the limit), t.
  integer, parameter :: failure_stop_violated = 1401
  !> Rates jump at an impact, behind which derivatives by parameters are not known: number (of the stop), t.
  integer, parameter :: failure_event_sensitivity = 1402
  !> The start lies behind a rigid stop: number (of the stop), coordinates, values (the coordinate, its limit), name (of their unit).
  integer, parameter :: failure_stop_start = 1403
  integer, parameter :: last_event_failure = failure_stop_start
end module mech9_event_failures
