!> The sign of a determinant from its factors, against exact determinants of whole numbers.
module test_determinant_sign
  use mech9_kinds, only: wp, long
  use mech9_random, only: random_type
  use mech9_least_squares, only: least_squares_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('small_matrices')) call small_matrices(test)
    if (test%runs('permutations')) call permutations(test)
    if (test%runs('large_matrices')) call large_matrices(test)
    if (test%runs('other_shapes')) call other_shapes(test)
  end subroutine run

  !> Exact determinant by Bareiss' elimination, which divides without remainder.
  function determinant(matrix) result(value)
    integer, intent(in) :: matrix(:, :)   !< square
    integer(long) :: value
    integer(long) :: a(size(matrix, 1), size(matrix, 1)), row(size(matrix, 1)), last
    integer :: n, i, j, k, sign

    n = size(matrix, 1)
    a = matrix
    sign = 1
    last = 1
    do k = 1, n - 1
      if (a(k, k) == 0) then
        i = findloc(a(k:, k) /= 0_long, .true., dim=1) + k - 1
        if (i < k) then
          value = 0
          return
        end if
        row = a(k, :)
        a(k, :) = a(i, :)
        a(i, :) = row
        sign = -sign
      end if
      do i = k + 1, n
        do j = k + 1, n
          a(i, j) = (a(i, j)*a(k, k) - a(i, k)*a(k, j))/last
        end do
      end do
      last = a(k, k)
    end do
    value = sign*a(n, n)
  end function determinant

  function random_integer(random, most) result(number)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: most                  !< largest magnitude
    integer :: number

    number = nint((most + 0.49_wp)*random%symmetric())
  end function random_integer

  function random_integers(random, n, most) result(a)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: n                     !< rows and columns
    integer, intent(in) :: most                  !< largest magnitude
    integer :: a(n, n), i, j

    do j = 1, n
      do i = 1, n
        a(i, j) = random_integer(random, most)
      end do
    end do
  end function random_integers

  subroutine check_matrix(test, matrix, value, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: matrix(:, :)        !< square
    integer(long), intent(in) :: value         !< its exact determinant
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(least_squares_type) :: system
    integer :: n

    n = size(matrix, 1)
    call system%create(n, n)
    system%a = matrix
    call system%factorize()
    if (value == 0) then
      call test%is_true(system%rank() < n, why//': a singular matrix has not full rank')
    else
      call test%is_true(system%rank() == n, why//': a regular matrix has full rank')
      call test%is_true(system%determinant_sign() == merge(1, -1, value > 0), why//': the sign is that of the determinant')
    end if
  end subroutine check_matrix

  !> Entries -1 .. 1 give many zeros and singular matrices, -3 .. 3 few.
  subroutine small_matrices(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer, allocatable :: a(:, :)
    integer :: n, trial

    do n = 1, 8
      do trial = 1, 200
        a = random_integers(random, n, 1 + 2*mod(trial, 2))
        call check_matrix(test, a, determinant(a), 'a small matrix')
      end do
    end do
  end subroutine small_matrices

  !> All permutations of three rows, with each choice of signs.
  subroutine permutations(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: orders(3, 6) = reshape([1, 2, 3, 2, 3, 1, 3, 1, 2, 2, 1, 3, 1, 3, 2, 3, 2, 1], [3, 6])
    integer :: a(3, 3), i, j, signs, value

    do i = 1, 6
      do signs = 0, 7
        a = 0
        value = merge(1, -1, i <= 3)
        do j = 1, 3
          a(orders(j, i), j) = merge(-2, 2, btest(signs, j - 1))
          value = value*a(orders(j, i), j)
        end do
        call check_matrix(test, a, int(value, long), 'a permutation')
      end do
    end do
  end subroutine permutations

  !> Blocks along the diagonal whose determinants are exact, mixed by additions of rows, which change no
  !> determinant, and by exchanges, which change its sign; past the size from which LAPACK is called.
  subroutine large_matrices(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer, allocatable :: a(:, :), block(:, :), row(:)
    integer :: n, trial, first, i, j, k, value
    integer(long) :: part

    do n = 20, 40, 4
      do trial = 1, 20
        allocate (a(n, n), source=0)
        value = 1
        first = 1
        do while (first <= n)
          block = random_integers(random, 4, 3)
          part = determinant(block)
          if (part == 0) cycle
          if (part < 0) value = -value
          a(first:first + 3, first:first + 3) = block
          first = first + 4
        end do
        do k = 1, 2*n
          i = 1 + mod(abs(random_integer(random, 100000)), n)
          j = 1 + mod(abs(random_integer(random, 100000)), n)
          if (i == j) cycle
          if (mod(k, 2) == 0) then
            row = a(i, :)
            a(i, :) = a(j, :)
            a(j, :) = row
            value = -value
          else if (maxval(abs(a(i, :))) < 20) then   ! the condition stays moderate
            a(i, :) = a(i, :) + a(j, :)
          end if
        end do
        call check_matrix(test, a, int(value, long), 'a large matrix')
        deallocate (a)
      end do
    end do
  end subroutine large_matrices

  subroutine other_shapes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(least_squares_type) :: system

    call system%create(3, 2)
    system%a = -1.0_wp
    call system%factorize()
    call test%is_true(system%determinant_sign() == 1, 'the determinant of a matrix that is not square has no sign')
    call system%create(0, 0)
    call system%factorize()
    call test%is_true(system%determinant_sign() == 1, 'the determinant of an empty matrix is one')
  end subroutine other_shapes
end module test_determinant_sign
