!> A file that gets its name when it is whole: until then a file of that name stays as it is, so that a program that is killed
!> in between destroys nothing.
module mech9_replacement
  use, intrinsic :: iso_c_binding, only: c_int, c_char, c_ptr, c_null_char, c_associated
  use mech9_error, only: error_type, raise, exit_file
  use mech9_path, only: folder_of, name_of
  use mech9_same_file, only: file_place_type, find_place, is_regular
  use mech9_system_error, only: error_number, reason
  implicit none
  private
  public :: replacement_type, begin_replacement, path_of_part

  !> Questions to access: may this program write there, may it look for names in that folder?
  integer(c_int), parameter :: may_write = 2, may_search = 1
  !> Requests to flock, for this program alone and at once (LOCK_EX, LOCK_NB); its answer where another program has the
  !> file (EWOULDBLOCK).
  integer(c_int), parameter :: alone = 2, at_once = 4, would_block = 11

  !> A file that is being written and will replace another one.
  type :: replacement_type
    character(len=:), allocatable :: path            !< path at which the file is to be written
    character(len=:), allocatable, private :: name   !< path of the file that it becomes; empty: it is that file
    integer, private :: permissions = -1             !< of the file that is there; -1: none
  contains
    procedure :: finish
    procedure :: abandon
  end type replacement_type

  interface
    integer(c_int) function c_access(path, mode) bind(c, name='access')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)   !< of the file or folder; ends with a byte of zero
      integer(c_int), value :: mode                   !< the questions: sum of may_write and may_search
    end function c_access

    type(c_ptr) function c_fopen(path, mode) bind(c, name='fopen')
      import :: c_ptr, c_char
      character(kind=c_char), intent(in) :: path(*)   !< of the file; ends with a byte of zero
      character(kind=c_char), intent(in) :: mode(*)   !< 'r+b': for reading and writing; ends with a byte of zero
    end function c_fopen

    integer(c_int) function c_fileno(stream) bind(c, name='fileno')
      import :: c_int, c_ptr
      type(c_ptr), value :: stream   !< an open file
    end function c_fileno

    integer(c_int) function c_flock(descriptor, operation) bind(c, name='flock')
      import :: c_int
      integer(c_int), value :: descriptor   !< an open file
      integer(c_int), value :: operation    !< sum of `alone` and `at_once`
    end function c_flock

    integer(c_int) function c_fclose(stream) bind(c, name='fclose')
      import :: c_int, c_ptr
      type(c_ptr), value :: stream   !< an open file
    end function c_fclose

    integer(c_int) function c_geteuid() bind(c, name='geteuid')
      import :: c_int
    end function c_geteuid

    integer(c_int) function c_chmod(path, permissions) bind(c, name='chmod')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)   !< of the file; ends with a byte of zero
      integer(c_int), value :: permissions            !< the lower bits of the mode; mode_t is an unsigned integer of this size
    end function c_chmod

    integer(c_int) function c_rename(old, new) bind(c, name='rename')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: old(*)   !< present path; ends with a byte of zero
      character(kind=c_char), intent(in) :: new(*)   !< path afterwards; ends with a byte of zero
    end function c_rename

    integer(c_int) function c_unlink(path) bind(c, name='unlink')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)   !< of the file; ends with a byte of zero
    end function c_unlink
  end interface

contains

  !> Begin to make a file of a given name. One that cannot be replaced is written itself: a device, a file of another
  !> user, a file in a folder in which no new ones can be made. Fails with exit_file where the
  !> file is there and may not be written, or another program has it open (HDF5 locks the files that it writes).
  subroutine begin_replacement(path, replacement, err)
    character(len=*), intent(in) :: path                 !< name of the file that is to be made
    type(replacement_type), intent(out) :: replacement   !< tells where the file is to be written
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(file_place_type) :: place
    integer(c_int) :: user

    replacement%path = path
    replacement%name = ''
    call find_place(path, place)
    if (place%path == '') return
    user = c_geteuid()
    if (place%exists .and. .not. (is_regular(place) .and. place%owner == user)) return
    if (c_access(folder_of(place%path)//c_null_char, may_write + may_search) /= 0) return
    if (place%exists) then
      call refuse_in_use(path, err)
      if (allocated(err)) return
      replacement%permissions = place%permissions
    end if
    replacement%name = place%path
    replacement%path = path_of_part(place%path)
  end subroutine begin_replacement

  !> Fails where a file that is there may not be written, or another program is writing it.
  subroutine refuse_in_use(path, err)
    character(len=*), intent(in) :: path                !< name of a file that is there
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(c_ptr) :: stream
    integer(c_int) :: status

    stream = c_fopen(path//c_null_char, 'r+b'//c_null_char)
    if (.not. c_associated(stream)) then
      call raise(err, exit_file, "cannot open '"//path//"' for writing: "//reason(error_number()))
      return
    end if
    if (c_flock(c_fileno(stream), alone + at_once) /= 0) then
      if (error_number() == would_block) &
        call raise(err, exit_file, "cannot open '"//path//"' for writing: another program has it open")
    end if
    status = c_fclose(stream)   ! nothing was written that it could lose
  end subroutine refuse_in_use

  !> Path of the file until it is whole: beside its final place, and hidden in listings. The path is always the same, so
  !> that the next run overwrites what a killed run may leave.
  pure function path_of_part(path) result(part)
    character(len=*), intent(in) :: path   !< of the file that is to be made, without links
    character(len=:), allocatable :: part

    part = folder_of(path)//'.'//name_of(path)//'.part'
  end function path_of_part

  !> The file is whole: it gets its name, and the rights of the file that it replaces. Does nothing a second time.
  subroutine finish(self, err)
    class(replacement_type), intent(inout) :: self      !< the replacement
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer(c_int) :: status

    if (self%name == '') return
    status = 0
    if (self%permissions >= 0) status = c_chmod(self%path//c_null_char, int(self%permissions, c_int))
    if (status == 0) status = c_rename(self%path//c_null_char, self%name//c_null_char)
    if (status /= 0) then
      call raise(err, exit_file, "cannot give '"//self%path//"' the name '"//self%name//"': "//reason(error_number()))
      return
    end if
    self%path = self%name
    self%name = ''
  end subroutine finish

  !> The file will not be whole: it is removed, and the one that it was to replace stays. Does nothing after `finish`.
  subroutine abandon(self)
    class(replacement_type), intent(inout) :: self   !< the replacement
    integer(c_int) :: status

    if (.not. allocated(self%name)) return
    if (self%name /= '') status = c_unlink(self%path//c_null_char)
    self%name = ''
  end subroutine abandon
end module mech9_replacement
