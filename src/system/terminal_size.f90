!> The size of the terminal in letters and lines.
module mech9_terminal_size
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_short
  implicit none
  private
  public :: find_terminal_size

  integer(c_int), parameter :: standard_output = 1
  !> The request TIOCGWINSZ of Linux.
  integer(c_long), parameter :: get_window_size = int(z'5413', c_long)
  integer, parameter :: usual_columns = 79, usual_rows = 23
  integer, parameter :: least_columns = 40, least_rows = 12

  !> The answer to the request (struct winsize).
  type, bind(c) :: window_size_type
    integer(c_short) :: rows = 0, columns = 0, width = 0, height = 0
  end type window_size_type

  interface
    integer(c_int) function c_ioctl(descriptor, request, size) bind(c, name='ioctl')
      import :: c_int, c_long, window_size_type
      integer(c_int), value :: descriptor             !< an open file
      integer(c_long), value :: request               !< number of the request
      type(window_size_type), intent(inout) :: size   !< gets the answer
    end function c_ioctl
  end interface

contains

  !> Size of the terminal on standard output, a column and a row less so that nothing scrolls; 79 x 23
  !> where standard output is none.
  subroutine find_terminal_size(columns, rows)
    integer, intent(out) :: columns   !< letters in a line
    integer, intent(out) :: rows      !< lines
    type(window_size_type) :: size

    columns = usual_columns
    rows = usual_rows
    if (c_ioctl(standard_output, get_window_size, size) /= 0) return
    ! a terminal that does not know its size answers 0
    if (size%columns > 0) columns = max(size%columns - 1, least_columns)
    if (size%rows > 0) rows = max(size%rows - 1, least_rows)
  end subroutine find_terminal_size
end module mech9_terminal_size
