!> Cosines and sines of many angles at once.
!>
!> The intrinsic functions are called for one angle after the other. Here angles are taken in groups of a fixed size, without a
!> branch, so that the compiler can compute several at once: whole quarter turns are subtracted, and the series of sine
!> and cosine are taken at the rest, at most half a quarter turn.
module mech9_sine_cosine
  use mech9_kinds, only: wp
  implicit none
  private
  public :: cosines_and_sines, largest_angle, quarter, per_quarter, whole

  !> Angles up to this one are reduced without loss of digits [rad].
  real(wp), parameter :: largest_angle = 1.0e6_wp
  !> A quarter turn in three parts; the first two have 33 bits each, so that multiples of them have no rounding.
  real(wp), parameter :: quarter(3) = [1.57079632673412561417_wp, 6.07710050630396597660e-11_wp, 2.02226624879595063154e-21_wp]
  real(wp), parameter :: per_quarter = 0.636619772367581343076_wp
  !> A number of this size has no room for a fraction: adding it and taking it away again rounds to whole numbers.
  real(wp), parameter :: whole = 1.5_wp*2.0_wp**52
  !> Number of angles in a group.
  integer, parameter :: group = 4
  !> So many angles take longer in a group than one after the other.
  integer, parameter :: few = 2

contains

  !> Cosines and sines with errors little above half a unit in the last place, as the intrinsic functions have.
  pure subroutine cosines_and_sines(n, angles, turned)
    integer, intent(in) :: n                !< number of angles
    real(wp), intent(in) :: angles(n)       !< [rad]
    real(wp), intent(out) :: turned(2, n)   !< cosine and sine of each angle
    real(wp) :: some(group), some_turned(2, group)
    integer :: i, k

    if (.not. all(abs(angles) <= largest_angle)) then
      do i = 1, n
        turned(1, i) = cos(angles(i))
        turned(2, i) = sin(angles(i))
      end do
      return
    end if
    do i = 1, n - group + 1, group
      call find_group(angles(i:i + group - 1), turned(:, i:i + group - 1))
    end do
    if (i > n) return
    if (n - i + 1 <= few) then
      do k = i, n
        call find_one(angles(k), turned(:, k))
      end do
      return
    end if
    ! the last group is filled up with the last angle
    do k = 1, group
      some(k) = angles(min(i + k - 1, n))
    end do
    call find_group(some, some_turned)
    do k = 1, group - 1
      if (i + k - 1 <= n) turned(:, i + k - 1) = some_turned(:, k)
    end do
  end subroutine cosines_and_sines

  !> Cosines and sines of a group of angles, none of them too large.
  pure subroutine find_group(angles, turned)
    real(wp), intent(in) :: angles(group)       !< [rad]
    real(wp), intent(out) :: turned(2, group)   !< cosine and sine of each angle
    integer :: i

    do i = 1, group
      call find_one(angles(i), turned(:, i))
    end do
  end subroutine find_group

  !> Cosine and sine of an angle that is not too large, by the same operations alone and in a group.
  pure subroutine find_one(angle, turned)
    real(wp), intent(in) :: angle        !< [rad]
    real(wp), intent(out) :: turned(2)   !< its cosine and sine
    real(wp) :: quarters, x, left, z, most, c, s
    logical :: exchanged

    quarters = (angle*per_quarter + whole) - whole
    ! the rest x, and its round-off error `left`
    z = angle - quarters*quarter(1)
    most = z - quarters*quarter(2)
    x = most - quarters*quarter(3)
    left = ((z - most) - quarters*quarter(2)) + ((most - x) - quarters*quarter(3))
    z = x**2
    s = x + (left*(1.0_wp - 0.5_wp*z) + x*z*(-1.0_wp/6.0_wp + z*(1.0_wp/120.0_wp + z*(-1.0_wp/5040.0_wp + z*(1.0_wp/362880.0_wp &
        + z*(-1.0_wp/39916800.0_wp + z*(1.0_wp/6227020800.0_wp + z*(-1.0_wp/1307674368000.0_wp &
        + z*(1.0_wp/355687428096000.0_wp)))))))))
    ! the round-off error of 1 - z/2 is added with the small terms
    most = 1.0_wp - 0.5_wp*z
    c = most + (((1.0_wp - most) - 0.5_wp*z) - x*left + z**2*(1.0_wp/24.0_wp + z*(-1.0_wp/720.0_wp + z*(1.0_wp/40320.0_wp &
        + z*(-1.0_wp/3628800.0_wp + z*(1.0_wp/479001600.0_wp + z*(-1.0_wp/87178291200.0_wp &
        + z*(1.0_wp/20922789888000.0_wp))))))))
    ! quarter turns without whole turns: -2 ... 2
    quarters = quarters - 4.0_wp*((0.25_wp*quarters + whole) - whole)
    exchanged = abs(abs(quarters) - 1.0_wp) < 0.5_wp
    turned(1) = merge(s, c, exchanged)*merge(-1.0_wp, 1.0_wp, quarters > 0.5_wp .or. quarters < -1.5_wp)
    turned(2) = merge(c, s, exchanged)*merge(-1.0_wp, 1.0_wp, quarters > 1.5_wp .or. quarters < -0.5_wp)
  end subroutine find_one
end module mech9_sine_cosine
