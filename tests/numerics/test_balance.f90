!> Balanced matrices: eigenvalues are kept, units are of no account.
module test_balance
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_balance, only: balance
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('units_are_of_no_account')) call units_are_of_no_account(test)
    if (test%runs('triangular_ones_become_diagonal')) call triangular_ones_become_diagonal(test)
    if (test%runs('eigenvalues_are_kept')) call eigenvalues_are_kept(test)
    if (test%runs('zeros_are_left')) call zeros_are_left(test)
  end subroutine run

  !> Entries at random, from -1 to 1.
  subroutine fill(random, a)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp), intent(out) :: a(:, :)             !< any shape
    integer :: i, j

    do j = 1, size(a, 2)
      do i = 1, size(a, 1)
        a(i, j) = random%symmetric()
      end do
    end do
  end subroutine fill

  !> D^-1 A D is as large as A once both are balanced: the scales are powers of ten far apart.
  subroutine units_are_of_no_account(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(6, 6), scaled(6, 6), unit(6)
    integer :: case, i, j

    do case = 1, 20
      call fill(random, a)
      unit = 10.0_wp**[(3.0_wp*random%symmetric(), i=1, 6)]
      do j = 1, 6
        scaled(:, j) = a(:, j)*unit(j)/unit
      end do
      call test%is_true(norm2(scaled) > 2.0_wp*norm2(a), 'a matrix in bad units is large')
      call balance(size(a, 1), a)
      call balance(size(scaled, 1), scaled)
      ! three sweeps leave a few percent of the least there is
      call test%is_true(abs(norm2(scaled) - norm2(a)) <= 0.1_wp*norm2(a), &
                        'a balanced matrix in bad units is as large as the one in good units')
    end do
  end subroutine units_are_of_no_account

  !> The entries of a triangular matrix beside its diagonal have no part in its eigenvalues.
  subroutine triangular_ones_become_diagonal(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(5, 5), before
    integer :: i, j

    call fill(random, a)
    do j = 1, 5
      a(:j - 1, j) = 0.0_wp
    end do
    before = norm2([(a(i, i), i=1, 5)])
    a = a + 100.0_wp*merge(1.0_wp, 0.0_wp, reshape([((i > j, i=1, 5), j=1, 5)], [5, 5]))
    call balance(size(a, 1), a)
    call test%is_true(abs(norm2(a) - before) <= 1.0e-2_wp*before, 'a balanced triangular matrix is as large as its diagonal')
  end subroutine triangular_ones_become_diagonal

  !> Traces of powers are sums of powers of the eigenvalues.
  subroutine eigenvalues_are_kept(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(4, 4), b(4, 4), power_a(4, 4), power_b(4, 4), trace_a, trace_b
    integer :: i, power

    call fill(random, a)
    a(2, :) = 1.0e3_wp*a(2, :)
    b = a
    call balance(size(b, 1), b)
    call test%is_true(norm2(b) < norm2(a), 'balancing makes a matrix smaller')
    power_a = a
    power_b = b
    do power = 1, 4
      trace_a = sum([(power_a(i, i), i=1, 4)])
      trace_b = sum([(power_b(i, i), i=1, 4)])
      ! round-off of products of entries up to 1e3
      call test%is_true(abs(trace_a - trace_b) <= 1.0e-12_wp*norm2(a)**power, &
                        'balancing keeps the traces of the powers of a matrix')
      power_a = matmul(power_a, a)
      power_b = matmul(power_b, b)
    end do
  end subroutine eigenvalues_are_kept

  !> No row, no column, no matrix at all.
  subroutine zeros_are_left(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: a(3, 3), none(0, 0)

    a = 0.0_wp
    a(1, 1) = 2.0_wp
    call balance(size(a, 1), a)
    call test%is_true(abs(norm2(a) - 2.0_wp) <= 0.0_wp, 'balancing keeps zeros')
    call balance(size(none, 1), none)
    call test%is_true(size(none) == 0, 'balancing leaves an empty matrix empty')
  end subroutine zeros_are_left
end module test_balance
