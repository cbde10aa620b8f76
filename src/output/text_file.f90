!> A file or standard output that takes whole lines and reports every failure.
!>
!> It calls the system's own `creat`, `write` and `close`: gfortran's runtime library loses the failure of
!> a buffered write (up to 8 KiB on a full disk are lost with a status of zero), and ends
!> lines on standard output by its own rules.
module mech9_text_file
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_size_t, c_char, c_null_char
  use mech9_error, only: error_type, raise, exit_file
  use mech9_replacement, only: replacement_type, begin_replacement
  use mech9_system_error, only: error_number, reason, interrupted_call
  implicit none
  private
  public :: text_file_type, save_text, replace_text

  integer(c_int), parameter :: standard_output = 1
  integer(c_int), parameter :: permissions = int(o'666', c_int)  !< of a new file; the user's mask removes some

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
      character(kind=c_char), intent(in) :: path(*)  !< path of the file, ended by a zero
      integer(c_int), value :: mode                  !< permissions, mode_t: an unsigned integer of the same size
    end function c_creat

    integer(c_long) function c_write(descriptor, bytes, count) bind(c, name='write')
      import :: c_int, c_long, c_size_t, c_char
      integer(c_int), value :: descriptor             !< number of the open file
      character(kind=c_char), intent(in) :: bytes(*)  !< the bytes to write
      integer(c_size_t), value :: count               !< how many bytes
    end function c_write

    integer(c_int) function c_close(descriptor) bind(c, name='close')
      import :: c_int
      integer(c_int), value :: descriptor  !< number of the open file
    end function c_close
  end interface

contains

  !> Create the file, or empty it if it exists.
  subroutine open_file(self, path, err, name)
    class(text_file_type), intent(inout) :: self       !< the text file
    character(len=*), intent(in) :: path               !< path of the file; '-' is standard output
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=*), intent(in), optional :: name     !< name of the file in messages; its path if absent

    if (path == '-') then
      self%path = 'standard output'
      self%descriptor = standard_output
      return
    end if
    self%path = "'"//path//"'"
    if (present(name)) self%path = "'"//name//"'"
    if (path == '' .or. index(path, c_null_char) > 0) then
      call raise(err, exit_file, self%path//' is not the name of a file')
      return
    end if
    self%descriptor = c_creat(path//c_null_char, permissions)
    if (self%descriptor < 0) then
      call raise(err, exit_file, 'cannot open '//self%path//' for writing: '//reason(error_number()))
    end if
  end subroutine open_file

  !> Whether the file is open.
  pure logical function is_open(self)
    class(text_file_type), intent(in) :: self  !< the text file

    is_open = self%descriptor >= 0
  end function is_open

  !> Write all bytes to the file.
  subroutine write_text(self, text, err)
    class(text_file_type), intent(inout) :: self       !< the text file
    character(len=*), intent(in) :: text               !< the bytes to write
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: done
    integer(c_long) :: written

    done = 0
    do while (done < len(text))
      written = c_write(self%descriptor, text(done + 1:), int(len(text) - done, c_size_t))
      if (written >= 0) then
        done = done + int(written)
      else if (error_number() /= interrupted_call) then
        call raise(err, exit_file, 'cannot write to '//self%path//': '//reason(error_number()))
        return
      end if
    end do
  end subroutine write_text

  !> Close the file; does nothing to one that is not open. Some disks report only at this moment that they are full.
  subroutine close_file(self, err)
    class(text_file_type), intent(inout) :: self       !< the text file
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer(c_int) :: descriptor

    descriptor = self%descriptor
    self%descriptor = -1
    if (descriptor < 0 .or. descriptor == standard_output) return
    if (c_close(descriptor) /= 0) &
      call raise(err, exit_file, 'cannot finish '//self%path//': '//reason(error_number()))
  end subroutine close_file

  !> Write a file with this text. Errors are exit_file; the first one is returned, and the file is closed in any case.
  subroutine save_text(path, text, err)
    character(len=*), intent(in) :: path               !< path of the file; '-' is standard output
    character(len=*), intent(in) :: text               !< the text, as whole lines
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(error_type), allocatable :: at_close
    type(text_file_type) :: file

    call file%open(path, err)
    if (allocated(err)) return
    call file%write(text, err)
    call file%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine save_text

  !> Replace a file by one with this text; the old file stays unchanged until the new one is complete. Errors are
  !> exit_file.
  subroutine replace_text(path, text, err)
    character(len=*), intent(in) :: path               !< path of the file
    character(len=*), intent(in) :: text               !< the text, as whole lines
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(error_type), allocatable :: at_close
    type(replacement_type) :: replacement
    type(text_file_type) :: file

    call begin_replacement(path, replacement, err)
    if (.not. allocated(err)) call file%open(replacement%path, err, path)
    if (allocated(err)) return
    call file%write(text, err)
    call file%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
    if (.not. allocated(err)) call replacement%finish(err)
    if (allocated(err)) call replacement%abandon()
  end subroutine replace_text
end module mech9_text_file
