!> A report on the mobility of a mechanism whose plan is made: ranks, redundant equations, coordinates that could be
!> independent, and idle ones.
module mech9_mobility_report
  use mech9_kinds, only: wp
  use mech9_tolerances, only: rank_tolerance, rank_tolerance_for
  use mech9_rotation, only: cross
  use mech9_screw, only: orthonormal_basis
  use mech9_least_squares, only: least_squares_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_unit_rates, only: find_unit_rates
  use mech9_generic_position, only: generic_position_type, find_generic_position
  use mech9_frame_motion, only: step_screw
  use mech9_release, only: most_free_coordinates
  use mech9_contradiction, only: find_repeating
  use mech9_block_equations, only: block_jacobian
  implicit none
  private
  public :: mobility_report_type, idle_type, report_mobility

  !> Coordinates in series that can move, with one freedom, while the links at both ends of the series stand still.
  type :: idle_type
    integer, allocatable :: coordinates(:)    !< numbers of the coordinates
    integer :: ends(2) = 0                    !< numbers of the links at both ends
  end type idle_type

  !> Closures that repeat each other.
  type :: chains_type
    integer, allocatable :: chains(:)         !< numbers of closed chains, and of couplings, negative; not allocated: none
  end type chains_type

  !> Ranks at a general position near the start, if one was found, and at the start.
  type :: mobility_report_type
    logical :: general = .false.              !< a general position was found
    integer :: by_count = 0                   !< mobility as number of coordinates less the dimensions of the chains' motions
    integer :: by_rank = 0                    !< mobility as number of coordinates less rank
    integer, allocatable :: ranks(:)          !< rank of each block
    integer, allocatable :: at_start(:)       !< rank of each block at the start: smaller if that is singular
    integer, allocatable :: redundant(:)      !< number of equations of each closure that follow from the closures before it
    type(chains_type), allocatable :: repeating(:)   !< of each closure that is a redundant coupling: those that repeat each other
    logical, allocatable :: moves(:)          !< (M) the coordinate could be independent
    integer, allocatable :: dimensions(:)     !< (M) most dimensions of the motions of a loop with the coordinate; 0 if on none
    !> (M, independent) rate of each coordinate per unit rate of each independent one, in their units
    real(wp), allocatable :: shares(:, :)
    type(idle_type), allocatable :: idle(:)   !< idle freedoms
  end type mobility_report_type

contains

  !> Judge a mechanism whose plan is made.
  subroutine report_mobility(mechanism, plan, start, report)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start   !< the assembled start
    type(mobility_report_type), intent(out) :: report   !< the report
    type(generic_position_type) :: generic
    type(state_type) :: state
    integer :: c

    allocate (report%dimensions(plan%n_coordinates), source=0)
    do c = 1, size(plan%closures)
      if (plan%closures(c)%coupling > 0) cycle
      associate (loop => plan%steps(plan%closures(c)%loop%steps)%coordinate)
        report%dimensions(loop) = max(report%dimensions(loop), plan%closures(c)%rank)
      end associate
    end do
    call find_generic_position(plan, plan%blocks, start, generic, report%general)
    state = start
    if (report%general) state = generic%state
    report%by_count = plan%n_coordinates - sum(plan%closures%rank)
    allocate (report%redundant(size(plan%closures)), source=0)
    allocate (report%ranks(size(plan%blocks)), report%at_start(size(plan%blocks)))
    call find_ranks(plan, state, report%ranks, report%redundant)
    call find_ranks(plan, start, report%at_start)
    call find_repetitions(plan, state, report)
    report%by_rank = plan%n_coordinates - sum(report%ranks)
    call find_shares(plan, state, report)
    call find_idle(mechanism, plan, state, report%dimensions, report%idle)
  end subroutine report_mobility

  !> The closures from which redundant couplings follow.
  subroutine find_repetitions(plan, state, report)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(mobility_report_type), intent(inout) :: report   !< with `redundant`; gets `repeating`
    integer, allocatable :: set(:)
    integer :: c

    allocate (report%repeating(size(plan%closures)))
    if (plan%n_coordinates > most_free_coordinates) return
    do c = 1, size(plan%closures)
      if (report%redundant(c) == 0 .or. plan%closures(c)%coupling == 0) cycle
      call find_repeating(plan, state, c, set)
      report%repeating(c)%chains = plan%closures(set)%chain
    end do
  end subroutine find_repetitions

  !> Rank of each block, and the closures to which redundant equations belong.
  subroutine find_ranks(plan, state, ranks, redundant)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(out) :: ranks(:)   !< rank of each block
    integer, intent(inout), optional :: redundant(:)   !< number of redundant equations of each closure
    type(block_work_type) :: work
    integer :: b

    ranks = 0
    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%equations == 0) cycle
      work = new_block_work(plan%blocks(b))
      call factorize_block(plan, plan%blocks(b), state, work)
      ranks(b) = work%equations%rank(rank_tolerance_for(plan%data_tolerance))
      if (present(redundant) .and. ranks(b) < plan%blocks(b)%equations) &
        call find_redundant(plan, plan%blocks(b), state, work%column_of, redundant)
    end do
  end subroutine find_ranks

  !> The equations of each closure of a block that follow from the closures before it.
  subroutine find_redundant(plan, block, state, column_of, redundant)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, allocatable, intent(in) :: column_of(:)   !< column of each step in the block's Jacobian, 0 if none
    integer, intent(inout) :: redundant(:)   !< number of redundant equations of each closure
    type(least_squares_type) :: equations
    real(wp) :: a(block%equations, size(block%unknowns))
    integer :: c, rows, rank, before

    call block_jacobian(plan, block, state, column_of, a)
    rows = 0
    before = 0
    do c = block%first_closure, block%last_closure
      rows = rows + plan%closures(c)%rank
      call equations%create(rows, size(a, 2))
      equations%a = a(:rows, :)
      call equations%factorize()
      rank = equations%rank(rank_tolerance_for(plan%data_tolerance))
      redundant(c) = plan%closures(c)%rank - (rank - before)
      before = rank
    end do
  end subroutine find_redundant

  !> Rates of all coordinates for a rate of one of each independent coordinate alone.
  subroutine find_shares(plan, state, report)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(mobility_report_type), intent(inout) :: report   !< the report
    integer :: i

    call find_unit_rates(plan, state, report%shares)
    allocate (report%moves(plan%n_coordinates), source=.false.)
    do i = 1, size(plan%independent)
      report%moves = report%moves .or. abs(report%shares(:, i)) > rank_tolerance
    end do
  end subroutine find_shares

  !> Idle freedoms of all series of pairs. A series goes through links that have no other pairs.
  subroutine find_idle(mechanism, plan, state, dimensions, idle)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: dimensions(:)   !< (M) most dimensions of the motions of a loop with the coordinate; 0 if on none
    type(idle_type), allocatable, intent(out) :: idle(:)   !< the idle freedoms
    integer, dimension(plan%n_coordinates) :: series
    integer :: links(0:plan%n_coordinates), at(2, plan%n_links), pairs_of(plan%n_links), i, k, l, n
    logical :: seen(plan%n_coordinates)

    allocate (idle(0))
    pairs_of = 0
    at = 0
    associate (links_of => mechanism%structure%links)
      do k = 1, size(links_of, 2)
        do i = 1, 2
          l = links_of(i, k)
          pairs_of(l) = pairs_of(l) + 1
          if (pairs_of(l) <= 2) at(pairs_of(l), l) = k
        end do
      end do
      pairs_of(1) = max(3, pairs_of(1))       ! the frame ends a series in any case
      seen = dimensions == 0
      do k = 1, size(links_of, 2)
        do i = 1, 2
          links(0) = links_of(i, k)
          if (seen(k) .or. pairs_of(links(0)) == 2) cycle
          n = 0
          l = k
          do
            n = n + 1
            seen(l) = .true.
            series(n) = l
            links(n) = links_of(1, l) + links_of(2, l) - links(n - 1)
            if (pairs_of(links(n)) /= 2) exit
            l = at(1, links(n)) + at(2, links(n)) - l
          end do
          call search_series(plan, state, series(:n), links(0:n), dimensions(k), idle)
        end do
      end do
    end associate
  end subroutine find_idle

  !> Find the shortest runs of a series whose screws are dependent: these can move alone, as a rod with spherical pairs at both
  !> ends spins, or axes in one line turn. A run that uses all dimensions of its loop is idle only if it ends at links with
  !> other pairs; otherwise it is the motion of the loop. A run that returns to its first link is a whole overconstrained
  !> loop, whose motion is not idle.
  subroutine search_series(plan, state, series, links, dimension, idle)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: series(:)   !< numbers of the coordinates in series
    integer, intent(in) :: links(0:)   !< (0:) the link before the first pair, then the link after each
    integer, intent(in) :: dimension   !< dimension of the motions of the loop
    type(idle_type), allocatable, intent(inout) :: idle(:)   !< the idle freedoms
    type(idle_type) :: run
    integer :: first, last, rank

    first = 1
    do last = 2, size(series)
      if (rank_of_series(plan, state, series(first:last)) == last - first + 1) cycle
      do while (rank_of_series(plan, state, series(first + 1:last)) < last - first)
        first = first + 1
      end do
      rank = last - first
      if ((rank < dimension .or. links(0) /= links(size(series))) .and. links(first - 1) /= links(last)) then
        run%coordinates = series(first:last)
        run%ends = [links(first - 1), links(last)]
        call append(idle, run)
      end if
      first = first + 1
    end do
  end subroutine search_series

  !> Append a series to a list. An array constructor would be shorter, but gfortran 12 leaks the components of its elements.
  pure subroutine append(list, series)
    type(idle_type), allocatable, intent(inout) :: list(:)   !< the list, which gets one more
    type(idle_type), intent(in) :: series   !< the series to add
    type(idle_type), allocatable :: longer(:)

    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = series
    call move_alloc(longer, list)
  end subroutine append

  !> Number of independent screws of some coordinates.
  integer function rank_of_series(plan, state, coordinates) result(rank)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: coordinates(:)   !< numbers of the coordinates
    real(wp) :: screws(6, size(coordinates)), basis(6, 6), v(3), place(3), first_place(3)
    integer :: i

    do i = 1, size(coordinates)
      call step_screw(plan, state, plan%step_of(coordinates(i)), screws(1:3, i), v, place)
      if (i == 1) first_place = place
      ! moments are taken about the first axis: about a distant origin all screws would be nearly equal
      screws(4:6, i) = (v + cross(place - first_place, screws(1:3, i)))/plan%length
      screws(:, i) = screws(:, i)/norm2(screws(:, i))
    end do
    call orthonormal_basis(screws, rank_tolerance, basis, rank)
  end function rank_of_series
end module mech9_mobility_report
