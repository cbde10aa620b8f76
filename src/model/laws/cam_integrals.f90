!> Integrals of the motion laws of cam design: that of the way s(x) from 0, and the integral of this one.
!>
!> All laws are symmetric, s(1 - x) = 1 - s(x), so that the first half of the time gives the second one.
module mech9_cam_integrals
  use mech9_kinds, only: wp, pi
  implicit none
  private
  public :: cam_integrals

contains

  !> Both integrals of a law from 0.
  pure subroutine cam_integrals(number, x, first, second)
    integer, intent(in) :: number       !< of the law in curve_names
    real(wp), intent(in) :: x           !< part of the time, 0 to 1
    real(wp), intent(out) :: first      !< integral of the part of the way
    real(wp), intent(out) :: second     !< integral of this integral
    real(wp) :: first_at_middle, second_at_middle

    call first_half(number, min(x, 1.0_wp - x), first, second)
    if (.not. x > 0.5_wp .or. number == 1) return
    call first_half(number, 0.5_wp, first_at_middle, second_at_middle)
    first = first + (x - 0.5_wp)
    second = 2.0_wp*second_at_middle + 0.5_wp*(x - 0.5_wp)**2 - second
  end subroutine cam_integrals

  !> Both integrals in the first half of the time.
  pure subroutine first_half(number, x, first, second)
    integer, intent(in) :: number       !< of the law in curve_names
    real(wp), intent(in) :: x           !< part of the time, 0 to 1/2
    real(wp), intent(out) :: first      !< integral of the part of the way
    real(wp), intent(out) :: second     !< integral of this integral

    first = 0.0_wp
    second = 0.0_wp
    select case (number)
    case (2)
      first = 0.5_wp*x**2
      second = x**3/6.0_wp
    case (3)
      first = 0.5_wp*x - sin(pi*x)/(2.0_wp*pi)
      second = 0.25_wp*x**2 - sin(0.5_wp*pi*x)**2/pi**2
    case (4)
      first = 0.5_wp*x**2 - sin(pi*x)**2/(2.0_wp*pi**2)
      second = x**3/6.0_wp - x/(4.0_wp*pi**2) + sin(2.0_wp*pi*x)/(8.0_wp*pi**3)
    case (5)
      first = x**4*(2.5_wp + x*(-3.0_wp + x))
      second = x**5*(0.5_wp + x*(-0.5_wp + x/7.0_wp))
    case (6)
      first = x**5*(7.0_wp + x*(-14.0_wp + x*(10.0_wp - 2.5_wp*x)))
      second = x**6*(7.0_wp/6.0_wp + x*(-2.0_wp + x*(1.25_wp - 2.5_wp/9.0_wp*x)))
    case (7)
      call modified_sine(x, first, second)
    case (8)
      call modified_trapezoid(x, first, second)
    end select
  end subroutine first_half

  !> Modified sine.
  pure subroutine modified_sine(x, first, second)
    real(wp), intent(in) :: x           !< part of the time, 0 to 1/2
    real(wp), intent(out) :: first      !< integral of the part of the way
    real(wp), intent(out) :: second     !< integral of this integral
    real(wp), parameter :: c = 1.0_wp/(4.0_wp + pi)
    real(wp) :: angle, u

    u = min(x, 0.125_wp)
    first = c*(0.5_wp*pi*u**2 - sin(2.0_wp*pi*u)**2/(8.0_wp*pi))
    second = c*(pi*u**3/6.0_wp - u/(16.0_wp*pi) + sin(4.0_wp*pi*u)/(64.0_wp*pi**2))
    if (x <= 0.125_wp) return
    u = x - 0.125_wp
    angle = pi/3.0_wp*(1.0_wp + 4.0_wp*x)
    second = second + first*u + c*(u**2 + 0.5_wp*pi*((x**3 - 0.125_wp**3)/3.0_wp - 0.125_wp**2*u) &
                                   + 81.0_wp/(64.0_wp*pi**2)*(sin(angle) - 1.0_wp))
    first = first + c*(2.0_wp*u + 0.5_wp*pi*(x**2 - 0.125_wp**2) + 27.0_wp/(16.0_wp*pi)*cos(angle))
  end subroutine modified_sine

  !> Modified trapezoid.
  pure subroutine modified_trapezoid(x, first, second)
    real(wp), intent(in) :: x           !< part of the time, 0 to 1/2
    real(wp), intent(out) :: first      !< integral of the part of the way
    real(wp), intent(out) :: second     !< integral of this integral
    real(wp), parameter :: a = 8.0_wp*pi/(2.0_wp + pi)                                !< greatest acceleration
    real(wp), parameter :: v1 = a/(4.0_wp*pi), s1 = v1*(0.125_wp - 1.0_wp/(4.0_wp*pi))    !< at 1/8
    real(wp), parameter :: v2 = v1 + 0.25_wp*a
    real(wp) :: u, first_at, second_at

    u = min(x, 0.125_wp)
    first = v1*(0.5_wp*u**2 - sin(2.0_wp*pi*u)**2/(8.0_wp*pi**2))
    second = v1*(u**3/6.0_wp - u/(16.0_wp*pi**2) + sin(4.0_wp*pi*u)/(64.0_wp*pi**3))
    if (x <= 0.125_wp) return
    u = min(x, 0.375_wp) - 0.125_wp
    second = second + u*(first + u*(0.5_wp*s1 + u*(v1/6.0_wp + a*u/24.0_wp)))
    first = first + u*(s1 + u*(0.5_wp*v1 + a*u/6.0_wp))
    if (x <= 0.375_wp) return
    ! counted from the middle, where the way is 1/2
    u = 0.5_wp - x
    call to_middle(0.125_wp, first_at, second_at)
    second = second + (first + first_at)*(0.125_wp - u) - second_at
    first = first + first_at
    call to_middle(u, first_at, second_at)
    second = second + second_at
    first = first - first_at
  contains
    !> Integrals of the way up to the middle of the time, over the time that is left.
    pure subroutine to_middle(u, first, second)
      real(wp), intent(in) :: u           !< part of the time before the middle
      real(wp), intent(out) :: first      !< integral of the part of the way, and a constant
      real(wp), intent(out) :: second     !< integral of this integral

      first = 0.5_wp*u - 0.5_wp*v2*u**2 + v1*cos(4.0_wp*pi*u)/(16.0_wp*pi**2)
      second = 0.25_wp*u**2 - v2*u**3/6.0_wp + v1*sin(4.0_wp*pi*u)/(64.0_wp*pi**3)
    end subroutine to_middle
  end subroutine modified_trapezoid
end module mech9_cam_integrals
