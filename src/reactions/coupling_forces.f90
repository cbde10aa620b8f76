!> The forces of couplings on their coordinates, by the transposed equations of the blocks.
!>
!> Each coordinate requires a generalized force for the motion of all links beyond it. The forces of closed chains and couplings
!> give those that dependent coordinates require: J_d^T y = required forces, with J_d of the blocks from the last one to the
!> first. The part of a coupling's equation in y is its force. It then counts as a load on its coordinates.
module mech9_coupling_forces
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_tolerances, only: rank_tolerance_for
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_loop_forces, only: loop_forces_type, new_loop_forces, eliminate_dependent, draw_idle_forces, coupling_force, &
    coupling_multiplier
  use mech9_reaction_plan, only: reaction_plan_type
  use mech9_required_wrenches, only: required_wrenches_type
  implicit none
  private
  public :: coupling_forces_type, new_coupling_forces, add_couplings, draw_idle_couplings

  !> Forces of all couplings, and scratch.
  type :: coupling_forces_type
    real(wp), allocatable :: values(:)   !< (couplings) generalized force on the second coordinate of each [N m, N]
    !> (M) largest of the forces of couplings and of the loads whose sum acts on each coordinate; the sum has its round-off [N m, N]
    real(wp), allocatable :: largest(:)
    type(block_work_type), allocatable, private :: blocks(:)   !< with the factors of their Jacobians
    type(loop_forces_type), private :: loops                   !< forces of the equations of all blocks
    real(wp), allocatable, private :: multipliers(:)           !< (couplings) of their weighed equations
    integer, private :: redundant = 0                          !< number of redundant equations of all blocks
    real(wp), allocatable, private :: required(:)              !< (M) forces that the coordinates require [N m, N]
    real(wp), allocatable, private :: together(:)              !< (M) forces of all couplings on the coordinates [N m, N]
  end type coupling_forces_type

contains

  !> Room for the forces of couplings; of no size where there is none.
  pure function new_coupling_forces(plan) result(self)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism, with all blocks
    type(coupling_forces_type) :: self
    integer :: b

    allocate (self%values(size(plan%couplings)), self%largest(plan%n_coordinates), source=0.0_wp)
    if (size(plan%couplings) == 0) return
    allocate (self%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      self%blocks(b) = new_block_work(plan%blocks(b))
      self%redundant = self%redundant + plan%blocks(b)%equations - size(plan%blocks(b)%unknowns)
    end do
    self%loops = new_loop_forces(plan)
    allocate (self%multipliers(size(plan%couplings)), source=0.0_wp)
    allocate (self%required(plan%n_coordinates), self%together(plan%n_coordinates), source=0.0_wp)
  end function new_coupling_forces

  !> Find the forces of couplings, and add them to the loads on the coordinates.
  subroutine add_couplings(plan, reactions, state, links, self)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, with all blocks
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(state_type), intent(in) :: state                 !< the position
    type(required_wrenches_type), intent(inout) :: links  !< requirements of each link with all beyond it; loads on coordinates grow
    type(coupling_forces_type), intent(inout) :: self     !< gets the forces

    if (size(plan%couplings) == 0) return
    call require(plan, reactions, links, self%required)
    if (links%loads%any_generalized) self%required = self%required - links%loads%generalized
    call factorize(plan, state, self)
    call eliminate_dependent(plan, state, self%blocks, self%loops, self%required)
    call take_multipliers(plan, self%loops, self%multipliers)
    call take_least(plan, state, self)
    call sum_forces(plan, state, self)
    associate (loads => links%loads)
      if (loads%any_generalized) then
        self%largest = max(self%largest, abs(loads%generalized))
        self%together = self%together + loads%generalized
      end if
      loads%generalized = self%together
      loads%any_generalized = .true.
    end associate
  end subroutine add_couplings

  !> Forces of couplings, at random, that have no effect on the motion of the links together with forces of closed chains.
  subroutine draw_idle_couplings(plan, state, random, self, multipliers, forces)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, with all blocks
    type(state_type), intent(in) :: state                 !< the position
    type(random_type), intent(inout) :: random            !< source of the numbers
    type(coupling_forces_type), intent(inout) :: self     !< scratch
    real(wp), intent(out) :: multipliers(:)               !< (couplings) of their weighed equations; zero where they are unique
    real(wp), intent(out) :: forces(:)                    !< (M) on the coordinates [N m, N]

    multipliers = 0.0_wp
    forces = 0.0_wp
    if (size(plan%couplings) == 0) return
    call factorize(plan, state, self)
    call draw_idle_forces(plan, state, self%blocks, self%loops, random)
    call take_multipliers(plan, self%loops, self%multipliers)
    call sum_forces(plan, state, self)
    multipliers = self%multipliers
    forces = self%together
  end subroutine draw_idle_couplings

  !> Factorize the equations of all blocks.
  subroutine factorize(plan, state, self)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, with all blocks
    type(state_type), intent(in) :: state                 !< the position
    type(coupling_forces_type), intent(inout) :: self     !< gets the factors
    integer :: b

    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%equations > 0) call factorize_block(plan, plan%blocks(b), state, self%blocks(b))
    end do
  end subroutine factorize

  !> The multipliers of all couplings.
  pure subroutine take_multipliers(plan, loops, multipliers)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, with all blocks
    type(loop_forces_type), intent(in) :: loops           !< with the multipliers of all blocks
    real(wp), intent(inout) :: multipliers(:)             !< (couplings) of their weighed equations
    integer :: b, c

    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        if (plan%closures(c)%coupling > 0) multipliers(plan%closures(c)%coupling) = coupling_multiplier(plan, b, c, loops)
      end do
    end do
  end subroutine take_multipliers

  !> Take off the multipliers of couplings what has no effect, so that their norm becomes the least one. Only redundant equations
  !> leave such a part.
  subroutine take_least(plan, state, self)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, with all blocks
    type(state_type), intent(in) :: state                 !< the position
    type(coupling_forces_type), intent(inout) :: self     !< with multipliers and factors of all blocks
    type(random_type) :: random
    real(wp) :: idle(size(self%multipliers), self%redundant)
    integer :: i, j, round

    do i = 1, self%redundant
      call draw_idle_forces(plan, state, self%blocks, self%loops, random)
      call take_multipliers(plan, self%loops, idle(:, i))
      if (norm2(idle(:, i)) <= rank_tolerance_for(plan%data_tolerance)) idle(:, i) = 0.0_wp
      do round = 1, 2
        do j = 1, i - 1
          idle(:, i) = idle(:, i) - dot_product(idle(:, j), idle(:, i))*idle(:, j)
        end do
      end do
      if (norm2(idle(:, i)) <= rank_tolerance_for(plan%data_tolerance)) then
        idle(:, i) = 0.0_wp
      else
        idle(:, i) = idle(:, i)/norm2(idle(:, i))
        self%multipliers = self%multipliers - dot_product(idle(:, i), self%multipliers)*idle(:, i)
      end if
    end do
  end subroutine take_least

  !> The forces of the couplings on all coordinates, and of each on its second one, from the multipliers.
  pure subroutine sum_forces(plan, state, self)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, with all blocks
    type(state_type), intent(in) :: state                 !< the position
    type(coupling_forces_type), intent(inout) :: self     !< with multipliers; gets the forces
    real(wp) :: force
    integer :: c, i, k, number

    self%together = 0.0_wp
    self%largest = 0.0_wp
    do c = 1, size(plan%closures)
      number = plan%closures(c)%coupling
      if (number == 0) cycle
      associate (coordinates => plan%couplings(number)%coupling%coordinates)
        do i = 1, size(coordinates)
          k = coordinates(i)
          force = coupling_force(plan, c, k, state, self%multipliers(number))
          self%together(k) = self%together(k) + force
          self%largest(k) = max(self%largest(k), abs(force))
        end do
        self%values(number) = coupling_force(plan, c, coordinates(2), state, self%multipliers(number))
      end associate
    end do
  end subroutine sum_forces

  !> The generalized forces that the coordinates require for all links beyond them, with all chains cut at their closing frames.
  pure subroutine require(plan, reactions, links, required)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(required_wrenches_type), intent(in) :: links     !< requirements of each link with all beyond it
    real(wp), intent(out) :: required(:)                  !< (M) [N m, N]
    real(wp) :: arm(3), about_point(3)
    integer :: i, k, link

    required = 0.0_wp
    associate (geometry => links%geometry, force => links%total_force)
      do i = 1, size(reactions%inwards)
        k = plan%steps(reactions%inwards(i))%coordinate
        link = plan%steps(reactions%inwards(i))%link
        arm = geometry%place(:, link) - geometry%point(:, k)
        about_point = links%total_moment(:, link) + cross(arm, force(:, link))
        required(k) = reactions%pairs(k)%direction*geometry%length(k)*(dot_product(geometry%axis(1:3, k), force(:, link)) &
                                                                       + dot_product(geometry%axis(4:6, k), about_point)/ &
                                                                       reactions%length)
      end do
    end associate
  end subroutine require
end module mech9_coupling_forces
