!> The symbols of stops: at each end a plate that the moving link meets where its motion ends. A rigid stop is hatched on the frame, a
!> compliant one has a buffer behind its plate.
!>
!> On a slide the plate stands across the guide, where the block meets it. The rod of a tube has a collar for the end at which the two
!> are shortest, and a piston in the tube for the other one. About a turning pair the plate stands beside the joint, where the bar or the
!> edge of the moving link meets it. Films colour the plate of an end while it pushes, and after each impact.
module mech9_stop_symbols
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, unit, turn, turn_back
  use mech9_pose, only: pose_type, transformed
  use mech9_text, only: to_text
  use mech9_part_names, only: name_in
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_film, only: film_type
  use mech9_pair_axes, only: turning, free
  use mech9_skeleton, only: skeleton_type
  use mech9_slide_places, only: find_pose, carried_to, along_rod
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, open_path, closed_path, segments, mark, in_stop, in_pushed, in_bracket, in_spring, &
                         in_hatch, as_stuck
  use mech9_symbol_shapes, only: across, block_half
  use mech9_pair_symbols, only: symbols_type
  implicit none
  private
  public :: add_stops, add_stuck_pairs

  !> One end of a stop: the plate in the link that carries it.
  type :: plate_type
    integer :: link = 0                 !< number of the link
    real(wp) :: at(3) = 0.0_wp          !< middle of the plate, in the system of the link [m]
    real(wp) :: away(3) = 0.0_wp        !< direction in which the motion ends there, of unit length
    real(wp) :: sides(3, 2) = 0.0_wp    !< directions of the plate's sides, of unit length
    real(wp) :: half(2) = 0.0_wp        !< halves of its sides [px]
    integer :: joint = 0                !< number of the node at the joint beside which it stands; 0: it stands on a guide
  end type plate_type

  !> Sizes on the page [px]: half the thickness of a plate and of a bar with its edge, halves of the sides of a plate across a guide, and
  !> beside a joint, its distance from the joint, half of a collar and of a piston, length of a buffer, and that of hatches.
  real(wp), parameter :: half_thickness = 2.7_wp, half_bar = 4.7_wp, on_guide(2) = [11.5_wp, 7.0_wp], &
                         at_joint(2) = [9.0_wp, 6.0_wp], from_joint = 23.0_wp, collar = 9.0_wp, piston = 5.0_wp, buffer = 12.0_wp, &
                         hatch = 6.0_wp
  !> Points nearer to the axis than this part of the mechanism's size give no direction. Directions of a link within a half turn, less
  !> this angle, have a first and a last one [rad].
  real(wp), parameter :: same = 0.004_wp, less_than_half = 0.1_wp
  !> A pair rests at rates below this part of its largest one.
  real(wp), parameter :: resting = 1.0e-9_wp

contains

  !> Add the plates of all stops, and the coloured ones that show which of them push.
  subroutine add_stops(mechanism, film, skeleton, projection, shapes, scene, symbols)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: shapes(:)                 !< (links) number of the item that shows each link; 0: none
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    type(plate_type) :: plate
    integer :: i, end, above(4)

    above = 0
    do i = 1, size(mechanism%stops)
      associate (stop => mechanism%stops(i), place => skeleton%places(mechanism%stops(i)%coordinate))
        above(:2) = shapes(place%links)
        do end = 1, 2
          if (.not. stop%has_end(end)) cycle
          call find_plate(mechanism, film, skeleton, projection, i, end, plate)
          if (plate%link == 0) cycle
          if (place%kind == turning) then
            call scene%add_node(plate%link, place%points(:, merge(1, 2, place%links(1) == plate%link)), plate%joint)
          else if (.not. within_guide(plate, symbols%guide(:, stop%coordinate), projection, scene)) then
            cycle
          end if
          call add_plate(plate, projection, stop%is_rigid, above, name_of(mechanism, i, end), scene)
          call scene%show_while(pushing_frames(film, i, end))
        end do
      end associate
    end do
  end subroutine add_stops

  !> Find the plate of one end. There is none in joints that are drawn as a whole, in balls, and in pairs of the user's procedures.
  subroutine find_plate(mechanism, film, skeleton, projection, number, end, plate)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(film_type), intent(in) :: film              !< poses of the run; the first frame is used
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: number                    !< of the stop
    integer, intent(in) :: end                       !< 1: the low one, 2: the high one
    type(plate_type), intent(out) :: plate           !< the plate, with link 0 where there is none
    type(pose_type) :: pose
    real(wp) :: tangent(3), along
    integer :: direction, k
    logical :: found

    direction = 2*end - 3
    k = mechanism%stops(number)%coordinate
    associate (place => skeleton%places(k))
      found = place%drawn_by == 0 .and. .not. place%ball .and. (place%kind /= free .or. size(place%guide, 2) > 0)
      if (found) call find_pose(mechanism%pairs(k)%pair, mechanism%stops(number)%ends(end), pose, tangent, found)
      if (.not. found) return
      if (place%kind == turning) then
        call stand_beside(mechanism, skeleton, projection, k, pose, direction, plate)
      else if (place%kind == free) then
        plate%link = place%links(1)
        plate%away = direction*unit(tangent)
        plate%at = transformed(pose, place%points(:, 2)) + projection%metres(block_half + half_thickness)*plate%away
      else
        plate%link = place%links(3 - place%carrier)
        plate%away = direction*(2*place%carrier - 3)*place%axes(:, 3 - place%carrier)
        plate%at = carried_to(pose, place) &
                   + projection%metres(half_thickness + merge(0.0_wp, block_half, place%telescopic))*plate%away
      end if
      if (place%kind == turning) return
      plate%sides(:, 1) = sideways(plate%away, turn_back(film%r(:, :, plate%link, 1), projection%view%toward))
      plate%sides(:, 2) = cross(plate%away, plate%sides(:, 1))
      plate%half = on_guide
      if (.not. place%telescopic) return
      ! the collar is outside the tube, and the piston in it
      along = dot_product(carried_to(pose, place) - place%points(:, 2), place%axes(:, 2))
      plate%half = merge(collar, piston, dot_product(place%pins(:, 2) - place%points(:, 2), plate%away) > 0.0_wp)
      if (.not. along_rod(along, place)) plate%link = 0
    end associate
  end subroutine find_plate

  !> The name of an end of a stop, with its place.
  pure function name_of(mechanism, number, end) result(name)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    integer, intent(in) :: number                    !< of the stop
    integer, intent(in) :: end                       !< 1: the low one, 2: the high one
    character(len=:), allocatable :: name

    associate (stop => mechanism%stops(number))
      name = 'stop '//to_text(number)//': '//trim(merge('low ', 'high', end == 1))//' end of '// &
             coordinate_in_words(mechanism, stop%coordinate)//' at '// &
             to_text(stop%ends(end)/unit_of(mechanism, stop%coordinate), 6)//' '//trim(unit_name(mechanism, stop%coordinate))
    end associate
  end function name_of

  !> A coordinate with its name, if it has one: q1 (hip).
  pure function coordinate_in_words(mechanism, coordinate) result(words)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    integer, intent(in) :: coordinate                !< number of the coordinate
    character(len=:), allocatable :: words

    words = trim(name_in(mechanism%names%coordinates, coordinate))
    if (words /= '') words = ' ('//words//')'
    words = 'q'//to_text(coordinate)//words
  end function coordinate_in_words

  !> The direction across a guide in which it is seen from the side.
  pure function sideways(axis, toward) result(side)
    real(wp), intent(in) :: axis(3)     !< direction of the guide, of unit length
    real(wp), intent(in) :: toward(3)   !< direction to the viewer, of unit length
    real(wp) :: side(3)
    real(wp) :: sides(3, 2)

    side = cross(axis, toward)
    if (norm2(side) > 0.1_wp) then
      side = unit(side)
    else
      sides = across(axis)
      side = sides(:, 1)
    end if
  end function sideways

  !> Whether a plate stands within a guide: not beyond an end of it that was too far away, or beyond the end of a tube or rod.
  pure logical function within_guide(plate, guide, projection, scene)
    type(plate_type), intent(in) :: plate            !< the plate
    integer, intent(in) :: guide(2)                  !< numbers of the nodes at the ends of the guide; 0: there is none
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(in) :: scene            !< nodes and items of the picture
    real(wp) :: apart(2), allowed
    integer :: i

    within_guide = .true.
    if (any(guide == 0)) return
    if (any(scene%node_link(guide) /= plate%link)) return
    allowed = projection%metres(half_thickness)
    do i = 1, 2
      apart(i) = dot_product(plate%at - scene%node_at(:, guide(i)), plate%away)
    end do
    within_guide = minval(apart) < allowed .and. maxval(apart) > -allowed
  end function within_guide

  !> Find the plate beside a joint that turns. The frame carries it, or the reference link, or the moving link where the reference link
  !> is a part of a joint.
  subroutine stand_beside(mechanism, skeleton, projection, k, pose, direction, plate)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: k                         !< number of the coordinate
    type(pose_type), intent(in) :: pose              !< of the moving link in the reference link at the end of the stop
    integer, intent(in) :: direction                 !< of the motion that ends there: 1 or -1
    type(plate_type), intent(out) :: plate           !< the plate
    real(wp) :: ray(3), sense
    integer :: carrier

    associate (place => skeleton%places(k))
      carrier = merge(2, 1, place%links(2) == 1 .or. place%links(1) > mechanism%structure%shown_links())
      sense = direction*(3 - 2*carrier)
      plate%link = place%links(carrier)
      ray = foremost(mechanism, skeleton, k, 3 - carrier, sense)
      if (carrier == 1) then
        ray = turn(pose%r, ray)
      else
        ray = turn_back(pose%r, ray)
      end if
      plate%away = sense*cross(place%axes(:, carrier), ray)
      plate%at = place%points(:, carrier) + projection%metres(from_joint)*ray &
                 + projection%metres(half_bar + half_thickness)*plate%away
      plate%sides(:, 1) = ray
      plate%sides(:, 2) = place%axes(:, carrier)
      plate%half = at_joint
    end associate
  end subroutine stand_beside

  !> The direction from a joint to the point of a link that comes first as the link turns. Where its points lie all around the joint it
  !> is that of the farthest point, where it has none that of another axis.
  function foremost(mechanism, skeleton, k, side, sense) result(ray)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    integer, intent(in) :: k                         !< number of the pair
    integer, intent(in) :: side                      !< of the pair, on which the link is
    real(wp), intent(in) :: sense                    !< 1 or -1: the link turns about the axis, or against it
    real(wp) :: ray(3)
    real(wp), allocatable :: rays(:, :), angles(:)
    real(wp) :: sides(3, 2)
    integer :: n, farthest, first, i

    associate (place => skeleton%places(k), axis => skeleton%places(k)%axes(:, side))
      call list_rays(mechanism, skeleton, k, side, rays)
      n = size(rays, 2)
      if (n == 0) then
        sides = across(axis)
        ray = sides(:, 1)
        return
      end if
      farthest = maxloc([(norm2(rays(:, i)), i=1, n)], dim=1)
      ray = unit(rays(:, farthest))
      angles = [(atan2(dot_product(cross(ray, rays(:, i)), axis), dot_product(ray, rays(:, i))), i=1, n)]
      if (maxval(angles) - minval(angles) > acos(-1.0_wp) - less_than_half) return
      first = maxloc(sense*angles, dim=1)
      ray = unit(rays(:, first))
    end associate
  end function foremost

  !> List the vectors across the axis of a joint to the other pairs and the traced points of a link. Where there are none, those along the
  !> axes of other pairs.
  subroutine list_rays(mechanism, skeleton, k, side, rays)
    type(mechanism_type), intent(in) :: mechanism           !< the mechanism
    type(skeleton_type), intent(in) :: skeleton             !< places at which the pairs are drawn
    integer, intent(in) :: k                                !< number of the pair
    integer, intent(in) :: side                             !< of the pair, on which the link is
    real(wp), allocatable, intent(out) :: rays(:, :)        !< (3,n) in the axes of the link [m]
    real(wp), allocatable :: along(:, :)
    integer :: i, j, other

    allocate (rays(3, 0), along(3, 0))
    associate (graph => skeleton%graph, place => skeleton%places(k), link => skeleton%places(k)%links(side))
      do i = graph%first(link), graph%first(link + 1) - 1
        j = graph%pair_at(i)
        if (j == k) cycle
        other = merge(1, 2, skeleton%places(j)%links(1) == link)
        call add_ray(skeleton%places(j)%points(:, other) - place%points(:, side), rays)
        call add_ray(skeleton%size*skeleton%places(j)%axes(:, other), along)
      end do
      do i = 1, size(mechanism%points)
        if (mechanism%points(i)%link == link) call add_ray(mechanism%points(i)%position - place%points(:, side), rays)
      end do
    end associate
    if (size(rays, 2) == 0) call move_alloc(along, rays)

  contains

    !> Add the part of a vector across the axis, unless it is short.
    subroutine add_ray(vector, list)
      real(wp), intent(in) :: vector(3)                    !< in the axes of the link [m]
      real(wp), allocatable, intent(inout) :: list(:, :)   !< (3,n) the vectors so far
      real(wp) :: part(3)

      associate (axis => skeleton%places(k)%axes(:, side))
        part = vector - dot_product(vector, axis)*axis
      end associate
      if (norm2(part) > same*skeleton%size) list = reshape([list, part], [3, size(list, 2) + 1])
    end subroutine add_ray
  end subroutine list_rays

  !> Add one plate, with what is behind it, and above it the coloured plate of films.
  subroutine add_plate(plate, projection, is_rigid, above, name, scene)
    type(plate_type), intent(in) :: plate            !< the plate
    type(projection_type), intent(in) :: projection  !< from space to the page
    logical, intent(in) :: is_rigid                  !< nothing gives way behind it
    integer, intent(in) :: above(4)                  !< numbers of the items that it lies upon; 0: none
    character(len=*), intent(in) :: name             !< name of the stop
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp), parameter :: signs(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
    !> The buffer: places from the front to the back, as parts of its length, and to the sides, as parts of the plate's.
    real(wp), parameter :: zigzag(2, 6) = reshape([0.0_wp, 0.0_wp, 0.2_wp, -0.5_wp, 0.4_wp, 0.5_wp, 0.6_wp, -0.5_wp, 0.8_wp, &
                                                   0.5_wp, 1.0_wp, 0.0_wp], [2, 6])
    integer :: corners(4), bends(size(zigzag, 2)), foot, i
    real(wp) :: back(3)

    if (plate%joint > 0) then
      call scene%add_node(plate%link, plate%at - projection%metres(plate%half(1))*plate%sides(:, 1), foot)
      call scene%add_item(open_path, in_bracket, [plate%joint, foot], plate%link, above=above)
    end if
    back = plate%at
    if (.not. is_rigid) then
      back = back + projection%metres(buffer)*plate%away
      do i = 1, size(bends)
        call scene%add_node(plate%link, plate%at + projection%metres(buffer)*zigzag(1, i)*plate%away &
                            + projection%metres(plate%half(1))*zigzag(2, i)*plate%sides(:, 1), bends(i))
      end do
      call scene%add_item(open_path, in_spring, bends, above=above)
    end if
    if (plate%link == 1) call add_hatches(plate, back, projection, above, scene)
    do i = 1, 4
      call scene%add_node(plate%link, plate%at + projection%metres(1.0_wp)*matmul(plate%sides, plate%half*signs(:, i)), corners(i))
    end do
    call scene%add_item(closed_path, in_stop, corners, plate%link, above=above, text=name)
    call scene%add_item(closed_path, in_pushed, corners, above=[scene%n_items, 0, 0, 0], &
                        text=name//', pushed')
  end subroutine add_plate

  !> Add the hatches of the frame behind a plate, or behind its buffer.
  subroutine add_hatches(plate, back, projection, above, scene)
    type(plate_type), intent(in) :: plate            !< the plate
    real(wp), intent(in) :: back(3)                  !< middle of the line from which the hatches go [m]
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: above(4)                  !< numbers of the items that they lie upon; 0: none
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer, parameter :: n = 4
    real(wp), parameter :: slope = 0.7_wp
    integer :: hatches(2*n + 2), i
    real(wp) :: from(3), side(3)

    side = projection%metres(plate%half(1))*plate%sides(:, 1)
    do i = 1, n
      from = back + (2.0_wp*i/n - 1.0_wp)*side
      call scene%add_node(plate%link, from, hatches(2*i - 1))
      call scene%add_node(plate%link, from + projection%metres(hatch)*(plate%away - slope*plate%sides(:, 1)), hatches(2*i))
    end do
    call scene%add_node(plate%link, back - side, hatches(2*n + 1))
    call scene%add_node(plate%link, back + side, hatches(2*n + 2))
    call scene%add_item(segments, in_hatch, hatches, above=above)
  end subroutine add_hatches

  !> The frames in which an end of a stop pushes, with those after an impact, which would pass unseen otherwise.
  pure function pushing_frames(film, number, end) result(frames)
    type(film_type), intent(in) :: film    !< values and impacts at the outputs of the run
    integer, intent(in) :: number          !< of the stop
    integer, intent(in) :: end             !< 1: the low one, 2: the high one
    logical :: frames(film%n_frames)
    integer, parameter :: part = 80        ! of the film in which an impact is seen
    integer :: i, column

    frames = .false.
    do column = 1, size(film%names)
      if (film%names(column)%text == 'S'//to_text(number)) frames = (3 - 2*end)*film%values(column, :film%n_frames) > 0.0_wp
    end do
    do i = 1, film%n_frames
      if (size(film%hit, 2) == 0) exit
      if (film%hit(end, number, i)) frames(i:min(film%n_frames, i + film%n_frames/part)) = .true.
    end do
  end function pushing_frames

  !> Add a mark at each pair that sticks, for the frames in which it does. Pairs with a smooth law never stick.
  subroutine add_stuck_pairs(mechanism, film, symbols, scene)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(film_type), intent(in) :: film              !< rates of coordinates with friction at the outputs of the run
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer :: i

    do i = 1, size(film%rates, 1)
      associate (friction => mechanism%frictions(i), rates => abs(film%rates(i, :film%n_frames)))
        if (friction%is_smooth) cycle
        call scene%add_item(mark, as_stuck, symbols%node(friction%coordinate:friction%coordinate), &
                            text='friction '//to_text(i)//': '//coordinate_in_words(mechanism, friction%coordinate)//' sticks')
        call scene%show_while(rates <= resting*maxval(rates))
      end associate
    end do
  end subroutine add_stuck_pairs
end module mech9_stop_symbols
