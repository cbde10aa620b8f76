!> The forces of closed chains that dependent coordinates require, and the forces that remain for the independent ones: the
!> transposed equations of the blocks, from the last block to the first.
module mech9_loop_forces
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_rotation, only: turn_back, cross
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_equations, only: constraint_wrench
  use mech9_coupling_constraint, only: bent_force
  use mech9_block_solver, only: block_work_type
  use mech9_tree_forces, only: loop_wrench_type
  implicit none
  private
  public :: loop_forces_type, new_loop_forces, eliminate_dependent, draw_idle_forces, loop_wrenches, vary_couplings, &
    coupling_force, coupling_multiplier

  !> The forces of the equations of one block, and scratch.
  type :: multipliers_type
    real(wp), allocatable :: right(:)      !< (unknowns) right-hand side
    real(wp), allocatable :: values(:)     !< (equations of the block) their forces
  end type multipliers_type

  !> The forces of the equations of all blocks.
  type :: loop_forces_type
    type(multipliers_type), allocatable :: blocks(:)
  end type loop_forces_type

contains

  !> Room for the forces of closed chains.
  pure function new_loop_forces(plan) result(loops)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism, in space
    type(loop_forces_type) :: loops
    integer :: b

    allocate (loops%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        allocate (loops%blocks(b)%right(size(block%unknowns)), loops%blocks(b)%values(block%equations), source=0.0_wp)
      end associate
    end do
  end function new_loop_forces

  !> Eliminate the forces of dependent coordinates by those of the closed chains. The forces of the independent coordinates then
  !> include all that the dependent ones hand on; those of dependent coordinates are zero.
  subroutine eliminate_dependent(plan, state, work, loops, forces)
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state             !< position of the mechanism
    type(block_work_type), intent(inout) :: work(:)   !< (blocks) with the factors of their Jacobians
    type(loop_forces_type), intent(inout) :: loops    !< gets the multipliers
    real(wp), intent(inout) :: forces(:)              !< (M) forces on the coordinates [N m, N]
    integer :: b

    do b = size(plan%blocks), 1, -1
      loops%blocks(b)%values = 0.0_wp
      if (size(plan%blocks(b)%unknowns) == 0) cycle
      associate (block => plan%blocks(b), multipliers => loops%blocks(b))
        multipliers%right = forces(block%coordinates)*plan%unit_of(block%coordinates)
        call work(b)%equations%solve_transposed(multipliers%right, multipliers%values)
        call hand_on(plan, block, state, multipliers%values, forces)
        forces(block%coordinates) = 0.0_wp
      end associate
    end do
  end subroutine eliminate_dependent

  !> Forces of closed chains and couplings, at random, that together have no effect on any coordinate: there are some where
  !> equations are redundant, and all others are zero.
  subroutine draw_idle_forces(plan, state, work, loops, random)
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(state_type), intent(in) :: state             !< position of the mechanism
    type(block_work_type), intent(inout) :: work(:)   !< (blocks) with the factors of their Jacobians
    type(loop_forces_type), intent(inout) :: loops    !< gets the multipliers
    type(random_type), intent(inout) :: random        !< source of the numbers
    type(loop_forces_type) :: drawn
    real(wp) :: forces(plan%n_coordinates)
    integer :: b, i

    drawn = loops
    forces = 0.0_wp
    do b = 1, size(plan%blocks)
      do i = 1, size(drawn%blocks(b)%values)
        drawn%blocks(b)%values(i) = random%symmetric()
      end do
      call hand_on(plan, plan%blocks(b), state, drawn%blocks(b)%values, forces)
    end do
    ! the equations determine the effect of the drawn forces; only the rest has none
    call eliminate_dependent(plan, state, work, loops, forces)
    do b = 1, size(plan%blocks)
      loops%blocks(b)%values = loops%blocks(b)%values + drawn%blocks(b)%values
    end do
  end subroutine draw_idle_forces

  !> Subtract the forces of the chains of a block on all coordinates of their loops.
  subroutine hand_on(plan, block, state, multipliers, forces)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism, in space
    type(block_type), intent(in) :: block      !< the block
    type(state_type), intent(in) :: state      !< position of the mechanism
    real(wp), intent(in) :: multipliers(:)     !< (equations of the block)
    real(wp), intent(inout) :: forces(:)       !< (M) forces on the coordinates [N m, N]
    real(wp) :: column(6)
    integer :: c, i, k, n, row

    row = 0
    do c = block%first_closure, block%last_closure
      n = plan%constraints(c)%item%equations
      associate (loop => plan%closures(c)%loop)
        do i = 1, size(loop%steps)
          k = plan%steps(loop%steps(i))%coordinate
          call plan%constraints(c)%item%column(plan, loop%steps(i), loop%signs(i), state, column(:n))
          forces(k) = forces(k) - dot_product(column(:n), multipliers(row + 1:row + n))/plan%unit_of(k)
        end do
      end associate
      row = row + n
    end do
  end subroutine hand_on

  !> Subtract the change of the forces of couplings on coordinates that vary, with the multipliers held.
  subroutine vary_couplings(plan, state, loops, q, forces)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state          !< position of the mechanism
    type(loop_forces_type), intent(in) :: loops    !< with the multipliers
    real(wp), intent(in) :: q(:)                   !< (M) variations of the coordinates
    real(wp), intent(inout) :: forces(:)           !< (M) forces on the coordinates that the varied motion requires [N m, N]
    integer :: b, c, row

    do b = 1, size(plan%blocks)
      row = 0
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        if (plan%closures(c)%coupling > 0) call bent_force(plan, c, state, -loops%blocks(b)%values(row + 1), q, forces)
        row = row + plan%constraints(c)%item%equations
      end do
    end do
  end subroutine vary_couplings

  !> The multiplier of the weighed equation of a coupling.
  pure real(wp) function coupling_multiplier(plan, b, c, loops) result(multiplier)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer, intent(in) :: b                       !< number of the block
    integer, intent(in) :: c                       !< number of its closure that is the coupling
    type(loop_forces_type), intent(in) :: loops    !< with the multipliers

    multiplier = loops%blocks(b)%values(sum(plan%closures(plan%blocks(b)%first_closure:c)%rank))
  end function coupling_multiplier

  !> The generalized force that a coupling exerts on one of its coordinates.
  pure real(wp) function coupling_force(plan, c, k, state, multiplier) result(force)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer, intent(in) :: c                       !< number of the closure that is the coupling
    integer, intent(in) :: k                       !< number of the coordinate
    type(state_type), intent(in) :: state          !< position of the mechanism
    real(wp), intent(in) :: multiplier             !< of the weighed equation
    real(wp) :: values(1)

    call plan%constraints(c)%item%column(plan, plan%step_of(k), 1.0_wp, state, values)
    force = values(1)*multiplier/plan%unit_of(k)
  end function coupling_force

  !> The forces of the closed chains from their multipliers.
  subroutine loop_wrenches(plan, state, loops, wrenches)
    type(plan_type), intent(in) :: plan                      !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                    !< position of the mechanism
    type(loop_forces_type), intent(in) :: loops              !< with the multipliers
    type(loop_wrench_type), intent(out) :: wrenches(:)       !< (closures)
    real(wp) :: force(3), moment(3), arm(3)
    integer :: b, c, n, row

    do b = 1, size(plan%blocks)
      row = 0
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        n = plan%constraints(c)%item%equations
        call constraint_wrench(plan, c, state, loops%blocks(b)%values(row + 1:row + n), force, moment)
        associate (base => plan%closures(c)%base)
          ! from the origin of the closing frame to that of the base
          arm = state%p(:, plan%closures(c)%closing) - state%p(:, base)
          moment = moment + cross(arm, force)
          wrenches(c)%force = turn_back(state%r(:, :, base), force)
          wrenches(c)%moment = turn_back(state%r(:, :, base), moment)
        end associate
        row = row + n
      end do
    end do
  end subroutine loop_wrenches
end module mech9_loop_forces
