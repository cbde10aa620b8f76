!> The making of a scene from a mechanism and its film: paths and guides, links, springs, pairs, points and labels.
module mech9_scene_making
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_spring_load, only: spring_load_type
  use mech9_film, only: film_type
  use mech9_pair_axes, only: free, turning
  use mech9_skeleton, only: skeleton_type, belt_figure, cam_figure
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, open_path, closed_path, segments, mark, in_plate, in_tube, &
                         in_curve, in_cam, as_dot, as_centre
  use mech9_scene_paths, only: add_paths, add_curves
  use mech9_link_shapes, only: distinct_points, find_shape
  use mech9_pair_symbols, only: symbols_type, prepare_symbols, add_guides, add_stands, add_symbols
  use mech9_spring_symbols, only: add_springs
  use mech9_contact_symbols, only: add_surfaces, add_balls
  use mech9_pose_marks, only: pose_mark_type, add_poses
  use mech9_stop_symbols, only: add_stops, add_stuck_pairs
  use mech9_scene_labels, only: add_labels
  implicit none
  private
  public :: make_scene

  !> Points of a link nearer to each other than this part of the mechanism's size are drawn as one.
  real(wp), parameter :: same = 0.004_wp

  !> The points that give a link its shape, in the system of the link, and the nodes at these points.
  type :: outline_type
    integer :: count = 0
    real(wp), allocatable :: points(:, :)   !< (3,count)
    integer, allocatable :: nodes(:)
  end type outline_type

contains

  !> Make the scene of a film. It is made for one projection, since the symbols have a fixed size on the page.
  subroutine make_scene(mechanism, film, skeleton, projection, with_masses, poses, scene)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    type(projection_type), intent(in) :: projection  !< from space to the page
    logical, intent(in) :: with_masses               !< mark the mass centres
    type(pose_mark_type), intent(in) :: poses(:)     !< poses that links should take
    type(scene_type), intent(out) :: scene           !< nodes and items of the picture
    type(symbols_type) :: symbols
    type(outline_type) :: outlines(skeleton%graph%n_links)
    integer :: shapes(skeleton%graph%n_links)   !< number of the item of each link; 0: none
    logical :: cams(size(skeleton%places))
    integer :: nodes(size(mechanism%points)), link

    call prepare_symbols(film, skeleton, projection, scene, symbols)
    if (mechanism%has_contacts()) call add_surfaces(mechanism, film, projection, scene)
    call add_paths(mechanism, film, 1.0_wp/projection%scale, scene)
    call add_curves(film, skeleton, 1.0_wp/projection%scale, scene, cams)
    call add_guides(skeleton, projection, scene, symbols)
    call add_stands(film, skeleton, projection, scene, symbols)
    shapes = 0
    scene%first_sorted = scene%n_items + 1
    do link = 2, size(outlines)
      call find_outline(mechanism, skeleton, symbols, link, scene, outlines(link))
      call add_shape(skeleton, symbols, link, .true., scene, outlines(link), shapes(link))
    end do
    ! bars are drawn above plates at the same depth
    do link = 2, size(outlines)
      if (shapes(link) == 0) call add_shape(skeleton, symbols, link, .false., scene, outlines(link), shapes(link))
      call add_reach(skeleton, symbols, cams, link, scene, outlines(link), shapes(link))
    end do
    call add_figures(skeleton, scene, shapes)
    call add_springs(mechanism, film, skeleton, projection, shapes, scene, symbols)
    call add_stops(mechanism, film, skeleton, projection, shapes, scene, symbols)
    if (mechanism%has_contacts()) call add_balls(mechanism, film, projection, scene)
    call add_symbols(film, skeleton, projection, shapes, scene, symbols)
    scene%last_sorted = scene%n_items
    call add_points(mechanism, with_masses, nodes, scene)
    call add_poses(poses, projection, scene)
    if (mechanism%has_frictions()) call add_stuck_pairs(mechanism, film, symbols, scene)
    associate (shown => mechanism%structure%shown_links())
      call add_labels(mechanism, film, projection, symbols, nodes, shown_by(outlines(:shown), shapes(:shown), scene), scene)
    end associate
  end subroutine make_scene

  !> List the points that a link joins: its pairs, traced points and ends of springs. Its mass centre is among them if
  !> it has one pair only.
  subroutine find_outline(mechanism, skeleton, symbols, link, scene, outline)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(skeleton_type), intent(in) :: skeleton    !< places at which the pairs are drawn
    type(symbols_type), intent(in) :: symbols      !< nodes and joints of the pairs
    integer, intent(in) :: link                    !< number of the link
    type(scene_type), intent(inout) :: scene       !< nodes and items of the picture
    type(outline_type), intent(out) :: outline     !< points that give the link its shape
    integer :: i, k, side

    associate (graph => skeleton%graph)
      do i = graph%first(link), graph%first(link + 1) - 1
        k = graph%pair_at(i)
        associate (place => skeleton%places(k))
          side = merge(1, 2, place%links(1) == link)
          if (place%drawn_by > 0) then
            call add_whole_joint(skeleton, symbols, k, link, scene, outline)
          else if (place%kind == turning .or. side == place%carrier) then
            call add_to_outline(outline, place%points(:, side), symbols%node(k))
          else if (place%telescopic .or. place%kind == free) then
            cycle
          else
            call add_to_outline(outline, scene%node_at(:, symbols%guide(1, k)), symbols%guide(1, k))
            call add_to_outline(outline, scene%node_at(:, symbols%guide(2, k)), symbols%guide(2, k))
          end if
        end associate
      end do
    end associate
    do i = 1, size(mechanism%points)
      if (mechanism%points(i)%link == link) call add_place(scene, link, mechanism%points(i)%position, outline)
    end do
    do i = 1, size(mechanism%loads)
      select type (load => mechanism%loads(i)%load)
      type is (spring_load_type)
        if (load%links(1) == link) call add_place(scene, link, load%positions(:, 1), outline)
        if (load%links(2) == link) call add_place(scene, link, load%positions(:, 2), outline)
      end select
    end do
    ! a link with one pair reaches at least to its mass centre
    if (skeleton%graph%first(link + 1) - skeleton%graph%first(link) > 1) return
    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%link == link) call add_place(scene, link, mechanism%bodies(i)%centre, outline)
    end do
  end subroutine find_outline

  !> Add the place of a planar or a free joint on its moving link to the outline of the link. The plane of a planar
  !> joint is added to the outline of its reference link.
  subroutine add_whole_joint(skeleton, symbols, k, link, scene, outline)
    type(skeleton_type), intent(in) :: skeleton   !< places at which the pairs are drawn
    type(symbols_type), intent(in) :: symbols     !< nodes and joints of the pairs
    integer, intent(in) :: k                      !< number of a pair of the joint
    integer, intent(in) :: link                   !< number of the link
    type(scene_type), intent(in) :: scene         !< nodes and items of the picture
    type(outline_type), intent(inout) :: outline  !< points that give the link its shape
    integer :: i

    associate (place => skeleton%places(k))
      if (place%drawn_by == k .and. place%links(2) == link) call add_to_outline(outline, place%points(:, 2), symbols%node(k))
      if (place%plane_from /= k .or. place%links(1) /= link) return
      do i = 1, 4
        associate (corner => symbols%plane(i, place%drawn_by))
          call add_to_outline(outline, scene%node_at(:, corner), corner)
        end associate
      end do
    end associate
  end subroutine add_whole_joint

  !> Make a node at a point of a link, and add it to the outline of the link.
  subroutine add_place(scene, link, at, outline)
    type(scene_type), intent(inout) :: scene      !< nodes and items of the picture
    integer, intent(in) :: link                   !< number of the link
    real(wp), intent(in) :: at(3)                 !< the point, in the system of the link [m]
    type(outline_type), intent(inout) :: outline  !< points that give the link its shape
    integer :: node

    call scene%add_node(link, at, node)
    call add_to_outline(outline, at, node)
  end subroutine add_place

  !> Add a point and its node to an outline.
  pure subroutine add_to_outline(outline, point, node)
    type(outline_type), intent(inout) :: outline  !< points that give the link its shape
    real(wp), intent(in) :: point(3)              !< the point, in the system of the link [m]
    integer, intent(in) :: node                   !< number of the node at that point
    real(wp), allocatable :: points(:, :)
    integer, allocatable :: nodes(:)

    if (.not. allocated(outline%nodes)) allocate (outline%points(3, 8), outline%nodes(8))
    if (outline%count == size(outline%nodes)) then
      allocate (points(3, 2*outline%count), nodes(2*outline%count))
      points(:, :outline%count) = outline%points
      nodes(:outline%count) = outline%nodes
      call move_alloc(points, outline%points)
      call move_alloc(nodes, outline%nodes)
    end if
    outline%count = outline%count + 1
    outline%points(:, outline%count) = point
    outline%nodes(outline%count) = node
  end subroutine add_to_outline

  !> Add the plate of a link, or its bars.
  subroutine add_shape(skeleton, symbols, link, plates, scene, outline, shape)
    type(skeleton_type), intent(in) :: skeleton   !< places at which the pairs are drawn
    type(symbols_type), intent(in) :: symbols     !< nodes and joints of the pairs
    integer, intent(in) :: link                   !< number of the link
    logical, intent(in) :: plates                 !< draw a plate and no bars, else bars and no plate
    type(scene_type), intent(inout) :: scene      !< nodes and items of the picture
    type(outline_type), intent(inout) :: outline  !< points that give the link its shape
    integer, intent(inout) :: shape               !< number of the item of the link, set where the link gets one
    integer, allocatable :: chosen(:), order(:)
    logical :: closed

    if (outline%count == 0) return
    chosen = distinct_points(outline%points(:, :outline%count), same*skeleton%size)
    outline%points(:, :size(chosen)) = outline%points(:, chosen)
    outline%nodes(:size(chosen)) = outline%nodes(chosen)
    outline%count = size(chosen)
    call find_shape(outline%points(:, :outline%count), same*skeleton%size, rails_of(skeleton, symbols, link, outline), &
                    order, closed)
    if (size(order) == 0 .or. (closed .neqv. plates)) return
    call scene%add_item(merge(closed_path, segments, closed), in_plate, outline%nodes(order), link)
    shape = scene%n_items
  end subroutine add_shape

  !> The numbers of the points of an outline that are the ends of a guide of the link.
  pure function rails_of(skeleton, symbols, link, outline) result(rails)
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    type(symbols_type), intent(in) :: symbols    !< nodes and joints of the pairs
    integer, intent(in) :: link                  !< number of the link
    type(outline_type), intent(in) :: outline    !< points that give the link its shape
    integer, allocatable :: rails(:, :)          !< (2,n) numbers of points
    integer :: ends(2), i, n

    allocate (rails(2, 0))
    do i = skeleton%graph%first(link), skeleton%graph%first(link + 1) - 1
      associate (guide => symbols%guide(:, skeleton%graph%pair_at(i)))
        if (any(guide == 0)) cycle
        do n = 1, 2
          ends(n) = findloc(outline%nodes(:outline%count), guide(n), dim=1)
        end do
      end associate
      if (all(ends > 0)) rails = reshape([rails, ends], [2, size(rails, 2) + 1])
    end do
  end function rails_of

  !> Add the lines from a link to the pairs that move along it.
  subroutine add_reach(skeleton, symbols, cams, link, scene, outline, shape)
    type(skeleton_type), intent(in) :: skeleton   !< places at which the pairs are drawn
    type(symbols_type), intent(in) :: symbols     !< nodes and joints of the pairs
    logical, intent(in) :: cams(:)                !< (M) the pair runs around a cam
    integer, intent(in) :: link                   !< number of the link
    type(scene_type), intent(inout) :: scene      !< nodes and items of the picture
    type(outline_type), intent(inout) :: outline  !< points that give the link its shape
    integer, intent(inout) :: shape               !< number of the item that shows the link; 0: none so far
    integer :: i, k, side

    associate (graph => skeleton%graph)
      do i = graph%first(link), graph%first(link + 1) - 1
        k = graph%pair_at(i)
        associate (place => skeleton%places(k))
          side = merge(1, 2, place%links(1) == link)
          if (place%telescopic .and. side == place%carrier) then
            call scene%add_item(open_path, in_tube, [symbols%guide(1, k), symbols%node(k)], link, above=[shape])
            shape = scene%n_items
          else if (place%telescopic) then
            call scene%add_item(open_path, in_plate, [symbols%guide(2, k), symbols%node(k)], link)
            shape = scene%n_items
            call add_to_outline(outline, place%pins(:, side), symbols%guide(2, k))
          else if (place%kind == free .and. side == 1 .and. outline%count > 0 .and. .not. cams(k)) then
            call scene%add_item(open_path, in_plate, [outline%nodes(1), symbols%node(k)], link)
            if (shape == 0) shape = scene%n_items
          end if
        end associate
      end do
    end associate
  end subroutine add_reach

  !> Add the wheels, racks and belts of couplings and the cams.
  subroutine add_figures(skeleton, scene, shapes)
    type(skeleton_type), intent(in) :: skeleton   !< places at which the pairs are drawn, and figures of couplings
    type(scene_type), intent(inout) :: scene      !< nodes and items of the picture
    integer, intent(inout) :: shapes(:)           !< (links) number of the item of each link, set where the link gets one; 0: none
    integer, allocatable :: nodes(:)
    integer :: i, j

    do i = 1, size(skeleton%figures)
      associate (figure => skeleton%figures(i))
        if (allocated(nodes)) deallocate (nodes)
        allocate (nodes(size(figure%points, 2)))
        do j = 1, size(nodes)
          call scene%add_node(figure%link, figure%points(:, j), nodes(j))
        end do
        select case (figure%kind)
        case (belt_figure)
          call scene%add_item(open_path, in_curve, nodes, figure%link)
          cycle
        case (cam_figure)
          call scene%add_item(closed_path, in_cam, nodes, figure%link)
        case default
          call scene%add_item(open_path, in_plate, nodes, figure%link)
        end select
        if (shapes(figure%link) == 0) shapes(figure%link) = scene%n_items
      end associate
    end do
  end subroutine add_figures

  !> Add the marks of points and mass centres.
  subroutine add_points(mechanism, with_masses, nodes, scene)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    logical, intent(in) :: with_masses             !< mark the mass centres
    integer, intent(out) :: nodes(:)               !< (points) number of the node of each point
    type(scene_type), intent(inout) :: scene       !< nodes and items of the picture
    integer :: i, node

    if (with_masses) then
      do i = 1, size(mechanism%bodies)
        if (mechanism%bodies(i)%link == 1 .or. .not. mechanism%bodies(i)%mass > 0.0_wp) cycle
        call scene%add_node(mechanism%bodies(i)%link, mechanism%bodies(i)%centre, node)
        call scene%add_item(mark, as_centre, [node])
      end do
    end if
    do i = 1, size(mechanism%points)
      call scene%add_node(mechanism%points(i)%link, mechanism%points(i)%position, nodes(i))
      call scene%add_item(mark, as_dot, nodes(i:i), mechanism%points(i)%link)
    end do
  end subroutine add_points

  !> The numbers of the item that shows each link and of a node of the link; zeros where there is none. A cam is an item
  !> by itself.
  pure function shown_by(outlines, shapes, scene) result(shown)
    type(outline_type), intent(in) :: outlines(:)  !< (links) points that give each link its shape
    integer, intent(in) :: shapes(:)               !< (links) number of the item of each link; 0: none
    type(scene_type), intent(in) :: scene          !< nodes and items of the picture
    integer :: shown(2, size(shapes))
    integer :: i

    shown = 0
    shown(1, :) = shapes
    do i = 1, scene%n_items
      associate (item => scene%items(i))
        if (item%style /= in_cam) cycle
        if (shown(1, item%link) == 0) shown(1, item%link) = i
      end associate
    end do
    do i = 1, size(outlines)
      if (outlines(i)%count > 0) shown(2, i) = outlines(i)%nodes(1)
    end do
  end function shown_by
end module mech9_scene_making
