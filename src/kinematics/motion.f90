!> Velocities and accelerations along the steps of a plan, and of points: (14)-(16) by recursion.
!> Uses kinds, rotation, plan, state, point.
module mech9_motion
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, cross
  use mech9_pose, only: transformed
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_point, only: point_type
  implicit none
  private
  public :: spread_velocities, spread_accelerations, point_motion

contains

  !> Velocities of the frames first .. last from the rates in `state`.
  pure subroutine spread_velocities(plan, first, last, state)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: first, last
    type(state_type), intent(inout) :: state
    integer :: s, i
    real(wp) :: rate, arm(3)

    do s = first, last
      i = plan%steps(s)%parent
      rate = state%dq(plan%steps(s)%coordinate)
      arm = state%p(:, s) - state%p(:, i)
      state%omega(:, s) = state%omega(:, i) + rate*state%axis_w(:, s)
      state%v(:, s) = state%v(:, i) + cross(state%omega(:, i), arm) + rate*state%axis_v(:, s)
    end do
  end subroutine spread_velocities

  !> Accelerations of the frames first .. last from the rates and accelerations in `state`.
  pure subroutine spread_accelerations(plan, first, last, state)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: first, last
    type(state_type), intent(inout) :: state
    integer :: s, i
    real(wp) :: rate, acceleration, arm(3), slip(3), turn(3)

    do s = first, last
      i = plan%steps(s)%parent
      rate = state%dq(plan%steps(s)%coordinate)
      acceleration = state%ddq(plan%steps(s)%coordinate)
      arm = state%p(:, s) - state%p(:, i)
      turn = rate*state%axis_w(:, s)
      slip = rate*state%axis_v(:, s)
      state%alpha(:, s) = state%alpha(:, i) + acceleration*state%axis_w(:, s) + cross(state%omega(:, i), turn)
      state%a(:, s) = state%a(:, i) + cross(state%alpha(:, i), arm) + acceleration*state%axis_v(:, s) &
                      + cross(state%omega(:, i), cross(state%omega(:, i), arm) + 2.0_wp*slip)
      if (.not. plan%steps(s)%is_screw) then
        state%alpha(:, s) = state%alpha(:, s) + rate**2*state%axis_w_rate(:, s)
        state%a(:, s) = state%a(:, s) + rate**2*state%axis_v_rate(:, s)
      end if
    end do
  end subroutine spread_accelerations

  !> Position (14), velocity (15) and acceleration (16) of a point of a link, in the system of link 1.
  pure subroutine point_motion(plan, state, point, position, velocity, acceleration)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    type(point_type), intent(in) :: point
    real(wp), intent(out) :: position(3), velocity(3), acceleration(3)   !< [m], [m/s], [m/s^2]
    real(wp) :: arm(3), in_frame(3)
    integer :: f

    f = plan%frame_of(point%link)
    in_frame = transformed(plan%link_in_frame(point%link), point%position)
    arm = turn(state%r(:, :, f), in_frame)
    position = state%p(:, f) + arm + plan%origin
    velocity = state%v(:, f) + cross(state%omega(:, f), arm)
    acceleration = state%a(:, f) + cross(state%alpha(:, f), arm) &
                   + cross(state%omega(:, f), cross(state%omega(:, f), arm))
  end subroutine point_motion
end module mech9_motion
