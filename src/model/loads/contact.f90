!> Contacts of a ball, or of a point, with a plane, a ball or a profile of another link: rigid ones with impacts, or compliant ones, with dry
!> friction.
!>
!> A ball of radius r about the point P meets a plane through O with the normal n at the gap g = n . (P - O) - r, and a ball of radius R
!> about O at g = |P - O| - r - R. A profile is a curve in a plane, along whose axis the surface goes on; its gap counts in the plane. The
!> bodies touch at C = P - r n. The penetration d = -g of a compliant contact gives the force d^exponent (stiffness + damping dd/dt), as
!> long as it pushes, as at compliant stops.
module mech9_contact
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  use mech9_rotation, only: cross, turn, turn_back
  use mech9_profile, only: profile_type, foot_type
  use mech9_motion_view, only: link_motion_type
  implicit none
  private
  public :: contact_type, contact_place_type, is_beyond_reach, plane_surface, ball_surface, profile_surface, surface_words

  !> The kinds of surfaces, and their names.
  integer, parameter :: plane_surface = 1, ball_surface = 2, profile_surface = 3
  character(len=6), parameter :: surface_words(3) = [character(len=6) :: 'plane', 'sphere', 'path']

  !> A way in a short time is no longer than this times the time and the greater of both speeds at its ends.
  real(wp), parameter :: longer_way = 1.25_wp

  !> A contact between two links.
  type :: contact_type
    type(place_type) :: place                    !< place of its group in the data file
    integer :: number = 0                        !< of its group; sides of one profile that a corner parts have the same number
    integer :: slot = 0                          !< its place among all contacts of the mechanism
    integer :: links(2) = 0                      !< numbers of the link of the ball, and of that of the surface
    real(wp) :: center(3) = 0.0_wp               !< of the ball, in the system of its link [m]
    real(wp) :: radius = 0.0_wp                  !< of the ball; 0: a point [m]
    integer :: surface = plane_surface           !< kind of the surface
    real(wp) :: origin(3) = 0.0_wp               !< a point of the plane, the centre of the ball, or the origin of the profile, in its link [m]
    real(wp) :: normal(3) = [0.0_wp, 0.0_wp, 1.0_wp]   !< of the plane, towards the free side, in the axes of its link
    real(wp) :: other_radius = 0.0_wp            !< of the ball that is the surface [m]
    real(wp) :: axes(3, 3) = 0.0_wp              !< x and y of the profile's plane, and the axis across it, in its link
    type(profile_type), allocatable :: profile   !< the curve, or one of its sides between corners that stand in
    type(profile_type), allocatable :: whole     !< the whole curve, where the profile is one side of it
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
    procedure :: centre_in_plane
    procedure :: is_smooth_between
    procedure :: acceleration
    procedure :: normal_force
    procedure :: energy
    procedure :: outline
  end type contact_type

  !> A contact in one state of motion, in fixed axes.
  type :: contact_place_type
    real(wp) :: gap = 0.0_wp            !< distance that is left; negative: the penetration [m]
    real(wp) :: normal(3) = 0.0_wp      !< of the surface, towards the ball
    real(wp) :: normal_rate(3) = 0.0_wp !< its derivative in time [1/s]
    real(wp) :: at(3) = 0.0_wp          !< point at which the bodies touch [m]
    real(wp) :: slip(3) = 0.0_wp        !< velocity of the ball there against the surface, the rate of the gap in it [m/s]
    real(wp) :: speed = 0.0_wp          !< sum of the speeds from which this velocity comes [m/s]
    real(wp) :: passing_speed = 0.0_wp  !< speed of the ball's centre as seen from the surface's link, along the plane of a profile [m/s]
    integer :: part = 0                 !< of a profile: the part with the nearest point, see foot_type; 0: a smooth surface
    real(wp) :: past = 0.0_wp           !< how far the centre is past the end of a given stretch of a profile [m]
    real(wp) :: past_rate = 0.0_wp      !< its derivative in time [m/s]
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
  pure function find_place(self, ball, surface, stretch) result(place)
    class(contact_type), intent(in) :: self        !< the contact
    type(link_motion_type), intent(in) :: ball     !< motion of the ball's link
    type(link_motion_type), intent(in) :: surface  !< motion of the surface's link
    integer, intent(in), optional :: stretch       !< of a profile, on which the foot is; 0 or absent: the nearest foot counts
    type(contact_place_type) :: place
    real(wp) :: d(3), v(3), v_origin(3), spin(3), carried(3), length

    d = ball%point_position(self%center) - surface%point_position(self%origin)
    v = ball%point_velocity(self%center)
    select case (self%surface)
    case (plane_surface)
      place%normal = surface%fixed_components(self%normal)
      place%gap = dot_product(place%normal, d) - self%radius
      place%normal_rate = cross(surface%omega, place%normal)
    case (profile_surface)
      call find_foot(self, d, v - surface%point_velocity(self%origin) - cross(surface%omega, d), surface, place, stretch)
    case default
      length = norm2(d)
      if (length > 0.0_wp) place%normal = d/length
      place%gap = length - self%radius - self%other_radius
      v_origin = surface%point_velocity(self%origin)
      if (length > 0.0_wp) &
        place%normal_rate = (v - v_origin - dot_product(place%normal, v - v_origin)*place%normal)/length
    end select
    place%at = ball%point_position(self%center) - self%radius*place%normal
    spin = self%radius*cross(ball%omega, place%normal)
    carried = surface%v + cross(surface%omega, place%at - surface%p)
    place%slip = v - spin - carried
    place%speed = norm2(v) + norm2(spin) + norm2(carried)
  end function find_place

  !> The centre of the ball in the plane of the profile, from its origin [m].
  pure function centre_in_plane(self, ball, surface) result(centre)
    class(contact_type), intent(in) :: self        !< a contact with a profile
    type(link_motion_type), intent(in) :: ball     !< motion of the ball's link
    type(link_motion_type), intent(in) :: surface  !< motion of the surface's link
    real(wp) :: centre(2), point(3)

    point = turn_back(self%axes, turn_back(surface%r, ball%point_position(self%center) - surface%point_position(self%origin)))
    centre = point(:2)
  end function centre_in_plane

  !> Find gap and normal of a profile.
  pure subroutine find_foot(self, d, v, surface, place, stretch)
    class(contact_type), intent(in) :: self               !< the contact
    real(wp), intent(in) :: d(3)                          !< from the profile's origin to the centre of the ball, fixed axes [m]
    real(wp), intent(in) :: v(3)                          !< velocity of this centre as seen from the surface, fixed axes [m/s]
    type(link_motion_type), intent(in) :: surface         !< motion of the surface's link
    type(contact_place_type), intent(inout) :: place      !< gets gap, normal and rate of the normal
    integer, intent(in), optional :: stretch              !< on which the foot is; 0 or absent: the nearest foot counts
    type(foot_type) :: foot
    real(wp) :: point(3), tangent(3), flat(3)

    point = turn_back(self%axes, turn_back(surface%r, d))
    flat = turn_back(self%axes, turn_back(surface%r, v))
    place%passing_speed = norm2(flat(:2))
    foot = self%profile%foot(point(:2), stretch)
    place%part = foot%part
    place%past = foot%past
    place%past_rate = dot_product(foot%past_slope, flat(:2))
    place%gap = foot%distance - self%radius
    if (is_hidden(self, foot, point(:2))) place%gap = -foot%distance
    place%normal = surface%fixed_components(turn(self%axes, [foot%normal, 0.0_wp]))
    tangent = surface%fixed_components(turn(self%axes, [foot%tangent, 0.0_wp]))
    place%normal_rate = cross(surface%omega, place%normal) + foot%turning*dot_product(v, tangent)*tangent
  end subroutine find_foot

  !> Whether the gap changes smoothly between two near places, as far as can be told from both: the nearest points lie on one part of a
  !> smooth piece or on two that follow each other, or the ball is too slow to come near another part.
  pure logical function is_smooth_between(self, first, second, time) result(is_smooth)
    class(contact_type), intent(in) :: self               !< the contact
    type(contact_place_type), intent(in) :: first         !< the place at one time
    type(contact_place_type), intent(in) :: second        !< the place at the other one
    real(wp), intent(in) :: time                          !< between both [s]

    is_smooth = self%surface /= profile_surface
    if (is_smooth) return
    is_smooth = self%profile%neighbours(first%part, second%part) .or. &
                ((first%gap < 0.0_wp .eqv. second%gap < 0.0_wp) .and. is_beyond_reach(first, second, time))
  end function is_smooth_between

  !> Whether a ball that is as near to a profile as at two places is too slow to touch it between both. A distance from a curve changes no
  !> faster than the point moves.
  pure logical function is_beyond_reach(first, second, time)
    type(contact_place_type), intent(in) :: first         !< the place at one time
    type(contact_place_type), intent(in) :: second        !< the place at the other one
    real(wp), intent(in) :: time                          !< between both [s]

    is_beyond_reach = abs(first%gap) + abs(second%gap) > longer_way*abs(time)*max(first%passing_speed, second%passing_speed)
  end function is_beyond_reach

  !> Whether a point outside the whole curve sees a side from behind, through the body, where it cannot touch.
  pure logical function is_hidden(self, foot, point)
    type(contact_type), intent(in) :: self   !< the contact
    type(foot_type), intent(in) :: foot      !< foot of the point on its profile
    real(wp), intent(in) :: point(2)         !< in the plane of the profile [m]
    type(foot_type) :: on_whole

    is_hidden = foot%distance < 0.0_wp .and. allocated(self%whole)
    if (.not. is_hidden) return
    on_whole = self%whole%foot(point)
    is_hidden = on_whole%distance > 0.0_wp
  end function is_hidden

  !> The derivative in time of the velocity of the ball against the surface where they touch, fixed axes [m/s^2]: its part along the normal
  !> is the second derivative of the gap, those along the tangents are derivatives of the slip.
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
    ! the normal turns: the rate of the gap changes with it, too, and along the surface it is no part of the slip
    acceleration = acceleration + dot_product(place%normal_rate, place%slip)*place%normal - place%gap_rate()*place%normal_rate
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

  !> Points along the profile, in the system of its link.
  pure function outline(self) result(points)
    class(contact_type), intent(in) :: self   !< a contact with a profile
    real(wp), allocatable :: points(:, :)     !< (3,n) [m]
    real(wp), allocatable :: flat(:, :)
    integer :: i

    flat = self%profile%trace()
    allocate (points(3, size(flat, 2)))
    do i = 1, size(flat, 2)
      points(:, i) = self%origin + turn(self%axes, [flat(:, i), 0.0_wp])
    end do
  end function outline

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
