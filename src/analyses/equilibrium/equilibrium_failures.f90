!> Failures of the search for positions of equilibrium.
module mech9_equilibrium_failures
  implicit none
  private
  public :: failure_no_equilibrium, failure_interrupted_starts, failure_moving_setpoint, last_equilibrium_failure

  !> No position of equilibrium was found: coordinates (the free ones), values (free coordinate; the force that is left on
  !> it, the coordinate where the search ended, in units of the data file), name (of the units of forces).
  integer, parameter :: failure_no_equilibrium = 1201
  !> The user interrupted a search for equilibria: number (of random starts so far), limit (number of all).
  integer, parameter :: failure_interrupted_starts = 1202
  !> The setpoint of a controller with an integral part follows the motion: number (of the motor), name (of the variable).
  integer, parameter :: failure_moving_setpoint = 1203
  integer, parameter :: last_equilibrium_failure = failure_moving_setpoint
end module mech9_equilibrium_failures
