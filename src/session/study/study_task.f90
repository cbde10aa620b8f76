!> The work on a study: opening its files, making its runs, and telling how they went.
module mech9_study_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_interrupted
  use mech9_text, only: to_text
  use mech9_clock, only: seconds
  use mech9_system, only: asked_to_end
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_document, only: document_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_written_files, only: result_paths_type, find_result_paths
  use mech9_quantity_record, only: quantity_record_type
  use mech9_study_check, only: check_study
  use mech9_study_runs, only: study_runs_type
  use mech9_study_results, only: study_results_type
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_study_columns, only: refuse_varied_times
  use mech9_study_plots, only: study_plots_type
  use mech9_processes, only: processes_type
  use mech9_study_threads, only: threads_of_machine, threads_for, has_threads
  use mech9_study_propagation, only: propagation_type, propagate
  use mech9_section_results, only: check_section_plots, write_section_files, print_section
  use mech9_study_words, only: print_study
  use mech9_json, only: json_type
  use mech9_report_parts, only: begin_report
  use mech9_study_report, only: add_study
  implicit none
  private
  public :: work_on_study

  !> Most threads that a user may ask for; the system refuses more of them in ways that a program cannot tell.
  integer, parameter :: most_threads = 1024
  !> How many runs for each thread may be made before one that takes long is written.
  integer, parameter :: runs_ahead = 64

contains

  !> Carry out the study that a data file describes.
  subroutine work_on_study(options, document, varied, model, diagnostics, reported, processes)
    type(command_line_type), intent(in) :: options          !< the command line
    type(document_type), intent(in) :: document             !< the data file as groups and items, with the changes by --set
    class(variable_model_type), intent(inout) :: varied     !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< a report was asked for, and it is written
    type(processes_type), intent(inout) :: processes  !< those that make the runs together
    type(quantity_record_type) :: quantities
    type(study_results_type), target :: results
    type(study_plots_type) :: plots
    type(signal_interruption_type) :: interruption
    type(model_type), allocatable :: used
    type(error_type), allocatable :: err

    reported = .false.
    used = model
    call judge(options, used, quantities, err)
    if (.not. allocated(err) .and. processes%count > 1) call refuse_processes(model, err)
    call processes%agree(err)
    if (.not. (processes%is_first .or. allocated(err))) then
      call processes%agree(err)
      call interruption%words%start(model%program, 'no result', 'it', options%has('quiet'), with_progress=.false.)
      if (.not. allocated(err)) call processes%follow(used, varied, interruption)
      reported = .true.
      return
    end if
    if (.not. allocated(err)) then
      call open_files(options, document, used, quantities, results, plots, err)
      call processes%agree(err)
    end if
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else
      call carry_out(options, varied, used, quantities, results, plots, diagnostics, reported, processes)
    end if
  end subroutine work_on_study

  !> Open the files of a study, and read the requests for its plots.
  subroutine open_files(options, document, model, quantities, results, plots, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(document_type), intent(in) :: document             !< the data file as groups and items, with the changes by --set
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(quantity_record_type), intent(in) :: quantities    !< with their columns
    type(study_results_type), intent(inout) :: results      !< gets the open files
    type(study_plots_type), intent(inout) :: plots          !< gets the requests
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(result_paths_type) :: paths

    call find_result_paths(options, model%request%output, paths)
    call plots%open(options, model, quantities, paths%table, err)
    if (allocated(err)) return
    if (.not. options%has('quiet')) call print_notes(options, model)
    call results%open(options, document, model, quantities, err)
    if (.not. allocated(err)) call check_section_plots(options, model, results%section, err)
  end subroutine open_files

  !> Report a study that cannot be carried out, and find the columns of its quantities. Runs keep their columns only where a file
  !> gets them.
  subroutine judge(options, model, quantities, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(inout) :: model                !< the model with the values of the data file
    type(quantity_record_type), intent(out) :: quantities   !< with their columns
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(result_paths_type) :: paths

    call find_result_paths(options, model%request%output, paths)
    if (paths%hdf5 == '') model%request%output%hdf5_runs = .false.
    if (options%number('threads', 1) > most_threads) &
      call raise(err, exit_usage, '--threads takes at most '//to_text(most_threads))
    if (.not. allocated(err)) call check_study(model, quantities, err)
    if (.not. allocated(err) .and. model%request%output%hdf5_runs) call refuse_varied_times(model, err)
    if (.not. allocated(err)) call refuse_parts(options, model, err)
  end subroutine judge

  !> Refuse several processes for a study whose runs follow each other, or whose points they would not give back.
  subroutine refuse_processes(model, err)
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it is refused

    if (.not. (model%request%study%carries() .or. model%request%study%classes .or. model%request%section%is_wanted)) return
    call raise(err, exit_usage, 'several processes make no study with classes, a section, or states that are carried on; make '// &
               'it in one, which has threads')
  end subroutine refuse_processes

  !> Refuse a part of a study whose runs follow each other, and to continue one whose points no file keeps.
  subroutine refuse_parts(options, model, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it is refused

    if (model%request%study%classes .and. (options%has('part') .or. options%has('continue'))) then
      call raise(err, exit_usage, 'a study with classes numbers them in all its runs, which one program makes: leave out --'// &
                 trim(merge('part    ', 'continue', options%has('part'))))
    else if (model%request%study%carries() .and. (options%has('part') .or. options%has('continue'))) then
      call raise(err, exit_usage, 'a study that carries states on makes all its runs, one after the other: leave out --'// &
                 trim(merge('part    ', 'continue', options%has('part'))))
    else if (model%request%section%is_wanted .and. options%has('continue')) then
      call raise(err, exit_usage, '--continue has no points of the section for the runs that were made before; make the study '// &
                 'anew, or leave out &section')
    end if
  end subroutine refuse_parts

  !> How many threads make the runs.
  integer function threads_of_study(options, model) result(threads)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model with the values of the data file

    threads = options%number('threads', threads_for(model))
    if (model%request%study%carries()) threads = 1
    if (.not. has_threads()) threads = 1
    threads = max(1, min(threads, most_threads, model%request%study%runs))
  end function threads_of_study

  !> Note what the user may expect of the study but does not get.
  subroutine print_notes(options, model)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    integer :: part(2), cores

    part = options%part()
    if (model%request%output%compression > 0) &
      write (error_unit, '(a)') 'note: the HDF5 file of a study is not compressed'
    if (part(1) > model%request%study%runs) &
      write (error_unit, '(a)') 'note: this part has no runs: the study has '//to_text(model%request%study%runs)
    if (options%number('threads', 1) > 1 .and. .not. has_threads()) &
      write (error_unit, '(a)') 'note: this program was built without threads; one core makes the runs'
    cores = threads_of_machine()
    if (cores > 1 .and. threads_for(model) == 1 .and. .not. options%has('threads')) &
      write (error_unit, '(a)') 'note: one thread makes the runs, because procedures of a user may not bear several at a time; '// &
                                '--threads N asks for more'
  end subroutine print_notes

  !> Make the runs, close the files, and tell how the study went. Where every run failed, the first failure is that of the study.
  subroutine carry_out(options, varied, model, quantities, results, plots, diagnostics, reported, processes)
    type(command_line_type), intent(in) :: options          !< the command line
    class(variable_model_type), intent(inout) :: varied     !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(quantity_record_type), intent(in) :: quantities    !< with their columns
    type(study_results_type), intent(inout), target :: results   !< open, and closed on return
    type(study_plots_type), intent(inout) :: plots          !< the plots that are requested
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(inout) :: reported                      !< the report is written
    type(processes_type), intent(in) :: processes     !< those that make the runs together
    type(study_runs_type) :: runs
    type(propagation_type), allocatable :: propagation(:)
    type(signal_interruption_type), target :: interruption
    type(json_type) :: json
    type(error_type), allocatable :: err, without_shares, of_section
    real(wp) :: clock
    integer :: threads
    logical :: quiet, kept

    quiet = options%has('quiet')
    clock = seconds()
    threads = threads_of_study(options, model)
    call interruption%words%start(model%program, 'no result', 'it', quiet, with_progress=.false.)
    call runs%begin(model, results, runs_ahead*max(threads, processes%count), options%has('plot'), interruption)
    call processes%lead(model, varied, threads, interruption, runs)
    call runs%finish(err)
    kept = .true.
    if (allocated(err)) kept = err%code == exit_interrupted
    clock = seconds() - clock
    allocate (propagation(0))
    if (.not. (allocated(err) .or. model%request%study%classes .or. model%request%study%exponents > 0) .and. &
        runs%statistics%drawn .and. runs%sums%done > 0 .and. .not. (quiet .and. .not. options%has('report'))) then
      call interruption%words%start(model%program, 'no derivatives at the means yet', 'their run', quiet, with_progress=.false.)
      call propagate(model, varied, interruption, propagation, without_shares)
    end if
    if (.not. quiet) call print_study(error_unit, model, quantities, runs, propagation, clock)
    if (.not. quiet .and. allocated(without_shares)) &
      write (error_unit, '(a)') 'note: no shares by derivatives: '//without_shares%message
    if (.not. quiet .and. kept) call results%print_paths(error_unit)
    if (allocated(results%section)) then
      call write_section_files(options, model, results%section, results%paths%table, of_section)
      if (allocated(of_section)) call diagnostics%add_error(of_section)
      if (.not. quiet) &
        call print_section(error_unit, results%section, .not. options%has('no-write'), model%mechanism%names)
    end if
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else if (allocated(runs%first_failure) .and. runs%sums%done == 0) then
      call diagnostics%add_error(runs%first_failure)
    else if (allocated(runs%first_failure) .and. .not. quiet) then
      call print_failure(runs%first_failure, diagnostics)
    end if
    ! an interrupted program makes no pictures, which would take too long
    if (.not. asked_to_end()) then
      call plots%draw(runs%statistics, error_unit, quiet, err)
      if (allocated(err)) call diagnostics%add_error(err)
    end if
    if (.not. options%has('report')) return
    call begin_report(json, model, diagnostics, results%paths%table)
    call add_study(json, model, quantities, runs, propagation)
    call json%end_object()
    call json%save(options%argument('report'), err)
    reported = .true.
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine carry_out

  !> Print the message of a failed run, with its place in the data file.
  subroutine print_failure(failure, diagnostics)
    type(error_type), intent(in) :: failure               !< of the run
    type(diagnostics_type), intent(in) :: diagnostics     !< of the program, which knows the data file
    type(diagnostics_type) :: own

    own%sources = diagnostics%sources
    call own%add_error(failure)
    call own%report(error_unit)
  end subroutine print_failure
end module mech9_study_task
