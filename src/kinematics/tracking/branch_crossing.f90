!> Motion through a position where branches cross, on the branch whose velocities are continuous.
!>
!> At the crossing the equations of the block do not distinguish one branch from the other, but each branch is smooth: the
!> polynomial through regular positions before it leads to regular positions after it, where Newton's method has only one
!> solution near by. Positions between are those of the polynomial through all of them, closed in the directions that the
!> equations determine.
module mech9_branch_crossing
  use mech9_kinds, only: wp
  use mech9_tolerances, only: near_singular
  use mech9_tracking_tolerances, only: shorter_crossing, trusted_crossing, trusted_crossing_rates
  use mech9_error, only: error_type
  use mech9_hermite, only: hermite_type, build_hermite
  use mech9_law, only: drive_slot_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, newton_outcome_type, close_block, solve_rates, solve_accelerations, apply_change
  use mech9_singularity_monitor, only: singularity_monitor_type, factorize_trial
  use mech9_branch_stepping, only: branch_stepper_type, accept_start, step_towards, set_inputs
  use mech9_frame_motion, only: place_frames, spread_velocities, spread_accelerations
  use mech9_block_equations, only: block_rates, block_residual
  implicit none
  private
  public :: branch_crossing_type, build_crossing, position_within, close_from_rates, step_until, copy_stepper

  !> The motion through a crossing, from one regular position to another.
  type :: branch_crossing_type
    logical :: exists = .false.                  !< the motion through the crossing was found
    real(wp) :: from = 0.0_wp                    !< time of the first position of the polynomial [s]
    real(wp) :: to = 0.0_wp                      !< time of its last position [s]
    type(hermite_type) :: polynomial             !< all coordinates over time
    class(branch_stepper_type), allocatable :: stepper_beyond   !< branch stepper at the last position, where it exists
    logical :: ends = .false.                    !< the motion ends at the crossing: the drives have no value beyond it
  end type branch_crossing_type

  !> Number of distances from the crossing that are tried.
  integer, parameter :: most_trials = 4
  !> Outcome of closing all blocks: the position is certain, or it is not, or a drive has no value there.
  integer, parameter :: is_certain = 1, is_uncertain = 2, has_no_drive = 3

contains

  !> Find the motion through the crossing at time t, on the branch of `stepper`, whose position must be near but regular.
  !> It does not exist where no smooth motion goes on. Fails where a pair has no pose.
  subroutine build_crossing(drives, plan, stepper, t, crossing, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper at a regular position near the crossing
    real(wp), intent(in) :: t   !< time of the crossing [s]
    type(branch_crossing_type), intent(inout) :: crossing   !< the crossing and the motion through it
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(branch_stepper_type) :: probe
    real(wp) :: half
    integer :: trial

    half = t - stepper%predictor%t
    crossing%exists = .false.
    do trial = 1, most_trials
      call copy_stepper(stepper, probe)
      probe%derivatives = 2
      if (trial > 1) call step_until(drives, plan, probe, t - half, crossing%exists, err)
      if (allocated(err)) return
      if (trial == 1 .or. crossing%exists) call try_crossing(drives, plan, probe, t, half, crossing, err)
      if (allocated(err) .or. crossing%exists) return
      half = half*shorter_crossing
    end do
  end subroutine build_crossing

  !> Try to find the motion through the crossing by two positions before it and two after it.
  subroutine try_crossing(drives, plan, probe, t, half, crossing, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: probe   !< a copy of the branch stepper, at time t - half
    real(wp), intent(in) :: t   !< time of the crossing [s]
    real(wp), intent(in) :: half   !< half of the time that the polynomial is to cover, negative backwards [s]
    type(branch_crossing_type), intent(inout) :: crossing   !< the crossing and the motion through it
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), dimension(plan%n_coordinates, 4) :: q, dq, ddq
    real(wp) :: times(4)
    integer :: outcome

    times = t + half*[-1.0_wp, -0.5_wp, 0.5_wp, 1.0_wp]
    call take(1)
    call step_until(drives, plan, probe, times(2), crossing%exists, err)
    if (allocated(err) .or. .not. crossing%exists) return
    call take(2)
    crossing%from = times(1)
    crossing%to = times(4)
    crossing%ends = .false.
    call build_hermite(times(:2), q(:, :2), dq(:, :2), ddq(:, :2), crossing%polynomial)
    probe%state%t = times(3)
    call close_all_blocks(drives, plan, crossing%polynomial, 1.0_wp, probe, outcome, err)
    crossing%exists = outcome == is_certain
    if (outcome == has_no_drive) then
      deallocate (err)
      call end_at_crossing()
      return
    end if
    if (.not. crossing%exists) return
    call take(3)
    call build_hermite(times(:3), q(:, :3), dq(:, :3), ddq(:, :3), crossing%polynomial)
    probe%state%t = times(4)
    call close_all_blocks(drives, plan, crossing%polynomial, 1.0_wp, probe, outcome, err)
    crossing%exists = outcome == is_certain
    if (outcome == has_no_drive) deallocate (err)
    if (.not. crossing%exists) return
    call take(4)
    call build_hermite(times, q, dq, ddq, crossing%polynomial)
    if (.not. allocated(crossing%stepper_beyond)) allocate (crossing%stepper_beyond)
    call copy_stepper(probe, crossing%stepper_beyond)

  contains

    !> Keep the position of `probe`.
    subroutine take(i)
      integer, intent(in) :: i   !< column of the position in q, dq and ddq

      q(:, i) = probe%predictor%q
      dq(:, i) = probe%predictor%dq
      ddq(:, i) = probe%predictor%ddq
    end subroutine take

    !> The last output may lie at the crossing where the drives have no value beyond it: one more position before it.
    subroutine end_at_crossing()
      times(3) = t - 0.25_wp*half
      call step_until(drives, plan, probe, times(3), crossing%exists, err)
      if (allocated(err) .or. .not. crossing%exists) return
      call take(3)
      call build_hermite(times(:3), q(:, :3), dq(:, :3), ddq(:, :3), crossing%polynomial)
      crossing%ends = .true.
    end subroutine end_at_crossing
  end subroutine try_crossing

  !> Take regular steps until a time is reached.
  subroutine step_until(drives, plan, stepper, t, arrived, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    real(wp), intent(in) :: t   !< time to reach [s]
    logical, intent(out) :: arrived   !< the time was reached
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical :: stuck
    integer :: refused_by

    stuck = .false.
    do while (abs(t - stepper%predictor%t) > 0.0_wp .and. .not. stuck)
      call step_towards(drives, plan, stepper, t, stuck, refused_by, err)
      if (allocated(err)) exit
    end do
    arrived = .not. (stuck .or. allocated(err))
  end subroutine step_until

  !> Close all blocks at time t, predicted in a straight line from a start where only positions and rates are known.
  subroutine close_from_rates(drives, plan, t, stepper, ok, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: t   !< time of the position to close [s]
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper
    logical, intent(out) :: ok   !< the position was closed and is certain
    type(error_type), allocatable, intent(out) :: err        !< a pair has no pose, or a drive no value
    type(hermite_type) :: polynomial
    real(wp), dimension(plan%n_coordinates, 1) :: q, dq, ddq
    integer :: outcome

    q(:, 1) = stepper%state%q
    dq(:, 1) = stepper%state%dq
    ddq = 0.0_wp
    call build_hermite([stepper%state%t], q, dq, ddq, polynomial)
    stepper%state%t = t
    call close_all_blocks(drives, plan, polynomial, 10.0_wp, stepper, outcome, err)
    ok = outcome == is_certain
  end subroutine close_from_rates

  !> Close all blocks at the time in the state, predicted by a polynomial. The result is certain if its corrections and the
  !> differences of its rates from those of the polynomial are small.
  subroutine close_all_blocks(drives, plan, polynomial, slack, stepper, outcome, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(hermite_type), intent(in) :: polynomial   !< all coordinates over time
    real(wp), intent(in) :: slack   !< factor on the distances from the prediction that are trusted
    type(branch_stepper_type), intent(inout) :: stepper   !< the branch stepper, with the time in its state
    integer, intent(out) :: outcome   !< is_certain, is_uncertain or has_no_drive
    type(error_type), allocatable, intent(out) :: err   !< a pair has no pose, or a drive no value
    real(wp), dimension(plan%n_coordinates) :: q, dq, ddq
    type(newton_outcome_type) :: newton
    integer :: b

    outcome = is_uncertain
    call polynomial%evaluate(stepper%state%t, q, dq, ddq)
    stepper%state%q = q
    call set_inputs(drives, stepper%state%t, stepper%state%q, stepper%state%dq, stepper%state%ddq, err)
    if (allocated(err)) then
      outcome = has_no_drive
      stepper%state%q = stepper%predictor%q
      return
    end if
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b), work => stepper%work(b), monitor => stepper%monitors(b))
        call close_block(plan, block, stepper%state, work, newton, err, 1)
        stepper%iterations = stepper%iterations + newton%iterations
        if (allocated(err) .or. .not. newton%converged) return
        call factorize_trial(plan, block, stepper%state, work, monitor)
        if (size(block%unknowns) > 0 .and. newton%correction > slack*trusted_crossing*monitor%trial_pivot) return
        call solve_rates(plan, block, stepper%state, work)
        call solve_accelerations(plan, block, stepper%state, work)
      end associate
    end do
    if (.not. maxval(abs(stepper%state%dq - dq)/plan%unit_of) <= slack*trusted_crossing_rates*maxval(abs(dq)/plan%unit_of)) return
    outcome = is_certain
    stepper%steps = stepper%steps + 1
    call accept_start(stepper)
  end subroutine close_all_blocks

  !> Position, rates and accelerations at a time within the crossing.
  subroutine position_within(drives, plan, crossing, t, stepper, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_crossing_type), intent(in) :: crossing   !< the crossing and the motion through it
    real(wp), intent(in) :: t   !< time, within the crossing [s]
    type(branch_stepper_type), intent(inout) :: stepper   !< its state gets the position and motion; the accepted position stays
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(newton_outcome_type) :: newton
    real(wp), dimension(plan%n_coordinates) :: dq, ddq
    integer :: b

    associate (state => stepper%state)
      state%t = t
      call crossing%polynomial%evaluate(t, state%q, dq, ddq)
      state%dq = dq
      state%ddq = ddq
      call set_inputs(drives, t, state%q, state%dq, state%ddq, err)
    end associate
    if (allocated(err)) return
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b), state => stepper%state, work => stepper%work(b), monitor => stepper%monitors(b))
        call place_frames(plan, block, state, err)
        if (allocated(err)) return
        call factorize_trial(plan, block, state, work, monitor)
        if (size(block%unknowns) > 0 .and. monitor%trial_pivot < near_singular*monitor%largest_pivot) then
          call close_where_determined(plan, block, state, work, monitor, err)
          if (allocated(err)) return
          state%dq(block%coordinates) = dq(block%coordinates)
          state%ddq(block%coordinates) = ddq(block%coordinates)
          call move_where_determined(plan, block, state, work, monitor)
        else
          call close_block(plan, block, state, work, newton, err)
          if (allocated(err)) return
          call factorize_trial(plan, block, state, work, monitor)
          call solve_rates(plan, block, state, work)
          call solve_accelerations(plan, block, state, work)
        end if
      end associate
    end do
  end subroutine position_within

  !> Close a block as far as its equations determine it: the directions of the least pivots are left as predicted.
  subroutine close_where_determined(plan, block, state, work, monitor, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its Jacobian and factors
    type(singularity_monitor_type), intent(in) :: monitor   !< the monitor of the block
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i

    do i = 1, 2
      call block_residual(plan, block, state, work%right)
      call solve_where_determined(work, monitor)
      call apply_change(plan, block, work%change, state)
      call place_frames(plan, block, state, err)
      if (allocated(err)) return
    end do
  end subroutine close_where_determined

  !> Correct rates and accelerations of a block as far as its equations determine them.
  subroutine move_where_determined(plan, block, state, work, monitor)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its Jacobian and factors
    type(singularity_monitor_type), intent(in) :: monitor   !< the monitor of the block

    associate (k => block%coordinates)
      call spread_velocities(plan, block, state)
      call block_rates(plan, block, 1, state, work%right)
      call solve_where_determined(work, monitor)
      state%dq(k) = state%dq(k) + work%change*plan%unit_of(k)
      call spread_velocities(plan, block, state)
      call spread_accelerations(plan, block, block%last_step, state)
      call block_rates(plan, block, 2, state, work%right)
      call solve_where_determined(work, monitor)
      state%ddq(k) = state%ddq(k) + work%change*plan%unit_of(k)
      call spread_accelerations(plan, block, block%last_step, state)
    end associate
  end subroutine move_where_determined

  !> The least change that cancels the right-hand side in `work`, without the directions of the least pivots.
  subroutine solve_where_determined(work, monitor)
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with its Jacobian and factors
    type(singularity_monitor_type), intent(in) :: monitor   !< the monitor of the block

    work%right = -work%right
    call work%equations%solve(work%right, work%change, tolerance=near_singular*monitor%largest_pivot/work%equations%largest_pivot())
  end subroutine solve_where_determined

  !> Copy a branch stepper. The assignment stands here alone, because compilers write it out for all components.
  pure subroutine copy_stepper(from, to)
    type(branch_stepper_type), intent(in) :: from    !< the branch stepper
    type(branch_stepper_type), intent(inout) :: to   !< the same afterwards

    to = from
  end subroutine copy_stepper
end module mech9_branch_crossing
