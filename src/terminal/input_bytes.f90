!> Standard input byte by byte, until an interrupt.
!>
!> It calls the system's own `poll` and `read`. The runtime library of gfortran goes on waiting after a signal, reads
!> lines of a fixed length, and buffers bytes that a line editor would need.
module mech9_input_bytes
  use, intrinsic :: iso_c_binding, only: c_int, c_short, c_long, c_size_t, c_char
  use mech9_system, only: interrupted, hung_up, standard_input
  implicit none
  private
  public :: input_bytes_type, input_read, input_ended, input_interrupted

  !> Results of a request for input: a byte or line was read, or there is none. The input ended (end of file, Ctrl-D, a
  !> closed terminal), or the user interrupted (Ctrl-C, a request to terminate).
  integer, parameter :: input_read = 0, input_ended = 1, input_interrupted = 2

  !> Longest wait before the next check for an interrupt [ms]: a signal that arrives just before the wait begins
  !> does not end it.
  integer(c_int), parameter :: patience = 200
  integer, parameter :: buffer_size = 4096

  !> Standard input, and the bytes that were read and not yet requested.
  type :: input_bytes_type
    private
    character(len=buffer_size) :: buffer
    integer :: place = 0  !< place of the last byte that was returned
    integer :: filled = 0
  contains
    procedure :: next_byte
    procedure :: step_back
    procedure, private :: refill
  end type input_bytes_type

  !> The request to `poll` (struct pollfd).
  type, bind(c) :: poll_type
    integer(c_int) :: descriptor = standard_input
    integer(c_short) :: events = 1  !< POLLIN
    integer(c_short) :: answer = 0
  end type poll_type

  interface
    integer(c_int) function c_poll(asked, count, timeout) bind(c, name='poll')
      import :: c_int, c_long, poll_type
      type(poll_type), intent(inout) :: asked  !< the file to wait for, and the answer
      integer(c_long), value :: count          !< how many files: 1
      integer(c_int), value :: timeout         !< longest time to wait [ms]
    end function c_poll

    integer(c_long) function c_read(descriptor, bytes, count) bind(c, name='read')
      import :: c_int, c_long, c_size_t, c_char
      integer(c_int), value :: descriptor              !< number of the open file
      character(kind=c_char), intent(out) :: bytes(*)  !< gets the bytes
      integer(c_size_t), value :: count                !< most bytes to read
    end function c_read
  end interface

contains

  !> Wait for the next byte. With `disturbed`, return also, without a byte, after a signal that does not interrupt. Such
  !> a signal comes when the program was stopped and continued, or the size of the window changed.
  subroutine next_byte(self, byte, status, disturbed)
    class(input_bytes_type), intent(inout) :: self  !< standard input
    character, intent(out) :: byte                  !< the byte; zero where there is none
    integer, intent(out) :: status                  !< input_read, or the reason why there is none
    logical, intent(out), optional :: disturbed     !< a signal ended the wait, and there is no byte
    logical :: by_signal

    byte = achar(0)
    status = input_read
    by_signal = .false.
    if (present(disturbed)) disturbed = .false.
    do while (self%place == self%filled .and. status == input_read)
      call self%refill(status, by_signal)
      if (.not. (by_signal .and. present(disturbed))) cycle
      disturbed = .true.
      return
    end do
    if (status /= input_read) return
    self%place = self%place + 1
    byte = self%buffer(self%place:self%place)
  end subroutine next_byte

  !> Return the last byte again at the next request.
  subroutine step_back(self)
    class(input_bytes_type), intent(inout) :: self  !< standard input

    if (self%place > 0) self%place = self%place - 1
  end subroutine step_back

  !> Wait for input and read it; `disturbed` is true where a signal ended the wait.
  subroutine refill(self, status, disturbed)
    class(input_bytes_type), intent(inout) :: self  !< standard input
    integer, intent(out) :: status                  !< input_read, input_ended or input_interrupted
    logical, intent(out) :: disturbed               !< whether a signal ended the wait
    type(poll_type) :: asked
    integer :: ready, got

    disturbed = .false.
    status = input_read
    ready = 0
    do while (ready == 0)
      if (interrupted()) exit
      ready = int(c_poll(asked, 1_c_long, patience))
    end do
    if (interrupted()) then
      status = merge(input_ended, input_interrupted, hung_up())
      return
    end if
    disturbed = ready < 0
    if (disturbed) return
    got = int(c_read(asked%descriptor, self%buffer, int(buffer_size, c_size_t)))
    self%place = 0
    self%filled = max(got, 0)
    status = merge(input_read, input_ended, got > 0)   ! a closed terminal answers with an error
  end subroutine refill
end module mech9_input_bytes
