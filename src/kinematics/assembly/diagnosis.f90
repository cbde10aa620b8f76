!> The diagnosis of a choice of independent coordinates that cannot serve, with choices that can.
module mech9_diagnosis
  use mech9_kinds, only: wp
  use mech9_tolerances, only: least_rate
  use mech9_assembly_tolerances, only: apparent_motion, returned_to_start, nearly_closed, overconstrained_nearby
  use mech9_error, only: error_type, raise, exit_structure, exit_assembly
  use mech9_assembly_failures, only: failure_wrong_choice, failure_undetermined_coordinates, failure_open_chain, &
    failure_nearly_closed_chain, failure_locked_chain, failure_nearly_moving_chain, failure_open_coupling
  use mech9_masks, only: numbers_of
  use mech9_random, only: random_type
  use mech9_plan, only: plan_type, within_range
  use mech9_state, only: state_type
  use mech9_assembly, only: assembly_outcome_type
  use mech9_finite_motion, only: locked_chain_type
  use mech9_release, only: close_free, most_free_coordinates
  use mech9_contradiction, only: find_holding, find_unfulfilled, name_closures
  use mech9_mobility, only: find_motions, choose_coordinates, shares_of
  implicit none
  private
  public :: judge_choice, refuse_open, refuse_undetermined, refuse_locked

contains

  !> Judge the independent coordinates at closed positions in which all coordinates are free. Fails if they cannot serve
  !> (exit_structure), or if the chains close nowhere (exit_assembly). A mechanism that is too large to be judged as one block
  !> passes. `state` is afterwards a closed position near the given coordinates, if `closed`.
  subroutine judge_choice(plan, state, closed, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    logical, intent(out) :: closed   !< `state` is a closed position
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(assembly_outcome_type) :: outcome
    type(state_type) :: trial, place
    real(wp), allocatable :: motions(:, :), best(:, :), positions(:, :)
    logical, dimension(plan%n_coordinates) :: wanted, chosen, returns, held
    integer :: i, k

    closed = .false.
    if (plan%n_coordinates > most_free_coordinates) return
    wanted = .false.
    wanted(plan%independent) = .true.
    call close_free(plan, state, .true., outcome, err)
    if (allocated(err)) return
    if (.not. outcome%closed) then
      call refuse_open(plan, state, outcome, err)
      return
    end if
    closed = .true.
    call find_positions(plan, state, positions, returns)
    trial = state
    do i = 1, size(positions, 2)
      trial%q = positions(:, i)
      ! the position is closed: this only places the frames
      call close_free(plan, trial, .false., outcome, err)
      if (allocated(err)) return
      held = .false.
      call find_motions(plan, trial, held, motions)
      held = returns .and. [(norm2(motions(k, :)) > apparent_motion, k=1, size(held))]
      if (any(held)) call find_motions(plan, trial, held, motions)
      call choose_coordinates(motions, wanted, chosen)
      if (all(chosen .eqv. wanted)) return
      ! the least mobile branch counts where branches of different mobility meet
      if (allocated(best)) then
        if (size(motions, 2) >= size(best, 2)) cycle
      end if
      best = motions
      place = trial
    end do
    call refuse_choice(plan, place, best, wanted, err)
  end subroutine judge_choice

  !> Generic closed positions near one that may be singular, and the coordinates that return to their values there each time.
  !> If the rates show that such a coordinate moves, they are wrong: it is locked, and the position is singular.
  subroutine find_positions(plan, state, positions, returns)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    real(wp), allocatable, intent(out) :: positions(:, :)   !< (M,n) coordinates; those in `state` where no other closes
    logical, intent(out) :: returns(:)   !< (M) the coordinate returned to its value in all positions
    real(wp), parameter :: amounts(6) = [0.3_wp, 0.1_wp, 0.03_wp, 0.3_wp, 0.1_wp, 0.03_wp]
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    type(state_type) :: trial
    type(random_type) :: random
    real(wp) :: found(plan%n_coordinates, size(amounts))
    integer :: i, k, n

    n = 0
    returns = plan%steps(plan%step_of)%searchable
    trial = state
    do i = 1, size(amounts)
      trial%q = state%q
      do k = 1, plan%n_coordinates
        if (plan%steps(plan%step_of(k))%searchable) &
          trial%q(k) = within_range(plan%steps(plan%step_of(k)), state%q(k) + amounts(i)*plan%unit_of(k)*random%symmetric())
      end do
      call close_free(plan, trial, .false., outcome, err)
      if (allocated(err)) cycle
      if (.not. outcome%closed) cycle
      n = n + 1
      found(:, n) = trial%q
      returns = returns .and. abs(trial%q - state%q) < returned_to_start*plan%unit_of
    end do
    if (n < 2) returns = .false.
    if (n == 0) then
      n = 1
      found(:, 1) = state%q
    end if
    positions = found(:, :n)
  end subroutine find_positions

  !> Fail because of a choice of independent coordinates, with one that would serve.
  subroutine refuse_choice(plan, state, motions, wanted, err)
    type(plan_type), intent(in) :: plan       !< the plan of the mechanism
    type(state_type), intent(in) :: state     !< the closed position
    real(wp), intent(in) :: motions(:, :)     !< (M, mobility) basis of the motions there
    logical, intent(in) :: wanted(:)          !< (M) the independent coordinates
    type(error_type), allocatable, intent(out) :: err   !< always allocated
    logical :: chosen(size(wanted)), idle(size(wanted))
    real(wp), allocatable :: shares(:, :)
    integer, allocatable :: set(:)
    integer :: k

    call raise(err, exit_structure, failure_wrong_choice)
    call choose_coordinates(motions, wanted, chosen)
    err%failure%number = size(wanted)
    err%failure%coordinates = numbers_of(wanted)
    err%failure%others = numbers_of(chosen)
    idle = [(norm2(motions(k, :)) <= least_rate, k=1, size(wanted))]
    err%failure%idle = numbers_of(idle)
    call find_holding(plan, state, idle, set)
    call name_closures(plan, set, err%failure)
    call place_at_last(plan, set, err)
    if (.not. any(chosen)) return
    call shares_of(motions, chosen, shares)
    err%failure%replaces = abs(shares) > least_rate
  end subroutine refuse_choice

  !> Fail because of coordinates that no chain determines, in a mechanism that is too large to be judged as one block.
  subroutine refuse_undetermined(undetermined, err)
    integer, intent(in) :: undetermined(:)   !< numbers of the coordinates that no chain determines
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call raise(err, exit_structure, failure_undetermined_coordinates)
    err%failure%coordinates = undetermined
  end subroutine refuse_undetermined

  !> Fail because of chains that do not close.
  subroutine refuse_open(plan, state, outcome, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< the position of least residual, whose frames are placed
    type(assembly_outcome_type), intent(in) :: outcome   !< result of the assembly that failed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call raise(err, exit_assembly, merge(failure_nearly_closed_chain, failure_open_chain, &
                                         outcome%gap < nearly_closed*plan%length))
    err%failure%gap = outcome%gap
    err%failure%size = plan%length
    associate (closure => plan%closures(outcome%worst_closure))
      if (closure%coupling > 0) then
        call refuse_coupling(plan, state, outcome%worst_closure, err)
      else
        err%failure%chains = [closure%chain]
        err%failure%link = plan%steps(closure%closing)%link
        err%failure%coordinates = [plan%steps(closure%closing)%coordinate]
      end if
    end associate
  end subroutine refuse_open

  !> Make a failure that of a coupling which contradicts others, or closed chains.
  subroutine refuse_coupling(plan, state, worst, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< the position of least residual
    integer, intent(in) :: worst   !< number of the closure with the largest gap, a coupling
    type(error_type), intent(inout) :: err   !< the failure; its kind is changed
    integer, allocatable :: set(:)

    err%failure%kind = failure_open_coupling
    err%failure%coordinates = plan%couplings(plan%closures(worst)%coupling)%coupling%coordinates
    if (plan%n_coordinates <= most_free_coordinates) call find_unfulfilled(plan, state, set)
    if (.not. allocated(set)) set = [worst]
    if (.not. any(plan%closures(set)%coupling > 0)) set = [worst]
    call name_closures(plan, set, err%failure)
    call place_at_last(plan, set, err)
  end subroutine refuse_coupling

  !> Give an error the place of the last coupling among some closures, if there is one.
  pure subroutine place_at_last(plan, set, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: set(:)   !< numbers of the closures
    type(error_type), intent(inout) :: err   !< gets the place
    integer :: last

    last = 0
    if (size(set) > 0) last = maxval(plan%closures(set)%coupling)
    if (last > 0) err%place = plan%couplings(last)%coupling%place
  end subroutine place_at_last

  !> Fail because of a chain whose equations are redundant at the start only.
  subroutine refuse_locked(plan, locked, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(locked_chain_type), intent(in) :: locked   !< the chain that does not move
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call raise(err, exit_structure, merge(failure_nearly_moving_chain, failure_locked_chain, &
                                          locked%distance <= overconstrained_nearby))
    err%failure%chains = [plan%closures(locked%closure)%chain]
    err%failure%number = locked%redundant
    err%failure%displacement = locked%displacement
    err%failure%gap = locked%gap
    err%failure%distance = locked%distance
    err%failure%size = plan%length
  end subroutine refuse_locked
end module mech9_diagnosis
