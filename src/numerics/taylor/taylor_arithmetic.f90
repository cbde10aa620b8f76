!> Taylor arithmetic, first part: the type and its operations.
module mech9_taylor_arithmetic
  use mech9_kinds, only: wp
  implicit none
  private
  public :: taylor, variable, constant, chain
  public :: assignment(=), operator(+), operator(-), operator(*), operator(/)

  !> A function of one variable x at some x.
  type :: taylor
    real(wp) :: value = 0.0_wp    !< f
    real(wp) :: first = 0.0_wp    !< df/dx
    real(wp) :: second = 0.0_wp   !< d2f/dx2
  end type taylor

  interface assignment(=)
    module procedure assign_real, assign_integer
  end interface assignment(=)

  interface operator(+)
    module procedure add, add_tr, add_rt, add_ti, add_it, plus_sign
  end interface operator(+)

  interface operator(-)
    module procedure subtract, subtract_tr, subtract_rt, subtract_ti, subtract_it, negate
  end interface operator(-)

  interface operator(*)
    module procedure multiply, multiply_tr, multiply_rt, multiply_ti, multiply_it
  end interface operator(*)

  interface operator(/)
    module procedure divide, divide_tr, divide_rt, divide_ti, divide_it
  end interface operator(/)

contains

  !> The variable itself at x: derivative 1.
  elemental type(taylor) function variable(x)
    real(wp), intent(in) :: x   !< value of the variable

    variable = taylor(x, 1.0_wp, 0.0_wp)
  end function variable

  !> A number that does not depend on the variable.
  elemental type(taylor) function constant(x)
    real(wp), intent(in) :: x   !< the number

    constant = taylor(x, 0.0_wp, 0.0_wp)
  end function constant

  !> f(u) from f, f', f'' at u's value.
  elemental type(taylor) function chain(u, f, f1, f2)
    type(taylor), intent(in) :: u   !< the inner function
    real(wp), intent(in) :: f       !< value of the outer function at the value of u
    real(wp), intent(in) :: f1      !< its first derivative there
    real(wp), intent(in) :: f2      !< its second derivative there

    chain = taylor(f, f1*u%first, f1*u%second + f2*u%first**2)
  end function chain

  elemental subroutine assign_real(a, x)
    type(taylor), intent(out) :: a   !< the function, a constant afterwards
    real(wp), intent(in) :: x        !< the number

    a = constant(x)
  end subroutine assign_real

  elemental subroutine assign_integer(a, n)
    type(taylor), intent(out) :: a   !< the function, a constant afterwards
    integer, intent(in) :: n         !< the number

    a = constant(real(n, wp))
  end subroutine assign_integer

  elemental type(taylor) function plus_sign(a)
    type(taylor), intent(in) :: a   !< the operand

    plus_sign = a
  end function plus_sign

  elemental type(taylor) function negate(a)
    type(taylor), intent(in) :: a   !< the operand

    negate = taylor(-a%value, -a%first, -a%second)
  end function negate

  elemental type(taylor) function add(a, b)
    type(taylor), intent(in) :: a   !< left operand
    type(taylor), intent(in) :: b   !< right operand

    add = taylor(a%value + b%value, a%first + b%first, a%second + b%second)
  end function add

  elemental type(taylor) function subtract(a, b)
    type(taylor), intent(in) :: a   !< left operand
    type(taylor), intent(in) :: b   !< right operand

    subtract = taylor(a%value - b%value, a%first - b%first, a%second - b%second)
  end function subtract

  elemental type(taylor) function multiply(a, b)
    type(taylor), intent(in) :: a   !< left operand
    type(taylor), intent(in) :: b   !< right operand

    multiply = taylor(a%value*b%value, a%first*b%value + a%value*b%first, &
                      a%second*b%value + 2.0_wp*a%first*b%first + a%value*b%second)
  end function multiply

  elemental type(taylor) function divide(a, b)
    type(taylor), intent(in) :: a   !< left operand
    type(taylor), intent(in) :: b   !< right operand

    divide%value = a%value/b%value
    divide%first = (a%first - divide%value*b%first)/b%value
    divide%second = (a%second - 2.0_wp*divide%first*b%first - divide%value*b%second)/b%value
  end function divide

  elemental type(taylor) function add_tr(a, b)
    type(taylor), intent(in) :: a   !< left operand
    real(wp), intent(in) :: b       !< right operand

    add_tr = taylor(a%value + b, a%first, a%second)
  end function add_tr

  elemental type(taylor) function add_rt(a, b)
    real(wp), intent(in) :: a       !< left operand
    type(taylor), intent(in) :: b   !< right operand

    add_rt = taylor(a + b%value, b%first, b%second)
  end function add_rt

  elemental type(taylor) function add_ti(a, b)
    type(taylor), intent(in) :: a   !< left operand
    integer, intent(in) :: b        !< right operand

    add_ti = add_tr(a, real(b, wp))
  end function add_ti

  elemental type(taylor) function add_it(a, b)
    integer, intent(in) :: a        !< left operand
    type(taylor), intent(in) :: b   !< right operand

    add_it = add_rt(real(a, wp), b)
  end function add_it

  elemental type(taylor) function subtract_tr(a, b)
    type(taylor), intent(in) :: a   !< left operand
    real(wp), intent(in) :: b       !< right operand

    subtract_tr = taylor(a%value - b, a%first, a%second)
  end function subtract_tr

  elemental type(taylor) function subtract_rt(a, b)
    real(wp), intent(in) :: a       !< left operand
    type(taylor), intent(in) :: b   !< right operand

    subtract_rt = taylor(a - b%value, -b%first, -b%second)
  end function subtract_rt

  elemental type(taylor) function subtract_ti(a, b)
    type(taylor), intent(in) :: a   !< left operand
    integer, intent(in) :: b        !< right operand

    subtract_ti = subtract_tr(a, real(b, wp))
  end function subtract_ti

  elemental type(taylor) function subtract_it(a, b)
    integer, intent(in) :: a        !< left operand
    type(taylor), intent(in) :: b   !< right operand

    subtract_it = subtract_rt(real(a, wp), b)
  end function subtract_it

  elemental type(taylor) function multiply_tr(a, b)
    type(taylor), intent(in) :: a   !< left operand
    real(wp), intent(in) :: b       !< right operand

    multiply_tr = taylor(a%value*b, a%first*b, a%second*b)
  end function multiply_tr

  elemental type(taylor) function multiply_rt(a, b)
    real(wp), intent(in) :: a       !< left operand
    type(taylor), intent(in) :: b   !< right operand

    multiply_rt = taylor(a*b%value, a*b%first, a*b%second)
  end function multiply_rt

  elemental type(taylor) function multiply_ti(a, b)
    type(taylor), intent(in) :: a   !< left operand
    integer, intent(in) :: b        !< right operand

    multiply_ti = multiply_tr(a, real(b, wp))
  end function multiply_ti

  elemental type(taylor) function multiply_it(a, b)
    integer, intent(in) :: a        !< left operand
    type(taylor), intent(in) :: b   !< right operand

    multiply_it = multiply_rt(real(a, wp), b)
  end function multiply_it

  elemental type(taylor) function divide_tr(a, b)
    type(taylor), intent(in) :: a   !< left operand
    real(wp), intent(in) :: b       !< right operand

    divide_tr = taylor(a%value/b, a%first/b, a%second/b)
  end function divide_tr

  elemental type(taylor) function divide_rt(a, b)
    real(wp), intent(in) :: a       !< left operand
    type(taylor), intent(in) :: b   !< right operand

    divide_rt = divide(constant(a), b)
  end function divide_rt

  elemental type(taylor) function divide_ti(a, b)
    type(taylor), intent(in) :: a   !< left operand
    integer, intent(in) :: b        !< right operand

    divide_ti = divide_tr(a, real(b, wp))
  end function divide_ti

  elemental type(taylor) function divide_it(a, b)
    integer, intent(in) :: a        !< left operand
    type(taylor), intent(in) :: b   !< right operand

    divide_it = divide_rt(real(a, wp), b)
  end function divide_it
end module mech9_taylor_arithmetic
