!> Planar arithmetic of the planar blocks of a spatial mechanism: the motion in each plane is that relative to the plane's base,
!> and links, points and screws are composed with the motion of the base where they are asked for.
module mech9_planar_block_arithmetic
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, combine, cross
  use mech9_pose, only: transformed
  use mech9_plan, only: plan_type
  use mech9_planar_formulas, only: turn_in_plane, point_velocity, point_acceleration
  use mech9_planar_arithmetic, only: planar_arithmetic_type
  use mech9_planar_view, only: plane_in_space, seen_velocity, seen_acceleration
  use mech9_state, only: state_type
  implicit none
  private
  public :: planar_block_arithmetic_type

  !> The arithmetic in the planes of planar blocks. It has no data.
  type, extends(planar_arithmetic_type) :: planar_block_arithmetic_type
  contains
    procedure, nopass :: link_motion
    procedure, nopass :: point_motion
    procedure, nopass :: link_turning
    procedure, nopass :: step_screw
  end type planar_block_arithmetic_type

contains

  !> A link's own system and its motion, in the system of link 1.
  pure subroutine link_motion(plan, state, link, r, p, omega, v)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the velocities of the frames
    integer, intent(in) :: link             !< number of the link
    real(wp), intent(out) :: r(3, 3)        !< rotation from the link's axes to those of link 1
    real(wp), intent(out) :: p(3)           !< origin of the link [m]
    real(wp), intent(out) :: omega(3)       !< angular velocity [rad/s]
    real(wp), intent(out) :: v(3)           !< velocity of the origin [m/s]
    real(wp) :: axes(3, 3), turned(3, 3), in_plane(2), arm(3), v_plane(2)
    integer :: i, base

    i = plan%frame_of(link)
    base = plan%planar%planes(plan%planar%plane_of(i))%base
    axes = plane_in_space(plan, state, i)
    associate (f => state%planar%pose(:, i), velocity => state%planar%velocity(:, i), in_frame => plan%planar%link_in_frame(link))
      turned(:, 1) = f(1)*axes(:, 1) + f(2)*axes(:, 2)
      turned(:, 2) = f(1)*axes(:, 2) - f(2)*axes(:, 1)
      turned(:, 3) = axes(:, 3)
      r = combine(turned, in_frame%r)
      call turn_in_plane(f, in_frame%p(1:2), in_plane)
      arm = turn(axes, [f(3:4) + in_plane, in_frame%p(3)])
      p = state%p(:, base) + arm + plan%origin
      omega = state%omega(:, base) + velocity(1)*axes(:, 3)
      call point_velocity(velocity, in_plane, v_plane)
      v = seen_velocity(state, base, axes, arm, v_plane)
    end associate
  end subroutine link_motion

  !> Position (14), velocity (15) and acceleration (16) of a point of a link, in the system of link 1.
  pure subroutine point_motion(plan, state, link, place, position, velocity, acceleration)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
    type(state_type), intent(in) :: state                !< with the motion of the frames
    integer, intent(in) :: link                          !< number of the link
    real(wp), intent(in) :: place(3)                     !< position of the point in the link's own system [m]
    real(wp), intent(out) :: position(3)                 !< in the system of link 1 [m]
    real(wp), intent(out), optional :: velocity(3)       !< in the axes of link 1 [m/s]
    real(wp), intent(out), optional :: acceleration(3)   !< in the axes of link 1 [m/s^2]
    real(wp) :: axes(3, 3), in_frame(3), in_plane(2), arm(3), v_plane(2), a_plane(2)
    integer :: i, base

    i = plan%frame_of(link)
    base = plan%planar%planes(plan%planar%plane_of(i))%base
    axes = plane_in_space(plan, state, i)
    in_frame = transformed(plan%planar%link_in_frame(link), place)
    associate (f => state%planar%pose(:, i), v => state%planar%velocity(:, i), a => state%planar%acceleration(:, i))
      call turn_in_plane(f, in_frame(1:2), in_plane)
      arm = turn(axes, [f(3:4) + in_plane, in_frame(3)])
      position = state%p(:, base) + arm + plan%origin
      call point_velocity(v, in_plane, v_plane)
      if (present(velocity)) velocity = seen_velocity(state, base, axes, arm, v_plane)
      if (.not. present(acceleration)) return
      call point_acceleration(v(1), a, in_plane, a_plane)
      acceleration = seen_acceleration(state, base, axes, arm, v_plane, a_plane)
    end associate
  end subroutine point_motion

  !> The angular acceleration of a link, in the axes of link 1.
  pure subroutine link_turning(plan, state, link, alpha)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the accelerations of the frames
    integer, intent(in) :: link             !< number of the link
    real(wp), intent(out) :: alpha(3)       !< angular acceleration [rad/s^2]
    real(wp) :: axes(3, 3)
    integer :: i, base

    i = plan%frame_of(link)
    base = plan%planar%planes(plan%planar%plane_of(i))%base
    axes = plane_in_space(plan, state, i)
    alpha = state%alpha(:, base) + state%planar%acceleration(1, i)*axes(:, 3) &
            + state%planar%velocity(1, i)*cross(state%omega(:, base), axes(:, 3))
  end subroutine link_turning

  !> The screw of a step at its new frame's origin, in the axes of frame 0.
  pure subroutine step_screw(plan, state, s, w, v, place)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the poses of the frames
    integer, intent(in) :: s                !< number of the step
    real(wp), intent(out) :: w(3)           !< angular velocity per unit rate [rad per unit of q]
    real(wp), intent(out) :: v(3)           !< velocity of the new frame's origin per unit rate [m per unit of q]
    real(wp), intent(out) :: place(3)       !< origin of the new frame, from that of frame 0 [m]
    real(wp) :: axes(3, 3)

    axes = plane_in_space(plan, state, s)
    associate (planar => plan%planar, pose => state%planar%pose(:, s), slide => state%planar%slide(:, s))
      w = planar%steps(s)%turn*axes(:, 3)
      v = slide(1)*axes(:, 1) + slide(2)*axes(:, 2)
      place = state%p(:, planar%planes(planar%plane_of(s))%base) + turn(axes, [pose(3), pose(4), planar%height(s)])
    end associate
  end subroutine step_screw
end module mech9_planar_block_arithmetic
