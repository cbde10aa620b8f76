!> Tolerances of inverse dynamics, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_reaction_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: balanced, balanced_singular, regular_balance, equal_lengths, counts_as_zero

  !> Wrenches of pairs balance the links if what remains is below this part of the largest wrench: a thousand times the round-off
  !> of the sums.
  real(wp), parameter :: balanced = 1.0e-12_wp
  !> The same beside a singular position, where wrenches are large against what the links require.
  real(wp), parameter :: balanced_singular = 1.0e-9_wp
  !> Transposed equations of motion give the wrenches where the least pivot is above this part of the largest; in worse positions the
  !> singular values of the links' balance decide which wrenches are finite.
  real(wp), parameter :: regular_balance = 1.0e-6_wp
  !> Lengths of links, and their changes with a parameter, are equal if they differ by less than this part: a thousand times the
  !> round-off of positions and of their derivatives.
  real(wp), parameter :: equal_lengths = 1.0e-10_wp
  !> A component that equilibrium does not determine counts as zero below this part of the whole wrench: a planar linkage under loads in
  !> its plane leaves round-off of its dimensions across it.
  real(wp), parameter :: counts_as_zero = 1.0e-9_wp
end module mech9_reaction_tolerances
