!> The transformation of the first set into the second one: the paper's Fig. 1, the rules taken
!> literally, and the definitions of the vectors on random structures of many kinds.
module test_transformation
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type, finding_type, structure_from_matrix, structure_from_pairs
  use mech9_structural_vectors, only: structural_vectors_type, chain_type, chains_of, structure_from_vectors
  use mech9_transformation, only: transform
  use mech9_testing, only: tester_type
  use random_structures, only: random_structure, n_kinds, kind_names
  use literal_transformation, only: transform_literally
  use vector_definition, only: what_is_wrong
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('fig_1')) call fig_1(tester)
    if (tester%runs('small_cases')) call small_cases(tester)
    if (tester%runs('follows_rules')) call follows_rules(tester)
    if (tester%runs('holds_definitions')) call holds_definitions(tester)
  end subroutine run

  !> Transform pairs with the links l(1),l(2), l(3),l(4), ...; they must be good data.
  subroutine transform_pairs(tester, n, l, cq, vectors)
    type(tester_type), intent(inout) :: tester              !< counts the checks
    integer, intent(in) :: n                                !< links
    integer, intent(in) :: l(:)                             !< two links for each pair, in the order of the coordinates
    integer, intent(in) :: cq(:)                            !< independent coordinates
    type(structural_vectors_type), intent(out) :: vectors   !< of the second set
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)

    call structure_from_pairs(n, reshape(l, [2, size(l)/2]), cq, structure, independent, findings)
    call tester%is_true(size(findings) == 0, 'good pairs have no findings')
    call transform(structure, independent, vectors)
    call tester%is_true(what_is_wrong(structure, independent, vectors) == '', 'the vectors of good pairs are as defined')
  end subroutine transform_pairs

  subroutine fig_1(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: c(6, 6) = reshape([0, 5, 0, 6, 0, 1, 5, 0, 4, 0, 0, 0, 0, 4, 0, 7, 3, 0, &
                                             6, 0, 7, 0, 0, 0, 0, 0, 3, 0, 0, 2, 1, 0, 0, 0, 2, 0], [6, 6])
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)
    type(structural_vectors_type) :: vectors
    type(chain_type) :: chains(2)

    call structure_from_matrix(c, 7, [5], structure, independent, findings)
    call tester%is_true(size(findings) == 0, 'Fig. 1 has no findings')
    call transform(structure, independent, vectors)
    call tester%is_true(same(vectors%nrg, [1, 2, 3, 4, 1, 1, 6, 5, 3]), 'nrg of Fig. 1 is as printed')
    call tester%is_true(same(vectors%nws, [0, 5, 4, 7, 6, 0, 1, 2, 3]), 'nws of Fig. 1 is as printed')
    call tester%is_true(same(vectors%rdw, [1, 1, 0, 0, 0, 1, 0, 0, 0]), 'rdw of Fig. 1 is as printed')
    call tester%is_true(same(vectors%nrw, [0, 0, 0, 0, 1, 1, 1, 1, 2]), &
                        'nrw of Fig. 1 is as defined: link 1 at position 5 closes the first chain')
    call tester%is_true(count(vectors%nws == 0) == 2, 'Fig. 1 has two chains')
    chains = chains_of(vectors)
    call tester%is_true(all(chains%closed), 'both chains of Fig. 1 are closed')
    call tester%is_true(all(chains%start == 1) .and. all(chains%first == [2, 7]) .and. all(chains%last == [5, 9]), &
                        'the chains of Fig. 1 stand where nws is not 0')
  end subroutine fig_1

  !> Cases worked out by hand from the rules.
  subroutine small_cases(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structural_vectors_type) :: vectors

    call transform_pairs(tester, 2, [2, 1], [1], vectors)
    call tester%is_true(same(vectors%nrg, [1, 2]) .and. same(vectors%nws, [0, 1]), 'one pair makes one open chain')

    call transform_pairs(tester, 2, [1, 2, 1, 2, 2, 1], [2], vectors)
    call tester%is_true(same(vectors%nrg, [1, 2, 1, 1, 2]) .and. same(vectors%nws, [0, 2, 1, 0, 3]), &
                        'three pairs between two links make a chain of two of them, then a chain of one')

    call transform_pairs(tester, 5, [2, 1, 2, 3, 3, 4, 4, 5, 5, 3], [1, 2], vectors)
    call tester%is_true(same(vectors%nrg, [1, 2, 3, 4, 5, 3]) .and. same(vectors%nws, [0, 1, 2, 3, 4, 5]), &
                        'a ring at the end of two bridges is one chain that closes on itself')
    call tester%is_true(same(vectors%nrw, [0, 0, 0, 0, 0, 1]), 'a ring at the end of two bridges counts one closure')

    call transform_pairs(tester, 6, [1, 2, 2, 3, 3, 4, 4, 3, 2, 5, 5, 6, 6, 5], [1, 2, 5], vectors)
    call tester%is_true(same(vectors%nrg, [1, 2, 3, 4, 3, 2, 5, 6, 5]), &
                        'of two rings equally far over bridges, the one by the lesser coordinate comes first')
    call transform_pairs(tester, 6, [1, 2, 2, 3, 3, 4, 4, 3, 2, 5, 5, 6, 6, 5], [1, 5], vectors)
    call tester%is_true(same(vectors%nrg, [1, 2, 5, 6, 5, 2, 3, 4, 3]), &
                        'of two rings over bridges, the one with fewer dependent coordinates on the way comes first')

    call transform_pairs(tester, 5, [1, 2, 2, 3, 1, 4, 4, 5], [4], vectors)
    call tester%is_true(same(vectors%nrg, [1, 2, 3, 1, 4, 5]) .and. same(vectors%nws, [0, 1, 2, 0, 3, 4]), &
                        'open chains are ordered by the least coordinate at their start')
    call transform_pairs(tester, 5, [1, 2, 2, 3, 1, 4, 4, 5], [3], vectors)
    call tester%is_true(same(vectors%nrg, [1, 4, 5, 1, 2, 3]), &
                        'an open chain that starts with an independent coordinate comes first')

    ! both rings have three dependent coordinates, the second one is longer by an independent one
    call transform_pairs(tester, 6, [1, 2, 2, 3, 3, 1, 1, 4, 4, 5, 5, 6, 6, 1], [7], vectors)
    call tester%is_true(same(vectors%nws, [0, 1, 2, 3, 0, 7, 6, 5, 4]), &
                        'the chain with the fewest coordinates comes first and starts at its end with the independent coordinate')
  end subroutine small_cases

  !> The rules taken literally give the same on small structures.
  subroutine follows_rules(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(structural_vectors_type) :: vectors, literal
    integer :: kind, seed, n
    logical :: equal

    do kind = 1, n_kinds
      do seed = 1, 150
        n = 3 + mod(seed, 6)
        if (kind_names(kind) == 'dense') n = min(n, 6)   ! the chains to be written down grow like factorials
        call random_structure(kind, n, seed, structure, independent)
        call transform(structure, independent, vectors)
        call transform_literally(structure, independent, literal)
        equal = same(vectors%nrg, literal%nrg) .and. same(vectors%nws, literal%nws) .and. &
                same(vectors%rdw, literal%rdw) .and. same(vectors%nrw, literal%nrw)
        call tester%is_true(equal, 'the rules taken literally give the same vectors: '//named(kind, n, seed))
      end do
    end do
  end subroutine follows_rules

  !> The definitions hold, and the vectors give their structure back.
  subroutine holds_definitions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structure_type) :: structure, back
    logical, allocatable :: independent(:), by_rdw(:)
    type(structural_vectors_type) :: vectors
    type(finding_type), allocatable :: findings(:)
    character(len=:), allocatable :: wrong
    integer, parameter :: sizes(7) = [4, 7, 12, 30, 100, 400, 1500]
    integer :: kind, seed, n

    do kind = 1, n_kinds
      do seed = 1, 70
        n = sizes(1 + mod(seed, size(sizes)))
        call random_structure(kind, n, 1000 + seed, structure, independent)
        call transform(structure, independent, vectors)
        wrong = what_is_wrong(structure, independent, vectors)
        call tester%is_true(wrong == '', 'the vectors are as defined: '//named(kind, n, seed)//': '//wrong)
        call structure_from_vectors(vectors, back, by_rdw, findings)
        call tester%is_true(size(findings) == 0, 'the vectors are accepted as data: '//named(kind, n, seed))
        if (size(findings) > 0) cycle
        call tester%is_true(same_structure(structure, back) .and. all(by_rdw .eqv. independent), &
                            'the vectors give the structure back: '//named(kind, n, seed))
      end do
    end do
  end subroutine holds_definitions

  logical function same_structure(a, b)
    type(structure_type), intent(in) :: a   !< first structure
    type(structure_type), intent(in) :: b   !< second structure

    same_structure = a%n_links == b%n_links .and. a%n_coordinates == b%n_coordinates
    if (.not. same_structure) return
    same_structure = all(minval(a%links, 1) == minval(b%links, 1)) .and. &
                     all(maxval(a%links, 1) == maxval(b%links, 1))
  end function same_structure

  logical function same(a, b)
    integer, intent(in) :: a(:)   !< first vector
    integer, intent(in) :: b(:)   !< second vector

    same = size(a) == size(b)
    if (same) same = all(a == b)
  end function same

  function named(kind, n, seed) result(text)
    integer, intent(in) :: kind   !< of the random structure
    integer, intent(in) :: n      !< its links, about
    integer, intent(in) :: seed   !< of its random numbers
    character(len=:), allocatable :: text

    text = trim(kind_names(kind))//', '//to_text(n)//' links, seed '//to_text(seed)
  end function named
end module test_transformation
