!> The least singular value by inverse iteration against LAPACK's, for all shapes and sizes of it.
module test_least_singular_value
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_matrix
  use mech9_least_squares, only: least_squares_type
  use mech9_lapack, only: dgesvd
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('all_shapes')) call all_shapes(test)
    if (test%runs('equal_values')) call equal_values(test)
    if (test%runs('special_matrices')) call special_matrices(test)
  end subroutine run

  subroutine all_shapes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: trial
    type(random_type) :: random

    do trial = 1, 30
      call compare(test, random, 3, 3, trial)
      call compare(test, random, 6, 3, trial)
      call compare(test, random, 12, 11, trial)
      call compare(test, random, 40, 36, trial)
    end do
  end subroutine all_shapes

  subroutine special_matrices(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(least_squares_type) :: equations

    call equations%create(4, 0)
    call equations%factorize()
    call test%is_true(equations%least_singular_value() > 1.0_wp, 'a matrix without columns is not singular')
    call equations%create(3, 2)
    equations%a = reshape([1.0_wp, 2.0_wp, 3.0_wp, 2.0_wp, 4.0_wp, 6.0_wp], [3, 2])
    call equations%factorize()
    call test%near(equations%least_singular_value(), 0.0_wp, 1.0e-15_wp, 'two equal columns have a least singular value of zero')
  end subroutine special_matrices

  !> A random matrix whose last column is nearer and nearer to the sum of the others.
  subroutine compare(test, random, m, n, trial)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: m                     !< rows
    integer, intent(in) :: n                     !< columns
    integer, intent(in) :: trial                 !< number of the matrix; the larger, the nearer to singular
    real(wp) :: a(m, n), s(n), u(m, m), vt(1, 1), work(20*(m + n)), small
    type(least_squares_type) :: equations
    integer :: info

    a = random_matrix(random, m, n)
    small = 10.0_wp**(-0.3_wp*trial)
    a(:, n) = small*a(:, n) + (1.0_wp - small)*sum(a(:, :n - 1), dim=2)
    call equations%create(m, n)
    equations%a = a
    call equations%factorize()
    ! without vectors LAPACK takes another way, which divides by zero on purpose
    call dgesvd('A', 'N', m, n, a, m, s, u, m, vt, 1, work, size(work), info)
    call test%is_true(info == 0, 'the singular values of LAPACK converge')
    ! both are exact to round-off of the largest one; values close together slow the iteration down, which
    ! then ends within 1e-10 of the least
    call test%near(equations%least_singular_value()/s(n), 1.0_wp, 1.0e-10_wp + 1.0e-14_wp*s(1)/s(n), &
                   'the least singular value is that of LAPACK')
  end subroutine compare

  !> An orthogonal matrix: all of them are one.
  subroutine equal_values(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(least_squares_type) :: equations
    real(wp), parameter :: c = 0.6_wp, s = 0.8_wp

    call equations%create(3, 3)
    equations%a = reshape([c, s, 0.0_wp, -s, c, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    call equations%factorize()
    call test%near(equations%least_singular_value(), 1.0_wp, 1.0e-14_wp, 'the least singular value of an orthogonal matrix is one')
  end subroutine equal_values
end module test_least_singular_value
