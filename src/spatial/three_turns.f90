!> Three turns about axes that meet in one point, each at a right angle to the next: the coordinates, or chart, of a ball joint.
!>
!> By two constant angles every such triple is brought to one form: with angles f, g, h the joint turns by
!>   A = base Rz(f) Rx(g) Ry(h) last,
!> where `last` is the same for all triples. The third axis d = base Rz(f) Rx(g) e_y is fixed in the link that moves, and the
!> first one, base e_z, in the link from which it moves. Where they are parallel, cos g = 0, the angles are singular: this is
!> gimbal lock. Another triple with the same third axis and a first one at a right angle to base e_z is there at its best.
!> Directions of d say everything about f and g, and the angles h of both triples differ by an angle `lead` that depends on
!> the direction of d alone. So fast turns about d do not disturb the continuation of the angles.
module mech9_three_turns
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: turn, turn_back, combine, cross, about_z
  implicit none
  private
  public :: three_turns_type, swing_type, heading_type, set_three_turns, substitute_turns, cyclic

  !> The rotation that brings z to x, x to y and y to z.
  real(wp), parameter :: cyclic(3, 3) = reshape([0.0_wp, 1.0_wp, 0.0_wp, &
                                                 0.0_wp, 0.0_wp, 1.0_wp, &
                                                 1.0_wp, 0.0_wp, 0.0_wp], [3, 3])
  !> Within this distance of gimbal lock [rad], a motion that goes through it has the rates that it has in it: their changes
  !> over so short a way are smaller than round-off over the squared distance.
  real(wp), parameter :: lock_radius = 1.0e-6_wp

  !> Three turns. Angles of the common form are sign*q + shift.
  type :: three_turns_type
    real(wp) :: base(3, 3) = 0.0_wp   !< from the axes of the common form to those of the frame before the first turn
    real(wp) :: sign(3) = 1.0_wp      !< 1 or -1 for each turn
    real(wp) :: shift(3) = 0.0_wp     !< [rad]
  contains
    procedure :: margin
    procedure :: swing
    procedure :: add_jerk
    procedure :: in_lock
    procedure :: distance
    procedure :: speed
    procedure :: continue_heading
    procedure :: coordinates
  end type three_turns_type

  !> The motion of a ball joint, in axes of the frame before the first turn: that of the third axis, and the turn about it.
  type :: swing_type
    real(wp) :: d(3) = 0.0_wp            !< direction of the third axis
    real(wp) :: e(3) = 0.0_wp            !< direction at a right angle to it, from which the third turn is counted
    real(wp) :: omega(3) = 0.0_wp        !< angular velocity by the first two turns [rad/s]
    real(wp) :: omega_rate(3) = 0.0_wp   !< its rate [rad/s^2]
    real(wp) :: omega_jerk(3) = 0.0_wp   !< the rate of this, where it is known [rad/s^3]
    real(wp) :: spin(3) = 0.0_wp         !< third angle of the common form, its rate and acceleration
  end type swing_type

  !> The direction of the third axis in the angles of a triple, continued along a motion.
  type :: heading_type
    real(wp) :: first = 0.0_wp    !< f [rad]
    real(wp) :: second = 0.0_wp   !< g [rad]
    real(wp) :: lead = 0.0_wp     !< h less the third angle of the swing [rad]
  end type heading_type

contains

  !> The triple of three consecutive turns about z, each after a constant rotation. `fits` is false where neighbouring axes are
  !> not at right angles.
  pure subroutine set_three_turns(before, sign, offset, tolerance, turns, fits)
    real(wp), intent(in) :: before(3, 3, 3)       !< the rotation before each turn
    real(wp), intent(in) :: sign(3)               !< of each turn, 1 or -1
    real(wp), intent(in) :: offset(3)             !< added to each coordinate [rad]
    real(wp), intent(in) :: tolerance             !< largest cosine between neighbouring axes
    type(three_turns_type), intent(out) :: turns  !< the triple
    logical, intent(out) :: fits                  !< neighbouring axes are at right angles
    real(wp) :: azimuth(2), rest(3, 3), twist(2)
    integer :: i

    fits = abs(before(3, 3, 2)) <= tolerance .and. abs(before(3, 3, 3)) <= tolerance
    if (.not. fits) return
    ! a rotation that brings z to a horizontal axis is Rz(azimuth) cyclic Rz(twist)
    do i = 1, 2
      azimuth(i) = atan2(before(2, 3, i + 1), before(1, 3, i + 1))
      rest = combine(transpose(cyclic), combine(about_z(-azimuth(i)), before(:, :, i + 1)))
      twist(i) = atan2(rest(2, 1), rest(1, 1))
    end do
    turns%base = before(:, :, 1)
    turns%sign = sign
    turns%shift = sign*offset + [azimuth(1), twist(1) + azimuth(2), twist(2)]
  end subroutine set_three_turns

  !> The triple that is at its best where the given one is singular: its turns are about z, after `base`, `cyclic`, `cyclic`.
  pure function substitute_turns(turns) result(other)
    type(three_turns_type), intent(in) :: turns   !< the triple that is to be replaced
    type(three_turns_type) :: other

    other%base = combine(turns%base, cyclic)
  end function substitute_turns

  !> The sine of the angle between the first and the third axis: 0 in gimbal lock, 1 at best.
  pure real(wp) function margin(self, q)
    class(three_turns_type), intent(in) :: self   !< the triple
    real(wp), intent(in) :: q                     !< coordinate of the second turn [rad]

    margin = abs(cos(self%sign(2)*q + self%shift(2)))
  end function margin

  !> The motion that coordinates give.
  pure function swing(self, q, dq, ddq) result(motion)
    class(three_turns_type), intent(in) :: self   !< the triple
    real(wp), intent(in) :: q(3)                  !< coordinates [rad]
    real(wp), intent(in) :: dq(3)                 !< rates [rad/s]
    real(wp), intent(in) :: ddq(3)                !< accelerations [rad/s^2]
    type(swing_type) :: motion
    real(wp) :: angle(3), rate(3), n(3), m(3)

    angle = self%sign*q + self%shift
    rate = self%sign*dq
    n = [cos(angle(1)), sin(angle(1)), 0.0_wp]
    m = [-sin(angle(1)), cos(angle(1)), 0.0_wp]
    motion%e = turn(self%base, n)
    motion%d = turn(self%base, m*cos(angle(2)) + [0.0_wp, 0.0_wp, sin(angle(2))])
    motion%omega = turn(self%base, n*rate(2) + [0.0_wp, 0.0_wp, rate(1)])
    motion%omega_rate = turn(self%base, n*self%sign(2)*ddq(2) + m*rate(1)*rate(2) + [0.0_wp, 0.0_wp, self%sign(1)*ddq(1)])
    motion%spin = [angle(3), rate(3), self%sign(3)*ddq(3)]
  end function swing

  !> Add the third derivatives, on which accelerations in gimbal lock depend, to a motion that `swing` gave.
  pure subroutine add_jerk(self, q, dq, ddq, dddq, motion)
    class(three_turns_type), intent(in) :: self   !< the triple
    real(wp), intent(in) :: q(3)                  !< coordinates [rad]
    real(wp), intent(in) :: dq(3)                 !< rates [rad/s]
    real(wp), intent(in) :: ddq(3)                !< accelerations [rad/s^2]
    real(wp), intent(in) :: dddq(3)               !< their rates [rad/s^3]
    type(swing_type), intent(inout) :: motion     !< gets `omega_jerk`
    real(wp) :: f, rate(3), acceleration(3), n(3), m(3)

    f = self%sign(1)*q(1) + self%shift(1)
    rate = self%sign*dq
    acceleration = self%sign*ddq
    n = [cos(f), sin(f), 0.0_wp]
    m = [-sin(f), cos(f), 0.0_wp]
    motion%omega_jerk = turn(self%base, n*(self%sign(2)*dddq(2) - rate(2)*rate(1)**2) &
                             + m*(2.0_wp*acceleration(2)*rate(1) + rate(2)*acceleration(1)) &
                             + [0.0_wp, 0.0_wp, self%sign(1)*dddq(1)])
  end subroutine add_jerk

  !> The sine of the angle between the third axis and the first one of this triple.
  pure real(wp) function distance(self, motion)
    class(three_turns_type), intent(in) :: self   !< the triple
    type(swing_type), intent(in) :: motion        !< of the joint
    real(wp) :: d(3)

    d = turn_back(self%base, motion%d)
    distance = norm2(d(1:2))
  end function distance

  !> The speed of the third axis' direction [rad/s].
  pure real(wp) function speed(self, motion)
    class(three_turns_type), intent(in) :: self   !< the triple
    type(swing_type), intent(in) :: motion        !< of the joint

    speed = norm2(turn_back(self%base, cross(motion%omega, motion%d)))
  end function speed

  !> Continue the heading to a motion: of all angles that give its direction, those nearest to the ones before. They are the
  !> true continuation where the way between has been shorter than half its distance from the lock, or comes so near to the
  !> lock that the side on which it passes is not known.
  pure subroutine continue_heading(self, motion, lock, heading)
    class(three_turns_type), intent(in) :: self     !< the triple
    type(swing_type), intent(in) :: motion          !< of the joint
    real(wp), intent(in) :: lock                    !< distance from the lock below which directions are not known [rad]
    type(heading_type), intent(inout) :: heading    !< before the motion; then in it
    real(wp) :: d(3), course(3), f, n(3)

    d = turn_back(self%base, motion%d)
    course = d
    if (in_lock(self, motion, lock)) course = turn_back(self%base, cross(motion%omega, motion%d))
    if (norm2(course(1:2)) > 0.0_wp) then
      f = atan2(-course(1), course(2))
      heading%first = f + pi*anint((heading%first - f)/pi)
    end if
    f = atan2(d(3), d(2)*cos(heading%first) - d(1)*sin(heading%first))
    heading%second = f + 2.0_wp*pi*anint((heading%second - f)/(2.0_wp*pi))
    n = turn(self%base, [cos(heading%first), sin(heading%first), 0.0_wp])
    f = atan2(dot_product(n, cross(motion%e, motion%d)), dot_product(n, motion%e))
    heading%lead = f + 2.0_wp*pi*anint((heading%lead - f)/(2.0_wp*pi))
  end subroutine continue_heading

  !> Whether a motion is so near to gimbal lock that its angles follow from the way on which it passes: it goes through the lock
  !> itself but for distances that are not known.
  pure logical function in_lock(self, motion, lock)
    class(three_turns_type), intent(in) :: self   !< the triple
    type(swing_type), intent(in) :: motion        !< of the joint
    real(wp), intent(in) :: lock                  !< distance from the lock below which directions are not known [rad]
    real(wp) :: d(3), course(3), aside

    d = turn_back(self%base, motion%d)
    in_lock = norm2(d(1:2)) <= max(lock, lock_radius)
    if (.not. in_lock) return
    course = turn_back(self%base, cross(motion%omega, motion%d))
    aside = abs(d(1)*course(2) - d(2)*course(1))
    in_lock = aside <= lock*norm2(course(1:2))
  end function in_lock

  !> Coordinates with their rates and accelerations in the angles of the triple. In gimbal lock these are limits along the
  !> motion, if it goes through.
  pure subroutine coordinates(self, motion, heading, lock, q, dq, ddq)
    class(three_turns_type), intent(in) :: self     !< the triple
    type(swing_type), intent(in) :: motion          !< of the joint
    type(heading_type), intent(in) :: heading       !< continued to this motion
    real(wp), intent(in) :: lock                    !< distance from the lock below which directions are not known [rad]
    real(wp), intent(out) :: q(3)                   !< coordinates [rad]
    real(wp), intent(out) :: dq(3)                  !< rates [rad/s]
    real(wp), intent(out) :: ddq(3)                 !< accelerations [rad/s^2]
    real(wp), dimension(3) :: n, m, d, omega, omega_rate, rest, rate, acceleration
    real(wp) :: lead(2)

    n = [cos(heading%first), sin(heading%first), 0.0_wp]
    m = [-n(2), n(1), 0.0_wp]
    d = turn_back(self%base, motion%d)
    omega = turn_back(self%base, motion%omega)
    omega_rate = turn_back(self%base, motion%omega_rate)
    rate(2) = dot_product(omega, n)
    if (in_lock(self, motion, lock)) then
      lead = lead_in_lock(omega, omega_rate, turn_back(self%base, motion%omega_jerk), n, m, d(3))
      rate(1) = omega(3) - lead(1)*d(3)
    else
      lead(1) = dot_product(omega, m)/dot_product(d, m)
      rate(1) = omega(3) - lead(1)*d(3)
      rest = omega_rate - rate(1)*rate(2)*m - lead(1)*cross(omega, d)
      lead(2) = dot_product(rest, m)/dot_product(d, m)
    end if
    rest = omega_rate - lead(1)*cross(omega, d)
    acceleration = [rest(3) - lead(2)*d(3), dot_product(rest, n), motion%spin(3) + lead(2)]
    rate(3) = motion%spin(2) + lead(1)
    q = self%sign*([heading%first, heading%second, motion%spin(1) + heading%lead] - self%shift)
    dq = self%sign*rate
    ddq = self%sign*acceleration
  end subroutine coordinates

  !> First and second rate of the angle `lead` in gimbal lock. It is the quotient of two functions of time that are zero there:
  !> with c = d . m and f = omega . m, the lead's rate f/c is f'/c', and its derivative (f'' - (f'/c') c'')/(2 c').
  pure function lead_in_lock(omega, omega_rate, omega_jerk, n, m, up) result(lead)
    real(wp), intent(in) :: omega(3)        !< angular velocity by the first two turns, in the axes of the common form [rad/s]
    real(wp), intent(in) :: omega_rate(3)   !< its rate [rad/s^2]
    real(wp), intent(in) :: omega_jerk(3)   !< the rate of this [rad/s^3]
    real(wp), intent(in) :: n(3)            !< second axis
    real(wp), intent(in) :: m(3)            !< first axis times second axis
    real(wp), intent(in) :: up              !< 1 or -1: the third axis is parallel to the first one, or opposite
    real(wp) :: lead(2), w, first

    lead = 0.0_wp
    w = dot_product(omega, n)
    if (.not. abs(w) > 0.0_wp) return
    lead(1) = -(dot_product(omega_rate, m) - omega(3)*w)/(2.0_wp*up*w)
    first = omega(3) - up*lead(1)
    lead(2) = -(dot_product(omega_jerk, m) - omega_rate(3)*w + (lead(1)*up - 2.0_wp*first)*dot_product(omega_rate, n)) &
              /(3.0_wp*up*w)
  end function lead_in_lock
end module mech9_three_turns
