!> A drive that rises and comes to rest without a jump in acceleration: the cycloidal motion
!> q = h (t/T - sin(2 pi t/T)/(2 pi)) for 0 <= t <= T.
!>
!> The parameters are the rise h [rad or m] and the duration T [s].
submodule (mech9_user_drive) cycloidal_drive
  implicit none

contains

  module subroutine user_drive(coordinate, t, parameters, q)
    integer, intent(in) :: coordinate       !< number of the driven coordinate, which tells drives apart
    type(taylor), intent(in) :: t           !< time [s]
    real(wp), intent(in) :: parameters(:)   !< rise [rad or m], duration [s]
    type(taylor), intent(out) :: q          !< value of the coordinate [rad or m]
    type(taylor) :: share
    real(wp) :: turn

    turn = 8.0_wp*atan(1.0_wp)
    share = t/parameters(2)
    q = parameters(1)*(share - sin(turn*share)/turn)
  end subroutine user_drive
end submodule cycloidal_drive
