!> The hook for the user's own drive, in Taylor arithmetic.
!>
!> Write a submodule of this module that holds `user_drive`, and link it: see docs/how-to/user-procedures.md.
!> All of Taylor arithmetic is known there without a further `use`.
module mech9_user_drive
  use mech9_kinds, only: wp
  use mech9_taylor
  implicit none
  private
  public :: user_drive

  interface
    !> An independent coordinate as a function of time.
    module subroutine user_drive(coordinate, t, parameters, q)
      integer, intent(in) :: coordinate             !< number of the coordinate, tells drives apart
      type(taylor), intent(in) :: t                 !< time [s]
      real(wp), intent(in) :: parameters(:)         !< from the group &user; empty when there is none
      type(taylor), intent(out) :: q                !< the coordinate [rad, m]
    end subroutine user_drive
  end interface
end module mech9_user_drive
