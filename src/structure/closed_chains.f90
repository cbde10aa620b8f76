!> The search for the next closed chain: the cheapest walk from a known link, through unused pairs and unknown links, to a known
!> link.
!>
!> Cheapest is: fewest dependent coordinates; ties: fewest coordinates, then the least link at
!> an end, then, read from that end, the least coordinate numbers in order.
!>
!> How. Each unknown link is labelled with its distance to the known links (the cost of the cheapest
!> way there) and with the pair by which that way leaves them. A pair whose two links have
!> different labels closes a chain, of cost distance + pair + distance, and the cheapest one is among
!> these. As links become known, distances only shrink, so labels are mended, never made anew.
!> Mending stops at half the cost of the cheapest chain in sight: no link of a cheapest chain is
!> further from the known links than that, and what lies beyond waits in the queue until it matters.
!> Below half that cost the label of a link is unique, since two labels at one distance would close
!> a chain of twice that distance. So the ties too are settled from the labels.
!>
!> A label is mended at most as often as half the cheapest chain in sight is long, and hardly ever more
!> than a few times: the work grows like the number of pairs (times its logarithm, for the queues). Ladders
!> with rungs as long as they have rungs are the worst known: there it grows with the power 1.5.
module mech9_closed_chains
  use mech9_kinds, only: long
  use mech9_priority_queue, only: queue_item_type, priority_queue_type
  use mech9_link_graph, only: link_graph_type, walk_type
  implicit none
  private
  public :: chain_search_type

  integer(long), parameter :: unlabelled = huge(1_long)

  !> What is known, what is used, and the labels. Bridges lie on no closed chain and are left out.
  type :: chain_search_type
    logical, allocatable :: known(:)                   !< (N)
    logical, allocatable :: used(:)                    !< (M)
    !> Pairs looked at and items taken in or out of a queue: a measure of the work.
    integer(long) :: operations = 0
    integer(long), allocatable, private :: distance(:) ! (N) to the known links, 0 for a known one
    integer, allocatable, private :: label(:)          ! (N) pair by which that way leaves them
    type(priority_queue_type), private :: pending      ! links to be labelled, by distance, label
    type(priority_queue_type), private :: closing      ! pairs that close a chain, by its cost and end
    integer, allocatable, private :: seen(:)           ! (N) the last tracing that looked at a link
    integer, private :: tracings = 0
    integer, allocatable, private :: trail_links(:)    ! (N+1) the chain being traced
    integer, allocatable, private :: trail_pairs(:)    ! (N+1)
    integer, allocatable, private :: trail_next(:)     ! (N+1) where tracing goes on at each link
  contains
    procedure :: start
    procedure :: make_known
    procedure :: next_closed_chain
    procedure, private :: look_around
    procedure, private :: offer
    procedure, private :: closing_item
    procedure, private :: drop_outdated
    procedure, private :: label_next
    procedure, private :: end_of_label
    procedure, private :: trace
    procedure, private :: trace_out
    procedure, private :: trace_home
  end type chain_search_type

contains

  !> Begin with nothing known and nothing used; a search can be started only once.
  pure subroutine start(self, graph)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph

    allocate (self%known(graph%n_links), source=.false.)
    allocate (self%used(graph%n_pairs), source=.false.)
    allocate (self%distance(graph%n_links), source=unlabelled)
    allocate (self%label(graph%n_links), source=0)
    allocate (self%seen(graph%n_links), source=0)
    allocate (self%trail_links(graph%n_links + 1), source=0)
    allocate (self%trail_pairs(graph%n_links + 1), source=0)
    allocate (self%trail_next(graph%n_links + 1), source=0)
  end subroutine start

  !> Add a link to the known ones. The pairs by which it was reached must be marked as used before.
  pure subroutine make_known(self, graph, link)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: link

    self%known(link) = .true.
    self%distance(link) = 0
    self%label(link) = 0
    call self%look_around(graph, link)
  end subroutine make_known

  !> The cheapest closed chain, run through so that an independent coordinate comes first where one
  !> end has it, else the smaller number. It is not yet marked as used or known.
  pure subroutine next_closed_chain(self, graph, chain, found)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    type(walk_type), intent(out) :: chain
    logical, intent(out) :: found
    type(queue_item_type) :: cheapest, nearest

    do
      call self%drop_outdated(graph)
      found = .not. self%closing%is_empty()
      if (self%pending%is_empty()) exit
      if (found) then
        cheapest = self%closing%top()
        nearest = self%pending%top()
        if (2*nearest%major > cheapest%major) exit
      end if
      call self%label_next(graph)
    end do
    if (found) call self%trace(graph, self%closing%top(), chain)
  end subroutine next_closed_chain

  !> After a link became known or got its label: offer the chains that its pairs close, and labels
  !> to its neighbours.
  pure subroutine look_around(self, graph, link)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: link
    integer(long) :: distance
    integer :: i, label

    do i = graph%first(link), graph%first(link + 1) - 1
      associate (pair => graph%pair_at(i), other => graph%other_at(i))
        self%operations = self%operations + 1
        if (self%used(pair) .or. graph%is_bridge(pair)) cycle
        call self%offer(graph, pair)
        if (self%known(other)) cycle
        distance = self%distance(link) + graph%cost(pair)
        label = merge(pair, self%label(link), self%known(link))
        if (distance < self%distance(other)) then
          call self%pending%push(queue_item_type(distance, int(label, long), other))
          self%operations = self%operations + 1
        end if
      end associate
    end do
  end subroutine look_around

  !> Queue a pair if, as the labels stand, it closes a chain.
  pure subroutine offer(self, graph, pair)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: pair
    type(queue_item_type) :: item
    logical :: closes

    call self%closing_item(graph, pair, item, closes)
    if (.not. closes) return
    call self%closing%push(item)
    self%operations = self%operations + 1
  end subroutine offer

  !> The cost of the chain that a pair closes, and the least end of it as the labels stand:
  !> least link, then least pair there.
  pure subroutine closing_item(self, graph, pair, item, closes)
    class(chain_search_type), intent(in) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: pair
    type(queue_item_type), intent(out) :: item
    logical, intent(out) :: closes
    integer :: label(2), i
    integer(long) :: end_key(2)

    closes = .false.
    if (self%used(pair)) return
    item%major = graph%cost(pair)
    do i = 1, 2
      associate (link => graph%ends(i, pair))
        if (self%distance(link) == unlabelled) return
        item%major = item%major + self%distance(link)
        if (self%known(link)) then
          label(i) = pair
          end_key(i) = end_number(graph, link, pair)
        else
          label(i) = self%label(link)
          end_key(i) = end_number(graph, self%end_of_label(graph, label(i)), label(i))
        end if
      end associate
    end do
    item%minor = minval(end_key)
    item%what = pair
    closes = label(1) /= label(2) .or. all(self%known(graph%ends(:, pair)))
  end subroutine closing_item

  !> An end of a chain as one number: by link, then by pair.
  pure integer(long) function end_number(graph, link, pair)
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: link, pair

    end_number = int(link, long)*(graph%n_pairs + 1) + pair
  end function end_number

  !> The known link of a pair that serves as label.
  pure integer function end_of_label(self, graph, pair)
    class(chain_search_type), intent(in) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: pair

    end_of_label = graph%ends(1, pair)
    if (.not. self%known(end_of_label)) end_of_label = graph%ends(2, pair)
  end function end_of_label

  !> Drop the offers at the head of the queue that labels have overtaken; newer ones stand further back.
  pure subroutine drop_outdated(self, graph)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    type(queue_item_type) :: offered, current
    logical :: closes

    do while (.not. self%closing%is_empty())
      offered = self%closing%top()
      call self%closing_item(graph, offered%what, current, closes)
      ! distances only shrink, so the same cost means the same labels
      if (closes .and. current%major == offered%major) exit
      call self%closing%pop()
      self%operations = self%operations + 1
    end do
  end subroutine drop_outdated

  !> Label the link at the head of the queue, unless it is known or labelled as near already.
  pure subroutine label_next(self, graph)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    type(queue_item_type) :: item

    item = self%pending%top()
    call self%pending%pop()
    self%operations = self%operations + 1
    if (item%major >= self%distance(item%what)) return
    self%distance(item%what) = item%major
    self%label(item%what) = int(item%minor)
    call self%look_around(graph, item%what)
  end subroutine label_next

  !> Trace the chain of an offer: from its least end through links with that label, across a pair to
  !> another label, and home to the known links, each time by the least coordinate that will do.
  pure subroutine trace(self, graph, item, chain)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    type(queue_item_type), intent(in) :: item
    type(walk_type), intent(out) :: chain
    integer :: n

    associate (per_link => int(graph%n_pairs + 1, long))
      self%trail_links(1) = int(item%minor/per_link)
      self%trail_pairs(1) = int(mod(item%minor, per_link))
    end associate
    call self%trace_out(graph, item%major, n)
    call self%trace_home(graph, n)
    chain%links = self%trail_links(:n + 1)
    chain%pairs = self%trail_pairs(:n)
    if (n > 1) then
      if (comes_before(graph, chain%pairs(n), chain%pairs(1))) then
        chain%links = chain%links(n + 1:1:-1)
        chain%pairs = chain%pairs(n:1:-1)
      end if
    end if
  end subroutine trace

  pure logical function comes_before(graph, a, b)
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: a, b

    if (graph%independent(a) .neqv. graph%independent(b)) then
      comes_before = graph%independent(a)
    else
      comes_before = a < b
    end if
  end function comes_before

  !> The trail up to and including the pair that leads to another label or to a known link. A search in
  !> depth by increasing coordinate numbers: what it finds first has the least numbers, and a link
  !> it had to turn back from is not tried again.
  pure subroutine trace_out(self, graph, cost, n)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    integer(long), intent(in) :: cost               !< of the whole chain
    integer, intent(out) :: n                       !< pairs in the trail
    integer(long) :: here
    integer :: i, link

    self%tracings = self%tracings + 1
    n = 1
    link = other_end(graph, self%trail_pairs(1), self%trail_links(1))
    self%trail_links(2) = link
    if (self%known(link)) return
    if (self%label(link) /= self%trail_pairs(1)) return
    self%trail_next(2) = graph%first(link)
    do
      link = self%trail_links(n + 1)
      i = self%trail_next(n + 1)
      if (i == graph%first(link + 1)) then
        n = n - 1
        cycle
      end if
      self%trail_next(n + 1) = i + 1
      self%operations = self%operations + 1
      associate (pair => graph%pair_at(i), other => graph%other_at(i))
        if (self%used(pair) .or. graph%is_bridge(pair) .or. pair == self%trail_pairs(n)) cycle
        if (self%distance(other) == unlabelled) cycle
        here = self%distance(link) + graph%cost(pair)
        if (self%known(other) .or. self%label(other) /= self%trail_pairs(1)) then
          if (here + self%distance(other) /= cost) cycle
        else
          if (here /= self%distance(other) .or. 2*here > cost) cycle
          if (self%seen(other) == self%tracings) cycle
          self%seen(other) = self%tracings
        end if
        n = n + 1
        self%trail_pairs(n) = pair
        self%trail_links(n + 1) = other
        if (self%known(other) .or. self%label(other) /= self%trail_pairs(1)) return
        self%trail_next(n + 1) = graph%first(other)
      end associate
    end do
  end subroutine trace_out

  !> From a link with another label on to the known links, each pair on a cheapest way there.
  pure subroutine trace_home(self, graph, n)
    class(chain_search_type), intent(inout) :: self   !< the chain search
    type(link_graph_type), intent(in) :: graph
    integer, intent(inout) :: n                     !< pairs in the trail
    integer :: i, link, label

    link = self%trail_links(n + 1)
    do while (.not. self%known(link))
      do i = graph%first(link), graph%first(link + 1) - 1
        self%operations = self%operations + 1
        associate (pair => graph%pair_at(i), other => graph%other_at(i))
          if (self%used(pair) .or. graph%is_bridge(pair)) cycle
          if (self%distance(other) == unlabelled) cycle
          if (self%distance(other) + graph%cost(pair) /= self%distance(link)) cycle
          label = merge(pair, self%label(other), self%known(other))
          if (label /= self%trail_pairs(1)) exit
        end associate
      end do
      n = n + 1
      self%trail_pairs(n) = graph%pair_at(i)
      self%trail_links(n + 1) = graph%other_at(i)
      link = self%trail_links(n + 1)
    end do
  end subroutine trace_home

  pure integer function other_end(graph, pair, link)
    type(link_graph_type), intent(in) :: graph
    integer, intent(in) :: pair, link

    other_end = graph%ends(1, pair)
    if (other_end == link) other_end = graph%ends(2, pair)
  end function other_end
end module mech9_closed_chains
