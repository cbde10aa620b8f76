!> The obstacles on the page of the first frame that labels should not cover.
module mech9_label_obstacles
  use mech9_kinds, only: wp
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, item_type, closed_path, segments, spring, mark, in_trace, in_curve, in_guide, in_plate, &
                         in_block, in_tube, in_pin, in_cross, in_cam, as_stand, as_ring, as_ball, as_dot, as_centre, as_free, &
                         as_coil, as_cup
  use mech9_drawing, only: drawing_type
  use mech9_label_places, only: obstacles_type
  implicit none
  private
  public :: find_obstacles, clear_radius

  !> The distance to which lines and marks reach on each side at full size of symbols [px], and the cost of covering
  !> them. There is an entry for each style of mech9_scene. Styles with zeros are no obstacles.
  real(wp), parameter :: reach(*) = [1.0_wp, 1.0_wp, 1.0_wp, 5.0_wp, 0.0_wp, 4.7_wp, 8.7_wp, 7.2_wp, 6.2_wp, 0.0_wp, 6.5_wp, &
                                     4.0_wp, 2.8_wp, 1.0_wp, 7.0_wp, 6.0_wp, 8.5_wp, 4.0_wp, 5.5_wp, 7.5_wp, &
                                     0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 6.0_wp, 13.0_wp, 17.0_wp, 0.0_wp, 6.0_wp, &
                                     0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.5_wp]
  real(wp), parameter :: weights(*) = [0.9_wp, 0.7_wp, 0.5_wp, 1.2_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 1.2_wp, 0.0_wp, 0.8_wp, &
                                       0.8_wp, 1.2_wp, 0.7_wp, 0.8_wp, 1.5_wp, 1.5_wp, 1.5_wp, 1.5_wp, 1.5_wp, &
                                       0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.8_wp, 0.7_wp, 0.7_wp, 0.0_wp, 1.0_wp, &
                                       0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.3_wp, 0.0_wp, 1.0_wp]
  !> The cost of covering the lines that every page has: the title and the foot.
  real(wp), parameter :: furniture = 2.0_wp

contains

  !> List the obstacles of all lines and marks of a scene, of the title, the foot and the axes.
  pure subroutine find_obstacles(scene, drawing, projection, obstacles)
    type(scene_type), intent(in) :: scene            !< without labels
    type(drawing_type), intent(in) :: drawing        !< places of the nodes on the page of the first frame
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(obstacles_type), intent(out) :: obstacles   !< lines that labels should not cover
    real(wp) :: foot(2), tip(2)
    integer :: i

    do i = 1, scene%n_items
      call add_item(scene%items(i), drawing, projection%symbol, obstacles)
    end do
    call obstacles%add([0.0_wp, 18.0_wp], [projection%width, 18.0_wp], 10.0_wp, furniture)
    call obstacles%add([0.0_wp, projection%height - 14.0_wp], [projection%width, projection%height - 14.0_wp], 8.0_wp, furniture)
    ! the axes with their letters
    foot = [38.0_wp, projection%height - 36.0_wp]
    do i = 1, 3
      tip = 36.0_wp*[projection%view%right(i), -projection%view%up(i)]
      call obstacles%add(foot, foot + tip, 6.0_wp, furniture)
    end do
  end subroutine find_obstacles

  !> Add the obstacles of one item.
  pure subroutine add_item(item, drawing, symbol, obstacles)
    type(item_type), intent(in) :: item               !< one thing to draw
    type(drawing_type), intent(in) :: drawing         !< places of the nodes on the page
    real(wp), intent(in) :: symbol                    !< scale of symbols, 1 at full size
    type(obstacles_type), intent(inout) :: obstacles  !< lines that labels should not cover
    real(wp) :: half, across(2)
    integer :: i, next

    if (item%style > size(reach)) return
    if (.not. reach(item%style) > 0.0_wp) return
    half = reach(item%style)
    if (all(item%style /= [in_trace, in_curve, in_guide, in_cam])) half = half*symbol
    if (item%style == as_stand) then
      call add_stand(drawing%xy(:, item%nodes(1)), sign(symbol, item%shift(2)), obstacles)
    else if (item%shape == mark) then
      call add_line(item, drawing%xy(:, item%nodes(1)), drawing%xy(:, item%nodes(1)), half, obstacles)
    else
      do i = 1, size(item%nodes)
        if (item%shape == segments .and. mod(i, 2) == 0) cycle
        if (item%shape /= closed_path .and. i == size(item%nodes)) cycle
        next = 1 + mod(i, size(item%nodes))
        across = 0.0_wp
        if (item%shape == spring) across = symbol*item%shift(1)*across_of(drawing%xy(:, item%nodes(i)), &
                                                                          drawing%xy(:, item%nodes(next)))
        call add_line(item, drawing%xy(:, item%nodes(i)) + across, drawing%xy(:, item%nodes(next)) + across, half, obstacles)
      end do
    end if
  end subroutine add_item

  !> The direction across a line, of unit length; zero where it has no length.
  pure function across_of(from, to) result(across)
    real(wp), intent(in) :: from(2)  !< first end of the line [px]
    real(wp), intent(in) :: to(2)    !< second end of the line [px]
    real(wp) :: across(2)

    across = [from(2) - to(2), to(1) - from(1)]
    if (norm2(across) > 0.0_wp) across = across/norm2(across)
  end function across_of

  !> Add one line of an item. The number of a link may stand on the bars and plates of this link.
  pure subroutine add_line(item, from, to, half, obstacles)
    type(item_type), intent(in) :: item               !< one thing to draw
    real(wp), intent(in) :: from(2)                   !< first end of the line [px]
    real(wp), intent(in) :: to(2)                     !< second end of the line [px]
    real(wp), intent(in) :: half                      !< distance to which it reaches on each side [px]
    type(obstacles_type), intent(inout) :: obstacles  !< lines that labels should not cover
    integer :: owner

    owner = 0
    if (item%style == in_plate .or. item%style == in_tube) owner = item%link
    call obstacles%add(from, to, half, weights(item%style), owner)
  end subroutine add_line

  !> Add a stand: its triangle from the joint to the ground, and the hatched ground.
  pure subroutine add_stand(at, symbol, obstacles)
    real(wp), intent(in) :: at(2)                     !< place of the joint [px]
    real(wp), intent(in) :: symbol                    !< scale of symbols, 1 at full size; negative for a stand above its joint
    type(obstacles_type), intent(inout) :: obstacles  !< lines that labels should not cover
    real(wp) :: ground(2)

    ground = at + [0.0_wp, 15.0_wp*symbol]
    call obstacles%add(at, ground, 6.0_wp*abs(symbol), weights(as_stand))
    ground = at + [0.0_wp, 18.0_wp*symbol]
    call obstacles%add(ground - [12.0_wp*symbol, 0.0_wp], ground + [12.0_wp*symbol, 0.0_wp], 4.5_wp*abs(symbol), &
                       weights(as_stand))
  end subroutine add_stand

  !> The radius of the largest symbol at a place [px].
  pure real(wp) function clear_radius(scene, drawing, symbol, at) result(radius)
    type(scene_type), intent(in) :: scene      !< without labels
    type(drawing_type), intent(in) :: drawing  !< places of the nodes on the page of the first frame
    real(wp), intent(in) :: symbol             !< scale of symbols, 1 at full size
    real(wp), intent(in) :: at(2)              !< the place on the page [px]
    integer, parameter :: solid(*) = [in_block, in_pin, in_cross, as_ring, as_ball, as_dot, as_centre, as_free, &
                                   as_coil, as_cup]
    real(wp), parameter :: radii(*) = [12.0_wp, 11.0_wp, 8.0_wp, 6.0_wp, 8.5_wp, 4.0_wp, 5.5_wp, 7.5_wp, 13.0_wp, 17.0_wp]
    real(wp), parameter :: near = 4.0_wp
    real(wp) :: middle(2)
    integer :: i, n

    radius = 3.0_wp
    do i = 1, scene%n_items
      associate (item => scene%items(i))
        n = findloc(solid, item%style, dim=1)
        if (n == 0) cycle
        middle = sum(drawing%xy(:, item%nodes), 2)/size(item%nodes)
        if (norm2(middle - at) < near) radius = max(radius, symbol*radii(n))
      end associate
    end do
  end function clear_radius
end module mech9_label_obstacles
