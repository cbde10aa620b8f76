!> Published problems with limits for the test of least values within limits.
module limited_problems
  use mech9_kinds, only: wp
  use mech9_smooth_problem, only: smooth_problem_type
  implicit none
  private
  public :: limited_problem_type, rosen_suzuki, with_edge, excluding, nowhere

  integer, parameter :: rosen_suzuki = 1, with_edge = 2, excluding = 3, nowhere = 4

  type, extends(smooth_problem_type) :: limited_problem_type
    integer :: name = rosen_suzuki
    integer :: evaluations = 0
    integer :: stop_after = huge(1)
  contains
    procedure :: evaluate
    procedure :: is_stopped
  end type limited_problem_type

contains

  subroutine evaluate(self, x, value, gradient, limits, slopes, has_value)
    class(limited_problem_type), intent(inout) :: self   !< the problem
    real(wp), intent(in) :: x(:)                         !< (n) the place
    real(wp), intent(out) :: value                       !< the function
    real(wp), intent(out) :: gradient(:)                 !< (n) its derivatives
    real(wp), intent(out) :: limits(:)                   !< (limits) not negative where they are kept
    real(wp), intent(out) :: slopes(:, :)                !< (n,limits) their derivatives
    logical, intent(out) :: has_value                    !< all these exist

    self%evaluations = self%evaluations + 1
    has_value = self%name /= nowhere
    value = 0.0_wp
    gradient = 0.0_wp
    limits = 0.0_wp
    slopes = 0.0_wp
    select case (self%name)
    case (rosen_suzuki)   ! Hock and Schittkowski (1981), problem 43
      value = sum(x**2) + x(3)**2 - 5.0_wp*x(1) - 5.0_wp*x(2) - 21.0_wp*x(3) + 7.0_wp*x(4)
      gradient = 2.0_wp*x + [-5.0_wp, -5.0_wp, 2.0_wp*x(3) - 21.0_wp, 7.0_wp]
      limits(1) = 8.0_wp - sum(x**2) - x(1) + x(2) - x(3) + x(4)
      limits(2) = 10.0_wp - sum(x**2) - x(2)**2 - x(4)**2 + x(1) + x(4)
      limits(3) = 5.0_wp - 2.0_wp*x(1)**2 - x(2)**2 - x(3)**2 - 2.0_wp*x(1) + x(2) + x(4)
      slopes(:, 1) = -2.0_wp*x + [-1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp]
      slopes(:, 2) = -2.0_wp*x + [1.0_wp, -2.0_wp*x(2), 0.0_wp, 1.0_wp - 2.0_wp*x(4)]
      slopes(:, 3) = [-4.0_wp*x(1) - 2.0_wp, 1.0_wp - 2.0_wp*x(2), -2.0_wp*x(3), 1.0_wp]
    case (with_edge)      ! no value left of 0.2, the least value at 0.25 beside it
      has_value = x(1) > 0.2_wp
      if (.not. has_value) return
      value = x(1) - sqrt(x(1))
      gradient = 1.0_wp - 0.5_wp/sqrt(x(1))
    case (excluding)      ! x at most 0.3 and at least 0.4
      value = x(1)
      gradient = 1.0_wp
      limits = [0.3_wp - x(1), x(1) - 0.4_wp]
      slopes(1, :) = [-1.0_wp, 1.0_wp]
    end select
  end subroutine evaluate

  logical function is_stopped(self)
    class(limited_problem_type), intent(in) :: self   !< the problem

    is_stopped = self%evaluations >= self%stop_after
  end function is_stopped
end module limited_problems

!> Least values of smooth functions between bounds and within limits, by each method.
module test_limited_minimum
  use mech9_kinds, only: wp
  use mech9_smooth_problem, only: smooth_settings_type, smooth_outcome_type, ended_converged, ended_infeasible, ended_nowhere
  use mech9_limited_minimum, only: minimise_within_limits
  use limited_problems, only: limited_problem_type, rosen_suzuki, with_edge, excluding, nowhere
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=6), parameter :: methods(4) = ['slsqp ', 'mma   ', 'ccsaq ', 'auglag']

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('published')) call published(tester)
    if (tester%runs('beside_an_edge')) call beside_an_edge(tester)
    if (tester%runs('without_result')) call without_result(tester)
    if (tester%runs('stopped')) call stopped(tester)
  end subroutine run

  !> The optimum of four unknowns is (0, 1, 2, -1), with the value -44 and two limits reached.
  subroutine published(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(limited_problem_type) :: problem
    type(smooth_settings_type) :: settings
    type(smooth_outcome_type) :: outcome
    real(wp) :: x(4)
    real(wp), parameter :: expected(4) = [0.0_wp, 1.0_wp, 2.0_wp, -1.0_wp]
    integer :: i

    problem%n = 4
    problem%n_limits = 3
    problem%name = rosen_suzuki
    do i = 1, size(methods)
      settings%method = methods(i)
      settings%most_evaluations = 5000
      x = 0.0_wp
      call minimise_within_limits(problem, x, [-3.0_wp, -3.0_wp, -3.0_wp, -3.0_wp], [3.0_wp, 3.0_wp, 3.0_wp, 3.0_wp], settings, &
                                  outcome)
      ! the limits are kept with a margin of 1e-9; methods of first order end farther away
      call tester%is_true(all(abs(x - expected) < merge(1.0e-7_wp, 1.0e-3_wp, i == 1)), methods(i)//' finds the published optimum')
      call tester%near(outcome%value, -44.0_wp, merge(1.0e-8_wp, 1.0e-4_wp, i == 1), methods(i)//': its value')
      call tester%is_true(outcome%value >= -44.0_wp, methods(i)//': no limit is broken')
    end do
    ! another start, outside a limit, and a bound that is reached
    settings%method = 'slsqp'
    x = 3.0_wp
    call minimise_within_limits(problem, x, [-3.0_wp, -3.0_wp, -3.0_wp, -3.0_wp], [3.0_wp, 3.0_wp, 1.5_wp, 3.0_wp], settings, &
                                outcome)
    call tester%is_true(outcome%kind == ended_converged .and. abs(x(3) - 1.5_wp) < 1.0e-12_wp, 'a bound is reached')
    call tester%is_true(outcome%value > -44.0_wp, 'which costs something')
  end subroutine published

  !> Steps over the edge of the places that have a value are refused.
  subroutine beside_an_edge(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(limited_problem_type) :: problem
    type(smooth_settings_type) :: settings
    type(smooth_outcome_type) :: outcome
    real(wp) :: x(1)
    integer :: i

    problem%n = 1
    problem%name = with_edge
    do i = 1, size(methods)
      settings%method = methods(i)
      x = 0.9_wp
      call minimise_within_limits(problem, x, [0.0_wp], [1.0_wp], settings, outcome)
      ! the value is flat there: its round-off hides differences of a few 1e-8
      call tester%near(x(1), 0.25_wp, 1.0e-6_wp, methods(i)//': the least value beside an edge')
    end do
  end subroutine beside_an_edge

  !> Limits that exclude each other, functions without value, and methods that do not exist.
  subroutine without_result(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(limited_problem_type) :: problem
    type(smooth_settings_type) :: settings
    type(smooth_outcome_type) :: outcome
    real(wp) :: x(1)
    integer :: i

    do i = 1, size(methods)
      settings%method = methods(i)
      problem = limited_problem_type(n=1, n_limits=2, name=excluding)
      x = 0.9_wp
      call minimise_within_limits(problem, x, [0.0_wp], [1.0_wp], settings, outcome)
      call tester%is_true(outcome%kind == ended_infeasible .and. abs(x(1) - 0.9_wp) <= 0.0_wp, methods(i)//': no place is allowed')
      problem = limited_problem_type(n=1, n_limits=0, name=nowhere)
      call minimise_within_limits(problem, x, [0.0_wp], [1.0_wp], settings, outcome)
      call tester%is_true(outcome%kind == ended_nowhere, methods(i)//': no value at the start')
    end do
    settings%method = 'unheard of'
    problem = limited_problem_type(n=1, n_limits=0, name=with_edge)
    call minimise_within_limits(problem, x, [0.0_wp], [1.0_wp], settings, outcome)
    call tester%is_true(outcome%kind == ended_nowhere, 'a method that does not exist')
  end subroutine without_result

  !> A search that is stopped ends at once.
  subroutine stopped(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(limited_problem_type) :: problem
    type(smooth_settings_type) :: settings
    type(smooth_outcome_type) :: outcome
    real(wp) :: x(4)
    integer :: i

    do i = 1, size(methods)
      settings%method = methods(i)
      problem = limited_problem_type(n=4, n_limits=3, name=rosen_suzuki, stop_after=3)
      x = 0.0_wp
      call minimise_within_limits(problem, x, 0.0_wp*x - 3.0_wp, 0.0_wp*x + 3.0_wp, settings, outcome)
      call tester%is_true(outcome%evaluations <= 6, methods(i)//': stops')
    end do
  end subroutine stopped
end module test_limited_minimum
