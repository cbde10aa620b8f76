!> A coupling by a table of a sine over a turn gives the sine and its derivatives, also turns before and after the table, and the
!> gain of gears that are not round.
program test_table_coupling
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_table_coupling, only: table_coupling_type, new_table_coupling
  use mech9_testing, only: tester_type
  implicit none
  integer, parameter :: n = 121
  !> A quintic spline over steps h misses the sine by h^6 (B6(t) - B6(0))/6!, with the Bernoulli polynomials B, and derivative k by
  !> h^(6-k) B_(6-k)(t)/(6-k)!. For h = 3 degrees the largest values are 1.4e-12, 8.1e-11, 1.05e-8, 1.15e-6; the next terms are
  !> a hundred times smaller.
  real(wp), parameter :: error(0:3) = [1.5e-12_wp, 8.5e-11_wp, 1.1e-8_wp, 1.2e-6_wp]
  type(tester_type) :: test

  call derivatives(0.0_wp)
  call derivatives(-2.0_wp)
  call repeated_points()
  call test%finish()

contains

  !> The function a sin x + gain x and its derivatives between the points, over several turns.
  subroutine derivatives(gain)
    real(wp), intent(in) :: gain   !< change of the second coordinate per rad of the first one
    real(wp), parameter :: first = 0.4_wp
    type(table_coupling_type) :: coupling
    type(error_type), allocatable :: err
    real(wp) :: x(n), q, expected(0:3)
    integer :: i, order

    x = [(first + 2.0_wp*pi*i/(n - 1), i=0, n - 1)]
    call new_table_coupling(x, sin(x) + gain*x, gain, coupling, err)
    call test%no_error(err, 'the table of a sine is accepted')
    if (allocated(err)) return
    do i = -40, 40
      q = 0.391_wp*i
      expected = [sin(q) + gain*q, cos(q) + gain, -sin(q), -cos(q)]
      do order = 0, 3
        call test%near(-coupling%term(1, q, order), expected(order), error(order), 'the function and its derivatives')
      end do
    end do
    expected = [0.7_wp, 1.0_wp, 0.0_wp, 0.0_wp]
    do order = 0, 3
      call test%near(coupling%term(2, 0.7_wp, order), expected(order), 0.0_wp, 'the second coordinate and its derivatives')
    end do
    call test%near(coupling%weight([1.0_wp, 0.1_wp]), 1.0_wp/(1.0_wp + abs(gain)), 1.0e-3_wp, &
                   'the weight makes the greatest derivative one; the steepest place may lie between points')
    call test%is_true(.not. coupling%is_linear(), 'its slope is not constant')
  end subroutine derivatives

  !> Points of one place have no spline.
  subroutine repeated_points()
    type(table_coupling_type) :: coupling
    type(error_type), allocatable :: err
    real(wp) :: x(6)

    x = [0.0_wp, 1.0_wp, 1.0_wp, 3.0_wp, 5.0_wp, 2.0_wp*pi]
    call new_table_coupling(x, 0.0_wp*x, 0.0_wp, coupling, err)
    call test%is_true(allocated(err), 'points of one place are refused')
  end subroutine repeated_points
end program test_table_coupling
