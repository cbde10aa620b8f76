!> The shapes of single symbols: blocks, runners on curves, pins, and the symbols of planar and free joints.
module mech9_symbol_shapes
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: cross, unit, turn_back
  use mech9_pose, only: default_zero
  use mech9_film, only: film_type
  use mech9_pair_axes, only: screwing
  use mech9_skeleton, only: skeleton_type, place_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, open_path, closed_path, facing_path, segments, spring, mark, in_plate, in_block, &
                         in_pin, in_pin_end, in_cross, in_thread, in_damper, as_free
  implicit none
  private
  public :: add_block, add_pin, add_led_link, add_whole_joint, find_plane, across, block_half, guide_more

  !> Sizes on the page [px].
  real(wp), parameter :: block_half = 13.0_wp, guide_more = 9.0_wp, pin_half = 10.0_wp, pin_radius = 5.0_wp, square_half = 7.0_wp, &
                         star_half = 17.0_wp, plane_more = 14.0_wp
  integer, parameter :: corners = 14         !< corners of the round end of a pin

contains

  !> Add the block of a sliding pair, or the nut of a helical one with the thread on which it runs.
  subroutine add_block(place, guide, projection, above, names, scene)
    type(place_type), intent(in) :: place            !< place and axes of the pair
    integer, intent(in) :: guide(2)                  !< numbers of the nodes at the ends of its guide
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items that the symbol lies upon; 0: none
    character(len=*), intent(in) :: names            !< names of the coordinates of the joint
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer :: from, to

    if (place%telescopic) return
    if (place%kind == screwing) call scene%add_item(spring, in_thread, guide, above=above)
    associate (point => place%points(:, place%carrier), axis => place%axes(:, place%carrier), &
               link => place%links(place%carrier))
      call scene%add_node(link, point - projection%metres(block_half)*axis, from)
      call scene%add_node(link, point + projection%metres(block_half)*axis, to)
      call scene%add_item(open_path, in_block, [from, to], link, above=above, text=names)
    end associate
  end subroutine add_block

  !> Add the block that runs along the curve of a path pair and turns with it.
  subroutine add_runner(place, projection, above, names, scene)
    type(place_type), intent(in) :: place            !< place of the pair
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items that the symbol lies upon; 0: none
    character(len=*), intent(in) :: names            !< names of the coordinates of the joint
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer :: ends(2), i

    do i = 1, 2
      call scene%add_node(place%links(2), place%points(:, 2) + (2*i - 3)*projection%metres(block_half)*place%tangent, ends(i))
    end do
    call scene%add_item(open_path, in_block, ends, place%links(2), above=above, text=names)
  end subroutine add_runner

  !> Add a pin: a short cylinder along the axis. Only the end that is turned to the viewer is drawn.
  subroutine add_pin(place, px, crossed, above, names, scene)
    type(place_type), intent(in) :: place     !< place and axes of the pair
    real(wp), intent(in) :: px                !< length of 1 px in the mechanism [m]
    logical, intent(in) :: crossed            !< the pin is one of two, a bar of the cross that they make
    integer, intent(in) :: above(4)           !< numbers of the items that the symbol lies upon; 0: none
    character(len=*), intent(in) :: names     !< names of the coordinates of the joint
    type(scene_type), intent(inout) :: scene  !< nodes and items of the picture
    real(wp) :: sides(3, 2), angle
    integer :: ends(2), around(corners), i, j

    associate (point => place%points(:, 1), axis => place%axes(:, 1), link => place%links(1))
      do i = 1, 2
        call scene%add_node(link, point + (2*i - 3)*px*pin_half*axis, ends(i))
      end do
      call scene%add_item(open_path, merge(in_cross, in_pin, crossed), ends, above=above, text=names)
      if (crossed) return
      sides = across(axis)
      do i = 1, 2
        ! each end is counterclockwise as seen from outside
        sides(:, 2) = -sides(:, 2)
        do j = 1, corners
          angle = 2.0_wp*pi*j/corners
          call scene%add_node(link, scene%node_at(:, ends(i)) &
                              + px*pin_radius*(cos(angle)*sides(:, 1) + sin(angle)*sides(:, 2)), around(j))
        end do
        call scene%add_item(facing_path, in_pin_end, around, above=above)
      end do
    end associate
  end subroutine add_pin

  !> Add a small square on the moving link. It is the face with which the link lies on the plane of a planar joint. For
  !> a curve it is the shoe that the curve leads without turning it.
  subroutine add_square(link, point, sides, projection, above, names, scene)
    integer, intent(in) :: link                      !< number of the moving link
    real(wp), intent(in) :: point(3)                 !< the middle of the square, in the system of the link [m]
    real(wp), intent(in) :: sides(3, 2)              !< directions of its sides, in the axes of the link, of unit length
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items that the symbol lies upon; 0: none
    character(len=*), intent(in) :: names            !< names of the coordinates of the joint
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp), parameter :: signs(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
    integer :: nodes(4), i

    do i = 1, 4
      call scene%add_node(link, point + projection%metres(square_half)*matmul(sides, signs(:, i)), nodes(i))
    end do
    call scene%add_item(closed_path, in_plate, nodes, link, above=above, text=names)
  end subroutine add_square

  !> Add the symbol of a planar or a free joint.
  subroutine add_whole_joint(place, projection, above, names, scene)
    type(place_type), intent(in) :: place            !< place of the last pair of the joint
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items that the symbol lies upon; 0: none
    character(len=*), intent(in) :: names            !< names of the coordinates of the joint
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture

    if (place%plane_from > 0) then
      call add_square(place%links(2), place%points(:, 2), across(place%axes(:, 2)), projection, above, names, scene)
    else
      call add_star(place, projection, above, names, scene)
    end if
  end subroutine add_whole_joint

  !> Add the symbol of a pair along a curve: a block that turns with the curve, or a square that does not turn. The pair
  !> of a user's procedure has a special symbol.
  subroutine add_led_link(place, node, projection, above, names, scene)
    type(place_type), intent(in) :: place            !< place of the pair
    integer, intent(in) :: node                      !< number of its node
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items that the symbol lies upon; 0: none
    character(len=*), intent(in) :: names            !< names of the coordinates of the joint
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture

    if (any(abs(place%tangent) > 0.0_wp)) then
      call add_runner(place, projection, above, names, scene)
    else if (any(abs(place%sides) > 0.0_wp)) then
      call add_square(place%links(2), place%points(:, 2), place%sides, projection, above, names, scene)
    else
      call scene%add_item(mark, as_free, [node], above=above, text=names)
    end if
  end subroutine add_led_link

  !> Add three short lines along the axes of the moving link, the symbol of a free joint.
  subroutine add_star(place, projection, above, names, scene)
    type(place_type), intent(in) :: place            !< place of the last pair of the joint
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items that the symbol lies upon; 0: none
    character(len=*), intent(in) :: names            !< names of the coordinates of the joint
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp) :: directions(3, 3)
    integer :: nodes(6), i

    directions(:, 3) = place%axes(:, 2)
    directions(:, :2) = across(place%axes(:, 2))
    do i = 1, 3
      call scene%add_node(place%links(2), place%points(:, 2) - projection%metres(star_half)*directions(:, i), nodes(2*i - 1))
      call scene%add_node(place%links(2), place%points(:, 2) + projection%metres(star_half)*directions(:, i), nodes(2*i))
    end do
    call scene%add_item(segments, in_damper, nodes, above=above, text=names)
  end subroutine add_star

  !> Find the rectangle that stands for the plane of a planar joint, in its reference link: it reaches around all places
  !> of the moving point.
  subroutine find_plane(film, skeleton, first, last, projection, link, rim)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    integer, intent(in) :: first                     !< number of the first pair of the joint, which slides
    integer, intent(in) :: last                      !< number of its last pair, which turns
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(out) :: link                     !< number of the reference link
    real(wp), intent(out) :: rim(3, 4)               !< its corners in turn, in the system of the reference link [m]
    real(wp) :: sides(3, 2), low(2), high(2), at(3), apart(2), origin(3)
    integer :: frame

    associate (start => skeleton%places(first), moving => skeleton%places(last))
      link = start%links(1)
      origin = start%points(:, 1)
      sides(:, 1) = start%axes(:, 1)
      ! in the first frame, the axis of the turn is the normal of the plane, as in all others
      at = turn_back(film%r(:, :, link, 1), film%direction(1, moving%links(2), moving%axes(:, 2)))
      sides(:, 2) = unit(cross(at, sides(:, 1)))
      low = 0.0_wp
      high = 0.0_wp
      do frame = 1, film%n_frames
        at = film%local(frame, link, film%position(frame, moving%links(2), moving%points(:, 2))) - origin
        apart = matmul(at, sides)
        if (frame == 1) low = apart
        if (frame == 1) high = apart
        low = min(low, apart)
        high = max(high, apart)
      end do
    end associate
    low = low - projection%metres(plane_more)
    high = high + projection%metres(plane_more)
    rim(:, 1) = origin + matmul(sides, low)
    rim(:, 2) = origin + matmul(sides, [high(1), low(2)])
    rim(:, 3) = origin + matmul(sides, high)
    rim(:, 4) = origin + matmul(sides, [low(1), high(2)])
  end subroutine find_plane

  !> Two directions at right angles to an axis and to each other, of unit length.
  pure function across(axis) result(sides)
    real(wp), intent(in) :: axis(3)  !< of unit length
    real(wp) :: sides(3, 2)

    sides(:, 1) = default_zero(axis)
    sides(:, 1) = unit(sides(:, 1) - dot_product(sides(:, 1), axis)*axis)
    sides(:, 2) = cross(axis, sides(:, 1))
  end function across
end module mech9_symbol_shapes
