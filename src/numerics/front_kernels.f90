!> The operations on one front of a sparse QR factorization. Loops of the most frequent sizes are compiled for these sizes.
!>
!> Arrays are of explicit shape, so that the compiler keeps their addresses in registers.
module mech9_front_kernels
  use mech9_kinds, only: wp
  use mech9_front_plan, only: front_type
  implicit none
  private
  public :: gather, take_rows, eliminate, add_squares, add_differences, pass_rows, reflect, substitute, take_covariance, invert, &
    fill_covariance

contains

  !> Take a front's original rows out of the matrix.
  pure subroutine gather(front, rows, columns, m_matrix, matrix, a)
    type(front_type), intent(in) :: front                       !< the front
    integer, intent(in) :: rows(front%original)                      !< numbers of its original rows in the matrix
    integer, intent(in) :: columns(front%columns)               !< numbers of its columns in the matrix
    integer, intent(in) :: m_matrix                             !< rows of the matrix
    real(wp), intent(in) :: matrix(m_matrix, *)                 !< the matrix
    real(wp), intent(inout) :: a(front%rows, front%columns)     !< gets the first rows of the front
    integer :: i, j

    if (is_spatial_closure(front%original, rows)) then
      do j = 1, front%columns
        do i = 1, 6
          a(i, j) = matrix(rows(1) + i - 1, columns(j))
        end do
      end do
      return
    end if
    do j = 1, front%columns
      do i = 1, front%original
        a(i, j) = matrix(rows(i), columns(j))
      end do
    end do
  end subroutine gather

  !> Take a front's original rows out of a right-hand side.
  pure subroutine take_rows(original, rows, m_matrix, right, sides)
    integer, intent(in) :: original             !< number of original rows
    integer, intent(in) :: rows(original)       !< their numbers in the matrix
    integer, intent(in) :: m_matrix             !< rows of the matrix
    real(wp), intent(in) :: right(m_matrix)     !< the right-hand side
    real(wp), intent(inout) :: sides(original)  !< gets the right-hand side of these rows
    integer :: i

    if (is_spatial_closure(original, rows)) then
      do i = 1, 6
        sides(i) = right(rows(1) + i - 1)
      end do
      return
    end if
    do i = 1, original
      sides(i) = right(rows(i))
    end do
  end subroutine take_rows

  !> Whether the original rows of a front are the six rows of one spatial closure, one behind the other.
  pure logical function is_spatial_closure(original, rows)
    integer, intent(in) :: original        !< number of original rows
    integer, intent(in) :: rows(original)  !< their numbers in the matrix

    is_spatial_closure = .false.
    if (original == 6) is_spatial_closure = rows(6) == rows(1) + 5
  end function is_spatial_closure

  !> Eliminate the pivots of a front by reflections.
  pure subroutine eliminate(m, p, n, a, scales, reciprocals, sign_of_det)
    integer, intent(in) :: m                  !< rows of the front
    integer, intent(in) :: p                  !< pivots of the front
    integer, intent(in) :: n                  !< columns of the front
    real(wp), intent(inout) :: a(m, n)        !< the front; R and reflections afterwards
    real(wp), intent(out) :: scales(p)        !< scales of the reflections
    real(wp), intent(out) :: reciprocals(p)   !< of the diagonal of R, 0 where that is 0
    integer, intent(inout) :: sign_of_det     !< changed for each negative factor of the determinant

    if (m == 6 .and. p == 5) then
      call eliminate_6_5(n, a, scales, reciprocals, sign_of_det)
    else if (m == 5 .and. p == 5) then
      call eliminate_5_5(n, a, scales, reciprocals, sign_of_det)
    else if (m == 6) then
      call eliminate_6(p, n, a, scales, reciprocals, sign_of_det)
    else if (m == 3) then
      call eliminate_3(p, n, a, scales, reciprocals, sign_of_det)
    else
      call eliminate_any(m, p, n, a, scales, reciprocals, sign_of_det)
    end if
  end subroutine eliminate

  ! The arguments that these procedures share are declared and described in the included file.

  !> `eliminate` for any number of rows.
  pure subroutine eliminate_any(m, p, n, a, scales, reciprocals, sign_of_det)
    integer, intent(in) :: m   !< number of rows
    integer, intent(in) :: p   !< number of pivots
    include 'elimination.inc'
  end subroutine eliminate_any

  !> `eliminate` for the six rows of a spatial closure.
  pure subroutine eliminate_6(p, n, a, scales, reciprocals, sign_of_det)
    integer, parameter :: m = 6
    integer, intent(in) :: p   !< number of pivots
    include 'elimination.inc'
  end subroutine eliminate_6

  !> `eliminate` for five pivots in the six rows of a spatial closure.
  pure subroutine eliminate_6_5(n, a, scales, reciprocals, sign_of_det)
    integer, parameter :: m = 6, p = 5
    include 'elimination.inc'
  end subroutine eliminate_6_5

  !> `eliminate` for five pivots in five rows.
  pure subroutine eliminate_5_5(n, a, scales, reciprocals, sign_of_det)
    integer, parameter :: m = 5, p = 5
    include 'elimination.inc'
  end subroutine eliminate_5_5

  !> `eliminate` for the three rows of a planar or spherical closure.
  pure subroutine eliminate_3(p, n, a, scales, reciprocals, sign_of_det)
    integer, parameter :: m = 3
    integer, intent(in) :: p   !< number of pivots
    include 'elimination.inc'
  end subroutine eliminate_3

  !> Add the squares of the numbers of R to those of their columns.
  pure subroutine add_squares(m, p, n, a, columns, n_matrix, squares)
    integer, intent(in) :: m                       !< rows of the front
    integer, intent(in) :: p                       !< pivots of the front
    integer, intent(in) :: n                       !< columns of the front
    real(wp), intent(in) :: a(m, n)                !< the front after elimination
    integer, intent(in) :: columns(n)              !< numbers of its columns in the matrix
    integer, intent(in) :: n_matrix                !< columns of the matrix
    real(wp), intent(inout) :: squares(n_matrix)   !< sums of squares of each column of R
    real(wp) :: s
    integer :: i, j

    do j = 1, p
      s = squares(columns(j))
      do i = 1, j
        s = s + a(i, j)**2
      end do
      squares(columns(j)) = s
    end do
    do j = p + 1, n
      if (p == 5) then
        s = a(1, j)**2 + a(2, j)**2 + a(3, j)**2 + a(4, j)**2 + a(5, j)**2
      else
        s = sum(a(:p, j)**2)
      end if
      squares(columns(j)) = squares(columns(j)) + s
    end do
  end subroutine add_squares

  !> Add the squares of the differences between two matrices in the original rows of a front.
  pure subroutine add_differences(front, rows, columns, m_matrix, a, b, total)
    type(front_type), intent(in) :: front           !< the front
    integer, intent(in) :: rows(front%original)          !< numbers of its original rows in the matrix
    integer, intent(in) :: columns(front%columns)   !< numbers of its columns in the matrix
    integer, intent(in) :: m_matrix                 !< rows of the matrix
    real(wp), intent(in) :: a(m_matrix, *)          !< the first matrix
    real(wp), intent(in) :: b(m_matrix, *)          !< the second one
    real(wp), intent(inout) :: total                !< the sum of squares
    real(wp) :: sums(6)
    integer :: i, j, k, before

    if (is_spatial_closure(front%original, rows)) then
      before = rows(1) - 1
      sums = 0.0_wp
      do j = 1, front%columns
        k = columns(j)
        ! unrolled, the loop would be compiled number by number and not for vectors
!GCC$ unroll 1
        do i = 1, 6
          sums(i) = sums(i) + (a(before + i, k) - b(before + i, k))**2
        end do
      end do
      total = total + (((sums(1) + sums(2)) + (sums(3) + sums(4))) + (sums(5) + sums(6)))
      return
    end if
    do j = 1, front%columns
      k = columns(j)
      do i = 1, front%original
        total = total + (a(rows(i), k) - b(rows(i), k))**2
      end do
    end do
  end subroutine add_differences

  !> Pass the rows that remain on to the parent, where they are zero in the columns that the front does not have.
  pure subroutine pass_rows(front, a, places, parent, values)
    type(front_type), intent(in) :: front                                !< the front
    real(wp), intent(in) :: a(front%rows, front%columns)                 !< its values after elimination
    integer, intent(in) :: places(front%columns)                         !< place of each column among the columns of the parent
    type(front_type), intent(in) :: parent                               !< its parent
    real(wp), intent(inout) :: values(parent%rows, parent%columns)       !< of the parent, which gets the rows
    integer :: i, j

    associate (m => front%rows, p => front%pivots, n => front%columns, before => front%parent_row)
      if (n - p < parent%columns) then
        do j = 1, parent%columns
          do i = before + 1, before + m - p
            values(i, j) = 0.0_wp
          end do
        end do
      end if
      do i = p + 1, m
        do j = p + 1, n
          values(before + i - p, places(j)) = a(i, j)
        end do
      end do
    end associate
  end subroutine pass_rows

  !> b becomes Q^T b, with the p reflections of a front.
  pure subroutine reflect(m, p, a, scales, b)
    integer, intent(in) :: m            !< rows of the front
    integer, intent(in) :: p            !< pivots of the front
    real(wp), intent(in) :: a(m, p)     !< the front after elimination
    real(wp), intent(in) :: scales(p)   !< scales of the reflections
    real(wp), intent(inout) :: b(m)     !< right-hand side; Q^T b afterwards

    if (m == 6 .and. p == 5) then
      call reflect_6_5(a, scales, b)
    else
      call reflect_any(m, p, a, scales, b)
    end if
  end subroutine reflect

  !> `reflect` for fronts of any size.
  pure subroutine reflect_any(m, n, a, tau, b)
    integer, intent(in) :: m   !< rows of the front
    integer, intent(in) :: n   !< pivots of the front
    include 'reflection.inc'
  end subroutine reflect_any

  !> `reflect` for five pivots in the six rows of a spatial closure.
  pure subroutine reflect_6_5(a, tau, b)
    integer, parameter :: m = 6, n = 5
    include 'reflection.inc'
  end subroutine reflect_6_5

  !> The solution of a front for its pivots, from the solution for its other columns.
  pure subroutine substitute(front, a, reciprocals, columns, b, x)
    type(front_type), intent(in) :: front                   !< the front
    real(wp), intent(in) :: a(front%rows, front%columns)    !< its values after elimination
    real(wp), intent(in) :: reciprocals(front%pivots)       !< of the diagonal of R
    integer, intent(in) :: columns(front%columns)           !< numbers of the columns in the matrix
    real(wp), intent(in) :: b(front%pivots)                 !< right-hand side
    real(wp), intent(inout) :: x(*)                         !< with the solution for the other columns; gets that for the pivots

    if (front%pivots == 5) then
      call substitute_5(front, a, reciprocals, columns, b, x)
    else
      call substitute_any(front%pivots, front, a, reciprocals, columns, b, x)
    end if
  end subroutine substitute

  !> `substitute` for any number of pivots.
  pure subroutine substitute_any(p, front, a, reciprocals, columns, b, x)
    integer, intent(in) :: p   !< number of pivots
    include 'front_substitution.inc'
  end subroutine substitute_any

  !> `substitute` for five pivots.
  pure subroutine substitute_5(front, a, reciprocals, columns, b, x)
    integer, parameter :: p = 5
    include 'front_substitution.inc'
  end subroutine substitute_5

  !> The covariance of the columns that a front shares with its parent.
  pure subroutine take_covariance(r, places, n_parent, of_parent, of_others)
    integer, intent(in) :: r                              !< number of these columns
    integer, intent(in) :: places(r)                      !< their places among the columns of the parent
    integer, intent(in) :: n_parent                       !< columns of the parent
    real(wp), intent(in) :: of_parent(n_parent, n_parent) !< covariance of the columns of the parent
    real(wp), intent(out) :: of_others(r, r)              !< covariance of the shared columns
    integer :: i, j

    do j = 1, r
      do i = 1, r
        of_others(i, j) = of_parent(places(i), places(j))
      end do
    end do
  end subroutine take_covariance

  !> The inverse among the pivots of a front, and its products with the other columns.
  pure subroutine invert(front, a, reciprocals, of_others, inverse, product, variances)
    type(front_type), intent(in) :: front                           !< the front
    real(wp), intent(in) :: a(front%rows, front%columns)            !< its values after elimination
    real(wp), intent(in) :: reciprocals(front%pivots)               !< of the diagonal of R
    real(wp), intent(in) :: of_others(*)                            !< covariance of the other columns
    real(wp), intent(out) :: inverse(front%pivots, front%columns)   !< R^-1 among the pivots, then its product with R in the others
    real(wp), intent(out) :: product(front%pivots, *)               !< product of the latter and the covariance
    real(wp), intent(out) :: variances(front%pivots)                !< diagonal of the covariance for the pivots

    if (front%pivots == 5) then
      call invert_5(front, a, reciprocals, of_others, inverse, product, variances)
    else
      call invert_any(front, a, reciprocals, of_others, inverse, product, variances)
    end if
  end subroutine invert

  !> `invert` for any number of pivots.
  pure subroutine invert_any(front, a, reciprocals, of_others, inverse, product, variances)
    type(front_type), intent(in) :: front                           !< the front
    real(wp), intent(in) :: a(front%rows, front%columns)            !< its values after elimination
    real(wp), intent(in) :: reciprocals(front%pivots)               !< of the diagonal of R
    real(wp), intent(in) :: of_others(front%columns - front%pivots, *)   !< covariance of the other columns
    real(wp), intent(out) :: inverse(front%pivots, front%columns)   !< R^-1 among the pivots, then its product with R in the others
    real(wp), intent(out) :: product(front%pivots, *)               !< product of the latter and the covariance
    real(wp), intent(out) :: variances(front%pivots)                !< diagonal of the covariance for the pivots
    real(wp) :: x(front%pivots)
    integer :: p, i, j, k

    p = front%pivots
    include 'inversion.inc'
  end subroutine invert_any

  !> `invert` for five pivots.
  pure subroutine invert_5(front, a, reciprocals, of_others, inverse, product, variances)
    integer, parameter :: p = 5
    type(front_type), intent(in) :: front                           !< the front
    real(wp), intent(in) :: a(front%rows, front%columns)            !< its values after elimination
    real(wp), intent(in) :: reciprocals(p)                          !< of the diagonal of R
    real(wp), intent(in) :: of_others(front%columns - p, *)         !< covariance of the other columns
    real(wp), intent(out) :: inverse(p, front%columns)              !< R^-1 among the pivots, then its product with R in the others
    real(wp), intent(out) :: product(p, *)                          !< product of the latter and the covariance
    real(wp), intent(out) :: variances(p)                           !< diagonal of the covariance for the pivots
    real(wp) :: x(p)
    integer :: i, j, k

    include 'inversion.inc'
  end subroutine invert_5

  !> The covariance of all columns of a front.
  pure subroutine fill_covariance(front, inverse, product, of_others, covariance)
    type(front_type), intent(in) :: front                                 !< the front
    real(wp), intent(in) :: inverse(front%pivots, front%columns)          !< R^-1 among the pivots; then its product with R
    real(wp), intent(in) :: product(front%pivots, *)                      !< product of the latter and the covariance of the others
    real(wp), intent(in) :: of_others(front%columns - front%pivots, *)    !< covariance of the other columns
    real(wp), intent(out) :: covariance(front%columns, front%columns)     !< covariance of all columns
    integer :: i, j, k

    associate (p => front%pivots, r => front%columns - front%pivots)
      do j = 1, p
        do i = 1, p
          covariance(i, j) = 0.0_wp
        end do
        do k = j, p
          do i = 1, k
            covariance(i, j) = covariance(i, j) + inverse(i, k)*inverse(j, k)
          end do
        end do
        do k = 1, r
          do i = 1, p
            covariance(i, j) = covariance(i, j) + product(i, k)*inverse(j, p + k)
          end do
        end do
      end do
      do j = 1, r
        do i = 1, p
          covariance(i, p + j) = -product(i, j)
          covariance(p + j, i) = -product(i, j)
        end do
        do i = 1, r
          covariance(p + i, p + j) = of_others(i, j)
        end do
      end do
    end associate
  end subroutine fill_covariance
end module mech9_front_kernels
