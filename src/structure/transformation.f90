!> The transformation of the first set of structural data (the links of each pair) into the second one (the order in which the
!> chains are run through).
!>
!> These rules are followed exactly for any number of links. Link 1 is known at first; the links of
!> each chain become known with it. A chain is cheaper than another one if it has fewer dependent coordinates or, with as
!> many of them, fewer coordinates.
!>
!> 1. While there is a closed chain, that is, one from a known link over unused pairs and
!>    unknown links to a known link, take the cheapest; ties: the one with the least link at an end,
!>    then, read from that end, with the least coordinate numbers in order. It is run through so that
!>    an independent coordinate comes first where one end has it, else the smaller number; a
!>    chain of a single pair starts at its lesser link.
!> 2. Else, if closed chains are left, bridges join them to the known links: pairs that lie on no
!>    closed chain. Take the cheapest walk over bridges from a known link to a link of a closed chain
!>    (ties: least start link, then least coordinate numbers), and append the closed chain that
!>    rule 1 gives at that link. Go on with rule 1.
!> 3. Only open chains are left then: from the least known link with an unused pair walk on to a leaf,
!>    at each link by an independent coordinate first, then by the least number.
!>
!> Each link but the first is reached once and each further pair closes a chain, L1 = M - N + 1 in all;
!> an open chain ends at a leaf only, and each leaf must end one: so the length is the least
!> possible, N + 2 L1 + L2 - 1; (9).
module mech9_transformation
  use mech9_kinds, only: long
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type, number_closures
  use mech9_priority_queue, only: queue_item_type, priority_queue_type
  use mech9_link_graph, only: link_graph_type, walk_type, graph_from_structure
  use mech9_closed_chains, only: chain_search_type
  implicit none
  private
  public :: transform

  integer(long), parameter :: out_of_reach = huge(1_long)

  !> The state of a transformation.
  type :: work_type
    type(link_graph_type) :: graph
    type(chain_search_type) :: search
    integer(long), allocatable :: reach(:)   !< (N) cost over bridges, outwards, to the nearest closed chain
    integer, allocatable :: onward(:)        !< (N) first bridge of the walk there; 0: the link lies on a closed chain
    type(priority_queue_type) :: parts       !< bridges from known links to closed chains, by cost, link, pair
    integer :: length = 0                    !< of the vectors so far
    type(structural_vectors_type) :: vectors
  end type work_type

contains

  !> Second set of structural data from the first one, which must be without findings.
  pure subroutine transform(structure, independent, vectors, operations)
    type(structure_type), intent(in) :: structure   !< the links of each pair, without findings
    logical, intent(in) :: independent(:)           !< (M) the coordinate is independent
    type(structural_vectors_type), intent(out) :: vectors   !< the second set of data
    integer(long), intent(out), optional :: operations   !< pairs examined and items queued or taken out: a measure of the work
    type(work_type) :: work

    work%graph = graph_from_structure(structure)
    call work%graph%weigh(independent)
    call work%search%start(work%graph)
    call measure_reach(work%graph, work%reach, work%onward)
    call reserve(work%vectors, 2*structure%n_coordinates + 1)
    call make_known(work, 1)
    call take_closed_chains(work)
    call take_open_chains(work)
    vectors%nrg = work%vectors%nrg(:work%length)
    vectors%nws = work%vectors%nws(:work%length)
    vectors%rdw = work%vectors%rdw(:work%length)
    call number_closures(vectors)
    if (present(operations)) operations = work%search%operations
  end subroutine transform

  !> Every chain has a start and a step at least, so 2M positions are enough.
  pure subroutine reserve(vectors, length)
    type(structural_vectors_type), intent(inout) :: vectors   !< gets room
    integer, intent(in) :: length                             !< positions

    allocate (vectors%nrg(length), vectors%nws(length), vectors%rdw(length), source=0)
  end subroutine reserve

  !> Find for each link the nearest closed chain that is reached from it over bridges, away from link 1.
  pure subroutine measure_reach(graph, reach, onward)
    type(link_graph_type), intent(in) :: graph            !< links and pairs of the mechanism
    integer(long), allocatable, intent(out) :: reach(:)   !< (N) cost of the walk to it; out_of_reach where there is none
    integer, allocatable, intent(out) :: onward(:)        !< (N) first bridge of the walk; 0 where the link lies on a closed chain
    logical :: done(graph%n_links)
    integer(long) :: cost
    integer :: i, j, link

    allocate (reach(graph%n_links), source=out_of_reach)
    allocate (onward(graph%n_links), source=0)
    done = .false.
    do j = graph%n_links, 1, -1
      link = graph%outward(j)
      done(link) = .true.
      do i = graph%first(link), graph%first(link + 1) - 1
        associate (pair => graph%pair_at(i), other => graph%other_at(i))
          if (.not. graph%is_bridge(pair)) then
            reach(link) = 0
            onward(link) = 0
            exit
          end if
          ! a bridge to a link not done yet leads back to link 1
          if (.not. done(other) .or. reach(other) == out_of_reach) cycle
          cost = graph%cost(pair) + reach(other)
          if (cost >= reach(link)) cycle
          reach(link) = cost
          onward(link) = pair
        end associate
      end do
    end do
  end subroutine measure_reach

  !> Append the closed chains by rules 1 and 2.
  pure subroutine take_closed_chains(work)
    type(work_type), intent(inout) :: work   !< the state of the transformation
    type(walk_type) :: chain, approach
    logical :: found

    do
      call work%search%next_closed_chain(work%graph, chain, found)
      if (found) then
        call take_chain(work, chain)
        cycle
      end if
      call next_approach(work, approach, found)
      if (.not. found) exit
      call mark(work, approach)
      ! no other closed chain was left, so this one starts where the approach ends
      call work%search%next_closed_chain(work%graph, chain, found)
      chain%links = [approach%links, chain%links(2:)]
      chain%pairs = [approach%pairs, chain%pairs]
      call take_chain(work, chain)
    end do
  end subroutine take_closed_chains

  !> The cheapest walk over bridges from a known link to a link of a closed chain.
  pure subroutine next_approach(work, approach, found)
    type(work_type), intent(inout) :: work     !< the state of the transformation
    type(walk_type), intent(out) :: approach   !< the walk
    logical, intent(out) :: found              !< whether there is one
    type(queue_item_type) :: item
    integer :: n

    found = .false.
    do while (.not. work%parts%is_empty())
      item = work%parts%top()
      call work%parts%pop()
      work%search%operations = work%search%operations + 1
      found = .not. work%search%used(item%what)
      if (found) exit
    end do
    if (.not. found) return
    call walk_onward(work, int(item%minor/(work%graph%n_pairs + 1)), item%what, approach, n)
    allocate (approach%links(n + 1), approach%pairs(n))
    call walk_onward(work, int(item%minor/(work%graph%n_pairs + 1)), item%what, approach, n)
  end subroutine next_approach

  !> Walk from a link through a bridge, and on to the nearest link of a closed chain. Counts the
  !> pairs, and notes the walk if there is room allocated for it.
  pure subroutine walk_onward(work, start, bridge, walk, n)
    type(work_type), intent(in) :: work      !< the state of the transformation
    integer, intent(in) :: start             !< link at which the walk starts
    integer, intent(in) :: bridge            !< its first pair
    type(walk_type), intent(inout) :: walk   !< gets the walk, if its parts are allocated
    integer, intent(out) :: n                !< pairs walked
    integer :: link, pair

    n = 0
    link = start
    pair = bridge
    if (allocated(walk%links)) walk%links(1) = start
    do while (pair /= 0)
      n = n + 1
      link = sum(work%graph%ends(:, pair)) - link
      if (allocated(walk%links)) then
        walk%links(n + 1) = link
        walk%pairs(n) = pair
      end if
      pair = work%onward(link)
    end do
  end subroutine walk_onward

  !> Append the open chains by rule 3.
  pure subroutine take_open_chains(work)
    type(work_type), intent(inout) :: work   !< the state of the transformation
    integer :: next(work%graph%n_links)      ! position from which the pairs of each link are examined next
    type(priority_queue_type) :: starts
    type(queue_item_type) :: start
    integer :: link, pair

    next = 1
    do link = 1, work%graph%n_links
      if (work%search%known(link)) call starts%push(queue_item_type(int(link, long), 0_long, link))
    end do
    do while (.not. starts%is_empty())
      start = starts%top()
      link = start%what
      call next_open_pair(work, next(link), link, pair)
      if (pair == 0) then
        call starts%pop()
        cycle
      end if
      call append(work, link, 0)
      do while (pair /= 0)
        link = sum(work%graph%ends(:, pair)) - link
        work%search%used(pair) = .true.
        work%search%known(link) = .true.
        call append(work, link, pair)
        call starts%push(queue_item_type(int(link, long), 0_long, link))
        call next_open_pair(work, next(link), link, pair)
      end do
    end do
  end subroutine take_open_chains

  !> The unused pair of a link with an independent coordinate and the least number; without one, the unused pair of the
  !> least number; without any, 0. Positions run over the pairs of the link twice: first for independent, then for
  !> dependent coordinates.
  pure subroutine next_open_pair(work, position, link, pair)
    type(work_type), intent(inout) :: work   !< the state of the transformation
    integer, intent(inout) :: position       !< position from which pairs are examined; 1 at first
    integer, intent(in) :: link              !< number of the link
    integer, intent(out) :: pair             !< number of the pair; 0: none is left
    integer :: degree

    degree = work%graph%first(link + 1) - work%graph%first(link)
    do while (position <= 2*degree)
      pair = work%graph%pair_at(work%graph%first(link) + mod(position - 1, degree))
      work%search%operations = work%search%operations + 1
      if (.not. work%search%used(pair) .and. (work%graph%independent(pair) .eqv. position <= degree)) return
      position = position + 1
    end do
    pair = 0
  end subroutine next_open_pair

  !> Write a chain into the vectors and make its links known.
  pure subroutine take_chain(work, chain)
    type(work_type), intent(inout) :: work   !< the state of the transformation
    type(walk_type), intent(in) :: chain     !< an open or closed chain as a walk
    integer :: i

    call append(work, chain%links(1), 0)
    do i = 1, size(chain%pairs)
      call append(work, chain%links(i + 1), chain%pairs(i))
    end do
    call mark(work, chain)
  end subroutine take_chain

  !> Mark the pairs of a walk as used, then its links as known.
  pure subroutine mark(work, walk)
    type(work_type), intent(inout) :: work   !< the state of the transformation
    type(walk_type), intent(in) :: walk      !< a walk from a known link
    integer :: i

    work%search%used(walk%pairs) = .true.
    do i = 1, size(walk%links)
      if (.not. work%search%known(walk%links(i))) call make_known(work, walk%links(i))
    end do
  end subroutine mark

  !> Make a link known, and queue the bridges that lead from it to closed chains.
  pure subroutine make_known(work, link)
    type(work_type), intent(inout) :: work   !< the state of the transformation
    integer, intent(in) :: link              !< number of the link
    integer :: i

    call work%search%make_known(work%graph, link)
    do i = work%graph%first(link), work%graph%first(link + 1) - 1
      associate (pair => work%graph%pair_at(i), other => work%graph%other_at(i))
        if (work%search%used(pair) .or. .not. work%graph%is_bridge(pair)) cycle
        if (work%reach(other) == out_of_reach) cycle
        call work%parts%push(queue_item_type(work%graph%cost(pair) + work%reach(other), &
                                             int(link, long)*(work%graph%n_pairs + 1) + pair, pair))
        work%search%operations = work%search%operations + 1
      end associate
    end do
  end subroutine make_known

  !> Append a position to the vectors.
  pure subroutine append(work, link, pair)
    type(work_type), intent(inout) :: work   !< the state of the transformation
    integer, intent(in) :: link              !< number of the link
    integer, intent(in) :: pair              !< 0 at the start of a chain

    work%length = work%length + 1
    work%vectors%nrg(work%length) = link
    work%vectors%nws(work%length) = pair
    work%vectors%rdw(work%length) = 1
    if (pair > 0) work%vectors%rdw(work%length) = merge(1, 0, work%graph%independent(pair))
  end subroutine append
end module mech9_transformation
