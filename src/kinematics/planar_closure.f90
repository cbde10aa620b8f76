!> Closures in planar arithmetic: three equations each, an angle and two ways in lengths of the mechanism,
!> written at the origin of the loop's base frame, as in space. Uses kinds, planar_plan, planar_motion.
module mech9_planar_closure
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_plan_type, planar_closure_type, planar_step_type
  use mech9_planar_motion, only: planar_motion_type
  implicit none
  private
  public :: planar_errors, planar_columns, planar_rates, planar_bias_rates, planar_gap, planar_difference

contains

  !> What the closures first .. last lack: (3,closures), angle and way.
  pure subroutine planar_errors(planar, first, last, motion, errors)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: errors(3, first:last)
    real(wp) :: w, x, y, per_length
    integer :: c

    per_length = 1.0_wp/planar%length
    do c = first, last
      call find_error(planar%closures(c), size(planar%steps), motion%pose, w, x, y)
      call move_to_base(planar%closures(c), per_length, size(planar%steps), motion%pose, w, x, y, errors(:, c))
    end do
  end subroutine planar_errors

  !> How far a closure is from closed: a length [m], its angle times the mechanism's size.
  pure real(wp) function planar_gap(planar, c, motion) result(gap)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: c
    type(planar_motion_type), intent(in) :: motion
    real(wp) :: w, x, y

    call find_error(planar%closures(c), size(planar%steps), motion%pose, w, x, y)
    gap = max(sqrt(x**2 + y**2), planar%length*abs(w))
  end function planar_gap

  ! Arrays of known shape, apart from their types: the compiler then keeps their addresses in registers.

  !> The angle and the way from the target to the closing frame.
  pure subroutine find_error(closure, m, f, w, x, y)
    type(planar_closure_type), intent(in) :: closure
    integer, intent(in) :: m
    real(wp), intent(in) :: f(4, 0:m)            !< poses of the frames
    real(wp), intent(out) :: w, x, y             !< [rad, m]
    real(wp) :: c, s
    integer :: i, t

    i = closure%closing
    t = closure%target
    c = f(1, t)*closure%cosine - f(2, t)*closure%sine
    s = f(2, t)*closure%cosine + f(1, t)*closure%sine
    w = angle_of(c*f(1, i) + s*f(2, i), c*f(2, i) - s*f(1, i))
    x = f(3, i) - f(3, t) - (f(1, t)*closure%place(1) - f(2, t)*closure%place(2))
    y = f(4, i) - f(4, t) - (f(2, t)*closure%place(1) + f(1, t)*closure%place(2))
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
  pure subroutine move_to_base(closure, per_length, m, f, w, x, y, rows)
    type(planar_closure_type), intent(in) :: closure
    real(wp), intent(in) :: per_length
    integer, intent(in) :: m
    real(wp), intent(in) :: f(4, 0:m)
    real(wp), intent(in) :: w, x, y
    real(wp), intent(out) :: rows(3)
    integer :: b, i

    b = closure%base
    i = closure%closing
    rows(1) = w
    rows(2) = (x - w*(f(4, b) - f(4, i)))*per_length
    rows(3) = (y + w*(f(3, b) - f(3, i)))*per_length
  end subroutine move_to_base

  !> Derivatives of a closure's three equations with respect to the coordinates of steps of its loop, each in
  !> its unit (rad, or the mechanism's length): into the columns of the Jacobian from row `row` + 1 on.
  pure subroutine planar_columns(planar, c, n_steps, steps, signs, first, last, column_of, motion, m, n, row, jacobian)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: c
    integer, intent(in) :: n_steps
    integer, intent(in) :: steps(n_steps)
    real(wp), intent(in) :: signs(n_steps)            !< that the steps have in the loop
    integer, intent(in) :: first, last
    integer, intent(in) :: column_of(first:last)      !< column of each of these steps, 0: none
    type(planar_motion_type), intent(in) :: motion
    integer, intent(in) :: m, n, row
    real(wp), intent(inout) :: jacobian(m, n)

    call fill_columns(size(planar%steps), planar%steps, planar%closures(c)%base, 1.0_wp/planar%length, n_steps, steps, &
                      signs, first, last, column_of, motion%pose, motion%slide, m, n, row, jacobian)
  end subroutine planar_columns

  pure subroutine fill_columns(k, flat, base, per_length, n_steps, steps, signs, first, last, column_of, f, slide, &
                               m, n, row, jacobian)
    integer, intent(in) :: k, base, n_steps, first, last, m, n, row
    type(planar_step_type), intent(in) :: flat(k)
    real(wp), intent(in) :: per_length
    integer, intent(in) :: steps(n_steps), column_of(first:last)
    real(wp), intent(in) :: signs(n_steps), f(4, 0:k), slide(2, k)
    real(wp), intent(inout) :: jacobian(m, n)
    real(wp) :: w, x, y
    integer :: i, j, s

    x = f(3, base)
    y = f(4, base)
    do i = 1, n_steps
      s = steps(i)
      if (s < first) cycle
      j = column_of(s)
      if (j == 0) cycle
      if (flat(s)%turns) then
        w = signs(i)*flat(s)%turn
        jacobian(row + 1, j) = w
        w = w*per_length
        jacobian(row + 2, j) = w*(f(4, s) - y)
        jacobian(row + 3, j) = w*(x - f(3, s))
      else
        jacobian(row + 1, j) = 0.0_wp
        jacobian(row + 2, j) = signs(i)*slide(1, s)
        jacobian(row + 3, j) = signs(i)*slide(2, s)
      end if
    end do
  end subroutine fill_columns

  !> How fast the closures first .. last open: (3,closures), from velocities of the frames.
  pure subroutine planar_rates(planar, first, last, motion, rates)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: rates(3, first:last)
    integer :: c

    do c = first, last
      associate (closure => planar%closures(c), v => motion%velocity)
        call find_difference(closure, 1.0_wp/planar%length, size(planar%steps), motion%pose, v(:, closure%closing), &
                             v(:, closure%target), 0.0_wp, rates(:, c))
      end associate
    end do
  end subroutine planar_rates

  !> The same from their accelerations.
  pure subroutine planar_bias_rates(planar, first, last, motion, rates)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: rates(3, first:last)
    integer :: c

    do c = first, last
      associate (closure => planar%closures(c), a => motion%acceleration)
        call find_difference(closure, 1.0_wp/planar%length, size(planar%steps), motion%pose, a(:, closure%closing), &
                             a(:, closure%target), motion%velocity(1, closure%target)**2, rates(:, c))
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

    call find_difference(planar%closures(c), 1.0_wp/planar%length, size(planar%steps), motion%pose, closing, target, &
                         0.0_wp, rows)
  end subroutine planar_difference

  pure subroutine find_difference(closure, per_length, m, f, closing, target, square, rows)
    type(planar_closure_type), intent(in) :: closure
    real(wp), intent(in) :: per_length
    integer, intent(in) :: m
    real(wp), intent(in) :: f(4, 0:m)
    real(wp), intent(in) :: closing(3), target(3)
    real(wp), intent(in) :: square                    !< of the target's angular velocity, between accelerations
    real(wp), intent(out) :: rows(3)
    real(wp) :: x, y

    x = f(3, closure%closing) - f(3, closure%target)
    y = f(4, closure%closing) - f(4, closure%target)
    call move_to_base(closure, per_length, m, f, closing(1) - target(1), closing(2) - target(2) + target(1)*y + square*x, &
                      closing(3) - target(3) - target(1)*x + square*y, rows)
  end subroutine find_difference
end module mech9_planar_closure
