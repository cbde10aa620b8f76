!> How the gap of a contact changes with the place of its ball, and the derivatives of gap and normal by a parameter.
!>
!> Seen from the link of the surface, the centre of the ball is at x, and the gap is g(x), with the normal n as its gradient. With the
!> change dx of the centre, g' = n . dx, and the rate of the gap, n . x', changes by n . dx' + x' . H dx, where H is the second
!> derivative of g. Numbers of the contact itself change the place of the ball and of the surface, too.
module mech9_contact_change
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, turn, turn_back
  use mech9_profile, only: foot_type
  use mech9_motion_view, only: link_motion_type
  use mech9_motion_change, only: link_change_type
  use mech9_contact, only: contact_type, plane_surface, profile_surface
  implicit none
  private
  public :: gap_shape_type, contact_change_type, find_gap_shape, numbers_of_contact, change_of_contact, surface_change, &
    vary_normal_force, number_count, of_restitution, of_sliding

  !> The gap near a place of the ball's centre, in the axes of the surface's link.
  type :: gap_shape_type
    real(wp) :: normal(3) = 0.0_wp        !< first derivative of the gap
    real(wp) :: bending(3, 3) = 0.0_wp    !< second derivative [1/m]
    real(wp) :: past_slope(3) = 0.0_wp    !< derivative of the way past the end of a given stretch of a profile
    real(wp), private :: tangent(3) = 0.0_wp   !< along a profile
    real(wp), private :: turning = 0.0_wp      !< of the normal of a profile, per way of the ball along the tangent [1/m]
    real(wp), private :: slope = 0.0_wp        !< derivative of `turning` along the tangent [1/m^2]
    real(wp), private :: length = 0.0_wp       !< from the centre of a ball that is the surface; 0: other surfaces [m]
  contains
    procedure :: bent
    procedure :: bent_along
  end type gap_shape_type

  !> The derivative of a contact by a parameter.
  type :: contact_change_type
    real(wp) :: gap = 0.0_wp          !< of the gap [m]
    real(wp) :: gap_rate = 0.0_wp     !< of its rate [m/s]
    real(wp) :: normal(3) = 0.0_wp    !< of the normal, fixed axes
    real(wp) :: centre(3) = 0.0_wp    !< of the position of the ball's centre, fixed axes [m]
  end type contact_change_type

  !> How many numbers a contact has, and the places of its restitution and of its coefficient of sliding friction among them.
  integer, parameter :: number_count = 23, of_restitution = 21, of_sliding = 22

contains

  !> The numbers of a contact: centre and radius of the ball; origin, axes and radius of the surface, its normal in place of axes if it is
  !> a plane; stiffness, damping, exponent, restitution and both coefficients of friction. The points of a profile are not among them.
  pure function numbers_of_contact(contact) result(values)
    type(contact_type), intent(in) :: contact   !< the contact
    real(wp) :: values(number_count)

    values(1:7) = [contact%center, contact%radius, contact%origin]
    values(8:16) = reshape(contact%axes, [9])
    if (contact%surface == plane_surface) values(8:10) = contact%normal
    values(17:) = [contact%other_radius, contact%stiffness, contact%damping, contact%exponent, contact%restitution, &
                   contact%sliding_friction, contact%static_friction]
  end function numbers_of_contact

  !> The gap near a place of the ball's centre.
  pure function find_gap_shape(contact, x, stretch) result(shape)
    type(contact_type), intent(in) :: contact   !< the contact
    real(wp), intent(in) :: x(3)                !< the centre from `origin` of the surface, in the axes of its link [m]
    integer, intent(in), optional :: stretch    !< of a profile, on which the foot is; 0 or absent: the nearest foot counts
    type(gap_shape_type) :: shape
    type(foot_type) :: foot
    real(wp) :: flat(3)
    integer :: i

    select case (contact%surface)
    case (plane_surface)
      shape%normal = contact%normal
    case (profile_surface)
      flat = turn_back(contact%axes, x)
      foot = contact%profile%foot(flat(:2), stretch)
      shape%past_slope = turn(contact%axes, [foot%past_slope, 0.0_wp])
      shape%normal = turn(contact%axes, [foot%normal, 0.0_wp])
      shape%tangent = turn(contact%axes, [foot%tangent, 0.0_wp])
      shape%turning = foot%turning
      shape%slope = foot%turning_slope
      shape%bending = foot%turning*spread(shape%tangent, 2, 3)*spread(shape%tangent, 1, 3)
    case default
      shape%length = norm2(x)
      if (.not. shape%length > 0.0_wp) return
      shape%normal = x/shape%length
      shape%bending = -spread(shape%normal, 2, 3)*spread(shape%normal, 1, 3)/shape%length
      do i = 1, 3
        shape%bending(i, i) = shape%bending(i, i) + 1.0_wp/shape%length
      end do
    end select
  end function find_gap_shape

  !> The derivative of a . H a along a change of the place, the vector a held [m/s^2].
  pure real(wp) function bent(self, a, change)
    class(gap_shape_type), intent(in) :: self   !< the gap near the place
    real(wp), intent(in) :: a(3)                !< the vector, in the axes of the surface's link [m/s]
    real(wp), intent(in) :: change(3)           !< of the place, in these axes [m]

    bent = dot_product(a, self%bent_along(a, change))
  end function bent

  !> The derivative of H a along a change of the place, the vector a held, in the axes of the surface's link [1/s].
  pure function bent_along(self, a, change) result(vector)
    class(gap_shape_type), intent(in) :: self   !< the gap near the place
    real(wp), intent(in) :: a(3)                !< the vector, in the axes of the surface's link [m/s]
    real(wp), intent(in) :: change(3)           !< of the place, in these axes [m]
    real(wp) :: vector(3), across(2), along(2)

    vector = 0.0_wp
    across = [dot_product(self%normal, a), dot_product(self%normal, change)]
    if (self%length > 0.0_wp) then
      vector = -((dot_product(a, change) - across(1)*across(2))*self%normal + across(2)*(a - across(1)*self%normal) &
                 + across(1)*(change - across(2)*self%normal))/self%length**2
    else if (abs(self%turning) > 0.0_wp .or. abs(self%slope) > 0.0_wp) then
      along = [dot_product(self%tangent, a), dot_product(self%tangent, change)]
      vector = self%slope*along(1)*along(2)*self%tangent - self%turning**2*((across(2)*along(1) + across(1)*along(2))*self%tangent &
                                                                            + along(1)*along(2)*self%normal)
    end if
  end function bent_along

  !> The twist of the surface in its link by a change of the contact's numbers: its rotation, and the shift of `origin`.
  pure function surface_change(contact, numbers) result(twist)
    type(contact_type), intent(in) :: contact    !< the contact
    real(wp), intent(in) :: numbers(:)           !< (numbers) derivatives of its numbers, by one parameter, SI units; of size 0: all are zero
    real(wp) :: twist(6), spin(3, 3)

    twist = 0.0_wp
    if (size(numbers) == 0) return
    twist(4:6) = numbers(5:7)
    if (contact%surface == plane_surface) then
      twist(1:3) = cross(contact%normal, numbers(8:10))
    else if (contact%surface == profile_surface) then
      spin = matmul(reshape(numbers(8:16), [3, 3]), transpose(contact%axes))
      twist(1:3) = 0.5_wp*[spin(3, 2) - spin(2, 3), spin(1, 3) - spin(3, 1), spin(2, 1) - spin(1, 2)]
    end if
  end function surface_change

  !> The derivative of a contact by a parameter that changes the motion of its links, or its own numbers.
  pure function change_of_contact(contact, ball, surface, ball_change, change_of_surface, numbers, stretch) result(change)
    type(contact_type), intent(in) :: contact                 !< the contact
    type(link_motion_type), intent(in) :: ball                !< motion of the ball's link
    type(link_motion_type), intent(in) :: surface             !< motion of the surface's link
    type(link_change_type), intent(in) :: ball_change         !< derivative of the first one
    type(link_change_type), intent(in) :: change_of_surface   !< derivative of the second one
    real(wp), intent(in) :: numbers(:)                        !< (numbers) derivatives of the contact's numbers by one parameter, SI units; of size 0: all are zero
    integer, intent(in), optional :: stretch                  !< of a profile, on which the foot is; 0 or absent: the nearest foot counts
    type(contact_change_type) :: change
    type(gap_shape_type) :: shape
    real(wp), dimension(3) :: arm, w, x, rate, moved, moved_rate, own, centre_rate
    real(wp) :: twist(6)

    change%centre = ball_change%of_position(ball, contact%center)
    centre_rate = ball_change%of_velocity(ball, contact%center)
    if (size(numbers) > 0) then
      own = turn(ball%r, numbers(1:3))
      change%centre = change%centre + own
      centre_rate = centre_rate + cross(ball%omega, own)
    end if
    arm = ball%point_position(contact%center) - surface%p
    w = ball%point_velocity(contact%center) - surface%v - cross(surface%omega, arm)
    x = turn_back(surface%r, arm) - contact%origin
    rate = turn_back(surface%r, w)
    twist = surface_change(contact, numbers)
    associate (s => change_of_surface)
      moved = turn_back(surface%r, change%centre - s%shift - cross(s%turn, arm)) - twist(4:6) - cross(twist(1:3), x)
      moved_rate = turn_back(surface%r, centre_rate - s%v - cross(s%omega, arm) - cross(surface%omega, change%centre - s%shift) &
                                        - cross(s%turn, w)) - cross(twist(1:3), rate)
      shape = find_gap_shape(contact, x, stretch)
      change%gap = dot_product(shape%normal, moved)
      change%gap_rate = dot_product(shape%normal, moved_rate) + dot_product(rate, matmul(shape%bending, moved))
      change%normal = turn(surface%r, matmul(shape%bending, moved) + cross(twist(1:3), shape%normal)) &
                      + cross(s%turn, turn(surface%r, shape%normal))
    end associate
    if (size(numbers) > 0) change%gap = change%gap - numbers(4) - numbers(17)
  end function change_of_contact

  !> The derivative of the normal force of a compliant contact [N].
  pure real(wp) function vary_normal_force(contact, gap, rate, change, numbers) result(force)
    type(contact_type), intent(in) :: contact            !< the contact
    real(wp), intent(in) :: gap                          !< its gap [m]
    real(wp), intent(in) :: rate                         !< rate of the gap [m/s]
    type(contact_change_type), intent(in) :: change      !< derivatives of both
    real(wp), intent(in) :: numbers(:)                   !< (numbers) derivatives of the contact's numbers by one parameter, SI units; of size 0: all are zero
    real(wp) :: factor, power

    force = 0.0_wp
    factor = contact%stiffness - contact%damping*rate
    if (contact%is_rigid .or. .not. gap < 0.0_wp .or. .not. factor > 0.0_wp) return
    power = (-gap)**contact%exponent
    force = -contact%exponent*power/(-gap)*factor*change%gap - power*contact%damping*change%gap_rate
    if (size(numbers) > 0) force = force + power*(numbers(18) - numbers(19)*rate + log(-gap)*numbers(20)*factor)
  end function vary_normal_force
end module mech9_contact_change
