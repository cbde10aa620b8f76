!> Lagrange's equations in space: columns of frames and inertia of links. Vectors are in fixed axes.
module mech9_spatial_lagrange
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_plan, only: plan_type, block_type, step_type
  use mech9_state, only: state_type
  use mech9_frame_columns, only: jacobian_type
  use mech9_lagrange_types, only: frame_body_type, dynamics_plan_type, lagrange_work_type
  implicit none
  private
  public :: spread_columns, add_body

contains

  !> Outward recursion of the columns of those frames of a block that are marked. Vectors are in fixed axes.
  pure subroutine spread_columns(plan, block, first, parent_entry, marked, state, jacobian)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    type(block_type), intent(in) :: block            !< the block
    integer, intent(in) :: first(0:*)                !< (0:M+1) first entry of each frame
    integer, intent(in) :: parent_entry(*)           !< (entries) the same column in the parent frame, 0 for none
    logical, intent(in) :: marked(0:*)               !< (0:M) the columns of the frame are found
    type(state_type), intent(in) :: state            !< with origins of the frames and screws of the steps
    type(jacobian_type), intent(inout) :: jacobian   !< with `b`; gets the columns of these frames

    call spread(plan%steps, state%p, state%axis_w, state%axis_v, jacobian%b, jacobian%w, jacobian%v)

  contains

    !> The same from plain arrays.
    pure subroutine spread(steps, p, axis_w, axis_v, b, w, v)
      type(step_type), intent(in) :: steps(*)   !< the steps of the plan
      real(wp), intent(in) :: p(3, 0:*)         !< origin of each frame [m]
      real(wp), intent(in) :: axis_w(3, *)      !< (3,M) angular velocity that each step gives per unit rate, fixed axes [1, rad/m]
      real(wp), intent(in) :: axis_v(3, *)      !< (3,M) velocity of the new origin per unit rate, fixed axes [m/rad, 1]
      real(wp), intent(in) :: b(*)              !< (entries) B, rate of the step's coordinate per unit rate of an independent one [1, rad/m, m/rad]
      real(wp), intent(inout) :: w(3, *)        !< (3,entries) gets the angular velocities per unit rate of an independent coordinate, fixed axes [1, rad/m]
      real(wp), intent(inout) :: v(3, *)        !< (3,entries) gets the velocities of the origins per unit rate of an independent coordinate, fixed axes [m/rad, 1]
      real(wp) :: x, y, z
      integer :: s, e, k

      do s = block%first_step, block%last_step
        if (.not. marked(s)) cycle
        x = p(1, s) - p(1, steps(s)%parent)
        y = p(2, s) - p(2, steps(s)%parent)
        z = p(3, s) - p(3, steps(s)%parent)
        do e = first(s), first(s + 1) - 1
          w(:, e) = b(e)*axis_w(:, s)
          v(:, e) = b(e)*axis_v(:, s)
          k = parent_entry(e)
          if (k == 0) cycle
          w(:, e) = w(:, e) + w(:, k)
          v(1, e) = v(1, e) + v(1, k) + w(2, k)*z - w(3, k)*y
          v(2, e) = v(2, e) + v(2, k) + w(3, k)*x - w(1, k)*z
          v(3, e) = v(3, e) + v(3, k) + w(1, k)*y - w(2, k)*x
        end do
      end do
    end subroutine spread
  end subroutine spread_columns

  !> Add the coefficients, velocity terms and weight of one body.
  pure subroutine add_body(dynamics, body, state, work)
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(frame_body_type), intent(in) :: body          !< the body
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the entries of the Jacobian; gets the sums
    real(wp) :: arm(3), force(3), torque(3), j_c(3), momentum(3), spin(3)
    integer :: f, e, d, p, r

    f = body%frame
    arm = turn(state%r(:, :, f), body%centre)
    force = body%mass*(state%a(:, f) + cross(state%alpha(:, f), arm) &
                       + cross(state%omega(:, f), cross(state%omega(:, f), arm)))
    torque = 0.0_wp
    if (.not. body%is_point) then
      spin = inertia_times(body, state%r(:, :, f), state%omega(:, f))
      torque = inertia_times(body, state%r(:, :, f), state%alpha(:, f)) + cross(state%omega(:, f), spin)
    end if
    do e = dynamics%first(f), dynamics%first(f + 1) - 1
      p = dynamics%column(e)
      j_c = work%jacobian%v(:, e) + cross(work%jacobian%w(:, e), arm)
      work%velocity_terms(p) = work%velocity_terms(p) + dot_product(j_c, force) &
                               + dot_product(work%jacobian%w(:, e), torque)
      work%forces(p) = work%forces(p) + body%mass*dot_product(j_c, dynamics%gravity)
      momentum = body%mass*j_c
      spin = cross(arm, momentum)
      if (.not. body%is_point) spin = spin + inertia_times(body, state%r(:, :, f), work%jacobian%w(:, e))
      ! J_c,r = J_v,r + J_w,r x arm, so that J_c,r . m J_c,p splits into J_v,r and J_w,r
      do d = e, dynamics%first(f + 1) - 1
        r = dynamics%column(d)
        work%coefficients(r, p) = work%coefficients(r, p) + dot_product(work%jacobian%v(:, d), momentum) &
                                  + dot_product(work%jacobian%w(:, d), spin)
      end do
    end do
  end subroutine add_body

  !> The product of a body's inertia tensor about its centre, in fixed axes, and a vector.
  pure function inertia_times(body, r, vector) result(product)
    type(frame_body_type), intent(in) :: body   !< the body
    real(wp), intent(in) :: r(3, 3)             !< rotation of its frame
    real(wp), intent(in) :: vector(3)           !< in fixed axes
    real(wp) :: product(3)                   !< in fixed axes

    product = turn(r, turn(body%inertia, turn_back(r, vector)))
  end function inertia_times
end module mech9_spatial_lagrange
