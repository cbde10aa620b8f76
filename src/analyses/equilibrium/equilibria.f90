!> Positions of equilibrium of a mechanism, with their linearised equations of motion and modes.
module mech9_equilibria
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, raise, exit_assembly, exit_singular, exit_interrupted
  use mech9_random, only: random_type
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_partition, only: partition_type, free_coordinate
  use mech9_plan, only: plan_type, within_range
  use mech9_state, only: state_type, copy_state
  use mech9_assemblies, only: close_from
  use mech9_posture, only: posture_type, new_posture
  use mech9_frame_motion, only: place_all
  use mech9_equilibrium_failures, only: failure_interrupted_starts
  use mech9_simulation, only: interruption_type
  use mech9_resting_mechanism, only: resting_type, put_to_rest, stand_at, is_balanced, copy_resting
  use mech9_same_position, only: is_same_position, same_position
  use mech9_resting_motors, only: held_position_type, hold_setpoints
  use mech9_linearised_equilibrium, only: equilibrium_type, linearise, copy_equilibrium
  use mech9_equilibrium_search, only: find_from_start, find_any
  implicit none
  private
  public :: find_equilibrium, find_equilibria

  !> One of several equilibria.
  type :: equilibrium_slot_type
    class(equilibrium_type), allocatable :: item
    real(wp), allocatable :: numbers(:)   !< of its posture
  end type equilibrium_slot_type

  !> Random positions tried for each start, because chains do not close everywhere.
  integer, parameter :: most_trials = 10

contains

  !> The equilibrium to which an assembled position leads. Fails with exit_assembly where there is none, with exit_singular where
  !> branches meet in it, or coordinates have no inertia in this position alone (gimbal lock), and where a load fails.
  subroutine find_equilibrium(mechanism, partition, plan, assembled, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: assembled           !< closed, with rates and accelerations of the driven coordinates
    type(equilibrium_type), intent(out) :: found        !< the equilibrium
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    class(held_position_type), allocatable :: held

    allocate (held)
    call hold_setpoints(mechanism, partition, plan, assembled, held, err)
    if (.not. allocated(err)) call put_to_rest(mechanism, held%partition, held%plan, held%state, found%resting, err)
    if (allocated(err)) return
    if (size(found%resting%free) > 0) call find_from_start(mechanism, found%resting, err)
    if (.not. allocated(err)) call linearise(mechanism, partition, found, err)
    if (allocated(err)) call name_chains(plan, err)
  end subroutine find_equilibrium

  !> Give a failure of a singular block the numbers of chains in the order of the data file, since the search has an order of its own.
  pure subroutine name_chains(plan, err)
    type(plan_type), intent(in) :: plan        !< the plan in the order of the data file
    type(error_type), intent(inout) :: err     !< any failure
    integer, allocatable :: chains(:)
    integer :: b, i

    if (.not. (allocated(err%failure%chains) .and. allocated(err%failure%coordinates))) return
    allocate (chains(0))
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        if (any([(any(block%coordinates == err%failure%coordinates(i)), i=1, size(err%failure%coordinates))])) &
          chains = [chains, block%chains]
      end associate
    end do
    if (size(chains) > 0) err%failure%chains = chains
  end subroutine name_chains

  !> All equilibria to which an assembled position and random ones lead, sorted by their coordinates. The random positions are
  !> the same in every run. Fails as find_equilibrium does, but with exit_assembly and exit_singular only where none is found.
  !> Fails with exit_interrupted where it shall stop, with the equilibria that were found before.
  subroutine find_equilibria(model, plan, assembled, n_starts, list, err, interruption, falls)
    type(model_type), intent(in) :: model                             !< the mechanism with the kinds of its coordinates
    type(plan_type), intent(in) :: plan                               !< its plan, in space
    type(state_type), intent(in) :: assembled                         !< closed, with the motion of the driven coordinates
    integer, intent(in) :: n_starts                                   !< number of random positions
    type(equilibrium_type), allocatable, intent(out) :: list(:)       !< the equilibria
    type(error_type), allocatable, intent(out) :: err                 !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption    !< is asked before each start whether the search shall stop
    logical, intent(in), optional :: falls  !< the mechanism falls from random positions where forces do not become less; not unless given
    class(equilibrium_type), allocatable :: found
    type(equilibrium_slot_type), allocatable :: slots(:)
    type(posture_type) :: posture
    type(random_type) :: random
    type(error_type), allocatable :: failure
    class(held_position_type), allocatable :: held
    integer :: i, n
    logical :: reached, may_fall

    allocate (found, held, list(0), slots(16))
    n = 0
    may_fall = .false.
    if (present(falls)) may_fall = falls
    associate (mechanism => model%mechanism, partition => model%problem%partition)
      posture = new_posture(mechanism, plan)
      call find_equilibrium(mechanism, partition, plan, assembled, found, failure)
      if (allocated(failure)) then
        if (failure%code /= exit_assembly .and. failure%code /= exit_singular) call move_alloc(failure, err)
        if (allocated(err)) return
      else
        call add_new(mechanism, posture, found, slots, n)
      end if
      call hold_setpoints(mechanism, partition, plan, assembled, held, err)
      if (allocated(err)) return
      do i = 1, n_starts
        ! setpoints may hold all coordinates, and there is one position then
        if (.not. any(held%partition%kind == free_coordinate)) exit
        if (present(interruption)) call stop_if_interrupted(interruption, i - 1, n_starts, err)
        if (.not. allocated(err)) call try_anywhere(mechanism, partition, held, may_fall, random, found, reached, err)
        if (allocated(err)) exit
        if (reached) call add_new(mechanism, posture, found, slots, n)
      end do
    end associate
    if (allocated(err)) then
      if (err%code /= exit_interrupted) return
    else if (n == 0) then
      call move_alloc(failure, err)
    end if
    call take_sorted(slots(:n), list)
  end subroutine find_equilibria

  !> Fail with exit_interrupted where the search shall stop.
  subroutine stop_if_interrupted(interruption, made, n_starts, err)
    class(interruption_type), intent(in) :: interruption   !< is asked
    integer, intent(in) :: made                            !< number of random starts so far
    integer, intent(in) :: n_starts                        !< number of all
    type(error_type), allocatable, intent(out) :: err      !< allocated if it shall stop

    if (.not. interruption%is_wanted()) return
    call raise(err, exit_interrupted, failure_interrupted_starts)
    err%failure%number = made
    err%failure%limit = n_starts
  end subroutine stop_if_interrupted

  !> The equilibrium to which one random position leads. `reached` is false where there is none.
  subroutine try_anywhere(mechanism, partition, held, may_fall, random, found, reached, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    type(held_position_type), intent(in) :: held        !< the assembled position, with driven setpoints
    logical, intent(in) :: may_fall                     !< the mechanism moves as forces pull where these do not become less
    type(random_type), intent(inout) :: random          !< source of random numbers
    type(equilibrium_type), intent(inout) :: found      !< the equilibrium
    logical, intent(out) :: reached                     !< there is one
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    class(resting_type), allocatable :: resting, start
    type(error_type), allocatable :: at_lock

    allocate (resting, start)
    call start_anywhere(mechanism, held, random, resting, reached)
    if (.not. reached) return
    if (may_fall) call copy_resting(resting, start)
    call find_any(mechanism, resting, reached, err)
    if (may_fall .and. .not. (allocated(err) .or. reached)) then
      call copy_resting(start, resting)
      call find_from_start(mechanism, resting, at_lock)
      reached = .not. allocated(at_lock)
      if (.not. reached) then
        if (at_lock%code /= exit_assembly) call move_alloc(at_lock, err)
      end if
    end if
    if (allocated(err) .or. .not. reached) return
    call reduce_turns(mechanism, held%state, resting)
    call copy_resting(resting, found%resting)
    call linearise(mechanism, partition, found, at_lock)
    ! without inertia, the forces say nothing about a coordinate: angles of a ball joint in gimbal lock
    reached = .not. allocated(at_lock)
  end subroutine try_anywhere

  !> A mechanism at rest in a random position. `reached` is false where the chains do not close.
  subroutine start_anywhere(mechanism, held, random, resting, reached)
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(held_position_type), intent(in) :: held      !< the assembled position, with driven setpoints
    type(random_type), intent(inout) :: random        !< source of random numbers
    type(resting_type), intent(out) :: resting        !< the mechanism in that position
    logical, intent(out) :: reached                   !< the chains close
    class(state_type), allocatable :: position
    type(error_type), allocatable :: err
    real(wp) :: change
    integer :: trial, i, k

    reached = .false.
    allocate (position)
    call put_to_rest(mechanism, held%partition, held%plan, held%state, resting, err)
    if (allocated(err)) return
    do trial = 1, most_trials
      call copy_state(held%state, position)
      do i = 1, size(resting%free)
        k = resting%free(i)
        associate (step => held%plan%steps(held%plan%step_of(k)))
          ! half a turn, or the size of the mechanism, in each direction
          change = merge(0.5_wp*step%period, held%plan%unit_of(k), step%period > 0.0_wp)
          position%q(k) = within_range(step, position%q(k) + change*random%symmetric())
        end associate
      end do
      call place_all(held%plan, position, err)
      if (.not. allocated(err)) call close_from(held%plan, held%plan%blocks, pi, random, position, reached)
      if (reached) exit
    end do
    if (.not. reached) return
    call stand_at(mechanism, position, resting, err)
    reached = .not. allocated(err)
  end subroutine start_anywhere

  !> Take whole turns off each angle that differs from that of a position by more than half a turn, if the equilibrium does not
  !> depend on them. Half a turn is taken forwards.
  subroutine reduce_turns(mechanism, assembled, resting)
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(state_type), intent(in) :: assembled         !< the position
    type(resting_type), intent(inout) :: resting      !< in equilibrium
    class(resting_type), allocatable :: other
    class(state_type), allocatable :: position
    type(error_type), allocatable :: err
    real(wp) :: period, turned
    integer :: k

    allocate (other, position)
    call copy_resting(resting, other)
    do k = 1, size(resting%state%q)
      period = resting%plan%steps(resting%plan%step_of(k))%period
      if (.not. period > 0.0_wp) cycle
      turned = period*ceiling((resting%state%q(k) - assembled%q(k) - same_position*resting%plan%unit_of(k))/period - 0.5_wp)
      if (.not. abs(turned) > 0.0_wp) cycle
      call copy_state(resting%state, position)
      position%q(k) = position%q(k) - turned
      call place_all(other%plan, position, err)
      if (.not. allocated(err)) call stand_at(mechanism, position, other, err)
      if (allocated(err)) return
      if (is_balanced(other)) call copy_resting(other, resting)
    end do
  end subroutine reduce_turns

  !> Add an equilibrium to those found so far, unless it is among them; then its finds are counted.
  subroutine add_new(mechanism, posture, found, slots, n)
    type(mechanism_type), intent(in) :: mechanism                         !< the mechanism
    type(posture_type), intent(in) :: posture                             !< the quantities that make its posture
    type(equilibrium_type), intent(in) :: found                           !< the equilibrium
    type(equilibrium_slot_type), allocatable, intent(inout) :: slots(:)   !< equilibria found so far; it grows
    integer, intent(inout) :: n                                           !< their number
    type(equilibrium_slot_type), allocatable :: longer(:)
    class(state_type), allocatable :: state
    real(wp), allocatable :: numbers(:)
    integer :: i

    allocate (state)
    call copy_state(found%resting%state, state)
    numbers = posture%numbers(found%resting%plan, state)
    do i = 1, n
      associate (known => slots(i)%item)
        if (.not. is_same_position(mechanism, posture, known%resting, found%resting, slots(i)%numbers, numbers)) cycle
        known%found = known%found + 1
        return
      end associate
    end do
    if (n == size(slots)) then
      allocate (longer(2*n))
      do i = 1, n
        call move_alloc(slots(i)%item, longer(i)%item)
        call move_alloc(slots(i)%numbers, longer(i)%numbers)
      end do
      call move_alloc(longer, slots)
    end if
    n = n + 1
    allocate (slots(n)%item)
    call copy_equilibrium(found, slots(n)%item)
    slots(n)%item%found = 1
    slots(n)%numbers = numbers
  end subroutine add_new

  !> Make the list of the equilibria that were found, sorted by their first coordinates, where these are the same by the second
  !> ones, and so on.
  subroutine take_sorted(slots, list)
    type(equilibrium_slot_type), intent(inout) :: slots(:)        !< the equilibria; empty afterwards
    type(equilibrium_type), allocatable, intent(out) :: list(:)   !< the same, sorted
    integer :: order(size(slots)), i, j

    do i = 1, size(slots)
      j = i
      do while (j > 1)
        if (.not. comes_before(slots(i)%item, slots(order(j - 1))%item)) exit
        order(j) = order(j - 1)
        j = j - 1
      end do
      order(j) = i
    end do
    allocate (list(size(slots)))
    do i = 1, size(slots)
      call copy_equilibrium(slots(order(i))%item, list(i))
      deallocate (slots(order(i))%item)
    end do
  end subroutine take_sorted

  !> Whether an equilibrium comes before another one.
  pure logical function comes_before(a, b)
    type(equilibrium_type), intent(in) :: a   !< an equilibrium
    type(equilibrium_type), intent(in) :: b   !< another one
    integer :: k

    comes_before = .false.
    do k = 1, size(a%resting%state%q)
      if (abs(a%resting%state%q(k) - b%resting%state%q(k)) <= same_position*a%resting%plan%unit_of(k)) cycle
      comes_before = a%resting%state%q(k) < b%resting%state%q(k)
      return
    end do
  end function comes_before
end module mech9_equilibria
