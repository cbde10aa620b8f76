!> Rows of results as lines for the terminal: some columns and the last rows, or all of them.
module mech9_rows_text
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_part_names, only: name_column
  use mech9_printable, only: utf8_length
  use mech9_kept_rows, only: kept_rows_type
  implicit none
  private
  public :: rows_text, all_rows_text, head_of, letters_of, columns_that_fit, digits_of_summary, all_digits

  !> Columns that fit on 80 letters, and the letters that they take, unless their names are long.
  integer, parameter :: columns_that_fit = 6, letters_that_fit = 78
  !> Significant digits of rows of a run, of a short table, and of a whole one.
  integer, parameter :: digits_of_rows = 7, digits_of_summary = 3, all_digits = 17
  character, parameter :: eol = achar(10)

contains

  !> Names, units and the last rows, as whole lines.
  pure function rows_text(kept, columns, last) result(text)
    type(kept_rows_type), intent(in) :: kept  !< the kept rows of a run
    integer, intent(in) :: columns(:)         !< numbers of the columns to show
    integer, intent(in) :: last               !< most rows shown
    character(len=:), allocatable :: text
    integer :: shown

    shown = min(last, kept%count)
    text = block_text(kept, columns, shown, digits_of_rows)//'(the last '//to_text(shown)//' of '//counted(kept%count, 'row')
    if (kept%stride > 1) text = text//', every '//to_text(kept%stride)//'th of the run'
    text = text//'; '//to_text(size(columns))//' of '//counted(size(kept%names), 'column')//')'//eol
  end function rows_text

  !> All rows and columns, as whole lines: blocks of columns one below the other, each behind the first column.
  pure function all_rows_text(kept, digits) result(text)
    type(kept_rows_type), intent(in) :: kept  !< rows that were kept
    integer, intent(in) :: digits             !< significant digits of each number
    character(len=:), allocatable :: text
    integer :: first, last, i, width

    text = ''
    first = 2
    do
      width = column_width(kept, 1, digits) + column_width(kept, first, digits)
      last = first
      do while (last < size(kept%names))
        width = width + column_width(kept, last + 1, digits)
        if (width > letters_that_fit) exit
        last = last + 1
      end do
      text = text//block_text(kept, [1, (i, i=first, min(last, size(kept%names)))], kept%count, digits)
      first = last + 1
      if (first > size(kept%names)) exit
    end do
  end function all_rows_text

  !> Names, units and the last rows of some columns.
  pure function block_text(kept, columns, shown, digits) result(text)
    type(kept_rows_type), intent(in) :: kept  !< rows that were kept
    integer, intent(in) :: columns(:)         !< numbers of the columns
    integer, intent(in) :: shown              !< how many rows
    integer, intent(in) :: digits             !< significant digits of each number
    character(len=:), allocatable :: text
    integer :: i, k, widths(size(columns))

    text = ''
    do k = 1, size(columns)
      widths(k) = column_width(kept, columns(k), digits)
      text = text//at_right(head_of(kept, columns(k)), widths(k))
    end do
    text = text//eol
    do k = 1, size(columns)
      text = text//at_right(kept%units(columns(k))%text, widths(k))
    end do
    text = text//eol
    do i = kept%count - shown + 1, kept%count
      do k = 1, size(columns)
        text = text//at_right(to_text(kept%rows(columns(k), i), digits), widths(k))
      end do
      text = text//eol
    end do
  end function block_text

  !> A text in its column, with a blank before it even where it is too long.
  pure function at_right(text, width) result(padded)
    character(len=*), intent(in) :: text  !< the text of one column
    integer, intent(in) :: width          !< of the column
    character(len=:), allocatable :: padded

    padded = repeat(' ', max(1, width - letters_of(text)))//text
  end function at_right

  !> The name of a column by the names of links and pairs, where they have any: B.q in place of q2.
  pure function head_of(kept, column) result(head)
    type(kept_rows_type), intent(in) :: kept    !< rows that were kept
    integer, intent(in) :: column               !< number of the column
    character(len=:), allocatable :: head

    head = kept%names(column)%text
    call name_column(kept%parts, head)
  end function head_of

  !> How many letters a text in UTF-8 has.
  pure integer function letters_of(text) result(letters)
    character(len=*), intent(in) :: text   !< the text
    integer :: i

    letters = 0
    i = 1
    do while (i <= len(text))
      i = i + max(1, utf8_length(text, i))
      letters = letters + 1
    end do
  end function letters_of

  !> The width of a column with its name and the blank before it.
  pure integer function column_width(kept, column, digits)
    type(kept_rows_type), intent(in) :: kept   !< rows that were kept
    integer, intent(in) :: column              !< number of the column; behind the last one: of none
    integer, intent(in) :: digits              !< significant digits of each number

    column_width = width_of(digits)
    if (column <= size(kept%names)) column_width = max(column_width, 1 + letters_of(head_of(kept, column)))
  end function column_width

  !> The width of a column: a blank, a sign, a point and an exponent beside the digits, but no less than that of 7 digits, which most
  !> names fit.
  pure integer function width_of(digits)
    integer, intent(in) :: digits   !< significant digits of each number

    width_of = max(digits, digits_of_rows) + 6
  end function width_of
end module mech9_rows_text
