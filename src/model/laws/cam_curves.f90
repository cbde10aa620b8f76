!> Motion laws of cam design: the way s(x) from 0 to 1 in the time x from 0 to 1, with its exact derivatives (Norton; VDI 2143 in
!> docs/reference/bibliography.md). All are symmetric: s(1 - x) = 1 - s(x).
module mech9_cam_curves
  use mech9_kinds, only: wp, pi
  implicit none
  private
  public :: curve_names, curve_number, cam_curve, cam_third, steepest_slope_of, find_inner_joints, most_inner_joints

  character(len=20), parameter :: curve_names(8) = [character(len=20) :: 'dwell', 'constant-velocity', 'harmonic', 'cycloidal', &
                                                    'polynomial345', 'polynomial4567', 'modified-sine', 'modified-trapezoidal']

  !> Most jumps of the fourth derivative between the ends of a law.
  integer, parameter :: most_inner_joints = 4

contains

  !> Number of a law by its name; 0 for an unknown name.
  pure integer function curve_number(name)
    character(len=*), intent(in) :: name   !< in lower case

    do curve_number = size(curve_names), 1, -1
      if (curve_names(curve_number) == name) return
    end do
  end function curve_number

  !> Way, slope and curvature of a law.
  pure subroutine cam_curve(number, x, s, ds, dds)
    integer, intent(in) :: number     !< of the law in curve_names
    real(wp), intent(in) :: x         !< part of the time, 0 to 1
    real(wp), intent(out) :: s        !< part of the way
    real(wp), intent(out) :: ds       !< its first derivative
    real(wp), intent(out) :: dds      !< its second derivative
    real(wp) :: from_end

    from_end = min(x, 1.0_wp - x)
    call first_half(number, from_end, s, ds, dds)
    if (.not. x > 0.5_wp) return
    s = 1.0_wp - s
    dds = -dds
    if (number == 1) s = 0.0_wp
  end subroutine cam_curve

  !> The parts of the time between its ends at which the fourth derivative of a law jumps.
  pure subroutine find_inner_joints(number, parts, n)
    integer, intent(in) :: number                        !< of the law in curve_names
    real(wp), intent(out) :: parts(most_inner_joints)    !< the first n of them, in their order, in parts of the duration [1]
    integer, intent(out) :: n                            !< how many there are

    parts = [0.125_wp, 0.375_wp, 0.625_wp, 0.875_wp]
    n = 0
    if (number == 7) parts(2) = parts(4)
    if (number == 7) n = 2
    if (number == 8) n = 4
  end subroutine find_inner_joints

  !> The third derivative of a law; where it jumps, that of the part after it in the first half of the time.
  pure real(wp) function cam_third(number, x) result(third)
    integer, intent(in) :: number     !< of the law in curve_names
    real(wp), intent(in) :: x         !< part of the time, 0 to 1
    real(wp), parameter :: sine = 16.0_wp*pi**3/(4.0_wp + pi), trapezoid = 32.0_wp*pi**2/(2.0_wp + pi)
    real(wp) :: y

    y = min(x, 1.0_wp - x)      ! all laws have the same one in both halves
    third = 0.0_wp
    select case (number)
    case (3)
      third = -0.5_wp*pi**3*sin(pi*y)
    case (4)
      third = 4.0_wp*pi**2*cos(2.0_wp*pi*y)
    case (5)
      third = 60.0_wp*(1.0_wp - 6.0_wp*y*(1.0_wp - y))
    case (6)
      third = 840.0_wp*y*(1.0_wp - y)*((1.0_wp - 2.0_wp*y)**2 - y*(1.0_wp - y))
    case (7)
      if (y < 0.125_wp) third = sine*cos(4.0_wp*pi*y)
      if (y >= 0.125_wp) third = sine/3.0_wp*cos(pi/3.0_wp*(1.0_wp + 4.0_wp*y))
    case (8)
      if (y < 0.125_wp) third = trapezoid*cos(4.0_wp*pi*y)
      if (y >= 0.375_wp) third = -trapezoid*cos(4.0_wp*pi*(0.5_wp - y))
    end select
  end function cam_third

  !> Way, slope and curvature of a law in the first half of the time.
  pure subroutine first_half(number, x, s, ds, dds)
    integer, intent(in) :: number     !< of the law in curve_names
    real(wp), intent(in) :: x         !< part of the time, 0 to 1/2
    real(wp), intent(out) :: s        !< part of the way
    real(wp), intent(out) :: ds       !< its first derivative
    real(wp), intent(out) :: dds      !< its second derivative

    s = 0.0_wp
    ds = 0.0_wp
    dds = 0.0_wp
    select case (number)
    case (2)
      s = x
      ds = 1.0_wp
    case (3)
      s = sin(0.5_wp*pi*x)**2
      ds = 0.5_wp*pi*sin(pi*x)
      dds = 0.5_wp*pi**2*cos(pi*x)
    case (4)
      s = x - sin(2.0_wp*pi*x)/(2.0_wp*pi)
      ds = 2.0_wp*sin(pi*x)**2
      dds = 2.0_wp*pi*sin(2.0_wp*pi*x)
    case (5)
      s = x**3*(10.0_wp + x*(-15.0_wp + 6.0_wp*x))
      ds = 30.0_wp*(x*(1.0_wp - x))**2
      dds = 60.0_wp*x*(1.0_wp - x)*(1.0_wp - 2.0_wp*x)
    case (6)
      s = x**4*(35.0_wp + x*(-84.0_wp + x*(70.0_wp - 20.0_wp*x)))
      ds = 140.0_wp*(x*(1.0_wp - x))**3
      dds = 420.0_wp*(x*(1.0_wp - x))**2*(1.0_wp - 2.0_wp*x)
    case (7)
      call modified_sine(x, s, ds, dds)
    case (8)
      call modified_trapezoid(x, s, ds, dds)
    end select
  end subroutine first_half

  !> Modified sine: a quarter of a sine of acceleration in an eighth of the time, then a slower cosine.
  pure subroutine modified_sine(x, s, ds, dds)
    real(wp), intent(in) :: x         !< part of the time, 0 to 1/2
    real(wp), intent(out) :: s        !< part of the way
    real(wp), intent(out) :: ds       !< its first derivative
    real(wp), intent(out) :: dds      !< its second derivative
    real(wp), parameter :: c = 1.0_wp/(4.0_wp + pi)
    real(wp) :: angle

    if (x < 0.125_wp) then
      s = c*(pi*x - 0.25_wp*sin(4.0_wp*pi*x))
      ds = 2.0_wp*c*pi*sin(2.0_wp*pi*x)**2
      dds = 4.0_wp*c*pi**2*sin(4.0_wp*pi*x)
    else
      angle = pi/3.0_wp*(1.0_wp + 4.0_wp*x)
      s = c*(2.0_wp + pi*x - 2.25_wp*sin(angle))
      ds = c*pi*(1.0_wp - 3.0_wp*cos(angle))
      dds = 4.0_wp*c*pi**2*sin(angle)
    end if
  end subroutine modified_sine

  !> Modified trapezoid: quarters of a sine of acceleration in eighths of the time, and constant acceleration between them.
  pure subroutine modified_trapezoid(x, s, ds, dds)
    real(wp), intent(in) :: x         !< part of the time, 0 to 1/2
    real(wp), intent(out) :: s        !< part of the way
    real(wp), intent(out) :: ds       !< its first derivative
    real(wp), intent(out) :: dds      !< its second derivative
    real(wp), parameter :: a = 8.0_wp*pi/(2.0_wp + pi)                                !< greatest acceleration
    real(wp), parameter :: v1 = a/(4.0_wp*pi), s1 = v1*(0.125_wp - 1.0_wp/(4.0_wp*pi))    !< at 1/8
    real(wp), parameter :: v2 = v1 + 0.25_wp*a
    real(wp) :: u

    if (x < 0.125_wp) then
      s = v1*(x - sin(4.0_wp*pi*x)/(4.0_wp*pi))
      ds = 2.0_wp*v1*sin(2.0_wp*pi*x)**2
      dds = a*sin(4.0_wp*pi*x)
    else if (x < 0.375_wp) then
      u = x - 0.125_wp
      s = s1 + u*(v1 + 0.5_wp*a*u)
      ds = v1 + a*u
      dds = a
    else
      ! counted from the middle, where the way is 1/2
      u = 0.5_wp - x
      s = 0.5_wp - v2*u - v1*sin(4.0_wp*pi*u)/(4.0_wp*pi)
      ds = v2 + v1*cos(4.0_wp*pi*u)
      dds = a*sin(4.0_wp*pi*u)
    end if
  end subroutine modified_trapezoid

  !> The greatest slope of a law.
  pure real(wp) function steepest_slope_of(number)
    integer, intent(in) :: number   !< of the law in curve_names
    real(wp) :: s, dds

    call cam_curve(number, 0.5_wp, s, steepest_slope_of, dds)
  end function steepest_slope_of
end module mech9_cam_curves
