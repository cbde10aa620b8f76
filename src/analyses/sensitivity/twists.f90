!> A twist is a motion of a body: its rotation, and the shift of its point at the origin of frame 0. It has derivatives in time.
module mech9_twists
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, cross
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_variation, only: third_derivatives_type
  implicit none
  private
  public :: bracket, carried, frame_twists_type, new_frame_twists, find_frame_twists, find_step_twists, shift_at

  !> The twists of a motion: velocities and accelerations of frames, and the twist of each step per unit rate with its first two
  !> derivatives in time. Rotation first, then shift, in the axes of frame 0.
  type :: frame_twists_type
    real(wp), allocatable :: velocity(:, :)      !< (6,0:M) of each frame [rad/s, m/s]
    real(wp), allocatable :: acceleration(:, :)  !< (6,0:M) derivative of `velocity` in time [rad/s^2, m/s^2]
    real(wp), allocatable :: step(:, :, :)       !< (6,0:2,M) of each step per unit rate, and its derivatives in time
  end type frame_twists_type

contains

  !> Twists of frames that are all at rest.
  pure function new_frame_twists(m) result(twists)
    integer, intent(in) :: m   !< number of steps
    type(frame_twists_type) :: twists

    allocate (twists%velocity(6, 0:m), twists%acceleration(6, 0:m), twists%step(6, 0:2, m), source=0.0_wp)
  end function new_frame_twists

  !> The derivative in time of a twist b that is fixed in a body which moves with twist a.
  pure function bracket(a, b) result(c)
    real(wp), intent(in) :: a(6)   !< twist of the body
    real(wp), intent(in) :: b(6)   !< the fixed twist
    real(wp) :: c(6)

    ! written out, since it takes most of the time
    c(1) = a(2)*b(3) - a(3)*b(2)
    c(2) = a(3)*b(1) - a(1)*b(3)
    c(3) = a(1)*b(2) - a(2)*b(1)
    c(4) = a(2)*b(6) - a(3)*b(5) + a(5)*b(3) - a(6)*b(2)
    c(5) = a(3)*b(4) - a(1)*b(6) + a(6)*b(1) - a(4)*b(3)
    c(6) = a(1)*b(5) - a(2)*b(4) + a(4)*b(2) - a(5)*b(1)
  end function bracket

  !> A twist that is constant in a frame, seen in frame 0, and its first derivatives in time.
  pure subroutine carried(state, twists, f, twist, highest, series)
    type(state_type), intent(in) :: state           !< with the poses of the frames
    type(frame_twists_type), intent(in) :: twists   !< of the frames
    integer, intent(in) :: f                        !< the frame
    real(wp), intent(in) :: twist(6)                !< in the frame [rad, m]
    integer, intent(in) :: highest                  !< order of the highest derivative
    real(wp), intent(out) :: series(6, 0:2)         !< up to this derivative, then zero

    series(1:3, 0) = turn(state%r(:, :, f), twist(1:3))
    series(4:6, 0) = turn(state%r(:, :, f), twist(4:6)) + cross(state%p(:, f), series(1:3, 0))
    series(:, 1:2) = 0.0_wp
    if (f == 0) return
    if (highest > 0) series(:, 1) = bracket(twists%velocity(:, f), series(:, 0))
    if (highest > 1) series(:, 2) = bracket(twists%acceleration(:, f), series(:, 0)) + bracket(twists%velocity(:, f), series(:, 1))
  end subroutine carried

  !> The shift of a point by a twist.
  pure function shift_at(twist, place) result(shift)
    real(wp), intent(in) :: twist(6)   !< rotation, and shift at the origin
    real(wp), intent(in) :: place(3)   !< the point, from the origin [m]
    real(wp) :: shift(3)

    shift = twist(4:6) + cross(twist(1:3), place)
  end function shift_at

  !> Velocities and accelerations of some frames as twists.
  pure subroutine find_frame_twists(state, frames, highest, twists)
    type(state_type), intent(in) :: state               !< the motion
    integer, intent(in) :: frames(:)                    !< the frames
    integer, intent(in) :: highest                      !< order of the highest derivative
    type(frame_twists_type), intent(inout) :: twists    !< gets the twists of these frames
    integer :: i, s

    if (highest == 0) return
    do i = 1, size(frames)
      s = frames(i)
      associate (p => state%p(:, s), v => state%v(:, s), omega => state%omega(:, s), alpha => state%alpha(:, s))
        twists%velocity(1:3, s) = omega
        twists%velocity(4:6, s) = v - cross(omega, p)
        if (highest == 1) cycle
        twists%acceleration(1:3, s) = alpha
        twists%acceleration(4:6, s) = state%a(:, s) - cross(alpha, p) - cross(omega, v)
      end associate
    end do
  end subroutine find_frame_twists

  !> Twists of some steps per unit rate with their derivatives in time. Those of the frames from which they lead must be known.
  pure subroutine find_step_twists(plan, state, third, steps, highest, twists)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state               !< the motion
    type(third_derivatives_type), intent(in) :: third   !< of the pairs without a fixed axis
    integer, intent(in) :: steps(:)                     !< the steps
    integer, intent(in) :: highest                      !< order of the highest derivative
    type(frame_twists_type), intent(inout) :: twists    !< gets the twists of these steps
    real(wp) :: derivatives(6, 2)
    integer :: j, s, i, k

    do j = 1, size(steps)
      s = steps(j)
      i = plan%steps(s)%parent
      associate (axis => twists%step(:, :, s), frame => twists%velocity(:, i))
        axis(1:3, 1) = state%axis_w(:, s)
        axis(4:6, 1) = state%axis_v(:, s) - cross(state%axis_w(:, s), state%p(:, s))
        if (highest == 0) cycle
        if (i > 0) axis(:, 2) = bracket(frame, axis(:, 1))
        if (i > 0 .and. highest > 1) axis(:, 3) = bracket(twists%acceleration(:, i), axis(:, 1)) + bracket(frame, axis(:, 2))
        if (plan%steps(s)%is_screw) cycle
        k = plan%steps(s)%coordinate
        call axis_derivatives(state, third, s, derivatives)
        if (i == 0) axis(:, 2:3) = 0.0_wp
        axis(:, 3) = axis(:, 3) + 2.0_wp*state%dq(k)*bracket(frame, derivatives(:, 1)) + state%ddq(k)*derivatives(:, 1) &
                     + state%dq(k)**2*derivatives(:, 2)
        axis(:, 2) = axis(:, 2) + state%dq(k)*derivatives(:, 1)
      end associate
    end do
  end subroutine find_step_twists

  !> First and second derivative in its coordinate of the twist of a step without a fixed axis, with the parent frame fixed.
  pure subroutine axis_derivatives(state, third, s, derivatives)
    type(state_type), intent(in) :: state               !< with the derivatives of the pair
    type(third_derivatives_type), intent(in) :: third   !< of the pair
    integer, intent(in) :: s                            !< the step
    real(wp), intent(out) :: derivatives(6, 2)          !< the derivatives

    associate (p => state%p(:, s), w => state%axis_w(:, s), v => state%axis_v(:, s), w_rate => state%axis_w_rate(:, s), &
               v_rate => state%axis_v_rate(:, s))
      derivatives(:, 1) = [w_rate, v_rate - cross(w_rate, p) - cross(w, v)]
      derivatives(:, 2) = [third%w(:, s), third%v(:, s) - cross(third%w(:, s), p) - 2.0_wp*cross(w_rate, v) - cross(w, v_rate)]
    end associate
  end subroutine axis_derivatives
end module mech9_twists
