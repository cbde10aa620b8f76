!> Least squares against their definition, against normal equations in quadruple precision, and
!> ranks and conditioning against singular values.
module test_least_squares
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_matrix
  use mech9_least_squares, only: least_squares_type
  use mech9_lapack, only: dgesvd
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: quad = selected_real_kind(30)

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('all_shapes')) call all_shapes(test)
    if (test%runs('against_normal_equations')) call against_normal_equations(test)
    if (test%runs('deficient')) call deficient(test)
    if (test%runs('hidden_behind_zeros')) call hidden_behind_zeros(test)
    if (test%runs('zero_matrices')) call zero_matrices(test)
    if (test%runs('known_conditioning')) call known_conditioning(test)
    if (test%runs('conditioning_within_bounds')) call conditioning_within_bounds(test)
    if (test%runs('several_right_sides')) call several_right_sides(test)
    if (test%runs('fewer_columns')) call fewer_columns(test)
  end subroutine run

  !> Singular values, the largest first.
  function singular_values(a) result(s)
    real(wp), intent(in) :: a(:, :)   !< any shape
    real(wp) :: s(min(size(a, 1), size(a, 2)))
    real(wp) :: copy(size(a, 1), size(a, 2)), u(size(a, 1), size(a, 1)), vt(1, 1), work(10*(size(a, 1) + size(a, 2)))
    integer :: info

    copy = a
    ! without vectors LAPACK takes another way, which divides by zero on purpose
    call dgesvd('A', 'N', size(a, 1), size(a, 2), copy, size(a, 1), s, u, size(a, 1), vt, 1, work, size(work), info)
    if (info /= 0) error stop 'singular values did not converge'
  end function singular_values

  !> The distance of x from least squares: A^T (b - A x), in quadruple precision, over |A| (|A| |x| + |b|), which the solution
  !> of a problem changed in its last digits leaves there.
  real(wp) function normality(a, b, x)
    real(wp), intent(in) :: a(:, :)   !< matrix of the problem
    real(wp), intent(in) :: b(:)      !< right-hand side
    real(wp), intent(in) :: x(:)      !< solution that is judged
    real(quad) :: remains(size(b))
    real(wp) :: size_a
    integer :: j

    remains = b
    do j = 1, size(x)
      remains = remains - real(a(:, j), quad)*x(j)
    end do
    normality = 0.0_wp
    do j = 1, size(x)
      normality = max(normality, real(abs(sum(real(a(:, j), quad)*remains)), wp))
    end do
    size_a = norm2(a)
    normality = normality/max(size_a*(size_a*norm2(x) + norm2(b)), tiny(size_a))
  end function normality

  !> Each shape up to 60 equations in 40 unknowns: the remainder stands across all columns.
  subroutine all_shapes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(least_squares_type) :: system
    real(wp), allocatable :: a(:, :), b(:), b_kept(:), x(:)
    real(wp) :: worst, worst_remainder, remainder
    logical :: full
    integer :: m, n, rank

    worst = 0.0_wp
    worst_remainder = 0.0_wp
    full = .true.
    do n = 1, 40
      if (allocated(x)) deallocate (x)
      allocate (x(n))
      do m = 1, 60
        a = random_matrix(random, m, n)
        b = reshape(random_matrix(random, m, 1), [m])
        b_kept = b
        call system%create(m, n)
        system%a = a
        call system%factorize()
        rank = system%rank()
        full = full .and. rank == min(m, n)
        call system%solve(b, x, remainder)
        worst = max(worst, normality(a, b_kept, x))
        worst_remainder = max(worst_remainder, abs(remainder - norm2(b_kept - matmul(a, x)))/(norm2(a)*norm2(x) + norm2(b_kept)))
      end do
    end do
    call test%is_true(full, 'random matrices have full rank')
    ! Householder factors are exact for a matrix that differs by some roundings; sixty of them add up at worst
    call test%near(worst, 0.0_wp, 20.0_wp*epsilon(worst), 'the remainder stands across all columns, in all shapes')
    call test%near(worst_remainder, 0.0_wp, 20.0_wp*epsilon(worst), 'the length of the remainder is as stated, in all shapes')
  end subroutine all_shapes

  !> Solution of A^T A x = A^T b by Cholesky's factorization, in quadruple precision.
  function normal_solution(a, b) result(x)
    real(wp), intent(in) :: a(:, :)   !< matrix with independent columns
    real(wp), intent(in) :: b(:)      !< right-hand side
    real(wp) :: x(size(a, 2))
    real(quad) :: c(size(a, 1), size(a, 2)), g(size(a, 2), size(a, 2)), y(size(a, 2))
    integer :: j, k, n

    n = size(a, 2)
    c = a
    do j = 1, n
      y(j) = sum(c(:, j)*b)
      do k = 1, j
        g(j, k) = sum(c(:, j)*c(:, k))
      end do
    end do
    do j = 1, n   ! lower triangle, row by row
      do k = 1, j - 1
        g(j, k) = (g(j, k) - sum(g(j, 1:k - 1)*g(k, 1:k - 1)))/g(k, k)
      end do
      g(j, j) = sqrt(g(j, j) - sum(g(j, 1:j - 1)**2))
    end do
    do j = 1, n
      y(j) = (y(j) - sum(g(j, 1:j - 1)*y(1:j - 1)))/g(j, j)
    end do
    do j = n, 1, -1
      y(j) = (y(j) - sum(g(j + 1:n, j)*y(j + 1:n)))/g(j, j)
    end do
    x = real(y, wp)
  end function normal_solution

  !> Solutions themselves, within what the condition of the problem allows.
  subroutine against_normal_equations(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: rows(9) = [1, 2, 3, 6, 12, 23, 25, 40, 60], columns(8) = [1, 2, 3, 6, 12, 23, 24, 40]
    type(random_type) :: random
    type(least_squares_type) :: system
    real(wp), allocatable :: a(:, :), b(:), x(:), expected(:), s(:)
    real(wp) :: condition, remainder, allowed
    integer :: i, j, m, n

    do j = 1, size(columns)
      n = columns(j)
      if (allocated(x)) deallocate (x)
      allocate (x(n))
      do i = 1, size(rows)
        m = rows(i)
        if (m < n) cycle
        a = random_matrix(random, m, n)
        b = reshape(random_matrix(random, m, 1), [m])
        expected = normal_solution(a, b)
        call system%create(m, n)
        system%a = a
        call system%factorize()
        call system%solve(b, x, remainder)
        s = singular_values(a)
        condition = s(1)/s(n)
        ! first-order perturbation: roundings times cond |x| + cond^2 |remainder|/|A|
        allowed = 20.0_wp*epsilon(allowed)*(condition*norm2(expected) + condition**2*remainder/s(1))
        call test%is_true(norm2(x - expected) <= allowed, 'the solution is that of the normal equations')
      end do
    end do
  end subroutine against_normal_equations

  !> Products of thin matrices have the rank of their common side, whatever the shape.
  subroutine deficient(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: sides(8) = [2, 3, 6, 9, 17, 24, 33, 40]
    type(random_type) :: random
    type(least_squares_type) :: system
    real(wp), allocatable :: a(:, :), b(:), b_kept(:), x(:)
    integer :: i, j, m, n, r

    do i = 1, size(sides)
      do j = 1, size(sides)
        m = sides(i)
        n = sides(j)
        do r = 1, min(m, n) - 1
          a = matmul(random_matrix(random, m, r), random_matrix(random, r, n))
          b = reshape(random_matrix(random, m, 1), [m])
          b_kept = b
          if (allocated(x)) deallocate (x)
          allocate (x(n))
          call system%create(m, n)
          system%a = a
          call system%factorize()
          call test%is_true(system%rank() == r, 'a product of thin matrices has the rank of its factors')
          call test%is_true(system%conditioning() < 1.0e-12_wp, 'the columns of a product of thin matrices depend on each other')
          call system%solve(b, x)
          call test%is_true(count(abs(x) > 0.0_wp) <= r, 'no more unknowns are used than the rank')
          ! columns left out are combinations of those used, by factors of a few tens at worst
          call test%near(normality(a, b_kept, x), 0.0_wp, 1.0e-13_wp, 'a solution of less than full rank is one of least squares')
        end do
      end do
    end do
  end subroutine deficient

  !> Columns along the axes: nothing below the diagonal is left to be reflected away, and yet the columns
  !> must be chosen by what remains of them.
  subroutine hidden_behind_zeros(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(least_squares_type) :: system
    real(wp) :: x(3), b(3), remainder
    integer, parameter :: entries(9) = [10, 0, 0, 9, 0, 0, 0, 1, 0]
    integer :: shift, n

    call system%create(3, 3)
    do shift = 0, 2
      system%a = cshift(real(reshape(entries, [3, 3]), wp), shift, dim=2)
      call system%factorize()
      call test%is_true(system%rank() == 2, 'two parallel columns and one across have rank 2')
      b = [5.0_wp, 7.0_wp, 2.0_wp]
      call system%solve(b, x, remainder)
      call test%near(remainder, 2.0_wp, 1.0e-15_wp, 'the remainder is the part that no column reaches')
    end do

    do n = 1, 30   ! upper triangles of ones: the number of different rows
      call system%create(n, n + 2)
      system%a = 0.0_wp
      do shift = 1, n
        system%a(:shift, shift) = 1.0_wp
      end do
      system%a(:, n + 1) = system%a(:, n)
      system%a(1, n + 2) = 3.0_wp
      call system%factorize()
      call test%is_true(system%rank() == n, 'a triangle with repeated columns has full row rank')
    end do
  end subroutine hidden_behind_zeros

  subroutine zero_matrices(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(least_squares_type) :: system
    real(wp) :: x(30), b(30), remainder
    integer :: n

    do n = 0, 30, 10
      call system%create(4, n)
      system%a = 0.0_wp
      call system%factorize()
      b(1:4) = [2.0_wp, 0.0_wp, 1.0_wp, 2.0_wp]
      call system%solve(b(1:4), x(1:n), remainder)
      call test%is_true(system%rank() == 0, 'a matrix of zeros has no rank')
      call test%is_true(all(abs(x(1:n)) <= 0.0_wp), 'a matrix of zeros moves no unknown')
      call test%near(remainder, 3.0_wp, 1.0e-15_wp, 'a matrix of zeros leaves the whole right side')
    end do
    call test%near(system%conditioning(), 0.0_wp, 0.0_wp, 'columns of zeros depend on each other')
    call system%create(3, 0)
    call test%near(system%conditioning(), 1.0_wp, 0.0_wp, 'a matrix without columns has no columns that depend on each other')
    call system%create(0, 3)
    call system%factorize()
    call system%solve(b(1:0), x(1:3), remainder)
    call test%is_true(system%rank() == 0 .and. maxval(abs(x(1:3))) <= 0.0_wp, &
                      'a system without equations has rank zero and moves no unknown')
  end subroutine zero_matrices

  !> Columns across each other: the quotient of the shortest and the longest.
  subroutine known_conditioning(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(least_squares_type) :: system
    integer :: k, i

    do k = 0, 12, 3
      call system%create(5, 4)
      system%a = 0.0_wp
      do i = 1, 4
        system%a(i + 1, i) = 3.0_wp
      end do
      system%a(3, 2) = -3.0_wp*10.0_wp**(-k)
      call system%factorize()
      call test%near(system%conditioning()*10.0_wp**k, 1.0_wp, 1.0e-15_wp, &
                     'the conditioning of columns across each other is the ratio of their lengths')
      call test%is_true(system%rank(1.0e-7_wp) == merge(4, 3, k < 7), 'the rank follows a tolerance of the caller')
    end do
    call system%create(2, 3)
    system%a = reshape([1.0_wp, 2.0_wp, -1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 3])
    call system%factorize()
    call test%near(system%conditioning(), 0.0_wp, 0.0_wp, 'more columns than equations depend on each other')
  end subroutine known_conditioning

  !> Pivots against singular values: |r11| <= s1 <= sqrt(n) |r11| and
  !> sn <= |rnn| <= sn sqrt(4^n + 6n - 1)/3 (Lawson and Hanson, chapter 6).
  subroutine conditioning_within_bounds(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(least_squares_type) :: system
    real(wp), allocatable :: a(:, :), s(:)
    real(wp) :: true, factor, found
    integer :: n, trial

    do trial = 1, 100
      do n = 1, 6
        a = random_matrix(random, n + mod(trial, 3), n)
        a(:, n) = a(:, n)*10.0_wp**(-mod(trial, 8))
        call system%create(size(a, 1), n)
        system%a = a
        call system%factorize()
        s = singular_values(a)
        true = s(n)/s(1)
        factor = sqrt(real(n, wp))*sqrt(4.0_wp**n + 6*n - 1)/3.0_wp
        found = system%conditioning()
        call test%is_true(found >= true*(1.0_wp - 1.0e-6_wp) .and. found <= true*factor*(1.0_wp + 1.0e-6_wp), &
                          'the conditioning by pivots lies between its bounds')
      end do
    end do
  end subroutine conditioning_within_bounds

  !> One factorization serves several right-hand sides.
  subroutine several_right_sides(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(least_squares_type) :: system
    real(wp), allocatable :: a(:, :), b(:), x(:), expected(:), s(:)
    integer :: n, k

    do n = 6, 30, 24
      a = random_matrix(random, n + 2, n)
      s = singular_values(a)
      call system%create(n + 2, n)
      system%a = a
      call system%factorize()
      if (allocated(x)) deallocate (x)
      allocate (x(n))
      do k = 1, 3
        expected = reshape(random_matrix(random, n, 1), [n])
        b = matmul(a, expected)
        call system%solve(b, x)
        call test%is_true(norm2(x - expected) <= 20.0_wp*epsilon(x)*s(1)/s(n)*norm2(expected), &
                          'each right side gets its known solution')
      end do
    end do
  end subroutine several_right_sides

  !> A tolerance above the least pivot leaves columns out, also of three equations in three unknowns: a row of zeros more,
  !> which takes them to another method, changes nothing.
  subroutine fewer_columns(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(least_squares_type) :: three, more
    type(random_type) :: random
    real(wp) :: b(3), right(3), longer(4), x(3), y(3), tolerance, left, left_of_more
    integer :: trial, left_out

    call three%create(3, 3)
    call more%create(4, 3)
    left_out = 0
    do trial = 1, 100
      three%a = random_matrix(random, 3, 3)
      more%a(:3, :) = three%a
      more%a(4, :) = 0.0_wp
      b = reshape(random_matrix(random, 3, 1), [3])
      call three%factorize()
      call more%factorize()
      tolerance = 0.5_wp*(1.0_wp + more%conditioning())
      right = b
      call three%solve(right, x, left, tolerance)
      longer(:3) = b
      longer(4) = 0.0_wp
      call more%solve(longer, y, left_of_more, tolerance)
      if (more%rank(tolerance) < 3) left_out = left_out + 1
      ! pivots that are used are at least half of the largest: some tens of roundings
      call test%near(maxval(abs(x - y)), 0.0_wp, 1.0e-13_wp*max(1.0_wp, maxval(abs(y))), &
                     'the solution with a column left out is the same by both methods')
      call test%near(left, left_of_more, 1.0e-13_wp, 'the remainder with a column left out is the same by both methods')
    end do
    call test%is_true(left_out == 100, 'a column is left out in each trial')
  end subroutine fewer_columns
end module test_least_squares
