!> Taylor arithmetic: sums, products and lengths of vectors, signs, comparisons with integers. Against the same
!> written out in operations that are tested on their own, and against closed forms.
module test_taylor_vectors
  use mech9_kinds, only: wp
  use mech9_taylor, only: taylor, variable, constant, assignment(=), operator(+), operator(-), operator(*), operator(/), &
    operator(**), operator(<), operator(<=), operator(>), operator(>=), operator(==), operator(/=), sqrt, sin, cos, abs, &
    sign, hypot, sum, dot_product, norm2
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Some operations on numbers of order one.
  real(wp), parameter :: tolerance = 1.0e-14_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('functions')) call functions(test)
    if (test%runs('integers')) call integers(test)
  end subroutine run

  subroutine functions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor) :: x, u(3), v(3)
    real(wp) :: a(3)

    x = variable(0.7_wp)
    u = [sin(x), 2.0_wp*x, x**2 - 1.0_wp]
    v = [cos(x), x, 3.0_wp/x]
    a = [0.3_wp, -1.2_wp, 2.0_wp]
    call same(test, sum(u), u(1) + u(2) + u(3), 'a sum')
    call same(test, sum(u(1:0)), constant(0.0_wp), 'a sum of nothing')
    call same(test, dot_product(u, v), u(1)*v(1) + u(2)*v(2) + u(3)*v(3), 'a scalar product')
    call same(test, dot_product(u, a), u(1)*a(1) + u(2)*a(2) + u(3)*a(3), 'a scalar product with numbers')
    call same(test, dot_product(a, u), dot_product(u, a), 'the same the other way round')
    call same(test, norm2(u), sqrt(u(1)**2 + u(2)**2 + u(3)**2), 'a length')
    call same(test, hypot(u(1), v(3)), sqrt(u(1)**2 + v(3)**2), 'the third side')
    call same(test, hypot(u(1), 2.0_wp), sqrt(u(1)**2 + 4.0_wp), 'the third side, one given')
    call same(test, hypot(2.0_wp, u(1)), hypot(u(1), 2.0_wp), 'the third side, the other given')
    call same(test, norm2([cos(x), sin(x)]), constant(1.0_wp), 'a point on the unit circle stays there')
    call same(test, hypot(3.0_wp*x, 4.0_wp*x), 5.0_wp*x, 'a straight way')
    ! squares of these would overflow
    call same(test, norm2(1.0e200_wp*[3.0_wp*x, 4.0_wp*x])/1.0e200_wp, 5.0_wp*x, 'a long way')
    call same(test, sign(u(3), x), abs(u(3)), 'the sign of something positive')
    call same(test, sign(x, u(3)), -x, 'the sign of something negative')
    call same(test, sign(u(3), -2.0_wp), u(3), 'a sign that it has')
    call same(test, sign(-2.0_wp, x), constant(2.0_wp), 'a number with the sign of a function')
  end subroutine functions

  subroutine integers(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor) :: two

    two = taylor(2.0_wp, 5.0_wp, -3.0_wp)
    call test%is_true(two < 3 .and. .not. two < 2 .and. 1 < two .and. .not. 2 < two, '< compares a value with an integer')
    call test%is_true(two <= 2 .and. .not. two <= 1 .and. 2 <= two .and. .not. 3 <= two, '<= compares a value with an integer')
    call test%is_true(two > 1 .and. .not. two > 2 .and. 3 > two .and. .not. 2 > two, '> compares a value with an integer')
    call test%is_true(two >= 2 .and. .not. two >= 3 .and. 2 >= two .and. .not. 1 >= two, '>= compares a value with an integer')
    call test%is_true(two == 2 .and. .not. two == 3 .and. 2 == two .and. .not. 1 == two, '== compares a value with an integer')
    call test%is_true(two /= 3 .and. .not. two /= 2 .and. 1 /= two .and. .not. 2 /= two, '/= compares a value with an integer')
  end subroutine integers

  subroutine same(test, f, expected, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(taylor), intent(in) :: f              !< value with derivatives
    type(taylor), intent(in) :: expected       !< the right ones
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp) :: scale

    scale = max(1.0_wp, abs(expected%value), abs(expected%first), abs(expected%second))
    call test%near(f%value/scale, expected%value/scale, tolerance, why//': the value is right')
    call test%near(f%first/scale, expected%first/scale, tolerance, why//': the first derivative is right')
    call test%near(f%second/scale, expected%second/scale, tolerance, why//': the second derivative is right')
  end subroutine same
end module test_taylor_vectors
