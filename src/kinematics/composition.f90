!> Composition of poses along the steps of a plan, (10), with the screws of the pairs on the way.
!> Uses kinds, error, sine_cosine, rotation, pose, pair, plan, state, planar_motion.
module mech9_composition
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_sine_cosine, only: cosines_and_sines
  use mech9_rotation, only: turn, combine, cross, turn_on
  use mech9_pair, only: pair_motion_type
  use mech9_pose, only: inverse
  use mech9_plan, only: plan_type, step_type
  use mech9_state, only: state_type
  use mech9_planar_motion, only: place_in_plane, nudge_in_plane
  implicit none
  private
  public :: place_frames, nudge_frames, reversed_motion

contains

  !> Poses of the frames first .. last and the screws of their steps, from the coordinates in `state`.
  !> The frames they start from must be in place. Fails only where a user pair has no pose.
  subroutine place_frames(plan, first, last, state, err)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: first, last
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: err
    integer :: s

    if (plan%planar%used) then
      call place_in_plane(plan%planar, first, last, state%q, state%planar)
      return
    end if
    do s = first, last
      state%angle(s) = plan%steps(s)%turn*(state%q(plan%steps(s)%coordinate) + plan%steps(s)%offset)
    end do
    call cosines_and_sines(last - first + 1, state%angle(first:last), state%turn(:, first:last))
    call compose_frames(plan, first, last, state, err)
  end subroutine place_frames

  !> The same after a small change of the coordinates of some steps: their angles are turned on, not computed anew.
  subroutine nudge_frames(plan, first, last, changed, change, state, err)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: first, last
    integer, intent(in) :: changed(:)           !< steps
    real(wp), intent(in) :: change(:)           !< of their coordinates, in units of these
    type(state_type), intent(inout) :: state    !< its coordinates are changed already
    type(error_type), allocatable, intent(out) :: err
    integer :: i

    if (plan%planar%used) then
      call nudge_in_plane(plan%planar, first, last, changed, change, state%q, state%planar)
      return
    end if
    do i = 1, size(changed)
      associate (step => plan%steps(changed(i)))
        if (abs(step%turn) > 0.0_wp) &
          call turn_on(step%turn*change(i)*plan%unit_of(step%coordinate), state%turn(:, changed(i)))
      end associate
    end do
    call compose_frames(plan, first, last, state, err)
  end subroutine nudge_frames

  !> Poses of frames from the angles of their steps.
  subroutine compose_frames(plan, first, last, state, err)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: first, last
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: err
    integer :: s

    do s = first, last
      if (plan%steps(s)%is_screw) then
        call place_screw(plan%steps(s), state%q(plan%steps(s)%coordinate), state%turn(1, s), state%turn(2, s), &
                         state%r(:, :, plan%steps(s)%parent), state%p(:, plan%steps(s)%parent), &
                         state%r(:, :, s), state%p(:, s), state%axis_w(:, s), state%axis_v(:, s))
      else
        call place_user(plan, s, state, err)
        if (allocated(err)) return
      end if
    end do
  end subroutine compose_frames

  !> One step along a fixed axis: constant pose, then turn about and slide along z.
  pure subroutine place_screw(step, q, c, s, r_parent, p_parent, r, p, axis_w, axis_v)
    type(step_type), intent(in) :: step
    real(wp), intent(in) :: q
    real(wp), intent(in) :: c, s              !< cosine and sine of its turn
    real(wp), intent(in) :: r_parent(3, 3), p_parent(3)
    real(wp), intent(out) :: r(3, 3), p(3), axis_w(3), axis_v(3)
    real(wp) :: advance, ex(3), ey(3), ez(3)
    integer :: i

    advance = step%slide*(q + step%offset)
    do i = 1, 3
      ex(i) = r_parent(i, 1)*step%before%r(1, 1) + r_parent(i, 2)*step%before%r(2, 1) + r_parent(i, 3)*step%before%r(3, 1)
      ey(i) = r_parent(i, 1)*step%before%r(1, 2) + r_parent(i, 2)*step%before%r(2, 2) + r_parent(i, 3)*step%before%r(3, 2)
      ez(i) = r_parent(i, 1)*step%before%r(1, 3) + r_parent(i, 2)*step%before%r(2, 3) + r_parent(i, 3)*step%before%r(3, 3)
      p(i) = p_parent(i) + r_parent(i, 1)*step%before%p(1) + r_parent(i, 2)*step%before%p(2) &
             + r_parent(i, 3)*step%before%p(3) + advance*ez(i)
    end do
    r(:, 1) = c*ex + s*ey
    r(:, 2) = c*ey - s*ex
    r(:, 3) = ez
    axis_w = step%turn*ez
    axis_v = step%slide*ez
  end subroutine place_screw

  !> One step through a pair that has no fixed axis.
  subroutine place_user(plan, s, state, err)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: s
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: err
    type(pair_motion_type) :: motion
    real(wp) :: r_departing(3, 3), p_departing(3)

    associate (step => plan%steps(s))
      call plan%pairs(step%coordinate)%pair%evaluate(state%q(step%coordinate), motion, err)
      if (allocated(err)) return
      if (step%reversed) motion = reversed_motion(motion)
      r_departing = combine(state%r(:, :, step%parent), step%before%r)
      p_departing = state%p(:, step%parent) + turn(state%r(:, :, step%parent), step%before%p)
    end associate
    state%r(:, :, s) = combine(r_departing, motion%pose%r)
    state%p(:, s) = p_departing + turn(r_departing, motion%pose%p)
    state%axis_w(:, s) = turn(r_departing, motion%w)
    state%axis_v(:, s) = turn(r_departing, motion%v)
    state%axis_w_rate(:, s) = turn(r_departing, motion%w_rate)
    state%axis_v_rate(:, s) = turn(r_departing, motion%v_rate)
  end subroutine place_user

  !> The motion of the reference link in the moving link, from that of the moving in the reference link.
  pure function reversed_motion(motion) result(back)
    type(pair_motion_type), intent(in) :: motion
    type(pair_motion_type) :: back
    real(wp) :: g(3), r_back(3, 3)

    r_back = transpose(motion%pose%r)
    back%pose = inverse(motion%pose)
    g = motion%v - cross(motion%w, motion%pose%p)
    back%w = -turn(r_back, motion%w)
    back%v = -turn(r_back, g)
    back%w_rate = -turn(r_back, motion%w_rate)
    back%v_rate = turn(r_back, cross(motion%w, g) + cross(motion%w, motion%v) &
                         + cross(motion%w_rate, motion%pose%p) - motion%v_rate)
  end function reversed_motion
end module mech9_composition
