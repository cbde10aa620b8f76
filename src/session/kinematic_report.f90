!> The report of a driven motion at the end of a run: a few lines for a person, JSON for a program.
module mech9_kinematic_report
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_json, only: json_type
  use mech9_facts, only: facts_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_block_solver, only: work_count_type, work_of
  use mech9_driven_motion, only: driven_motion_type
  use mech9_block_names, only: words_of_block
  use mech9_law_notes, only: print_jumps
  use mech9_recording, only: recording_outcome_type
  use mech9_force_record, only: reacting_pairs
  use mech9_uniqueness, only: uniqueness_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_quantity_results, only: report_quantities
  use mech9_run_words, only: duration, each, begin_report, add_structure, add_uniqueness
  implicit none
  private
  public :: print_kinematic_report, save_kinematic_report, kinematic_facts

contains

  !> The short report of a run.
  subroutine print_kinematic_report(unit, model, plan, table_path, outcome, driven)
    integer, intent(in) :: unit                           !< the output unit
    type(model_type), intent(in) :: model             !< the model
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    character(len=*), intent(in) :: table_path            !< path of the table; '-': standard output; empty: none
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts
    integer :: k, calls

    write (unit, '(a)') counted(outcome%rows, 'position')//': '//duration(outcome%seconds_solving)//' to solve'// &
      each(outcome%seconds_solving, outcome%rows)//', '//duration(outcome%seconds_writing)//' to write'
    write (unit, '(a)') 'Newton iterations for each position: '//to_text(iterations_each(outcome, driven), 3)// &
      '; largest closure '//to_text(driven%worst_closure, 3)//' m'
    if (driven%conditioning%block > 0) write (unit, '(a)') 'least conditioning '// &
      to_text(driven%conditioning%least, 3)//' at t = '//to_text(driven%conditioning%t, 6)//' s: '// &
      words_of_block(plan%blocks(driven%conditioning%block)%chains, plan%blocks(driven%conditioning%block)%coordinates)
    if (driven%crossings > 0) write (unit, '(a)') 'special positions passed: '//to_text(driven%crossings)// &
      ', each on the branch with continuous velocities'
    if (driven%steps >= outcome%rows) write (unit, '(a)') counted(driven%steps, 'step')//' to keep to the branch, and '// &
      to_text(driven%halvings)//' more that '//trim(merge('was ', 'were', driven%halvings == 1))//' too long'
    calls = 0
    do k = 1, size(model%mechanism%pairs)
      if (model%mechanism%pairs(k)%pair%user_calls() > 1) calls = calls + model%mechanism%pairs(k)%pair%user_calls()
    end do
    if (calls > 0) write (unit, '(a)') 'user pairs in plain values: '//to_text(calls)// &
      ' calls or more for each evaluation; in Taylor arithmetic it would be one a pair'
    call print_jumps(unit, model)
    if (table_path /= '' .and. table_path /= '-') write (unit, '(2a)') 'table: ', table_path
  end subroutine print_kinematic_report

  pure real(wp) function iterations_each(outcome, driven)
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts

    iterations_each = real(driven%iterations, wp)/max(1, outcome%rows)
  end function iterations_each

  !> The facts about a run, for reports that programs read.
  subroutine kinematic_facts(plan, outcome, driven, facts)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts
    type(facts_type), intent(out) :: facts                !< named numbers and texts about the run
    type(work_count_type) :: work

    call facts%add('positions', outcome%rows, 'positions computed')
    call facts%add('steps', driven%steps, 'steps of following the drives')
    call facts%add('halvings', driven%halvings, 'steps that were too long')
    call facts%add('newton_iterations', driven%iterations, 'Newton iterations')
    call facts%add('newton_iterations_per_position', iterations_each(outcome, driven), 'Newton iterations a position', '1')
    call facts%add('largest_closure', driven%worst_closure, 'largest error of a closed chain', 'm')
    call facts%add('size', plan%length, 'size of the mechanism, which weighs lengths against angles', 'm')
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
  end subroutine kinematic_facts

  !> Write the report as JSON, with the structure.
  subroutine save_kinematic_report(path, model, plan, table_path, diagnostics, outcome, driven, err, &
                                   unique, quantities)
    character(len=*), intent(in) :: path                  !< of the report
    type(model_type), intent(in) :: model             !< the model
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    character(len=*), intent(in) :: table_path            !< path of the table; '-': standard output; empty: none
    type(diagnostics_type), intent(in) :: diagnostics     !< messages and exit code of the run
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts
    type(uniqueness_type), allocatable, intent(in) :: unique   !< of forces; not allocated: none are recorded
    type(quantity_record_type), intent(in) :: quantities   !< of the run
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(json_type) :: json
    type(facts_type) :: facts

    call begin_report(json, model, diagnostics, table_path)
    call kinematic_facts(plan, outcome, driven, facts)
    call facts%to_json(json)
    call report_quantities(quantities, json)
    if (allocated(unique)) call add_uniqueness(json, reacting_pairs(model), unique)
    call add_structure(json, model, plan)
    call json%end_object()
    call json%save(path, err)
  end subroutine save_kinematic_report
end module mech9_kinematic_report
