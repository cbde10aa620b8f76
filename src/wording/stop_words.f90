!> Sentences about stops that a motion cannot keep.
module mech9_stop_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_failure, only: failure_type
  use mech9_event_failures, only: failure_stop_violated, failure_stop_start, failure_singular_contact
  use mech9_simulation_failures, only: failure_many_events, failure_unheld_stop
  use mech9_driven_failures, only: failure_stop_passed
  implicit none
  private
  public :: explain_stop_failure

contains

  !> The sentence about a failure at stops. `text` stays as it is for another kind.
  pure subroutine explain_stop_failure(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_stop_start)
      text = 'the motion starts beyond the end of stop '//to_text(failure%number)//': coordinate '// &
             to_text(failure%coordinates)//' is '//trim(value(1))//', '//trim(depth())//' beyond '// &
             trim(value(2))//'. Start elsewhere, or move the stop'
    case (failure_stop_violated)
      text = 'the drives force coordinate '//to_text(failure%coordinates)//' beyond the end of stop '//to_text(failure%number)// &
             ' at '//trim(value(1))//' from t = '//to_text(failure%t, 10)//' s on, with the rate '//trim(value(2))// &
             '/s. Change the drives, move the stop, or make it compliant by stiffness='
    case (failure_many_events)
      text = 'the motion makes no progress beyond t = '//to_text(failure%t, 10)//' s: it has had '//to_text(failure%limit)// &
             ' events at stops, frictions and contacts. Give a smaller restitution, a compliant stop or contact by stiffness=, '// &
             'or friction by law=''smooth'''
    case (failure_unheld_stop)
      text = 'the motion ends at t = '//to_text(failure%t, 10)//' s, because no independent coordinates serve while stops and '// &
             'frictions hold coordinates '//to_text(failure%coordinates)//'. Make one of these stops compliant by '// &
             'stiffness=, or the friction smooth by law=''smooth'''
    case (failure_stop_passed)
      text = 'coordinate '//to_text(failure%coordinates)//' passes the end of stop '//to_text(failure%number)//' at '// &
             trim(value(1))//' at t = '//to_text(failure%t, 10)//' s: at t = '//to_text(failure%t_stop, 10)//' s it would be '// &
             trim(value(2))//', '//trim(depth())//' beyond. Change the drives, or move the stop'
    case (failure_singular_contact)
      text = 'the motion cannot go on from a stop at t = '//to_text(failure%t, 10)//' s: no mass moves with coordinate '// &
             to_text(failure%coordinates)//' there, apart from those that other independent coordinates move. Start elsewhere, '// &
             'or make the stop compliant by stiffness='
    end select
  contains
    !> One of the values, with its unit.
    pure character(len=48) function value(i)
      integer, intent(in) :: i   !< its number

      value = to_text(failure%values(1, i), 6)//' '//failure%name
    end function value

    !> The distance of both values, with its unit.
    pure character(len=48) function depth()
      real(wp) :: distance

      distance = abs(failure%values(1, 2) - failure%values(1, 1))
      depth = to_text(distance, 4)//' '//failure%name
    end function depth
  end subroutine explain_stop_failure
end module mech9_stop_words
