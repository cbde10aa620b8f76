!> The assemblies of a mechanism: the positions in which its chains close for the same independent coordinates, as far as
!> random starts lead to them.
module mech9_assemblies
  use mech9_kinds, only: wp, pi
  use mech9_tolerances, only: same_assembly
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_plan, only: plan_type, block_type, within_range, without_periods
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work
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
  end type assembly_list_type

contains

  !> Find the assemblies with the independent coordinates of an assembled start, which is the first of them. The random
  !> starts are the same in every run.
  subroutine find_assemblies(plan, start, n_starts, list)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< an assembled position
    integer, intent(in) :: n_starts   !< number of random starts
    type(assembly_list_type), intent(out) :: list   !< the assemblies found
    type(state_type) :: trial
    type(random_type) :: random
    integer :: i
    logical :: closed

    allocate (list%q(plan%n_coordinates, 0), list%found(0))
    call count_assembly(plan, start%q, list)
    list%found(1) = 0
    list%starts = n_starts
    trial = start
    do i = 1, n_starts
      trial%q = start%q
      call close_from(plan, plan%blocks, pi, random, trial, closed)
      if (.not. closed) cycle
      list%closed = list%closed + 1
      call count_assembly(plan, trial%q, list)
    end do
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

  !> Count an assembly, and add it to the list if it is new.
  subroutine count_assembly(plan, q, list)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: q(:)   !< (M) coordinates of the assembly [rad, m]
    type(assembly_list_type), intent(inout) :: list   !< the assemblies found
    real(wp), allocatable :: longer(:, :)
    real(wp) :: difference
    integer :: i, k, n

    n = size(list%found)
    do i = 1, n
      do k = 1, size(q)
        difference = without_periods(plan%steps(plan%step_of(k)), q(k) - list%q(k, i))
        if (abs(difference) > same_assembly*plan%unit_of(k)) exit
      end do
      if (k <= size(q)) cycle
      list%found(i) = list%found(i) + 1
      return
    end do
    allocate (longer(size(q), n + 1))
    longer(:, :n) = list%q
    longer(:, n + 1) = q
    do k = 1, size(q)
      if (plan%steps(plan%step_of(k))%dependent) longer(k, n + 1) = without_periods(plan%steps(plan%step_of(k)), q(k))
    end do
    call move_alloc(longer, list%q)
    list%found = [list%found, 1]
  end subroutine count_assembly
end module mech9_assemblies
