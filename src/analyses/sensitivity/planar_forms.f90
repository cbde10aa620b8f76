!> Columns of the openings of chains and of the shifts of points in planar arithmetic, with their derivatives in time.
!>
!> A twist in the plane is three numbers: the rotation about the normal, and the shift of the point at the origin of frame 0.
module mech9_planar_forms
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_plan_type, planar_step_type
  use mech9_state, only: planar_motion_type
  use mech9_planar_formulas, only: turn_in_plane, point_velocity, point_acceleration
  use mech9_parameter_support, only: varied_constant_type
  use mech9_linear_form, only: linear_form_type
  implicit none
  private
  public :: carry_in_plane, fill_planar_closure, fill_planar_point, planar_step_series

contains

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_plane(n, constants, motion, highest, series)
    integer, intent(in) :: n                                !< number of twists
    type(varied_constant_type), intent(in) :: constants(n)  !< rotation and shifts in twist(1:3), in the axes of the planar frames
    type(planar_motion_type), intent(in) :: motion          !< the motion of the frames
    integer, intent(in) :: highest                          !< order of the highest derivative
    real(wp), intent(inout) :: series(3, 0:2, n)            !< gets the twists up to this derivative
    real(wp) :: shift(2), w, turning
    integer :: i

    do i = 1, n
      associate (twist => constants(i)%twist, pose => motion%pose(:, constants(i)%frame), &
                 v => motion%velocity(:, constants(i)%frame), a => motion%acceleration(:, constants(i)%frame))
        turning = twist(1)
        call turn_in_plane(pose, twist(2:3), shift)
        series(1, 0, i) = turning
        series(2, 0, i) = shift(1) + turning*pose(4)
        series(3, 0, i) = shift(2) - turning*pose(3)
        if (highest == 0) cycle
        w = v(1)
        series(2, 1, i) = turning*v(3) - w*shift(2)
        series(3, 1, i) = w*shift(1) - turning*v(2)
        series(2, 2, i) = turning*a(3) - a(1)*shift(2) - w**2*shift(1)
        series(3, 2, i) = a(1)*shift(1) - w**2*shift(2) - turning*a(2)
      end associate
    end do
  end subroutine carry_in_plane

  !> Fill the form of a closed chain: its rotation, and its shift at the origin of its base frame in lengths of the mechanism.
  pure subroutine fill_planar_closure(planar, c, motion, highest, series, form)
    type(planar_plan_type), intent(in) :: planar         !< the plan in planar arithmetic
    integer, intent(in) :: c                             !< number of the closure
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(in) :: series(:, 0:, :)             !< (3,0:2,constants) twists of constants
    type(linear_form_type), intent(inout) :: form        !< gets its columns and shares
    real(wp) :: base(2), per_length, factor
    integer :: i

    per_length = 1.0_wp/planar%length
    base = motion%pose(3:4, planar%closures(c)%base)
    do i = 1, size(form%steps)
      call step_columns(planar%steps(form%steps(i)), form%signs(i), per_length, form%steps(i), base, motion, highest, &
                        form%columns(:, :, i))
    end do
    do i = 1, size(form%constants)
      associate (twist => series(:, :, form%constants(i)), share => form%shares(:, :, i))
        factor = form%constant_signs(i)*per_length
        share(1, 1) = form%constant_signs(i)*twist(1, 1)
        share(2, 1) = factor*(twist(2, 1) - twist(1, 1)*base(2))
        share(3, 1) = factor*(twist(3, 1) + twist(1, 1)*base(1))
        if (highest == 0) cycle
        share(2:3, 2) = factor*twist(2:3, 2)
        share(2:3, 3) = factor*twist(2:3, 3)
      end associate
    end do
  end subroutine fill_planar_closure

  !> The columns of one step in the opening of a chain.
  pure subroutine step_columns(step, sign, per_length, s, base, motion, highest, columns)
    type(planar_step_type), intent(in) :: step           !< the step
    real(wp), intent(in) :: sign                         !< of the step in the loop
    real(wp), intent(in) :: per_length                   !< one over the length of the mechanism [1/m]
    integer, intent(in) :: s                             !< number of the step
    real(wp), intent(in) :: base(2)                      !< origin of the frame at which the opening is written [m]
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(inout) :: columns(3, 0:2)           !< gets the columns
    real(wp) :: w, turning, slide(2, 0:2)

    if (step%turns) then
      turning = sign*step%turn
      w = turning*per_length
      columns(1, 0) = turning
      columns(2, 0) = w*(motion%pose(4, s) - base(2))
      columns(3, 0) = w*(base(1) - motion%pose(3, s))
      if (highest == 0) return
      columns(2, 1) = w*motion%velocity(3, s)
      columns(3, 1) = -w*motion%velocity(2, s)
      columns(2, 2) = w*motion%acceleration(3, s)
      columns(3, 2) = -w*motion%acceleration(2, s)
    else
      call slide_series(step, s, motion, highest, slide)
      columns(2:3, :) = sign*per_length*slide
    end if
  end subroutine step_columns

  !> The direction in which a step slides, and its derivatives in time.
  pure subroutine slide_series(step, s, motion, highest, series)
    type(planar_step_type), intent(in) :: step           !< the step
    integer, intent(in) :: s                             !< number of the step
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(out) :: series(2, 0:2)              !< shift per unit of the coordinate

    associate (slide => motion%slide(:, s), v => motion%velocity(:, step%parent), a => motion%acceleration(:, step%parent))
      series = 0.0_wp
      series(:, 0) = slide
      if (highest == 0) return
      series(1, 1) = -v(1)*slide(2)
      series(2, 1) = v(1)*slide(1)
      series(1, 2) = -a(1)*slide(2) - v(1)**2*slide(1)
      series(2, 2) = a(1)*slide(1) - v(1)**2*slide(2)
    end associate
  end subroutine slide_series

  !> Fill the form of a point: its shift in space, or in the plane where the plane's axes are those of frame 0.
  pure subroutine fill_planar_point(planar, frame, place, motion, highest, series, form)
    type(planar_plan_type), intent(in) :: planar         !< the plan in planar arithmetic
    integer, intent(in) :: frame                         !< frame with which the point moves
    real(wp), intent(in) :: place(2)                     !< the point in the planar frame [m]
    type(planar_motion_type), intent(in) :: motion       !< the motion of the frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(in) :: series(:, 0:, :)             !< (3,0:2,constants) twists of constants
    type(linear_form_type), intent(inout) :: form        !< gets its columns and shares
    real(wp) :: arm(2), p(2, 0:2), shift(2, 0:2)
    integer :: i, s, order

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
        call slide_series(planar%steps(s), s, motion, highest, shift)
      end if
      do order = 0, highest
        call put(planar, shift(:, order), form%columns(:, order, i))
      end do
    end do
    do i = 1, size(form%constants)
      associate (twist => series(:, :, form%constants(i)))
        do order = 0, highest
          shift(1, order) = twist(2, order + 1) - twist(1, 1)*p(2, order)
          shift(2, order) = twist(3, order + 1) + twist(1, 1)*p(1, order)
          call put(planar, shift(:, order), form%shares(:, order, i))
        end do
      end associate
    end do
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
    call step_columns(planar%steps(s), 1.0_wp, 1.0_wp, s, [0.0_wp, 0.0_wp], motion, highest, series)
  end subroutine planar_step_series
end module mech9_planar_forms
