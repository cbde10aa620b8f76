!> The lines at the end of a driven run.
module mech9_driven_run_text
  use mech9_program_kind, only: dynamics
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_model, only: model_type
  use mech9_result_units, only: length_text
  use mech9_plan, only: plan_type
  use mech9_driven_motion, only: driven_motion_type
  use mech9_named_words, only: with_names
  use mech9_block_names, only: words_of_block
  use mech9_check_notes, only: print_run_notes
  use mech9_friction_text, only: print_rest
  use mech9_driven_simulation, only: driven_simulation_type
  use mech9_run_outcome, only: run_outcome_type
  use mech9_run_words, only: duration, each
  use mech9_run_facts, only: iterations_each
  implicit none
  private
  public :: print_driven_run

contains

  !> Print the lines.
  subroutine print_driven_run(unit, simulation, table_path, outcome)
    integer, intent(in) :: unit                               !< Fortran unit to write to
    type(driven_simulation_type), intent(in) :: simulation    !< the motion, as far as it went
    character(len=*), intent(in) :: table_path                !< path of the table; '-': standard output; empty: none
    type(run_outcome_type), intent(in) :: outcome             !< number of rows, and the times for solving and writing

    call print_motion(unit, simulation%model, simulation%plan, table_path, outcome, simulation%driven)
    if (allocated(simulation%frictions)) call print_rest(unit, simulation%model%mechanism, simulation%frictions%rest)
  end subroutine print_driven_run

  !> Print the lines about the motion.
  subroutine print_motion(unit, model, plan, table_path, outcome, driven)
    integer, intent(in) :: unit                           !< Fortran unit to write to
    type(model_type), intent(in) :: model                 !< the model
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, as it is executed
    character(len=*), intent(in) :: table_path            !< path of the table; '-': standard output; empty: none
    type(run_outcome_type), intent(in) :: outcome   !< number of rows, and the times for solving and writing
    type(driven_motion_type), intent(in) :: driven        !< the driven motion at the end of the run, with its counts
    integer :: k, calls

    write (unit, '(a)') counted(outcome%rows, 'position')//': '//duration(outcome%seconds_solving)//' to solve'// &
      each(outcome%seconds_solving, outcome%rows)//', '//duration(outcome%seconds_writing)//' to write'
    write (unit, '(a)') 'Newton iterations for each position: '//to_text(iterations_each(outcome, driven), 3)// &
      '; largest closure '//trim(length_text(model%mechanism, driven%worst_closure, 3))
    if (driven%conditioning%block > 0) write (unit, '(a)') 'least conditioning '// &
      to_text(driven%conditioning%least, 3)//' at t = '//to_text(driven%conditioning%t, 6)//' s: '// &
      with_names(model%mechanism%names, words_of_block(plan%blocks(driven%conditioning%block)%chains, &
                                                       plan%blocks(driven%conditioning%block)%coordinates))
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
    call print_run_notes(unit, model, model%program == dynamics .or. model%request%output%with_forces())
    if (table_path /= '' .and. table_path /= '-') write (unit, '(2a)') 'table: ', table_path
  end subroutine print_motion
end module mech9_driven_run_text
