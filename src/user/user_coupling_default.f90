!> The default procedure, which answers where no user's coupling in Taylor arithmetic is linked.
submodule (mech9_user_coupling) mech9_user_coupling_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_coupling(coupling, first, parameters, second)
    integer, intent(in) :: coupling         !< unused
    type(taylor), intent(in) :: first       !< unused
    real(wp), intent(in) :: parameters(:)   !< unused
    type(taylor), intent(out) :: second     !< the sign that no procedure is linked

    second = constant(not_linked)
  end subroutine user_coupling
end submodule mech9_user_coupling_default
