!> The equations of a block: residuals, Jacobian and rates of its constraints, one below the other.
module mech9_block_equations
  use mech9_kinds, only: wp
  use mech9_front_plan, only: front_plan_type, row_groups_type, new_front_plan, add_diagonal
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: block_residual, block_jacobian, block_rates, block_fronts, damped_fronts, constraint_wrench, largest_gap

contains

  !> The residual of the constraints of a block: rotations in rad, translations in lengths of the mechanism.
  pure subroutine block_residual(plan, block, state, residual)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(block_type), intent(in) :: block              !< the block
    type(state_type), intent(in) :: state              !< with the poses of the frames
    real(wp), intent(out), contiguous :: residual(:)   !< (equations) [rad, lengths of the mechanism]
    integer :: c, row

    row = 0
    do c = block%first_closure, block%last_closure
      associate (constraint => plan%constraints(c)%item)
        call constraint%residual(plan, state, residual(row + 1:row + constraint%equations))
        row = row + constraint%equations
      end associate
    end do
  end subroutine block_residual

  !> Derivatives of the block's equations with respect to its unknowns, each coordinate in its own unit (rad, or the
  !> mechanism's length).
  pure subroutine block_jacobian(plan, block, state, column_of, jacobian)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(block_type), intent(in) :: block                 !< the block
    type(state_type), intent(in) :: state                 !< with the poses of the frames and the screws of the steps
    integer, allocatable, intent(in) :: column_of(:)      !< (steps of the block) column of each step; 0: not an unknown
    real(wp), intent(out), contiguous :: jacobian(:, :)   !< (equations, unknowns)
    integer :: c, row

    jacobian = 0.0_wp
    row = 0
    do c = block%first_closure, block%last_closure
      associate (constraint => plan%constraints(c)%item)
        if (block%whole_loops) then
          call constraint%jacobian(plan, plan%closures(c)%loop, column_of, state, row, jacobian)
        else
          call constraint%jacobian(plan, plan%closures(c)%part, column_of, state, row, jacobian)
        end if
        row = row + constraint%equations
      end associate
    end do
  end subroutine block_jacobian

  !> First or second time derivatives of the block's residual at the rates, or rates and accelerations, in `state`. The motion
  !> of the frames of earlier blocks must agree with these; for second derivatives, that of the block's own frames too.
  pure subroutine block_rates(plan, block, order, state, rates)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(block_type), intent(in) :: block           !< the block
    integer, intent(in) :: order                    !< 1: first derivatives, 2: second derivatives
    type(state_type), intent(in) :: state           !< with the motion of the frames
    real(wp), intent(out), contiguous :: rates(:)   !< (equations) [rad, lengths of the mechanism; per s or s^2]
    integer :: c, row

    row = 0
    do c = block%first_closure, block%last_closure
      associate (constraint => plan%constraints(c)%item)
        call constraint%rates(plan, order, state, rates(row + 1:row + constraint%equations))
        row = row + constraint%equations
      end associate
    end do
  end subroutine block_rates

  !> The force, and the moment about the closing frame's origin, that do the work of the multipliers of a constraint's equations in
  !> any motion of the closing frame relative to its target.
  pure subroutine constraint_wrench(plan, c, state, multipliers, force, moment)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    integer, intent(in) :: c                    !< number of the constraint
    type(state_type), intent(in) :: state       !< with the poses of the frames
    real(wp), intent(in) :: multipliers(:)      !< (equations) [N m]
    real(wp), intent(out) :: force(3)           !< axes of frame 0 [N]
    real(wp), intent(out) :: moment(3)          !< axes of frame 0 [N m]
    real(wp), parameter :: none(3) = 0.0_wp
    real(wp) :: along(3), values(6)
    integer :: i, n

    n = size(multipliers)
    associate (constraint => plan%constraints(c)%item)
      do i = 1, 3
        along = 0.0_wp
        along(i) = 1.0_wp
        call constraint%opening(plan, state, along, none, values(:n))
        moment(i) = dot_product(values(:n), multipliers)
        call constraint%opening(plan, state, none, along, values(:n))
        force(i) = dot_product(values(:n), multipliers)
      end do
    end associate
  end subroutine constraint_wrench

  !> The fronts by which the block's Jacobian can be factorized: its rows come in groups, one for each constraint, and only the
  !> unknowns of a constraint's loop occur in its group.
  pure function block_fronts(plan, block, column_of) result(fronts)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(block_type), intent(in) :: block       !< the block
    integer, allocatable, intent(in) :: column_of(:)   !< (steps of the block) column of each step; 0: not an unknown
    type(front_plan_type) :: fronts
    type(row_groups_type) :: groups

    groups = block_groups(plan, block, column_of)
    fronts = new_front_plan(groups)
  end function block_fronts

  !> The fronts of the Jacobian with one more row for each unknown, in which only this unknown occurs: `row_of` gives it.
  pure subroutine damped_fronts(plan, block, column_of, fronts, row_of)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(block_type), intent(in) :: block           !< the block
    integer, allocatable, intent(in) :: column_of(:)   !< (steps of the block) column of each step; 0: not an unknown
    type(front_plan_type), intent(out) :: fronts    !< of the matrix of equations + unknowns rows
    integer, intent(out) :: row_of(:)               !< (unknowns) the row that is added for each
    type(row_groups_type) :: groups

    groups = block_groups(plan, block, column_of)
    call add_diagonal(groups, row_of)
    fronts = new_front_plan(groups)
  end subroutine damped_fronts

  !> The groups of rows of a block's Jacobian, one for each constraint.
  pure function block_groups(plan, block, column_of) result(groups)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(block_type), intent(in) :: block       !< the block
    integer, allocatable, intent(in) :: column_of(:)   !< (steps of the block) column of each step; 0: not an unknown
    type(row_groups_type) :: groups
    integer, allocatable :: columns(:)
    integer :: c, i, n

    n = block%last_closure - block%first_closure + 1
    groups%n = size(block%unknowns)
    allocate (groups%sizes(n), groups%first(n + 1), groups%members(0))
    groups%first(1) = 1
    do i = 1, n
      c = block%first_closure + i - 1
      groups%sizes(i) = plan%constraints(c)%item%equations
      if (block%whole_loops) then
        columns = plan%closures(c)%loop%steps
      else
        columns = plan%closures(c)%part%steps
      end if
      columns = column_of(pack(columns, columns >= block%first_step))
      groups%members = [groups%members, pack(columns, columns > 0)]
      groups%first(i + 1) = size(groups%members) + 1
    end do
  end function block_groups

  !> The largest gap of any constraint that the plan's blocks solve: a length [m]; rotations are multiplied by the
  !> mechanism's size.
  pure real(wp) function largest_gap(plan, state) result(largest)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the poses of the frames
    integer :: b, c

    largest = 0.0_wp
    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        largest = max(largest, plan%constraints(c)%item%gap(plan, state))
      end do
    end do
  end function largest_gap
end module mech9_block_equations
