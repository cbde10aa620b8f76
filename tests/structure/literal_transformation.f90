!> The rules of mech9_transformation taken literally: at each turn all chains are written down and the best one is taken. For
!> small structures only.
module literal_transformation
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type
  implicit none
  private
  public :: transform_literally

  !> The chain being written down, and the best one so far.
  type :: listing_type
    integer :: n = 0                             ! pairs in the chain
    integer, allocatable :: links(:), pairs(:)
    integer :: best_n = 0
    integer, allocatable :: best_links(:), best_pairs(:)
  end type listing_type

  type :: work_type
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    logical, allocatable :: known(:), used(:), bridge(:)
    type(structural_vectors_type) :: vectors
    integer :: closures = 0
  end type work_type

contains

  subroutine transform_literally(structure, independent, vectors)
    type(structure_type), intent(in) :: structure           !< the structure
    logical, intent(in) :: independent(:)                   !< (M) the coordinate is independent
    type(structural_vectors_type), intent(out) :: vectors   !< by the rules, taken literally
    type(work_type) :: work
    type(listing_type) :: closed, approach
    integer :: k

    work%structure = structure
    work%independent = independent
    allocate (work%known(structure%n_links), source=.false.)
    allocate (work%used(structure%n_coordinates), source=.false.)
    allocate (work%bridge(structure%n_coordinates), source=.false.)
    do k = 1, structure%n_coordinates
      work%bridge(k) = .not. connected_without(structure, k)
    end do
    allocate (work%vectors%nrg(0), work%vectors%nws(0), work%vectors%rdw(0), work%vectors%nrw(0))
    work%known(1) = .true.
    do
      call best_chain(work, .false., closed)
      if (closed%best_n > 0) then
        call put_in_order(work, closed)
        call take(work, closed%best_links, closed%best_pairs)
        cycle
      end if
      call best_chain(work, .true., approach)
      if (approach%best_n == 0) exit
      work%known(approach%best_links) = .true.
      work%used(approach%best_pairs) = .true.
      call best_chain(work, .false., closed)
      call put_in_order(work, closed)
      call take(work, [approach%best_links, closed%best_links(2:)], [approach%best_pairs, closed%best_pairs])
    end do
    do while (.not. all(work%used))
      call take_open_chain(work)
    end do
    vectors = work%vectors
  end subroutine transform_literally

  !> Whether the links stay connected if a pair is taken away.
  logical function connected_without(structure, without)
    type(structure_type), intent(in) :: structure   !< the structure
    integer, intent(in) :: without                  !< coordinate of the pair that is taken away
    logical :: reached(structure%n_links)
    integer :: turn, k

    reached = .false.
    reached(1) = .true.
    do turn = 1, structure%n_links
      do k = 1, structure%n_coordinates
        if (k == without) cycle
        if (any(reached(structure%links(:, k)))) reached(structure%links(:, k)) = .true.
      end do
    end do
    connected_without = all(reached)
  end function connected_without

  !> The best of all chains from known links: of closed ones over pairs of any kind, or of walks over
  !> bridges to a link that has a pair which is none.
  subroutine best_chain(work, over_bridges, listing)
    type(work_type), intent(in) :: work          !< structure, vectors so far, and the chain in hand
    logical, intent(in) :: over_bridges          !< walks over bridges, not closed chains
    type(listing_type), intent(out) :: listing   !< the best chain
    integer :: start

    allocate (listing%links(work%structure%n_coordinates + 1), listing%pairs(work%structure%n_coordinates))
    do start = 1, work%structure%n_links
      if (.not. work%known(start)) cycle
      listing%n = 0
      listing%links(1) = start
      call list_from_here(work, over_bridges, listing)
    end do
  end subroutine best_chain

  recursive subroutine list_from_here(work, over_bridges, listing)
    type(work_type), intent(in) :: work            !< structure, vectors so far, and the chain in hand
    logical, intent(in) :: over_bridges            !< walks over bridges, not closed chains
    type(listing_type), intent(inout) :: listing   !< the chain in hand and the best one so far
    integer :: k, here, next
    logical :: complete

    here = listing%links(listing%n + 1)
    do k = 1, work%structure%n_coordinates
      if (work%used(k) .or. all(work%structure%links(:, k) /= here)) cycle
      if (any(listing%pairs(:listing%n) == k)) cycle
      if (over_bridges .and. .not. work%bridge(k)) cycle
      next = sum(work%structure%links(:, k)) - here
      if (.not. work%known(next) .and. any(listing%links(:listing%n + 1) == next)) cycle
      listing%n = listing%n + 1
      listing%pairs(listing%n) = k
      listing%links(listing%n + 1) = next
      if (over_bridges) then
        complete = on_closed_chain(work, next)
      else
        complete = work%known(next)
      end if
      if (complete) then
        call keep_better(work, listing)
      else if (.not. work%known(next)) then
        call list_from_here(work, over_bridges, listing)
      end if
      listing%n = listing%n - 1
    end do
  end subroutine list_from_here

  logical function on_closed_chain(work, link)
    type(work_type), intent(in) :: work   !< structure, vectors so far, and the chain in hand
    integer, intent(in) :: link           !< its number
    integer :: k

    on_closed_chain = .false.
    do k = 1, work%structure%n_coordinates
      if (any(work%structure%links(:, k) == link) .and. .not. work%bridge(k)) on_closed_chain = .true.
    end do
  end function on_closed_chain

  !> Fewest dependent coordinates, fewest coordinates, least start link, least coordinates.
  subroutine keep_better(work, listing)
    type(work_type), intent(in) :: work            !< structure, vectors so far, and the chain in hand
    type(listing_type), intent(inout) :: listing   !< the chain in hand and the best one so far
    integer :: ours(listing%n + 3), best(listing%best_n + 3), i
    logical :: better

    better = listing%best_n == 0
    if (.not. better) then
      ours = key(work, listing%links(1), listing%pairs(:listing%n))
      best = key(work, listing%best_links(1), listing%best_pairs)
      do i = 1, min(size(ours), size(best))
        better = ours(i) < best(i)
        if (ours(i) /= best(i)) exit
      end do
    end if
    if (.not. better) return
    listing%best_n = listing%n
    listing%best_links = listing%links(:listing%n + 1)
    listing%best_pairs = listing%pairs(:listing%n)
  end subroutine keep_better

  pure function key(work, start, pairs)
    type(work_type), intent(in) :: work   !< structure, vectors so far, and the chain in hand
    integer, intent(in) :: start          !< link from which the chain starts
    integer, intent(in) :: pairs(:)       !< its coordinates
    integer :: key(size(pairs) + 3)

    key(1) = count(.not. work%independent(pairs))
    key(2) = size(pairs)
    key(3) = start
    key(4:) = pairs
  end function key

  !> An independent coordinate first where one end has it, else the smaller number.
  subroutine put_in_order(work, listing)
    type(work_type), intent(in) :: work            !< structure, vectors so far, and the chain in hand
    type(listing_type), intent(inout) :: listing   !< the chain whose ends may be exchanged
    logical :: turn
    integer :: n, first, last

    n = listing%best_n
    first = listing%best_pairs(1)
    last = listing%best_pairs(n)
    if (work%independent(first) .neqv. work%independent(last)) then
      turn = work%independent(last)
    else
      turn = last < first
    end if
    if (.not. turn) return
    listing%best_pairs = listing%best_pairs(n:1:-1)
    listing%best_links = listing%best_links(n + 1:1:-1)
  end subroutine put_in_order

  subroutine take_open_chain(work)
    type(work_type), intent(inout) :: work   !< structure, vectors so far, and the chain in hand
    integer :: links(work%structure%n_links), pairs(work%structure%n_links)
    integer :: link, pair, n

    pair = 0
    link = 0
    do while (pair == 0)
      link = link + 1
      if (work%known(link)) pair = open_pair(work, link)
    end do
    n = 0
    links(1) = link
    do while (pair > 0)
      n = n + 1
      work%used(pair) = .true.
      pairs(n) = pair
      links(n + 1) = sum(work%structure%links(:, pair)) - links(n)
      pair = open_pair(work, links(n + 1))
    end do
    call take(work, links(:n + 1), pairs(:n))
  end subroutine take_open_chain

  integer function open_pair(work, link)
    type(work_type), intent(in) :: work   !< structure, vectors so far, and the chain in hand
    integer, intent(in) :: link           !< at which the pair leaves
    integer :: k

    open_pair = 0
    do k = work%structure%n_coordinates, 1, -1
      if (work%used(k) .or. all(work%structure%links(:, k) /= link)) cycle
      if (open_pair > 0) then
        if (work%independent(open_pair) .and. .not. work%independent(k)) cycle
      end if
      open_pair = k
    end do
  end function open_pair

  !> Write a chain down; only the last link of a closed chain is one of it or known before.
  subroutine take(work, links, pairs)
    type(work_type), intent(inout) :: work   !< structure, vectors so far, and the chain in hand
    integer, intent(in) :: links(:)          !< of the chain, in order, the first one known
    integer, intent(in) :: pairs(:)          !< its coordinates, in order
    integer :: n, kinds(size(pairs)), numbers(size(pairs))
    logical :: closes

    n = size(pairs)
    closes = any(links(:n) == links(n + 1))
    ! on an approach the links are known by now, but they are written down for the first time
    if (work%known(links(n + 1)) .and. any(work%vectors%nrg == links(n + 1))) closes = .true.
    kinds = merge(1, 0, work%independent(pairs))
    numbers = work%closures
    if (closes) work%closures = work%closures + 1
    numbers(n) = work%closures
    associate (v => work%vectors)
      if (size(v%nrw) > 0) then
        v%nrw = [v%nrw, v%nrw(size(v%nrw)), numbers]
      else
        v%nrw = [0, numbers]
      end if
      v%nrg = [v%nrg, links]
      v%nws = [v%nws, 0, pairs]
      v%rdw = [v%rdw, 1, kinds]
    end associate
    work%known(links) = .true.
    work%used(pairs) = .true.
  end subroutine take
end module literal_transformation
