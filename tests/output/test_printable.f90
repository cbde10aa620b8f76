!> Texts of any origin made fit for other programs: escapes, names of columns, bytes that are no text.
module test_printable
  use mech9_printable, only: printable, column_name, with_escapes, utf8_length
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('test_escapes')) call test_escapes(test)
    if (test%runs('test_clean_texts')) call test_clean_texts(test)
  end subroutine run

  subroutine test_escapes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=5), parameter :: escapes(3) = ['&amp;', '&lt; ', '\\   ']
    character(len=*), parameter :: letters = '&<\'

    call is(test, with_escapes('a < b & c', letters, escapes), 'a &lt; b &amp; c', 'letters with a meaning')
    call is(test, with_escapes('&&', letters, escapes), '&amp;&amp;', 'an escape is not escaped again')
    call is(test, with_escapes('\', letters, escapes), '\\', 'an escape that holds its letter')
    call is(test, with_escapes(' plain  ', letters, escapes), ' plain  ', 'blanks stay')
    call is(test, with_escapes('', letters, escapes), '', 'nothing')
    call is(test, with_escapes('a&b', '', escapes(:0)), 'a&b', 'no letter with a meaning')
  end subroutine test_escapes

  subroutine test_clean_texts(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), parameter :: e_acute = char(195)//char(169)

    call is(test, printable('a'//achar(10)//'b'), 'a b', 'a line that would end')
    call is(test, printable(e_acute//char(200)), e_acute//'?', 'a letter of two bytes, and a byte that is none')
    call is(test, column_name('my "x" #1 '), 'my__x___1', 'a name for readers of tables')
    call is(test, column_name(' '), '_', 'a name of nothing')
    call test%is_true(utf8_length(e_acute, 1) == 2 .and. utf8_length(e_acute, 2) == 0, 'a letter begins at its first byte')
    ! the first numbers that need two, three and four bytes, written in one more than they need, are no text
    call test%is_true(utf8_length(char(192)//char(128), 1) == 0, 'an overlong form of two bytes is no letter')
    call test%is_true(utf8_length(char(224)//char(130)//char(128), 1) == 0, 'an overlong form of three bytes is no letter')
    call test%is_true(utf8_length(char(237)//char(160)//char(128), 1) == 0, 'a surrogate is no letter')
    call test%is_true(utf8_length(char(244)//char(143)//char(191)//char(191), 1) == 4, 'the last number of a letter is accepted')
    call test%is_true(utf8_length(char(244)//char(144)//char(128)//char(128), 1) == 0, 'the number after the last one is no letter')
  end subroutine test_clean_texts

  subroutine is(test, text, expected, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< of any bytes
    character(len=*), intent(in) :: expected   !< the right printable text
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong

    call test%is_true(len(text) == len(expected) .and. text == expected, why//': '//text)
  end subroutine is
end module test_printable
