!> Failures of driven motions: ends and surfaces that are passed, and frictions that lock.
module mech9_driven_failures
  implicit none
  private
  public :: failure_stop_passed, failure_contact_passed, failure_self_locking, last_driven_failure

  !> A driven motion passes an end of a stop: number (of the stop), coordinates, values (the limit, the coordinate at t_stop), name (of
  !> their unit), t (of the passing), t_stop (of the position behind it).
  integer, parameter :: failure_stop_passed = 1501
  !> A driven motion moves links into each other at a contact: number (of the contact), values (the gap at t_stop), t (of the passing), t_stop
  !> (of the position behind it).
  integer, parameter :: failure_contact_passed = 1502
  !> Frictions lock a driven motion, so that no drive force moves it this way: coordinates (the pair, the drive), values (the coefficient of
  !> the pair, the least one at which this is so), number (1 or -1: direction of the drive), limit (1: no force moves it, 2: several do), t.
  integer, parameter :: failure_self_locking = 1503
  integer, parameter :: last_driven_failure = failure_self_locking
end module mech9_driven_failures
