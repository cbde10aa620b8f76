!> The table of results: comment lines, a line of names, rows of numbers.
!>
!>     # A slider-crank
!>     # mech9k 0.1.0
!>     # units:                s                      rad
!>                             t                       q1
!>        0.0000000000000000E+00   5.0000000000000000E-01
!>
!> A file whose name ends in .csv gets the names, in the first line, and the rows only, with commas between.
!>
!> Rows are gathered in a buffer and written as whole rows, when it is full and about once a second, so
!> that a run that is killed leaves a table that can be read. (Linux interrupts even a write in progress when a
!> process is killed by signal 9; only then may the last line be a part of a row.)
module mech9_table
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_internal
  use mech9_text, only: string_type, lower, join
  use mech9_clock, only: pacer_type
  use mech9_result_sink, only: result_sink_type
  use mech9_heading, only: heading_type
  use mech9_number_format, only: number_format_type, number_width
  use mech9_printable, only: printable, column_name
  use mech9_text_file, only: text_file_type
  implicit none
  private
  public :: table_type

  integer, parameter :: buffer_size = 1048576
  !> Age of the rows in the buffer [s] after which the next row makes them be written.
  real(wp), parameter :: longest_wait = 1.0_wp
  character, parameter :: line_end = achar(10)

  !> A table being written.
  type, extends(result_sink_type) :: table_type
    private
    type(text_file_type) :: file
    type(number_format_type) :: format
    type(pacer_type) :: pacer
    character(len=:), allocatable :: buffer
    integer :: used = 0  !< bytes waiting in the buffer
    integer :: columns = 0
    integer, allocatable :: order(:)        !< numbers of the columns in the order of the table; not allocated: as they are
    real(wp), allocatable :: arranged(:)    !< a row in this order
    integer :: row_size = 0      !< length of the longest row [bytes]
    logical :: commas = .false.  !< whether the file has comma-separated values
  contains
    procedure :: open => open_table
    procedure :: write_row
    procedure :: write_rows
    procedure :: flush => hand_over
    procedure :: close => close_table
  end type table_type

contains

  !> Create the file and write the lines above the rows.
  subroutine open_table(self, path, heading, program, err, order)
    class(table_type), intent(inout) :: self           !< the table
    character(len=*), intent(in) :: path               !< path of the file; '-' is standard output
    type(heading_type), intent(in) :: heading          !< names and units; each line of its title becomes a comment line
    character(len=*), intent(in) :: program            !< name and version of the program
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer, intent(in), optional :: order(:)          !< numbers of the columns in the order of the table; absent: as they are

    if (size(heading%names) == 0 .or. size(heading%names) /= size(heading%units)) then
      call raise(err, exit_internal, 'a table needs columns, and as many units as names')
      return
    end if
    call self%file%open(path, err)
    if (allocated(err)) return
    self%format = number_format_type()
    self%columns = size(heading%names)
    if (allocated(self%order)) deallocate (self%order, self%arranged)
    if (present(order)) then
      self%order = order
      allocate (self%arranged(size(order)))
    end if
    self%row_size = number_width*self%columns + 1
    self%used = 0
    if (allocated(self%buffer)) deallocate (self%buffer)
    allocate (character(len=max(buffer_size, self%row_size)) :: self%buffer)
    call self%pacer%start(longest_wait)
    self%commas = .false.
    if (len(path) > 4) self%commas = lower(path(len(path) - 3:)) == '.csv'
    if (self%commas) then
      call self%file%write(comma_line(in_order(heading%names, self%order)), err)
    else
      call self%file%write(comment_lines(heading%title)//comment_lines(program)// &
                           unit_line(in_order(heading%units, self%order))//name_line(in_order(heading%names, self%order)), err)
    end if
  end subroutine open_table

  !> Write one row, a value for each column. It may stay in the buffer for a moment.
  subroutine write_row(self, values, err)
    class(table_type), intent(inout) :: self           !< the table
    real(wp), intent(in) :: values(:)                  !< one number for each column
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: at

    if (size(values) /= self%columns .or. .not. self%file%is_open()) then
      call raise(err, exit_internal, 'a row needs an open table and a value for each column')
      return
    end if
    if (self%used + self%row_size > len(self%buffer)) then
      call self%flush(err)
      if (allocated(err)) return
    end if
    at = self%used
    if (self%commas) then
      call put_with_commas(self%format, values, self%buffer, at)
    else
      call put_in_fields(self%format, values, self%buffer, at)
    end if
    self%buffer(at + 1:at + 1) = line_end
    self%used = at + 1
    if (self%pacer%due()) call self%flush(err)
  end subroutine write_row

  !> Append numbers in columns of equal width to the first `at` bytes of the buffer.
  pure subroutine put_in_fields(format, values, buffer, at)
    type(number_format_type), intent(in) :: format  !< the number format
    real(wp), intent(in) :: values(:)               !< the numbers of one row
    character(len=*), intent(inout) :: buffer       !< the text, which gets the row
    integer, intent(inout) :: at                    !< number of bytes used in the buffer
    integer :: i

    do i = 1, size(values)
      call format%put(values(i), buffer(at + 1:at + number_width))
      at = at + number_width
    end do
  end subroutine put_in_fields

  !> Append numbers without blanks and with commas between them to the first `at` bytes of the buffer.
  pure subroutine put_with_commas(format, values, buffer, at)
    type(number_format_type), intent(in) :: format  !< the number format
    real(wp), intent(in) :: values(:)               !< the numbers of one row
    character(len=*), intent(inout) :: buffer       !< the text, which gets the row
    integer, intent(inout) :: at                    !< number of bytes used in the buffer
    character(len=number_width) :: field
    integer :: i, first

    do i = 1, size(values)
      if (i > 1) then
        at = at + 1
        buffer(at:at) = ','
      end if
      call format%put(values(i), field)
      first = verify(field, ' ')
      buffer(at + 1:at + number_width - first + 1) = field(first:)
      at = at + number_width - first + 1
    end do
  end subroutine put_with_commas

  !> Write rows, one after the other.
  subroutine write_rows(self, rows, err)
    class(table_type), intent(inout) :: self           !< the table
    real(wp), intent(in), contiguous :: rows(:, :)     !< (columns, rows) numbers of the rows
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: i, k

    do i = 1, size(rows, 2)
      if (allocated(self%order)) then
        do k = 1, size(self%order)
          self%arranged(k) = rows(self%order(k), i)
        end do
        call self%write_row(self%arranged, err)
      else
        call self%write_row(rows(:, i), err)
      end if
      if (allocated(err)) return
    end do
  end subroutine write_rows

  !> Texts in another order, if one is given.
  pure function in_order(texts, order) result(arranged)
    type(string_type), intent(in) :: texts(:)      !< the texts
    integer, allocatable, intent(in) :: order(:)   !< their numbers in the other order; not allocated: as they are
    type(string_type) :: arranged(size(texts))

    arranged = texts
    if (allocated(order)) arranged = texts(order)
  end function in_order

  !> Write the last rows and close the file; does nothing to a table that is not open. The file is closed
  !> even when writing fails.
  subroutine close_table(self, err)
    class(table_type), intent(inout) :: self           !< the table
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(error_type), allocatable :: close_error

    if (.not. self%file%is_open()) return
    call self%flush(err)
    call self%file%close(close_error)
    if (.not. allocated(err)) call move_alloc(close_error, err)
    deallocate (self%buffer)
  end subroutine close_table

  !> Write the buffer to the file. Rows that cannot be written are dropped: the run is about to
  !> end with this error, which must not occur a second time when the table is closed.
  subroutine hand_over(self, err)
    class(table_type), intent(inout) :: self           !< the table
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: used

    used = self%used
    self%used = 0
    if (used > 0) call self%file%write(self%buffer(:used), err)
  end subroutine hand_over

  !> Text as comment lines; it is split at line ends of all kinds.
  pure function comment_lines(text) result(lines)
    character(len=*), intent(in) :: text  !< any text, of several lines
    character(len=:), allocatable :: lines
    integer :: first, length

    lines = ''
    first = 1
    do while (first <= len(text))
      length = scan(text(first:), achar(10)//achar(13)) - 1
      if (length < 0) length = len(text) - first + 1
      if (text(first:first + length - 1) /= '') &
        lines = lines//'# '//trim(printable(text(first:first + length - 1)))//line_end
      first = first + length + 1
    end do
  end function comment_lines

  !> The units, each above its column.
  pure function unit_line(units) result(line)
    type(string_type), intent(in) :: units(:)  !< units of the columns
    character(len=:), allocatable :: line
    character(len=*), parameter :: beginning = '# units:'
    type(string_type) :: words(size(units))
    integer :: i

    do i = 1, size(units)
      words(i)%text = unit_name(units(i)%text)
    end do
    line = line_of(beginning, words)
  end function unit_line

  !> The unit as a heading: 1 for a plain number.
  pure function unit_name(unit) result(name)
    character(len=*), intent(in) :: unit  !< unit of a column; empty where it has none
    character(len=:), allocatable :: name

    if (unit == '') then
      name = '1'
    else
      name = column_name(unit)
    end if
  end function unit_name

  !> The headings, each above its column.
  pure function name_line(names) result(line)
    type(string_type), intent(in) :: names(:)  !< headings of the columns
    character(len=:), allocatable :: line
    type(string_type) :: words(size(names))
    integer :: i

    do i = 1, size(names)
      words(i)%text = column_name(names(i)%text)
    end do
    line = line_of('', words)
  end function name_line

  !> A line with one word in each column, at its right end; a word that fills its column keeps a blank before it.
  pure function line_of(beginning, words) result(line)
    character(len=*), intent(in) :: beginning  !< first letters of the line, in the first column
    type(string_type), intent(in) :: words(:)  !< a word for each column
    character(len=:), allocatable :: line
    integer :: widths(size(words)), i, at

    do i = 1, size(words)
      widths(i) = max(number_width, len(words(i)%text) + 1)
    end do
    widths(1) = max(number_width, len(beginning) + len(words(1)%text) + 1)
    allocate (character(len=sum(widths) + 1) :: line)
    at = 0
    do i = 1, size(words)
      line(at + 1:at + widths(i)) = repeat(' ', widths(i) - len(words(i)%text))//words(i)%text
      at = at + widths(i)
    end do
    line(:len(beginning)) = beginning
    line(at + 1:) = line_end
  end function line_of

  !> The names with commas between, in quotes where they hold a comma or a quote.
  pure function comma_line(names) result(line)
    type(string_type), intent(in) :: names(:)  !< headings of the columns
    character(len=:), allocatable :: line
    type(string_type) :: words(size(names))
    integer :: i

    do i = 1, size(names)
      words(i)%text = quoted(trim(printable(names(i)%text)))
    end do
    line = join(words, ',')//line_end
  end function comma_line

  !> A name in quotes, its own quotes doubled, where it holds a comma or a quote; any other name as it is.
  pure function quoted(name) result(word)
    character(len=*), intent(in) :: name  !< a name of printable letters
    character(len=:), allocatable :: word
    integer :: i

    word = name
    if (scan(name, ',"') == 0) return
    word = '"'
    do i = 1, len(name)
      word = word//repeat(name(i:i), merge(2, 1, name(i:i) == '"'))
    end do
    word = word//'"'
  end function quoted
end module mech9_table
