!> The default procedure, which answers where no user's pair in plain real numbers is linked.
submodule (mech9_user_pair_values) mech9_user_pair_values_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_pair_values(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate       !< unused
    real(wp), intent(in) :: q               !< unused
    real(wp), intent(in) :: parameters(:)   !< unused
    real(wp), intent(out) :: r1(3)          !< the sign that no procedure is linked
    real(wp), intent(out) :: r2(3)          !< the same sign
    real(wp), intent(out) :: r3(3)          !< the same sign

    r1 = not_linked
    r2 = not_linked
    r3 = not_linked
  end subroutine user_pair_values
end submodule mech9_user_pair_values_default
