!> Matching of unknowns to chains, and strong components, on small random graphs against exhaustive search.
module test_graphs
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_chain_matching, only: loop_lists_type, match_chains
  use mech9_strong_components, only: graph_type, strong_components
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_graphs')) call random_graphs(test)
  end subroutine run

  subroutine random_graphs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i
    type(random_type) :: random

    do i = 1, 400
      call try_matching(test, random, 1 + modulo(i, 8), 1 + modulo(5*i, 23))
      call try_components(test, random, 1 + modulo(i, 13))
    end do
  end subroutine random_graphs

  subroutine try_matching(test, random, n_chains, n_unknowns)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: n_chains              !< closed chains
    integer, intent(in) :: n_unknowns            !< unknown coordinates
    logical :: passes(n_chains, n_unknowns)
    integer :: offers(n_chains), owner(n_unknowns), c, u
    logical :: allowed
    type(loop_lists_type) :: loops

    do c = 1, n_chains
      offers(c) = int(3.5_wp + 3.0_wp*random%symmetric())
      do u = 1, n_unknowns
        passes(c, u) = random%symmetric() > 0.3_wp
      end do
    end do
    loops%n_chains = n_chains
    loops%n_unknowns = n_unknowns
    allocate (loops%first(n_chains + 1), loops%unknowns(count(passes)))
    loops%first(1) = 1
    do c = 1, n_chains
      loops%first(c + 1) = loops%first(c) + count(passes(c, :))
      loops%unknowns(loops%first(c):loops%first(c + 1) - 1) = pack([(u, u=1, n_unknowns)], passes(c, :))
    end do
    call match_chains(loops, offers, owner)
    allowed = .true.
    do u = 1, n_unknowns
      if (owner(u) > 0) allowed = allowed .and. passes(owner(u), u)
    end do
    do c = 1, n_chains
      allowed = allowed .and. count(owner == c) <= offers(c)
    end do
    call test%is_true(allowed, 'unknowns go to chains that pass through them, and to none too many')
    call test%is_true(count(owner > 0) == most_matched(passes, offers), 'as many unknowns as possible are matched')
  end subroutine try_matching

  !> The largest flow is the least cut: over all sets of chains, what these offer and what others reach.
  pure integer function most_matched(passes, offers) result(most)
    logical, intent(in) :: passes(:, :)   !< (chain,unknown) the unknown occurs in the chain
    integer, intent(in) :: offers(:)      !< equations of each chain
    logical :: in_set(size(offers))
    integer :: set, c

    most = size(passes, 2)
    do set = 0, 2**size(offers) - 1
      in_set = [(btest(set, c - 1), c=1, size(offers))]
      most = min(most, sum(pack(offers, in_set)) + &
                 count(any(passes .and. spread(.not. in_set, 2, size(passes, 2)), dim=1)))
    end do
  end function most_matched

  subroutine try_components(test, random, n)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: n                     !< nodes
    logical :: leads(n, n), reaches(n, n)
    integer :: component(n), n_components, i, j, k
    type(graph_type) :: graph
    logical :: right

    do j = 1, n
      do i = 1, n
        leads(i, j) = random%symmetric() > 1.0_wp - 3.0_wp/n
      end do
    end do
    graph%n = n
    allocate (graph%first(n + 1), graph%heads(count(leads)))
    graph%first(1) = 1
    do i = 1, n
      graph%first(i + 1) = graph%first(i) + count(leads(i, :))
      graph%heads(graph%first(i):graph%first(i + 1) - 1) = pack([(j, j=1, n)], leads(i, :))
    end do
    call strong_components(graph, [(i, i=n, 1, -1)], component, n_components)
    reaches = leads
    do i = 1, n
      reaches(i, i) = .true.
    end do
    do k = 1, n
      do j = 1, n
        reaches(:, j) = reaches(:, j) .or. (reaches(:, k) .and. reaches(k, j))
      end do
    end do
    right = maxval(component) == n_components .and. minval(component) == 1
    do j = 1, n
      do i = 1, n
        right = right .and. ((component(i) == component(j)) .eqv. (reaches(i, j) .and. reaches(j, i)))
        if (reaches(i, j)) right = right .and. component(j) <= component(i)
      end do
    end do
    call test%is_true(right, 'components are those of mutual reach, each after those to which it leads')
  end subroutine try_components
end module test_graphs
