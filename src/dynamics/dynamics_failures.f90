!> Failures of the equations of motion.
module mech9_dynamics_failures
  implicit none
  private
  public :: failure_singular_block, failure_no_inertia, last_dynamics_failure

  !> A block is singular for the independent coordinates: chains, coordinates.
  integer, parameter :: failure_singular_block = 701
  !> No mass moves with an independent coordinate: coordinates.
  integer, parameter :: failure_no_inertia = 702
  integer, parameter :: last_dynamics_failure = failure_no_inertia
end module mech9_dynamics_failures
