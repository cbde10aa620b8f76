!> Two structures of bench_structures, derived by hand: the accelerations of an open chain of two links and of a four-bar in the
!> plane.
module mech9_closed_structures
  use mech9_kinds, only: wp
  use mech9_two_bars, only: point_type, bar_type, turning_point, meet
  implicit none
  private
  public :: two_link_accelerations, four_bar_acceleration

  real(wp), parameter :: g = 9.81_wp   ! [m/s^2]
  !> Moment of inertia of each link about its mass centre [kg m^2]; its mass is 1 kg.
  real(wp), parameter :: inertia = 0.08_wp

contains

  !> Accelerations of the angles of two links of 1 m with their centres in the middle; the second angle is one to the first link.
  pure function two_link_accelerations(q, dq) result(ddq)
    real(wp), intent(in) :: q(2)    !< angles; the home position lies along x [rad]
    real(wp), intent(in) :: dq(2)   !< their rates [rad/s]
    real(wp) :: ddq(2)
    real(wp) :: a11, a12, a22, c, s, right(2), w, determinant, weight

    c = 0.5_wp*cos(q(2))
    s = 0.5_wp*sin(q(2))
    a22 = inertia + 0.25_wp
    a12 = a22 + c
    a11 = a22 + 1.25_wp + inertia + 2.0_wp*c
    w = dq(1) + dq(2)
    weight = 0.5_wp*g*cos(q(1) + q(2))
    right(1) = s*(w**2 - dq(1)**2) - 1.5_wp*g*cos(q(1)) - weight
    right(2) = -s*dq(1)**2 - weight
    determinant = 1.0_wp/(a11*a22 - a12**2)
    ddq = [a22*right(1) - a12*right(2), a11*right(2) - a12*right(1)]*determinant
  end function two_link_accelerations

  !> Acceleration of the crank of the four-bar [rad/s^2].
  pure real(wp) function four_bar_acceleration(angle, speed)
    real(wp), intent(in) :: angle   !< of the crank from home [rad]
    real(wp), intent(in) :: speed   !< its rate [rad/s]
    ! squares of the lengths of coupler and rocker, and their mass centres along and across them as parts of their length
    real(wp), parameter :: coupler = 0.05_wp**2 + 0.45_wp**2, rocker = 0.45_wp**2 + 0.05_wp**2, &
      coupler_along = (0.02_wp*0.05_wp + 0.25_wp*0.45_wp)/coupler, coupler_across = (0.25_wp*0.05_wp - 0.02_wp*0.45_wp)/coupler, &
      rocker_along = (0.20_wp*0.45_wp + 0.02_wp*0.05_wp)/rocker, rocker_across = (0.02_wp*0.45_wp - 0.20_wp*0.05_wp)/rocker
    type(point_type) :: pin
    type(bar_type) :: bar, back
    real(wp) :: c, s, m, half_dm, arm(2), d(2), dd(2)

    c = cos(angle)
    s = sin(angle)
    pin = turning_point([0.4_wp*c - 0.05_wp*s, 0.4_wp*s + 0.05_wp*c])
    call meet(pin, [0.0_wp, 0.45_wp], sqrt(coupler), sqrt(rocker), -1.0_wp, bar, back)
    arm = coupler_along*bar%r + coupler_across*[-bar%r(2), bar%r(1)]
    d = pin%d + bar%w*[-arm(2), arm(1)]
    dd = pin%dd + bar%dw*[-arm(2), arm(1)] - bar%w**2*arm
    ! moment of inertia as the crank has it, and half of its derivative by the crank's angle
    m = inertia + 0.04_wp + d(1)**2 + d(2)**2 + inertia*bar%w**2 &
        + (inertia + rocker*(rocker_along**2 + rocker_across**2))*back%w**2
    half_dm = d(1)*dd(1) + d(2)*dd(2) + inertia*bar%w*bar%dw &
              + (inertia + rocker*(rocker_along**2 + rocker_across**2))*back%w*back%dw
    arm = rocker_along*back%r + rocker_across*[-back%r(2), back%r(1)]
    four_bar_acceleration = (-g*(0.2_wp*c + d(2) + back%w*arm(1)) - half_dm*speed**2)/m
  end function four_bar_acceleration
end module mech9_closed_structures
