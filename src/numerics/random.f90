!> Reproducible pseudo-random numbers without hidden state, for trial positions.
module mech9_random
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: random_type

  !> The minimal standard generator of Park and Miller; the same numbers on every machine.
  type :: random_type
    integer(long) :: seed = 20011_long
  contains
    procedure :: symmetric
  end type random_type

contains

  !> The next number, between -1 and 1.
  real(wp) function symmetric(self)
    class(random_type), intent(inout) :: self   !< the generator, which goes on by one number
    integer(long), parameter :: modulus = 2147483647_long

    self%seed = mod(48271_long*self%seed, modulus)
    symmetric = 2.0_wp*real(self%seed, wp)/real(modulus, wp) - 1.0_wp
  end function symmetric
end module mech9_random
