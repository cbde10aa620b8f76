!> The symbols of pairs: rings, pins, balls and blocks, the guides of blocks, and stands on the frame.
!>
!> Pairs at one place are drawn as one joint. Two axes make a universal joint and three a ball. An axis along which one
!> pair slides and about which another one turns makes a cylindrical joint.
module mech9_pair_symbols
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, unit
  use mech9_text, only: to_text
  use mech9_film, only: film_type
  use mech9_pair_axes, only: turning, sliding, screwing, free
  use mech9_skeleton, only: skeleton_type, place_type
  use mech9_projection, only: projection_type
  use mech9_symbol_shapes, only: add_block, add_pin, add_led_link, add_whole_joint, find_plane, block_half, guide_more
  use mech9_scene, only: scene_type, open_path, segments, mark, in_guide, in_ground, in_hatch, as_stand, as_ring, as_ball
  implicit none
  private
  public :: symbols_type, prepare_symbols, add_guides, add_stands, add_symbols, add_ground

  !> The nodes of all pairs, and the joints that they make.
  type :: symbols_type
    integer, allocatable :: node(:)          !< (M) node of each pair
    !> (2,M) nodes of the ends of the guide of a sliding pair; of a tube and its rod, nodes of their far ends.
    integer, allocatable :: guide(:, :)
    integer, allocatable :: plane(:, :)      !< (4,M) for the last pair of a planar joint, nodes of the corners of its plane; else 0
    integer, allocatable :: joint(:)         !< (M) first pair of the joint that the pair belongs to
    logical, allocatable :: hangs(:)         !< (M) for the first pair of each joint: it hangs from its stand
  end type symbols_type

  !> Sizes on the page [px].
  real(wp), parameter :: block_side = 10.0_wp, hatch_step = 7.0_wp, hatch_length = 7.0_wp
  !> Pairs nearer to each other than this part of the mechanism's size are one joint. Axes with a sine of their angle
  !> below the second number are parallel.
  real(wp), parameter :: same = 0.004_wp, parallel = 0.01_wp

contains

  !> Add the nodes of all pairs to the scene, and find the joints that they make.
  subroutine prepare_symbols(film, skeleton, projection, scene, symbols)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(out) :: symbols       !< nodes and joints of the pairs
    real(wp) :: more, ends(3, 2), rim(3, 4)
    integer :: k, i, side, links(2)

    allocate (symbols%node(size(skeleton%places)), symbols%guide(2, size(skeleton%places)))
    allocate (symbols%plane(4, size(skeleton%places)), source=0)
    symbols%guide = 0
    more = projection%metres(block_half + guide_more)
    do k = 1, size(skeleton%places)
      associate (place => skeleton%places(k))
        call scene%add_node(place%links(place%carrier), place%points(:, place%carrier), symbols%node(k))
        if ((place%kind /= sliding .and. place%kind /= screwing) .or. place%drawn_by > 0) cycle
        if (place%telescopic) then
          links = place%links
          ends = place%pins
        else
          side = 3 - place%carrier
          links = place%links(side)
          ends(:, 1) = place%points(:, side) + (place%least - more)*place%axes(:, side)
          ends(:, 2) = place%points(:, side) + (place%most + more)*place%axes(:, side)
        end if
        do i = 1, 2
          call scene%add_node(links(i), ends(:, i), symbols%guide(i, k))
        end do
      end associate
    end do
    symbols%joint = joints_of(film, skeleton)
    do k = 1, size(skeleton%places)
      associate (place => skeleton%places(k))
        if (place%drawn_by == 0) cycle
        symbols%node(k) = symbols%node(place%drawn_by)
        if (place%drawn_by /= k .or. place%plane_from == 0) cycle
        call find_plane(film, skeleton, place%plane_from, k, projection, links(1), rim)
        do i = 1, 4
          call scene%add_node(links(1), rim(:, i), symbols%plane(i, k))
        end do
      end associate
    end do
    allocate (symbols%hangs(size(symbols%joint)), source=.false.)
  end subroutine prepare_symbols

  !> The number of the first pair of each pair's joint. Pairs are one joint if they share a link and stand at one place of
  !> it.
  pure function joints_of(film, skeleton) result(joint)
    type(film_type), intent(in) :: film          !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    integer, allocatable :: joint(:)
    real(wp) :: at(3, size(skeleton%places))
    integer :: link, i, j, a, b, k

    joint = [(k, k=1, size(skeleton%places))]
    do k = 1, size(joint)
      associate (place => skeleton%places(k))
        at(:, k) = film%position(1, place%links(place%carrier), place%points(:, place%carrier))
        ! coordinates of a joint that is drawn as a whole belong together wherever it is
        if (place%drawn_by > 0) joint(k) = findloc(skeleton%places%drawn_by, place%drawn_by, dim=1)
      end associate
    end do
    do link = 1, skeleton%graph%n_links
      do i = skeleton%graph%first(link), skeleton%graph%first(link + 1) - 1
        a = skeleton%graph%pair_at(i)
        if (at_guide(skeleton%places(a), link) .or. is_within(skeleton%places(a), a)) cycle
        do j = skeleton%graph%first(link), i - 1
          b = skeleton%graph%pair_at(j)
          if (at_guide(skeleton%places(b), link) .or. is_within(skeleton%places(b), b)) cycle
          if (maxval(abs(at(:, a) - at(:, b))) > same*skeleton%size) cycle
          where (joint == max(joint(a), joint(b))) joint = min(joint(a), joint(b))
        end do
      end do
    end do
  end function joints_of

  !> Whether a pair is within a joint that another pair draws as a whole.
  elemental logical function is_within(place, k)
    type(place_type), intent(in) :: place  !< place and axes of the pair
    integer, intent(in) :: k               !< its number

    is_within = place%drawn_by > 0 .and. place%drawn_by /= k
  end function is_within

  !> Whether a link only guides the pair, so that the pair is no fixed place of it.
  pure logical function at_guide(place, link)
    type(place_type), intent(in) :: place  !< place and axes of the pair
    integer, intent(in) :: link            !< number of the link

    at_guide = (place%kind == sliding .or. place%kind == screwing .or. place%kind == free) &
               .and. place%links(place%carrier) /= link
  end function at_guide

  !> Add the guides on the frame: a centre line, and hatched ground beside it.
  subroutine add_guides(skeleton, projection, scene, symbols)
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    real(wp) :: ends(3, 2), axis(3), down(3)
    integer :: k

    do k = 1, size(skeleton%places)
      associate (place => skeleton%places(k))
        if (place%drawn_by == k .and. place%plane_from > 0) call add_plane(projection, symbols%plane(:, k), scene)
        if (all(symbols%guide(:, k) == 0) .or. all(place%links /= 1)) cycle
        ends(:, 1) = scene%node_at(:, symbols%guide(1, k))
        ends(:, 2) = scene%node_at(:, symbols%guide(2, k))
        call scene%add_item(open_path, in_guide, symbols%guide(:, k))
        axis = unit(ends(:, 2) - ends(:, 1))
        down = cross(axis, projection%view%toward)
        if (norm2(down) < 0.1_wp) cycle
        down = unit(down)
        if (dot_product(down, projection%view%up) > 1.0e-6_wp) down = -down
        call add_ground(projection, ends, axis, down, block_side, scene)
      end associate
    end do
  end subroutine add_guides

  !> Add the plane of a planar joint on the frame: its rim, hatched on the side that is lowest in the picture. The plane
  !> of a joint on a moving link is a part of the link's shape.
  subroutine add_plane(projection, rim, scene)
    type(projection_type), intent(in) :: projection !< from space to the page
    integer, intent(in) :: rim(4)                   !< numbers of the nodes at its corners, in turn
    type(scene_type), intent(inout) :: scene        !< nodes and items of the picture
    real(wp) :: at(3, 4), middle(3), down(3), lowest, height
    integer :: i, side

    if (scene%node_link(rim(1)) /= 1) return
    at = scene%node_at(:, rim)
    call scene%add_item(open_path, in_guide, [rim, rim(1)])
    middle = sum(at, 2)/4
    side = 1
    lowest = huge(lowest)
    do i = 1, 4
      height = dot_product(0.5_wp*(at(:, i) + at(:, 1 + modulo(i, 4))) - middle, projection%view%up)
      if (height >= lowest) cycle
      lowest = height
      side = i
    end do
    associate (from => at(:, side), to => at(:, 1 + modulo(side, 4)))
      down = unit(0.5_wp*(from + to) - middle)
      call add_ground(projection, reshape([from, to], [3, 2]), unit(to - from), down, 0.0_wp, scene)
    end associate
  end subroutine add_plane

  !> Add a hatched line of the frame, beside a guide or where a spring ends.
  subroutine add_ground(projection, ends, axis, down, aside, scene)
    type(projection_type), intent(in) :: projection !< from space to the page
    real(wp), intent(in) :: ends(3, 2)      !< (3,2) ends of the guide, in the system of link 1 [m]
    real(wp), intent(in) :: axis(3)         !< direction from the first end to the second one, in the axes of link 1, of unit length
    real(wp), intent(in) :: down(3)         !< direction across the guide to the ground, in the axes of link 1, of unit length
    real(wp), intent(in) :: aside           !< distance of the line from the guide [px]
    type(scene_type), intent(inout) :: scene !< nodes and items of the picture
    integer, parameter :: most_hatches = 200
    integer :: from, to, n, i
    integer, allocatable :: hatches(:)
    real(wp) :: step, start(3)

    start = ends(:, 1) + projection%metres(aside)*down
    call scene%add_node(1, start, from)
    call scene%add_node(1, ends(:, 2) + projection%metres(aside)*down, to)
    call scene%add_item(open_path, in_ground, [from, to])
    n = max(1, min(most_hatches, nint(norm2(ends(:, 2) - ends(:, 1))/projection%metres(hatch_step))))
    step = norm2(ends(:, 2) - ends(:, 1))/n
    allocate (hatches(2*n))
    do i = 1, n
      call scene%add_node(1, start + i*step*axis, hatches(2*i - 1))
      call scene%add_node(1, start + i*step*axis + projection%metres(hatch_length)*(down - 0.8_wp*axis), hatches(2*i))
    end do
    call scene%add_item(segments, in_hatch, hatches)
  end subroutine add_ground

  !> Add the stands of the joints that turn on the frame. A stand is below its joint, unless the links hang from it.
  subroutine add_stands(film, skeleton, projection, scene, symbols)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(inout) :: symbols     !< nodes and joints of the pairs
    logical :: done(size(skeleton%places))
    real(wp) :: direction(2)
    integer :: k

    done = .false.
    do k = 1, size(skeleton%places)
      associate (place => skeleton%places(k))
        if (place%kind /= turning .or. all(place%links /= 1) .or. place%drawn_by > 0 .or. done(symbols%joint(k))) cycle
        done(symbols%joint(k)) = .true.
        direction = [0.0_wp, 1.0_wp]
        symbols%hangs(symbols%joint(k)) = hangs(film, skeleton, projection, symbols%joint, k)
        if (symbols%hangs(symbols%joint(k))) direction = -direction
        call scene%add_shifted(mark, as_stand, symbols%node(k:k), direction)
      end associate
    end do
  end subroutine add_stands

  !> Whether the links at a joint of the frame are below it in all frames. This follows from the other joints of these
  !> links, since pairs of one joint stand at one place.
  pure logical function hangs(film, skeleton, projection, joint, k)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: joint(:)                  !< (M) first pair of the joint that each pair belongs to
    integer, intent(in) :: k                         !< number of a pair of the joint on the frame
    logical :: moved(skeleton%graph%n_links)
    real(wp) :: below, apart(3)
    integer :: frame, j

    moved = .false.
    do j = 1, size(joint)
      if (joint(j) == joint(k)) moved(skeleton%places(j)%links) = .true.
    end do
    moved(1) = .false.
    below = 0.0_wp
    hangs = .true.
    associate (place => skeleton%places(k))
      do frame = 1, film%n_frames, max(1, film%n_frames/40)
        do j = 1, size(joint)
          associate (neighbour => skeleton%places(j))
            if (joint(j) == joint(k) .or. .not. any(moved(neighbour%links))) cycle
            apart = film%position(frame, neighbour%links(neighbour%carrier), neighbour%points(:, neighbour%carrier)) &
                    - film%position(frame, place%links(1), place%points(:, 1))
          end associate
          apart = projection%view%seen(apart)
          hangs = hangs .and. apart(2) < 0.3_wp*abs(apart(1))
          below = below - apart(2)
        end do
      end do
    end associate
    hangs = hangs .and. below > 0.0_wp
  end function hangs

  !> Add the symbols of all joints.
  subroutine add_symbols(film, skeleton, projection, shapes, scene, symbols)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: shapes(:)                 !< (links) number of the item that shows each link; 0: none
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    integer, allocatable :: pairs(:)
    integer :: joint, k

    do joint = 1, size(symbols%joint)
      if (symbols%joint(joint) /= joint) cycle
      pairs = pack([(k, k=1, size(symbols%joint))], symbols%joint == joint)
      call add_joint(film, skeleton, projection, shapes, pairs, scene, symbols)
    end do
  end subroutine add_symbols

  !> Add the symbols of one joint.
  subroutine add_joint(film, skeleton, projection, shapes, pairs, scene, symbols)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: shapes(:)                 !< (links) number of the item that shows each link; 0: none
    integer, intent(in) :: pairs(:)                  !< numbers of the pairs of the joint
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    integer, allocatable :: single(:), turns(:)
    integer :: i, above(4)
    character(len=:), allocatable :: names

    above = 0
    do i = 1, min(2, size(pairs))
      above(2*i - 1:2*i) = shapes(skeleton%places(pairs(i))%links)
    end do
    names = names_of(pairs)
    do i = 1, size(pairs)
      associate (place => skeleton%places(pairs(i)))
        if (place%drawn_by > 0) then
          if (place%drawn_by == pairs(i)) call add_whole_joint(place, projection, above, names, scene)
        else if (place%kind == free) then
          call add_led_link(place, symbols%node(pairs(i)), projection, above, names, scene)
        else if (place%kind == sliding .or. place%kind == screwing) then
          call add_block(place, symbols%guide(:, pairs(i)), projection, above, names, scene)
        end if
      end associate
    end do
    single = pack(pairs, skeleton%places(pairs)%drawn_by == 0)
    turns = turning_axes(film, skeleton, single)
    if (count(skeleton%places(single)%kind == turning) == 0) return
    if (projection%view%along_normal) then
      call scene%add_item(mark, as_ring, symbols%node(pairs(1):pairs(1)), above=above, text=names)
    else if (size(turns) >= 3 .or. any(skeleton%places(single)%ball)) then
      call scene%add_item(mark, as_ball, symbols%node(pairs(1):pairs(1)), above=above, text=names)
    else
      do i = 1, size(turns)
        call add_pin(skeleton%places(turns(i)), projection%metres(1.0_wp), size(turns) > 1, above, names, scene)
      end do
    end if
  end subroutine add_joint

  !> The names of the coordinates of some pairs.
  pure function names_of(pairs) result(names)
    integer, intent(in) :: pairs(:)  !< numbers of the pairs of the joint
    character(len=:), allocatable :: names
    integer :: i

    names = 'q'//to_text(pairs(1))
    do i = 2, size(pairs)
      names = names//' q'//to_text(pairs(i))
    end do
  end function names_of

  !> The turning pairs of a joint that are drawn: those not parallel to the axis of an earlier pair or of a sliding one.
  pure function turning_axes(film, skeleton, pairs) result(chosen)
    type(film_type), intent(in) :: film          !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    integer, intent(in) :: pairs(:)              !< numbers of the pairs of the joint
    integer, allocatable :: chosen(:)
    real(wp) :: axes(3, size(pairs))
    logical :: new(size(pairs))
    integer :: i, j

    do i = 1, size(pairs)
      associate (place => skeleton%places(pairs(i)))
        axes(:, i) = film%direction(1, place%links(1), place%axes(:, 1))
        new(i) = place%kind == turning
      end associate
    end do
    do i = 1, size(pairs)
      if (.not. new(i)) cycle
      do j = 1, size(pairs)
        if (j == i .or. (j > i .and. skeleton%places(pairs(j))%kind == turning)) cycle
        if (skeleton%places(pairs(j))%kind == free) cycle
        if (norm2(cross(axes(:, i), axes(:, j))) < parallel) new(i) = .false.
      end do
    end do
    chosen = pack(pairs, new)
  end function turning_axes
end module mech9_pair_symbols
