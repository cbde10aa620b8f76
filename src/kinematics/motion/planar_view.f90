!> Frames of planar blocks seen in space: the motion in a plane composed with the motion of the plane's base.
!>
!> The poses, velocities and accelerations of these frames are known in their plane, relative to its base. Those that other
!> blocks or the equations of motion read in space are *shown*: composed with the motion of the base and kept in the arrays for
!> space. Points and links are composed where they are asked for.
module mech9_planar_view
  use mech9_kinds, only: wp
  use mech9_rotation, only: combine, cross
  use mech9_plan, only: plan_type
  use mech9_planar_plan, only: planar_plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: plane_in_space, show_poses, show_velocities, show_accelerations, seen_velocity, seen_acceleration

  !> A plane in space, and the motion of its base.
  type :: moving_plane_type
    logical :: moves = .false.           !< the base moves
    real(wp) :: axes(3, 3) = 0.0_wp      !< axes of the plane, in those of frame 0
    real(wp) :: p(3) = 0.0_wp            !< origin of the base [m]
    real(wp) :: omega(3) = 0.0_wp        !< angular velocity of the base [rad/s]
    real(wp) :: v(3) = 0.0_wp            !< velocity of its origin [m/s]
    real(wp) :: alpha(3) = 0.0_wp        !< angular acceleration of the base [rad/s^2]
    real(wp) :: a(3) = 0.0_wp            !< acceleration of its origin [m/s^2]
  end type moving_plane_type

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

  !> The plane of a frame, with the motion of its base as far as that is known.
  pure function moving_plane(plan, state, frame) result(plane)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the motion of the plane's base
    integer, intent(in) :: frame            !< number of the frame, of a planar block of a spatial mechanism
    type(moving_plane_type) :: plane

    associate (b => plan%planar%planes(plan%planar%plane_of(frame))%base)
      plane%moves = b > 0
      plane%axes = plane_in_space(plan, state, frame)
      plane%p = state%p(:, b)
      plane%omega = state%omega(:, b)
      plane%v = state%v(:, b)
      plane%alpha = state%alpha(:, b)
      plane%a = state%a(:, b)
    end associate
  end function moving_plane

  !> Poses of the shown frames first .. last in space, and the screws of their steps, from their poses in the plane.
  pure subroutine show_poses(plan, shown, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(in) :: shown(0:)           !< (0:M) the frames that are shown
    integer, intent(in) :: first               !< frames from this one, of planar blocks
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< planar poses and poses of bases in; poses and screws in space out
    type(moving_plane_type) :: plane
    integer :: s, number

    number = 0
    do s = first, last
      if (.not. shown(s)) cycle
      if (plan%planar%plane_of(s) /= number) plane = moving_plane(plan, state, s)
      number = plan%planar%plane_of(s)
      call show_pose(plan%planar, s, plane, state%planar%pose(:, s), state%r(:, :, s), state%p(:, s))
      if (plan%planar%steps(s)%turns) then
        state%axis_w(:, s) = plan%planar%steps(s)%turn*plane%axes(:, 3)
        state%axis_v(:, s) = 0.0_wp
      else
        state%axis_w(:, s) = 0.0_wp
        state%axis_v(:, s) = state%planar%slide(1, s)*plane%axes(:, 1) + state%planar%slide(2, s)*plane%axes(:, 2)
      end if
    end do
  end subroutine show_poses

  !> Velocities of the shown frames first .. last in space.
  pure subroutine show_velocities(plan, shown, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(in) :: shown(0:)           !< (0:M) the frames that are shown
    integer, intent(in) :: first               !< frames from this one, of planar blocks
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< poses, planar velocities and velocities of bases in; velocities in space out
    type(moving_plane_type) :: plane
    integer :: s, number

    number = 0
    do s = first, last
      if (.not. shown(s)) cycle
      if (plan%planar%plane_of(s) /= number) plane = moving_plane(plan, state, s)
      number = plan%planar%plane_of(s)
      call show_velocity(state%planar%velocity(:, s), plane, state%p(:, s), state%omega(:, s), state%v(:, s))
    end do
  end subroutine show_velocities

  !> Accelerations of the shown frames first .. last in space.
  pure subroutine show_accelerations(plan, shown, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(in) :: shown(0:)           !< (0:M) the frames that are shown
    integer, intent(in) :: first               !< frames from this one, of planar blocks
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< velocities, planar accelerations and those of bases in; accelerations out
    type(moving_plane_type) :: plane
    integer :: s, number

    number = 0
    do s = first, last
      if (.not. shown(s)) cycle
      if (plan%planar%plane_of(s) /= number) plane = moving_plane(plan, state, s)
      number = plan%planar%plane_of(s)
      call show_acceleration(state%planar%velocity(:, s), state%planar%acceleration(:, s), plane, state%p(:, s), &
                             state%alpha(:, s), state%a(:, s))
    end do
  end subroutine show_accelerations

  ! The next three procedures take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> The pose of one frame in space.
  pure subroutine show_pose(planar, s, plane, pose, r, p)
    type(planar_plan_type), intent(in) :: planar     !< the plan in planar arithmetic
    integer, intent(in) :: s                         !< number of the frame and its step
    type(moving_plane_type), intent(in) :: plane     !< its plane
    real(wp), intent(in) :: pose(4)                  !< (cosine, sine, x, y) in the plane [m]
    real(wp), intent(out) :: r(3, 3)                 !< rotation of the frame
    real(wp), intent(out) :: p(3)                    !< its origin [m]
    real(wp) :: x(3), y(3)

    associate (axes => plane%axes, to_planar => planar%to_planar(:, :, s))
      x = pose(1)*axes(:, 1) + pose(2)*axes(:, 2)
      y = pose(1)*axes(:, 2) - pose(2)*axes(:, 1)
      p = plane%p + pose(3)*axes(:, 1) + pose(4)*axes(:, 2) + planar%height(s)*axes(:, 3)
      if (planar%steps(s)%turns) then
        ! the axis of the step is the normal, in one direction or the other
        r(:, 1) = x
        r(:, 2) = to_planar(2, 2)*y
        r(:, 3) = to_planar(3, 3)*axes(:, 3)
      else
        r(:, 1) = x*to_planar(1, 1) + y*to_planar(2, 1) + axes(:, 3)*to_planar(3, 1)
        r(:, 2) = x*to_planar(1, 2) + y*to_planar(2, 2) + axes(:, 3)*to_planar(3, 2)
        r(:, 3) = x*to_planar(1, 3) + y*to_planar(2, 3) + axes(:, 3)*to_planar(3, 3)
      end if
    end associate
  end subroutine show_pose

  !> The velocity of one frame in space.
  pure subroutine show_velocity(velocity, plane, p, omega, v)
    real(wp), intent(in) :: velocity(3)              !< angular and of the origin, in the plane [rad/s, m/s]
    type(moving_plane_type), intent(in) :: plane     !< the plane
    real(wp), intent(in) :: p(3)                     !< origin of the frame [m]
    real(wp), intent(out) :: omega(3)                !< angular velocity of the frame [rad/s]
    real(wp), intent(out) :: v(3)                    !< velocity of its origin [m/s]

    omega = velocity(1)*plane%axes(:, 3)
    v = velocity(2)*plane%axes(:, 1) + velocity(3)*plane%axes(:, 2)
    if (.not. plane%moves) return
    omega = omega + plane%omega
    v = v + plane%v + cross(plane%omega, p - plane%p)
  end subroutine show_velocity

  !> The acceleration of one frame in space.
  pure subroutine show_acceleration(velocity, acceleration, plane, p, alpha, a)
    real(wp), intent(in) :: velocity(3)              !< angular and of the origin, in the plane [rad/s, m/s]
    real(wp), intent(in) :: acceleration(3)          !< the same [rad/s^2, m/s^2]
    type(moving_plane_type), intent(in) :: plane     !< the plane
    real(wp), intent(in) :: p(3)                     !< origin of the frame [m]
    real(wp), intent(out) :: alpha(3)                !< angular acceleration of the frame [rad/s^2]
    real(wp), intent(out) :: a(3)                    !< acceleration of its origin [m/s^2]
    real(wp) :: arm(3), slip(3)

    alpha = acceleration(1)*plane%axes(:, 3)
    a = acceleration(2)*plane%axes(:, 1) + acceleration(3)*plane%axes(:, 2)
    if (.not. plane%moves) return
    arm = p - plane%p
    alpha = alpha + plane%alpha + velocity(1)*cross(plane%omega, plane%axes(:, 3))
    slip = cross(plane%omega, arm) + 2.0_wp*(velocity(2)*plane%axes(:, 1) + velocity(3)*plane%axes(:, 2))
    a = a + plane%a + cross(plane%alpha, arm) + cross(plane%omega, slip)
  end subroutine show_acceleration

  !> The velocity of a point that moves in a plane, in the axes of frame 0 [m/s].
  pure function seen_velocity(state, base, axes, arm, velocity) result(v)
    type(state_type), intent(in) :: state   !< with the velocity of the base
    integer, intent(in) :: base             !< frame in which the plane is fixed
    real(wp), intent(in) :: axes(3, 3)      !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: arm(3)          !< from the plane's origin to the point, in the axes of frame 0 [m]
    real(wp), intent(in) :: velocity(2)     !< relative to the base, in the plane's axes [m/s]
    type(moving_plane_type) :: plane
    real(wp) :: v(3), unused(3)

    plane = moving_plane_type(moves=base > 0, axes=axes, omega=state%omega(:, base), v=state%v(:, base))
    call show_velocity([0.0_wp, velocity], plane, arm, unused, v)
  end function seen_velocity

  !> The acceleration of a point that moves in a plane, in the axes of frame 0 [m/s^2].
  pure function seen_acceleration(state, base, axes, arm, velocity, acceleration) result(a)
    type(state_type), intent(in) :: state     !< with velocity and acceleration of the base
    integer, intent(in) :: base               !< frame in which the plane is fixed
    real(wp), intent(in) :: axes(3, 3)        !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: arm(3)            !< from the plane's origin to the point, in the axes of frame 0 [m]
    real(wp), intent(in) :: velocity(2)       !< relative to the base, in the plane's axes [m/s]
    real(wp), intent(in) :: acceleration(2)   !< relative to the base, in the plane's axes [m/s^2]
    type(moving_plane_type) :: plane
    real(wp) :: a(3), unused(3)

    plane = moving_plane_type(moves=base > 0, axes=axes, omega=state%omega(:, base), alpha=state%alpha(:, base), &
                              a=state%a(:, base))
    call show_acceleration([0.0_wp, velocity], [0.0_wp, acceleration], plane, arm, unused, a)
  end function seen_acceleration
end module mech9_planar_view
