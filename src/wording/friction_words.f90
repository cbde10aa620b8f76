!> Sentences about frictions that a motion or forces cannot have.
module mech9_friction_words
  use mech9_text, only: to_text
  use mech9_failure, only: failure_type
  use mech9_reaction_failures, only: failure_shared_bearing
  use mech9_integration_failures, only: failure_no_friction
  use mech9_event_failures, only: failure_paradox, failure_shared_sticking, failure_undecided_friction
  use mech9_driven_failures, only: failure_self_locking
  implicit none
  private
  public :: explain_friction_failure

contains

  !> The sentence about a failure of frictions. `text` stays as it is for another kind.
  pure subroutine explain_friction_failure(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: alike

    alike = ''
    if (failure%growing > 1) alike = ', if all coefficients are changed alike,'
    select case (failure%kind)
    case (failure_shared_bearing)
      text = 'the friction of coordinate '//to_text(failure%coordinates)//' depends on the component '//failure%name// &
             ' of the wrench of its pair, which equilibrium does not determine and which is not zero at t = '// &
             to_text(failure%t, 10)//' s. Leave this friction out, or give the joint more freedoms (--check names the components)'
    case (failure_no_friction)
      text = 'the frictions of coordinates '//to_text(failure%coordinates)//' have no solution at t = '//to_text(failure%t, 10)// &
             ' s: they grow faster than what they resist. Lower the coefficients of friction'
    case (failure_paradox)
      text = 'the friction of coordinate '//to_text(failure%coordinates)//' has '// &
             trim(merge('no solution      ', 'several solutions', failure%number == 1))//' from t = '//to_text(failure%t, 10)// &
             ' s on (the paradox of Painleve): its coefficient is '//to_text(failure%values(1, 1), 8)// &
             ', and from '//to_text(failure%values(1, 2), 8)//' on'//alike// &
             ' rigid bodies with dry friction cannot slip this way. Lower the coefficient, or end the motion before'
    case (failure_self_locking)
      text = 'coordinate '//to_text(failure%coordinates(2))//' cannot be driven in the '// &
             trim(merge('positive', 'negative', failure%number > 0))//' direction at t = '//to_text(failure%t, 10)// &
             ' s: the mechanism locks itself by the friction of coordinate '//to_text(failure%coordinates(1))// &
             ', whose coefficient is '//to_text(failure%values(1, 1), 8)//'; from '//to_text(failure%values(1, 2), 8)// &
             ' on'//alike//trim(merge(' no force moves it this way                          ', &
                                               ' it may jam, and the force of the drive is not unique', failure%limit == 1))// &
             '. Lower the coefficient, or drive another coordinate'
    case (failure_shared_sticking)
      text = 'the motion ends at t = '//to_text(failure%t, 10)//' s: the pair of coordinate '//to_text(failure%coordinates(1))// &
             ' sticks together with coordinates '//to_text(failure%coordinates(2:))//', and nothing decides how they share '// &
             'their forces. Leave out the friction of one of them, or give law=''smooth'''
    case (failure_undecided_friction)
      text = 'the motion ends at t = '//to_text(failure%t, 10)//' s, because no choice of sticking and slipping pairs agrees '// &
             'with the friction of coordinates '//to_text(failure%coordinates)//'. Lower the coefficients of friction, or give '// &
             'law=''smooth'''
    end select
  end subroutine explain_friction_failure
end module mech9_friction_words
