!> User couplings for the tests, in plain real numbers; couplings_taylor.f90 holds the same in Taylor arithmetic.
submodule (mech9_user_coupling_values) test_couplings_values
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none

contains

  module subroutine user_coupling_values(coupling, first, parameters, second)
    integer, intent(in) :: coupling         !< selects the function
    real(wp), intent(in) :: first           !< the first coordinate
    real(wp), intent(in) :: parameters(:)   !< of the function
    real(wp), intent(out) :: second         !< the second coordinate

    select case (coupling)
    case (1)
      second = parameters(1)*first + parameters(2)*sin(parameters(3)*first)
    case default
      second = ieee_value(1.0_wp, ieee_quiet_nan)
      if (first < 1.0_wp) second = sqrt(1.0_wp - first)
    end select
  end subroutine user_coupling_values
end submodule test_couplings_values
