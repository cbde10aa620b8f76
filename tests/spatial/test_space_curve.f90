!> Curves by their arc length: lines are exact, circles and ellipses converge with sixth order, derivatives and frames agree with
!> differences, and frames of closed curves close.
module test_space_curve
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_data
  use mech9_random, only: random_type
  use mech9_rotation, only: cross, combine, identity
  use mech9_space_curve, only: space_curve_type, curve_place_type, build_curve
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('straight_line')) call straight_line(test)
    if (test%runs('circle')) call circle(test)
    if (test%runs('ellipse')) call ellipse(test)
    if (test%runs('helix')) call helix(test)
    if (test%runs('derivatives')) call derivatives(test)
    if (test%runs('closed_frame')) call closed_frame(test)
    if (test%runs('refused')) call refused(test)
  end subroutine run

  !> On points of a line at uneven distances, the arc length is the distance to round-off, and nothing turns.
  subroutine straight_line(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: way(7) = [0.0_wp, 0.3_wp, 0.4_wp, 1.1_wp, 1.15_wp, 1.9_wp, 2.5_wp]
    real(wp), parameter :: along(3) = [2.0_wp, -1.0_wp, 2.0_wp]/3.0_wp
    type(space_curve_type) :: curve
    type(curve_place_type) :: place
    type(error_type), allocatable :: err
    real(wp) :: points(3, 7)
    integer :: i

    do i = 1, 7
      points(:, i) = [5.0_wp, 4.0_wp, 3.0_wp] + way(i)*along
    end do
    call build_curve(points, .false., curve, err)
    call test%no_error(err, 'a straight line is accepted')
    call test%near(curve%length, 2.5_wp, 4.0e-15_wp, 'its length is that of the line')
    do i = 0, 25
      call curve%locate(0.1_wp*i, place)
      ! coordinates of some 5 are rounded by 1e-15; differences over 0.05 enlarge this by 20 for each derivative
      call test%near(norm2(place%point - [5.0_wp, 4.0_wp, 3.0_wp] - 0.1_wp*i*along), 0.0_wp, 1.0e-14_wp, 'places lie on the line')
      call test%near(norm2(place%tangent - along), 0.0_wp, 1.0e-13_wp, 'the tangent lies along the line')
      call test%near(norm2(place%curvature), 0.0_wp, 1.0e-11_wp, 'a line has no curvature')
    end do
  end subroutine straight_line

  !> Circles through points at uneven angles: the length and the curvature converge with the orders of splines of fifth degree.
  subroutine circle(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: coarse(3), fine(3)
    logical :: closed
    integer :: i

    do i = 1, 2
      closed = i == 2
      coarse = circle_errors(test, 64, closed)
      fine = circle_errors(test, 128, closed)
      ! quotients of 64, 64 and 16 where each parametrisation is as accurate as the spline; those of chords alone give 16 and 4
      call test%is_true(coarse(1)/fine(1) > 45.0_wp, 'places on a circle converge with sixth order')
      call test%is_true(coarse(2)/fine(2) > 30.0_wp .or. fine(2) < 1.0e-11_wp, 'lengths converge at least with fifth order')
      call test%is_true(coarse(3)/fine(3) > 11.0_wp, 'curvatures converge with fourth order')
      call test%is_true(fine(1) < 1.0e-8_wp, 'few points give a circle nearly exactly')
    end do
  end subroutine circle

  !> Largest errors of the distance from the centre, of the whole length and of the curvature of a unit circle.
  function circle_errors(test, n, closed) result(errors)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< pieces
    logical, intent(in) :: closed              !< the whole circle, or three quarters of it
    real(wp) :: errors(3)
    type(space_curve_type) :: curve
    type(curve_place_type) :: place
    type(error_type), allocatable :: err
    real(wp) :: points(3, 0:n), t, whole
    integer :: i

    whole = merge(2.0_wp, 1.5_wp, closed)*pi
    do i = 0, n
      t = whole*i/n
      if (i < n) t = t + 0.3_wp*sin(2.0_wp*pi*i/n) + 0.2_wp*modulo(i, 2)*whole/n
      points(:, i) = [cos(t), sin(t), 0.0_wp]
    end do
    if (closed) points(:, n) = points(:, 0)
    call build_curve(points, closed, curve, err)
    call test%no_error(err, 'points of a circle are accepted')
    errors = [0.0_wp, abs(curve%length - whole), 0.0_wp]
    do i = 0, 3000
      call curve%locate(i*curve%length/3000, place)
      errors(1) = max(errors(1), abs(norm2(place%point) - 1.0_wp))
      errors(3) = max(errors(3), norm2(place%curvature + place%point))
    end do
  end function circle_errors

  !> The length of an ellipse against the complete elliptic integral, by Gauss's arithmetic-geometric mean.
  subroutine ellipse(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: errors(2), exact
    integer :: i

    exact = length_of_ellipse(2.0_wp, 1.0_wp)
    do i = 1, 2
      errors(i) = abs(ellipse_length(test, 32*i) - exact)
    end do
    call test%is_true(errors(1)/errors(2) > 32.0_wp, 'the length of an ellipse converges')
    call test%near(ellipse_length(test, 1000), exact, 1.0e-14_wp*exact, 'the length of an ellipse is exact for many points')
  end subroutine ellipse

  !> Length of the curve through points of an ellipse.
  real(wp) function ellipse_length(test, n)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< points
    type(space_curve_type) :: curve
    type(error_type), allocatable :: err
    real(wp) :: points(3, 0:n)
    integer :: i

    do i = 0, n
      points(:, i) = [2.0_wp*cos(2.0_wp*pi*i/n), 0.0_wp, sin(2.0_wp*pi*i/n)]
    end do
    points(:, n) = points(:, 0)
    call build_curve(points, .true., curve, err)
    call test%no_error(err, 'points of an ellipse are accepted')
    ellipse_length = curve%length
  end function ellipse_length

  !> 4 a E(e), where E is the complete elliptic integral of the second kind (Abramowitz and Stegun, 17.6).
  pure real(wp) function length_of_ellipse(a, b) result(length)
    real(wp), intent(in) :: a   !< long half axis
    real(wp), intent(in) :: b   !< short half axis
    real(wp) :: mean, geometric, total, half, power

    mean = a
    geometric = b
    total = 0.5_wp*(a**2 - b**2)
    power = 0.5_wp
    do while (mean - geometric > epsilon(mean)*mean)
      half = 0.5_wp*(mean - geometric)
      power = 2.0_wp*power
      total = total + power*half**2
      half = sqrt(mean*geometric)
      mean = 0.5_wp*(mean + geometric)
      geometric = half
    end do
    length = 2.0_wp*pi*(a**2 - total)/mean
  end function length_of_ellipse

  !> A helix has constant curvature, and relative to its principal normal a carried frame turns back at the rate of its torsion.
  subroutine helix(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: radius = 0.3_wp, rise = 0.4_wp   ! a speed of 0.5 per rad
    integer, parameter :: n = 200
    type(space_curve_type) :: curve
    type(curve_place_type) :: place
    type(error_type), allocatable :: err
    real(wp) :: points(3, 0:n), r(3, 3), normal(3), angle, before
    integer :: i

    do i = 0, n
      points(:, i) = [radius*cos(0.05_wp*i), radius*sin(0.05_wp*i), rise*0.05_wp*i]
    end do
    call build_curve(points, .false., curve, err)
    call test%no_error(err, 'a helix is accepted')
    call test%near(curve%length, 5.0_wp, 1.0e-12_wp, 'its length is that of the hypotenuse')
    before = 0.0_wp
    do i = 0, 50
      call curve%locate(curve%length*i/50, place)
      ! the ends are known to fourth order only: (0.05/2)^4 times derivatives and constants of the order of 10
      call test%near(norm2(place%curvature), radius/0.25_wp, 1.0e-5_wp, 'its curvature is constant')
      r = curve%frame_at(place)
      normal = place%curvature/norm2(place%curvature)
      angle = atan2(dot_product(normal, r(:, 3)), dot_product(normal, r(:, 2)))
      if (i > 0) call test%near(modulo(angle - before + pi, 2.0_wp*pi) - pi, 0.1_wp*rise/0.25_wp, 1.0e-6_wp, &
                                'the principal normal turns in the frame at the rate of the torsion')
      before = angle
    end do
  end subroutine helix

  !> A knot with inflections nearby: each derivative against differences of the one before it, and the frame's turning.
  subroutine derivatives(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(space_curve_type) :: curve
    type(curve_place_type) :: place, before, after
    type(random_type) :: random
    real(wp), parameter :: h = 1.0e-4_wp
    real(wp) :: r(3, 3), change(3, 3), turning(3), s
    integer :: i, k

    call build_knot(test, 60, curve)
    do i = 1, 200
      s = 3.0_wp*curve%length*random%symmetric()
      call curve%locate(s - h, before)
      call curve%locate(s, place)
      call curve%locate(s + h, after)
      ! the error of differences is h^2/6 of third derivatives, which reach 10 to 100
      call test%near(norm2((after%point - before%point)/(2.0_wp*h) - place%tangent), 0.0_wp, 1.0e-7_wp, &
                     'the tangent is the derivative of the place')
      call test%near(norm2((after%tangent - before%tangent)/(2.0_wp*h) - place%curvature), 0.0_wp, 1.0e-7_wp, &
                     'the curvature is the derivative of the tangent')
      call test%near(norm2((after%curvature - before%curvature)/(2.0_wp*h) - place%curvature_rate), 0.0_wp, 1.0e-6_wp, &
                     'the last vector is the derivative of the curvature')
      r = curve%frame_at(place)
      change = (curve%frame_at(after) - curve%frame_at(before))/(2.0_wp*h)
      turning = cross(place%tangent, place%curvature) + curve%twist*place%tangent
      do k = 1, 3
        call test%near(norm2(change(:, k) - cross(turning, r(:, k))), 0.0_wp, 1.0e-7_wp, 'the frame turns as it is said to')
      end do
      call test%near(maxval(abs(combine(transpose(r), r) - identity)), 0.0_wp, 1.0e-15_wp, 'the frame is orthonormal')
      call test%near(norm2(r(:, 1) - place%tangent), 0.0_wp, 0.0_wp, 'its x axis is the tangent')
    end do
  end subroutine derivatives

  !> The frame of a closed curve is the same after one turn and after many.
  subroutine closed_frame(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(space_curve_type) :: curve
    type(curve_place_type) :: first, last
    integer :: turn

    call build_knot(test, 40, curve)
    call test%is_true(abs(curve%twist*curve%length) > 0.1_wp, 'this knot would not close its frame without turning it')
    call curve%locate(0.0_wp, first)
    do turn = -2, 3
      call curve%locate(turn*curve%length - 1.0e-14_wp, last)
      call test%near(norm2(first%point - last%point), 0.0_wp, 1.0e-13_wp, 'the curve closes')
      call test%near(norm2(first%curvature_rate - last%curvature_rate), 0.0_wp, 1.0e-10_wp, 'its derivatives close')
      call test%near(maxval(abs(curve%frame_at(first) - curve%frame_at(last))), 0.0_wp, 1.0e-13_wp, 'its frame closes')
    end do
  end subroutine closed_frame

  !> A trefoil on a torus.
  subroutine build_knot(test, n, curve)
    type(tester_type), intent(inout) :: test       !< counts the checks
    integer, intent(in) :: n                       !< points
    type(space_curve_type), intent(out) :: curve   !< the curve
    type(error_type), allocatable :: err
    real(wp) :: points(3, 0:n), t
    integer :: i

    do i = 0, n
      t = 2.0_wp*pi*i/n
      points(:, i) = [(2.0_wp + cos(3.0_wp*t))*cos(2.0_wp*t), (2.0_wp + cos(3.0_wp*t))*sin(2.0_wp*t), sin(3.0_wp*t)]
    end do
    points(:, n) = points(:, 0)
    call build_curve(points, .true., curve, err)
    call test%no_error(err, 'a knot is accepted')
  end subroutine build_knot

  !> A line that turns back on itself has no tangent at its end.
  subroutine refused(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(space_curve_type) :: curve
    type(error_type), allocatable :: err
    real(wp) :: points(3, 9)
    integer :: i

    points = 0.0_wp
    points(1, :) = [(4.0_wp - abs(real(i - 5, wp)), i=1, 9)]
    call build_curve(points, .false., curve, err)
    call test%has_error(err, exit_data, 'a line that turns back is refused')
    call build_curve(points, .true., curve, err)
    call test%has_error(err, exit_data, 'a closed line that turns back is refused')
    call build_curve(points(:, :3), .false., curve, err)
    call test%has_error(err, exit_data, 'three points are refused')
  end subroutine refused
end module test_space_curve
