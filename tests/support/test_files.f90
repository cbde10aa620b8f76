!> Files of tests: written from lines, read as a whole, removed. Each suite has names of its own, since suites may run side by side.
module mech9_test_files
  use mech9_error, only: error_type
  use mech9_file_bytes, only: read_bytes
  use mech9_text_file, only: save_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: save_lines, remove_file, text_of_file, text_of_unit, count_of

contains

  !> Write lines to a file.
  subroutine save_lines(tester, path, lines)
    type(tester_type), intent(inout) :: tester    !< counts the checks
    character(len=*), intent(in) :: path          !< file that is written
    character(len=*), intent(in) :: lines(:)      !< its lines
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(lines)
      text = text//trim(lines(i))//achar(10)
    end do
    call save_text(path, text, err)
    call tester%no_error(err, 'the file of the case is written')
  end subroutine save_lines

  !> Remove a file.
  subroutine remove_file(path)
    character(len=*), intent(in) :: path   !< path of the file, which may be absent
    integer :: unit, status

    open (newunit=unit, file=path, status='old', iostat=status)
    if (status == 0) close (unit, status='delete')
  end subroutine remove_file

  !> All bytes of a file, which must be there.
  subroutine text_of_file(tester, path, text)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: path                 !< of the file
    character(len=:), allocatable, intent(out) :: text   !< its bytes
    type(error_type), allocatable :: err

    call read_bytes(path, text, err)
    call tester%no_error(err, 'the file is there')
    if (.not. allocated(text)) text = ''
  end subroutine text_of_file

  !> All lines that were written to a unit, which is closed and removed. It was opened for writing and reading with a name.
  subroutine text_of_unit(tester, unit, text)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    integer, intent(in) :: unit                          !< Fortran unit
    character(len=:), allocatable, intent(out) :: text   !< its lines
    character(len=1000) :: path

    inquire (unit=unit, name=path)
    close (unit)
    call text_of_file(tester, trim(path), text)
    call remove_file(trim(path))
  end subroutine text_of_unit

  !> How often words stand in a text.
  pure integer function count_of(words, text) result(n)
    character(len=*), intent(in) :: words   !< words that are counted
    character(len=*), intent(in) :: text    !< text that may hold them
    integer :: at, found

    n = 0
    at = 1
    do
      found = index(text(at:), words)
      if (found == 0) return
      n = n + 1
      at = at + found + len(words) - 1
    end do
  end function count_of
end module mech9_test_files
