!> Structures of many kinds from a seed, their links and coordinates numbered at random.
module random_structures
  use mech9_structure, only: structure_type
  implicit none
  private
  public :: random_type, random_structure, n_kinds, kind_names

  integer, parameter :: n_kinds = 15
  character(len=20), parameter :: kind_names(n_kinds) = [character(len=20) :: &
    'tree', 'ladder', 'theta', 'hanging parts', 'tree with chords', 'dense', 'parallel pairs', &
    'grid', 'three pairs a link', 'rings on a path', 'star of rings', 'one ring', &
    'wheel', 'ladder in a ring', 'long rungs']

  !> Random numbers that are the same with every compiler (Lehmer's generator, x <- 48271 x mod 2^31-1).
  type :: random_type
    integer :: state = 1
  contains
    procedure :: below
  end type random_type

  !> Pairs being collected.
  type :: pairs_type
    integer :: count = 0
    integer, allocatable :: links(:, :)
  contains
    procedure :: join
  end type pairs_type

contains

  !> A whole number from 1 to n.
  subroutine below(self, n, number)
    class(random_type), intent(inout) :: self   !< source of the random numbers
    integer, intent(in) :: n                    !< greatest number
    integer, intent(out) :: number              !< from 1 to n
    integer, parameter :: modulus = 2147483647, factor = 48271, quotient = 44488, remainder = 3399

    ! Schrage's way to multiply without overflow
    self%state = factor*mod(self%state, quotient) - remainder*(self%state/quotient)
    if (self%state <= 0) self%state = self%state + modulus
    number = 1 + mod(self%state/7, n)
  end subroutine below

  subroutine join(self, a, b)
    class(pairs_type), intent(inout) :: self   !< pairs so far
    integer, intent(in) :: a                   !< first link
    integer, intent(in) :: b                   !< second link
    integer, allocatable :: grown(:, :)

    if (.not. allocated(self%links)) allocate (self%links(2, 16))
    if (self%count == size(self%links, 2)) then
      allocate (grown(2, 2*self%count))
      grown(:, :self%count) = self%links
      call move_alloc(grown, self%links)
    end if
    self%count = self%count + 1
    self%links(:, self%count) = [a, b]
  end subroutine join

  !> A connected structure of a kind (1 to n_kinds) with about n links.
  subroutine random_structure(kind, n, seed, structure, independent, shuffle)
    integer, intent(in) :: kind                !< 1 to n_kinds
    integer, intent(in) :: n                   !< links, about
    integer, intent(in) :: seed                !< of the random numbers
    type(structure_type), intent(out) :: structure         !< the structure
    logical, allocatable, intent(out) :: independent(:)    !< (M) the coordinate is independent
    logical, intent(in), optional :: shuffle   !< number links and coordinates at random (default)
    type(random_type) :: random
    type(pairs_type) :: pairs
    integer :: i, discarded, share
    logical :: at_random

    random%state = 1 + 7919*seed + 104729*kind
    do i = 1, 8
      call random%below(10, discarded)
    end do
    select case (kind)
    case (1, 5, 6, 7)
      call add_tree(pairs, n, random)
    case (2)
      call add_grid(pairs, n, 2)
    case (3)
      call add_theta(pairs, n, random)
    case (4)
      call add_hanging_parts(pairs, n, random)
    case (8)
      call add_grid(pairs, n, max(2, int(sqrt(real(n)))))
    case (9)
      call add_three_a_link(pairs, n, random)
    case (10, 11)
      call add_rings(pairs, n, kind == 10, random)
    case (12)
      call add_ring(pairs, n)
    case (13)
      call add_wheel(pairs, n)
    case (14)
      call add_ladder_in_ring(pairs, n)
    case default
      call add_long_rungs(pairs, n)
    end select
    if (kind == 5) call add_chords(pairs, n, max(1, n/3), random)
    if (kind == 6) call add_chords(pairs, n, n, random)
    if (kind == 7) call add_parallel(pairs, max(1, n/4), random)
    at_random = .true.
    if (present(shuffle)) at_random = shuffle
    structure%n_coordinates = pairs%count
    structure%n_links = maxval(pairs%links(:, :pairs%count))
    allocate (structure%links(2, pairs%count), independent(pairs%count))
    structure%links = pairs%links(:, :pairs%count)
    if (at_random) call renumber(structure, random)
    call random%below(4, share)
    do i = 1, pairs%count
      call random%below(8, discarded)
      independent(i) = discarded < share
    end do
  end subroutine random_structure

  subroutine add_tree(pairs, n, random)
    type(pairs_type), intent(inout) :: pairs     !< pairs so far; those of the part are added
    integer, intent(in) :: n                     !< links
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: i, near

    do i = 2, n
      call random%below(min(i - 1, 6), near)
      call pairs%join(i, i - near)
    end do
  end subroutine add_tree

  subroutine add_chords(pairs, n, chords, random)
    type(pairs_type), intent(inout) :: pairs     !< pairs so far; those of the part are added
    integer, intent(in) :: n                     !< links
    integer, intent(in) :: chords                !< pairs beyond a tree
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: i, a, b

    do i = 1, chords
      call random%below(n, a)
      call random%below(n, b)
      if (a /= b) call pairs%join(a, b)
    end do
  end subroutine add_chords

  !> Double some pairs.
  subroutine add_parallel(pairs, more, random)
    type(pairs_type), intent(inout) :: pairs     !< pairs so far; those of the part are added
    integer, intent(in) :: more                  !< pairs that are doubled
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: i, k, links(2)

    do i = 1, more
      call random%below(pairs%count, k)
      links = pairs%links(:, k)   ! a copy: the array may move while it grows
      call pairs%join(links(2), links(1))
    end do
  end subroutine add_parallel

  !> Rows of `width` links; a width of 2 makes a ladder.
  subroutine add_grid(pairs, n, width)
    type(pairs_type), intent(inout) :: pairs   !< pairs so far; those of the part are added
    integer, intent(in) :: n                   !< links
    integer, intent(in) :: width               !< links in a row
    integer :: i

    do i = 2, max(n, width + 2)
      if (mod(i - 1, width) /= 0) call pairs%join(i - 1, i)
      if (i > width) call pairs%join(i - width, i)
    end do
  end subroutine add_grid

  !> Several walks between two links.
  subroutine add_theta(pairs, n, random)
    type(pairs_type), intent(inout) :: pairs     !< pairs so far; those of the part are added
    integer, intent(in) :: n                     !< links
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: last, length, i

    call pairs%join(1, 2)
    last = 2
    do while (last < n)
      call random%below(max(1, n/4), length)
      call pairs%join(1, last + 1)
      do i = 2, length
        call pairs%join(last + i - 1, last + i)
      end do
      last = last + length
      call pairs%join(last, 2)
    end do
  end subroutine add_theta

  !> A tree some of whose links carry small rings.
  subroutine add_hanging_parts(pairs, n, random)
    type(pairs_type), intent(inout) :: pairs     !< pairs so far; those of the part are added
    integer, intent(in) :: n                     !< links
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: last, tree, size_of_ring, at, i

    tree = max(2, n/2)
    call add_tree(pairs, tree, random)
    last = tree
    do while (last < n)
      call random%below(4, size_of_ring)
      call random%below(last, at)
      call pairs%join(at, last + 1)
      do i = 2, size_of_ring
        call pairs%join(last + i - 1, last + i)
      end do
      last = last + size_of_ring
      if (size_of_ring > 1) call pairs%join(last, last - size_of_ring + 1)
    end do
  end subroutine add_hanging_parts

  !> A ring with as many chords as make three pairs at each link.
  subroutine add_three_a_link(pairs, n, random)
    type(pairs_type), intent(inout) :: pairs     !< pairs so far; those of the part are added
    integer, intent(in) :: n                     !< links
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: order(n), i

    call add_ring(pairs, n)
    call shuffled(order, random)
    do i = 1, n - 1, 2
      call pairs%join(order(i), order(i + 1))
    end do
  end subroutine add_three_a_link

  !> Rings that share one link with the ring before, or all with the first link.
  subroutine add_rings(pairs, n, on_path, random)
    type(pairs_type), intent(inout) :: pairs     !< pairs so far; those of the part are added
    integer, intent(in) :: n                     !< links
    logical, intent(in) :: on_path               !< each ring shares a link with the ring before, not with the first link
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: last, at, length, i

    last = 1
    do while (last < max(n, 3))
      at = merge(last, 1, on_path)
      call random%below(5, length)
      call pairs%join(at, last + 1)
      do i = 2, length
        call pairs%join(last + i - 1, last + i)
      end do
      last = last + length
      call pairs%join(last, at)
    end do
  end subroutine add_rings

  subroutine add_ring(pairs, n)
    type(pairs_type), intent(inout) :: pairs   !< pairs so far; those of the part are added
    integer, intent(in) :: n                   !< links
    integer :: i

    do i = 2, n
      call pairs%join(i - 1, i)
    end do
    call pairs%join(n, 1)
  end subroutine add_ring

  !> A ring, and a hub that is joined to each of its links.
  subroutine add_wheel(pairs, n)
    type(pairs_type), intent(inout) :: pairs   !< pairs so far; those of the part are added
    integer, intent(in) :: n                   !< links
    integer :: i

    call add_ring(pairs, n - 1)
    do i = 1, n - 1
      call pairs%join(i, n)
    end do
  end subroutine add_wheel

  !> A ring of half of the links, and a ladder of the others across it.
  subroutine add_ladder_in_ring(pairs, n)
    type(pairs_type), intent(inout) :: pairs   !< pairs so far; those of the part are added
    integer, intent(in) :: n                   !< links
    integer :: i, half

    half = max(3, n/2)
    call add_ring(pairs, half)
    call pairs%join(1, half + 1)
    do i = half + 2, max(n, half + 2)
      call pairs%join(i - 1, i)
      if (i - 3 > half) call pairs%join(i - 3, i)
    end do
    call pairs%join(max(n, half + 2), half/2 + 1)
  end subroutine add_ladder_in_ring

  !> A ladder whose rungs have about as many links as it has rungs.
  subroutine add_long_rungs(pairs, n)
    type(pairs_type), intent(inout) :: pairs   !< pairs so far; those of the part are added
    integer, intent(in) :: n                   !< links
    integer :: rungs, i, j, last

    rungs = max(2, int(sqrt(real(n))))
    do i = 2, rungs
      call pairs%join(2*i - 3, 2*i - 1)
      call pairs%join(2*i - 2, 2*i)
    end do
    last = 2*rungs
    do i = 1, rungs
      call pairs%join(2*i - 1, last + 1)
      do j = 2, rungs
        call pairs%join(last + j - 1, last + j)
      end do
      last = last + rungs
      call pairs%join(last, 2*i)
    end do
  end subroutine add_long_rungs

  !> New numbers for links and coordinates, and the links of a pair in either order.
  subroutine renumber(structure, random)
    type(structure_type), intent(inout) :: structure   !< gets new numbers
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer :: of_link(structure%n_links), of_pair(structure%n_coordinates), k, turn
    integer :: links(2, structure%n_coordinates)

    call shuffled(of_link, random)
    call shuffled(of_pair, random)
    do k = 1, structure%n_coordinates
      call random%below(2, turn)
      links(1, of_pair(k)) = of_link(structure%links(turn, k))
      links(2, of_pair(k)) = of_link(structure%links(3 - turn, k))
    end do
    structure%links = links
  end subroutine renumber

  subroutine shuffled(numbers, random)
    integer, intent(out) :: numbers(:)           !< 1 to their count, in random order
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer :: i, j

    do i = 1, size(numbers)
      call random%below(i, j)
      numbers(i) = numbers(j)
      numbers(j) = i
    end do
  end subroutine shuffled
end module random_structures
