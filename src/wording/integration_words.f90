!> Sentences about integrations that cannot begin or go on.
module mech9_integration_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, nearest_name
  use mech9_failure, only: failure_type, integration_stop_type
  use mech9_ode_failures, only: failure_unknown_method, failure_no_jacobian, failure_tolerance_count, &
    failure_relative_tolerance, failure_absolute_tolerance, failure_many_steps, failure_inaccurate_step, &
    failure_unsolved_step, failure_accurate_step, failure_step_memory, failure_step_settings, failure_short_step
  use mech9_integration_methods, only: integration_methods
  implicit none
  private
  public :: explain_settings, explain_step, explain_stop

contains

  !> Settings with which no integration can begin. `text` stays as it is for other kinds.
  pure subroutine explain_settings(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_unknown_method)
      call explain_method(failure%name, text)
    case (failure_no_jacobian)
      text = 'a system of equations without Jacobian was asked for it'
    case (failure_tolerance_count)
      text = 'an integration needs one absolute tolerance for each of its variables'
    case (failure_relative_tolerance)
      text = 'the relative tolerance must be between 0 and 1; it is '//to_text(failure%tolerance)
    case (failure_absolute_tolerance)
      text = 'the absolute tolerance must be greater than 0'
    end select
  end subroutine explain_settings

  !> A name that no method of integration has.
  pure subroutine explain_method(method, text)
    character(len=*), intent(in) :: method                !< the name
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: hint, names
    integer :: i

    names = trim(integration_methods(1)%name)
    do i = 2, size(integration_methods)
      names = names//', '//trim(integration_methods(i)%name)
    end do
    hint = nearest_name(method, integration_methods%name)
    if (hint /= '') then
      hint = '; did you mean '''//hint//'''?'
    else
      hint = '.'
    end if
    text = 'unknown method of integration '''//trim(method)//''''//hint//' There are: '//names
  end subroutine explain_method

  !> A step that the method of integration cannot make. `text` stays as it is for other kinds.
  pure subroutine explain_step(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: reason

    select case (failure%kind)
    case (failure_many_steps)
      reason = to_text(failure%limit)//' steps were not enough to come to t = '//to_text(failure%t_stop, 10)// &
               ' s, and they are now '//to_text(failure%step, 3)//' s long. The motion is stiff (try method ''bdf''), or the'// &
               ' tolerances are too small, or maximum_steps is'
    case (failure_inaccurate_step)
      reason = 'however short the step, its error stays too large.'// &
               ' Look for a force that jumps or grows without limit there; or raise the tolerances'
    case (failure_unsolved_step)
      reason = 'the equations of an implicit step cannot be solved.'// &
               ' Look for a force that jumps there; or try another method'
    case (failure_accurate_step)
      reason = 'the tolerances ask for more digits than the numbers'// &
               ' have. Raise relative_tolerance or absolute_tolerance'
    case (failure_step_memory)
      reason = 'there is not enough memory'
    case (failure_step_settings)
      reason = 'its settings do not fit together'
    case (failure_short_step)
      reason = 'the steps have become too short for time to advance.'// &
               ' The motion becomes infinitely fast there, or comes to a position that it cannot pass;'// &
               ' or times are so large that they should begin at 0'
    case default
      return
    end select
    text = stands(failure%t)//' '//reason
  end subroutine explain_step

  !> Say where the integration stood that a failure ended, before the message of that.
  pure subroutine explain_stop(stopped, text)
    type(integration_stop_type), intent(in) :: stopped    !< the times at which it stood and failed
    character(len=:), allocatable, intent(inout) :: text  !< the message

    text = stands(stopped%t)//' at t = '//to_text(stopped%t_failed, 10)//' s: '//text
  end subroutine explain_stop

  !> Length of the beginning of a message.
  pure integer function stands_length(t) result(length)
    real(wp), intent(in) :: t        !< end of the last step [s]

    length = len('the integration cannot go on from t =  s:') + len(to_text(t, 10))
  end function stands_length

  !> The time at which the integration stands, as the beginning of a message.
  pure function stands(t) result(text)
    real(wp), intent(in) :: t        !< end of the last step [s]
    character(len=stands_length(t)) :: text

    text = 'the integration cannot go on from t = '//to_text(t, 10)//' s:'
  end function stands
end module mech9_integration_words
