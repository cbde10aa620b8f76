!> The skeleton of a mechanism's picture: the point of its axis at which each pair is drawn.
!>
!> A data file may give any point of an axis. It usually gives the one where a designer would put the bearing. This
!> point is kept unless it lies far from everything else; then the pair is moved along its axis to its links.
module mech9_skeleton
  use mech9_kinds, only: wp
  use mech9_link_graph, only: link_graph_type, graph_from_structure
  use mech9_mechanism, only: mechanism_type
  use mech9_spring_load, only: spring_load_type
  use mech9_film, only: film_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning, free
  implicit none
  private
  public :: skeleton_type, place_type, make_skeleton, append_figure, wheel_figure, belt_figure, cam_figure

  !> The place where a pair is drawn. Side 1 is the reference link, side 2 the moving link.
  type, extends(pair_axes_type) :: place_type
    !> The side whose link carries the drawn symbol; the symbol slides along the axis of the other side.
    integer :: carrier = 1
    !> Travel of the carrier's point along the other side's axis, from that side's point [m].
    real(wp) :: least = 0.0_wp, most = 0.0_wp
    !> The two links are a tube and a rod in it. The carrier's point is the mouth of the tube. The points `pins` are the
    !> far ends of the tube and of the rod, each in the system of its link.
    logical :: telescopic = .false.
    real(wp) :: pins(3, 2) = 0.0_wp
    !> A planar or a free joint is drawn as a whole at its last pair, whose number this is; 0: in no such joint.
    integer :: drawn_by = 0
    logical :: ball = .false.          !< the pair is one of the three of a spherical joint
    integer :: plane_from = 0          !< of a planar joint that is drawn as a whole, its first pair; 0: of a free one
  end type place_type

  !> The kinds of figures. A wheel or a rack is a thick line of its link. A straight part of a belt does not move as its
  !> link does, and a cam or a roller is closed and filled.
  integer, parameter :: wheel_figure = 1, belt_figure = 2, cam_figure = 3

  !> A line that shows a wheel, a rack, a belt or a cam.
  type :: figure_type
    integer :: kind = wheel_figure
    integer :: link = 0                       !< number of its link
    real(wp), allocatable :: points(:, :)     !< (3,n) points that it joins, in the system of the link [m]
  end type figure_type

  !> The places of all pairs, the graph of links and pairs, and the figures of couplings and cams.
  type :: skeleton_type
    type(place_type), allocatable :: places(:)
    type(link_graph_type) :: graph
    type(figure_type), allocatable :: figures(:)
    real(wp) :: size = 1.0_wp          !< size of the mechanism at the start: diagonal of its box [m]
  end type skeleton_type

  !> A given point is moved if its distance along the axis from the nearest pair of its links exceeds two bounds. One
  !> bound is this multiple of the width of the mechanism.
  real(wp), parameter :: far = 1.5_wp
  !> The other bound is this multiple of the median of these distances over all turning pairs.
  real(wp), parameter :: unusual = 4.0_wp

contains

  !> Find the places of all pairs but the sliding ones, which mech9_slide_places finds from these.
  subroutine make_skeleton(mechanism, film, skeleton)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(film_type), intent(in) :: film            !< poses of the run; only the first frame is used
    type(skeleton_type), intent(out) :: skeleton   !< places at which the pairs are drawn
    type(pair_axes_type), allocatable :: axes(:)
    integer :: k

    axes = pair_axes(mechanism%pairs)
    skeleton%graph = graph_from_structure(mechanism%structure)
    allocate (skeleton%places(size(axes)), skeleton%figures(0))
    do k = 1, size(axes)
      skeleton%places(k)%pair_axes_type = axes(k)
      if (axes(k)%kind == free) skeleton%places(k)%carrier = 2
    end do
    call mark_joints(mechanism, skeleton%places)
    call draw_near(film, skeleton)
    skeleton%size = size_of(mechanism, film, skeleton%places)
  end subroutine make_skeleton

  !> Add a line of a link to the figures.
  subroutine append_figure(link, points, kind, skeleton)
    integer, intent(in) :: link                     !< number of the link
    real(wp), intent(in) :: points(:, :)            !< (3,n) points that the line joins, in the system of the link [m]
    integer, intent(in) :: kind                     !< wheel_figure, belt_figure or cam_figure
    type(skeleton_type), intent(inout) :: skeleton  !< gets the line
    type(figure_type), allocatable :: grown(:)
    integer :: i, n

    n = size(skeleton%figures)
    allocate (grown(n + 1))
    do i = 1, n
      grown(i) = skeleton%figures(i)
    end do
    grown(n + 1)%link = link
    grown(n + 1)%points = points
    grown(n + 1)%kind = kind
    call move_alloc(grown, skeleton%figures)
  end subroutine append_figure

  !> Give the pairs of planar and free joints the number of the pair that draws them, and mark those of balls.
  pure subroutine mark_joints(mechanism, places)
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(place_type), intent(inout) :: places(:)      !< (M) places at which the pairs are drawn
    integer :: j, i

    if (.not. allocated(mechanism%structure%joints)) return
    do j = 1, size(mechanism%structure%joints)
      associate (joint => mechanism%structure%joints(j))
        if (joint%kind == 'spherical') places(joint%coordinates())%ball = .true.
        if (joint%kind /= 'planar' .and. joint%kind /= 'free') cycle
        do i = 1, joint%freedoms
          associate (place => places(joint%numbers(i)))
            place%drawn_by = joint%numbers(joint%freedoms)
            if (joint%kind == 'planar') place%plane_from = joint%numbers(1)
            place%carrier = 2
          end associate
        end do
      end associate
    end do
  end subroutine mark_joints

  !> Move points that are far from everything else along their axes.
  subroutine draw_near(film, skeleton)
    type(film_type), intent(in) :: film             !< poses and values at the outputs of the run
    type(skeleton_type), intent(inout) :: skeleton  !< places at which the pairs are drawn
    real(wp), dimension(3, size(skeleton%places)) :: given, directions
    real(wp) :: shift(size(skeleton%places)), widest, allowed
    integer :: k

    associate (places => skeleton%places)
      do k = 1, size(places)
        given(:, k) = film%position(1, places(k)%links(1), places(k)%points(:, 1))
        directions(:, k) = film%direction(1, places(k)%links(1), places(k)%axes(:, 1))
      end do
      widest = 0.0_wp
      shift = 0.0_wp
      do k = 1, size(places)
        if (places(k)%kind == turning) call look_along(skeleton, given, directions(:, k), k, shift(k), widest)
      end do
      if (count(places%kind == turning) < 2 .or. .not. widest > 0.0_wp) return
      allowed = max(far*widest, unusual*median(pack(abs(shift), places%kind == turning)))
      do k = 1, size(places)
        if (places(k)%kind /= turning .or. abs(shift(k)) <= allowed) cycle
        places(k)%points = places(k)%points + shift(k)*places(k)%axes
      end do
    end associate
  end subroutine draw_near

  !> Compute the signed distance along the axis of a turning pair to the nearest pair of its links. Enlarge `widest` to
  !> the largest distance of such a pair from the axis.
  pure subroutine look_along(skeleton, given, axis, k, along, widest)
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    real(wp), intent(in) :: given(:, :)          !< (3,M) given point of each axis, in the system of link 1 [m]
    real(wp), intent(in) :: axis(3)              !< direction of the axis of the pair, in the axes of link 1
    integer, intent(in) :: k                     !< number of the pair
    real(wp), intent(inout) :: along             !< distance along the axis to the nearest pair; unchanged where there is none [m]
    real(wp), intent(inout) :: widest            !< largest distance of a pair from the axis so far [m]
    real(wp) :: apart(3), part
    integer :: side, link, i, j
    logical :: first

    first = .true.
    do side = 1, 2
      link = skeleton%places(k)%links(side)
      do i = skeleton%graph%first(link), skeleton%graph%first(link + 1) - 1
        j = skeleton%graph%pair_at(i)
        if (j == k .or. skeleton%places(j)%kind /= turning) cycle
        apart = given(:, j) - given(:, k)
        part = dot_product(apart, axis)
        widest = max(widest, norm2(apart - part*axis))
        if (first .or. abs(part) < abs(along)) along = part
        first = .false.
      end do
    end do
  end subroutine look_along

  !> The median of some values; of an even number, the lower one of the two in the middle.
  pure real(wp) function median(values)
    real(wp), intent(in) :: values(:)  !< the values, one at least
    real(wp) :: least
    integer :: i

    ! the median is the least value that at least half of the values do not exceed
    median = huge(median)
    do i = 1, size(values)
      least = values(i)
      if (2*count(values <= least) >= size(values)) median = min(median, least)
    end do
  end function median

  !> The diagonal of the box around all places of the mechanism in the first frame [m].
  pure real(wp) function size_of(mechanism, film, places)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(film_type), intent(in) :: film            !< poses and values at the outputs of the run
    type(place_type), intent(in) :: places(:)      !< (M) places at which the pairs are drawn
    real(wp) :: low(3), high(3)
    integer :: i, side

    low = huge(low)
    high = -huge(high)
    do i = 1, size(places)
      do side = 1, 2
        call enclose(film%position(1, places(i)%links(side), places(i)%points(:, side)), low, high)
      end do
    end do
    do i = 1, size(mechanism%points)
      call enclose(film%position(1, mechanism%points(i)%link, mechanism%points(i)%position), low, high)
    end do
    do i = 1, size(mechanism%bodies)
      call enclose(film%position(1, mechanism%bodies(i)%link, mechanism%bodies(i)%centre), low, high)
    end do
    do i = 1, size(mechanism%loads)
      select type (load => mechanism%loads(i)%load)
      type is (spring_load_type)
        call enclose(film%position(1, load%links(1), load%positions(:, 1)), low, high)
        call enclose(film%position(1, load%links(2), load%positions(:, 2)), low, high)
      end select
    end do
    size_of = norm2(high - low)
    if (.not. size_of > 0.0_wp) size_of = 1.0_wp
  end function size_of

  !> Enlarge the bounds of a box by a place.
  pure subroutine enclose(place, low, high)
    real(wp), intent(in) :: place(3)    !< place in the system of link 1 [m]
    real(wp), intent(inout) :: low(3)   !< smallest coordinates so far [m]
    real(wp), intent(inout) :: high(3)  !< largest coordinates so far [m]

    low = min(low, place)
    high = max(high, place)
  end subroutine enclose
end module mech9_skeleton
