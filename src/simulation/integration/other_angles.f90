!> The equations of motion in other angles of ball joints, or with other angles of rods held.
module mech9_other_angles
  use mech9_error, only: error_type
  use mech9_plan, only: copy_plan
  use mech9_state, only: copy_state
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_held_angles, only: copy_drives
  use mech9_ball_angles, only: ball_angles_type
  implicit none
  private
  public :: take_angles

contains

  !> Make the system in the angles that serve best, at the present state. It is not made where these are the present ones.
  subroutine take_angles(system, present_angles, angles, other, failure)
    class(motion_system_type), intent(in) :: system         !< the system in the present angles
    type(ball_angles_type), intent(in) :: present_angles    !< ball joints of the motion
    type(ball_angles_type), intent(inout) :: angles         !< the same; then those of the other system
    type(motion_system_type), intent(inout) :: other        !< gets the system
    type(error_type), allocatable, intent(out) :: failure   !< allocated if these angles cannot serve

    if (size(system%plan%closures) > 0) then
      if (angles%in_use()) then
        call copy_plan(angles%plan, other%plan)
        call copy_state(angles%state, other%state)
      else
        call copy_plan(system%plan, other%plan)
        call copy_state(system%state, other%state)
      end if
      call angles%restart(system%model, system%partition, other%plan, other%state, failure)
    else
      call angles%change(system%state, other%plan, other%state, failure)
    end if
    if (allocated(failure) .or. angles%move_as(present_angles)) return
    call copy_drives(angles%held%drives, other%drives)
    call system%hand_on_modes(other)
    call set_motion_system(system%model, angles%held%partition, other, failure)
  end subroutine take_angles
end module mech9_other_angles
