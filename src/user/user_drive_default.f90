!> The default procedure, which answers where no user's drive in Taylor arithmetic is linked.
submodule (mech9_user_drive) mech9_user_drive_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_drive(coordinate, t, parameters, q)
    integer, intent(in) :: coordinate       !< unused
    type(taylor), intent(in) :: t           !< unused
    real(wp), intent(in) :: parameters(:)   !< unused
    type(taylor), intent(out) :: q          !< the sign that no procedure is linked

    q = constant(not_linked)
  end subroutine user_drive
end submodule mech9_user_drive_default
