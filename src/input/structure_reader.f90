!> The structure of a mechanism from a checked document: first set, second set, or the links of the pairs. Each error is
!> reported at the number that causes it.
module mech9_structure_reader
  use mech9_error, only: exit_structure
  use mech9_text, only: to_text, some_of
  use mech9_masks, only: numbers_of
  use mech9_source, only: span_type
  use mech9_finding, only: finding_type, longest_list
  use mech9_structure, only: structure_type, structure_from_pairs, structure_from_matrix, check_pair_links
  use mech9_structural_vectors, only: structural_vectors_type, structure_from_vectors
  use mech9_transformation, only: transform
  use mech9_partition, only: partition_type, free_coordinate, dependent_coordinate
  use mech9_compound_joint, only: compound_joint_type
  use mech9_joint_expansion, only: expand_structure, expand_vectors, inner_coordinates
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_unsound, has_name, get_integer, get_integers, span_of, find_item
  use mech9_matrix_items, only: matrix_type, read_matrix
  use mech9_joint_reader, only: read_joints, coordinates_of, coordinate_span
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_structure

  !> The data on the structure, gathered from all groups.
  type :: source_data_type
    type(group_type) :: structure  !< the group &structure, empty where there is none
    integer :: n_links = 0         !< number of links by &mechanism; 0: not given
    integer :: n_coordinates = 0
    type(span_type) :: n_links_span, n_coordinates_span
    integer, allocatable :: pairs(:)  !< numbers of the sound groups &pair
    logical :: all_pairs = .false.    !< whether no pair has an error
    logical :: count_is_known = .true.   !< the number of coordinates does not depend on pairs that have errors
    type(matrix_type) :: matrix
    type(compound_joint_type), allocatable :: joints(:)   !< joints with several freedoms, without numbers of their own links
    !> (2,M) links of each coordinate's pair; 0 where it has none, or where the first coordinate of its joint stands for it.
    integer, allocatable :: links(:, :)
    integer, allocatable :: group_of_pair(:)  !< (M) number of each coordinate's group &pair; 0 where it has none
  end type source_data_type

contains

  !> Read the structure and the order of computation; where the file does not give the order, it is computed.
  !> `known` is false where an error was reported that leaves the structure unknown.
  pure subroutine read_structure(document, structure, partition, known, diagnostics)
    type(document_type), intent(in) :: document            !< the checked document
    type(structure_type), intent(out) :: structure         !< links of each coordinate
    type(partition_type), intent(out) :: partition         !< kinds of the coordinates, none driven, and the order of computation
    logical, intent(out) :: known                          !< whether no error leaves the structure unknown
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    type(source_data_type) :: data
    logical, allocatable :: independent(:)
    integer :: found
    logical :: has_vectors

    known = .false.
    found = diagnostics%count
    if (has_unsound(document, 'mechanism') .or. has_unsound(document, 'structure')) return
    call gather(document, data)
    has_vectors = any([has_name(data%structure, 'nrg'), has_name(data%structure, 'nws'), &
                       has_name(data%structure, 'rdw'), has_name(data%structure, 'nrw')])
    if (.not. has_vectors .and. .not. has_name(data%structure, 'cq')) &
      call diagnostics%add(data%structure%span, 'nothing tells the independent coordinates: give &structure cq = ... '// &
                           '(or nrg, nws and rdw)')
    if (has_name(data%structure, 'c')) then
      call from_matrix(document, data, structure, independent, diagnostics)
    else if (.not. has_vectors) then
      call from_pairs(document, data, structure, independent, known, diagnostics)
      if (.not. known) return
    end if
    if (has_vectors) call from_vectors(document, data, structure, independent, partition%vectors, diagnostics)
    known = diagnostics%count == found
    if (.not. known) return
    call compare_with_pairs(document, data, structure, diagnostics)
    known = diagnostics%count == found
    if (.not. known) return
    if (size(data%joints) > 0) call expand_structure(data%joints, structure)
    if (.not. has_vectors) then
      call transform(structure, independent, partition%vectors)
    else if (size(data%joints) > 0) then
      call expand_vectors(structure, independent, partition%vectors)
    end if
    partition%kind = merge(free_coordinate, dependent_coordinate, independent)
  end subroutine read_structure

  !> Collect the data on the structure from all groups.
  pure subroutine gather(document, data)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    type(source_data_type), intent(out) :: data  !< the data on the structure, gathered from all groups
    integer, allocatable :: numbers(:)

    data%structure%name = 'structure'
    allocate (data%structure%items(0))
    numbers = groups_named(document, 'structure')
    if (size(numbers) > 0) data%structure = document%groups(numbers(1))
    numbers = groups_named(document, 'mechanism')
    if (size(numbers) > 0) then
      associate (group => document%groups(numbers(1)))
        data%n_links_span = span_of(group, 'links', 1)
        data%n_coordinates_span = span_of(group, 'coordinates', 1)
        if (has_name(group, 'links')) data%n_links = get_integer(group, 'links')
        if (has_name(group, 'coordinates')) data%n_coordinates = get_integer(group, 'coordinates')
      end associate
    end if
    data%pairs = groups_named(document, 'pair')
    data%all_pairs = .not. has_unsound(document, 'pair')
    call read_joints(document, data%joints)
  end subroutine gather

  !> Make the structure from the coincidence matrix.
  pure subroutine from_matrix(document, data, structure, independent, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(source_data_type), intent(inout) :: data         !< the data on the structure, gathered from all groups
    type(structure_type), intent(inout) :: structure      !< links of each coordinate
    logical, allocatable, intent(inout) :: independent(:) !< (M) the coordinate is independent
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(finding_type), allocatable :: findings(:)
    integer :: m, n, most
    logical :: ok

    call read_matrix(data%structure, data%n_links, data%matrix, ok, diagnostics)
    if (.not. ok) return
    n = size(data%matrix%c, 1)
    m = data%n_coordinates
    if (m == 0) m = max(maxval(data%matrix%c), 0, greatest_of_joints(data))
    most = n*(n - 1)/2 + sum(data%joints%freedoms - 1)
    if (m > most) then
      call diagnostics%add(data%n_coordinates_span, 'a matrix c of '//to_text(n)//' links holds at most '// &
                           to_text(most)//' coordinates, not '//to_text(m), exit_structure)
      return
    end if
    call structure_from_matrix(data%matrix%c, m, cq_of(data), structure, independent, findings, &
                               inner_coordinates(data%joints, m))
    call report(findings, document, data, diagnostics)
  end subroutine from_matrix

  !> The greatest coordinate of a joint with several freedoms; 0 where there is none.
  pure integer function greatest_of_joints(data) result(greatest)
    type(source_data_type), intent(in) :: data  !< the data on the structure, gathered from all groups
    integer :: j

    greatest = 0
    do j = 1, size(data%joints)
      greatest = max(greatest, maxval(data%joints(j)%numbers))
    end do
  end function greatest_of_joints

  !> Make the structure from the links of the pairs.
  pure subroutine from_pairs(document, data, structure, independent, known, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(source_data_type), intent(inout) :: data         !< the data on the structure, gathered from all groups
    type(structure_type), intent(inout) :: structure      !< links of each coordinate
    logical, allocatable, intent(inout) :: independent(:) !< (M) the coordinate is independent
    logical, intent(out) :: known                         !< whether no error leaves the structure unknown
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(finding_type), allocatable :: findings(:)
    integer :: n

    known = .false.
    if (size(data%pairs) == 0 .and. data%all_pairs) then
      call diagnostics%add(span_type(), 'nothing says which links meet: give &structure c and cq, or nrg, nws and rdw, '// &
                           'or &pair groups', exit_structure)
      return
    end if
    n = data%n_coordinates
    data%count_is_known = n > 0 .or. data%all_pairs
    if (n == 0) n = size(data%pairs) + sum(data%joints%freedoms - 1)
    call take_pairs(document, n, data, diagnostics)
    if (.not. data%all_pairs .or. any(data%group_of_pair == 0)) return
    n = data%n_links
    if (n == 0) n = min(maxval(data%links), size(data%pairs) + 1)
    call structure_from_pairs(n, data%links, cq_of(data), structure, independent, findings)
    call report(findings, document, data, diagnostics)
    known = size(findings) == 0
  end subroutine from_pairs

  !> Make the structure from the structural vectors, and compare it with the other data.
  pure subroutine from_vectors(document, data, structure, independent, vectors, diagnostics)
    type(document_type), intent(in) :: document              !< the data file as groups and items
    type(source_data_type), intent(in) :: data               !< the data on the structure, gathered from all groups
    type(structure_type), intent(inout) :: structure         !< the structure by the first set, where it is given
    logical, allocatable, intent(inout) :: independent(:)    !< (M) the coordinate is independent
    type(structural_vectors_type), intent(inout) :: vectors  !< structural vectors: links in the order of computation, and so on
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the errors
    type(structure_type) :: second
    logical, allocatable :: by_rdw(:)
    type(finding_type), allocatable :: findings(:)
    integer, allocatable :: n, m      ! not allocated where not given
    logical :: has_first
    integer :: greatest

    has_first = allocated(structure%links)
    vectors%nrg = get_integers(data%structure, 'nrg')
    vectors%nws = get_integers(data%structure, 'nws')
    vectors%rdw = get_integers(data%structure, 'rdw')
    vectors%nrw = get_integers(data%structure, 'nrw')
    if (data%n_links > 0) n = data%n_links
    if (data%n_coordinates > 0) m = data%n_coordinates
    if (size(data%joints) > 0) then
      greatest = min(max(data%n_coordinates, maxval([0, vectors%nws]), greatest_of_joints(data)), &
                     size(vectors%nrg) + sum(data%joints%freedoms))
      call structure_from_vectors(vectors, second, by_rdw, findings, n, m, inner_coordinates(data%joints, greatest))
    else
      call structure_from_vectors(vectors, second, by_rdw, findings, n, m)
    end if
    call report(findings, document, data, diagnostics)
    if (size(findings) > 0) return
    call settle_joints(data, by_rdw, diagnostics)
    if (has_first) then
      call compare_sets(data, structure, second, by_rdw, diagnostics)
    else
      call compare_independent(data, cq_of(data), by_rdw, diagnostics)
      structure = second
    end if
    independent = by_rdw
  end subroutine from_vectors

  !> Set which coordinates of joints with several freedoms are independent: cq tells them, and rdw alone only where all are.
  pure subroutine settle_joints(data, by_rdw, diagnostics)
    type(source_data_type), intent(in) :: data            !< the data on the structure, gathered from all groups
    logical, intent(inout) :: by_rdw(:)  !< (M) independent by rdw; of a joint only its first coordinate, then all of them
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: cq(:), k(:)
    integer :: i, j

    cq = cq_of(data)
    do j = 1, size(data%joints)
      k = data%joints(j)%coordinates()
      if (any(k > size(by_rdw))) cycle          ! reported with the pairs
      if (by_rdw(k(1)) .and. .not. has_name(data%structure, 'cq')) then
        by_rdw(k) = .true.
      else if (.not. has_name(data%structure, 'cq')) then
        call diagnostics%add(span_of(data%structure, 'rdw', findloc_value(data, k(1))), 'rdw is 0 for the '// &
                             trim(data%joints(j)%kind)//' joint of coordinates '//to_text(k)//'; give cq too, which tells '// &
                             'whether any of them is independent', exit_structure)
      else if (by_rdw(k(1)) .neqv. all([(any(cq == k(i)), i=1, size(k))])) then
        call diagnostics%add(span_of(data%structure, 'rdw', findloc_value(data, k(1))), 'cq and rdw disagree about the '// &
                             trim(data%joints(j)%kind)//' joint of coordinates '//to_text(k)//': rdw is 1 where cq names '// &
                             'all of them, else 0', exit_structure)
        by_rdw(k) = [(any(cq == k(i)), i=1, size(k))]
      else
        by_rdw(k) = [(any(cq == k(i)), i=1, size(k))]
      end if
    end do
  end subroutine settle_joints

  !> The independent coordinates; none where cq is not given.
  pure function cq_of(data) result(cq)
    type(source_data_type), intent(in) :: data  !< the data on the structure, gathered from all groups
    integer, allocatable :: cq(:)

    cq = get_integers(data%structure, 'cq')
  end function cq_of

  !> First and second set must describe the same structure.
  pure subroutine compare_sets(data, first, second, by_rdw, diagnostics)
    type(source_data_type), intent(in) :: data            !< the data on the structure, gathered from all groups
    type(structure_type), intent(in) :: first             !< the structure by the matrix c or the pairs
    type(structure_type), intent(in) :: second            !< the structure by nrg and nws
    logical, intent(in) :: by_rdw(:)                      !< (M) the coordinate is independent by rdw
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(finding_type), allocatable :: findings(:)
    integer :: i

    if (first%n_links /= second%n_links .or. first%n_coordinates /= second%n_coordinates) then
      call diagnostics%add(span_of(data%structure, 'nrg'), 'first and second set disagree: c has '// &
                           to_text(first%n_links)//' links and '//to_text(first%n_coordinates)//' coordinates, nrg and nws '// &
                           to_text(second%n_links)//' and '//to_text(second%n_coordinates), exit_structure)
      return
    end if
    call check_pair_links(first, second%links, findings)
    do i = 1, size(findings)
      call diagnostics%add(span_of(data%structure, 'nws', findloc_value(data, findings(i)%index(1))), &
                           'first and second set disagree: '//findings(i)%message, exit_structure)
    end do
    if (has_name(data%structure, 'cq')) call compare_independent(data, cq_of(data), by_rdw, diagnostics)
  end subroutine compare_sets

  !> The position of a coordinate in nws.
  pure integer function findloc_value(data, coordinate) result(position)
    type(source_data_type), intent(in) :: data  !< the data on the structure, gathered from all groups
    integer, intent(in) :: coordinate           !< number of the coordinate

    position = findloc(get_integers(data%structure, 'nws'), coordinate, dim=1)
  end function findloc_value

  !> Report contradictions between cq and the second set about independent coordinates.
  pure subroutine compare_independent(data, cq, by_rdw, diagnostics)
    type(source_data_type), intent(in) :: data            !< the data on the structure, gathered from all groups
    integer, intent(in) :: cq(:)                          !< numbers of the independent coordinates
    logical, intent(in) :: by_rdw(:)                      !< (M) the coordinate is independent by rdw
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: k
    logical :: in_cq

    if (.not. has_name(data%structure, 'cq')) return
    do k = 1, size(by_rdw)
      in_cq = any(cq == k)
      if (in_cq .eqv. by_rdw(k)) cycle
      call diagnostics%add(span_of(data%structure, 'rdw', findloc_value(data, k)), 'cq and rdw disagree about coordinate '// &
                           to_text(k)//': by cq it is '//trim(kind_word(in_cq))//', by rdw '// &
                           trim(kind_word(.not. in_cq)), exit_structure)
    end do
    do k = 1, size(cq)
      if (cq(k) > size(by_rdw)) &
        call diagnostics%add(span_of(data%structure, 'cq', k), 'cq names coordinate '//to_text(cq(k))// &
                             '; the coordinates are 1 to '//to_text(size(by_rdw)), exit_structure)
    end do
  end subroutine compare_independent


  !> The pairs must agree with a structure that does not come from them, one for each coordinate.
  pure subroutine compare_with_pairs(document, data, structure, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(source_data_type), intent(inout) :: data         !< the data on the structure, gathered from all groups
    type(structure_type), intent(in) :: structure         !< links of each coordinate
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(finding_type), allocatable :: findings(:)
    integer, allocatable :: links(:, :)
    integer :: k

    if (allocated(data%links)) return                   ! the structure was made from the pairs themselves
    if (size(data%pairs) == 0) return
    call take_pairs(document, structure%n_coordinates, data, diagnostics)
    links = data%links
    do k = 1, size(links, 2)
      if (data%group_of_pair(k) == 0) links(:, k) = structure%links(:, k)
    end do
    call check_pair_links(structure, links, findings)
    call report(findings, document, data, diagnostics)
  end subroutine compare_with_pairs

  !> Take the links of the pairs by coordinate; report coordinates without a pair and pairs of coordinates that do not exist.
  pure subroutine take_pairs(document, n_coordinates, data, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: n_coordinates                  !< how many coordinates the pairs should have
    type(source_data_type), intent(inout) :: data         !< the data on the structure, gathered from all groups
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: missing(:), coordinates(:)
    integer :: i, j, k, m

    m = n_coordinates
    if (m > 10*(size(data%pairs) + sum(data%joints%freedoms)) + 1000) then
      call diagnostics%add(data%n_coordinates_span, to_text(m)//' coordinates need as many pairs, and there are '// &
                           to_text(size(data%pairs)), exit_structure)
      m = size(data%pairs)
    end if
    allocate (data%links(2, m), source=0)
    allocate (data%group_of_pair(m), source=0)
    do i = 1, size(data%pairs)
      associate (group => document%groups(data%pairs(i)))
        coordinates = coordinates_of(group)
        do j = 1, size(coordinates)
          k = coordinates(j)
          if (k > m) then
            if (data%count_is_known) call diagnostics%add(coordinate_span(group, j), 'there is no coordinate '//to_text(k)// &
                                 '; they are 1 to '//to_text(m), exit_structure)
          else
            if (j == 1) data%links(:, k) = get_integers(group, 'links')
            data%group_of_pair(k) = data%pairs(i)
          end if
        end do
      end associate
    end do
    if (.not. data%all_pairs .or. m /= n_coordinates) return
    missing = numbers_of(data%group_of_pair == 0)
    if (size(missing) > 0) &
      call diagnostics%add(data%n_coordinates_span, 'no &pair is given for coordinate'// &
                           trim(merge('s', ' ', size(missing) > 1))//' '//some_of(missing, longest_list), exit_structure)
  end subroutine take_pairs

  !> The kind of a coordinate in words, padded with a blank.
  pure function kind_word(independent) result(word)
    logical, intent(in) :: independent  !< whether the coordinate is independent
    character(len=11) :: word

    word = merge('independent', 'dependent  ', independent)
  end function kind_word

  !> Report findings of the structure floor at the numbers that cause them.
  pure subroutine report(findings, document, data, diagnostics)
    type(finding_type), intent(in) :: findings(:)         !< errors that the structure floor found
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(source_data_type), intent(in) :: data            !< the data on the structure, gathered from all groups
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i

    do i = 1, size(findings)
      call diagnostics%add(span_of_finding(findings(i), document, data), findings(i)%message, exit_structure)
    end do
  end subroutine report

  !> The place of the number that causes an error.
  pure type(span_type) function span_of_finding(finding, document, data) result(span)
    type(finding_type), intent(in) :: finding    !< an error that the structure floor found
    type(document_type), intent(in) :: document  !< the data file as groups and items
    type(source_data_type), intent(in) :: data   !< the data on the structure, gathered from all groups

    span = data%structure%span
    associate (i => finding%index(1), j => finding%index(2))
      if (finding%name == 'links') then
        if (i > 0) then
          span = span_of(document%groups(data%group_of_pair(i)), 'links', j)
        else if (data%n_links > 0) then
          span = data%n_links_span
        end if
        return
      end if
      if (find_item(data%structure, trim(finding%name)) > 0) span = span_of(data%structure, trim(finding%name), i)
      if (finding%name == 'c' .and. i > 0) then
        if (data%matrix%spans(i, j)%source > 0) span = data%matrix%spans(i, j)
      else if (finding%name == 'c') then
        span = span_of(data%structure, 'c')
      end if
    end associate
  end function span_of_finding
end module mech9_structure_reader
