!> Template of forces of your own. Copy it, rename the submodule, fill in your forces. As it stands it is a
!> constant force parameters(1) along x on the origin of link 2.
submodule (mech9_user_force) user_force_template
  implicit none

contains

  module subroutine user_force(t, state, parameters, loads)
    real(wp), intent(in) :: t                      !< time [s]
    type(motion_view_type), intent(in) :: state    !< motion of links and coordinates: see docs/how-to/user-procedures.md
    real(wp), intent(in) :: parameters(:)          !< the numbers of &user parameters = ... /
    type(force_sum_type), intent(inout) :: loads   !< forces and torques are added to it
    real(wp), parameter :: origin(3) = 0.0_wp

    call loads%add_force(state, 2, origin, [parameters(1), 0.0_wp, 0.0_wp])
  end subroutine user_force
end submodule user_force_template
