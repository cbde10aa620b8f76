!> The hook for the user's own coupling, in Taylor arithmetic.
!>
!> Write a submodule of this module that holds `user_coupling`, and link it: see docs/how-to/user-procedures.md.
!> All of Taylor arithmetic is known there without a further `use`.
module mech9_user_coupling
  use mech9_kinds, only: wp
  use mech9_taylor
  implicit none
  private
  public :: user_coupling

  interface
    !> The second coordinate of a coupling as a function of the first one.
    module subroutine user_coupling(coupling, first, parameters, second)
      integer, intent(in) :: coupling               !< number of the coupling in the data file, tells couplings apart
      type(taylor), intent(in) :: first             !< the first coordinate [rad, m]
      real(wp), intent(in) :: parameters(:)         !< from the group &user; empty when there is none
      type(taylor), intent(out) :: second           !< the second coordinate [rad, m]
    end subroutine user_coupling
  end interface
end module mech9_user_coupling
