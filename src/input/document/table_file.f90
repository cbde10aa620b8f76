!> Files of points: lines with t and q of a law of time, or with x, y and z of a curve.
!>
!> Each line holds two numbers, those of a curve in space three, with blanks or a comma between; `#` begins a comment. A
!> line of names may stand before the first point.
module mech9_table_file
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type, place_words
  use mech9_text, only: to_text, lower, starts_with
  use mech9_counted, only: counted
  use mech9_source, only: source_type, span_type, read_source
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_item_check, only: is_sensible
  use mech9_diagnostics, only: diagnostics_type, printable
  implicit none
  private
  public :: read_table_file, read_curve_file, beside

  character(len=*), parameter :: gaps = ' ,'//achar(9)//achar(13)
  integer, parameter :: fewest_points = 4  !< fewest points of a cubic spline

  !> A file of points while its lines are read.
  type :: point_file_type
    type(source_type) :: source       !< its text
    integer :: number = 0             !< of the file among the sources, for spans
    logical :: may_be_names = .true.  !< no line so far held a name or a number
  end type point_file_type

contains

  !> Read the points of a table. Errors are reported with their places in that file; `ok` is false where there are any.
  subroutine read_table_file(path, asked_at, of_first, of_second, points, ok, diagnostics)
    character(len=*), intent(in) :: path                  !< path of the table
    type(span_type), intent(in) :: asked_at               !< place of its name in the data file
    character(len=*), intent(in) :: of_first              !< name of the first number of each line, for messages
    character(len=*), intent(in) :: of_second             !< name of the second one
    real(wp), allocatable, intent(out) :: points(:, :)    !< (2,n) both numbers of each line, in the units of the file
    logical, intent(out) :: ok                            !< whether no error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(point_file_type) :: file
    type(error_type), allocatable :: err
    integer :: line, n, found

    ok = .false.
    allocate (points(2, 0))
    call read_source(path, file%source, err)
    if (allocated(err)) then
      call diagnostics%add(asked_at, 'the table '''//printable(path)//''': '//err%message, err%code)
      return
    end if
    call diagnostics%add_source(file%source, file%number)
    found = diagnostics%count
    deallocate (points)
    allocate (points(2, size(file%source%line_start)))
    n = 0
    do line = 1, size(file%source%line_start)
      call read_point(file, line, of_first, of_second, points, n, diagnostics)
    end do
    points = points(:, :n)
    if (diagnostics%count == found .and. n < fewest_points) &
      call diagnostics%add(span_type(file%number, 0, 0), 'a smooth curve needs at least '//to_text(fewest_points)// &
                           ' points, and the table has '//to_text(n))
    ok = diagnostics%count == found
  end subroutine read_table_file

  !> Take the point of a line, if there is one.
  pure subroutine read_point(file, line, of_first, of_second, points, n, diagnostics)
    type(point_file_type), intent(inout) :: file          !< the table
    integer, intent(in) :: line                           !< number of the line, from 1
    character(len=*), intent(in) :: of_first              !< name of its first number
    character(len=*), intent(in) :: of_second             !< name of its second number
    real(wp), intent(inout) :: points(:, :)               !< (2,) the points, in the units of the file; the first n are in use
    integer, intent(inout) :: n                           !< how many points are in use
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(span_type) :: fields(2), whole
    real(wp) :: numbers(2)
    integer :: count
    logical :: ok

    call find_words(file, line, fields, count, whole)
    if (count == 0) return
    if (count /= 2) then
      call diagnostics%add(whole, 'each line holds two numbers, '//of_first//' and '//of_second//'; this one has '// &
                           to_text(count))
      return
    end if
    call read_words(file%source, fields, numbers, ok, diagnostics)
    if (.not. ok) return
    if (n > 0) then
      ! between nearer points a slope would be round-off only
      if (numbers(1) - points(1, n) <= 1.0e-13_wp*max(abs(numbers(1)), abs(points(1, n)))) then
        call diagnostics%add(fields(1), of_first//' must increase from line to line')
        return
      end if
    end if
    n = n + 1
    points(:, n) = numbers
  end subroutine read_point

  !> Read the points of a curve: x and y in each line, or x, y and z. Errors are reported with their places in that file; `ok` is
  !> false where there are any.
  subroutine read_curve_file(path, asked_at, chosen, fewest, points, spans, corners, ok, diagnostics)
    character(len=*), intent(in) :: path                  !< path of the file
    type(span_type), intent(in) :: asked_at               !< place of its name in the data file
    integer, intent(in) :: chosen(:)                      !< columns of x, y and perhaps z; none: the file has no others
    integer, intent(in) :: fewest                         !< number of points that are needed
    real(wp), allocatable, intent(out) :: points(:, :)    !< (3,n) [m]; z is 0 in a plane
    type(span_type), allocatable, intent(out) :: spans(:) !< (n) places of the points in the file
    logical, allocatable, intent(out) :: corners(:)       !< (n) an empty line parts the point from the next one
    logical, intent(out) :: ok                            !< whether no error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(point_file_type) :: file
    type(span_type), allocatable :: fields(:)
    type(span_type) :: whole
    type(error_type), allocatable :: err
    integer :: line, n, found, count, columns
    logical :: readable, parted

    ok = .false.
    allocate (points(3, 0), spans(0), corners(0))
    call read_source(path, file%source, err)
    if (allocated(err)) then
      call diagnostics%add(asked_at, 'the curve '''//printable(path)//''': '//err%message, err%code)
      return
    end if
    call diagnostics%add_source(file%source, file%number)
    found = diagnostics%count
    deallocate (points, spans, corners)
    allocate (points(3, size(file%source%line_start)), source=0.0_wp)
    allocate (spans(size(file%source%line_start)), corners(size(file%source%line_start)))
    corners = .false.
    parted = .false.
    n = 0
    columns = size(chosen)
    ! no line has more words than the file has letters
    allocate (fields(max(3, min(maxval([0, chosen]), len(file%source%text)))))
    do line = 1, size(file%source%line_start)
      call find_words(file, line, fields, count, whole)
      if (count == 0) then
        parted = parted .or. is_blank(file%source, whole)
        cycle
      end if
      if (size(chosen) > 0) then
        call choose_fields(chosen, whole, count, fields, readable, diagnostics)
        if (.not. readable) cycle
      end if
      if (columns == 0 .and. (count == 2 .or. count == 3)) columns = count
      if (count /= columns) then
        call diagnostics%add(whole, 'each line holds the coordinates of a point, x and y in a plane or x, y and z in space; '// &
                             'this one has '//counted(count, 'number')//the_others(columns))
        cycle
      end if
      call read_words(file%source, fields(:count), points(:count, n + 1), readable, diagnostics)
      if (.not. readable) cycle
      if (parted .and. n > 0) corners(n) = .true.
      parted = .false.
      n = n + 1
      spans(n) = whole
    end do
    points = points(:, :n)
    spans = spans(:n)
    corners = corners(:n)
    if (diagnostics%count == found .and. n < fewest) call report_few_points(file%number, n, fewest, asked_at, diagnostics)
    ok = diagnostics%count == found
  end subroutine read_curve_file

  !> Whether a line is empty, without a comment.
  pure logical function is_blank(source, line)
    type(source_type), intent(in) :: source   !< the text of the file
    type(span_type), intent(in) :: line       !< place of the line

    is_blank = .true.
    if (line%first > len(source%text)) return
    is_blank = verify(source%text(line%first:min(line%last, len(source%text))), gaps//achar(10)) == 0
  end function is_blank

  !> Report a file with too few points for a curve, and what needs the curve.
  pure subroutine report_few_points(number, n, fewest, asked_at, diagnostics)
    integer, intent(in) :: number                         !< of the file among the sources
    integer, intent(in) :: n                              !< number of its points
    integer, intent(in) :: fewest                         !< number of points that are needed
    type(span_type), intent(in) :: asked_at               !< place of the file's name in the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: group
    type(place_type) :: place

    place = diagnostics%place(asked_at)
    group = 'a group'
    if (place%line > 0 .and. place%source == 1) &
      group = 'the group in '//trim(place_words(place))//' of '//printable(diagnostics%sources(1)%name)
    call diagnostics%add(span_type(number, 0, 0), 'a curve needs at least '//to_text(fewest)// &
                         ' points, and the file has '//to_text(n)//'; '//group//' needs it')
  end subroutine report_few_points

  !> Keep the words of the chosen columns of a line. A line without some of them is reported.
  pure subroutine choose_fields(chosen, whole, count, fields, ok, diagnostics)
    integer, intent(in) :: chosen(:)                      !< the columns
    type(span_type), intent(in) :: whole                  !< place of the line
    integer, intent(inout) :: count                       !< how many words the line has; afterwards how many are chosen
    type(span_type), intent(inout) :: fields(:)           !< places of the words; afterwards the first ones are those chosen
    logical, intent(out) :: ok                            !< whether the line has all of these columns
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    ok = count >= maxval(chosen)
    if (ok) then
      fields(:size(chosen)) = fields(chosen)
      count = size(chosen)
    else
      call diagnostics%add(whole, 'column '//to_text(maxval(chosen))//' is asked for by ''columns'', and this line has '// &
                           counted(count, 'number'))
    end if
  end subroutine choose_fields

  !> How many numbers the lines before have: " and those before it have 2"; empty where there are none.
  pure function the_others(columns) result(text)
    integer, intent(in) :: columns   !< numbers in the lines before; 0: there are none
    character(len=merge(27, 0, columns > 0)) :: text

    text = ' and those before it have '//achar(iachar('0') + columns)
  end function the_others

  !> The words of a line, but those of a line of names before the first point.
  pure subroutine find_words(file, line, fields, count, whole)
    type(point_file_type), intent(inout) :: file    !< the file
    integer, intent(in) :: line                     !< number of the line, from 1, behind those that were read before
    type(span_type), intent(out) :: fields(:)       !< places of the first words
    integer, intent(out) :: count                   !< how many words the line has
    type(span_type), intent(out) :: whole           !< place of the line
    integer :: first, last

    call file%source%line_bounds(line, first, last)
    whole = span_type(file%number, first, max(first, last))
    call split(file%source%text, first, last, file%number, fields, count)
    if (count == 0 .or. .not. file%may_be_names) return
    file%may_be_names = .false.
    if (are_names(file%source%text(first:last))) count = 0
  end subroutine find_words

  !> The numbers that words mean; the first word that means none is reported.
  pure subroutine read_words(source, fields, numbers, ok, diagnostics)
    type(source_type), intent(in) :: source               !< the text of the file
    type(span_type), intent(in) :: fields(:)              !< places of the words
    real(wp), intent(out) :: numbers(:)                   !< (words) the numbers
    logical, intent(out) :: ok                            !< whether no error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(numeral_type) :: numeral
    integer :: i

    ok = .false.
    numbers = 0.0_wp
    do i = 1, size(fields)
      call read_numeral(source%text(fields(i)%first:fields(i)%last), numeral)
      if (.not. allocated(numeral%problem)) then
        numbers(i) = numeral%number
        if (is_sensible(numeral%number)) cycle
        numeral%problem = 'is too large or too small; numbers are 0 or between 1e-100 and 1e100'
      end if
      call diagnostics%add(fields(i), ''''//diagnostics%text_of(fields(i))//''' '//numeral%problem)
      return
    end do
    ok = .true.
  end subroutine read_words

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
      rest = (rest(at:))
      if (rest(1:1) == '#') exit
      if (scan(rest(1:1), '0123456789+-.') > 0 .or. starts_with(rest, 'nan') .or. starts_with(rest, 'inf')) return
      at = scan(rest, gaps//'#')
      if (at == 0) exit
      rest = rest(at:)
    end do
    are_names = .true.
  end function are_names

  !> Find the words of a line up to its comment; words for which there is no room are only counted.
  pure subroutine split(text, first, last, source, fields, count)
    character(len=*), intent(in) :: text       !< the whole text of the table
    integer, intent(in) :: first               !< number of the line's first byte
    integer, intent(in) :: last                !< number of the line's last byte
    integer, intent(in) :: source              !< number of the table as a source, for spans
    type(span_type), intent(out) :: fields(:)  !< places of the first words
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
      if (count <= size(fields)) fields(count) = span_type(source, start, at - 1)
    end do
  end subroutine split

  !> Length of the part of the data file's path that a relative name is appended to; 0 for an absolute name.
  pure integer function start_length(data_file, name)
    character(len=*), intent(in) :: data_file  !< path of the data file
    character(len=*), intent(in) :: name       !< path as the data file gives it

    start_length = index(data_file, '/', back=.true.)
    if (starts_with(name, '/')) start_length = 0
  end function start_length

  !> Path of a file named in a data file: relative names start from the data file's folder.
  pure function beside(data_file, name) result(path)
    character(len=*), intent(in) :: data_file  !< path of the data file
    character(len=*), intent(in) :: name       !< path as the data file gives it
    character(len=start_length(data_file, name) + len(name)) :: path

    path = data_file(:start_length(data_file, name))//name
  end function beside
end module mech9_table_file
