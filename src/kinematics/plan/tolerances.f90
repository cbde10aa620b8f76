!> All tolerances of kinematics, dynamics and simulation, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: rank_tolerance, rank_tolerance_for, inexact_dimensions, contradicting_rates, screw_tolerance, least_rate, &
    singular_conditioning, zero_rate, lower_pivot, clearly_less, round_off_of_rates, negligible_distance, &
    planar_round_off, closed_to_round_off, last_correction, small_turn, unchanged_position, unchanged_factors, &
    unchanged_prediction, newton_radius, regular_correction, closed_singular, allowed_gap, largest_closure, &
    least_part_of_carrying, same_assembly, &
    least_movement, returned_to_start, apparent_motion, closed_after_motion, small_gap, small_part, &
    deciding_conditioning, settled_unknowns, first_displacement, finite_movement, ineffective_dimensions, &
    first_order_gap, unexplained_gap, longest_drive, longest_move, trusted_correction, trusted_rate_change, &
    trusted_contraction, small_correction, least_step, creeping_step, creeping_move, harmless_change, trusted_change, &
    unbounded_excess, near_singular, longest_prediction, round_off_term, same_spacing, least_spacing, worth_positions, &
    clear_pivot, dead_growth, crossing_pivot, crossing_growth, stuck_pivot, last_pivot, probe_move, longest_growth, &
    far_slide, escaped_slide, escaping_speed, escape_law, just_short_of_end, shorter_crossing, trusted_crossing, &
    trusted_crossing_rates, first_move, doubtful_conditioning, worthwhile_improvement, regular_conditioning, &
    refused_conditioning, trusted_closing, trusted_between_steps, steepest_slope, negligible_inertia, &
    doubtful_margin, lesser_share, lesser_share_near, short_way, third_derivative_step, locked, locked_together, balanced, &
    equal_lengths, balanced_singular, regular_balance, opened_by_parameter, round_off_of_opening, &
    round_off_of_jumps, hidden_part, one_point

  ! Ranks and singular positions: judged alike by --check, driven motion and dynamics.

  !> Pivots below this fraction of the largest count as zero when ranks are found.
  real(wp), parameter :: rank_tolerance = 1.0e-9_wp
  !> Factor from the error of inexact dimensions to the pivots, and to the contradictions of rates, that it causes.
  real(wp), parameter :: inexact_dimensions = 10.0_wp
  !> Least residual of the rate equations, for independent rates of about one, that shows that these contradict each other.
  real(wp), parameter :: contradicting_rates = 1.0e-7_wp
  !> Screws whose components outside a smaller space are below this lie in it: well above the round-off of directions given
  !> with 16 digits, well below any deliberate deviation.
  real(wp), parameter :: screw_tolerance = 1.0e-11_wp
  !> Coordinates whose rates in all motions of norm one are below this do not move.
  real(wp), parameter :: least_rate = 1.0e-8_wp
  !> A block is in a singular position where its least pivot is below this part of its largest one: at a dead point round-off of
  !> the position gives its square root, about 1e-8.
  real(wp), parameter :: singular_conditioning = 1.0e-7_wp
  !> Rates below this part of the largest are zero but for round-off.
  real(wp), parameter :: zero_rate = 1.0e-13_wp
  !> The least singular value is found when the least pivot has fallen to this part.
  real(wp), parameter :: lower_pivot = 0.99_wp
  !> Of values that differ by no more than round-off, after a whole turn for example, the first one counts.
  real(wp), parameter :: clearly_less = 1.0_wp - 1.0e-12_wp
  !> Round-off of rates where a block is well conditioned. Near a singular position closed positions
  !> are uncertain by round-off over the pivot, and rates by that over the pivot again.
  real(wp), parameter :: round_off_of_rates = 64.0_wp*epsilon(1.0_wp)

  ! Scaling and planar layout.

  !> Distances between pairs below this part of their distances from the links' origins are not taken as the size: round-off
  !> of the positions would exceed 1e-12 of them. Errors of a spherical mechanism's centre make such distances.
  real(wp), parameter :: negligible_distance = 1.0e-4_wp
  !> Directions, and heights in lengths of the mechanism, may differ from the plane's by this: round-off of data with 16 digits.
  real(wp), parameter :: planar_round_off = 64.0_wp*epsilon(1.0_wp)

  ! Closing chains.

  !> A chain counts as closed when its independent equations hold to this many times round-off,
  !> rotations in rad, translations in lengths of the mechanism: a sum over the steps of a loop
  !> loses a few units.
  real(wp), parameter :: closed_to_round_off = 32.0_wp*epsilon(1.0_wp)
  !> Once a correction is this small, the next error is its square: round-off.
  real(wp), parameter :: last_correction = 1.0e-9_wp
  !> Angles that change by less are changed to second order: the terms of higher order are round-off.
  real(wp), parameter :: small_turn = 1.0e-5_wp
  !> A correction by less than this is round-off of poses and Jacobians, which stay as they are.
  real(wp), parameter :: unchanged_position = 8.0_wp*epsilon(1.0_wp)
  !> A correction by less than this changes solutions with the factors of a Jacobian by no more than their own round-off in chains
  !> of some dozens of steps; the factors stay.
  real(wp), parameter :: unchanged_factors = 32.0_wp*epsilon(1.0_wp)
  !> The same for rates from which only the next position is predicted: twelve digits are more than the prediction has.
  real(wp), parameter :: unchanged_prediction = 1.0e-12_wp
  !> Newton's method takes over from residuals below this.
  real(wp), parameter :: newton_radius = 1.0e-8_wp
  !> A larger correction of Newton's method from there shows a singular position.
  real(wp), parameter :: regular_correction = 1.0e-5_wp
  !> Residual that is accepted at a singular position, where convergence is slow: still far below any tolerance.
  real(wp), parameter :: closed_singular = 1.0e-12_wp
  !> Factor from the tolerance of the data, which holds for one closure, to the residual of a block with several closures.
  real(wp), parameter :: allowed_gap = 10.0_wp
  !> Chains count as closed up to this part of the mechanism's size: a thousand times above the worst round-off that was
  !> measured, far below any accuracy that users need.
  real(wp), parameter :: largest_closure = 1.0e-9_wp
  !> Chains count as closed up to this part of the shortest link, too: where lengths differ by more than 1e11, the round-off of the
  !> largest ones hides the motion of the shortest.
  real(wp), parameter :: hidden_part = 1.0e-4_wp
  !> Shorter links [m] have pairs in one point but for errors of the data: 0.1 um, more exactly than joints are made.
  real(wp), parameter :: one_point = 1.0e-7_wp
  !> Independent coordinates are moved to given values in steps of at least this part of the whole distance.
  real(wp), parameter :: least_part_of_carrying = 1.0e-4_wp
  !> Coordinates that differ by less, in their units, belong to one assembly.
  real(wp), parameter :: same_assembly = 1.0e-6_wp
  !> A change of a coordinate below this, in its unit, is no motion: at a singular position the round-off of a closure changes
  !> coordinates by its square root.
  real(wp), parameter :: least_movement = 1.0e-4_wp
  !> A coordinate that differs from the start by less than this, in its unit, after a change of all coordinates has returned to
  !> it: at a singular position the round-off of a closure changes coordinates by its square root.
  real(wp), parameter :: returned_to_start = 1.0e-4_wp
  !> A coordinate whose rates in motions of norm one exceed this would not return to the start by chance.
  real(wp), parameter :: apparent_motion = 1.0e-2_wp

  ! Chains that close at the start only.

  !> Residuals of a chain that stays closed [rad, parts of the size]: sums of round-off over the steps of a loop.
  real(wp), parameter :: closed_after_motion = 1.0e-12_wp
  !> Residuals below this, and below this part of the squared displacement, come from inexact dimensions if the position is
  !> regular: inputs out of reach and other branches of an earlier block leave larger ones.
  real(wp), parameter :: small_gap = 1.0e-6_wp
  !> Residuals below this, and below this part of the squared displacement, come from inexact dimensions if the position is
  !> regular: inputs out of reach and other branches of an earlier block leave larger ones.
  real(wp), parameter :: small_part = 1.0e-4_wp
  !> Least conditioning of a position whose residual decides alone: round-off of earlier blocks grows by its inverse square.
  real(wp), parameter :: deciding_conditioning = 1.0e-3_wp
  !> Largest distance of the unknowns from those with the least residual.
  real(wp), parameter :: settled_unknowns = 1.0e-8_wp
  !> Largest displacement, in units of the coordinates.
  real(wp), parameter :: first_displacement = 0.3_wp
  !> Least change of a coordinate, in its unit, that counts as a motion where all coordinates are displaced.
  real(wp), parameter :: finite_movement = 1.0e-2_wp
  !> Singular values of the effect of dimensions on closures below this part of the largest do not count.
  real(wp), parameter :: ineffective_dimensions = 1.0e-3_wp
  !> Largest gap, in parts of the size, on which changes of dimensions act to first order.
  real(wp), parameter :: first_order_gap = 1.0e-2_wp
  !> Largest part of the gaps that changes of dimensions may leave unexplained.
  real(wp), parameter :: unexplained_gap = 0.1_wp

  ! Steps of driven motions.

  !> Largest movement of a driven coordinate in a step [rad, lengths of the mechanism].
  real(wp), parameter :: longest_drive = 0.25_wp
  !> Largest movement of a dependent coordinate in a step [rad, lengths of the mechanism].
  real(wp), parameter :: longest_move = 0.5_wp
  !> Largest correction of the prediction over the least pivot. By Kantorovich's theorem Newton's method converges to the only
  !> solution near by while this is below about 1/2 over the curvature.
  real(wp), parameter :: trusted_correction = 0.05_wp
  !> Largest change of the rates in a step, times its length, over the movement: beyond it the movement turned back.
  real(wp), parameter :: trusted_rate_change = 1.0_wp
  !> Newton's method must reduce its correction to this part from the first to the second iteration, ...
  real(wp), parameter :: trusted_contraction = 0.25_wp
  !> ... unless the correction is below this part of the least pivot.
  real(wp), parameter :: small_correction = 1.0e-4_wp
  !> A step shorter than this part of the time is not tried.
  real(wp), parameter :: least_step = 1.0e-14_wp
  !> A step creeps if it goes less than this part of the remaining time and moves no coordinate farther than creeping_move.
  real(wp), parameter :: creeping_step = 1.0e-5_wp
  !> Largest movement of a creeping step [rad, lengths of the mechanism].
  real(wp), parameter :: creeping_move = 1.0e-3_wp
  !> A change of the Jacobian (root of the sum of squares) up to this part of the least pivot is accepted.
  real(wp), parameter :: harmless_change = 0.25_wp
  !> Norm of J^-1 D that is accepted: below 1 no singular matrix lies on the straight line between the two Jacobians; the
  !> margin is for the true path, which is not straight.
  real(wp), parameter :: trusted_change = 0.5_wp
  !> Measure of a step whose excess of length has no measure.
  real(wp), parameter :: unbounded_excess = 1.0e30_wp
  !> A block is near a singular position where its least pivot is below this part of the largest least pivot so far.
  real(wp), parameter :: near_singular = 0.03_wp
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

  ! Special positions of driven motions. All pivots are parts of the largest least pivot so far.

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

  ! Motions of dynamics.

  !> A coefficient of motion below this part of the whole mechanism's inertia is the square of rates that are round-off; the
  !> inertias of a watch's gear and of a crane are in the ratio 1e-18.
  real(wp), parameter :: negligible_inertia = 1.0e-26_wp
  !> Below this conditioning other independent coordinates are tried ...
  real(wp), parameter :: doubtful_conditioning = 0.08_wp
  !> ... and taken if they are so many times better conditioned; otherwise they are tried again when the conditioning is so many
  !> times worse.
  real(wp), parameter :: worthwhile_improvement = 4.0_wp
  !> Above this conditioning a step may go beyond the next output: it will not reach a singular position unnoticed.
  real(wp), parameter :: regular_conditioning = 0.14_wp
  !> A step from a well conditioned state is repeated with a shorter length if it meets a conditioning below this.
  real(wp), parameter :: refused_conditioning = 0.03_wp
  !> Largest change of a coordinate, in its unit, when the chains are closed at the integrator's result, whose error is far
  !> smaller: after a larger change they might be closed on another branch.
  real(wp), parameter :: trusted_closing = 0.02_wp
  !> The same for a position within a step, which is known as well as the ends of the step.
  real(wp), parameter :: trusted_between_steps = 1.0e-3_wp
  !> A change of the rate of a drive at a joint of its law is round-off of the law where it moves the coordinate by less than this in
  !> the whole run, in its unit: laws that come to rest leave some 1e-14 of their greatest rate.
  real(wp), parameter :: round_off_of_jumps = 1.0e-9_wp
  !> Steepest slope between two neighbouring triple zeros, times their distance, against the height: 3.4.
  real(wp), parameter :: steepest_slope = 4.0_wp
  !> The angles of a ball joint are replaced by others where the sine of the angle between their first and third axis is below
  !> this. The others' sine is then above 0.9.
  real(wp), parameter :: doubtful_margin = 0.4_wp
  !> Another angle of a rod between two ball joints is held in place of the present one where the present one's share in a turn of
  !> the rod about itself is below this part of the greatest share ...
  real(wp), parameter :: lesser_share = 0.5_wp
  !> ... or below this part near a singular position, for which the held angle may be the reason. The greatest share is above 0.2.
  real(wp), parameter :: lesser_share_near = 0.8_wp
  !> Longest way of a ball joint's third axis over which its angles are continued at once, in parts of its distance from gimbal
  !> lock. They cannot change by half a turn while this is below 1; ways are bounded by twice the greater speed of both ends.
  real(wp), parameter :: short_way = 0.5_wp
  !> An integration that cannot go on stands in gimbal lock if the least singular value of the coefficients of motion is below
  !> this part of that at the start: integrations come to 1e-6 rad of it, and the value is about the square of the distance.
  real(wp), parameter :: locked = 1.0e-6_wp
  !> Coordinates have a part in gimbal lock that is at least this part of the largest.
  real(wp), parameter :: locked_together = 0.1_wp
  !> Wrenches of pairs balance the links if what remains is below this part of the largest wrench: a thousand times the round-off
  !> of the sums.
  real(wp), parameter :: balanced = 1.0e-12_wp
  !> Lengths of links, and their changes with a parameter, are equal if they differ by less than this part: a thousand times the
  !> round-off of positions and of their derivatives.
  real(wp), parameter :: equal_lengths = 1.0e-10_wp
  !> The same beside a singular position, where wrenches are large against what the links require.
  real(wp), parameter :: balanced_singular = 1.0e-9_wp
  !> Transposed equations of motion give the wrenches where the least pivot is above this part of the largest; in worse positions the
  !> singular values of the links' balance decide which wrenches are finite.
  real(wp), parameter :: regular_balance = 1.0e-6_wp
  !> Distance in time of two evaluations whose difference gives third derivatives, over the time that the motion takes for
  !> 1 rad: the square of this and round-off over it are both the error, about 1e-10.
  real(wp), parameter :: third_derivative_step = 1.0e-5_wp
  !> A chain that a parameter opens does so by a part of the order of 1 of the largest shift of its links; one that stays closed does
  !> so to round-off times the conditioning of its block, which is 1e-7 or better.
  real(wp), parameter :: opened_by_parameter = 1.0e-7_wp
  !> A parameter may move no link of a chain. The shifts of the links and the opening of the chain are then round-off of the constants'
  !> derivatives: the opening is a sum of this over some dozen constants, which the conditioning of the chain makes larger.
  real(wp), parameter :: round_off_of_opening = 1000.0_wp

contains

  !> The tolerance of ranks for dimensions of some accuracy: pivots that errors of dimensions make count as zero too.
  pure real(wp) function rank_tolerance_for(data_tolerance) result(tolerance)
    real(wp), intent(in) :: data_tolerance    !< error of the dimensions [rad, parts of the mechanism's size]

    tolerance = max(rank_tolerance, inexact_dimensions*data_tolerance)
  end function rank_tolerance_for
end module mech9_tolerances
