!> Derivatives from values alone: as exact as truncation and round-off allow, and an honest estimate.
!>
!> The polynomial of degree 2n through x +- h ... +- n h errs by h^2n f^(2n+1) (n!)^2/(2n+1)! in the first
!> derivative and by 2 h^2n f^(2n+2) (n!)^2/(2n+2)! in the second; here n = 8. Roundings of the values come
!> in by less than 4/h and 8/h^2.
module test_differentiation
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, stencil_size, step_count, trial_step, derivatives_from_stencil
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> (8!)^2/17! and 2 (8!)^2/18!
  real(wp), parameter :: truncation_first = 40320.0_wp**2/355687428096000.0_wp
  real(wp), parameter :: truncation_second = truncation_first/9.0_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('steps')) call steps(test)
    if (test%runs('powers')) call powers(test)
    if (test%runs('sines')) call sines(test)
    if (test%runs('exponential')) call exponential(test)
    if (test%runs('rational')) call rational(test)
    if (test%runs('order_and_estimate')) call order_and_estimate(test)
  end subroutine run

  subroutine steps(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: number

    call test%is_true(stencil_size == 2*half_width + 2, 'a stencil has its middle, two sides, and a value between them')
    call test%near(trial_step(1, 1.0_wp), 0.125_wp, 0.0_wp, 'the first step is an eighth of the scale')
    do number = 2, step_count
      call test%near(trial_step(number, 1.0_wp)*4.0_wp, trial_step(number - 1, 1.0_wp), 0.0_wp, &
                     'each step is a quarter of the one before')
    end do
    call test%near(trial_step(3, 1024.0_wp), 1024.0_wp*trial_step(3, 1.0_wp), 0.0_wp, 'steps are proportional to the scale')
  end subroutine steps

  !> A polynomial of degree 16 is its own interpolant: nothing but round-off remains.
  subroutine powers(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: h = 0.125_wp, x = 0.25_wp
    real(wp) :: values(-half_width:half_width), first, second, error, largest
    integer :: n, i

    do n = 0, 16
      do i = -half_width, half_width
        values(i) = (x + i*h)**n
      end do
      call derivatives_from_stencil(values, h, first, second, error)
      largest = maxval(abs(values))
      call test%is_true(abs(first - n*x**max(n - 1, 0)) <= 4.0_wp*epsilon(h)*largest/h, &
                        'the first derivative of x^n is right to round-off')
      call test%is_true(abs(second - n*(n - 1)*x**max(n - 2, 0)) <= 8.0_wp*epsilon(h)*largest/h**2, &
                        'the second derivative of x^n is right to round-off')
    end do
  end subroutine powers

  !> Check one stencil; `bound17` and `bound18` limit the derivatives of these orders on it.
  subroutine check_stencil(test, values, h, first_true, second_true, bound17, bound18, why)
    type(tester_type), intent(inout) :: test                 !< counts the checks
    real(wp), intent(in) :: values(-half_width:half_width)   !< of the function at i h
    real(wp), intent(in) :: h                                !< distance of neighbours
    real(wp), intent(in) :: first_true                       !< the right first derivative
    real(wp), intent(in) :: second_true                      !< the right second derivative
    real(wp), intent(in) :: bound17                          !< largest derivative of order 17
    real(wp), intent(in) :: bound18                          !< largest derivative of order 18
    character(len=*), intent(in) :: why                      !< the statement that is checked, printed where it is wrong
    real(wp) :: first, second, error, rounding

    rounding = epsilon(h)*maxval(abs(values))
    call derivatives_from_stencil(values, h, first, second, error)
    call test%near(first, first_true, truncation_first*h**16*bound17 + 4.0_wp*rounding/h, &
                   'the error of the first derivative keeps its bound for '//why)
    call test%near(second, second_true, truncation_second*h**16*bound18 + 8.0_wp*rounding/h**2, &
                   'the error of the second derivative keeps its bound for '//why)
    call test%is_true(abs(second - second_true) <= 1.01_wp*error, 'the estimate covers the error of the second derivative of '//why)
  end subroutine check_stencil

  subroutine sines(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: values(-half_width:half_width), x, k, h
    integer :: trial, number, i

    do trial = 1, 40
      k = 2.0_wp**(nint(3.4_wp*random%symmetric()))                ! waves of lengths from 0.8 to 50
      x = real(nint(4096.0_wp*random%symmetric()), wp)/1024.0_wp   ! so that k (x + i h) is exact
      do number = 1, step_count
        h = trial_step(number, 1.0_wp)
        if (k*h > 1.0_wp) cycle
        values = [(sin(k*(x + i*h)), i=-half_width, half_width)]
        call check_stencil(test, values, h, k*cos(k*x), -k**2*sin(k*x), k**17, k**18, 'a sine')
      end do
    end do
  end subroutine sines

  subroutine exponential(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: values(-half_width:half_width), x, h, top
    integer :: trial, number, i

    do trial = 1, 40
      x = real(nint(4096.0_wp*random%symmetric()), wp)/1024.0_wp
      do number = 1, step_count
        h = trial_step(number, 1.0_wp)
        values = [(exp(x + i*h), i=-half_width, half_width)]
        top = exp(x + half_width*h)
        call check_stencil(test, values, h, exp(x), exp(x), top, top, 'an exponential')
      end do
    end do
  end subroutine exponential

  !> 1/x, whose derivatives grow like factorials: f^(n) = (-1)^n n!/x^(n+1).
  subroutine rational(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: values(-half_width:half_width), x, h, least
    integer :: number, i, j

    do j = 1, 8
      x = real(j, wp)
      do number = 1, step_count
        h = trial_step(number, 1.0_wp)
        least = x - half_width*h
        if (least < 0.4_wp*x) cycle
        values = [(1.0_wp/(x + i*h), i=-half_width, half_width)]
        call check_stencil(test, values, h, -1.0_wp/x**2, 2.0_wp/x**3, &
                           gamma(18.0_wp)/least**18, gamma(19.0_wp)/least**19, 'a reciprocal')
      end do
    end do
  end subroutine rational

  !> Half the step divides the error by 2^16 where truncation dominates, and the estimate is above it.
  subroutine order_and_estimate(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: x = 0.3_wp
    real(wp) :: values(-half_width:half_width), h, first, second, error, e_first(2), e_second(2)
    integer :: i, j

    do j = 1, 2
      h = 1.0_wp/2**(j - 1)
      values = [(sin(x + i*h), i=-half_width, half_width)]
      call derivatives_from_stencil(values, h, first, second, error)
      e_first(j) = abs(first - cos(x))
      e_second(j) = abs(second + sin(x))
      call test%is_true(error >= e_second(j), 'the estimate of the error is not below the error')
    end do
    ! the next order changes the quotient of 65536 by a few tenths at these steps
    call test%is_true(e_first(1)/e_first(2) > 2.0_wp**15 .and. e_first(1)/e_first(2) < 2.0_wp**17, &
                      'the first derivative is of order 16')
    call test%is_true(e_second(1)/e_second(2) > 2.0_wp**15 .and. e_second(1)/e_second(2) < 2.0_wp**17, &
                      'the second derivative is of order 16')
  end subroutine order_and_estimate
end module test_differentiation
