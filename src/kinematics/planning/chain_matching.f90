!> Matching of unknowns with the closed chains that determine them.
!>
!> Each chain can determine as many unknowns of its loop as it offers equations. Chains that can determine all unknowns of
!> their loops are assigned first, which often leaves others with few enough unknowns. The rest is matched by augmenting paths,
!> each found by a breadth-first search, so that as many unknowns as possible have a chain (a maximum matching; Hopcroft and
!> Karp in docs/reference/bibliography.md).
module mech9_chain_matching
  implicit none
  private
  public :: loop_lists_type, match_chains

  !> The unknowns of each chain's loop, one list behind the other.
  type :: loop_lists_type
    integer :: n_chains = 0               !< number of chains
    integer :: n_unknowns = 0             !< number of unknowns
    integer, allocatable :: first(:)      !< (n_chains+1): the loop of chain c is unknowns(first(c):first(c+1)-1)
    integer, allocatable :: unknowns(:)   !< numbers of the unknowns, loop after loop
  end type loop_lists_type

contains

  !> The chain that determines each unknown, 0 for none.
  subroutine match_chains(loops, offers, owner)
    type(loop_lists_type), intent(in) :: loops   !< the unknowns on the loop of each chain
    integer, intent(in) :: offers(:)      !< (n_chains) equations of each chain
    integer, intent(out) :: owner(:)   !< (n_unknowns) chain that determines each unknown; 0 if none
    type(loop_lists_type) :: passing
    integer :: free(loops%n_chains), c, i

    owner = 0
    passing = chains_through(loops)
    call take_alone(loops, passing, offers, owner, free)
    do c = 1, loops%n_chains
      do i = loops%first(c), loops%first(c + 1) - 1
        if (free(c) == 0) exit
        if (owner(loops%unknowns(i)) /= 0) cycle
        owner(loops%unknowns(i)) = c
        free(c) = free(c) - 1
      end do
    end do
    call augment(loops, passing, owner, free)
  end subroutine match_chains

  !> The chains whose loops pass through each unknown: lists with chains and unknowns exchanged.
  pure function chains_through(loops) result(passing)
    type(loop_lists_type), intent(in) :: loops   !< the unknowns on the loop of each chain
    type(loop_lists_type) :: passing
    integer :: place(loops%n_unknowns + 1), c, i, u

    passing%n_chains = loops%n_unknowns
    passing%n_unknowns = loops%n_chains
    allocate (passing%first(loops%n_unknowns + 1), source=0)
    allocate (passing%unknowns(size(loops%unknowns)))
    passing%first(1) = 1
    do i = 1, size(loops%unknowns)
      passing%first(loops%unknowns(i) + 1) = passing%first(loops%unknowns(i) + 1) + 1
    end do
    do u = 1, loops%n_unknowns
      passing%first(u + 1) = passing%first(u) + passing%first(u + 1)
    end do
    place = passing%first
    do c = 1, loops%n_chains
      do i = loops%first(c), loops%first(c + 1) - 1
        u = loops%unknowns(i)
        passing%unknowns(place(u)) = c
        place(u) = place(u) + 1
      end do
    end do
  end function chains_through

  !> Assign to each chain that can determine all unknowns of its loop those unknowns, until there is no such chain.
  subroutine take_alone(loops, passing, offers, owner, free)
    type(loop_lists_type), intent(in) :: loops   !< the unknowns on the loop of each chain
    type(loop_lists_type), intent(in) :: passing   !< the chains whose loops pass through each unknown
    integer, intent(in) :: offers(:)   !< (n_chains) number of equations of each chain
    integer, intent(inout) :: owner(:)   !< (n_unknowns) chain that determines each unknown; 0 if none
    integer, intent(out) :: free(:)       !< equations that are left to each chain
    integer :: unknown(loops%n_chains), queue(loops%n_chains), head, tail, c, i, j, u
    logical :: queued(loops%n_chains)

    free = offers
    queued = .false.
    tail = 0
    do c = 1, loops%n_chains
      unknown(c) = loops%first(c + 1) - loops%first(c)
      if (unknown(c) <= offers(c)) call append(c)
    end do
    head = 0
    do while (head < tail)
      head = head + 1
      c = queue(head)
      do i = loops%first(c), loops%first(c + 1) - 1
        u = loops%unknowns(i)
        if (owner(u) /= 0) cycle
        owner(u) = c
        do j = passing%first(u), passing%first(u + 1) - 1
          unknown(passing%unknowns(j)) = unknown(passing%unknowns(j)) - 1
          if (unknown(passing%unknowns(j)) <= offers(passing%unknowns(j))) call append(passing%unknowns(j))
        end do
      end do
      free(c) = 0
    end do

  contains

    !> Put a chain into the queue once.
    subroutine append(chain)
      integer, intent(in) :: chain   !< number of the chain

      if (queued(chain)) return
      queued(chain) = .true.
      tail = tail + 1
      queue(tail) = chain
    end subroutine append
  end subroutine take_alone

  !> Match the unknowns that have no chain by exchanges along augmenting paths, where there are any. The search is
  !> breadth-first; a chain from which no path was found is not searched again, because it never has one later.
  subroutine augment(loops, passing, owner, free)
    type(loop_lists_type), intent(in) :: loops   !< the unknowns on the loop of each chain
    type(loop_lists_type), intent(in) :: passing   !< the chains whose loops pass through each unknown
    integer, intent(inout) :: owner(:)   !< (n_unknowns) chain that determines each unknown; 0 if none
    integer, intent(inout) :: free(:)   !< (n_chains) number of equations that are left to each chain
    integer :: queue(loops%n_chains), predecessor(loops%n_chains), head, tail, u, i, c
    logical :: seen(loops%n_chains), found

    seen = .false.
    do u = 1, loops%n_unknowns
      if (owner(u) /= 0) cycle
      head = 0
      tail = 0
      call visit(u)
      do while (head < tail .and. .not. found)
        head = head + 1
        c = queue(head)
        do i = loops%first(c), loops%first(c + 1) - 1
          if (owner(loops%unknowns(i)) == c) call visit(loops%unknowns(i))
          if (found) exit
        end do
      end do
      if (.not. found) cycle
      call exchange(queue(tail), predecessor, owner, free)
      seen(queue(:tail)) = .false.
    end do

  contains

    !> Add all chains through an unknown to the search, and stop at one with an equation left.
    subroutine visit(unknown)
      integer, intent(in) :: unknown   !< number of the unknown
      integer :: j, chain

      found = .false.
      do j = passing%first(unknown), passing%first(unknown + 1) - 1
        chain = passing%unknowns(j)
        if (seen(chain)) cycle
        seen(chain) = .true.
        tail = tail + 1
        queue(tail) = chain
        predecessor(chain) = unknown
        found = free(chain) > 0
        if (found) return
      end do
    end subroutine visit
  end subroutine augment

  !> Along a path that ends at a chain with an equation left, each unknown moves to the next chain.
  pure subroutine exchange(last, predecessor, owner, free)
    integer, intent(in) :: last   !< chain at the end of the augmenting path
    integer, intent(in) :: predecessor(:)  !< (n_chains) the unknown from which the search came to each chain
    integer, intent(inout) :: owner(:)   !< (n_unknowns) chain that determines each unknown; 0 if none
    integer, intent(inout) :: free(:)   !< (n_chains) number of equations that are left to each chain
    integer :: c, before

    free(last) = free(last) - 1
    c = last
    do while (c /= 0)
      before = owner(predecessor(c))
      owner(predecessor(c)) = c
      c = before
    end do
  end subroutine exchange
end module mech9_chain_matching
