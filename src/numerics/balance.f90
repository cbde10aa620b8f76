!> Balancing of a matrix, so that its size does not depend on the units of its coordinates.
module mech9_balance
  use mech9_kinds, only: wp
  implicit none
  private
  public :: balance

  !> Sweeps over all coordinates; the first one or two do nearly all of the balancing.
  integer, parameter :: sweeps = 3
  !> A coordinate is scaled by no more than this at once.
  real(wp), parameter :: largest_scale = 1.0e4_wp

contains

  !> Scale a square matrix A to D^-1 A D with a diagonal matrix D, so that each row and the column of the same number
  !> become equally long outside the diagonal (Osborne in docs/bibliography.md). The eigenvalues stay; the Frobenius norm falls
  !> towards the least value that any choice of units can give it.
  pure subroutine balance(a)
    real(wp), intent(inout) :: a(:, :)   !< (n, n) the matrix, which becomes D^-1 A D
    real(wp) :: row, column, scale
    integer :: sweep, i

    do sweep = 1, sweeps
      do i = 1, size(a, 1)
        row = sum(a(i, :)**2) - a(i, i)**2
        column = sum(a(:, i)**2) - a(i, i)**2
        if (.not. row + column > 0.0_wp) cycle
        scale = largest_scale
        if (row < column*largest_scale**4) scale = max(1.0_wp/largest_scale, sqrt(sqrt(row/column)))
        a(i, :) = a(i, :)/scale
        a(:, i) = a(:, i)*scale
      end do
    end do
  end subroutine balance
end module mech9_balance
