!> User drives for the tests, in plain real numbers; drives_taylor.f90 holds the same in Taylor arithmetic.
submodule (mech9_user_drive_values) test_drives_values
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none

contains

  module subroutine user_drive_values(coordinate, t, parameters, q)
    integer, intent(in) :: coordinate       !< selects the function
    real(wp), intent(in) :: t               !< time [s]
    real(wp), intent(in) :: parameters(:)   !< of the function
    real(wp), intent(out) :: q              !< value of the coordinate

    select case (coordinate)
    case (1)
      q = parameters(1)*t + parameters(2)*sin(parameters(3)*t)
    case (2)
      q = ieee_value(1.0_wp, ieee_quiet_nan)
      if (t < 1.0_wp) q = sqrt(1.0_wp - t)
    case default
      q = exp(-t)/(1.0_wp + t**2)
    end select
  end subroutine user_drive_values
end submodule test_drives_values
