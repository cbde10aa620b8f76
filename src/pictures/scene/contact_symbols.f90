!> The symbols of contacts of links: the ball, with lines on it that show how it rolls, and the plane or the ball that it meets.
!>
!> A ball looks like a circle from every side. A plane is drawn as far as the ball comes: as a line with hatches at the filled side where a
!> planar mechanism is seen along its normal, else as a rectangle.
module mech9_contact_symbols
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_rotation, only: cross, unit, turn_back
  use mech9_mechanism, only: mechanism_type
  use mech9_scene_paths, only: add_guide
  use mech9_contact, only: contact_type, plane_surface, ball_surface, profile_surface
  use mech9_film, only: film_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, open_path, closed_path, segments, mark, in_ground, in_hatch, in_bracket, in_surface, &
                         in_rolling, as_sphere
  use mech9_symbol_shapes, only: across
  implicit none
  private
  public :: add_surfaces, add_balls

  !> Room of a plane beyond the places of the ball, distance and length of its hatches [px]; most hatches.
  real(wp), parameter :: plane_more = 24.0_wp, hatch_step = 8.0_wp, hatch = 7.0_wp
  integer, parameter :: most_hatches = 80
  !> Corners of a circle that is drawn on a ball.
  integer, parameter :: corners = 36
  !> Least sine of the angle between the normal of a plane and the direction of the view at which its hatches are seen.
  real(wp), parameter :: seen_from_side = 0.05_wp

contains

  !> Add the planes and paths of all contacts, which all other things cover.
  subroutine add_surfaces(mechanism, film, projection, scene)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(film_type), intent(in) :: film              !< poses at the outputs of the run
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer :: i

    do i = 1, size(mechanism%contacts)
      if (mechanism%contacts(i)%surface == plane_surface) &
        call add_plane(mechanism%contacts(i), name_of(mechanism%contacts(i)%number), film, projection, scene)
      if (mechanism%contacts(i)%surface == profile_surface) &
        call add_guide(mechanism%contacts(i)%outline(), mechanism%contacts(i)%links(2), 1.0_wp/projection%scale, scene)
    end do
  end subroutine add_surfaces

  !> Add the balls of all contacts. Each is drawn once, however many contacts share it.
  subroutine add_balls(mechanism, film, projection, scene)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(film_type), intent(in) :: film              !< poses at the outputs of the run
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer :: i, j

    do i = 1, size(mechanism%contacts)
      associate (contact => mechanism%contacts(i))
        if (contact%surface /= ball_surface .or. .not. contact%other_radius > 0.0_wp) cycle
        if (.not. (any([(same_surface(contact, mechanism%contacts(j)), j=1, i - 1)]))) then
          call add_sphere(contact%links(2), contact%origin, contact%other_radius, name_of(contact%number), projection, scene)
        end if
      end associate
    end do
    do i = 1, size(mechanism%contacts)
      associate (contact => mechanism%contacts(i))
        if (.not. contact%radius > 0.0_wp .or. any([(same_ball(contact, mechanism%contacts(j)), j=1, i - 1)])) cycle
        call add_sphere(contact%links(1), contact%center, contact%radius, name_of(contact%number), projection, scene)
        call add_lines(contact, film, projection, scene)
      end associate
    end do
  end subroutine add_balls

  !> The name of a contact.
  pure function name_of(number) result(name)
    integer, intent(in) :: number   !< of the contact
    character(len=:), allocatable :: name

    name = 'contact '//to_text(number)
  end function name_of

  !> Whether two contacts have one ball for a surface.
  pure logical function same_surface(one, other)
    type(contact_type), intent(in) :: one     !< a contact whose surface is a ball
    type(contact_type), intent(in) :: other   !< any contact

    same_surface = other%surface == ball_surface .and. one%links(2) == other%links(2) .and. &
                   all(abs(one%origin - other%origin) <= 0.0_wp) .and. abs(one%other_radius - other%other_radius) <= 0.0_wp
  end function same_surface

  !> Whether two contacts have one moving ball.
  pure logical function same_ball(one, other)
    type(contact_type), intent(in) :: one     !< a contact
    type(contact_type), intent(in) :: other   !< another one

    same_ball = one%links(1) == other%links(1) .and. all(abs(one%center - other%center) <= 0.0_wp) .and. &
                abs(one%radius - other%radius) <= 0.0_wp
  end function same_ball

  !> Add a ball.
  subroutine add_sphere(link, center, radius, name, projection, scene)
    integer, intent(in) :: link                      !< number of its link
    real(wp), intent(in) :: center(3)                !< in the system of the link [m]
    real(wp), intent(in) :: radius                   !< of the ball [m]
    character(len=*), intent(in) :: name             !< of the contact
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer :: node

    call scene%add_node(link, center, node)
    call scene%add_item(mark, as_sphere, [node], link, text=name)
    scene%items(scene%n_items)%shift = [radius/projection%metres(1.0_wp), 0.0_wp]
  end subroutine add_sphere

  !> Add the lines on a ball: in a plane two diameters, in space two circles around it.
  subroutine add_lines(contact, film, projection, scene)
    type(contact_type), intent(in) :: contact        !< the contact
    type(film_type), intent(in) :: film              !< poses at the outputs of the run; the first one is used
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp) :: axes(3, 3)
    integer :: nodes(corners), i

    associate (link => contact%links(1), center => contact%center, radius => contact%radius)
      axes(:, 3) = turn_back(film%r(:, :, link, 1), projection%view%toward)
      if (.not. projection%view%along_normal) axes(:, 3) = [0.0_wp, 0.0_wp, 1.0_wp]
      axes(:, :2) = across(axes(:, 3))
      if (projection%view%along_normal) then
        do i = 1, 2
          call scene%add_node(link, center - radius*axes(:, i), nodes(2*i - 1))
          call scene%add_node(link, center + radius*axes(:, i), nodes(2*i))
        end do
        call scene%add_item(segments, in_rolling, nodes(:4), link)
        return
      end if
      do i = 1, corners
        call scene%add_node(link, center + radius*matmul(axes(:, 1:2), on_circle(i)), nodes(i))
      end do
      call scene%add_item(open_path, in_rolling, [nodes, nodes(1)], link)
      do i = 1, corners
        call scene%add_node(link, center + radius*matmul(axes(:, 2:3), on_circle(i)), nodes(i))
      end do
      call scene%add_item(open_path, in_rolling, [nodes, nodes(1)], link)
    end associate
  end subroutine add_lines

  !> A corner of a circle with the radius 1.
  pure function on_circle(i) result(place)
    integer, intent(in) :: i   !< number of the corner
    real(wp) :: place(2)

    place = [cos(2.0_wp*pi*i/corners), sin(2.0_wp*pi*i/corners)]
  end function on_circle

  !> Add a plane, as far as the ball comes.
  subroutine add_plane(contact, name, film, projection, scene)
    type(contact_type), intent(in) :: contact        !< a contact whose surface is a plane
    character(len=*), intent(in) :: name             !< of the contact
    type(film_type), intent(in) :: film              !< poses at the outputs of the run
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp) :: sides(3, 2), low(2), high(2), at(2), toward(3), more
    integer :: nodes(4), frame

    associate (link => contact%links(2), normal => contact%normal)
      toward = turn_back(film%r(:, :, link, 1), projection%view%toward)
      sides = across(normal)
      if (norm2(cross(toward, normal)) > seen_from_side) then
        sides(:, 1) = unit(cross(toward, normal))
        sides(:, 2) = cross(normal, sides(:, 1))
      end if
      low = huge(low)
      high = -huge(high)
      do frame = 1, film%n_frames
        at = matmul(film%local(frame, link, film%position(frame, contact%links(1), contact%center)) - contact%origin, sides)
        low = min(low, at)
        high = max(high, at)
      end do
      more = contact%radius + projection%metres(plane_more)
      low = low - more
      high = high + more
      if (projection%view%along_normal .and. abs(dot_product(toward, normal)) < seen_from_side) then
        call scene%add_node(link, contact%origin + low(1)*sides(:, 1), nodes(1))
        call scene%add_node(link, contact%origin + high(1)*sides(:, 1), nodes(2))
        call scene%add_item(open_path, merge(in_ground, in_bracket, link == 1), nodes(:2), link)
        call add_hatches(contact, sides(:, 1), low(1), high(1), projection, scene)
      else
        call scene%add_node(link, contact%origin + matmul(sides, low), nodes(1))
        call scene%add_node(link, contact%origin + matmul(sides, [high(1), low(2)]), nodes(2))
        call scene%add_node(link, contact%origin + matmul(sides, high), nodes(3))
        call scene%add_node(link, contact%origin + matmul(sides, [low(1), high(2)]), nodes(4))
        call scene%add_item(closed_path, in_surface, nodes, link, text=name)
      end if
    end associate
  end subroutine add_plane

  !> Add the hatches at the filled side of a plane that is seen as a line.
  subroutine add_hatches(contact, side, low, high, projection, scene)
    type(contact_type), intent(in) :: contact        !< a contact whose surface is a plane
    real(wp), intent(in) :: side(3)                  !< direction of the line, in the axes of its link
    real(wp), intent(in) :: low                      !< beginning of the line, from the origin of the plane [m]
    real(wp), intent(in) :: high                     !< its end [m]
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer, allocatable :: nodes(:)
    real(wp) :: from(3)
    integer :: n, i

    n = max(2, min(most_hatches, int((high - low)/projection%metres(hatch_step))))
    allocate (nodes(2*n))
    do i = 1, n
      from = contact%origin + (low + (high - low)*(i - 0.5_wp)/n)*side
      call scene%add_node(contact%links(2), from, nodes(2*i - 1))
      call scene%add_node(contact%links(2), from - projection%metres(hatch)*(contact%normal + 0.6_wp*side), nodes(2*i))
    end do
    call scene%add_item(segments, in_hatch, nodes)
  end subroutine add_hatches
end module mech9_contact_symbols
