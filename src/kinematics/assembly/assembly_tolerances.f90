!> Tolerances of the search for closed positions and of the judgement of mobility, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_assembly_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: newton_radius, regular_correction, closed_singular, allowed_gap, least_part_of_carrying, same_assembly, &
    least_movement, returned_to_start, apparent_motion, closed_after_motion, small_gap, small_part, &
    deciding_conditioning, converged_unknowns, first_displacement, finite_movement, ineffective_dimensions, &
    first_order_gap, unexplained_gap, nearly_closed, overconstrained_nearby, part_open

  ! Closing chains.

  !> Newton's method is used where residuals are below this.
  real(wp), parameter :: newton_radius = 1.0e-8_wp
  !> A larger correction of Newton's method from there shows a singular position.
  real(wp), parameter :: regular_correction = 1.0e-5_wp
  !> Residual that is accepted at a singular position, where convergence is slow: still far below any tolerance.
  real(wp), parameter :: closed_singular = 1.0e-12_wp
  !> Factor from the tolerance of the data, which holds for one closure, to the residual of a block with several closures.
  real(wp), parameter :: allowed_gap = 10.0_wp
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
  real(wp), parameter :: converged_unknowns = 1.0e-8_wp
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

  ! Causes why chains do not close or move.

  !> Gaps below this part of the mechanism's size come from dimensions with too few digits.
  real(wp), parameter :: nearly_closed = 1.0e-5_wp
  !> Dimensions that differ by less than this from those of a mechanism that moves are taken for inexact ones of it.
  real(wp), parameter :: overconstrained_nearby = 1.0e-3_wp
  !> A residual above this part of that of all closures remains open.
  real(wp), parameter :: part_open = 1.0e-3_wp
end module mech9_assembly_tolerances
