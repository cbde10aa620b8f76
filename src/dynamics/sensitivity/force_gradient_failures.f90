!> Failures of the derivatives of accelerations by parameters.
module mech9_force_gradient_failures
  implicit none
  private
  public :: failure_lost_inertia, failure_jumping_force, last_force_gradient_failure

  !> No mass moves with an independent coordinate that had inertia at the start: coordinates.
  integer, parameter :: failure_lost_inertia = 901
  !> A parameter sets numbers of a law by which a force jumps, so that derivatives jump: name.
  integer, parameter :: failure_jumping_force = 902
  integer, parameter :: last_force_gradient_failure = failure_jumping_force
end module mech9_force_gradient_failures
