!> Position and orientation of a frame B in a frame A as a pose, X_A = r_ab X_B + p_ab_a; the paper's (2)-(6), (10).
module mech9_pose
  use mech9_kinds, only: wp
  use mech9_rotation, only: identity, cross, unit
  implicit none
  private
  public :: pose_type, identity_pose, compose, inverse, transformed, pose_from_points, pose_from_axis
  public :: pose_from_dh, default_zero

  !> Rotation matrix (the paper's A) and translation (the paper's U) of a frame in another one.
  type :: pose_type
    real(wp) :: r(3, 3) = identity   !< turns components in the frame into components in the other one
    real(wp) :: p(3) = 0.0_wp        !< origin of the frame, in the other one [m]
  end type pose_type

  type(pose_type), parameter :: identity_pose = pose_type()

contains

  !> Pose of C in A from those of B in A and of C in B; (10) with its factors corrected.
  pure function compose(x_ab, x_bc) result(x_ac)
    type(pose_type), intent(in) :: x_ab   !< pose of B in A, lengths in m
    type(pose_type), intent(in) :: x_bc   !< pose of C in B
    type(pose_type) :: x_ac

    x_ac%r = matmul(x_ab%r, x_bc%r)
    x_ac%p = x_ab%p + matmul(x_ab%r, x_bc%p)
  end function compose

  !> Pose of A in B from that of B in A.
  pure function inverse(x_ab) result(x_ba)
    type(pose_type), intent(in) :: x_ab   !< pose of B in A
    type(pose_type) :: x_ba

    x_ba%r = transpose(x_ab%r)
    x_ba%p = -matmul(x_ba%r, x_ab%p)
  end function inverse

  !> Coordinates in A of a point given in B; (2).
  pure function transformed(x_ab, point_b) result(point_a)
    type(pose_type), intent(in) :: x_ab   !< pose of B in A
    real(wp), intent(in) :: point_b(3)    !< the point in B [m]
    real(wp) :: point_a(3)

    point_a = x_ab%p + matmul(x_ab%r, point_b)
  end function transformed

  !> Pose of the frame that three points define: origin R1, e1 towards R2, e2 across the plane of
  !> the three, e3 = e1 x e2; (3)-(6). `ok` is false where the points lie on one line.
  pure subroutine pose_from_points(r1, r2, r3, pose, ok)
    real(wp), intent(in) :: r1(3)          !< first point, the origin [m]
    real(wp), intent(in) :: r2(3)          !< second point, on the first axis [m]
    real(wp), intent(in) :: r3(3)          !< third point, which spans the plane with the others [m]
    type(pose_type), intent(out) :: pose   !< pose of the new frame in that of the points
    logical, intent(out) :: ok             !< whether the points define a frame
    real(wp) :: d(3), f(3), n(3)

    d = unit(r2 - r1)
    f = unit(r3 - r1)
    n = cross(d, f)
    ! below this limit the normal of the plane has fewer than four correct digits
    ok = norm2(n) > 1.0e-12_wp
    if (.not. ok) return
    pose%p = r1
    pose%r(:, 1) = d
    ! for points close to one line the product is perpendicular to d to few digits only
    n = unit(n)
    pose%r(:, 2) = unit(n - dot_product(n, d)*d)
    pose%r(:, 3) = cross(pose%r(:, 1), pose%r(:, 2))
  end subroutine pose_from_points

  !> Frame with its origin in `point`, z along `axis`, x along `zero` made perpendicular to it.
  !> `ok` is false where the axis is zero or `zero` is along it.
  pure subroutine pose_from_axis(point, axis, zero, pose, ok)
    real(wp), intent(in) :: point(3)       !< the origin [m]
    real(wp), intent(in) :: axis(3)        !< direction of z, of any length
    real(wp), intent(in) :: zero(3)        !< direction on the side of x, of any length
    type(pose_type), intent(out) :: pose   !< pose of the new frame in that of the point
    logical, intent(out) :: ok             !< whether the two directions define a frame
    real(wp) :: x(3), z(3)

    z = unit(axis)
    x = unit(zero)
    x = x - dot_product(x, z)*z
    ok = norm2(x) > 1.0e-8_wp .and. any(abs(axis) > 0.0_wp)
    if (.not. ok) return
    x = unit(x)
    x = unit(x - dot_product(x, z)*z)
    pose%p = point
    pose%r(:, 1) = x
    pose%r(:, 2) = cross(z, x)
    pose%r(:, 3) = z
  end subroutine pose_from_axis

  !> Direction of the zero position where none is given: the first of the x, y, z axes at 45 degrees or more to the axis.
  pure function default_zero(axis) result(zero)
    real(wp), intent(in) :: axis(3)   !< direction of the axis, of any length
    real(wp) :: zero(3), z(3)
    integer :: i

    z = unit(axis)
    zero = 0.0_wp
    do i = 1, 3
      ! the limit is slightly enlarged, so that an axis at exactly 45 degrees counts whatever its round-off
      if (abs(z(i)) <= sqrt(0.5_wp)*(1.0_wp + 1.0e-12_wp)) then
        zero(i) = 1.0_wp
        return
      end if
    end do
  end function default_zero

  !> Denavit-Hartenberg pose T = Rz(theta) Tz(d) Tx(a) Rx(alpha), angles in rad.
  pure function pose_from_dh(a, alpha, d, theta) result(pose)
    real(wp), intent(in) :: a       !< length of the link, along x [m]
    real(wp), intent(in) :: alpha   !< twist of the link, about x [rad]
    real(wp), intent(in) :: d       !< offset of the joint, along z [m]
    real(wp), intent(in) :: theta   !< angle of the joint, about z [rad]
    type(pose_type) :: pose
    real(wp) :: ca, sa, ct, st

    ca = cos(alpha)
    sa = sin(alpha)
    ct = cos(theta)
    st = sin(theta)
    pose%r(:, 1) = [ct, st, 0.0_wp]
    pose%r(:, 2) = [-st*ca, ct*ca, sa]
    pose%r(:, 3) = [st*sa, -ct*sa, ca]
    pose%p = [a*ct, a*st, d]
  end function pose_from_dh
end module mech9_pose
