!> A search for oddities in the geometry of closed chains that do not close or do not move: one axis that is not parallel to
!> the others, or does not meet them in their common point, heights that do not fit, a link that is too long.
!>
!> All pairs of a chain are laid out from one of its links with all coordinates zero. For all values of the coordinates,
!> turns about parallel axes keep their directions, and turns about axes through one point keep this point.
module mech9_loop_geometry
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type, compose, inverse, transformed
  use mech9_link_graph, only: link_graph_type, graph_from_structure
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning, sliding, screwing, free
  use mech9_link_dimensions, only: link_dimension_type, dimension_between
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: oddity_type, find_oddity, none_found, bent_link, not_parallel, not_across, not_concurrent, other_height, too_long

  !> Kinds of oddities.
  integer, parameter :: none_found = 0
  integer, parameter :: not_parallel = 1     !< the axis of a pair that turns is not parallel to the others
  integer, parameter :: not_across = 2       !< the direction of a slide is not perpendicular to the parallel axes
  integer, parameter :: not_concurrent = 3   !< an axis does not meet the point in which the others meet
  integer, parameter :: other_height = 4     !< the chain stays open along its parallel axes
  integer, parameter :: too_long = 5         !< a link is longer than all others together
  integer, parameter :: bent_link = 6        !< the axes of two pairs are not parallel on one link alone

  !> Angles [rad] and parts of the chain's size that count as zero: round-off of data with 16 digits.
  real(wp), parameter :: round_off = 1.0e-12_wp

  !> The first oddity that was found.
  type :: oddity_type
    integer :: kind = none_found
    integer, allocatable :: pairs(:)   !< all pairs of the closed chain, in its order
    integer, allocatable :: odd(:)     !< the odd ones of them; the two pairs of an odd link
    integer :: link = 0                !< the link that is too long or bent
    real(wp) :: angle = 0.0_wp         !< between the odd axes, or between the slide and the plane across the axes [rad]
    !> The distance of the axis from the point, the difference of heights, or the length of the link [m].
    real(wp) :: distance = 0.0_wp
    real(wp) :: others = 0.0_wp             !< length of all other links together [m]
  end type oddity_type

  !> A closed chain laid out from its first link, all coordinates zero.
  type :: loop_type
    integer, allocatable :: pairs(:)               !< (n) in order
    integer, allocatable :: links(:)               !< (n): links(i) lies before pair i
    type(pair_axes_type), allocatable :: axes(:)   !< (n) axes of the pairs in their own links
    real(wp), allocatable :: direction(:, :)       !< (3,n) directions of the axes, in the first link
    real(wp), allocatable :: point(:, :)           !< (3,n) points of the axes, in the first link [m]
    type(pose_type) :: end                         !< pose of the first link in itself, reached through all pairs
    real(wp) :: length = 0.0_wp                    !< the largest distance of a point from the first one [m]
    real(wp) :: slack = round_off                  !< angles [rad] and parts of the length that count as zero
  end type loop_type

contains

  !> Search the closed chains of a mechanism; `kind` is none_found where nothing is odd.
  pure subroutine find_oddity(mechanism, oddity)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(oddity_type), intent(out) :: oddity        !< the first one found
    type(link_graph_type) :: graph
    type(pair_axes_type), allocatable :: axes(:)
    type(loop_type) :: loop
    integer, allocatable :: through(:), depth(:)
    integer :: k

    graph = graph_from_structure(mechanism%structure)
    axes = pair_axes(mechanism%pairs)
    call span(graph, through, depth)
    do k = 1, graph%n_pairs
      if (through(graph%ends(1, k)) == k .or. through(graph%ends(2, k)) == k) cycle
      call lay_out(graph, axes, through, depth, k, loop)
      loop%slack = round_off + mechanism%data_tolerance
      call judge(axes, loop, oddity)
      if (oddity%kind /= none_found) return
    end do
  end subroutine find_oddity

  !> A spanning tree from link 1, breadth first: the pair by which each link is reached, and the number of pairs to it.
  pure subroutine span(graph, through, depth)
    type(link_graph_type), intent(in) :: graph        !< links and pairs of the mechanism
    integer, allocatable, intent(out) :: through(:)   !< (N) pair that leads to each link; 0 for link 1
    integer, allocatable, intent(out) :: depth(:)     !< (N) number of pairs from link 1 to each link
    integer :: queue(graph%n_links), next, n, i, other

    allocate (through(graph%n_links), source=0)
    allocate (depth(graph%n_links), source=-1)
    queue(1) = 1
    depth(1) = 0
    n = 1
    next = 1
    do while (next <= n)
      do i = graph%first(queue(next)), graph%first(queue(next) + 1) - 1
        other = graph%other_at(i)
        if (depth(other) >= 0) cycle
        depth(other) = depth(queue(next)) + 1
        through(other) = graph%pair_at(i)
        n = n + 1
        queue(n) = other
      end do
      next = next + 1
    end do
  end subroutine span

  !> Lay out the chain that a pair outside the tree closes.
  pure subroutine lay_out(graph, axes, through, depth, closing, loop)
    type(link_graph_type), intent(in) :: graph    !< links and pairs of the mechanism
    type(pair_axes_type), intent(in) :: axes(:)   !< (M)
    integer, intent(in) :: through(:)             !< (N) pair that leads to each link in the tree; 0 for link 1
    integer, intent(in) :: depth(:)               !< (N) number of pairs from link 1 to each link
    integer, intent(in) :: closing                !< coordinate of the pair
    type(loop_type), intent(out) :: loop          !< the chain
    integer :: ends(2), down(size(depth)), up(size(depth)), n_down, n_up, side, link, i
    type(pose_type) :: pose

    ! walk from both ends of the pair up the tree until the two walks meet
    ends = graph%ends(:, closing)
    n_down = 0
    n_up = 0
    do while (ends(1) /= ends(2))
      if (depth(ends(1)) >= depth(ends(2))) then
        n_down = n_down + 1
        down(n_down) = through(ends(1))
        ends(1) = sum(graph%ends(:, down(n_down))) - ends(1)
      else
        n_up = n_up + 1
        up(n_up) = through(ends(2))
        ends(2) = sum(graph%ends(:, up(n_up))) - ends(2)
      end if
    end do
    loop%pairs = [down(n_down:1:-1), closing, up(:n_up)]
    loop%axes = axes(loop%pairs)
    allocate (loop%links(size(loop%pairs)))
    allocate (loop%direction(3, size(loop%pairs)), loop%point(3, size(loop%pairs)))
    link = ends(1)
    do i = 1, size(loop%pairs)
      loop%links(i) = link
      associate (pair => loop%axes(i))
        side = merge(1, 2, pair%links(1) == link)
        loop%direction(:, i) = matmul(pose%r, pair%axes(:, side))
        loop%point(:, i) = transformed(pose, pair%points(:, side))
        if (side == 1) pose = compose(pose, pair%home)
        if (side == 2) pose = compose(pose, inverse(pair%home))
        link = pair%links(3 - side)
      end associate
    end do
    loop%end = pose
    do i = 1, size(loop%pairs)
      loop%length = max(loop%length, norm2(loop%point(:, i) - loop%point(:, 1)))
    end do
  end subroutine lay_out

  !> Search one chain for an oddity.
  pure subroutine judge(all_axes, loop, oddity)
    type(pair_axes_type), intent(in) :: all_axes(:)   !< (M)
    type(loop_type), intent(in) :: loop               !< the chain, laid out
    type(oddity_type), intent(inout) :: oddity        !< becomes the oddity that is found; unchanged without one
    type(link_dimension_type) :: dimensions(size(loop%pairs))
    logical :: planar
    integer :: i, n

    if (any(loop%axes%kind == free)) return
    oddity%pairs = loop%pairs
    n = size(loop%pairs)
    do i = 1, n
      dimensions(i) = dimension_between(all_axes, loop%links(i), loop%pairs(modulo(i - 2, n) + 1), loop%pairs(i))
    end do
    if (all(loop%axes%kind == turning)) call judge_links(dimensions, loop%slack, oddity)
    if (oddity%kind /= none_found) return
    call judge_directions(loop, oddity, planar)
    if (oddity%kind == none_found .and. .not. planar) call judge_centre(loop, oddity)
    if (oddity%kind == none_found .and. all(loop%axes%kind == turning)) call judge_lengths(dimensions, planar, oddity)
  end subroutine judge

  !> Search for one link on which the axes are not parallel, as they are on all others: the two ends of one axis have
  !> different directions.
  pure subroutine judge_links(dimensions, slack, oddity)
    type(link_dimension_type), intent(in) :: dimensions(:)   !< of the links of a chain whose pairs turn
    real(wp), intent(in) :: slack                            !< angle that counts as zero [rad]
    type(oddity_type), intent(inout) :: oddity               !< becomes the oddity that is found; unchanged without one
    logical :: bent(size(dimensions))
    integer :: i

    bent = abs(sin(dimensions%angle)) > slack
    if (count(bent) /= 1 .or. .not. few(.not. bent)) return
    i = findloc(bent, .true., dim=1)
    oddity%kind = bent_link
    oddity%link = dimensions(i)%link
    oddity%odd = dimensions(i)%pairs
    oddity%angle = asin(abs(sin(dimensions(i)%angle)))
  end subroutine judge_links

  !> Search for a few axes that are not parallel to the others, or slides not perpendicular to them; where there are none,
  !> for heights that do not fit.
  pure subroutine judge_directions(loop, oddity, planar)
    type(loop_type), intent(in) :: loop          !< the chain, laid out
    type(oddity_type), intent(inout) :: oddity   !< becomes the oddity that is found; unchanged without one
    logical, intent(out) :: planar               !< all turn about one direction or slide across it
    logical, dimension(size(loop%pairs)) :: fits, best, turns
    real(wp) :: normal(3), sine, gap
    integer :: i, k, chosen

    turns = loop%axes%kind /= sliding
    best = .false.
    chosen = 0
    do k = 1, size(loop%pairs)
      if (.not. turns(k)) cycle
      do i = 1, size(loop%pairs)
        fits(i) = deviation(loop, i, loop%direction(:, k)) <= loop%slack
      end do
      if (count(fits) > count(best)) then
        best = fits
        chosen = k
      end if
    end do
    planar = all(best)
    if (chosen == 0) return
    normal = loop%direction(:, chosen)
    if (planar) then
      gap = dot_product(normal, loop%end%p)
      if (any(loop%axes%kind == screwing) .or. abs(gap) <= loop%slack*max(loop%length, norm2(loop%end%p))) return
      oddity%kind = other_height
      oddity%distance = abs(gap)
      oddity%odd = pack(loop%pairs, steps_up(loop, normal))
    else if (few(best) .and. count(best .and. turns) >= 2) then
      i = findloc(best, .false., dim=1)
      sine = deviation(loop, i, normal)
      oddity%kind = merge(not_parallel, not_across, turns(i))
      oddity%angle = asin(min(1.0_wp, sine))
      oddity%odd = pack(loop%pairs, .not. best)
    end if
  end subroutine judge_directions

  !> Sine of the angle between a turning axis and a direction, or between a slide and the plane across the direction.
  pure real(wp) function deviation(loop, i, normal)
    type(loop_type), intent(in) :: loop   !< the chain, laid out
    integer, intent(in) :: i              !< place of the pair in the chain
    real(wp), intent(in) :: normal(3)     !< of length 1, in the first link

    if (loop%axes(i)%kind == sliding) then
      deviation = abs(dot_product(loop%direction(:, i), normal))
    else
      deviation = norm2(cross(loop%direction(:, i), normal))
    end if
  end function deviation

  !> Whether so few pairs do not fit that they are likely to be errors. Chains of more than six pairs can move with any axes.
  pure logical function few(fits)
    logical, intent(in) :: fits(:)                     !< (n) of the pairs of a chain

    few = count(fits) >= 3 .and. count(.not. fits) <= max(1, size(fits)/3) .and. size(fits) <= 6
  end function few

  !> Pairs that join points of different heights in the systems of their links.
  pure function steps_up(loop, normal) result(steps)
    type(loop_type), intent(in) :: loop   !< the chain, laid out
    real(wp), intent(in) :: normal(3)     !< of length 1, in the first link
    logical :: steps(size(loop%pairs))
    real(wp) :: rise
    type(pose_type) :: pose
    integer :: i

    do i = 1, size(loop%pairs)
      associate (pair => loop%axes(i))
        if (pair%links(1) == loop%links(i)) then
          rise = dot_product(normal, matmul(pose%r, pair%home%p))
          pose = compose(pose, pair%home)
        else
          pose = compose(pose, inverse(pair%home))
          rise = dot_product(normal, matmul(pose%r, pair%home%p))
        end if
        steps(i) = abs(rise) > loop%slack*max(loop%length, norm2(pair%home%p))
      end associate
    end do
  end function steps_up

  !> Search for a few axes that do not meet the common point of the others.
  pure subroutine judge_centre(loop, oddity)
    type(loop_type), intent(in) :: loop          !< the chain, laid out
    type(oddity_type), intent(inout) :: oddity   !< becomes the oddity that is found; unchanged without one
    logical, dimension(size(loop%pairs)) :: fits, best
    real(wp) :: centre(3), best_centre(3)
    logical :: meet
    integer :: i, j, k

    if (any(loop%axes%kind /= turning)) return
    best = .false.
    best_centre = 0.0_wp
    do i = 1, size(loop%pairs) - 1
      do j = i + 1, size(loop%pairs)
        call meeting_point(loop, i, j, centre, meet)
        if (.not. meet) cycle
        do k = 1, size(loop%pairs)
          fits(k) = distance_from_axis(loop, k, centre) <= 8*loop%slack*max(loop%length, norm2(centre))
        end do
        if (count(fits) <= count(best)) cycle
        best = fits
        best_centre = centre
      end do
    end do
    if (all(best) .or. .not. few(best)) return
    i = findloc(best, .false., dim=1)
    oddity%kind = not_concurrent
    oddity%odd = pack(loop%pairs, .not. best)
    oddity%distance = distance_from_axis(loop, i, best_centre)
  end subroutine judge_centre

  !> The point in which two axes meet, if they do.
  pure subroutine meeting_point(loop, i, j, centre, meet)
    type(loop_type), intent(in) :: loop   !< the chain, laid out
    integer, intent(in) :: i              !< place of one pair in the chain
    integer, intent(in) :: j              !< place of the other pair in the chain
    real(wp), intent(out) :: centre(3)    !< in the first link [m]
    logical, intent(out) :: meet          !< whether the axes meet in one point
    real(wp) :: normal(3), apart(3), sine

    centre = 0.0_wp
    normal = cross(loop%direction(:, i), loop%direction(:, j))
    sine = norm2(normal)
    meet = sine > 1.0e-6_wp
    if (.not. meet) return
    apart = loop%point(:, j) - loop%point(:, i)
    meet = abs(dot_product(apart, normal)) <= sine*loop%slack*max(loop%length, norm2(loop%point(:, i)))
    centre = loop%point(:, i) + loop%direction(:, i)*dot_product(cross(apart, loop%direction(:, j)), normal)/sine**2
  end subroutine meeting_point

  !> Distance of a point from an axis [m].
  pure real(wp) function distance_from_axis(loop, i, centre) result(distance)
    type(loop_type), intent(in) :: loop   !< the chain, laid out
    integer, intent(in) :: i              !< place of the pair in the chain
    real(wp), intent(in) :: centre(3)     !< in the first link [m]

    distance = norm2(cross(loop%direction(:, i), centre - loop%point(:, i)))
  end function distance_from_axis

  !> Search for a link that is too long. The points of pairs that turn form a polygon; with parallel axes their projections
  !> across the axes do. It cannot close where one side is longer than all others together.
  pure subroutine judge_lengths(dimensions, planar, oddity)
    type(link_dimension_type), intent(in) :: dimensions(:)   !< of the links of a chain whose pairs turn
    logical, intent(in) :: planar                            !< the axes of all pairs are parallel
    type(oddity_type), intent(inout) :: oddity               !< becomes the oddity that is found; unchanged without one
    real(wp) :: lengths(size(dimensions))
    integer :: i

    lengths = merge(dimensions%distance, dimensions%between_points, planar)
    i = maxloc(lengths, dim=1)
    if (2.0_wp*lengths(i) <= sum(lengths)*(1.0_wp + round_off)) return
    oddity%kind = too_long
    oddity%link = dimensions(i)%link
    oddity%odd = dimensions(i)%pairs
    oddity%distance = lengths(i)
    oddity%others = sum(lengths) - lengths(i)
  end subroutine judge_lengths
end module mech9_loop_geometry
