!> The assembly of a block: its chains are closed from a rough guess.
!>
!> The residual is reduced by damped least squares (Levenberg and Marquardt in docs/reference/bibliography.md), and Newton's method
!> finishes at round-off. Where the guess leads to no closed position, the guesses are changed by growing random amounts, the
!> same in every run.
module mech9_assembly
  use mech9_kinds, only: wp, pi
  use mech9_tolerances, only: closed_to_round_off
  use mech9_assembly_tolerances, only: allowed_gap, closed_singular, newton_radius, regular_correction
  use mech9_error, only: error_type
  use mech9_least_squares, only: least_squares_type
  use mech9_front_plan, only: front_plan_type
  use mech9_random, only: random_type
  use mech9_plan, only: plan_type, block_type, within_range, without_periods
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, newton_outcome_type, close_block, apply_change
  use mech9_frame_motion, only: place_frames
  use mech9_block_equations, only: block_jacobian, block_residual, damped_fronts
  implicit none
  private
  public :: assemble_block, assembly_outcome_type

  !> Largest number of restarts.
  integer, parameter :: most_restarts = 100
  !> Large blocks are restarted less often: unknowns times restarts stay below this.
  integer, parameter :: most_restarted = 3000
  !> Largest number of damped steps from one guess.
  integer, parameter :: most_steps = 200
  !> Number of steps in which the residual must become clearly smaller.
  integer, parameter :: steps_between_checks = 25


  !> The result of an assembly.
  type :: assembly_outcome_type
    logical :: closed = .false.       !< a closed position was found
    integer :: restarts = 0           !< number of changed guesses that were needed
    integer :: worst_closure = 0      !< number of the closure with the largest gap
    real(wp) :: gap = 0.0_wp          !< this gap [m, rotations times the mechanism's size]
  end type assembly_outcome_type

  !> The damped equations of a block: those of its closures, and one for each unknown that it shall not change.
  type :: damped_equations_type
    type(least_squares_type) :: equations   !< their matrix and its factors
    integer, allocatable :: row_of(:)       !< (unknowns) the damped equation of each
    real(wp), allocatable :: right(:)       !< right-hand side
    real(wp) :: damping = 0.0_wp            !< factor of the squared changes that are added to the squared residual
  end type damped_equations_type

contains

  !> Close the chains of a block from the guesses in `state`. Where no closed position is found, the coordinates are those of
  !> the least residual that was reached from the first guess.
  subroutine assemble_block(plan, block, state, work, may_restart, outcome, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block
    logical, intent(in) :: may_restart   !< try changed guesses where the given one fails
    type(assembly_outcome_type), intent(out) :: outcome   !< result of the assembly
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: guess(size(block%unknowns)), nearest(size(block%unknowns))
    type(random_type) :: random
    integer :: restart, restarts, i, k

    restarts = 0
    if (may_restart) restarts = max(2, min(most_restarts, most_restarted/max(1, size(guess))))
    guess = state%q(block%coordinates)
    do restart = 0, restarts
      do i = 1, size(guess)
        k = block%coordinates(i)
        state%q(k) = guess(i)
        if (restart > 0) state%q(k) = within_range(plan%steps(block%unknowns(i)), &
                                                   guess(i) + plan%unit_of(k)*random%symmetric()*pi*restart/restarts)
      end do
      call close_from_guess(plan, block, state, work, outcome, err)
      if (allocated(err)) then
        ! a user's pair has no pose: an error only at the guess that the user gave
        if (restart == 0) return
        cycle
      end if
      outcome%restarts = restart
      if (outcome%closed) then
        call remove_full_turns(plan, block, guess, state, err)
        return
      end if
      if (restart == 0) nearest = state%q(block%coordinates)
    end do
    outcome = assembly_outcome_type(restarts=restarts)
    state%q(block%coordinates) = nearest
    call place_frames(plan, block, state, err)
    if (allocated(err)) return
    call find_worst_closure(plan, block, state, outcome)
  end subroutine assemble_block

  !> Reduce the residual by damped least squares from the coordinates in `state`, then by Newton's method to round-off. At a
  !> singular position Newton's method would close the chains too, but at coordinates far away: there damped least squares
  !> goes on as far as possible.
  subroutine close_from_guess(plan, block, state, work, outcome, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block
    type(assembly_outcome_type), intent(out) :: outcome   !< result of the assembly
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(newton_outcome_type) :: newton
    real(wp) :: before(size(block%unknowns)), small_enough

    ! the residual must be the least one where inexact redundant equations stay open
    small_enough = newton_radius
    if (plan%data_tolerance > 0.0_wp .and. block%equations > size(block%unknowns)) small_enough = closed_to_round_off
    call reduce_errors(plan, block, state, work, small_enough, 1.0e-2_wp, err)
    if (allocated(err)) return
    outcome%closed = norm2(work%right) <= max(newton_radius, allowed_gap*plan%data_tolerance)
    if (outcome%closed) then
      before = state%q(block%coordinates)
      call close_block(plan, block, state, work, newton, err)
      if (allocated(err)) return
      if (.not. newton%converged .or. newton%correction > regular_correction) then
        state%q(block%coordinates) = before
        call reduce_errors(plan, block, state, work, closed_to_round_off, 1.0e-10_wp, err)
        if (allocated(err)) return
        outcome%closed = norm2(work%right) <= max(closed_singular, allowed_gap*plan%data_tolerance)
      end if
    end if
    call find_worst_closure(plan, block, state, outcome)
    ! the gap counts all six components of every closure, also those outside its space of motions
    outcome%closed = outcome%closed .and. outcome%gap <= max(1.0e-10_wp, plan%data_tolerance)*plan%length
  end subroutine close_from_guess

  !> Damped least squares (Levenberg and Marquardt) until the residual, in work%right, is small enough, or becomes no smaller.
  subroutine reduce_errors(plan, block, state, work, small_enough, damping_at_first, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block
    real(wp), intent(in) :: small_enough   !< norm of the residual at which to stop
    real(wp), intent(in) :: damping_at_first   !< damping of the first step
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(damped_equations_type) :: damped
    real(wp) :: before(size(block%unknowns)), residual_norm, trial_norm, norm_then
    integer :: step

    call begin_damping(plan, block, work, damping_at_first, damped)
    call find_residual(plan, block, state, work, residual_norm, err)
    if (allocated(err)) return
    norm_then = residual_norm
    do step = 1, most_steps
      if (residual_norm <= small_enough .or. size(before) == 0) exit
      call damped_change(plan, block, state, damped, work)
      before = state%q(block%coordinates)
      call apply_change(plan, block, work%change, state)
      call find_residual(plan, block, state, work, trial_norm, err)
      ! a step to a position where a user's pair has no pose is too long, like any other that does not reduce the residual
      if (allocated(err)) deallocate (err)
      if (trial_norm < residual_norm) then
        damped%damping = max(damped%damping*0.2_wp, 1.0e-20_wp)
        residual_norm = trial_norm
      else
        state%q(block%coordinates) = before
        call find_residual(plan, block, state, work, residual_norm, err)
        if (allocated(err)) return
        damped%damping = max(damped%damping, 1.0e-16_wp)*5.0_wp
        if (damped%damping > 1.0e6_wp) exit
      end if
      if (mod(step, steps_between_checks) == 0) then
        if (residual_norm > 0.7_wp*norm_then) exit     ! a least distance that is not zero
        norm_then = residual_norm
      end if
    end do
  end subroutine reduce_errors

  !> Room for the damped equations of a block.
  subroutine begin_damping(plan, block, work, damping, damped)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(block_work_type), intent(in) :: work   !< scratch of the block
    real(wp), intent(in) :: damping   !< damping of the first step
    type(damped_equations_type), intent(out) :: damped   !< the damped equations
    type(front_plan_type) :: fronts

    damped%damping = damping
    allocate (damped%row_of(size(block%unknowns)), damped%right(block%equations + size(block%unknowns)))
    call damped_fronts(plan, block, work%column_of, fronts, damped%row_of)
    call damped%equations%create(size(damped%right), size(block%unknowns), fronts)
  end subroutine begin_damping

  !> Find the change of the unknowns in a damped linear step, in work%change, from the residual in work%right.
  subroutine damped_change(plan, block, state, damped, work)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(damped_equations_type), intent(inout) :: damped   !< with the damping; gets matrix and right-hand side
    type(block_work_type), intent(inout) :: work   !< scratch of the block
    integer :: i, m

    m = block%equations
    associate (a => damped%equations%a)
      call block_jacobian(plan, block, state, work%column_of, a(:m, :))
      a(m + 1:, :) = 0.0_wp
      do i = 1, size(block%unknowns)
        a(damped%row_of(i), i) = sqrt(damped%damping)
      end do
    end associate
    damped%right(:m) = -work%right
    damped%right(m + 1:) = 0.0_wp
    call damped%equations%factorize()
    call damped%equations%solve(damped%right, work%change)
    ! no more than about a radian at once: beyond it the linear model of the closures is useless
    if (.not. block%is_linear) work%change = work%change/max(1.0_wp, maxval(abs(work%change)))
  end subroutine damped_change

  !> The residual of the block at the coordinates in `state`, in work%right, and its norm.
  subroutine find_residual(plan, block, state, work, residual_norm, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block
    real(wp), intent(out) :: residual_norm   !< norm of the residual at the end [rad, lengths of the mechanism]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    residual_norm = huge(residual_norm)
    call place_frames(plan, block, state, err)
    if (allocated(err)) return
    call block_residual(plan, block, state, work%right)
    residual_norm = norm2(work%right)
  end subroutine find_residual

  !> The closure of a block with the largest gap.
  subroutine find_worst_closure(plan, block, state, outcome)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(assembly_outcome_type), intent(inout) :: outcome   !< result of the assembly
    real(wp) :: gap
    integer :: c

    outcome%gap = 0.0_wp
    do c = block%first_closure, block%last_closure
      gap = plan%constraints(c)%item%gap(plan, state)
      if (gap > outcome%gap .or. outcome%worst_closure == 0) then
        outcome%gap = gap
        outcome%worst_closure = c
      end if
    end do
  end subroutine find_worst_closure

  !> Take full turns off the coordinates of pairs whose positions repeat, so that each is within half a turn of its guess.
  subroutine remove_full_turns(plan, block, guess, state, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    real(wp), intent(in) :: guess(:)   !< (unknowns) guesses of the block's coordinates [rad, m]
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i
    logical :: changed

    changed = .false.
    do i = 1, size(block%unknowns)
      associate (step => plan%steps(block%unknowns(i)))
        if (abs(state%q(step%coordinate) - guess(i)) <= 0.5_wp*step%period .or. .not. step%period > 0.0_wp) cycle
        state%q(step%coordinate) = guess(i) + without_periods(step, state%q(step%coordinate) - guess(i))
        changed = .true.
      end associate
    end do
    if (changed) call place_frames(plan, block, state, err)
  end subroutine remove_full_turns
end module mech9_assembly
