!> The hook for the user's own pair, in plain real numbers; the program differentiates it.
!>
!> Write a submodule of this module that holds `user_pair_values`, and link it: see
!> docs/how-to/user-procedures.md.
module mech9_user_pair_values
  use mech9_kinds, only: wp
  implicit none
  private
  public :: user_pair_values

  interface
    !> The three characteristic points of the moving link in the reference link. It must be smooth in q.
    module subroutine user_pair_values(coordinate, q, parameters, r1, r2, r3)
      integer, intent(in) :: coordinate             !< number of the coordinate, tells pairs apart
      real(wp), intent(in) :: q                     !< the coordinate
      real(wp), intent(in) :: parameters(:)         !< from the group &user; empty when there is none
      real(wp), intent(out) :: r1(3)                !< origin of the moving link [m]
      real(wp), intent(out) :: r2(3)                !< a point on its x axis [m]
      real(wp), intent(out) :: r3(3)                !< a third point, not in line: y is along (R2-R1) x (R3-R1)
    end subroutine user_pair_values
  end interface
end module mech9_user_pair_values
