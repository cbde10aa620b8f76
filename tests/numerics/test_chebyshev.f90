!> Polynomials at Chebyshev's points: integrals and derivatives of those that they hold exactly, and zeros.
module test_chebyshev
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type, new_chebyshev
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('powers')) call powers(tester)
    if (tester%runs('zero')) call zero(tester)
  end subroutine run

  !> Powers that the points determine.
  subroutine powers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(chebyshev_type) :: rule
    integer :: n, power
    real(wp) :: x

    do n = 2, 12
      call new_chebyshev(n, rule)
      do power = 0, n - 1
        x = 0.37_wp
        ! round-off grows with the derivatives of the polynomial, some (n - 1)**2
        call tester%near(dot_product(rule%weights, rule%points**power), merge(2.0_wp/(power + 1), 0.0_wp, mod(power, 2) == 0), &
                         1e-15_wp*n, 'the integral of a power is exact')
        call tester%near(rule%value_at(rule%points**power, x), x**power, 1e-14_wp, 'so is its value between the points')
        call tester%near(rule%value_at(rule%points**power, rule%points(2)), rule%points(2)**power, 0.0_wp, 'and that at a point')
        if (power == 0) cycle
        call tester%near(maxval(abs(matmul(rule%derivative, rule%points**power) - power*rule%points**(power - 1))), 0.0_wp, &
                         1e-15_wp*n**3, 'and its derivative at the points')
      end do
    end do
  end subroutine powers

  !> The zero of cos(x + 1) is at pi/2 - 1, to the degree of the polynomial through twelve points.
  subroutine zero(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(chebyshev_type) :: rule
    integer :: n

    call new_chebyshev(12, rule)
    n = count(cos(rule%points + 1.0_wp) > 0.0_wp)
    call tester%near(rule%zero_between(cos(rule%points + 1.0_wp), n), 2.0_wp*atan(1.0_wp) - 1.0_wp, 1e-12_wp, 'a zero is found')
  end subroutine zero
end module test_chebyshev
