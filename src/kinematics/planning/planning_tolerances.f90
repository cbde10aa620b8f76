!> Tolerances of the making of the plan, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_planning_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: contradicting_rates, one_point, lesser_share, lesser_share_near, equal_features, drawn_gap, &
    near_guesses

  !> Least residual of the rate equations, for independent rates of about one, that shows that these contradict each other.
  real(wp), parameter :: contradicting_rates = 1.0e-7_wp
  !> Shorter links [m] have pairs in one point but for errors of the data: 0.1 um, more exactly than joints are made.
  real(wp), parameter :: one_point = 1.0e-7_wp
  !> Another angle of a rod between two ball joints is held in place of the present one where the present one's share in a turn of
  !> the rod about itself is below this part of the greatest share ...
  real(wp), parameter :: lesser_share = 0.5_wp
  !> ... or below this part near a singular position, for which the held angle may be the reason. The greatest share is above 0.2.
  real(wp), parameter :: lesser_share_near = 0.8_wp
  !> Features of pairs that differ by less are equal when pairs are put in order: far above round-off, far below what is drawn.
  real(wp), parameter :: equal_features = 1.0e-7_wp
  !> Chains that are open by less than this part of the mechanism's size were drawn closed: points have three digits at least.
  real(wp), parameter :: drawn_gap = 1.0e-3_wp
  !> Closed positions up to this far from the guesses, in units of the coordinates, are those that the guesses mean: other
  !> assemblies are farther away, unless they are about to meet.
  real(wp), parameter :: near_guesses = 0.3_wp
end module mech9_planning_tolerances
