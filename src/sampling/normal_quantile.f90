!> Quantiles of the normal distribution.
module mech9_normal_quantile
  use mech9_kinds, only: wp, pi
  implicit none
  private
  public :: normal_quantile

contains

  !> The number that a normal variable of mean 0 and deviation 1 exceeds with probability 1 - p.
  pure real(wp) function normal_quantile(p) result(x)
    real(wp), intent(in) :: p   !< probability, greater than 0 and less than 1
    real(wp) :: tail, t, difference
    integer :: pass

    tail = min(p, 1.0_wp - p)
    if (tail >= 0.5_wp) then
      x = 0.0_wp
      return
    end if
    ! to three digits by Hastings' formula (Abramowitz and Stegun 26.2.22), then by Halley's method
    t = sqrt(-2.0_wp*log(tail))
    x = t - (2.30753_wp + 0.27061_wp*t)/(1.0_wp + t*(0.99229_wp + 0.04481_wp*t))
    do pass = 1, 3
      difference = (0.5_wp*erfc(x/sqrt(2.0_wp)) - tail)*sqrt(2.0_wp*pi)*exp(0.5_wp*x**2)
      x = x + difference/(1.0_wp + 0.5_wp*x*difference)
    end do
    if (p < 0.5_wp) x = -x
  end function normal_quantile
end module mech9_normal_quantile
