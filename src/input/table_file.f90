!> The file of a table drive: lines with t and q.
!>
!> Each line holds two numbers, with blanks or a comma between; `#` begins a comment. A line of names may stand before
!> the first point.
module mech9_table_file
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text, lower, starts_with
  use mech9_source, only: source_type, span_type, read_source
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_item_check, only: is_sensible
  use mech9_diagnostics, only: diagnostics_type, printable
  implicit none
  private
  public :: read_table_file

  character(len=*), parameter :: gaps = ' ,'//achar(9)//achar(13)
  integer, parameter :: fewest_points = 4  !< fewest points of a cubic spline

contains

  !> Read the points of a table. Errors are reported with their places in that file; `ok` is false where there are any.
  subroutine read_table_file(path, asked_at, t, q, ok, diagnostics)
    character(len=*), intent(in) :: path                  !< path of the table
    type(span_type), intent(in) :: asked_at               !< place of its name in the data file
    real(wp), allocatable, intent(out) :: t(:)            !< times [s]
    real(wp), allocatable, intent(out) :: q(:)            !< values of the coordinate, in the unit of the file
    logical, intent(out) :: ok                            !< whether no error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    type(source_type) :: source
    type(error_type), allocatable :: err
    integer :: number, line, n, found
    logical :: may_be_names

    ok = .false.
    allocate (t(0), q(0))
    call read_source(path, source, err)
    if (allocated(err)) then
      call diagnostics%add(asked_at, 'the table '''//printable(path)//''': '//err%message, err%code)
      return
    end if
    call diagnostics%add_source(source, number)
    found = diagnostics%count
    deallocate (t, q)
    allocate (t(size(source%line_start)), q(size(source%line_start)))
    n = 0
    may_be_names = .true.
    do line = 1, size(source%line_start)
      call read_point(source, number, line, may_be_names, t, q, n, diagnostics)
    end do
    t = t(:n)
    q = q(:n)
    if (diagnostics%count == found .and. n < fewest_points) &
      call diagnostics%add(span_type(number, 0, 0), 'a smooth curve needs at least '//to_text(fewest_points)// &
                           ' points, and the table has '//to_text(n))
    ok = diagnostics%count == found
  end subroutine read_table_file

  !> Take the point of a line, if there is one.
  pure subroutine read_point(source, number, line, may_be_names, t, q, n, diagnostics)
    type(source_type), intent(in) :: source               !< the text of the table
    integer, intent(in) :: number                         !< number of the table as a source, for spans
    integer, intent(in) :: line                           !< number of the line, from 1
    logical, intent(inout) :: may_be_names                !< whether no earlier line held a name or a number
    real(wp), intent(inout) :: t(:)                       !< times [s]; the first n are in use
    real(wp), intent(inout) :: q(:)                       !< values, in the unit of the file; the first n are in use
    integer, intent(inout) :: n                           !< how many points are in use
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    type(span_type) :: fields(2)
    type(numeral_type) :: numerals(2)
    integer :: first, last, count, i

    call source%line_bounds(line, first, last)
    call split(source%text, first, last, number, fields, count)
    if (count == 0) return
    if (may_be_names) then
      may_be_names = .false.
      if (are_names(source%text(first:last))) return
    end if
    if (count /= 2) then
      call diagnostics%add(span_type(number, first, max(first, last)), 'each line holds two numbers, t and q; this one has '// &
                           to_text(count))
      return
    end if
    do i = 1, 2
      call read_numeral(source%text(fields(i)%first:fields(i)%last), numerals(i))
      if (.not. allocated(numerals(i)%problem)) then
        if (is_sensible(numerals(i)%number)) cycle
        numerals(i)%problem = 'is too large or too small; numbers are 0 or between 1e-100 and 1e100'
      end if
      call diagnostics%add(fields(i), ''''//diagnostics%text_of(fields(i))//''' '//numerals(i)%problem)
      return
    end do
    if (n > 0) then
      ! between nearer points a slope would be round-off only
      if (numerals(1)%number - t(n) <= 1.0e-13_wp*max(abs(numerals(1)%number), abs(t(n)))) then
        call diagnostics%add(fields(1), 't must increase from line to line')
        return
      end if
    end if
    n = n + 1
    t(n) = numerals(1)%number
    q(n) = numerals(2)%number
  end subroutine read_point

  !> Whether a line holds names of columns: none of its words begins as a number does, or means one that is not finite.
  pure logical function are_names(line)
    character(len=*), intent(in) :: line  !< a line of the table
    character(len=:), allocatable :: rest
    integer :: at

    are_names = .false.
    rest = lower(line)
    do
      at = verify(rest, gaps)
      if (at == 0) exit
      rest = rest(at:)
      if (rest(1:1) == '#') exit
      if (scan(rest(1:1), '0123456789+-.') > 0 .or. starts_with(rest, 'nan') .or. starts_with(rest, 'inf')) return
      at = scan(rest, gaps//'#')
      if (at == 0) exit
      rest = rest(at:)
    end do
    are_names = .true.
  end function are_names

  !> Find the words of a line up to its comment; words after the second are only counted.
  pure subroutine split(text, first, last, source, fields, count)
    character(len=*), intent(in) :: text       !< the whole text of the table
    integer, intent(in) :: first               !< number of the line's first byte
    integer, intent(in) :: last                !< number of the line's last byte
    integer, intent(in) :: source              !< number of the table as a source, for spans
    type(span_type), intent(out) :: fields(2)  !< places of the first two words
    integer, intent(out) :: count              !< how many words the line has
    integer :: at, start

    count = 0
    at = first
    do
      do while (at <= last)
        if (index(gaps, text(at:at)) == 0) exit
        at = at + 1
      end do
      if (at > last) return
      if (text(at:at) == '#') return
      start = at
      do while (at <= last)
        if (index(gaps//'#', text(at:at)) > 0) exit
        at = at + 1
      end do
      count = count + 1
      if (count <= 2) fields(count) = span_type(source, start, at - 1)
    end do
  end subroutine split
end module mech9_table_file
