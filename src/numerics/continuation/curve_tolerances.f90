!> Tolerances of curves of solutions. Unknowns are in their units; the parameter is a part of its range.
module mech9_curve_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: round_off_step, stagnated_step, least_contraction, least_curve_step, first_part, most_turn, most_departure, &
    same_point, null_direction, difference_step, polished_step, second_order, neutral_root, real_root, same_direction, &
    near_special, near_branching

  !> Newton's method has reached round-off where its step is below this: a few thousand units of round-off.
  real(wp), parameter :: round_off_step = 1.0e-12_wp
  !> Near a branch point round-off is larger; a step below this that no longer shrinks is round-off, too.
  real(wp), parameter :: stagnated_step = 1.0e-6_wp
  !> A step of Newton's method is shorter than this part of the one before, or the method does not converge.
  real(wp), parameter :: least_contraction = 0.5_wp
  !> Steps along a curve are no shorter than this: three digits above the round-off of a branch point.
  real(wp), parameter :: least_curve_step = 1.0e-7_wp
  !> The first step of a curve is this part of the longest one.
  real(wp), parameter :: first_part = 0.1_wp
  !> Least cosine of the angle between the directions at both ends of a step, about 10 degrees: the next part of a curve may not be
  !> confused with a branch beside it, and pictures look smooth.
  real(wp), parameter :: most_turn = 0.985_wp
  !> Largest distance of a point from its prediction, as a part of the step.
  real(wp), parameter :: most_departure = 0.3_wp
  !> Points that differ by less are the same: two searches for a branch point agree to the root of round-off and better.
  real(wp), parameter :: same_point = 1.0e-6_wp
  !> A singular value of the equations at a branch point below this part of their size belongs to a direction of a branch:
  !> round-off of the exact point is a thousand times less, and a stiff mechanism has soft directions above it.
  real(wp), parameter :: null_direction = 1.0e-9_wp
  !> Step of the central differences that give second derivatives from exact first ones: truncation and round-off are both near 1e-10.
  real(wp), parameter :: difference_step = 1.0e-5_wp
  !> The search for a branch point has ended where its step is below this.
  real(wp), parameter :: polished_step = 1.0e-12_wp
  !> Second derivatives below this part of the largest one are zero: ten times the error of the differences, and more.
  real(wp), parameter :: second_order = 1.0e-6_wp
  !> A pair of roots whose real part is below this part of its magnitude neither grows nor decays: the root of round-off, which double
  !> roots have, with room.
  real(wp), parameter :: neutral_root = 1.0e-7_wp
  !> A root whose imaginary part is below this part of its magnitude is real: a real double root has such parts by round-off.
  real(wp), parameter :: real_root = 1.0e-6_wp
  !> Directions whose cosine is above this are the same: those of branches that cross differ more, by far.
  real(wp), parameter :: same_direction = 0.999_wp
  !> A fold within this part of a step from a branch point is that point: there its test is flat, and round-off moves its zero.
  real(wp), parameter :: near_special = 1.0e-3_wp
  !> The same for a branch that turns back at a branch point, on which points near it are not apart from those of the other branch.
  real(wp), parameter :: near_branching = 1.0e-2_wp
end module mech9_curve_tolerances
