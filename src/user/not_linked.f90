!> The number that the default procedures of the hooks return, so that a missing user's procedure is noticed.
module mech9_not_linked
  use mech9_kinds, only: wp
  implicit none
  private
  public :: not_linked

  !> No procedure of a user gives this number on purpose.
  real(wp), parameter :: not_linked = -huge(1.0_wp)
end module mech9_not_linked
