!> Tolerances of driven motions, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_tracking_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: trusted_contraction, small_correction, unchanged_prediction, least_step, stagnant_step, stagnant_move, &
    harmless_change, unbounded_excess, longest_prediction, round_off_term, same_spacing, least_spacing, &
    worth_positions, zero_rate, clear_pivot, dead_growth, crossing_pivot, crossing_growth, stuck_pivot, last_pivot, &
    probe_move, longest_growth, far_slide, escaped_slide, escaping_speed, escape_law, just_short_of_end, &
    shorter_crossing, trusted_crossing, trusted_crossing_rates, first_move, doubtful_margin

  ! Steps.

  !> Newton's method must reduce its correction to this part from the first to the second iteration, ...
  real(wp), parameter :: trusted_contraction = 0.25_wp
  !> ... unless the correction is below this part of the least pivot.
  real(wp), parameter :: small_correction = 1.0e-4_wp
  !> A correction by less than this leaves the rates as they are from which only the next position is predicted: twelve digits are
  !> more than the prediction has.
  real(wp), parameter :: unchanged_prediction = 1.0e-12_wp
  !> A step shorter than this part of the time is not tried.
  real(wp), parameter :: least_step = 1.0e-14_wp
  !> A step is stagnant if it goes less than this part of the remaining time and moves no coordinate farther than stagnant_move.
  real(wp), parameter :: stagnant_step = 1.0e-5_wp
  !> Largest movement of a stagnant step [rad, lengths of the mechanism].
  real(wp), parameter :: stagnant_move = 1.0e-3_wp
  !> A change of the Jacobian (root of the sum of squares) up to this part of the least pivot is accepted.
  real(wp), parameter :: harmless_change = 0.25_wp
  !> Measure of a step whose excess of length has no measure.
  real(wp), parameter :: unbounded_excess = 1.0e30_wp
  !> A prediction uses the polynomial through two positions up to this many times their distance.
  real(wp), parameter :: longest_prediction = 3.0_wp
  !> The highest term of the polynomial is only round-off where it is below this part of the coordinate or of its unit.
  real(wp), parameter :: round_off_term = 64.0_wp*epsilon(1.0_wp)
  !> Weights serve again where all times, or of equal steps the latest one, agree within this part of the step with those for which
  !> they were found.
  real(wp), parameter :: same_spacing = 1.0e-9_wp
  !> Earlier times are used as long as the distances between them are at least this part of the last step.
  real(wp), parameter :: least_spacing = 0.2_wp
  !> Positions are used where the correction of a prediction from rates exceeds this, in units of the coordinates. Newton's
  !> method takes a second iteration from 1e-9 on; round-off of the positions makes a correction of about 1e-14.
  real(wp), parameter :: worth_positions = 1.0e-10_wp

  ! Special positions. All pivots are parts of the largest least pivot so far.

  !> Rates below this part of the largest are zero but for round-off.
  real(wp), parameter :: zero_rate = 1.0e-13_wp
  !> Above this least pivot the block is far from the singular position again.
  real(wp), parameter :: clear_pivot = 0.06_wp
  !> Rates that have grown by this factor show a dead point.
  real(wp), parameter :: dead_growth = 1.0e4_wp
  !> Below this least pivot ...
  real(wp), parameter :: crossing_pivot = 1.0e-6_wp
  !> ... rates that have grown by less than this factor show a crossing.
  real(wp), parameter :: crossing_growth = 3.0_wp
  !> The same where no step is accepted any more, which round-off may cause somewhat before.
  real(wp), parameter :: stuck_pivot = 1.0e-4_wp
  !> Below this least pivot round-off dominates, so that the kind must be decided.
  real(wp), parameter :: last_pivot = 3.0e-8_wp
  !> Movement of the fastest coordinate in a step of the probe [rad, lengths of the mechanism].
  real(wp), parameter :: probe_move = 0.1_wp
  !> Largest ratio of a step of the probe to the one before it, and factor by which steps are shortened where drives end.
  real(wp), parameter :: longest_growth = 4.0_wp
  !> A slide that exceeds so many lengths of the mechanism may escape.
  real(wp), parameter :: far_slide = 3.0_wp
  !> A slide escapes where it exceeds so many lengths of the mechanism ...
  real(wp), parameter :: escaped_slide = 100.0_wp
  !> ... and is so many times faster than the coordinates that drive it: hardly any mechanism has two axes that come so close
  !> to parallel and part again.
  real(wp), parameter :: escaping_speed = 5.0e3_wp
  !> For x = c/(T - t)^p the quotient x x''/x'^2 is 1 + 1/p, between these; at a dead point it is large.
  real(wp), parameter :: escape_law(2) = [1.2_wp, 6.0_wp]
  !> A motion that ends goes up to this part of the time between the position where the end was found and the end.
  real(wp), parameter :: just_short_of_end = 1.0e-9_wp
  !> Distance of a polynomial from the crossing, over the distance tried before.
  real(wp), parameter :: shorter_crossing = 1.0_wp/3.0_wp
  !> Largest correction of a position beyond the crossing, over the least pivot there.
  real(wp), parameter :: trusted_crossing = 0.02_wp
  !> Largest difference between its rates and those of the polynomial, over the largest rate.
  real(wp), parameter :: trusted_crossing_rates = 0.02_wp
  !> Movement from the start to the first regular position that is tried [rad, lengths of the mechanism].
  real(wp), parameter :: first_move = 0.05_wp
  !> The angles of a ball joint are replaced by others where the sine of the angle between their first and third axis is below
  !> this. The others' sine is then above 0.9.
  real(wp), parameter :: doubtful_margin = 0.4_wp
end module mech9_tracking_tolerances
