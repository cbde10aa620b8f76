!> The help of a program: its purpose, its options, its exit codes. These are also used by --help, the manual page and
!> the completion of the shell.
module mech9_help_text
  use mech9_program_kind, only: dynamics, program_names, belongs_to
  use mech9_error, only: exit_done, exit_internal, exit_usage, exit_data, exit_structure, exit_assembly, &
                         exit_singular, exit_integrator, exit_file, exit_interrupted
  use mech9_text, only: to_text
  use mech9_options, only: option_type, options_table, no_argument, optional_argument
  implicit none
  private
  public :: help_text, option_form, purpose, exit_row_type, exit_table

  !> An exit code of a program.
  type :: exit_row_type
    integer :: code
    character(len=32) :: meaning
  end type exit_row_type

  type(exit_row_type), parameter :: exit_table(*) = [ &
    exit_row_type(exit_done, 'done'), &
    exit_row_type(exit_internal, 'internal error'), &
    exit_row_type(exit_usage, 'usage'), &
    exit_row_type(exit_data, 'data file'), &
    exit_row_type(exit_structure, 'structure or mobility'), &
    exit_row_type(exit_assembly, 'cannot be assembled'), &
    exit_row_type(exit_singular, 'singular position or branch'), &
    exit_row_type(exit_integrator, 'integrator'), &
    exit_row_type(exit_file, 'file input or output'), &
    exit_row_type(exit_interrupted, 'interrupted')]

  character, parameter :: eol = achar(10)
  integer, parameter :: widest_line = 79

contains

  !> The purpose of a program, in one line.
  pure function purpose(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text

    text = 'kinematics of mechanisms from structural data'
    if (program == dynamics) text = 'dynamics of mechanisms from structural data'
  end function purpose

  !> The text of --help, as whole lines; the last one has no line end.
  pure function help_text(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text
    character(len=28) :: left
    integer :: i

    text = 'usage: '//program_names(program)//' FILE [options]'//eol// &
           '       runs the mechanism that the data file FILE describes'//eol// &
           '       '//program_names(program)//' [options]'//eol// &
           '       asks for the mechanism in a conversation, saves it as a data file and runs it'//eol//eol// &
           'options:'
    do i = 1, size(options_table)
      if (.not. belongs_to(options_table(i)%program, program)) cycle
      left = option_form(options_table(i))
      text = text//eol//'  '//left//trim(options_table(i)%help)
    end do
    text = text//eol//eol//'Results are written to files or standard output, messages to standard error.'//eol//exit_lines()
  end function help_text

  !> The exit codes in as few lines as possible.
  pure function exit_lines() result(text)
    character(len=:), allocatable :: text, item, line
    integer :: i

    text = ''
    item = ''
    line = 'Exit codes:'
    do i = 1, size(exit_table)
      item = to_text(exit_table(i)%code)//' '//trim(exit_table(i)%meaning)//merge(',', '.', i < size(exit_table))
      if (len(line) + 1 + len(item) > widest_line) then
        text = text//line//eol
        line = item
      else
        line = line//' '//item
      end if
    end do
    text = text//line
  end function exit_lines

  !> An option in the form of the help: "--table PATH", "--help-data [GROUP[.NAME]]".
  pure function option_form(option) result(form)
    type(option_type), intent(in) :: option  !< the option, as a row of its table
    character(len=:), allocatable :: form

    form = '--'//trim(option%name)
    if (option%takes == no_argument) return
    if (option%takes == optional_argument) then
      form = form//' ['//trim(option%argument)//']'
    else
      form = form//' '//trim(option%argument)
    end if
  end function option_form
end module mech9_help_text
