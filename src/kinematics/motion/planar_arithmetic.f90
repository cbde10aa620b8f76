!> Planar arithmetic: poses, velocities and accelerations of frames that keep one normal, and their conversion to space.
module mech9_planar_arithmetic
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_pose, only: transformed
  use mech9_plan, only: plan_type, arithmetic_type
  use mech9_planar_formulas, only: turn_in_plane, point_velocity, point_acceleration
  use mech9_planar_motion, only: new_planar_motion, place_in_plane, change_in_plane, planar_velocities, planar_accelerations, &
    to_space
  use mech9_state, only: state_type
  implicit none
  private
  public :: planar_arithmetic_type

  !> The arithmetic in the plane. It has no data.
  type, extends(arithmetic_type) :: planar_arithmetic_type
  contains
    procedure, nopass :: make_frames
    procedure, nopass :: place
    procedure, nopass :: place_after_change
    procedure, nopass :: spread_velocities
    procedure, nopass :: spread_accelerations
    procedure, nopass :: link_motion
    procedure, nopass :: point_motion
    procedure, nopass :: link_turning
    procedure, nopass :: step_screw
  end type planar_arithmetic_type

contains

  !> Room in a state for frames 0 .. m, all in the place of frame 0 and at rest.
  pure subroutine make_frames(m, state)
    integer, intent(in) :: m                   !< number of steps
    type(state_type), intent(inout) :: state   !< gets room for the frames

    state%planar = new_planar_motion(m)
  end subroutine make_frames

  !> Poses of frames and the directions in which their steps slide, from the coordinates in `state`.
  subroutine place(plan, first, last, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    type(state_type), intent(inout) :: state            !< coordinates in; poses and screws of these frames out
    type(error_type), allocatable, intent(out) :: err   !< never allocated: user pairs are not planar

    call place_in_plane(plan%planar, first, last, state%q, state%planar)
  end subroutine place

  !> Poses of frames after a small change of the coordinates of some steps. The cosines and sines of their angles are corrected
  !> to second order and not computed anew.
  subroutine place_after_change(plan, first, last, changed, change, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    integer, intent(in) :: changed(:)                   !< steps whose coordinates have changed
    real(wp), intent(in) :: change(:)                   !< changes of their coordinates, in units of these
    type(state_type), intent(inout) :: state            !< changed coordinates in; poses and screws of these frames out
    type(error_type), allocatable, intent(out) :: err   !< never allocated: user pairs are not planar

    call change_in_plane(plan%planar, first, last, changed, change, state%q, state%planar)
  end subroutine place_after_change

  !> Velocities of frames from the rates in `state`.
  pure subroutine spread_velocities(plan, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    integer, intent(in) :: first               !< frames from this one
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< rates in; velocities of these frames out

    call planar_velocities(plan%planar, first, last, state%dq, state%planar)
  end subroutine spread_velocities

  !> Accelerations of frames from the rates and accelerations in `state`.
  pure subroutine spread_accelerations(plan, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    integer, intent(in) :: first               !< frames from this one
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< rates and accelerations in; accelerations of these frames out

    call planar_accelerations(plan%planar, first, last, state%dq, state%ddq, state%planar)
  end subroutine spread_accelerations

  !> A link's own system and its motion, in the system of link 1.
  pure subroutine link_motion(plan, state, link, r, p, omega, v)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the velocities of the frames
    integer, intent(in) :: link             !< number of the link
    real(wp), intent(out) :: r(3, 3)        !< rotation from the link's axes to those of link 1
    real(wp), intent(out) :: p(3)           !< origin of the link [m]
    real(wp), intent(out) :: omega(3)       !< angular velocity [rad/s]
    real(wp), intent(out) :: v(3)           !< velocity of the origin [m/s]
    real(wp) :: arm(2), turned(2), moved(2)
    integer :: i, j

    i = plan%frame_of(link)
    associate (f => state%planar%pose(:, i), velocity => state%planar%velocity(:, i), in_frame => plan%planar%link_in_frame(link))
      do j = 1, 3
        call turn_in_plane(f, in_frame%r(1:2, j), turned)
        r(:, j) = to_space(plan%planar, turned(1), turned(2), in_frame%r(3, j))
      end do
      call turn_in_plane(f, in_frame%p(1:2), arm)
      p = to_space(plan%planar, f(3) + arm(1), f(4) + arm(2), in_frame%p(3)) + plan%origin
      omega = to_space(plan%planar, 0.0_wp, 0.0_wp, velocity(1))
      call point_velocity(velocity, arm, moved)
      v = to_space(plan%planar, moved(1), moved(2), 0.0_wp)
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
    real(wp) :: in_frame(3), arm(2), moved(2)
    integer :: i

    i = plan%frame_of(link)
    in_frame = transformed(plan%planar%link_in_frame(link), place)
    associate (f => state%planar%pose(:, i), v => state%planar%velocity(:, i), a => state%planar%acceleration(:, i))
      call turn_in_plane(f, in_frame(1:2), arm)
      position = to_space(plan%planar, f(3) + arm(1), f(4) + arm(2), in_frame(3)) + plan%origin
      if (present(velocity)) then
        call point_velocity(v, arm, moved)
        velocity = to_space(plan%planar, moved(1), moved(2), 0.0_wp)
      end if
      if (present(acceleration)) then
        call point_acceleration(v(1), a, arm, moved)
        acceleration = to_space(plan%planar, moved(1), moved(2), 0.0_wp)
      end if
    end associate
  end subroutine point_motion

  !> The angular acceleration of a link, in the axes of link 1.
  pure subroutine link_turning(plan, state, link, alpha)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the accelerations of the frames
    integer, intent(in) :: link             !< number of the link
    real(wp), intent(out) :: alpha(3)       !< angular acceleration [rad/s^2]

    alpha = to_space(plan%planar, 0.0_wp, 0.0_wp, state%planar%acceleration(1, plan%frame_of(link)))
  end subroutine link_turning

  !> The screw of a step at its new frame's origin, in the axes of frame 0.
  pure subroutine step_screw(plan, state, s, w, v, place)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the poses of the frames
    integer, intent(in) :: s                !< number of the step
    real(wp), intent(out) :: w(3)           !< angular velocity per unit rate [rad per unit of q]
    real(wp), intent(out) :: v(3)           !< velocity of the new frame's origin per unit rate [m per unit of q]
    real(wp), intent(out) :: place(3)       !< origin of the new frame, from that of frame 0 [m]

    associate (planar => plan%planar, pose => state%planar%pose(:, s), slide => state%planar%slide(:, s))
      w = to_space(planar, 0.0_wp, 0.0_wp, planar%steps(s)%turn)
      v = to_space(planar, slide(1), slide(2), 0.0_wp)
      place = to_space(planar, pose(3), pose(4), planar%height(s))
    end associate
  end subroutine step_screw
end module mech9_planar_arithmetic
