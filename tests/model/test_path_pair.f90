!> Third derivatives of path pairs, seen from either link, agree with differences of the second ones that the pairs give.
module test_path_pair
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_pose, only: identity_pose
  use mech9_space_curve, only: space_curve_type, build_curve
  use mech9_pair, only: pair_motion_type, pair_thirds_type, reversed_motion, reversed_thirds
  use mech9_path_pair, only: path_pair_type, path_pair
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('fixed')) call third_derivatives(test, along=.false., closed=.false.)
    if (test%runs('along')) call third_derivatives(test, along=.true., closed=.false.)
    if (test%runs('closed')) call third_derivatives(test, along=.true., closed=.true.)
  end subroutine run

  !> A random curve, at places away from its points, where the fourth derivative of the spline has corners, and at its ends.
  subroutine third_derivatives(test, along, closed)
    type(tester_type), intent(inout) :: test   !< counts the checks
    logical, intent(in) :: along               !< the moving link turns with the tangent
    logical, intent(in) :: closed              !< the curve is closed
    type(space_curve_type) :: curve
    type(path_pair_type) :: pair
    type(pair_thirds_type) :: thirds
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp) :: points(3, 9), q
    integer :: i

    call curve_through(points, closed)
    call build_curve(points, closed, curve, err)
    call test%no_error(err, 'a random curve is accepted')
    pair = path_pair(curve, 1.0_wp, along, identity_pose, identity_pose)
    do i = 1, size(curve%piece)
      ! the middle of a part is no point of the curve
      q = 0.5_wp*(curve%s(i - 1) + curve%s(i))
      call pair%thirds(q, thirds)
      call test%is_true(thirds%known, 'a path pair knows its third derivatives')
      call pair%evaluate(q, motion, err)
      call test%no_error(err, 'a path pair has a pose on its curve')
      call compare(test, pair, q, thirds, .false.)
      call compare(test, pair, q, reversed_thirds(motion, thirds), .true.)
    end do
    if (closed) return
    ! at the ends themselves there are differences to one side only, and the third derivatives are those of the end pieces
    call pair%thirds(0.0_wp, thirds)
    call test%is_true(thirds%known .and. all(abs(thirds%v) < huge(q)), 'third derivatives at the beginning of an open curve')
    call pair%thirds(curve%length, thirds)
    call test%is_true(thirds%known .and. all(abs(thirds%w) < huge(q)), 'third derivatives at the end of an open curve')
  end subroutine third_derivatives

  !> Points at random near a turn of a helix.
  subroutine curve_through(points, closed)
    real(wp), intent(out) :: points(3, 9)   !< the points; the last one is the first one where the curve is closed [m]
    logical, intent(in) :: closed           !< whether it is
    type(random_type) :: random
    real(wp) :: noise(3), angle
    integer :: i, k

    do i = 1, 9
      angle = 0.75_wp*(i - 1)
      do k = 1, 3
        noise(k) = random%symmetric()
      end do
      points(:, i) = [cos(angle), sin(angle), 0.2_wp*sin(2.0_wp*angle)] + 0.1_wp*noise
    end do
    if (closed) points(:, 9) = points(:, 1)
  end subroutine curve_through

  !> Differences of fourth order at a distance of 1e-3 of the pair's second derivatives: errors of some 1e-12 times the sixth
  !> derivatives, which are up to some thousands here, and round-off of 1e-16 times second derivatives over 1e-3.
  subroutine compare(test, pair, q, thirds, reversed)
    type(tester_type), intent(inout) :: test       !< counts the checks
    type(path_pair_type), intent(in) :: pair       !< the pair
    real(wp), intent(in) :: q                      !< its coordinate [m]
    type(pair_thirds_type), intent(in) :: thirds   !< the derivatives that are tested
    logical, intent(in) :: reversed                !< they are those of the reference link in the moving one
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp), parameter :: h = 1.0e-3_wp, weights(-2:2) = [1.0_wp, -8.0_wp, 0.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
    real(wp) :: w(3), v(3)
    integer :: i

    w = 0.0_wp
    v = 0.0_wp
    do i = -2, 2
      call pair%evaluate(q + i*h, motion, err)
      call test%no_error(err, 'a path pair has a pose near its place')
      if (reversed) motion = reversed_motion(motion)
      w = w + weights(i)*motion%w_rate/h
      v = v + weights(i)*motion%v_rate/h
    end do
    call test%is_true(norm2(thirds%w - w) <= 1.0e-6_wp*max(1.0_wp, norm2(w)), 'third derivative of the rotation')
    call test%is_true(norm2(thirds%v - v) <= 1.0e-6_wp*max(1.0_wp, norm2(v)), 'third derivative of the origin')
  end subroutine compare
end module test_path_pair
