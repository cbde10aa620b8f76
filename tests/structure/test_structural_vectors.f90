!> The second set given as data: valid ones in any order are taken, and each kind of inconsistency is
!> found, named and placed.
module test_structural_vectors
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type, finding_type
  use mech9_structural_vectors, only: structural_vectors_type, chain_type, chains_of, structure_from_vectors
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('good_vectors')) call good_vectors(tester)
    if (tester%runs('wrong_sizes')) call wrong_sizes(tester)
    if (tester%runs('wrong_numbers')) call wrong_numbers(tester)
    if (tester%runs('wrong_chains')) call wrong_chains(tester)
    if (tester%runs('wrong_closures')) call wrong_closures(tester)
  end subroutine run

  !> The second set of Fig. 1, with nrw by its definition.
  function fig_1() result(vectors)
    type(structural_vectors_type) :: vectors

    allocate (vectors%nrg, source=[1, 2, 3, 4, 1, 1, 6, 5, 3])
    allocate (vectors%nws, source=[0, 5, 4, 7, 6, 0, 1, 2, 3])
    allocate (vectors%rdw, source=[1, 1, 0, 0, 0, 1, 0, 0, 0])
    allocate (vectors%nrw, source=[0, 0, 0, 0, 1, 1, 1, 1, 2])
  end function fig_1

  function some_vectors(nrg, nws, rdw) result(vectors)
    integer, intent(in) :: nrg(:)   !< links in the order of computation
    integer, intent(in) :: nws(:)   !< coordinates that lead to them
    integer, intent(in) :: rdw(:)   !< 1 where a coordinate is independent
    type(structural_vectors_type) :: vectors

    allocate (vectors%nrg, source=nrg)
    allocate (vectors%nws, source=nws)
    allocate (vectors%rdw, source=rdw)
  end function some_vectors

  subroutine good_vectors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structural_vectors_type) :: vectors
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)
    type(chain_type) :: chains(2)

    vectors = fig_1()
    call structure_from_vectors(vectors, structure, independent, findings, n_links=6, n_coordinates=7)
    call tester%is_true(size(findings) == 0, 'the vectors of Fig. 1 are good')
    call tester%is_true(structure%n_links == 6 .and. structure%n_coordinates == 7, 'Fig. 1 has 6 links and 7 coordinates')
    call tester%is_true(all(structure%links == reshape([1, 6, 6, 5, 5, 3, 2, 3, 1, 2, 4, 1, 3, 4], [2, 7])), &
                        'the pairs of Fig. 1 join the links of the figure')
    call tester%is_true(count(independent) == 1 .and. independent(5), 'coordinate 5 of Fig. 1 is the independent one')
    deallocate (vectors%nrw)
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(size(findings) == 0 .and. all(vectors%nrw == [0, 0, 0, 0, 1, 1, 1, 1, 2]), &
                        'nrw of Fig. 1 is computed from the other vectors')
    ! not in the program's order and longer than needed: the first ring is cut into an open chain
    ! and a closed one
    vectors = some_vectors([1, 4, 3, 1, 2, 3], [0, 6, 7, 0, 5, 4], [1, 0, 0, 1, 1, 0])
    vectors%nws = [0, 4, 3, 0, 1, 2]
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(size(findings) == 0, 'vectors in another order and of a longer set are good, too')
    call tester%is_true(all(vectors%nrw == [0, 0, 0, 0, 0, 1]), 'nrw counts one closure at the end of the closed chain')
    chains = chains_of(vectors)
    call tester%is_true(.not. chains(1)%closed .and. chains(2)%closed, 'the first chain is open and the second is closed')
    call tester%is_true(all(chains%start == 1) .and. all(chains%first == [2, 5]) .and. all(chains%last == [3, 6]), &
                        'each chain has the places of its steps')
  end subroutine good_vectors

  !> Exactly one finding, with this name, place and text in it.
  subroutine one_finding(tester, vectors, name, position, text, why)
    type(tester_type), intent(inout) :: tester                !< counts the checks
    type(structural_vectors_type), intent(inout) :: vectors   !< with one mistake
    character(len=*), intent(in) :: name                      !< of the wrong vector
    character(len=*), intent(in) :: text                      !< part of the message
    character(len=*), intent(in) :: why                       !< the statement that is checked, printed where it is wrong
    integer, intent(in) :: position                           !< of the mistake in it
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)
    integer :: i

    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(size(findings) == 1, why//': there is one finding, not '//to_text(size(findings)))
    do i = 1, size(findings)
      if (size(findings) > 1) print '(2a)', '  ', findings(i)%message
    end do
    if (size(findings) == 0) return
    call tester%is_true(findings(1)%name == name, &
                        why//': the finding names '//name//', not '//trim(findings(1)%name))
    call tester%is_true(all(findings(1)%index == [position, 0]), &
                        why//': the finding tells the right place, not '//to_text(findings(1)%index))
    call tester%is_true(index(findings(1)%message, text) > 0, &
                        why//': the message holds the right part, and is: '//findings(1)%message)
  end subroutine one_finding

  subroutine wrong_sizes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structural_vectors_type) :: vectors, empty
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)

    vectors = fig_1()
    vectors%rdw = [1, 1, 0, 0, 0, 1, 0, 0]
    call one_finding(tester, vectors, 'rdw', 0, 'rdw has 8 numbers and nrg 9', 'rdw too short')
    vectors = fig_1()
    vectors%nws = [0, 5, 4, 7, 6, 0, 1, 2, 3, 3]
    call one_finding(tester, vectors, 'nws', 0, 'nws has 10 numbers and nrg 9', 'nws too long')
    vectors = fig_1()
    vectors%nrw = [0]
    call one_finding(tester, vectors, 'nrw', 0, 'nrw has 1 numbers', 'nrw too short')
    call one_finding(tester, empty, 'nrg', 0, 'nrg has 0 numbers', 'nothing at all')
    vectors = some_vectors([1], [0], [1])
    call one_finding(tester, vectors, 'nrg', 0, 'at least one step', 'only the head')
    vectors = fig_1()
    call structure_from_vectors(vectors, structure, independent, findings, n_links=20, n_coordinates=7)
    call tester%is_true(size(findings) == 1, 'vectors that are too short for the number of links have one finding')
    vectors = fig_1()
    call structure_from_vectors(vectors, structure, independent, findings, n_links=7, n_coordinates=8)
    call tester%is_true(size(findings) == 2, 'a missing link and a missing coordinate are two findings')
    vectors = fig_1()
    call structure_from_vectors(vectors, structure, independent, findings, n_links=5, n_coordinates=6)
    call tester%is_true(size(findings) == 2, 'a link too many and a coordinate too many are two findings')
  end subroutine wrong_sizes

  subroutine wrong_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structural_vectors_type) :: vectors
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)

    vectors = fig_1()
    vectors%nrg(1) = 2
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(any(findings%name == 'nrg' .and. findings%index(1) == 1), &
                        'vectors that do not begin with the frame have a finding at position 1 of nrg')
    vectors = fig_1()
    vectors%nws(1) = 3
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(any(findings%name == 'nws' .and. findings%index(1) == 1), &
                        'vectors whose first coordinate is not 0 have a finding at position 1 of nws')
    vectors = fig_1()
    vectors%rdw(3) = 2
    call one_finding(tester, vectors, 'rdw', 3, 'rdw(3) = 2', 'neither 0 nor 1')
    vectors = fig_1()
    vectors%rdw(1) = 0
    call one_finding(tester, vectors, 'rdw', 1, 'must be 1', 'the first of rdw')
    vectors = fig_1()
    vectors%rdw(6) = 0
    call one_finding(tester, vectors, 'rdw', 6, 'must be 1', 'rdw at a start')
    vectors = fig_1()
    vectors%nws(9) = 2
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(any(findings%name == 'nws' .and. findings%index(1) == 9), &
                        'a coordinate that is used twice has a finding at its second place')
    call tester%is_true(any(findings%name == 'nws' .and. findings%index(1) == 0), &
                        'a coordinate that is missing has a finding of nws')
    vectors = fig_1()
    vectors%nrg(8) = 1000000000
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(any(findings%name == 'nrg' .and. findings%index(1) == 8), 'a link out of range has a finding at its place')
    vectors = fig_1()
    vectors%nws(8) = -huge(1)
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(any(findings%name == 'nws' .and. findings%index(1) == 8), &
                        'a negative coordinate has a finding at its place')
    vectors = fig_1()
    vectors%nrw(3) = huge(1)
    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(any(findings%name == 'nrw' .and. findings%index(1) == 3), &
                        'a huge number of closures has a finding at its place')
  end subroutine wrong_numbers

  subroutine wrong_chains(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structural_vectors_type) :: vectors

    vectors = some_vectors([1, 2, 3, 1, 4, 3], [0, 1, 2, 3, 4, 5], [1, 1, 0, 0, 0, 0])
    call one_finding(tester, vectors, 'nws', 5, 'goes on after link 1 has closed', 'no restart after a closure')
    vectors = some_vectors([1, 2, 4, 3, 1], [0, 1, 0, 2, 3], [1, 1, 1, 0, 0])
    call one_finding(tester, vectors, 'nrg', 3, 'starts at link 4', 'a start at an unknown link')
    vectors = some_vectors([1, 2, 2], [0, 1, 0], [1, 1, 1])
    call one_finding(tester, vectors, 'nws', 3, 'has no step', 'a chain without steps at the end')
    vectors = some_vectors([1, 2, 2, 1, 3], [0, 1, 0, 0, 2], [1, 1, 1, 1, 1])
    call one_finding(tester, vectors, 'nws', 3, 'has no step', 'a chain without steps in between')
    vectors = some_vectors([1, 1, 2], [0, 0, 1], [1, 1, 1])
    call one_finding(tester, vectors, 'nws', 2, 'must be a step', 'a first chain without steps')
    vectors = some_vectors([1, 2, 2, 3], [0, 1, 2, 3], [1, 1, 0, 0])
    call check_self_step(tester, vectors)
  end subroutine wrong_chains

  subroutine check_self_step(tester, vectors)
    type(tester_type), intent(inout) :: tester                !< counts the checks
    type(structural_vectors_type), intent(inout) :: vectors   !< good ones, which are changed
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)

    call structure_from_vectors(vectors, structure, independent, findings)
    call tester%is_true(any(findings%name == 'nrg' .and. findings%index(1) == 3), &
                        'a step from a link to itself has a finding at its place')
  end subroutine check_self_step

  subroutine wrong_closures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structural_vectors_type) :: vectors

    vectors = fig_1()
    vectors%nrw = [0, 0, 0, 0, 0, 1, 1, 1, 2]
    call one_finding(tester, vectors, 'nrw', 5, 'must grow by one at position 5', 'nrw as misprinted')
    vectors%nrw = [0, 0, 0, 0, 0, 0, 0, 0, 1]
    call one_finding(tester, vectors, 'nrw', 5, 'must grow by one at position 5', 'a closure not counted')
    vectors%nrw = [0, 0, 1, 1, 2, 2, 2, 2, 3]
    call one_finding(tester, vectors, 'nrw', 3, 'must not change at position 3', 'one closure too many')
    vectors%nrw = [1, 1, 1, 1, 2, 2, 2, 2, 3]
    call one_finding(tester, vectors, 'nrw', 1, 'must start with 0', 'nrw starting with 1')
  end subroutine wrong_closures
end module test_structural_vectors
