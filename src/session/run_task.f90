!> A run of a program: it opens the results, records the motion, closes the results, and reports.
module mech9_run_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_error, only: error_type
  use mech9_system, only: asked_to_end
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_facts, only: facts_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_result_sink, only: mark_events
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_structure_text, only: print_structure, print_mobility
  use mech9_held_text, only: print_held
  use mech9_parameter_text, only: print_parameter_notes
  use mech9_plan_text, only: print_plan
  use mech9_force_text, only: print_undetermined, print_forceless
  use mech9_start_way_text, only: print_start_way
  use mech9_picture_requests, only: picture_requests_type
  use mech9_results, only: results_type
  use mech9_quantity_words, only: print_quantities
  use mech9_section_results, only: check_section_plots, write_section_files
  use mech9_section_words, only: print_section
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_run_record, only: begin_run_record, begin_free_record, end_free_record, end_run_record, list_facts
  use mech9_answer_report, only: save_run_report
  use mech9_recording, only: record
  use mech9_run_text, only: print_run
  implicit none
  private
  public :: carry_out

contains

  !> Carry out the run of a data file, which is prepared, and report it.
  subroutine carry_out(options, pictures, given, reported, kept)
    type(command_line_type), intent(in) :: options                    !< the command line
    type(picture_requests_type), intent(in) :: pictures               !< the pictures of the mechanism that are requested
    type(data_file_type), intent(inout), target :: given              !< the data file; it gets the errors
    logical, intent(out) :: reported                                  !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept             !< gets the rows as well, for a look at them after the run
    type(results_type), target :: results
    type(facts_type) :: facts
    type(hdf5_sink_type), pointer :: hdf5
    type(error_type), allocatable :: err
    logical :: ready

    call given%run%source%forces%judge(given%model, given%run%motion%plan, given%run%motion%start)
    reported = .false.
    call given%run%source%begin_section(err)
    if (.not. allocated(err)) then
      if (allocated(given%run%source%section)) then
        call check_section_plots(options, given, err, given%run%source%section%names)
      else
        call check_section_plots(options, given, err)
      end if
    end if
    call given%fail(err)
    if (allocated(err)) return
    if (pictures%any_wanted()) call given%run%record_film(given%model)
    call begin_run(options, given, results, ready)
    if (.not. options%has('quiet')) call print_start_way(error_unit, given%model%mechanism, given%run%motion%way)
    reported = ready .and. options%has('report')
    if (.not. ready) return
    call find_tolerances(options, pictures, given, err)
    call list_facts(given, facts)
    call results%write_facts(facts)
    hdf5 => results%hdf5()
    if (associated(hdf5)) call begin_free_record(hdf5, given)
    if (.not. allocated(err)) call record(given, results, options%has('quiet'), err, kept)
    if (.not. options%has('quiet')) call print_run(error_unit, given%run%motion, results%table_path, given%outcome)
    call given%fail(err)
    call list_facts(given, facts)
    call results%write_facts(facts, given%diagnostics%code())
    if (associated(hdf5)) call end_free_record(hdf5, given)
    associate (events => given%run%motion%simulation%events)
      call mark_events(results%sinks, events, given%model%mechanism)
      if (present(kept)) call kept%take_events(events, given%model%mechanism)
    end associate
    call end_run(options, pictures, given, results)
    if (.not. reported) return
    call save_run_report(options%argument('report'), given, results%table_path, facts, err)
    call given%fail(err)
  end subroutine carry_out

  !> Find the tolerances for an accuracy, where one is asked for, and tell where the runs are that this needs.
  subroutine find_tolerances(options, pictures, given, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(picture_requests_type), intent(in) :: pictures     !< the pictures of the mechanism that are requested
    type(data_file_type), intent(inout) :: given            !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(signal_interruption_type), target :: interruption

    if (.not. given%run%motion%simulation%with_error) return
    call interruption%words%start(given%model%program, 'no row yet', 'a run that tells the accuracy', options%has('quiet'), &
                                  with_progress=.true.)
    call given%run%motion%find_tolerances(given%model, err, pictures%any_wanted(), interruption)
    call interruption%words%finish()
  end subroutine find_tolerances

  !> Print the title of the run and open its results. `ready` is false after an error.
  subroutine begin_run(options, given, results, ready)
    type(command_line_type), intent(in) :: options         !< the command line
    type(data_file_type), intent(inout) :: given           !< the data file; it gets the errors
    type(results_type), intent(out), target :: results     !< opened
    logical, intent(out) :: ready                          !< the run can begin
    type(error_type), allocatable :: err
    type(hdf5_sink_type), pointer :: hdf5

    ready = .false.
    call announce(options, given)
    if (given%model%request%output%with_forces() .and. .not. options%has('quiet')) &
      call print_forceless(error_unit, given%model%mechanism)
    call results%open(options, given, err)
    ready = .not. allocated(err)
    if (.not. ready) call given%fail(err)
    hdf5 => results%hdf5()
    if (ready .and. associated(hdf5)) call begin_run_record(hdf5, given)
  end subroutine begin_run

  !> Close the results of a run, draw the mechanism, and print which files were written.
  subroutine end_run(options, pictures, given, results)
    type(command_line_type), intent(in) :: options         !< the command line
    type(picture_requests_type), intent(in) :: pictures    !< the pictures of the mechanism that are requested
    type(data_file_type), intent(inout) :: given           !< the data file; it gets the errors
    type(results_type), intent(inout), target :: results   !< closed on return
    type(error_type), allocatable :: err
    type(hdf5_sink_type), pointer :: hdf5

    hdf5 => results%hdf5()
    if (associated(hdf5)) call end_run_record(hdf5, given)
    if (allocated(given%run%source%section)) then
      associate (section => given%run%source%section)
        call write_section_files(options, given, section%names, section%units, section%points(:, :section%count), &
                                 results%table_path, err)
      end associate
    end if
    call given%fail(err)
    associate (source => given%run%source)
      if (allocated(source%section) .and. .not. options%has('quiet')) &
        call print_section(error_unit, source%section, .not. options%has('no-write'), given%model%mechanism%names)
      call results%close(err)
      call given%fail(err)
      if (.not. options%has('quiet')) call print_quantities(error_unit, source%quantities)
      call results%print_words(error_unit, options%has('quiet'))
      if (allocated(source%forces%unique) .and. .not. options%has('quiet')) &
        call print_undetermined(error_unit, given%reacting_pairs(), source%forces%unique, &
                                given%model%request%output%reactions_in_links)
    end associate
    ! an interrupted program makes no pictures, which would take too long
    if (asked_to_end()) return
    if (allocated(given%run%source%film)) call draw(options, pictures, given)
  end subroutine end_run

  !> Print the title, and with --verbose the structure and the plan.
  subroutine announce(options, given)
    type(command_line_type), intent(in) :: options   !< the command line
    type(data_file_type), intent(in) :: given        !< the data file

    if (.not. options%has('quiet') .and. given%model%mechanism%title /= '') write (error_unit, '(a)') given%model%mechanism%title
    if (.not. options%has('quiet')) call print_held(error_unit, given%model)
    if (.not. options%has('quiet')) call print_parameter_notes(error_unit, given%model)
    if (.not. options%has('verbose')) return
    call print_structure(error_unit, given%model%mechanism%structure, given%model%problem%partition%vectors)
    associate (motion => given%run%motion)
      call print_mobility(error_unit, given%model%mechanism, motion%plan)
      call print_plan(error_unit, given%model%mechanism, motion%plan, motion%simulation%requested)
    end associate
  end subroutine announce

  !> Draw the requested pictures of the mechanism, and print a line about each.
  subroutine draw(options, pictures, given)
    type(command_line_type), intent(in) :: options         !< the command line
    type(picture_requests_type), intent(in) :: pictures    !< the pictures of the mechanism that are requested
    type(data_file_type), intent(inout) :: given           !< the data file; it gets the errors
    type(error_type), allocatable :: err

    call pictures%save(given%model, given%run%source%film, err)
    if (allocated(err)) then
      call given%fail(err)
    else if (.not. options%has('quiet')) then
      call pictures%print_words(error_unit)
    end if
  end subroutine draw
end module mech9_run_task
