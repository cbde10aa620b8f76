!> Tolerances of events of a motion, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_event_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: round_off_of_limit, round_off_of_gaps, several_coordinates, touching, drawn_behind_stop, jumped_behind, &
    round_off_of_impacts, least_rebound, hidden_rebound, endless_part, grazing, most_events, most_events_at_once, &
    limit_of_sticking, at_rest, still, tied, round_off_of_sticking, beyond_all_bounds, pressing, known_use_rate

  ! Drives and outputs.

  !> Excess of a motor's force over its limit that is round-off, in parts of the limit.
  real(wp), parameter :: round_off_of_limit = 1.0e-12_wp

  ! Stops.

  !> Round-off of the gap to an end, in the unit of the coordinate or parts of the limit: round-off of positions of well conditioned chains.
  real(wp), parameter :: round_off_of_gaps = 8.0_wp*epsilon(1.0_wp)
  !> Gaps err by so many times the round-off of one coordinate.
  real(wp), parameter :: several_coordinates = 8.0_wp
  !> Rebounds up to so many times the round-off of the gap are no impacts: each would gain as much rate as this round-off hides.
  real(wp), parameter :: hidden_rebound = 64.0_wp
  !> An end of a stop touches where its coordinate is at most so far away or behind it, in its unit: a hundred times the round-off of
  !> closed positions, far below the tolerances of integration.
  real(wp), parameter :: touching = 1.0e-12_wp
  !> A coordinate may start so far behind its stop, in its unit: positions in a data file have ten digits and more, and chains are closed
  !> to round-off.
  real(wp), parameter :: drawn_behind_stop = 1.0e-10_wp
  !> A ball that is met so far behind its surface, in the unit of length, did not come through it: times of events err by far less.
  real(wp), parameter :: jumped_behind = 1.0e-6_wp
  !> Part of the sum of its terms that is round-off in the acceleration or in the force of a contact: inertia times acceleration is
  !> eliminated there.
  real(wp), parameter :: round_off_of_impacts = 1.0e-12_wp
  !> A coordinate rebounds no higher than this, in its unit, where endless impacts are cut off: below the tolerances of integration, far
  !> above the round-off of the gap ...
  real(wp), parameter :: least_rebound = 1.0e-12_wp
  !> ... and if they would end within this part of the duration of the motion. Their end is worked out; the contact pushes as much
  !> until then as the impacts that are left out.
  real(wp), parameter :: endless_part = 1.0e-6_wp
  !> An end is met without a rate, by which derivatives would be infinite, where its rate would lift the coordinate by this part of
  !> `least_rebound`: endless impacts have larger ones before they are left out, and the rate of a motion that just touches is lost in the
  !> round-off of the gap.
  real(wp), parameter :: grazing = 1.0e-6_wp
  !> A contact that touches is pressed where its acceleration towards the end is more than this part of the largest: far above round-off.
  real(wp), parameter :: pressing = 1.0e-9_wp

  ! Frictions.

  !> Utilization of a friction at which it slips: the bound but for the round-off of reactions.
  real(wp), parameter :: limit_of_sticking = 1.0_wp + 1.0e-12_wp
  !> The bound is met at an event where the utilization is so near to it: the time of the event has the error of dense output.
  real(wp), parameter :: round_off_of_sticking = 1.0e-8_wp
  !> A pair is at rest below this part of the rates that make up its own: a thousand times their round-off.
  real(wp), parameter :: at_rest = 1.0e-12_wp
  !> A pair that sticks goes on to do so below this part of the largest rate: errors of integration are taken from the rates at an event.
  real(wp), parameter :: still = 1.0e-9_wp
  !> A coordinate depends on another below this part of what is left of it beside the others, and does not depend on one that moves it
  !> by less: the square root of the round-off of their mobilities.
  real(wp), parameter :: tied = 1.0e-8_wp

  !> A pair does not stick where its acceleration is so many times that by its largest friction: it has hardly any mobility there.
  real(wp), parameter :: beyond_all_bounds = 1.0e6_wp

  !> Error of the rate at which a pair comes to its bound, in parts of this rate, up to which derivatives by parameters use it.
  real(wp), parameter :: known_use_rate = 1.0e-6_wp

  !> Most events of a motion, and most at one time: more mean that the motion makes no progress.
  integer, parameter :: most_events = 1000000, most_events_at_once = 1000
end module mech9_event_tolerances
