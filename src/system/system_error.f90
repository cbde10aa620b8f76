!> The number of the error of a failed call of the C library, and its meaning in words.
module mech9_system_error
  use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_char, c_ptr, c_f_pointer, c_associated
  implicit none
  private
  public :: error_number, clear_error_number, reason, interrupted_call, no_such_file

  !> The call was interrupted by a signal (EINTR, the same on all Unixes): to be made again.
  integer(c_int), parameter :: interrupted_call = 4
  !> There is no such file or folder (ENOENT, the same on all Unixes).
  integer(c_int), parameter :: no_such_file = 2

  interface
    ! the place at which the C library of Linux keeps errno for this thread
    type(c_ptr) function c_errno_location() bind(c, name='__errno_location')
      import :: c_ptr
    end function c_errno_location

    type(c_ptr) function c_strerror(number) bind(c, name='strerror')
      import :: c_int, c_ptr
      integer(c_int), value :: number   !< of the error
    end function c_strerror

    integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
      import :: c_size_t, c_ptr
      type(c_ptr), value :: text   !< ends with a byte of zero
    end function c_strlen
  end interface

contains

  !> The number of the error, errno; valid right after the call that failed.
  integer(c_int) function error_number()
    integer(c_int), pointer :: number

    call c_f_pointer(c_errno_location(), number)
    error_number = number
  end function error_number

  !> Forget earlier errors, before a call whose failure only the number shows.
  subroutine clear_error_number()
    integer(c_int), pointer :: number

    call c_f_pointer(c_errno_location(), number)
    number = 0
  end subroutine clear_error_number

  !> The system's words for an error number, padded with blanks.
  function reason(number) result(text)
    integer(c_int), intent(in) :: number   !< of the error
    character(len=80) :: text
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: words
    integer :: i

    words = c_strerror(number)
    text = 'unknown reason'
    if (.not. c_associated(words)) return
    call c_f_pointer(words, letters, [c_strlen(words)])
    text = ''
    do i = 1, min(size(letters), len(text))
      text(i:i) = letters(i)
    end do
  end function reason
end module mech9_system_error
