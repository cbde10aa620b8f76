!> Rows of results as lines for the terminal: some columns and the last rows, or all of them.
module mech9_rows_text
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_kept_rows, only: kept_rows_type
  implicit none
  private
  public :: rows_text, all_rows_text, columns_that_fit

  !> Width of a column, and columns that fit on 80 letters.
  integer, parameter :: column_width = 13, columns_that_fit = 6
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
    text = block_text(kept, columns, shown)//'(the last '//to_text(shown)//' of '//counted(kept%count, 'row')
    if (kept%stride > 1) text = text//', every '//to_text(kept%stride)//'th of the run'
    text = text//'; '//to_text(size(columns))//' of '//counted(size(kept%names), 'column')//')'//eol
  end function rows_text

  !> All rows and columns, as whole lines: blocks of columns one below the other, each behind the first column.
  pure function all_rows_text(kept) result(text)
    type(kept_rows_type), intent(in) :: kept  !< rows that were kept
    character(len=:), allocatable :: text
    integer :: first, i

    text = ''
    do first = 2, max(2, size(kept%names)), columns_that_fit - 1
      text = text//block_text(kept, [1, (i, i=first, min(first + columns_that_fit - 2, size(kept%names)))], kept%count)
    end do
  end function all_rows_text

  !> Names, units and the last rows of some columns.
  pure function block_text(kept, columns, shown) result(text)
    type(kept_rows_type), intent(in) :: kept  !< rows that were kept
    integer, intent(in) :: columns(:)         !< numbers of the columns
    integer, intent(in) :: shown              !< how many rows
    character(len=:), allocatable :: text
    integer :: i, k

    text = ''
    do k = 1, size(columns)
      text = text//at_right(kept%names(columns(k))%text)
    end do
    text = text//eol
    do k = 1, size(columns)
      text = text//at_right(kept%units(columns(k))%text)
    end do
    text = text//eol
    do i = kept%count - shown + 1, kept%count
      do k = 1, size(columns)
        text = text//at_right(to_text(kept%rows(columns(k), i), 7))
      end do
      text = text//eol
    end do
  end function block_text

  !> A text in its column, with a blank before it even where it is too long.
  pure function at_right(text) result(padded)
    character(len=*), intent(in) :: text  !< the text of one column
    character(len=:), allocatable :: padded

    padded = repeat(' ', max(1, column_width - len(text)))//text
  end function at_right
end module mech9_rows_text
