!> One block at one time: Newton's method for its positions, then its exact rates and accelerations.
!> Uses kinds, error, least_squares, plan, state, composition, closure, motion.
module mech9_solver
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type
  use mech9_least_squares, only: least_squares_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type, velocity_known, acceleration_known
  use mech9_composition, only: place_frames
  use mech9_closure, only: closure_errors, closure_jacobian, closure_rates
  use mech9_motion, only: spread_velocities, spread_accelerations
  implicit none
  private
  public :: block_work_type, new_block_work, close_block, factorize_block, solve_rates, solve_accelerations, apply_change
  public :: closed_enough, newton_outcome_type, least_pivot, work_count_type, work_of

  !> A chain counts as closed when its independent equations hold to this many times round-off,
  !> rotations in rad, translations in lengths of the mechanism: a sum over the steps of a loop
  !> loses a few units.
  real(wp), parameter :: closed_enough = 32.0_wp*epsilon(1.0_wp)
  !> Once a correction is this small, the next error is its square: round-off.
  real(wp), parameter :: last_correction = 1.0e-9_wp
  integer, parameter :: most_iterations = 12

  !> How much was done.
  type :: work_count_type
    integer(long) :: frames_placed = 0       !< poses of frames
    integer(long) :: frames_moved = 0        !< their velocities, and their accelerations
    integer(long) :: factorizations = 0      !< Jacobians of blocks
    integer(long) :: rates = 0               !< blocks solved for their rates
    integer(long) :: accelerations = 0       !< blocks solved for their accelerations
  end type work_count_type

  !> Scratch of one block, sized once.
  type :: block_work_type
    type(least_squares_type) :: equations      !< Jacobian and its factors
    integer, allocatable :: column_of(:)       !< unknown of each of the block's steps, 0 for none
    real(wp), allocatable :: right(:)          !< (equations)
    real(wp), allocatable :: change(:)         !< (unknowns)
    logical :: factors_stay = .false.          !< the Jacobian never changes, and was factorized
    type(work_count_type) :: count             !< of what was done for the block
  end type block_work_type

  !> How Newton's method went.
  type :: newton_outcome_type
    logical :: converged = .false.
    integer :: iterations = 0
    real(wp) :: correction = 0.0_wp      !< of all iterations together, largest coordinate in its unit
    real(wp) :: contraction = 0.0_wp     !< second correction against the first; 0 where one was enough
  end type newton_outcome_type

contains

  !> Scratch for a block.
  pure function new_block_work(block) result(work)
    type(block_type), intent(in) :: block
    type(block_work_type) :: work
    integer :: i

    call work%equations%create(block%equations, size(block%unknowns))
    allocate (work%column_of(block%last_step - block%first_step + 1), source=0)
    do i = 1, size(block%unknowns)
      work%column_of(block%unknowns(i) - block%first_step + 1) = i
    end do
    allocate (work%right(block%equations), work%change(size(block%unknowns)), source=0.0_wp)
  end function new_block_work

  !> Close the chains of a block by Newton's method from the coordinates in `state`; at the end its
  !> frames are in place. Whether it converged, and how, is in `outcome`. Fails only where a pair has no pose.
  subroutine close_block(plan, block, state, work, outcome, err, at_least)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(inout) :: state
    type(block_work_type), intent(inout) :: work
    type(newton_outcome_type), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: err
    integer, intent(in), optional :: at_least        !< iterations also where the chains are closed enough
    real(wp) :: size_of_change, previous, lack
    integer :: least

    least = 0
    if (present(at_least)) least = at_least
    previous = 0.0_wp
    do
      call place_frames(plan, block%first_step, block%last_step, state, err)
      if (allocated(err)) return
      work%count%frames_placed = work%count%frames_placed + steps_of(block)
      if (size(block%unknowns) == 0) then
        outcome%converged = .true.
        return
      end if
      call closure_errors(plan, block, state, work%right)
      lack = maxval(abs(work%right))
      outcome%converged = (lack <= closed_enough .and. outcome%iterations >= least) .or. &
                          (outcome%iterations > 0 .and. previous <= last_correction)
      if (outcome%converged) return
      ! not a number, or no progress
      if (outcome%iterations == most_iterations .or. .not. lack < huge(lack)) return
      call factorize_block(plan, block, state, work)
      work%right = -work%right
      call work%equations%solve(work%right, work%change)
      call apply_change(plan, block, work%change, state)
      outcome%iterations = outcome%iterations + 1
      size_of_change = maxval(abs(work%change))
      outcome%correction = outcome%correction + size_of_change
      if (outcome%iterations == 2) outcome%contraction = size_of_change/max(previous, tiny(previous))
      previous = size_of_change
    end do
  end subroutine close_block

  !> Jacobian of a block at the position in `state`, factorized.
  subroutine factorize_block(plan, block, state, work)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    type(block_work_type), intent(inout) :: work

    if (work%factors_stay) return
    call closure_jacobian(plan, block, state, work%column_of, work%equations%a)
    call work%equations%factorize()
    work%count%factorizations = work%count%factorizations + 1
    work%factors_stay = block%is_constant
  end subroutine factorize_block

  !> What was done for all blocks together.
  pure function work_of(blocks) result(all)
    type(block_work_type), intent(in) :: blocks(:)
    type(work_count_type) :: all

    all%frames_placed = sum(blocks%count%frames_placed)
    all%frames_moved = sum(blocks%count%frames_moved)
    all%factorizations = sum(blocks%count%factorizations)
    all%rates = sum(blocks%count%rates)
    all%accelerations = sum(blocks%count%accelerations)
  end function work_of

  !> Frames that a block makes.
  pure integer function steps_of(block)
    type(block_type), intent(in) :: block

    steps_of = block%last_step - block%first_step + 1
  end function steps_of

  !> Least pivot of a block's factorized Jacobian: about its least singular value, somewhat above it
  !> (rotations in rad, lengths in the mechanism's); 0 where rows are missing.
  pure real(wp) function least_pivot(work)
    type(block_work_type), intent(in) :: work

    least_pivot = 0.0_wp
    associate (m => work%equations%m, n => work%equations%n)
      if (n > 0 .and. m >= n) least_pivot = abs(work%equations%a(n, n))
    end associate
  end function least_pivot

  !> Add a change, given in units of the coordinates, to the block's dependent coordinates.
  pure subroutine apply_change(plan, block, change, state)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    real(wp), intent(in) :: change(:)
    type(state_type), intent(inout) :: state
    integer :: i, k

    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%q(k) = state%q(k) + change(i)*plan%unit_of(k)
    end do
  end subroutine apply_change

  !> Rates of the block's dependent coordinates, J_d dq_d = -J_i dq_i, and velocities of its frames.
  !> The Jacobian must be factorized at this position.
  subroutine solve_rates(plan, block, state, work, remainder)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(inout) :: state
    type(block_work_type), intent(inout) :: work
    real(wp), intent(out), optional :: remainder   !< what no rates of the unknowns can make up for
    integer :: i, k

    if (present(remainder)) remainder = 0.0_wp
    do i = 1, size(block%unknowns)
      state%dq(block%coordinates(i)) = 0.0_wp
    end do
    call spread_velocities(plan, block%first_step, block%last_step, state)
    work%count%rates = work%count%rates + 1
    work%count%frames_moved = work%count%frames_moved + steps_of(block)
    if (block%equations == 0) return
    call closure_rates(plan, block, state, velocity_known, work%right)
    work%right = -work%right
    if (present(remainder)) then
      call work%equations%solve(work%right, work%change, remainder)
    else
      call work%equations%solve(work%right, work%change)
    end if
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%dq(k) = work%change(i)*plan%unit_of(k)
    end do
    call spread_velocities(plan, block%first_step, block%last_step, state)
    work%count%frames_moved = work%count%frames_moved + steps_of(block)
  end subroutine solve_rates

  !> Accelerations of the block's dependent coordinates, J_d ddq_d = -J_i ddq_i - dJ/dt dq, and of its frames.
  !> The Jacobian must be factorized at this position and the rates be known.
  subroutine solve_accelerations(plan, block, state, work)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(inout) :: state
    type(block_work_type), intent(inout) :: work
    integer :: i, k, last

    work%count%accelerations = work%count%accelerations + 1
    last = min(block%last_step, block%last_moved)
    if (size(block%unknowns) == 0) then
      call spread_accelerations(plan, block%first_step, last, state)
      work%count%frames_moved = work%count%frames_moved + (last - block%first_step + 1)
      return
    end if
    do i = 1, size(block%unknowns)
      state%ddq(block%coordinates(i)) = 0.0_wp
    end do
    call spread_accelerations(plan, block%first_step, block%last_step, state)
    call closure_rates(plan, block, state, acceleration_known, work%right)
    work%right = -work%right
    call work%equations%solve(work%right, work%change)
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%ddq(k) = work%change(i)*plan%unit_of(k)
    end do
    call spread_accelerations(plan, block%first_step, last, state)
    work%count%frames_moved = work%count%frames_moved + steps_of(block) + (last - block%first_step + 1)
  end subroutine solve_accelerations
end module mech9_solver
