!> The default procedure, which answers where no user's drive in plain real numbers is linked.
submodule (mech9_user_drive_values) mech9_user_drive_values_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_drive_values(coordinate, t, parameters, q)
    integer, intent(in) :: coordinate       !< unused
    real(wp), intent(in) :: t               !< unused
    real(wp), intent(in) :: parameters(:)   !< unused
    real(wp), intent(out) :: q              !< the sign that no procedure is linked

    q = not_linked
  end subroutine user_drive_values
end submodule mech9_user_drive_values_default
