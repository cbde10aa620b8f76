!> The contact of a cam with its follower in one position: a point of the cam's profile with its tangent and curvature.
!>
!> The profile is the envelope of the roller's circles, or of the lines of a flat face, in the system of the cam. It follows from
!> the position, velocity and acceleration of the follower against the cam (docs/explanation/theory.md); nothing is found by
!> differences.
module mech9_cam_contact
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, turn, turn_back
  use mech9_pair_axes, only: pair_axes_type, turning
  use mech9_request, only: cam_request_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion, link_turning, point_motion
  implicit none
  private
  public :: cam_contact_type, find_contact

  !> A motion against the cam that is a smaller part of the motions in space is round-off.
  real(wp), parameter :: least_motion = 1.0e-11_wp
  !> A smaller curvature is that of a straight line [1/m].
  real(wp), parameter :: straight = 1.0e-100_wp

  !> The contact in one position. Points are in the system of the cam.
  type :: cam_contact_type
    real(wp) :: t = 0.0_wp               !< time [s]
    real(wp) :: angle = 0.0_wp           !< coordinate of the cam [rad, m]
    real(wp) :: pitch(3) = 0.0_wp        !< centre of the roller, or the given point of the flat face [m]
    logical :: known = .false.           !< the follower moves against the cam, so that there is a point of the profile
    real(wp) :: profile(3) = 0.0_wp      !< point of contact, where it is known [m]
    real(wp) :: radius = 0.0_wp          !< radius of curvature, positive where the cam is convex; infinite where it is straight [m]
    real(wp) :: normal(3) = 0.0_wp       !< unit vector at the contact into the cam
    logical :: undercut = .false.        !< the profile turns back here: no cam has this point
    real(wp) :: offset = 0.0_wp          !< place of the contact on a flat face, from its given point [m]
    real(wp) :: pressure = 0.0_wp        !< angle between the common normal and the motion that the guide allows, 0 to pi/2 [rad]
    real(wp) :: height = 0.0_wp          !< of the pitch point along the axis of the cam's plane [m]
    real(wp) :: tilt = 0.0_wp            !< sine of the angle by which a flat face leaves the normal of the cam's plane
  end type cam_contact_type

  !> The motion of the follower against the cam, in the axes of link 1.
  type :: relative_motion_type
    real(wp) :: r(3, 3) = 0.0_wp           !< turns components in the cam's system into those of link 1
    real(wp) :: origin(3) = 0.0_wp         !< of the cam [m]
    real(wp) :: axis(3) = 0.0_wp           !< normal of the cam's plane
    real(wp) :: place(3) = 0.0_wp          !< of the follower's point [m]
    real(wp) :: velocity(3) = 0.0_wp       !< of this point, as seen from the cam [m/s]
    real(wp) :: acceleration(3) = 0.0_wp   !< of this point, as seen from the cam [m/s^2]
    real(wp) :: speed = 0.0_wp             !< sum of the speeds in space from which the velocity follows [m/s]
    real(wp) :: omega(3) = 0.0_wp          !< angular velocity of the cam in link 1 [rad/s]
    real(wp) :: alpha(3) = 0.0_wp          !< its angular acceleration [rad/s^2]
  end type relative_motion_type

contains

  !> The contact in the position of a state.
  pure subroutine find_contact(cam, guides, plan, state, contact)
    type(cam_request_type), intent(in) :: cam         !< the cam and its follower
    type(pair_axes_type), intent(in) :: guides(:)     !< the pair that guides the follower; none: no pressure angle
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(state_type), intent(in) :: state             !< with the accelerations of all frames
    type(cam_contact_type), intent(out) :: contact    !< the contact
    type(relative_motion_type) :: motion
    real(wp) :: normal(3)

    contact%t = state%t
    contact%angle = state%q(cam%coordinate)
    call find_motion(cam, plan, state, motion)
    contact%pitch = turn_back(motion%r, motion%place - motion%origin)
    contact%height = dot_product(contact%pitch, cam%axis)
    if (cam%flat) then
      call touch_face(cam, plan, state, motion, contact, normal)
    else
      call touch_roller(cam, carrier_rate(cam, guides, plan, state, motion), motion, contact, normal)
    end if
    contact%normal = turn_back(motion%r, normal)
    if (.not. contact%known .or. size(guides) == 0) return
    if (cam%flat) motion%place = motion%origin + turn(motion%r, contact%profile)
    call find_pressure(cam, guides(1), plan, state, motion%place, normal, contact)
  end subroutine find_contact

  !> The motion of the follower's point against the cam.
  pure subroutine find_motion(cam, plan, state, motion)
    type(cam_request_type), intent(in) :: cam             !< the cam and its follower
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< with the accelerations of all frames
    type(relative_motion_type), intent(out) :: motion     !< the motion
    real(wp), dimension(3) :: v, a, origin_v, origin_a, arm, carried

    call link_motion(plan, state, cam%link, motion%r, motion%origin, motion%omega, origin_v)
    call link_turning(plan, state, cam%link, motion%alpha)
    call point_motion(plan, state, cam%link, [0.0_wp, 0.0_wp, 0.0_wp], motion%origin, origin_v, origin_a)
    call point_motion(plan, state, cam%follower, cam%point, motion%place, v, a)
    motion%axis = turn(motion%r, cam%axis)
    arm = motion%place - motion%origin
    carried = cross(motion%omega, arm)
    motion%velocity = v - origin_v - carried
    motion%acceleration = a - origin_a - cross(motion%alpha, arm) - cross(motion%omega, carried) &
                          - 2.0_wp*cross(motion%omega, motion%velocity)
    motion%speed = norm2(v) + norm2(origin_v) + norm2(carried)
  end subroutine find_motion

  !> Angular velocity of the cam about its axis against the link that carries the guide of the follower, or against link 1 [rad/s].
  pure real(wp) function carrier_rate(cam, guides, plan, state, motion) result(rate)
    type(cam_request_type), intent(in) :: cam           !< the cam and its follower
    type(pair_axes_type), intent(in) :: guides(:)       !< the pair that guides the follower, or none
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(state_type), intent(in) :: state               !< with the velocities of all frames
    type(relative_motion_type), intent(in) :: motion    !< of the follower against the cam
    real(wp) :: r(3, 3), p(3), omega(3), v(3)

    omega = 0.0_wp
    if (size(guides) > 0) &
      call link_motion(plan, state, sum(guides(1)%links) - cam%follower, r, p, omega, v)
    rate = dot_product(motion%omega - omega, motion%axis)
  end function carrier_rate

  !> The point at which a roller touches. The cam lies on the inner side of the pitch curve, which runs around the cam against the
  !> sense in which the cam turns; where the cam only slides, it lies on the side of the cam's origin.
  pure subroutine touch_roller(cam, rate, motion, contact, normal)
    type(cam_request_type), intent(in) :: cam               !< the cam and its follower
    real(wp), intent(in) :: rate                            !< of the cam against the guide's link, about its axis [rad/s]
    type(relative_motion_type), intent(in) :: motion        !< of the roller's centre against the cam
    type(cam_contact_type), intent(inout) :: contact        !< gets the point and its curvature
    real(wp), intent(out) :: normal(3)                      !< unit vector from its centre into the cam, in the axes of link 1
    real(wp) :: speed, left(3), arm(3), side, pitch_curvature, shrinkage

    normal = 0.0_wp
    speed = norm2(motion%velocity)
    contact%known = speed > least_motion*motion%speed
    if (.not. contact%known) return
    left = cross(motion%axis, motion%velocity)/speed
    arm = motion%place - motion%origin
    side = -sign(1.0_wp, rate)
    if (.not. abs(rate)*norm2(arm) > least_motion*speed) side = -sign(1.0_wp, dot_product(left, arm))
    if (cam%outer) side = -side
    normal = side*left
    pitch_curvature = dot_product(motion%acceleration, normal)/speed**2
    shrinkage = 1.0_wp - cam%roller*pitch_curvature
    contact%profile = turn_back(motion%r, arm + cam%roller*normal)
    contact%radius = radius_of(shrinkage, pitch_curvature)
    contact%undercut = shrinkage <= 0.0_wp
  end subroutine touch_roller

  !> A length over its curvature, infinite where the curvature is zero.
  pure real(wp) function radius_of(length, curvature) result(radius)
    real(wp), intent(in) :: length      !< 1, or a part of it
    real(wp), intent(in) :: curvature   !< [1/m]

    if (abs(curvature) > straight*abs(length)) then
      radius = length/curvature
    else
      radius = sign(ieee_value(1.0_wp, ieee_positive_inf), length)
    end if
  end function radius_of

  !> The point at which a flat face touches.
  pure subroutine touch_face(cam, plan, state, motion, contact, normal)
    type(cam_request_type), intent(in) :: cam               !< the cam and its follower
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism
    type(state_type), intent(in) :: state                   !< with the accelerations of all frames
    type(relative_motion_type), intent(in) :: motion        !< of the given point of the face against the cam
    type(cam_contact_type), intent(inout) :: contact        !< gets the point and its curvature
    real(wp), intent(out) :: normal(3)                      !< unit normal of the face into the cam, in the axes of link 1
    real(wp) :: r(3, 3), p(3), omega(3), v(3), alpha(3), along(3), rate, acceleration, slip, offset_rate

    call link_motion(plan, state, cam%follower, r, p, omega, v)
    call link_turning(plan, state, cam%follower, alpha)
    normal = turn(r, cam%face)
    along = cross(motion%axis, normal)
    contact%tilt = max(abs(dot_product(motion%axis, normal)), &
                       tilt_of(omega - motion%omega, motion%axis, norm2(omega) + norm2(motion%omega)))
    rate = dot_product(omega - motion%omega, motion%axis)
    contact%known = abs(rate) > least_motion*(norm2(omega) + norm2(motion%omega))
    if (.not. contact%known) return
    acceleration = dot_product(alpha - motion%alpha, motion%axis)
    ! the face touches its envelope where the cam's material slips along it only
    slip = dot_product(normal, motion%velocity)
    contact%offset = slip/rate
    offset_rate = (rate*dot_product(along, motion%velocity) + dot_product(normal, motion%acceleration) &
                   - contact%offset*acceleration)/rate
    contact%radius = -(dot_product(along, motion%velocity) + offset_rate)/rate
    contact%undercut = contact%radius <= 0.0_wp
    contact%profile = turn_back(motion%r, motion%place + contact%offset*along - motion%origin)
  end subroutine touch_face

  !> Part of an angular velocity that is not about the axis; 0 where there is only round-off.
  pure real(wp) function tilt_of(omega, axis, scale) result(tilt)
    real(wp), intent(in) :: omega(3)   !< the angular velocity [rad/s]
    real(wp), intent(in) :: axis(3)    !< unit vector
    real(wp), intent(in) :: scale      !< sum of the angular velocities from which it follows [rad/s]

    tilt = 0.0_wp
    if (norm2(omega) > least_motion*scale) tilt = norm2(cross(axis, omega))/norm2(omega)
  end function tilt_of

  !> The pressure angle: between the common normal and the direction in which the guide lets the follower move there. This is, for a
  !> roller, the motion of its centre, and for a flat face that of the point of contact.
  pure subroutine find_pressure(cam, guide, plan, state, place, normal, contact)
    type(cam_request_type), intent(in) :: cam             !< the cam and its follower
    type(pair_axes_type), intent(in) :: guide             !< the pair that guides the follower
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< with the poses of all frames
    real(wp), intent(in) :: place(3)                      !< centre of the roller, or point of contact, in the system of link 1 [m]
    real(wp), intent(in) :: normal(3)                     !< unit normal at the contact, in the axes of link 1
    type(cam_contact_type), intent(inout) :: contact      !< gets the angle
    real(wp) :: r(3, 3), p(3), omega(3), v(3), direction(3)
    integer :: side

    side = merge(1, 2, guide%links(1) == cam%follower)
    call link_motion(plan, state, cam%follower, r, p, omega, v)
    direction = turn(r, guide%axes(:, side))
    if (guide%kind == turning) &
      direction = cross(direction, place - p - turn(r, guide%points(:, side)))
    contact%pressure = atan2(norm2(cross(normal, direction)), abs(dot_product(normal, direction)))
  end subroutine find_pressure
end module mech9_cam_contact
