!> The number of independent equations that each closed chain offers while it moves alone.
!>
!> Most loops offer as many equations as their space of motions has dimensions. Overconstrained loops, such as Bennett's, offer
!> fewer: their screws are dependent at every closed position, though not at others. A loop that may be overconstrained is
!> therefore closed alone, with all its coordinates free, at positions away from its guess, and the rank there counts.
module mech9_loop_rank
  use mech9_kinds, only: wp
  use mech9_tolerances, only: rank_tolerance_for
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_plan, only: plan_type, closure_type, block_type, new_state, within_range
  use mech9_state, only: state_type
  use mech9_arithmetics, only: set_in_space
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  implicit none
  private
  public :: find_offers

  !> Loops whose space of motions has at most so many dimensions, planar and spherical ones included, lose no rank at a general
  !> closed position.
  integer, parameter :: never_overconstrained = 3
  !> Loops with more coordinates are not closed alone: they have enough freedom to have the full rank.
  integer, parameter :: longest_loop = 60

contains

  !> Find the number of independent equations of closures, whose ranks and loops must be known.
  subroutine find_offers(plan, guess, known)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: guess(:)   !< (M) guesses of all coordinates [rad, m]
    logical, intent(in) :: known(:)   !< (closures) the number is known already
    integer :: c, n

    do c = 1, size(plan%closures)
      if (known(c) .or. plan%closures(c)%coupling > 0) cycle
      n = size(plan%closures(c)%loop%steps)
      plan%closures(c)%independent_equations = min(plan%closures(c)%rank, n)
      if (plan%closures(c)%rank <= never_overconstrained .or. n > longest_loop) cycle
      call find_rank_alone(loop_alone(plan, plan%closures(c)), &
                           guess(plan%steps(plan%closures(c)%loop%steps)%coordinate), plan%closures(c)%independent_equations)
    end do
  end subroutine find_offers

  !> Rank of a loop near the guess, the largest at two closed positions. `rank` is unchanged if the loop does not close.
  subroutine find_rank_alone(loop, guess, rank)
    type(plan_type), intent(in) :: loop   !< plan of the loop alone
    real(wp), intent(in) :: guess(:)   !< (coordinates of the loop) guesses of its coordinates [rad, m]
    integer, intent(inout) :: rank         !< the rank of the loop; on entry the largest possible one
    real(wp), parameter :: amounts(4) = [0.3_wp, 0.1_wp, 0.5_wp, 0.03_wp]
    type(state_type) :: state
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(random_type) :: random
    type(error_type), allocatable :: err
    integer :: trial, k, found, best, closed

    state = new_state(loop)
    work = new_block_work(loop%blocks(1))
    best = 0
    closed = 0
    do trial = 1, size(amounts)
      state%q = guess
      do k = 1, size(guess)
        if (loop%steps(k)%searchable) &
          state%q(k) = within_range(loop%steps(k), guess(k) + amounts(trial)*loop%unit_of(k)*random%symmetric())
      end do
      call assemble_block(loop, loop%blocks(1), state, work, trial == 1, outcome, err)
      ! a user's pair may have no pose here; the other trials may succeed
      if (allocated(err)) cycle
      if (.not. outcome%closed) cycle
      call factorize_block(loop, loop%blocks(1), state, work)
      found = work%equations%rank(rank_tolerance_for(loop%data_tolerance))
      best = max(best, found)
      closed = closed + 1
      if (best == rank .or. closed == 2) exit
    end do
    if (closed > 0) rank = best
  end subroutine find_rank_alone

  !> The plan of one loop alone: its base frame is frame 0, and all its coordinates are unknown.
  function loop_alone(plan, closure) result(loop)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(closure_type), intent(in) :: closure   !< the closure of the loop, with its whole loop
    type(plan_type) :: loop
    integer :: i, k, n

    n = size(closure%loop%steps)
    loop%n_coordinates = n
    loop%length = plan%length
    loop%data_tolerance = plan%data_tolerance
    allocate (loop%couplings(0))
    loop%steps = plan%steps(closure%loop%steps)
    loop%unit_of = plan%unit_of(loop%steps%coordinate)
    allocate (loop%pairs(n))
    do i = 1, n
      k = loop%steps(i)%coordinate
      if (.not. loop%steps(i)%is_screw) allocate (loop%pairs(i)%pair, source=plan%pairs(k)%pair)
      loop%steps(i)%coordinate = i
      loop%steps(i)%parent = place_of(loop%steps(i)%parent, closure%loop%steps)
      loop%steps(i)%dependent = .true.
    end do
    loop%closures = [closure]
    loop%closures(1)%base = 0
    loop%closures(1)%closing = place_of(closure%closing, closure%loop%steps)
    loop%closures(1)%target = place_of(closure%target, closure%loop%steps)
    loop%closures(1)%loop%steps = [(i, i=1, n)]
    loop%closures(1)%loop%stems = 0
    loop%closures(1)%part = loop%closures(1)%loop
    allocate (loop%blocks(1))
    loop%blocks(1) = block_type(first_step=1, last_step=n, first_closure=1, last_closure=1, chains=[1], &
                                equations=closure%rank, unknowns=[(i, i=1, n)], coordinates=[(i, i=1, n)])
    call set_in_space(loop)
  end function loop_alone

  !> Place of a frame in a list of frames; 0 where it is not there.
  pure integer function place_of(frame, frames)
    integer, intent(in) :: frame   !< number of the frame to find
    integer, intent(in) :: frames(:)   !< numbers of frames

    do place_of = size(frames), 1, -1
      if (frames(place_of) == frame) return
    end do
  end function place_of
end module mech9_loop_rank
