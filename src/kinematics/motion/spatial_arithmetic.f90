!> Arithmetic in space: poses (10), velocities and accelerations of frames along the steps of a plan, (14)-(16) by recursion.
module mech9_spatial_arithmetic
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_sine_cosine, only: cosines_and_sines
  use mech9_rotation, only: turn, combine, cross, add_small_angle
  use mech9_pose, only: transformed
  use mech9_pair, only: pair_motion_type, reversed_motion
  use mech9_plan, only: plan_type, step_type, arithmetic_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: spatial_arithmetic_type

  !> The arithmetic in space. It has no data.
  type, extends(arithmetic_type) :: spatial_arithmetic_type
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
  end type spatial_arithmetic_type

contains

  !> Room in a state for frames 0 .. m, all in the place of frame 0 and at rest.
  pure subroutine make_frames(m, state)
    integer, intent(in) :: m                   !< number of steps
    type(state_type), intent(inout) :: state   !< gets room for the frames
    integer :: i

    allocate (state%r(3, 3, 0:m), state%p(3, 0:m), source=0.0_wp)
    allocate (state%angle(m), state%turn(2, m), source=0.0_wp)
    state%turn(1, :) = 1.0_wp
    allocate (state%axis_w(3, m), state%axis_v(3, m), source=0.0_wp)
    allocate (state%axis_w_rate(3, m), state%axis_v_rate(3, m), source=0.0_wp)
    allocate (state%omega(3, 0:m), state%v(3, 0:m), state%alpha(3, 0:m), state%a(3, 0:m), source=0.0_wp)
    do i = 1, 3
      state%r(i, i, :) = 1.0_wp
    end do
  end subroutine make_frames

  !> Poses of frames and the screws of their steps, from the coordinates in `state`.
  subroutine place(plan, first, last, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    type(state_type), intent(inout) :: state            !< coordinates in; poses and screws of these frames out
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    integer :: s

    do s = first, last
      state%angle(s) = plan%steps(s)%turn*(state%q(plan%steps(s)%coordinate) + plan%steps(s)%offset)
    end do
    call cosines_and_sines(last - first + 1, state%angle(first:last), state%turn(:, first:last))
    call compose_frames(plan, first, last, state, err)
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
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    integer :: i

    do i = 1, size(changed)
      associate (step => plan%steps(changed(i)))
        if (abs(step%turn) > 0.0_wp) &
          call add_small_angle(step%turn*change(i)*plan%unit_of(step%coordinate), state%turn(:, changed(i)))
      end associate
    end do
    call compose_frames(plan, first, last, state, err)
  end subroutine place_after_change

  !> Poses of frames from the cosines and sines of their steps.
  subroutine compose_frames(plan, first, last, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    type(state_type), intent(inout) :: state            !< coordinates, cosines and sines in; poses and screws of these frames out
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    integer :: s

    s = first
    do
      call place_screws(plan%steps, s, state%turn, state%r, state%p, state%axis_w, state%axis_v)
      if (s > last) return
      call place_user(plan, s, state, err)
      if (allocated(err)) return
      s = s + 1
    end do

  contains

    !> Frames of steps along fixed axes, up to the first step that has none. Each is made by a constant pose, then a turn about z and
    !> a slide along z. All but the last extent of the arrays is known, so that the compiler keeps their addresses in registers.
    pure subroutine place_screws(steps, s, turn, r, p, axis_w, axis_v)
      type(step_type), intent(in) :: steps(*)     !< steps of the plan
      integer, intent(inout) :: s                 !< first step; then the first one that was not placed
      real(wp), intent(in) :: turn(2, *)          !< cosine and sine of the angle of each step
      real(wp), intent(inout) :: r(3, 3, 0:*)     !< rotations of the frames
      real(wp), intent(inout) :: p(3, 0:*)        !< origins of the frames [m]
      real(wp), intent(inout) :: axis_w(3, *)     !< angular velocity per unit rate
      real(wp), intent(inout) :: axis_v(3, *)     !< velocity of the origin per unit rate
      real(wp) :: x(3), y(3), z(3), offset(3)
      integer :: i

      do while (s <= last)
        if (.not. steps(s)%is_screw) return
        i = steps(s)%parent
        ! axes and origin in the parent frame, which are turned by one product each
        z = steps(s)%before%r(:, 3)
        x = turn(1, s)*steps(s)%before%r(:, 1) + turn(2, s)*steps(s)%before%r(:, 2)
        y = turn(1, s)*steps(s)%before%r(:, 2) - turn(2, s)*steps(s)%before%r(:, 1)
        offset = steps(s)%before%p + steps(s)%slide*(state%q(steps(s)%coordinate) + steps(s)%offset)*z
        r(:, 1, s) = r(:, 1, i)*x(1) + r(:, 2, i)*x(2) + r(:, 3, i)*x(3)
        r(:, 2, s) = r(:, 1, i)*y(1) + r(:, 2, i)*y(2) + r(:, 3, i)*y(3)
        r(:, 3, s) = r(:, 1, i)*z(1) + r(:, 2, i)*z(2) + r(:, 3, i)*z(3)
        p(:, s) = p(:, i) + r(:, 1, i)*offset(1) + r(:, 2, i)*offset(2) + r(:, 3, i)*offset(3)
        axis_w(:, s) = steps(s)%turn*r(:, 3, s)
        axis_v(:, s) = steps(s)%slide*r(:, 3, s)
        s = s + 1
      end do
    end subroutine place_screws
  end subroutine compose_frames

  !> The frame of one step through a pair that has no fixed axis.
  subroutine place_user(plan, s, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: s                            !< number of the step
    type(state_type), intent(inout) :: state            !< coordinates in; pose and screw of the new frame out
    type(error_type), allocatable, intent(out) :: err   !< allocated if the pair has no pose
    type(pair_motion_type) :: motion
    real(wp) :: r_departing(3, 3), p_departing(3)

    associate (step => plan%steps(s))
      call plan%pairs(step%coordinate)%pair%evaluate(state%q(step%coordinate), motion, err)
      if (allocated(err)) then
        if (allocated(err%failure)) err%failure%t = state%t
        return
      end if
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

  !> Velocities of frames from the rates in `state`.
  pure subroutine spread_velocities(plan, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    integer, intent(in) :: first               !< frames from this one
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< rates in; velocities of these frames out

    call find_velocities(plan%steps, state%p, state%axis_w, state%axis_v, state%omega, state%v)

  contains

    !> The same from plain arrays as above.
    pure subroutine find_velocities(steps, p, axis_w, axis_v, omega, v)
      type(step_type), intent(in) :: steps(*)    !< steps of the plan
      real(wp), intent(in) :: p(3, 0:*)          !< origins [m]
      real(wp), intent(in) :: axis_w(3, *)       !< angular velocity per unit rate
      real(wp), intent(in) :: axis_v(3, *)       !< velocity of the origin per unit rate
      real(wp), intent(inout) :: omega(3, 0:*)   !< angular velocities [rad/s]
      real(wp), intent(inout) :: v(3, 0:*)       !< velocities of the origins [m/s]
      real(wp) :: rate, arm(3)
      integer :: s, i

      do s = first, last
        i = steps(s)%parent
        rate = state%dq(steps(s)%coordinate)
        arm = p(:, s) - p(:, i)
        omega(:, s) = omega(:, i) + rate*axis_w(:, s)
        v(:, s) = v(:, i) + cross(omega(:, i), arm) + rate*axis_v(:, s)
      end do
    end subroutine find_velocities
  end subroutine spread_velocities

  !> Accelerations of frames from the rates and accelerations in `state`.
  pure subroutine spread_accelerations(plan, first, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    integer, intent(in) :: first               !< frames from this one
    integer, intent(in) :: last                !< to this one
    type(state_type), intent(inout) :: state   !< rates and accelerations in; accelerations of these frames out

    call find_accelerations(plan%steps, state%p, state%axis_w, state%axis_v, state%omega, state%alpha, state%a)

  contains

    !> The same from plain arrays as above.
    pure subroutine find_accelerations(steps, p, axis_w, axis_v, omega, alpha, a)
      type(step_type), intent(in) :: steps(*)     !< steps of the plan
      real(wp), intent(in) :: p(3, 0:*)           !< origins [m]
      real(wp), intent(in) :: axis_w(3, *)        !< angular velocity per unit rate
      real(wp), intent(in) :: axis_v(3, *)        !< velocity of the origin per unit rate
      real(wp), intent(in) :: omega(3, 0:*)       !< angular velocities [rad/s]
      real(wp), intent(inout) :: alpha(3, 0:*)    !< angular accelerations [rad/s^2]
      real(wp), intent(inout) :: a(3, 0:*)        !< accelerations of the origins [m/s^2]
      real(wp) :: rate, acceleration, arm(3), slip(3), turning(3)
      integer :: s, i

      do s = first, last
        i = steps(s)%parent
        rate = state%dq(steps(s)%coordinate)
        acceleration = state%ddq(steps(s)%coordinate)
        arm = p(:, s) - p(:, i)
        turning = rate*axis_w(:, s)
        slip = cross(omega(:, i), arm) + 2.0_wp*rate*axis_v(:, s)
        alpha(:, s) = alpha(:, i) + acceleration*axis_w(:, s) + cross(omega(:, i), turning)
        a(:, s) = a(:, i) + cross(alpha(:, i), arm) + acceleration*axis_v(:, s) + cross(omega(:, i), slip)
        if (steps(s)%is_screw) cycle
        ! only pairs without a fixed axis have such terms
        alpha(:, s) = alpha(:, s) + rate**2*state%axis_w_rate(:, s)
        a(:, s) = a(:, s) + rate**2*state%axis_v_rate(:, s)
      end do
    end subroutine find_accelerations
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
    real(wp) :: arm(3)
    integer :: f

    f = plan%frame_of(link)
    arm = turn(state%r(:, :, f), plan%link_in_frame(link)%p)
    r = combine(state%r(:, :, f), plan%link_in_frame(link)%r)
    p = state%p(:, f) + arm + plan%origin
    omega = state%omega(:, f)
    v = state%v(:, f) + cross(state%omega(:, f), arm)
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
    real(wp) :: arm(3)
    integer :: f

    f = plan%frame_of(link)
    arm = turn(state%r(:, :, f), transformed(plan%link_in_frame(link), place))
    position = state%p(:, f) + arm + plan%origin
    if (present(velocity)) velocity = state%v(:, f) + cross(state%omega(:, f), arm)
    if (present(acceleration)) acceleration = state%a(:, f) + cross(state%alpha(:, f), arm) &
                                              + cross(state%omega(:, f), cross(state%omega(:, f), arm))
  end subroutine point_motion

  !> The angular acceleration of a link, in the axes of link 1.
  pure subroutine link_turning(plan, state, link, alpha)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the accelerations of the frames
    integer, intent(in) :: link             !< number of the link
    real(wp), intent(out) :: alpha(3)       !< angular acceleration [rad/s^2]

    alpha = state%alpha(:, plan%frame_of(link))
  end subroutine link_turning

  !> The screw of a step at its new frame's origin, in the axes of frame 0.
  pure subroutine step_screw(plan, state, s, w, v, place)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the poses of the frames
    integer, intent(in) :: s                !< number of the step
    real(wp), intent(out) :: w(3)           !< angular velocity per unit rate [rad per unit of q]
    real(wp), intent(out) :: v(3)           !< velocity of the new frame's origin per unit rate [m per unit of q]
    real(wp), intent(out) :: place(3)       !< origin of the new frame, from that of frame 0 [m]

    w = state%axis_w(:, s)
    v = state%axis_v(:, s)
    place = state%p(:, s)
  end subroutine step_screw
end module mech9_spatial_arithmetic
