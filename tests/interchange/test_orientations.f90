!> Rotations from angles, quaternions and directions, against their matrices written out and against each other.
module test_orientations
  use mech9_kinds, only: wp
  use mech9_rotation, only: identity, about_axis
  use mech9_orientations, only: rotation_of_rpy, from_quaternion, orientation_from_z, from_euler
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, near_matrix
  implicit none
  private
  public :: run

  !> Products of a few rotations, each rounded.
  real(wp), parameter :: tol = 1.0e-14_wp

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('roll_pitch_yaw')) call roll_pitch_yaw(tester)
    if (tester%runs('quaternions')) call quaternions(tester)
    if (tester%runs('directions')) call directions(tester)
    if (tester%runs('euler_angles')) call euler_angles(tester)
  end subroutine run

  !> The matrix of the URDF and SDF documents, written out.
  subroutine roll_pitch_yaw(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: rpy(3) = [0.4_wp, -0.7_wp, 2.1_wp]
    real(wp) :: c(3), s(3), r(3, 3)

    c = cos(rpy)
    s = sin(rpy)
    r(1, :) = [c(3)*c(2), c(3)*s(2)*s(1) - s(3)*c(1), c(3)*s(2)*c(1) + s(3)*s(1)]
    r(2, :) = [s(3)*c(2), s(3)*s(2)*s(1) + c(3)*c(1), s(3)*s(2)*c(1) - c(3)*s(1)]
    r(3, :) = [-s(2), c(2)*s(1), c(2)*c(1)]
    call near_matrix(tester, rotation_of_rpy(rpy), r, tol, 'roll, pitch and yaw')
    call near_matrix(tester, from_euler(rpy, 'XYZ'), r, tol, 'roll, pitch and yaw are turns about fixed axes')
  end subroutine roll_pitch_yaw

  !> The matrix of a quaternion of length one is quadratic in its components.
  subroutine quaternions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: raw(4) = [0.3_wp, -1.2_wp, 0.5_wp, 2.0_wp]
    real(wp) :: q(4), r(3, 3)

    q = raw/norm2(raw)
    r(1, :) = 2.0_wp*[0.5_wp - q(3)**2 - q(4)**2, q(2)*q(3) - q(1)*q(4), q(2)*q(4) + q(1)*q(3)]
    r(2, :) = 2.0_wp*[q(2)*q(3) + q(1)*q(4), 0.5_wp - q(2)**2 - q(4)**2, q(3)*q(4) - q(1)*q(2)]
    r(3, :) = 2.0_wp*[q(2)*q(4) - q(1)*q(3), q(3)*q(4) + q(1)*q(2), 0.5_wp - q(2)**2 - q(3)**2]
    call near_matrix(tester, from_quaternion(q), r, tol, 'a quaternion of length one')
    call near_matrix(tester, from_quaternion(-1.0e150_wp*raw), r, tol, 'its opposite, of another length, turns alike')
    call near_matrix(tester, from_quaternion([-2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]), identity, 0.0_wp, 'no turn')
    call near_matrix(tester, from_quaternion(0.0_wp*raw), identity, 0.0_wp, 'a quaternion of zeros is no turn')
  end subroutine quaternions

  !> The shortest way from z to a direction turns about an axis across both.
  subroutine directions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: d(3, 3) = reshape([2.0_wp, -1.0_wp, 0.5_wp, 0.0_wp, 0.0_wp, -3.0_wp, 1.0e-9_wp, 0.0_wp, 1.0_wp], [3, 3])
    real(wp) :: r(3, 3), across(3)
    integer :: i

    do i = 1, 3
      r = orientation_from_z(d(:, i))
      call near_vector(tester, r(:, 3), d(:, i)/norm2(d(:, i)), tol, 'z comes to the direction')
      call near_matrix(tester, matmul(transpose(r), r), identity, tol, 'it is a rotation')
      across = [-d(2, i), d(1, i), 0.0_wp]
      call near_vector(tester, matmul(r, across), across, tol, 'the direction across both stays')
    end do
    call near_matrix(tester, orientation_from_z([0.0_wp, 0.0_wp, 5.0_wp]), identity, 0.0_wp, 'z stays where it is')
  end subroutine directions

  !> Turns about the axes of the turning frame multiply from the left to the right, those about fixed axes the other way.
  subroutine euler_angles(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: a(3) = [0.3_wp, 1.2_wp, -0.8_wp]
    real(wp) :: x(3, 3), y(3, 3), z(3, 3)

    x = about_axis(identity(:, 1), a(1))
    y = about_axis(identity(:, 2), a(2))
    z = about_axis(identity(:, 3), a(3))
    call near_matrix(tester, from_euler(a, 'xyz'), matmul(x, matmul(y, z)), tol, 'axes that turn')
    call near_matrix(tester, from_euler(a, 'XYZ'), matmul(z, matmul(y, x)), tol, 'axes that do not turn')
    call near_matrix(tester, from_euler(a, 'xYz'), matmul(matmul(y, x), z), tol, 'axes of both kinds')
    z = about_axis(identity(:, 3), a(1))
    x = about_axis(identity(:, 1), a(2))
    y = about_axis(identity(:, 3), a(3))
    call near_matrix(tester, from_euler(a, 'zxz'), matmul(z, matmul(x, y)), tol, 'an axis that comes twice')
  end subroutine euler_angles
end module test_orientations
