!> A program from the words of its command line to its exit code, the same for all tasks.
!> Uses command_line, system, the input floor, plan_text, task, version.
module mech9_session
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_error, only: error_type, exit_done
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type, get_command_words, parse_command_line
  use mech9_help_text, only: help_text
  use mech9_version, only: version_text
  use mech9_system, only: catch_interrupts, exit_program
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_setting, only: apply_setting
  use mech9_reader, only: read_structure_only, read_mechanism
  use mech9_data_help, only: write_data_help
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan_text, only: print_structure
  use mech9_task, only: task_type
  implicit none
  private
  public :: run_program, run_words

contains

  !> The whole program. It does not come back.
  subroutine run_program(task)
    class(task_type), intent(in) :: task
    integer :: code

    call run_command_line(task, code)
    call exit_program(code)
  end subroutine run_program

  !> The words are gone again before the program ends.
  subroutine run_command_line(task, code)
    class(task_type), intent(in) :: task
    integer, intent(out) :: code
    type(string_type), allocatable :: words(:)

    call get_command_words(words)
    call run_words(task, words, code)
  end subroutine run_command_line

  !> Do what the words of a command line ask for; `code` is what the program answers to the shell.
  subroutine run_words(task, words, code)
    class(task_type), intent(in) :: task
    type(string_type), intent(in) :: words(:)   !< without the program's name
    integer, intent(out) :: code
    type(command_line_type) :: options
    type(error_type), allocatable :: err

    call parse_command_line(words, task%program_name, options, err)
    if (allocated(err)) then
      write (error_unit, '(3a)') task%program_name, ': ', err%message
      code = err%code
      return
    end if
    code = exit_done
    if (options%has('help')) then
      write (output_unit, '(a)') help_text(task%program_name)
    else if (options%has('version')) then
      write (output_unit, '(a)') version_text(task%program_name)
    else if (options%has('help-data')) then
      call show_data_help(task, options%argument('help-data'), code)
    else
      call catch_interrupts()
      call work_on_file(task, options, code)
    end if
  end subroutine run_words

  subroutine show_data_help(task, group, code)
    class(task_type), intent(in) :: task
    character(len=*), intent(in) :: group
    integer, intent(out) :: code
    type(error_type), allocatable :: err

    code = exit_done
    call write_data_help(output_unit, group, err)
    if (.not. allocated(err)) return
    write (error_unit, '(3a)') task%program_name, ': ', err%message
    code = err%code
  end subroutine show_data_help

  !> Read the data file and do what is asked for.
  subroutine work_on_file(task, options, code)
    class(task_type), intent(in) :: task
    type(command_line_type), intent(in) :: options
    integer, intent(out) :: code
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(structure_type) :: structure
    type(structural_vectors_type) :: vectors
    type(mechanism_type) :: mechanism
    type(string_type), allocatable :: settings(:)
    integer :: i

    call read_document(options%file, document, diagnostics)
    call options%arguments('set', settings)
    do i = 1, size(settings)
      call apply_setting(document, settings(i)%text, diagnostics)
    end do
    if (options%has('structure')) then
      call read_structure_only(document, structure, vectors, diagnostics)
      if (.not. diagnostics%failed()) call print_structure(output_unit, vectors)
    else
      call read_mechanism(document, task%needs_drives, mechanism, diagnostics)
      if (.not. diagnostics%failed()) call task%work(options, mechanism, diagnostics)
    end if
    call diagnostics%report(error_unit)
    code = diagnostics%code()
  end subroutine work_on_file
end module mech9_session
