!> Rotations as 3x3 matrices, and products of vectors.
!>
!> r_ab turns components in frame B into components in frame A.
module mech9_rotation
  use mech9_kinds, only: wp
  implicit none
  private
  public :: identity, turn, turn_back, combine, cross, unit, about_axis, about_z, add_small_angle, rotation_vector, &
    rotation_between, axial_vector, quaternion

  !> The rotation by no angle.
  real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, &
                                                   0.0_wp, 1.0_wp, 0.0_wp, &
                                                   0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
  !> Below this sine of an angle, three terms of its series are exact.
  real(wp), parameter :: small_sine = 1.0e-4_wp

contains

  ! The products are written out for fixed sizes: matmul of sections of unknown size makes temporaries and is slower.

  !> r x: components in A from components in B, for r_ab.
  pure function turn(r, x) result(y)
    real(wp), intent(in) :: r(3, 3)   !< rotation matrix r_ab
    real(wp), intent(in) :: x(3)      !< vector, components in B
    real(wp) :: y(3)
    integer :: i

    do i = 1, 3
      y(i) = r(i, 1)*x(1) + r(i, 2)*x(2) + r(i, 3)*x(3)
    end do
  end function turn

  !> r^T x: components in B from components in A, for r_ab.
  pure function turn_back(r, x) result(y)
    real(wp), intent(in) :: r(3, 3)   !< rotation matrix r_ab
    real(wp), intent(in) :: x(3)      !< vector, components in A
    real(wp) :: y(3)
    integer :: i

    do i = 1, 3
      y(i) = r(1, i)*x(1) + r(2, i)*x(2) + r(3, i)*x(3)
    end do
  end function turn_back

  !> a b: r_ac from r_ab and r_bc.
  pure function combine(a, b) result(c)
    real(wp), intent(in) :: a(3, 3)   !< r_ab
    real(wp), intent(in) :: b(3, 3)   !< r_bc
    real(wp) :: c(3, 3)
    integer :: i, j

    do j = 1, 3
      do i = 1, 3
        c(i, j) = a(i, 1)*b(1, j) + a(i, 2)*b(2, j) + a(i, 3)*b(3, j)
      end do
    end do
  end function combine

  !> Vector product a x b.
  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3)   !< left factor
    real(wp), intent(in) :: b(3)   !< right factor, in the same axes
    real(wp) :: c(3)

    c(1) = a(2)*b(3) - a(3)*b(2)
    c(2) = a(3)*b(1) - a(1)*b(3)
    c(3) = a(1)*b(2) - a(2)*b(1)
  end function cross

  !> The vector at length one; zero stays zero. Scaled first, so that no square overflows.
  pure function unit(a) result(e)
    real(wp), intent(in) :: a(3)   !< a vector
    real(wp) :: e(3), largest

    largest = maxval(abs(a))
    if (.not. largest > 0.0_wp) then
      e = 0.0_wp
      return
    end if
    e = a/largest
    e = e/norm2(e)
  end function unit

  !> Cosine and sine of an angle that grows by a small one, to second order.
  pure subroutine add_small_angle(small, turned)
    real(wp), intent(in) :: small          !< the angle added [rad]
    real(wp), intent(inout) :: turned(2)   !< cosine and sine
    real(wp) :: c, s

    c = turned(1)
    s = turned(2)
    turned(1) = c - small*(s + 0.5_wp*small*c)
    turned(2) = s + small*(c - 0.5_wp*small*s)
  end subroutine add_small_angle

  !> Rotation by an angle [rad] about a unit axis (Rodrigues).
  pure function about_axis(axis, angle) result(r)
    real(wp), intent(in) :: axis(3)   !< of length one
    real(wp), intent(in) :: angle     !< [rad]
    real(wp) :: r(3, 3), c, s, v
    integer :: i, j

    c = cos(angle)
    s = sin(angle)
    v = 2.0_wp*sin(0.5_wp*angle)**2
    do j = 1, 3
      do i = 1, 3
        r(i, j) = v*axis(i)*axis(j)
      end do
      r(j, j) = r(j, j) + c
    end do
    r(3, 2) = r(3, 2) + s*axis(1)
    r(2, 3) = r(2, 3) - s*axis(1)
    r(1, 3) = r(1, 3) + s*axis(2)
    r(3, 1) = r(3, 1) - s*axis(2)
    r(2, 1) = r(2, 1) + s*axis(3)
    r(1, 2) = r(1, 2) - s*axis(3)
  end function about_axis

  !> Rotation by an angle [rad] about z.
  pure function about_z(angle) result(r)
    real(wp), intent(in) :: angle   !< [rad]
    real(wp) :: r(3, 3)

    r = identity
    r(1, 1) = cos(angle)
    r(2, 1) = sin(angle)
    r(1, 2) = -r(2, 1)
    r(2, 2) = r(1, 1)
  end function about_z

  !> The vector of the skew part of a matrix: w with (r - r^T)/2 = w x.
  pure function axial_vector(r) result(w)
    real(wp), intent(in) :: r(3, 3)   !< any matrix
    real(wp) :: w(3)

    w(1) = 0.5_wp*(r(3, 2) - r(2, 3))
    w(2) = 0.5_wp*(r(1, 3) - r(3, 1))
    w(3) = 0.5_wp*(r(2, 1) - r(1, 2))
  end function axial_vector

  !> Rotation vector (axis times angle, 0 to pi [rad]) of a rotation matrix, accurate at all angles:
  !> near 180 degrees, where the skew part vanishes, the axis comes from the symmetric part.
  pure function rotation_vector(r) result(phi)
    real(wp), intent(in) :: r(3, 3)   !< rotation matrix
    real(wp) :: phi(3), w(3), s, c, angle, axis(3), column(3)
    integer :: k

    w = axial_vector(r)
    s = norm2(w)
    c = 0.5_wp*(r(1, 1) + r(2, 2) + r(3, 3) - 1.0_wp)
    if (c > 0.0_wp) then
      ! angle/sin(angle), by its series where the quotient would lose digits
      if (s < small_sine) then
        phi = w*(1.0_wp + s*s*(1.0_wp/6.0_wp + s*s*(3.0_wp/40.0_wp)))
      else
        phi = w*(atan2(s, c)/s)
      end if
      return
    end if
    angle = atan2(s, c)
    ! symmetric part = cos I + (1 - cos) axis axis^T: its largest column points along the axis
    k = maxloc([r(1, 1), r(2, 2), r(3, 3)], dim=1)
    column = 0.5_wp*(r(:, k) + r(k, :))
    column(k) = column(k) - c
    axis = column/norm2(column)
    if (dot_product(axis, w) < 0.0_wp) axis = -axis
    phi = angle*axis
  end function rotation_vector

  !> Rotation vector, in the axes of A, that turns frame B onto frame C. For a small turn it is the sum of the axes' cross products
  !> b x c, which is twice the sine along the axis; then the matrix of the turn is not formed.
  pure function rotation_between(r_ab, r_ac) result(phi)
    real(wp), intent(in) :: r_ab(3, 3)   !< turns components in B into components in A
    real(wp), intent(in) :: r_ac(3, 3)   !< turns components in C into components in A
    real(wp) :: phi(3)                   !< axis times angle, 0 to pi [rad]
    real(wp) :: w(3), square, r_bc(3, 3)
    integer :: i

    w = 0.0_wp
    do i = 1, 3
      w(1) = w(1) + r_ab(2, i)*r_ac(3, i) - r_ab(3, i)*r_ac(2, i)
      w(2) = w(2) + r_ab(3, i)*r_ac(1, i) - r_ab(1, i)*r_ac(3, i)
      w(3) = w(3) + r_ab(1, i)*r_ac(2, i) - r_ab(2, i)*r_ac(1, i)
    end do
    square = 0.25_wp*(w(1)**2 + w(2)**2 + w(3)**2)
    ! two axes that keep their direction within 60 degrees exclude a turn near 180 degrees
    if (square < small_sine**2 .and. dot_product(r_ab(:, 1), r_ac(:, 1)) > 0.5_wp .and. &
        dot_product(r_ab(:, 2), r_ac(:, 2)) > 0.5_wp) then
      phi = 0.5_wp*w*(1.0_wp + square*(1.0_wp/6.0_wp + square*(3.0_wp/40.0_wp)))
      return
    end if
    do i = 1, 3
      r_bc(:, i) = turn_back(r_ab, r_ac(:, i))
    end do
    phi = turn(r_ab, rotation_vector(r_bc))
  end function rotation_between

  !> Unit quaternion (w, x, y, z) of a rotation matrix, w >= 0. Its largest part is found first and divides the
  !> others, so that no digits are lost at any angle.
  pure function quaternion(r) result(q)
    real(wp), intent(in) :: r(3, 3)   !< rotation matrix
    real(wp) :: q(4), squares(4), w(3)
    integer :: i, j, k

    squares = 0.25_wp*(1.0_wp + [r(1, 1) + r(2, 2) + r(3, 3), r(1, 1) - r(2, 2) - r(3, 3), &
                                 r(2, 2) - r(1, 1) - r(3, 3), r(3, 3) - r(1, 1) - r(2, 2)])
    k = maxloc(squares, dim=1)
    q(k) = sqrt(squares(k))
    w = axial_vector(r)
    if (k == 1) then
      q(2:4) = 0.5_wp*w/q(1)
    else
      i = 1 + mod(k - 1, 3)
      j = 1 + mod(k, 3)
      q(1) = 0.5_wp*w(k - 1)/q(k)
      q(1 + i) = 0.25_wp*(r(i, k - 1) + r(k - 1, i))/q(k)
      q(1 + j) = 0.25_wp*(r(j, k - 1) + r(k - 1, j))/q(k)
    end if
    if (q(1) < 0.0_wp) q = -q
  end function quaternion
end module mech9_rotation
