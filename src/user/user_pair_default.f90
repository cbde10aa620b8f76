!> What answers where no user's pair in Taylor arithmetic is linked.
submodule (mech9_user_pair) mech9_user_pair_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_pair(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate
    type(taylor), intent(in) :: q
    real(wp), intent(in) :: parameters(:)
    type(taylor), intent(out) :: r1(3), r2(3), r3(3)

    r1 = constant(not_linked)
    r2 = constant(not_linked)
    r3 = constant(not_linked)
  end subroutine user_pair
end submodule mech9_user_pair_default
