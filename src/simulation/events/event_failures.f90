!> Failures of events of a motion: what stops cannot do.
module mech9_event_failures
  implicit none
  private
  public :: failure_stop_violated, failure_event_sensitivity, failure_stop_start, failure_singular_contact, last_event_failure

  !> Drives move or press a coordinate beyond a rigid stop: number (of the stop), coordinates, values (the limit, the rate), name (unit
  !> of the limit), t.
  integer, parameter :: failure_stop_violated = 1401
  !> Rates jump at an impact, behind which derivatives by parameters are not known: number (of the stop), t.
  integer, parameter :: failure_event_sensitivity = 1402
  !> The start lies behind a rigid stop: number (of the stop), coordinates, values (the coordinate, its limit), name (of their unit).
  integer, parameter :: failure_stop_start = 1403
  !> The equations of motion are singular where a stop is met: coordinates (without inertia), t.
  integer, parameter :: failure_singular_contact = 1404
  integer, parameter :: last_event_failure = failure_singular_contact
end module mech9_event_failures
