!> The work on a study: opening its files, making its runs, and telling how they went.
module mech9_study_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_interrupted
  use mech9_text, only: to_text
  use mech9_clock, only: seconds
  use mech9_system, only: asked_to_end
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_written_files, only: result_paths_type, find_result_paths, find_kept_files, standard_output_path
  use mech9_kept_files, only: kept_files_type
  use mech9_kept_study, only: kept_study_type, processes_type, threads_of_machine, threads_for, has_threads
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_study_columns, only: refuse_varied_times
  use mech9_study_plots, only: study_plots_type
  use mech9_section_results, only: check_section_plots, write_section_files
  use mech9_section_words, only: print_section
  use mech9_study_words, only: print_study
  implicit none
  private
  public :: work_on_study

  !> Most threads that a user may ask for; the system refuses more of them in ways that a program cannot tell.
  integer, parameter :: most_threads = 1024

contains

  !> Carry out the study that a data file describes.
  subroutine work_on_study(options, given, reported, processes)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout), target :: given    !< the data file; it gets the errors
    logical, intent(out) :: reported                        !< a report was asked for, and it is written
    type(processes_type), intent(inout) :: processes  !< those that make the runs together
    type(kept_study_type), target :: study
    type(study_plots_type) :: plots
    type(signal_interruption_type) :: interruption
    type(error_type), allocatable :: err

    reported = .false.
    call judge(options, given, err)
    if (.not. allocated(err) .and. processes%count > 1) call refuse_processes(given, err)
    call processes%agree(err)
    if (.not. (processes%is_first .or. allocated(err))) then
      call processes%agree(err)
      call interruption%words%start(given%model%program, 'no result', 'it', options%has('quiet'), with_progress=.false.)
      if (.not. allocated(err)) call processes%follow(given%model, given%variable, interruption)
      reported = .true.
      return
    end if
    if (.not. allocated(err)) then
      call open_files(options, given, study, plots, err)
      call processes%agree(err)
    end if
    if (allocated(err)) then
      call given%fail(err)
    else
      call carry_out(options, given, study, plots, reported, processes)
    end if
  end subroutine work_on_study

  !> Open the files of a study, and read the requests for its plots.
  subroutine open_files(options, given, study, plots, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(kept_study_type), intent(inout) :: study           !< gets the open files
    type(study_plots_type), intent(inout) :: plots          !< gets the requests
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(kept_files_type) :: wanted

    call find_kept_files(options, given, wanted)
    call plots%open(options, given, wanted%table, err)
    if (allocated(err)) return
    if (.not. options%has('quiet')) call print_notes(options, given)
    call study%results%open(wanted, given, err)
    if (allocated(err)) return
    if (allocated(study%results%section)) then
      call check_section_plots(options, given, err, study%results%section%names)
    else
      call check_section_plots(options, given, err)
    end if
  end subroutine open_files

  !> Report a study that cannot be carried out, and find the columns of its quantities. Runs keep their columns only where a file
  !> gets them.
  subroutine judge(options, given, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout) :: given            !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(result_paths_type) :: paths

    call find_result_paths(options, paths, given)
    if (paths%hdf5 == '') given%model%request%output%hdf5_runs = .false.
    if (options%number('threads', 1) > most_threads) &
      call raise(err, exit_usage, '--threads takes at most '//to_text(most_threads))
    if (.not. allocated(err)) call given%judge_study(err)
    if (.not. allocated(err) .and. given%model%request%output%hdf5_runs) call refuse_varied_times(given, err)
    if (.not. allocated(err)) call refuse_parts(options, given, err)
  end subroutine judge

  !> Refuse several processes for a study whose runs follow each other, or whose points they would not give back.
  subroutine refuse_processes(given, err)
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it is refused

    associate (request => given%model%request)
      if (.not. (request%study%carries() .or. request%study%classes .or. request%section%is_wanted)) return
    end associate
    call raise(err, exit_usage, 'several processes make no study with classes, a section, or states that are carried on; make '// &
               'it in one, which has threads')
  end subroutine refuse_processes

  !> Refuse a part of a study whose runs follow each other, and to continue one whose points no file keeps.
  subroutine refuse_parts(options, given, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it is refused

    if (given%model%request%study%classes .and. (options%has('part') .or. options%has('continue'))) then
      call raise(err, exit_usage, 'a study with classes numbers them in all its runs, which one program makes: leave out --'// &
                 trim(merge('part    ', 'continue', options%has('part'))))
    else if (given%model%request%study%carries() .and. (options%has('part') .or. options%has('continue'))) then
      call raise(err, exit_usage, 'a study that carries states on makes all its runs, one after the other: leave out --'// &
                 trim(merge('part    ', 'continue', options%has('part'))))
    else if (given%model%request%section%is_wanted .and. options%has('continue')) then
      call raise(err, exit_usage, '--continue has no points of the section for the runs that were made before; make the study '// &
                 'anew, or leave out &section')
    end if
  end subroutine refuse_parts

  !> How many threads make the runs.
  integer function threads_of_study(options, given) result(threads)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file

    threads = options%number('threads', threads_for(given%model))
    if (given%model%request%study%carries()) threads = 1
    if (.not. has_threads()) threads = 1
    threads = max(1, min(threads, most_threads, given%model%request%study%runs))
  end function threads_of_study

  !> Note what the user may expect of the study but does not get.
  subroutine print_notes(options, given)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    integer :: part(2), cores, borne

    part = options%part()
    if (given%model%request%output%compression > 0) &
      write (error_unit, '(a)') 'note: the HDF5 file of a study is not compressed'
    if (part(1) > given%model%request%study%runs) &
      write (error_unit, '(a)') 'note: this part has no runs: the study has '//to_text(given%model%request%study%runs)
    if (options%number('threads', 1) > 1 .and. .not. has_threads()) &
      write (error_unit, '(a)') 'note: this program was built without threads; one core makes the runs'
    cores = threads_of_machine()
    borne = threads_for(given%model)
    if (cores > 1 .and. borne == 1 .and. .not. options%has('threads')) &
      write (error_unit, '(a)') 'note: one thread makes the runs, because procedures of a user may not bear several at a time; '// &
                                '--threads N asks for more'
  end subroutine print_notes

  !> Make the runs, close the files, and tell how the study went. Where every run failed, the first failure is that of the study.
  subroutine carry_out(options, given, study, plots, reported, processes)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout), target :: given    !< the data file; it gets the errors
    type(kept_study_type), intent(inout), target :: study   !< with its open files, which are closed on return
    type(study_plots_type), intent(inout) :: plots          !< the plots that are requested
    logical, intent(inout) :: reported                      !< the report is written
    type(processes_type), intent(in) :: processes           !< those that make the runs together
    type(signal_interruption_type), target :: interruption
    type(error_type), allocatable :: err
    real(wp) :: clock
    logical :: quiet, kept

    quiet = options%has('quiet')
    clock = seconds()
    call interruption%words%start(given%model%program, 'no result', 'it', quiet, with_progress=.false.)
    call study%make(given, processes, threads_of_study(options, given), options%has('plot'), interruption, err)
    kept = .true.
    if (allocated(err)) kept = err%code == exit_interrupted
    clock = seconds() - clock
    if (.not. allocated(err) .and. study%has_scatter(given) .and. (options%has('report') .or. .not. quiet)) then
      call interruption%words%start(given%model%program, 'no derivatives at the means yet', 'their run', quiet, &
                                    with_progress=.false.)
      call study%find_scatter(given, interruption)
    end if
    if (.not. quiet) call print_study(error_unit, given%model, given%quantities, study%runs, study%propagation, clock)
    if (.not. quiet .and. allocated(study%without_shares)) &
      write (error_unit, '(a)') 'note: no shares by derivatives: '//study%without_shares%message
    if (.not. quiet .and. kept) call print_paths(study)
    call finish_section(options, given, study)
    if (allocated(err)) then
      call given%fail(err)
    else if (allocated(study%runs%first_failure) .and. study%runs%sums%done == 0) then
      call given%fail(study%runs%first_failure)
    else if (allocated(study%runs%first_failure) .and. .not. quiet) then
      call given%report_failure(study%runs%first_failure, error_unit)
    end if
    ! an interrupted program makes no pictures, which would take too long
    if (.not. asked_to_end()) then
      call plots%draw(study, error_unit, quiet, err)
      call given%fail(err)
    end if
    if (.not. options%has('report')) return
    call study%save_report(options%argument('report'), given, err)
    reported = .true.
    call given%fail(err)
  end subroutine carry_out

  !> Print where the results are.
  subroutine print_paths(study)
    type(kept_study_type), intent(in) :: study   !< made

    associate (wanted => study%results%wanted)
      if (wanted%table /= '' .and. wanted%table /= standard_output_path) write (error_unit, '(2a)') 'table: ', wanted%table
      if (wanted%hdf5 /= '') write (error_unit, '(2a)') 'HDF5 file: ', wanted%hdf5
    end associate
  end subroutine print_paths

  !> Write the files of the section, where there is one, and tell of it.
  subroutine finish_section(options, given, study)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout) :: given            !< the data file; it gets the errors
    type(kept_study_type), intent(in) :: study              !< made
    type(error_type), allocatable :: err

    if (.not. allocated(study%results%section)) return
    associate (section => study%results%section)
      call write_section_files(options, given, section%names, section%units, section%points(:, :section%count), &
                               study%results%wanted%table, err)
    end associate
    call given%fail(err)
    if (.not. options%has('quiet')) &
      call print_section(error_unit, study%results%section, .not. options%has('no-write'), given%model%mechanism%names)
  end subroutine finish_section
end module mech9_study_task
