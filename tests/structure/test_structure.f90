!> The first set of structural data: good data are taken, and each kind of bad data is found, named and
!> placed, with nothing found twice.
module test_structure
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type, finding_type, structure_from_matrix, structure_from_pairs, &
    check_pair_links
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Fig. 1 of the paper, pairs 1 to 7.
  integer, parameter :: fig_1(2, 7) = reshape([1, 6, 5, 6, 3, 5, 2, 3, 1, 2, 1, 4, 3, 4], [2, 7])

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('good_data')) call good_data(tester)
    if (tester%runs('bad_matrices')) call bad_matrices(tester)
    if (tester%runs('bad_pairs')) call bad_pairs(tester)
    if (tester%runs('bad_independent')) call bad_independent(tester)
    if (tester%runs('disagreeing_pairs')) call disagreeing_pairs(tester)
  end subroutine run

  !> The matrix of pairs, by (7).
  function matrix_of(n, links) result(c)
    integer, intent(in) :: n             !< links
    integer, intent(in) :: links(:, :)   !< (2,m) links of each pair
    integer :: c(n, n), k

    c = 0
    do k = 1, size(links, 2)
      c(links(1, k), links(2, k)) = k
      c(links(2, k), links(1, k)) = k
    end do
  end function matrix_of

  subroutine good_data(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)
    logical, parameter :: only_5(7) = [.false., .false., .false., .false., .true., .false., .false.]

    call structure_from_matrix(matrix_of(6, fig_1), 7, [5], structure, independent, findings)
    call tester%is_true(size(findings) == 0, 'the matrix of Fig. 1 is good')
    call tester%is_true(structure%n_links == 6 .and. structure%n_coordinates == 7, 'Fig. 1 has 6 links and 7 coordinates')
    call tester%is_true(all(structure%links == reshape([1, 6, 5, 6, 3, 5, 2, 3, 1, 2, 1, 4, 3, 4], [2, 7])), &
                        'the pairs of Fig. 1 join the links of the figure')
    call tester%is_true(all(independent .eqv. only_5), 'coordinate 5 of Fig. 1 is the independent one')
    call structure_from_pairs(6, fig_1, [5], structure, independent, findings)
    call tester%is_true(size(findings) == 0 .and. all(structure%links == fig_1), 'the pairs of Fig. 1 are good')
    call structure_from_pairs(2, reshape([1, 2, 2, 1], [2, 2]), [integer ::], structure, independent, findings)
    call tester%is_true(size(findings) == 0, &
                        'two pairs between the same links, and no independent coordinate, are good')
  end subroutine good_data

  !> Exactly one finding, with this name, this place, and this text in it.
  subroutine one_finding(tester, findings, name, index_, text, why)
    type(tester_type), intent(inout) :: tester      !< counts the checks
    type(finding_type), intent(in) :: findings(:)   !< of the check
    character(len=*), intent(in) :: name            !< of the wrong data
    character(len=*), intent(in) :: text            !< part of the message
    character(len=*), intent(in) :: why             !< the statement that is checked, printed where it is wrong
    integer, intent(in) :: index_(2)                !< the place of the mistake in them
    integer :: i

    call tester%is_true(size(findings) == 1, why//': there is one finding, not '//to_text(size(findings)))
    do i = 1, size(findings)
      if (size(findings) > 1) print '(2a)', '  ', findings(i)%message
    end do
    if (size(findings) == 0) return
    call tester%is_true(findings(1)%name == name, &
                        why//': the finding names '//name//', not '//trim(findings(1)%name))
    call tester%is_true(all(findings(1)%index == index_), &
                        why//': the finding tells the right place, not '//to_text(findings(1)%index))
    call tester%is_true(index(findings(1)%message, text) > 0, &
                        why//': the message holds the right part, and is: '//findings(1)%message)
  end subroutine one_finding

  subroutine bad_matrices(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)
    integer :: c(6, 6)

    c = matrix_of(6, fig_1)
    call structure_from_matrix(c(:, :5), 7, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [0, 0], '6 rows and 5 columns', 'not square')
    c(4, 1) = 0
    call structure_from_matrix(c, 7, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [4, 1], 'c(1,4) = 6, but c(4,1) = 0', 'an element forgotten')
    c(4, 1) = 7
    call structure_from_matrix(c, 7, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [4, 1], 'not symmetric', 'not symmetric by another number')
    c = matrix_of(6, fig_1)
    c(3, 3) = 2
    call structure_from_matrix(c, 7, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [3, 3], 'c(3,3) = 2', 'diagonal')
    c = matrix_of(6, fig_1)
    c(5, 2) = 4
    c(2, 5) = 4
    call structure_from_matrix(c, 7, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [2, 5], 'coordinate 4 is repeated', 'repeated')
    c(5, 2) = 8
    c(2, 5) = 8
    call structure_from_matrix(c, 7, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [2, 5], 'c(2,5) = 8', 'out of range')
    c(5, 2) = -1
    c(2, 5) = -1
    call structure_from_matrix(c, 7, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [2, 5], 'c(2,5) = -1', 'negative')
    c = matrix_of(6, fig_1)
    call structure_from_matrix(c, 8, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [0, 0], 'coordinate 8 is missing', 'one missing')
    call structure_from_matrix(c, 9, [5], structure, independent, findings)
    call one_finding(tester, findings, 'c', [0, 0], 'coordinates 8, 9 are missing', 'two missing')
    c = matrix_of(6, reshape([1, 2, 2, 3, 3, 1, 4, 5, 5, 6, 6, 4], [2, 6]))
    call structure_from_matrix(c, 6, [1], structure, independent, findings)
    call one_finding(tester, findings, 'c', [0, 0], 'links 4, 5, 6 are not connected to link 1', 'two parts')
    c = matrix_of(6, fig_1)
    c(1, 1) = 1
    c(6, 6) = 1
    c(3, 1) = 5
    call structure_from_matrix(c, 8, [0, 5, 5], structure, independent, findings)
    call tester%is_true(size(findings) == 6, 'six faults at once give six findings')
    call structure_from_matrix(reshape([0], [1, 1]), 1, [integer ::], structure, independent, findings)
    call tester%is_true(size(findings) == 2, &
                        'a single link has two findings: there are too few links, and its coordinate is missing')
    call structure_from_matrix(reshape([integer ::], [0, 0]), 0, [integer ::], structure, independent, findings)
    call tester%is_true(size(findings) == 2, 'a structure without links and coordinates has two findings')
  end subroutine bad_matrices

  subroutine bad_pairs(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)
    integer :: links(2, 7), long_links(2, 19), i

    links = fig_1
    links(2, 7) = 7
    call structure_from_pairs(6, links, [5], structure, independent, findings)
    call one_finding(tester, findings, 'links', [7, 2], 'pair 7 names link 7', 'link out of range')
    links(2, 7) = 3
    call structure_from_pairs(6, links, [5], structure, independent, findings)
    call one_finding(tester, findings, 'links', [7, 2], 'pair 7 joins link 3 to itself', 'both links the same')
    links(:, 7) = [0, -3]
    call structure_from_pairs(6, links, [5], structure, independent, findings)
    call tester%is_true(size(findings) == 2, 'two wrong links of one pair are two findings')
    call structure_from_pairs(7, fig_1, [5], structure, independent, findings)
    call one_finding(tester, findings, 'links', [0, 0], 'link 7 is not connected to link 1', 'a loose link')
    do i = 1, 19
      long_links(:, i) = [i + 1, i + 2]
    end do
    call structure_from_pairs(21, long_links, [1], structure, independent, findings)
    call one_finding(tester, findings, 'links', [0, 0], 'links 2, 3, 4, 5, 6, 7, 8, 9 and 12 more are not', &
                     'a long list is shortened')
    call structure_from_pairs(huge(1), fig_1, [5], structure, independent, findings)
    call one_finding(tester, findings, 'links', [0, 0], 'cannot all be connected by 7 pairs', &
                     'a mistyped number of links')
    call structure_from_pairs(2, reshape([integer ::], [2, 0]), [integer ::], structure, independent, findings)
    call tester%is_true(size(findings) == 2, 'a structure without pairs has two findings: there are no pairs, and link 2 is loose')
  end subroutine bad_pairs

  subroutine bad_independent(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)

    call structure_from_pairs(6, fig_1, [5, 6, 5], structure, independent, findings)
    call one_finding(tester, findings, 'cq', [3, 0], 'coordinate 5 twice', 'cq repeated')
    call structure_from_pairs(6, fig_1, [5, 8], structure, independent, findings)
    call one_finding(tester, findings, 'cq', [2, 0], 'coordinate 8', 'cq too large')
    call structure_from_matrix(matrix_of(6, fig_1), 7, [0], structure, independent, findings)
    call one_finding(tester, findings, 'cq', [1, 0], 'coordinate 0', 'cq too small')
  end subroutine bad_independent

  subroutine disagreeing_pairs(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(finding_type), allocatable :: findings(:)
    integer :: links(2, 7)

    call structure_from_pairs(6, fig_1, [5], structure, independent, findings)
    call check_pair_links(structure, fig_1(2:1:-1, :), findings)
    call tester%is_true(size(findings) == 0, 'the order of the links of a pair is free')
    links = fig_1
    links(2, 3) = 6
    call check_pair_links(structure, links, findings)
    call one_finding(tester, findings, 'links', [3, 0], 'pair 3', 'a pair against the structural data')
  end subroutine disagreeing_pairs
end module test_structure
