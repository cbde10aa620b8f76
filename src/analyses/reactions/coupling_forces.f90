!> The forces of couplings on their coordinates, by the transposed equations of the blocks.
!>
!> Each coordinate requires a generalized force for the motion of all links beyond it. The forces of closed chains and couplings
!> give those that dependent coordinates require: J_d^T y = required forces, with J_d of the blocks from the last one to the
!> first. The part of a coupling's equation in y is its force. It then counts as a load on its coordinates.
module mech9_coupling_forces
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_loop_forces, only: loop_forces_type, new_loop_forces, eliminate_dependent, coupling_force
  use mech9_force_sum, only: force_sum_type
  use mech9_reaction_plan, only: reaction_plan_type
  use mech9_joint_geometry, only: joint_geometry_type
  implicit none
  private
  public :: coupling_forces_type, new_coupling_forces, add_couplings

  !> Forces of all couplings, and scratch.
  type :: coupling_forces_type
    real(wp), allocatable :: values(:)   !< (couplings) generalized force on the second coordinate of each [N m, N]
    type(block_work_type), allocatable, private :: blocks(:)   !< with the factors of their Jacobians
    type(loop_forces_type), private :: loops                   !< forces of the equations of all blocks
    real(wp), allocatable, private :: required(:)              !< (M) forces that the coordinates require [N m, N]
    real(wp), allocatable, private :: together(:)              !< (M) forces of all couplings on the coordinates [N m, N]
  end type coupling_forces_type

contains

  !> Room for the forces of couplings; of no size where there is none.
  pure function new_coupling_forces(plan) result(self)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism, with all blocks
    type(coupling_forces_type) :: self
    integer :: b

    allocate (self%values(size(plan%couplings)), source=0.0_wp)
    if (size(plan%couplings) == 0) return
    allocate (self%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      self%blocks(b) = new_block_work(plan%blocks(b))
    end do
    self%loops = new_loop_forces(plan)
    allocate (self%required(plan%n_coordinates), self%together(plan%n_coordinates), source=0.0_wp)
  end function new_coupling_forces

  !> Find the forces of couplings, and add them to the loads on the coordinates.
  subroutine add_couplings(plan, reactions, state, geometry, force, moment, loads, self)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, with all blocks
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(state_type), intent(in) :: state                 !< the position
    type(joint_geometry_type), intent(in) :: geometry     !< of the position
    real(wp), intent(in), contiguous :: force(:, :)       !< (3,N) what each link requires with all beyond it, axes of link 1 [N]
    real(wp), intent(in), contiguous :: moment(:, :)      !< (3,N) about the places of the links [N m]
    type(force_sum_type), intent(inout) :: loads          !< sums of the loads; those on coordinates grow
    type(coupling_forces_type), intent(inout) :: self     !< gets the forces
    integer :: b, c, i, k

    if (size(plan%couplings) == 0) return
    call require(plan, reactions, geometry, force, moment, self%required)
    if (loads%any_generalized) self%required = self%required - loads%generalized
    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%equations > 0) call factorize_block(plan, plan%blocks(b), state, self%blocks(b))
    end do
    call eliminate_dependent(plan, state, self%blocks, self%loops, self%required)
    self%together = 0.0_wp
    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        if (plan%closures(c)%coupling == 0) cycle
        associate (coordinates => plan%couplings(plan%closures(c)%coupling)%coupling%coordinates)
          do i = 1, size(coordinates)
            k = coordinates(i)
            self%together(k) = self%together(k) + coupling_force(plan, b, c, k, state, self%loops)
          end do
          self%values(plan%closures(c)%coupling) = coupling_force(plan, b, c, coordinates(2), state, self%loops)
        end associate
      end do
    end do
    if (loads%any_generalized) self%together = self%together + loads%generalized
    loads%generalized = self%together
    loads%any_generalized = .true.
  end subroutine add_couplings

  !> The generalized forces that the coordinates require for all links beyond them, with all chains cut at their closing frames.
  pure subroutine require(plan, reactions, geometry, force, moment, required)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(joint_geometry_type), intent(in) :: geometry     !< of the position
    real(wp), intent(in), contiguous :: force(:, :)       !< (3,N) what each link requires with all beyond it, axes of link 1 [N]
    real(wp), intent(in), contiguous :: moment(:, :)      !< (3,N) about the places of the links [N m]
    real(wp), intent(out) :: required(:)                  !< (M) [N m, N]
    real(wp) :: arm(3), about_point(3)
    integer :: i, k, link

    required = 0.0_wp
    do i = 1, size(reactions%inwards)
      k = plan%steps(reactions%inwards(i))%coordinate
      link = plan%steps(reactions%inwards(i))%link
      arm = geometry%place(:, link) - geometry%point(:, k)
      about_point = moment(:, link) + cross(arm, force(:, link))
      required(k) = reactions%pairs(k)%direction*geometry%length(k)*(dot_product(geometry%axis(1:3, k), force(:, link)) &
                                                                     + dot_product(geometry%axis(4:6, k), about_point)/ &
                                                                     reactions%length)
    end do
  end subroutine require
end module mech9_coupling_forces
