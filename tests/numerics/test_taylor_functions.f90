!> Functions of Taylor arithmetic: against differences of the same function of real numbers, against
!> textbook derivatives, and against each other.
module test_taylor_functions
  use mech9_kinds, only: wp, pi
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_taylor, only: taylor, variable, constant, operator(+), operator(-), operator(*), operator(/), operator(**), &
    sqrt, exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, abs
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: function_count = 18

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('against_differences')) call against_differences(test)
    if (test%runs('textbook_derivatives')) call textbook_derivatives(test)
    if (test%runs('inverse_functions')) call inverse_functions(test)
    if (test%runs('related_functions')) call related_functions(test)
    if (test%runs('all_quadrants')) call all_quadrants(test)
  end subroutine run

  !> A smooth argument u(x) that stays between 0.15 and 0.85 for |x| <= 1.
  function argument_real(x, a) result(u)
    real(wp), intent(in) :: x   !< variable
    real(wp), intent(in) :: a   !< factor that chooses the argument
    real(wp) :: u

    u = 0.5_wp + 0.1_wp*a*x - 0.2_wp*x*x*a + 0.05_wp*x*x*x
  end function argument_real

  function argument_taylor(x, a) result(u)
    type(taylor), intent(in) :: x   !< variable
    real(wp), intent(in) :: a       !< factor that chooses the argument
    type(taylor) :: u

    u = 0.5_wp + 0.1_wp*a*x - 0.2_wp*x*x*a + 0.05_wp*x*x*x
  end function argument_taylor

  function value_real(number, u) result(f)
    integer, intent(in) :: number   !< of the function
    real(wp), intent(in) :: u       !< its argument
    real(wp) :: f

    include 'tested_functions.inc'
  end function value_real

  function value_taylor(number, u) result(f)
    integer, intent(in) :: number   !< of the function
    type(taylor), intent(in) :: u   !< its argument
    type(taylor) :: f

    include 'tested_functions.inc'
  end function value_taylor

  !> f(u(x)) by Taylor arithmetic and by differences of real numbers.
  subroutine against_differences(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), parameter :: h = 1.0_wp/64.0_wp
    character(len=2) :: name
    type(taylor) :: f
    real(wp) :: x, a, values(-half_width:half_width), first, second, error
    integer :: number, trial, i

    do number = 1, function_count
      write (name, '(i0)') number
      do trial = 1, 10
        x = 0.5_wp*random%symmetric()
        a = random%symmetric()
        f = value_taylor(number, argument_taylor(variable(x), a))
        do i = -half_width, half_width
          values(i) = value_real(number, argument_real(x + i*h, a))
        end do
        call derivatives_from_stencil(values, h, first, second, error)
        call test%near(f%value, values(0), 1.0e-15_wp, 'function '//name//': the value is right to one rounding')
        ! round-off of values of order ten (u^-3: 200) by 2/h and 8/h^2; truncation is far below
        call test%near(f%first, first, 1.0e-12_wp, 'function '//name//': the first derivative is the slope of the values')
        call test%near(f%second, second, 1.0e-10_wp, 'function '//name//': the second derivative is the curvature of the values')
      end do
    end do
  end subroutine against_differences

  subroutine derivatives(test, f, first, second, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor), intent(in) :: f              !< value with derivatives
    real(wp), intent(in) :: first              !< the right first derivative
    real(wp), intent(in) :: second             !< the right second derivative
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong

    ! ten roundings of numbers of order one
    call test%near(f%first, first, 4.0e-15_wp, why//': the first derivative is that of the closed form')
    call test%near(f%second, second, 1.0e-14_wp, why//': the second derivative is that of the closed form')
  end subroutine derivatives

  subroutine textbook_derivatives(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: q
    real(wp) :: x
    integer :: i

    do i = 1, 20
      x = 0.5_wp + 0.4_wp*random%symmetric()
      q = variable(x)
      call derivatives(test, sqrt(q), 1/(2*sqrt(x)), -1/(4*x*sqrt(x)), 'square root')
      call derivatives(test, exp(q), exp(x), exp(x), 'exponential')
      call derivatives(test, log(q), 1/x, -1/x**2, 'logarithm')
      call derivatives(test, sin(q), cos(x), -sin(x), 'sine')
      call derivatives(test, cos(q), -sin(x), -cos(x), 'cosine')
      call derivatives(test, tan(q), 1/cos(x)**2, 2*sin(x)/cos(x)**3, 'tangent')
      call derivatives(test, asin(q), 1/sqrt(1 - x**2), x/sqrt(1 - x**2)**3, 'arc sine')
      call derivatives(test, acos(q), -1/sqrt(1 - x**2), -x/sqrt(1 - x**2)**3, 'arc cosine')
      call derivatives(test, atan(q), 1/(1 + x**2), -2*x/(1 + x**2)**2, 'arc tangent')
      call derivatives(test, sinh(q), cosh(x), sinh(x), 'hyperbolic sine')
      call derivatives(test, cosh(q), sinh(x), cosh(x), 'hyperbolic cosine')
      call derivatives(test, tanh(q), 1/cosh(x)**2, -2*sinh(x)/cosh(x)**3, 'hyperbolic tangent')
      call derivatives(test, q**2.5_wp, 2.5_wp*x*sqrt(x), 3.75_wp*sqrt(x), 'power 5/2')
      call derivatives(test, 2.0_wp**q, log(2.0_wp)*2.0_wp**x, log(2.0_wp)**2*2.0_wp**x, 'power of two')
      call derivatives(test, q**q, x**x*(log(x) + 1), x**x*((log(x) + 1)**2 + 1/x), 'x^x')
      call derivatives(test, abs(-q), 1.0_wp, 0.0_wp, 'absolute value of a negative number')
    end do
  end subroutine textbook_derivatives

  subroutine same(test, a, b, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor), intent(in) :: a              !< value with derivatives
    type(taylor), intent(in) :: b              !< the right ones
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong

    ! arguments between 0.15 and 0.85: the worst of the functions below multiplies roundings by fifty
    call test%near(a%value, b%value, 1.0e-14_wp, why//': the values are equal')
    call test%near(a%first, b%first, 1.0e-14_wp, why//': the first derivatives are equal')
    call test%near(a%second, b%second, 4.0e-14_wp, why//': the second derivatives are equal')
  end subroutine same

  function random_argument(random) result(u)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(taylor) :: u

    u%value = 0.5_wp + 0.35_wp*random%symmetric()
    u%first = random%symmetric()
    u%second = random%symmetric()
  end function random_argument

  !> Each function undoes its inverse, with both derivatives.
  subroutine inverse_functions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: u
    integer :: i

    do i = 1, 30
      u = random_argument(random)
      call same(test, sqrt(u)*sqrt(u), u, 'square of the root')
      call same(test, sqrt(u*u), u, 'root of the square')
      call same(test, exp(log(u)), u, 'exponential of the logarithm')
      call same(test, log(exp(u)), u, 'logarithm of the exponential')
      call same(test, sin(asin(u)), u, 'sine of the arc sine')
      call same(test, asin(sin(u)), u, 'arc sine of the sine')
      call same(test, cos(acos(u)), u, 'cosine of the arc cosine')
      call same(test, acos(cos(u)), u, 'arc cosine of the cosine')
      call same(test, tan(atan(u)), u, 'tangent of the arc tangent')
      call same(test, atan(tan(u)), u, 'arc tangent of the tangent')
      call same(test, log(sinh(u) + cosh(u)), u, 'logarithm of the sum of the hyperbolic functions')
      call same(test, 0.5_wp*log((1.0_wp + tanh(u))/(1.0_wp - tanh(u))), u, 'inverse hyperbolic tangent of the tangent')
      call same(test, (u**1.3_wp)**(1.0_wp/1.3_wp), u, 'power of a power')
    end do
  end subroutine inverse_functions

  subroutine related_functions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(taylor) :: u
    integer :: i

    do i = 1, 30
      u = random_argument(random)
      call same(test, sin(u)**2 + cos(u)**2, constant(1.0_wp), 'sine and cosine')
      call same(test, cosh(u)**2 - sinh(u)**2, constant(1.0_wp), 'hyperbolic sine and cosine')
      call same(test, sin(u)/cos(u), tan(u), 'tangent')
      call same(test, sinh(u)/cosh(u), tanh(u), 'hyperbolic tangent')
      call same(test, sin(2.0_wp*u), 2.0_wp*sin(u)*cos(u), 'sine of twice the angle')
      call same(test, asin(u) + acos(u), constant(0.5_wp*pi), 'arc sine and arc cosine')
      call same(test, atan(u) + atan(1.0_wp/u), constant(0.5_wp*pi), 'arc tangents of a number and its reciprocal')
      call same(test, atan2(u, constant(1.0_wp)), atan(u), 'arc tangent of a quotient')
      call same(test, atan2(u, 1.0_wp), atan(u), 'arc tangent of a quotient, real divisor')
      call same(test, atan2(1.0_wp, u), atan(1.0_wp/u), 'arc tangent of a quotient, real dividend')
      call same(test, exp(u)*exp(-u), constant(1.0_wp), 'exponentials of opposite numbers')
      call same(test, log(u*u), 2.0_wp*log(u), 'logarithm of a square')
    end do
  end subroutine related_functions

  !> The angle of a point that runs around the origin grows with it in every quadrant.
  subroutine all_quadrants(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor) :: angle, back
    integer :: i

    do i = -35, 36
      angle = taylor(i*pi/36.0_wp - 0.01_wp, 1.3_wp, -0.4_wp)
      back = atan2(2.0_wp*sin(angle), 2.0_wp*cos(angle))
      call same(test, back, angle, 'the angle of a point on a circle')
    end do
  end subroutine all_quadrants
end module test_taylor_functions
