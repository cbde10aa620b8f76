!> The bytes of a whole file, or of a pipe.
!>
!> The C library reads them: a unit of Fortran cannot be opened while another one reads the same file, as
!> two threads may do.
module mech9_file_bytes
  use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_char, c_ptr, c_null_char, c_associated
  use mech9_error, only: error_type, raise, exit_file
  use mech9_system_error, only: error_number, reason, no_such_file
  implicit none
  private
  public :: read_bytes

  !> A larger file is no description of a mechanism; byte positions stay default integers.
  integer, parameter :: largest_size = 1000000000

  interface
    type(c_ptr) function c_fopen(path, mode) bind(c, name='fopen')
      import :: c_ptr, c_char
      character(kind=c_char), intent(in) :: path(*)   !< name of the file; ends with a byte of zero
      character(kind=c_char), intent(in) :: mode(*)   !< 'rb': for reading; ends with a byte of zero
    end function c_fopen

    integer(c_size_t) function c_fread(bytes, length, count, stream) bind(c, name='fread')
      import :: c_size_t, c_char, c_ptr
      character(kind=c_char), intent(inout) :: bytes(*)   !< the bytes read
      integer(c_size_t), value :: length                  !< of one element [bytes]
      integer(c_size_t), value :: count                   !< number of elements
      type(c_ptr), value :: stream                        !< an open file
    end function c_fread

    integer(c_int) function c_ferror(stream) bind(c, name='ferror')
      import :: c_int, c_ptr
      type(c_ptr), value :: stream   !< an open file
    end function c_ferror

    integer(c_int) function c_fclose(stream) bind(c, name='fclose')
      import :: c_int, c_ptr
      type(c_ptr), value :: stream   !< an open file
    end function c_fclose
  end interface

contains

  !> Read a whole file. Fails with exit_file, and with the reason in words.
  subroutine read_bytes(path, text, err)
    character(len=*), intent(in) :: path                 !< name of the file
    character(len=:), allocatable, intent(out) :: text   !< all bytes of the file
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(c_ptr) :: stream
    integer(c_int) :: status

    if (index(path, c_null_char) > 0) then
      call raise(err, exit_file, 'cannot be read: its name holds a byte of zero')
      return
    end if
    stream = c_fopen(path//c_null_char, 'rb'//c_null_char)
    if (.not. c_associated(stream)) then
      if (error_number() == no_such_file) then
        call raise(err, exit_file, 'cannot be read: there is no such file')
      else
        call raise(err, exit_file, 'cannot be read: '//reason(error_number()))
      end if
      return
    end if
    call read_stream(stream, text, err)
    status = c_fclose(stream)   ! nothing was written that it could lose
  end subroutine read_bytes

  !> Read pieces of growing size, until the stream ends or shows that it is no text.
  subroutine read_stream(stream, text, err)
    type(c_ptr), intent(in) :: stream                    !< an open file
    character(len=:), allocatable, intent(out) :: text   !< all bytes of the file
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    character(len=:), allocatable :: grown
    integer :: n, taken

    allocate (character(len=65536) :: text)
    n = 0
    do
      taken = int(c_fread(text(n + 1:), 1_c_size_t, int(len(text) - n, c_size_t), stream))
      if (c_ferror(stream) /= 0) then
        call raise(err, exit_file, 'cannot be read: '//reason(error_number()))
        return
      end if
      n = n + taken
      if (n < len(text)) exit
      if (index(text, c_null_char) > 0) exit   ! no text: an endless device ends here too
      if (n > largest_size/2) then
        call raise(err, exit_file, 'cannot be read: it is too large for a data file')
        return
      end if
      allocate (character(len=2*n) :: grown)
      grown(:n) = text
      call move_alloc(grown, text)
    end do
    text = text(:n)
  end subroutine read_stream
end module mech9_file_bytes
