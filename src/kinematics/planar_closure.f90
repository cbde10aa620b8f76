!> Closures in planar arithmetic: three equations each, an angle and two ways in lengths of the mechanism,
!> written at the origin of the loop's base frame, as in space. Uses kinds, planar_plan, planar_motion.
module mech9_planar_closure
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_plan_type, planar_closure_type
  use mech9_planar_motion, only: planar_motion_type
  implicit none
  private
  public :: planar_errors, planar_column, planar_rates, planar_bias_rates, planar_gap, planar_difference

contains

  !> What the closures first .. last lack: (3,closures), angle and way.
  pure subroutine planar_errors(planar, first, last, motion, errors)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: errors(3, first:last)
    real(wp) :: w, x, y
    integer :: c

    do c = first, last
      call find_error(planar%closures(c), motion%pose, w, x, y)
      call move_to_base(planar, planar%closures(c), motion%pose, w, x, y, errors(:, c))
    end do
  end subroutine planar_errors

  !> How far a closure is from closed: a length [m], its angle times the mechanism's size.
  pure real(wp) function planar_gap(planar, c, motion) result(gap)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: c
    type(planar_motion_type), intent(in) :: motion
    real(wp) :: w, x, y

    call find_error(planar%closures(c), motion%pose, w, x, y)
    gap = max(sqrt(x**2 + y**2), planar%length*abs(w))
  end function planar_gap

  !> The angle and the way from the target to the closing frame.
  pure subroutine find_error(closure, f, w, x, y)
    type(planar_closure_type), intent(in) :: closure
    real(wp), intent(in) :: f(:, 0:)             !< poses of the frames
    real(wp), intent(out) :: w, x, y             !< [rad, m]
    real(wp) :: c, s

    associate (i => closure%closing, t => closure%target)
      c = f(1, t)*closure%cosine - f(2, t)*closure%sine
      s = f(2, t)*closure%cosine + f(1, t)*closure%sine
      w = angle_of(c*f(1, i) + s*f(2, i), c*f(2, i) - s*f(1, i))
      x = f(3, i) - f(3, t) - (f(1, t)*closure%place(1) - f(2, t)*closure%place(2))
      y = f(4, i) - f(4, t) - (f(2, t)*closure%place(1) + f(1, t)*closure%place(2))
    end associate
  end subroutine find_error

  !> The angle with this cosine and sine; small ones by the series of the arc sine.
  pure real(wp) function angle_of(c, s) result(angle)
    real(wp), intent(in) :: c, s

    if (c > 0.0_wp .and. abs(s) < 1.0e-2_wp) then
      angle = s*(1.0_wp + s**2*(1.0_wp/6.0_wp + s**2*(3.0_wp/40.0_wp + s**2*(5.0_wp/112.0_wp))))
    else
      angle = atan2(s, c)
    end if
  end function angle_of

  !> Rows of an angle and a way that are given at the origin of a closure's closing frame.
  pure subroutine move_to_base(planar, closure, f, w, x, y, rows)
    type(planar_plan_type), intent(in) :: planar
    type(planar_closure_type), intent(in) :: closure
    real(wp), intent(in) :: f(:, 0:)
    real(wp), intent(in) :: w, x, y
    real(wp), intent(out) :: rows(3)
    real(wp) :: per_length

    per_length = 1.0_wp/planar%length
    associate (b => closure%base, i => closure%closing)
      rows(1) = w
      rows(2) = (x - w*(f(4, b) - f(4, i)))*per_length
      rows(3) = (y + w*(f(3, b) - f(3, i)))*per_length
    end associate
  end subroutine move_to_base

  !> Derivatives of a closure's three equations with respect to the coordinate of a step of its loop, that
  !> coordinate counted in `unit` (with the sign that the step has in the loop).
  pure subroutine planar_column(planar, c, s, unit, motion, column)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: c, s
    real(wp), intent(in) :: unit
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: column(3)
    real(wp) :: w, per_length

    per_length = 1.0_wp/planar%length
    if (planar%steps(s)%turns) then
      w = unit*planar%steps(s)%turn
      associate (f => motion%pose, b => planar%closures(c)%base)
        column(1) = w
        column(2) = -w*(f(4, b) - f(4, s))*per_length
        column(3) = w*(f(3, b) - f(3, s))*per_length
      end associate
    else
      column(1) = 0.0_wp
      column(2) = unit*motion%slide(1, s)*per_length
      column(3) = unit*motion%slide(2, s)*per_length
    end if
  end subroutine planar_column

  !> How fast the closures first .. last open: (3,closures), from velocities of the frames.
  pure subroutine planar_rates(planar, first, last, motion, rates)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: rates(3, first:last)
    integer :: c

    do c = first, last
      associate (closure => planar%closures(c), v => motion%velocity)
        call planar_difference(planar, c, motion, v(:, closure%closing), v(:, closure%target), rates(:, c))
      end associate
    end do
  end subroutine planar_rates

  !> The same from their accelerations.
  pure subroutine planar_bias_rates(planar, first, last, motion, rates)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: rates(3, first:last)
    real(wp) :: closing(3), square
    integer :: c

    do c = first, last
      associate (i => planar%closures(c)%closing, t => planar%closures(c)%target, f => motion%pose, a => motion%acceleration)
        square = motion%velocity(1, t)**2
        closing(1) = a(1, i)
        closing(2) = a(2, i) + square*(f(3, i) - f(3, t))
        closing(3) = a(3, i) + square*(f(4, i) - f(4, t))
        call planar_difference(planar, c, motion, closing, a(:, t), rates(:, c))
      end associate
    end do
  end subroutine planar_bias_rates

  !> Rows of the difference of two velocities: that of the closing frame less what the target gives it.
  pure subroutine planar_difference(planar, c, motion, closing, target, rows)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: c
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(in) :: closing(3), target(3)     !< angular velocity, velocity of the frame's own origin
    real(wp), intent(out) :: rows(3)

    associate (i => planar%closures(c)%closing, t => planar%closures(c)%target, f => motion%pose)
      call move_to_base(planar, planar%closures(c), f, closing(1) - target(1), &
                        closing(2) - target(2) + target(1)*(f(4, i) - f(4, t)), &
                        closing(3) - target(3) - target(1)*(f(3, i) - f(3, t)), rows)
    end associate
  end subroutine planar_difference
end module mech9_planar_closure
