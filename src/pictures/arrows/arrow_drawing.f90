!> Arrows in the scene of a film. The tip and the barbs of an arrow are drawn as points of additional links, which the film gets; these
!> links move from frame to frame as the vector does. An arrow round an axis is one link, which also grows and shrinks: its matrix is a
!> rotation times a factor.
module mech9_arrow_drawing
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: identity, cross, unit
  use mech9_film, only: film_type
  use mech9_view, only: view_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, segments, open_path, mark, as_pole
  use mech9_arrow, only: arrow_type, links_of, straight, ring, pole
  use mech9_force_arrows, only: is_near
  implicit none
  private
  public :: ends_of, take_arrows, add_arrows

  !> Length of the barbs [px], their largest part of the arrow, and their slope.
  real(wp), parameter :: barb = 9.0_wp, largest_part = 0.4_wp, slope = 0.4_wp
  !> The second head of an arrow with two heads is this part of its barbs behind the first one.
  real(wp), parameter :: behind = 0.8_wp
  !> The radius of an arrow round an axis as a part of its vector, the angles at which it begins and ends, and its number of steps.
  real(wp), parameter :: radius = 0.5_wp, first_angle = 0.25_wp*pi, last_angle = 1.75_wp*pi
  integer, parameter :: steps = 18

contains

  !> Places that a picture encloses so that all arrows are in it, in the system of link 1 [m].
  function ends_of(arrows, film, view) result(ends)
    type(arrow_type), intent(in) :: arrows(:)        !< all arrows
    type(film_type), intent(in) :: film              !< poses at the outputs of the run
    type(view_type), intent(in) :: view              !< direction from which the mechanism is seen
    real(wp), allocatable :: ends(:, :, :)           !< (3,ends,frames)
    real(wp) :: foot(3), reach(3)
    integer :: i, frame

    ! poles come last; they may be far away, and the picture is not made for them
    allocate (ends(3, 2*count(arrows%shape /= pole), film%n_frames))
    do frame = 1, film%n_frames
      do i = 1, size(ends, 2)/2
        foot = arrows(i)%begins_at(film, frame)
        if (arrows(i)%shape == ring) then
          reach = radius*norm2(arrows(i)%ways(:, frame))*(view%right + view%up + view%toward)
          ends(:, 2*i - 1, frame) = foot - reach
          ends(:, 2*i, frame) = foot + reach
        else
          ends(:, 2*i - 1, frame) = foot
          ends(:, 2*i, frame) = foot + arrows(i)%ways(:, frame)
        end if
      end do
    end do
  end function ends_of

  !> Form the film with more links, those of all arrows in their order.
  subroutine take_arrows(arrows, film, projection, with_arrows)
    type(arrow_type), intent(in) :: arrows(:)         !< all arrows
    type(film_type), intent(in) :: film               !< poses at the outputs of the run
    type(projection_type), intent(in) :: projection   !< from space to the page
    type(film_type), intent(out) :: with_arrows       !< the film with more links
    real(wp), allocatable :: r(:, :, :, :), p(:, :, :)
    integer :: i, links, n, first, last, frame

    links = size(film%p, 2)
    with_arrows = film
    last = links + sum(links_of(arrows))
    allocate (r(3, 3, last, size(film%p, 3)), p(3, last, size(film%p, 3)))
    r(:, :, :links, :) = film%r
    p(:, :links, :) = film%p
    do frame = 1, film%n_frames
      r(:, :, links + 1:, frame) = spread(identity, 3, last - links)
      first = links + 1
      do i = 1, size(arrows)
        associate (arrow => arrows(i), way => arrows(i)%ways(:, frame))
          select case (arrow%shape)
          case (pole)
            p(:, first, frame) = 0.0_wp
            if (is_near(way)) p(:, first, frame) = way
          case (ring)
            p(:, first, frame) = film%position(frame, arrow%link, arrow%foot)
            r(:, :, first, frame) = turned_ring(way, arrow%greatest(), projection%view)
          case default
            n = first + links_of(arrow) - 1
            if (allocated(arrow%feet)) then
              p(:, n, frame) = arrow%feet(:, frame)
              n = n - 1
            end if
            call place_heads(arrow%begins_at(film, frame), way, projection, p(:, first:n, frame))
          end select
          first = first + links_of(arrow)
        end associate
      end do
    end do
    call move_alloc(r, with_arrows%r)
    call move_alloc(p, with_arrows%p)
  end subroutine take_arrows

  !> Compute the tip and the ends of the barbs of one arrow, and the same for a second head; the barbs lie across the view.
  pure subroutine place_heads(foot, way, projection, places)
    real(wp), intent(in) :: foot(3)                  !< its beginning, in the system of link 1 [m]
    real(wp), intent(in) :: way(3)                   !< from there to its end [m]
    type(projection_type), intent(in) :: projection  !< from space to the page
    real(wp), intent(out) :: places(:, :)            !< (3,3 or 6) of the tip and the ends of the barbs [m]
    real(wp) :: along(3), across(3), length
    integer :: i

    places = spread(foot + way, 2, size(places, 2))
    if (.not. norm2(way) > 0.0_wp) return
    along = unit(way)
    across = cross(projection%view%toward, along)
    if (.not. norm2(across) > 1.0e-3_wp) return
    across = unit(across)
    length = min(projection%metres(barb), largest_part*norm2(way))
    do i = 1, size(places, 2), 3
      places(:, i) = foot + way - merge(0.0_wp, behind*length, i == 1)*along
      places(:, i + 1) = places(:, i) - length*(along + slope*across)
      places(:, i + 2) = places(:, i) - length*(along - slope*across)
    end do
  end subroutine place_heads

  !> The matrix of an arrow round an axis: its third direction is the axis, its first one points to the right as far as it can.
  pure function turned_ring(way, greatest, view) result(r)
    real(wp), intent(in) :: way(3)         !< its vector in a frame
    real(wp), intent(in) :: greatest       !< the greatest length of its vector in the film
    type(view_type), intent(in) :: view    !< direction from which the mechanism is seen
    real(wp) :: r(3, 3), axis(3), right(3)

    r = 0.0_wp
    if (.not. norm2(way) > 0.0_wp) return
    axis = unit(way)
    right = view%right
    ! an axis that points to the right itself
    if (abs(dot_product(axis, right)) > 0.9_wp) right = view%up
    right = unit(right - dot_product(axis, right)*axis)
    r = (norm2(way)/greatest)*reshape([right, cross(axis, right), axis], [3, 3])
  end function turned_ring

  !> Add the arrows to the scene.
  subroutine add_arrows(arrows, film, projection, scene)
    type(arrow_type), intent(in) :: arrows(:)         !< all arrows
    type(film_type), intent(in) :: film               !< with the links of the arrows
    type(projection_type), intent(in) :: projection   !< from space to the page
    type(scene_type), intent(inout) :: scene          !< nodes and items of the picture
    integer :: i, j, first, node

    first = size(film%p, 2) - sum(links_of(arrows)) + 1
    do i = 1, size(arrows)
      associate (arrow => arrows(i))
        select case (arrow%shape)
        case (pole)
          call scene%add_node(first, [0.0_wp, 0.0_wp, 0.0_wp], node)
          call scene%add_item(mark, as_pole, [node], text=arrow%text)
          call scene%show_while([(is_on_page(arrow%ways(:, j), projection), j=1, film%n_frames)])
        case (ring)
          call add_ring(arrow, first, projection, scene)
        case default
          call add_straight(arrow, first, scene)
        end select
        first = first + links_of(arrow)
      end associate
    end do
  end subroutine add_arrows

  !> Add a straight arrow with one head or two.
  subroutine add_straight(arrow, first, scene)
    type(arrow_type), intent(in) :: arrow             !< the arrow
    integer, intent(in) :: first                      !< its first link
    type(scene_type), intent(inout) :: scene          !< nodes and items of the picture
    integer :: j, foot, ends(7)

    if (.not. allocated(arrow%feet)) call scene%add_node(arrow%link, arrow%foot, foot)
    do j = 1, links_of(arrow)
      call scene%add_node(first + j - 1, [0.0_wp, 0.0_wp, 0.0_wp], ends(j))
    end do
    if (allocated(arrow%feet)) foot = ends(links_of(arrow))
    if (arrow%shape == straight) then
      call scene%add_item(segments, arrow%style, [foot, ends(1), ends(1), ends(2), ends(1), ends(3)], text=arrow%text)
    else
      call scene%add_item(segments, arrow%style, [foot, ends(1), ends(1), ends(2), ends(1), ends(3), ends(4), ends(5), &
                                                  ends(4), ends(6)], text=arrow%text)
    end if
  end subroutine add_straight

  !> Add an arrow round an axis, counterclockwise where the axis points to the viewer.
  subroutine add_ring(arrow, link, projection, scene)
    type(arrow_type), intent(in) :: arrow             !< the arrow
    integer, intent(in) :: link                       !< its link
    type(projection_type), intent(in) :: projection   !< from space to the page
    type(scene_type), intent(inout) :: scene          !< nodes and items of the picture
    real(wp) :: r, length, back(2), out(2), tip(2)
    integer :: nodes(0:steps), barbs(2), j
    real(wp) :: angle

    r = radius*arrow%greatest()
    do j = 0, steps
      angle = first_angle + (last_angle - first_angle)*j/steps
      tip = r*[cos(angle), sin(angle)]
      call scene%add_node(link, [tip, 0.0_wp], nodes(j))
    end do
    ! the barbs keep to the chord that ends at the tip of a bent arrow
    length = min(projection%metres(barb), largest_part*2.0_wp*r)
    angle = last_angle - 0.5_wp*length/r
    back = length*[sin(angle), -cos(angle)]
    out = slope*length*[cos(angle), sin(angle)]
    call scene%add_node(link, [tip + back + out, 0.0_wp], barbs(1))
    call scene%add_node(link, [tip + back - out, 0.0_wp], barbs(2))
    call scene%add_item(open_path, arrow%style, [nodes, barbs(1), nodes(steps), barbs(2)], text=arrow%text)
  end subroutine add_ring

  !> Whether a pole is on the page.
  pure logical function is_on_page(way, projection)
    real(wp), intent(in) :: way(3)                    !< its place as find_arrows leaves it
    type(projection_type), intent(in) :: projection   !< from space to the page
    real(wp) :: xy(2), depth

    is_on_page = is_near(way)
    if (.not. is_on_page) return
    call projection%on_page(way, xy, depth)
    is_on_page = all(xy > 0.0_wp) .and. all(xy < [projection%width, projection%height])
  end function is_on_page
end module mech9_arrow_drawing
