!> The hook for the user's own pair, in Taylor arithmetic.
!>
!> Write a submodule of this module that holds `user_pair`, and link it: see docs/how-to/user-procedures.md.
!> All of Taylor arithmetic is known there without a further `use`.
module mech9_user_pair
  use mech9_kinds, only: wp
  use mech9_taylor
  implicit none
  private
  public :: user_pair

  interface
    !> The three characteristic points of the moving link in the reference link, as functions of q.
    module subroutine user_pair(coordinate, q, parameters, r1, r2, r3)
      integer, intent(in) :: coordinate             !< number of the coordinate, tells pairs apart
      type(taylor), intent(in) :: q                 !< the coordinate
      real(wp), intent(in) :: parameters(:)         !< from the group &user; empty when there is none
      type(taylor), intent(out) :: r1(3)            !< origin of the moving link [m]
      type(taylor), intent(out) :: r2(3)            !< a point on its x axis [m]
      type(taylor), intent(out) :: r3(3)            !< a third point, not in line: y is along (R2-R1) x (R3-R1)
    end subroutine user_pair
  end interface
end module mech9_user_pair
