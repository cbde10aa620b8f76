!> A coupling by a table of a sine over a turn gives the sine and its derivatives, also turns before and after the table, and the
!> gain of gears that are not round.
module test_table_coupling
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_singular
  use mech9_table_coupling, only: table_coupling_type, new_table_coupling, new_turning_table
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: n = 121
  !> A quintic spline over steps h misses the sine by h^6 (B6(t) - B6(0))/6!, with the Bernoulli polynomials B, and derivative k by
  !> h^(6-k) B_(6-k)(t)/(6-k)!. For h = 3 degrees the largest values are 1.4e-12, 8.1e-11, 1.05e-8, 1.15e-6; the next terms are
  !> a hundred times smaller.
  real(wp), parameter :: error(0:3) = [1.5e-12_wp, 8.5e-11_wp, 1.1e-8_wp, 1.2e-6_wp]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('derivatives')) call derivatives(test, 0.0_wp)
    if (test%runs('derivatives_from_other_turn')) call derivatives(test, -2.0_wp)
    if (test%runs('with_ends')) call with_ends(test)
    if (test%runs('repeated_points')) call repeated_points(test)
  end subroutine run

  !> The function a sin x + gain x and its derivatives between the points, over several turns.
  subroutine derivatives(test, gain)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: gain               !< change of the second coordinate per rad of the first one
    real(wp), parameter :: first = 0.4_wp
    type(table_coupling_type) :: coupling
    type(error_type), allocatable :: err
    real(wp) :: x(n), q, expected(0:3), found(0:3)
    integer :: i, order

    x = [(first + 2.0_wp*pi*i/(n - 1), i=0, n - 1)]
    call new_turning_table(x, sin(x) + gain*x, gain, coupling, err)
    call test%no_error(err, 'the table of a sine is accepted')
    if (allocated(err)) return
    do i = -40, 40
      q = 0.391_wp*i
      expected = [sin(q) + gain*q, cos(q) + gain, -sin(q), -cos(q)]
      call coupling%find_curve(q, found(0:2), err)
      call test%no_error(err, 'a table over a turn has no ends')
      call coupling%find_third(q, found(3), err)
      call test%no_error(err, 'nor has its third derivative')
      do order = 0, 3
        call test%near(found(order), expected(order), error(order), 'the function and its derivatives')
        if (order < 3) call test%near(coupling%term(1, q, found(0:2), order), -found(order), 0.0_wp, 'the first term')
      end do
    end do
    expected(0:2) = [0.7_wp, 1.0_wp, 0.0_wp]
    do order = 0, 2
      call test%near(coupling%term(2, 0.7_wp, found(0:2), order), expected(order), 0.0_wp, &
                     'the second coordinate and its derivatives')
    end do
    call test%near(coupling%weight([1.0_wp, 0.1_wp]), 1.0_wp/(1.0_wp + abs(gain)), 1.0e-3_wp, &
                   'the weight makes the greatest derivative one; the steepest place may lie between points')
    call test%is_true(.not. coupling%is_linear(), 'its slope is not constant')
  end subroutine derivatives

  !> A table over a slide: a polynomial of fifth degree is reproduced, and the coordinate ends with the table.
  subroutine with_ends(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(table_coupling_type) :: coupling
    type(error_type), allocatable :: err
    real(wp) :: x(9), q, found(0:3), expected(0:3), limits(2)
    integer :: i, order

    x = [(0.1_wp*i + 0.01_wp*i**2, i=0, 8)]
    call new_table_coupling(x, x**5 - 2.0_wp*x**2, coupling, err)
    call test%no_error(err, 'a table that does not repeat is accepted')
    limits = coupling%ends()
    call test%near(limits(1), 0.0_wp, 0.0_wp, 'it begins with its first point')
    call test%near(limits(2), x(9), 0.0_wp, 'it ends with its last point')
    do i = 0, 12
      q = 0.12_wp*i
      call coupling%find_curve(q, found(0:2), err)
      call test%no_error(err, 'it has values up to its ends')
      call coupling%find_third(q, found(3), err)
      expected = [q**5 - 2.0_wp*q**2, 5.0_wp*q**4 - 4.0_wp*q, 20.0_wp*q**3 - 4.0_wp, 60.0_wp*q**2]
      do order = 0, 3
        ! round-off grows by the factor 10 of the shortest step with each derivative
        call test%near(found(order), expected(order), 1.0e-13_wp*10.0_wp**(order + 1), 'a polynomial of fifth degree')
      end do
    end do
    coupling%coordinates = [1, 2]
    do i = -1, 1, 2
      call coupling%find_curve(0.72_wp + 0.73_wp*i, found(0:2), err)
      call test%has_error(err, exit_singular, 'beyond the ends it has no values')
    end do
  end subroutine with_ends

  !> Points of one place have no spline.
  subroutine repeated_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(table_coupling_type) :: coupling
    type(error_type), allocatable :: err
    real(wp) :: x(6)

    x = [0.0_wp, 1.0_wp, 1.0_wp, 3.0_wp, 5.0_wp, 2.0_wp*pi]
    call new_turning_table(x, 0.0_wp*x, 0.0_wp, coupling, err)
    call test%is_true(allocated(err), 'points of one place are refused')
  end subroutine repeated_points
end module test_table_coupling
