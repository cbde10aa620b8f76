!> Taylor arithmetic: operations, comparisons, mixed operands, arrays, powers.
!>
!> The oracle is the algebra of polynomials: with u = a0 + a1 x + a2 x^2 the value and derivatives at
!> x = 0 are a0, a1, 2 a2, and sums, products and quotients of polynomials are known by their coefficients.
module test_taylor_operations
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_taylor, only: taylor, variable, constant, assignment(=), operator(+), operator(-), operator(*), &
    operator(/), operator(**), operator(<), operator(<=), operator(>), operator(>=), operator(==), operator(/=), &
    abs, min, max, sqrt, exp, log
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Some tens of roundings of numbers up to ten.
  real(wp), parameter :: round_off = 1.0e-13_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('against_polynomials')) call against_polynomials(test)
    if (test%runs('identities')) call identities(test)
    if (test%runs('mixed_operands')) call mixed_operands(test)
    if (test%runs('powers')) call powers(test)
    if (test%runs('powers_at_zero')) call powers_at_zero(test)
    if (test%runs('comparisons')) call comparisons(test)
    if (test%runs('arrays')) call arrays(test)
  end subroutine run

  subroutine same(test, a, b, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor), intent(in) :: a              !< value with derivatives
    type(taylor), intent(in) :: b              !< the right ones
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong

    call test%near(a%value, b%value, round_off, why//': the values are equal')
    call test%near(a%first, b%first, round_off, why//': the first derivatives are equal')
    call test%near(a%second, b%second, round_off, why//': the second derivatives are equal')
  end subroutine same

  function random_taylor(random) result(a)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(taylor) :: a

    a%value = sign(1.0_wp, random%symmetric())
    a%value = a%value*(1.2_wp + 0.7_wp*random%symmetric())   ! away from zero: it may be divided by
    a%first = random%symmetric()
    a%second = random%symmetric()
  end function random_taylor

  !> The function with these three coefficients at x = 0.
  function from_coefficients(c) result(a)
    real(wp), intent(in) :: c(0:2)   !< of 1, x, x^2
    type(taylor) :: a

    a = taylor(c(0), c(1), 2.0_wp*c(2))
  end function from_coefficients

  subroutine against_polynomials(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: u, v
    real(wp) :: a(0:2), b(0:2), product(0:2), quotient(0:2)
    integer :: i

    do i = 1, 50
      u = random_taylor(random)
      v = random_taylor(random)
      a = [u%value, u%first, 0.5_wp*u%second]
      b = [v%value, v%first, 0.5_wp*v%second]
      product = [a(0)*b(0), a(0)*b(1) + a(1)*b(0), a(0)*b(2) + a(1)*b(1) + a(2)*b(0)]
      quotient(0) = a(0)/b(0)   ! long division of the power series
      quotient(1) = (a(1) - quotient(0)*b(1))/b(0)
      quotient(2) = (a(2) - quotient(0)*b(2) - quotient(1)*b(1))/b(0)
      call same(test, u + v, from_coefficients(a + b), 'sum')
      call same(test, u - v, from_coefficients(a - b), 'difference')
      call same(test, u*v, from_coefficients(product), 'product')
      call same(test, u/v, from_coefficients(quotient), 'quotient')
    end do
  end subroutine against_polynomials

  subroutine identities(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: u, v, w
    integer :: i

    do i = 1, 50
      u = random_taylor(random)
      v = random_taylor(random)
      w = random_taylor(random)
      call same(test, (u/v)*v, u, 'a quotient times its divisor')
      call same(test, u*(v + w), u*v + u*w, 'distribution')
      call same(test, (u*v)*w, u*(v*w), 'association')
      call same(test, u - v, -(v - u), 'exchange in a difference')
      call same(test, +u, u, 'plus sign')
      call same(test, u + (-u), constant(0.0_wp), 'a number and its opposite')
      call same(test, abs(u)*abs(u), u*u, 'absolute value')
      call test%is_true(abs(u) >= 0.0_wp, 'no absolute value is negative')
      call same(test, min(u, v) + max(u, v), u + v, 'the lesser and the greater')
      call test%is_true(min(u, v) <= max(u, v), 'the lesser of two numbers is not greater than the greater')
    end do
  end subroutine identities

  !> Real numbers and integers beside Taylor numbers act as constants, on either side.
  subroutine mixed_operands(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: u, x, k
    real(wp) :: r
    integer :: i, n

    x = 2.5_wp
    call same(test, x, constant(2.5_wp), 'a real number assigned')
    x = 3
    call same(test, x, constant(3.0_wp), 'an integer assigned')
    x = variable(0.3_wp)
    call same(test, x, taylor(0.3_wp, 1.0_wp, 0.0_wp), 'the variable itself')
    do i = 1, 20
      u = random_taylor(random)
      r = 1.5_wp + random%symmetric()
      k = constant(r)
      call same(test, u + r, u + k, 'Taylor + real')
      call same(test, r + u, k + u, 'real + Taylor')
      call same(test, u - r, u - k, 'Taylor - real')
      call same(test, r - u, k - u, 'real - Taylor')
      call same(test, u*r, u*k, 'Taylor * real')
      call same(test, r*u, k*u, 'real * Taylor')
      call same(test, u/r, u/k, 'Taylor / real')
      call same(test, r/u, k/u, 'real / Taylor')
      call same(test, min(u, r), min(u, k), 'least of Taylor and real')
      call same(test, min(r, u), min(k, u), 'least of real and Taylor')
      call same(test, max(u, r), max(u, k), 'greatest of Taylor and real')
      call same(test, max(r, u), max(k, u), 'greatest of real and Taylor')
      n = 2 + i
      k = constant(real(n, wp))
      call same(test, u + n, u + k, 'Taylor + integer')
      call same(test, n + u, k + u, 'integer + Taylor')
      call same(test, u - n, u - k, 'Taylor - integer')
      call same(test, n - u, k - u, 'integer - Taylor')
      call same(test, u*n, u*k, 'Taylor * integer')
      call same(test, n*u, k*u, 'integer * Taylor')
      call same(test, u/n, u/k, 'Taylor / integer')
      call same(test, n/u, k/u, 'integer / Taylor')
    end do
  end subroutine mixed_operands

  !> Powers against repeated products, roots and logarithms.
  subroutine powers(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: u, v, product
    integer :: i, n

    do i = 1, 20
      u = random_taylor(random)
      product = constant(1.0_wp)
      do n = 0, 5
        call same(test, (u**n)/product, constant(1.0_wp), 'a whole power is a repeated product')
        call same(test, u**(-n)*product, constant(1.0_wp), 'a negative power is its reciprocal')
        call same(test, (abs(u)**real(n, wp))/abs(product), constant(1.0_wp), 'a whole number given as real')
        product = product*u
      end do
      u = abs(u)
      v = random_taylor(random)
      call same(test, u**0.5_wp, sqrt(u), 'power one half')
      call same(test, u**(-0.5_wp)*sqrt(u), constant(1.0_wp), 'power minus one half')
      call same(test, u**constant(1.7_wp), u**1.7_wp, 'an exponent that does not change')
      call same(test, u**v, exp(v*log(u)), 'an exponent that changes')
      call same(test, log(1.7_wp**v)/log(1.7_wp), v, 'power of a real number')
    end do
  end subroutine powers

  !> At zero a power is as smooth as its exponent says; nothing is divided by zero.
  subroutine powers_at_zero(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor) :: x

    x = variable(0.0_wp)
    call same(test, x**0, constant(1.0_wp), 'x^0 at 0')
    call same(test, x**1, x, 'x^1 at 0')
    call same(test, x**2, taylor(0.0_wp, 0.0_wp, 2.0_wp), 'x^2 at 0')
    call same(test, x**3, taylor(0.0_wp, 0.0_wp, 0.0_wp), 'x^3 at 0')
    call same(test, x**0.0_wp, constant(1.0_wp), 'x^0.0 at 0')
    call same(test, x**1.0_wp, x, 'x^1.0 at 0')
    call same(test, x**2.0_wp, taylor(0.0_wp, 0.0_wp, 2.0_wp), 'x^2.0 at 0')
    call same(test, x**2.5_wp, taylor(0.0_wp, 0.0_wp, 0.0_wp), 'x^2.5 at 0')
    call same(test, x**constant(2.0_wp), taylor(0.0_wp, 0.0_wp, 2.0_wp), 'x^2 at 0, with a constant as exponent')
    x = variable(-1.5_wp)
    call same(test, x**constant(3.0_wp), x*x*x, 'a cube of a negative number')
  end subroutine powers_at_zero

  !> Comparisons look at values only.
  subroutine comparisons(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor) :: a, b
    real(wp) :: x, y
    integer :: i, j

    do i = -1, 1
      do j = -1, 1
        x = real(i, wp)
        y = real(j, wp)
        a = taylor(x, 5.0_wp, -3.0_wp)
        b = taylor(y, -7.0_wp, 2.0_wp)
        call test%is_true(((a < b) .eqv. (i < j)) .and. ((a < y) .eqv. (i < j)) .and. ((x < b) .eqv. (i < j)), &
                          '< compares the values')
        call test%is_true(((a <= b) .eqv. (i <= j)) .and. ((a <= y) .eqv. (i <= j)) .and. ((x <= b) .eqv. (i <= j)), &
                          '<= compares the values')
        call test%is_true(((a > b) .eqv. (i > j)) .and. ((a > y) .eqv. (i > j)) .and. ((x > b) .eqv. (i > j)), &
                          '> compares the values')
        call test%is_true(((a >= b) .eqv. (i >= j)) .and. ((a >= y) .eqv. (i >= j)) .and. ((x >= b) .eqv. (i >= j)), &
                          '>= compares the values')
        call test%is_true(((a == b) .eqv. (i == j)) .and. ((a == y) .eqv. (i == j)) .and. ((x == b) .eqv. (i == j)), &
                          '== compares the values')
        call test%is_true(((a /= b) .eqv. (i /= j)) .and. ((a /= y) .eqv. (i /= j)) .and. ((x /= b) .eqv. (i /= j)), &
                          '/= compares the values')
      end do
    end do
  end subroutine comparisons

  !> Arrays go through element by element, with scalars beside them.
  subroutine arrays(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: a(3), b(3), c(3), d(2, 2), u
    integer :: i

    u = random_taylor(random)
    do i = 1, 3
      a(i) = random_taylor(random)
      b(i) = random_taylor(random)
    end do
    c = (a*b + 2.0_wp*u)/abs(b) - a**2
    do i = 1, 3
      call same(test, c(i), (a(i)*b(i) + 2.0_wp*u)/abs(b(i)) - a(i)**2, 'an expression of arrays')
    end do
    c = [1.0_wp, 2.0_wp, 3.0_wp]
    call same(test, c(3), constant(3.0_wp), 'an array of real numbers assigned')
    d = 0.0_wp
    d(:, 2) = a(1:2)*[2.0_wp, 3.0_wp]
    call same(test, d(2, 1), constant(0.0_wp), 'a real number assigned to an array')
    call same(test, d(2, 2), 3.0_wp*a(2), 'a section times real numbers')
    call test%is_true(all(abs(a) >= 0.0_wp) .and. all(max(a, b) >= min(a, b)), &
                      'absolute value, maximum and minimum of arrays are taken entry by entry')
  end subroutine arrays
end module test_taylor_operations
