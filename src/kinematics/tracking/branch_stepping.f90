!> Steps of a driven motion through regular positions, on one branch.
!>
!> Each block is predicted (mech9_predictor), corrected by Newton's method, and judged. A step is accepted if the block's
!> Jacobian cannot have been singular within it (mech9_singularity_monitor) and the correction is small: then the closed
!> position near the prediction is the only one there, and it belongs to the branch (Kantorovich's theorem, see
!> docs/reference/bibliography.md). The correction is measured by the least pivot, which shows how far away other branches are.
module mech9_branch_stepping
  use mech9_kinds, only: wp, long
  use mech9_tolerances, only: longest_drive, longest_move, trusted_correction, trusted_rate_change, unchanged_factors
  use mech9_tracking_tolerances, only: stagnant_move, stagnant_step, least_step, small_correction, &
    trusted_contraction, unchanged_prediction
  use mech9_error, only: error_type
  use mech9_masks, only: numbers_of
  use mech9_law, only: drive_slot_type
  use mech9_plan, only: plan_type, block_type
  use mech9_tree_paths, only: mark_path
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, newton_outcome_type, close_block, &
    solve_rates, solve_motion
  use mech9_made_motion, only: take_made_blocks, move_as_made
  use mech9_predictor, only: predictor_type, new_predictor, begin_prediction, add_position, prepare_prediction, predict, &
    set_accelerations
  use mech9_singularity_monitor, only: singularity_monitor_type, new_singularity_monitor, monitor_step, accept_jacobians, &
    nearness, is_near
  implicit none
  private
  public :: branch_stepper_type, new_branch_stepper, accept_start, step_towards, set_inputs, restore_last_position, &
    add_accelerations

  !> After this many stagnant steps towards one time the branch stepper gives up.
  integer, parameter :: most_stagnant = 10000

  !> The branch stepper: state, last accepted position, scratch, and counts for the report.
  type :: branch_stepper_type
    type(state_type) :: state                     !< during a step the trial position, then the accepted one
    type(predictor_type) :: predictor             !< the position accepted last
    type(block_work_type), allocatable :: work(:) !< scratch of each block
    type(singularity_monitor_type), allocatable :: monitors(:)   !< singularity monitor of each block
    real(wp), allocatable :: per_unit(:)          !< (M) reciprocals of the coordinates' units
    integer, allocatable :: drives(:)             !< numbers of the drives that move closed chains
    integer :: last_block = huge(1)               !< the blocks after this one are left as they are
    integer :: derivatives = 2                    !< order of the highest derivative in time that is found at every position
    logical :: accelerations_found = .false.      !< those in the state belong to its position
    real(wp) :: reach = huge(1.0_wp)              !< length of a step that will probably be accepted [s]
    real(wp) :: goal = 0.0_wp                     !< time towards which the last step went [s]
    real(wp) :: correction = 0.0_wp               !< largest correction in the last trial step, in units of the coordinates
    integer :: stagnant_steps = 0                 !< number of stagnant steps towards the goal
    integer(long) :: steps = 0                    !< number of accepted steps
    integer(long) :: halvings = 0                 !< number of refused steps
    integer(long) :: iterations = 0               !< number of iterations of Newton's method in all blocks
  end type branch_stepper_type

contains

  !> Independent coordinates and their derivatives at a time, from the drives.
  subroutine set_inputs(drives, t, q, dq, ddq, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    real(wp), intent(in) :: t   !< time [s]
    real(wp), intent(inout) :: q(:)   !< (M) coordinates [rad, m]: the driven ones are set
    real(wp), intent(inout) :: dq(:)   !< (M) their rates: the driven ones are set
    real(wp), intent(inout) :: ddq(:)   !< (M) their accelerations: the driven ones are set
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i, k

    do i = 1, size(drives)
      k = drives(i)%drive%coordinate
      call drives(i)%drive%evaluate(t, q(k), dq(k), ddq(k), err)
      if (allocated(err)) return
    end do
  end subroutine set_inputs

  !> A branch stepper at an assembled position, whose rates and accelerations are not known yet.
  pure function new_branch_stepper(drives, plan, assembled) result(stepper)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: assembled   !< an assembled position
    type(branch_stepper_type) :: stepper
    integer :: b, m

    stepper%state = assembled
    m = plan%n_coordinates
    stepper%predictor = new_predictor(m)
    allocate (stepper%work(size(plan%blocks)), stepper%monitors(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      stepper%work(b) = new_block_work(plan%blocks(b), plan)
      stepper%monitors(b) = new_singularity_monitor(plan%blocks(b))
    end do
    call take_made_blocks(plan, stepper%work)
    allocate (stepper%per_unit(m))
    stepper%per_unit = 1.0_wp/plan%unit_of
    stepper%drives = drives_of_chains(drives, plan)
  end function new_branch_stepper

  !> Numbers of the drives whose coordinates belong to closed chains. Those of open chains, and of linear couplings between open
  !> chains, may move any distance in a step.
  pure function drives_of_chains(drives, plan) result(numbers)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, allocatable :: numbers(:)
    logical :: marked(plan%n_coordinates), drives_chain(size(drives))
    integer :: b, c, i

    marked = .false.
    ! later blocks first: a coupling hands the motion of its coordinates on to them
    do b = size(plan%blocks), 1, -1
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        associate (closure => plan%closures(c))
          call mark_path(plan%steps, closure%closing, marked)
          call mark_path(plan%steps, closure%target, marked)
          if (closure%coupling == 0) cycle
          if (plan%blocks(b)%is_linear .and. .not. any(marked(closure%loop%steps))) cycle
          do i = 1, size(closure%loop%steps)
            call mark_path(plan%steps, closure%loop%steps(i), marked)
          end do
        end associate
      end do
    end do
    do i = 1, size(drives)
      drives_chain(i) = marked(plan%step_of(drives(i)%drive%coordinate))
    end do
    numbers = numbers_of(drives_chain)
  end function drives_of_chains

  !> Take the state, complete with its accelerations, as the accepted position; nothing is known of the motion before it.
  !> The monitors must hold the Jacobians of all blocks there (see factorize_trial).
  pure subroutine accept_start(stepper)
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper

    stepper%accelerations_found = .true.
    call begin_prediction(stepper%state, stepper%predictor)
    call accept_jacobians(stepper%work, stepper%monitors)
  end subroutine accept_start

  !> Take one accepted step towards time t, as long as can be trusted. `stuck` means that even the shortest step is
  !> refused, or that too many steps led nearly nowhere; `refused_by` then names the block. Fails where a drive or a pair has
  !> no value.
  subroutine step_towards(drives, plan, stepper, t, stuck, refused_by, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    real(wp), intent(in) :: t   !< time to go towards [s]
    logical, intent(out) :: stuck   !< even the shortest step is refused, or too many steps led nearly nowhere
    integer, intent(out) :: refused_by   !< number of the block that refused the last step, 0 if none
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: remaining, h, worst
    logical :: driven, complete

    stuck = .false.
    if (abs(t - stepper%goal) > 0.0_wp) stepper%stagnant_steps = 0
    stepper%goal = t
    do
      remaining = t - stepper%predictor%t
      h = min(abs(remaining), stepper%reach)
      call limit_by_drives(drives, plan, stepper, sign(1.0_wp, remaining), h, driven)
      stepper%state%t = stepper%predictor%t + sign(h, remaining)
      ! two equal steps rather than a long one and a short remainder
      if (h < abs(remaining) .and. 2.0_wp*h > abs(remaining)) &
        stepper%state%t = stepper%predictor%t + 0.5_wp*remaining
      if (h >= abs(remaining)) stepper%state%t = t
      h = abs(stepper%state%t - stepper%predictor%t)
      complete = stepper%derivatives > 1 .or. any(is_near(stepper%monitors))
      refused_by = 0
      call set_inputs(drives, stepper%state%t, stepper%state%q, stepper%state%dq, stepper%state%ddq, err)
      if (allocated(err)) return
      call try_step(plan, stepper, complete, worst, refused_by, err)
      if (worst <= 1.0_wp) then
        stepper%reach = min(2.0_wp*min(max(stepper%reach, h), 1.0e100_wp), 0.8_wp*h/max(worst, 1.0e-6_wp))
        if (h < stagnant_step*abs(remaining) .and. .not. driven) &
          call count_stagnant(plan, stepper, stuck, refused_by)
        call accept_step(plan, stepper, complete)
        return
      end if
      stepper%halvings = stepper%halvings + 1
      stepper%reach = h*max(0.1_wp, min(0.6_wp, 0.8_wp/worst))
      stuck = stepper%reach <= least_step*max(abs(t), abs(stepper%predictor%t))
      if (stuck) return
    end do
  end subroutine step_towards

  !> Count a short step that is about to be accepted, if it moves no coordinate far. Without a limit to such steps the
  !> motion might never reach its goal.
  pure subroutine count_stagnant(plan, stepper, too_many, slowest)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    logical, intent(out) :: too_many   !< more steps led nearly nowhere than are allowed
    integer, intent(inout) :: slowest         !< changed if too many: number of the block nearest to a singular position
    integer :: b

    if (any(abs(stepper%state%q - stepper%predictor%q) > stagnant_move*plan%unit_of)) then
      too_many = .false.
      return
    end if
    stepper%stagnant_steps = stepper%stagnant_steps + 1
    too_many = stepper%stagnant_steps > most_stagnant
    if (.not. too_many) return
    do b = 1, size(plan%blocks)
      if (nearness(stepper%monitors(b)) < nearness(stepper%monitors(slowest))) slowest = b
    end do
  end subroutine count_stagnant

  !> Shorten a step until no driven coordinate of a closed chain can move far within it.
  subroutine limit_by_drives(drives, plan, stepper, direction, h, driven)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    real(wp), intent(in) :: direction         !< +1, or -1 backwards in time
    real(wp), intent(inout) :: h              !< length of the step, > 0 [s]
    logical, intent(out) :: driven            !< the step was shortened
    real(wp) :: part
    integer :: i, trial

    driven = .false.
    do i = 1, size(stepper%drives)
      associate (drive => drives(stepper%drives(i))%drive)
        ! the bound of the rate depends on the step, so that the length is found by iteration
        do trial = 1, 100
          part = h*drive%greatest_rate(stepper%predictor%t, direction*h)/(longest_drive*plan%unit_of(drive%coordinate))
          if (.not. part > 1.0_wp) exit
          driven = .true.
          h = h*max(0.2_wp, 0.99_wp/part)
          stepper%reach = h
        end do
      end associate
    end do
  end subroutine limit_by_drives

  !> Predict, correct and judge one step of all blocks, from the last accepted position to the time in the state, for which the
  !> independent coordinates are set.
  subroutine try_step(plan, stepper, complete, worst, refused_by, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    logical, intent(in) :: complete             !< find accelerations too
    real(wp), intent(out) :: worst              !< measure of the step: accepted up to 1, else about the factor it is too long
    integer, intent(out) :: refused_by          !< number of the block judged last, which refused the step if worst > 1
    type(error_type), allocatable, intent(out) :: err   !< allocated if a pair has no pose
    type(newton_outcome_type) :: newton
    real(wp) :: unchanged
    logical :: is_moved
    integer :: b

    refused_by = 0
    worst = 0.0_wp
    unchanged = unchanged_factors
    ! only the prediction of the next position depends on these rates
    if (.not. complete .and. stepper%derivatives == 0) unchanged = unchanged_prediction
    stepper%correction = 0.0_wp
    call prepare_prediction(stepper%state%t, stepper%predictor)
    do b = 1, min(size(plan%blocks), stepper%last_block)
      refused_by = b
      associate (block => plan%blocks(b), work => stepper%work(b))
        is_moved = .false.
        if (work%made > 0) then
          call predict(block, stepper%predictor, stepper%state)
          call move_as_made(plan, block, complete, stepper%state, work, newton, is_moved)
        end if
        if (.not. is_moved) then
          call predict(block, stepper%predictor, stepper%state)
          ! Newton's method goes on to round-off, because beside a singular position a small residual means a large error
          call close_block(plan, block, stepper%state, work, newton, err, 1)
        end if
        stepper%iterations = stepper%iterations + newton%iterations
        stepper%correction = max(stepper%correction, newton%correction)
        ! a pair may have no pose at the end of a step that is too long
        if (allocated(err) .or. .not. newton%converged) worst = 4.0_wp
        if (worst > 1.0_wp) return
        if (size(block%unknowns) > 0) &
          call monitor_step(plan, block, stepper%state, newton%last <= unchanged, work, stepper%monitors(b), worst)
        if (worst > 1.0_wp) return
        if (is_moved) then
          continue
        else if (complete) then
          call solve_motion(plan, block, stepper%state, work)
        else
          call solve_rates(plan, block, stepper%state, work, without_accelerations=.true.)
        end if
        call judge_step(block, stepper%per_unit, stepper%predictor, stepper%state, newton, stepper%monitors(b)%trial_pivot, &
                        worst)
        if (worst > 1.0_wp) return
      end associate
    end do
  end subroutine try_step

  !> Judge a block's step by the correction of its prediction, by its movement, and by the change of its rates.
  pure subroutine judge_step(block, per_unit, predictor, state, newton, pivot, worst)
    type(block_type), intent(in) :: block   !< the block
    real(wp), intent(in), contiguous :: per_unit(:)   !< (M) reciprocals of the coordinates' units
    type(predictor_type), intent(in) :: predictor   !< the position accepted last, where the step starts
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(newton_outcome_type), intent(in) :: newton   !< outcome of Newton's method for the block
    real(wp), intent(in) :: pivot   !< least pivot of the block's Jacobian at the end of the step
    real(wp), intent(inout) :: worst   !< raised to at least the measure of this step: at most 1 where it can be accepted
    real(wp) :: move, rate_change
    integer :: m

    if (size(block%unknowns) == 0 .or. block%is_linear) return
    worst = max(worst, newton%correction/(trusted_correction*pivot))
    if (newton%correction > small_correction*pivot) worst = max(worst, newton%contraction/trusted_contraction)
    m = size(per_unit)
    call find_changes(state%q, predictor%q, state%dq, predictor%dq, move, rate_change)
    rate_change = rate_change*abs(state%t - predictor%t)
    worst = max(worst, move/longest_move, rate_change/(trusted_rate_change*max(move, trusted_correction*pivot)))

  contains

    !> Largest differences of the block's coordinates and of their rates over the step, in their units. Arrays have explicit shapes,
    !> so that the compiler keeps their addresses in registers.
    pure subroutine find_changes(q, q_before, dq, dq_before, move, rate_change)
      real(wp), intent(in) :: q(m)              !< coordinates at the end of the step [rad, m]
      real(wp), intent(in) :: q_before(m)       !< coordinates at its start
      real(wp), intent(in) :: dq(m)             !< rates at the end of the step
      real(wp), intent(in) :: dq_before(m)      !< rates at its start
      real(wp), intent(out) :: move             !< largest difference of the coordinates
      real(wp), intent(out) :: rate_change      !< largest difference of the rates [per s]
      integer :: i, k

      move = 0.0_wp
      rate_change = 0.0_wp
      do i = 1, size(block%coordinates)
        k = block%coordinates(i)
        move = max(move, abs(q(k) - q_before(k))*per_unit(k))
        rate_change = max(rate_change, abs(dq(k) - dq_before(k))*per_unit(k))
      end do
    end subroutine find_changes
  end subroutine judge_step

  !> The trial position becomes the accepted one.
  pure subroutine accept_step(plan, stepper, complete)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    logical, intent(in) :: complete             !< the accelerations in the state are known

    stepper%steps = stepper%steps + 1
    stepper%accelerations_found = complete
    call add_position(stepper%state, plan%unit_of, complete, stepper%correction, stepper%predictor)
    call accept_jacobians(stepper%work, stepper%monitors)
  end subroutine accept_step

  !> Find the accelerations at the accepted position, if they are not known.
  subroutine add_accelerations(plan, stepper)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    integer :: b

    if (stepper%accelerations_found) return
    do b = 1, min(size(plan%blocks), stepper%last_block)
      call solve_motion(plan, plan%blocks(b), stepper%state, stepper%work(b))
    end do
    stepper%accelerations_found = .true.
    call set_accelerations(stepper%state%ddq, stepper%predictor)
  end subroutine add_accelerations

  !> Restore the last accepted position after a step that failed.
  pure subroutine restore_last_position(stepper)
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper

    stepper%state%t = stepper%predictor%t
    stepper%state%q = stepper%predictor%q
    stepper%state%dq = stepper%predictor%dq
    stepper%state%ddq = stepper%predictor%ddq
    stepper%accelerations_found = .false.
  end subroutine restore_last_position
end module mech9_branch_stepping
