!> The report of a driven motion.
module mech9_kinematic_report
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_facts, only: facts_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_block_solver, only: work_count_type, work_of
  use mech9_driven_motion, only: driven_motion_type
  use mech9_block_names, only: words_of_block
  use mech9_law_notes, only: print_jumps
  use mech9_driven_simulation, only: driven_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_recording, only: recording_outcome_type
  use mech9_run_words, only: duration, each
  use mech9_run_report, only: run_report_type
  implicit none
  private
  public :: kinematic_report_type

  type, extends(run_report_type) :: kinematic_report_type
  contains
    procedure, nopass :: print => print_report
    procedure, nopass :: find_facts
  end type kinematic_report_type

contains

  !> Print the short report of a run.
  subroutine print_report(unit, motion, table_path, outcome)
    integer, intent(in) :: unit                           !< Fortran unit to write to
    type(model_motion_type), intent(inout) :: motion      !< the motion, as far as it went
    character(len=*), intent(in) :: table_path            !< path of the table; '-': standard output; empty: none
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_simulation_type), pointer :: simulation

    simulation => motion%driven()
    call print_motion(unit, simulation%model, simulation%plan, table_path, outcome, simulation%driven)
  end subroutine print_report

  !> Print the lines.
  subroutine print_motion(unit, model, plan, table_path, outcome, driven)
    integer, intent(in) :: unit                           !< Fortran unit to write to
    type(model_type), intent(in) :: model                 !< the model
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, as it is executed
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
  end subroutine print_motion

  pure real(wp) function iterations_each(outcome, driven)
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts

    iterations_each = real(driven%iterations, wp)/max(1, outcome%rows)
  end function iterations_each

  !> List the facts about a run, for reports that programs read.
  subroutine find_facts(motion, outcome, facts)
    type(model_motion_type), intent(inout) :: motion      !< the motion, as far as it went
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(facts_type), intent(out) :: facts                !< named numbers and texts about the run
    type(driven_simulation_type), pointer :: simulation

    simulation => motion%driven()
    call facts_of(simulation%plan, outcome, simulation%driven, facts)
  end subroutine find_facts

  !> List the facts about a driven motion.
  subroutine facts_of(plan, outcome, driven, facts)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(recording_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts
    type(facts_type), intent(inout) :: facts              !< named numbers and texts about the run
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
  end subroutine facts_of
end module mech9_kinematic_report
