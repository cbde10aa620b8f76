!> The logarithm of the size of a determinant.
module mech9_log_determinant
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgetrf
  implicit none
  private
  public :: log_determinant

contains

  !> The logarithm of the size of a determinant, by triangular factors. Pivots that are zero count as the least number.
  real(wp) function log_determinant(a)
    real(wp), intent(in) :: a(:, :)   !< (n,n) the matrix
    real(wp) :: factors(size(a, 1), size(a, 1))
    integer :: pivots(size(a, 1)), i, info

    log_determinant = 0.0_wp
    if (size(a) == 0) return
    factors = a
    call dgetrf(size(a, 1), size(a, 1), factors, size(a, 1), pivots, info)
    do i = 1, size(a, 1)
      log_determinant = log_determinant + log(max(abs(factors(i, i)), tiny(1.0_wp)))
    end do
  end function log_determinant
end module mech9_log_determinant
