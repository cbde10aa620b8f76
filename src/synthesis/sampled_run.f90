!> The run of a design whose chains may open, sampled to find the coordinates and times at its targets.
module mech9_sampled_run
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: new_state
  use mech9_state, only: state_type
  use mech9_block_solver, only: new_block_work, block_work_type
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  use mech9_frame_motion, only: place_all
  use mech9_branch_stepping, only: set_inputs
  use mech9_objective, only: timing_free
  use mech9_design_space, only: design_type
  use mech9_open_position, only: open_position_type, find_openings
  use mech9_targets, only: target_type, difference
  use mech9_relaxed_fit, only: relaxed_fit_type, turn_on
  implicit none
  private
  public :: sample_run, reach

  integer, parameter :: fewest_samples = 48   !< positions at which free times are looked for

contains

  !> Close all chains from the coordinates in the state, or come as near as damped least squares lead.
  subroutine reach(design, t, target, state, closed)
    type(design_type), intent(in) :: design       !< placed
    real(wp), intent(in) :: t                     !< time [s]
    type(target_type), intent(in) :: target       !< may turn a crank on
    type(state_type), intent(inout) :: state      !< coordinates in and out
    logical, intent(out) :: closed                !< all chains are closed
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    integer :: b

    closed = .false.
    state%t = t
    call set_inputs(design%drives, t, state%q, state%dq, state%ddq, err)
    call turn_on(target, state%q)
    if (.not. allocated(err)) call place_all(design%plan, state, err)
    if (allocated(err)) return
    closed = .true.
    do b = 1, size(design%plan%blocks)
      if (size(design%plan%blocks(b)%unknowns) == 0) cycle
      work = new_block_work(design%plan%blocks(b))
      call assemble_block(design%plan, design%plan%blocks(b), state, work, .false., outcome, err)
      closed = closed .and. outcome%closed .and. .not. allocated(err)
    end do
  end subroutine reach

  !> Sample the run from a position at its start, with chains closed or nearly so, and choose the coordinates and times of the
  !> targets: those with free times are assigned in their order to the samples that are nearest to them.
  subroutine sample_run(fit, design, position, given, q_start, y)
    class(relaxed_fit_type), intent(in) :: fit           !< with the targets, the dependent coordinates and the times of the run
    type(design_type), intent(in) :: design              !< placed
    type(open_position_type), intent(inout) :: position  !< scratch
    real(wp), intent(in) :: given(:)                     !< (targets) times that are not free [s]
    real(wp), intent(in) :: q_start(:)                   !< (M) coordinates at the start [rad, m]
    real(wp), intent(out) :: y(:, :)                     !< (n_y,targets) dependent coordinates in their units, and times
    type(state_type) :: state
    type(target_type) :: nowhere
    type(error_type), allocatable :: err
    real(wp), allocatable :: q(:, :), times(:), squares(:, :)
    real(wp) :: r(6), time
    integer, allocatable :: at(:)
    integer :: i, g, n
    logical :: closed

    n = max(fewest_samples, 3*size(fit%targets))
    allocate (q(size(q_start), 0:n), times(0:n), squares(size(fit%targets), 0:n))
    state = new_state(design%plan)
    state%q = q_start
    do i = 0, n
      times(i) = fit%start + (fit%end - fit%start)*i/n
      call reach(design, times(i), nowhere, state, closed)
      q(:, i) = state%q
      position%state%t = times(i)
      position%state%q = state%q
      call set_inputs(design%drives, times(i), position%state%q, position%state%dq, position%state%ddq, err)
      if (.not. allocated(err)) call find_openings(design, position, err)
      do g = 1, size(fit%targets)
        call difference(fit%targets(g), design%in_space, design, position%state, r)
        squares(g, i) = sum(r**2)
      end do
    end do
    allocate (at(size(fit%targets)))
    call assign_in_order(fit%targets, squares, at)
    do g = 1, size(fit%targets)
      time = times(at(g))
      if (fit%targets(g)%timing /= timing_free) then
        time = given(g)
        at(g) = minloc(abs(times - time), dim=1) - 1
        state%q = q(:, at(g))
        call reach(design, time, fit%targets(g), state, closed)
        y(:size(y, 1) - 1, g) = state%q(fit%dependent)/design%in_space%unit_of(fit%dependent)
      else
        y(:size(y, 1) - 1, g) = q(fit%dependent, at(g))/design%in_space%unit_of(fit%dependent)
      end if
      y(size(y, 1), g) = (time - fit%start)/(fit%end - fit%start)
    end do
  end subroutine sample_run

  !> Assign the targets of each objective to samples in increasing order, so that the sum of squares is least (dynamic programming).
  pure subroutine assign_in_order(targets, squares, at)
    type(target_type), intent(in) :: targets(:)   !< the targets
    real(wp), intent(in) :: squares(:, 0:)        !< (targets,0:n) squared difference at each sample
    integer, intent(out) :: at(:)                 !< (targets) sample of each target, from 0
    real(wp) :: least(size(targets), 0:ubound(squares, 2))
    integer :: from(size(targets), 0:ubound(squares, 2)), g, i, best, before, after
    logical :: is_first, is_last

    do g = 1, size(targets)
      before = max(1, g - 1)
      is_first = g == 1 .or. targets(g)%objective /= targets(before)%objective
      best = -1
      do i = 0, ubound(squares, 2)
        least(g, i) = squares(g, i)
        from(g, i) = 0
        if (is_first) cycle
        if (best < 0) then
          least(g, i) = huge(1.0_wp)
        else
          least(g, i) = min(huge(1.0_wp), least(g, i) + least(before, best))
          from(g, i) = best
        end if
        if (best < 0) then
          best = i
        else if (least(before, i) < least(before, best)) then
          best = i
        end if
      end do
    end do
    do g = size(targets), 1, -1
      after = min(g + 1, size(targets))
      is_last = g == after .or. targets(g)%objective /= targets(after)%objective
      if (is_last) then
        at(g) = minloc(least(g, :), dim=1) - 1
      else
        at(g) = from(after, at(after))
      end if
    end do
  end subroutine assign_in_order
end module mech9_sampled_run
