!> Checks of vectors, matrices and messages, each made of the checks of the test harness.
module mech9_checks
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: near_vector, near_matrix, has_message

contains

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
end module mech9_checks
