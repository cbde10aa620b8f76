!> The motion of frames, links and points, each in the arithmetic of its block.
module mech9_frame_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: place_frames, place_frames_after_change, spread_velocities, spread_accelerations, place_all, spread_all_velocities, &
    spread_all_accelerations, link_motion, point_motion, step_screw

contains

  !> Poses of a block's frames and the screws of their steps, from the coordinates in `state`. The frames of earlier blocks must
  !> be in place. Fails only where a user pair has no pose.
  subroutine place_frames(plan, block, state, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call plan%arithmetics(block%arithmetic)%kind%place(plan, block%first_step, block%last_step, state, err)
  end subroutine place_frames

  !> The same after a small change of the block's unknowns: their angles are turned on, not computed anew.
  subroutine place_frames_after_change(plan, block, change, state, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    real(wp), intent(in) :: change(:)             !< (unknowns) of the coordinates, in units of these
    type(state_type), intent(inout) :: state      !< its coordinates are changed already
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call plan%arithmetics(block%arithmetic)%kind%place_after_change(plan, block%first_step, block%last_step, block%unknowns, &
                                                                    change, state, err)
  end subroutine place_frames_after_change

  !> Velocities of a block's frames from the rates in `state`.
  pure subroutine spread_velocities(plan, block, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism

    call plan%arithmetics(block%arithmetic)%kind%spread_velocities(plan, block%first_step, block%last_step, state)
  end subroutine spread_velocities

  !> Accelerations of a block's frames from the rates and accelerations in `state`.
  pure subroutine spread_accelerations(plan, block, last, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    integer, intent(in) :: last                   !< frames up to this one
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism

    call plan%arithmetics(block%arithmetic)%kind%spread_accelerations(plan, block%first_step, last, state)
  end subroutine spread_accelerations

  !> Poses of the frames of all blocks.
  subroutine place_all(plan, state, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: b

    do b = 1, size(plan%blocks)
      call place_frames(plan, plan%blocks(b), state, err)
      if (allocated(err)) return
    end do
  end subroutine place_all

  !> Velocities of the frames of all blocks.
  pure subroutine spread_all_velocities(plan, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    integer :: b

    do b = 1, size(plan%blocks)
      call spread_velocities(plan, plan%blocks(b), state)
    end do
  end subroutine spread_all_velocities

  !> Accelerations of the frames of all blocks.
  pure subroutine spread_all_accelerations(plan, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    integer :: b

    do b = 1, size(plan%blocks)
      call spread_accelerations(plan, plan%blocks(b), plan%blocks(b)%last_step, state)
    end do
  end subroutine spread_all_accelerations

  !> A link's own system, its angular velocity and the velocity of its origin, in the system of link 1.
  pure subroutine link_motion(plan, state, link, r, p, omega, v)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: link
    real(wp), intent(out) :: r(3, 3)              !< rotation
    real(wp), intent(out) :: p(3)                 !< origin [m]
    real(wp), intent(out) :: omega(3)             !< [rad/s]
    real(wp), intent(out) :: v(3)                 !< of the origin [m/s]

    call plan%arithmetics(1)%kind%link_motion(plan, state, link, r, p, omega, v)
  end subroutine link_motion

  !> Position (14), velocity (15) and acceleration (16) of a point of a link, in the system of link 1; those that are
  !> asked for must be known of the state.
  pure subroutine point_motion(plan, state, link, place, position, velocity, acceleration)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: link
    real(wp), intent(in) :: place(3)              !< of the point, in the link's own system [m]
    real(wp), intent(out) :: position(3)          !< [m]
    real(wp), intent(out), optional :: velocity(3)      !< [m/s]
    real(wp), intent(out), optional :: acceleration(3)  !< [m/s^2]

    call plan%arithmetics(1)%kind%point_motion(plan, state, link, place, position, velocity, acceleration)
  end subroutine point_motion

  !> The angular velocity and the velocity of the new frame's origin that a step gives per unit rate, and that origin; in the
  !> axes of frame 0, from its origin.
  pure subroutine step_screw(plan, state, s, w, v, place)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: s                      !< step
    real(wp), intent(out) :: w(3)                 !< [rad per unit of q]
    real(wp), intent(out) :: v(3)                 !< [m per unit of q]
    real(wp), intent(out) :: place(3)             !< [m]

    call plan%arithmetics(1)%kind%step_screw(plan, state, s, w, v, place)
  end subroutine step_screw
end module mech9_frame_motion
