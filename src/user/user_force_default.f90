!> The default procedure, which answers where no user's forces are linked.
submodule (mech9_user_force) mech9_user_force_default
  implicit none

contains

  module subroutine user_force(t, state, parameters, loads)
    real(wp), intent(in) :: t                      !< unused
    type(motion_view_type), intent(in) :: state    !< unused
    real(wp), intent(in) :: parameters(:)          !< unused
    type(force_sum_type), intent(inout) :: loads   !< gets the sign that no procedure is linked

    loads%unanswered = .true.
  end subroutine user_force
end submodule mech9_user_force_default
