!> Template of a coupling of your own, in plain real numbers; the program differentiates it. As it stands
!> the second coordinate is parameters(1) times the sine of the first one.
submodule (mech9_user_coupling_values) user_coupling_values_template
  implicit none

contains

  module subroutine user_coupling_values(coupling, first, parameters, second)
    integer, intent(in) :: coupling         !< number of the coupling, which tells couplings apart
    real(wp), intent(in) :: first           !< the first of its coordinates [rad or m]
    real(wp), intent(in) :: parameters(:)   !< the numbers of &user parameters = ... /
    real(wp), intent(out) :: second         !< the second of its coordinates [rad or m]

    second = parameters(1)*sin(first)
  end subroutine user_coupling_values
end submodule user_coupling_values_template
