!> The symbols of springs and dampers, between points and on coordinates, and of the walls that hold fixed ends.
module mech9_spring_symbols
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, unit
  use mech9_mechanism, only: mechanism_type
  use mech9_spring_load, only: spring_load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_film, only: film_type
  use mech9_pair_axes, only: sliding, turning
  use mech9_skeleton, only: skeleton_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, open_path, spring, mark, in_guide, in_spring, in_damper, as_coil, as_cup
  use mech9_pair_symbols, only: symbols_type, add_ground
  implicit none
  private
  public :: add_springs

  !> Half the length of a wall, and the distance of a spring and of a damper from the line between their common points
  !> [px].
  real(wp), parameter :: half_wall = 11.0_wp, beside = 7.0_wp
  !> Places nearer to each other than this part of the mechanism's size are drawn as one.
  real(wp), parameter :: same = 0.004_wp

contains

  !> Add all springs and dampers. A load that has neither, such as a constant force on a coordinate, is not drawn.
  subroutine add_springs(mechanism, film, skeleton, projection, shapes, scene, symbols)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: shapes(:)                 !< (links) number of the item that shows each link; 0: none
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    integer :: nodes(2), above(4), i, side

    do i = 1, size(mechanism%loads)
      above = 0
      select type (load => mechanism%loads(i)%load)
      type is (spring_load_type)
        do side = 1, 2
          call scene%add_node(load%links(side), load%positions(:, side), nodes(side))
        end do
        above(:2) = shapes(load%links)
        call add_between(nodes, abs(load%stiffness) > 0.0_wp, abs(load%damping) > 0.0_wp, above, scene)
        do side = 1, 2
          if (load%links(side) == 1) call add_wall(film, skeleton, projection, nodes(side), nodes(3 - side), scene)
        end do
      type is (coordinate_load_type)
        above(:2) = shapes(skeleton%places(load%coordinate)%links)
        call add_on_coordinate(load, film, skeleton, projection, above, scene, symbols)
      end select
    end do
  end subroutine add_springs

  !> Add a spring, a damper, or both side by side.
  subroutine add_between(nodes, is_spring, is_damper, above, scene)
    integer, intent(in) :: nodes(2)           !< numbers of the nodes at its ends
    logical, intent(in) :: is_spring          !< there is a spring
    logical, intent(in) :: is_damper          !< there is a damper
    integer, intent(in) :: above(4)           !< numbers of the items that it lies upon; 0: none
    type(scene_type), intent(inout) :: scene  !< nodes and items of the picture
    real(wp) :: aside(2)

    aside = 0.0_wp
    if (is_spring .and. is_damper) aside(1) = beside
    if (is_spring .or. .not. is_damper) call scene%add_shifted(spring, in_spring, nodes, aside, above)
    if (is_damper) call scene%add_shifted(spring, in_damper, nodes, -aside, above)
  end subroutine add_between

  !> Add a spring and damper on a coordinate. For a turning pair they are around the joint. For a sliding pair they are
  !> along the guide, between the block and a support beyond an end of the guide. Those in a tube go from end to end.
  subroutine add_on_coordinate(load, film, skeleton, projection, above, scene, symbols)
    type(coordinate_load_type), intent(in) :: load   !< stiffness and damping on the coordinate
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items of the links of the pair; 0: none
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    integer :: nodes(2), k
    logical :: is_spring, is_damper

    k = load%coordinate
    is_spring = abs(load%stiffness) > 0.0_wp
    is_damper = abs(load%damping) > 0.0_wp
    if (.not. (is_spring .or. is_damper)) return
    associate (place => skeleton%places(k))
      if (place%kind == sliding .and. place%drawn_by == 0) then
        if (place%telescopic) then
          nodes = symbols%guide(:, k)
        else
          call add_support(symbols%guide(:, k), projection, nodes(1), scene)
          nodes(2) = symbols%node(k)
        end if
        call add_between(nodes, is_spring, is_damper, above, scene)
        if (scene%node_link(nodes(1)) == 1) call add_wall(film, skeleton, projection, nodes(1), nodes(2), scene)
      else
        if (is_spring) call scene%add_item(mark, as_coil, symbols%node(k:k), above=above)
        if (is_damper) call scene%add_item(mark, as_cup, symbols%node(k:k), above=above)
      end if
    end associate
  end subroutine add_on_coordinate

  !> Add a support beyond an end of a guide, and lengthen the guide to it, so that a spring to the block can be seen. It
  !> is beyond the first end, or beyond the second one if the page ends before.
  subroutine add_support(guide, projection, node, scene)
    integer, intent(in) :: guide(2)                  !< numbers of the nodes at the ends of the guide
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(out) :: node                     !< number of the new node at the support
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp), parameter :: beyond = 34.0_wp, edge = 14.0_wp   ! [px]
    real(wp) :: at(3), along(3), xy(2), depth
    integer :: side, link

    along = unit(scene%node_at(:, guide(2)) - scene%node_at(:, guide(1)))
    do side = 1, 2
      at = scene%node_at(:, guide(side)) + (2*side - 3)*projection%metres(beyond)*along
      node = guide(side)
      ! a moving link can be anywhere on the page, so that its first end is taken
      if (scene%node_link(node) /= 1) exit
      call projection%on_page(at, xy, depth)
      if (all(xy > edge) .and. all(xy < [projection%width, projection%height] - edge)) exit
    end do
    ! the call gives `node` a new value
    link = scene%node_link(node)
    call scene%add_node(link, at, node)
    call scene%add_item(open_path, in_guide, [guide(min(side, 2)), node])
  end subroutine add_support

  !> Add the hatched wall that holds the fixed end of a spring, at right angles to the spring as it is in the first
  !> frame. There is no wall where a joint of the frame has a stand already.
  subroutine add_wall(film, skeleton, projection, fixed, other, scene)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: fixed                     !< number of the node at the fixed end
    integer, intent(in) :: other                     !< number of the node at the other end
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp) :: at(3), away(3), across(3), ends(3, 2)
    integer :: k

    at = scene%node_at(:, fixed)
    do k = 1, size(skeleton%places)
      associate (place => skeleton%places(k))
        if (place%kind /= turning .or. all(place%links /= 1)) cycle
        if (norm2(film%position(1, place%links(1), place%points(:, 1)) - at) < same*skeleton%size) return
      end associate
    end do
    away = at - film%position(1, scene%node_link(other), scene%node_at(:, other))
    away = away - dot_product(away, projection%view%toward)*projection%view%toward
    if (norm2(away) < same*skeleton%size) return
    away = unit(away)
    across = cross(projection%view%toward, away)
    ends(:, 1) = at - projection%metres(half_wall)*across
    ends(:, 2) = at + projection%metres(half_wall)*across
    call add_ground(projection, ends, across, away, 0.0_wp, scene)
  end subroutine add_wall
end module mech9_spring_symbols
