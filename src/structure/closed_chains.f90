!> The search for the next closed chain: the cheapest walk from a known link, through unused pairs and unknown links, to a known
!> link.
!>
!> The cheapest chain has the fewest dependent coordinates. Among chains with equally many, it has the fewest coordinates,
!> then the least link at an end, then, read from that end, the least coordinate numbers in order.
!>
!> The method labels each unknown link with its distance to the known links (the cost of the cheapest
!> walk there) and with the pair by which that walk leaves the known links. A pair whose two links have
!> different labels closes a chain, of cost distance + pair + distance, and the cheapest chain is among
!> these. As links become known, distances only shrink, so that labels are updated and never made anew.
!> Updates stop at half the cost of the cheapest chain found so far: no link of a cheapest chain is
!> further from the known links, and links beyond wait in the queue until they are needed.
!> Below half that cost the label of a link is unique, since two labels at one distance would close
!> a chain of twice that distance. Hence the labels decide ties, too.
!>
!> A label is updated at most as often as half the cheapest chain found so far is long, and hardly ever more
!> than a few times: the work grows like the number of pairs (times its logarithm, for the queues). The worst known
!> mechanisms are ladders whose rungs are as long as the number of rungs: there the work grows with the power 1.5.
module mech9_closed_chains
  use mech9_kinds, only: long
  use mech9_priority_queue, only: queue_item_type, priority_queue_type
  use mech9_link_graph, only: link_graph_type, walk_type
  implicit none
  private
  public :: chain_search_type

  integer(long), parameter :: unlabelled = huge(1_long)

  !> The state of the search. Bridges lie on no closed chain and are left out.
  type :: chain_search_type
    logical, allocatable :: known(:)   !< (N) the link is known
    logical, allocatable :: used(:)    !< (M) the pair is used
    !> Pairs examined and items taken in or out of a queue: a measure of the work.
    integer(long) :: operations = 0
    integer(long), allocatable, private :: distance(:) ! (N) to the known links, 0 for a known one
    integer, allocatable, private :: label(:)          ! (N) pair by which the cheapest walk leaves them
    type(priority_queue_type), private :: pending      ! links to be labelled, by distance, label
    type(priority_queue_type), private :: closing      ! pairs that close a chain, by its cost and end
    integer, allocatable, private :: seen(:)           ! (N) number of the last tracing that reached the link
    integer, private :: tracings = 0                   ! number of tracings so far
    integer, allocatable, private :: trail_links(:)    ! (N+1) the chain being traced
    integer, allocatable, private :: trail_pairs(:)    ! (N+1) its pairs
    integer, allocatable, private :: trail_next(:)     ! (N+1) place of the pair that tracing tries next at each link
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
    procedure, private :: trace_back
  end type chain_search_type

contains

  !> Begin with nothing known and nothing used; a search can be started only once.
  pure subroutine start(self, graph)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism

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
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    integer, intent(in) :: link                       !< number of the link

    self%known(link) = .true.
    self%distance(link) = 0
    self%label(link) = 0
    call self%look_around(graph, link)
  end subroutine make_known

  !> The cheapest closed chain, run through so that an independent coordinate comes first where one
  !> end has it, else the smaller number. It is not yet marked as used or known.
  pure subroutine next_closed_chain(self, graph, chain, found)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    type(walk_type), intent(out) :: chain             !< the closed chain as a walk
    logical, intent(out) :: found                     !< whether there is one
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

  !> Offer the chains that the pairs of a link close, and labels to its neighbours, after the link became known or got its
  !> label.
  pure subroutine look_around(self, graph, link)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    integer, intent(in) :: link                       !< number of the link
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

  !> Queue a pair if it closes a chain by the present labels.
  pure subroutine offer(self, graph, pair)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    integer, intent(in) :: pair                       !< number of the pair
    type(queue_item_type) :: item
    logical :: closes

    call self%closing_item(graph, pair, item, closes)
    if (.not. closes) return
    call self%closing%push(item)
    self%operations = self%operations + 1
  end subroutine offer

  !> The cost of the chain that a pair closes, and the least end of it by the present labels:
  !> least link, then least pair there.
  pure subroutine closing_item(self, graph, pair, item, closes)
    class(chain_search_type), intent(in) :: self   !< the search
    type(link_graph_type), intent(in) :: graph     !< links and pairs of the mechanism
    integer, intent(in) :: pair                    !< number of the pair
    type(queue_item_type), intent(out) :: item     !< the pair, with cost and least end of the chain as its key
    logical, intent(out) :: closes                 !< whether the pair closes a chain
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
    type(link_graph_type), intent(in) :: graph   !< links and pairs of the mechanism
    integer, intent(in) :: link                  !< number of the link at the end
    integer, intent(in) :: pair                  !< number of the pair

    end_number = int(link, long)*(graph%n_pairs + 1) + pair
  end function end_number

  !> The known link of a pair that serves as label.
  pure integer function end_of_label(self, graph, pair)
    class(chain_search_type), intent(in) :: self   !< the search
    type(link_graph_type), intent(in) :: graph     !< links and pairs of the mechanism
    integer, intent(in) :: pair                    !< number of the pair

    end_of_label = graph%ends(1, pair)
    if (.not. self%known(end_of_label)) end_of_label = graph%ends(2, pair)
  end function end_of_label

  !> Drop the offers at the head of the queue that no longer agree with the labels; newer ones stand further back.
  pure subroutine drop_outdated(self, graph)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
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

  !> Label the link at the head of the queue, unless it is known or its label has no larger distance already.
  pure subroutine label_next(self, graph)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
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
  !> another label, and back to the known links, each time by the least coordinate that is possible.
  pure subroutine trace(self, graph, item, chain)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    type(queue_item_type), intent(in) :: item         !< the offer of a pair that closes a chain
    type(walk_type), intent(out) :: chain             !< the closed chain as a walk
    integer :: n

    associate (per_link => int(graph%n_pairs + 1, long))
      self%trail_links(1) = int(item%minor/per_link)
      self%trail_pairs(1) = int(mod(item%minor, per_link))
    end associate
    call self%trace_out(graph, item%major, n)
    call self%trace_back(graph, n)
    chain%links = self%trail_links(:n + 1)
    chain%pairs = self%trail_pairs(:n)
    if (n > 1) then
      if (comes_before(graph, chain%pairs(n), chain%pairs(1))) then
        chain%links = chain%links(n + 1:1:-1)
        chain%pairs = chain%pairs(n:1:-1)
      end if
    end if
  end subroutine trace

  !> Whether a chain is run through from the end with coordinate a: an independent coordinate comes first, then the
  !> smaller number.
  pure logical function comes_before(graph, a, b)
    type(link_graph_type), intent(in) :: graph   !< links and pairs of the mechanism
    integer, intent(in) :: a                     !< coordinate at one end
    integer, intent(in) :: b                     !< coordinate at the other end

    if (graph%independent(a) .neqv. graph%independent(b)) then
      comes_before = graph%independent(a)
    else
      comes_before = a < b
    end if
  end function comes_before

  !> The trail up to and including the pair that leads to another label or to a known link. It is found by a depth-first
  !> search in the order of coordinate numbers: the first trail found has the least numbers, and a link
  !> from which no trail leads on is not tried again.
  pure subroutine trace_out(self, graph, cost, n)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    integer(long), intent(in) :: cost                 !< of the whole chain
    integer, intent(out) :: n                         !< pairs in the trail
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

  !> Continue the trail from a link with another label to the known links, each pair on a cheapest walk there.
  pure subroutine trace_back(self, graph, n)
    class(chain_search_type), intent(inout) :: self   !< the search
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    integer, intent(inout) :: n                       !< pairs in the trail
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
  end subroutine trace_back

  !> The link at the other end of a pair.
  pure integer function other_end(graph, pair, link)
    type(link_graph_type), intent(in) :: graph   !< links and pairs of the mechanism
    integer, intent(in) :: pair                  !< number of the pair
    integer, intent(in) :: link                  !< one of its links

    other_end = graph%ends(1, pair)
    if (other_end == link) other_end = graph%ends(2, pair)
  end function other_end
end module mech9_closed_chains
