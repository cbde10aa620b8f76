!> What answers where no user's pair in plain real numbers is linked.
submodule (mech9_user_pair_values) mech9_user_pair_values_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_pair_values(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate
    real(wp), intent(in) :: q
    real(wp), intent(in) :: parameters(:)
    real(wp), intent(out) :: r1(3), r2(3), r3(3)

    r1 = not_linked
    r2 = not_linked
    r3 = not_linked
  end subroutine user_pair_values
end submodule mech9_user_pair_values_default
