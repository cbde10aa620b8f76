!> A driven motion from output to output, through singular positions or up to its end.
module mech9_driven_motion
  use mech9_kinds, only: wp, long
  use mech9_tolerances, only: singular_conditioning
  use mech9_tracking_tolerances, only: just_short_of_end, doubtful_margin
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_tracking_failures, only: failure_start_at_dead_point, failure_start_on_branches, failure_start_unclear, &
    failure_start_locked, failure_start_not_left, failure_escape, failure_dead_point, failure_lost_branch
  use mech9_three_turns, only: three_turns_type
  use mech9_law, only: drive_slot_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: solve_rates, solve_accelerations
  use mech9_conditioning, only: conditioning_type
  use mech9_singularity_monitor, only: factorize_trial, is_near
  use mech9_branch_stepping, only: branch_stepper_type, new_branch_stepper, accept_start, step_towards, set_inputs, &
    restore_last_position, add_accelerations
  use mech9_special_position, only: finding_type, look_ahead, find_escape, has_slides, nothing_special, dead_point, &
    branch_point, uncertain, escape
  use mech9_special_start, only: starting_rates_type, find_starting_rates, start_crossing
  use mech9_branch_crossing, only: branch_crossing_type, build_crossing, position_within, copy_stepper
  use mech9_held_rods, only: held_rod_type, should_change
  use mech9_frame_motion, only: spread_velocities
  use mech9_block_equations, only: largest_gap
  implicit none
  private
  public :: driven_motion_type, ball_angles_in_use_type, start_driven_motion, advance, ends_before, set_inputs, angles_in_doubt

  !> The angles by which a ball joint moves at present.
  type :: ball_angles_in_use_type
    type(three_turns_type) :: turns   !< the three turns
    integer :: second = 0             !< coordinate of the second turn
  end type ball_angles_in_use_type

  !> A driven motion: the branch stepper, the special position ahead, and counts for the report.
  type, extends(branch_stepper_type) :: driven_motion_type
    type(finding_type) :: ahead                   !< the special position ahead, if one was found
    type(branch_crossing_type) :: crossing        !< the motion through a crossing ahead
    logical, allocatable :: slides(:)             !< (blocks) a dependent coordinate of the block slides
    real(wp), allocatable :: clear_until(:)       !< (blocks) time up to which no special position was found [s]
    integer(long) :: crossings = 0                !< number of crossings that were passed
    type(conditioning_type) :: conditioning       !< worst conditioning of all outputs
    real(wp) :: closure = 0.0_wp                  !< largest closure error at the last output [m]
    real(wp) :: worst_closure = 0.0_wp            !< largest closure error at any output [m]
    real(wp), allocatable :: limit(:)             !< (M) independent coordinates where the motion ends [rad, m]
    type(ball_angles_in_use_type), allocatable :: angles(:)   !< of the ball joints whose angles can be replaced; may be missing
    type(held_rod_type), allocatable :: rods(:)   !< rods one of whose angles is held; may be missing
    logical :: stops_short = .false.              !< a motion that ends stops where its end is found, and does not go on up to it
    logical :: paused = .false.                   !< the motion waits short of the time to go to, at the end of a step
  end type driven_motion_type

contains

  !> Begin at an assembled position, with rates and accelerations there. Later outputs may need fewer derivatives.
  subroutine start_driven_motion(drives, plan, assembled, t, driven, err, derivatives)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: assembled   !< an assembled position
    real(wp), intent(in) :: t   !< time of the start [s]
    type(driven_motion_type), intent(out) :: driven   !< the driven motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, intent(in), optional :: derivatives   !< order of the highest derivative found at every position; 2 unless given
    integer :: b
    logical :: starts_singular

    starts_singular = .false.
    driven%branch_stepper_type = new_branch_stepper(drives, plan, assembled)
    if (present(derivatives)) driven%derivatives = derivatives
    driven%slides = has_slides(plan%blocks, plan)
    driven%state%t = t
    call set_inputs(drives, t, driven%state%q, driven%state%dq, driven%state%ddq, err)
    if (allocated(err)) return
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b), work => driven%work(b))
        call factorize_trial(plan, block, driven%state, work, driven%monitors(b))
        if (work%equations%conditioning() < singular_conditioning) then
          call find_rates_off_start(plan, block, starts_singular, driven, err)
          if (allocated(err)) return
          starts_singular = .true.
        else
          call solve_rates(plan, block, driven%state, work)
          call solve_accelerations(plan, block, driven%state, work)
        end if
      end associate
    end do
    if (starts_singular) then
      call begin_crossing(drives, plan, driven, err)
      if (allocated(err)) return
    else
      call accept_start(driven%branch_stepper_type)
    end if
    allocate (driven%clear_until(size(plan%blocks)), source=t)
    call judge_output(plan, driven)
  end subroutine start_driven_motion

  !> Find the rates of a block that starts in a singular position. Fails unless exactly one branch leads through it.
  subroutine find_rates_off_start(plan, block, another_is_singular, driven, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    logical, intent(in) :: another_is_singular   !< an earlier block starts in a singular position too
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(starting_rates_type) :: starting
    integer :: b, kind

    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%first_step == block%first_step) exit
    end do
    call find_starting_rates(plan, block, driven%state, driven%work(b), starting)
    if (starting%dead) then
      kind = failure_start_at_dead_point
    else if (starting%count == 2) then
      kind = failure_start_on_branches
    else if (starting%undetermined .or. another_is_singular) then
      kind = failure_start_unclear
    else if (starting%count == 0) then
      kind = failure_start_locked
    else
      driven%state%dq(block%coordinates) = starting%rates(:, 1)
      call spread_velocities(plan, block, driven%state)
      return
    end if
    call raise(err, exit_singular, kind)
    err%failure%chains = block%chains
    err%failure%coordinates = block%coordinates
    if (kind == failure_start_on_branches) call add_rates(plan, starting, err)
  end subroutine find_rates_off_start

  !> Add the rates by which a block could go on to a failure that has its coordinates.
  pure subroutine add_rates(plan, starting, err)
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism
    type(starting_rates_type), intent(in) :: starting       !< the rates of the block's coordinates
    type(error_type), intent(inout) :: err                  !< gets them, in units of the data file
    integer :: i

    err%failure%values = starting%rates(:, :starting%count)
    do i = 1, size(err%failure%coordinates)
      err%failure%values(i, :) = err%failure%values(i, :)/plan%rate_unit(err%failure%coordinates(i))
    end do
    err%failure%name = trim(plan%rate_names)
  end subroutine add_rates

  !> Find the motion off a singular start.
  subroutine begin_crossing(drives, plan, driven, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    driven%predictor%t = driven%state%t
    driven%predictor%q = driven%state%q
    driven%predictor%dq = driven%state%dq
    call start_crossing(drives, plan, driven%branch_stepper_type, driven%crossing, err)
    if (allocated(err)) return
    if (.not. driven%crossing%exists) then
      call raise(err, exit_singular, failure_start_not_left)
      return
    end if
    driven%monitors = driven%crossing%stepper_beyond%monitors
    call position_within(drives, plan, driven%crossing, driven%predictor%t, driven%branch_stepper_type, err)
  end subroutine begin_crossing

  !> Go on to a time on the same branch; the state then has position, rates and accelerations there. Fails with exit_singular
  !> where the motion cannot go on; the state is then the last one that was reached. Where the angles of a ball joint come near
  !> to their singular position, or another angle of a rod should be held, or many steps were taken, the motion is `paused` at the
  !> end of a step.
  subroutine advance(drives, plan, driven, t, err, most_steps)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    real(wp), intent(in) :: t   !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, intent(in), optional :: most_steps   !< steps after which the motion pauses; any number unless given
    real(wp) :: direction
    integer(long) :: last_step
    integer :: refused_by
    logical :: stuck

    last_step = huge(last_step)
    if (present(most_steps)) last_step = driven%steps + most_steps
    driven%paused = .false.
    do while (abs(t - driven%predictor%t) > 0.0_wp)
      direction = sign(1.0_wp, t - driven%predictor%t)
      if (driven%crossing%exists) then
        if (.not. (t - driven%crossing%to)*direction > 0.0_wp .or. driven%crossing%ends) then
          call position_within(drives, plan, driven%crossing, t, driven%branch_stepper_type, err)
          exit
        end if
        call leave_crossing(driven)
        cycle
      end if
      if (ends_before(driven, t)) then
        call end_motion(drives, plan, driven, err)
        exit
      end if
      call step_towards(drives, plan, driven%branch_stepper_type, t, stuck, refused_by, err)
      if (allocated(err)) exit
      driven%paused = angles_in_doubt(driven)
      if (driven%paused) exit
      if (stuck) then
        ! an escape that was found before explains why no step is accepted
        if (driven%ahead%kind /= escape .or. driven%ahead%block /= refused_by) &
          driven%ahead = finding_type(uncertain, refused_by, driven%predictor%t)
        call fail_at_end(drives, plan, driven, err)
        exit
      end if
      call look_ahead_if_near(drives, plan, driven, direction, err)
      if (allocated(err)) exit
      driven%paused = driven%steps >= last_step .and. abs(t - driven%predictor%t) > 0.0_wp
      if (driven%paused) exit
    end do
    if (allocated(err)) then
      call restore_last_position(driven%branch_stepper_type)
    else if (.not. driven%paused) then
      call judge_output(plan, driven)
    end if
  end subroutine advance

  !> Whether a dead point that lies ahead ends the motion before it comes to a time.
  pure logical function ends_before(driven, t)
    type(driven_motion_type), intent(in) :: driven   !< the driven motion
    real(wp), intent(in) :: t                        !< the time [s]
    real(wp) :: direction

    direction = sign(1.0_wp, t - driven%predictor%t)
    ends_before = driven%ahead%kind == dead_point .and. (driven%ahead%t - driven%predictor%t)*direction > 0.0_wp .and. &
                  .not. (driven%ahead%t - t)*direction > 0.0_wp
  end function ends_before

  !> Whether the angles of a ball joint are near their singular position, so that others should be taken, or another angle of a rod
  !> should be held.
  pure logical function angles_in_doubt(driven)
    type(driven_motion_type), intent(in) :: driven   !< the driven motion
    integer :: i

    angles_in_doubt = .false.
    if (allocated(driven%rods)) then
      do i = 1, size(driven%rods)
        angles_in_doubt = angles_in_doubt .or. should_change(driven%rods(i), driven%state, any(is_near(driven%monitors)))
      end do
    end if
    if (.not. allocated(driven%angles)) return
    do i = 1, size(driven%angles)
      associate (angles => driven%angles(i))
        angles_in_doubt = angles_in_doubt .or. angles%turns%margin(driven%predictor%q(angles%second)) < doubtful_margin
      end associate
    end do
  end function angles_in_doubt

  !> Look ahead after a step if a block has come near a singular position.
  subroutine look_ahead_if_near(drives, plan, driven, direction, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    real(wp), intent(in) :: direction   !< +1, or -1 backwards in time
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(finding_type) :: ahead
    integer :: b

    do b = 1, size(plan%blocks)
      if (size(plan%blocks(b)%unknowns) == 0) cycle
      ahead%kind = nothing_special
      if (driven%slides(b)) call find_escape(plan, driven%branch_stepper_type, b, .false., ahead)
      if (ahead%kind == escape) then
        driven%ahead = ahead
        call fail_at_end(drives, plan, driven, err)
        return
      end if
      if (.not. is_near(driven%monitors(b))) cycle
      ! a special position ahead is known already, or none was found up to a later time
      if (driven%ahead%kind /= nothing_special) exit
      if ((driven%clear_until(b) - driven%predictor%t)*direction > 0.0_wp) cycle
      call add_accelerations(plan, driven%branch_stepper_type)
      call look_ahead(drives, plan, driven%branch_stepper_type, b, direction, ahead)
      driven%clear_until(b) = ahead%t
      driven%ahead = ahead
      if (ahead%kind == branch_point) then
        call build_crossing(drives, plan, driven%branch_stepper_type, ahead%t, driven%crossing, err)
        if (allocated(err)) return
        if (.not. driven%crossing%exists) driven%ahead%kind = uncertain
      end if
      ! the motion goes on up to a dead point, or until a coordinate that escapes is far away
      if (driven%ahead%kind == uncertain) call fail_at_end(drives, plan, driven, err)
      if (allocated(err)) return
    end do
  end subroutine look_ahead_if_near

  !> Go on from the end of a crossing.
  pure subroutine leave_crossing(driven)
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    real(wp) :: largest
    integer :: b, derivatives

    do b = 1, size(driven%monitors)
      largest = driven%monitors(b)%largest_pivot
      driven%crossing%stepper_beyond%monitors(b)%largest_pivot = max(largest, &
        driven%crossing%stepper_beyond%monitors(b)%largest_pivot)
    end do
    derivatives = driven%derivatives
    call copy_stepper(driven%crossing%stepper_beyond, driven%branch_stepper_type)
    driven%derivatives = derivatives
    driven%crossing%exists = .false.
    driven%crossings = driven%crossings + 1
    ! the crossing is still near, but it is behind
    driven%ahead%kind = nothing_special
    driven%clear_until = driven%crossing%to + (driven%crossing%to - driven%crossing%from)
  end subroutine leave_crossing

  !> Go as near to the end of the motion as regular steps lead, and fail with the reason.
  subroutine end_motion(drives, plan, driven, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: t
    integer :: refused_by
    logical :: stuck

    t = driven%ahead%t - just_short_of_end*(driven%ahead%t - driven%predictor%t)
    stuck = driven%stops_short
    do while (abs(t - driven%predictor%t) > 0.0_wp .and. .not. stuck .and. .not. allocated(err))
      call step_towards(drives, plan, driven%branch_stepper_type, t, stuck, refused_by, err)
    end do
    call fail_at_end(drives, plan, driven, err)
  end subroutine end_motion

  !> Keep the closure error and the conditioning of an output.
  subroutine judge_output(plan, driven)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion

    driven%closure = largest_gap(plan, driven%state)
    driven%worst_closure = max(driven%worst_closure, driven%closure)
    call driven%conditioning%update_by_pivots(driven%state%t, driven%work)
  end subroutine judge_output

  !> Fail where and why the motion cannot go on, and keep the independent coordinates there.
  subroutine fail_at_end(drives, plan, driven, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(error_type), allocatable :: no_value
    real(wp), dimension(plan%n_coordinates) :: q, dq, ddq
    integer :: i, k, kind

    q = driven%predictor%q
    call set_inputs(drives, driven%ahead%t, q, dq, ddq, no_value)
    driven%limit = q
    select case (driven%ahead%kind)
    case (escape)
      kind = failure_escape
    case (dead_point)
      kind = failure_dead_point
    case default
      kind = failure_lost_branch
    end select
    call raise(err, exit_singular, kind)
    associate (block => plan%blocks(driven%ahead%block), failure => err%failure)
      failure%chains = block%chains
      failure%coordinates = block%coordinates
      failure%number = block%last_closure - block%first_closure + 1
      failure%t = driven%ahead%t
      failure%growing = driven%ahead%coordinate
      failure%others = plan%independent
      allocate (failure%values(size(plan%independent), 1))
      do i = 1, size(plan%independent)
        k = plan%independent(i)
        failure%values(i, 1) = q(k)/plan%result_unit(k)
      end do
    end associate
  end subroutine fail_at_end
end module mech9_driven_motion
