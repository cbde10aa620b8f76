!> The shape of a link by its points: a bar, a plate around them, or bars from one to the next.
module mech9_link_shapes
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, unit
  implicit none
  private
  public :: distinct_points, find_shape

contains

  !> The numbers of the points that differ from all points before them.
  pure function distinct_points(points, tolerance) result(chosen)
    real(wp), intent(in) :: points(:, :)  !< (3,n) points in the system of the link [m]
    real(wp), intent(in) :: tolerance     !< distance up to which points are the same [m]
    integer, allocatable :: chosen(:)
    logical :: new(size(points, 2))
    integer :: i, j

    do i = 1, size(new)
      new(i) = .true.
      do j = 1, i - 1
        if (.not. new(j)) cycle
        new(i) = norm2(points(:, i) - points(:, j)) > tolerance
        if (.not. new(i)) exit
      end do
    end do
    chosen = pack([(i, i=1, size(new))], new)
  end function distinct_points

  !> Form the outline of a set of distinct points. It is closed around a plate where the points lie in one plane.
  !> Otherwise, or where all points but one lie on a rail, it consists of pairs of points that bars join.
  pure subroutine find_shape(points, tolerance, rails, order, closed)
    real(wp), intent(in) :: points(:, :)           !< (3,n) points in the system of the link, all different [m]
    real(wp), intent(in) :: tolerance              !< distance up to which a point lies on a line or in a plane [m]
    integer, intent(in) :: rails(:, :)             !< (2,rails) numbers of the points that a bar must join
    integer, allocatable, intent(out) :: order(:)  !< numbers of the points: corners of the plate in turn, or two ends for each bar
    logical, intent(out) :: closed                 !< the outline is that of a plate
    real(wp) :: normal(3), along(3), off(size(points, 2)), x(2, size(points, 2))
    integer :: first, second, third, i

    closed = .false.
    allocate (order(0))
    if (size(points, 2) < 2) return
    first = farthest(points, sum(points, 2)/size(points, 2))
    second = farthest(points, points(:, first))
    along = unit(points(:, second) - points(:, first))
    do i = 1, size(points, 2)
      off(i) = norm2(cross(along, points(:, i) - points(:, first)))
    end do
    third = maxloc(off, dim=1)
    if (off(third) <= tolerance) then
      order = [first, second]
      return
    end if
    normal = unit(cross(along, points(:, third) - points(:, first)))
    do i = 1, size(points, 2)
      off(i) = abs(dot_product(normal, points(:, i) - points(:, first)))
      x(1, i) = dot_product(along, points(:, i) - points(:, first))
      x(2, i) = dot_product(cross(normal, along), points(:, i) - points(:, first))
    end do
    closed = maxval(off) <= tolerance .and. beside(points, rails, tolerance) /= 1
    if (closed) then
      order = hull(x)
    else
      order = spanning_bars(points, rails)
    end if
  end subroutine find_shape

  !> The number of points that do not lie on the first rail; zero where there is no rail.
  pure integer function beside(points, rails, tolerance)
    real(wp), intent(in) :: points(:, :)  !< (3,n) points in the system of the link [m]
    integer, intent(in) :: rails(:, :)    !< (2,rails) numbers of the two points at the ends of each rail
    real(wp), intent(in) :: tolerance     !< distance up to which a point lies on a line or in a plane [m]
    real(wp) :: along(3)
    integer :: i

    beside = 0
    if (size(rails, 2) == 0) return
    along = unit(points(:, rails(2, 1)) - points(:, rails(1, 1)))
    do i = 1, size(points, 2)
      if (norm2(cross(along, points(:, i) - points(:, rails(1, 1)))) > tolerance) beside = beside + 1
    end do
  end function beside

  !> The number of the point that is farthest from a place.
  pure integer function farthest(points, from)
    real(wp), intent(in) :: points(:, :)  !< (3,n) points in the system of the link [m]
    real(wp), intent(in) :: from(3)       !< place from which distances are measured [m]
    integer :: i

    farthest = maxloc([(norm2(points(:, i) - from), i=1, size(points, 2))], dim=1)
  end function farthest

  !> The convex hull of points in a plane, counterclockwise. Each corner is followed by the point that leaves no other
  !> point outside (gift wrapping).
  pure function hull(x) result(around)
    real(wp), intent(in) :: x(:, :)  !< (2,n) coordinates in the plane [m]
    integer, allocatable :: around(:)
    real(wp) :: side
    integer :: found(size(x, 2)), n, i, next

    found(1) = minloc(x(1, :), dim=1)
    n = 1
    do
      next = merge(2, 1, found(n) == 1)
      do i = 1, size(x, 2)
        if (i == found(n) .or. i == next) cycle
        associate (a => x(:, next) - x(:, found(n)), b => x(:, i) - x(:, found(n)))
          side = a(1)*b(2) - a(2)*b(1)
          if (side < 0.0_wp .or. (side <= 0.0_wp .and. norm2(b) > norm2(a))) next = i
        end associate
      end do
      if (next == found(1) .or. n == size(x, 2)) exit
      n = n + 1
      found(n) = next
    end do
    around = found(:n)
  end function hull

  !> The shortest bars that hold points in space together: each point is joined to the nearest point that is joined
  !> already. The ends of a rail are joined to each other.
  pure function spanning_bars(points, rails) result(ends)
    real(wp), intent(in) :: points(:, :)  !< (3,n) points in the system of the link [m]
    integer, intent(in) :: rails(:, :)    !< (2,rails) numbers of the two ends of each rail; rails have no common points
    integer, allocatable :: ends(:)       !< numbers of points, two for each bar
    real(wp) :: distance(size(points, 2))
    integer :: nearest(size(points, 2)), i, n, new
    logical :: joined(size(points, 2))

    allocate (ends(2*(size(points, 2) - 1)))
    joined = .false.
    distance = huge(distance)
    nearest = 0
    new = 1
    if (size(rails, 2) > 0) new = rails(1, 1)
    do n = 1, size(points, 2)
      joined(new) = .true.
      if (n > 1) ends(2*n - 3:2*n - 2) = [nearest(new), new]
      do i = 1, size(points, 2)
        if (norm2(points(:, i) - points(:, new)) >= distance(i)) cycle
        distance(i) = norm2(points(:, i) - points(:, new))
        nearest(i) = new
      end do
      do i = 1, size(rails, 2)
        if (all(rails(:, i) /= new)) cycle
        distance(sum(rails(:, i)) - new) = -1.0_wp
        nearest(sum(rails(:, i)) - new) = new
      end do
      new = minloc(distance, dim=1, mask=.not. joined)
    end do
  end function spanning_bars
end module mech9_link_shapes
