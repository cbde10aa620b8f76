!> The structure of a mechanism is the two links of each pair. With the independent coordinates it is the paper's first set
!> of data; (7), (8).
!>
!> It is held sparsely, as two links a pair: the coincidence matrix C itself is only read.
module mech9_structure
  use mech9_text, only: to_text, some_of
  use mech9_masks, only: numbers_of
  use mech9_finding, only: finding_type, finding_list_type, longest_list
  use mech9_compound_joint, only: compound_joint_type
  implicit none
  private
  public :: structure_type, finding_type
  public :: structure_from_pairs, structure_from_matrix, check_pair_links

  !> Links and pairs. Pair k has coordinate k.
  type :: structure_type
    integer :: n_links = 0                   !< N, with link 1 the frame
    integer :: n_coordinates = 0             !< M, as many as pairs
    integer, allocatable :: links(:, :)      !< (2,M) the two links of each pair
    !> Joints with several freedoms, whose pairs and inner links are among those above; not allocated where there is none.
    type(compound_joint_type), allocatable :: joints(:)
  contains
    procedure :: shown_links
    procedure :: joint_of
    procedure :: joint_of_link
    procedure :: first_of_joint
    procedure :: stands_alone
  end type structure_type

contains

  !> Number of the links that the user knows: they come first, and the links of joints after them.
  pure integer function shown_links(self)
    class(structure_type), intent(in) :: self   !< the structure

    shown_links = self%n_links
    if (allocated(self%joints)) shown_links = self%n_links - sum(self%joints%freedoms - 1)
  end function shown_links

  !> Number of the joint to which a coordinate belongs; 0 where its pair is no part of a joint with several freedoms.
  pure integer function joint_of(self, coordinate) result(joint)
    class(structure_type), intent(in) :: self   !< the structure
    integer, intent(in) :: coordinate           !< number of the coordinate

    joint = 0
    if (.not. allocated(self%joints)) return
    do joint = size(self%joints), 1, -1
      associate (j => self%joints(joint))
        if (any(j%numbers(:j%freedoms) == coordinate)) return
      end associate
    end do
  end function joint_of

  !> Number of the joint to which a link belongs; 0 for a link that the user knows.
  pure integer function joint_of_link(self, link) result(joint)
    class(structure_type), intent(in) :: self   !< the structure
    integer, intent(in) :: link                 !< number of the link

    joint = 0
    if (.not. allocated(self%joints)) return
    do joint = size(self%joints), 1, -1
      associate (j => self%joints(joint))
        if (link > j%before_inner .and. link < j%before_inner + j%freedoms) return
      end associate
    end do
  end function joint_of_link

  !> The first coordinate of the joint to which a coordinate belongs; the coordinate itself where its pair is no part of one.
  pure integer function first_of_joint(self, coordinate) result(first)
    class(structure_type), intent(in) :: self   !< the structure
    integer, intent(in) :: coordinate           !< number of the coordinate
    integer :: joint

    first = coordinate
    joint = self%joint_of(coordinate)
    if (joint > 0) first = self%joints(joint)%numbers(1)
  end function first_of_joint

  !> Whether each coordinate stands for a whole joint, being the only one or the first of it.
  pure function stands_alone(self)
    class(structure_type), intent(in) :: self   !< the structure
    logical :: stands_alone(self%n_coordinates)
    integer :: j

    stands_alone = .true.
    if (.not. allocated(self%joints)) return
    do j = 1, size(self%joints)
      stands_alone(self%joints(j)%numbers(2:self%joints(j)%freedoms)) = .false.
    end do
  end function stands_alone

  !> Structure from the links of each pair. Two pairs may join the same two links.
  pure subroutine structure_from_pairs(n_links, links, cq, structure, independent, findings)
    integer, intent(in) :: n_links                  !< N
    integer, intent(in) :: links(:, :)  !< (2,M) links of pair k in column k; 0 where another coordinate of its joint stands for it
    integer, intent(in) :: cq(:)                    !< independent coordinates
    type(structure_type), intent(out) :: structure  !< of use only without findings
    logical, allocatable, intent(out) :: independent(:)           !< (M) the coordinate is independent
    type(finding_type), allocatable, intent(out) :: findings(:)   !< size 0: all is well
    type(finding_list_type) :: list

    structure%n_links = n_links
    structure%n_coordinates = size(links, 2)
    structure%links = links
    call check_counts(n_links, size(links, 2), 'links', list)
    call check_link_numbers(n_links, links, list)
    call check_connected(n_links, links, 'links', list)
    call take_independent(cq, structure%n_coordinates, independent, list)
    call list%hand_over(findings)
  end subroutine structure_from_pairs

  !> Structure from the coincidence matrix (7). It cannot express two pairs between the same links.
  pure subroutine structure_from_matrix(c, n_coordinates, cq, structure, independent, findings, inner)
    integer, intent(in) :: c(:, :)                  !< c(i,j) = c(j,i) = k where pair k joins links i and j
    integer, intent(in) :: n_coordinates            !< M
    integer, intent(in) :: cq(:)                    !< independent coordinates
    type(structure_type), intent(out) :: structure  !< of use only without findings
    logical, allocatable, intent(out) :: independent(:)           !< (M) the coordinate is independent
    type(finding_type), allocatable, intent(out) :: findings(:)   !< size 0: all is well
    logical, intent(in), optional :: inner(:)   !< (M) another coordinate of its joint stands for it in C
    type(finding_list_type) :: list
    integer :: n
    logical :: is_inner(max(n_coordinates, 0))

    n = size(c, 1)
    structure%n_links = n
    structure%n_coordinates = max(n_coordinates, 0)
    allocate (structure%links(2, structure%n_coordinates), source=0)
    if (size(c, 2) /= n) then
      call list%add('c', [0, 0], 'C has '//to_text(n)//' rows and '//to_text(size(c, 2))// &
                    ' columns; it must have a row and a column for each link')
    else
      call check_counts(n, n_coordinates, 'c', list)
      call check_diagonal(c, list)
      call check_symmetry(c, list)
      is_inner = .false.
      if (present(inner)) is_inner = inner
      call take_links(c, structure%links, is_inner, list)
      call check_connected(n, joined_in_matrix(c), 'c', list)
    end if
    call take_independent(cq, structure%n_coordinates, independent, list)
    call list%hand_over(findings)
  end subroutine structure_from_matrix

  !> Compare the links that the pairs themselves name with those of a structure from other data.
  pure subroutine check_pair_links(structure, links, findings)
    type(structure_type), intent(in) :: structure                 !< the structure, from the first or the second set of data
    integer, intent(in) :: links(:, :)                            !< (2,M) links of pair k in column k
    type(finding_type), allocatable, intent(out) :: findings(:)   !< size 0: all is well
    type(finding_list_type) :: list
    integer :: k

    do k = 1, min(structure%n_coordinates, size(links, 2))
      associate (ours => structure%links(:, k), theirs => links(:, k))
        if (minval(ours) == minval(theirs) .and. maxval(ours) == maxval(theirs)) cycle
        call list%add('links', [k, 0], 'pair '//to_text(k)//' is said to join links '// &
                      to_text(theirs(1))//' and '//to_text(theirs(2))//', but the structural data join links '// &
                      to_text(ours(1))//' and '//to_text(ours(2))//' by it; correct one of them')
      end associate
    end do
    call list%hand_over(findings)
  end subroutine check_pair_links

  !> Note too few links or pairs.
  pure subroutine check_counts(n_links, n_coordinates, name, list)
    integer, intent(in) :: n_links                   !< N
    integer, intent(in) :: n_coordinates             !< M
    character(len=*), intent(in) :: name             !< name of the data for the finding: 'links' or 'c'
    type(finding_list_type), intent(inout) :: list   !< gets the findings

    if (n_links < 2) call list%add(name, [0, 0], 'a mechanism has at least two links (link 1 is the frame), not '// &
                                   to_text(n_links))
    if (n_coordinates < 1) call list%add(name, [0, 0], 'a mechanism has at least one pair, and a coordinate for it')
  end subroutine check_counts

  !> Note links that do not exist, and pairs of a link with itself.
  pure subroutine check_link_numbers(n_links, links, list)
    integer, intent(in) :: n_links                   !< N
    integer, intent(in) :: links(:, :)               !< (2,M) links of pair k in column k
    type(finding_list_type), intent(inout) :: list   !< gets the findings
    integer :: i, k

    do k = 1, size(links, 2)
      if (all(links(:, k) == 0)) cycle          ! another coordinate of its joint stands for it
      do i = 1, 2
        if (links(i, k) < 1 .or. links(i, k) > n_links) &
          call list%add('links', [k, i], 'pair '//to_text(k)//' names link '//to_text(links(i, k))// &
                        '; the links are 1 to '//to_text(n_links))
      end do
      if (links(1, k) == links(2, k)) &
        call list%add('links', [k, 2], 'pair '//to_text(k)//' joins link '//to_text(links(1, k))// &
                      ' to itself; a pair joins two different links')
    end do
  end subroutine check_link_numbers

  !> Note the links that no sequence of pairs joins to the frame.
  !> Pairs with wrong link numbers join nothing; they have a finding of their own.
  pure subroutine check_connected(n_links, links, name, list)
    integer, intent(in) :: n_links                   !< N
    integer, intent(in) :: links(:, :)               !< (2,M) links of pair k in column k
    character(len=*), intent(in) :: name             !< name of the data for the finding: 'links' or 'c'
    type(finding_list_type), intent(inout) :: list   !< gets the findings
    integer, allocatable :: group(:), apart(:)
    integer :: i, k, a, b

    if (n_links > 2*size(links, 2) + 1000) then
      ! the count is most likely mistyped: so many links are not listed
      call list%add(name, [0, 0], to_text(n_links)//' links cannot all be connected by '// &
                    to_text(size(links, 2))//' pairs')
      return
    end if
    allocate (group(max(n_links, 0)))
    do i = 1, n_links
      group(i) = i
    end do
    do k = 1, size(links, 2)
      if (any(links(:, k) < 1 .or. links(:, k) > n_links)) cycle
      call find_group(group, links(1, k), a)
      call find_group(group, links(2, k), b)
      group(max(a, b)) = min(a, b)
    end do
    do i = 1, n_links
      call find_group(group, i, a)
    end do
    apart = numbers_of(group /= 1)
    if (size(apart) == 1) then
      call list%add(name, [0, 0], 'link '//some_of(apart, longest_list)//' is not connected to link 1 (the frame); '// &
                    'give a pair that joins it')
    else if (size(apart) > 1) then
      call list%add(name, [0, 0], 'links '//some_of(apart, longest_list)//' are not connected to link 1 (the frame); '// &
                    'give pairs that join them')
    end if
  end subroutine check_connected

  !> The least link of a link's group; the path to it is halved for the next search (union-find).
  pure subroutine find_group(group, link, least)
    integer, intent(inout) :: group(:)   !< (N) a link of the same group, no greater than the link itself; shortened
    integer, intent(in) :: link          !< number of the link
    integer, intent(out) :: least        !< the least link of its group

    least = link
    do while (group(least) /= least)
      group(least) = group(group(least))
      least = group(least)
    end do
    group(link) = least
  end subroutine find_group

  !> Note numbers on the diagonal of C.
  pure subroutine check_diagonal(c, list)
    integer, intent(in) :: c(:, :)                   !< (N,N) the coincidence matrix
    type(finding_list_type), intent(inout) :: list   !< gets the findings
    integer :: i

    do i = 1, size(c, 1)
      if (c(i, i) /= 0) call list%add('c', [i, i], trim(entry_text(c, i, i))// &
                                      ' is on the diagonal and must be 0: no pair joins a link to itself')
    end do
  end subroutine check_diagonal

  !> Note numbers of C that differ from those on the other side of the diagonal.
  pure subroutine check_symmetry(c, list)
    integer, intent(in) :: c(:, :)                   !< (N,N) the coincidence matrix
    type(finding_list_type), intent(inout) :: list   !< gets the findings
    integer :: i, j

    do i = 2, size(c, 1)
      do j = 1, i - 1
        if (c(i, j) /= c(j, i)) &
          call list%add('c', [i, j], 'C is not symmetric: '//trim(entry_text(c, j, i))//', but '//trim(entry_text(c, i, j)))
      end do
    end do
  end subroutine check_symmetry

  !> Links of each coordinate, with findings for numbers out of range, repeated or missing.
  !> A number counts as present but not as repeated where C is not symmetric, so that one error makes one finding.
  pure subroutine take_links(c, links, is_inner, list)
    integer, intent(in) :: c(:, :)                   !< (N,N) the coincidence matrix
    integer, intent(inout) :: links(:, :)            !< (2,M) zeros on entry
    logical, intent(in) :: is_inner(:)               !< (M) another coordinate of its joint stands for it in C
    type(finding_list_type), intent(inout) :: list   !< gets the findings
    integer :: i, j, k, m
    logical :: present_in_c(size(links, 2))
    integer, allocatable :: missing(:)

    m = size(links, 2)
    present_in_c = .false.
    do i = 1, size(c, 1)
      do j = 1, size(c, 1)
        k = c(i, j)
        if (k == 0 .or. i == j) cycle
        if (k < 0 .or. k > m) then
          if (j > i .or. c(j, i) /= k) &
            call list%add('c', [i, j], trim(entry_text(c, i, j))//' is no number of a coordinate; they are 1 to '//to_text(m))
          cycle
        end if
        present_in_c(k) = .true.
        if (is_inner(k)) then
          if (j > i) call list%add('c', [i, j], trim(entry_text(c, i, j))//': a joint with several coordinates stands in C by '// &
                                   'the first of them; leave the others out')
          cycle
        end if
        if (j < i .or. c(j, i) /= k) cycle
        if (links(1, k) == 0) then
          links(:, k) = [i, j]
        else
          call list%add('c', [i, j], 'coordinate '//to_text(k)//' is repeated: it joins links '// &
                        to_text(links(1, k))//' and '//to_text(links(2, k))//' already, and '// &
                        to_text(i)//' and '//to_text(j)//' again')
        end if
      end do
    end do
    missing = numbers_of(.not. (present_in_c .or. is_inner))
    if (size(missing) == 1) then
      call list%add('c', [0, 0], 'coordinate '//some_of(missing, longest_list)//' is missing in C')
    else if (size(missing) > 1) then
      call list%add('c', [0, 0], 'coordinates '//some_of(missing, longest_list)//' are missing in C')
    end if
  end subroutine take_links

  !> Links that C joins by any number, right or wrong, in either half.
  pure function joined_in_matrix(c) result(links)
    integer, intent(in) :: c(:, :)   !< (N,N) the coincidence matrix, right or wrong
    integer, allocatable :: links(:, :)
    integer :: i, j, n

    allocate (links(2, count(c /= 0)))
    n = 0
    do j = 1, size(c, 2)
      do i = 1, size(c, 1)
        if (c(i, j) == 0) cycle
        n = n + 1
        links(:, n) = [i, j]
      end do
    end do
  end function joined_in_matrix

  !> Mark the independent coordinates, and note numbers that do not exist or are repeated.
  pure subroutine take_independent(cq, n_coordinates, independent, list)
    integer, intent(in) :: cq(:)                          !< independent coordinates
    integer, intent(in) :: n_coordinates                  !< M
    logical, allocatable, intent(out) :: independent(:)   !< (M) the coordinate is independent
    type(finding_list_type), intent(inout) :: list        !< gets the findings
    integer :: i

    allocate (independent(n_coordinates), source=.false.)
    do i = 1, size(cq)
      if (cq(i) < 1 .or. cq(i) > n_coordinates) then
        call list%add('cq', [i, 0], 'cq names coordinate '//to_text(cq(i))//'; the coordinates are 1 to '// &
                      to_text(n_coordinates))
      else if (independent(cq(i))) then
        call list%add('cq', [i, 0], 'cq names coordinate '//to_text(cq(i))//' twice; name each one once')
      else
        independent(cq(i)) = .true.
      end if
    end do
  end subroutine take_independent

  !> An element of C as text, such as "c(2,3) = 4".
  pure function entry_text(c, i, j) result(text)
    integer, intent(in) :: c(:, :)   !< (N,N) the coincidence matrix
    integer, intent(in) :: i         !< row
    integer, intent(in) :: j         !< column
    character(len=48) :: text

    text = 'c('//to_text(i)//','//to_text(j)//') = '//to_text(c(i, j))
  end function entry_text
end module mech9_structure
