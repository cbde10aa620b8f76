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
  !> become equally long outside the diagonal (Osborne in docs/reference/bibliography.md). The eigenvalues stay; the Frobenius
  !> norm decreases towards the least value that any choice of units can give it.
  pure subroutine balance(n, a)
    integer, intent(in) :: n             !< order of the matrix
    real(wp), intent(inout) :: a(n, n)   !< the matrix, which becomes D^-1 A D
    real(wp) :: row, column, scale, per_scale
    integer :: sweep, i, j

    do sweep = 1, sweeps
      do i = 1, n
        row = 0.0_wp
        column = 0.0_wp
        do j = 1, n
          if (j == i) cycle
          row = row + a(i, j)**2
          column = column + a(j, i)**2
        end do
        if (.not. row + column > 0.0_wp) cycle
        scale = largest_scale
        if (row < column*largest_scale**4) scale = max(1.0_wp/largest_scale, sqrt(sqrt(row/column)))
        per_scale = 1.0_wp/scale
        do j = 1, n
          a(i, j) = a(i, j)*per_scale
        end do
        do j = 1, n
          a(j, i) = a(j, i)*scale
        end do
      end do
    end do
  end subroutine balance
end module mech9_balance
