!> A program, from the words of its command line to its exit code. It runs a data file, makes one of a robot, or holds
!> a conversation.
module mech9_program
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type, get_command_words, parse_command_line
  use mech9_system, only: exit_program, leave_quit_alone
  use mech9_session, only: carry_out, asks_for_text
  use mech9_kept_study, only: processes_type
  use mech9_importing, only: import_robot
  use mech9_converse, only: converse
  implicit none
  private
  public :: run_program

contains

  !> Run the whole program. There is no return from it.
  subroutine run_program(program)
    integer, intent(in) :: program             !< kinematics or dynamics
    integer :: code

    call leave_quit_alone()
    call run_command_line(program, code)
    call exit_program(code)
  end subroutine run_program

  !> Carry out the command line. Its words are deallocated before the program ends.
  subroutine run_command_line(program, code)
    integer, intent(in) :: program             !< kinematics or dynamics
    integer, intent(out) :: code          !< exit code of the program
    type(string_type), allocatable :: words(:)

    call get_command_words(words)
    call run_words(program, words, code)
  end subroutine run_command_line

  !> Carry out the words of a command line. `code` is the exit code of the program.
  subroutine run_words(program, words, code)
    integer, intent(in) :: program             !< kinematics or dynamics
    type(string_type), intent(in) :: words(:)  !< words of the command line without the program's name
    integer, intent(out) :: code               !< exit code of the program
    type(command_line_type) :: options
    type(processes_type) :: processes
    type(string_type), allocatable :: inputs(:)
    type(error_type), allocatable :: err

    call parse_command_line(words, program, options, err)
    if (allocated(err)) then
      write (error_unit, '(3a)') program_names(program), ': ', err%message
      code = err%code
    else if (options%has('import') .and. .not. asks_for_text(options)) then
      call options%arguments('import', inputs)
      call import_robot(program, inputs, options%argument('out'), options%has('quiet'), code)
    else if (options%converses() .and. .not. asks_for_text(options)) then
      call converse(options, code)
    else
      call carry_out(options, processes, code)
    end if
  end subroutine run_words
end module mech9_program
