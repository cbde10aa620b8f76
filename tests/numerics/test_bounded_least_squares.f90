!> Problems of Moré, Garbow and Hillstrom (1981) and of others as residuals for the test of least squares with bounds.
module published_problems
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_bounded_least_squares, only: residuals_type, residual_values_type
  implicit none
  private
  public :: problem_type, circle_type, rosenbrock, powell_singular, wood, freudenstein_roth, bard, jennrich_sampson, &
    one_direction, with_gap

  integer, parameter :: rosenbrock = 1, powell_singular = 2, wood = 3, freudenstein_roth = 4, bard = 5, jennrich_sampson = 6, &
    one_direction = 7, with_gap = 8

  type, extends(residuals_type) :: problem_type
    integer :: name = rosenbrock
    integer :: evaluations = 0
  contains
    procedure :: evaluate
  end type problem_type

  !> Points near a circle: the centre and the radius are shared, each point has its angle on the circle.
  type, extends(residuals_type) :: circle_type
    real(wp), allocatable :: points(:, :)
    logical :: shared = .false.   !< the angles are given as shared unknowns too
  contains
    procedure :: evaluate => evaluate_circle
  end type circle_type

contains

  subroutine evaluate(self, x, y, with_derivatives, values, has_value)
    class(problem_type), intent(inout) :: self                      !< the problem
    real(wp), intent(in) :: x(:)                                   !< (n) shared unknowns
    real(wp), intent(in) :: y(:, :)                                !< (n_y,groups) unknowns of each group
    logical, intent(in) :: with_derivatives                        !< derivatives are asked for
    type(residual_values_type), intent(inout) :: values            !< gets the residuals
    logical, intent(out) :: has_value                              !< the residuals have a value here
    real(wp), parameter :: measured(15) = [0.14_wp, 0.18_wp, 0.22_wp, 0.25_wp, 0.29_wp, 0.32_wp, 0.35_wp, 0.39_wp, 0.37_wp, &
                                           0.58_wp, 0.73_wp, 0.96_wp, 1.34_wp, 2.10_wp, 4.39_wp]
    real(wp) :: bottom
    integer :: i

    has_value = size(y) == 0
    self%evaluations = self%evaluations + 1
    associate (r => values%r(:, 1), a => values%by_x(:, :, 1))
      select case (self%name)
      case (rosenbrock)
        r = [10.0_wp*(x(2) - x(1)**2), 1.0_wp - x(1)]
        if (with_derivatives) a = reshape([-20.0_wp*x(1), -1.0_wp, 10.0_wp, 0.0_wp], [2, 2])
      case (powell_singular)
        r = [x(1) + 10.0_wp*x(2), sqrt(5.0_wp)*(x(3) - x(4)), (x(2) - 2.0_wp*x(3))**2, sqrt(10.0_wp)*(x(1) - x(4))**2]
        if (.not. with_derivatives) return
        a = 0.0_wp
        a(1, 1:2) = [1.0_wp, 10.0_wp]
        a(2, 3:4) = [1.0_wp, -1.0_wp]*sqrt(5.0_wp)
        a(3, 2:3) = [1.0_wp, -2.0_wp]*2.0_wp*(x(2) - 2.0_wp*x(3))
        a(4, [1, 4]) = [1.0_wp, -1.0_wp]*2.0_wp*sqrt(10.0_wp)*(x(1) - x(4))
      case (wood)
        r = [10.0_wp*(x(2) - x(1)**2), 1.0_wp - x(1), sqrt(90.0_wp)*(x(4) - x(3)**2), 1.0_wp - x(3), &
             sqrt(10.0_wp)*(x(2) + x(4) - 2.0_wp), (x(2) - x(4))/sqrt(10.0_wp)]
        if (.not. with_derivatives) return
        a = 0.0_wp
        a(1, 1:2) = [-20.0_wp*x(1), 10.0_wp]
        a(2, 1) = -1.0_wp
        a(3, 3:4) = sqrt(90.0_wp)*[-2.0_wp*x(3), 1.0_wp]
        a(4, 3) = -1.0_wp
        a(5, [2, 4]) = sqrt(10.0_wp)
        a(6, [2, 4]) = [1.0_wp, -1.0_wp]/sqrt(10.0_wp)
      case (freudenstein_roth)
        r = [-13.0_wp + x(1) + ((5.0_wp - x(2))*x(2) - 2.0_wp)*x(2), -29.0_wp + x(1) + ((x(2) + 1.0_wp)*x(2) - 14.0_wp)*x(2)]
        if (with_derivatives) a = reshape([1.0_wp, 1.0_wp, 10.0_wp*x(2) - 3.0_wp*x(2)**2 - 2.0_wp, &
                                           3.0_wp*x(2)**2 + 2.0_wp*x(2) - 14.0_wp], [2, 2])
      case (bard)
        do i = 1, 15
          bottom = (16 - i)*x(2) + min(i, 16 - i)*x(3)
          r(i) = measured(i) - (x(1) + i/bottom)
          if (with_derivatives) a(i, :) = [-1.0_wp, i*(16 - i)/bottom**2, i*min(i, 16 - i)/bottom**2]
        end do
      case (jennrich_sampson)
        do i = 1, 10
          r(i) = 2.0_wp + 2.0_wp*i - (exp(i*x(1)) + exp(i*x(2)))
          if (with_derivatives) a(i, :) = [-i*exp(i*x(1)), -i*exp(i*x(2))]
        end do
      case (one_direction)
        do i = 1, 5   ! only x1 + 2 x2 counts, and x3 does not count at all
          r(i) = i*(x(1) + 2.0_wp*x(2)) - 1.0_wp
          if (with_derivatives) a(i, :) = [1.0_wp*i, 2.0_wp*i, 0.0_wp]
        end do
      case (with_gap)
        ! a step beyond 0.9 is too long: there is no number there
        has_value = has_value .and. (x(1) <= 0.9_wp .or. x(1) > 2.0_wp)
        r = [sqrt(abs(0.9_wp - x(1))), 3.0_wp*(x(1) - 1.0_wp)]
        if (x(1) > 2.0_wp) r = ieee_value(1.0_wp, ieee_quiet_nan)
        if (with_derivatives) a = reshape([-0.5_wp/sqrt(0.9_wp - x(1)), 3.0_wp], [2, 1])
      end select
    end associate
  end subroutine evaluate

  subroutine evaluate_circle(self, x, y, with_derivatives, values, has_value)
    class(circle_type), intent(inout) :: self                       !< the points
    real(wp), intent(in) :: x(:)                                   !< (n) shared unknowns
    real(wp), intent(in) :: y(:, :)                                !< (n_y,groups) unknowns of each group
    logical, intent(in) :: with_derivatives                        !< derivatives are asked for
    type(residual_values_type), intent(inout) :: values            !< gets the residuals
    logical, intent(out) :: has_value                              !< the residuals have a value here
    real(wp) :: angle, along(2)
    integer :: i, g, row

    has_value = .true.
    do i = 1, size(self%points, 2)
      g = merge(1, i, self%shared)
      row = merge(2*i - 2, 0, self%shared)
      if (self%shared) then
        angle = x(3 + i)
      else
        angle = y(1, i)
      end if
      along = [cos(angle), sin(angle)]
      values%r(row + 1:row + 2, g) = x(1:2) + x(3)*along - self%points(:, i)
      if (.not. with_derivatives) cycle
      if (i == 1) values%by_x = 0.0_wp
      values%by_x(row + 1:row + 2, 1:3, g) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, along], [2, 3])
      if (self%shared) then
        values%by_x(row + 1:row + 2, 3 + i, g) = x(3)*[-along(2), along(1)]
      else
        values%by_y(:, 1, g) = x(3)*[-along(2), along(1)]
      end if
    end do
  end subroutine evaluate_circle
end module published_problems

!> Least squares with bounds: problems whose minima are published, the same with bounds, and groups of residuals with unknowns of
!> their own.
module test_bounded_least_squares
  use mech9_kinds, only: wp
  use mech9_bounded_least_squares, only: bounds_type, least_squares_settings_type, least_squares_outcome_type, minimise_squares, &
    ended_short, &
    ended_flat, ended_by_count, ended_without_value
  use published_problems, only: problem_type, circle_type, rosenbrock, powell_singular, wood, freudenstein_roth, bard, &
    jennrich_sampson, one_direction, with_gap
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: far = 1.0e30_wp

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_published')) call test_published(tester)
    if (tester%runs('test_bounds')) call test_bounds(tester)
    if (tester%runs('test_deficient')) call test_deficient(tester)
    if (tester%runs('test_gaps')) call test_gaps(tester)
    if (tester%runs('test_groups')) call test_groups(tester)
  end subroutine run

  !> Solve a problem between bounds.
  subroutine solve(tester, name, rows, x, low, high, outcome, most_steps)
    type(tester_type), intent(inout) :: tester                 !< counts the checks
    integer, intent(in) :: name                                !< of the problem
    integer, intent(in) :: rows                                !< its number of residuals
    real(wp), intent(inout) :: x(:)                            !< start, then the minimum
    real(wp), intent(in) :: low(:)                             !< least x
    real(wp), intent(in) :: high(:)                            !< largest x
    type(least_squares_outcome_type), intent(out) :: outcome   !< how the search ended
    integer, intent(in) :: most_steps                          !< number of steps that are allowed
    type(problem_type) :: problem
    type(least_squares_settings_type) :: settings
    real(wp) :: y(0, 1), bounds(0, 1)

    problem%name = name
    problem%n = size(x)
    problem%groups = 1
    problem%rows = rows
    settings%most_steps = most_steps
    call minimise_squares(problem, x, y, bounds_type(low, high, bounds, bounds), settings, outcome)
    call tester%is_true(all(x >= low) .and. all(x <= high), 'the bounds hold')
    ! one evaluation of the residuals for each step, one of the derivatives for each accepted step, and both at the start
    call tester%is_true(problem%evaluations <= 2*outcome%steps + 2, 'no evaluation is made twice')
  end subroutine solve

  !> Minima without bounds, as published.
  subroutine test_published(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(least_squares_outcome_type) :: outcome
    real(wp) :: x2(2), x3(3), x4(4)

    x2 = [-1.2_wp, 1.0_wp]
    call solve(tester, rosenbrock, 2, x2, [-far, -far], [far, far], outcome, 100)
    call tester%near(norm2(x2 - 1.0_wp), 0.0_wp, 1e-10_wp, 'Rosenbrock''s valley ends at (1,1)')
    x4 = [3.0_wp, -1.0_wp, 0.0_wp, 1.0_wp]
    call solve(tester, powell_singular, 4, x4, [-far, -far, -far, -far], [far, far, far, far], outcome, 100)
    ! the Jacobian is singular there, so that each step gains a factor only
    call tester%near(norm2(x4), 0.0_wp, 1e-5_wp, 'Powell''s singular function is zero at the origin')
    x4 = [-3.0_wp, -1.0_wp, -3.0_wp, -1.0_wp]
    call solve(tester, wood, 6, x4, [-far, -far, -far, -far], [far, far, far, far], outcome, 200)
    call tester%near(norm2(x4 - 1.0_wp), 0.0_wp, 1e-10_wp, 'Wood''s function is zero at (1,1,1,1)')
    x2 = [0.5_wp, -2.0_wp]
    call solve(tester, freudenstein_roth, 2, x2, [-far, -far], [far, far], outcome, 100)
    ! the published value has six digits
    call tester%near(outcome%value/48.9842_wp, 1.0_wp, 2e-6_wp, 'Freudenstein and Roth''s local minimum')
    x3 = 1.0_wp
    call solve(tester, bard, 15, x3, [-far, -far, -far], [far, far, far], outcome, 100)
    call tester%near(outcome%value/8.21487e-3_wp, 1.0_wp, 1e-6_wp, 'Bard''s minimum')
    x2 = [0.3_wp, 0.4_wp]
    call solve(tester, jennrich_sampson, 10, x2, [-far, -far], [far, far], outcome, 100)
    call tester%near(outcome%value/124.362_wp, 1.0_wp, 2e-6_wp, 'Jennrich and Sampson''s minimum, whose residual is large')
    call tester%near(norm2(x2 - 0.257825_wp), 0.0_wp, 2e-5_wp, 'and its place')
  end subroutine test_published

  !> Minima at bounds, which follow by hand.
  subroutine test_bounds(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(least_squares_outcome_type) :: outcome
    real(wp) :: x2(2), x4(4)

    x2 = [-1.2_wp, 1.0_wp]
    call solve(tester, rosenbrock, 2, x2, [-far, -far], [0.5_wp, far], outcome, 100)
    call tester%near(norm2(x2 - [0.5_wp, 0.25_wp]), 0.0_wp, 1e-10_wp, 'with x1 <= 1/2 the valley is left at (1/2,1/4)')
    call tester%near(outcome%value, 0.25_wp, 1e-12_wp, 'with the value (1 - 1/2)^2')
    x2 = [-1.2_wp, 3.0_wp]
    call solve(tester, rosenbrock, 2, x2, [-far, 1.5_wp], [far, far], outcome, 100)
    ! 100 (1.5 - x^2)^2 + (1 - x)^2 has its minima at the zeros of 200 x^3 - 299 x - 1
    call tester%near(200.0_wp*x2(1)**3 - 299.0_wp*x2(1) - 1.0_wp, 0.0_wp, 1e-7_wp, 'the other unknown is free at a bound')
    call tester%near(x2(2), 1.5_wp, 0.0_wp, 'a bound is reached exactly')
    x2 = [5.0_wp, -7.0_wp]
    call solve(tester, rosenbrock, 2, x2, [2.0_wp, -1.0_wp], [3.0_wp, 0.0_wp], outcome, 100)
    call tester%near(norm2(x2 - [2.0_wp, 0.0_wp]), 0.0_wp, 0.0_wp, 'a corner is found from a start outside the box')
    call tester%is_true(outcome%kind == ended_flat, 'nothing is free at a corner')
    x2 = [-1.2_wp, 1.0_wp]
    call solve(tester, rosenbrock, 2, x2, [-1.2_wp, -far], [-1.2_wp, far], outcome, 100)
    call tester%near(x2(2), 1.44_wp, 1e-12_wp, 'an unknown whose bounds are one number stays')
    x4 = [-3.0_wp, -1.0_wp, -3.0_wp, -1.0_wp]
    call solve(tester, wood, 6, x4, [-far, -far, -far, -far], [0.0_wp, far, far, far], outcome, 300)
    call tester%near(x4(1), 0.0_wp, 0.0_wp, 'Wood''s function with x1 <= 0 ends at this bound')
  end subroutine test_bounds

  !> Columns that are zero or depend on each other.
  subroutine test_deficient(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(least_squares_outcome_type) :: outcome
    real(wp) :: x(3)

    x = [1.0_wp, 1.0_wp, 7.0_wp]
    call solve(tester, one_direction, 5, x, [-far, -far, -far], [far, far, far], outcome, 100)
    ! minimum at x1 + 2 x2 = sum(i)/sum(i^2) = 15/55, with the value 5 - 15^2/55
    call tester%near(x(1) + 2.0_wp*x(2), 15.0_wp/55.0_wp, 1e-9_wp, 'one direction is determined')
    call tester%near(outcome%value, 5.0_wp - 225.0_wp/55.0_wp, 1e-12_wp, 'the value is that of the projection')
    call tester%near(x(3), 7.0_wp, 0.0_wp, 'an unknown without effect stays')
  end subroutine test_deficient

  !> Places without residuals.
  subroutine test_gaps(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(least_squares_outcome_type) :: outcome
    real(wp) :: x(1)

    x = [-5.0_wp]
    call solve(tester, with_gap, 2, x, [-10.0_wp], [10.0_wp], outcome, 200)
    ! the derivative of 0.9 - x + 9 (x - 1)^2 is zero at 1 + 1/18, in the gap: the least value is at its edge
    call tester%is_true(x(1) > 0.85_wp .and. x(1) <= 0.9_wp, 'steps into a gap become shorter, and end near its edge')
    call tester%is_true(outcome%kind == ended_short .or. outcome%kind == ended_by_count, 'by short steps')
    x = [5.0_wp]
    call solve(tester, with_gap, 2, x, [-10.0_wp], [10.0_wp], outcome, 200)
    call tester%is_true(outcome%kind == ended_without_value, 'a start without numbers is told')
    call tester%near(x(1), 5.0_wp, 0.0_wp, 'and is left as it is')
  end subroutine test_gaps

  !> The circle of least distances: unknowns of groups give the same minimum as unknowns that all share.
  subroutine test_groups(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 9
    type(circle_type) :: apart, together
    type(least_squares_settings_type) :: settings
    type(least_squares_outcome_type) :: outcome, other
    real(wp) :: x(3), y(1, n), all_x(3 + n), low(3 + n), none(0, 1)
    integer :: i

    allocate (apart%points(2, n))
    do i = 1, n   ! some points of an arc, moved a little
      apart%points(:, i) = [2.0_wp, -1.0_wp] + (3.0_wp + 0.1_wp*sin(9.0_wp*i))*[cos(0.4_wp*i), sin(0.4_wp*i)]
      y(1, i) = 0.3_wp*i
    end do
    apart%n = 3
    apart%groups = n
    apart%n_y = 1
    apart%rows = 2
    x = [0.0_wp, 0.0_wp, 1.0_wp]
    all_x = [x, y]
    low = -far
    call minimise_squares(apart, x, y, bounds_type(low(:3), -low(:3), reshape(low(4:), [1, n]), reshape(-low(4:), [1, n])), &
                          settings, outcome)
    call tester%near(outcome%value, sum((norm2(apart%points - spread(x(1:2), 2, n), 1) - x(3))**2), 1e-12_wp, &
                     'the value is the sum of the squared distances from the circle')
    call tester%is_true(outcome%value > 1e-3_wp .and. outcome%value < 0.09_wp, 'which is of the size of the disturbance')
    together%points = apart%points
    together%shared = .true.
    together%n = 3 + n
    together%groups = 1
    together%rows = 2*n
    call minimise_squares(together, all_x, none, bounds_type(low, -low, none, none), settings, other)
    call tester%near(other%value, outcome%value, 1e-12_wp, 'the same minimum where all unknowns are shared')
    call tester%near(norm2(all_x - [x, y]), 0.0_wp, 1e-6_wp, 'at the same place')
    call tester%is_true(abs(other%steps - outcome%steps) <= 2, 'in as many steps: elimination changes round-off only')
  end subroutine test_groups
end module test_bounded_least_squares
