!> Linear complementarity: its conditions decide whether a solution is one, as G is a Gram matrix.
module test_complementarity
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_matrix
  use mech9_cholesky, only: cholesky_factorize
  use mech9_complementarity, only: solve_complementarity
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_contacts')) call random_contacts(test)
    if (test%runs('several_in_one_corner')) call several_in_one_corner(test)
    if (test%runs('without_solution')) call without_solution(test)
    if (test%runs('opposed_to_round_off')) call opposed_to_round_off(test)
    if (test%runs('round_off_holds')) call round_off_holds(test)
  end subroutine run

  !> Contacts of unit mass points in up to six dimensions, fewer or more than these, whose rows depend on each other. Such problems have
  !> a solution, and the rate after the impact does not depend on the order of the contacts.
  subroutine random_contacts(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), allocatable :: a(:, :), u(:), b(:), g(:, :), z(:), z2(:), w(:), round_off(:), factors(:, :)
    logical, allocatable :: holds(:), holds2(:)
    integer, allocatable :: order(:), holding(:)
    real(wp) :: least_z, least_w, product, difference
    logical :: solved, solved2, independent
    integer :: n, dimensions, trial, i, n_solved, n_trials, n_holding, failed_at

    least_z = 0.0_wp
    least_w = 0.0_wp
    product = 0.0_wp
    difference = 0.0_wp
    independent = .true.
    n_solved = 0
    n_trials = 0
    n_holding = 0
    do dimensions = 1, 6
      do n = 1, 10
        do trial = 1, 10
          a = random_matrix(random, n, dimensions)
          if (n > 2) a(n, :) = a(1, :)
          if (n > 3) a(n - 1, :) = -a(2, :)
          if (n > 4) a(n - 2, :) = 0.5_wp*(a(1, :) + a(2, :))
          allocate (u(dimensions), b(n), g(n, n), z(n), z2(n), w(n), round_off(n), holds(n), holds2(n))
          do i = 1, dimensions
            u(i) = random%symmetric()
          end do
          g = matmul(a, transpose(a))
          b = matmul(a, u)
          round_off = 1.0e-13_wp
          call solve_complementarity(n, g, b, round_off, z, holds, solved)
          n_trials = n_trials + 1
          if (solved) n_solved = n_solved + 1
          w = b + matmul(g, z)
          least_z = min(least_z, minval(z))
          least_w = min(least_w, minval(w))
          product = max(product, maxval(abs(z*w)))
          holding = pack([(i, i=1, n)], holds)
          factors = g(holding, holding)
          call cholesky_factorize(size(factors, 1), factors, failed_at)
          independent = independent .and. failed_at == 0
          n_holding = n_holding + count(holds)
          order = [(i, i=n, 1, -1)]
          call solve_complementarity(n, g(order, order), b(order), round_off, z2, holds2, solved2)
          difference = max(difference, maxval(abs(matmul(transpose(a), z) - matmul(transpose(a(order, :)), z2))))
          if (.not. solved2) n_solved = n_solved - 1
          deallocate (u, b, g, z, z2, w, round_off, holds, holds2)
        end do
      end do
    end do
    call test%is_true(n_solved == n_trials, 'all are solved')
    call test%is_true(n_holding > n_trials, 'most have several contacts that push')
    call test%is_true(independent, 'contacts that push are independent')
    ! round-off of 1e-16, enlarged by the conditioning of the contacts, which is 1e-4 in the worst of these
    call test%near(least_z, 0.0_wp, 1.0e-12_wp, 'no impulse pulls')
    call test%near(least_w, 0.0_wp, 1.0e-11_wp, 'no contact is passed')
    call test%near(product, 0.0_wp, 1.0e-11_wp, 'a contact pushes or opens')
    call test%near(difference, 0.0_wp, 1.0e-11_wp, 'another order of contacts gives the same rate')
  end subroutine random_contacts

  !> Many contacts that meet in one corner, beside each other: most are passed on the way to the solution, and opened again.
  subroutine several_in_one_corner(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: n = 20
    real(wp) :: a(n, 3), g(n, n), b(n), z(n), w(n), round_off(n), angle, pi
    logical :: holds(n), solved
    integer :: i

    pi = acos(-1.0_wp)
    do i = 1, n
      angle = 2.0_wp*pi*i/n
      a(i, :) = [cos(angle), sin(angle), 0.1_wp]
    end do
    g = matmul(a, transpose(a))
    b = matmul(a, [0.3_wp, 0.1_wp, -1.0_wp])
    round_off = 1.0e-13_wp
    call solve_complementarity(n, g, b, round_off, z, holds, solved)
    w = b + matmul(g, z)
    call test%is_true(solved, 'a cone of contacts is solved')
    call test%is_true(all(z >= 0.0_wp) .and. all(w > -1.0e-12_wp), 'no contact pulls or is passed')
    call test%near(maxval(abs(z*w)), 0.0_wp, 1.0e-12_wp, 'one of both is zero')
    call test%is_true(count(holds) <= 3, 'three contacts determine a point')
  end subroutine several_in_one_corner

  !> Contacts that no impulses can keep.
  subroutine without_solution(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: opposed(2, 2) = reshape([1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp], [2, 2])
    real(wp) :: z1(1), z2(2)
    logical :: holds1(1), holds2(2), solved

    call solve_complementarity(1, reshape([0.0_wp], [1, 1]), [-1.0_wp], [1.0e-13_wp], z1, holds1, solved)
    call test%is_true(.not. solved, 'nothing moves the contact')
    call solve_complementarity(2, opposed, [-1.0_wp, -1.0_wp], [1.0e-13_wp, 1.0e-13_wp], z2, holds2, solved)
    call test%is_true(.not. solved, 'two contacts are driven against each other')
    call solve_complementarity(2, opposed, [-1.0_wp, 1.0_wp], [1.0e-13_wp, 1.0e-13_wp], z2, holds2, solved)
    call test%is_true(solved, 'two contacts are driven alike')
    call test%near(z2(1) - z2(2), 1.0_wp, 1.0e-15_wp, 'the first one pushes')
  end subroutine without_solution

  !> Two contacts that are driven against each other, of masses that are no whole numbers: one row is a negative multiple of the other
  !> but for round-off, so that what elimination leaves of it is no impulse that could hold both.
  subroutine opposed_to_round_off(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(2, 3), z(2)
    logical :: holds(2), solved
    integer :: trial, i, n_solved

    n_solved = 0
    do trial = 1, 100
      do i = 1, 3
        a(1, i) = random%symmetric()
      end do
      a(2, :) = -(1.1_wp + random%symmetric())*a(1, :)
      call solve_complementarity(2, matmul(a, transpose(a)), [-1.0_wp, -1.0_wp], [1.0e-13_wp, 1.0e-13_wp], z, holds, solved)
      if (solved) n_solved = n_solved + 1
    end do
    call test%is_true(n_solved == 0, 'contacts that are driven against each other have no solution')
  end subroutine opposed_to_round_off

  !> A rate within round-off is none.
  subroutine round_off_holds(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: z(2)
    logical :: holds(2), solved

    call solve_complementarity(2, reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2]), [-0.9e-13_wp, -1.1e-13_wp], &
                               [1.0e-13_wp, 1.0e-13_wp], z, holds, solved)
    call test%is_true(solved .and. .not. holds(1) .and. holds(2), 'only the rate above round-off is stopped')
    call test%near(z(1), 0.0_wp, 0.0_wp, 'without an impulse')
  end subroutine round_off_holds
end module test_complementarity
