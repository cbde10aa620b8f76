!> Failures of the integration of a motion: steps, other coordinates, and joints of laws.
module mech9_integration_failures
  implicit none
  private
  public :: failure_singular_step, failure_unclosed_step, failure_other_branch, failure_drive_jumps, &
    failure_jump_sensitivity, failure_no_friction, failure_contact_paradox, failure_shared_contact, &
    failure_angles_sensitivity, last_integration_failure

  !> A position inside a step is too near to a singular one for the independent coordinates.
  integer, parameter :: failure_singular_step = 1301
  !> A block cannot be closed after a step: chains, t.
  integer, parameter :: failure_unclosed_step = 1302
  !> A coordinate would jump with other independent coordinates: coordinates.
  integer, parameter :: failure_other_branch = 1303
  !> A drive is elsewhere than its rates lead: coordinates (the driven one), t.
  integer, parameter :: failure_drive_jumps = 1304
  !> Rates jump at a joint of laws whose time a parameter sets: name, t.
  integer, parameter :: failure_jump_sensitivity = 1305
  !> Frictions have no solution, or it was not found: coordinates, t.
  integer, parameter :: failure_no_friction = 1306
  !> Friction draws a contact together that slides, so that its force has no solution: number (of the contact), values (its coefficient, the
  !> least one at which this is so), t.
  integer, parameter :: failure_contact_paradox = 1307
  !> Derivatives by parameters are not known where equilibrium does not determine the forces of closed contacts, with friction or where
  !> forces are wanted: number (of the first of these contacts), t.
  integer, parameter :: failure_shared_contact = 1308
  !> Other angles are integrated in place of those of the data file, whose derivatives are not known: t.
  integer, parameter :: failure_angles_sensitivity = 1309
  integer, parameter :: last_integration_failure = failure_angles_sensitivity
end module mech9_integration_failures
