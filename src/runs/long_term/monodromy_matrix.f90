!> Monodromy matrices: one eigenvector split off, the eigenvector of the multiplier -1, and linear equations.
module mech9_monodromy_matrix
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgetrf, dgetrs
  use mech9_singular_values, only: decompose
  implicit none
  private
  public :: split_off, find_alternating, solve_square

  !> A multiplier is -1 where the least singular value of the matrix with 1 added is below this, in parts of the largest one: far above
  !> errors of the place, and far below all that is not zero there.
  real(wp), parameter :: alternates = 1.0e-7_wp

contains

  !> Split off an eigenvector from a matrix: what is left, across it, has the other eigenvalues (deflation by a reflection).
  subroutine split_off(vector, matrix)
    real(wp), intent(in) :: vector(:)                     !< (n) the eigenvector, not zero
    real(wp), allocatable, intent(inout) :: matrix(:, :)  !< (n,n); then (n-1,n-1)
    real(wp) :: v(size(vector))
    integer :: n

    n = size(vector)
    v = vector/norm2(vector)
    v(1) = v(1) + sign(1.0_wp, v(1))
    v = v*(sqrt(2.0_wp)/norm2(v))
    matrix = matrix - matmul(reshape(v, [n, 1]), reshape(matmul(v, matrix), [1, n]))
    matrix = matrix - matmul(reshape(matmul(matrix, v), [n, 1]), reshape(v, [1, n]))
    matrix = matrix(2:, 2:)
  end subroutine split_off

  !> The eigenvector of the multiplier -1: deviations along it change side in each period. `found` is false where there is none, or several.
  subroutine find_alternating(matrix, vector, found)
    real(wp), intent(in) :: matrix(:, :)     !< (n,n) the monodromy matrix, in units of the state
    real(wp), intent(out) :: vector(:)       !< (n) of length 1, its largest number above 0
    logical, intent(out) :: found            !< there is one
    real(wp), dimension(size(vector), size(vector)) :: a, u, v
    real(wp) :: s(size(vector)), largest
    integer :: n, i

    n = size(vector)
    vector = 0.0_wp
    found = n > 0
    if (.not. found) return
    a = matrix
    do i = 1, n
      a(i, i) = a(i, i) + 1.0_wp
    end do
    call decompose(a, u, s, v)
    largest = max(1.0_wp, s(1))
    found = s(n) <= alternates*largest
    if (n > 1) found = found .and. s(n - 1) > alternates*largest
    vector = v(:, n)*sign(1.0_wp, v(maxloc(abs(v(:, n)), dim=1), n))
  end subroutine find_alternating

  !> Solve as many equations as unknowns.
  subroutine solve_square(matrix, right, x, solved)
    real(wp), intent(in) :: matrix(:, :)     !< (n,n)
    real(wp), intent(in) :: right(:)         !< (n) right-hand sides
    real(wp), intent(out) :: x(:)            !< (n) the solution
    logical, intent(out) :: solved           !< there is one
    real(wp) :: a(size(x), size(x)), b(size(x), 1)
    integer :: pivots(size(x)), info

    a = matrix
    b(:, 1) = right
    call dgetrf(size(x), size(x), a, size(x), pivots, info)
    solved = info == 0
    if (.not. solved) return
    call dgetrs('N', size(x), 1, a, size(x), pivots, b, size(x), info)
    x = b(:, 1)
  end subroutine solve_square
end module mech9_monodromy_matrix
