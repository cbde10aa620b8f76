!> The failures of an integration: unusable requests, and steps that cannot be made.
module mech9_integration_failure
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_internal, exit_data, exit_integrator
  use mech9_failure, only: failure_off_curve, failure_off_table
  use mech9_ode_failures, only: failure_unknown_method, failure_tolerance_count, failure_relative_tolerance, &
    failure_absolute_tolerance, failure_inaccurate_step, failure_unsolved_step, failure_accurate_step, &
    failure_step_memory, failure_step_settings, failure_short_step
  use mech9_integration_methods, only: method_index, step_tolerance_type
  use mech9_stepper, only: evaluation_failed, too_inaccurate, not_convergent, too_accurate, out_of_memory
  use mech9_sundials_system, only: system_box_type
  implicit none
  private
  public :: check_method, check_tolerances, fail_by_outcome, fail_by_vanishing_step

contains

  !> Place of a method in integration_methods; blank means the first. Fails for an unknown name.
  pure subroutine check_method(method, index, err)
    character(len=*), intent(in) :: method              !< name, as in integration_methods; blank: the first one
    integer, intent(out) :: index                       !< place of the method in integration_methods; 0 where the name is unknown
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    index = 1
    if (method == '') return
    index = method_index(method)
    if (index > 0) return
    call raise(err, exit_data, failure_unknown_method)
    err%failure%name = trim(method)
  end subroutine check_method

  !> Fails for tolerances with which no step can be judged.
  pure subroutine check_tolerances(tolerance, n, err)
    type(step_tolerance_type), intent(in) :: tolerance  !< of the steps
    integer, intent(in) :: n                            !< number of variables
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    associate (relative => tolerance%relative, absolute => tolerance%absolute)
      if (n < 1 .or. size(absolute) /= n) then
        call raise(err, exit_internal, failure_tolerance_count)
      else if (.not. (relative > 0.0_wp .and. relative < 1.0_wp)) then
        call raise(err, exit_data, failure_relative_tolerance)
        err%failure%tolerance = relative
      else if (.not. all(absolute > 0.0_wp .and. absolute <= huge(absolute))) then
        call raise(err, exit_data, failure_absolute_tolerance)
      end if
    end associate
  end subroutine check_tolerances

  !> The failure of a step: that of the system where it explains the outcome, else that of the method.
  subroutine fail_by_outcome(box, outcome, t, err)
    type(system_box_type), intent(in) :: box            !< the system, with the failures of its evaluations
    integer, intent(in) :: outcome                      !< one of the outcomes of mech9_stepper but `stepped`
    real(wp), intent(in) :: t                           !< end of the last accepted step [s]
    type(error_type), allocatable, intent(out) :: err   !< always allocated

    if (box%has_cause()) then
      call fail_by_system(box, t, err)
      return
    end if
    select case (outcome)
    case (too_inaccurate)
      call raise(err, exit_integrator, failure_inaccurate_step)
    case (not_convergent, evaluation_failed)
      call raise(err, exit_integrator, failure_unsolved_step)
    case (too_accurate)
      call raise(err, exit_integrator, failure_accurate_step)
    case (out_of_memory)
      call raise(err, exit_integrator, failure_step_memory)
    case default
      call raise(err, exit_internal, failure_step_settings)
    end select
    err%failure%t = t
  end subroutine fail_by_outcome

  !> The failure where a step has become too short to change the time.
  subroutine fail_by_vanishing_step(box, t, err)
    type(system_box_type), intent(in) :: box            !< the system, with the failures of its evaluations
    real(wp), intent(in) :: t                           !< end of the last accepted step [s]
    type(error_type), allocatable, intent(out) :: err   !< always allocated

    if (box%has_cause()) then
      call fail_by_system(box, t, err)
      return
    end if
    call raise(err, exit_integrator, failure_short_step)
    err%failure%t = t
  end subroutine fail_by_vanishing_step

  !> The failure of the system, which keeps its code, and the times of the integration.
  subroutine fail_by_system(box, t, err)
    type(system_box_type), intent(in) :: box            !< the system, with the failures of its evaluations
    real(wp), intent(in) :: t                           !< end of the last accepted step [s]
    type(error_type), allocatable, intent(out) :: err   !< always allocated

    err = box%failure
    if (allocated(err%failure)) then
      ! this message tells all
      if (err%failure%kind == failure_off_curve .or. err%failure%kind == failure_off_table) return
    end if
    allocate (err%stopped)
    err%stopped%t = t
    err%stopped%t_failed = box%origin + box%t_failed
  end subroutine fail_by_system
end module mech9_integration_failure
