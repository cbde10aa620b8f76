!> A search that finds whether a link can turn about one direction only, as all links of a planar mechanism do.
!>
!> A path of pairs leads from the link to link 1. Where each of its pairs slides, or turns about the direction, no
!> other path lets the link turn otherwise. The search goes through all such pairs until it reaches link 1.
module mech9_turning_direction
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_structure, only: structure_type
  use mech9_link_graph, only: link_graph_type, graph_from_structure
  use mech9_pair, only: pair_slot_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes, sliding, free
  implicit none
  private
  public :: turning_search_type, new_turning_search

  !> The search, with the results of earlier searches.
  type :: turning_search_type
    private
    type(link_graph_type) :: graph
    type(pair_axes_type), allocatable :: axes(:)   !< (M) of the pairs
    logical, allocatable :: found(:)               !< (N) links that turn about `direction` only
    real(wp), allocatable :: direction(:, :)       !< (3,N) of length 1, in the axes of each link
  contains
    procedure :: turns_only_about
  end type turning_search_type

contains

  !> A search among the links of a structure without findings; it may be without links.
  pure subroutine new_turning_search(structure, pairs, search)
    type(structure_type), intent(in) :: structure      !< links and pairs
    type(pair_slot_type), intent(in) :: pairs(:)       !< (M); some may be missing
    type(turning_search_type), intent(out) :: search   !< the search, which has found nothing yet

    search%graph = graph_from_structure(structure)
    search%axes = pair_axes(pairs)
    allocate (search%found(structure%n_links), source=.false.)
    allocate (search%direction(3, structure%n_links), source=0.0_wp)
  end subroutine new_turning_search

  !> Find whether a link can turn about a direction only.
  pure subroutine turns_only_about(self, link, direction, slack, answer, barrier)
    class(turning_search_type), intent(inout) :: self   !< the turning search
    integer, intent(in) :: link   !< number of the link
    real(wp), intent(in) :: direction(3)       !< of length 1, in the axes of the link
    real(wp), intent(in) :: slack   !< angle that counts as zero [rad]
    logical, intent(out) :: answer   !< whether the link turns about the direction only, as far as the search can find
    integer, intent(out) :: barrier            !< a pair by which the link may turn otherwise; 0: none, or none is known
    logical :: reached(self%graph%n_links)
    integer :: queue(self%graph%n_links), n, next, i, other
    logical :: passes

    barrier = 0
    answer = self%found(link) .and. norm2(cross(direction, self%direction(:, link))) <= slack
    if (answer) return
    reached = .false.
    reached(link) = .true.
    self%direction(:, link) = direction
    queue(1) = link
    n = 1
    next = 1
    do while (next <= n)
      do i = self%graph%first(queue(next)), self%graph%first(queue(next) + 1) - 1
        other = self%graph%other_at(i)
        if (reached(other)) cycle
        call cross_pair(self%axes(self%graph%pair_at(i)), queue(next), slack, self%direction, other, passes)
        if (.not. passes) then
          if (barrier == 0) barrier = self%graph%pair_at(i)
          cycle
        end if
        reached(other) = .true.
        n = n + 1
        queue(n) = other
      end do
      next = next + 1
    end do
    answer = reached(1)
    if (answer) self%found = self%found .or. reached
    if (answer) barrier = 0
  end subroutine turns_only_about

  !> Find the direction in the link at the other end of a pair, if the pair keeps it.
  pure subroutine cross_pair(axes, from, slack, direction, to, passes)
    type(pair_axes_type), intent(in) :: axes     !< of the pair, in both of its links
    integer, intent(in) :: from                  !< link in which the direction is known
    real(wp), intent(in) :: slack                !< angle that counts as zero [rad]
    real(wp), intent(inout) :: direction(:, :)   !< (3,N) in the axes of each link
    integer, intent(in) :: to                    !< link in which it is found
    logical, intent(out) :: passes               !< whether the pair keeps the direction
    integer :: near, far
    real(wp) :: along

    near = merge(1, 2, axes%links(1) == from)
    far = 3 - near
    passes = axes%kind /= free
    if (.not. passes) return
    if (axes%kind == sliding) then
      if (near == 1) direction(:, to) = matmul(transpose(axes%home%r), direction(:, from))
      if (near == 2) direction(:, to) = matmul(axes%home%r, direction(:, from))
    else
      along = dot_product(axes%axes(:, near), direction(:, from))
      passes = norm2(cross(axes%axes(:, near), direction(:, from))) <= slack
      if (passes) direction(:, to) = sign(1.0_wp, along)*axes%axes(:, far)
    end if
  end subroutine cross_pair
end module mech9_turning_direction
