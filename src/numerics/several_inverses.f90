!> The inverses of several square matrices that resemble each other, such as those of neighbouring positions of a motion, at once: the
!> number of the matrix is the fastest index.
!>
!> All are inverted by Gauss-Jordan elimination with the same order of rows, that of the pivots of one of them. Each inverse is judged
!> by itself afterwards, by its product with the matrix, and by the norms of both, which bound the condition of the matrix. An
!> inverse that does not pass is for the caller to find otherwise, with pivots of its own.
module mech9_several_inverses
  use mech9_kinds, only: wp
  implicit none
  private
  public :: most_rows, find_pivot_order, invert_in_order, bound_conditioning

  !> Largest number that the product of a matrix and its inverse may have beside the unit matrix. Round-off leaves some units times the
  !> condition.
  real(wp), parameter :: trusted_product = 1.0e-13_wp
  !> A pivot of this size or less, in a matrix whose numbers are about one, is taken for zero. The numbers of inverses then stay below the
  !> power of its reciprocal by the rows, so that their squares do not overflow.
  real(wp), parameter :: least_pivot = 1.0e-12_wp
  !> Rows of the largest matrices for which this holds.
  integer, parameter :: most_rows = 12

contains

  !> The order of the rows in which elimination with partial pivoting takes them.
  pure subroutine find_pivot_order(m, a, order)
    integer, intent(in) :: m           !< rows and columns
    real(wp), intent(in) :: a(m, m)    !< the matrix
    integer, intent(out) :: order(m)   !< number of the row at each place
    real(wp) :: b(m, m), factor
    integer :: i, k, best

    b = a
    order = [(i, i=1, m)]
    do k = 1, m
      best = k - 1 + maxloc(abs(b(order(k:), k)), dim=1)
      order([k, best]) = order([best, k])
      if (.not. abs(b(order(k), k)) > least_pivot) return
      do i = k + 1, m
        factor = b(order(i), k)/b(order(k), k)
        b(order(i), k + 1:) = b(order(i), k + 1:) - factor*b(order(k), k + 1:)
      end do
    end do
  end subroutine find_pivot_order

  !> Find the inverses. Where a pivot vanishes, numbers without meaning take the place of an inverse.
  pure subroutine invert_in_order(n, lead, m, order, a, b, inverse)
    integer, intent(in) :: n                          !< number of matrices
    integer, intent(in) :: lead                       !< room for so many matrices
    integer, intent(in) :: m                          !< rows and columns, at most `most_rows`
    integer, intent(in) :: order(m)                   !< number of the row of each pivot
    real(wp), intent(in) :: a(lead, m, m)             !< the matrices
    real(wp), intent(inout) :: b(lead, m, m)          !< scratch
    real(wp), intent(inout) :: inverse(lead, m, m)    !< the inverses
    integer :: i, j, k, s

    do j = 1, m
      do i = 1, m
        do s = 1, n
          b(s, i, j) = a(s, order(i), j)
        end do
      end do
    end do
    do k = 1, m
      do s = 1, n
        b(s, k, k) = 1.0_wp/merge(b(s, k, k), 1.0_wp, abs(b(s, k, k)) > least_pivot)
      end do
      do j = 1, m
        if (j == k) cycle
        do s = 1, n
          b(s, k, j) = b(s, k, j)*b(s, k, k)
        end do
        call subtract_column(n, lead, m, k, b(1, 1, k), b(1, k, j), b(1, 1, j))
      end do
      do i = 1, m
        if (i == k) cycle
        do s = 1, n
          b(s, i, k) = -b(s, i, k)*b(s, k, k)
        end do
      end do
    end do
    do j = 1, m
      do i = 1, m
        do s = 1, n
          inverse(s, i, order(j)) = b(s, i, j)
        end do
      end do
    end do
  end subroutine invert_in_order

  !> Subtract the column of a pivot, times a factor, from another one, but for the row of the pivot.
  pure subroutine subtract_column(n, lead, m, k, column, factor, other)
    integer, intent(in) :: n                     !< number of matrices
    integer, intent(in) :: lead                  !< room for so many matrices
    integer, intent(in) :: m                     !< rows
    integer, intent(in) :: k                     !< the row of the pivot
    real(wp), intent(in) :: column(lead, m)      !< the column of the pivot
    real(wp), intent(in) :: factor(lead)         !< factors
    real(wp), intent(inout) :: other(lead, m)    !< the other column; its row k holds the factors
    integer :: i, s

    do i = 1, m
      if (i == k) cycle
      do s = 1, n
        other(s, i) = other(s, i) - column(s, i)*factor(s)
      end do
    end do
  end subroutine subtract_column

  !> Lower bounds of the least singular values over the largest ones; zero where the product of matrix and inverse is not the unit matrix.
  pure subroutine bound_conditioning(n, lead, m, a, inverse, regular, bounds)
    integer, intent(in) :: n                        !< number of matrices
    integer, intent(in) :: lead                     !< room for so many matrices
    integer, intent(in) :: m                        !< rows and columns
    real(wp), intent(in) :: a(lead, m, m)           !< the matrices
    real(wp), intent(in) :: inverse(lead, m, m)     !< their inverses
    real(wp), intent(in) :: regular                 !< size of a matrix that is far from singular; 0: it is not known
    real(wp), intent(inout) :: bounds(lead)         !< the bounds; a larger `regular` takes the place of the largest singular value
    real(wp) :: worst(lead), product(lead), size_of(lead), size_of_inverse(lead)
    integer :: i, j, k, s

    do s = 1, n
      worst(s) = 0.0_wp
      size_of(s) = 0.0_wp
      size_of_inverse(s) = 0.0_wp
    end do
    do j = 1, m
      do i = 1, m
        do s = 1, n
          product(s) = merge(-1.0_wp, 0.0_wp, i == j)
          size_of(s) = size_of(s) + a(s, i, j)**2
          size_of_inverse(s) = size_of_inverse(s) + inverse(s, i, j)**2
        end do
        do k = 1, m - 1, 2
          do s = 1, n
            product(s) = product(s) + a(s, i, k)*inverse(s, k, j) + a(s, i, k + 1)*inverse(s, k + 1, j)
          end do
        end do
        do s = 1, n
          if (mod(m, 2) == 1) product(s) = product(s) + a(s, i, m)*inverse(s, m, j)
          worst(s) = max(worst(s), abs(product(s)))
        end do
      end do
    end do
    do s = 1, n
      bounds(s) = 1.0_wp/(max(sqrt(size_of(s)), regular, least_pivot)*max(sqrt(size_of_inverse(s)), least_pivot))
      bounds(s) = merge(bounds(s), 0.0_wp, worst(s) <= trusted_product)
    end do
  end subroutine bound_conditioning
end module mech9_several_inverses
