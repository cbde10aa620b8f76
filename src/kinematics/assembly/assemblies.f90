!> The assemblies of a mechanism: the positions in which its chains close for the same independent coordinates, as far as
!> random starts lead to them, or curves from those.
module mech9_assemblies
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_stop_request, only: stop_request_type
  use mech9_random, only: random_type
  use mech9_plan, only: plan_type, block_type, within_range, without_periods
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work
  use mech9_mechanism, only: mechanism_type
  use mech9_posture, only: posture_type, new_posture, is_same_posture
  use mech9_release, only: most_free_coordinates
  use mech9_released_curve, only: curve_type, begin_curve
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  implicit none
  private
  public :: assembly_list_type, find_assemblies, close_from_random_starts, close_from

  !> Assemblies, in the order in which they were found.
  type :: assembly_list_type
    integer :: starts = 0                    !< number of starts that were tried
    integer :: closed = 0                    !< number of starts that led to a closed position
    real(wp), allocatable :: q(:, :)         !< (M, assemblies) coordinates; angles within half a turn [rad, m]
    integer, allocatable :: found(:)         !< number of starts that led to each assembly
    type(posture_type) :: posture            !< the quantities in which they differ
    real(wp), allocatable :: postures(:, :)  !< (n, assemblies) numbers of the posture of each assembly
    !> (independent coordinates, assemblies) the curve on which only this coordinate is free has been followed through the assembly
    logical, allocatable :: walked(:, :)
  end type assembly_list_type

  !> For each random start so many steps along curves are made at most, which take about twice its time, and so many on one curve.
  integer, parameter :: steps_for_start = 50, longest_curve = 2000
  !> Starts beyond this number ask for no more steps, since the steps must remain an integer that can be represented.
  integer, parameter :: counted_starts = 40000000

contains

  !> Find the assemblies with the independent coordinates of an assembled start, which is the first of them. Positions that differ
  !> in the settings of joints alone are one assembly. The random starts are the same in every run. From the assemblies to which
  !> they lead, others are found along curves on which one independent coordinate is free.
  subroutine find_assemblies(mechanism, plan, start, n_starts, list, stop)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< an assembled position
    integer, intent(in) :: n_starts   !< number of random starts
    type(assembly_list_type), intent(out) :: list   !< the assemblies found
    class(stop_request_type), intent(in), optional :: stop   !< is asked before each start and each curve whether the search ends there
    type(state_type) :: trial
    type(random_type) :: random
    integer :: i, number
    logical :: closed

    list%posture = new_posture(mechanism, plan)
    trial = start
    allocate (list%q(plan%n_coordinates, 0), list%found(0), list%postures(size(list%posture%numbers(plan, trial)), 0))
    allocate (list%walked(size(plan%independent), 0))
    call find_in_list(plan, trial, list, number)
    list%starts = n_starts
    do i = 1, n_starts
      if (present(stop)) then
        if (stop%is_wanted()) return
      end if
      trial%q = start%q
      call close_from(plan, plan%blocks, pi, random, trial, closed)
      if (.not. closed) cycle
      list%closed = list%closed + 1
      call find_in_list(plan, trial, list, number)
      list%found(number) = list%found(number) + 1
    end do
    if (plan%n_coordinates > most_free_coordinates .or. n_starts < 1) return
    call search_along_curves(plan, start, steps_for_start*min(n_starts, counted_starts), list, stop)
  end subroutine find_assemblies

  !> Close blocks, the last of which does not close with the others at their present positions, from starts farther and
  !> farther from the coordinates in `state`.
  subroutine close_from_random_starts(plan, blocks, state, closed)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: blocks(:)   !< the blocks to close, in their order
    type(state_type), intent(inout) :: state   !< coordinates to start from; then the closed position, if one was found
    logical, intent(out) :: closed   !< all these blocks were closed
    type(state_type) :: trial
    type(random_type) :: random
    integer :: i, starts

    ! fewer starts for larger mechanisms
    starts = max(4, min(40, 4000/blocks(size(blocks))%last_step))
    trial = state
    do i = 1, starts
      trial%q = state%q
      call close_from(plan, blocks, pi*i/starts, random, trial, closed)
      if (closed) then
        state = trial
        return
      end if
    end do
  end subroutine close_from_random_starts

  !> Change all dependent coordinates at random and close block after block.
  subroutine close_from(plan, blocks, amount, random, state, closed)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: blocks(:)   !< the blocks to close, in their order
    real(wp), intent(in) :: amount   !< largest change of a coordinate, in its unit
    type(random_type), intent(inout) :: random   !< source of random numbers
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    logical, intent(out) :: closed   !< all these blocks were closed
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    integer :: b, i, k

    closed = .true.
    do b = 1, size(blocks)
      do i = 1, size(blocks(b)%unknowns)
        k = blocks(b)%coordinates(i)
        state%q(k) = within_range(plan%steps(blocks(b)%unknowns(i)), state%q(k) + amount*plan%unit_of(k)*random%symmetric())
      end do
      work = new_block_work(blocks(b))
      call assemble_block(plan, blocks(b), state, work, .false., outcome, err)
      closed = outcome%closed .and. .not. allocated(err)
      if (.not. closed) return
    end do
  end subroutine close_from

  !> Search from the assemblies that were found for others, along curves on which one independent coordinate is free: first from
  !> those to which few starts led. `most_steps` steps are made at most.
  subroutine search_along_curves(plan, start, most_steps, list, stop)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    type(state_type), intent(in) :: start            !< any assembly
    integer, intent(in) :: most_steps                !< number of steps on all curves together
    type(assembly_list_type), intent(inout) :: list  !< the assemblies found
    class(stop_request_type), intent(in), optional :: stop   !< is asked before each curve whether the search ends there
    type(state_type) :: base
    type(curve_type) :: curve
    integer :: from, i, steps_left, direction
    logical :: returned

    base = start
    steps_left = most_steps
    do while (steps_left > 0)
      call choose_curve(list, from, i)
      if (from == 0) return
      if (present(stop)) then
        if (stop%is_wanted()) return
      end if
      list%walked(i, from) = .true.
      do direction = 1, -1, -2
        base%q = list%q(:, from)
        call begin_curve(plan, base, plan%independent(i), real(direction, wp), curve)
        call follow_curve(plan, curve, from, i, steps_left, returned, list)
        if (returned) exit
      end do
    end do
  end subroutine search_along_curves

  !> Choose the assembly with the fewest starts among those from which a curve is not known yet, and the first such curve.
  pure subroutine choose_curve(list, from, i)
    type(assembly_list_type), intent(in) :: list   !< the assemblies found
    integer, intent(out) :: from                   !< number of the assembly; 0: all curves are known
    integer, intent(out) :: i                      !< place of the coordinate among the independent ones
    integer :: k

    from = 0
    i = 0
    do k = 1, size(list%found)
      if (all(list%walked(:, k))) cycle
      if (from > 0) then
        if (list%found(k) >= list%found(from)) cycle
      end if
      from = k
    end do
    if (from > 0) i = findloc(list%walked(:, from), .false., dim=1)
  end subroutine choose_curve

  !> Follow one curve until it returns to its start or ends, and add the assemblies on it.
  subroutine follow_curve(plan, curve, from, i, steps_left, returned, list)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    type(curve_type), intent(inout) :: curve         !< the curve, at the assembly where it begins
    integer, intent(in) :: from                      !< number of this assembly
    integer, intent(in) :: i                         !< place of the free coordinate among the independent ones
    integer, intent(inout) :: steps_left             !< number of steps that can be made on all curves from now on
    logical, intent(out) :: returned                 !< the curve came back to its start
    type(assembly_list_type), intent(inout) :: list  !< the assemblies found
    type(state_type) :: assembly
    integer :: number, last
    logical :: passed

    returned = .false.
    assembly = curve%state
    last = max(0, steps_left - longest_curve)
    do while (curve%goes_on .and. .not. returned .and. steps_left > last)
      steps_left = steps_left - 1
      call curve%advance(plan, passed, assembly)
      if (.not. passed) cycle
      call find_in_list(plan, assembly, list, number)
      list%walked(i, number) = .true.
      returned = number == from
    end do
  end subroutine follow_curve

  !> Find the number of an assembly in the list, and add it if its posture is new.
  subroutine find_in_list(plan, state, list, number)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    type(state_type), intent(inout) :: state         !< the assembly, with frames in place
    type(assembly_list_type), intent(inout) :: list  !< the assemblies found
    integer, intent(out) :: number                   !< of the assembly in the list
    real(wp), allocatable :: longer(:, :), postures(:, :)
    logical, allocatable :: walked(:, :)
    real(wp) :: values(size(list%postures, 1))
    integer :: k, n

    n = size(list%found)
    values = list%posture%numbers(plan, state)
    do number = 1, n
      if (is_same_posture(values, list%postures(:, number))) return
    end do
    allocate (longer(plan%n_coordinates, n + 1), postures(size(values), n + 1), walked(size(plan%independent), n + 1))
    longer(:, :n) = list%q
    longer(:, n + 1) = state%q
    postures(:, :n) = list%postures
    postures(:, n + 1) = values
    walked(:, :n) = list%walked
    walked(:, n + 1) = [(.not. is_in_loop(plan, plan%independent(k)), k=1, size(plan%independent))]
    do k = 1, plan%n_coordinates
      if (plan%steps(plan%step_of(k))%dependent) &
        longer(k, n + 1) = without_periods(plan%steps(plan%step_of(k)), longer(k, n + 1))
    end do
    call move_alloc(longer, list%q)
    call move_alloc(postures, list%postures)
    call move_alloc(walked, list%walked)
    list%found = [list%found, 0]
  end subroutine find_in_list

  !> Whether a closed chain contains a coordinate.
  pure logical function is_in_loop(plan, coordinate)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: coordinate     !< number of the coordinate
    integer :: c

    is_in_loop = .false.
    do c = 1, size(plan%closures)
      is_in_loop = is_in_loop .or. any(plan%closures(c)%loop%steps == plan%step_of(coordinate))
    end do
  end function is_in_loop
end module mech9_assemblies
