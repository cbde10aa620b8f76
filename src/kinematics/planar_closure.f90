!> Closures in planar arithmetic: three equations each, an angle and two ways in lengths of the mechanism,
!> written at the origin of the loop's base frame, as in space. Uses kinds, planar_plan, planar_motion.
module mech9_planar_closure
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_plan_type, planar_closure_type, planar_step_type
  use mech9_planar_motion, only: planar_motion_type
  implicit none
  private
  public :: planar_errors, planar_columns, planar_path_rates, planar_path_bias, planar_bias_rates, planar_gap, planar_difference
  public :: move_to_base, stem_difference

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

  !> How fast a closure opens, from the rates of the coordinates on its path and the velocities of the frames
  !> where that begins.
  pure subroutine planar_path_rates(planar, c, n_steps, steps, signs, stems, dq, motion, rates)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: c
    integer, intent(in) :: n_steps
    integer, intent(in) :: steps(n_steps)
    real(wp), intent(in) :: signs(n_steps)
    integer, intent(in) :: stems(2)
    real(wp), intent(in), contiguous :: dq(:)         !< (M)
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: rates(3)

    call sum_velocities(planar%closures(c), 1.0_wp/planar%length, size(planar%steps), planar%steps, n_steps, steps, &
                        signs, stems, dq, motion%pose, motion%slide, motion%velocity, rates)
  end subroutine planar_path_rates

  !> The same of accelerations; of all frames of the path velocities must be known.
  pure subroutine planar_path_bias(planar, c, n_steps, steps, signs, stems, dq, ddq, motion, rates)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: c
    integer, intent(in) :: n_steps
    integer, intent(in) :: steps(n_steps)
    real(wp), intent(in) :: signs(n_steps)
    integer, intent(in) :: stems(2)
    real(wp), intent(in), contiguous :: dq(:), ddq(:)  !< (M)
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: rates(3)

    call sum_accelerations(planar%closures(c), 1.0_wp/planar%length, size(planar%steps), planar%steps, n_steps, steps, &
                           signs, stems, dq, ddq, motion%pose, motion%slide, motion%velocity, motion%acceleration, rates)
  end subroutine planar_path_bias

  !> How fast the closures first .. last open: (3,closures), from the accelerations of their frames.
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

  pure subroutine sum_velocities(closure, per_length, m, flat, n_steps, steps, signs, stems, dq, f, slide, v, rows)
    type(planar_closure_type), intent(in) :: closure
    real(wp), intent(in) :: per_length
    integer, intent(in) :: m, n_steps
    type(planar_step_type), intent(in) :: flat(m)
    integer, intent(in) :: steps(n_steps), stems(2)
    real(wp), intent(in) :: signs(n_steps), dq(m), f(4, 0:m), slide(2, m), v(3, 0:m)
    real(wp), intent(out) :: rows(3)
    real(wp) :: w, x, y, place(2), rate
    integer :: i, s

    place = f(3:4, closure%closing)
    call stem_difference(m, stems, place, f, v, w, x, y)
    do i = 1, n_steps
      s = steps(i)
      rate = signs(i)*dq(flat(s)%coordinate)
      if (.not. abs(rate) > 0.0_wp) cycle
      if (flat(s)%turns) then
        rate = rate*flat(s)%turn
        w = w + rate
        x = x - rate*(place(2) - f(4, s))
        y = y + rate*(place(1) - f(3, s))
      else
        x = x + rate*slide(1, s)
        y = y + rate*slide(2, s)
      end if
    end do
    call move_to_base(closure, per_length, m, f, w, x, y, rows)
  end subroutine sum_velocities

  pure subroutine sum_accelerations(closure, per_length, m, flat, n_steps, steps, signs, stems, dq, ddq, f, slide, v, a, rows)
    type(planar_closure_type), intent(in) :: closure
    real(wp), intent(in) :: per_length
    integer, intent(in) :: m, n_steps
    type(planar_step_type), intent(in) :: flat(m)
    integer, intent(in) :: steps(n_steps), stems(2)
    real(wp), intent(in) :: signs(n_steps), dq(m), ddq(m), f(4, 0:m), slide(2, m), v(3, 0:m), a(3, 0:m)
    real(wp), intent(out) :: rows(3)
    real(wp) :: w, x, y, place(2), square, coriolis, angular
    integer :: i, s, p

    place = f(3:4, closure%closing)
    call stem_difference(m, stems, place, f, a, w, x, y)
    do i = 1, n_steps
      s = steps(i)
      p = flat(s)%parent
      square = signs(i)*v(1, p)**2
      angular = signs(i)*ddq(flat(s)%coordinate)
      x = x - square*(f(3, s) - f(3, p))
      y = y - square*(f(4, s) - f(4, p))
      if (flat(s)%turns) then
        angular = angular*flat(s)%turn
        w = w + angular
        x = x - angular*(place(2) - f(4, s))
        y = y + angular*(place(1) - f(3, s))
      else
        coriolis = 2.0_wp*signs(i)*v(1, p)*dq(flat(s)%coordinate)
        x = x + angular*slide(1, s) - coriolis*slide(2, s)
        y = y + angular*slide(2, s) + coriolis*slide(1, s)
      end if
    end do
    s = closure%target
    square = v(1, s)**2
    x = x + square*(place(1) - f(3, s))
    y = y + square*(place(2) - f(4, s))
    call move_to_base(closure, per_length, m, f, w, x, y, rows)
  end subroutine sum_accelerations

  !> What two frames would carry past each other at a place: the difference of their velocities, or of
  !> accelerations without those of turning on.
  pure subroutine stem_difference(m, stems, place, f, v, w, x, y)
    integer, intent(in) :: m, stems(2)
    real(wp), intent(in) :: place(2), f(4, 0:m), v(3, 0:m)
    real(wp), intent(out) :: w, x, y
    integer :: i, k

    w = 0.0_wp
    x = 0.0_wp
    y = 0.0_wp
    i = stems(1)
    k = stems(2)
    if (i == k) return
    w = v(1, i) - v(1, k)
    x = v(2, i) - v(1, i)*(place(2) - f(4, i)) - v(2, k) + v(1, k)*(place(2) - f(4, k))
    y = v(3, i) + v(1, i)*(place(1) - f(3, i)) - v(3, k) - v(1, k)*(place(1) - f(3, k))
  end subroutine stem_difference

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
