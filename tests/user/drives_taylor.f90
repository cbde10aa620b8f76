!> User drives for the tests, in Taylor arithmetic; drives_values.f90 holds the same in plain real numbers.
submodule (mech9_user_drive) test_drives
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none

contains

  module subroutine user_drive(coordinate, t, parameters, q)
    integer, intent(in) :: coordinate       !< selects the function
    type(taylor), intent(in) :: t           !< time [s]
    real(wp), intent(in) :: parameters(:)   !< of the function
    type(taylor), intent(out) :: q          !< value of the coordinate

    select case (coordinate)
    case (1)   ! a curve of parameters: p1 t + p2 sin(p3 t)
      q = parameters(1)*t + parameters(2)*sin(parameters(3)*t)
    case (2)   ! ends at t = 1
      q = constant(ieee_value(1.0_wp, ieee_quiet_nan))
      if (t < 1.0_wp) q = sqrt(1.0_wp - t)
    case default
      q = exp(-t)/(1.0_wp + t**2)
    end select
  end subroutine user_drive
end submodule test_drives
