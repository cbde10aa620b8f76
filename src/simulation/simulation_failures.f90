!> Failures of motions in time: requests that cannot be met, and motions that cannot go on.
module mech9_simulation_failures
  implicit none
  private
  public :: failure_not_started, failure_backwards, failure_interrupted, failure_accuracy, &
    failure_open_position, failure_lost_link, failure_no_initial_position, failure_singular_start_block, &
    failure_driven_dead_point, failure_gimbal_lock, failure_lost_angles, failure_loaded_lock, &
    failure_singular_passing, failure_many_events, failure_unheld_stop, failure_friction_sensitivity, &
    failure_contact_still, last_simulation_failure

  !> A motion is to advance before its start.
  integer, parameter :: failure_not_started = 1001
  !> A motion is to go back: t (where it stands), t_stop (where it is to go).
  integer, parameter :: failure_backwards = 1002
  !> The user interrupted a motion: t (that comes next).
  integer, parameter :: failure_interrupted = 1003
  !> A motion cannot be as accurate as was asked for: t (of the first position that is not), deviation (estimated error
  !> there), tolerance (allowed error), name (of the method), values (tolerance of its steps), limit (prince-dormand would take more than so
  !> many times the steps of the method; 0: it was not tried).
  integer, parameter :: failure_accuracy = 1004
  !> The chains of a position are open by more than is allowed: t, gap, tolerance (allowed [m]), size.
  integer, parameter :: failure_open_position = 1005
  !> The chains of a position are open by much against a short link, whose motion is lost in the round-off of the largest
  !> lengths: t, gap, tolerance (allowed [m]), size, link, distance (between the pairs of the link).
  integer, parameter :: failure_lost_link = 1006
  !> An independent coordinate of a free motion has no initial position: coordinates.
  integer, parameter :: failure_no_initial_position = 1007
  !> The same as failure_singular_block, at the start.
  integer, parameter :: failure_singular_start_block = 1008
  !> The same as failure_dead_point in a motion with free coordinates; others and values are those of driven coordinates.
  integer, parameter :: failure_driven_dead_point = 1009
  !> The rates of some coordinates no longer determine a motion of the links: coordinates, t.
  integer, parameter :: failure_gimbal_lock = 1010
  !> The angles of a ball joint could not be followed through gimbal lock: coordinates, t.
  integer, parameter :: failure_lost_angles = 1011
  !> A ball joint comes to gimbal lock in angles that cannot be replaced: coordinates, others (those of them that loads read or
  !> move; none: a drive or a coupling does), t.
  integer, parameter :: failure_loaded_lock = 1012
  !> Closed chains come to a singular position that the motion does not pass, whatever coordinates are independent: chains,
  !> coordinates, t.
  integer, parameter :: failure_singular_passing = 1013
  !> A motion has more events than are allowed: limit, t.
  integer, parameter :: failure_many_events = 1014
  !> No independent coordinates serve with those held whose stops are closed: coordinates (that are held), t.
  integer, parameter :: failure_unheld_stop = 1015
  !> Derivatives by parameters are not known with friction: number (of the first one).
  integer, parameter :: failure_friction_sensitivity = 1016
  !> The links of a contact never move against each other: number (of the contact).
  integer, parameter :: failure_contact_still = 1017
  integer, parameter :: last_simulation_failure = failure_contact_still
end module mech9_simulation_failures
