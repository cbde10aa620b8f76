!> Namelist text to documents: values of every kind, names, subscripts, comments, places.
module test_scanner
  use mech9_kinds, only: wp
  use mech9_source, only: source_from_text
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_document, only: document_type, value_type, value_null, value_integer, value_real, value_logical, &
                            value_text, value_word
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_error, only: place_type
  use mech9_testing, only: tester_type
  use mech9_input_support, only: eol
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('numerals')) call numerals(tester)
    if (tester%runs('values_of_every_kind')) call values_of_every_kind(tester)
    if (tester%runs('repeats_and_nulls')) call repeats_and_nulls(tester)
    if (tester%runs('names_and_subscripts')) call names_and_subscripts(tester)
    if (tester%runs('groups')) call groups(tester)
    if (tester%runs('places')) call places(tester)
  end subroutine run

  !> Written and expected numbers; the compiler's own constants are the oracle.
  subroutine numerals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    ! more digits than a stack holds
    call number_is(tester, '0.25'//repeat('0', 20000000), 0.25_wp, whole=.false.)
    call number_is(tester, '12', 12.0_wp, .true.)
    call number_is(tester, '-7', -7.0_wp, .true.)
    call number_is(tester, '+0', 0.0_wp, .true.)
    call number_is(tester, '1.5', 1.5_wp, .false.)
    call number_is(tester, '.25', 0.25_wp, .false.)
    call number_is(tester, '3.', 3.0_wp, .false.)
    call number_is(tester, '1e3', 1000.0_wp, .false.)
    call number_is(tester, '-1.25d-2', -0.0125_wp, .false.)
    call number_is(tester, '2Q+2', 200.0_wp, .false.)
    call number_is(tester, '0.1', 0.1_wp, .false.)
    call number_is(tester, '1.7976931348623157e308', huge(1.0_wp), .false.)
    call number_is(tester, '0.00017976931348623157E+312', huge(1.0_wp), .false.)
    call number_is(tester, '2.2250738585072014e-308', tiny(1.0_wp), .false.)
    call number_is(tester, '1e-999999999999', 0.0_wp, .false.)
    call number_is(tester, '0e999', 0.0_wp, .false.)
    call number_is(tester, '0.7173560908995228', 0.7173560908995228_wp, .false.)
    call number_is(tester, repeat('0', 5000)//'1.0', 1.0_wp, .false.)
    call is_no_number(tester, '1e309', 'too large')
    call is_no_number(tester, '1.7976931348623159e308', 'too large')
    call is_no_number(tester, '17976931348623159'//repeat('0', 292), 'too large')
    call is_no_number(tester, '-1e999', 'too large')
    call is_no_number(tester, 'nan', 'finite')
    call is_no_number(tester, 'NaN(3)', 'finite')
    call is_no_number(tester, '+INF', 'finite')
    call is_no_number(tester, '-infinity', 'finite')
    call is_no_number(tester, '', 'not a number')
    call is_no_number(tester, '-', 'not a number')
    call is_no_number(tester, '.', 'not a number')
    call is_no_number(tester, 'e5', 'not a number')
    call is_no_number(tester, '1e', 'not a number')
    call is_no_number(tester, '1e+', 'not a number')
    call is_no_number(tester, '1.2.3', 'not a number')
    call is_no_number(tester, '1-2', 'not a number')
    call is_no_number(tester, '0x10', 'not a number')
    call is_no_number(tester, '12abc', 'not a number')
    call is_no_number(tester, 'inferior', 'not a number')
  end subroutine numerals

  subroutine number_is(tester, text, expected, whole)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of the number
    real(wp), intent(in) :: expected             !< its right value
    logical, intent(in) :: whole                 !< it is a whole number
    type(numeral_type) :: numeral
    character(len=30) :: shown

    shown = text
    call read_numeral(text, numeral)
    call tester%is_true(.not. allocated(numeral%problem), trim(shown)//' is a number')
    ! exact: both the compiler and the program round correctly
    call tester%is_true(abs(numeral%number - expected) <= 0.0_wp, trim(shown)//' has its value')
    call tester%is_true(numeral%is_integer .eqv. whole, trim(shown)//' is whole or not')
    if (whole) call tester%is_true(numeral%whole == nint(expected), trim(shown)//' has its whole value')
  end subroutine number_is

  subroutine is_no_number(tester, text, reason)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< text that is no number
    character(len=*), intent(in) :: reason       !< part of the message
    type(numeral_type) :: numeral

    call read_numeral(text, numeral)
    call tester%is_true(allocated(numeral%problem), text//' is refused')
    if (allocated(numeral%problem)) call tester%is_true(index(numeral%problem, reason) > 0, &
                                                        text//': the reason is told: '//numeral%problem)
  end subroutine is_no_number

  subroutine parse(text, document, errors)
    character(len=*), intent(in) :: text           !< of a data file
    type(document_type), intent(out) :: document   !< its groups and items
    integer, intent(out) :: errors                 !< how many there are
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    errors = diagnostics%count
  end subroutine parse

  subroutine values_of_every_kind(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: d
    integer :: errors

    call parse("&g a=1, 2.5d0 -3, .true. F 'it''s' ""say """"no"""" / & !"" word /", d, errors)
    call tester%is_true(errors == 0, 'values of every kind are read')
    associate (v => d%groups(1)%items(1)%values)
      call tester%is_true(size(v) == 8, 'commas and blanks separate values')
      call tester%is_true(all(v%kind == [value_integer, value_real, value_integer, value_logical, value_logical, &
                                         value_text, value_text, value_word]), 'kinds of values are told apart')
      call tester%is_true(v(1)%whole == 1 .and. v(3)%whole == -3, 'whole numbers have their value')
      call tester%near(v(2)%number, 2.5_wp, 0.0_wp, 'a real may have the exponent letter d')
      call tester%is_true(v(4)%truth .and. .not. v(5)%truth, 'logicals are read in both spellings')
      call tester%is_true(v(6)%text == "it's", 'a doubled apostrophe stands for one')
      call tester%is_true(v(7)%text == 'say "no" / & !', 'marks of the language mean nothing within quotes')
    end associate
    call parse("&g a='' b="" "" /", d, errors)
    call tester%is_true(d%groups(1)%items(1)%values(1)%text == '', 'an empty text is read as such')
    call tester%is_true(len(d%groups(1)%items(2)%values(1)%text) == 1, 'a text of one blank keeps it')
  end subroutine values_of_every_kind

  subroutine repeats_and_nulls(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: d
    integer :: errors

    call parse("&g a=2*1.5, 3*'x' b=,1,,2, c= d=2* e=1 /", d, errors)
    call tester%is_true(errors == 0, 'repeats and nulls are read')
    associate (items => d%groups(1)%items)
      call tester%is_true(all(items(1)%values%times == [2, 3]), 'r*value keeps its r')
      call tester%is_true(items(1)%values(2)%text == 'x', 'a text can be repeated')
      call tester%is_true(all(items(2)%values%kind == [value_null, value_integer, value_null, value_integer]), &
                          'commas without a value between them mean a null; a comma at the end does not')
      call tester%is_true(size(items(3)%values) == 0, 'a name may have no value at all')
      call tester%is_true(items(4)%values(1)%kind == value_null .and. items(4)%values(1)%times == 2, 'r* means r nulls')
      call tester%is_true(items(5)%name == 'e', 'the name after a null is found')
    end associate
  end subroutine repeats_and_nulls

  subroutine names_and_subscripts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: d
    integer :: errors

    call parse("&g A(2)=1 b(1,:)=2 c( : , 3 )=4 d(2:4)=1 e(2:)=1 long_name_9 = 1 f"//eol//" ! note"//eol//" =3/", d, errors)
    call tester%is_true(errors == 0, 'subscripts of all forms are read')
    associate (i => d%groups(1)%items)
      call tester%is_true(i(1)%name == 'a' .and. i(1)%subscripts(1)%first == 2 .and. .not. i(1)%subscripts(1)%section, &
                          'the subscript of a(2) is read')
      call tester%is_true(i(2)%subscripts(1)%first == 1 .and. i(2)%subscripts(2)%section &
                          .and. i(2)%subscripts(2)%first == 0, 'the subscripts of b(1,:) are read')
      call tester%is_true(i(3)%subscripts(1)%section .and. i(3)%subscripts(2)%first == 3, 'the subscripts of c(:,3) are read')
      call tester%is_true(i(4)%subscripts(1)%first == 2 .and. i(4)%subscripts(1)%last == 4, 'the section d(2:4) is read')
      call tester%is_true(i(5)%subscripts(1)%first == 2 .and. i(5)%subscripts(1)%last == 0, 'the section e(2:) is read')
      call tester%is_true(i(6)%name == 'long_name_9', 'digits and underscores belong to names')
      call tester%is_true(i(7)%name == 'f' .and. i(7)%values(1)%whole == 3, 'a comment may stand between a name and =')
    end associate
    call parse("&g a(1,2,3)=1 b(x)=1 c()=1 d(99999999999)=1 /", d, errors)
    call tester%is_true(errors >= 4, 'subscripts that are not numbers are refused')
  end subroutine names_and_subscripts

  subroutine groups(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: d
    integer :: errors

    call parse("! c"//eol//"&A x=1/ &b"//eol//"&end"//eol//"&c/", d, errors)
    call tester%is_true(errors == 0 .and. size(d%groups) == 3, 'groups end with / or &end')
    call tester%is_true(d%groups(1)%name == 'a', 'names of groups are in lower case')
    call parse("&a x=1 &b y=2 /", d, errors)
    call tester%is_true(errors == 1 .and. size(d%groups) == 2, 'after a forgotten slash the next group is read')
    call parse("&a x='1 /"//eol//"&b y=2 /", d, errors)
    call tester%is_true(errors == 1 .and. size(d%groups) == 2, 'a forgotten quote costs one error, not the rest of the file')
    call parse("&a x=1 / junk"//eol//"more junk"//eol//"&b y=2 /", d, errors)
    call tester%is_true(errors == 1 .and. size(d%groups) == 2, 'text outside the groups is told once')
  end subroutine groups

  !> Lines and columns by counting in the text.
  subroutine places(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: d
    type(diagnostics_type) :: g

    call parse_document(source_from_text('t', "&a"//achar(13)//eol//"  x=1,"//achar(9)//"23"//achar(13)//"y='"// &
                                         char(195)//char(164)//"' z=7 /"), d, g)
    call tester%is_true(at(g, d%groups(1)%items(1)%values(2), 2, 8), 'the place after CR LF, a blank and a tab is right')
    call tester%is_true(at(g, d%groups(1)%items(2)%values(1), 3, 3), 'a CR alone ends a line')
    call tester%is_true(at(g, d%groups(1)%items(3)%values(1), 3, 9), 'a character of two bytes is one column')
  end subroutine places

  logical function at(diagnostics, value, line, column)
    type(diagnostics_type), intent(in) :: diagnostics   !< with the text of the file
    type(value_type), intent(in) :: value               !< of an item
    integer, intent(in) :: line                         !< the right line
    integer, intent(in) :: column                       !< the right column
    type(place_type) :: place

    place = diagnostics%place(value%span)
    at = place%line == line .and. place%column == column
  end function at
end module test_scanner
