!> A run of a program: it opens the results, records the motion, closes the results, and reports.
module mech9_run_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_system, only: asked_to_end
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_run, only: run_type
  use mech9_periodic, only: periodic_found_type
  use mech9_row_source, only: row_source_type
  use mech9_force_record, only: reacting_pairs
  use mech9_film, only: film_type
  use mech9_json, only: json_type
  use mech9_facts, only: facts_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_result_sink, only: mark_events
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_force_layout, only: write_uniqueness
  use mech9_quantity_layout, only: write_quantities
  use mech9_structure_text, only: print_structure, print_mobility
  use mech9_held_text, only: print_held
  use mech9_parameter_text, only: print_parameter_notes
  use mech9_plan_text, only: print_plan
  use mech9_force_text, only: print_undetermined, print_forceless
  use mech9_start_way_text, only: print_start_way
  use mech9_picture_requests, only: picture_requests_type
  use mech9_results, only: results_type
  use mech9_quantity_results, only: print_quantities
  use mech9_section_results, only: check_section_plots, write_section_results, print_section
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_run_outcome, only: run_outcome_type
  use mech9_run_facts, only: list_run_facts
  use mech9_whole_report, only: compose_report
  use mech9_recording, only: record
  use mech9_run_text, only: print_run
  use mech9_row_layout, only: write_coefficients, take_changes, write_events
  implicit none
  private
  public :: carry_out

contains

  !> Carry out a run and report it.
  subroutine carry_out(options, pictures, model, run, diagnostics, reported, kept, periodic)
    type(command_line_type), intent(in) :: options                    !< the command line
    type(picture_requests_type), intent(in) :: pictures               !< the pictures of the mechanism that are requested
    type(model_type), intent(inout), target :: model                  !< of the simulation; gets the tolerances for an accuracy
    type(run_type), intent(inout), target :: run                      !< prepared
    type(diagnostics_type), intent(inout) :: diagnostics              !< gets the errors
    logical, intent(out) :: reported                                  !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept             !< gets the rows as well, for a look at them after the run
    type(periodic_found_type), intent(in), optional :: periodic       !< periodic motions, of which the run records one, for the report
    type(results_type), target :: results
    type(facts_type) :: facts
    type(json_type) :: json
    type(hdf5_sink_type), pointer :: hdf5
    type(run_outcome_type) :: outcome
    type(error_type), allocatable :: err
    logical :: ready

    associate (motion => run%motion, source => run%source)
      call source%forces%judge(model, motion%plan, motion%start)
      reported = .false.
      call source%begin_section(err)
      if (.not. allocated(err)) call check_section_plots(options, model, source%section, err)
      if (allocated(err)) call diagnostics%add_error(err)
      if (allocated(err)) return
      if (pictures%any_wanted()) call run%record_film(model)
      call begin_run(options, model, run, results, diagnostics, ready)
      if (.not. options%has('quiet')) call print_start_way(error_unit, model%mechanism, motion%way)
      reported = ready .and. options%has('report')
      if (.not. ready) return
      call find_tolerances(options, pictures, model, motion, err)
      call list_run_facts(motion, outcome, facts)
      call results%write_facts(facts)
      hdf5 => results%hdf5()
      if (associated(hdf5) .and. motion%is_free()) call write_start(hdf5, motion, motion%free())
      if (.not. allocated(err)) call record(source, model, results, options%has('quiet'), outcome, err, kept)
      if (.not. options%has('quiet')) call print_run(error_unit, motion, results%table_path, outcome)
      if (allocated(err)) call diagnostics%add_error(err)
      call list_run_facts(motion, outcome, facts)
      call results%write_facts(facts, diagnostics%code())
      if (associated(hdf5) .and. motion%is_free()) call write_end(hdf5, motion%free())
      call mark_events(results%sinks, motion%simulation%events, model%mechanism)
      if (present(kept)) call kept%take_events(motion%simulation%events, model%mechanism)
      call end_run(options, pictures, model, source, results, diagnostics)
      if (.not. reported) return
      call compose_report(json, model, diagnostics, results%table_path, facts, run, periodic)
      call json%save(options%argument('report'), err)
      if (allocated(err)) call diagnostics%add_error(err)
    end associate
  end subroutine carry_out

  !> Write the coefficients of a free motion as data sets, and make data sets for changes of coordinates.
  subroutine write_start(hdf5, motion, simulation)
    type(hdf5_sink_type), intent(inout) :: hdf5               !< the open file of results
    type(model_motion_type), intent(in) :: motion             !< the motion, prepared
    type(free_simulation_type), intent(in) :: simulation      !< its simulation

    call write_coefficients(hdf5%file, motion%plan, simulation)
    call hdf5%begin_changes(size(motion%plan%independent))
  end subroutine write_start

  !> Write the changes of the independent coordinates and the events as data sets.
  subroutine write_end(hdf5, simulation)
    type(hdf5_sink_type), intent(inout) :: hdf5               !< the open file of results
    type(free_simulation_type), intent(in) :: simulation      !< the free motion, as far as it went
    real(wp), allocatable :: rows(:, :)

    call take_changes(simulation, rows)
    call hdf5%write_changes(rows)
    call write_events(hdf5%file, simulation)
  end subroutine write_end

  !> Find the tolerances for an accuracy, where one is asked for, and tell where the runs are that this needs.
  subroutine find_tolerances(options, pictures, model, motion, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(picture_requests_type), intent(in) :: pictures     !< the pictures of the mechanism that are requested
    type(model_type), intent(inout) :: model                !< of the simulation; gets the tolerances
    type(model_motion_type), intent(inout) :: motion        !< prepared
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(signal_interruption_type), target :: interruption

    if (.not. motion%simulation%with_error) return
    call interruption%words%start(model%program, 'no row yet', 'a run that tells the accuracy', options%has('quiet'), &
                                  with_progress=.true.)
    call motion%find_tolerances(model, err, pictures%any_wanted(), interruption)
    call interruption%words%finish()
  end subroutine find_tolerances

  !> Print the title of the run and open its results. `ready` is false after an error.
  subroutine begin_run(options, model, run, results, diagnostics, ready)
    type(command_line_type), intent(in) :: options         !< the command line
    type(model_type), intent(in) :: model              !< the model
    type(run_type), intent(in) :: run                      !< prepared
    type(results_type), intent(out), target :: results     !< opened
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    logical, intent(out) :: ready                          !< the run can begin
    type(error_type), allocatable :: err
    type(hdf5_sink_type), pointer :: hdf5

    ready = .false.
    call announce(options, model, run%motion)
    if (model%request%output%with_forces() .and. .not. options%has('quiet')) call print_forceless(error_unit, model%mechanism)
    associate (source => run%source)
      call results%open(options, model, diagnostics%sources(1)%text, source%columns, err)
      ready = .not. allocated(err)
      if (.not. ready) call diagnostics%add_error(err)
      hdf5 => results%hdf5()
      if (.not. (ready .and. associated(hdf5))) return
      call write_uniqueness(hdf5%file, source%columns, source%forces)
      if (.not. source%quantities%is_empty()) call write_quantities(source%quantities, hdf5%file, again=.false.)
    end associate
  end subroutine begin_run

  !> Close the results of a run, draw the mechanism, and print which files were written.
  subroutine end_run(options, pictures, model, source, results, diagnostics)
    type(command_line_type), intent(in) :: options         !< the command line
    type(picture_requests_type), intent(in) :: pictures    !< the pictures of the mechanism that are requested
    type(model_type), intent(in) :: model              !< the model
    type(row_source_type), intent(in) :: source            !< of the rows that were written
    type(results_type), intent(inout), target :: results   !< closed on return
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    type(error_type), allocatable :: err
    type(hdf5_sink_type), pointer :: hdf5

    hdf5 => results%hdf5()
    if (associated(hdf5) .and. .not. source%quantities%is_empty()) &
      call write_quantities(source%quantities, hdf5%file, again=.true.)
    if (allocated(source%section)) then
      call write_section_results(options, model, source%section, results%table_path, hdf5, err)
      if (allocated(err)) call diagnostics%add_error(err)
      if (.not. options%has('quiet')) &
        call print_section(error_unit, source%section, .not. options%has('no-write'), model%mechanism%names)
    end if
    call results%close(err)
    if (allocated(err)) call diagnostics%add_error(err)
    if (.not. options%has('quiet')) call print_quantities(error_unit, source%quantities)
    call results%print_words(error_unit, options%has('quiet'))
    if (allocated(source%forces%unique) .and. .not. options%has('quiet')) &
      call print_undetermined(error_unit, reacting_pairs(model), source%forces%unique, &
                              model%request%output%reactions_in_links)
    ! an interrupted program makes no pictures, which would take too long
    if (asked_to_end()) return
    if (allocated(source%film)) call draw(options, pictures, model, source%film, diagnostics)
  end subroutine end_run

  !> Print the title, and with --verbose the structure and the plan.
  subroutine announce(options, model, motion)
    type(command_line_type), intent(in) :: options   !< the command line
    type(model_type), intent(in) :: model        !< the model
    type(model_motion_type), intent(in) :: motion    !< prepared

    if (.not. options%has('quiet') .and. model%mechanism%title /= '') write (error_unit, '(a)') model%mechanism%title
    if (.not. options%has('quiet')) call print_held(error_unit, model)
    if (.not. options%has('quiet')) call print_parameter_notes(error_unit, model)
    if (.not. options%has('verbose')) return
    call print_structure(error_unit, model%mechanism%structure, model%problem%partition%vectors)
    call print_mobility(error_unit, model%mechanism, motion%plan)
    call print_plan(error_unit, model%mechanism, motion%plan, motion%simulation%requested)
  end subroutine announce

  !> Draw the requested pictures of the mechanism, and print a line about each.
  subroutine draw(options, pictures, model, film, diagnostics)
    type(command_line_type), intent(in) :: options         !< the command line
    type(picture_requests_type), intent(in) :: pictures    !< the pictures of the mechanism that are requested
    type(model_type), intent(in) :: model              !< the model
    type(film_type), intent(in) :: film                    !< poses and columns at some outputs
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    type(error_type), allocatable :: err

    call pictures%save(model, film, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else if (.not. options%has('quiet')) then
      call pictures%print_words(error_unit)
    end if
  end subroutine draw
end module mech9_run_task
