!> The hook for the user's own drive, in plain real numbers; the program differentiates it.
!>
!> Write a submodule of this module that holds `user_drive_values`, and link it: see
!> docs/how-to/user-procedures.md.
module mech9_user_drive_values
  use mech9_kinds, only: wp
  implicit none
  private
  public :: user_drive_values

  interface
    !> An independent coordinate as a function of time. It must be smooth in t.
    module subroutine user_drive_values(coordinate, t, parameters, q)
      integer, intent(in) :: coordinate             !< number of the coordinate, tells drives apart
      real(wp), intent(in) :: t                     !< time [s]
      real(wp), intent(in) :: parameters(:)         !< from the group &user; empty when there is none
      real(wp), intent(out) :: q                    !< the coordinate [rad, m]
    end subroutine user_drive_values
  end interface
end module mech9_user_drive_values
