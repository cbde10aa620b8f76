!> A pair seen from its moving link: the inverse pose, and its derivatives against differences.
module test_reversed_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width
  use mech9_rotation, only: about_axis
  use mech9_pose, only: pose_type, compose, inverse, identity_pose
  use mech9_pair, only: reversed_motion, pair_motion_type
  use mech9_screw_pair, only: screw_pair_type, helical_pair
  use mech9_random_geometry, only: random_vector, random_unit, random_pose, largest_difference
  use mech9_motion_check, only: motion_from_poses, poses_around, check_same_motion
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Differences at this step leave round-off times 2/h and 8/h^2; truncation is 1e-30.
  real(wp), parameter :: h = 1.0_wp/32.0_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_pairs')) call random_pairs(test)
  end subroutine run

  !> Pairs at random.
  subroutine random_pairs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer :: trial

    do trial = 1, 30
      call reversed_screw(test, random)
      call reversed_general(test, random)
    end do
  end subroutine random_pairs

  !> A helical pair, which states its own derivatives.
  subroutine reversed_screw(test, random)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(screw_pair_type) :: pair, exchanged
    type(pose_type) :: f, g, poses(-half_width:half_width)
    type(pair_motion_type) :: motion, back, expected
    type(error_type), allocatable :: err
    real(wp) :: q, pitch
    integer :: i

    q = 3.0_wp*random%symmetric()
    pitch = random%symmetric()
    f = random_pose(random)
    g = random_pose(random)
    pair = helical_pair(f, g, pitch)
    call pair%evaluate(q, motion, err)
    call test%no_error(err, 'a helical pair is evaluated')
    back = reversed_motion(motion)
    call poses_around(test, pair, q, h, poses)
    do i = -half_width, half_width
      poses(i) = inverse(poses(i))
    end do
    call motion_from_poses(poses, h, expected)
    call check_same_motion(test, back, expected, [1.0e-15_wp, 2.0e-13_wp, 2.0e-11_wp], 'a screw, reversed')
    ! (F motion(q) G^-1)^-1 = G motion(-q) F^-1: the same pair with its frames exchanged, run backwards
    exchanged = helical_pair(g, f, pitch)
    call exchanged%evaluate(-q, expected, err)
    call test%no_error(err, 'a helical pair with its links exchanged is evaluated')
    expected%w = -expected%w
    expected%v = -expected%v
    call check_same_motion(test, back, expected, [1.0e-14_wp, 1.0e-14_wp, 1.0e-14_wp], 'a screw with its frames exchanged')
    call test%near(largest_difference(compose(motion%pose, back%pose), identity_pose), 0.0_wp, 1.0e-14_wp, &
                   'a pose followed by that of the exchanged pair is no displacement')
    call check_same_motion(test, reversed_motion(back), motion, [1.0e-14_wp, 1.0e-14_wp, 1.0e-14_wp], 'twice reversed')
  end subroutine reversed_screw

  !> A motion whose axis turns and whose speed changes, with its derivatives in closed form: two turns
  !> at uneven rates, one after the other, and a curve.
  subroutine reversed_general(test, random)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(pose_type) :: poses(-half_width:half_width)
    type(pair_motion_type) :: motion, expected
    real(wp) :: a(3), b(3), c(3), d(3), e(3), q, x
    integer :: i

    a = random_unit(random)
    b = random_unit(random)
    c = random_vector(random)
    d = random_vector(random)
    e = random_vector(random)
    q = random%symmetric()
    do i = -half_width, half_width
      x = q + i*h
      poses(i)%r = matmul(about_axis(a, x + 0.3_wp*x*x), about_axis(b, sin(x)))
      poses(i)%p = c + x*d + cos(x)*e
    end do
    call general_motion(a, b, c, d, e, q, motion)
    call motion_from_poses(poses, h, expected)
    call check_same_motion(test, motion, expected, [1.0e-15_wp, 2.0e-13_wp, 2.0e-11_wp], 'a general motion')
    do i = -half_width, half_width
      poses(i) = inverse(poses(i))
    end do
    call motion_from_poses(poses, h, expected)
    call check_same_motion(test, reversed_motion(motion), expected, [1.0e-15_wp, 2.0e-13_wp, 4.0e-11_wp], &
                           'a general motion, reversed')
  end subroutine reversed_general

  !> w = f' a + Ra g' b, where Ra turns about a by f = x + 0.3 x^2 and the second turn is g = sin x.
  subroutine general_motion(a, b, c, d, e, x, motion)
    real(wp), intent(in) :: a(3)                    !< axis of the first turn
    real(wp), intent(in) :: b(3)                    !< axis of the second turn
    real(wp), intent(in) :: c(3)                    !< coefficients of the curve
    real(wp), intent(in) :: d(3)                    !< coefficients of the curve
    real(wp), intent(in) :: e(3)                    !< coefficients of the curve
    real(wp), intent(in) :: x                       !< the coordinate
    type(pair_motion_type), intent(out) :: motion   !< with its derivatives
    real(wp) :: r_a(3, 3), f_first, carried(3), spin(3)

    r_a = about_axis(a, x + 0.3_wp*x*x)
    f_first = 1.0_wp + 0.6_wp*x
    carried = matmul(r_a, b)
    ! a x carried: the rate of what the first turn carries along
    spin = [a(2)*carried(3) - a(3)*carried(2), a(3)*carried(1) - a(1)*carried(3), a(1)*carried(2) - a(2)*carried(1)]
    motion%pose%r = matmul(r_a, about_axis(b, sin(x)))
    motion%pose%p = c + x*d + cos(x)*e
    motion%w = f_first*a + cos(x)*carried
    motion%w_rate = 0.6_wp*a - sin(x)*carried + cos(x)*f_first*spin
    motion%v = d - sin(x)*e
    motion%v_rate = -cos(x)*e
  end subroutine general_motion
end module test_reversed_motion
