!> Tolerances of derivatives by parameters, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_sensitivity_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: opened_by_parameter, round_off_of_opening

  !> A chain that a parameter opens does so by a part of the order of 1 of the largest shift of its links; one that stays closed does
  !> so to round-off times the conditioning of its block, which is 1e-7 or better.
  real(wp), parameter :: opened_by_parameter = 1.0e-7_wp
  !> A parameter may move no link of a chain. The shifts of the links and the opening of the chain are then round-off of the constants'
  !> derivatives: the opening is a sum of this over some dozen constants, which the conditioning of the chain makes larger.
  real(wp), parameter :: round_off_of_opening = 1000.0_wp
end module mech9_sensitivity_tolerances
