!> Failures of inverse dynamics: forces that do not exist, or are not unique.
module mech9_reaction_failures
  implicit none
  private
  public :: failure_unbalanced, failure_shared_force, failure_shared_bearing, &
    last_reaction_failure

  !> No finite forces in the pairs balance the links in a singular position: coordinates (of the closed chains), t.
  integer, parameter :: failure_unbalanced = 1101
  !> Equilibrium does not determine the force of a coupling, whose derivatives are not known: number (of the coupling).
  integer, parameter :: failure_shared_force = 1102
  !> Equilibrium does not determine a component of a wrench on which friction depends, and it is not zero: coordinates, name (of the
  !> component), t.
  integer, parameter :: failure_shared_bearing = 1103
  integer, parameter :: last_reaction_failure = failure_shared_bearing
end module mech9_reaction_failures
