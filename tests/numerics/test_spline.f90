!> Cubic splines: cubics are reproduced, pieces join smoothly, errors shrink with the fourth power.
module test_spline
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_random, only: random_type
  use mech9_spline, only: spline_type, build_spline
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('cubics')) call cubics(test)
    if (test%runs('smoothness')) call smoothness(test)
    if (test%runs('order')) call order(test)
    if (test%runs('refused')) call refused(test)
  end subroutine run

  !> Increasing points at distances between 0.1 and 0.3.
  function random_knots(random, n) result(x)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: n                     !< points
    real(wp) :: x(n)
    integer :: i

    x(1) = random%symmetric()
    do i = 2, n
      x(i) = x(i - 1) + 0.2_wp + 0.1_wp*random%symmetric()
    end do
  end function random_knots

  !> "Not a knot" ends leave a cubic as it is, between the points and beyond them.
  subroutine cubics(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(spline_type) :: spline
    type(error_type), allocatable :: err
    real(wp), allocatable :: x(:)
    real(wp) :: c(0:3), t, y, dy, ddy
    integer :: n, i

    do n = 4, 30
      x = random_knots(random, n)
      do i = 0, 3
        c(i) = random%symmetric()
      end do
      call build_spline(x, c(0) + x*(c(1) + x*(c(2) + x*c(3))), spline, err)
      call test%no_error(err, 'points of a cubic are accepted')
      do i = 1, 20
        t = x(1) + (x(n) - x(1))*(0.5_wp + 0.52_wp*random%symmetric())
        call spline%evaluate(t, y, dy, ddy)
        ! values up to 300 (x up to 6) and second differences over distances of 0.1: roundings by 2/h and 8/h^2
        call test%near(y, c(0) + t*(c(1) + t*(c(2) + t*c(3))), 1.0e-13_wp, 'the value of a cubic is found again')
        call test%near(dy, c(1) + t*(2.0_wp*c(2) + t*3.0_wp*c(3)), 1.0e-12_wp, 'the first derivative of a cubic is found again')
        call test%near(ddy, 2.0_wp*c(2) + 6.0_wp*c(3)*t, 1.0e-11_wp, 'the second derivative of a cubic is found again')
      end do
    end do
  end subroutine cubics

  !> Through each point; value, slope and second derivative the same from both sides; the third
  !> derivative the same on both sides of the second and of the last point but one.
  subroutine smoothness(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(spline_type) :: spline
    type(error_type), allocatable :: err
    real(wp), allocatable :: x(:), y(:)
    real(wp) :: left(3), right(3), third(4)
    integer :: n, i, k

    do n = 4, 24, 5
      x = random_knots(random, n)
      y = [(random%symmetric(), i=1, n)]
      call build_spline(x, y, spline, err)
      call test%no_error(err, 'points without any order are accepted')
      do i = 1, n
        call spline%evaluate(x(i), right(1), right(2), right(3))
        call test%near(right(1), y(i), 1.0e-15_wp, 'the curve runs through its points')
        if (i == 1 .or. i == n) cycle
        call spline%evaluate(nearest(x(i), -1.0_wp), left(1), left(2), left(3))
        ! curvatures reach some hundred and third derivatives some thousand: roundings of these, and
        ! their change over the distance to the neighbouring number
        call test%near(left(1), right(1), 1.0e-14_wp, 'the value is the same from both sides of a point')
        call test%near(left(2), right(2), 1.0e-12_wp, 'the slope is the same from both sides of a point')
        call test%near(left(3), right(3), 1.0e-11_wp, 'the second derivative is the same from both sides of a point')
      end do
      do k = 1, 4
        i = merge(k, n - 5 + k, k <= 2)   ! pieces 1, 2, n-2, n-1
        call spline%evaluate(x(i), left(1), left(2), left(3))
        call spline%evaluate(nearest(x(i + 1), -1.0_wp), right(1), right(2), right(3))
        third(k) = (right(3) - left(3))/(x(i + 1) - x(i))
      end do
      call test%near(third(1), third(2), 1.0e-11_wp, 'the third derivative does not jump at the second point')
      call test%near(third(3), third(4), 1.0e-11_wp, 'the third derivative does not jump at the last point but one')
    end do
  end subroutine smoothness

  !> Largest errors of value and derivatives of the spline through n + 1 points of a sine.
  subroutine sine_errors(test, n, errors)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< intervals
    real(wp), intent(out) :: errors(3)         !< of value, first and second derivative
    type(spline_type) :: spline
    type(error_type), allocatable :: err
    real(wp) :: x(0:n), t, y, dy, ddy
    integer :: i

    x = [(3.0_wp*i/n, i=0, n)]
    call build_spline(x, sin(x), spline, err)
    call test%no_error(err, 'points of a sine are accepted')
    errors = 0.0_wp
    do i = 0, 2000
      t = 3.0_wp*i/2000.0_wp
      call spline%evaluate(t, y, dy, ddy)
      errors = max(errors, abs([y - sin(t), dy - cos(t), ddy + sin(t)]))
    end do
  end subroutine sine_errors

  !> Half the distance divides the errors by 16, 8 and 4.
  subroutine order(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: coarse(3), fine(3), quotient(3)
    integer :: i

    call sine_errors(test, 40, coarse)
    call sine_errors(test, 80, fine)
    quotient = coarse/fine
    do i = 1, 3
      ! the next term changes the quotient by a part of the order of the distance, 0.075
      call test%is_true(abs(quotient(i)/2.0_wp**(5 - i) - 1.0_wp) < 0.25_wp, &
                        'value, slope and second derivative converge with the orders 4, 3 and 2')
    end do
    ! constant of complete splines: 5/384 h^4 inside, some times that near the free ends
    call test%is_true(fine(1) < 10.0_wp*5.0_wp/384.0_wp*(3.0_wp/80.0_wp)**4, 'the error has the size of the bound for splines')
  end subroutine order

  subroutine refused(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(spline_type) :: spline
    type(error_type), allocatable :: err

    call build_spline([1.0_wp, 2.0_wp, 3.0_wp], [0.0_wp, 1.0_wp, 0.0_wp], spline, err)
    call test%has_error(err, exit_data, 'three points are refused as too few')
    call build_spline([real(wp) ::], [real(wp) ::], spline, err)
    call test%has_error(err, exit_data, 'no points are refused as too few')
    call build_spline([1.0_wp, 2.0_wp, 2.0_wp, 3.0_wp], [0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp], spline, err)
    call test%has_error(err, exit_data, 'two points at one abscissa are refused')
    call test%is_true(index(message_of(err), 'point 3') > 0, 'the message about two points at one abscissa names the point')
    call build_spline([1.0_wp, 2.0_wp, 4.0_wp, 3.0_wp, 5.0_wp], [0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], spline, err)
    call test%has_error(err, exit_data, 'abscissae that fall are refused')
    call test%is_true(index(message_of(err), 'point 4') > 0, 'the message about falling abscissae names the point')
  end subroutine refused
end module test_spline
