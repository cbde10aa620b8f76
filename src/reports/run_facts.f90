!> The facts about a run of either kind, for reports that programs read.
module mech9_run_facts
  use mech9_kinds, only: wp
  use mech9_facts, only: facts_type
  use mech9_units, only: units_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_block_solver, only: work_count_type, work_of
  use mech9_driven_motion, only: driven_motion_type
  use mech9_driven_simulation, only: driven_simulation_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_integration_methods, only: integration_methods
  use mech9_integrator, only: integration_statistics_type
  use mech9_model_motion, only: model_motion_type
  use mech9_run_outcome, only: run_outcome_type
  implicit none
  private
  public :: list_run_facts, iterations_each, method_of

contains

  !> List the facts about a run.
  subroutine list_run_facts(motion, outcome, facts)
    type(model_motion_type), intent(inout) :: motion      !< the motion, as far as it went
    type(run_outcome_type), intent(in) :: outcome         !< number of rows, and the times for solving and writing
    type(facts_type), intent(out) :: facts                !< named numbers and texts about the run
    type(driven_simulation_type), pointer :: driven
    type(free_simulation_type), pointer :: free

    driven => motion%driven()
    free => motion%free()
    if (associated(driven)) then
      call list_driven(driven%model%mechanism%units, driven%plan, outcome, driven%driven, facts)
    else if (associated(free)) then
      call list_free(free%model, motion%plan, outcome, free, facts)
    end if
  end subroutine list_run_facts

  !> List the facts about a driven motion.
  subroutine list_driven(units, plan, outcome, driven, facts)
    type(units_type), intent(in) :: units                 !< of the results
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(run_outcome_type), intent(in) :: outcome         !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts
    type(facts_type), intent(inout) :: facts              !< named numbers and texts about the run
    type(work_count_type) :: work

    call facts%add('positions', outcome%rows, 'positions computed')
    call facts%add('steps', driven%steps, 'steps of following the drives')
    call facts%add('halvings', driven%halvings, 'steps that were too long')
    call facts%add('newton_iterations', driven%iterations, 'Newton iterations')
    call facts%add('newton_iterations_per_position', iterations_each(outcome, driven), 'Newton iterations a position', '1')
    call facts%add('largest_closure', driven%worst_closure/units%length, 'largest error of a closed chain', trim(units%length_name))
    call facts%add('size', plan%length/units%length, 'size of the mechanism, which weighs lengths against angles', &
                   trim(units%length_name))
    call facts%add('least_conditioning', driven%conditioning%least, 'least singular value of any block: 0 is singular', '1')
    call facts%add('least_conditioning_time', driven%conditioning%t, 'when it was that', 's')
    call facts%add('least_conditioning_block', driven%conditioning%block, 'block that it was in')
    call facts%add('special_positions_passed', driven%crossings, 'special positions passed')
    if (allocated(driven%work)) work = work_of(driven%work)
    call facts%add('frames_placed', work%frames_placed, 'poses of frames that were found')
    call facts%add('frames_moved', work%frames_moved, 'velocities and accelerations of frames that were found')
    call facts%add('factorizations', work%factorizations, 'Jacobians of blocks that were factorized')
    call facts%add('rate_solutions', work%rates, 'blocks solved for their rates')
    call facts%add('acceleration_solutions', work%accelerations, 'blocks solved for their accelerations')
    call facts%add('seconds_solving', outcome%seconds_solving, 'time spent solving', 's')
    call facts%add('seconds_writing', outcome%seconds_writing, 'time spent writing', 's')
  end subroutine list_driven

  !> Newton iterations for each position.
  pure real(wp) function iterations_each(outcome, driven)
    type(run_outcome_type), intent(in) :: outcome         !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts

    iterations_each = real(driven%iterations, wp)/max(1, outcome%rows)
  end function iterations_each

  !> List the facts about a free motion.
  subroutine list_free(model, plan, outcome, simulation, facts)
    type(model_type), intent(in) :: model                     !< the model
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism
    type(run_outcome_type), intent(in) :: outcome             !< number of rows, and the times for solving and writing
    type(free_simulation_type), intent(inout) :: simulation   !< the motion, as far as it went
    type(facts_type), intent(inout) :: facts                  !< named numbers and texts about the run
    type(integration_statistics_type) :: counts
    type(work_count_type) :: work
    character(len=:), allocatable :: unit

    counts = simulation%motion%statistics()
    call facts%add('outputs', outcome%rows, 'outputs computed')
    call facts%add('method', trim(method_of(simulation)), 'method of integration')
    call facts%add('relative_tolerance', model%request%solver%relative_tolerance, 'relative error allowed in a step', '1')
    call facts%add('absolute_tolerance', model%request%solver%absolute_tolerance, 'absolute error allowed in a step', '1')
    if (simulation%with_error) then
      unit = model%mechanism%units%angle_name//','//trim(model%mechanism%units%length_name)
      call facts%add('accuracy', simulation%errors%allowed, 'largest error that was allowed', unit)
      call facts%add('error', simulation%largest_error, 'largest estimated error of the outputs', unit)
      call facts%add('other_runs', simulation%errors%runs, 'runs that tell the error and the tolerances')
      call facts%add('other_evaluations', simulation%errors%evaluations, 'evaluations of the accelerations in these runs')
    end if
    call facts%add('steps', counts%steps, 'steps of the integrator')
    if (method_of(simulation) == 'auto') then
      call facts%add('implicit_steps', counts%implicit_steps, 'steps of bdf, where the motion was stiff')
      call facts%add('method_changes', counts%method_changes, 'changes between prince-dormand and bdf')
    end if
    call facts%add('evaluations', counts%rate_evaluations, 'evaluations of the accelerations')
    call facts%add('jacobian_evaluations', counts%jacobian_evaluations, &
                   'Jacobians of the equations of motion, by differences (bdf)')
    call facts%add('error_test_failures', counts%error_test_failures, 'steps made again for their error')
    call facts%add('convergence_failures', counts%convergence_failures, 'steps made again that did not converge')
    call facts%add('refusals', counts%refusals, 'steps made again for what they met')
    call facts%add('newton_iterations', simulation%motion%iterations(), 'Newton iterations')
    associate (units => model%mechanism%units)
      call facts%add('largest_closure', simulation%worst_closure/units%length, 'largest error of a closed chain', &
                     trim(units%length_name))
      call facts%add('size', plan%length/units%length, 'size of the mechanism, which weighs lengths against angles', &
                     trim(units%length_name))
      if (model%request%output%energies) then
        call facts%add('energy_at_start', simulation%energy_at_start/units%size_of('J'), &
                       'kinetic and potential energy at the start', trim(units%name_of('J')))
        call facts%add('largest_energy_change', simulation%largest_energy_change/units%size_of('J'), &
                       'largest change of that energy', trim(units%name_of('J')))
      end if
    end associate
    call facts%add('least_conditioning', simulation%conditioning%least, 'least singular value of any block: 0 is singular', '1')
    call facts%add('least_conditioning_time', simulation%conditioning%t, 'when it was that', 's')
    if (associated(simulation%motion%system)) then
      work = simulation%motion%work_done()
      call facts%add('frames_placed', work%frames_placed, 'poses of frames that were found in closing chains')
      call facts%add('factorizations', work%factorizations, 'Jacobians of blocks that were factorized')
      call facts%add('links_with_inertia', size(simulation%motion%system%dynamics%bodies), &
                     'links that the coefficients of motion have terms of')
      call facts%add('acting_loads', size(simulation%motion%system%dynamics%acting) + &
                     size(simulation%motion%system%model%mechanism%motors), 'loads and motors that may move anything')
      call facts%add('frames_carried', count(simulation%motion%system%dynamics%carries(1:)), &
                     'frames whose motion a mass or a load depends on')
    end if
    call facts%add('seconds_solving', outcome%seconds_solving, 'time spent solving', 's')
    call facts%add('seconds_writing', outcome%seconds_writing, 'time spent writing', 's')
  end subroutine list_free

  !> The method in use.
  pure function method_of(simulation) result(name)
    type(free_simulation_type), intent(in) :: simulation   !< the motion, as far as it went
    character(len=len(integration_methods%name)) :: name

    name = simulation%motion%system%model%request%solver%method
    if (name == '') name = integration_methods(1)%name
  end function method_of
end module mech9_run_facts
