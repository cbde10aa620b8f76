!> The small pieces of namelist text: blanks, names, subscripts, values.
!>
!> Each procedure starts at byte `at` of the text and leaves `at` on the first byte it did not take.
module mech9_scanner
  use mech9_kinds, only: wp
  use mech9_text, only: lower
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_source, only: span_type
  use mech9_document, only: value_type, subscript_type, value_integer, value_real, value_logical, &
                            value_text, value_word, value_bad
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: skip_blanks, skip_line, next_is_name, scan_word, scan_subscripts, scan_value, is_letter, blanks

  character(len=*), parameter :: line_ends = achar(10)//achar(13)
  character(len=*), parameter :: blanks = ' '//achar(9)//achar(11)//achar(12)//line_ends
  character(len=*), parameter :: digits = '0123456789'
  character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'
  character(len=*), parameter :: name_letters = letters//digits//'_'
  !> Characters that end a value that is not in quotes.
  character(len=*), parameter :: separators = blanks//',;/!&()="'''

contains

  !> Whether the byte is a letter; false beyond the end.
  pure logical function is_letter(text, at)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(in) :: at             !< number of a byte; it may be beyond the end

    is_letter = .false.
    if (at <= len(text)) is_letter = index(letters, text(at:at)) > 0
  end function is_letter

  !> Go on over blanks, line ends and comments.
  pure subroutine skip_blanks(text, at)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(inout) :: at          !< number of a byte: where to begin, then the first byte not taken

    do while (at <= len(text))
      if (text(at:at) == '!') then
        call skip_line(text, at)
      else if (index(blanks, text(at:at)) > 0) then
        at = at + 1
      else
        return
      end if
    end do
  end subroutine skip_blanks

  !> Go on to the end of the line.
  pure subroutine skip_line(text, at)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(inout) :: at          !< number of a byte: where to begin, then the first byte not taken

    do while (at <= len(text))
      if (index(line_ends, text(at:at)) > 0) return
      at = at + 1
    end do
  end subroutine skip_line

  !> Take letters, digits and underscores.
  pure subroutine scan_word(text, at)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(inout) :: at          !< number of a byte: where to begin, then the first byte not taken

    do while (at <= len(text))
      if (index(name_letters, text(at:at)) == 0) return
      at = at + 1
    end do
  end subroutine scan_word

  !> Whether a name begins at a byte: a word, perhaps with subscripts, before an equals sign.
  pure logical function next_is_name(text, start)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(in) :: start          !< number of the byte where the name may begin
    integer :: at, closing

    next_is_name = .false.
    if (.not. is_letter(text, start)) return
    at = start
    call scan_word(text, at)
    call skip_blanks(text, at)
    if (at > len(text)) return
    if (text(at:at) == '(') then
      closing = verify(text(at + 1:), digits//':,'//blanks)
      if (closing == 0) return
      at = at + closing
      if (text(at:at) /= ')') return
      at = at + 1
      call skip_blanks(text, at)
      if (at > len(text)) return
    end if
    next_is_name = text(at:at) == '='
  end function next_is_name

  !> Take subscripts: "(2)", "(1,:)", "(2:4)"; `ok` is false where the text has another form.
  pure subroutine scan_subscripts(text, at, subscripts, ok)
    character(len=*), intent(in) :: text                             !< the whole text of the source
    integer, intent(inout) :: at  !< number of a byte: that of the parenthesis, then the first byte not taken
    type(subscript_type), allocatable, intent(out) :: subscripts(:)  !< the subscripts, in their order
    logical, intent(out) :: ok                                       !< whether they are subscripts
    type(subscript_type) :: one

    allocate (subscripts(0))
    ok = .true.
    do
      at = at + 1
      one = subscript_type()
      call scan_index(text, at, one%first, ok)
      if (at > len(text)) ok = .false.
      if (.not. ok) return
      if (text(at:at) == ':') then
        one%section = .true.
        at = at + 1
        call scan_index(text, at, one%last, ok)
        if (at > len(text)) ok = .false.
        if (.not. ok) return
      end if
      ok = one%section .or. one%first > 0
      subscripts = [subscripts, one]
      if (.not. ok .or. text(at:at) /= ',') exit
    end do
    ok = ok .and. text(at:at) == ')' .and. size(subscripts) <= 2
    if (ok) at = at + 1
  end subroutine scan_subscripts

  !> Take a positive whole number with blanks around it, if there is one.
  pure subroutine scan_index(text, at, index_value, ok)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(inout) :: at          !< number of a byte: where to begin, then the first byte not taken
    integer, intent(out) :: index_value   !< the number; 0 where there is none
    logical, intent(inout) :: ok          !< set to false where the number is too large or zero
    integer :: first

    index_value = 0
    call skip_blanks(text, at)
    first = at
    do while (at <= len(text))
      if (index(digits, text(at:at)) == 0) exit
      if (at - first >= 9) ok = .false.
      if (ok) index_value = 10*index_value + index(digits, text(at:at)) - 1
      at = at + 1
    end do
    if (at > first .and. index_value == 0) ok = .false.   ! subscripts begin at 1
    call skip_blanks(text, at)
  end subroutine scan_index

  !> Take one value; text that cannot be one is reported and becomes a bad value.
  pure subroutine scan_value(text, at, source, value, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole text of the source
    integer, intent(inout) :: at                          !< number of a byte: where to begin, then the first byte not taken
    integer, intent(in) :: source                         !< number of the source, for spans
    type(value_type), intent(out) :: value                !< the value with its kind and place
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: first, star

    first = at
    do while (at <= len(text))
      if (index(separators, text(at:at)) > 0) exit
      at = at + 1
    end do
    star = index(text(first:at - 1), '*')
    if (star > 1) then
      if (verify(text(first:first + star - 2), digits) == 0) then
        call read_repeat(text(first:first + star - 2), value%times)
        if (value%times == 0) then
          value%kind = value_bad
          value%span = span_type(source, first, at - 1)
          call diagnostics%add(value%span, '''r*'' repeats a value r times; r must be a positive whole number')
          return
        end if
        first = first + star
      end if
    end if

    value%span = span_type(source, first, at - 1)
    if (first < at) then
      call classify(text(first:at - 1), value, diagnostics)
    else if (at <= len(text)) then
      if (scan(text(at:at), '"''') > 0) then
        call scan_text(text, at, source, value, diagnostics)
      else if (star > 1) then
        value%span = span_type(source, first - star, at - 1)   ! "3*" alone: three empty values
      else
        value%span = span_type(source, at, at)
        value%kind = value_bad
        call diagnostics%add(value%span, 'unexpected '''//text(at:at)//''''//trim(advice(text(at:at))))
        at = at + 1
      end if
    end if
  end subroutine scan_value

  !> Advice for an unexpected character; blank where there is none.
  pure function advice(mark) result(text)
    character, intent(in) :: mark  !< the unexpected character
    character(len=64) :: text

    select case (mark)
    case (';')
      text = '; values are separated by commas or blanks'
    case ('(')
      text = '; write values one after the other, without parentheses'
    case ('=')
      text = '; write name = value'
    case default
      text = ''
    end select
  end function advice

  !> The r of r*value; 0 where it is zero or longer than any list.
  pure subroutine read_repeat(text, times)
    character(len=*), intent(in) :: text  !< digits
    integer, intent(out) :: times         !< the number; 0 where it is zero or too large
    type(numeral_type) :: numeral

    times = 0
    call read_numeral(text, numeral)
    if (allocated(numeral%problem)) return
    if (numeral%number <= 1.0e9_wp) times = int(numeral%whole)
  end subroutine read_repeat

  !> Determine the kind of a value without quotes, and its value.
  pure subroutine classify(word, value, diagnostics)
    character(len=*), intent(in) :: word                  !< the value as it is written
    type(value_type), intent(inout) :: value              !< the value with its kind and place
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(numeral_type) :: numeral

    select case (lower(word))
    case ('t', 'true', '.t.', '.true.', '.true', '.t')
      value%kind = value_logical
      value%truth = .true.
      return
    case ('f', 'false', '.f.', '.false.', '.false', '.f')
      value%kind = value_logical
      return
    end select
    call read_numeral(word, numeral)
    if (.not. allocated(numeral%problem)) then
      value%kind = merge(value_integer, value_real, numeral%is_integer)
      value%whole = numeral%whole
      value%number = numeral%number
    else if (is_letter(word, 1) .and. index(numeral%problem, 'finite') == 0) then
      value%kind = value_word
      value%text = word
    else
      value%kind = value_bad
      call diagnostics%add(value%span, ''''//diagnostics%text_of(value%span)//''' '//numeral%problem)
    end if
  end subroutine classify

  !> Take a text in quotes; a doubled quote stands for one. It must end on its line: a forgotten
  !> quote would otherwise turn the rest of the file into text.
  pure subroutine scan_text(text, at, source, value, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole text of the source
    integer, intent(inout) :: at                          !< number of a byte: where to begin, then the first byte not taken
    integer, intent(in) :: source                         !< number of the source, for spans
    type(value_type), intent(inout) :: value              !< the value with its kind and place
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: first
    logical :: closed

    first = at
    call find_closing_quote(text, at, closed)
    if (closed) then
      value%kind = value_text
      call undouble(text(first + 1:at - 1), text(first:first), value%text)
      value%span = span_type(source, first, at)
      at = at + 1
    else
      value%kind = value_bad
      value%span = span_type(source, first, at - 1)
      call diagnostics%add(span_type(source, first, first), 'the text that begins here has no closing '//text(first:first))
      if (closes_group(text(first:at - 1))) at = first + len_trim(text(first:at - 1)) - 1
    end if
  end subroutine scan_text

  !> Go on from an opening quote to the closing one, or to the end of the line.
  pure subroutine find_closing_quote(text, at, closed)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(inout) :: at          !< number of a byte: where to begin, then the first byte not taken
    logical, intent(out) :: closed        !< whether the closing quote stands on this line
    integer :: first

    first = at
    closed = .false.
    do
      at = at + 1
      if (at > len(text)) return
      if (index(line_ends, text(at:at)) > 0) return
      if (text(at:at) /= text(first:first)) cycle
      closed = .true.
      if (at == len(text)) return
      if (text(at + 1:at + 1) /= text(first:first)) return
      closed = .false.
      at = at + 1
    end do
  end subroutine find_closing_quote

  !> The text with each doubled quote written once.
  pure subroutine undouble(text, quote, content)
    character(len=*), intent(in) :: text                   !< the text between the quotes
    character, intent(in) :: quote                         !< the quotation mark that is doubled
    character(len=:), allocatable, intent(out) :: content  !< the text without doubled quotes
    integer :: i, n

    content = text
    n = 0
    i = 0
    do while (i < len(text))
      i = i + 1
      n = n + 1
      content(n:n) = text(i:i)
      if (text(i:i) == quote) i = i + 1
    end do
    content = content(:n)
  end subroutine undouble

  !> Whether a line with a forgotten quote ends with a slash, which then most likely ends the group.
  pure logical function closes_group(line)
    character(len=*), intent(in) :: line  !< the rest of the line, from the opening quote

    closes_group = .false.
    if (len_trim(line) > 1) closes_group = line(len_trim(line):len_trim(line)) == '/'
  end function closes_group
end module mech9_scanner
