!> The plane in which all links of a mechanism move, if there is one: all axes of turning are parallel, and all slides lie across them.
!>
!> The normal of the plane goes from link to link over all pairs, from the axis of the first turning pair on. Each pair must keep it.
module mech9_turning_plane
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: turn, turn_back, unit, cross, identity, about_axis
  use mech9_pose, only: default_zero
  use mech9_structure, only: structure_type
  use mech9_link_graph, only: link_graph_type, graph_from_structure
  use mech9_pair, only: pair_type, pair_slot_type, pair_guide_type, screw_factors_type
  implicit none
  private
  public :: turning_plane_type, find_turning_plane, turn_onto

  !> Directions may differ by this: round-off of data with 16 digits, as in the layout of planar arithmetic.
  real(wp), parameter :: parallel = 64.0_wp*epsilon(1.0_wp)

  !> The plane, or the pair that prevents it.
  type :: turning_plane_type
    logical :: found = .false.               !< all links move in one plane, and one of them turns
    integer :: pair = 0                      !< number of the first turning pair; 0: none turns
    integer :: barrier = 0                   !< number of a pair that leaves the plane; 0: there is none
    real(wp), allocatable :: normal(:, :)    !< (3,N) direction of the first turning pair's axis, in the axes of each link
  end type turning_plane_type

contains

  !> Find the plane of a mechanism whose pairs are all known.
  pure subroutine find_turning_plane(structure, pairs, plane)
    type(structure_type), intent(in) :: structure     !< links and pairs
    type(pair_slot_type), intent(in) :: pairs(:)      !< (M)
    type(turning_plane_type), intent(out) :: plane    !< the plane, or why there is none
    integer :: k

    allocate (plane%normal(3, structure%n_links), source=0.0_wp)
    do k = 1, size(pairs)
      if (.not. is_revolute(pairs(k)%pair)) cycle
      plane%pair = k
      exit
    end do
    if (plane%pair == 0) return
    call spread_normal(structure, pairs, plane)
    do k = 1, size(pairs)
      if (plane%barrier > 0) exit
      if (.not. keeps_normal(pairs(k)%pair, plane%normal)) plane%barrier = k
    end do
    plane%found = plane%barrier == 0
  end subroutine find_turning_plane

  !> Whether a pair turns about a fixed axis and does nothing else.
  pure logical function is_revolute(pair)
    class(pair_type), intent(in) :: pair   !< the pair
    type(screw_factors_type) :: factors
    logical :: is_screw

    call pair%as_screw(factors, is_screw)
    is_revolute = is_screw .and. abs(factors%turn) > 0.0_wp .and. .not. abs(factors%slide) > 0.0_wp
  end function is_revolute

  !> Carry the axis of the first turning pair from link to link, until a pair leaves the plane.
  pure subroutine spread_normal(structure, pairs, plane)
    type(structure_type), intent(in) :: structure        !< links and pairs
    type(pair_slot_type), intent(in) :: pairs(:)         !< (M)
    type(turning_plane_type), intent(inout) :: plane     !< with its first turning pair; gets the normals, or the barrier
    type(link_graph_type) :: graph
    type(screw_factors_type) :: factors
    integer :: queue(structure%n_links), n, next, i, from, to
    logical :: reached(structure%n_links), is_screw

    graph = graph_from_structure(structure)
    reached = .false.
    queue(1) = pairs(plane%pair)%pair%reference
    reached(queue(1)) = .true.
    call pairs(plane%pair)%pair%as_screw(factors, is_screw)
    plane%normal(:, queue(1)) = factors%before%r(:, 3)
    n = 1
    next = 1
    do while (next <= n)
      from = queue(next)
      do i = graph%first(from), graph%first(from + 1) - 1
        to = graph%other_at(i)
        if (reached(to)) cycle
        associate (pair => pairs(graph%pair_at(i))%pair)
          if (.not. keeps(pair, in_pair(pair, from, plane%normal(:, from)))) then
            plane%barrier = graph%pair_at(i)
            return
          end if
          plane%normal(:, to) = unit(in_link(pair, to, in_pair(pair, from, plane%normal(:, from))))
        end associate
        reached(to) = .true.
        n = n + 1
        queue(n) = to
      end do
      next = next + 1
    end do
  end subroutine spread_normal

  !> Whether a pair keeps the normal of both of its links.
  pure logical function keeps_normal(pair, normal)
    class(pair_type), intent(in) :: pair        !< the pair
    real(wp), intent(in) :: normal(:, :)        !< (3,N) in the axes of each link
    real(wp) :: here(3), there(3)

    here = in_pair(pair, pair%reference, normal(:, pair%reference))
    there = in_pair(pair, pair%moving, normal(:, pair%moving))
    keeps_normal = keeps(pair, here) .and. norm2(here - there) <= parallel
  end function keeps_normal

  !> Whether the motion of a pair keeps a direction of its frame: it turns about it, or leads its link across it without a turn.
  pure logical function keeps(pair, direction)
    class(pair_type), intent(in) :: pair      !< the pair
    real(wp), intent(in) :: direction(3)      !< of length 1, in the axes of the pair's frame, whose z is its axis
    type(screw_factors_type) :: factors
    type(pair_guide_type) :: guide
    logical :: is_screw
    integer :: i

    call pair%as_screw(factors, is_screw)
    if (is_revolute(pair)) then
      keeps = norm2(direction(1:2)) <= parallel
    else if (is_screw) then
      keeps = abs(direction(3)) <= parallel .and. .not. abs(factors%turn) > 0.0_wp
    else
      call pair%guide(guide)
      keeps = size(guide%points, 2) > 0 .and. .not. guide%turns
      do i = 2, size(guide%points, 2)
        associate (way => guide%points(:, i) - guide%points(:, 1))
          keeps = keeps .and. abs(dot_product(direction, way)) <= parallel*max(guide%length, norm2(way))
        end associate
      end do
    end if
  end function keeps

  !> A direction of a link, in the axes of a pair's frame.
  pure function in_pair(pair, link, direction) result(turned)
    class(pair_type), intent(in) :: pair      !< the pair
    integer, intent(in) :: link               !< number of one of its links
    real(wp), intent(in) :: direction(3)      !< in the axes of this link
    real(wp) :: turned(3)
    type(screw_factors_type) :: factors
    logical :: is_screw

    call pair%as_screw(factors, is_screw)
    if (link == pair%reference) then
      turned = turn_back(factors%before%r, direction)
    else
      turned = turn(factors%after%r, direction)
    end if
  end function in_pair

  !> A direction of a pair's frame that the pair keeps, in the axes of one of its links.
  pure function in_link(pair, link, direction) result(turned)
    class(pair_type), intent(in) :: pair      !< the pair
    integer, intent(in) :: link               !< number of one of its links
    real(wp), intent(in) :: direction(3)      !< in the axes of the pair's frame
    real(wp) :: turned(3)
    type(screw_factors_type) :: factors
    logical :: is_screw

    call pair%as_screw(factors, is_screw)
    if (link == pair%reference) then
      turned = turn(factors%before%r, direction)
    else
      turned = turn_back(factors%after%r, direction)
    end if
  end function in_link

  !> The smallest rotation that turns one direction onto another; of opposite ones, half a turn about an axis across them.
  pure function turn_onto(from, to) result(r)
    real(wp), intent(in) :: from(3)   !< of length 1
    real(wp), intent(in) :: to(3)     !< of length 1
    real(wp) :: r(3, 3), axis(3), sine

    axis = cross(from, to)
    sine = norm2(axis)
    if (sine > parallel) then
      r = about_axis(axis/sine, atan2(sine, dot_product(from, to)))
    else if (dot_product(from, to) > 0.0_wp) then
      r = identity
    else
      r = about_axis(unit(cross(to, default_zero(to))), pi)
    end if
  end function turn_onto
end module mech9_turning_plane
