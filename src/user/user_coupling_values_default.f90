!> The default procedure, which answers where no user's coupling in plain real numbers is linked.
submodule (mech9_user_coupling_values) mech9_user_coupling_values_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_coupling_values(coupling, first, parameters, second)
    integer, intent(in) :: coupling         !< unused
    real(wp), intent(in) :: first           !< unused
    real(wp), intent(in) :: parameters(:)   !< unused
    real(wp), intent(out) :: second         !< the sign that no procedure is linked

    second = not_linked
  end subroutine user_coupling_values
end submodule mech9_user_coupling_values_default
