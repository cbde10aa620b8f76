!> The hook for the user's own coupling, in plain real numbers; the program differentiates it.
!>
!> Write a submodule of this module that holds `user_coupling_values`, and link it: see
!> docs/how-to/user-procedures.md.
module mech9_user_coupling_values
  use mech9_kinds, only: wp
  implicit none
  private
  public :: user_coupling_values

  interface
    !> The second coordinate of a coupling as a function of the first one, in which it must be smooth.
    module subroutine user_coupling_values(coupling, first, parameters, second)
      integer, intent(in) :: coupling               !< number of the coupling in the data file, tells couplings apart
      real(wp), intent(in) :: first                 !< the first coordinate [rad, m]
      real(wp), intent(in) :: parameters(:)         !< from the group &user; empty when there is none
      real(wp), intent(out) :: second               !< the second coordinate [rad, m]
    end subroutine user_coupling_values
  end interface
end module mech9_user_coupling_values
