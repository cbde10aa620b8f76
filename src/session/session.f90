!> Work on a data file, from the options of a command line to an exit code, the same for all tasks.
module mech9_session
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type, exit_done
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type
  use mech9_help_text, only: help_text
  use mech9_version, only: version_text
  use mech9_system, only: catch_interrupts, catch_size_limit, flush_output
  use mech9_data_file, only: data_file_type
  use mech9_data_help, only: write_data_help
  use mech9_kept_rows, only: kept_rows_type
  use mech9_structure_text, only: print_structure_of
  use mech9_task, only: work_on_mechanism, answers_only
  use mech9_answer_report, only: save_failure_report
  use mech9_study_task, only: work_on_study
  use mech9_kept_study, only: processes_type
  use mech9_dakota_task, only: work_for_dakota
  use mech9_part_merge, only: merge_parts
  use mech9_optimum_task, only: work_on_optimum
  use mech9_unused_options, only: print_unused_options
  use mech9_overwriting, only: refuse_overwriting
  implicit none
  private
  public :: carry_out, run_file, asks_for_text

contains

  !> Carry out a command line about a data file or about the program itself; `code` is the exit code of the
  !> program.
  subroutine carry_out(options, processes, code)
    type(command_line_type), intent(in) :: options           !< the command line
    type(processes_type), intent(inout) :: processes   !< those that make studies and searches together
    integer, intent(out) :: code                             !< exit code of the program
    type(error_type), allocatable :: err

    code = exit_done
    if (options%has('help')) then
      write (output_unit, '(a)') help_text(options%program)
    else if (options%has('version')) then
      write (output_unit, '(a)') version_text(options%program)
    else if (options%has('help-data')) then
      call show_data_help(options, code)
    else if (options%has('merge')) then
      call catch_size_limit()
      call merge_parts(options, code)
    else
      call run_file(options, options%file, processes, code)
    end if
    call flush_output(err)
    if (.not. allocated(err)) return
    write (error_unit, '(3a)') program_names(options%program), ': ', err%message
    if (code == exit_done) code = err%code
  end subroutine carry_out

  !> Whether the options request a text about the program; all other options are then ignored.
  pure logical function asks_for_text(options)
    type(command_line_type), intent(in) :: options   !< the command line

    asks_for_text = options%has('help') .or. options%has('version') .or. options%has('help-data')
  end function asks_for_text

  !> Carry out --help-data: about the group that it names, or the list of groups.
  subroutine show_data_help(options, code)
    type(command_line_type), intent(in) :: options   !< the command line
    integer, intent(out) :: code                     !< exit code of the program
    type(error_type), allocatable :: err

    code = exit_done
    call write_data_help(output_unit, options%argument('help-data'), err)
    if (.not. allocated(err)) return
    write (error_unit, '(3a)') program_names(options%program), ': ', err%message
    code = err%code
  end subroutine show_data_help

  !> Read a data file and carry out the options.
  subroutine run_file(options, path, processes, code, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    character(len=*), intent(in) :: path                    !< of the data file
    type(processes_type), intent(inout) :: processes  !< those that make studies and searches together
    integer, intent(out) :: code                            !< exit code of the program
    type(kept_rows_type), intent(inout), optional :: kept   !< the rows of the run, for who looks at them after it
    class(data_file_type), allocatable, target :: given
    type(string_type), allocatable :: settings(:), inputs(:)
    type(error_type), allocatable :: err
    logical :: reported

    ! an answer without a run has no results to keep: Ctrl-C ends it at once
    call catch_size_limit()
    if (.not. answers_only(options)) call catch_interrupts()
    allocate (given)
    call options%arguments('set', settings)
    call given%open(path, options%program, settings)
    given%path = options%file
    given%command_line = options%line
    call list_inputs(path, options, given, inputs)
    call refuse_overwriting(options, inputs, err)
    if (allocated(err)) then
      write (error_unit, '(3a)') program_names(options%program), ': ', err%message
      code = err%code
      return
    end if
    ! of several processes the first one writes the report
    reported = .not. processes%is_first
    if (options%has('structure')) then
      if (options%has('quiet')) then
        call print_structure_of(output_unit, given%document, given%diagnostics)
      else
        call print_unused_options(error_unit, options, given)
        call print_structure_of(output_unit, given%document, given%diagnostics, names_unit=error_unit)
      end if
    else
      call given%read()
      if (.not. given%failed()) call work_on_model(options, inputs, given, reported, processes, kept)
    end if
    code = given%code()
    if (options%has('report') .and. .not. reported) call report_briefly(options, given, code)
    call given%report(error_unit)
  end subroutine run_file

  !> Carry out the options on the model of a data file.
  subroutine work_on_model(options, inputs, given, reported, processes, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(string_type), intent(in) :: inputs(:)              !< paths of the files that are read
    type(data_file_type), intent(inout), target :: given    !< the data file; it gets the errors
    logical, intent(inout) :: reported                      !< the report is written, or needs not be
    type(processes_type), intent(inout) :: processes        !< those that make studies and searches together
    type(kept_rows_type), intent(inout), optional :: kept   !< the rows of the run, for who looks at them after it
    type(error_type), allocatable :: err

    if (.not. options%has('quiet')) call print_unused_options(error_unit, options, given)
    call refuse_overwriting(options, inputs, err, given)
    if (allocated(err)) then
      reported = .true.
      call given%fail(err)
      return
    end if
    if (options%has('study') .or. options%has('optimize') .or. options%has('dakota') .or. options%has('branch') .or. &
        given%model%request%output%with_derivatives()) call given%prepare_variable()
    if (options%has('dakota')) then
      call work_for_dakota(options, given)
    else if (options%has('study')) then
      call work_on_study(options, given, reported, processes)
    else if (options%has('optimize')) then
      call work_on_optimum(options, given, reported, processes)
    else
      call work_on_mechanism(options, given, reported, kept)
    end if
  end subroutine work_on_model

  !> List the files that are read: the data file, those that its groups name, and one of Dakota.
  pure subroutine list_inputs(path, options, given, inputs)
    character(len=*), intent(in) :: path                       !< of the data file
    type(command_line_type), intent(in) :: options             !< the command line
    class(data_file_type), intent(in) :: given                 !< the data file
    type(string_type), allocatable, intent(out) :: inputs(:)   !< paths of the files that are read
    type(string_type), allocatable :: of_groups(:), of_dakota(:)
    integer :: i, n

    call given%list_files(of_groups)
    call options%arguments('dakota', of_dakota)
    n = min(1, size(of_dakota))
    allocate (inputs(1 + size(of_groups) + n))
    inputs(1)%text = path
    do i = 1, size(of_groups)
      inputs(1 + i)%text = of_groups(i)%text
    end do
    if (n > 0) inputs(size(inputs))%text = of_dakota(1)%text
  end subroutine list_inputs

  !> Write the report where no run wrote one. A failure to write it is another error; the first error determines the code.
  subroutine report_briefly(options, given, code)
    type(command_line_type), intent(in) :: options      !< the command line
    class(data_file_type), intent(inout) :: given       !< the data file; it gets the error
    integer, intent(inout) :: code                      !< exit code of the program; of the first error
    type(error_type), allocatable :: err

    call save_failure_report(options%argument('report'), given, code, err)
    call given%fail(err)
    if (allocated(err) .and. code == exit_done) code = err%code
  end subroutine report_briefly
end module mech9_session
