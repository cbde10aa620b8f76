!> The solution of one block at one time: Newton's method for the positions, then the exact rates and accelerations.
module mech9_block_solver
  use mech9_kinds, only: wp, long
  use mech9_tolerances, only: closed_to_round_off, last_correction
  use mech9_motion_tolerances, only: small_turn, unchanged_position
  use mech9_error, only: error_type
  use mech9_least_squares, only: least_squares_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_planar_chain, only: planar_chain_type, new_planar_chain, chain_residual, chain_jacobian, chain_change, &
    chain_rates, chain_motion
  use mech9_frame_motion, only: place_unshown, place_frames_after_change, spread_velocities, spread_accelerations
  use mech9_planar_view, only: show_poses, show_velocities, show_accelerations
  use mech9_block_equations, only: block_jacobian, block_rates, block_residual, block_fronts
  implicit none
  private
  public :: block_work_type, new_block_work, close_block, factorize_block, solve_rates, solve_accelerations, solve_motion
  public :: apply_change, newton_outcome_type, work_count_type, work_of

  integer, parameter :: most_iterations = 12

  !> Numbers of operations done.
  type :: work_count_type
    integer(long) :: frames_placed = 0       !< poses of frames computed
    integer(long) :: frames_moved = 0        !< velocities and accelerations of frames computed, counted together
    integer(long) :: factorizations = 0      !< Jacobians of blocks factorized
    integer(long) :: rates = 0               !< blocks solved for their rates
    integer(long) :: accelerations = 0       !< blocks solved for their accelerations
  end type work_count_type

  !> Scratch of one block, sized once.
  type :: block_work_type
    real(wp), allocatable :: jacobian(:, :)    !< (equations,unknowns) the Jacobian that was factorized last
    type(least_squares_type) :: equations      !< its factors
    type(planar_chain_type) :: chain           !< the block as a planar chain, if it is one
    integer, allocatable :: column_of(:)       !< (first_step:last_step) number of the unknown of each step; 0: none
    real(wp), allocatable :: right(:)          !< (equations) right-hand sides
    real(wp), allocatable :: change(:)         !< (unknowns) solution, in units of the coordinates
    logical :: factors_stay = .false.          !< the Jacobian is constant and has been factorized
    integer :: made = 0                        !< number of the block among those for which code was made; 0: none was
    real(wp), allocatable :: numbers(:)        !< numbers of the plan for this code, see mech9_made_motion
    type(work_count_type) :: count             !< operations done for the block
  end type block_work_type

  !> The course of Newton's method.
  type :: newton_outcome_type
    logical :: converged = .false.       !< the chains are closed
    integer :: iterations = 0            !< number of corrections applied
    real(wp) :: correction = 0.0_wp      !< sum over the iterations of the largest change of a coordinate, in its unit
    real(wp) :: contraction = 0.0_wp     !< ratio of the second correction to the first; 0 where one was enough
    !> Largest change of a coordinate in the last iteration, in its unit; if it is small, the factors serve at the closed position
    real(wp) :: last = huge(1.0_wp)
  end type newton_outcome_type

contains

  !> Scratch for a block. If the complete plan is given, a planar chain of three unknowns gets an arithmetic of its own, and the
  !> sparsity of the Jacobian of several chains is used.
  pure function new_block_work(block, plan) result(work)
    type(block_type), intent(in) :: block           !< the block
    type(plan_type), intent(in), optional :: plan   !< the complete plan; without it no arithmetic of its own is chosen
    type(block_work_type) :: work
    integer :: i

    allocate (work%jacobian(block%equations, size(block%unknowns)), source=0.0_wp)
    allocate (work%column_of(block%first_step:block%last_step), source=0)
    do i = 1, size(block%unknowns)
      work%column_of(block%unknowns(i)) = i
    end do
    if (present(plan)) then
      call work%equations%create(block%equations, size(block%unknowns), block_fronts(plan, block, work%column_of))
      work%chain = new_planar_chain(plan, block)
    else
      call work%equations%create(block%equations, size(block%unknowns))
    end if
    work%equations%regular_pivot = block%regular_pivot
    allocate (work%right(block%equations), work%change(size(block%unknowns)), source=0.0_wp)
  end function new_block_work

  !> Close the chains of a block by Newton's method from the coordinates in `state`; at the end its frames are in place.
  !> `outcome` says whether the method converged. An error arises only where a pair has no pose.
  subroutine close_block(plan, block, state, work, outcome, err, at_least)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(block_type), intent(in) :: block               !< the block
    type(state_type), intent(inout) :: state            !< first guess in; the closed block and poses of its frames out
    type(block_work_type), intent(inout) :: work        !< scratch of the block; gets the factors of its Jacobian
    type(newton_outcome_type), intent(out) :: outcome   !< the course of Newton's method
    type(error_type), allocatable, intent(out) :: err   !< allocated if a pair has no pose
    integer, intent(in), optional :: at_least           !< least number of iterations; 0 unless given
    real(wp) :: size_of_change, previous, residual_norm
    integer :: least

    least = 0
    if (present(at_least)) least = at_least
    previous = 0.0_wp
    call place_unshown(plan, block, state, err)
    if (allocated(err)) return
    work%count%frames_placed = work%count%frames_placed + steps_of(block)
    outcome%converged = size(block%unknowns) == 0
    do while (.not. outcome%converged)
      call find_residual(plan, block, state, work, residual_norm)
      outcome%converged = residual_norm <= closed_to_round_off .and. outcome%iterations >= least
      if (outcome%converged) exit
      ! the iteration has diverged, or is too slow
      if (outcome%iterations == most_iterations .or. .not. residual_norm < huge(residual_norm)) exit
      call factorize_block(plan, block, state, work)
      call correct(plan, block, state, work, size_of_change)
      outcome%iterations = outcome%iterations + 1
      outcome%last = size_of_change
      if (size_of_change > unchanged_position) then
        work%count%frames_placed = work%count%frames_placed + steps_of(block)
        if (size_of_change <= small_turn) then
          call place_frames_after_change(plan, block, work%change, state, err)
        else
          call place_unshown(plan, block, state, err)
        end if
      end if
      if (allocated(err)) return
      outcome%converged = size_of_change <= last_correction
      outcome%correction = outcome%correction + size_of_change
      if (outcome%iterations == 2) outcome%contraction = size_of_change/max(previous, tiny(previous))
      previous = size_of_change
    end do
    if (block%is_shown) call show_poses(plan, plan%planar%shown, block%first_step, block%last_step, state)
  end subroutine close_block

  !> The residual of a block at the position in `state`, into work%right, and its largest number.
  pure subroutine find_residual(plan, block, state, work, largest)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(block_type), intent(in) :: block          !< the block
    type(state_type), intent(in) :: state          !< with the poses of the frames
    type(block_work_type), intent(inout) :: work   !< scratch of the block; gets the residual
    real(wp), intent(out) :: largest               !< the largest number of the residual [rad, lengths of the mechanism]

    if (work%chain%used) then
      call chain_residual(work%chain, state%planar, work%right)
      largest = largest_of_three(work%right)
    else
      call block_residual(plan, block, state, work%right)
      largest = maxval(abs(work%right))
    end if
  end subroutine find_residual

  !> Change a block's dependent coordinates by the correction that its factors give for the residual in work%right; the frames stay.
  subroutine correct(plan, block, state, work, largest)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(block_type), intent(in) :: block          !< the block
    type(state_type), intent(inout) :: state       !< its coordinates are changed
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with residual and factors; gets the change
    real(wp), intent(out) :: largest               !< the largest change of a coordinate, in its unit

    if (work%chain%used .and. work%equations%by_cofactors) then
      call chain_change(work%chain, work%equations%inverse, work%right, state%q, work%change)
      largest = largest_of_three(work%change)
    else
      work%right = -work%right
      call work%equations%solve(work%right, work%change)
      call apply_change(plan, block, work%change, state)
      largest = maxval(abs(work%change))
    end if
  end subroutine correct

  !> Jacobian of a block at the position in `state`, factorized.
  subroutine factorize_block(plan, block, state, work)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(block_type), intent(in) :: block          !< the block
    type(state_type), intent(in) :: state          !< with the poses of the frames and the screws of the steps
    type(block_work_type), intent(inout) :: work   !< scratch of the block; gets the Jacobian and its factors

    if (work%factors_stay) return
    if (work%chain%used) then
      call chain_jacobian(plan%planar, work%chain, state%planar, work%jacobian)
    else
      call block_jacobian(plan, block, state, work%column_of, work%jacobian)
    end if
    call work%equations%factorize(work%jacobian)
    work%count%factorizations = work%count%factorizations + 1
    work%factors_stay = block%is_constant
  end subroutine factorize_block

  !> Numbers of operations done for all blocks together, added to earlier ones.
  pure function work_of(blocks, before) result(all)
    type(block_work_type), intent(in) :: blocks(:)          !< scratch of all blocks
    type(work_count_type), intent(in), optional :: before   !< number of earlier operations to be added; none unless given
    type(work_count_type) :: all

    if (present(before)) all = before
    all%frames_placed = all%frames_placed + sum(blocks%count%frames_placed)
    all%frames_moved = all%frames_moved + sum(blocks%count%frames_moved)
    all%factorizations = all%factorizations + sum(blocks%count%factorizations)
    all%rates = all%rates + sum(blocks%count%rates)
    all%accelerations = all%accelerations + sum(blocks%count%accelerations)
  end function work_of

  !> The number of frames that a block makes.
  pure integer function steps_of(block)
    type(block_type), intent(in) :: block   !< the block

    steps_of = block%last_step - block%first_step + 1
  end function steps_of

  !> Add a change, given in units of the coordinates, to the block's dependent coordinates.
  pure subroutine apply_change(plan, block, change, state)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(block_type), intent(in) :: block           !< the block
    real(wp), intent(in), contiguous :: change(:)   !< (unknowns) in units of the coordinates (rad, or lengths of the mechanism)
    type(state_type), intent(inout) :: state        !< its coordinates are changed; its frames stay

    call add_at(size(change), block%coordinates, change, plan%unit_of, state%q)
  end subroutine apply_change

  !> Rates of the block's dependent coordinates, J_d dq_d = -J_i dq_i, and velocities of its frames.
  !> The Jacobian must be factorized at this position.
  subroutine solve_rates(plan, block, state, work, remainder, without_accelerations)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(block_type), intent(in) :: block          !< the block
    type(state_type), intent(inout) :: state       !< given rates in; rates of the block and velocities of its frames out
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its factors
    real(wp), intent(out), optional :: remainder   !< norm of the residual that no rates of the unknowns remove
    logical, intent(in), optional :: without_accelerations   !< a planar chain finds only velocities that other blocks use
    integer :: last

    work%count%rates = work%count%rates + 1
    if (work%chain%used .and. work%equations%by_cofactors .and. .not. present(remainder)) then
      last = block%last_step
      if (present(without_accelerations)) last = merge(work%chain%last_moved, last, without_accelerations)
      call chain_rates(plan%planar, work%chain, work%equations%inverse, last, state%dq, state%planar)
      if (block%is_shown) call show_velocities(plan, plan%planar%shown, block%first_step, last, state)
      work%count%frames_moved = work%count%frames_moved + (last - block%first_step + 1)
      return
    end if
    if (present(remainder)) remainder = 0.0_wp
    call clear_at(size(block%unknowns), block%coordinates, state%dq)
    if (block%equations == 0) then
      call spread_velocities(plan, block, state)
      work%count%frames_moved = work%count%frames_moved + steps_of(block)
      return
    end if
    call block_rates(plan, block, 1, state, work%right)
    work%right = -work%right
    if (present(remainder)) then
      call work%equations%solve(work%right, work%change, remainder)
    else
      call work%equations%solve(work%right, work%change)
    end if
    call add_at(size(work%change), block%coordinates, work%change, plan%unit_of, state%dq)
    call spread_velocities(plan, block, state)
    work%count%frames_moved = work%count%frames_moved + steps_of(block)
  end subroutine solve_rates

  !> Rates and accelerations of the block's dependent coordinates and the motion of its frames. The Jacobian must be
  !> factorized at this position.
  subroutine solve_motion(plan, block, state, work)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(block_type), intent(in) :: block          !< the block
    type(state_type), intent(inout) :: state       !< given rates and accelerations in; motion of the block out
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its factors

    if (work%chain%used .and. work%equations%by_cofactors) then
      call chain_motion(plan%planar, work%chain, work%equations%inverse, state%dq, state%ddq, state%planar)
      if (block%is_shown) then
        call show_velocities(plan, plan%planar%shown, block%first_step, block%last_step, state)
        call show_accelerations(plan, plan%planar%shown, block%first_step, work%chain%last_moved, state)
      end if
      work%count%rates = work%count%rates + 1
      work%count%accelerations = work%count%accelerations + 1
      work%count%frames_moved = work%count%frames_moved + steps_of(block) &
                                + (work%chain%last_moved - block%first_step + 1)
    else
      call solve_rates(plan, block, state, work)
      call solve_accelerations(plan, block, state, work)
    end if
  end subroutine solve_motion

  !> Accelerations of the block's dependent coordinates, J_d ddq_d = -J_i ddq_i - dJ/dt dq, and of its frames.
  !> The Jacobian must be factorized at this position and the rates be known.
  subroutine solve_accelerations(plan, block, state, work)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(block_type), intent(in) :: block          !< the block
    type(state_type), intent(inout) :: state       !< rates and given accelerations in; accelerations of the block out
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its factors
    integer :: last

    work%count%accelerations = work%count%accelerations + 1
    last = min(block%last_step, block%last_moved)
    call clear_at(size(block%unknowns), block%coordinates, state%ddq)
    if (size(block%unknowns) > 0) then
      call spread_accelerations(plan, block, block%last_step, state)
      work%count%frames_moved = work%count%frames_moved + steps_of(block)
      call block_rates(plan, block, 2, state, work%right)
      work%right = -work%right
      call work%equations%solve(work%right, work%change)
      call add_at(size(work%change), block%coordinates, work%change, plan%unit_of, state%ddq)
    end if
    call spread_accelerations(plan, block, last, state)
    work%count%frames_moved = work%count%frames_moved + (last - block%first_step + 1)
  end subroutine solve_accelerations

  ! The next three take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> The largest absolute value of three numbers.
  pure real(wp) function largest_of_three(values) result(largest)
    real(wp), intent(in) :: values(3)   !< of any unit

    largest = max(abs(values(1)), abs(values(2)), abs(values(3)))
  end function largest_of_three

  !> Set some of the values to zero.
  pure subroutine clear_at(n, places, values)
    integer, intent(in) :: n               !< number of places
    integer, intent(in) :: places(n)       !< indices in `values`
    real(wp), intent(inout) :: values(*)   !< rates or accelerations of all coordinates; zero at these places afterwards
    integer :: i

    do i = 1, n
      values(places(i)) = 0.0_wp
    end do
  end subroutine clear_at

  !> Add a change, given in units, to some of the values.
  pure subroutine add_at(n, places, change, unit_of, values)
    integer, intent(in) :: n               !< number of places
    integer, intent(in) :: places(n)       !< indices in `values`
    real(wp), intent(in) :: change(n)      !< in units of the coordinates
    real(wp), intent(in) :: unit_of(*)     !< unit of each coordinate: 1 rad, or the length of the mechanism [m]
    real(wp), intent(inout) :: values(*)   !< all coordinates, rates or accelerations [rad, m; per s or s^2]
    integer :: i

    do i = 1, n
      values(places(i)) = values(places(i)) + change(i)*unit_of(places(i))
    end do
  end subroutine add_at
end module mech9_block_solver
