!> The errors of an input: each with its place, sorted, and shown with its line of the file.
module mech9_diagnostics
  use mech9_error, only: error_type, place_type, exit_done, exit_data, exit_structure, exit_file
  use mech9_text, only: to_text
  use mech9_part_names, only: part_names_type, add_names
  use mech9_explanation, only: explain
  use mech9_source, only: source_type, span_type
  implicit none
  private
  public :: diagnostics_type, printable

  !> A text made safe to print.
  interface printable
    module procedure printable_text, printable_beginning
  end interface printable

  type :: diagnostic_type
    type(span_type) :: span
    character(len=:), allocatable :: message
    integer :: code = exit_data
  end type diagnostic_type

  type :: diagnostics_type
    !> The texts that spans point into; the first one is the data file.
    type(source_type), allocatable :: sources(:)
    type(part_names_type) :: names    !< of links and pairs, which stand behind numbers in messages
    integer :: count = 0  !< errors found, also those that are no longer kept
    type(diagnostic_type), allocatable, private :: kept(:)
    integer, private :: kept_count = 0
  contains
    procedure :: add
    procedure :: add_error
    procedure :: add_source
    procedure :: is_setting
    procedure :: clear
    procedure :: failed
    procedure :: code
    procedure :: place
    procedure :: text_of
    procedure :: known
    procedure :: sorted
    procedure :: get
    procedure :: render
    procedure :: report
  end type diagnostics_type

  integer, parameter :: most_kept = 1000  !< errors that are kept; a file with more is no data file
  integer, parameter :: most_shown = 20
  integer, parameter :: window = 100        !< columns of a line that are shown
  integer, parameter :: margin = 33         !< columns shown before the place of the error
  integer, parameter :: longest_quote = 40  !< longest text that a message quotes

contains

  !> Add an error. A span with source 0 means that it has no place.
  pure subroutine add(self, span, message, code)
    class(diagnostics_type), intent(inout) :: self  !< the diagnostics
    type(span_type), intent(in) :: span             !< place of the error in its source; source 0: none
    character(len=*), intent(in) :: message         !< the error in words
    integer, intent(in), optional :: code           !< exit code for this error; exit_data if absent

    self%count = self%count + 1
    if (.not. allocated(self%kept)) allocate (self%kept(16))
    if (self%kept_count >= most_kept) return
    if (self%kept_count == size(self%kept)) call grow(self%kept)
    self%kept_count = self%kept_count + 1
    associate (new => self%kept(self%kept_count))
      new%span = span
      new%message = message
      if (present(code)) new%code = code
    end associate
  end subroutine add

  !> Add a failure of another floor; its place is one in the data file or in a setting.
  pure subroutine add_error(self, err)
    class(diagnostics_type), intent(inout) :: self  !< the diagnostics
    type(error_type), intent(in) :: err             !< the failure
    type(error_type) :: explained
    type(span_type) :: span
    integer :: byte

    explained = err
    call explain(explained)
    if (err%place%line > 0 .and. allocated(self%sources)) then
      associate (source => self%sources(err%place%source))
        byte = source%byte_at(err%place)
        if (byte > 0) span = span_type(err%place%source, byte, byte + word_length(source%text(byte:)) - 1)
      end associate
    end if
    call self%add(span, explained%message, err%code)
  end subroutine add_error

  !> Length of the word at the beginning of a text, for the carets under it; at least 1.
  pure integer function word_length(text) result(length)
    character(len=*), intent(in) :: text  !< the text from the first byte of the word to the end of the file

    length = scan(text(min(2, len(text)):), ' ,/=()'//achar(9)//achar(10)//achar(13))
    if (length == 0) length = len(text)
    length = max(length, 1)
  end function word_length

  !> Make room for more errors.
  pure subroutine grow(kept)
    type(diagnostic_type), allocatable, intent(inout) :: kept(:)  !< the errors; their number of places is doubled
    type(diagnostic_type), allocatable :: grown(:)

    allocate (grown(2*size(kept)))
    grown(:size(kept)) = kept
    call move_alloc(grown, kept)
  end subroutine grow

  !> Add a text that spans will point into.
  pure subroutine add_source(self, source, number)
    class(diagnostics_type), intent(inout) :: self  !< the diagnostics
    type(source_type), intent(in) :: source         !< the text that spans will point into
    integer, intent(out) :: number                  !< number of the source, for spans
    type(source_type), allocatable :: grown(:)

    number = 1
    if (allocated(self%sources)) number = size(self%sources) + 1
    allocate (grown(number))
    if (number > 1) grown(:number - 1) = self%sources
    grown(number) = source
    call move_alloc(grown, self%sources)
  end subroutine add_source

  !> Whether a span stands in a setting of --set, not in groups of a file or of a mechanism in memory.
  pure logical function is_setting(self, span)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics
    type(span_type), intent(in) :: span          !< bytes of a source

    is_setting = .false.
    if (span%source > 1) is_setting = self%sources(span%source)%name == '--set'
  end function is_setting

  !> Forget all errors, and keep the sources.
  pure subroutine clear(self)
    class(diagnostics_type), intent(inout) :: self  !< the diagnostics

    self%count = 0
    self%kept_count = 0
    if (allocated(self%kept)) deallocate (self%kept)
  end subroutine clear

  !> Whether there are errors.
  pure logical function failed(self)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics

    failed = self%count > 0
  end function failed

  !> The exit code of the gravest error: an unreadable file before wrong data before a wrong structure.
  pure integer function code(self)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics
    integer, parameter :: order(3) = [exit_file, exit_data, exit_structure]
    integer :: i

    code = exit_done
    if (self%kept_count == 0) return
    do i = 1, size(order)
      code = order(i)
      if (any(self%kept(:self%kept_count)%code == code)) return
    end do
    code = self%kept(1)%code
  end function code

  !> Line and column of a span; line 0 for a span that is nowhere.
  pure type(place_type) function place(self, span)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics
    type(span_type), intent(in) :: span          !< bytes of a source

    if (span%source == 0 .or. span%first == 0) return
    place = self%sources(span%source)%place(span%first)
    place%source = span%source
  end function place

  !> Length of a text that is cut where it is too long.
  pure integer function cut_length(text, longest) result(length)
    character(len=*), intent(in) :: text  !< the text that is shown
    integer, intent(in) :: longest        !< most bytes that are shown

    length = len(text)
    if (length > longest) length = character_start(text, longest, 1) - 1 + len('...')
  end function cut_length

  !> Length of the result of text_of.
  pure integer function length_of(self, span) result(length)
    type(diagnostics_type), intent(in) :: self  !< the diagnostics
    type(span_type), intent(in) :: span         !< the bytes that are quoted

    length = 0
    if (span%source == 0) return
    length = cut_length(self%sources(span%source)%text(span%first:span%last), longest_quote)
  end function length_of

  !> A span as it is written, for messages: short and printable.
  pure function text_of(self, span) result(text)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics
    type(span_type), intent(in) :: span          !< the bytes that are quoted
    character(len=length_of(self, span)) :: text

    if (span%source == 0) return
    text = printable(self%sources(span%source)%text(span%first:span%last), longest_quote)
  end function text_of

  !> The number of errors that `get` and `render` can return.
  pure integer function known(self)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics

    known = self%kept_count
  end function known

  !> Error number i in the order in which they were found: its message alone, and its place.
  pure subroutine get(self, i, message, span)
    class(diagnostics_type), intent(in) :: self            !< the diagnostics
    integer, intent(in) :: i                               !< number of the error, from 1 to known()
    character(len=:), allocatable, intent(out) :: message  !< the error in words
    type(span_type), intent(out) :: span                   !< place of the error; source 0: none

    message = self%kept(i)%message
    call add_names(self%names, message)
    span = self%kept(i)%span
  end subroutine get

  !> Error number i in the order of the places, as it is shown: message, line, carets.
  pure subroutine render(self, i, text)
    class(diagnostics_type), intent(in) :: self         !< the diagnostics
    integer, intent(in) :: i                            !< position of the error in the order of places, from 1
    character(len=:), allocatable, intent(out) :: text  !< the lines to show, without a line end after the last
    type(diagnostic_type) :: this
    type(place_type) :: position
    integer, allocatable :: order(:)

    order = self%sorted()
    this = self%kept(order(i))
    call add_names(self%names, this%message)
    if (this%span%source == 0) then
      text = this%message
      if (allocated(self%sources)) text = printable(self%sources(1)%name)//': '//text
      return
    end if
    associate (source => self%sources(this%span%source))
      text = printable(source%name)//':'
      if (this%span%first > 0 .and. source%is_file) then
        position = source%place(this%span%first)
        text = text//to_text(position%line)//':'//to_text(position%column)//':'
      end if
      text = text//' '//this%message
      if (this%span%first > 0) call append_excerpt(source, this%span, text)
    end associate
  end subroutine render

  !> Print the errors in the order of their places, at most twenty of them.
  subroutine report(self, unit)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics
    integer, intent(in) :: unit                  !< Fortran unit to write to
    character(len=:), allocatable :: text
    integer :: i

    do i = 1, min(self%kept_count, most_shown)
      call self%render(i, text)
      write (unit, '(a)') text
    end do
    if (self%count > most_shown) &
      write (unit, '(3a)') 'and ', to_text(self%count - most_shown), ' more'
  end subroutine report

  !> Positions of the kept errors by source, then by place; those without a place come last.
  pure function sorted(self) result(order)
    class(diagnostics_type), intent(in) :: self  !< the diagnostics
    integer, allocatable :: order(:)
    integer :: i, j, new

    allocate (order(self%kept_count))
    do i = 1, self%kept_count
      new = i
      j = i - 1
      do while (j >= 1)
        if (.not. before(self%kept(new)%span, self%kept(order(j))%span)) exit
        order(j + 1) = order(j)
        j = j - 1
      end do
      order(j + 1) = new
    end do
  end function sorted

  !> Whether the first of two places is shown before the other.
  pure logical function before(a, b)
    type(span_type), intent(in) :: a  !< the place that may come first
    type(span_type), intent(in) :: b  !< the place that it is compared with

    if (a%source == b%source) then
      before = a%first < b%first
    else
      before = a%source > 0 .and. (a%source < b%source .or. b%source == 0)
    end if
  end function before

  !> Append the line of a span with carets under the span; of a long line, a window around it.
  pure subroutine append_excerpt(source, span, text)
    type(source_type), intent(in) :: source               !< the text that the span points into
    type(span_type), intent(in) :: span                   !< the place that gets carets
    character(len=:), allocatable, intent(inout) :: text  !< the message, to which two lines are appended
    character(len=:), allocatable :: line, carets
    type(place_type) :: position
    integer :: first, last, from, to, i

    position = source%place(span%first)
    call source%line_bounds(position%line, first, last)
    from = first
    to = last
    if (to - from + 1 > window) then
      from = max(first, min(span%first - margin, last - window + 1))
      to = from + window - 1
      from = character_start(source%text, from, first)
      to = character_start(source%text, to + 1, first) - 1
    end if
    line = printable(source%text(from:to))
    carets = repeat(' ', count_characters(source%text(from:span%first - 1)))
    do i = 1, min(len(carets), len(line))
      if (line(i:i) == achar(9)) carets(i:i) = achar(9)   ! a blank under a tab would shift the carets
    end do
    carets = carets//repeat('^', max(1, count_characters(source%text(span%first:min(span%last, to)))))
    if (from > first) then
      line = '...'//line
      carets = '   '//carets
    end if
    if (to < last) line = line//'...'
    text = text//new_line('a')//line//new_line('a')//carets
  end subroutine append_excerpt

  !> The first byte of the character that byte `at` belongs to.
  pure integer function character_start(text, at, least) result(start)
    character(len=*), intent(in) :: text  !< a text in UTF-8
    integer, intent(in) :: at             !< number of a byte; it may be one beyond the end
    integer, intent(in) :: least          !< lowest result allowed

    start = at
    if (at > len(text)) return
    do while (start > least)
      if (iachar(text(start:start)) < 128 .or. iachar(text(start:start)) >= 192) exit
      start = start - 1
    end do
  end function character_start

  !> Number of characters of a text.
  pure integer function count_characters(text) result(n)
    character(len=*), intent(in) :: text  !< a text in UTF-8
    integer :: i

    n = 0
    do i = 1, len(text)
      if (iachar(text(i:i)) < 128 .or. iachar(text(i:i)) >= 192) n = n + 1
    end do
  end function count_characters

  !> A text of any origin, safe to print: control bytes become question marks (tabs stay).
  pure function printable_text(text) result(shown)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=len(text)) :: shown
    integer :: i

    shown = text
    do i = 1, len(shown)
      if ((iachar(shown(i:i)) < 32 .and. shown(i:i) /= achar(9)) .or. iachar(shown(i:i)) == 127) shown(i:i) = '?'
    end do
  end function printable_text

  !> The beginning of a text, safe to print, of at most `longest` bytes.
  pure function printable_beginning(text, longest) result(shown)
    character(len=*), intent(in) :: text  !< any bytes
    integer, intent(in) :: longest        !< most bytes of the result
    character(len=cut_length(text, longest)) :: shown

    shown = printable_text(text)
    if (len(text) > longest) shown = printable_text(text(:len(shown) - len('...')))//'...'
  end function printable_beginning
end module mech9_diagnostics
