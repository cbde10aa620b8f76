!> Sparse Cholesky factors solve random symmetric matrices of blocks: the residual of the equations is round-off.
module test_block_cholesky
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_block_cholesky, only: block_cholesky_type, new_block_cholesky
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_graphs')) call random_graphs(test)
    if (test%runs('ladder')) call ladder(test)
    if (test%runs('singular')) call singular(test)
  end subroutine run

  !> Random graphs, with nodes that no edge joins, and edges that count nothing or twice.
  subroutine random_graphs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer, parameter :: sizes(4) = [3, 6, 2, 1]
    integer :: trial, n, d, i
    integer, allocatable :: edges(:, :)

    do trial = 1, 40
      n = 1 + mod(trial, 9)
      d = sizes(1 + mod(trial, 4))
      allocate (edges(2, 2*n))
      do i = 1, 2*n
        edges(:, i) = [int(0.4999_wp*(1.0_wp + random%symmetric())*(n + 1)), int(0.4999_wp*(1.0_wp + random%symmetric())*(n + 1))]
      end do
      call compare(test, random, d, n, edges)
      deallocate (edges)
    end do
  end subroutine random_graphs

  !> A long ladder: its factor has few blocks more than the matrix.
  subroutine ladder(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: n = 200
    type(block_cholesky_type) :: matrix
    type(random_type) :: random
    integer :: edges(2, 3*n), i

    edges = 0
    do i = 1, n - 2
      edges(:, i) = [i, i + 2]
    end do
    do i = 1, n - 1, 2
      edges(:, n + i) = [i, i + 1]
    end do
    matrix = new_block_cholesky(3, n, edges)
    call test%is_true(size(matrix%row) < 3*n, 'the factor of a ladder is sparse')
    call compare(test, random, 3, n, edges)
  end subroutine ladder

  !> Sums of squares of differences over the edges, and a part of each node's own: the matrix is positive definite.
  subroutine compare(test, random, d, n, edges)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: d                     !< rows of a block
    integer, intent(in) :: n                     !< number of nodes
    integer, intent(in) :: edges(:, :)           !< (2,edges)
    type(block_cholesky_type) :: matrix
    real(wp) :: full(d, n, d, n), part(d, d, 2), x(d, n), b(d, n)
    integer :: i, j, k, side, other

    matrix = new_block_cholesky(d, n, edges)
    call matrix%clear()
    full = 0.0_wp
    do i = 1, n
      do j = 1, d
        full(j, i, j, i) = 1.0_wp
      end do
    end do
    do i = 1, size(edges, 2)
      if (minval(edges(:, i)) == 0 .or. edges(1, i) == edges(2, i)) cycle
      do side = 1, 2
        do k = 1, d
          do j = 1, d
            part(j, k, side) = random%symmetric()
          end do
        end do
      end do
      do side = 1, 2
        do other = 1, 2
          full(:, edges(side, i), :, edges(other, i)) = full(:, edges(side, i), :, edges(other, i)) &
                                                        + matmul(transpose(part(:, :, side)), part(:, :, other))
        end do
      end do
    end do
    do i = 1, n
      matrix%diagonal(:, :, matrix%position(i)) = full(:, i, :, i)
      do j = 1, n
        if (matrix%position(j) >= matrix%position(i)) cycle
        k = matrix%place_of(i, j)
        if (k > 0) matrix%blocks(:, :, k) = full(:, i, :, j)
      end do
      do j = 1, d
        b(j, i) = random%symmetric()
      end do
    end do
    x = b
    call matrix%factorize()
    call test%is_true(matrix%least_part > 0.0_wp, 'a positive definite matrix has positive pivots')
    call matrix%solve(x)
    ! eigenvalues lie between 1 and some hundreds
    call test%near(maxval(abs(matmul(reshape(full, [d*n, d*n]), reshape(x, [d*n])) - reshape(b, [d*n]))), 0.0_wp, 1.0e-12_wp, &
                   'the solution satisfies the equations')
  end subroutine compare

  !> Two nodes that only an edge holds: the last pivot is zero but for round-off.
  subroutine singular(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(block_cholesky_type) :: matrix
    integer :: j, e

    matrix = new_block_cholesky(3, 2, reshape([1, 2], [2, 1]))
    call matrix%clear()
    e = matrix%place_of(1, 2)
    do j = 1, 3
      matrix%diagonal(j, j, :) = 1.0_wp/3.0_wp
      matrix%blocks(j, j, e) = -1.0_wp/3.0_wp
    end do
    call matrix%factorize()
    call test%is_true(matrix%least_part < 1.0e-15_wp, 'a singular matrix is known by its least pivot')
  end subroutine singular
end module test_block_cholesky
