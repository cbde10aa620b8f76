!> Tolerances that several floors of kinematics, dynamics and simulation share, each with its reason.
!>
!> Tolerances of one floor, and of floors that use it, stand in its file `*_tolerances.f90`.
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: rank_tolerance, rank_tolerance_for, inexact_dimensions, screw_tolerance, least_rate, &
    singular_conditioning, round_off_of_rates, negligible_inertia, negligible_distance, &
    planar_round_off, closed_to_round_off, last_correction, unchanged_factors, &
    longest_drive, longest_move, trusted_correction, trusted_rate_change, trusted_change, near_singular

  ! Ranks and singular positions: judged alike by --check, driven motion and dynamics.

  !> Pivots below this fraction of the largest count as zero when ranks are found.
  real(wp), parameter :: rank_tolerance = 1.0e-9_wp
  !> Factor from the error of inexact dimensions to the pivots, and to the contradictions of rates, that it causes.
  real(wp), parameter :: inexact_dimensions = 10.0_wp
  !> Screws whose components outside a smaller space are below this lie in it: well above the round-off of directions given
  !> with 16 digits, well below any deliberate deviation.
  real(wp), parameter :: screw_tolerance = 1.0e-11_wp
  !> Coordinates whose rates in all motions of norm one are below this do not move.
  real(wp), parameter :: least_rate = 1.0e-8_wp
  !> A block is in a singular position where its least pivot is below this part of its largest one: at a dead point round-off of
  !> the position gives its square root, about 1e-8.
  real(wp), parameter :: singular_conditioning = 1.0e-7_wp
  !> Round-off of rates where a block is well conditioned. Near a singular position closed positions
  !> are uncertain by round-off over the pivot, and rates by that over the pivot again.
  real(wp), parameter :: round_off_of_rates = 64.0_wp*epsilon(1.0_wp)
  !> A coefficient of motion below this part of the whole mechanism's inertia is the square of rates that are round-off; the
  !> inertias of a watch's gear and of a crane are in the ratio 1e-18.
  real(wp), parameter :: negligible_inertia = 1.0e-26_wp

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
  !> A correction by less than this changes solutions with the factors of a Jacobian by no more than their own round-off in chains
  !> of some dozens of steps; the factors stay.
  real(wp), parameter :: unchanged_factors = 32.0_wp*epsilon(1.0_wp)

  ! Steps of driven motions, and of the runs of planar mechanisms.

  !> Largest movement of a driven coordinate in a step [rad, lengths of the mechanism].
  real(wp), parameter :: longest_drive = 0.25_wp
  !> Largest movement of a dependent coordinate in a step [rad, lengths of the mechanism].
  real(wp), parameter :: longest_move = 0.5_wp
  !> Largest correction of the prediction over the least pivot. By Kantorovich's theorem Newton's method converges to the only
  !> solution near by while this is below about 1/2 over the curvature.
  real(wp), parameter :: trusted_correction = 0.05_wp
  !> Largest change of the rates in a step, times its length, over the movement: beyond it the movement turned back.
  real(wp), parameter :: trusted_rate_change = 1.0_wp
  !> Norm of J^-1 D that is accepted: below 1 no singular matrix lies on the straight line between the two Jacobians; the
  !> margin is for the true path, which is not straight.
  real(wp), parameter :: trusted_change = 0.5_wp
  !> A block is near a singular position where its least pivot is below this part of the largest least pivot so far.
  real(wp), parameter :: near_singular = 0.03_wp

contains

  !> The tolerance of ranks for dimensions of some accuracy: pivots that errors of dimensions make count as zero too.
  pure real(wp) function rank_tolerance_for(data_tolerance) result(tolerance)
    real(wp), intent(in) :: data_tolerance    !< error of the dimensions [rad, parts of the mechanism's size]

    tolerance = max(rank_tolerance, inexact_dimensions*data_tolerance)
  end function rank_tolerance_for
end module mech9_tolerances
