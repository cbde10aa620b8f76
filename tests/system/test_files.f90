!> Files in the system: places that names mean, replacement of files as a whole, and the bytes of files.
module test_files
  use, intrinsic :: iso_c_binding, only: c_int, c_char, c_null_char
  use mech9_error, only: error_type, exit_file
  use mech9_file_bytes, only: read_bytes
  use mech9_replacement, only: replacement_type, begin_replacement, path_of_part
  use mech9_same_file, only: file_place_type, find_place, same_place, same_file, is_fifo, is_regular
  use mech9_text_file, only: save_text, replace_text
  use mech9_checks, only: has_message
  use mech9_test_files, only: remove_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_files.txt', link = 'test_files.link', second = 'test_files_2.txt'

  interface
    integer(c_int) function c_symlink(target, path) bind(c, name='symlink')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: target(*)   !< path that the link holds; ends with a byte of zero
      character(kind=c_char), intent(in) :: path(*)     !< of the link; ends with a byte of zero
    end function c_symlink

    integer(c_int) function c_link(old, new) bind(c, name='link')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: old(*)   !< path of a file; ends with a byte of zero
      character(kind=c_char), intent(in) :: new(*)   !< another path of it; ends with a byte of zero
    end function c_link

    integer(c_int) function c_mkfifo(path, mode) bind(c, name='mkfifo')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)   !< of the pipe; ends with a byte of zero
      integer(c_int), value :: mode                   !< permissions
    end function c_mkfifo

    integer(c_int) function c_chmod(path, mode) bind(c, name='chmod')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)   !< of the file; ends with a byte of zero
      integer(c_int), value :: mode                   !< permissions
    end function c_chmod

    integer(c_int) function c_unlink(path) bind(c, name='unlink')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)   !< of the file; ends with a byte of zero
    end function c_unlink
  end interface

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('places')) call places(tester)
    if (tester%runs('future_places')) call future_places(tester)
    if (tester%runs('kinds')) call kinds(tester)
    if (tester%runs('bytes')) call bytes(tester)
    if (tester%runs('replacement')) call replacement(tester)
    if (tester%runs('replaced_link')) call replaced_link(tester)
  end subroutine run

  subroutine save(tester, name, text)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: name         !< path of the file
    character(len=*), intent(in) :: text         !< its bytes
    type(error_type), allocatable :: err

    call save_text(name, text, err)
    call tester%no_error(err, 'a file is written')
  end subroutine save

  !> Two names mean one file by detours, links and second names.
  subroutine places(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer(c_int) :: status

    call save(tester, path, 'a')
    call save(tester, second, 'a')
    call tester%is_true(same_file(path, './'//path), 'a detour')
    call tester%is_true(same_file(path, './/./'//path), 'detours')
    call tester%is_true(.not. same_file(path, second), 'files with equal bytes are two')
    status = c_symlink(path//c_null_char, link//c_null_char)
    call tester%is_true(same_file(link, path), 'a link means its file')
    status = c_unlink(link//c_null_char)
    status = c_link(path//c_null_char, link//c_null_char)
    call tester%is_true(same_file(link, path), 'a second name means the same file')
    status = c_unlink(link//c_null_char)
    call tester%is_true(.not. same_file('/dev/null', '/dev/null'), 'devices lose nothing')
    call remove_file(path)
    call remove_file(second)
  end subroutine places

  !> Files that are not there yet: the places at which they would be made.
  subroutine future_places(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(file_place_type) :: place
    integer(c_int) :: status

    call tester%is_true(same_file('none.txt', './none.txt'), 'two names of no file')
    call tester%is_true(.not. same_file('none.txt', 'none.tx'), 'names of no files')
    call tester%is_true(.not. same_file('', ''), 'a name that means nothing')
    status = c_symlink('none.txt'//c_null_char, link//c_null_char)
    call tester%is_true(same_file(link, 'none.txt'), 'a link to a file that is not there')
    status = c_unlink(link//c_null_char)
    status = c_symlink(link//c_null_char, link//c_null_char)
    call find_place(link, place)
    call tester%is_true(.not. place%exists, 'a link to itself')
    status = c_unlink(link//c_null_char)
    call find_place('none.txt', place)
    call tester%is_true(.not. place%exists .and. place%path(1:1) == '/' .and. &
                        index(place%path, '/none.txt') == len(place%path) - 8, 'a future path is whole: '//place%path)
    call tester%is_true(same_place(place, place), 'a place is itself')
  end subroutine future_places

  subroutine kinds(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(file_place_type) :: place
    integer(c_int) :: status

    call save(tester, path, 'a')
    call find_place(path, place)
    call tester%is_true(is_regular(place) .and. .not. is_fifo(place), 'a file')
    call find_place('.', place)
    call tester%is_true(place%exists .and. .not. is_regular(place), 'a folder')
    status = c_mkfifo(link//c_null_char, int(o'600', c_int))
    call find_place(link, place)
    call tester%is_true(is_fifo(place) .and. .not. is_regular(place), 'a pipe')
    status = c_unlink(link//c_null_char)
    call remove_file(path)
  end subroutine kinds

  subroutine bytes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text, expected
    type(error_type), allocatable :: err
    integer :: i

    expected = repeat('a'//achar(10)//achar(13), 70000)
    do i = 1, 255
      expected = expected//char(i)
    end do
    call save(tester, path, expected)
    call read_bytes(path, text, err)
    call tester%no_error(err, 'a file is read')
    call tester%is_true(len(text) == len(expected), 'all bytes are there')
    call tester%is_true(text == expected, 'they are as they were')
    call read_bytes('/dev/zero', text, err)
    call tester%is_true(index(text, achar(0)) == 1, 'an endless device, which is no text, ends')
    call save(tester, path, '')
    call read_bytes(path, text, err)
    call tester%is_true(len(text) == 0 .and. .not. allocated(err), 'an empty file')
    call remove_file(path)
    call read_bytes(path, text, err)
    call has_message(tester, err, exit_file, 'cannot be read: there is no such file', 'no file')
    call read_bytes('.', text, err)
    call tester%has_error(err, exit_file, 'a folder')
    call read_bytes('a'//achar(0), text, err)
    call has_message(tester, err, exit_file, 'its name holds a byte of zero', 'a name of C that ends before its end')
  end subroutine bytes

  !> The new file takes the place of the old one when it is finished, with its permissions; an abandoned one is gone.
  subroutine replacement(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(replacement_type) :: new
    type(file_place_type) :: place
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer(c_int) :: status

    call tester%is_true(path_of_part('/d/a.h5') == '/d/.a.h5.part', 'the path until the end')
    call save(tester, path, 'old')
    status = c_chmod(path//c_null_char, int(o'604', c_int))
    call begin_replacement(path, new, err)
    call tester%no_error(err, 'a replacement begins')
    call tester%is_true(new%path /= path .and. index(new%path, '/.'//path//'.part') > 0, 'it is written elsewhere')
    call save(tester, new%path, 'new')
    call read_bytes(path, text, err)
    call tester%is_true(text == 'old', 'the old file stays')
    call new%finish(err)
    call tester%no_error(err, 'a replacement ends')
    call read_bytes(path, text, err)
    call tester%is_true(text == 'new', 'the new file is there')
    call find_place(path, place)
    call tester%is_true(place%permissions == int(o'604'), 'with the permissions of the old one')
    call new%finish(err)
    call tester%no_error(err, 'a second end does nothing')
    call begin_replacement(path, new, err)
    call save(tester, new%path, 'third')
    call new%abandon()
    call find_place(path_of_part(path), place)
    call read_bytes(path, text, err)
    call tester%is_true(.not. place%exists .and. text == 'new', 'an abandoned file is gone, the old one stays')
    call remove_file(path)
    call begin_replacement('/dev/null', new, err)
    call tester%is_true(new%path == '/dev/null' .and. .not. allocated(err), 'a device is written itself')
  end subroutine replacement

  !> A link stays a link, and its file is replaced.
  subroutine replaced_link(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer(c_int) :: status

    call save(tester, path, 'old')
    status = c_symlink(path//c_null_char, link//c_null_char)
    call replace_text(link, 'new', err)
    call tester%no_error(err, 'the file of a link is replaced')
    call read_bytes(path, text, err)
    call tester%is_true(text == 'new', 'the file that the link leads to is replaced')
    call tester%is_true(same_file(link, path), 'the link stays a link')
    status = c_unlink(link//c_null_char)
    call remove_file(path)
  end subroutine replaced_link
end module test_files
