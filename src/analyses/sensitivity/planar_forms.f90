!> Columns of the openings of chains and of the shifts of points in planar arithmetic, with their derivatives in time.
!>
!> A twist in the plane is three numbers: the rotation about the normal, and the shift of the point at the origin of frame 0.
module mech9_planar_forms
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_plan_type, planar_step_type
  use mech9_state, only: planar_motion_type
  use mech9_planar_formulas, only: turn_in_plane, point_velocity, point_acceleration
  use mech9_parameter_support, only: varied_constant_type
  use mech9_linear_form, only: linear_form_type, put_constant
  implicit none
  private
  public :: carry_in_plane, fill_planar_closure, fill_planar_point, planar_step_series

contains

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_plane(n, constants, motion, highest, again, series)
    integer, intent(in) :: n                                !< number of twists
    type(varied_constant_type), intent(in) :: constants(n)  !< rotation and shifts in twist(1:3), in the axes of the planar frames
    type(planar_motion_type), intent(in) :: motion          !< the motion of the frames
    integer, intent(in) :: highest                          !< order of the highest derivative
    logical, intent(in) :: again                            !< twists of the ground are in `series` already
    real(wp), intent(inout) :: series(3, 0:2, n)            !< gets the twists up to this derivative

    call carry(n, constants, ubound(motion%pose, 2), motion%pose, motion%velocity, motion%acceleration, highest, again, series)
  end subroutine carry_in_plane

  !> Fill the form of a closed chain: its rotation, and its shift at the origin of its base frame in lengths of the mechanism.
  pure subroutine fill_planar_closure(planar, c, motion, highest, series, form)
    type(planar_plan_type), intent(in) :: planar         !< the plan in planar arithmetic
    integer, intent(in) :: c                             !< number of the closure
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(in) :: series(:, 0:, :)             !< (3,0:2,constants) twists of constants
    type(linear_form_type), intent(inout) :: form        !< gets its columns and shares
    real(wp) :: base(2), per_length

    per_length = 1.0_wp/planar%length
    base = motion%pose(3:4, planar%closures(c)%base)
    call fill_columns(size(form%steps), form%steps, form%signs, size(planar%steps), planar%steps, per_length, base, motion%pose, &
                      motion%slide, motion%velocity, motion%acceleration, highest, form%columns)
    call add_constants(size(form%constants), form%constants, form%constant_signs, form%parameters, form%is_first, &
                       form%keeps, form%is_filled, per_length, base, size(series, 3), series, highest, &
                       size(form%of_constants, 1), form%of_constants)
    form%is_filled = .true.
  end subroutine fill_planar_closure

  ! The next four procedures take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> Twists of constants, seen from frame 0, from plain arrays.
  pure subroutine carry(n, constants, m, f, v, a, highest, again, series)
    integer, intent(in) :: n                                !< number of twists
    type(varied_constant_type), intent(in) :: constants(n)  !< rotation and shifts in twist(1:3), in the axes of the planar frames
    integer, intent(in) :: m                                !< number of steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                       !< poses of the frames [m]
    real(wp), intent(in) :: v(3, 0:m)                       !< velocities of the frames [rad/s, m/s]
    real(wp), intent(in) :: a(3, 0:m)                       !< accelerations of the frames [rad/s^2, m/s^2]
    integer, intent(in) :: highest                          !< order of the highest derivative
    logical, intent(in) :: again                            !< twists of the ground are in `series` already
    real(wp), intent(inout) :: series(3, 0:2, n)            !< gets the twists up to this derivative
    real(wp) :: x, y, w, square, turning
    integer :: i, k

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
  end subroutine carry

  !> The shares of constants in the opening of a chain.
  pure subroutine add_constants(n, numbers, signs, parameters, is_first, keeps, is_filled, per_length, base, count, series, &
                                highest, n_parameters, sums)
    integer, intent(in) :: n                             !< number of these constants
    integer, intent(in) :: numbers(n)                    !< numbers of the constants
    real(wp), intent(in) :: signs(n)                     !< of the constants
    integer, intent(in) :: parameters(n)                 !< of the constants
    logical, intent(in) :: is_first(n)                   !< the constant is the first one of its parameter
    logical, intent(in) :: keeps(n)                      !< its share never changes
    logical, intent(in) :: is_filled                     !< all shares have been found once
    real(wp), intent(in) :: per_length                   !< one over the length of the mechanism [1/m]
    real(wp), intent(in) :: base(2)                      !< origin of the frame at which the opening is written [m]
    integer, intent(in) :: count                         !< number of all constants
    real(wp), intent(in) :: series(3, 0:2, count)        !< twists of all constants
    integer, intent(in) :: highest                       !< order of the highest derivative
    integer, intent(in) :: n_parameters                  !< number of parameters
    real(wp), intent(inout) :: sums(n_parameters, 3, 0:2)   !< gets the shares, by parameters
    real(wp) :: factor, share(3)
    integer :: i, k, p, order

    do i = 1, n
      if (keeps(i) .and. is_filled) cycle
      k = numbers(i)
      p = parameters(i)
      factor = signs(i)*per_length
      share(1) = signs(i)*series(1, 0, k)
      share(2) = factor*(series(2, 0, k) - series(1, 0, k)*base(2))
      share(3) = factor*(series(3, 0, k) + series(1, 0, k)*base(1))
      if (is_first(i)) then
        sums(p, 1, 0) = share(1)
        sums(p, 2, 0) = share(2)
        sums(p, 3, 0) = share(3)
        do order = 1, highest
          sums(p, 2, order) = factor*series(2, order, k)
          sums(p, 3, order) = factor*series(3, order, k)
        end do
      else
        sums(p, 1, 0) = sums(p, 1, 0) + share(1)
        sums(p, 2, 0) = sums(p, 2, 0) + share(2)
        sums(p, 3, 0) = sums(p, 3, 0) + share(3)
        do order = 1, highest
          sums(p, 2, order) = sums(p, 2, order) + factor*series(2, order, k)
          sums(p, 3, order) = sums(p, 3, order) + factor*series(3, order, k)
        end do
      end if
    end do
  end subroutine add_constants

  !> The columns of steps in the opening of a chain.
  pure subroutine fill_columns(n, numbers, signs, m, steps, per_length, base, f, slide, v, a, highest, columns)
    integer, intent(in) :: n                             !< number of these steps
    integer, intent(in) :: numbers(n)                    !< numbers of the steps
    real(wp), intent(in) :: signs(n)                     !< of the steps in the loop
    integer, intent(in) :: m                             !< number of steps of the plan
    type(planar_step_type), intent(in) :: steps(m)       !< steps of the plan
    real(wp), intent(in) :: per_length                   !< one over the length of the mechanism [1/m]
    real(wp), intent(in) :: base(2)                      !< origin of the frame at which the opening is written [m]
    real(wp), intent(in) :: f(4, 0:m)                    !< poses of the frames [m]
    real(wp), intent(in) :: slide(2, m)                  !< velocity of each frame's origin per unit rate
    real(wp), intent(in) :: v(3, 0:m)                    !< velocities of the frames [rad/s, m/s]
    real(wp), intent(in) :: a(3, 0:m)                    !< accelerations of the frames [rad/s^2, m/s^2]
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(inout) :: columns(3, 0:2, n)        !< gets the columns
    real(wp) :: w, turning
    integer :: i, k

    do i = 1, n
      k = numbers(i)
      if (steps(k)%turns) then
        turning = signs(i)*steps(k)%turn
        w = turning*per_length
        columns(1, 0, i) = turning
        columns(2, 0, i) = w*(f(4, k) - base(2))
        columns(3, 0, i) = w*(base(1) - f(3, k))
        if (highest == 0) cycle
        columns(2, 1, i) = w*v(3, k)
        columns(3, 1, i) = -w*v(2, k)
        columns(2, 2, i) = w*a(3, k)
        columns(3, 2, i) = -w*a(2, k)
      else
        w = signs(i)*per_length
        call slide_series(slide(:, k), v(1, steps(k)%parent), a(1, steps(k)%parent), columns(2:3, 0, i), columns(2:3, 1, i), &
                          columns(2:3, 2, i))
        columns(2:3, :, i) = w*columns(2:3, :, i)
      end if
    end do
  end subroutine fill_columns

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

  !> Fill the form of a point: its shift in space, or in the plane where the plane's axes are those of frame 0.
  pure subroutine fill_planar_point(planar, frame, place, motion, highest, constants, series, form)
    type(planar_plan_type), intent(in) :: planar         !< the plan in planar arithmetic
    integer, intent(in) :: frame                         !< frame with which the point moves
    real(wp), intent(in) :: place(2)                     !< the point in the planar frame [m]
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    type(varied_constant_type), intent(in) :: constants(:)   !< the constants
    real(wp), intent(in) :: series(:, 0:, :)             !< (3,0:2,constants) twists of constants
    type(linear_form_type), intent(inout) :: form        !< gets its columns and shares
    real(wp) :: arm(2), p(2, 0:2), shift(2, 0:2), share(3, 0:2)
    integer :: i, s, k, order

    p = 0.0_wp
    associate (f => motion%pose(:, frame), v => motion%velocity(:, frame), a => motion%acceleration(:, frame))
      call turn_in_plane(f, place, arm)
      p(:, 0) = f(3:4) + arm
      if (highest > 0) call point_velocity(v, arm, p(:, 1))
      if (highest > 1) call point_acceleration(v(1), a, arm, p(:, 2))
    end associate
    do i = 1, size(form%steps)
      s = form%steps(i)
      if (planar%steps(s)%turns) then
        call turn_about(planar%steps(s)%turn, p(:, 0), motion%pose(3:4, s), shift(:, 0))
        call turn_about(planar%steps(s)%turn, p(:, 1), motion%velocity(2:3, s), shift(:, 1))
        call turn_about(planar%steps(s)%turn, p(:, 2), motion%acceleration(2:3, s), shift(:, 2))
      else
        k = planar%steps(s)%parent
        call slide_series(motion%slide(:, s), motion%velocity(1, k), motion%acceleration(1, k), shift(:, 0), shift(:, 1), &
                          shift(:, 2))
      end if
      do order = 0, highest
        call put(planar, shift(:, order), form%columns(:, order, i))
      end do
    end do
    do i = 1, size(form%constants)
      if (form%keeps(i) .and. form%is_filled) cycle
      associate (twist => series(:, :, form%constants(i)))
        do order = 0, highest
          shift(1, order) = twist(2, order + 1) - twist(1, 1)*p(2, order)
          shift(2, order) = twist(3, order + 1) + twist(1, 1)*p(1, order)
        end do
        if (form%rows == 2) then
          call put_constant(form, i, highest, shift)
          cycle
        end if
        do order = 0, highest
          call put(planar, shift(:, order), share(:, order))
        end do
        ! points alone may be shifted along the normal
        if (constants(form%constants(i))%point > 0) &
          share(:, 0) = share(:, 0) + constants(form%constants(i))%twist(4)*planar%axes(:, 3)
        call put_constant(form, i, highest, share)
      end associate
    end do
    form%is_filled = .true.
  end subroutine fill_planar_point

  !> The shift of a place by a turn about another one.
  pure subroutine turn_about(angle, place, centre, shift)
    real(wp), intent(in) :: angle         !< small angle [rad]
    real(wp), intent(in) :: place(2)      !< the place, or a derivative in time [m]
    real(wp), intent(in) :: centre(2)     !< the other one, alike [m]
    real(wp), intent(out) :: shift(2)     !< [m]

    shift(1) = angle*(centre(2) - place(2))
    shift(2) = angle*(place(1) - centre(1))
  end subroutine turn_about

  !> Put a vector of the plane into a column.
  pure subroutine put(planar, vector, column)
    type(planar_plan_type), intent(in) :: planar   !< the plan in planar arithmetic
    real(wp), intent(in) :: vector(2)              !< in the plane's axes
    real(wp), intent(inout) :: column(:)           !< two rows in the plane's axes where these are those of frame 0, else three rows

    if (planar%in_xy_plane) then
      column(1) = vector(1)
      column(2) = vector(2)
    else
      column = planar%axes(:, 1)*vector(1) + planar%axes(:, 2)*vector(2)
    end if
  end subroutine put

  !> The twist of a step per unit rate and its derivatives in time.
  pure subroutine planar_step_series(planar, s, motion, highest, series)
    type(planar_plan_type), intent(in) :: planar         !< the plan in planar arithmetic
    integer, intent(in) :: s                             !< number of the step
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(out) :: series(3, 0:2)              !< rotation, and shift at the origin of frame 0

    series = 0.0_wp
    call fill_columns(1, [s], [1.0_wp], size(planar%steps), planar%steps, 1.0_wp, [0.0_wp, 0.0_wp], motion%pose, motion%slide, &
                      motion%velocity, motion%acceleration, highest, series)
  end subroutine planar_step_series
end module mech9_planar_forms
