!> Poses: composition, points, axes, Denavit-Hartenberg, the default zero direction.
module test_pose
  use mech9_kinds, only: wp, pi
  use mech9_random, only: random_type
  use mech9_rotation, only: identity, cross, about_axis, about_z
  use mech9_pose, only: pose_type, identity_pose, compose, inverse, transformed, pose_from_points, pose_from_axis, &
    pose_from_dh, default_zero
  use mech9_random_geometry, only: random_vector, random_unit, random_pose, largest_difference
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A few roundings of numbers of order one.
  real(wp), parameter :: round_off = 4.0e-15_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('composition')) call composition(test)
    if (test%runs('from_points')) call from_points(test)
    if (test%runs('nearly_in_line')) call nearly_in_line(test)
    if (test%runs('in_line')) call in_line(test)
    if (test%runs('from_axis')) call from_axis(test)
    if (test%runs('denavit_hartenberg')) call denavit_hartenberg(test)
    if (test%runs('default_directions')) call default_directions(test)
  end subroutine run

  subroutine composition(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(pose_type) :: a, b, c
    real(wp) :: x(3)
    integer :: i

    do i = 1, 50
      a = random_pose(random)
      b = random_pose(random)
      c = random_pose(random)
      x = random_vector(random)
      call test%near(largest_difference(compose(a, inverse(a)), identity_pose), 0.0_wp, round_off, &
                     'a pose followed by its inverse is no displacement')
      call test%near(largest_difference(compose(inverse(a), a), identity_pose), 0.0_wp, round_off, &
                     'the inverse of a pose followed by the pose is no displacement')
      call test%near(largest_difference(compose(a, identity_pose), a), 0.0_wp, 0.0_wp, &
                     'a pose followed by no displacement is itself')
      call test%near(largest_difference(compose(identity_pose, a), a), 0.0_wp, 0.0_wp, &
                     'no displacement followed by a pose is the pose')
      call test%near(largest_difference(compose(compose(a, b), c), compose(a, compose(b, c))), 0.0_wp, round_off, &
                     'three poses can be composed from either end')
      call test%near(largest_difference(inverse(compose(a, b)), compose(inverse(b), inverse(a))), 0.0_wp, round_off, &
                     'the inverse of a product is the product of the inverses in reverse')
      call test%near(maxval(abs(transformed(compose(a, b), x) - transformed(a, transformed(b, x)))), 0.0_wp, round_off, &
                     'a point is moved by two poses as by their product')
      call test%near(maxval(abs(transformed(a, [0.0_wp, 0.0_wp, 0.0_wp]) - a%p)), 0.0_wp, 0.0_wp, &
                     'the origin is moved to the position of the pose')
    end do
  end subroutine composition

  !> Three points given in a frame lead back to it: R2 on x, R3 in the half-plane of x and -z, so that
  !> (R2 - R1) x (R3 - R1) is along y.
  subroutine from_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(pose_type) :: pose, found
    real(wp) :: scale, along, across, r2(3), r3(3)
    logical :: ok
    integer :: i

    do i = 1, 100
      pose = random_pose(random)
      scale = 10.0_wp**(3.0_wp*random%symmetric())
      pose%p = pose%p*scale
      along = random%symmetric()
      across = 1.0_wp + 0.8_wp*random%symmetric()
      r2 = transformed(pose, [scale, 0.0_wp, 0.0_wp])
      r3 = transformed(pose, [along*scale, 0.0_wp, -across*scale])
      call pose_from_points(pose%p, r2, r3, found, ok)
      call test%is_true(ok, 'three points in general give a pose')
      ! roundings of points over the least distance, 0.2 of the size
      call test%near(maxval(abs(found%r - pose%r)), 0.0_wp, 5.0_wp*round_off, &
                     'the axes of the pose of three points are those of the frame')
      call test%near(maxval(abs(found%p - pose%p)), 0.0_wp, 0.0_wp, 'the origin of the pose of three points is the first point')
      call test%near(maxval(abs(matmul(found%r, transpose(found%r)) - identity)), 0.0_wp, round_off, &
                     'the rotation of three points satisfies R R^T = 1')
    end do
  end subroutine from_points

  !> Close to one line the plane is known badly, but the matrix is a rotation all the same.
  subroutine nearly_in_line(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(pose_type) :: pose, found
    logical :: ok
    integer :: i, k

    do k = 2, 11
      do i = 1, 10
        pose = random_pose(random)
        call pose_from_points(pose%p, transformed(pose, [1.0_wp, 0.0_wp, 0.0_wp]), &
                              transformed(pose, [0.7_wp, 0.0_wp, -10.0_wp**(-k)]), found, ok)
        call test%is_true(ok, 'points close to one line give a pose')
        call test%near(maxval(abs(matmul(found%r, transpose(found%r)) - identity)), 0.0_wp, round_off, &
                       'the rotation of points close to one line satisfies R R^T = 1')
        ! roundings of the points over their distance from the line
        call test%near(maxval(abs(found%r - pose%r)), 0.0_wp, 5.0e-15_wp*10.0_wp**k, &
                       'the axes of points close to one line are found as well as their plane is known')
      end do
    end do
  end subroutine nearly_in_line

  subroutine in_line(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(pose_type) :: pose
    real(wp) :: r1(3), d(3)
    logical :: ok
    integer :: i

    do i = 1, 20
      r1 = random_vector(random)
      d = random_vector(random)
      call pose_from_points(r1, r1 + d, r1 + d*(2.0_wp + random%symmetric()), pose, ok)
      call test%is_true(.not. ok, 'three points in one line are refused')
    end do
    call pose_from_points(r1, r1, r1 + d, pose, ok)
    call test%is_true(.not. ok, 'equal first and second points are refused')
    call pose_from_points(r1, r1 + d, r1, pose, ok)
    call test%is_true(.not. ok, 'equal first and third points are refused')
    call pose_from_points(r1, r1 + d, r1 + d, pose, ok)
    call test%is_true(.not. ok, 'equal second and third points are refused')
  end subroutine in_line

  subroutine from_axis(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(pose_type) :: pose
    real(wp) :: point(3), axis(3), zero(3)
    logical :: ok
    integer :: i

    do i = 1, 100
      point = random_vector(random)
      axis = random_unit(random)
      zero = random_unit(random)
      if (norm2(cross(axis, zero)) < 0.1_wp) cycle
      call pose_from_axis(point, axis*10.0_wp**(100.0_wp*random%symmetric()), zero*3.0_wp, pose, ok)
      call test%is_true(ok, 'an axis and a direction across it give a pose')
      call test%near(maxval(abs(pose%p - point)), 0.0_wp, 0.0_wp, 'the origin of the pose of an axis is its point')
      call test%near(maxval(abs(pose%r(:, 3) - axis)), 0.0_wp, round_off, 'the z axis of the pose of an axis lies along it')
      call test%near(dot_product(cross(axis, zero), pose%r(:, 1)), 0.0_wp, round_off, &
                     'the x axis lies in the plane of the axis and the zero direction')
      call test%is_true(dot_product(zero, pose%r(:, 1)) > 0.0_wp, 'the x axis lies on the side of the zero direction')
      call test%near(maxval(abs(matmul(pose%r, transpose(pose%r)) - identity)), 0.0_wp, round_off, &
                     'the rotation of an axis and a direction satisfies R R^T = 1')
      call test%near(maxval(abs(cross(pose%r(:, 1), pose%r(:, 2)) - pose%r(:, 3))), 0.0_wp, round_off, &
                     'the axes of the pose of an axis and a direction are right-handed')
      call pose_from_axis(point, axis, axis*zero(1), pose, ok)
      call test%is_true(.not. ok, 'a zero direction along the axis is refused')
    end do
    call pose_from_axis(point, [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], pose, ok)
    call test%is_true(.not. ok, 'an axis of length zero is refused')
    call pose_from_axis(point, [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], pose, ok)
    call test%is_true(.not. ok, 'a zero direction of length zero is refused')
  end subroutine from_axis

  pure function moved(x, y, z) result(pose)
    real(wp), intent(in) :: x   !< translation along x [m]
    real(wp), intent(in) :: y   !< translation along y [m]
    real(wp), intent(in) :: z   !< translation along z [m]
    type(pose_type) :: pose

    pose%p = [x, y, z]
  end function moved

  !> T = Rz(theta) Tz(d) Tx(a) Rx(alpha), factor by factor.
  subroutine denavit_hartenberg(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(pose_type) :: expected
    real(wp) :: a, alpha, d, theta
    integer :: i

    do i = 1, 50
      a = random%symmetric()
      alpha = 2.0_wp*pi*random%symmetric()
      d = random%symmetric()
      theta = 2.0_wp*pi*random%symmetric()
      expected%p = 0.0_wp
      expected%r = about_z(theta)
      expected = compose(compose(expected, moved(0.0_wp, 0.0_wp, d)), moved(a, 0.0_wp, 0.0_wp))
      expected = compose(expected, pose_type(about_axis([1.0_wp, 0.0_wp, 0.0_wp], alpha), [0.0_wp, 0.0_wp, 0.0_wp]))
      call test%near(largest_difference(pose_from_dh(a, alpha, d, theta), expected), 0.0_wp, round_off, &
                     'the pose of Denavit-Hartenberg parameters is the product of four displacements')
    end do
    call test%near(largest_difference(pose_from_dh(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp), identity_pose), 0.0_wp, 0.0_wp, &
                   'Denavit-Hartenberg parameters of zero are no displacement')
  end subroutine denavit_hartenberg

  subroutine check_default(test, axis, expected, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: axis(3)            !< of any length
    integer, intent(in) :: expected            !< number of the right direction: 1, 2, 3 for x, y, z
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp) :: zero(3)

    zero = default_zero(axis)
    call test%near(maxval(abs(zero - identity(:, expected))), 0.0_wp, 0.0_wp, why//': the zero direction is the right one')
  end subroutine check_default

  !> The first of x, y, z at 45 degrees or more, by the angle itself; at exactly 45 it counts, whatever
  !> the length of the axis and its rounding.
  subroutine default_directions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: axis(3), angles(3), scale
    integer :: i

    call check_default(test, [0.0_wp, 0.0_wp, 1.0_wp], 1, 'axis along z')
    call check_default(test, [1.0_wp, 0.0_wp, 0.0_wp], 2, 'axis along x')
    call check_default(test, [0.0_wp, -1.0_wp, 0.0_wp], 1, 'axis along -y')
    do i = 1, 200
      scale = 10.0_wp**(5.0_wp*random%symmetric())
      call check_default(test, scale*[1.0_wp, 1.0_wp, 0.0_wp], 1, 'axis between x and y')
      call check_default(test, scale*[-1.0_wp, 0.0_wp, 1.0_wp], 1, 'axis between -x and z')
      call check_default(test, [-scale, scale, 1.0e-9_wp*scale], 1, 'axis all but between -x and y')
      call check_default(test, scale*[1.00001_wp, 1.0_wp, 0.0_wp], 2, 'axis nearer to x')
      axis = random_unit(random)
      angles = acos(min(1.0_wp, abs(axis)))
      if (any(abs(angles - 0.25_wp*pi) < 1.0e-6_wp)) cycle
      call check_default(test, axis*scale, findloc(angles > 0.25_wp*pi, .true., dim=1), 'any axis')
    end do
    call check_default(test, [cos(0.25_wp*pi), sin(0.25_wp*pi), 0.0_wp], 1, 'an axis from an angle of 45 degrees')
  end subroutine default_directions
end module test_pose
