!> Failures of events of a motion: what stops, frictions and contacts cannot do.
module mech9_event_failures
  implicit none
  private
  public :: failure_stop_violated, failure_event_sensitivity, failure_stop_start, failure_singular_contact, &
    failure_paradox, failure_shared_sticking, failure_undecided_friction, failure_contact_start, &
    failure_contact_violated, failure_undecided_contact, failure_contact_behind, last_event_failure
  public :: cause_grazing, cause_several_impacts, cause_start_on_stop, cause_no_motion, cause_drive_jumps, &
    cause_breaks_loose, cause_held_hit, cause_contact_loose, cause_contact_rest, cause_rubbing_impact, cause_slip_at_rest, &
    cause_corner_rest

  !> Drives move or press a coordinate beyond a rigid stop: number (of the stop), coordinates, values (the limit, the rate), name (unit
  !> of the limit), t.
  integer, parameter :: failure_stop_violated = 1401
  !> An event has no derivatives by parameters: limit (one of the causes below), number (of the stop or the contact; of the friction
  !> where that is the cause), name (stop or contact), t.
  integer, parameter :: failure_event_sensitivity = 1402
  !> The causes: a stop is met without a rate; two impacts at once; a start on a stop that parameters move; a pair comes to rest without
  !> an acceleration; the rate of a drive jumps; a pair begins to slip whose coefficient at
  !> rest is above that of sliding; drives hit a contact that is closed; a contact begins to slide whose coefficient at rest is above that of
  !> sliding; one comes to rest without an acceleration; friction just stops the slip of one that is hit; one begins to
  !> act without a slip, which parameters change; the ball of a contact comes to rest where a part of its path ends.
  integer, parameter :: cause_grazing = 1, cause_several_impacts = 2, cause_start_on_stop = 3, cause_no_motion = 4, &
    cause_drive_jumps = 5, cause_breaks_loose = 6, cause_held_hit = 7, cause_contact_loose = 8, cause_contact_rest = 9, &
    cause_rubbing_impact = 10, cause_slip_at_rest = 11, cause_corner_rest = 12
  !> The start lies behind a rigid stop: number (of the stop), coordinates, values (the coordinate, its limit), name (of their unit).
  integer, parameter :: failure_stop_start = 1403
  !> The equations of motion are singular where a stop is met: coordinates (without inertia), t.
  integer, parameter :: failure_singular_contact = 1404
  !> While pairs slip, frictions have no solution or several (the paradox of Painleve): coordinates, values (the coefficient of the first
  !> one, the least one at which this is so), number (1: no solution, 2: several), t.
  integer, parameter :: failure_paradox = 1405
  !> A pair sticks whose coordinate depends on several others that stick, so that nothing decides how they share their forces:
  !> coordinates (the pair, then the others), t.
  integer, parameter :: failure_shared_sticking = 1406
  !> It was not found which pairs stick, and which slip: coordinates, t.
  integer, parameter :: failure_undecided_friction = 1407
  !> The start lies within a rigid contact: number (of the contact), values (the gap).
  integer, parameter :: failure_contact_start = 1408
  !> Drives press the links of a contact into each other: number (of the contact), values (the rate of the gap), t.
  integer, parameter :: failure_contact_violated = 1409
  !> Contacts with friction have no solution, or several: number (of one of them), limit (1: no solution, 2: several), t.
  integer, parameter :: failure_undecided_contact = 1410
  !> A ball comes behind its path, round one of its ends: number (of the contact), values (the gap), t.
  integer, parameter :: failure_contact_behind = 1411
  integer, parameter :: last_event_failure = failure_contact_behind
end module mech9_event_failures
