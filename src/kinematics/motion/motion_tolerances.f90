!> Tolerances of closing chains and of their conditioning, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_motion_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: small_turn, unchanged_position, lower_pivot, clearly_less

  !> Angles that change by less are changed to second order: the terms of higher order are round-off.
  real(wp), parameter :: small_turn = 1.0e-5_wp
  !> A correction by less than this is round-off of poses and Jacobians, which stay as they are.
  real(wp), parameter :: unchanged_position = 8.0_wp*epsilon(1.0_wp)
  !> The least singular value is found when the least pivot has fallen to this part.
  real(wp), parameter :: lower_pivot = 0.99_wp
  !> Of values that differ by no more than round-off, after a whole turn for example, the first one counts.
  real(wp), parameter :: clearly_less = 1.0_wp - 1.0e-12_wp
end module mech9_motion_tolerances
