!> The places of sliding pairs: the link that carries the block and the one that guides it, the place of the block, and
!> its travel. Some of these pairs are a tube and a rod in it.
module mech9_slide_places
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn
  use mech9_pose, only: pose_type, compose, inverse, transformed
  use mech9_pair, only: pair_type, pair_motion_type, screw_factors_type
  use mech9_mechanism, only: mechanism_type
  use mech9_film, only: film_type
  use mech9_pair_axes, only: sliding, screwing, turning, free
  use mech9_skeleton, only: skeleton_type, place_type
  implicit none
  private
  public :: place_slides, find_pose, carried_to, along_rod

  !> Places nearer to each other than this part of the mechanism's size count as one.
  real(wp), parameter :: same = 0.01_wp
  !> The place of the mouth of a tube, as a part of the least distance between the ends.
  real(wp), parameter :: mouth = 0.62_wp
  !> A guide is lengthened to an end of a stop that is nearer than this multiple of the mechanism's size, or of its travel.
  real(wp), parameter :: near = 2.0_wp

  !> The pins of one link: the places of its other pairs, in the system of the link.
  type :: pins_type
    integer :: count = 0
    logical :: alone = .true.           !< the link has no traced points at other places
    real(wp) :: beside(2) = 0.0_wp      !< reach of such points from the first pin, along the axis of the slide and against it [m]
    real(wp), allocatable :: at(:, :)   !< (3,count)
  contains
    procedure :: all_at_one_place
  end type pins_type

contains

  !> Find the places of all sliding pairs; those of the other pairs must be known.
  subroutine place_slides(mechanism, film, skeleton)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(film_type), intent(in) :: film             !< poses and values at the outputs of the run
    type(skeleton_type), intent(inout) :: skeleton  !< places at which the pairs are drawn
    type(pins_type) :: pins(2)
    integer :: k, side

    do k = 1, size(skeleton%places)
      if (skeleton%places(k)%kind /= sliding .and. skeleton%places(k)%kind /= screwing) cycle
      if (skeleton%places(k)%drawn_by > 0) cycle
      do side = 1, 2
        call find_pins(mechanism, skeleton, k, side, pins(side))
      end do
      call judge_telescopic(film, pins, skeleton%size, skeleton%places(k))
      if (.not. skeleton%places(k)%telescopic) then
        call choose_carrier(pins, skeleton%size, skeleton%places(k))
        call seat_block(pins(skeleton%places(k)%carrier), skeleton%size, skeleton%places(k))
      end if
      call find_travel(film, skeleton%places(k))
    end do
    call reach_stops(mechanism, skeleton)
  end subroutine place_slides

  !> List the places of the other pairs of a link that turn or are the user's. If there are none, list the places of its
  !> traced points.
  subroutine find_pins(mechanism, skeleton, k, slide_side, pins)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(skeleton_type), intent(in) :: skeleton    !< places at which the pairs are drawn
    integer, intent(in) :: k                       !< number of the sliding pair
    integer, intent(in) :: slide_side              !< 1: its reference link is looked at, 2: its moving link
    type(pins_type), intent(out) :: pins           !< places of the other pairs of the link
    real(wp) :: along
    integer :: i, j, side, own

    associate (graph => skeleton%graph, link => skeleton%places(k)%links(slide_side))
      allocate (pins%at(3, graph%first(link + 1) - graph%first(link) + size(mechanism%points)), source=0.0_wp)
      do i = graph%first(link), graph%first(link + 1) - 1
        j = graph%pair_at(i)
        if (j == k) cycle
        side = merge(1, 2, skeleton%places(j)%links(1) == link)
        if (skeleton%places(j)%kind == turning .or. (skeleton%places(j)%kind == free .and. side == 2)) &
          call add_pin(pins, skeleton%places(j)%points(:, side))
      end do
      own = pins%count
      do i = 1, size(mechanism%points)
        if (mechanism%points(i)%link /= link) cycle
        if (own == 0) then
          call add_pin(pins, mechanism%points(i)%position)
        else if (norm2(mechanism%points(i)%position - pins%at(:, 1)) > same*skeleton%size) then
          pins%alone = .false.
          along = dot_product(mechanism%points(i)%position - pins%at(:, 1), skeleton%places(k)%axes(:, slide_side))
          pins%beside = max(pins%beside, [along, -along])
        end if
      end do
    end associate
  end subroutine find_pins

  !> Add a point to the pins of a link.
  pure subroutine add_pin(pins, point)
    type(pins_type), intent(inout) :: pins  !< places of the other pairs of the link
    real(wp), intent(in) :: point(3)        !< the point, in the system of the link [m]

    pins%count = pins%count + 1
    pins%at(:, pins%count) = point
  end subroutine add_pin

  !> Whether a link has pins that are all at one place of a line.
  pure logical function all_at_one_place(self, point, axis, tolerance)
    class(pins_type), intent(in) :: self  !< places of the other pairs of a link
    real(wp), intent(in) :: point(3)      !< a point of the line, in the system of the link [m]
    real(wp), intent(in) :: axis(3)       !< direction of the line, in the axes of the link, of unit length
    real(wp), intent(in) :: tolerance     !< distance up to which places are the same [m]
    integer :: i

    all_at_one_place = self%count > 0
    do i = 1, self%count
      if (norm2(self%at(:, i) - self%at(:, 1)) > tolerance) all_at_one_place = .false.
      if (norm2(off_line(self%at(:, i), point, axis)) > tolerance) all_at_one_place = .false.
    end do
  end function all_at_one_place

  !> The vector from a line to a point, perpendicular to the line.
  pure function off_line(place, point, axis) result(across)
    real(wp), intent(in) :: place(3)  !< the point [m]
    real(wp), intent(in) :: point(3)  !< a point of the line [m]
    real(wp), intent(in) :: axis(3)   !< direction of the line, of unit length
    real(wp) :: across(3)

    across = place - point
    across = across - dot_product(across, axis)*axis
  end function off_line

  !> Find whether a sliding pair is a tube and a rod. It is if each of its two moving links has its pins at one place of
  !> the axis, and these places never come together. Other points of the links may stand beside the tube and the rod,
  !> but not beyond their ends. The tip of a lever that slides through a block would be beyond.
  subroutine judge_telescopic(film, pins, size, place)
    type(film_type), intent(in) :: film       !< poses and values at the outputs of the run
    type(pins_type), intent(in) :: pins(2)    !< pins of the reference link and of the moving link
    real(wp), intent(in) :: size              !< size of the mechanism at the start [m]
    type(place_type), intent(inout) :: place  !< place and travel of the sliding pair
    real(wp) :: apart, least, most
    integer :: frame, side

    if (any(place%links == 1)) return
    do side = 1, 2
      if (.not. pins(side)%all_at_one_place(place%points(:, side), place%axes(:, side), same*size)) return
      place%pins(:, side) = pins(side)%at(:, 1)
    end do
    least = huge(least)
    most = -huge(most)
    do frame = 1, film%n_frames
      apart = dot_product(film%local(frame, place%links(1), film%position(frame, place%links(2), place%pins(:, 2))) &
                          - place%pins(:, 1), place%axes(:, 1))
      least = min(least, apart)
      most = max(most, apart)
    end do
    if (least > 5.0_wp*same*size) then
      place%telescopic = all([pins(1)%beside, pins(2)%beside] <= [least, 0.0_wp, 0.0_wp, least] + same*size)
    else if (most < -5.0_wp*same*size) then
      place%telescopic = all([pins(1)%beside, pins(2)%beside] <= [0.0_wp, -most, -most, 0.0_wp] + same*size)
    end if
    if (.not. place%telescopic) return
    place%carrier = 1
    if (least < 0.0_wp) least = most
    place%points(:, 1) = place%pins(:, 1) + mouth*least*place%axes(:, 1)
  end subroutine judge_telescopic

  !> Choose the link that carries the block. The frame always guides. Otherwise the link whose pins are all at one place
  !> of the axis carries the block. If this holds for neither link the moving link does.
  subroutine choose_carrier(pins, size, place)
    type(pins_type), intent(in) :: pins(2)    !< pins of the reference link and of the moving link
    real(wp), intent(in) :: size              !< size of the mechanism at the start [m]
    type(place_type), intent(inout) :: place  !< place and travel of the sliding pair
    logical :: is_block(2)
    integer :: side

    do side = 1, 2
      is_block(side) = pins(side)%all_at_one_place(place%points(:, side), place%axes(:, side), same*size)
    end do
    place%carrier = 2
    if (is_block(1) .and. .not. is_block(2)) place%carrier = 1
    ! a lever has its pivot on the axis too, but it also has other points
    if (all(is_block) .and. pins(1)%alone .and. .not. pins(2)%alone) place%carrier = 1
    if (place%links(1) == 1) place%carrier = 2
    if (place%links(2) == 1) place%carrier = 1
  end subroutine choose_carrier

  !> Put the block at the nearest pin of its link if that is on the axis. Otherwise put it beside that pin, unless the
  !> given point is near that place.
  subroutine seat_block(pins, size, place)
    type(pins_type), intent(in) :: pins       !< pins of the link that carries the block
    real(wp), intent(in) :: size              !< size of the mechanism at the start [m]
    type(place_type), intent(inout) :: place  !< place and travel of the sliding pair
    real(wp) :: across(3), foot(3), distance, nearest
    integer :: i

    nearest = huge(nearest)
    associate (point => place%points(:, place%carrier), axis => place%axes(:, place%carrier))
      foot = point
      do i = 1, pins%count
        distance = norm2(pins%at(:, i) - point)
        if (distance >= nearest) cycle
        nearest = distance
        across = off_line(pins%at(:, i), point, axis)
        foot = pins%at(:, i) - across
        ! only the direction of an axis far from the link has a meaning, and the block is drawn at the pin
        if (norm2(across) > 0.75_wp*size .and. place%kind == sliding) foot = pins%at(:, i)
        if (norm2(across) > same*size .and. norm2(foot - point) < 0.3_wp*size) foot = point
      end do
      place%points(:, place%carrier) = foot
    end associate
  end subroutine seat_block

  !> Find the travel of the carrier's point in the other link.
  subroutine find_travel(film, place)
    type(film_type), intent(in) :: film       !< poses and values at the outputs of the run
    type(place_type), intent(inout) :: place  !< place and travel of the sliding pair
    real(wp) :: at(3), along
    integer :: frame, guide

    guide = 3 - place%carrier
    do frame = 1, film%n_frames
      at = film%local(frame, place%links(guide), &
                      film%position(frame, place%links(place%carrier), place%points(:, place%carrier)))
      if (frame == 1) place%points(:, guide) = at
      along = dot_product(at - place%points(:, guide), place%axes(:, guide))
      place%least = min(place%least, along)
      place%most = max(place%most, along)
    end do
  end subroutine find_travel

  !> Lengthen the guides of sliding pairs to the ends of their stops, except those that are far away. Tubes become as long as their
  !> pistons need.
  subroutine reach_stops(mechanism, skeleton)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(skeleton_type), intent(inout) :: skeleton  !< places at which the pairs are drawn, with the travel of blocks
    real(wp) :: along, allowed, least, most
    integer :: i, end
    logical :: found

    do i = 1, size(mechanism%stops)
      associate (stop => mechanism%stops(i), place => skeleton%places(mechanism%stops(i)%coordinate))
        if (place%kind == turning .or. place%kind == free .or. place%drawn_by > 0) cycle
        allowed = near*max(skeleton%size, place%most - place%least)
        least = place%least
        most = place%most
        do end = 1, 2
          if (.not. stop%has_end(end)) cycle
          call find_travel_to(mechanism%pairs(stop%coordinate)%pair, place, stop%ends(end), along, found)
          if (place%telescopic) then
            if (found) call make_room_for_piston(along, place)
            cycle
          end if
          if (.not. found .or. along < least - allowed .or. along > most + allowed) cycle
          place%least = min(place%least, along)
          place%most = max(place%most, along)
        end do
      end associate
    end do
  end subroutine reach_stops

  !> Compute the travel of the block of a sliding pair at a value of its coordinate.
  subroutine find_travel_to(pair, place, q, along, found)
    class(pair_type), intent(in) :: pair     !< the pair
    type(place_type), intent(in) :: place    !< place and travel of the pair
    real(wp), intent(in) :: q                !< the coordinate [rad, m]
    real(wp), intent(out) :: along           !< from the place of the block in the first frame, along the axis of the guide [m]
    logical, intent(out) :: found            !< the pair has this value
    type(pose_type) :: pose
    real(wp) :: tangent(3)
    integer :: guide

    along = 0.0_wp
    call find_pose(pair, q, pose, tangent, found)
    if (.not. found) return
    guide = 3 - place%carrier
    along = dot_product(carried_to(pose, place) - place%points(:, guide), place%axes(:, guide))
  end subroutine find_travel_to

  !> Lengthen a tube so that a piston on the rod, which is at the mouth at one end of a stop, stays in the tube wherever the rod goes.
  pure subroutine make_room_for_piston(along, place)
    real(wp), intent(in) :: along              !< travel of the mouth along the rod at the end of the stop [m]
    type(place_type), intent(inout) :: place   !< place and travel of the pair
    real(wp), parameter :: spare = 0.1_wp, largest = 0.92_wp
    real(wp) :: needed, shortest, shift

    needed = deepest(along, place) + spare*norm2(place%points(:, 1) - place%pins(:, 1))
    shortest = norm2(place%points(:, 1) - place%pins(:, 1)) + shortest_rod(place)
    shift = needed - norm2(place%points(:, 1) - place%pins(:, 1))
    if (shift <= 0.0_wp .or. needed > largest*shortest) return
    shift = shift*sign(1.0_wp, dot_product(place%points(:, 1) - place%pins(:, 1), place%axes(:, 1)))
    place%points = place%points + shift*place%axes
  end subroutine make_room_for_piston

  !> The part of a rod outside its tube where this is least [m].
  pure real(wp) function shortest_rod(place)
    type(place_type), intent(in) :: place   !< place and travel of the pair
    real(wp) :: rod

    rod = dot_product(place%pins(:, 2) - place%points(:, 2), place%axes(:, 2))
    shortest_rod = min(abs(rod - place%least), abs(rod - place%most))
  end function shortest_rod

  !> How deep in the tube a place of the rod is where the rod is farthest in; negative where it never goes into the tube [m].
  pure real(wp) function deepest(along, place)
    real(wp), intent(in) :: along            !< the place: travel of the mouth along the rod [m]
    type(place_type), intent(in) :: place    !< place and travel of the pair
    real(wp) :: rod

    rod = dot_product(place%pins(:, 2) - place%points(:, 2), place%axes(:, 2))
    deepest = abs(rod - along) - shortest_rod(place)
  end function deepest

  !> Compute the pose of the moving link in the reference link at a value of the coordinate, and the direction in which it moves.
  subroutine find_pose(pair, q, pose, tangent, found)
    class(pair_type), intent(in) :: pair       !< the pair
    real(wp), intent(in) :: q                  !< the coordinate [rad, m]
    type(pose_type), intent(out) :: pose       !< of the moving link in the reference link
    real(wp), intent(out) :: tangent(3)        !< rate of the moving frame's origin by q, in the axes of the reference link [m/rad, 1]
    logical, intent(out) :: found              !< the pair has this value
    type(screw_factors_type) :: factors
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    logical :: is_screw

    tangent = 0.0_wp
    call pair%as_screw(factors, is_screw)
    call pair%evaluate(q, motion, err)
    found = .not. allocated(err)
    if (.not. found) return
    if (is_screw) then
      pose = motion%pose
    else
      pose = compose(compose(factors%before, motion%pose), factors%after)
    end if
    tangent = turn(factors%before%r, motion%v)
  end subroutine find_pose

  !> The place of the point that carries the symbol of a pair in its other link, at a pose of the moving link in the reference link.
  pure function carried_to(pose, place) result(at)
    type(pose_type), intent(in) :: pose      !< of the moving link in the reference link
    type(place_type), intent(in) :: place    !< place of the pair
    real(wp) :: at(3)

    if (place%carrier == 2) then
      at = transformed(pose, place%points(:, 2))
    else
      at = transformed(inverse(pose), place%points(:, 1))
    end if
  end function carried_to

  !> Whether a place of a rod is on the rod, and never behind the bottom of its tube.
  pure logical function along_rod(along, place)
    real(wp), intent(in) :: along            !< the place: travel of the mouth along the rod [m]
    type(place_type), intent(in) :: place    !< place and travel of the pair
    real(wp) :: rod

    rod = dot_product(place%pins(:, 2) - place%points(:, 2), place%axes(:, 2))
    along_rod = (rod - along)*rod > 0.0_wp .and. deepest(along, place) < norm2(place%points(:, 1) - place%pins(:, 1))
  end function along_rod
end module mech9_slide_places
