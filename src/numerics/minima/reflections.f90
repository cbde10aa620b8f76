!> Small systems by Householder's reflections, without pivots: for matrices whose columns are independent because they are damped.
module mech9_reflections
  use mech9_kinds, only: wp
  implicit none
  private
  public :: triangulate, solve_upper

contains

  !> Make the first columns of a matrix upper triangular by reflections, which all later columns share.
  pure subroutine triangulate(a, columns)
    real(wp), intent(inout) :: a(:, :)   !< (m,n) the matrix; then upper triangular in its first columns
    integer, intent(in) :: columns       !< number of these, at most m
    real(wp) :: v(size(a, 1)), norm, part
    integer :: j, k, m

    m = size(a, 1)
    do j = 1, columns
      norm = norm2(a(j:, j))
      if (.not. norm > 0.0_wp) cycle
      v(j:) = a(j:, j)
      v(j) = v(j) + sign(norm, v(j))
      part = 1.0_wp/(norm*abs(v(j)))
      a(j, j) = -sign(norm, a(j, j))
      a(j + 1:, j) = 0.0_wp
      do k = j + 1, size(a, 2)
        a(j:, k) = a(j:, k) - part*dot_product(v(j:m), a(j:, k))*v(j:m)
      end do
    end do
  end subroutine triangulate

  !> Solve with an upper triangular matrix. An unknown whose diagonal element is zero is zero.
  pure subroutine solve_upper(a, b, x)
    real(wp), intent(in) :: a(:, :)   !< (n,n) the matrix
    real(wp), intent(in) :: b(:)      !< (n) right-hand side
    real(wp), intent(out) :: x(:)     !< (n) the solution
    integer :: j

    do j = size(x), 1, -1
      x(j) = 0.0_wp
      if (abs(a(j, j)) > 0.0_wp) x(j) = (b(j) - dot_product(a(j, j + 1:size(x)), x(j + 1:)))/a(j, j)
    end do
  end subroutine solve_upper
end module mech9_reflections
