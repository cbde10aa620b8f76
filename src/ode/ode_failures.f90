!> Failures of integrations: settings with which none can begin, and steps that cannot be made.
module mech9_ode_failures
  implicit none
  private
  public :: failure_unknown_method, failure_no_jacobian, failure_tolerance_count, failure_relative_tolerance, &
    failure_absolute_tolerance, failure_many_steps, failure_inaccurate_step, failure_unsolved_step, &
    failure_accurate_step, failure_step_memory, failure_step_settings, failure_short_step, failure_infinite_rate, &
    failure_infinite_jacobian, last_ode_failure

  !> No method of integration has this name: name.
  integer, parameter :: failure_unknown_method = 601
  !> A system of equations without Jacobian is asked for it.
  integer, parameter :: failure_no_jacobian = 602
  !> The number of absolute tolerances is not that of the variables.
  integer, parameter :: failure_tolerance_count = 603
  !> A relative tolerance is not between 0 and 1: tolerance.
  integer, parameter :: failure_relative_tolerance = 604
  !> An absolute tolerance is not above 0.
  integer, parameter :: failure_absolute_tolerance = 605
  !> An integration takes too many steps: t, t_stop, limit, step.
  integer, parameter :: failure_many_steps = 606
  !> A step cannot be made as accurate as is asked for: t. The same for the following five, of other steps that cannot be
  !> made.
  integer, parameter :: failure_inaccurate_step = 607
  integer, parameter :: failure_unsolved_step = 608
  integer, parameter :: failure_accurate_step = 609
  integer, parameter :: failure_step_memory = 610
  integer, parameter :: failure_step_settings = 611
  integer, parameter :: failure_short_step = 612
  !> A rate of change is not finite: number (its place); of a motion, coordinates (the one that moves so).
  integer, parameter :: failure_infinite_rate = 613
  !> An entry of the Jacobian of the rates is not finite: number (its place).
  integer, parameter :: failure_infinite_jacobian = 614
  integer, parameter :: last_ode_failure = failure_infinite_jacobian
end module mech9_ode_failures
