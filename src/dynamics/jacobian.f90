!> Jacobians of frames with respect to the independent coordinates, with the dependent coordinates eliminated block by block.
module mech9_jacobian
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_planar_closure, only: planar_difference
  use mech9_block_solver, only: block_work_type
  use mech9_dynamics_plan, only: dynamics_plan_type
  use mech9_planar_lagrange, only: spread_columns
  use mech9_spatial_closure, only: reduced_screw
  implicit none
  private
  public :: jacobian_type, new_jacobian, find_jacobian, noise_of_rates

  !> Round-off of rates where a block is well conditioned. Near a singular position closed positions
  !> are uncertain by round-off over the pivot, and rates by that over the pivot again.
  real(wp), parameter :: noise_of_rates = 64.0_wp*epsilon(1.0_wp)

  !> Entries as in the dynamics plan: derivatives of a frame's angular velocity and of the velocity of its
  !> origin (fixed axes) by the rate of an independent coordinate; `b` is dq_k/dq_i of the step's coordinate.
  type :: jacobian_type
    real(wp), allocatable :: w(:, :)    !< (3, entries)
    real(wp), allocatable :: v(:, :)    !< (3, entries)
    real(wp), allocatable :: flat(:, :) !< (3, entries) in planar arithmetic, instead of both
    real(wp), allocatable :: b(:)       !< (entries)
  end type jacobian_type

contains

  !> Room for the entries that the dynamics plan lists, all zero but what independent coordinates are to themselves.
  pure function new_jacobian(plan, dynamics) result(jacobian)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(jacobian_type) :: jacobian
    integer :: s, e

    if (plan%planar%used) then
      allocate (jacobian%flat(3, size(dynamics%column)), source=0.0_wp)
    else
      allocate (jacobian%w(3, size(dynamics%column)), jacobian%v(3, size(dynamics%column)), source=0.0_wp)
    end if
    allocate (jacobian%b(size(dynamics%column)), source=0.0_wp)
    do s = 1, plan%n_coordinates
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        if (plan%steps(s)%dependent) cycle
        if (dynamics%column(e) == dynamics%place_of(plan%steps(s)%coordinate)) jacobian%b(e) = 1.0_wp
      end do
    end do
  end function new_jacobian

  !> The entries of a block's frames and its part of B = dq/dq_i. Frames must be in place, the block's
  !> Jacobian factorized, earlier blocks done. Where a dependent coordinate is determined no better than
  !> by noise, near a position where branches meet, it keeps to `expected`: the tangent is continued.
  subroutine find_jacobian(plan, dynamics, block, state, expected, work, jacobian)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    real(wp), intent(in) :: expected(:)       !< (entries) B as it was found before, continued
    type(block_work_type), intent(inout) :: work
    type(jacobian_type), intent(inout) :: jacobian
    integer :: s, e, c

    do s = block%first_step, block%last_step
      if (.not. plan%steps(s)%dependent) cycle
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        jacobian%b(e) = expected(e)
      end do
    end do
    if (size(block%unknowns) > 0) then
      call spread_jacobian(plan, dynamics, block, state, .true., jacobian)
      do c = 1, dynamics%first(block%first_step + 1) - dynamics%first(block%first_step)
        call eliminate(plan, dynamics, block, state, c - 1, work, jacobian)
      end do
    end if
    call spread_jacobian(plan, dynamics, block, state, .false., jacobian)
  end subroutine find_jacobian

  !> Outward recursion of the entries over the steps of a block.
  pure subroutine spread_jacobian(plan, dynamics, block, state, all_frames, jacobian)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    logical, intent(in) :: all_frames        !< also those that carry nothing
    type(jacobian_type), intent(inout) :: jacobian
    real(wp) :: arm(3)
    integer :: s, e, p

    if (plan%planar%used) then
      call spread_columns(plan%n_coordinates, size(jacobian%b), plan%planar%steps, block%first_step, block%last_step, &
                          dynamics%first, dynamics%parent_entry, dynamics%carries, all_frames, jacobian%b, &
                          state%planar%pose, state%planar%slide, jacobian%flat)
      return
    end if
    do s = block%first_step, block%last_step
      if (.not. (all_frames .or. dynamics%carries(s))) cycle
      arm = state%p(:, s) - state%p(:, plan%steps(s)%parent)
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        jacobian%w(:, e) = jacobian%b(e)*state%axis_w(:, s)
        jacobian%v(:, e) = jacobian%b(e)*state%axis_v(:, s)
        p = dynamics%parent_entry(e)
        if (p == 0) cycle
        jacobian%w(:, e) = jacobian%w(:, e) + jacobian%w(:, p)
        jacobian%v(:, e) = jacobian%v(:, e) + jacobian%v(:, p) + cross(jacobian%w(:, p), arm)
      end do
    end do
  end subroutine spread_jacobian

  !> Rates of the block's dependent coordinates for one independent coordinate, number `offset` + 1
  !> of the block's, from what is expected: J_d (change of b_d) = -(what opens the closures).
  subroutine eliminate(plan, dynamics, block, state, offset, work, jacobian)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: offset
    type(block_work_type), intent(inout) :: work
    type(jacobian_type), intent(inout) :: jacobian
    integer :: c, e, row, i, s, k

    row = 0
    do c = block%first_closure, block%last_closure
      associate (rank => plan%closures(c)%rank)
        e = dynamics%first(plan%closures(c)%closing) + offset
        call closing_column(plan, c, state, jacobian, e, dynamics%target_entry(e), work%right(row + 1:row + rank))
        row = row + rank
      end associate
    end do
    work%right = -work%right
    k = plan%independent(dynamics%column(dynamics%first(block%first_step) + offset))
    call work%equations%solve(work%right, work%change, noise=noise_of_rates/plan%unit_of(k))
    do i = 1, size(block%unknowns)
      s = block%unknowns(i)
      e = dynamics%first(s) + offset
      jacobian%b(e) = jacobian%b(e) + work%change(i)*plan%unit_of(plan%steps(s)%coordinate)
    end do
  end subroutine eliminate

  !> By what an entry of a closing frame opens its closure.
  pure subroutine closing_column(plan, c, state, jacobian, e, t, column)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: c
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(jacobian_type), intent(in) :: jacobian
    integer, intent(in) :: e, t              !< entry of the closing frame and the same of its target; 0 for none
    real(wp), intent(out), contiguous :: column(:)
    real(wp) :: w(3), v(3), arm(3)

    if (plan%planar%used) then
      w = 0.0_wp
      if (t > 0) w = jacobian%flat(:, t)
      call planar_difference(plan%planar, c, state%planar, jacobian%flat(:, e), w, column)
      return
    end if
    associate (closure => plan%closures(c))
      w = jacobian%w(:, e)
      v = jacobian%v(:, e)
      if (t > 0) then
        arm = state%p(:, closure%closing) - state%p(:, closure%target)
        w = w - jacobian%w(:, t)
        v = v - jacobian%v(:, t) - cross(jacobian%w(:, t), arm)
      end if
      call reduced_screw(plan, closure, state, w, v, state%p(:, closure%closing), column)
    end associate
  end subroutine closing_column
end module mech9_jacobian
