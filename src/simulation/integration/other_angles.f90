!> The equations of motion in other angles of ball joints, or with other angles of rods held.
module mech9_other_angles
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: copy_plan
  use mech9_state, only: copy_state
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_held_angles, only: copy_drives
  use mech9_ball_angles, only: ball_angles_type
  use mech9_third_derivatives, only: find_third_derivatives
  use mech9_partition, only: partition_type
  implicit none
  private
  public :: take_angles, show_in_angles, set_in_partition

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

  !> Show the present state of a system in the angles of the data file, if others are integrated.
  subroutine show_in_angles(system, angles, err)
    class(motion_system_type), intent(inout) :: system      !< the system; its state stays
    type(ball_angles_type), intent(inout) :: angles         !< continued to the present state; get it
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: dddq(system%plan%n_coordinates)

    if (.not. angles%in_use()) return
    call angles%continue_to(system%state)
    dddq = 0.0_wp
    if (angles%in_lock()) call find_third_derivatives(system, dddq, err)
    if (.not. allocated(err)) call angles%show(system%state, dddq, err)
    if (allocated(system%state%stop_force)) angles%state%stop_force = system%state%stop_force
    if (allocated(system%contact)) angles%state%contact_force = system%state%contact_force
    if (allocated(system%state%friction)) then
      angles%state%friction = system%state%friction
      angles%state%heat = system%state%heat
    end if
  end subroutine show_in_angles

  !> Make the system in other independent coordinates, from a plan and a state that were carried over to them. It is not made where
  !> these coordinates cannot serve: they may have no inertia in this position.
  subroutine set_in_partition(system, partition, serves, angles, other, made, failure)
    class(motion_system_type), intent(in) :: system         !< the system in the present coordinates
    type(partition_type), intent(in) :: partition           !< of the other coordinates
    logical, intent(in) :: serves                           !< the plan has the frames of the present one
    type(ball_angles_type), intent(inout) :: angles         !< those of the present system; then those of the other one
    type(motion_system_type), intent(inout) :: other        !< with plan and state; gets the system
    logical, intent(out) :: made                            !< it was made
    type(error_type), allocatable, intent(out) :: failure   !< allocated if the angles cannot be carried over
    type(error_type), allocatable :: unfit
    logical :: same_frames

    made = .false.
    if (angles%in_use()) then
      angles%held%partition = partition
      call angles%follow(system%model, other%plan, other%state, failure)
    else
      call angles%restart(system%model, partition, other%plan, other%state, failure)
    end if
    if (allocated(failure)) return
    same_frames = serves .and. .not. angles%in_use() .and. all(angles%held%partition%kind == partition%kind) &
                  .and. all(partition%driven() .eqv. system%plan%driven)
    call copy_drives(angles%held%drives, other%drives)
    call system%hand_on_modes(other)
    if (same_frames) then
      call set_motion_system(system%model, angles%held%partition, other, unfit, system)
    else
      call set_motion_system(system%model, angles%held%partition, other, unfit)
    end if
    made = .not. allocated(unfit)
  end subroutine set_in_partition
end module mech9_other_angles
