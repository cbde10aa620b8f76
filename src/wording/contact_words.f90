!> Sentences about contacts of links that a motion cannot have.
module mech9_contact_words
  use mech9_length_words, only: length_in_words
  use mech9_text, only: to_text
  use mech9_failure, only: failure_type
  use mech9_integration_failures, only: failure_contact_paradox, failure_shared_contact
  use mech9_event_failures, only: failure_contact_start, failure_contact_violated, failure_undecided_contact, &
    failure_contact_behind
  use mech9_driven_failures, only: failure_contact_passed
  use mech9_simulation_failures, only: failure_contact_still
  implicit none
  private
  public :: explain_contact_failure

contains

  !> The sentence about a failure at contacts. `text` stays as it is for another kind.
  pure subroutine explain_contact_failure(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_contact_start)
      text = 'the links of contact '//to_text(failure%number)//' are '// &
             trim(length_in_words(failure, -failure%values(1, 1), 4))//' within each other at the start. '// &
             'Start elsewhere, or move the surface'
    case (failure_contact_violated)
      text = 'the drives press the links of contact '//to_text(failure%number)//' into each other from t = '// &
             to_text(failure%t, 10)//' s on; the gap has the rate '//trim(length_in_words(failure, failure%values(1, 1), 6))// &
             '/s. Change the drives, or make the contact compliant by stiffness='
    case (failure_undecided_contact)
      text = 'the motion ends at t = '//to_text(failure%t, 10)//' s: the forces of rigid contacts with friction have '// &
             trim(merge('no solution      ', 'several solutions', failure%limit == 1))//' there, among them contact '// &
             to_text(failure%number)//' (the paradox of Painleve). Lower friction=, or make the contact compliant by stiffness='
    case (failure_contact_behind)
      text = 'the ball of contact '//to_text(failure%number)//' comes behind its path at t = '//to_text(failure%t, 10)// &
             ' s, round one of its ends: it is '//trim(length_in_words(failure, -failure%values(1, 1), 4))// &
             ' within the surface. Make the path longer, or close it'
    case (failure_contact_still)
      text = 'the links of contact '//to_text(failure%number)//' never move against each other: the pairs between them stand '// &
             'still. Name another link or point, or leave the contact out'
    case (failure_contact_paradox)
      text = 'the friction of contact '//to_text(failure%number)//' has no solution from t = '//to_text(failure%t, 10)// &
             ' s on (the paradox of Painleve): its coefficient is '//to_text(failure%values(1, 1), 8)//', and from '// &
             to_text(failure%values(1, 2), 8)//' on friction draws the links together faster than they are pressed apart. '// &
             'Lower friction=, or end the motion before'
    case (failure_contact_passed)
      text = 'the links of contact '//to_text(failure%number)//' move into each other at t = '//to_text(failure%t, 10)// &
             ' s: at t = '//to_text(failure%t_stop, 10)//' s they would be '// &
             trim(length_in_words(failure, -failure%values(1, 1), 4))//' within each other. Change the drives, or move the surface'
    case (failure_shared_contact)
      text = 'derivatives by the parameters are not computed at t = '//to_text(failure%t, 10)//' s, where equilibrium does not '// &
             'determine the forces of closed contacts, among them contact '//to_text(failure%number)//'. Leave out reactions '// &
             'and drive forces if contacts have no friction, or give fewer contacts, or leave out sensitivities and gradients'
    end select
  end subroutine explain_contact_failure
end module mech9_contact_words
