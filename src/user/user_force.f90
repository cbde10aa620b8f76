!> The hook for the user's own forces.
!>
!> Write a submodule of this module that holds `user_force`, and link it: see docs/how-to/user-procedures.md.
module mech9_user_force
  use mech9_kinds, only: wp
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  implicit none
  private
  public :: user_force

  interface
    !> Forces, torques and generalized forces at a time and state. Read positions and velocities of
    !> points by `state%position(link, point)` and `state%velocity(link, point)`, directions by
    !> `state%turned(link, vector)`, coordinates in `state%q` and `state%dq`. Add forces by
    !> `call loads%add_force(state, link, point, force)`, `call loads%add_torque(link, torque)` and
    !> `call loads%add_generalized(coordinate, value)`. Lengths are in m, angles in rad, and vectors in fixed axes.
    module subroutine user_force(t, state, parameters, loads)
      real(wp), intent(in) :: t                      !< time [s]
      type(motion_view_type), intent(in) :: state    !< links and coordinates
      real(wp), intent(in) :: parameters(:)          !< from the group &user; empty when there is none
      type(force_sum_type), intent(inout) :: loads   !< sums to which forces are added
    end subroutine user_force
  end interface
end module mech9_user_force
