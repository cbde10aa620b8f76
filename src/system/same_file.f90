!> The place in the file system that a name means, and whether two names mean one file, be it there or still to be made.
!>
!> A file that is there is known by its device and inode: hard links, symbolic links and names such as
!> /dev/fd/3 lead to the same ones. A file that is not there yet is known by the path at which it would be made.
module mech9_same_file
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_int16_t, c_int32_t, c_int64_t, c_long, c_size_t, c_char, &
                                         c_null_char, c_associated
  use mech9_kinds, only: long
  use mech9_path, only: folder_of, name_of
  implicit none
  private
  public :: file_place_type, find_place, find_open_place, same_place, same_file, is_fifo, is_regular

  !> Bytes of the longest path of the system, with the one that ends it.
  integer, parameter :: longest_path = 4096
  !> The largest number of symbolic links that lead to one another; the system has the same limit.
  integer, parameter :: most_links = 40
  !> Kinds of files, and the bits of a file's mode that tell the kind (S_IFMT), the same on all Unixes.
  integer, parameter :: kind_bits = int(o'170000'), fifo = int(o'010000'), character_device = int(o'020000'), &
                        regular_file = int(o'100000'), permission_bits = int(o'7777')
  !> Values for statx: names start from the folder of the program; an empty name means the descriptor itself; the facts
  !> that are wanted.
  integer(c_int), parameter :: from_here = -100, empty_path = 4096, basic_facts = 2047

  !> The place to which a name leads.
  type :: file_place_type
    logical :: exists = .false.              !< there is a file, folder or device
    integer(long) :: device = 0, inode = 0   !< of what is there
    integer :: kind = 0                      !< of what is there: S_IFREG, S_IFIFO, ...
    integer :: permissions = 0               !< of what is there: the lower bits of its mode
    integer :: owner = 0                     !< of what is there: the number of the user
    character(len=:), allocatable :: path    !< of what is there or would be made, without detours and links; empty: none
  end type file_place_type

  !> The facts that the system tells of a file (struct statx): the layout is the same on all processors.
  type, bind(c) :: facts_type
    integer(c_int32_t) :: asked, block_size
    integer(c_int64_t) :: attributes
    integer(c_int32_t) :: links, owner, group
    integer(c_int16_t) :: mode, spare
    integer(c_int64_t) :: inode, size, blocks, attributes_known
    integer(c_int64_t) :: times(8)
    integer(c_int32_t) :: special_device(2), device(2)
    integer(c_int64_t) :: more(14)
  end type facts_type

  interface
    type(c_ptr) function c_realpath(path, resolved) bind(c, name='realpath')
      import :: c_ptr, c_char
      character(kind=c_char), intent(in) :: path(*)        !< a path; ends with a byte of zero
      character(kind=c_char), intent(out) :: resolved(*)   !< the path without detours and links, with a byte of zero at its end
    end function c_realpath

    integer(c_long) function c_readlink(path, target, size) bind(c, name='readlink')
      import :: c_long, c_size_t, c_char
      character(kind=c_char), intent(in) :: path(*)      !< of a symbolic link; ends with a byte of zero
      character(kind=c_char), intent(out) :: target(*)   !< the path that the link holds, without a byte of zero
      integer(c_size_t), value :: size                   !< room in `target` [bytes]
    end function c_readlink

    integer(c_int) function c_statx(folder, path, flags, asked, facts) bind(c, name='statx')
      import :: c_int, c_char, facts_type
      integer(c_int), value :: folder                 !< from where names start: from_here, or a descriptor
      integer(c_int), value :: flags                  !< 0 or empty_path
      integer(c_int), value :: asked                  !< bits of the facts that are wanted
      character(kind=c_char), intent(in) :: path(*)   !< of the file; ends with a byte of zero
      type(facts_type), intent(out) :: facts          !< the facts that the system tells
    end function c_statx
  end interface

contains

  !> The place to which a path leads, through all folders and links.
  subroutine find_place(path, place)
    character(len=*), intent(in) :: path          !< any name of a file
    type(file_place_type), intent(out) :: place   !< the file that it names; `exists` false and an empty path where it names none

    place%path = ''
    if (path == '' .or. index(path, c_null_char) > 0) return
    call ask(from_here, path, 0_c_int, place)
    if (place%exists) then
      call resolve(path, place%path)
    else
      call find_future_path(path, place%path)
    end if
  end subroutine find_place

  !> The place of an open file, such as standard output.
  subroutine find_open_place(descriptor, place)
    integer, intent(in) :: descriptor             !< its number
    type(file_place_type), intent(out) :: place   !< the file that it names; without a path

    place%path = ''
    call ask(int(descriptor, c_int), '', empty_path, place)
  end subroutine find_open_place

  !> Whether two places are one. A terminal, or /dev/null, can be given twice without a loss: it is never the same place.
  pure logical function same_place(first, second)
    type(file_place_type), intent(in) :: first    !< one of the two
    type(file_place_type), intent(in) :: second   !< the other one

    if (first%exists .and. second%exists) then
      same_place = first%device == second%device .and. first%inode == second%inode .and. first%kind /= character_device
    else
      same_place = .not. (first%exists .or. second%exists) .and. first%path /= '' &
                   .and. first%path == second%path .and. len(first%path) == len(second%path)
    end if
  end function same_place

  !> Whether two paths lead to one place.
  logical function same_file(first, second)
    character(len=*), intent(in) :: first    !< one of the two
    character(len=*), intent(in) :: second   !< the other one
    type(file_place_type) :: first_place, second_place

    call find_place(first, first_place)
    call find_place(second, second_place)
    same_file = same_place(first_place, second_place)
  end function same_file

  !> Whether a place is a pipe, with a name (mkfifo) or without.
  pure logical function is_fifo(place)
    type(file_place_type), intent(in) :: place   !< as find_place gave it

    is_fifo = place%exists .and. place%kind == fifo
  end function is_fifo

  !> Whether a place is a file with contents of its own: no device, no pipe, no folder.
  pure logical function is_regular(place)
    type(file_place_type), intent(in) :: place   !< as find_place gave it

    is_regular = place%exists .and. place%kind == regular_file
  end function is_regular

  !> Ask the system for device, inode and kind.
  subroutine ask(folder, path, flags, place)
    integer(c_int), intent(in) :: folder            !< of statx: from_here, or the number of an open file
    integer(c_int), intent(in) :: flags             !< of statx: 0, or empty_path for the open file itself
    character(len=*), intent(in) :: path            !< of the file; empty for an open file
    type(file_place_type), intent(inout) :: place   !< gets the facts; unchanged where there is no file
    type(facts_type) :: facts

    if (c_statx(folder, path//c_null_char, flags, basic_facts, facts) /= 0) return
    place%exists = .true.
    place%device = ishft(int(facts%device(1), long), 32) + iand(int(facts%device(2), long), int(z'ffffffff', long))
    place%inode = facts%inode
    place%kind = iand(int(facts%mode), kind_bits)
    place%permissions = iand(int(facts%mode), permission_bits)
    place%owner = int(facts%owner)
  end subroutine ask

  !> The path at which a file that is not there would be made: the links of its name are followed, then the detours of
  !> its folder left out, unless the folder is not there either.
  subroutine find_future_path(path, future)
    character(len=*), intent(in) :: path                   !< of a file that is not there
    character(len=:), allocatable, intent(out) :: future   !< the path at which it would be made
    character(kind=c_char) :: letters(longest_path)
    character(len=:), allocatable :: folder, target
    integer(c_long) :: length
    integer :: links

    future = path
    target = ''
    do links = 1, most_links
      length = c_readlink(future//c_null_char, letters, int(longest_path, c_size_t))
      if (length <= 0) exit
      call take(letters(:int(length)), target)
      if (target(1:1) /= '/') target = folder_of(future)//target
      future = target
    end do
    folder = folder_of(future)
    if (folder == '') folder = '.'
    call resolve(folder, target)
    if (target == '') return
    if (target /= '/') target = target//'/'
    future = target//name_of(future)
  end subroutine find_future_path

  !> The path of a file or folder without detours and links; empty where there is none.
  subroutine resolve(path, resolved)
    character(len=*), intent(in) :: path                       !< of a file or folder
    character(len=:), allocatable, intent(inout) :: resolved   !< the path without detours and links; empty where nothing is there
    character(kind=c_char) :: letters(longest_path)

    letters(1) = c_null_char
    if (.not. c_associated(c_realpath(path//c_null_char, letters))) letters(1) = c_null_char
    call take(letters(:findloc(letters, c_null_char, 1) - 1), resolved)
  end subroutine resolve

  !> Letters of C as a text.
  pure subroutine take(letters, text)
    character(kind=c_char), intent(in) :: letters(:)       !< without the byte of zero
    character(len=:), allocatable, intent(inout) :: text   !< the same letters
    integer :: i

    if (allocated(text)) deallocate (text)
    allocate (character(len=size(letters)) :: text)
    do i = 1, size(letters)
      text(i:i) = letters(i)
    end do
  end subroutine take
end module mech9_same_file
