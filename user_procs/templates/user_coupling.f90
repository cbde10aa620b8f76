!> Template of a coupling of your own, in Taylor arithmetic. As it stands
!> the second coordinate is parameters(1) times the sine of the first one.
submodule (mech9_user_coupling) user_coupling_template
  implicit none

contains

  module subroutine user_coupling(coupling, first, parameters, second)
    integer, intent(in) :: coupling         !< number of the coupling, which tells couplings apart
    type(taylor), intent(in) :: first       !< the first of its coordinates [rad or m]
    real(wp), intent(in) :: parameters(:)   !< the numbers of &user parameters = ... /
    type(taylor), intent(out) :: second     !< the second of its coordinates [rad or m]

    second = parameters(1)*sin(first)
  end subroutine user_coupling
end submodule user_coupling_template
