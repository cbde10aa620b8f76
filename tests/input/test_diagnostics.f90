!> The display of errors: place, line, carets, order, number, exit code.
module test_diagnostics
  use mech9_error, only: error_type, place_type, raise, exit_data, exit_structure, exit_file, exit_assembly, exit_done
  use mech9_source, only: span_type, source_from_text
  use mech9_diagnostics, only: diagnostics_type
  use mech9_testing, only: tester_type
  use mech9_input_support, only: eol, printed, count_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('the_form')) call the_form(tester)
    if (tester%runs('tabs_and_alphabets')) call tabs_and_alphabets(tester)
    if (tester%runs('a_long_line')) call a_long_line(tester)
    if (tester%runs('order_and_number')) call order_and_number(tester)
    if (tester%runs('exit_codes')) call exit_codes(tester)
    if (tester%runs('failures_from_elsewhere')) call failures_from_elsewhere(tester)
  end subroutine run

  subroutine shows(tester, text, first, last, expected, why, name)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    character(len=*), intent(in) :: text             !< of the file
    character(len=*), intent(in) :: expected         !< the right lines
    character(len=*), intent(in) :: why              !< the statement that is checked, printed where it is wrong
    integer, intent(in) :: first                     !< first byte of the error in the text
    integer, intent(in) :: last                      !< last byte of the error in the text
    character(len=*), intent(in), optional :: name   !< of the file
    type(diagnostics_type) :: g
    integer :: number

    if (present(name)) then
      call g%add_source(source_from_text(name, text), number)
    else
      call g%add_source(source_from_text('f.nml', text), number)
    end if
    call g%add(span_type(number, first, last), 'message')
    call tester%is_true(rendered(g, 1) == expected, why)
    if (rendered(g, 1) /= expected) print '(a)', rendered(g, 1)
  end subroutine shows

  subroutine the_form(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(diagnostics_type) :: g
    integer :: number

    call shows(tester, "&a"//eol//"  x = 12 /"//eol, 10, 11, &
               "f.nml:2:7: message"//eol//"  x = 12 /"//eol//"      ^^", 'message, line, carets under the place')
    call shows(tester, "&a", 1, 2, "f.nml:1:1: message"//eol//"&a"//eol//"^^", 'a file without a line end')
    call shows(tester, "ab"//eol//"cd", 2, 5, "f.nml:1:2: message"//eol//"ab"//eol//" ^", 'carets end with the line')
    call shows(tester, "a"//achar(27)//"b"//eol, 3, 3, "f.nml:1:3: message"//eol//"a?b"//eol//"  ^", &
               'control bytes are not printed')
    call g%add_source(source_from_text('--set', 'time.end=x', is_file=.false.), number)
    call g%add(span_type(number, 10, 10), 'message')
    call tester%is_true(rendered(g, 1) == '--set: message'//eol//'time.end=x'//eol//'         ^', 'a setting has no line number')
  end subroutine the_form

  subroutine tabs_and_alphabets(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=2), parameter :: umlaut = char(195)//char(164)

    call shows(tester, achar(9)//"x"//achar(9)//"= 1", 4, 4, "f.nml:1:4: message"//eol//achar(9)//"x"//achar(9)//"= 1"//eol// &
               achar(9)//" "//achar(9)//"^", 'tabs stand above tabs, so that the carets do not shift')
    call shows(tester, "t='"//umlaut//umlaut//"' x", 10, 10, "f.nml:1:8: message"//eol//"t='"//umlaut//umlaut//"' x"//eol// &
               "       ^", 'characters of two bytes take one column')
    call shows(tester, "'"//umlaut//"'", 1, 4, "f.nml:1:1: message"//eol//"'"//umlaut//"'"//eol//"^^^", &
               'a character of two bytes has one caret')
  end subroutine tabs_and_alphabets

  subroutine a_long_line(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(diagnostics_type) :: g
    character(len=:), allocatable :: text, shown
    integer :: number, lines(3)

    text = repeat('0123456789', 5000)//'X'//repeat('abcdefghij', 5000)
    call g%add_source(source_from_text('f.nml', text), number)
    call g%add(span_type(number, 50001, 50001), 'message')
    shown = rendered(g, 1)
    lines(1) = index(shown, eol)
    lines(2) = lines(1) + index(shown(lines(1) + 1:), eol)
    call tester%is_true(index(shown, 'f.nml:1:50001:') == 1, 'the column is that of the file')
    call tester%is_true(lines(2) - lines(1) < 120, 'a window of a long line is shown')
    call tester%is_true(index(shown(lines(1) + 1:), '...') == 1 .and. shown(lines(2) - 3:lines(2) - 1) == '...', &
                        'the window of a long line is marked as one')
    call tester%is_true(index(shown(lines(1) + 1:), 'X') == index(shown(lines(2) + 1:), '^'), &
                        'the caret stands under the place')
  end subroutine a_long_line

  subroutine order_and_number(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(diagnostics_type) :: g
    character(len=:), allocatable :: text
    integer :: number, i

    call g%add_source(source_from_text('f.nml', repeat('x'//eol, 40)), number)
    call g%add(span_type(), 'without place')
    do i = 30, 1, -1
      call g%add(span_type(number, 2*i - 1, 2*i - 1), 'message')
    end do
    text = printed(g)
    call tester%is_true(index(text, 'f.nml:1:1:') == 1 .and. index(text, 'f.nml:2:1:') > 1, 'errors are sorted by line')
    call tester%is_true(count_of('f.nml:', text) == 20, 'twenty errors are shown')
    call tester%is_true(index(text, 'and 11 more') > 0, 'the errors that are not shown are counted')
    do i = 1, 5000
      call g%add(span_type(number, 1, 1), 'message')
    end do
    call tester%is_true(g%count == 5031, 'all are counted, though not all are kept')
  end subroutine order_and_number

  subroutine exit_codes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(diagnostics_type) :: g

    call tester%is_true(g%code() == exit_done .and. .not. g%failed(), 'where there are no errors the exit code is that of success')
    call g%add(span_type(), 'x', exit_structure)
    call tester%is_true(g%code() == exit_structure .and. g%failed(), 'a wrong structure has its exit code')
    call g%add(span_type(), 'x')
    call tester%is_true(g%code() == exit_data, 'wrong data come before a wrong structure')
    call g%add(span_type(), 'x', exit_file)
    call tester%is_true(g%code() == exit_file, 'an unreadable file comes before all other errors')
  end subroutine exit_codes

  subroutine failures_from_elsewhere(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(diagnostics_type) :: g
    type(error_type), allocatable :: err
    integer :: number

    call g%add_source(source_from_text('f.nml', "&a /"//eol//" &pair x=1 /"//eol), number)
    call raise(err, exit_assembly, 'message', place_type(2, 2))
    call g%add_error(err)
    call tester%is_true(rendered(g, 1) == 'f.nml:2:2: message'//eol//' &pair x=1 /'//eol//' ^^^^^', &
                        'a failure with a place in the model shows where it was written')
    call tester%is_true(g%code() == exit_assembly, 'a failure with a place in the model keeps its code')
    call raise(err, exit_assembly, 'nowhere', place_type(77, 2))
    call g%add_error(err)
    call tester%is_true(rendered(g, 2) == 'f.nml: nowhere', 'a place that is not there does no harm')
  end subroutine failures_from_elsewhere

  function rendered(diagnostics, i) result(text)
    type(diagnostics_type), intent(in) :: diagnostics   !< of an input
    integer, intent(in) :: i                            !< number of the error
    character(len=:), allocatable :: text

    call diagnostics%render(i, text)
  end function rendered
end module test_diagnostics
