!> The dimensions of links, which are the distance and the angle between the axes of two pairs of a link.
module mech9_link_dimensions
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_structure, only: structure_type
  use mech9_link_graph, only: link_graph_type, graph_from_structure
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning, sliding, free
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: link_dimension_type, link_dimensions, dimension_between

  !> On a link with up to so many pairs each pair is compared with each other; on a link with more, each with the next.
  integer, parameter :: most_pairs = 4
  !> Axes with an angle up to this one [rad] count as parallel: their distance is taken between parallel lines.
  real(wp), parameter :: parallel = 1.0e-9_wp

  !> The dimensions between two pairs of one link.
  type :: link_dimension_type
    integer :: link = 0                   !< number of the link
    integer :: pairs(2) = 0               !< their coordinates
    logical :: has_angle = .false.        !< both pairs have axes
    real(wp) :: angle = 0.0_wp            !< between the directions of the axes, 0 to pi [rad]
    logical :: has_distance = .false.     !< the axes are lines, not both of them directions alone
    real(wp) :: distance = 0.0_wp         !< between the axes, along their common normal [m]
    logical :: has_points = .false.       !< the points of both pairs keep their places in both of their links
    real(wp) :: between_points = 0.0_wp   !< the distance of these points [m]
  end type link_dimension_type

contains

  !> The dimensions of all links that the user knows, in the order of links and coordinates.
  pure subroutine link_dimensions(mechanism, dimensions)
    type(mechanism_type), intent(in) :: mechanism                          !< the mechanism
    type(link_dimension_type), allocatable, intent(out) :: dimensions(:)   !< two pairs of a link each
    type(link_graph_type) :: graph
    type(pair_axes_type), allocatable :: axes(:)
    integer :: link, i, j, n

    graph = graph_from_structure(mechanism%structure)
    axes = pair_axes(mechanism%pairs)
    n = 0
    do link = 1, mechanism%structure%shown_links()
      n = n + number_of_dimensions(graph%first(link + 1) - graph%first(link))
    end do
    allocate (dimensions(n))
    n = 0
    do link = 1, mechanism%structure%shown_links()
      associate (pairs => graph%pair_at(graph%first(link):graph%first(link + 1) - 1))
        do i = 1, size(pairs) - 1
          do j = i + 1, size(pairs)
            if (size(pairs) > most_pairs .and. j > i + 1 .and. .not. (i == 1 .and. j == size(pairs))) cycle
            n = n + 1
            dimensions(n) = dimension_between(axes, link, pairs(i), pairs(j))
            call name_joints(mechanism%structure, dimensions(n))
          end do
        end do
      end associate
    end do
  end subroutine link_dimensions

  !> Call joints with several freedoms by their first coordinates, and leave out what depends on their axes: they have several.
  pure subroutine name_joints(structure, dimension)
    type(structure_type), intent(in) :: structure           !< links and joints
    type(link_dimension_type), intent(inout) :: dimension   !< the dimensions between two pairs
    integer :: i

    do i = 1, 2
      if (structure%joint_of(dimension%pairs(i)) == 0) cycle
      dimension%pairs(i) = structure%first_of_joint(dimension%pairs(i))
      dimension%has_angle = .false.
      dimension%has_distance = .false.
    end do
  end subroutine name_joints

  !> Number of pairs of pairs that are compared on a link.
  pure integer function number_of_dimensions(n_pairs) result(n)
    integer, intent(in) :: n_pairs   !< number of pairs of the link

    n = n_pairs*(n_pairs - 1)/2
    if (n_pairs > most_pairs) n = n_pairs
  end function number_of_dimensions

  !> The dimensions between two pairs of a link.
  pure function dimension_between(axes, link, first, second) result(dimension)
    type(pair_axes_type), intent(in) :: axes(:)   !< (M) of all pairs
    integer, intent(in) :: link                   !< number of the link
    integer, intent(in) :: first                  !< coordinate of one pair of this link
    integer, intent(in) :: second                 !< coordinate of another pair of this link
    type(link_dimension_type) :: dimension
    real(wp) :: normal(3), apart(3), sine, cosine
    integer :: side_a, side_b

    dimension%link = link
    dimension%pairs = [first, second]
    associate (a => axes(first), b => axes(second))
      side_a = merge(1, 2, a%links(1) == link)
      side_b = merge(1, 2, b%links(1) == link)
      dimension%has_angle = a%kind /= free .and. b%kind /= free
      if (.not. dimension%has_angle) return
      normal = cross(a%axes(:, side_a), b%axes(:, side_b))
      sine = norm2(normal)
      cosine = dot_product(a%axes(:, side_a), b%axes(:, side_b))
      dimension%angle = atan2(sine, cosine)
      ! the axis of a slide has a direction, but no position
      dimension%has_distance = .not. (a%kind == sliding .and. b%kind == sliding)
      dimension%has_points = a%kind == turning .and. b%kind == turning
      apart = b%points(:, side_b) - a%points(:, side_a)
      dimension%between_points = norm2(apart)
      if (sine <= parallel) then
        dimension%distance = norm2(cross(a%axes(:, side_a), apart))
      else
        dimension%distance = abs(dot_product(apart, normal))/sine
      end if
    end associate
  end function dimension_between
end module mech9_link_dimensions
