!> A small test harness: named checks that say why their number is right, and a count.
!> The unit tests of a floor are one program. Each of its suites is a module with a subroutine `run`, which asks `runs` before
!> each of its cases. The words of the command line select what is run:
!>    unit_structure                        all suites
!>    unit_structure vectors graphs/trees   one suite, and one case of another
!>    unit_structure --list                 prints the names of all cases
module mech9_testing
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_explanation, only: explain
  implicit none
  private
  public :: tester_type, message_of

  integer, parameter :: longest_name = 120

  type :: tester_type
    integer :: passed = 0
    integer :: failed = 0
    character(len=:), allocatable :: tree                       ! folder of the project
    character(len=longest_name), private, allocatable :: selected(:)   ! suites and cases to run; all where there are none
    character(len=:), private, allocatable :: suite             ! the present suite
    logical, private :: only_lists = .false.
    integer, private :: n_cases = 0
  contains
    procedure :: start
    procedure :: enters
    procedure :: runs
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

  !> Read the words of the command line.
  subroutine start(self, tree)
    class(tester_type), intent(inout) :: self   !< selects suites and cases
    character(len=*), intent(in) :: tree        !< folder of the project
    integer :: i

    self%tree = tree
    allocate (self%selected(command_argument_count()))
    do i = 1, size(self%selected)
      call get_command_argument(i, self%selected(i))
      if (self%selected(i) == '--list') self%only_lists = .true.
    end do
    if (self%only_lists) self%selected = self%selected(1:0)
  end subroutine start

  !> Begin a suite; true where it, or one of its cases, is selected.
  function enters(self, suite) result(answer)
    class(tester_type), intent(inout) :: self   !< notes the suite
    character(len=*), intent(in) :: suite       !< name of the suite
    logical :: answer

    self%suite = suite
    answer = size(self%selected) == 0 .or. any(self%selected == suite) .or. any(index(self%selected, suite//'/') == 1)
  end function enters

  !> Whether a case of the present suite is to run.
  function runs(self, case_name) result(answer)
    class(tester_type), intent(inout) :: self   !< knows the suite and what is selected
    character(len=*), intent(in) :: case_name   !< name of the case
    logical :: answer

    answer = size(self%selected) == 0 .or. any(self%selected == self%suite) .or. &
             any(self%selected == self%suite//'/'//case_name)
    if (.not. answer) return
    self%n_cases = self%n_cases + 1
    if (self%only_lists) then
      print '(3a)', self%suite, '/', case_name
      answer = .false.
    end if
  end function runs

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

    if (self%only_lists) return
    if (allocated(self%selected) .and. self%n_cases == 0) print '(a)', 'no case has the given name; --list prints the names'
    print '(i0,a,i0,a)', self%passed, ' checks passed, ', self%failed, ' failed'
    if (self%failed > 0 .or. self%passed == 0) stop 1
  end subroutine finish
end module mech9_testing
