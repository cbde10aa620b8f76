!> Taylor arithmetic: a value with its first and second derivative in one variable, carried exactly through arithmetic and the
!> usual functions.
!>
!> Write a formula with `type(taylor)` as with real numbers; mixed operations with real numbers and
!> integers work, and so do arrays.
module mech9_taylor
  use mech9_kinds, only: wp
  use mech9_taylor_arithmetic, only: taylor, variable, constant, chain, assignment(=), operator(+), &
    operator(-), operator(*), operator(/)
  use mech9_taylor_comparison, only: operator(<), operator(<=), operator(>), operator(>=), operator(==), operator(/=), &
    min, max, sign
  implicit none
  private
  public :: taylor, variable, constant
  public :: assignment(=), operator(+), operator(-), operator(*), operator(/), operator(**)
  public :: operator(<), operator(<=), operator(>), operator(>=), operator(==), operator(/=)
  public :: sqrt, exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, abs, sign, min, max
  public :: hypot, sum, dot_product, norm2

  interface operator(**)
    module procedure power_ti, power_tr, power_tt, power_rt
  end interface operator(**)

  interface sqrt
    module procedure sqrt_t
  end interface sqrt

  interface exp
    module procedure exp_t
  end interface exp

  interface log
    module procedure log_t
  end interface log

  interface sin
    module procedure sin_t
  end interface sin

  interface cos
    module procedure cos_t
  end interface cos

  interface tan
    module procedure tan_t
  end interface tan

  interface asin
    module procedure asin_t
  end interface asin

  interface acos
    module procedure acos_t
  end interface acos

  interface atan
    module procedure atan_t
  end interface atan

  interface sinh
    module procedure sinh_t
  end interface sinh

  interface cosh
    module procedure cosh_t
  end interface cosh

  interface tanh
    module procedure tanh_t
  end interface tanh

  interface abs
    module procedure abs_t
  end interface abs

  interface atan2
    module procedure atan2_tt, atan2_tr, atan2_rt
  end interface atan2

  !> The third side of a right-angled triangle.
  interface hypot
    module procedure hypot_tt, hypot_tr, hypot_rt
  end interface hypot

  !> Sum of the elements of a vector.
  interface sum
    module procedure sum_t
  end interface sum

  !> Scalar product of two vectors.
  interface dot_product
    module procedure dot_product_tt, dot_product_tr, dot_product_rt
  end interface dot_product

  !> Length of a vector.
  interface norm2
    module procedure norm2_t
  end interface norm2

contains

  elemental type(taylor) function power_ti(a, n)
    type(taylor), intent(in) :: a   !< the base
    integer, intent(in) :: n        !< the exponent

    select case (n)
    case (0)
      power_ti = constant(1.0_wp)
    case (1)
      power_ti = a
    case (2)
      power_ti = a*a
    case default
      power_ti = chain(a, a%value**n, n*a%value**(n - 1), n*(n - 1.0_wp)*a%value**(n - 2))
    end select
  end function power_ti

  elemental type(taylor) function power_tr(a, b)
    type(taylor), intent(in) :: a   !< the base
    real(wp), intent(in) :: b       !< the exponent
    real(wp) :: first, second

    ! the power may be infinite where the factor is zero, and their product not a number: x**1.0 at 0
    first = 0.0_wp
    second = 0.0_wp
    if (abs(b) > 0.0_wp) first = b*a%value**(b - 1.0_wp)
    if (abs(b*(b - 1.0_wp)) > 0.0_wp) second = b*(b - 1.0_wp)*a%value**(b - 2.0_wp)
    power_tr = chain(a, a%value**b, first, second)
  end function power_tr

  elemental type(taylor) function power_tt(a, b)
    type(taylor), intent(in) :: a   !< the base
    type(taylor), intent(in) :: b   !< the exponent

    if (abs(b%first) <= 0.0_wp .and. abs(b%second) <= 0.0_wp) then
      power_tt = power_tr(a, b%value)   ! a constant exponent: also for bases without a logarithm
    else
      power_tt = exp_t(b*log_t(a))
    end if
  end function power_tt

  elemental type(taylor) function power_rt(a, b)
    real(wp), intent(in) :: a       !< the base
    type(taylor), intent(in) :: b   !< the exponent

    power_rt = exp_t(log(a)*b)
  end function power_rt

  elemental type(taylor) function sqrt_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: f

    f = sqrt(a%value)
    sqrt_t = chain(a, f, 0.5_wp/f, -0.25_wp/(f*a%value))
  end function sqrt_t

  elemental type(taylor) function exp_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: f

    f = exp(a%value)
    exp_t = chain(a, f, f, f)
  end function exp_t

  elemental type(taylor) function log_t(a)
    type(taylor), intent(in) :: a   !< the argument

    log_t = chain(a, log(a%value), 1.0_wp/a%value, -1.0_wp/a%value**2)
  end function log_t

  elemental type(taylor) function sin_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: s, c

    s = sin(a%value)
    c = cos(a%value)
    sin_t = chain(a, s, c, -s)
  end function sin_t

  elemental type(taylor) function cos_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: s, c

    s = sin(a%value)
    c = cos(a%value)
    cos_t = chain(a, c, -s, -c)
  end function cos_t

  elemental type(taylor) function tan_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: f

    f = tan(a%value)
    tan_t = chain(a, f, 1.0_wp + f*f, 2.0_wp*f*(1.0_wp + f*f))
  end function tan_t

  elemental type(taylor) function asin_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: g

    g = 1.0_wp/sqrt((1.0_wp - a%value)*(1.0_wp + a%value))
    asin_t = chain(a, asin(a%value), g, a%value*g**3)
  end function asin_t

  elemental type(taylor) function acos_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: g

    g = 1.0_wp/sqrt((1.0_wp - a%value)*(1.0_wp + a%value))
    acos_t = chain(a, acos(a%value), -g, -a%value*g**3)
  end function acos_t

  elemental type(taylor) function atan_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: g

    g = 1.0_wp/(1.0_wp + a%value**2)
    atan_t = chain(a, atan(a%value), g, -2.0_wp*a%value*g*g)
  end function atan_t

  elemental type(taylor) function sinh_t(a)
    type(taylor), intent(in) :: a   !< the argument

    sinh_t = chain(a, sinh(a%value), cosh(a%value), sinh(a%value))
  end function sinh_t

  elemental type(taylor) function cosh_t(a)
    type(taylor), intent(in) :: a   !< the argument

    cosh_t = chain(a, cosh(a%value), sinh(a%value), cosh(a%value))
  end function cosh_t

  elemental type(taylor) function tanh_t(a)
    type(taylor), intent(in) :: a   !< the argument
    real(wp) :: f

    f = tanh(a%value)
    tanh_t = chain(a, f, 1.0_wp - f*f, -2.0_wp*f*(1.0_wp - f*f))
  end function tanh_t

  elemental type(taylor) function abs_t(a)
    type(taylor), intent(in) :: a   !< the argument

    abs_t = merge(a, -a, a%value >= 0.0_wp)
  end function abs_t

  !> Angle of the point (b, a), in all four quadrants.
  elemental type(taylor) function atan2_tt(a, b)
    type(taylor), intent(in) :: a   !< ordinate of the point
    type(taylor), intent(in) :: b   !< abscissa of the point
    real(wp) :: square, turn

    square = a%value**2 + b%value**2
    turn = (a%first*b%value - a%value*b%first)/square
    atan2_tt%value = atan2(a%value, b%value)
    atan2_tt%first = turn
    atan2_tt%second = (a%second*b%value - a%value*b%second &
                       - 2.0_wp*turn*(a%value*a%first + b%value*b%first))/square
  end function atan2_tt

  elemental type(taylor) function atan2_tr(a, b)
    type(taylor), intent(in) :: a   !< ordinate of the point
    real(wp), intent(in) :: b       !< abscissa of the point

    atan2_tr = atan2_tt(a, constant(b))
  end function atan2_tr

  elemental type(taylor) function atan2_rt(a, b)
    real(wp), intent(in) :: a       !< ordinate of the point
    type(taylor), intent(in) :: b   !< abscissa of the point

    atan2_rt = atan2_tt(constant(a), b)
  end function atan2_rt

  elemental type(taylor) function hypot_tt(a, b)
    type(taylor), intent(in) :: a   !< one side at the right angle
    type(taylor), intent(in) :: b   !< the other side at the right angle

    hypot_tt = norm2_t([a, b])
  end function hypot_tt

  elemental type(taylor) function hypot_tr(a, b)
    type(taylor), intent(in) :: a   !< one side at the right angle
    real(wp), intent(in) :: b       !< the other side at the right angle

    hypot_tr = norm2_t([a, constant(b)])
  end function hypot_tr

  elemental type(taylor) function hypot_rt(a, b)
    real(wp), intent(in) :: a       !< one side at the right angle
    type(taylor), intent(in) :: b   !< the other side at the right angle

    hypot_rt = norm2_t([constant(a), b])
  end function hypot_rt

  pure type(taylor) function sum_t(a)
    type(taylor), intent(in) :: a(:)   !< the vector

    sum_t = taylor(sum(a%value), sum(a%first), sum(a%second))
  end function sum_t

  pure type(taylor) function dot_product_tt(a, b)
    type(taylor), intent(in) :: a(:)   !< one vector
    type(taylor), intent(in) :: b(:)   !< the other vector, of the same size

    dot_product_tt = sum_t(a*b)
  end function dot_product_tt

  pure type(taylor) function dot_product_tr(a, b)
    type(taylor), intent(in) :: a(:)   !< one vector
    real(wp), intent(in) :: b(:)       !< the other vector, of the same size

    dot_product_tr = sum_t(a*b)
  end function dot_product_tr

  pure type(taylor) function dot_product_rt(a, b)
    real(wp), intent(in) :: a(:)       !< one vector
    type(taylor), intent(in) :: b(:)   !< the other vector, of the same size

    dot_product_rt = sum_t(a*b)
  end function dot_product_rt

  !> The length of a vector, from |a|^2 differentiated twice, without squares that overflow.
  pure type(taylor) function norm2_t(a)
    type(taylor), intent(in) :: a(:)   !< the vector
    real(wp) :: length, rate

    length = norm2(a%value)
    rate = sum(a%value/length*a%first)
    norm2_t = taylor(length, rate, &
                     sum(a%value/length*a%second) + (sum(a%first/length*a%first) - rate/length*rate))
  end function norm2_t
end module mech9_taylor
