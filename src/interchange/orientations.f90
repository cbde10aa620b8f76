!> Rotations from the numbers with which robots tell them: angles, quaternions, directions.
module mech9_orientations
  use mech9_kinds, only: wp
  use mech9_rotation, only: identity, unit, cross, about_axis
  implicit none
  private
  public :: rotation_of_rpy, from_quaternion, orientation_from_z, from_euler

contains

  !> The rotation of roll, pitch and yaw: turns about the fixed axes x, y and z, in this order.
  pure function rotation_of_rpy(rpy) result(r)
    real(wp), intent(in) :: rpy(3)  !< angles [rad]
    real(wp) :: r(3, 3)

    r = matmul(about_axis([0.0_wp, 0.0_wp, 1.0_wp], rpy(3)), &
               matmul(about_axis([0.0_wp, 1.0_wp, 0.0_wp], rpy(2)), about_axis([1.0_wp, 0.0_wp, 0.0_wp], rpy(1))))
  end function rotation_of_rpy

  !> The rotation of a quaternion of any length.
  pure function from_quaternion(quat) result(r)
    real(wp), intent(in) :: quat(4)  !< w, x, y, z
    real(wp) :: r(3, 3), scaled(4)

    r = identity
    if (.not. any(abs(quat) > 0.0_wp)) return
    scaled = quat/maxval(abs(quat))
    if (any(abs(scaled(2:)) > 0.0_wp)) r = about_axis(unit(scaled(2:)), 2.0_wp*atan2(norm2(scaled(2:)), scaled(1)))
  end function from_quaternion

  !> The rotation that takes z to a direction by the shortest way.
  pure function orientation_from_z(direction) result(r)
    real(wp), intent(in) :: direction(3)  !< of any length but zero
    real(wp) :: r(3, 3), axis(3), d(3)

    d = unit(direction)
    axis = cross([0.0_wp, 0.0_wp, 1.0_wp], d)
    if (any(abs(axis) > 0.0_wp)) then
      r = about_axis(unit(axis), atan2(norm2(axis), d(3)))
    else
      r = identity
      if (d(3) < 0.0_wp) r = about_axis([1.0_wp, 0.0_wp, 0.0_wp], acos(-1.0_wp))
    end if
  end function orientation_from_z

  !> The rotation of three Euler angles.
  pure function from_euler(angles, sequence) result(r)
    real(wp), intent(in) :: angles(3)             !< [rad]
    character(len=3), intent(in) :: sequence      !< axes; small letters turn with the frame, capitals do not
    real(wp) :: r(3, 3), axis(3)
    integer :: i, k

    r = identity
    do i = 1, 3
      k = modulo(index('xyzXYZ', sequence(i:i)) - 1, 3) + 1
      axis = identity(:, k)
      if (index('xyz', sequence(i:i)) > 0) then
        r = matmul(r, about_axis(axis, angles(i)))
      else
        r = matmul(about_axis(axis, angles(i)), r)
      end if
    end do
  end function from_euler
end module mech9_orientations
