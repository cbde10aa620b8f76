!> Contacts of a ball, or of a point, with a plane or a ball of another link: rigid ones with impacts, or compliant ones, with dry friction.
!>
!> A ball of radius r about the point P meets a plane through O with the normal n at the gap g = n . (P - O) - r, and a ball of radius R
!> about O at g = |P - O| - r - R. The bodies touch at C = P - r n. The penetration d = -g of a compliant contact gives the force
!> d^exponent (stiffness + damping dd/dt), as long as it pushes, as at compliant stops.
module mech9_contact
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  use mech9_rotation, only: cross
  use mech9_motion_view, only: link_motion_type
  implicit none
  private
  public :: contact_type, contact_place_type

  !> A contact between two links.
  type :: contact_type
    type(place_type) :: place                    !< place of its group in the data file
    integer :: links(2) = 0                      !< numbers of the link of the ball, and of that of the surface
    real(wp) :: center(3) = 0.0_wp               !< of the ball, in the system of its link [m]
    real(wp) :: radius = 0.0_wp                  !< of the ball; 0: a point [m]
    logical :: is_plane = .true.                 !< the surface is a plane, and a ball otherwise
    real(wp) :: origin(3) = 0.0_wp               !< a point of the plane, or the centre of the ball, in the system of its link [m]
    real(wp) :: normal(3) = [0.0_wp, 0.0_wp, 1.0_wp]   !< of the plane, towards the free side, in the axes of its link
    real(wp) :: other_radius = 0.0_wp            !< of the ball that is the surface [m]
    logical :: is_rigid = .true.                 !< it cannot be pressed in
    real(wp) :: restitution = 0.0_wp             !< of a rigid one: rate after an impact over that before it, 0 to 1
    real(wp) :: sliding_friction = 0.0_wp        !< coefficient of friction in motion
    real(wp) :: static_friction = 0.0_wp         !< coefficient of friction at rest
    real(wp) :: stiffness = 0.0_wp               !< of a compliant one [N/m^n]
    real(wp) :: damping = 0.0_wp                 !< of a compliant one, force per rate and power of the penetration
    real(wp) :: exponent = 1.0_wp                !< n, of the penetration
  contains
    procedure :: has_friction
    procedure :: find_place
    procedure :: acceleration
    procedure :: normal_force
    procedure :: energy
  end type contact_type

  !> A contact in one state of motion, in fixed axes.
  type :: contact_place_type
    real(wp) :: gap = 0.0_wp            !< distance that is left; negative: the penetration [m]
    real(wp) :: normal(3) = 0.0_wp      !< of the surface, towards the ball
    real(wp) :: normal_rate(3) = 0.0_wp !< its derivative in time [1/s]
    real(wp) :: at(3) = 0.0_wp          !< point at which the bodies touch [m]
    real(wp) :: slip(3) = 0.0_wp        !< velocity of the ball there against the surface, the rate of the gap in it [m/s]
    real(wp) :: speed = 0.0_wp          !< sum of the speeds from which this velocity comes [m/s]
  contains
    procedure :: gap_rate
    procedure :: tangents
  end type contact_place_type

contains

  !> Whether there is friction.
  pure logical function has_friction(self)
    class(contact_type), intent(in) :: self   !< the contact

    has_friction = self%static_friction > 0.0_wp
  end function has_friction

  !> The place of the contact in a motion of its links.
  pure function find_place(self, ball, surface) result(place)
    class(contact_type), intent(in) :: self        !< the contact
    type(link_motion_type), intent(in) :: ball     !< motion of the ball's link
    type(link_motion_type), intent(in) :: surface  !< motion of the surface's link
    type(contact_place_type) :: place
    real(wp) :: d(3), v(3), v_origin(3), spin(3), carried(3), length

    d = ball%point_position(self%center) - surface%point_position(self%origin)
    v = ball%point_velocity(self%center)
    if (self%is_plane) then
      place%normal = surface%fixed_components(self%normal)
      place%gap = dot_product(place%normal, d) - self%radius
      place%normal_rate = cross(surface%omega, place%normal)
    else
      length = norm2(d)
      if (length > 0.0_wp) place%normal = d/length
      place%gap = length - self%radius - self%other_radius
      v_origin = surface%point_velocity(self%origin)
      if (length > 0.0_wp) &
        place%normal_rate = (v - v_origin - dot_product(place%normal, v - v_origin)*place%normal)/length
    end if
    place%at = ball%point_position(self%center) - self%radius*place%normal
    spin = self%radius*cross(ball%omega, place%normal)
    carried = surface%v + cross(surface%omega, place%at - surface%p)
    place%slip = v - spin - carried
    place%speed = norm2(v) + norm2(spin) + norm2(carried)
  end function find_place

  !> The derivative in time of the velocity of the ball against the surface where they touch, fixed axes [m/s^2]; its part along the normal
  !> is the second derivative of the gap.
  pure function acceleration(self, place, ball, surface, a_center, alpha_ball, a_surface, alpha_surface)
    class(contact_type), intent(in) :: self        !< the contact
    type(contact_place_type), intent(in) :: place  !< its place
    type(link_motion_type), intent(in) :: ball     !< motion of the ball's link
    type(link_motion_type), intent(in) :: surface  !< motion of the surface's link
    real(wp), intent(in) :: a_center(3)            !< acceleration of the ball's centre, fixed axes [m/s^2]
    real(wp), intent(in) :: alpha_ball(3)          !< angular acceleration of its link, fixed axes [rad/s^2]
    real(wp), intent(in) :: a_surface(3)           !< acceleration of the origin of the surface's link, fixed axes [m/s^2]
    real(wp), intent(in) :: alpha_surface(3)       !< angular acceleration of this link, fixed axes [rad/s^2]
    real(wp) :: acceleration(3), at_rate(3)

    at_rate = ball%point_velocity(self%center) - self%radius*place%normal_rate
    acceleration = a_center - self%radius*(cross(alpha_ball, place%normal) + cross(ball%omega, place%normal_rate)) &
                   - a_surface - cross(alpha_surface, place%at - surface%p) - cross(surface%omega, at_rate - surface%v)
    ! the normal turns: the rate of the gap changes with it, too
    acceleration = acceleration + dot_product(place%normal_rate, place%slip)*place%normal
  end function acceleration

  !> The force of a compliant contact, along the normal [N].
  pure real(wp) function normal_force(self, place) result(force)
    class(contact_type), intent(in) :: self        !< the contact
    type(contact_place_type), intent(in) :: place  !< its place

    force = 0.0_wp
    if (self%is_rigid .or. .not. place%gap < 0.0_wp) return
    force = max(0.0_wp, (-place%gap)**self%exponent*(self%stiffness - self%damping*place%gap_rate()))
  end function normal_force

  !> The energy of a compliant contact without its damping [J].
  pure real(wp) function energy(self, place)
    class(contact_type), intent(in) :: self        !< the contact
    type(contact_place_type), intent(in) :: place  !< its place

    energy = 0.0_wp
    if (.not. self%is_rigid) energy = self%stiffness*max(0.0_wp, -place%gap)**(self%exponent + 1.0_wp)/(self%exponent + 1.0_wp)
  end function energy

  !> The rate of the gap [m/s].
  pure real(wp) function gap_rate(self)
    class(contact_place_type), intent(in) :: self   !< the place of the contact

    gap_rate = dot_product(self%normal, self%slip)
  end function gap_rate

  !> Two directions in the surface, fixed axes, of length 1 and at right angles to each other and to the normal.
  pure function tangents(self)
    class(contact_place_type), intent(in) :: self   !< the place of the contact
    real(wp) :: tangents(3, 2)
    real(wp) :: aside(3)

    aside = 0.0_wp
    aside(minloc(abs(self%normal), dim=1)) = 1.0_wp
    tangents(:, 2) = cross(self%normal, aside)
    tangents(:, 2) = tangents(:, 2)/max(norm2(tangents(:, 2)), tiny(1.0_wp))
    tangents(:, 1) = cross(tangents(:, 2), self%normal)
  end function tangents
end module mech9_contact
