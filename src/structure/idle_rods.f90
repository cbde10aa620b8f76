!> Rods between two ball joints: links that can turn about the line between both balls by themselves, whatever moves else.
!>
!> A rod may consist of several links in series, such as a cylinder and its piston: as long as nothing else is joined to them, they
!> can turn about that line together.
module mech9_idle_rods
  use mech9_structure, only: structure_type
  implicit none
  private
  public :: idle_rod_type, find_idle_rods

  !> One rod.
  type :: idle_rod_type
    integer, allocatable :: links(:)   !< numbers of its links, from the one at the first ball to the one at the second
    integer :: joints(2) = 0           !< numbers of its ball joints among those with several freedoms
    !> (links - 1) number of the coordinate between neighbours, the first one of a joint with several freedoms.
    integer, allocatable :: between(:)
  end type idle_rod_type

  !> The joints as the user knows them.
  type :: edges_type
    integer :: n = 0                         !< number of joints
    integer, allocatable :: links(:, :)      !< (2,n) the links that they join
    integer, allocatable :: first(:)         !< (n) their first coordinates
    integer, allocatable :: joint(:)         !< (n) numbers among the joints with several freedoms; 0 for other pairs
  end type edges_type

contains

  !> All rods of a mechanism.
  pure subroutine find_idle_rods(structure, rods)
    type(structure_type), intent(in) :: structure            !< links and joints
    type(idle_rod_type), allocatable, intent(out) :: rods(:) !< in the order of their first ball joints
    type(idle_rod_type), allocatable :: found(:)
    type(idle_rod_type) :: rod
    type(edges_type) :: edges
    integer, allocatable :: count_at(:)
    integer :: e, i, n

    n = 0
    if (allocated(structure%joints)) then
      call find_edges(structure, edges)
      allocate (count_at(structure%n_links), source=0)
      do e = 1, edges%n
        count_at(edges%links(:, e)) = count_at(edges%links(:, e)) + 1
      end do
      allocate (found(2*size(structure%joints)))
      do e = 1, edges%n
        if (.not. is_ball(structure, edges%joint(e))) cycle
        do i = 1, 2
          call follow(structure, edges, count_at, e, edges%links(i, e), rod)
          ! each rod is found from both ends
          if (rod%joints(2) <= rod%joints(1)) cycle
          n = n + 1
          found(n) = rod
        end do
      end do
    end if
    allocate (rods(n))
    if (n > 0) rods = found(:n)
  end subroutine find_idle_rods

  !> The joints as the user knows them.
  pure subroutine find_edges(structure, edges)
    type(structure_type), intent(in) :: structure   !< links and joints
    type(edges_type), intent(out) :: edges          !< in the order of their first coordinates
    integer :: j, k, m

    m = structure%n_coordinates
    allocate (edges%links(2, m), edges%first(m), edges%joint(m))
    do k = 1, m
      j = structure%joint_of(k)
      if (j > 0) then
        if (structure%joints(j)%numbers(1) /= k) cycle
      end if
      edges%n = edges%n + 1
      edges%first(edges%n) = k
      edges%joint(edges%n) = j
      edges%links(:, edges%n) = structure%links(:, k)
      if (j > 0) edges%links(:, edges%n) = structure%joints(j)%ends
    end do
  end subroutine find_edges

  !> Whether a joint is a ball joint.
  pure logical function is_ball(structure, joint)
    type(structure_type), intent(in) :: structure   !< links and joints
    integer, intent(in) :: joint                    !< number of the joint; 0 for a pair with one freedom

    is_ball = .false.
    if (joint > 0) is_ball = structure%joints(joint)%kind == 'spherical'
  end function is_ball

  !> Follow links with two joints from a ball joint to the next one; the second joint is 0 where there is none.
  pure subroutine follow(structure, edges, count_at, start, link, rod)
    type(structure_type), intent(in) :: structure   !< links and joints
    type(edges_type), intent(in) :: edges           !< the joints
    integer, intent(in) :: count_at(:)              !< (links) how many joints a link has
    integer, intent(in) :: start                    !< number of the first joint
    integer, intent(in) :: link                     !< one of its two links, the first of the rod
    type(idle_rod_type), intent(out) :: rod         !< the rod
    integer :: at, e, last, next

    rod%joints(1) = edges%joint(start)
    allocate (rod%links(0), rod%between(0))
    at = link
    last = start
    do
      if (at == 1 .or. count_at(at) /= 2) return
      next = 0
      do e = 1, edges%n
        if (e /= last .and. any(edges%links(:, e) == at)) next = e
      end do
      if (next == 0) return
      rod%links = [rod%links, at]
      if (is_ball(structure, edges%joint(next))) exit
      rod%between = [rod%between, edges%first(next)]
      at = sum(edges%links(:, next)) - at
      last = next
      if (size(rod%links) >= structure%n_links) return
    end do
    rod%joints(2) = edges%joint(next)
  end subroutine follow
end module mech9_idle_rods
