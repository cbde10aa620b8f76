!> A file or standard output that takes whole lines and reports every failure. Uses mech9_error, mech9_text.
!>
!> It calls the system's own `creat`, `write` and `close`: gfortran's runtime library loses the failure of
!> a write that it held back (up to 8 KiB on a full disk vanish with a status of zero), and ends
!> lines on standard output by its own rules.
module mech9_text_file
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_size_t, c_char, c_ptr, c_null_char, &
                                         c_f_pointer, c_associated
  use mech9_error, only: error_type, raise, exit_file
  implicit none
  private
  public :: text_file_type

  integer(c_int), parameter :: standard_output = 1
  integer(c_int), parameter :: permissions = int(o'666', c_int)   !< less what the user masks
  integer(c_int), parameter :: interrupted_call = 4               !< EINTR, the same on all Unixes

  !> One file open for writing.
  type :: text_file_type
    private
    integer(c_int) :: descriptor = -1
    character(len=:), allocatable :: path
  contains
    procedure :: open => open_file
    procedure :: write => write_text
    procedure :: close => close_file
    procedure :: is_open
  end type text_file_type

  interface
    integer(c_int) function c_creat(path, mode) bind(c, name='creat')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode   ! mode_t, an unsigned of the same size
    end function c_creat

    integer(c_long) function c_write(descriptor, bytes, count) bind(c, name='write')
      import :: c_int, c_long, c_size_t, c_char
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: bytes(*)
      integer(c_size_t), value :: count
    end function c_write

    integer(c_int) function c_close(descriptor) bind(c, name='close')
      import :: c_int
      integer(c_int), value :: descriptor
    end function c_close

    ! where the C library of Linux keeps errno for this thread
    type(c_ptr) function c_errno_location() bind(c, name='__errno_location')
      import :: c_ptr
    end function c_errno_location

    type(c_ptr) function c_strerror(number) bind(c, name='strerror')
      import :: c_int, c_ptr
      integer(c_int), value :: number
    end function c_strerror

    integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
      import :: c_size_t, c_ptr
      type(c_ptr), value :: text
    end function c_strlen
  end interface

contains

  !> Create the file, or empty it if it exists.
  subroutine open_file(self, path, err)
    class(text_file_type), intent(inout) :: self
    character(len=*), intent(in) :: path   !< '-' is standard output
    type(error_type), allocatable, intent(out) :: err

    if (path == '-') then
      self%path = 'standard output'
      self%descriptor = standard_output
      return
    end if
    self%path = "'"//path//"'"
    if (path == '' .or. index(path, c_null_char) > 0) then
      call raise(err, exit_file, self%path//' is not the name of a file')
      return
    end if
    self%descriptor = c_creat(path//c_null_char, permissions)
    if (self%descriptor < 0) then
      call raise(err, exit_file, 'cannot open '//self%path//' for writing: '//reason(errno()))
    end if
  end subroutine open_file

  pure logical function is_open(self)
    class(text_file_type), intent(in) :: self

    is_open = self%descriptor >= 0
  end function is_open

  !> Hand bytes to the system, all of them.
  subroutine write_text(self, text, err)
    class(text_file_type), intent(inout) :: self
    character(len=*), intent(in) :: text
    type(error_type), allocatable, intent(out) :: err
    integer :: done
    integer(c_long) :: written

    done = 0
    do while (done < len(text))
      written = c_write(self%descriptor, text(done + 1:), int(len(text) - done, c_size_t))
      if (written >= 0) then
        done = done + int(written)
      else if (errno() /= interrupted_call) then
        call raise(err, exit_file, 'cannot write to '//self%path//': '//reason(errno()))
        return
      end if
    end do
  end subroutine write_text

  !> Close the file; does nothing to one that is not open. Some disks tell only now that they are full.
  subroutine close_file(self, err)
    class(text_file_type), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: err
    integer(c_int) :: descriptor

    descriptor = self%descriptor
    self%descriptor = -1
    if (descriptor < 0 .or. descriptor == standard_output) return
    if (c_close(descriptor) /= 0) &
      call raise(err, exit_file, 'cannot finish '//self%path//': '//reason(errno()))
  end subroutine close_file

  integer(c_int) function errno()
    integer(c_int), pointer :: number

    call c_f_pointer(c_errno_location(), number)
    errno = number
  end function errno

  !> The system's words for an error number.
  function reason(number) result(text)
    integer(c_int), intent(in) :: number
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: words
    integer :: i

    words = c_strerror(number)
    if (.not. c_associated(words)) then
      text = 'unknown reason'
      return
    end if
    call c_f_pointer(words, letters, [c_strlen(words)])
    allocate (character(len=size(letters)) :: text)
    do i = 1, size(letters)
      text(i:i) = letters(i)
    end do
  end function reason
end module mech9_text_file
