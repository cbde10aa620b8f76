!> The inverse of a 3 by 3 matrix by its cofactors.
!>
!> The cofactors are the vector products of two columns each. Their lengths give the pivots that a QR factorization
!> with column pivoting would find: the length of the longest column, the largest area that another column spans with
!> it over that length, and the volume of all three over that area.
module mech9_cofactors
  use mech9_kinds, only: wp
  implicit none
  private
  public :: invert_by_cofactors, invert_several

contains

  !> Inverse and pivots. Where columns depend on each other pivots are zero and the inverse is not set. Where the
  !> least pivot is much below the largest, the inverse is less certain than a solution by reflections.
  pure subroutine invert_by_cofactors(a, inverse, pivots, sign_of_det)
    real(wp), intent(in) :: a(3, 3)            !< the matrix
    real(wp), intent(inout) :: inverse(3, 3)   !< its inverse; unchanged where columns depend on each other
    real(wp), intent(out) :: pivots(3)         !< lengths, not increasing
    integer, intent(out) :: sign_of_det        !< -1 or 1
    real(wp) :: c1(3), c2(3), c3(3), l1, l2, l3, longest, area, volume, per_volume

    c1 = product_of(a(:, 2), a(:, 3))
    c2 = product_of(a(:, 3), a(:, 1))
    c3 = product_of(a(:, 1), a(:, 2))
    l1 = a(1, 1)**2 + a(2, 1)**2 + a(3, 1)**2
    l2 = a(1, 2)**2 + a(2, 2)**2 + a(3, 2)**2
    l3 = a(1, 3)**2 + a(2, 3)**2 + a(3, 3)**2
    volume = a(1, 1)*c1(1) + a(2, 1)*c1(2) + a(3, 1)*c1(3)
    longest = max(l1, l2, l3)
    ! squares of the areas that the longest column spans with the others
    if (l1 >= longest) then
      area = max(square(c2), square(c3))
    else if (l2 >= longest) then
      area = max(square(c1), square(c3))
    else
      area = max(square(c1), square(c2))
    end if
    sign_of_det = merge(-1, 1, volume < 0.0_wp)
    pivots(1) = sqrt(longest)
    pivots(2:3) = 0.0_wp
    if (.not. area > 0.0_wp) return
    area = sqrt(area)
    pivots(2) = area/pivots(1)
    pivots(3) = abs(volume)/area
    if (.not. pivots(3) > 0.0_wp) return
    per_volume = 1.0_wp/volume
    inverse(1, :) = per_volume*c1
    inverse(2, :) = per_volume*c2
    inverse(3, :) = per_volume*c3
  end subroutine invert_by_cofactors

  !> Inverses of several matrices, with the number of the matrix as the fastest index, by the same cofactors. Where the least pivot is not
  !> above a part of the largest one, the inverse is zero.
  pure subroutine invert_several(n, lead, part, a, inverse, largest, least)
    integer, intent(in) :: n                             !< number of matrices
    integer, intent(in) :: lead                          !< room for so many matrices
    real(wp), intent(in) :: part                         !< of the largest pivot
    real(wp), intent(in) :: a(lead, 3, 3)                !< the matrices
    real(wp), intent(inout) :: inverse(lead, 3, 3)       !< their inverses
    real(wp), intent(inout) :: largest(lead)             !< largest pivot of each
    real(wp), intent(inout) :: least(lead)               !< least pivot of each
    real(wp), dimension(lead) :: l1, l2, l3, s1, s2, s3, volume
    real(wp) :: area
    integer :: i, j, k

    call cofactor_row(n, lead, a(1, 1, 2), a(1, 1, 3), inverse(1, 1, 1), s1)
    call cofactor_row(n, lead, a(1, 1, 3), a(1, 1, 1), inverse(1, 2, 1), s2)
    call cofactor_row(n, lead, a(1, 1, 1), a(1, 1, 2), inverse(1, 3, 1), s3)
    do i = 1, n
      l1(i) = a(i, 1, 1)**2 + a(i, 2, 1)**2 + a(i, 3, 1)**2
      l2(i) = a(i, 1, 2)**2 + a(i, 2, 2)**2 + a(i, 3, 2)**2
      l3(i) = a(i, 1, 3)**2 + a(i, 2, 3)**2 + a(i, 3, 3)**2
      volume(i) = a(i, 1, 1)*inverse(i, 1, 1) + a(i, 2, 1)*inverse(i, 1, 2) + a(i, 3, 1)*inverse(i, 1, 3)
    end do
    do i = 1, n
      largest(i) = max(l1(i), l2(i), l3(i))
      area = merge(max(s1(i), s2(i)), merge(max(s1(i), s3(i)), max(s2(i), s3(i)), l2(i) >= largest(i) .and. l1(i) < largest(i)), &
                   l1(i) < largest(i) .and. l2(i) < largest(i))
      largest(i) = sqrt(largest(i))
      least(i) = abs(volume(i))/sqrt(max(area, tiny(area)))
      volume(i) = merge(volume(i), huge(area), least(i) > part*largest(i))
      volume(i) = 1.0_wp/volume(i)
    end do
    do k = 1, 3
      do j = 1, 3
        do i = 1, n
          inverse(i, j, k) = volume(i)*inverse(i, j, k)
        end do
      end do
    end do
  end subroutine invert_several

  !> Vector products of two columns each of several matrices, as rows of others, and the squares of their lengths.
  pure subroutine cofactor_row(n, lead, u, v, row, square_of)
    integer, intent(in) :: n                       !< number of matrices
    integer, intent(in) :: lead                    !< room for so many matrices
    real(wp), intent(in) :: u(lead, 3)             !< left factors
    real(wp), intent(in) :: v(lead, 3)             !< right factors
    real(wp), intent(inout) :: row(3*lead, *)      !< (:lead,3) gets the products, one row of each of the other matrices
    real(wp), intent(inout) :: square_of(lead)     !< squares of the lengths
    real(wp) :: x, y, z
    integer :: i

    do i = 1, n
      x = u(i, 2)*v(i, 3) - u(i, 3)*v(i, 2)
      y = u(i, 3)*v(i, 1) - u(i, 1)*v(i, 3)
      z = u(i, 1)*v(i, 2) - u(i, 2)*v(i, 1)
      row(i, 1) = x
      row(i, 2) = y
      row(i, 3) = z
      square_of(i) = x**2 + y**2 + z**2
    end do
  end subroutine cofactor_row

  !> Vector product u x v. (The floor of rotations, which has one too, lies above this one.)
  pure function product_of(u, v) result(w)
    real(wp), intent(in) :: u(3)   !< left factor
    real(wp), intent(in) :: v(3)   !< right factor
    real(wp) :: w(3)

    w(1) = u(2)*v(3) - u(3)*v(2)
    w(2) = u(3)*v(1) - u(1)*v(3)
    w(3) = u(1)*v(2) - u(2)*v(1)
  end function product_of

  !> Square of the length of a vector.
  pure real(wp) function square(v)
    real(wp), intent(in) :: v(3)   !< any vector

    square = v(1)**2 + v(2)**2 + v(3)**2
  end function square
end module mech9_cofactors
