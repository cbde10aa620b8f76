!> The curves of a scene: the paths of points, and the curves along which users' pairs guide their links.
module mech9_scene_paths
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_film, only: film_type
  use mech9_pair_axes, only: free
  use mech9_skeleton, only: skeleton_type
  use mech9_scene, only: scene_type, open_path, closed_path, in_trace, in_curve, in_cam
  implicit none
  private
  public :: add_guide, add_paths, add_curves

  !> Bounds for a straight line that replaces part of a curve: its distance from the curve [px], and the number of
  !> points that it skips.
  real(wp), parameter :: straight = 0.15_wp
  integer, parameter :: longest_straight = 40

contains

  !> Add the paths of the points.
  subroutine add_paths(mechanism, film, px, scene)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(film_type), intent(in) :: film            !< poses and values at the outputs of the run
    real(wp), intent(in) :: px                     !< length of 1 px in the mechanism [m]
    type(scene_type), intent(inout) :: scene       !< nodes and items of the picture
    integer, allocatable :: chosen(:), nodes(:)
    integer :: i, n

    if (film%n_path_points < 2) return
    do i = 1, size(mechanism%points)
      if (mechanism%points(i)%link == 1) cycle
      chosen = bends_of(film%paths(:, i, :film%n_path_points), straight*px)
      if (allocated(nodes)) deallocate (nodes)
      allocate (nodes(size(chosen)))
      do n = 1, size(chosen)
        call scene%add_node(1, film%paths(:, i, chosen(n)), nodes(n))
      end do
      call scene%add_item(open_path, in_trace, nodes, mechanism%points(i)%link)
    end do
  end subroutine add_paths

  !> The numbers of the points of a path that are kept. No other point lies farther than `tolerance` from the lines
  !> between them.
  pure function bends_of(path, tolerance) result(kept)
    real(wp), intent(in) :: path(:, :)  !< (3,n) points of the path, in the system of link 1 [m]
    real(wp), intent(in) :: tolerance   !< largest distance of a point that is left out from the line [m]
    integer, allocatable :: kept(:)
    logical :: keep(size(path, 2))
    integer :: from, to, i

    keep = .false.
    keep([1, size(keep)]) = .true.
    from = 1
    do to = 3, size(keep)
      ! the length of a line is bounded, since its points are examined again for each new end
      if (to - from < longest_straight) then
        if (all([(distance(path(:, i), path(:, from), path(:, to)) <= tolerance, i=from + 1, to - 1)])) cycle
      end if
      keep(to - 1) = .true.
      from = to - 1
    end do
    kept = pack([(i, i=1, size(keep))], keep)
  end function bends_of

  !> Distance of a point from a line between two others [m].
  pure real(wp) function distance(point, from, to)
    real(wp), intent(in) :: point(3)  !< the point [m]
    real(wp), intent(in) :: from(3)   !< first end of the line [m]
    real(wp), intent(in) :: to(3)     !< second end of the line [m]
    real(wp) :: along(3), part

    along = to - from
    part = 0.0_wp
    if (dot_product(along, along) > 0.0_wp) &
      part = max(0.0_wp, min(1.0_wp, dot_product(point - from, along)/dot_product(along, along)))
    distance = norm2(point - from - part*along)
  end function distance

  !> Add the curves on which pairs guide their moving links. Curves of path pairs are shown as a whole, those of users'
  !> pairs as far as the origins of their moving links come. A closed curve of a moving link is the edge of a cam.
  subroutine add_curves(film, skeleton, px, scene, cams)
    type(film_type), intent(in) :: film          !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    real(wp), intent(in) :: px                   !< length of 1 px in the mechanism [m]
    type(scene_type), intent(inout) :: scene     !< nodes and items of the picture
    logical, intent(out) :: cams(:)              !< (M) the pair runs around a cam, or along a curve that is drawn whole
    integer :: nodes(film%n_frames), k, frame

    cams = .false.
    do k = 1, size(skeleton%places)
      associate (place => skeleton%places(k))
        if (size(place%guide, 2) > 0) call add_guide(place%guide, place%links(1), px, scene)
        cams(k) = size(place%guide, 2) > 0
        if (place%kind /= free .or. cams(k) .or. film%n_frames < 2) cycle
        do frame = 1, film%n_frames
          call scene%add_node(place%links(1), film%local(frame, place%links(1), film%p(:, place%links(2), frame)), &
                              nodes(frame))
        end do
        cams(k) = closes(scene%node_at(:, nodes)) .and. place%links(1) /= 1
        if (cams(k)) then
          call scene%add_item(closed_path, in_cam, nodes, place%links(1))
        else
          call scene%add_item(open_path, in_curve, nodes, place%links(1))
        end if
      end associate
    end do
  end subroutine add_curves

  !> Add the curve of a path pair; a closed one of a moving link is the edge of a cam.
  subroutine add_guide(guide, link, px, scene)
    real(wp), intent(in) :: guide(:, :)       !< (3,n) places of the curve, in the link [m]
    integer, intent(in) :: link               !< number of the link to which it belongs
    real(wp), intent(in) :: px                !< length of 1 px in the mechanism [m]
    type(scene_type), intent(inout) :: scene  !< nodes and items of the picture
    integer, allocatable :: chosen(:), nodes(:)
    integer :: i

    chosen = bends_of(guide, straight*px)
    allocate (nodes(size(chosen)))
    do i = 1, size(chosen)
      call scene%add_node(link, guide(:, chosen(i)), nodes(i))
    end do
    i = size(nodes)
    if (link /= 1 .and. norm2(guide(:, size(guide, 2)) - guide(:, 1)) <= px) then
      call scene%add_item(closed_path, in_cam, nodes(:i - 1), link)
    else
      call scene%add_item(open_path, in_curve, nodes, link)
    end if
  end subroutine add_guide

  !> Whether a curve ends within two of its mean steps from where it began.
  pure logical function closes(curve)
    real(wp), intent(in) :: curve(:, :)  !< (3,n) points of the curve, in one system [m]
    real(wp) :: length
    integer :: i

    length = 0.0_wp
    do i = 2, size(curve, 2)
      length = length + norm2(curve(:, i) - curve(:, i - 1))
    end do
    closes = norm2(curve(:, size(curve, 2)) - curve(:, 1)) < 2.0_wp*length/size(curve, 2) .and. size(curve, 2) > 8
  end function closes
end module mech9_scene_paths
