!> What mech9k does, from the words of its command line to its exit code. Uses the floors below.
module mech9_mech9k_session
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_done
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type, get_command_words, parse_command_line, help_text
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
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_plan_text, only: print_structure, print_mobility, print_plan
  use mech9_kinematic_run, only: kinematic_outcome_type, assemble_start, run_kinematics
  use mech9_kinematic_report, only: print_kinematic_report, save_kinematic_report
  implicit none
  private
  public :: mech9k_main, mech9k_session

  character(len=*), parameter :: program_name = 'mech9k'

contains

  !> The whole program. It does not come back.
  subroutine mech9k_main()
    integer :: code

    call run_words(code)
    call exit_program(code)
  end subroutine mech9k_main

  !> The words are gone again before the program ends.
  subroutine run_words(code)
    integer, intent(out) :: code
    type(string_type), allocatable :: words(:)

    call get_command_words(words)
    call mech9k_session(words, code)
  end subroutine run_words

  !> Do what the words of a command line ask for; `code` is what the program answers to the shell.
  subroutine mech9k_session(words, code)
    type(string_type), intent(in) :: words(:)   !< without the program's name
    integer, intent(out) :: code
    type(command_line_type) :: options
    type(error_type), allocatable :: err

    call parse_command_line(words, program_name, options, err)
    if (allocated(err)) then
      write (error_unit, '(3a)') program_name, ': ', err%message
      code = err%code
      return
    end if
    code = exit_done
    if (options%help) then
      write (output_unit, '(a)') help_text(program_name)
    else if (options%version) then
      write (output_unit, '(a)') version_text(program_name)
    else if (options%help_data) then
      call show_data_help(options%help_group, code)
    else
      call catch_interrupts()
      call work_on_file(options, code)
    end if
  end subroutine mech9k_session

  subroutine show_data_help(group, code)
    character(len=*), intent(in) :: group
    integer, intent(out) :: code
    type(error_type), allocatable :: err

    code = exit_done
    call write_data_help(output_unit, group, err)
    if (.not. allocated(err)) return
    write (error_unit, '(3a)') program_name, ': ', err%message
    code = err%code
  end subroutine show_data_help

  !> Read the data file and do what is asked for.
  subroutine work_on_file(options, code)
    type(command_line_type), intent(in) :: options
    integer, intent(out) :: code
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(structure_type) :: structure
    type(structural_vectors_type) :: vectors
    type(mechanism_type) :: mechanism
    integer :: i

    call read_document(options%file, document, diagnostics)
    do i = 1, size(options%settings)
      if (.not. diagnostics%failed()) call apply_setting(document, options%settings(i)%text, diagnostics)
    end do
    if (options%structure) then
      if (.not. diagnostics%failed()) call read_structure_only(document, structure, vectors, diagnostics)
      if (.not. diagnostics%failed()) call print_structure(output_unit, vectors)
    else
      if (.not. diagnostics%failed()) call read_mechanism(document, .true., mechanism, diagnostics)
      if (.not. diagnostics%failed()) call work_on_mechanism(options, mechanism, diagnostics)
    end if
    call diagnostics%report(error_unit)
    code = diagnostics%code()
  end subroutine work_on_file

  !> Plan, assemble, and run unless only a check is asked for. Errors go to `diagnostics`, which knows
  !> the places in the data file.
  subroutine work_on_mechanism(options, mechanism, diagnostics)
    type(command_line_type), intent(in) :: options
    type(mechanism_type), intent(in) :: mechanism
    type(diagnostics_type), intent(inout) :: diagnostics
    type(plan_type) :: plan
    type(state_type) :: start
    type(kinematic_outcome_type) :: outcome
    type(error_type), allocatable :: err
    character(len=:), allocatable :: table_path

    call assemble_start(mechanism, plan, start, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
      return
    end if
    if (options%check .or. options%plan) then
      call print_mobility(output_unit, plan)
      if (options%plan) call print_plan(output_unit, mechanism, plan)
      if (options%check) call print_start(mechanism, start)
      return
    end if
    table_path = table_path_of(options, mechanism)
    if (.not. options%quiet .and. mechanism%title /= '') write (error_unit, '(a)') mechanism%title
    if (options%verbose) then
      call print_structure(error_unit, mechanism%vectors)
      call print_mobility(error_unit, plan)
      call print_plan(error_unit, mechanism, plan)
    end if
    call run_kinematics(mechanism, plan, start, table_path, options%quiet, outcome, err)
    if (.not. options%quiet) call print_kinematic_report(error_unit, mechanism, table_path, outcome)
    if (allocated(err)) call diagnostics%add_error(err)
    if (options%report == '') return
    call save_kinematic_report(options%report, mechanism, plan, table_path, diagnostics%code(), outcome, err)
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine work_on_mechanism

  !> Where the table goes: the command line comes before the data file; without either, standard output.
  pure function table_path_of(options, mechanism) result(path)
    type(command_line_type), intent(in) :: options
    type(mechanism_type), intent(in) :: mechanism
    character(len=:), allocatable :: path

    path = '-'
    if (mechanism%output%table /= '') path = mechanism%output%table
    if (options%table /= '') path = options%table
    if (options%no_write) path = ''
  end function table_path_of

  !> The assembled coordinates at the start, in the units of the data file.
  subroutine print_start(mechanism, start)
    type(mechanism_type), intent(in) :: mechanism
    type(state_type), intent(in) :: start
    integer :: k
    character(len=16) :: name

    write (output_unit, '(a)') 'assembled at the start:'
    do k = 1, size(mechanism%pairs)
      write (name, '(a,i0)') 'q', k
      write (output_unit, '(2x,a8,g0.16)') name, &
        start%q(k)/merge(mechanism%angle_unit, 1.0_wp, mechanism%pairs(k)%pair%angular)
    end do
  end subroutine print_start
end module mech9_mech9k_session
