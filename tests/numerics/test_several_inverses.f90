!> Inverses of several matrices at once, against their definition in quadruple precision, and their judgement against singular values.
module test_several_inverses
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_matrix
  use mech9_several_inverses, only: most_rows, find_pivot_order, invert_in_order, bound_conditioning
  use mech9_lapack, only: dgesvd
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: quad = selected_real_kind(30), lead = 8

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('near_each_other')) call near_each_other(test)
    if (test%runs('one_by_one')) call one_by_one(test)
    if (test%runs('other_pivots')) call other_pivots(test)
    if (test%runs('singular')) call singular(test)
  end subroutine run

  !> Invert matrices in the order of pivots of the first one.
  subroutine invert(n, m, a, order, inverse, bounds)
    integer, intent(in) :: n                       !< number of matrices
    integer, intent(in) :: m                       !< rows and columns
    real(wp), intent(in) :: a(lead, m, m)          !< the matrices
    integer, intent(in) :: order(m)                !< of their pivots
    real(wp), intent(out) :: inverse(lead, m, m)   !< the inverses
    real(wp), intent(out) :: bounds(lead)          !< of the conditioning
    real(wp) :: scratch(lead, m, m)

    inverse = 0.0_wp
    scratch = 0.0_wp
    bounds = -1.0_wp
    call invert_in_order(n, lead, m, order, a, scratch, inverse)
    call bound_conditioning(n, lead, m, a, inverse, 0.0_wp, bounds)
  end subroutine invert

  !> Least singular value over the largest one.
  real(wp) function conditioning(a)
    real(wp), intent(in) :: a(:, :)   !< square
    real(wp) :: copy(size(a, 1), size(a, 1)), s(size(a, 1)), u(size(a, 1), size(a, 1)), vt(1, 1), work(10*size(a, 1))
    integer :: info

    copy = a
    ! without vectors LAPACK takes another way, which divides by zero on purpose
    call dgesvd('A', 'N', size(a, 1), size(a, 1), copy, size(a, 1), s, u, size(a, 1), vt, 1, work, size(work), info)
    if (info /= 0) error stop 'singular values did not converge'
    conditioning = s(size(s))/s(1)
  end function conditioning

  !> Matrices of neighbouring positions: an accepted inverse times its matrix is the unit matrix, and the bound of the conditioning is
  !> right. The lengths of rows and columns together are at most the root of their number times a singular value.
  subroutine near_each_other(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), allocatable :: a(:, :, :), inverse(:, :, :)
    real(quad), allocatable :: rest(:, :)
    real(wp) :: bounds(lead), worst, ratio
    integer, allocatable :: order(:)
    integer :: m, i, j, trial, accepted
    logical :: right

    worst = 0.0_wp
    right = .true.
    accepted = 0
    do m = 1, most_rows
      do trial = 1, 20
        allocate (a(lead, m, m), inverse(lead, m, m), order(m))
        a(1, :, :) = random_matrix(random, m, m)
        do i = 2, lead
          a(i, :, :) = a(i - 1, :, :) + 0.05_wp*random_matrix(random, m, m)
        end do
        call find_pivot_order(m, a(1, :, :), order)
        call invert(lead, m, a, order, inverse, bounds)
        do i = 1, lead
          if (.not. bounds(i) > 0.0_wp) cycle
          accepted = accepted + 1
          rest = matmul(real(a(i, :, :), quad), real(inverse(i, :, :), quad))
          do j = 1, m
            rest(j, j) = rest(j, j) - 1.0_quad
          end do
          worst = max(worst, real(maxval(abs(rest)), wp))
          ratio = conditioning(a(i, :, :))
          right = right .and. bounds(i) <= ratio*(1.0_wp + 1e-9_wp) .and. bounds(i) >= 0.99_wp*ratio/m
        end do
        deallocate (a, inverse, order)
      end do
    end do
    ! judged in double precision with the same limit of 1e-13, to which round-off adds less than half
    call test%near(worst, 0.0_wp, 1.5e-13_wp, 'matrix times inverse is one')
    call test%is_true(right, 'bounds are not above the ratio of singular values, and not far below it')
    call test%is_true(2*accepted > 20*most_rows*lead, 'most matrices that resemble each other are inverted')
  end subroutine near_each_other

  !> An inverse does not depend on the matrices beside it.
  subroutine one_by_one(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer, parameter :: m = 6
    real(wp) :: a(lead, m, m), alone(lead, m, m), inverse(lead, m, m), own(lead, m, m), bounds(lead), own_bounds(lead)
    integer :: order(m), i
    logical :: same

    do i = 1, lead
      a(i, :, :) = random_matrix(random, m, m)
    end do
    call find_pivot_order(m, a(1, :, :), order)
    call invert(lead, m, a, order, inverse, bounds)
    same = .true.
    alone = 0.0_wp
    do i = 1, lead
      alone(1, :, :) = a(i, :, :)
      call invert(1, m, alone, order, own, own_bounds)
      same = same .and. all(abs(own(1, :, :) - inverse(i, :, :)) <= 0.0_wp) .and. abs(own_bounds(1) - bounds(i)) <= 0.0_wp
    end do
    call test%is_true(same, 'matrices beside it do not change an inverse')
  end subroutine one_by_one

  !> A matrix whose pivots stand elsewhere is not accepted, and is with its own pivots.
  subroutine other_pivots(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: m = 4
    real(wp) :: a(lead, m, m), inverse(lead, m, m), bounds(lead)
    integer :: order(m), i

    a = 0.0_wp
    do i = 1, m
      a(1, i, i) = 1.0_wp
      a(2, i, m + 1 - i) = 1.0_wp
    end do
    call find_pivot_order(m, a(1, :, :), order)
    call invert(2, m, a, order, inverse, bounds)
    call test%near(bounds(1), 0.25_wp, epsilon(1.0_wp), 'the unit matrix of four rows: lengths of two and two')
    call test%near(bounds(2), 0.0_wp, 0.0_wp, 'a matrix with zeros in the places of the pivots')
    call find_pivot_order(m, a(2, :, :), order)
    call invert(2, m, a, order, inverse, bounds)
    call test%near(bounds(2), 0.25_wp, epsilon(1.0_wp), 'the same matrix with its own pivots')
  end subroutine other_pivots

  !> Singular matrices are never accepted, and their numbers do not overflow.
  subroutine singular(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), allocatable :: a(:, :, :), inverse(:, :, :)
    real(wp) :: bounds(lead), largest
    integer, allocatable :: order(:)
    integer :: m, i

    largest = 0.0_wp
    do m = 2, most_rows
      allocate (a(lead, m, m), inverse(lead, m, m), order(m))
      do i = 1, lead
        a(i, :, :) = random_matrix(random, m, m)
      end do
      call find_pivot_order(m, a(1, :, :), order)
      a(2, :, :) = 0.0_wp
      a(3, :, 1) = 0.0_wp
      a(4, 2, :) = a(4, 1, :)
      a(5, :, m) = 2.0_wp*a(5, :, 1)
      do i = 1, m
        a(6, i, :) = 1.0_wp
      end do
      call invert(6, m, a, order, inverse, bounds)
      largest = max(largest, maxval(bounds(2:6)))
      deallocate (a, inverse, order)
    end do
    ! round-off may leave a row that another one equals a part of 1e-16 of it
    call test%near(largest, 0.0_wp, 1e-14_wp, 'singular matrices have no conditioning')
  end subroutine singular
end module test_several_inverses
