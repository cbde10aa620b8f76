!> Polynomials through values and two derivatives: they reproduce polynomials, and approach other functions.
module test_hermite
  use mech9_kinds, only: wp
  use mech9_hermite, only: hermite_type, build_hermite
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: nodes(4) = [-1.0_wp, -0.5_wp, 0.5_wp, 1.0_wp]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('powers_and_sine')) call powers_and_sine(test)
    if (test%runs('many_abscissas')) call many_abscissas(test)
  end subroutine run

  !> The highest power that the points determine, and a sine.
  subroutine powers_and_sine(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(hermite_type) :: hermite
    real(wp) :: y(2, 4), dy(2, 4), ddy(2, 4), v(2), dv(2), ddv(2), x
    integer :: i, n

    do n = 1, 4
      ! x^(3n-1), the highest power that n points determine, and a sine
      do i = 1, n
        call power(nodes(i), 3*n - 1, y(1, i), dy(1, i), ddy(1, i))
        y(2, i) = sin(nodes(i))
        dy(2, i) = cos(nodes(i))
        ddy(2, i) = -sin(nodes(i))
      end do
      call build_hermite(nodes(:n), y(:, :n), dy(:, :n), ddy(:, :n), hermite)
      do i = -10, 10
        x = 0.1_wp*i
        call hermite%evaluate(x, v, dv, ddv)
        call power(x, 3*n - 1, y(1, 4), dy(1, 4), ddy(1, 4))
        ! round-off of a dozen differences over distances of one half or more
        call test%near(v(1), y(1, 4), 1.0e-12_wp, 'a power is interpolated exactly')
        call test%near(dv(1), dy(1, 4), 1.0e-11_wp, 'the derivative of a power is interpolated exactly')
        call test%near(ddv(1), ddy(1, 4), 1.0e-10_wp, 'the second derivative of a power is interpolated exactly')
        if (n < 4) cycle
        ! |f^(12)|/12! times the product of the cubed distances: 2e-9/1e2; two more derivatives cost factors of ten
        call test%near(v(2), sin(x), 1.0e-10_wp, 'the sine is interpolated within the error of the formula')
        call test%near(dv(2), cos(x), 1.0e-9_wp, 'the derivative of the interpolated sine is the cosine')
        call test%near(ddv(2), -sin(x), 1.0e-8_wp, 'the second derivative of the interpolated sine is the negative sine')
      end do
    end do
  end subroutine powers_and_sine

  !> A power of the highest degree and its derivatives, each at many abscissas at once.
  subroutine many_abscissas(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: degree = 3*size(nodes) - 1
    ! round-off as for single abscissas
    real(wp), parameter :: round_off(0:2) = [1.0e-12_wp, 1.0e-11_wp, 1.0e-10_wp]
    type(hermite_type) :: hermite
    real(wp) :: y(1, size(nodes)), dy(1, size(nodes)), ddy(1, size(nodes)), x(21), values(21), right(21, 0:2)
    integer :: i, order

    do i = 1, size(nodes)
      call power(nodes(i), degree, y(1, i), dy(1, i), ddy(1, i))
    end do
    call build_hermite(nodes, y, dy, ddy, hermite)
    do i = 1, size(x)
      x(i) = 0.1_wp*(i - 11)
      call power(x(i), degree, right(i, 0), right(i, 1), right(i, 2))
    end do
    do order = 0, 2
      call hermite%first_at(x, order, values)
      call test%near(maxval(abs(values - right(:, order))), 0.0_wp, round_off(order), 'a derivative of a power at many abscissas')
    end do
  end subroutine many_abscissas

  pure subroutine power(x, k, y, dy, ddy)
    real(wp), intent(in) :: x      !< base
    integer, intent(in) :: k       !< exponent
    real(wp), intent(out) :: y     !< x^k
    real(wp), intent(out) :: dy    !< its first derivative
    real(wp), intent(out) :: ddy   !< its second derivative

    y = x**k
    dy = k*x**(k - 1)
    ddy = k*(k - 1)*x**(k - 2)
  end subroutine power
end module test_hermite
