!> Sentences about stops that a motion cannot keep.
module mech9_stop_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_failure, only: failure_type
  use mech9_event_failures, only: failure_stop_violated, failure_stop_start
  use mech9_simulation_failures, only: failure_many_events, failure_unheld_stop, &
    failure_stop_passed
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
      text = 'the motion starts behind stop '//to_text(failure%number)//': coordinate '//to_text(failure%coordinates)//' is '// &
             value(1)//', '//depth()//' beyond the end at '//value(2)//'. Start elsewhere, or move the stop'
    case (failure_stop_violated)
      text = 'the drives force coordinate '//to_text(failure%coordinates)//' beyond the end of stop '//to_text(failure%number)// &
             ' at '//value(1)//' from t = '//to_text(failure%t, 10)//' s on, with the rate '//value(2)//'/s. Change the '// &
             'drives, move the stop, or make it compliant by stiffness='
    case (failure_many_events)
      text = 'the motion makes no progress beyond t = '//to_text(failure%t, 10)//' s: it has had '//to_text(failure%limit)// &
             ' events at stops. Give a smaller restitution, or a compliant stop by stiffness='
    case (failure_unheld_stop)
      text = 'the motion ends at t = '//to_text(failure%t, 10)//' s, because no independent coordinates serve while stops hold '// &
             'coordinates '//to_text(failure%coordinates)//'. Make one of these stops compliant by stiffness='
    case (failure_stop_passed)
      text = 'coordinate '//to_text(failure%coordinates)//' passes the end of stop '//to_text(failure%number)//' at '//value(1)// &
             ' at t = '//to_text(failure%t, 10)//' s: at t = '//to_text(failure%t_stop, 10)//' s it would be '//value(2)//', '// &
             depth()//' beyond. Change the drives, or move the stop'
    end select
  contains
    !> One of the values, with its unit.
    pure function value(i) result(words)
      integer, intent(in) :: i   !< its number
      character(len=:), allocatable :: words

      words = to_text(failure%values(1, i), 6)//' '//failure%name
    end function value

    !> The distance of both values, with its unit.
    pure function depth() result(words)
      character(len=:), allocatable :: words
      real(wp) :: distance

      distance = abs(failure%values(1, 2) - failure%values(1, 1))
      words = to_text(distance, 4)//' '//failure%name
    end function depth
  end subroutine explain_stop_failure
end module mech9_stop_words
