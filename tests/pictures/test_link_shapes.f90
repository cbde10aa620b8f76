!> Shapes of links: bars, plates around points of a plane, bars between points in space.
module test_link_shapes
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_rotation, only: cross
  use mech9_random_geometry, only: random_vector, random_rotation
  use mech9_link_shapes, only: distinct_points, find_shape
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: tolerance = 1.0e-6_wp
  integer, parameter :: no_rails(2, 0) = 0

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('few_points')) call few_points(test)
    if (test%runs('plates')) call plates(test)
    if (test%runs('points_in_space')) call points_in_space(test)
    if (test%runs('rails')) call rails(test)
    if (test%runs('same_points')) call same_points(test)
  end subroutine run

  !> No shape for a point; for points of a line the bar between the outermost.
  subroutine few_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: points(3, 5), from(3), along(3)
    integer, allocatable :: order(:)
    logical :: closed
    integer :: i

    call find_shape(points(:, :0), tolerance, no_rails, order, closed)
    call test%is_true(size(order) == 0 .and. .not. closed, 'a link without points has no shape')
    from = random_vector(random)
    along = random_vector(random)
    points = reshape([(from + real(mod(3*i, 5), wp)*along, i=1, 5)], [3, 5])   ! places 3 1 4 2 0
    call find_shape(points(:, :1), tolerance, no_rails, order, closed)
    call test%is_true(size(order) == 0, 'a link with one point has no shape')
    call find_shape(points, tolerance, no_rails, order, closed)
    call test%is_true(.not. closed .and. size(order) == 2, 'points of a line are joined by a bar')
    if (size(order) == 2) call test%is_true(minval(order) == 3 .and. maxval(order) == 5, &
                                            'the bar of points of a line joins the outermost')
  end subroutine few_points

  !> Corners of a polygon and points within, turned anyhow: around it by turns, all others inside.
  subroutine plates(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: points(3, 40), r(3, 3), normal(3), side(3)
    integer, allocatable :: order(:)
    logical :: closed, convex
    integer :: trial, n, i, j

    do trial = 1, 40
      n = 2 + trial - trial/39*2
      r = random_rotation(random)
      do i = 1, n
        points(:, i) = random_vector(random)
        points(3, i) = 0.0_wp
        points(:, i) = matmul(r, points(:, i))
      end do
      call find_shape(points(:, :n), tolerance, no_rails, order, closed)
      call test%is_true(closed .and. size(order) >= 3, 'points of a plane are surrounded by a plate')
      if (size(order) < 3) cycle
      normal = cross(points(:, order(2)) - points(:, order(1)), points(:, order(3)) - points(:, order(2)))
      convex = .true.
      do i = 1, size(order)
        side = points(:, order(1 + mod(i, size(order)))) - points(:, order(i))
        do j = 1, n
          convex = convex .and. dot_product(normal, cross(side, points(:, j) - points(:, order(i)))) > -tolerance
        end do
      end do
      call test%is_true(convex, 'no point lies outside the plate')
    end do
  end subroutine plates

  !> Bars join all points: as many as points but one, and one can go from each to each.
  subroutine points_in_space(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: points(3, 12)
    integer, allocatable :: order(:)
    logical :: closed
    integer :: group(12), i

    do i = 1, 12
      points(:, i) = random_vector(random)
    end do
    call find_shape(points, tolerance, no_rails, order, closed)
    call test%is_true(.not. closed .and. size(order) == 22, 'twelve points in space are joined by eleven bars')
    group = [(i, i=1, 12)]
    do i = 1, size(order) - 1, 2
      where (group == group(order(i))) group = group(order(i + 1))
    end do
    call test%is_true(all(group == group(1)), 'the eleven bars hold together')
  end subroutine points_in_space

  !> A long rail and a pin between its ends: the rail stays in one piece, the pin hangs on one of them. Two pins
  !> in a plane with it make a plate, two that are not make bars.
  subroutine rails(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: points(3, 4)
    integer, parameter :: rail(2, 1) = reshape([1, 4], [2, 1])
    integer, allocatable :: order(:)
    logical :: closed

    points = reshape([0.0_wp, 0.0_wp, 0.0_wp, 5.0_wp, 1.0_wp, 0.0_wp, 5.0_wp, 2.0_wp, 0.0_wp, 9.0_wp, 0.0_wp, 0.0_wp], [3, 4])
    call find_shape(points, tolerance, rail, order, closed)
    call test%is_true(closed .and. size(order) == 3, 'two pins on one side of a rail make a plate')
    points(:, 3) = [7.0_wp, 0.0_wp, 0.0_wp]
    call find_shape(points, tolerance, rail, order, closed)
    call test%is_true(.not. closed .and. size(order) == 6, 'a rail, a pin on it and a pin beside it are joined by three bars')
    points(:, 3) = [5.0_wp, 1.0_wp, 1.0_wp]
    call find_shape(points, tolerance, rail, order, closed)
    call test%is_true(.not. closed .and. size(order) == 6, 'a rail and two pins in space are joined by three bars')
    if (size(order) == 6) then
      call test%is_true(all(order(:2) == [1, 4]), 'the first bar is the rail')
      call test%is_true(all(order(3:4) == [4, 2]), 'the second bar leads from the nearer end of the rail to a pin')
      call test%is_true(all(order(5:6) == [2, 3]), 'the third bar leads from this pin to the other one')
    end if
  end subroutine rails

  subroutine same_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: points(3, 6)

    points = 0.0_wp
    points(1, :) = [0.0_wp, 1.0_wp, 1.0e-9_wp, 1.0_wp, 2.0_wp, 0.0_wp]
    call test%is_true(all([distinct_points(points, tolerance), 0, 0, 0] == [1, 2, 5, 0, 0, 0]), 'each place is taken once')
  end subroutine same_points
end module test_link_shapes
