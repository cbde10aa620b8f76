!> A present motion in the arithmetic of its derivatives, where the run has its frames in another one, or not all of them.
module mech9_placed_motion
  use mech9_error, only: error_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: place_all, spread_all_velocities, spread_all_accelerations
  implicit none
  private
  public :: place_motion

contains

  !> Place all frames of a motion. Fails where a pair has no pose.
  subroutine place_motion(present, plan, state, err)
    type(state_type), intent(in) :: present               !< the motion, with all accelerations
    type(plan_type), intent(in) :: plan                   !< in the arithmetic of the derivatives
    type(state_type), intent(inout) :: state              !< of this plan; gets the motion
    type(error_type), allocatable, intent(out) :: err     !< allocated if a pair has no pose

    state%t = present%t
    state%q = present%q
    state%dq = present%dq
    state%ddq = present%ddq
    if (allocated(present%motor)) then
      state%motor = present%motor
      state%limited = present%limited
    end if
    if (allocated(present%pressed)) state%pressed = present%pressed
    if (allocated(present%friction)) state%friction = present%friction
    if (allocated(present%contact_force)) state%contact_force = present%contact_force
    if (allocated(present%stretch)) then
      state%stretch = present%stretch
    else if (allocated(state%stretch)) then
      deallocate (state%stretch)
    end if
    call place_all(plan, state, err)
    if (allocated(err)) return
    call spread_all_velocities(plan, state)
    call spread_all_accelerations(plan, state)
  end subroutine place_motion
end module mech9_placed_motion
