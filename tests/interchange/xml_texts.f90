!> XML documents from lines of text, for the tests of readers, and comparisons of what they read.
module xml_texts
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text_file, only: save_text
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_reader, only: read_xml
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: read_lines, save_lines, remove_file, near_vector, near_matrix, has_message, symmetric

contains

  !> Read lines as a document. Its places begin with the path, which no other suite may use at the same time.
  subroutine read_lines(tester, path, lines, tree)
    type(tester_type), intent(inout) :: tester    !< counts the checks
    character(len=*), intent(in) :: path          !< file that is written, read and removed
    character(len=*), intent(in) :: lines(:)      !< the document
    type(xml_tree_type), intent(out) :: tree      !< its elements
    type(error_type), allocatable :: err

    call save_lines(tester, path, lines)
    call read_xml(path, tree, err)
    call tester%no_error(err, 'the document of the case is XML')
    call remove_file(path)
  end subroutine read_lines

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

  !> Check the components of a vector.
  subroutine near_vector(tester, value, expected, tol, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), intent(in) :: value(:)             !< vector that is checked
    real(wp), intent(in) :: expected(:)          !< the right one, of the same size
    real(wp), intent(in) :: tol                  !< for each component, as in `near`
    character(len=*), intent(in) :: why          !< the statement that is checked
    integer :: i

    call tester%is_true(size(value) == size(expected), why//': the number of components')
    do i = 1, min(size(value), size(expected))
      call tester%near(value(i), expected(i), tol, why)
    end do
  end subroutine near_vector

  !> Check the elements of a matrix.
  subroutine near_matrix(tester, value, expected, tol, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), intent(in) :: value(:, :)          !< matrix that is checked
    real(wp), intent(in) :: expected(:, :)       !< the right one, of the same shape
    real(wp), intent(in) :: tol                  !< for each element, as in `near`
    character(len=*), intent(in) :: why          !< the statement that is checked

    call near_vector(tester, pack(value, .true.), pack(expected, .true.), tol, why)
  end subroutine near_matrix

  !> Check the code of a failure, and words of its message.
  subroutine has_message(tester, err, code, words, why)
    type(tester_type), intent(inout) :: tester         !< counts the checks
    type(error_type), allocatable, intent(in) :: err   !< of the call
    integer, intent(in) :: code                        !< the right code
    character(len=*), intent(in) :: words              !< part of the message
    character(len=*), intent(in) :: why                !< the statement that is checked

    call tester%has_error(err, code, why)
    if (.not. allocated(err)) return
    call tester%is_true(index(message_of(err), words) > 0, why//': the message is "'//message_of(err)//'"')
  end subroutine has_message

  !> The symmetric tensor of its components xx, yy, zz, xy, xz, yz.
  pure function symmetric(j) result(tensor)
    real(wp), intent(in) :: j(6)   !< components [kg m^2]
    real(wp) :: tensor(3, 3)

    tensor = reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), j(3)], [3, 3])
  end function symmetric
end module xml_texts
