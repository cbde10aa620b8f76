!> The second set of structural data, the vectors nrg, nws, rdw, nrw, which hold the order in which the kinematic chains are run
!> through.
module mech9_structural_vectors
  use mech9_kinds, only: long
  use mech9_text, only: to_text, some_of
  use mech9_masks, only: numbers_of
  use mech9_finding, only: finding_type, finding_list_type, longest_list
  use mech9_structure, only: structure_type
  implicit none
  private
  public :: structural_vectors_type, chain_type
  public :: structure_from_vectors, chains_of, number_closures

  !> Position i is a step to link nrg(i) through pair nws(i), or, where nws(i) = 0, the start of a
  !> chain at the known link nrg(i).
  type :: structural_vectors_type
    integer, allocatable :: nrg(:)   !< links
    integer, allocatable :: nws(:)   !< coordinates, 0 at the start of a chain
    integer, allocatable :: rdw(:)   !< 1 where the coordinate is independent, and at starts; else 0
    integer, allocatable :: nrw(:)   !< number of closures met so far
  end type structural_vectors_type

  !> One kinematic chain in the vectors.
  type :: chain_type
    integer :: start = 0          !< the known link it starts at; it stands at position first - 1
    integer :: first = 0          !< position of its first step
    integer :: last = 0           !< position of its last step
    logical :: closed = .false.   !< its last step reaches a known link
  end type chain_type

contains

  !> Structure from the second set given as data, in any valid order and of any
  !> length. nrw may be absent (not allocated, or of size 0) and is then computed.
  pure subroutine structure_from_vectors(vectors, structure, independent, findings, n_links, n_coordinates, inner)
    type(structural_vectors_type), intent(inout) :: vectors       !< the second set of data; nrw is computed where it is absent
    type(structure_type), intent(out) :: structure                !< of use only without findings
    logical, allocatable, intent(out) :: independent(:)           !< (M) the coordinate is independent
    type(finding_type), allocatable, intent(out) :: findings(:)   !< size 0: all is well
    integer, intent(in), optional :: n_links                      !< N, where known; else the greatest link named
    integer, intent(in), optional :: n_coordinates                !< M, where known; else the greatest coordinate named
    logical, intent(in), optional :: inner(:)                     !< (M) another coordinate of its joint stands for it in nws
    type(finding_list_type) :: list
    logical, allocatable :: is_inner(:)
    integer :: n_inner

    call check_sizes(vectors, list)
    call list%hand_over(findings)
    if (size(findings) > 0) return
    ! valid vectors are longer than N and M, which keeps a mistyped number from asking for much memory
    structure%n_links = min(max(1, maxval(vectors%nrg)), size(vectors%nrg))
    structure%n_coordinates = min(max(0, maxval(vectors%nws)), size(vectors%nrg))
    n_inner = 0
    if (present(inner)) then
      n_inner = count(inner)
      structure%n_coordinates = size(inner)
    end if
    if (present(n_links)) call take_count('nrg', 'links', n_links, structure%n_links, size(vectors%nrg), list)
    if (present(n_coordinates)) &
      call take_count('nws', 'coordinates', n_coordinates, structure%n_coordinates, &
                      size(vectors%nrg) - 1 + n_inner, list)
    allocate (structure%links(2, structure%n_coordinates), source=0)
    allocate (independent(structure%n_coordinates), source=.false.)
    call check_head(vectors, list)
    allocate (is_inner(structure%n_coordinates), source=.false.)
    if (present(inner)) is_inner = inner(:structure%n_coordinates)
    call walk(vectors, structure, independent, list, is_inner)
    call check_kinds(vectors, list)
    if (size(vectors%nrw) > 0) then
      call check_closures(vectors, list)
    else
      call number_closures(vectors)
    end if
    call list%hand_over(findings)
  end subroutine structure_from_vectors

  !> The chains, in the order of the vectors, which must be valid.
  pure function chains_of(vectors) result(chains)
    type(structural_vectors_type), intent(in) :: vectors   !< valid vectors
    type(chain_type), allocatable :: chains(:)
    integer :: i, n

    allocate (chains(count(vectors%nws == 0)))
    n = 0
    do i = 1, size(vectors%nws)
      if (vectors%nws(i) == 0) then
        n = n + 1
        chains(n)%start = vectors%nrg(i)
        chains(n)%first = i + 1
      else
        chains(n)%last = i
        chains(n)%closed = vectors%nrw(i) > vectors%nrw(i - 1)
      end if
    end do
  end function chains_of

  !> Set nrw by its definition: one more at each step that reaches a known link.
  pure subroutine number_closures(vectors)
    type(structural_vectors_type), intent(inout) :: vectors   !< with nrg and nws set

    vectors%nrw = closure_numbers(vectors)
  end subroutine number_closures

  !> The vector nrw by its definition; links with impossible numbers are passed over.
  pure function closure_numbers(vectors) result(nrw)
    type(structural_vectors_type), intent(in) :: vectors   !< with nrg and nws set
    integer :: nrw(size(vectors%nrg))
    logical :: known(size(vectors%nrg))   ! as long as any valid link number needs
    integer :: i, n

    known = .false.
    n = 0
    do i = 1, size(vectors%nrg)
      associate (link => vectors%nrg(i))
        if (is_link(link, size(known))) then
          if (vectors%nws(i) /= 0 .and. known(link)) n = n + 1
          known(link) = .true.
        end if
      end associate
      nrw(i) = n
    end do
  end function closure_numbers

  !> Take a number of links or coordinates that is known from elsewhere, unless the vectors are
  !> too short for it.
  pure subroutine take_count(name, things, known, count, most, list)
    character(len=*), intent(in) :: name   !< of the vector: nrg or nws
    character(len=*), intent(in) :: things   !< word for the message: links or coordinates
    integer, intent(in) :: known   !< the number known from elsewhere
    integer, intent(inout) :: count   !< the number taken from the vectors; the known one afterwards, if it is possible
    integer, intent(in) :: most                     !< as many as vectors of this length can hold
    type(finding_list_type), intent(inout) :: list   !< gets the findings

    if (known >= 1 .and. known <= most) then
      count = known
    else
      call list%add(name, [0, 0], name//' is too short for '//to_text(known)//' '//things)
    end if
  end subroutine take_count

  !> All vectors must be there and equally long; only nrw may be absent.
  pure subroutine check_sizes(vectors, list)
    type(structural_vectors_type), intent(inout) :: vectors   !< absent ones get size 0
    type(finding_list_type), intent(inout) :: list            !< gets the findings
    integer :: n

    if (.not. allocated(vectors%nrg)) allocate (vectors%nrg(0))
    if (.not. allocated(vectors%nws)) allocate (vectors%nws(0))
    if (.not. allocated(vectors%rdw)) allocate (vectors%rdw(0))
    if (.not. allocated(vectors%nrw)) allocate (vectors%nrw(0))
    n = size(vectors%nrg)
    if (n < 2) call list%add('nrg', [0, 0], 'nrg has '//to_text(n)// &
                             ' numbers; it starts with 1, and at least one step follows')
    call check_size('nws', size(vectors%nws), n, list)
    call check_size('rdw', size(vectors%rdw), n, list)
    if (size(vectors%nrw) > 0) call check_size('nrw', size(vectors%nrw), n, list)
  end subroutine check_sizes

  !> Note a vector that is not as long as nrg.
  pure subroutine check_size(name, length, n, list)
    character(len=*), intent(in) :: name             !< of the vector
    integer, intent(in) :: length                    !< its size
    integer, intent(in) :: n                         !< size of nrg
    type(finding_list_type), intent(inout) :: list   !< gets the findings

    if (length /= n) call list%add(name, [0, 0], name//' has '//to_text(length)//' numbers and nrg '// &
                                   to_text(n)//'; they must be equally long')
  end subroutine check_size

  !> Note a wrong beginning of the vectors.
  pure subroutine check_head(vectors, list)
    type(structural_vectors_type), intent(in) :: vectors   !< the second set of data
    type(finding_list_type), intent(inout) :: list         !< gets the findings

    if (vectors%nrg(1) /= 1) call list%add('nrg', [1, 0], 'nrg starts with '//to_text(vectors%nrg(1))// &
                                           ', but must start with 1, the frame')
    if (vectors%nws(1) /= 0) call list%add('nws', [1, 0], 'nws starts with '//to_text(vectors%nws(1))// &
                                           ', but must start with 0')
    if (vectors%nws(2) == 0) call list%add('nws', [2, 0], 'nws(2) is 0, but the second position must be a step '// &
                                           'from the frame')
  end subroutine check_head

  !> Run through the chains: take links and kinds of the coordinates, and note errors.
  pure subroutine walk(vectors, structure, independent, list, is_inner)
    type(structural_vectors_type), intent(in) :: vectors   !< the second set of data
    type(structure_type), intent(inout) :: structure       !< gets the links of the coordinates
    logical, intent(inout) :: independent(:)               !< (M) gets the kinds of the coordinates
    type(finding_list_type), intent(inout) :: list         !< gets the findings
    logical, intent(in) :: is_inner(:)                     !< (M) another coordinate of its joint stands for it in nws
    logical :: known(structure%n_links), used(structure%n_coordinates)
    logical :: may_go_on       ! false after a step that closed its chain
    integer :: i

    used = is_inner
    known = .false.
    known(1) = .true.
    may_go_on = .true.
    do i = 2, size(vectors%nrg)
      if (.not. is_link(vectors%nrg(i), structure%n_links)) then
        call list%add('nrg', [i, 0], 'nrg('//to_text(i)//') = '//to_text(vectors%nrg(i))// &
                      ' is no link; the links are 1 to '//to_text(structure%n_links))
        if (vectors%nws(i) /= 0) call take_step(vectors, structure, independent, used, i, list, is_inner)
        may_go_on = .true.
      else if (vectors%nws(i) == 0) then
        call check_restart(vectors, known, i, list)
        may_go_on = .true.
      else
        if (.not. may_go_on) &
          call list%add('nws', [i, 0], 'position '//to_text(i)//' goes on after link '//to_text(vectors%nrg(i - 1))// &
                        ' has closed the chain; restart there with a known link and nws = 0')
        call take_step(vectors, structure, independent, used, i, list, is_inner)
        may_go_on = .not. known(vectors%nrg(i))
      end if
      if (is_link(vectors%nrg(i), structure%n_links)) known(vectors%nrg(i)) = .true.
    end do
    call check_complete(known, used, list)
  end subroutine walk

  !> Note a start of a chain at an unknown link, or without a step after it.
  pure subroutine check_restart(vectors, known, i, list)
    type(structural_vectors_type), intent(in) :: vectors   !< the second set of data
    logical, intent(in) :: known(:)   !< (N) links reached so far
    integer, intent(in) :: i                        !< a position with nws = 0
    type(finding_list_type), intent(inout) :: list   !< gets the findings

    if (.not. known(vectors%nrg(i))) &
      call list%add('nrg', [i, 0], 'a chain starts at link '//to_text(vectors%nrg(i))//' (position '//to_text(i)// &
                    '), which no chain before has reached; start at a known link')
    ! a start must be followed by a step: not by another start, nor by the end
    if (i < size(vectors%nws)) then
      if (vectors%nws(i + 1) /= 0) return
    end if
    call list%add('nws', [i, 0], 'the chain that starts at position '//to_text(i)//' has no step; leave it out')
  end subroutine check_restart

  !> Take links and kind of the coordinate of a step, and note an error.
  pure subroutine take_step(vectors, structure, independent, used, i, list, is_inner)
    type(structural_vectors_type), intent(in) :: vectors   !< the second set of data
    type(structure_type), intent(inout) :: structure   !< gets the links of the coordinates
    logical, intent(inout) :: independent(:)        !< (M) gets the kinds of the coordinates
    logical, intent(inout) :: used(:)               !< coordinates met so far
    integer, intent(in) :: i                        !< a position with nws /= 0
    type(finding_list_type), intent(inout) :: list   !< gets the findings
    logical, intent(in) :: is_inner(:)              !< (M) another coordinate of its joint stands for it in nws
    integer :: k

    k = vectors%nws(i)
    if (k < 1 .or. k > structure%n_coordinates) then
      call list%add('nws', [i, 0], 'nws('//to_text(i)//') = '//to_text(k)// &
                    ' is no coordinate; they are 1 to '//to_text(structure%n_coordinates))
    else if (is_inner(k)) then
      call list%add('nws', [i, 0], 'nws('//to_text(i)//') = '//to_text(k)//': a joint with several coordinates stands in nws '// &
                    'by the first of them; leave the others out')
    else if (used(k)) then
      call list%add('nws', [i, 0], 'coordinate '//to_text(k)//' is used a second time at position '//to_text(i)// &
                    '; each coordinate stands once in nws')
    else
      used(k) = .true.
      structure%links(:, k) = vectors%nrg(i - 1:i)
      independent(k) = vectors%rdw(i) == 1
    end if
    if (vectors%nrg(i) == vectors%nrg(i - 1)) &
      call list%add('nrg', [i, 0], 'position '//to_text(i)//' steps from link '//to_text(vectors%nrg(i))// &
                    ' to itself; a pair joins two different links')
  end subroutine take_step

  !> Whether there is a link of this number.
  pure logical function is_link(number, n_links)
    integer, intent(in) :: number    !< any integer
    integer, intent(in) :: n_links   !< N

    is_link = number >= 1 .and. number <= n_links
  end function is_link

  !> Every link must be reached and every coordinate used.
  pure subroutine check_complete(known, used, list)
    logical, intent(in) :: known(:)                  !< (N) links that a chain reaches
    logical, intent(in) :: used(:)                   !< (M) coordinates that stand in nws
    type(finding_list_type), intent(inout) :: list   !< gets the findings
    integer, allocatable :: missing(:)

    missing = numbers_of(.not. known)
    if (size(missing) > 0) call list%add('nrg', [0, 0], 'no chain reaches these links: '//some_of(missing, longest_list))
    missing = numbers_of(.not. used)
    if (size(missing) > 0) call list%add('nws', [0, 0], 'these coordinates are missing in nws: '//some_of(missing, longest_list))
  end subroutine check_complete

  !> Note numbers of rdw that are neither 0 nor 1, and starts of chains that are not 1.
  pure subroutine check_kinds(vectors, list)
    type(structural_vectors_type), intent(in) :: vectors   !< the second set of data
    type(finding_list_type), intent(inout) :: list         !< gets the findings
    integer :: i

    do i = 1, size(vectors%rdw)
      if (vectors%rdw(i) < 0 .or. vectors%rdw(i) > 1) then
        call list%add('rdw', [i, 0], 'rdw('//to_text(i)//') = '//to_text(vectors%rdw(i))// &
                      '; it must be 1 (independent) or 0 (dependent)')
      else if (vectors%nws(i) == 0 .and. vectors%rdw(i) /= 1) then
        call list%add('rdw', [i, 0], 'rdw('//to_text(i)//') must be 1, because a chain starts there (nws = 0)')
      end if
    end do
  end subroutine check_kinds

  !> Note wrong numbers of nrw. A number that is wrong only because an earlier one is wrong is not noted.
  pure subroutine check_closures(vectors, list)
    type(structural_vectors_type), intent(in) :: vectors   !< the second set of data
    type(finding_list_type), intent(inout) :: list         !< gets the findings
    integer :: right(size(vectors%nrg)), i

    right = closure_numbers(vectors)
    if (vectors%nrw(1) /= 0) call list%add('nrw', [1, 0], 'nrw starts with '//to_text(vectors%nrw(1))// &
                                           ', but must start with 0')
    do i = 2, size(right)
      if (vectors%nrw(i) == right(i)) cycle
      ! wide integers, so that no mistyped number overflows
      if (int(vectors%nrw(i), long) - vectors%nrw(i - 1) == right(i) - right(i - 1)) cycle
      if (right(i) > right(i - 1)) then
        call list%add('nrw', [i, 0], 'nrw must grow by one at position '//to_text(i)//', where link '// &
                      to_text(vectors%nrg(i))//' closes a chain: '//to_text(right(i))//', not '// &
                      to_text(vectors%nrw(i))//' (or leave nrw out: it is then computed)')
      else
        call list%add('nrw', [i, 0], 'nrw must not change at position '//to_text(i)//', where no chain closes: '// &
                      to_text(right(i))//', not '//to_text(vectors%nrw(i))//' (or leave nrw out: it is then computed)')
      end if
    end do
  end subroutine check_closures
end module mech9_structural_vectors
