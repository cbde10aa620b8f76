!> Velocities and accelerations along the steps of a plan, of links and of points: (14)-(16) by recursion.
!> Uses kinds, rotation, pose, plan, state, planar_motion, point.
module mech9_motion
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, combine, cross
  use mech9_pose, only: transformed
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planar_motion, only: planar_velocities, planar_accelerations, to_space
  use mech9_point, only: point_type
  implicit none
  private
  public :: spread_velocities, spread_accelerations, link_motion, point_motion, step_screw

contains

  !> Velocities of the frames first .. last from the rates in `state`.
  pure subroutine spread_velocities(plan, first, last, state)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: first, last
    type(state_type), intent(inout) :: state
    integer :: s, i
    real(wp) :: rate, arm(3)

    if (plan%planar%used) then
      call planar_velocities(plan%planar, first, last, state%dq, state%planar)
      return
    end if
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

    if (plan%planar%used) then
      call planar_accelerations(plan%planar, first, last, state%dq, state%ddq, state%planar)
      return
    end if
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

  !> Position (14), velocity (15) and acceleration (16) of a point of a link, in the system of link 1; those that are
  !> asked for must be known of the state.
  pure subroutine point_motion(plan, state, point, position, velocity, acceleration)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    type(point_type), intent(in) :: point
    real(wp), intent(out) :: position(3)                                  !< [m]
    real(wp), intent(out), optional :: velocity(3), acceleration(3)       !< [m/s], [m/s^2]
    real(wp) :: arm(3), in_frame(3)
    integer :: f

    if (plan%planar%used) then
      call planar_point_motion(plan, state, point, position, velocity, acceleration)
      return
    end if
    f = plan%frame_of(point%link)
    in_frame = transformed(plan%link_in_frame(point%link), point%position)
    arm = turn(state%r(:, :, f), in_frame)
    position = state%p(:, f) + arm + plan%origin
    if (present(velocity)) velocity = state%v(:, f) + cross(state%omega(:, f), arm)
    if (present(acceleration)) acceleration = state%a(:, f) + cross(state%alpha(:, f), arm) &
                                              + cross(state%omega(:, f), cross(state%omega(:, f), arm))
  end subroutine point_motion

  !> The same in planar arithmetic.
  pure subroutine planar_point_motion(plan, state, point, position, velocity, acceleration)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    type(point_type), intent(in) :: point
    real(wp), intent(out) :: position(3)
    real(wp), intent(out), optional :: velocity(3), acceleration(3)
    real(wp) :: in_frame(3), x, y
    integer :: i

    i = plan%frame_of(point%link)
    in_frame = transformed(plan%planar%link_in_frame(point%link), point%position)
    associate (f => state%planar%pose(:, i), v => state%planar%velocity(:, i), a => state%planar%acceleration(:, i))
      x = f(1)*in_frame(1) - f(2)*in_frame(2)
      y = f(2)*in_frame(1) + f(1)*in_frame(2)
      position = to_space(plan%planar, f(3) + x, f(4) + y, in_frame(3)) + plan%origin
      if (present(velocity)) velocity = to_space(plan%planar, v(2) - v(1)*y, v(3) + v(1)*x, 0.0_wp)
      if (present(acceleration)) &
        acceleration = to_space(plan%planar, a(2) - a(1)*y - v(1)**2*x, a(3) + a(1)*x - v(1)**2*y, 0.0_wp)
    end associate
  end subroutine planar_point_motion

  !> A link's own system, its angular velocity and the velocity of its origin, in the system of link 1.
  pure subroutine link_motion(plan, state, link, r, p, omega, v)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    integer, intent(in) :: link
    real(wp), intent(out) :: r(3, 3), p(3)            !< rotation; origin [m]
    real(wp), intent(out) :: omega(3), v(3)           !< [rad/s], [m/s]
    real(wp) :: arm(3)
    integer :: f, j

    f = plan%frame_of(link)
    if (plan%planar%used) then
      associate (pose => state%planar%pose, velocity => state%planar%velocity, in_frame => plan%planar%link_in_frame(link))
        do j = 1, 3
          r(:, j) = to_space(plan%planar, pose(1, f)*in_frame%r(1, j) - pose(2, f)*in_frame%r(2, j), &
                             pose(2, f)*in_frame%r(1, j) + pose(1, f)*in_frame%r(2, j), in_frame%r(3, j))
        end do
        arm(1) = pose(1, f)*in_frame%p(1) - pose(2, f)*in_frame%p(2)
        arm(2) = pose(2, f)*in_frame%p(1) + pose(1, f)*in_frame%p(2)
        p = to_space(plan%planar, pose(3, f) + arm(1), pose(4, f) + arm(2), in_frame%p(3)) + plan%origin
        omega = to_space(plan%planar, 0.0_wp, 0.0_wp, velocity(1, f))
        v = to_space(plan%planar, velocity(2, f) - velocity(1, f)*arm(2), velocity(3, f) + velocity(1, f)*arm(1), 0.0_wp)
      end associate
    else
      arm = turn(state%r(:, :, f), plan%link_in_frame(link)%p)
      r = combine(state%r(:, :, f), plan%link_in_frame(link)%r)
      p = state%p(:, f) + arm + plan%origin
      omega = state%omega(:, f)
      v = state%v(:, f) + cross(state%omega(:, f), arm)
    end if
  end subroutine link_motion

  !> What a step gives per unit rate: the angular velocity and the velocity of the new frame's origin, and where
  !> that is; in the axes of frame 0, from its origin.
  pure subroutine step_screw(plan, state, s, w, v, place)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    integer, intent(in) :: s
    real(wp), intent(out) :: w(3), v(3), place(3)

    if (plan%planar%used) then
      associate (planar => plan%planar, pose => state%planar%pose(:, s), slide => state%planar%slide(:, s))
        w = to_space(planar, 0.0_wp, 0.0_wp, planar%steps(s)%turn)
        v = to_space(planar, slide(1), slide(2), 0.0_wp)
        place = to_space(planar, pose(3), pose(4), planar%height(s))
      end associate
    else
      w = state%axis_w(:, s)
      v = state%axis_v(:, s)
      place = state%p(:, s)
    end if
  end subroutine step_screw
end module mech9_motion
