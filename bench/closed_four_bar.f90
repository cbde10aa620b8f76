!> The four-bar linkage in closed form, written by hand for this one mechanism: the measure of a general program.
module mech9_closed_four_bar
  use mech9_kinds, only: wp
  implicit none
  private
  public :: four_bar_position, four_bar_motion

  real(wp), parameter :: ground = 0.40_wp, crank = 0.15_wp, coupler = 0.35_wp, rocker = 0.30_wp   ! [m]
  !> The point, in the coupler, x from the crank's pin to the rocker's.
  real(wp), parameter :: along = 0.20_wp, across = 0.10_wp                                       ! [m]

contains

  !> Position of the point at a crank angle, on the open branch.
  pure subroutine four_bar_position(angle, point)
    real(wp), intent(in) :: angle       !< of the crank [rad]
    real(wp), intent(out) :: point(2)   !< from the crank's bearing, x along the ground link [m]
    real(wp) :: pin(2), u(2), v(2)

    call find_pins(angle, pin, u, v)
    point(1) = pin(1) + along*u(1) - across*u(2)
    point(2) = pin(2) + along*u(2) + across*u(1)
  end subroutine four_bar_position

  !> Position, velocity and acceleration of the point at a constant crank speed.
  pure subroutine four_bar_motion(angle, speed, point, velocity, acceleration)
    real(wp), intent(in) :: angle              !< of the crank [rad]
    real(wp), intent(in) :: speed              !< of the crank, constant [rad/s]
    real(wp), intent(out) :: point(2)          !< from the crank's bearing, x along the ground link [m]
    real(wp), intent(out) :: velocity(2)       !< of the point [m/s]
    real(wp), intent(out) :: acceleration(2)   !< of the point [m/s^2]
    real(wp) :: pin(2), u(2), v(2), arm(2), swept(2), r(2), w_coupler, w_rocker, a_coupler, determinant

    call find_pins(angle, pin, u, v)
    ! crank + coupler u = ground + rocker v, differentiated: the rates of the directions u and v
    swept = [-pin(2), pin(1)]*speed
    determinant = u(1)*v(2) - u(2)*v(1)
    w_coupler = -(swept(1)*v(1) + swept(2)*v(2))/(coupler*determinant)
    w_rocker = -(swept(1)*u(1) + swept(2)*u(2))/(rocker*determinant)
    r = -speed**2*pin - coupler*w_coupler**2*u + rocker*w_rocker**2*v
    a_coupler = -(r(1)*v(1) + r(2)*v(2))/(coupler*determinant)
    arm = [along*u(1) - across*u(2), along*u(2) + across*u(1)]
    point = pin + arm
    velocity = swept + w_coupler*[-arm(2), arm(1)]
    acceleration = -speed**2*pin + a_coupler*[-arm(2), arm(1)] - w_coupler**2*arm
  end subroutine four_bar_motion

  !> The crank's pin and the directions of coupler and rocker: two circles meet in the rocker's pin.
  pure subroutine find_pins(angle, pin, u, v)
    real(wp), intent(in) :: angle     !< of the crank [rad]
    real(wp), intent(out) :: pin(2)   !< of crank and coupler, from the crank's bearing [m]
    real(wp), intent(out) :: u(2)     !< unit vector along the coupler, towards the rocker
    real(wp), intent(out) :: v(2)     !< unit vector along the rocker, away from its bearing
    real(wp) :: x, y, square, a, h

    pin = crank*[cos(angle), sin(angle)]
    x = ground - pin(1)
    y = -pin(2)
    square = x**2 + y**2
    a = 0.5_wp*(1.0_wp + (coupler**2 - rocker**2)/square)
    h = sqrt(coupler**2/square - a**2)
    u = [a*x - h*y, a*y + h*x]/coupler
    v = ([a*x - h*y, a*y + h*x] - [x, y])/rocker
  end subroutine find_pins
end module mech9_closed_four_bar
