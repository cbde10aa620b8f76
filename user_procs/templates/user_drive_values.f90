!> Template of a drive of your own, in plain real numbers; the program differentiates it. As it stands
!> it makes a turn in parameters(1) seconds.
submodule (mech9_user_drive_values) user_drive_values_template
  implicit none

contains

  module subroutine user_drive_values(coordinate, t, parameters, q)
    integer, intent(in) :: coordinate       !< number of the driven coordinate, which tells drives apart
    real(wp), intent(in) :: t               !< time [s]
    real(wp), intent(in) :: parameters(:)   !< the numbers of &user parameters = ... /
    real(wp), intent(out) :: q              !< value of the coordinate [rad or m]

    q = 8.0_wp*atan(1.0_wp)*t/parameters(1)
  end subroutine user_drive_values
end submodule user_drive_values_template
