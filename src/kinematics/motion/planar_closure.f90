!> Closures in planar arithmetic: three equations each, for an angle and for two displacements in lengths of the mechanism. They
!> are written at the origin of the loop's base frame, as in space.
module mech9_planar_closure
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_plan_type, planar_closure_type, planar_step_type
  use mech9_planar_formulas, only: step_column, add_rate, stem_difference, rows_at_base, closing_error
  use mech9_plan, only: plan_type, loop_type, constraint_type
  use mech9_state, only: planar_motion_type, state_type
  use mech9_planar_view, only: plane_in_space
  implicit none
  private
  public :: planar_closure_constraint_type, planar_bias_rates, planar_difference

  !> The constraint of one closure.
  type, extends(constraint_type) :: planar_closure_constraint_type
    integer :: closure = 0                        !< its number
  contains
    procedure :: residual
    procedure :: jacobian
    procedure :: column
    procedure :: rates
    procedure :: opening
    procedure :: gap
  end type planar_closure_constraint_type

contains

  !> The residual: the angle and the displacement from the target pose to the closing frame.
  pure subroutine residual(self, plan, state, values)
    class(planar_closure_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                         !< the plan of the mechanism
    type(state_type), intent(in) :: state                       !< with the poses of the frames
    real(wp), intent(out), contiguous :: values(:)              !< (3) [rad, lengths of the mechanism]
    real(wp) :: error(3)

    associate (closure => plan%planar%closures(self%closure))
      call closing_error(closure, state%planar%pose, error)
      call rows_at_base(closure, 1.0_wp/plan%length, state%planar%pose, error, values)
    end associate
  end subroutine residual

  !> Derivatives with respect to the coordinates of steps of a loop, each in its unit.
  pure subroutine jacobian(self, plan, loop, column_of, state, row, matrix)
    class(planar_closure_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                         !< the plan of the mechanism
    type(loop_type), intent(in) :: loop                         !< the steps of the loop
    integer, allocatable, intent(in) :: column_of(:)            !< (steps of the block) column of each step; 0: none
    type(state_type), intent(in) :: state                       !< with the poses of the frames
    integer, intent(in) :: row                                  !< number of rows of `matrix` before those of this constraint
    real(wp), intent(inout), contiguous :: matrix(:, :)         !< Jacobian of the block; gets three rows
    integer :: base, m

    base = plan%planar%closures(self%closure)%base
    m = size(matrix, 1)
    call fill_columns(plan%planar%steps, state%planar%pose, state%planar%slide, matrix)

  contains

    !> The same from plain arrays of which all but the last extent is known, so that the compiler keeps their addresses in
    !> registers.
    pure subroutine fill_columns(steps, f, slide, matrix)
      type(planar_step_type), intent(in) :: steps(*)   !< steps of the plan
      real(wp), intent(in) :: f(4, 0:*)                !< poses of the frames [m]
      real(wp), intent(in) :: slide(2, *)              !< velocity of each frame's origin per unit rate
      real(wp), intent(inout) :: matrix(m, *)          !< gets three rows
      real(wp) :: per_length
      integer :: i, j, s

      per_length = 1.0_wp/plan%length
      do i = 1, size(loop%steps)
        s = loop%steps(i)
        if (s < lbound(column_of, 1)) cycle
        j = column_of(s)
        if (j == 0) cycle
        call step_column(steps(s), loop%signs(i), f(:, s), slide(:, s), f(3:4, base), per_length, matrix(row + 1:row + 3, j))
      end do
    end subroutine fill_columns
  end subroutine jacobian

  !> Derivatives with respect to the coordinate of one step, in its unit.
  pure subroutine column(self, plan, s, sign, state, values)
    class(planar_closure_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                         !< the plan of the mechanism
    integer, intent(in) :: s                                    !< number of the step
    real(wp), intent(in) :: sign                                !< of the step in the loop: 1 or -1
    type(state_type), intent(in) :: state                       !< with the poses of the frames
    real(wp), intent(out), contiguous :: values(:)              !< (3) [rad, lengths of the mechanism] per unit of the coordinate

    call step_column(plan%planar%steps(s), sign, state%planar%pose(:, s), state%planar%slide(:, s), &
                     state%planar%pose(3:4, plan%planar%closures(self%closure)%base), 1.0_wp/plan%length, values)
  end subroutine column

  !> First or second time derivatives at the rates, or rates and accelerations, in `state`. The motion of the frames of earlier
  !> blocks must agree with these; for second derivatives, that of the block's own frames too.
  pure subroutine rates(self, plan, order, state, values)
    class(planar_closure_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                         !< the plan of the mechanism
    integer, intent(in) :: order                                !< 1: first derivatives, 2: second derivatives
    type(state_type), intent(in) :: state                       !< with the motion of the frames
    real(wp), intent(out), contiguous :: values(:)              !< (3) [rad, lengths of the mechanism; per s or s^2]
    real(wp) :: opening(3)

    associate (closure => plan%planar%closures(self%closure), part => plan%closures(self%closure)%part, &
               steps => plan%planar%steps, motion => state%planar)
      if (order == 1) then
        call sum_rates(closure, part, steps, state%dq, motion, opening)
        call rows_at_base(closure, 1.0_wp/plan%length, motion%pose, opening, values)
      else
        call find_difference(closure, 1.0_wp/plan%length, motion%pose, motion%acceleration(:, closure%closing), &
                             motion%acceleration(:, closure%target), motion%velocity(1, closure%target)**2, values)
      end if
    end associate
  end subroutine rates

  !> The equations' values for a motion of the closing frame relative to the target.
  pure subroutine opening(self, plan, state, w, v, values)
    class(planar_closure_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                         !< the plan of the mechanism
    type(state_type), intent(in) :: state                       !< with the poses of the frames
    real(wp), intent(in) :: w(3)                     !< angular velocity, in the axes of frame 0 [rad/s]
    real(wp), intent(in) :: v(3)                     !< velocity of the closing frame's origin, in the axes of frame 0 [m/s]
    real(wp), intent(out), contiguous :: values(:)   !< (3) [rad/s, lengths of the mechanism/s]
    real(wp) :: axes(3, 3)

    associate (closure => plan%planar%closures(self%closure))
      axes = plane_in_space(plan, state, closure%closing)
      call rows_at_base(closure, 1.0_wp/plan%length, state%planar%pose, &
                        [dot_product(axes(:, 3), w), dot_product(axes(:, 1), v), dot_product(axes(:, 2), v)], values)
    end associate
  end subroutine opening

  !> The gap of the closure, a length [m]: the larger of its distance and its angle times the mechanism's size.
  pure real(wp) function gap(self, plan, state)
    class(planar_closure_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                         !< the plan of the mechanism
    type(state_type), intent(in) :: state                       !< with the poses of the frames
    real(wp) :: error(3)

    call closing_error(plan%planar%closures(self%closure), state%planar%pose, error)
    gap = max(sqrt(error(2)**2 + error(3)**2), plan%length*abs(error(1)))
  end function gap

  !> Velocity of the closing frame relative to the target, at the closing frame's origin. It results from the rates of the
  !> coordinates in the closure's part, and from the velocities of the frames at which this part begins.
  pure subroutine sum_rates(closure, part, steps, rates, motion, opening)
    type(planar_closure_type), intent(in) :: closure   !< the closure in planar arithmetic
    type(loop_type), intent(in) :: part                !< its part
    type(planar_step_type), intent(in) :: steps(:)     !< steps of the plan
    real(wp), intent(in) :: rates(:)                   !< rates of the coordinates [rad/s, m/s]
    type(planar_motion_type), intent(in) :: motion     !< poses and velocities of the frames
    real(wp), intent(out) :: opening(3)                !< relative velocity of the closing frame [rad/s, m/s]
    integer :: i, s

    associate (place => motion%pose(3:4, closure%closing))
      call stem_difference(part%stems, place, motion%pose, motion%velocity, opening)
      do i = 1, size(part%steps)
        s = part%steps(i)
        call add_rate(steps(s), part%signs(i)*rates(steps(s)%coordinate), motion%pose(:, s), motion%slide(:, s), place, opening)
      end do
    end associate
  end subroutine sum_rates

  !> Second time derivatives of the closures first .. last, from the accelerations of their frames.
  pure subroutine planar_bias_rates(planar, first, last, motion, rates)
    type(planar_plan_type), intent(in) :: planar     !< the plan in planar arithmetic
    integer, intent(in) :: first                     !< first closure
    integer, intent(in) :: last                      !< last closure
    type(planar_motion_type), intent(in) :: motion   !< poses, velocities and accelerations of the frames
    real(wp), intent(out) :: rates(3, first:last)    !< (equations, closures) [rad/s^2, lengths of the mechanism/s^2]
    integer :: c

    do c = first, last
      associate (closure => planar%closures(c), a => motion%acceleration)
        call find_difference(closure, 1.0_wp/planar%length, motion%pose, a(:, closure%closing), &
                             a(:, closure%target), motion%velocity(1, closure%target)**2, rates(:, c))
      end associate
    end do
  end subroutine planar_bias_rates

  !> The three equations of a closure for a given difference of velocities: that of the closing frame less that of the target's
  !> point at the same place.
  pure subroutine planar_difference(planar, c, motion, closing, target, rows)
    type(planar_plan_type), intent(in) :: planar     !< the plan in planar arithmetic
    integer, intent(in) :: c                         !< number of the closure
    type(planar_motion_type), intent(in) :: motion   !< with the poses of the frames
    real(wp), intent(in) :: closing(3)               !< angular velocity of the closing frame, and velocity of its origin
    real(wp), intent(in) :: target(3)                !< angular velocity of the target, and velocity of its origin
    real(wp), intent(out) :: rows(3)                 !< the difference, translations in lengths of the mechanism

    call find_difference(planar%closures(c), 1.0_wp/planar%length, motion%pose, closing, target, 0.0_wp, rows)
  end subroutine planar_difference

  !> The three equations of a closure for the motion of the closing frame less that of the target's point at the same place.
  pure subroutine find_difference(closure, per_length, f, closing, target, square, rows)
    type(planar_closure_type), intent(in) :: closure   !< the closure in planar arithmetic
    real(wp), intent(in) :: per_length                 !< one over the mechanism's size [1/m]
    real(wp), intent(in) :: f(4, 0:*)                  !< poses of the frames [m]
    real(wp), intent(in) :: closing(3)                 !< motion of the closing frame: angular, and of its origin
    real(wp), intent(in) :: target(3)                  !< motion of the target: angular, and of its origin
    real(wp), intent(in) :: square                     !< squared angular velocity of the target if these are accelerations, else 0
    real(wp), intent(out) :: rows(3)                   !< the difference, translations in lengths of the mechanism
    real(wp) :: x, y

    x = f(3, closure%closing) - f(3, closure%target)
    y = f(4, closure%closing) - f(4, closure%target)
    call rows_at_base(closure, per_length, f, [closing(1) - target(1), &
                                               closing(2) - target(2) + target(1)*y + square*x, &
                                               closing(3) - target(3) - target(1)*x + square*y], rows)
  end subroutine find_difference
end module mech9_planar_closure
