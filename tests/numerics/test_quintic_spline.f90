!> Quintic splines: polynomials of fifth degree are reproduced, pieces join with four derivatives, errors shrink with the sixth power.
module test_quintic_spline
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_data
  use mech9_random, only: random_type
  use mech9_quintic_spline, only: quintic_spline_type, build_quintic
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('polynomials')) call polynomials(test)
    if (test%runs('smoothness')) call smoothness(test, .false.)
    if (test%runs('smoothness_closed')) call smoothness(test, .true.)
    if (test%runs('order')) call order(test)
    if (test%runs('refused')) call refused(test)
  end subroutine run

  !> Open curves through points of polynomials are these polynomials; through fewer than six points, up to the degree that the
  !> points determine.
  subroutine polynomials(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(quintic_spline_type) :: spline
    type(error_type), allocatable :: err
    real(wp) :: c(0:5, 3), x(12), t
    real(wp), dimension(3) :: y, first, second, third
    integer :: n, i, k, degree

    do n = 4, 12
      degree = min(5, n - 1)
      c = 0.0_wp
      do i = 0, degree
        do k = 1, 3
          c(i, k) = random%symmetric()
        end do
      end do
      x = [(0.25_wp*i + 0.08_wp*random%symmetric(), i=1, 12)]
      call build_quintic(x(:n), values_of(c, x(:n)), .false., spline, err)
      call test%no_error(err, 'points of a polynomial are accepted')
      do i = 1, n - 1
        t = x(i) + 0.3_wp*(x(i + 1) - x(i))
        call spline%evaluate(i, t, y, first, second, third)
        ! values up to 1000 (x up to 3), and differences over distances of 0.1, which enlarge roundings by 10, 100 and 1000
        do k = 1, 3
          call test%near(y(k), polynomial(c(:, k), t, 0), 1.0e-12_wp, 'the value of a polynomial is found again')
          call test%near(first(k), polynomial(c(:, k), t, 1), 1.0e-11_wp, 'the first derivative of a polynomial is found again')
          call test%near(second(k), polynomial(c(:, k), t, 2), 2.0e-10_wp, 'the second derivative of a polynomial is found again')
          call test%near(third(k), polynomial(c(:, k), t, 3), 5.0e-9_wp, 'the third derivative of a polynomial is found again')
        end do
      end do
    end do
  end subroutine polynomials

  !> Values of three polynomials at some places.
  function values_of(c, x) result(y)
    real(wp), intent(in) :: c(0:, :)   !< (0:5,3) coefficients
    real(wp), intent(in) :: x(:)       !< places
    real(wp) :: y(3, size(x))
    integer :: i, k

    do i = 1, size(x)
      y(:, i) = [(polynomial(c(:, k), x(i), 0), k=1, 3)]
    end do
  end function values_of

  !> A derivative of a polynomial.
  real(wp) function polynomial(c, x, derivative)
    real(wp), intent(in) :: c(0:)       !< coefficients
    real(wp), intent(in) :: x           !< the place
    integer, intent(in) :: derivative   !< its order
    integer :: i, k

    polynomial = 0.0_wp
    do i = derivative, ubound(c, 1)
      polynomial = polynomial + c(i)*product([(real(i - k, wp), k=0, derivative - 1)])*x**(i - derivative)
    end do
  end function polynomial

  !> Random points: the curve runs through them, and its derivatives up to the fourth are the same from both sides.
  subroutine smoothness(test, periodic)
    type(tester_type), intent(inout) :: test   !< counts the checks
    logical, intent(in) :: periodic            !< the curve is closed
    type(random_type) :: random
    type(quintic_spline_type) :: spline
    type(error_type), allocatable :: err
    real(wp), allocatable :: x(:), points(:, :)
    real(wp) :: left(3, 0:3), right(3, 0:3), tolerance(0:3), h
    integer :: n, i, k, d, before

    do n = 5, 40, 7
      x = [(0.2_wp*i + 0.07_wp*random%symmetric(), i=1, n)]
      points = reshape([(random%symmetric(), i=1, 3*n)], [3, n])
      if (periodic) points(:, n) = points(:, 1)
      call build_quintic(x, points, periodic, spline, err)
      call test%no_error(err, 'points without any order are accepted')
      ! roundings of derivatives, which reach some 10, 1000 and 50000
      tolerance = [1.0e-13_wp, 1.0e-12_wp, 1.0e-10_wp, 1.0e-8_wp]
      do i = merge(1, 2, periodic), n - 1
        before = merge(n - 1, i - 1, i == 1)
        call spline%evaluate(before, x(before + 1), left(:, 0), left(:, 1), left(:, 2), left(:, 3))
        call spline%evaluate(i, x(i), right(:, 0), right(:, 1), right(:, 2), right(:, 3))
        do k = 1, 3
          call test%near(right(k, 0), points(k, i), tolerance(0), 'the curve runs through its points')
          do d = 0, 3
            call test%near(left(k, d), right(k, d), tolerance(d), 'derivatives are the same from both sides of a point')
          end do
          h = x(before + 1) - x(before)
          call test%near((24.0_wp*spline%c(4, k, before) + 120.0_wp*spline%c(5, k, before))/h**4, &
                         24.0_wp*spline%c(4, k, i)/(x(i + 1) - x(i))**4, 1.0e-6_wp, &
                         'the fourth derivative is the same from both sides of a point')
        end do
      end do
    end do
  end subroutine smoothness

  !> Half the distance divides the errors of value and derivatives by 64, 32, 16 and 8, with ends and without.
  subroutine order(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: coarse(0:3), fine(0:3)
    integer :: i
    logical :: periodic

    do i = 0, 7
      periodic = i > 3
      if (mod(i, 4) == 0) then
        coarse = circle_errors(test, 32, periodic)
        fine = circle_errors(test, 64, periodic)
      end if
      ! errors of higher order change the quotient by a part of the order of the distance, 0.1 to 0.2
      call test%is_true(abs(coarse(mod(i, 4))/fine(mod(i, 4))/2.0_wp**(6 - mod(i, 4)) - 1.0_wp) < 0.3_wp, &
                        'value and derivatives converge with the orders 6, 5, 4 and 3')
    end do
  end subroutine order

  !> Largest errors of a unit circle through points at even distances, over its angle.
  function circle_errors(test, n, periodic) result(errors)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< pieces
    logical, intent(in) :: periodic            !< the curve is closed
    real(wp) :: errors(0:3)
    type(quintic_spline_type) :: spline
    type(error_type), allocatable :: err
    real(wp) :: x(0:n), points(3, 0:n), y(3, 0:3), t
    integer :: i, k, d

    x = [(2.0_wp*pi*i/n, i=0, n)]
    points(1, :) = cos(x)
    points(2, :) = sin(x)
    points(3, :) = 0.0_wp
    points(:, n) = merge(points(:, 0), points(:, n), periodic)
    call build_quintic(x, points, periodic, spline, err)
    call test%no_error(err, 'points of a circle are accepted')
    errors = 0.0_wp
    do i = 1, n
      do k = 0, 20
        t = x(i - 1) + k*(x(i) - x(i - 1))/20
        call spline%evaluate(i, t, y(:, 0), y(:, 1), y(:, 2), y(:, 3))
        do d = 0, 3
          errors(d) = max(errors(d), hypot(y(1, d) - cos(t + 0.5_wp*pi*d), y(2, d) - sin(t + 0.5_wp*pi*d)))
        end do
      end do
    end do
  end function circle_errors

  subroutine refused(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(quintic_spline_type) :: spline
    type(error_type), allocatable :: err
    real(wp) :: points(3, 5)

    points = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
                      0.0_wp, 0.0_wp, 0.0_wp], [3, 5])
    call build_quintic([1.0_wp, 2.0_wp, 3.0_wp], points(:, :3), .false., spline, err)
    call test%has_error(err, exit_data, 'three points are refused as too few')
    call build_quintic([1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp], points, .true., spline, err)
    call test%no_error(err, 'a closed curve through four points is accepted')
    call build_quintic([1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp], points(:, [1, 2, 3, 1]), .true., spline, err)
    call test%has_error(err, exit_data, 'a closed curve through three points is refused')
    call build_quintic([1.0_wp, 2.0_wp, 2.0_wp, 4.0_wp, 5.0_wp], points, .false., spline, err)
    call test%has_error(err, exit_data, 'two points at one value of the parameter are refused')
  end subroutine refused
end module test_quintic_spline
