!> Command lines of tests, from their words in one text.
module option_words
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type, parse_command_line
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: options_of

contains

  !> The options of a command line of mech9d, which must be right.
  subroutine options_of(tester, line, options)
    type(tester_type), intent(inout) :: tester         !< counts the checks
    character(len=*), intent(in) :: line               !< words with a blank between them, without the program's name
    type(command_line_type), intent(out) :: options    !< the options
    type(string_type), allocatable :: words(:)
    type(error_type), allocatable :: err
    integer :: first, i, n

    n = count([(line(i:i) == ' ', i=1, len(line))]) + 1
    allocate (words(n))
    first = 1
    do i = 1, n
      words(i)%text = line(first:first + index(line(first:)//' ', ' ') - 2)
      first = first + len(words(i)%text) + 1
    end do
    call parse_command_line(words, dynamics, options, err)
    call tester%no_error(err, 'a command line: '//line)
  end subroutine options_of
end module option_words
