!> The drive of cycloidal_drive.f90 in plain real numbers: the same formula, and the program finds
!> its derivatives.
submodule (mech9_user_drive_values) cycloidal_drive_values
  implicit none

contains

  module subroutine user_drive_values(coordinate, t, parameters, q)
    integer, intent(in) :: coordinate       !< number of the driven coordinate, which tells drives apart
    real(wp), intent(in) :: t               !< time [s]
    real(wp), intent(in) :: parameters(:)   !< rise [rad or m], duration [s]
    real(wp), intent(out) :: q              !< value of the coordinate [rad or m]
    real(wp) :: share, turn

    turn = 8.0_wp*atan(1.0_wp)
    share = t/parameters(2)
    q = parameters(1)*(share - sin(turn*share)/turn)
  end subroutine user_drive_values
end submodule cycloidal_drive_values
