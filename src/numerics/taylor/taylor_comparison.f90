!> Taylor arithmetic, second part: comparisons, least and greatest numbers, and signs, for which the values alone decide.
module mech9_taylor_comparison
  use mech9_kinds, only: wp
  use mech9_taylor_arithmetic, only: taylor, constant, operator(*)
  implicit none
  private
  public :: operator(<), operator(<=), operator(>), operator(>=), operator(==), operator(/=)
  public :: min, max, sign

  interface operator(<)
    module procedure less_tt, less_tr, less_rt, less_ti, less_it
  end interface operator(<)

  interface operator(<=)
    module procedure less_equal_tt, less_equal_tr, less_equal_rt, less_equal_ti, less_equal_it
  end interface operator(<=)

  interface operator(>)
    module procedure greater_tt, greater_tr, greater_rt, greater_ti, greater_it
  end interface operator(>)

  interface operator(>=)
    module procedure greater_equal_tt, greater_equal_tr, greater_equal_rt, greater_equal_ti, greater_equal_it
  end interface operator(>=)

  interface operator(==)
    module procedure equal_tt, equal_tr, equal_rt, equal_ti, equal_it
  end interface operator(==)

  interface operator(/=)
    module procedure unequal_tt, unequal_tr, unequal_rt, unequal_ti, unequal_it
  end interface operator(/=)

  interface min
    module procedure min_tt, min_tr, min_rt
  end interface min

  interface max
    module procedure max_tt, max_tr, max_rt
  end interface max

  !> The size of the first with the sign of the second.
  interface sign
    module procedure sign_tt, sign_tr, sign_rt
  end interface sign

contains

  elemental logical function less_tt(a, b)
    type(taylor), intent(in) :: a   !< left side
    type(taylor), intent(in) :: b   !< right side

    less_tt = a%value < b%value
  end function less_tt

  elemental logical function less_tr(a, b)
    type(taylor), intent(in) :: a   !< left side
    real(wp), intent(in) :: b       !< right side

    less_tr = a%value < b
  end function less_tr

  elemental logical function less_rt(a, b)
    real(wp), intent(in) :: a       !< left side
    type(taylor), intent(in) :: b   !< right side

    less_rt = a < b%value
  end function less_rt

  elemental logical function less_equal_tt(a, b)
    type(taylor), intent(in) :: a   !< left side
    type(taylor), intent(in) :: b   !< right side

    less_equal_tt = a%value <= b%value
  end function less_equal_tt

  elemental logical function less_equal_tr(a, b)
    type(taylor), intent(in) :: a   !< left side
    real(wp), intent(in) :: b       !< right side

    less_equal_tr = a%value <= b
  end function less_equal_tr

  elemental logical function less_equal_rt(a, b)
    real(wp), intent(in) :: a       !< left side
    type(taylor), intent(in) :: b   !< right side

    less_equal_rt = a <= b%value
  end function less_equal_rt

  elemental logical function greater_tt(a, b)
    type(taylor), intent(in) :: a   !< left side
    type(taylor), intent(in) :: b   !< right side

    greater_tt = a%value > b%value
  end function greater_tt

  elemental logical function greater_tr(a, b)
    type(taylor), intent(in) :: a   !< left side
    real(wp), intent(in) :: b       !< right side

    greater_tr = a%value > b
  end function greater_tr

  elemental logical function greater_rt(a, b)
    real(wp), intent(in) :: a       !< left side
    type(taylor), intent(in) :: b   !< right side

    greater_rt = a > b%value
  end function greater_rt

  elemental logical function greater_equal_tt(a, b)
    type(taylor), intent(in) :: a   !< left side
    type(taylor), intent(in) :: b   !< right side

    greater_equal_tt = a%value >= b%value
  end function greater_equal_tt

  elemental logical function greater_equal_tr(a, b)
    type(taylor), intent(in) :: a   !< left side
    real(wp), intent(in) :: b       !< right side

    greater_equal_tr = a%value >= b
  end function greater_equal_tr

  elemental logical function greater_equal_rt(a, b)
    real(wp), intent(in) :: a       !< left side
    type(taylor), intent(in) :: b   !< right side

    greater_equal_rt = a >= b%value
  end function greater_equal_rt

  elemental logical function equal_tt(a, b)
    type(taylor), intent(in) :: a   !< left side
    type(taylor), intent(in) :: b   !< right side

    equal_tt = a%value <= b%value .and. a%value >= b%value
  end function equal_tt

  elemental logical function equal_tr(a, b)
    type(taylor), intent(in) :: a   !< left side
    real(wp), intent(in) :: b       !< right side

    equal_tr = a%value <= b .and. a%value >= b
  end function equal_tr

  elemental logical function equal_rt(a, b)
    real(wp), intent(in) :: a       !< left side
    type(taylor), intent(in) :: b   !< right side

    equal_rt = a <= b%value .and. a >= b%value
  end function equal_rt

  elemental logical function unequal_tt(a, b)
    type(taylor), intent(in) :: a   !< left side
    type(taylor), intent(in) :: b   !< right side

    unequal_tt = a%value < b%value .or. a%value > b%value
  end function unequal_tt

  elemental logical function unequal_tr(a, b)
    type(taylor), intent(in) :: a   !< left side
    real(wp), intent(in) :: b       !< right side

    unequal_tr = a%value < b .or. a%value > b
  end function unequal_tr

  elemental logical function unequal_rt(a, b)
    real(wp), intent(in) :: a       !< left side
    type(taylor), intent(in) :: b   !< right side

    unequal_rt = a < b%value .or. a > b%value
  end function unequal_rt

  elemental logical function less_ti(a, b)
    type(taylor), intent(in) :: a   !< left side
    integer, intent(in) :: b        !< right side

    less_ti = less_tr(a, real(b, wp))
  end function less_ti

  elemental logical function less_it(a, b)
    integer, intent(in) :: a        !< left side
    type(taylor), intent(in) :: b   !< right side

    less_it = less_rt(real(a, wp), b)
  end function less_it

  elemental logical function less_equal_ti(a, b)
    type(taylor), intent(in) :: a   !< left side
    integer, intent(in) :: b        !< right side

    less_equal_ti = less_equal_tr(a, real(b, wp))
  end function less_equal_ti

  elemental logical function less_equal_it(a, b)
    integer, intent(in) :: a        !< left side
    type(taylor), intent(in) :: b   !< right side

    less_equal_it = less_equal_rt(real(a, wp), b)
  end function less_equal_it

  elemental logical function greater_ti(a, b)
    type(taylor), intent(in) :: a   !< left side
    integer, intent(in) :: b        !< right side

    greater_ti = greater_tr(a, real(b, wp))
  end function greater_ti

  elemental logical function greater_it(a, b)
    integer, intent(in) :: a        !< left side
    type(taylor), intent(in) :: b   !< right side

    greater_it = greater_rt(real(a, wp), b)
  end function greater_it

  elemental logical function greater_equal_ti(a, b)
    type(taylor), intent(in) :: a   !< left side
    integer, intent(in) :: b        !< right side

    greater_equal_ti = greater_equal_tr(a, real(b, wp))
  end function greater_equal_ti

  elemental logical function greater_equal_it(a, b)
    integer, intent(in) :: a        !< left side
    type(taylor), intent(in) :: b   !< right side

    greater_equal_it = greater_equal_rt(real(a, wp), b)
  end function greater_equal_it

  elemental logical function equal_ti(a, b)
    type(taylor), intent(in) :: a   !< left side
    integer, intent(in) :: b        !< right side

    equal_ti = equal_tr(a, real(b, wp))
  end function equal_ti

  elemental logical function equal_it(a, b)
    integer, intent(in) :: a        !< left side
    type(taylor), intent(in) :: b   !< right side

    equal_it = equal_rt(real(a, wp), b)
  end function equal_it

  elemental logical function unequal_ti(a, b)
    type(taylor), intent(in) :: a   !< left side
    integer, intent(in) :: b        !< right side

    unequal_ti = unequal_tr(a, real(b, wp))
  end function unequal_ti

  elemental logical function unequal_it(a, b)
    integer, intent(in) :: a        !< left side
    type(taylor), intent(in) :: b   !< right side

    unequal_it = unequal_rt(real(a, wp), b)
  end function unequal_it

  elemental type(taylor) function min_tt(a, b)
    type(taylor), intent(in) :: a   !< one of the two
    type(taylor), intent(in) :: b   !< the other one

    min_tt = merge(a, b, a%value <= b%value)
  end function min_tt

  elemental type(taylor) function min_tr(a, b)
    type(taylor), intent(in) :: a   !< one of the two
    real(wp), intent(in) :: b       !< the other one

    min_tr = merge(a, constant(b), a%value <= b)
  end function min_tr

  elemental type(taylor) function min_rt(a, b)
    real(wp), intent(in) :: a       !< one of the two
    type(taylor), intent(in) :: b   !< the other one

    min_rt = merge(constant(a), b, a <= b%value)
  end function min_rt

  elemental type(taylor) function max_tt(a, b)
    type(taylor), intent(in) :: a   !< one of the two
    type(taylor), intent(in) :: b   !< the other one

    max_tt = merge(a, b, a%value >= b%value)
  end function max_tt

  elemental type(taylor) function max_tr(a, b)
    type(taylor), intent(in) :: a   !< one of the two
    real(wp), intent(in) :: b       !< the other one

    max_tr = merge(a, constant(b), a%value >= b)
  end function max_tr

  elemental type(taylor) function max_rt(a, b)
    real(wp), intent(in) :: a       !< one of the two
    type(taylor), intent(in) :: b   !< the other one

    max_rt = merge(constant(a), b, a >= b%value)
  end function max_rt

  !> |a| with the sign of b.
  elemental type(taylor) function sign_tr(a, b)
    type(taylor), intent(in) :: a   !< the number whose size is taken
    real(wp), intent(in) :: b       !< the number whose sign is taken

    sign_tr = sign(1.0_wp, a%value)*sign(1.0_wp, b)*a
  end function sign_tr

  elemental type(taylor) function sign_tt(a, b)
    type(taylor), intent(in) :: a   !< the number whose size is taken
    type(taylor), intent(in) :: b   !< the number whose sign is taken

    sign_tt = sign_tr(a, b%value)
  end function sign_tt

  elemental type(taylor) function sign_rt(a, b)
    real(wp), intent(in) :: a       !< the number whose size is taken
    type(taylor), intent(in) :: b   !< the number whose sign is taken

    sign_rt = constant(sign(a, b%value))
  end function sign_rt
end module mech9_taylor_comparison
