!> Whether vectors describe a structure, straight from the definitions of the paper's chapter 2 and the least length (9).
module vector_definition
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type
  implicit none
  private
  public :: what_is_wrong

contains

  !> The first thing that is wrong, or nothing.
  function what_is_wrong(structure, independent, vectors) result(text)
    type(structure_type), intent(in) :: structure          !< from which the vectors come
    logical, intent(in) :: independent(:)   !< (M) the coordinate is independent
    type(structural_vectors_type), intent(in) :: vectors   !< vectors that are held against the definitions
    character(len=:), allocatable :: text
    logical :: known(structure%n_links), used(structure%n_coordinates)
    logical :: closes, over
    integer :: i, n, closures

    n = size(vectors%nrg)
    text = ''
    if (any([size(vectors%nws), size(vectors%rdw), size(vectors%nrw)] /= n)) text = 'lengths differ'
    if (n /= least_length(structure)) text = 'length '//to_text(n)//', not '//to_text(least_length(structure))
    if (text == '') then
      if (any([vectors%nrg(1), vectors%nws(1), vectors%rdw(1), vectors%nrw(1)] /= [1, 0, 1, 0])) text = 'head'
    end if
    if (text /= '') return
    known = .false.
    known(1) = .true.
    used = .false.
    over = .false.       ! has a closure just ended the chain?
    closures = 0
    do i = 2, n
      associate (link => vectors%nrg(i), k => vectors%nws(i))
        closes = .false.
        if (k == 0) then
          if (.not. known(link)) text = 'starts at an unknown link'
          if (vectors%rdw(i) /= 1) text = 'rdw at a start'
          if (vectors%nws(i - 1) == 0) text = 'a chain without steps'
        else
          if (over) text = 'goes on after a closure'
          if (used(k)) text = 'a pair twice'
          used(k) = .true.
          if (all([link, vectors%nrg(i - 1)] /= structure%links(1, k)) .or. &
              all([link, vectors%nrg(i - 1)] /= structure%links(2, k))) text = 'a pair between other links'
          if (vectors%rdw(i) /= merge(1, 0, independent(k))) text = 'rdw'
          closes = known(link)
          known(link) = .true.
        end if
        if (closes) closures = closures + 1
        if (vectors%nrw(i) /= closures) text = 'nrw'
        over = closes
      end associate
      if (text /= '') text = text//' at position '//to_text(i)
      if (text /= '') return
    end do
    if (.not. all(known)) text = 'a link is missing'
    if (.not. all(used)) text = 'a pair is missing'
  end function what_is_wrong

  !> N + 2 L1 + L2 - 1. Every pair beyond the N - 1 that reach the links closes a chain, and a leaf (a
  !> link of one pair) can only be the end of an open one, so there are at least as many.
  integer function least_length(structure)
    type(structure_type), intent(in) :: structure   !< the structure
    integer :: pairs_of(structure%n_links), k, i, l1, l2

    pairs_of = 0
    do k = 1, structure%n_coordinates
      do i = 1, 2
        pairs_of(structure%links(i, k)) = pairs_of(structure%links(i, k)) + 1
      end do
    end do
    l1 = structure%n_coordinates - structure%n_links + 1
    l2 = count(pairs_of(2:) == 1)
    least_length = structure%n_links + 2*l1 + l2 - 1
  end function least_length
end module vector_definition
