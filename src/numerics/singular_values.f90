!> Singular values and vectors of small square matrices, by LAPACK.
module mech9_singular_values
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgesvd, zgesvd
  implicit none
  private
  public :: decompose, null_vector

contains

  !> a = u diag(s) v^T.
  subroutine decompose(a, u, s, v)
    real(wp), intent(in) :: a(:, :)    !< (n,n) the matrix
    real(wp), intent(out) :: u(:, :)   !< (n,n) left singular vectors in columns
    real(wp), intent(out) :: s(:)      !< (n) singular values, not increasing
    real(wp), intent(out) :: v(:, :)   !< (n,n) right singular vectors in columns
    real(wp) :: copy(size(a, 1), size(a, 2)), vt(size(a, 1), size(a, 2)), work(32*size(a, 1) + 32)
    integer :: n, info

    n = size(a, 1)
    if (n == 0) return
    copy = a
    call dgesvd('A', 'A', n, n, copy, n, s, u, n, vt, n, work, size(work), info)
    v = transpose(vt)
  end subroutine decompose

  !> A vector that a complex matrix makes almost zero: its right singular vector of a small singular value, the least, or the
  !> next ones where as many are as small.
  subroutine null_vector(a, number, small, vector)
    complex(wp), intent(in) :: a(:, :)     !< (n,n) the matrix
    integer, intent(in) :: number          !< 1 for the least singular value, 2 for the next one, ...
    real(wp), intent(in) :: small          !< singular values above this part of the largest do not count as small
    complex(wp), intent(out) :: vector(:)  !< (n) of length 1
    complex(wp) :: copy(size(a, 1), size(a, 2)), u(1, 1), vt(size(a, 1), size(a, 2)), work(32*size(a, 1) + 32)
    real(wp) :: s(size(a, 1)), scratch(5*size(a, 1))
    integer :: n, i, info

    n = size(a, 1)
    copy = a
    call zgesvd('N', 'A', n, n, copy, n, s, u, 1, vt, n, work, size(work), scratch, info)
    i = n + 1 - min(number, n)
    do while (i < n)
      if (s(i) <= small*s(1)) exit
      i = i + 1
    end do
    vector = conjg(vt(i, :))
  end subroutine null_vector
end module mech9_singular_values
