!> Factors of small matrices against their definitions: cofactors, Householder's reflections, singular values and null vectors, and
!> lengths.
module test_small_matrices
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_cofactors, only: invert_by_cofactors
  use mech9_householder, only: householder, reflect, back_substitute, reflect_back
  use mech9_matrix_norms, only: matrix_length, distance_in_full
  use mech9_singular_values, only: decompose, null_vector
  use mech9_reflections, only: triangulate, solve_upper
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Some tens of roundings of numbers of order one; random matrices of a few rows have a condition of some hundred at most here.
  real(wp), parameter :: round_off = 1.0e-14_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('cofactors')) call cofactors(test)
    if (test%runs('dependent_columns')) call dependent_columns(test)
    if (test%runs('reflections')) call reflections(test)
    if (test%runs('triangles')) call triangles(test)
    if (test%runs('singular_values')) call singular_values(test)
    if (test%runs('null_vectors')) call null_vectors(test)
    if (test%runs('lengths')) call lengths(test)
  end subroutine run

  !> Numbers between -1 and 1 at random.
  subroutine fill(random, matrix)
    type(random_type), intent(inout) :: random   !< source of the numbers
    real(wp), intent(out) :: matrix(:, :)        !< gets them
    integer :: i, j

    do j = 1, size(matrix, 2)
      do i = 1, size(matrix, 1)
        matrix(i, j) = random%symmetric()
      end do
    end do
  end subroutine fill

  !> The unit matrix.
  pure function unit(n)
    integer, intent(in) :: n   !< number of rows
    real(wp) :: unit(n, n)
    integer :: i

    unit = 0.0_wp
    do i = 1, n
      unit(i, i) = 1.0_wp
    end do
  end function unit

  !> The determinant by Sarrus.
  pure real(wp) function determinant(a)
    real(wp), intent(in) :: a(3, 3)   !< the matrix

    determinant = a(1, 1)*a(2, 2)*a(3, 3) + a(1, 2)*a(2, 3)*a(3, 1) + a(1, 3)*a(2, 1)*a(3, 2) &
                  - a(1, 3)*a(2, 2)*a(3, 1) - a(1, 1)*a(2, 3)*a(3, 2) - a(1, 2)*a(2, 1)*a(3, 3)
  end function determinant

  !> The inverse, the sign of the determinant, and pivots whose product is its magnitude.
  subroutine cofactors(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(3, 3), inverse(3, 3), pivots(3)
    integer :: trial, sign_of_det

    do trial = 1, 100
      call fill(random, a)
      call invert_by_cofactors(a, inverse, pivots, sign_of_det)
      ! round-off grows with the inverse
      call test%near(maxval(abs(matmul(a, inverse) - unit(3))), 0.0_wp, round_off*maxval(abs(inverse)), 'the inverse')
      call test%near(sign_of_det*product(pivots), determinant(a), round_off, 'pivots and sign make the determinant')
      call test%near(pivots(1), sqrt(maxval(sum(a**2, 1))), round_off, 'the first pivot is the longest column')
      call test%is_true(pivots(1) >= pivots(2) .and. pivots(2) >= pivots(3), 'pivots do not increase')
    end do
  end subroutine cofactors

  !> The least pivot of dependent columns is zero, and their inverse is not set.
  subroutine dependent_columns(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: inverse(3, 3), pivots(3)
    integer :: sign_of_det

    inverse = 7.0_wp
    call invert_by_cofactors(reshape([1.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [3, 3]), inverse, &
                             pivots, sign_of_det)
    call test%near(pivots(3), 0.0_wp, 0.0_wp, 'the least pivot')
    call test%near(maxval(abs(inverse - 7.0_wp)), 0.0_wp, 0.0_wp, 'the inverse stays')
  end subroutine dependent_columns

  !> Q R of a matrix with permuted columns, its determinant's sign, solutions, and the way back.
  subroutine reflections(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer, parameter :: shapes(2, 5) = reshape([3, 3, 6, 6, 5, 4, 6, 3, 4, 4], [2, 5])
    real(wp), allocatable :: a(:, :), factors(:, :), tau(:), norms(:), b(:), product_of(:, :)
    integer, allocatable :: pivot(:)
    integer :: i, k, m, n, trial, sign_of_det

    do trial = 1, 50
      m = shapes(1, 1 + mod(trial, 5))
      n = shapes(2, 1 + mod(trial, 5))
      allocate (a(m, n), factors(m, n), tau(n), norms(n), b(m), product_of(m, n), pivot(n))
      call fill(random, a)
      factors = a
      call householder(m, n, factors, pivot, tau, sign_of_det, norms)
      do k = 1, n
        b = 0.0_wp
        b(:k) = factors(:k, k)
        call reflect_back(m, n, factors, tau, b)
        product_of(:, k) = b
      end do
      call test%near(maxval(abs(product_of - a(:, pivot))), 0.0_wp, round_off, 'Q R is the matrix with permuted columns')
      call test%is_true(all([(abs(factors(k, k)) >= abs(factors(min(k + 1, n), min(k + 1, n))), k=1, n)]), 'pivots do not increase')
      if (m == 3 .and. n == 3) call test%is_true(sign_of_det*determinant(a) > 0.0_wp, 'the sign of the determinant')
      product_of(:, 1) = matmul(a, [(real(i, wp), i=1, n)])
      b = product_of(:, 1)
      call reflect(m, n, factors, tau, b)
      call test%near(norm2(b), norm2(product_of(:, 1)), round_off, 'reflections keep lengths')
      call back_substitute(m, n, factors, [(1.0_wp/factors(k, k), k=1, n)], b(:n))
      ! round-off over the least pivot
      call test%near(maxval(abs(b(:n) - pivot)), 0.0_wp, 1.0e-13_wp/abs(factors(n, n)), 'the solution is found')
      deallocate (a, factors, tau, norms, b, product_of, pivot)
    end do
  end subroutine reflections

  !> A matrix with right-hand sides behind it: the solution, and zero where the diagonal is zero.
  subroutine triangles(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(6, 5), reduced(6, 5), x(4)
    integer :: i, trial

    do trial = 1, 20
      call fill(random, a)
      a(:, 5) = matmul(a(:, :4), [(real(i, wp), i=1, 4)])
      reduced = a
      call triangulate(reduced, 4)
      call test%near(maxval(abs(matmul(transpose(reduced(:4, :4)), reduced(:4, :4)) - matmul(transpose(a(:, :4)), a(:, :4)))), &
                     0.0_wp, round_off, 'the triangle has the products of the columns')
      call solve_upper(reduced(:4, :4), reduced(:4, 5), x)
      call test%near(maxval(abs(x - [(real(i, wp), i=1, 4)])), 0.0_wp, 1.0e-12_wp, 'the solution is found')
    end do
    call solve_upper(reshape([2.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [2, 2]), [3.0_wp, 5.0_wp], x(:2))
    call test%near(maxval(abs(x(:2) - [1.5_wp, 0.0_wp])), 0.0_wp, 0.0_wp, 'an unknown without a pivot is zero')
  end subroutine triangles

  !> u and v are orthogonal, and u diag(s) v^T is the matrix.
  subroutine singular_values(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), allocatable :: a(:, :), u(:, :), v(:, :), s(:)
    integer :: n

    do n = 1, 8
      allocate (a(n, n), u(n, n), v(n, n), s(n))
      call fill(random, a)
      call decompose(a, u, s, v)
      call test%near(maxval(abs(matmul(transpose(u), u) - unit(n))), 0.0_wp, round_off, 'left vectors are orthonormal')
      call test%near(maxval(abs(matmul(transpose(v), v) - unit(n))), 0.0_wp, round_off, 'right vectors are orthonormal')
      call test%near(maxval(abs(matmul(u*spread(s, 1, n), transpose(v)) - a)), 0.0_wp, round_off, 'they make the matrix')
      call test%is_true(all(s >= 0.0_wp) .and. all(s(:n - 1) >= s(2:)), 'singular values do not increase')
      deallocate (a, u, v, s)
    end do
  end subroutine singular_values

  !> The vectors that a matrix makes zero: one, and the second one of two; where there is one only, it is given for both.
  subroutine null_vectors(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    complex(wp) :: a(3, 3), first(3), second(3)

    ! (x, y, z) -> (x + i y, 0, 0): the null space is spanned by (1, i, 0)/sqrt(2) and (0, 0, 1)
    a = (0.0_wp, 0.0_wp)
    a(1, 1) = (1.0_wp, 0.0_wp)
    a(1, 2) = (0.0_wp, 1.0_wp)
    call null_vector(a, 1, 1.0e-9_wp, first)
    call null_vector(a, 2, 1.0e-9_wp, second)
    call test%near(maxval(abs(matmul(a, first))), 0.0_wp, round_off, 'the first vector')
    call test%near(maxval(abs(matmul(a, second))), 0.0_wp, round_off, 'the second vector')
    call test%near(abs(dot_product(first, second)), 0.0_wp, round_off, 'they are at right angles')
    call test%near(norm2(abs(first)), 1.0_wp, round_off, 'the first one is of length one')
    a(2, 3) = (2.0_wp, 0.0_wp)
    call null_vector(a, 2, 1.0e-9_wp, second)
    call test%near(maxval(abs(matmul(a, second))), 0.0_wp, round_off, 'the only vector counts where there is no second one')
  end subroutine null_vectors

  !> Lengths and distances are roots of sums of squares.
  subroutine lengths(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: a(4) = [1.0_wp, 2.0_wp, 4.0_wp, 10.0_wp], b(4) = [1.0_wp, -1.0_wp, 4.0_wp, 6.0_wp]

    call test%near(matrix_length(4, a), 11.0_wp, round_off, 'a length')
    call test%near(distance_in_full(4, a, b), 5.0_wp, round_off, 'a distance')
    call test%near(matrix_length(0, a), 0.0_wp, 0.0_wp, 'nothing has no length')
  end subroutine lengths
end module test_small_matrices
