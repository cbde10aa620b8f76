!> Closures in space, (12): the screw of the error pose, in independent equations.
!>
!> At most six of the twelve scalar equations of (12) are independent. They are replaced by the screw of the error pose: the
!> rotation vector that turns the target pose onto the closing frame, and the displacement between the two. The screw is written
!> at the base frame of the loop, where the space of motions of the loop is constant, and the closure's constant rows select its
!> independent components.
module mech9_spatial_closure
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, combine, cross, rotation_between
  use mech9_plan, only: plan_type, step_type, closure_type, loop_type, constraint_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: spatial_closure_type, loop_screw, reduced_screw

  !> The constraint of one closure.
  type, extends(constraint_type) :: spatial_closure_type
    integer :: closure = 0                        !< its number
  contains
    procedure :: residual
    procedure :: jacobian
    procedure :: column
    procedure :: rates
    procedure :: opening
    procedure :: gap
  end type spatial_closure_type

contains

  !> The residual: the independent components of the screw of the error pose.
  pure subroutine residual(self, plan, state, values)
    class(spatial_closure_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(state_type), intent(in) :: state             !< with the poses of the frames
    real(wp), intent(out), contiguous :: values(:)    !< (equations) [rad, lengths of the mechanism]
    real(wp) :: w(3), v(3), place(3)

    call error_screw(plan%closures(self%closure), state, w, v, place)
    call reduced_screw(plan, plan%closures(self%closure), state, w, v, place, values)
  end subroutine residual

  !> Derivatives with respect to the coordinates of steps of a loop, each in its unit.
  pure subroutine jacobian(self, plan, loop, column_of, state, row, matrix)
    class(spatial_closure_type), intent(in) :: self       !< the constraint
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(loop_type), intent(in) :: loop                   !< the steps of the loop
    integer, allocatable, intent(in) :: column_of(:)      !< (steps of the block) column of each step; 0: none
    type(state_type), intent(in) :: state                 !< with the poses of the frames and the screws of the steps
    integer, intent(in) :: row                            !< number of rows of `matrix` before those of this constraint
    real(wp), intent(inout), contiguous :: matrix(:, :)   !< Jacobian of the block; gets the rows of this closure
    integer :: i, s, m

    if (self%equations == 6) then
      m = size(matrix, 1)
      call fill_columns(plan%steps, state%p, state%axis_w, state%axis_v, matrix)
      return
    end if
    do i = 1, size(loop%steps)
      s = loop%steps(i)
      if (s < lbound(column_of, 1)) cycle
      if (column_of(s) == 0) cycle
      call self%column(plan, s, loop%signs(i), state, matrix(row + 1:row + self%equations, column_of(s)))
    end do

  contains

    !> The derivatives of all six equations, from plain arrays of which all but the last extent is known, so that the compiler keeps
    !> their addresses in registers.
    pure subroutine fill_columns(steps, p, axis_w, axis_v, matrix)
      type(step_type), intent(in) :: steps(*)    !< steps of the plan
      real(wp), intent(in) :: p(3, 0:*)          !< origins of the frames [m]
      real(wp), intent(in) :: axis_w(3, *)       !< angular velocity per unit rate
      real(wp), intent(in) :: axis_v(3, *)       !< velocity of the origin per unit rate
      real(wp), intent(inout) :: matrix(m, *)    !< gets six rows
      real(wp) :: w(3), v(3), per_length
      integer :: closing, i, j, s

      closing = plan%closures(self%closure)%closing
      per_length = 1.0_wp/plan%length
      do i = 1, size(loop%steps)
        s = loop%steps(i)
        if (s < lbound(column_of, 1)) cycle
        j = column_of(s)
        if (j == 0) cycle
        call carry_screw(loop%signs(i)*plan%unit_of(steps(s)%coordinate), axis_w(:, s), axis_v(:, s), p(:, s), p(:, closing), w, v)
        matrix(row + 1:row + 3, j) = w
        matrix(row + 4:row + 6, j) = v*per_length
      end do
    end subroutine fill_columns
  end subroutine jacobian

  !> The screw of a step, with a weight, at another place.
  pure subroutine carry_screw(weight, axis_w, axis_v, from, place, w, v)
    real(wp), intent(in) :: weight      !< factor of the screw
    real(wp), intent(in) :: axis_w(3)   !< angular velocity per unit rate
    real(wp), intent(in) :: axis_v(3)   !< velocity of the step's frame per unit rate
    real(wp), intent(in) :: from(3)     !< origin of the step's frame [m]
    real(wp), intent(in) :: place(3)    !< the place [m]
    real(wp), intent(out) :: w(3)       !< angular velocity
    real(wp), intent(out) :: v(3)       !< velocity at the place
    real(wp) :: arm(3)

    w = weight*axis_w
    arm = place - from
    v = weight*axis_v + cross(w, arm)
  end subroutine carry_screw

  !> Derivatives with respect to the coordinate of one step, in its unit.
  pure subroutine column(self, plan, s, sign, state, values)
    class(spatial_closure_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    integer, intent(in) :: s                          !< number of the step
    real(wp), intent(in) :: sign                      !< of the step in the loop: 1 or -1
    type(state_type), intent(in) :: state             !< with the poses of the frames and the screws of the steps
    real(wp), intent(out), contiguous :: values(:)    !< (equations) [rad, lengths of the mechanism] per unit of the coordinate
    real(wp) :: w(3), v(3)

    associate (place => state%p(:, plan%closures(self%closure)%closing))
      call carry_screw(sign*plan%unit_of(plan%steps(s)%coordinate), state%axis_w(:, s), state%axis_v(:, s), state%p(:, s), &
                       place, w, v)
      call reduced_screw(plan, plan%closures(self%closure), state, w, v, place, values)
    end associate
  end subroutine column

  !> First or second time derivatives at the rates, or rates and accelerations, in `state`. The motion of the frames of earlier
  !> blocks must agree with these; for second derivatives, that of the block's own frames too.
  pure subroutine rates(self, plan, order, state, values)
    class(spatial_closure_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    integer, intent(in) :: order                      !< 1: first derivatives, 2: second derivatives
    type(state_type), intent(in) :: state             !< with the motion of the frames
    real(wp), intent(out), contiguous :: values(:)    !< (equations) [rad, lengths of the mechanism; per s or s^2]
    real(wp) :: w(3), v(3)

    associate (closure => plan%closures(self%closure))
      if (order == 1) then
        call opening_velocity(plan, closure, state, w, v)
      else
        call opening_acceleration(closure, state, w, v)
      end if
      call reduced_screw(plan, closure, state, w, v, state%p(:, closure%closing), values)
    end associate
  end subroutine rates

  !> The equations' values for a motion of the closing frame relative to the target.
  pure subroutine opening(self, plan, state, w, v, values)
    class(spatial_closure_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(state_type), intent(in) :: state             !< with the poses of the frames
    real(wp), intent(in) :: w(3)                      !< angular velocity, in the axes of frame 0 [rad/s]
    real(wp), intent(in) :: v(3)                      !< velocity of the closing frame's origin, in the axes of frame 0 [m/s]
    real(wp), intent(out), contiguous :: values(:)    !< (equations) [rad/s, lengths of the mechanism/s]

    associate (closure => plan%closures(self%closure))
      call reduced_screw(plan, closure, state, w, v, state%p(:, closure%closing), values)
    end associate
  end subroutine opening

  !> The gap of the closure, a length [m]: the larger of its distance and its angle times the mechanism's size. Redundant
  !> components are included.
  pure real(wp) function gap(self, plan, state)
    class(spatial_closure_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(state_type), intent(in) :: state             !< with the poses of the frames
    real(wp) :: w(3), v(3), place(3)

    call error_screw(plan%closures(self%closure), state, w, v, place)
    gap = max(norm2(v), plan%length*norm2(w))
  end function gap

  !> Velocity of the closing frame relative to the target, from the rates of the coordinates in the closure's part.
  pure subroutine opening_velocity(plan, closure, state, w, v)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(closure_type), intent(in) :: closure   !< the closure
    type(state_type), intent(in) :: state       !< with the rates, and the velocities of the frames of earlier blocks
    real(wp), intent(out) :: w(3)               !< relative angular velocity, in the axes of frame 0 [rad/s]
    real(wp), intent(out) :: v(3)               !< relative velocity at the closing frame's origin, in the axes of frame 0 [m/s]
    real(wp) :: place(3)

    place = state%p(:, closure%closing)
    call stem_difference(closure, place, state%p, state%omega, state%v, w, v)
    call add_velocities(plan%steps, state%p, state%axis_w, state%axis_v, w, v)

  contains

    !> Add the velocities that the rates of steps give, from plain arrays as above.
    pure subroutine add_velocities(steps, p, axis_w, axis_v, w, v)
      type(step_type), intent(in) :: steps(*)   !< steps of the plan
      real(wp), intent(in) :: p(3, 0:*)         !< origins of the frames [m]
      real(wp), intent(in) :: axis_w(3, *)      !< angular velocity per unit rate
      real(wp), intent(in) :: axis_v(3, *)      !< velocity of the origin per unit rate
      real(wp), intent(inout) :: w(3)           !< relative angular velocity [rad/s]
      real(wp), intent(inout) :: v(3)           !< relative velocity at the place [m/s]
      real(wp) :: spin(3), slip(3), rate
      integer :: i, s

      do i = 1, size(closure%part%steps)
        s = closure%part%steps(i)
        rate = state%dq(steps(s)%coordinate)
        if (.not. abs(rate) > 0.0_wp) cycle
        call carry_screw(closure%part%signs(i)*rate, axis_w(:, s), axis_v(:, s), p(:, s), place, spin, slip)
        w = w + spin
        v = v + slip
      end do
    end subroutine add_velocities
  end subroutine opening_velocity

  !> Difference at a place between the velocities of the two bodies on whose frames the part of a loop begins.
  pure subroutine stem_difference(closure, place, p, omega, v_frame, w, v)
    type(closure_type), intent(in) :: closure   !< the closure
    real(wp), intent(in) :: place(3)            !< from the origin of frame 0, in its axes [m]
    real(wp), intent(in) :: p(:, 0:)            !< origins of the frames [m]
    real(wp), intent(in) :: omega(:, 0:)        !< angular velocities of the frames [rad/s]
    real(wp), intent(in) :: v_frame(:, 0:)      !< velocities of their origins [m/s]
    real(wp), intent(out) :: w(3)               !< difference of the angular velocities [rad/s]
    real(wp), intent(out) :: v(3)               !< difference of the velocities at the place [m/s]
    real(wp) :: arm(3)
    integer :: f, g

    f = closure%part%stems(1)
    g = closure%part%stems(2)
    w = 0.0_wp
    v = 0.0_wp
    if (f == g) return
    arm = place - p(:, f)
    v = v_frame(:, f) + cross(omega(:, f), arm)
    arm = place - p(:, g)
    v = v - v_frame(:, g) - cross(omega(:, g), arm)
    w = omega(:, f) - omega(:, g)
  end subroutine stem_difference

  !> Acceleration of the closing frame relative to the target, from the motion of both frames.
  pure subroutine opening_acceleration(closure, state, w, v)
    type(closure_type), intent(in) :: closure   !< the closure
    type(state_type), intent(in) :: state       !< with velocities and accelerations of the frames
    real(wp), intent(out) :: w(3)               !< relative angular acceleration, in the axes of frame 0 [rad/s^2]
    real(wp), intent(out) :: v(3)   !< relative acceleration at the closing frame's origin, in the axes of frame 0 [m/s^2]
    real(wp) :: arm(3), slip(3)

    associate (f => closure%closing, g => closure%target)
      arm = state%p(:, f) - state%p(:, g)
      slip = cross(state%omega(:, g), arm)
      w = state%alpha(:, f) - state%alpha(:, g)
      v = state%a(:, f) - state%a(:, g) - cross(state%alpha(:, g), arm) - cross(state%omega(:, g), slip)
    end associate
  end subroutine opening_acceleration

  !> The error pose of a closure as a screw at the closing frame's origin, in the axes of frame 0.
  pure subroutine error_screw(closure, state, w, v, place)
    type(closure_type), intent(in) :: closure   !< the closure
    type(state_type), intent(in) :: state       !< with the poses of the frames
    real(wp), intent(out) :: w(3)   !< rotation vector from the target pose to the closing frame, in the axes of frame 0 [rad]
    real(wp), intent(out) :: v(3)   !< from the target pose's origin to that of the closing frame, in the axes of frame 0 [m]
    real(wp), intent(out) :: place(3)           !< the closing frame's origin, from that of frame 0 [m]
    real(wp) :: r_target(3, 3)

    associate (g => closure%target)
      r_target = combine(state%r(:, :, g), closure%in_target%r)
      place = state%p(:, closure%closing)
      v = place - state%p(:, g) - turn(state%r(:, :, g), closure%in_target%p)
      w = rotation_between(r_target, state%r(:, :, closure%closing))
    end associate
  end subroutine error_screw

  !> The independent components of a screw that is given at `place` in the axes of frame 0.
  pure subroutine reduced_screw(plan, closure, state, w, v, place, components)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(closure_type), intent(in) :: closure   !< the closure
    type(state_type), intent(in) :: state       !< with the poses of the frames
    real(wp), intent(in) :: w(3)                !< angular part [rad], or its derivative
    real(wp), intent(in) :: v(3)                !< translation of the place [m], or its derivative
    real(wp), intent(in) :: place(3)            !< from the origin of frame 0 [m]
    real(wp), intent(out) :: components(:)      !< (rank) [rad, lengths of the mechanism], or derivatives of these
    real(wp) :: screw(6)
    integer :: i

    if (closure%rank == 6) then
      components(1:3) = w
      components(4:6) = v/plan%length
      return
    end if
    screw = loop_screw(plan, closure, state, w, v, place)
    do i = 1, closure%rank
      components(i) = dot_product(closure%rows(:, i), screw)
    end do
  end subroutine reduced_screw

  !> A screw given at `place` in the axes of frame 0, moved to the base frame of a loop; lengths are divided by the mechanism's
  !> length.
  pure function loop_screw(plan, closure, state, w, v, place) result(screw)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(closure_type), intent(in) :: closure   !< the closure
    type(state_type), intent(in) :: state       !< with the poses of the frames
    real(wp), intent(in) :: w(3)                !< angular part [rad], or its derivative
    real(wp), intent(in) :: v(3)                !< translation of the place [m], or its derivative
    real(wp), intent(in) :: place(3)            !< from the origin of frame 0 [m]
    real(wp) :: screw(6), v_base(3), arm(3)

    arm = state%p(:, closure%base) - place
    v_base = (v + cross(w, arm))/plan%length
    if (closure%base == 0) then
      screw(1:3) = w
      screw(4:6) = v_base
    else
      screw(1:3) = turn_back(state%r(:, :, closure%base), w)
      screw(4:6) = turn_back(state%r(:, :, closure%base), v_base)
    end if
  end function loop_screw
end module mech9_spatial_closure
