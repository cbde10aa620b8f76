!> The length of a matrix, which is the root of the sum of squares of its numbers, and the distance of two matrices.
!>
!> The procedures work on arrays of explicit shape: the compiler needs neither descriptors nor strides.
module mech9_matrix_norms
  use mech9_kinds, only: wp
  implicit none
  private
  public :: matrix_length, distance_in_full

contains

  !> Root of the sum of squares of a matrix.
  pure real(wp) function matrix_length(n, a) result(length)
    integer, intent(in) :: n       !< number of elements
    real(wp), intent(in) :: a(n)   !< the matrix, element by element
    integer :: i

    length = 0.0_wp
    do i = 1, n
      length = length + a(i)**2
    end do
    length = sqrt(length)
  end function matrix_length

  !> Root of the sum of squares of the differences between two full matrices.
  pure real(wp) function distance_in_full(n, a, b) result(distance)
    integer, intent(in) :: n   !< number of elements
    real(wp), intent(in) :: a(n)   !< the first matrix, element by element
    real(wp), intent(in) :: b(n)   !< the second one
    real(wp) :: sums(4)
    integer :: i, k

    ! four sums, so that none waits for the one before it
    sums = 0.0_wp
    do i = 1, n - 3, 4
      do k = 1, 4
        sums(k) = sums(k) + (a(i + k - 1) - b(i + k - 1))**2
      end do
    end do
    do i = n - mod(n, 4) + 1, n
      sums(1) = sums(1) + (a(i) - b(i))**2
    end do
    distance = sqrt((sums(1) + sums(2)) + (sums(3) + sums(4)))
  end function distance_in_full
end module mech9_matrix_norms
