!> The default procedure, which answers where no user's pair in Taylor arithmetic is linked.
submodule (mech9_user_pair) mech9_user_pair_default
  use mech9_not_linked, only: not_linked
  implicit none

contains

  module subroutine user_pair(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate       !< unused
    type(taylor), intent(in) :: q           !< unused
    real(wp), intent(in) :: parameters(:)   !< unused
    type(taylor), intent(out) :: r1(3)      !< the sign that no procedure is linked
    type(taylor), intent(out) :: r2(3)      !< the same sign
    type(taylor), intent(out) :: r3(3)      !< the same sign

    r1 = constant(not_linked)
    r2 = constant(not_linked)
    r3 = constant(not_linked)
  end subroutine user_pair
end submodule mech9_user_pair_default
