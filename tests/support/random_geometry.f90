!> Random vectors, rotations and poses for tests, reproducible.
!>
!> Rotations come from quaternions, so that they are no product of the procedures under test.
module mech9_random_geometry
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_pose, only: pose_type
  implicit none
  private
  public :: random_vector, random_unit, random_rotation, random_pose, random_matrix, rotation_from_quaternion
  public :: largest_difference

contains

  !> Components between -1 and 1.
  function random_vector(random) result(a)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp) :: a(3)
    integer :: i

    do i = 1, 3
      a(i) = random%symmetric()
    end do
  end function random_vector

  !> A unit vector, each direction with the same probability.
  function random_unit(random) result(e)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp) :: e(3), length

    do
      e = random_vector(random)
      length = norm2(e)
      if (length > 0.1_wp .and. length <= 1.0_wp) exit
    end do
    e = e/length
  end function random_unit

  !> Entries between -1 and 1.
  function random_matrix(random, m, n) result(a)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: m                     !< rows
    integer, intent(in) :: n                     !< columns
    real(wp) :: a(m, n)
    integer :: i, j

    do j = 1, n
      do i = 1, m
        a(i, j) = random%symmetric()
      end do
    end do
  end function random_matrix

  !> The rotation of a quaternion of any length but zero, scalar part first.
  pure function rotation_from_quaternion(quaternion) result(r)
    real(wp), intent(in) :: quaternion(0:3)   !< scalar part first, not zero
    real(wp) :: r(3, 3), q(0:3)

    q = quaternion/norm2(quaternion)
    r(:, 1) = [q(0)**2 + q(1)**2 - q(2)**2 - q(3)**2, 2.0_wp*(q(1)*q(2) + q(0)*q(3)), 2.0_wp*(q(1)*q(3) - q(0)*q(2))]
    r(:, 2) = [2.0_wp*(q(1)*q(2) - q(0)*q(3)), q(0)**2 - q(1)**2 + q(2)**2 - q(3)**2, 2.0_wp*(q(2)*q(3) + q(0)*q(1))]
    r(:, 3) = [2.0_wp*(q(1)*q(3) + q(0)*q(2)), 2.0_wp*(q(2)*q(3) - q(0)*q(1)), q(0)**2 - q(1)**2 - q(2)**2 + q(3)**2]
  end function rotation_from_quaternion

  !> A random rotation.
  function random_rotation(random) result(r)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp) :: r(3, 3), q(0:3)

    do
      q(0) = random%symmetric()
      q(1:3) = random_vector(random)
      if (norm2(q) > 0.1_wp .and. norm2(q) <= 1.0_wp) exit
    end do
    r = rotation_from_quaternion(q)
  end function random_rotation

  !> Any rotation, and a translation of components between -1 and 1.
  function random_pose(random) result(pose)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(pose_type) :: pose

    pose%r = random_rotation(random)
    pose%p = random_vector(random)
  end function random_pose

  !> The largest difference of any two numbers of two poses.
  pure real(wp) function largest_difference(a, b)
    type(pose_type), intent(in) :: a   !< first pose
    type(pose_type), intent(in) :: b   !< second pose

    largest_difference = max(maxval(abs(a%r - b%r)), maxval(abs(a%p - b%p)))
  end function largest_difference
end module mech9_random_geometry
