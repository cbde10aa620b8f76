!> The lines at the end of a run under forces.
module mech9_free_run_text
  use mech9_result_units, only: length_text, inertia_unit_of
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_number_lists, only: same_numbers
  use mech9_part_names, only: part_names_type
  use mech9_named_words, only: with_names, named_list
  use mech9_model, only: model_type
  use mech9_check_notes, only: print_run_notes
  use mech9_model_motion, only: model_motion_type
  use mech9_run_outcome, only: run_outcome_type
  use mech9_integrator, only: integration_statistics_type
  use mech9_simulation, only: coordinate_change_type
  use mech9_event_words, only: told_events_type, tell_events
  use mech9_free_simulation, only: free_simulation_type
  use mech9_run_words, only: duration, each
  use mech9_energy_text, only: words_of_energy_change
  use mech9_run_facts, only: method_of
  implicit none
  private
  public :: print_free_run, print_coefficients

  !> Events that are printed before the last one.
  integer, parameter :: printed_events = 10

contains

  !> Print the lines.
  subroutine print_free_run(unit, simulation, table_path, outcome)
    integer, intent(in) :: unit                              !< Fortran unit to write to
    type(free_simulation_type), intent(inout) :: simulation  !< the motion, as far as it went
    character(len=*), intent(in) :: table_path               !< path of the table; '-': standard output; empty: none
    type(run_outcome_type), intent(in) :: outcome            !< number of rows, and the times for solving and writing
    type(told_events_type) :: events
    type(integration_statistics_type) :: counts
    integer :: i

    counts = simulation%motion%statistics()
    write (unit, '(a)') counted(outcome%rows, 'output')//': '//duration(outcome%seconds_solving)//' to solve, '// &
      duration(outcome%seconds_writing)//' to write'
    write (unit, '(a)') trim(method_of(simulation))//': '//counted(counts%steps, 'step')//by_bdf(counts)//', '// &
      to_text(counts%error_test_failures + counts%convergence_failures + counts%refusals)//' made again, '// &
      counted(counts%rate_evaluations, 'evaluation')//each(outcome%seconds_solving, int(counts%rate_evaluations))
    if (simulation%with_error) write (unit, '(a)') &
      'largest error '//to_text(simulation%largest_error, 2)//' ('// &
      simulation%model%mechanism%units%angle_name//', '//trim(simulation%model%mechanism%units%length_name)//'), estimated by '// &
      to_text(simulation%errors%runs)// &
      ' other runs; tolerances '//to_text(simulation%model%request%solver%relative_tolerance, 2)
    write (unit, '(a)', advance='no') 'largest closure '//trim(length_text(simulation%model%mechanism, simulation%worst_closure, 3))
    if (simulation%motion%system%model%request%output%energies) &
      write (unit, '(a)', advance='no') '; '//words_of_energy_change(simulation%model)//' '// &
        to_text(simulation%largest_energy_change/simulation%model%mechanism%units%size_of('J'), 3)//' '// &
        trim(simulation%model%mechanism%units%name_of('J'))
    write (unit, '(a)') ''
    if (simulation%conditioning%block > 0) write (unit, '(a)') 'least conditioning '// &
      to_text(simulation%conditioning%least, 3)//' at t = '//to_text(simulation%conditioning%t, 6)//' s'
    do i = 1, size(simulation%coordinate_changes)
      write (unit, '(a)') 't = '//to_text(simulation%coordinate_changes(i)%t, 8)//' s: '// &
        with_names(simulation%model%mechanism%names, &
                   change_words(simulation%coordinate_changes, simulation%model%mechanism%names, i))
    end do
    call tell_events(simulation%events, simulation%model%mechanism, events)
    call print_events(unit, events)
    call print_run_notes(unit, simulation%model, .true.)
    if (table_path /= '' .and. table_path /= '-') write (unit, '(2a)') 'table: ', table_path
  end subroutine print_free_run

  !> The steps of the implicit one of two methods.
  pure function by_bdf(counts) result(words)
    type(integration_statistics_type), intent(in) :: counts   !< of the integration
    character(len=:), allocatable :: words

    words = ''
    if (counts%method_changes > 0) &
      words = ' ('//to_text(counts%implicit_steps)//' by bdf; changes of the method: '//to_text(counts%method_changes)//')'
  end function by_bdf

  !> Print the first and the last events, and how many there are.
  subroutine print_events(unit, events)
    integer, intent(in) :: unit                       !< Fortran unit to write to
    type(told_events_type), intent(in) :: events      !< of the motion
    integer :: i

    do i = 1, events%count
      if (i > printed_events .and. i < events%count) cycle
      if (i == events%count .and. i > printed_events + 1) &
        write (unit, '(a)') counted(i - printed_events - 1, 'more event')//'; the option --report writes all of them'
      write (unit, '(a)') 't = '//to_text(events%items(i)%t, 8)//' s: '//events%sentences(i)%text
    end do
  end subroutine print_events

  !> A change of coordinates in words.
  pure function change_words(events, names, i) result(words)
    type(coordinate_change_type), intent(in) :: events(:)   !< all changes, in the order of time
    type(part_names_type), intent(in) :: names              !< of links and pairs
    integer, intent(in) :: i                                !< number of the one that is meant
    character(len=:), allocatable :: words
    integer, allocatable :: before(:)

    allocate (before(0))
    if (i > 1) before = events(i - 1)%replaced
    words = ''
    if (size(events(i)%replaced) > 0) then
      words = 'near gimbal lock, other angles are integrated in place of coordinates '//to_text(events(i)%replaced)
    else if (size(before) > 0) then
      words = 'coordinates '//to_text(before)//' are integrated themselves again'
    end if
    if (same_numbers(before, events(i)%replaced)) words = 'independent coordinates are now '// &
      named_list(names%coordinates, events(i)%independent, size(events(i)%independent))
  end function change_words

  !> Print the coefficients of motion a(p,r) at the start, p and r the numbers of the independent coordinates.
  subroutine print_coefficients(unit, model, motion)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    type(model_type), intent(in) :: model                  !< the model
    type(model_motion_type), intent(inout) :: motion       !< its free motion, prepared
    type(free_simulation_type), pointer :: simulation
    integer :: p, r

    simulation => motion%free()
    write (unit, '(a)') 'coefficients of motion (mass matrix) at the start:'
    associate (independent => motion%plan%independent)
      do p = 1, size(independent)
        do r = p, size(independent)
          write (unit, '(2x,a,es24.16)') 'a('//to_text(independent(p))//','//to_text(independent(r))//') =', &
            simulation%coefficients(r, p)/inertia_unit_of(model%mechanism, independent(p), independent(r))
        end do
      end do
    end associate
  end subroutine print_coefficients
end module mech9_free_run_text
