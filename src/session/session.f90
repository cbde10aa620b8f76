!> Work on a data file, from the options of a command line to an exit code, the same for all tasks.
module mech9_session
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_program_kind, only: kinematics, program_names
  use mech9_error, only: error_type, exit_done, exit_file
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type
  use mech9_help_text, only: help_text
  use mech9_version, only: version_text
  use mech9_system, only: catch_interrupts, catch_size_limit, flush_output
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_setting, only: apply_setting
  use mech9_drive_reader, only: files_of_groups
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_reader, only: read_model
  use mech9_data_help, only: write_data_help
  use mech9_kept_rows, only: kept_rows_type
  use mech9_model, only: model_type
  use mech9_structure_text, only: print_structure_of
  use mech9_task, only: work_on_mechanism, answers_only
  use mech9_report_parts, only: save_short_report
  use mech9_study_task, only: work_on_study
  use mech9_processes, only: processes_type
  use mech9_dakota_task, only: work_for_dakota
  use mech9_part_merge, only: merge_parts
  use mech9_optimum_task, only: work_on_optimum
  use mech9_choice_check, only: judge_choice_of
  use mech9_unused_options, only: print_unused_options
  use mech9_overwriting, only: refuse_overwriting
  use mech9_made_check, only: refuse_other_mechanism
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
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics, choice
    type(model_type), target :: model
    type(varied_document_type), target :: variable
    type(string_type), allocatable :: settings(:), inputs(:)
    type(error_type), allocatable :: err
    logical :: legible, reported
    integer :: i

    ! an answer without a run has no results to keep: Ctrl-C ends it at once
    call catch_size_limit()
    if (.not. answers_only(options)) call catch_interrupts()
    model%program = options%program
    call read_document(path, document, diagnostics)
    call options%arguments('set', settings)
    if (diagnostics%code() /= exit_file) then
      do i = 1, size(settings)
        call apply_setting(document, settings(i)%text, diagnostics)
      end do
    end if
    call list_inputs(path, options, document, inputs)
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
        call print_structure_of(output_unit, document, diagnostics)
      else
        call print_unused_options(error_unit, options, model)
        call print_structure_of(output_unit, document, diagnostics, names_unit=error_unit)
      end if
    else
      legible = .not. diagnostics%failed()
      call read_model(document, options%program, model, diagnostics)
      if (.not. diagnostics%failed()) call refuse_other_mechanism(document, diagnostics)
      if (.not. diagnostics%failed()) then
        if (.not. options%has('quiet')) call print_unused_options(error_unit, options, model)
        call refuse_overwriting(options, inputs, err, model%request%output, model%request%section)
        reported = reported .or. allocated(err)
        if (allocated(err)) call diagnostics%add_error(err)
        if (options%has('study') .or. options%has('optimize') .or. options%has('dakota') .or. options%has('branch') .or. &
            model%request%output%with_derivatives()) &
          call new_varied_document(document, diagnostics%sources, options%program, variable)
        if (.not. allocated(err) .and. options%has('dakota')) then
          call work_for_dakota(options, variable, model, diagnostics)
        else if (.not. allocated(err) .and. options%has('study')) then
          call work_on_study(options, document, variable, model, diagnostics, reported, processes)
        else if (.not. allocated(err) .and. options%has('optimize')) then
          call work_on_optimum(options, document, variable, model, diagnostics, reported, processes)
        else if (.not. allocated(err)) then
          call work_on_mechanism(options, model, variable, diagnostics, reported, kept)
        end if
      else if (legible .and. options%program == kinematics) then
        call judge_choice_of(document, diagnostics, choice)
      end if
    end if
    code = diagnostics%code()
    if (choice%failed()) code = choice%code()
    if (options%has('report') .and. .not. reported) &
      call report_briefly(options, model, choice, diagnostics, code)
    call choice%report(error_unit)
    call diagnostics%report(error_unit)
  end subroutine run_file

  !> List the files that are read: the data file, those that its groups name, and one of Dakota.
  pure subroutine list_inputs(path, options, document, inputs)
    character(len=*), intent(in) :: path                       !< of the data file
    type(command_line_type), intent(in) :: options             !< the command line
    type(document_type), intent(in) :: document                !< its groups and items
    type(string_type), allocatable, intent(out) :: inputs(:)   !< paths of the files that are read
    type(string_type), allocatable :: of_groups(:), of_dakota(:)
    integer :: i, n

    call files_of_groups(document, of_groups)
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
  subroutine report_briefly(options, model, choice, diagnostics, code)
    type(command_line_type), intent(in) :: options         !< the command line
    type(model_type), intent(in) :: model                  !< the model
    type(diagnostics_type), intent(in) :: choice           !< judgement of the choice of independent coordinates
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    integer, intent(inout) :: code                         !< exit code of the program; of the first error
    type(error_type), allocatable :: err

    call save_short_report(options%argument('report'), model, code, choice, diagnostics, err)
    if (.not. allocated(err)) return
    call diagnostics%add_error(err)
    if (code == exit_done) code = err%code
  end subroutine report_briefly
end module mech9_session
