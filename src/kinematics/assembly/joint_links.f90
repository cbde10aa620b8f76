!> Links that only form joints: a ball joint or a universal joint is made of revolute pairs whose axes meet in one point, with links
!> between them that bear nothing.
!>
!> The same position of the two links that a ball joint connects has several settings of its three angles: (a, b, c) and, where
!> neighbouring axes are at right angles, (a + pi, pi - b, c + pi). A rod between two such joints, one of them a ball joint, may be
!> turned about the line between their centres. Only links between the joints distinguish such settings.
module mech9_joint_links
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_compound_joint, only: compound_joint_type
  use mech9_link_graph, only: link_graph_type, graph_from_structure
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning, sliding
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: find_joint_links, posture_link, joint_link, rod_link

  integer, parameter :: posture_link = 0   !< any other link
  integer, parameter :: joint_link = 1     !< a link between the axes of a ball joint or a universal joint
  integer, parameter :: rod_link = 2       !< a rod between two such joints, or a part of one that slides

  !> Joints of the data file about whose centre both links turn.
  character(len=*), parameter :: turning_joints(2) = [character(len=9) :: 'spherical', 'universal']

  !> The mechanism as the search sees it.
  type :: view_type
    type(link_graph_type) :: graph                 !< pairs of each link
    type(pair_axes_type), allocatable :: axes(:)   !< (M) of all pairs
    logical, allocatable :: meets(:)               !< (N) may lie in a joint: its two axes meet, and it bears nothing
    logical, allocatable :: loaded(:)              !< (N) a load acts on the link, or a coupling on one of its pairs
    integer, allocatable :: joint_at(:)            !< (M) number of links of the joint to which the pair belongs; 0: none
    real(wp) :: tolerance = 0.0_wp                 !< distance of axes that meet [m]
  end type view_type

contains

  !> Find which links only form joints or are rods between them.
  subroutine find_joint_links(mechanism, tolerance, roles)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(in) :: tolerance               !< distance of axes that count as meeting [m]
    integer, intent(out) :: roles(:)                !< (N) posture_link, joint_link or rod_link
    type(view_type) :: view
    integer :: link, members

    roles = posture_link
    call look_at(mechanism, tolerance, view)
    if (allocated(mechanism%structure%joints)) call mark_given(mechanism%structure%joints, view, roles)
    do members = 2, 1, -1
      do link = 2, size(roles)
        if (view%meets(link) .and. roles(link) == posture_link) call mark_joint(view, link, members, roles)
      end do
    end do
    do link = 2, size(roles)
      if (roles(link) == posture_link) call mark_rod(view, link, roles)
    end do
  end subroutine find_joint_links

  !> Mark the inner links of joints that the data file gives as one pair.
  pure subroutine mark_given(joints, view, roles)
    type(compound_joint_type), intent(in) :: joints(:)   !< joints with several freedoms
    type(view_type), intent(inout) :: view               !< the mechanism; pairs of the joints are marked
    integer, intent(inout) :: roles(:)                   !< (N) the inner links are marked
    integer :: j

    do j = 1, size(joints)
      associate (inner => [joints(j)%before_inner + 1, joints(j)%before_inner + joints(j)%freedoms - 1], &
                 numbers => joints(j)%coordinates())
        roles(inner(1):inner(2)) = joint_link
        view%meets(inner(1):inner(2)) = .false.
        if (any(joints(j)%kind == turning_joints)) view%joint_at(numbers([1, size(numbers)])) = joints(j)%freedoms - 1
      end associate
    end do
  end subroutine mark_given

  !> The pairs of each link, and the links that may lie in joints.
  subroutine look_at(mechanism, tolerance, view)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(in) :: tolerance               !< distance of axes that count as meeting [m]
    type(view_type), intent(out) :: view            !< the mechanism as the search sees it
    logical :: bears(mechanism%structure%n_links)
    real(wp) :: centre(3)
    integer :: i

    view%tolerance = tolerance
    view%graph = graph_from_structure(mechanism%structure)
    view%axes = pair_axes(mechanism%pairs)
    allocate (view%joint_at(size(view%axes)), source=0)
    allocate (view%loaded(size(bears)), source=.false.)
    call mechanism%mark_loaded_links(view%loaded)
    if (allocated(mechanism%couplings)) then
      do i = 1, size(mechanism%couplings)
        associate (coupled => view%axes(mechanism%couplings(i)%coupling%coordinates))
          view%loaded(coupled%links(1)) = .true.
          view%loaded(coupled%links(2)) = .true.
        end associate
      end do
    end if
    bears = view%loaded
    bears(1) = .true.
    bears(mechanism%points%link) = .true.
    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%has_inertia()) bears(mechanism%bodies(i)%link) = .true.
    end do
    allocate (view%meets(size(bears)), source=.false.)
    do i = 2, size(bears)
      if (.not. bears(i)) call find_centre(view, i, centre, view%meets(i))
    end do
  end subroutine look_at

  !> The point in which the axes of the two pairs of a link meet.
  pure subroutine find_centre(view, link, centre, found)
    type(view_type), intent(in) :: view   !< the mechanism
    integer, intent(in) :: link           !< number of the link
    real(wp), intent(out) :: centre(3)    !< in the system of the link [m]
    logical, intent(out) :: found         !< it has two pairs, both turn, and their axes meet and are not parallel
    real(wp), dimension(3) :: p, q, a, b, normal
    real(wp) :: square

    centre = 0.0_wp
    found = number_of_pairs(view, link) == 2
    if (.not. found) return
    associate (pairs => view%graph%pair_at(view%graph%first(link):view%graph%first(link) + 1))
      found = all(view%axes(pairs)%kind == turning)
      if (.not. found) return
      call axis_in(view%axes(pairs(1)), link, p, a)
      call axis_in(view%axes(pairs(2)), link, q, b)
    end associate
    normal = cross(a, b)
    square = dot_product(normal, normal)
    ! axes at less than a thousandth of a right angle make no joint
    found = square > 1.0e-6_wp
    if (.not. found) return
    found = abs(dot_product(q - p, normal)) <= view%tolerance*sqrt(square)
    centre = p + dot_product(cross(q - p, b), normal)/square*a
  end subroutine find_centre

  !> Mark the links of the joint to which a link belongs: two links between three axes, or one between two. More, or axes of the
  !> outer links that pass the centre too, are a spherical chain, in which every link has a position of its own. A single link
  !> beside one that may lie in another joint, such as a crank that carries a ball joint on an axis through its own, is none.
  subroutine mark_joint(view, link, wanted, roles)
    type(view_type), intent(inout) :: view   !< the mechanism; pairs of the joint are marked
    integer, intent(in) :: link              !< number of a link whose axes meet
    integer, intent(in) :: wanted            !< joints of so many links are marked
    integer, intent(inout) :: roles(:)       !< (N) the links of the joint are marked
    integer :: members(3), ends(2), pairs(2), n, side
    logical :: is_joint

    n = 1
    members(1) = link
    is_joint = .true.
    do side = 1, 2
      call walk(view, link, side, members, n, ends(side), pairs(side))
      is_joint = is_joint .and. n <= 2
      if (.not. is_joint) return
    end do
    is_joint = n == wanted
    if (n == 1) is_joint = is_joint .and. .not. (any(view%meets(ends)) .or. any(roles(ends) == joint_link))
    do side = 1, 2
      is_joint = is_joint .and. .not. goes_on(view, members(:n), ends(side), pairs(side))
    end do
    if (.not. is_joint .or. ends(1) == ends(2)) return
    roles(members(:n)) = joint_link
    view%joint_at(pairs) = n
  end subroutine mark_joint

  !> Walk from a link to the outer link of its joint on one side, over links whose axes meet in the same point.
  subroutine walk(view, from, side, members, n, outer, pair)
    type(view_type), intent(in) :: view     !< the mechanism
    integer, intent(in) :: from             !< number of the link
    integer, intent(in) :: side             !< 1: over its first pair, 2: over its second one
    integer, intent(inout) :: members(:)    !< (3) links of the joint so far; more are counted, not kept
    integer, intent(inout) :: n             !< their number
    integer, intent(out) :: outer           !< number of the outer link
    integer, intent(out) :: pair            !< the pair of the outer link
    integer :: link

    link = from
    pair = view%graph%pair_at(view%graph%first(link) + side - 1)
    do
      outer = sum(view%axes(pair)%links) - link
      if (.not. view%meets(outer) .or. n > 2) return
      if (abs(height(view, outer, pair) - height(view, link, pair)) > view%tolerance) return
      n = n + 1
      if (n <= size(members)) members(n) = outer
      link = outer
      associate (pairs => view%graph%pair_at(view%graph%first(link):view%graph%first(link) + 1))
        pair = sum(pairs) - pair
      end associate
    end do
  end subroutine walk

  !> The place of the centre of a link whose axes meet, along the axis of one of its pairs, the same in both links of the pair [m].
  pure real(wp) function height(view, link, pair)
    type(view_type), intent(in) :: view   !< the mechanism
    integer, intent(in) :: link           !< number of the link
    integer, intent(in) :: pair           !< number of the pair
    real(wp), dimension(3) :: centre, point, axis
    logical :: found

    call find_centre(view, link, centre, found)
    call axis_in(view%axes(pair), link, point, axis)
    height = dot_product(centre - point, axis)
  end function height

  !> Whether another axis of an outer link passes the centre of a joint, in another direction than the axis of the joint there. An
  !> axis of another joint, which may lie along a rod, does not count.
  logical function goes_on(view, members, outer, pair)
    type(view_type), intent(in) :: view   !< the mechanism
    integer, intent(in) :: members(:)     !< links of the joint
    integer, intent(in) :: outer          !< number of the outer link
    integer, intent(in) :: pair           !< its pair in the joint
    real(wp), dimension(3) :: centre, joint_axis, point, axis
    integer :: i, other

    call axis_in(view%axes(pair), outer, point, joint_axis)
    centre = point + height(view, members(findloc(members, sum(view%axes(pair)%links) - outer, dim=1)), pair)*joint_axis
    goes_on = .false.
    do i = view%graph%first(outer), view%graph%first(outer + 1) - 1
      other = view%graph%pair_at(i)
      if (other == pair .or. view%axes(other)%kind /= turning .or. view%joint_at(other) > 0) cycle
      call axis_in(view%axes(other), outer, point, axis)
      goes_on = goes_on .or. (norm2(cross(centre - point, axis)) <= view%tolerance .and. &
                              norm2(cross(joint_axis, axis)) > 1.0e-3_wp)
    end do
  end function goes_on

  !> Mark the parts of the rod to which a link belongs: links of two pairs without loads and couplings, joined by slides, between
  !> two joints, one of which at least is a ball joint.
  subroutine mark_rod(view, link, roles)
    type(view_type), intent(in) :: view   !< the mechanism, with its joints
    integer, intent(in) :: link           !< number of a link
    integer, intent(inout) :: roles(:)    !< (N) the parts of the rod are marked
    logical :: parts(size(roles))
    integer :: joints(2), side, at, pair

    parts = .false.
    joints = 0
    do side = 1, 2
      at = link
      if (number_of_pairs(view, at) /= 2) return
      pair = view%graph%pair_at(view%graph%first(at) + side - 1)
      do
        if (view%loaded(at) .or. roles(at) /= posture_link .or. at == 1) return
        parts(at) = .true.
        joints(side) = view%joint_at(pair)
        if (view%axes(pair)%kind /= sliding) exit
        at = sum(view%axes(pair)%links) - at
        if (number_of_pairs(view, at) /= 2 .or. parts(at)) return
        associate (pairs => view%graph%pair_at(view%graph%first(at):view%graph%first(at) + 1))
          pair = sum(pairs) - pair
        end associate
      end do
    end do
    if (minval(joints) < 1 .or. maxval(joints) < 2) return
    where (parts) roles = rod_link
  end subroutine mark_rod

  !> The axis of a pair in the system of one of its links.
  pure subroutine axis_in(pair, link, point, axis)
    type(pair_axes_type), intent(in) :: pair   !< the pair
    integer, intent(in) :: link                !< number of the link
    real(wp), intent(out) :: point(3)          !< of the axis [m]
    real(wp), intent(out) :: axis(3)           !< its direction
    integer :: side

    side = merge(1, 2, pair%links(1) == link)
    point = pair%points(:, side)
    axis = pair%axes(:, side)
  end subroutine axis_in

  !> The number of pairs of a link.
  pure integer function number_of_pairs(view, link)
    type(view_type), intent(in) :: view   !< the mechanism
    integer, intent(in) :: link           !< number of the link

    number_of_pairs = view%graph%first(link + 1) - view%graph%first(link)
  end function number_of_pairs
end module mech9_joint_links
