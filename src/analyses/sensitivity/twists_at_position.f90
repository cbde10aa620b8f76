!> The twists of steps and constants at one position, with their derivatives in time, in the plane and in space.
module mech9_twists_at_position
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_planar_plan, only: planar_plan_type
  use mech9_state, only: state_type, planar_motion_type
  use mech9_twists, only: frame_twists_type, carried
  use mech9_parameter_support, only: varied_constant_type
  implicit none
  private
  public :: carry_in_plane, planar_step_series, carry_in_space

contains

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_plane(n, constants, motion, highest, again, series)
    integer, intent(in) :: n                                !< number of twists
    type(varied_constant_type), intent(in) :: constants(n)  !< rotation and shifts in twist(1:3), in the axes of the planar frames
    type(planar_motion_type), intent(in) :: motion          !< the motion of the frames
    integer, intent(in) :: highest                          !< order of the highest derivative
    logical, intent(in) :: again                            !< twists of the ground are in `series` already
    real(wp), intent(inout) :: series(3, 0:2, n)            !< gets the twists up to this derivative
    real(wp) :: x, y, w, square, turning
    integer :: i, k

    associate (f => motion%pose, v => motion%velocity, a => motion%acceleration)
      do i = 1, n
        k = constants(i)%frame
        if (again .and. k == 0) cycle
        turning = constants(i)%twist(1)
        x = f(1, k)*constants(i)%twist(2) - f(2, k)*constants(i)%twist(3)
        y = f(2, k)*constants(i)%twist(2) + f(1, k)*constants(i)%twist(3)
        series(1, 0, i) = turning
        series(2, 0, i) = x + turning*f(4, k)
        series(3, 0, i) = y - turning*f(3, k)
        if (highest == 0) cycle
        w = v(1, k)
        square = w**2
        series(2, 1, i) = turning*v(3, k) - w*y
        series(3, 1, i) = w*x - turning*v(2, k)
        series(2, 2, i) = turning*a(3, k) - a(1, k)*y - square*x
        series(3, 2, i) = a(1, k)*x - square*y - turning*a(2, k)
      end do
    end associate
  end subroutine carry_in_plane

  !> The twist of a step per unit rate and its derivatives in time.
  pure subroutine planar_step_series(planar, s, motion, highest, series)
    type(planar_plan_type), intent(in) :: planar         !< the plan in planar arithmetic
    integer, intent(in) :: s                             !< number of the step
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(out) :: series(3, 0:2)              !< rotation, and shift at the origin of frame 0

    series = 0.0_wp
    associate (f => motion%pose, v => motion%velocity, a => motion%acceleration, step => planar%steps(s))
      if (step%turns) then
        series(1, 0) = step%turn
        series(2, 0) = step%turn*f(4, s)
        series(3, 0) = -step%turn*f(3, s)
        if (highest == 0) return
        series(2, 1) = step%turn*v(3, s)
        series(3, 1) = -step%turn*v(2, s)
        series(2, 2) = step%turn*a(3, s)
        series(3, 2) = -step%turn*a(2, s)
      else
        call slide_series(motion%slide(:, s), v(1, step%parent), a(1, step%parent), series(2:3, 0), series(2:3, 1), series(2:3, 2))
      end if
    end associate
  end subroutine planar_step_series

  !> The direction in which a step slides, and its derivatives in time.
  pure subroutine slide_series(slide, w, alpha, shift, first, second)
    real(wp), intent(in) :: slide(2)      !< shift per unit of the coordinate
    real(wp), intent(in) :: w             !< angular velocity of the frame [rad/s]
    real(wp), intent(in) :: alpha         !< its angular acceleration [rad/s^2]
    real(wp), intent(out) :: shift(2)     !< shift per unit of the coordinate
    real(wp), intent(out) :: first(2)     !< its first derivative
    real(wp), intent(out) :: second(2)    !< its second derivative

    shift = slide
    first(1) = -w*slide(2)
    first(2) = w*slide(1)
    second(1) = -alpha*slide(2) - w**2*slide(1)
    second(2) = alpha*slide(1) - w**2*slide(2)
  end subroutine slide_series

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_space(plan, constants, state, twists, highest, again, series)
    type(plan_type), intent(in) :: plan                     !< the plan, in space
    type(varied_constant_type), intent(in) :: constants(:)  !< the twists
    type(state_type), intent(in) :: state                   !< the motion
    type(frame_twists_type), intent(in) :: twists           !< of its frames
    integer, intent(in) :: highest                          !< order of the highest derivative
    logical, intent(in) :: again                            !< twists of the ground are in `series` already
    real(wp), intent(inout), contiguous :: series(:, 0:, :) !< (6,0:2,constants) gets the twists up to this derivative
    real(wp) :: length(0:2)
    integer :: i

    do i = 1, size(constants)
      associate (constant => constants(i))
        if (again .and. constant%frame == 0 .and. constant%stretched_by == 0) cycle
        call carried(state, twists, constant%frame, constant%twist, highest, series(:, :, i))
        if (constant%stretched_by == 0) cycle
        length(0) = state%q(constant%stretched_by) + plan%steps(constant%step)%offset
        length(1) = state%dq(constant%stretched_by)
        length(2) = state%ddq(constant%stretched_by)
        series(:, 2, i) = length(2)*series(:, 0, i) + 2.0_wp*length(1)*series(:, 1, i) + length(0)*series(:, 2, i)
        series(:, 1, i) = length(1)*series(:, 0, i) + length(0)*series(:, 1, i)
        series(:, 0, i) = length(0)*series(:, 0, i)
      end associate
    end do
  end subroutine carry_in_space
end module mech9_twists_at_position
