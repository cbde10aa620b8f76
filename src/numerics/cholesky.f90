!> Cholesky factors of small symmetric matrices.
module mech9_cholesky
  use mech9_kinds, only: wp
  implicit none
  private
  public :: cholesky_factorize, cholesky_solve

contains

  !> a = L L^T; only the lower triangle is read and becomes L. `failed_at` is the row where the matrix
  !> turns out not to be positive definite beyond round-off, 0 where all is well.
  pure subroutine cholesky_factorize(n, a, failed_at, least)
    integer, intent(in) :: n                       !< order of the matrix
    real(wp), intent(inout) :: a(n, n)             !< the matrix, symmetric; L in the lower triangle afterwards
    integer, intent(out) :: failed_at              !< row of the first pivot that is not positive; 0 where all is well
    real(wp), intent(in), optional :: least(n)     !< round-off of each pivot; that of the diagonal of `a` unless given
    real(wp) :: pivot, round_off
    integer :: i, j, k

    failed_at = 0
    do j = 1, n
      pivot = a(j, j)
      round_off = 8.0_wp*n*epsilon(pivot)*pivot
      if (present(least)) round_off = least(j)
      do k = 1, j - 1
        pivot = pivot - a(j, k)**2
      end do
      ! a pivot that round-off alone can explain counts as zero
      if (.not. pivot > round_off) then
        failed_at = j
        return
      end if
      a(j, j) = sqrt(pivot)
      do k = 1, j - 1
        do i = j + 1, n
          a(i, j) = a(i, j) - a(i, k)*a(j, k)
        end do
      end do
      a(j + 1:n, j) = a(j + 1:n, j)/a(j, j)
    end do
  end subroutine cholesky_factorize

  !> Solve with the factors: b becomes x.
  pure subroutine cholesky_solve(n, factors, b)
    integer, intent(in) :: n                !< order of the matrix
    real(wp), intent(in) :: factors(n, n)   !< L in the lower triangle, as `cholesky_factorize` leaves it
    real(wp), intent(inout) :: b(n)         !< the right-hand side; the solution afterwards
    integer :: j

    do j = 1, n
      b(j) = b(j)/factors(j, j)
      b(j + 1:n) = b(j + 1:n) - b(j)*factors(j + 1:n, j)
    end do
    do j = n, 1, -1
      b(j) = (b(j) - dot_product(factors(j + 1:n, j), b(j + 1:n)))/factors(j, j)
    end do
  end subroutine cholesky_solve
end module mech9_cholesky
