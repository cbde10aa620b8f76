!> The choice of the arithmetic in which a plan is executed: in space, in the plane of a planar mechanism, or in space with planar
!> blocks.
module mech9_arithmetics
  use mech9_plan, only: plan_type, arithmetic_slot_type
  use mech9_planar_plan, only: planar_plan_type
  use mech9_spatial_arithmetic, only: spatial_arithmetic_type
  use mech9_spatial_closure, only: spatial_closure_type
  use mech9_coupling_constraint, only: coupling_constraint_type
  use mech9_planar_arithmetic, only: planar_arithmetic_type
  use mech9_planar_block_arithmetic, only: planar_block_arithmetic_type
  use mech9_planar_closure, only: planar_closure_constraint_type
  implicit none
  private
  public :: set_in_space, set_in_plane, set_blocks_in_planes

contains

  !> Execute a plan in space. Each constraint has as many equations as the rank of its closure is at this call.
  pure subroutine set_in_space(plan)
    type(plan_type), intent(inout) :: plan   !< the plan; gets the arithmetic and the constraints in space
    integer :: c

    plan%planar = planar_plan_type()
    if (allocated(plan%arithmetics)) deallocate (plan%arithmetics, plan%constraints)
    allocate (plan%arithmetics(1), plan%constraints(size(plan%closures)))
    allocate (spatial_arithmetic_type :: plan%arithmetics(1)%kind)
    do c = 1, size(plan%closures)
      if (plan%closures(c)%coupling > 0) then
        allocate (plan%constraints(c)%item, source=coupling_constraint_type(equations=1, closure=c))
      else
        allocate (plan%constraints(c)%item, &
                  source=spatial_closure_type(equations=plan%closures(c)%rank, closure=c))
      end if
    end do
  end subroutine set_in_space

  !> Execute a plan in its plane, if it has been laid out there.
  pure subroutine set_in_plane(plan)
    type(plan_type), intent(inout) :: plan   !< the plan; gets the arithmetic and the constraints in the plane
    integer :: c

    if (.not. plan%planar%used) return
    deallocate (plan%arithmetics, plan%constraints)
    allocate (plan%arithmetics(1), plan%constraints(size(plan%closures)))
    allocate (planar_arithmetic_type :: plan%arithmetics(1)%kind)
    do c = 1, size(plan%closures)
      allocate (plan%constraints(c)%item, source=planar_closure_constraint_type(equations=3, closure=c))
    end do
  end subroutine set_in_plane

  !> Execute the planar blocks of a plan in their planes, where these have been laid out; the others stay in space.
  pure subroutine set_blocks_in_planes(plan)
    type(plan_type), intent(inout) :: plan   !< the plan in space; gets the arithmetic and the constraints in the planes
    type(arithmetic_slot_type) :: both(2)
    integer :: b, c

    if (size(plan%planar%planes) == 0) return
    both(1) = plan%arithmetics(1)
    allocate (planar_block_arithmetic_type :: both(2)%kind)
    plan%arithmetics = both
    do b = 1, size(plan%blocks)
      ! a block without steps has equations of couplings only
      if (plan%blocks(b)%last_step < plan%blocks(b)%first_step) cycle
      if (plan%planar%plane_of(plan%blocks(b)%last_step) == 0) cycle
      plan%blocks(b)%arithmetic = 2
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        deallocate (plan%constraints(c)%item)
        allocate (plan%constraints(c)%item, source=planar_closure_constraint_type(equations=3, closure=c))
      end do
    end do
  end subroutine set_blocks_in_planes
end module mech9_arithmetics
