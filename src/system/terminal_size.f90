!> How many letters the terminal shows.
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

  !> struct winsize
  type, bind(c) :: window_size_type
    integer(c_short) :: rows = 0, columns = 0, width = 0, height = 0
  end type window_size_type

  interface
    integer(c_int) function c_ioctl(descriptor, request, size) bind(c, name='ioctl')
      import :: c_int, c_long, window_size_type
      integer(c_int), value :: descriptor
      integer(c_long), value :: request
      type(window_size_type), intent(inout) :: size
    end function c_ioctl
  end interface

contains

  !> Size of the terminal on standard output, a column and a row less so that nothing scrolls; 79 x 23
  !> where standard output is none.
  subroutine find_terminal_size(columns, rows)
    integer, intent(out) :: columns, rows
    type(window_size_type) :: size

    columns = usual_columns
    rows = usual_rows
    if (c_ioctl(standard_output, get_window_size, size) /= 0) return
    ! a terminal that does not know its size says 0
    if (size%columns > 0) columns = max(size%columns - 1, least_columns)
    if (size%rows > 0) rows = max(size%rows - 1, least_rows)
  end subroutine find_terminal_size
end module mech9_terminal_size
