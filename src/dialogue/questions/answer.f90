!> The check of an answer to a question against its row of the grammar, the same as that of the reader of data files.
module mech9_answer
  use mech9_kinds, only: wp
  use mech9_text, only: lower, to_text, exact_digits
  use mech9_formula, only: formula_problem_type
  use mech9_formula_value, only: evaluate_number
  use mech9_source, only: source_type, span_type, source_from_text
  use mech9_grammar, only: item_row_type
  use mech9_document, only: item_type
  use mech9_parser, only: parse_item
  use mech9_setting, only: has_formula, is_formula, element_end
  use mech9_item_merge, only: expand_repeats
  use mech9_item_check, only: check_item
  use mech9_diagnostics, only: diagnostics_type, printable
  use mech9_printable, only: with_escapes
  use mech9_draft_source, only: values_text
  use mech9_short_answers, only: full_form
  implicit none
  private
  public :: read_answer, yes_or_no, wants_quotes

  !> Longer answers are refused.
  integer, parameter :: longest_answer = 100000

contains

  !> Read an answer as values in the form of a data file. If this is impossible, `problem` has one message or several, a
  !> line each. Texts need no quotes, a switch may be answered by yes or no, and short forms are written in full.
  pure subroutine read_answer(row, line, text, problem, unit_of_angles)
    type(item_row_type), intent(in) :: row                 !< row of the table of names for the question
    character(len=*), intent(in) :: line                   !< the answer, without blanks around it
    character(len=:), allocatable, intent(out) :: text     !< values as a data file writes them
    character(len=:), allocatable, intent(out) :: problem  !< the reason why it is no answer; empty: it is one
    real(wp), intent(in), optional :: unit_of_angles       !< of formulas [rad]; a rad where it is not given
    character(len=:), allocatable :: written
    real(wp) :: angle_unit

    angle_unit = 1.0_wp
    if (present(unit_of_angles)) angle_unit = unit_of_angles
    text = ''
    problem = ''
    if (len(line) > longest_answer) then
      problem = 'this is too long for an answer'
      return
    end if
    if (has_control_byte(line)) then
      problem = 'there is a control character in it; type it again'
      return
    end if
    if (names_file(row) .and. wants_quotes(line)) then
      problem = 'a name of a file is asked for; write one that has blanks in quotes'
      return
    end if
    written = full_form(row, line)
    if (row%type == 'text' .and. scan(line, '''"') /= 1) then
      if (row%high > 1) then
        written = quoted_words(written)
      else
        written = quoted(written)
      end if
    end if
    if (row%type == 'logical') written = switch_text(line)
    if (row%type == 'real') call evaluate_formulas(row, angle_unit, written, problem)
    if (problem /= '') return
    call read_values(row, written, text, problem)
  end subroutine read_answer

  !> Write the values of formulas of numbers in their places: 49.49747468305833 for 35*sqrt(2).
  pure subroutine evaluate_formulas(row, angle_unit, written, problem)
    type(item_row_type), intent(in) :: row                      !< row of the table of names for the question
    real(wp), intent(in) :: angle_unit                          !< unit of angles of formulas [rad]
    character(len=:), allocatable, intent(inout) :: written     !< numbers and formulas, with commas between them
    character(len=:), allocatable, intent(inout) :: problem     !< stays empty where the formulas have values
    type(formula_problem_type) :: wrong
    character(len=:), allocatable :: text
    integer :: first, last
    real(wp) :: value

    if (.not. has_formula(written, 0, row%high == 1)) return
    text = ''
    last = 0
    do while (last <= len(written))
      first = last + 1
      last = element_end(written, first)
      if (first > 1) text = text//', '
      if (is_formula(written(first:last - 1), row%high == 1)) then
        call evaluate_number(trim(adjustl(written(first:last - 1))), angle_unit, value, wrong)
        if (allocated(wrong%words)) then
          problem = "'"//printable(trim(adjustl(written(first:last - 1))), 40)//"': "//wrong%words
          return
        end if
        text = text//to_text(value, exact_digits(value))
      else
        text = text//trim(adjustl(written(first:last - 1)))
      end if
    end do
    written = text
  end subroutine evaluate_formulas

  !> Whether a row of the table of names is about a file.
  pure logical function names_file(row)
    type(item_row_type), intent(in) :: row   !< row of the table of names for the question

    names_file = row%name == 'file' .or. (row%group == 'output' .and. &
                                          any(row%name == [character(len=9) :: 'table', 'hdf5', 'sketch', 'animation']))
  end function names_file

  !> Whether a text has blanks and no quotes: words that may mean anything rather than the name of a file.
  pure logical function wants_quotes(line)
    character(len=*), intent(in) :: line     !< the answer, without blanks around it

    wants_quotes = index(line, ' ') > 0 .and. scan(line, '''"') /= 1
  end function wants_quotes

  !> Read values in full form, and check them against a row of the grammar.
  pure subroutine read_values(row, written, text, problem)
    type(item_row_type), intent(in) :: row                   !< row of the table of names for the question
    character(len=*), intent(in) :: written                  !< values in full form
    character(len=:), allocatable, intent(out) :: text       !< values as a data file writes them
    character(len=:), allocatable, intent(inout) :: problem  !< stays empty where the values are right
    type(source_type) :: source
    type(item_type) :: item, plain
    type(diagnostics_type) :: diagnostics
    integer :: at, number

    source = source_from_text('answer', trim(row%name)//' = '//written, is_file=.false.)
    call diagnostics%add_source(source, number)
    at = 1
    call parse_item(source%text, at, number, item, diagnostics)
    text = values_text(source%text, item%values)
    if (at <= len(source%text)) then
      problem = "'"//printable(source%text(at:), 40)//"' cannot stand in an answer"//advice(source%text(at:at))
      return
    end if
    plain%name = item%name
    plain%span = item%span
    call expand_repeats(item, plain%values, diagnostics)
    call check_item(plain, row, diagnostics)
    if (diagnostics%failed()) problem = messages_of(diagnostics)
  end subroutine read_values

  !> The advice for a letter that cannot stand in an answer; empty if there is none.
  pure function advice(mark) result(text)
    character, intent(in) :: mark  !< first letter that cannot be read
    character(len=:), allocatable :: text

    text = ''
    if (mark == '/') text = '; write a quotient as a number, 0.5 instead of 1/2'
  end function advice

  !> The messages of the errors, each once and in a line of its own, at most a few.
  pure function messages_of(diagnostics) result(text)
    type(diagnostics_type), intent(in) :: diagnostics  !< the errors that were found
    character(len=:), allocatable :: text, message
    type(span_type) :: span
    integer, parameter :: most = 4
    integer :: i, shown

    text = ''
    shown = 0
    do i = 1, diagnostics%known()
      call diagnostics%get(i, message, span)
      ! a word that is repeated gives one message
      if (index(new_line('a')//text, new_line('a')//message//new_line('a')) > 0) cycle
      shown = shown + 1
      if (shown <= most) text = text//message//new_line('a')
    end do
    if (shown > most) then
      text = text//'and '//to_text(shown - most)//' more'
    else if (text /= '') then
      text = text(:len(text) - 1)
    end if
  end function messages_of

  !> A text in quotes, with its own quotes doubled.
  pure function quoted(line) result(text)
    character(len=*), intent(in) :: line  !< the text without quotes around it
    character(len=:), allocatable :: text

    text = ''''//with_escapes(line, '''', [''''''])//''''
  end function quoted

  !> Words with commas between them, each in quotes.
  pure function quoted_words(line) result(text)
    character(len=*), intent(in) :: line  !< the words without quotes around them
    character(len=:), allocatable :: text
    integer :: first, comma

    text = ''
    first = 1
    do while (first <= len(line))
      comma = index(line(first:)//',', ',') + first - 1
      if (text /= '') text = text//', '
      text = text//quoted(trim(adjustl(line(first:comma - 1))))
      first = comma + 1
    end do
  end function quoted_words

  !> A switch as a data file writes it; an answer other than yes or no stays as it is.
  pure function switch_text(line) result(text)
    character(len=*), intent(in) :: line  !< the answer, without blanks around it
    character(len=:), allocatable :: text

    text = line
    if (yes_or_no(line) == 'yes') text = '.true.'
    if (yes_or_no(line) == 'no') text = '.false.'
  end function switch_text

  !> 'yes' or 'no' for the usual ways to type them; empty for anything else.
  pure function yes_or_no(line) result(word)
    character(len=*), intent(in) :: line  !< the answer, without blanks around it
    character(len=:), allocatable :: word

    select case (lower(line))
    case ('yes', 'y')
      word = 'yes'
    case ('no', 'n')
      word = 'no'
    case default
      word = ''
    end select
  end function yes_or_no

  !> Whether a text has a control character other than a tab.
  pure logical function has_control_byte(line)
    character(len=*), intent(in) :: line  !< the answer, without blanks around it
    integer :: i

    has_control_byte = .true.
    do i = 1, len(line)
      if ((iachar(line(i:i)) < 32 .and. line(i:i) /= achar(9)) .or. iachar(line(i:i)) == 127) return
    end do
    has_control_byte = .false.
  end function has_control_byte
end module mech9_answer
