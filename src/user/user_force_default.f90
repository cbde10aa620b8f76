!> What answers where no user's forces are linked.
submodule (mech9_user_force) mech9_user_force_default
  implicit none

contains

  module subroutine user_force(t, state, parameters, loads)
    real(wp), intent(in) :: t
    type(motion_view_type), intent(in) :: state
    real(wp), intent(in) :: parameters(:)
    type(force_sum_type), intent(inout) :: loads

    loads%unanswered = .true.
  end subroutine user_force
end submodule mech9_user_force_default
