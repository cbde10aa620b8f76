!> Closures of a block, (12): by how much its chains fail to close, in independent equations, and the
!> exact Jacobian. Uses kinds, rotation, plan, state, planar_closure.
!>
!> The twelve scalars of (12) hold at most six independent ones. They are replaced by the screw of
!> the error pose: the rotation vector that turns the target onto the closing frame, and the distance
!> between the two. The screw is written at the base frame of the loop, where the space of motions of
!> the loop is constant, and the closure's constant rows pick its independent components. Rotations
!> count in rad, translations in lengths of the mechanism.
module mech9_closure
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, combine, cross, rotation_vector
  use mech9_plan, only: plan_type, closure_type, block_type
  use mech9_state, only: state_type, velocity_known
  use mech9_planar_closure, only: planar_errors, planar_columns, planar_path_rates, planar_path_bias, planar_gap
  implicit none
  private
  public :: closure_errors, closure_jacobian, closure_column, closure_rates, closing_error, loop_screw, reduced_screw

contains

  !> What the closures of a block lack: (equations), rotations in rad and translations in lengths.
  pure subroutine closure_errors(plan, block, state, errors)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    real(wp), intent(out), contiguous :: errors(:)
    real(wp) :: w(3), v(3), place(3)
    integer :: c, row

    if (plan%planar%used) then
      call planar_errors(plan%planar, block%first_closure, block%last_closure, state%planar, errors)
      return
    end if
    row = 0
    do c = block%first_closure, block%last_closure
      call error_screw(plan%closures(c), state, w, v, place)
      call reduced_screw(plan, plan%closures(c), state, w, v, place, errors(row + 1:row + plan%closures(c)%rank))
      row = row + plan%closures(c)%rank
    end do
  end subroutine closure_errors

  !> Derivatives of the block's equations with respect to its dependent coordinates, each coordinate
  !> in its own unit (rad, or the mechanism's length): (equations, unknowns).
  pure subroutine closure_jacobian(plan, block, state, column_of, jacobian)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    integer, intent(in), contiguous :: column_of(:)   !< column of each of the block's steps; 0: not an unknown
    real(wp), intent(out), contiguous :: jacobian(:, :)
    integer :: c, i, s, row, column

    jacobian = 0.0_wp
    if (plan%planar%used) then
      call planar_jacobian(plan, block, state, column_of, jacobian)
      return
    end if
    row = 0
    do c = block%first_closure, block%last_closure
      associate (closure => plan%closures(c))
        do i = 1, size(closure%path%steps)
          s = closure%path%steps(i)
          if (s < block%first_step) cycle
          column = column_of(s - block%first_step + 1)
          if (column == 0) cycle
          call closure_column(plan, c, s, closure%path%signs(i), state, jacobian(row + 1:row + closure%rank, column))
        end do
        row = row + closure%rank
      end associate
    end do
  end subroutine closure_jacobian

  !> The same in planar arithmetic.
  pure subroutine planar_jacobian(plan, block, state, column_of, jacobian)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    integer, intent(in), contiguous :: column_of(:)
    real(wp), intent(inout), contiguous :: jacobian(:, :)
    integer :: c

    do c = block%first_closure, block%last_closure
      associate (path => plan%closures(c)%path)
        call planar_columns(plan%planar, c, size(path%steps), path%steps, path%signs, block%first_step, block%last_step, &
                            column_of, state%planar, size(jacobian, 1), size(jacobian, 2), &
                            3*(c - block%first_closure), jacobian)
      end associate
    end do
  end subroutine planar_jacobian

  !> Derivatives of a closure's equations with respect to the coordinate of one step, in its unit.
  pure subroutine closure_column(plan, c, s, sign, state, column)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: c, s
    real(wp), intent(in) :: sign              !< of the step in the loop, as in its path
    type(state_type), intent(in) :: state
    real(wp), intent(out), contiguous :: column(:)
    real(wp) :: arm(3), w(3), v(3), unit

    if (plan%planar%used) then
      call planar_columns(plan%planar, c, 1, [s], [sign], s, s, [1], state%planar, 3, 1, 0, column)
      return
    end if
    associate (place => state%p(:, plan%closures(c)%closing))
      unit = sign*plan%unit_of(plan%steps(s)%coordinate)
      w = unit*state%axis_w(:, s)
      arm = place - state%p(:, s)
      v = unit*state%axis_v(:, s) + cross(w, arm)
      call reduced_screw(plan, plan%closures(c), state, w, v, place, column)
    end associate
  end subroutine closure_column

  !> How fast the block's closures open at the rates in `state`, or at its accelerations. The frames of blocks
  !> before it must move as these say; of its own frames no accelerations are needed, and no velocities for the
  !> first.
  pure subroutine closure_rates(plan, block, state, order, rates)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    integer, intent(in) :: order          !< velocity_known or acceleration_known: which of them
    real(wp), intent(out), contiguous :: rates(:)
    real(wp) :: w(3), v(3)
    integer :: c, row

    row = 0
    do c = block%first_closure, block%last_closure
      associate (closure => plan%closures(c))
        if (plan%planar%used) then
          if (order == velocity_known) then
            call planar_path_rates(plan%planar, c, size(closure%path%steps), closure%path%steps, closure%path%signs, &
                              closure%path%stems, state%dq, state%planar, rates(row + 1:row + 3))
          else
            call planar_path_bias(plan%planar, c, size(closure%path%steps), closure%path%steps, closure%path%signs, &
                                   closure%path%stems, state%dq, state%ddq, state%planar, rates(row + 1:row + 3))
          end if
        else
          if (order == velocity_known) then
            call opening_velocity(plan, closure, state, w, v)
          else
            call opening_acceleration(plan, closure, state, w, v)
          end if
          call reduced_screw(plan, closure, state, w, v, state%p(:, closure%closing), rates(row + 1:row + closure%rank))
        end if
        row = row + closure%rank
      end associate
    end do
  end subroutine closure_rates

  !> Velocity of a closure's closing frame against what its target carries along.
  pure subroutine opening_velocity(plan, closure, state, w, v)
    type(plan_type), intent(in) :: plan
    type(closure_type), intent(in) :: closure
    type(state_type), intent(in) :: state
    real(wp), intent(out) :: w(3), v(3)
    real(wp) :: place(3), arm(3), spin(3), rate
    integer :: i, s

    place = state%p(:, closure%closing)
    call stem_difference(closure, place, state%p, state%omega, state%v, w, v)
    do i = 1, size(closure%path%steps)
      s = closure%path%steps(i)
      rate = closure%path%signs(i)*state%dq(plan%steps(s)%coordinate)
      if (.not. abs(rate) > 0.0_wp) cycle
      spin = rate*state%axis_w(:, s)
      arm = place - state%p(:, s)
      w = w + spin
      v = v + rate*state%axis_v(:, s) + cross(spin, arm)
    end do
  end subroutine opening_velocity

  !> What the two frames where the path of a closure begins would carry past each other at a place: the difference
  !> of their velocities, or of accelerations without those of turning on.
  pure subroutine stem_difference(closure, place, p, omega, v_frame, w, v)
    type(closure_type), intent(in) :: closure
    real(wp), intent(in) :: place(3), p(:, 0:), omega(:, 0:), v_frame(:, 0:)
    real(wp), intent(out) :: w(3), v(3)
    real(wp) :: arm(3)
    integer :: f, g

    f = closure%path%stems(1)
    g = closure%path%stems(2)
    w = 0.0_wp
    v = 0.0_wp
    if (f == g) return
    arm = place - p(:, f)
    v = v_frame(:, f) + cross(omega(:, f), arm)
    arm = place - p(:, g)
    v = v - v_frame(:, g) - cross(omega(:, g), arm)
    w = omega(:, f) - omega(:, g)
  end subroutine stem_difference

  !> Its acceleration, likewise.
  pure subroutine opening_acceleration(plan, closure, state, w, v)
    type(plan_type), intent(in) :: plan
    type(closure_type), intent(in) :: closure
    type(state_type), intent(in) :: state
    real(wp), intent(out) :: w(3), v(3)
    real(wp) :: place(3), arm(3), spin(3), slip(3), rate, acceleration
    integer :: i, s, f

    place = state%p(:, closure%closing)
    call stem_difference(closure, place, state%p, state%alpha, state%a, w, v)
    do i = 1, size(closure%path%steps)
      s = closure%path%steps(i)
      f = plan%steps(s)%parent
      rate = state%dq(plan%steps(s)%coordinate)
      acceleration = state%ddq(plan%steps(s)%coordinate)
      arm = state%p(:, s) - state%p(:, f)
      spin = rate*state%axis_w(:, s)
      slip = cross(state%omega(:, f), arm) + 2.0_wp*rate*state%axis_v(:, s)
      spin = acceleration*state%axis_w(:, s) + cross(state%omega(:, f), spin)
      slip = acceleration*state%axis_v(:, s) + cross(state%omega(:, f), slip)
      if (.not. plan%steps(s)%is_screw) then
        spin = spin + rate**2*state%axis_w_rate(:, s)
        slip = slip + rate**2*state%axis_v_rate(:, s)
      end if
      w = w + closure%path%signs(i)*spin
      arm = place - state%p(:, s)
      v = v + closure%path%signs(i)*(slip + cross(spin, arm))
    end do
    f = closure%target
    arm = place - state%p(:, f)
    slip = cross(state%omega(:, f), arm)
    v = v - cross(state%omega(:, f), slip)
  end subroutine opening_acceleration

  !> How far a closure is from closed, all six components: a length [m], rotations times the mechanism's size.
  pure real(wp) function closing_error(plan, c, state)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: c
    type(state_type), intent(in) :: state
    real(wp) :: w(3), v(3), place(3)

    if (plan%planar%used) then
      closing_error = planar_gap(plan%planar, c, state%planar)
      return
    end if
    call error_screw(plan%closures(c), state, w, v, place)
    closing_error = max(norm2(v), plan%length*norm2(w))
  end function closing_error

  !> Error pose of a closure as a screw at the closing frame's origin, in the axes of frame 0.
  pure subroutine error_screw(closure, state, w, v, place)
    type(closure_type), intent(in) :: closure
    type(state_type), intent(in) :: state
    real(wp), intent(out) :: w(3), v(3), place(3)
    real(wp) :: r_target(3, 3), r_error(3, 3)
    integer :: i

    associate (g => closure%target)
      r_target = combine(state%r(:, :, g), closure%in_target%r)
      place = state%p(:, closure%closing)
      v = place - state%p(:, g) - turn(state%r(:, :, g), closure%in_target%p)
      do i = 1, 3
        r_error(:, i) = turn_back(r_target, state%r(:, i, closure%closing))
      end do
      w = turn(r_target, rotation_vector(r_error))
    end associate
  end subroutine error_screw

  !> The independent components of a screw that is given at `place` in the axes of frame 0.
  pure subroutine reduced_screw(plan, closure, state, w, v, place, components)
    type(plan_type), intent(in) :: plan
    type(closure_type), intent(in) :: closure
    type(state_type), intent(in) :: state
    real(wp), intent(in) :: w(3), v(3), place(3)
    real(wp), intent(out) :: components(:)
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

  !> A screw given at `place` in the axes of frame 0, moved to the base frame of a loop, lengths scaled.
  pure function loop_screw(plan, closure, state, w, v, place) result(screw)
    type(plan_type), intent(in) :: plan
    type(closure_type), intent(in) :: closure
    type(state_type), intent(in) :: state
    real(wp), intent(in) :: w(3), v(3), place(3)
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
end module mech9_closure
