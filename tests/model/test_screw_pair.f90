!> Revolute, prismatic and helical pairs: their motion against elementary poses, their derivatives
!> against differences, their factors against their motion.
module test_screw_pair
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_rotation, only: about_z
  use mech9_pose, only: pose_type, compose, inverse, transformed, pose_from_dh
  use mech9_pair, only: pair_motion_type, screw_factors_type
  use mech9_screw_pair, only: screw_pair_type, revolute_pair, prismatic_pair, helical_pair, &
    revolute_pair_dh, prismatic_pair_dh, helical_pair_dh
  use mech9_random_geometry, only: random_pose, largest_difference
  use mech9_motion_check, only: check_derivatives
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A few roundings of numbers of order one.
  real(wp), parameter :: round_off = 1.0e-14_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_pairs')) call random_pairs(test)
    if (test%runs('kinds_and_units')) call kinds_and_units(test)
  end subroutine run

  subroutine random_pairs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer :: trial

    do trial = 1, 15
      call with_frames(test, random)
      call with_denavit_hartenberg(test, random)
      call fixed_axes(test, random)
    end do
  end subroutine random_pairs

  function pose_at(test, pair, q) result(pose)
    type(tester_type), intent(inout) :: test    !< counts the checks
    type(screw_pair_type), intent(in) :: pair   !< the pair
    real(wp), intent(in) :: q                   !< coordinate [rad or m]
    type(pose_type) :: pose
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err

    call pair%evaluate(q, motion, err)
    if (allocated(err)) call test%no_error(err, 'a screw pair has a pose everywhere')
    pose = motion%pose
  end function pose_at

  !> A turn about z and a translation along z.
  pure function turn_and_slide(angle, length) result(pose)
    real(wp), intent(in) :: angle    !< about z [rad]
    real(wp), intent(in) :: length   !< along z [m]
    type(pose_type) :: pose

    pose%r = about_z(angle)
    pose%p = [0.0_wp, 0.0_wp, length]
  end function turn_and_slide

  !> Pose, derivatives and factors of one pair at one position.
  subroutine check_pair(test, pair, q, expected, why)
    type(tester_type), intent(inout) :: test    !< counts the checks
    type(screw_pair_type), intent(in) :: pair   !< the pair
    real(wp), intent(in) :: q                   !< coordinate [rad or m]
    type(pose_type), intent(in) :: expected     !< the right pose
    character(len=*), intent(in) :: why         !< the statement that is checked, printed where it is wrong
    type(screw_factors_type) :: factors
    type(pose_type) :: composed
    logical :: is_screw

    call test%near(largest_difference(pose_at(test, pair, q), expected), 0.0_wp, round_off, why//': the pose is the composed one')
    call check_derivatives(test, pair, q, why)
    call pair%as_screw(factors, is_screw)
    call test%is_true(is_screw, why//': the motion is a screw')
    composed = turn_and_slide(factors%turn*(q + factors%offset), factors%slide*(q + factors%offset))
    composed = compose(compose(factors%before, composed), factors%after)
    call test%near(largest_difference(pose_at(test, pair, q), composed), 0.0_wp, round_off, &
                   why//': the factors compose to the pose')
  end subroutine check_pair

  !> T(q) = F motion(q) G^-1.
  subroutine with_frames(test, random)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(pose_type) :: f, g
    real(wp) :: q, pitch

    f = random_pose(random)
    g = random_pose(random)
    q = 4.0_wp*random%symmetric()
    pitch = random%symmetric()
    call check_pair(test, revolute_pair(f, g), q, compose(compose(f, turn_and_slide(q, 0.0_wp)), inverse(g)), 'revolute pair')
    call check_pair(test, prismatic_pair(f, g), q, compose(compose(f, turn_and_slide(0.0_wp, q)), inverse(g)), &
                    'prismatic pair')
    call check_pair(test, helical_pair(f, g, pitch), q, &
                    compose(compose(f, turn_and_slide(q, pitch*q/(2.0_wp*pi))), inverse(g)), 'helical pair')
    ! with one frame for both, all link systems coincide at home
    call test%near(largest_difference(pose_at(test, revolute_pair(f, f), 0.0_wp), pose_type()), 0.0_wp, round_off, &
                   'a revolute pair with equal frames has no displacement at zero')
    call test%near(largest_difference(pose_at(test, helical_pair(f, f, pitch), 0.0_wp), pose_type()), 0.0_wp, round_off, &
                   'a helical pair with equal frames has no displacement at zero')
  end subroutine with_frames

  !> T = Rz(theta) Tz(d) Tx(a) Rx(alpha) with q added to theta, or to d; a helical pair advances besides.
  subroutine with_denavit_hartenberg(test, random)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp) :: a, alpha, d, theta, q, pitch

    a = random%symmetric()
    alpha = pi*random%symmetric()
    d = random%symmetric()
    theta = pi*random%symmetric()
    q = 3.0_wp*random%symmetric()
    pitch = random%symmetric()
    call check_pair(test, revolute_pair_dh(a, alpha, d, theta), q, pose_from_dh(a, alpha, d, theta + q), &
                    'revolute pair by Denavit-Hartenberg parameters')
    call check_pair(test, prismatic_pair_dh(a, alpha, d, theta), q, pose_from_dh(a, alpha, d + q, theta), &
                    'prismatic pair by Denavit-Hartenberg parameters')
    call check_pair(test, helical_pair_dh(a, alpha, d, theta, pitch), q, &
                    pose_from_dh(a, alpha, d + pitch*q/(2.0_wp*pi), theta + q), &
                    'helical pair by Denavit-Hartenberg parameters')
  end subroutine with_denavit_hartenberg

  !> Points of the axis stay on it: a turn leaves them, a slide moves them by q, a full turn of a screw
  !> by its pitch.
  subroutine fixed_axes(test, random)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(pose_type) :: f, g, turned
    real(wp) :: on_axis(3), q, pitch

    f = random_pose(random)
    g = random_pose(random)
    q = 3.0_wp*random%symmetric()
    pitch = random%symmetric()
    on_axis = [0.0_wp, 0.0_wp, random%symmetric()]
    call test%near(maxval(abs(transformed(pose_at(test, revolute_pair(f, g), q), transformed(g, on_axis)) &
                              - transformed(f, on_axis))), 0.0_wp, round_off, &
                              'points of the axis of a revolute pair stay where they are')
    call test%near(maxval(abs(transformed(pose_at(test, prismatic_pair(f, g), q), transformed(g, on_axis)) &
                              - transformed(f, on_axis) - q*f%r(:, 3))), 0.0_wp, round_off, &
                   'points of the axis of a prismatic pair move along it by the coordinate')
    turned = pose_at(test, helical_pair(f, g, pitch), q + 2.0_wp*pi)
    turned%p = turned%p - pitch*f%r(:, 3)
    call test%near(largest_difference(turned, pose_at(test, helical_pair(f, g, pitch), q)), 0.0_wp, round_off, &
                   'a helical pair advances by its pitch in a full turn')
  end subroutine fixed_axes

  subroutine kinds_and_units(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(screw_pair_type) :: pair
    type(pose_type) :: home

    pair = revolute_pair(home, home)
    call test%is_true(pair%kind_name() == 'revolute' .and. pair%angular, 'a revolute pair has an angle')
    pair = prismatic_pair(home, home)
    call test%is_true(pair%kind_name() == 'prismatic' .and. .not. pair%angular, 'a prismatic pair has a length')
    pair = helical_pair(home, home, -0.1_wp)
    call test%is_true(pair%kind_name() == 'helical' .and. pair%angular, 'a helical pair has an angle')
    pair = revolute_pair_dh(1.0_wp, 0.2_wp, 0.3_wp, 0.4_wp)
    call test%is_true(pair%kind_name() == 'revolute' .and. pair%angular, &
                      'a revolute pair by Denavit-Hartenberg parameters has an angle')
    pair = prismatic_pair_dh(1.0_wp, 0.2_wp, 0.3_wp, 0.4_wp)
    call test%is_true(pair%kind_name() == 'prismatic' .and. .not. pair%angular, &
                      'a prismatic pair by Denavit-Hartenberg parameters has a length')
    pair = helical_pair_dh(1.0_wp, 0.2_wp, 0.3_wp, 0.4_wp, 0.1_wp)
    call test%is_true(pair%kind_name() == 'helical' .and. pair%angular, &
                      'a helical pair by Denavit-Hartenberg parameters has an angle')
    call test%is_true(pair%user_calls() == 0, 'a pair of the program calls no procedure of a user')
  end subroutine kinds_and_units
end module test_screw_pair
