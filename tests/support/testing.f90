!> The smallest test harness: named checks that say why their number is right, and a count.
!> A test program makes a `tester_type`, checks, and calls `finish`, which ends with 1 on any failure.
module mech9_testing
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_explanation, only: explain
  implicit none
  private
  public :: tester_type, message_of

  type :: tester_type
    integer :: passed = 0
    integer :: failed = 0
  contains
    procedure :: is_true
    procedure :: near
    procedure :: no_error
    procedure :: has_error
    procedure :: finish
  end type tester_type

contains

  !> The message of an error as users read it.
  pure function message_of(err) result(message)
    type(error_type), intent(in) :: err   !< the error, which stays as it is
    character(len=:), allocatable :: message
    type(error_type) :: explained

    explained = err
    call explain(explained)
    message = explained%message
  end function message_of

  !> Check that a condition holds.
  subroutine is_true(self, condition, why)
    class(tester_type), intent(inout) :: self   !< counts the checks
    logical, intent(in) :: condition            !< condition that must hold
    character(len=*), intent(in) :: why         !< the statement that is checked, printed where it is wrong

    if (condition) then
      self%passed = self%passed + 1
    else
      self%failed = self%failed + 1
      print '(2a)', 'FAILED: ', why
    end if
  end subroutine is_true

  !> Check |value - expected| <= tol*max(1, |expected|). The mechanisms of unit tests are of order one; smaller quantities are
  !> divided by their size before they are compared.
  subroutine near(self, value, expected, tol, why)
    class(tester_type), intent(inout) :: self   !< counts the checks
    real(wp), intent(in) :: value               !< value that is checked
    real(wp), intent(in) :: expected            !< the right value
    real(wp), intent(in) :: tol                 !< over the larger of one and the right value
    character(len=*), intent(in) :: why         !< the statement that is checked, printed where it is wrong

    if (abs(value - expected) <= tol*max(1.0_wp, abs(expected))) then
      self%passed = self%passed + 1
    else
      self%failed = self%failed + 1
      print '(2a,3(a,es24.16))', 'FAILED: ', why, ': got', value, ', expected', expected, ', tolerance', tol
    end if
  end subroutine near

  !> Check that a call went well.
  subroutine no_error(self, err, why)
    class(tester_type), intent(inout) :: self          !< counts the checks
    type(error_type), allocatable, intent(in) :: err   !< of the call; not allocated where all is well
    character(len=*), intent(in) :: why                !< the statement that is checked, printed where it is wrong

    call self%is_true(.not. allocated(err), why)
    if (allocated(err)) print '(2a)', '  it answered: ', message_of(err)
  end subroutine no_error

  !> Check that a call failed with this code.
  subroutine has_error(self, err, code, why)
    class(tester_type), intent(inout) :: self          !< counts the checks
    type(error_type), allocatable, intent(in) :: err   !< of the call
    integer, intent(in) :: code                        !< the right code
    character(len=*), intent(in) :: why                !< the statement that is checked, printed where it is wrong

    if (allocated(err)) then
      call self%is_true(err%code == code, why)
    else
      call self%is_true(.false., why//' (no error came)')
    end if
  end subroutine has_error

  !> Print the counts and end the program, with 1 if anything failed.
  subroutine finish(self)
    class(tester_type), intent(in) :: self   !< counts the checks

    print '(i0,a,i0,a)', self%passed, ' checks passed, ', self%failed, ' failed'
    if (self%failed > 0 .or. self%passed == 0) stop 1
  end subroutine finish
end module mech9_testing
