!> Links and pairs as a graph: which pairs each link has, and which pairs are bridges, that is, lie on no closed chain.
module mech9_link_graph
  use mech9_kinds, only: long
  use mech9_structure, only: structure_type
  implicit none
  private
  public :: link_graph_type, walk_type, graph_from_structure

  !> The pairs of link i stand at first(i) .. first(i+1) - 1 of `pair_at`, by increasing number, with
  !> the link at the other end of each in `other_at`.
  type :: link_graph_type
    integer :: n_links = 0
    integer :: n_pairs = 0
    integer, allocatable :: ends(:, :)       !< (2,M) links of each pair
    integer, allocatable :: first(:)         !< (N+1) place of the first pair of each link in pair_at
    integer, allocatable :: pair_at(:)       !< (2M) pairs, link by link
    integer, allocatable :: other_at(:)      !< (2M) link at the other end of each of them
    logical, allocatable :: is_bridge(:)     !< (M) the pair lies on no closed chain
    integer, allocatable :: outward(:)       !< (N) links in an order in which link 1 is first, and
                                             !< each link comes later than those nearer to it by bridges
    logical, allocatable :: independent(:)   !< (M) the coordinate of the pair is independent; set by `weigh`
    !> (M) cost of a pair, set by `weigh`. The cost of a chain is the sum over its pairs; it compares first the number of
    !> dependent coordinates, then the number of all coordinates.
    integer(long), allocatable :: cost(:)
  contains
    procedure :: weigh
  end type link_graph_type

  !> A walk from links(1) through pairs(1) to links(2), and so on.
  type :: walk_type
    integer, allocatable :: links(:)   !< (n+1) in the order of the walk
    integer, allocatable :: pairs(:)   !< (n) in the order of the walk
  end type walk_type

contains

  !> The graph of a structure.
  pure function graph_from_structure(structure) result(graph)
    type(structure_type), intent(in) :: structure   !< a structure without findings
    type(link_graph_type) :: graph

    graph%n_links = structure%n_links
    graph%n_pairs = structure%n_coordinates
    allocate (graph%ends, source=structure%links)
    call collect_pairs(graph)
    call find_bridges(graph)
  end function graph_from_structure

  !> Sort the pairs by their links.
  pure subroutine collect_pairs(graph)
    type(link_graph_type), intent(inout) :: graph   !< the graph, with the links of each pair
    integer :: next(graph%n_links), i, k, link

    allocate (graph%first(graph%n_links + 1), source=0)
    allocate (graph%pair_at(2*graph%n_pairs), graph%other_at(2*graph%n_pairs))
    do k = 1, graph%n_pairs
      do i = 1, 2
        link = graph%ends(i, k)
        graph%first(link + 1) = graph%first(link + 1) + 1
      end do
    end do
    graph%first(1) = 1
    do link = 1, graph%n_links
      graph%first(link + 1) = graph%first(link) + graph%first(link + 1)
    end do
    next = graph%first(:graph%n_links)
    do k = 1, graph%n_pairs
      do i = 1, 2
        link = graph%ends(i, k)
        graph%pair_at(next(link)) = k
        graph%other_at(next(link)) = graph%ends(3 - i, k)
        next(link) = next(link) + 1
      end do
    end do
  end subroutine collect_pairs

  !> One number holds both parts of the cost: `scale` for a dependent coordinate, and one more for
  !> any coordinate. In sums of up to four chains the lower part never reaches `scale`.
  pure subroutine weigh(graph, independent)
    class(link_graph_type), intent(inout) :: graph   !< the graph, which gets the costs
    logical, intent(in) :: independent(:)            !< (M) the coordinate of the pair is independent
    integer(long) :: scale

    scale = 4_long*graph%n_pairs + 4_long
    graph%independent = independent
    graph%cost = merge(1_long, scale + 1_long, independent)
  end subroutine weigh

  !> Bridges by one depth-first walk from link 1 (Tarjan in docs/reference/bibliography.md): the pair that first reached a link is a
  !> bridge if no other pair leads from that link, or from those reached through it, further back.
  pure subroutine find_bridges(graph)
    type(link_graph_type), intent(inout) :: graph   !< the graph, with the pairs of each link
    integer :: reached(graph%n_links)        ! number in the order in which links are reached; 0: not yet
    integer :: back(graph%n_links)           ! the least such number that can be reached from this link on
    integer :: next(graph%n_links)           ! place in pair_at of the next pair of the link
    integer :: through(graph%n_links)        ! pair that first reached the link
    integer :: from(graph%n_links)           ! link from which it was reached
    integer :: link, other, n

    allocate (graph%is_bridge(graph%n_pairs), source=.false.)
    allocate (graph%outward(graph%n_links), source=1)
    reached = 0
    through = 0
    from = 0
    next = graph%first(:graph%n_links)
    n = 1
    link = 1
    reached(1) = 1
    back(1) = 1
    do
      if (next(link) < graph%first(link + 1)) then
        associate (pair => graph%pair_at(next(link)))
          other = graph%other_at(next(link))
          next(link) = next(link) + 1
          if (pair == through(link)) cycle
          if (reached(other) > 0) then
            back(link) = min(back(link), reached(other))
            cycle
          end if
          through(other) = pair
        end associate
        from(other) = link
        n = n + 1
        reached(other) = n
        back(other) = n
        graph%outward(n) = other
        link = other
      else
        if (from(link) == 0) exit
        graph%is_bridge(through(link)) = back(link) == reached(link)
        back(from(link)) = min(back(from(link)), back(link))
        link = from(link)
      end if
    end do
  end subroutine find_bridges
end module mech9_link_graph
