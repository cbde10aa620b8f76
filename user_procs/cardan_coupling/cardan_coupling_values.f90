!> A universal joint as a coupling of the angles of its two shafts, in plain real numbers; the program differentiates it.
submodule (mech9_user_coupling_values) cardan_coupling_values
  implicit none

contains

  module subroutine user_coupling_values(coupling, first, parameters, second)
    integer, intent(in) :: coupling         !< number of the coupling, which tells couplings apart
    real(wp), intent(in) :: first           !< angle of the first shaft [rad]
    real(wp), intent(in) :: parameters(:)   !< the angle between the shafts [rad]
    real(wp), intent(out) :: second         !< angle of the second shaft [rad]

    ! tan(second) = tan(first)/cos(parameters(1)); this form has no jumps at right angles
    second = first + atan2((1.0_wp - cos(parameters(1)))*sin(first)*cos(first), &
                           sin(first)**2 + cos(parameters(1))*cos(first)**2)
  end subroutine user_coupling_values
end submodule cardan_coupling_values
