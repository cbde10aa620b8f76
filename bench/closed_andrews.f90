!> Andrews' squeezing mechanism in one coordinate, derived by hand for this one mechanism: the measure of a general program.
!>
!> The crank's angle beta gives the pin F. Three pairs of bars, each two circles that meet, give the pin E over F and B, and from E
!> the pins G and H, both over A. With primes for derivatives by beta, the kinetic energy is M beta_dot^2/2, where M is the sum of
!> m u'.u' + I w^2 over the bodies with centres u and rates of turn w, and Lagrange's equation is
!> M beta_ddot = Q - M' beta_dot^2/2.
module mech9_closed_andrews
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_ode_system, only: ode_system_type
  use mech9_two_bars, only: point_type, bar_type, turning_point, meet
  implicit none
  private
  public :: closed_andrews_type, andrews_acceleration, andrews_angles

  !> Bearings, and the spring's end on the frame [m].
  real(wp), parameter :: a(2) = [-0.06934_wp, -0.00227_wp], b(2) = [-0.03635_wp, 0.03273_wp], c(2) = [0.014_wp, 0.072_wp]
  !> Lengths of the bars OF, FE, BE, EG, AG, EH and AH [m].
  real(wp), parameter :: of = 0.007_wp, fe = 0.028_wp, be = 0.035_wp, eg = 0.02_wp, ag = 0.04_wp, eh = 0.02_wp, ah = 0.04_wp
  !> Masses of FE, EG and EH [kg], their moments of inertia [kg m^2], and their mass centres as parts of the bar from F, E and E.
  real(wp), parameter :: mass(3) = [0.00365_wp, 0.00706_wp, 0.00706_wp], inertia(3) = [4.41e-7_wp, 5.667e-7_wp, 5.667e-7_wp], &
    part(3) = [0.0115_wp/fe, 0.01421_wp/eg, 0.01421_wp/eh]
  !> Moments of inertia about their bearings of the crank, BE, AG and AH [kg m^2].
  real(wp), parameter :: about_o = 2.194e-6_wp + 0.04325_wp*0.00092_wp**2, &
    about_b = 5.255e-6_wp + 0.02373_wp*(0.01874_wp**2 + 0.01043_wp**2), &
    about_ag = 1.169e-5_wp + 0.07050_wp*(0.02308_wp**2 + 0.00916_wp**2), &
    about_ah = 1.912e-5_wp + 0.05498_wp*(0.01228_wp**2 + 0.00449_wp**2)
  !> The crank's torque [N m], the spring's stiffness [N/m] and free length [m], and its end on BE, along BE and across it [m].
  real(wp), parameter :: torque = 0.033_wp, stiffness = 4530.0_wp, free_length = 0.07785_wp, along = 0.018_wp, across = 0.02_wp

  !> The equation of motion as an integrator uses it; its two variables are beta and beta_dot.
  type, extends(ode_system_type) :: closed_andrews_type
  contains
    procedure :: rate
  end type closed_andrews_type

contains

  !> The rate of change of beta and beta_dot. It cannot fail.
  subroutine rate(self, t, y, ydot, err)
    class(closed_andrews_type), intent(inout) :: self   !< the equation
    real(wp), intent(in) :: t                           !< [s]
    real(wp), intent(in) :: y(:)                        !< (2) beta and beta_dot [rad, rad/s]
    real(wp), intent(out) :: ydot(:)                    !< (2) their derivatives in time
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    ydot(1) = y(2)
    ydot(2) = andrews_acceleration(y(1), y(2))
  end subroutine rate

  !> Acceleration of the crank [rad/s^2].
  pure real(wp) function andrews_acceleration(beta, speed)
    real(wp), intent(in) :: beta    !< angle of the crank [rad]
    real(wp), intent(in) :: speed   !< its rate [rad/s]
    type(bar_type) :: bar_fe, bar_be, bar_eg, bar_ag, bar_eh, bar_ah
    type(point_type) :: f, e
    real(wp) :: m, half_dm, arm(2), spring(2), length

    call find_bars(beta, f, e, bar_fe, bar_be, bar_eg, bar_ag, bar_eh, bar_ah)
    m = about_o + about_b*bar_be%w**2 + about_ag*bar_ag%w**2 + about_ah*bar_ah%w**2
    half_dm = about_b*bar_be%w*bar_be%dw + about_ag*bar_ag%w*bar_ag%dw + about_ah*bar_ah%w*bar_ah%dw
    call add_body(mass(1), inertia(1), part(1), f, bar_fe, m, half_dm)
    call add_body(mass(2), inertia(2), part(2), e, bar_eg, m, half_dm)
    call add_body(mass(3), inertia(3), part(3), e, bar_eh, m, half_dm)
    ! from B to D, and from D to C
    arm = (along*bar_be%r + across*[-bar_be%r(2), bar_be%r(1)])/be
    spring = c - b - arm
    length = sqrt(dot_product(spring, spring))
    andrews_acceleration = (torque + stiffness*(1.0_wp - free_length/length)*bar_be%w &
                            *(spring(2)*arm(1) - spring(1)*arm(2)) - half_dm*speed**2)/m
  end function andrews_acceleration

  !> The angles beta, theta, gamma, phi, delta, Omega and epsilon of the test set, those after beta between -pi and pi [rad].
  pure function andrews_angles(beta) result(angles)
    real(wp), intent(in) :: beta   !< angle of the crank [rad]
    real(wp) :: angles(7)
    type(bar_type) :: bar_fe, bar_be, bar_eg, bar_ag, bar_eh, bar_ah
    type(point_type) :: f, e
    real(wp) :: difference(2)

    call find_bars(beta, f, e, bar_fe, bar_be, bar_eg, bar_ag, bar_eh, bar_ah)
    angles(1) = beta
    ! FE = -fe (cos, sin)(beta + theta), BE = be (sin, -cos)(gamma), GE = eg (sin, -cos)(phi + delta), AG = ag (cos, sin)(delta),
    ! HE = eh (cos, sin)(Omega + epsilon), AH = ah (sin, -cos)(epsilon)
    angles(3) = atan2(bar_be%r(1), -bar_be%r(2))
    angles(5) = atan2(bar_ag%r(2), bar_ag%r(1))
    angles(7) = atan2(bar_ah%r(1), -bar_ah%r(2))
    difference = turned_back(-bar_fe%r, [cos(beta), sin(beta)])
    angles(2) = atan2(difference(2), difference(1))
    difference = turned_back([bar_eg%r(2), -bar_eg%r(1)], bar_ag%r)
    angles(4) = atan2(difference(2), difference(1))
    difference = turned_back(-bar_eh%r, [-bar_ah%r(2), bar_ah%r(1)])
    angles(6) = atan2(difference(2), difference(1))
  end function andrews_angles

  !> A vector turned by the angle of another one, backwards.
  pure function turned_back(vector, other) result(difference)
    real(wp), intent(in) :: vector(2)   !< of any length
    real(wp), intent(in) :: other(2)    !< of any length
    real(wp) :: difference(2)

    difference = [dot_product(other, vector), other(1)*vector(2) - other(2)*vector(1)]
  end function turned_back

  !> All bars at an angle of the crank.
  pure subroutine find_bars(beta, f, e, bar_fe, bar_be, bar_eg, bar_ag, bar_eh, bar_ah)
    real(wp), intent(in) :: beta           !< angle of the crank [rad]
    type(point_type), intent(out) :: f     !< pin of the crank
    type(point_type), intent(out) :: e     !< pin of four bars
    type(bar_type), intent(out) :: bar_fe  !< from F to E
    type(bar_type), intent(out) :: bar_be  !< from B to E
    type(bar_type), intent(out) :: bar_eg  !< from E to G
    type(bar_type), intent(out) :: bar_ag  !< from A to G
    type(bar_type), intent(out) :: bar_eh  !< from E to H
    type(bar_type), intent(out) :: bar_ah  !< from A to H

    f = turning_point(of*[cos(beta), sin(beta)])
    call meet(f, b, fe, be, 1.0_wp, bar_fe, bar_be)
    e%x = b + bar_be%r
    e%d = bar_be%w*[-bar_be%r(2), bar_be%r(1)]
    e%dd = bar_be%dw*[-bar_be%r(2), bar_be%r(1)] - bar_be%w**2*bar_be%r
    call meet(e, a, eg, ag, -1.0_wp, bar_eg, bar_ag)
    call meet(e, a, eh, ah, 1.0_wp, bar_eh, bar_ah)
  end subroutine find_bars

  !> Add a bar with its mass centre between its pins to M and M'/2.
  pure subroutine add_body(mass, inertia, part, pin, bar, m, half_dm)
    real(wp), intent(in) :: mass            !< [kg]
    real(wp), intent(in) :: inertia         !< about the mass centre [kg m^2]
    real(wp), intent(in) :: part            !< of the bar, from its first pin to the mass centre
    type(point_type), intent(in) :: pin     !< first pin
    type(bar_type), intent(in) :: bar       !< the bar
    real(wp), intent(inout) :: m            !< moment of inertia as the crank has it; the bar is added [kg m^2]
    real(wp), intent(inout) :: half_dm      !< half of its derivative by the crank's angle; the bar is added [kg m^2]
    real(wp) :: d(2), dd(2), across(2)

    across = [-bar%r(2), bar%r(1)]
    d = pin%d + part*bar%w*across
    dd = pin%dd + part*(bar%dw*across - bar%w**2*bar%r)
    m = m + mass*(d(1)**2 + d(2)**2) + inertia*bar%w**2
    half_dm = half_dm + mass*(d(1)*dd(1) + d(2)*dd(2)) + inertia*bar%w*bar%dw
  end subroutine add_body
end module mech9_closed_andrews
