!> The singularity monitor: it compares a block's Jacobian at both ends of a step, and finds whether a singular one may lie between.
!>
!> With the Jacobian J at the end of a step and its change D within the step, all matrices J - s D, 0 <= s <= 1, are regular
!> while a norm of J^-1 D is below 1. The norm of D over the least pivot of J is a cheap estimate of it.
module mech9_singularity_monitor
  use mech9_kinds, only: wp
  use mech9_tolerances, only: near_singular, trusted_change
  use mech9_tracking_tolerances, only: harmless_change, unbounded_excess
  use mech9_balance, only: balance
  use mech9_matrix_norms, only: matrix_length
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, factorize_block
  implicit none
  private
  public :: singularity_monitor_type, new_singularity_monitor, factorize_trial, monitor_step, accept_jacobians, nearness, is_near



  !> The Jacobian of a block at the start of a step, and the measures of it and of that at the end of the trial step.
  type :: singularity_monitor_type
    real(wp), allocatable :: jacobian(:, :)     !< at the start of the step; that at its end is in the block's scratch
    real(wp), allocatable :: change(:, :)       !< scratch for J^-1 D
    integer :: sign = 1                         !< sign of the determinant at the start, if the Jacobian is square
    integer :: trial_sign = 1                   !< the same at the end of the trial step
    real(wp) :: pivot = 1.0_wp                  !< least pivot at the start
    real(wp) :: trial_pivot = 1.0_wp            !< least pivot at the end of the trial step
    real(wp) :: largest_pivot = 0.0_wp          !< largest least pivot of all positions so far
  end type singularity_monitor_type

contains

  !> A monitor of a block, which has seen no position yet.
  pure function new_singularity_monitor(block) result(monitor)
    type(block_type), intent(in) :: block   !< the block
    type(singularity_monitor_type) :: monitor

    allocate (monitor%jacobian(block%equations, size(block%unknowns)), source=0.0_wp)
    allocate (monitor%change(size(block%unknowns), size(block%unknowns)), source=0.0_wp)
  end function new_singularity_monitor

  !> Factorize the block's Jacobian at the position in `state` and take it as that at the end of the trial step.
  subroutine factorize_trial(plan, block, state, work, monitor)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its Jacobian and factors
    type(singularity_monitor_type), intent(inout) :: monitor   !< the monitor of the block

    if (size(block%unknowns) == 0) return
    call factorize_block(plan, block, state, work)
    call read_factors(work, monitor)
  end subroutine factorize_trial

  !> Take the Jacobian that stands factorized in `work` as that at the end of the trial step.
  subroutine read_factors(work, monitor)
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its Jacobian and factors
    type(singularity_monitor_type), intent(inout) :: monitor   !< the monitor of the block

    monitor%trial_pivot = work%equations%least_pivot()
    monitor%trial_sign = work%equations%determinant_sign()
  end subroutine read_factors

  !> Factorize the block's Jacobian at the end of a step, unless it is factorized, and judge whether a singular one may lie
  !> within the step.
  subroutine monitor_step(plan, block, state, factorized, work, monitor, worst)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    logical, intent(in) :: factorized   !< the factors in `work` belong to the position in `state`
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its Jacobian and factors
    type(singularity_monitor_type), intent(inout) :: monitor   !< the monitor of the block
    real(wp), intent(inout) :: worst   !< raised to at least the measure of this step; up to 1 it has no singular matrix
    real(wp) :: change

    if (.not. factorized) call factorize_block(plan, block, state, work)
    call read_factors(work, monitor)
    if (.not. monitor%trial_pivot > 0.0_wp) then
      worst = unbounded_excess
      return
    end if
    change = work%equations%distance(work%jacobian, monitor%jacobian)/(harmless_change*monitor%trial_pivot)
    ! the sharper bound costs a solution for each column: it is found only where it may allow longer steps
    if (change > 0.5_wp) change = min(change, relative_change(work, monitor)/trusted_change)
    worst = max(worst, change)
    if (monitor%trial_sign /= monitor%sign) worst = max(worst, 2.0_wp)
  end subroutine monitor_step

  ! The procedures below work on arrays of explicit shape: the compiler needs neither descriptors nor strides.

  !> The difference of two vectors.
  pure subroutine subtract(n, a, b, difference)
    integer, intent(in) :: n                !< number of elements
    real(wp), intent(in) :: a(n)            !< the first vector
    real(wp), intent(in) :: b(n)            !< the second one
    real(wp), intent(out) :: difference(n)  !< the first less the second

    difference = a - b
  end subroutine subtract

  !> Copy a matrix.
  pure subroutine copy(n, from, to)
    integer, intent(in) :: n   !< number of elements
    real(wp), intent(in) :: from(n)   !< the original
    real(wp), intent(out) :: to(n)   !< the copy

    to = from
  end subroutine copy

  !> Norm (root of the sum of squares) of J^-1 D after balancing, which chooses the units of the coordinates that make it
  !> small; `unbounded_excess` where J is singular.
  real(wp) function relative_change(work, monitor) result(change)
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its Jacobian and factors
    type(singularity_monitor_type), intent(inout) :: monitor   !< the monitor of the block
    integer :: j, n

    change = unbounded_excess
    n = work%equations%n
    if (work%equations%rank() < n) return
    do j = 1, n
      call subtract(work%equations%m, work%jacobian(:, j), monitor%jacobian(:, j), work%right)
      call work%equations%solve(work%right, monitor%change(:, j))
    end do
    call balance(n, monitor%change)
    change = matrix_length(n*n, monitor%change)
  end function relative_change

  !> The step is accepted: the Jacobians at its end are those at the start of the next one.
  pure subroutine accept_jacobians(work, monitors)
    type(block_work_type), intent(in) :: work(:)   !< scratch of all blocks, with their Jacobians at the end of the step
    type(singularity_monitor_type), intent(inout) :: monitors(:)   !< the monitors of all blocks
    integer :: b

    do b = 1, size(monitors)
      associate (monitor => monitors(b))
        call copy(size(monitor%jacobian), work(b)%jacobian, monitor%jacobian)
        monitor%sign = monitor%trial_sign
        monitor%pivot = monitor%trial_pivot
        monitor%largest_pivot = max(monitor%largest_pivot, monitor%pivot)
      end associate
    end do
  end subroutine accept_jacobians

  !> Whether a block is near a singular position.
  pure elemental logical function is_near(monitor)
    type(singularity_monitor_type), intent(in) :: monitor   !< the monitor of the block

    is_near = monitor%pivot < near_singular*monitor%largest_pivot
  end function is_near

  !> Least pivot at the end of the trial step, divided by the largest least pivot so far.
  pure real(wp) function nearness(monitor)
    type(singularity_monitor_type), intent(in) :: monitor   !< the monitor of the block

    nearness = monitor%trial_pivot/max(monitor%largest_pivot, tiny(nearness))
  end function nearness
end module mech9_singularity_monitor
