!> The expansion of joints with several freedoms into chains of pairs, in the structure and in the structural vectors, and the
!> way back, for people.
!>
!> In the user's structure the first coordinate of a joint stands for all of it, and the others have no links.
module mech9_joint_expansion
  use mech9_compound_joint, only: compound_joint_type
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type, number_closures
  implicit none
  private
  public :: expand_structure, expand_vectors, shown_vectors, inner_coordinates

contains

  !> Whether each coordinate is one of a joint, but not the first of it. Numbers that do not exist are passed over.
  pure function inner_coordinates(joints, n_coordinates) result(inner)
    type(compound_joint_type), intent(in) :: joints(:)   !< the joints
    integer, intent(in) :: n_coordinates                 !< M
    logical :: inner(n_coordinates)
    integer :: i, j

    inner = .false.
    do j = 1, size(joints)
      do i = 2, joints(j)%freedoms
        associate (k => joints(j)%numbers(i))
          if (k >= 1 .and. k <= n_coordinates) inner(k) = .true.
        end associate
      end do
    end do
  end function inner_coordinates

  !> Replace each joint by its chain: give numbers to its inner links, and links to its coordinates.
  pure subroutine expand_structure(joints, structure)
    type(compound_joint_type), intent(in) :: joints(:)    !< the joints, without numbers of their inner links
    type(structure_type), intent(inout) :: structure      !< of the user; then with the chains of the joints
    integer :: i, j

    structure%joints = joints
    do j = 1, size(joints)
      associate (joint => structure%joints(j))
        joint%before_inner = structure%n_links
        structure%n_links = structure%n_links + joint%freedoms - 1
        do i = 1, joint%freedoms
          structure%links(:, joint%numbers(i)) = joint%links_of_pair(i)
        end do
      end associate
    end do
  end subroutine expand_structure

  !> Replace each step over a joint by the steps of its chain.
  pure subroutine expand_vectors(structure, independent, vectors)
    type(structure_type), intent(in) :: structure            !< with the chains of the joints
    logical, intent(in) :: independent(:)                    !< (M) the coordinate is independent
    type(structural_vectors_type), intent(inout) :: vectors  !< of the user; then with the chains of the joints
    type(structural_vectors_type) :: longer
    integer :: i, j, n, length

    length = size(vectors%nrg) + sum(structure%joints%freedoms - 1)
    allocate (longer%nrg(length), longer%nws(length), longer%rdw(length), source=1)
    n = 0
    do i = 1, size(vectors%nrg)
      j = 0
      if (vectors%nws(i) > 0) j = structure%joint_of(vectors%nws(i))
      if (j > 0) then
        call walk_joint(structure%joints(j), vectors%nrg(i), independent, longer, n)
      else
        n = n + 1
        longer%nrg(n) = vectors%nrg(i)
        longer%nws(n) = vectors%nws(i)
        longer%rdw(n) = vectors%rdw(i)
      end if
    end do
    call number_closures(longer)
    vectors = longer
  end subroutine expand_vectors

  !> Append the steps of a joint's chain.
  pure subroutine walk_joint(joint, target, independent, vectors, n)
    type(compound_joint_type), intent(in) :: joint           !< the joint
    integer, intent(in) :: target                            !< the link to which the chain leads
    logical, intent(in) :: independent(:)                    !< (M) the coordinate is independent
    type(structural_vectors_type), intent(inout) :: vectors  !< gets the steps
    integer, intent(inout) :: n                              !< positions that are filled
    integer :: i, place, links(2)

    do i = 1, joint%freedoms
      place = i
      if (target == joint%ends(1)) place = joint%freedoms + 1 - i
      links = joint%links_of_pair(place)
      n = n + 1
      vectors%nrg(n) = links(2)
      if (target == joint%ends(1)) vectors%nrg(n) = links(1)
      vectors%nws(n) = joint%numbers(place)
      vectors%rdw(n) = merge(1, 0, independent(joint%numbers(place)))
    end do
  end subroutine walk_joint

  !> The structural vectors as the user knows them: the steps over a joint become one, with its first coordinate, and with rdw = 1
  !> where all its coordinates are independent.
  pure function shown_vectors(structure, vectors) result(shown)
    type(structure_type), intent(in) :: structure           !< with the chains of the joints
    type(structural_vectors_type), intent(in) :: vectors    !< with the chains of the joints
    type(structural_vectors_type) :: shown
    logical :: kept(size(vectors%nrg))
    integer :: i, j, kind

    shown = vectors
    if (.not. allocated(structure%joints)) return
    kept = vectors%nrg <= structure%shown_links()
    kind = 1
    do i = 1, size(vectors%nrg)
      j = 0
      if (vectors%nws(i) > 0) j = structure%joint_of(vectors%nws(i))
      if (j == 0) cycle
      kind = min(kind, vectors%rdw(i))
      if (.not. kept(i)) cycle
      shown%nws(i) = structure%joints(j)%numbers(1)
      shown%rdw(i) = kind
      kind = 1
    end do
    shown%nrg = pack(shown%nrg, kept)
    shown%nws = pack(shown%nws, kept)
    shown%rdw = pack(shown%rdw, kept)
    shown%nrw = pack(shown%nrw, kept)
  end function shown_vectors
end module mech9_joint_expansion
