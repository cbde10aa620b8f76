!> Frames of planar blocks seen in space: the motion in a plane composed with the motion of the plane's base.
!>
!> The poses, velocities and accelerations of these frames are known in their plane, relative to its base. Those that other
!> blocks or the equations of motion read in space are *shown*: composed with the motion of the base and kept in the arrays for
!> space. Points and links are composed where they are asked for.
module mech9_planar_view
  use mech9_kinds, only: wp
  use mech9_rotation, only: combine, cross
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: plane_in_space, show_poses, show_velocities, show_accelerations, seen_velocity, seen_acceleration

contains

  !> The axes of the plane of a frame, in the axes of frame 0; their third is the normal.
  pure function plane_in_space(plan, state, frame) result(axes)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the pose of the plane's base
    integer, intent(in) :: frame            !< number of the frame, of a planar block
    real(wp) :: axes(3, 3)

    if (plan%planar%used) then
      axes = plan%planar%axes
      return
    end if
    associate (plane => plan%planar%planes(plan%planar%plane_of(frame)))
      axes = plane%axes
      if (plane%base > 0) axes = combine(state%r(:, :, plane%base), plane%axes)
    end associate
  end function plane_in_space

  !> Poses of the shown frames first .. last in space, and the screws of their steps, from their poses in the plane.
  pure subroutine show_poses(plan, shown, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(in) :: shown(0:)           !< (0:M) the frames that are shown
    integer, intent(in) :: first               !< frames from this one, of planar blocks
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< planar poses and poses of bases in; poses and screws in space out
    real(wp) :: axes(3, 3)
    integer :: s, plane

    plane = 0
    do s = first, last
      if (.not. shown(s)) cycle
      if (plan%planar%plane_of(s) /= plane) axes = plane_in_space(plan, state, s)
      plane = plan%planar%plane_of(s)
      call show_pose(state%planar%pose(:, s), state%planar%slide(:, s), plan%planar%steps(s)%turns, plan%planar%steps(s)%turn, &
                     plan%planar%height(s), plan%planar%to_planar(:, :, s), axes, state%p(:, plan%planar%planes(plane)%base), &
                     state%r(:, :, s), state%p(:, s), state%axis_w(:, s), state%axis_v(:, s))
    end do
  end subroutine show_poses

  !> Velocities of the shown frames first .. last in space.
  pure subroutine show_velocities(plan, shown, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(in) :: shown(0:)           !< (0:M) the frames that are shown
    integer, intent(in) :: first               !< frames from this one, of planar blocks
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< poses, planar velocities and velocities of bases in; velocities in space out
    real(wp) :: axes(3, 3)
    integer :: s, b, plane

    plane = 0
    do s = first, last
      if (.not. shown(s)) cycle
      if (plan%planar%plane_of(s) /= plane) axes = plane_in_space(plan, state, s)
      plane = plan%planar%plane_of(s)
      b = plan%planar%planes(plane)%base
      call show_velocity(state%planar%velocity(:, s), b > 0, axes, state%p(:, b), state%omega(:, b), state%v(:, b), &
                         state%p(:, s), state%omega(:, s), state%v(:, s))
    end do
  end subroutine show_velocities

  !> Accelerations of the shown frames first .. last in space.
  pure subroutine show_accelerations(plan, shown, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(in) :: shown(0:)           !< (0:M) the frames that are shown
    integer, intent(in) :: first               !< frames from this one, of planar blocks
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< velocities, planar accelerations and those of bases in; accelerations out
    real(wp) :: axes(3, 3)
    integer :: s, b, plane

    plane = 0
    do s = first, last
      if (.not. shown(s)) cycle
      if (plan%planar%plane_of(s) /= plane) axes = plane_in_space(plan, state, s)
      plane = plan%planar%plane_of(s)
      b = plan%planar%planes(plane)%base
      call show_acceleration(state%planar%velocity(:, s), state%planar%acceleration(:, s), b > 0, axes, state%p(:, b), &
                             state%omega(:, b), state%alpha(:, b), state%a(:, b), state%p(:, s), state%alpha(:, s), state%a(:, s))
    end do
  end subroutine show_accelerations

  ! The next three procedures take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> The pose of one frame in space, and the screw of its step.
  pure subroutine show_pose(pose, slide, turns, turn, height, to_planar, axes, p_base, r, p, axis_w, axis_v)
    real(wp), intent(in) :: pose(4)           !< (cosine, sine, x, y) in the plane [m]
    real(wp), intent(in) :: slide(2)          !< velocity of the frame's origin per unit rate, in the plane
    logical, intent(in) :: turns              !< the step turns; else it slides
    real(wp), intent(in) :: turn              !< rotation about the normal per unit of its coordinate
    real(wp), intent(in) :: height            !< above the plane [m]
    real(wp), intent(in) :: to_planar(3, 3)   !< turns components in the frame into those in the planar frame
    real(wp), intent(in) :: axes(3, 3)        !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: p_base(3)         !< origin of the plane [m]
    real(wp), intent(out) :: r(3, 3)          !< rotation of the frame
    real(wp), intent(out) :: p(3)             !< its origin [m]
    real(wp), intent(out) :: axis_w(3)        !< angular velocity per unit rate
    real(wp), intent(out) :: axis_v(3)        !< velocity of the origin per unit rate
    real(wp) :: x(3), y(3)

    x = pose(1)*axes(:, 1) + pose(2)*axes(:, 2)
    y = pose(1)*axes(:, 2) - pose(2)*axes(:, 1)
    p = p_base + pose(3)*axes(:, 1) + pose(4)*axes(:, 2) + height*axes(:, 3)
    if (turns) then
      ! the axis of the step is the normal, in one direction or the other
      r(:, 1) = x
      r(:, 2) = to_planar(2, 2)*y
      r(:, 3) = to_planar(3, 3)*axes(:, 3)
      axis_w = turn*axes(:, 3)
      axis_v = 0.0_wp
    else
      r(:, 1) = x*to_planar(1, 1) + y*to_planar(2, 1) + axes(:, 3)*to_planar(3, 1)
      r(:, 2) = x*to_planar(1, 2) + y*to_planar(2, 2) + axes(:, 3)*to_planar(3, 2)
      r(:, 3) = x*to_planar(1, 3) + y*to_planar(2, 3) + axes(:, 3)*to_planar(3, 3)
      axis_w = 0.0_wp
      axis_v = slide(1)*axes(:, 1) + slide(2)*axes(:, 2)
    end if
  end subroutine show_pose

  !> The velocity of one frame in space.
  pure subroutine show_velocity(velocity, moves, axes, p_base, omega_base, v_base, p, omega, v)
    real(wp), intent(in) :: velocity(3)     !< angular and of the origin, in the plane [rad/s, m/s]
    logical, intent(in) :: moves            !< the base moves
    real(wp), intent(in) :: axes(3, 3)      !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: p_base(3)       !< origin of the base [m]
    real(wp), intent(in) :: omega_base(3)   !< angular velocity of the base [rad/s]
    real(wp), intent(in) :: v_base(3)       !< velocity of its origin [m/s]
    real(wp), intent(in) :: p(3)            !< origin of the frame [m]
    real(wp), intent(out) :: omega(3)       !< angular velocity of the frame [rad/s]
    real(wp), intent(out) :: v(3)           !< velocity of its origin [m/s]

    omega = velocity(1)*axes(:, 3)
    v = velocity(2)*axes(:, 1) + velocity(3)*axes(:, 2)
    if (.not. moves) return
    omega = omega + omega_base
    v = v + v_base + cross(omega_base, p - p_base)
  end subroutine show_velocity

  !> The acceleration of one frame in space.
  pure subroutine show_acceleration(velocity, acceleration, moves, axes, p_base, omega_base, alpha_base, a_base, p, alpha, a)
    real(wp), intent(in) :: velocity(3)       !< angular and of the origin, in the plane [rad/s, m/s]
    real(wp), intent(in) :: acceleration(3)   !< the same [rad/s^2, m/s^2]
    logical, intent(in) :: moves              !< the base moves
    real(wp), intent(in) :: axes(3, 3)        !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: p_base(3)         !< origin of the base [m]
    real(wp), intent(in) :: omega_base(3)     !< angular velocity of the base [rad/s]
    real(wp), intent(in) :: alpha_base(3)     !< angular acceleration of the base [rad/s^2]
    real(wp), intent(in) :: a_base(3)         !< acceleration of its origin [m/s^2]
    real(wp), intent(in) :: p(3)              !< origin of the frame [m]
    real(wp), intent(out) :: alpha(3)         !< angular acceleration of the frame [rad/s^2]
    real(wp), intent(out) :: a(3)             !< acceleration of its origin [m/s^2]
    real(wp) :: arm(3), slip(3)

    alpha = acceleration(1)*axes(:, 3)
    a = acceleration(2)*axes(:, 1) + acceleration(3)*axes(:, 2)
    if (.not. moves) return
    arm = p - p_base
    alpha = alpha + alpha_base + velocity(1)*cross(omega_base, axes(:, 3))
    slip = cross(omega_base, arm) + 2.0_wp*(velocity(2)*axes(:, 1) + velocity(3)*axes(:, 2))
    a = a + a_base + cross(alpha_base, arm) + cross(omega_base, slip)
  end subroutine show_acceleration

  !> The velocity of a point that moves in a plane, in the axes of frame 0 [m/s].
  pure function seen_velocity(state, base, axes, arm, velocity) result(v)
    type(state_type), intent(in) :: state   !< with the velocity of the base
    integer, intent(in) :: base             !< frame in which the plane is fixed
    real(wp), intent(in) :: axes(3, 3)      !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: arm(3)          !< from the plane's origin to the point, in the axes of frame 0 [m]
    real(wp), intent(in) :: velocity(2)     !< relative to the base, in the plane's axes [m/s]
    real(wp) :: v(3), unused(3)

    call show_velocity([0.0_wp, velocity], base > 0, axes, [0.0_wp, 0.0_wp, 0.0_wp], state%omega(:, base), state%v(:, base), arm, &
                       unused, v)
  end function seen_velocity

  !> The acceleration of a point that moves in a plane, in the axes of frame 0 [m/s^2].
  pure function seen_acceleration(state, base, axes, arm, velocity, acceleration) result(a)
    type(state_type), intent(in) :: state     !< with velocity and acceleration of the base
    integer, intent(in) :: base               !< frame in which the plane is fixed
    real(wp), intent(in) :: axes(3, 3)        !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: arm(3)            !< from the plane's origin to the point, in the axes of frame 0 [m]
    real(wp), intent(in) :: velocity(2)       !< relative to the base, in the plane's axes [m/s]
    real(wp), intent(in) :: acceleration(2)   !< relative to the base, in the plane's axes [m/s^2]
    real(wp) :: a(3), unused(3)

    call show_acceleration([0.0_wp, velocity], [0.0_wp, acceleration], base > 0, axes, [0.0_wp, 0.0_wp, 0.0_wp], &
                           state%omega(:, base), state%alpha(:, base), state%a(:, base), arm, unused, a)
  end function seen_acceleration
end module mech9_planar_view
