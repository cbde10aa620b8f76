!> A user's force that has a value up to a time only, parameters(1); after it, not a number. After a second time,
!> parameters(2) where it is given, it does not come back.
submodule (mech9_user_force) failing_force
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none

contains

  module subroutine user_force(t, state, parameters, loads)
    real(wp), intent(in) :: t                      !< time [s]
    type(motion_view_type), intent(in) :: state    !< motion of links and coordinates
    real(wp), intent(in) :: parameters(:)          !< of &user
    type(force_sum_type), intent(inout) :: loads   !< forces and torques are added to it
    real(wp) :: force

    force = 1.0_wp
    if (t > parameters(1)) force = ieee_value(force, ieee_quiet_nan)
    call loads%add_generalized(1, force)
    if (size(parameters) == 1) return
    do while (t > parameters(2))
      call cpu_time(force)
    end do
  end subroutine user_force
end submodule failing_force
