!> Sentences about derivatives by parameters that do not exist.
module mech9_sensitivity_words
  use mech9_text, only: to_text
  use mech9_failure, only: failure_type
  use mech9_sensitivity_failures, only: failure_no_neighbours, failure_unknown_derivative, &
    failure_singular_sensitivity, failure_opening_parameter
  use mech9_force_gradient_failures, only: failure_jumping_force
  use mech9_integration_failures, only: failure_jump_sensitivity, failure_angles_sensitivity
  use mech9_event_failures, only: failure_event_sensitivity, cause_grazing, cause_several_impacts, cause_start_on_stop, &
    cause_drive_jumps, cause_breaks_loose, cause_held_hit, cause_contact_loose, &
    cause_contact_rest, cause_rubbing_impact, cause_slip_at_rest, cause_corner_rest
  use mech9_simulation_failures, only: failure_friction_sensitivity
  use mech9_reaction_failures, only: failure_shared_force
  use mech9_block_names, only: chain_names
  implicit none
  private
  public :: explain_sensitivity, find_cause_at_event

contains

  !> The sentence about a failure of sensitivities. `text` stays as it is for any other kind.
  pure subroutine explain_sensitivity(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: cause

    select case (failure%kind)
    case (failure_no_neighbours)
      text = 'derivatives by the parameter '''//failure%name//''' do not exist: its value cannot be changed a little in both '// &
             'directions, because the data file would be wrong. Give a value inside the range that is allowed'
    case (failure_unknown_derivative)
      text = 'derivatives by the parameter '''//failure%name//''' are not computed: it sets a time of the results, '// &
             'or another number for which they are not known. Leave out the parameter, or sensitivities and gradients'
    case (failure_singular_sensitivity)
      text = 'derivatives by the parameters do not exist at t = '//to_text(failure%t, 10)//' s, in a singular position of '// &
             chain_names(failure%chains)//'. Choose times that leave it out, or leave out sensitivities and gradients'
    case (failure_opening_parameter)
      text = 'derivatives by the parameter '''//failure%name//''' do not exist: '//chain_names(failure%chains)//' would not '// &
             'stay closed if it changed alone. Let the parameter set the other dimensions too that must change with it'
    case (failure_jump_sensitivity)
      text = 'derivatives by the parameter '''//failure%name//''' are not computed beyond t = '//to_text(failure%t, 10)// &
             ' s: it sets this time, at which the rates of drives jump. Give drives without jumps of their rates, end the run '// &
             'before, leave out the parameter, or sensitivities and gradients'
    case (failure_friction_sensitivity)
      text = 'derivatives by the parameters are not computed with friction, as of friction '//to_text(failure%number)// &
             '. Leave out the friction, the parameters, or sensitivities and gradients'
    case (failure_event_sensitivity)
      call find_cause_at_event(failure, cause)
      text = 'derivatives by the parameters do not exist at t = '
      ! these exist
      if (any(failure%limit == [cause_contact_loose, cause_breaks_loose])) &
        text = 'derivatives by the parameters are not computed at t = '
      text = text//to_text(failure%t, 10)//' s: '//cause// &
             '. End the run before, or leave out sensitivities and gradients'
    case (failure_angles_sensitivity)
      text = 'derivatives by the parameters are not computed at t = '//to_text(failure%t, 10)//' s, where the motion goes on '// &
             'in other angles of a ball joint or of a rod than those of the data file. End the run before, or leave out '// &
             'sensitivities and gradients'
    case (failure_shared_force)
      text = 'derivatives of forces in the pairs are not computed, because equilibrium does not determine the force of '// &
             'coupling '//to_text(failure%number)//'. Leave out reactions, or sensitivities and gradients'
    case (failure_jumping_force)
      text = 'derivatives by the parameter '''//failure%name//''' are not computed: it sets numbers of a law by which the '// &
             'force of a load or of a motor jumps. Give a law whose value does not jump (and for the setpoint of a '// &
             'controller its rate), leave out the parameter, or sensitivities and gradients'
    end select
  end subroutine explain_sensitivity

  !> Find words for the cause for which an event has no derivatives.
  pure subroutine find_cause_at_event(failure, text)
    type(failure_type), intent(in) :: failure                     !< the failure
    character(len=:), allocatable, intent(out) :: text            !< the words
    character(len=:), allocatable :: place

    place = 'stop '//to_text(failure%number)
    if (allocated(failure%name)) place = failure%name//' '//to_text(failure%number)
    select case (failure%limit)
    case (cause_grazing)
      text = place//' is met without a rate'
    case (cause_several_impacts)
      text = place//' is hit together with another stop or contact'
    case (cause_start_on_stop)
      text = 'the motion begins on '//place//', and parameters move it away or behind'
    case (cause_held_hit)
      text = place//' is closed, and hit by drives whose rates jump'
    case (cause_contact_loose)
      text = place//' begins to slide, and its coefficient at rest is above that of sliding (give both the same value)'
    case (cause_contact_rest)
      text = place//' comes to rest without an acceleration'
    case (cause_rubbing_impact)
      text = place//' is hit, and its friction just stops the slip'
    case (cause_slip_at_rest)
      text = place//' begins to act without a slip, and parameters change its slip'
    case (cause_corner_rest)
      text = 'the ball of '//place//' comes to rest at a corner or an end of its path'
    case (cause_drive_jumps)
      text = 'the rate of a drive jumps while a stop or friction holds a coordinate'
    case (cause_breaks_loose)
      text = 'the pair of friction '//to_text(failure%number)//' begins to slip, its coefficient at rest is above that of '// &
             'sliding, and other pairs slip with it, or its bound is not met at a known rate (give both coefficients the same '// &
             'value)'
    case default
      text = 'the pair of friction '//to_text(failure%number)//' is at rest without an acceleration, or at the start with a '// &
             'rate that parameters change'
    end select
  end subroutine find_cause_at_event
end module mech9_sensitivity_words
