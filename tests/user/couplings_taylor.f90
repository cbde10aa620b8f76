!> User couplings for the tests, in Taylor arithmetic; couplings_values.f90 holds the same in plain real numbers.
submodule (mech9_user_coupling) test_couplings
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none

contains

  module subroutine user_coupling(coupling, first, parameters, second)
    integer, intent(in) :: coupling         !< selects the function
    type(taylor), intent(in) :: first       !< the first coordinate
    real(wp), intent(in) :: parameters(:)   !< of the function
    type(taylor), intent(out) :: second     !< the second coordinate

    select case (coupling)
    case (1)   ! a wave of parameters: p1 q + p2 sin(p3 q)
      second = parameters(1)*first + parameters(2)*sin(parameters(3)*first)
    case default   ! ends at 1
      second = constant(ieee_value(1.0_wp, ieee_quiet_nan))
      if (first < 1.0_wp) second = sqrt(1.0_wp - first)
    end select
  end subroutine user_coupling
end submodule test_couplings
