!> Motions of pairs against differences of their poses.
module mech9_motion_check
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_rotation, only: axial_vector
  use mech9_pose, only: pose_type
  use mech9_pair, only: pair_type, pair_motion_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: motion_from_poses, poses_around, check_derivatives, check_same_motion

contains

  !> The poses of a pair at q + i h, i = -8 .. 8.
  subroutine poses_around(test, pair, q, h, poses)
    type(tester_type), intent(inout) :: test                        !< counts the checks
    class(pair_type), intent(in) :: pair                            !< the pair
    real(wp), intent(in) :: q                                       !< coordinate in the middle [rad or m]
    real(wp), intent(in) :: h                                       !< distance of neighbours [rad or m]
    type(pose_type), intent(out) :: poses(-half_width:half_width)   !< at q + i h
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    integer :: i

    do i = -half_width, half_width
      call pair%evaluate(q + i*h, motion, err)
      if (allocated(err)) call test%no_error(err, 'a pair near the position where it is checked')
      poses(i) = motion%pose
    end do
  end subroutine poses_around

  !> Pose, screw and its rate at the middle one of poses at distances h of the coordinate.
  pure subroutine motion_from_poses(poses, h, motion)
    type(pose_type), intent(in) :: poses(-half_width:half_width)   !< at distances h of the coordinate
    real(wp), intent(in) :: h                                      !< distance of neighbours [rad or m]
    type(pair_motion_type), intent(out) :: motion                  !< in the middle
    real(wp) :: first(3, 3), second(3, 3), turned_back(3, 3), error
    integer :: i, j

    motion%pose = poses(0)
    do j = 1, 3
      call derivatives_from_stencil(poses%p(j), h, motion%v(j), motion%v_rate(j), error)
      do i = 1, 3
        call derivatives_from_stencil(poses%r(i, j), h, first(i, j), second(i, j), error)
      end do
    end do
    ! A' A^T = w x, and the skew part of A'' A^T is w' x
    turned_back = transpose(poses(0)%r)
    motion%w = axial_vector(matmul(first, turned_back))
    motion%w_rate = axial_vector(matmul(second, turned_back))
  end subroutine motion_from_poses

  !> Check that the derivatives of a pair agree with differences of its poses. Sixteenth-order differences
  !> at h = 1/32 leave, for motions that change over a length of one, no truncation (1e-30) but the
  !> round-off of the poses times 2/h and 8/h^2.
  subroutine check_derivatives(test, pair, q, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    class(pair_type), intent(in) :: pair       !< the pair
    real(wp), intent(in) :: q                  !< coordinate at which it is checked [rad or m]
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp), parameter :: h = 1.0_wp/32.0_wp
    type(pose_type) :: poses(-half_width:half_width)
    type(pair_motion_type) :: motion, expected
    type(error_type), allocatable :: err

    call pair%evaluate(q, motion, err)
    call test%no_error(err, why//': the pair has a motion')
    call poses_around(test, pair, q, h, poses)
    call motion_from_poses(poses, h, expected)
    call check_same_motion(test, motion, expected, [0.0_wp, 1.0e-13_wp, 1.0e-11_wp], why)
  end subroutine check_derivatives

  !> Check that two motions agree: tolerances of the pose, of the first and of the second derivatives,
  !> against the larger of one and the largest number of each.
  subroutine check_same_motion(test, motion, expected, tolerances, why)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(pair_motion_type), intent(in) :: motion     !< the motion that is checked
    type(pair_motion_type), intent(in) :: expected   !< the right motion
    real(wp), intent(in) :: tolerances(3)            !< of the pose, of the screw, of its rate
    character(len=*), intent(in) :: why              !< the statement that is checked, printed where it is wrong

    call check_numbers(test, reshape(motion%pose%r, [9]), reshape(expected%pose%r, [9]), tolerances(1), &
                       why//': the rotations are equal')
    call check_numbers(test, motion%pose%p, expected%pose%p, tolerances(1), why//': the translations are equal')
    call check_numbers(test, motion%w, expected%w, tolerances(2), why//': the angular velocities are equal')
    call check_numbers(test, motion%v, expected%v, tolerances(2), why//': the velocities are equal')
    call check_numbers(test, motion%w_rate, expected%w_rate, tolerances(3), why//': the rates of the angular velocities are equal')
    call check_numbers(test, motion%v_rate, expected%v_rate, tolerances(3), why//': the rates of the velocities are equal')
  end subroutine check_same_motion

  subroutine check_numbers(test, numbers, expected, tolerance, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: numbers(:)         !< numbers that are checked
    real(wp), intent(in) :: expected(:)        !< the right numbers, as many
    real(wp), intent(in) :: tolerance          !< over the larger of one and the largest number
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp) :: scale

    scale = max(1.0_wp, maxval(abs(expected)))
    call test%near(maxval(abs(numbers - expected))/scale, 0.0_wp, tolerance, why)
  end subroutine check_numbers
end module mech9_motion_check
