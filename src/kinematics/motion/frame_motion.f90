!> The motion of frames, links and points, each in the arithmetic of its block; frames of planar blocks are also composed with the
!> motion of their plane's base where they are read in space.
module mech9_frame_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_coupling_constraint, only: find_curves
  use mech9_planar_view, only: show_poses, show_velocities, show_accelerations
  implicit none
  private
  public :: place_frames, place_unshown, place_frames_after_change
  public :: spread_velocities, spread_accelerations, place_all, spread_all_velocities, spread_all_accelerations
  public :: show_all_frames, link_motion, link_turning, point_motion, step_screw

contains

  !> Poses of a block's frames and the screws of their steps, from the coordinates in `state`. The frames of earlier blocks must
  !> be in place. Fails only where a pair has no pose, or a coupling no value.
  subroutine place_frames(plan, block, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(block_type), intent(in) :: block               !< the block
    type(state_type), intent(inout) :: state            !< coordinates in; poses and screws of the block's frames out
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call place_unshown(plan, block, state, err)
    if (allocated(err) .or. .not. block%is_shown) return
    call show_poses(plan, plan%planar%shown, block%first_step, block%last_step, state)
  end subroutine place_frames

  !> The same as place_frames, without the poses in space of planar frames that are read there.
  subroutine place_unshown(plan, block, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(block_type), intent(in) :: block               !< the block
    type(state_type), intent(inout) :: state            !< coordinates in; poses and screws of the block's frames out
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (block%arithmetic == 0) then
      call place_all(plan, state, err)
    else
      call plan%arithmetics(block%arithmetic)%kind%place(plan, block%first_step, block%last_step, state, err)
    end if
    if (plan%has_curves .and. .not. allocated(err)) call find_curves(plan, block%first_closure, block%last_closure, state, err)
  end subroutine place_unshown

  !> Poses of a block's frames after a small change of its unknowns, without those in space of planar frames that are read
  !> there. The cosines and sines of their angles are corrected to second order and not computed anew.
  subroutine place_frames_after_change(plan, block, change, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(block_type), intent(in) :: block               !< the block
    real(wp), intent(in) :: change(:)                   !< (unknowns) change of the coordinates, in units of these
    type(state_type), intent(inout) :: state            !< changed coordinates in; poses and screws of the block's frames out
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (block%arithmetic == 0) then
      call place_all(plan, state, err)
    else
      call plan%arithmetics(block%arithmetic)%kind%place_after_change(plan, block%first_step, block%last_step, &
                                                                      block%unknowns, change, state, err)
    end if
    if (plan%has_curves .and. .not. allocated(err)) call find_curves(plan, block%first_closure, block%last_closure, state, err)
  end subroutine place_frames_after_change

  !> Velocities of a block's frames from the rates in `state`.
  pure subroutine spread_velocities(plan, block, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(block_type), intent(in) :: block      !< the block
    type(state_type), intent(inout) :: state   !< rates in; velocities of the block's frames out

    if (block%arithmetic == 0) then
      call spread_all_velocities(plan, state)
    else
      call plan%arithmetics(block%arithmetic)%kind%spread_velocities(plan, block%first_step, block%last_step, state)
      if (block%is_shown) call show_velocities(plan, plan%planar%shown, block%first_step, block%last_step, state)
    end if
  end subroutine spread_velocities

  !> Accelerations of a block's frames from the rates and accelerations in `state`.
  pure subroutine spread_accelerations(plan, block, last, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(block_type), intent(in) :: block      !< the block
    integer, intent(in) :: last                !< frames up to this one
    type(state_type), intent(inout) :: state   !< rates and accelerations in; accelerations of the block's frames out

    if (block%arithmetic == 0) then
      call spread_all_accelerations(plan, state)
    else
      call plan%arithmetics(block%arithmetic)%kind%spread_accelerations(plan, block%first_step, last, state)
      if (block%is_shown) call show_accelerations(plan, plan%planar%shown, block%first_step, last, state)
    end if
  end subroutine spread_accelerations

  !> Poses of the frames of all blocks.
  subroutine place_all(plan, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(state_type), intent(inout) :: state            !< coordinates in; poses and screws of all frames out
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: b, last

    b = 1
    do while (b <= size(plan%blocks))
      last = end_of_run(plan, b)
      call plan%arithmetics(plan%blocks(b)%arithmetic)%kind%place(plan, plan%blocks(b)%first_step, &
                                                                  plan%blocks(last)%last_step, state, err)
      if (allocated(err)) return
      if (shows_any(plan, b, last)) call show_poses(plan, plan%planar%shown, plan%blocks(b)%first_step, &
                                                    plan%blocks(last)%last_step, state)
      if (plan%has_curves) call find_curves(plan, plan%blocks(b)%first_closure, plan%blocks(last)%last_closure, state, err)
      if (allocated(err)) return
      b = last + 1
    end do
  end subroutine place_all

  !> Velocities of the frames of all blocks.
  pure subroutine spread_all_velocities(plan, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< rates in; velocities of all frames out
    integer :: b, last

    b = 1
    do while (b <= size(plan%blocks))
      last = end_of_run(plan, b)
      call plan%arithmetics(plan%blocks(b)%arithmetic)%kind%spread_velocities(plan, plan%blocks(b)%first_step, &
                                                                              plan%blocks(last)%last_step, state)
      if (shows_any(plan, b, last)) call show_velocities(plan, plan%planar%shown, plan%blocks(b)%first_step, &
                                                         plan%blocks(last)%last_step, state)
      b = last + 1
    end do
  end subroutine spread_all_velocities

  !> Accelerations of the frames of all blocks.
  pure subroutine spread_all_accelerations(plan, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< rates and accelerations in; accelerations of all frames out
    integer :: b, last

    b = 1
    do while (b <= size(plan%blocks))
      last = end_of_run(plan, b)
      call plan%arithmetics(plan%blocks(b)%arithmetic)%kind%spread_accelerations(plan, plan%blocks(b)%first_step, &
                                                                                 plan%blocks(last)%last_step, state)
      if (shows_any(plan, b, last)) call show_accelerations(plan, plan%planar%shown, plan%blocks(b)%first_step, &
                                                            plan%blocks(last)%last_step, state)
      b = last + 1
    end do
  end subroutine spread_all_accelerations

  !> The motion in space of all frames of planar blocks, those included that no block reads there.
  pure subroutine show_all_frames(plan, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< the motion in the planes in; that in space out

    if (.not. allocated(plan%planar%planes)) return
    call show_poses(plan, plan%planar%plane_of > 0, 1, plan%n_coordinates, state)
    call show_velocities(plan, plan%planar%plane_of > 0, 1, plan%n_coordinates, state)
    call show_accelerations(plan, plan%planar%plane_of > 0, 1, plan%n_coordinates, state)
  end subroutine show_all_frames

  !> The last of the blocks from b on whose steps follow each other in one arithmetic, so that one call serves them all.
  pure integer function end_of_run(plan, b) result(last)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: b              !< number of the first block

    last = b
    do while (last < size(plan%blocks))
      if (plan%blocks(last + 1)%arithmetic /= plan%blocks(b)%arithmetic .or. &
          plan%blocks(last + 1)%first_step /= plan%blocks(last)%last_step + 1) return
      last = last + 1
    end do
  end function end_of_run

  !> Whether some frames of the blocks b .. last are planar and are read in space.
  pure logical function shows_any(plan, b, last)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: b              !< number of the first block
    integer, intent(in) :: last           !< number of the last block

    shows_any = .false.
    ! a plan with one arithmetic has no frames of another
    if (size(plan%arithmetics) > 1) shows_any = any(plan%blocks(b:last)%is_shown)
  end function shows_any

  !> A link's own system, its angular velocity and the velocity of its origin, in the system of link 1.
  pure subroutine link_motion(plan, state, link, r, p, omega, v)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the velocities of the frames
    integer, intent(in) :: link             !< number of the link
    real(wp), intent(out) :: r(3, 3)        !< rotation from the link's axes to those of link 1
    real(wp), intent(out) :: p(3)           !< origin of the link [m]
    real(wp), intent(out) :: omega(3)       !< angular velocity [rad/s]
    real(wp), intent(out) :: v(3)           !< velocity of the origin [m/s]

    call plan%arithmetics(arithmetic_of(plan, plan%frame_of(link)))%kind%link_motion(plan, state, link, r, p, omega, v)
  end subroutine link_motion

  !> Position (14), velocity (15) and acceleration (16) of a point of a link, in the system of link 1; those that are
  !> present must be known in `state`.
  pure subroutine point_motion(plan, state, link, place, position, velocity, acceleration)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
    type(state_type), intent(in) :: state                !< with the motion of the frames
    integer, intent(in) :: link                          !< number of the link
    real(wp), intent(in) :: place(3)                     !< position of the point in the link's own system [m]
    real(wp), intent(out) :: position(3)                 !< in the system of link 1 [m]
    real(wp), intent(out), optional :: velocity(3)       !< in the axes of link 1 [m/s]
    real(wp), intent(out), optional :: acceleration(3)   !< in the axes of link 1 [m/s^2]

    call plan%arithmetics(arithmetic_of(plan, plan%frame_of(link)))%kind%point_motion(plan, state, link, place, position, &
      velocity, acceleration)
  end subroutine point_motion

  !> The angular acceleration of a link, in the axes of link 1.
  pure subroutine link_turning(plan, state, link, alpha)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the accelerations of the frames
    integer, intent(in) :: link             !< number of the link
    real(wp), intent(out) :: alpha(3)       !< angular acceleration [rad/s^2]

    call plan%arithmetics(arithmetic_of(plan, plan%frame_of(link)))%kind%link_turning(plan, state, link, alpha)
  end subroutine link_turning

  !> The angular velocity and the velocity of the new frame's origin that a step gives per unit rate, and that origin; in the
  !> axes of frame 0, from its origin.
  pure subroutine step_screw(plan, state, s, w, v, place)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the poses of the frames
    integer, intent(in) :: s                !< number of the step
    real(wp), intent(out) :: w(3)           !< angular velocity per unit rate [rad per unit of q]
    real(wp), intent(out) :: v(3)           !< velocity of the new frame's origin per unit rate [m per unit of q]
    real(wp), intent(out) :: place(3)       !< origin of the new frame, from that of frame 0 [m]

    call plan%arithmetics(arithmetic_of(plan, s))%kind%step_screw(plan, state, s, w, v, place)
  end subroutine step_screw

  !> The arithmetic that knows the motion of a frame.
  pure integer function arithmetic_of(plan, frame) result(arithmetic)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: frame          !< number of the frame

    arithmetic = 1
    if (.not. allocated(plan%planar%plane_of)) return
    if (plan%planar%plane_of(frame) > 0) arithmetic = 2
  end function arithmetic_of
end module mech9_frame_motion
