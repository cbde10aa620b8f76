!> Driven motions through gimbal lock of ball joints: near it, other angles move the joint, and results keep those of the data file.
!>
!> Steps end where the angles of a joint come near to their singular position. The motion starts anew there with other angles
!> (mech9_ball_angles). While others are in use, steps are so short that the angles of the data file can be continued.
module mech9_driven_angles
  use mech9_kinds, only: wp
  use mech9_integration_tolerances, only: third_derivative_step
  use mech9_error, only: error_type
  use mech9_law, only: drive_slot_type
  use mech9_partition, only: partition_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, copy_plan
  use mech9_state, only: state_type, copy_state
  use mech9_requested, only: requested_type
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance, angles_in_doubt
  use mech9_ball_angles, only: ball_angles_type
  implicit none
  private
  public :: begin_with_angles, advance_with_angles, copy_driven_motion

  !> Most halvings of a step over which angles cannot be continued.
  integer, parameter :: most_halvings = 60
  !> Steps of a motion after which it pauses.
  integer, parameter :: steps_at_once = 1000

contains

  !> Begin a motion at its assembled start, with other angles in ball joints that stand near gimbal lock.
  subroutine begin_with_angles(model, requested, plan, start, driven, angles, err)
    type(model_type), intent(in) :: model                  !< the model
    type(requested_type), intent(in) :: requested          !< the part of the motion that is worked out
    type(plan_type), intent(inout) :: plan                 !< with the angles of the data file; then as the motion executes it
    type(state_type), intent(inout) :: start               !< the assembled position and its time; then in the angles of the motion
    type(driven_motion_type), intent(out) :: driven        !< the driven motion
    type(ball_angles_type), intent(inout) :: angles        !< of the ball joints
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: t

    t = start%t
    call angles%begin(model, requested, plan, start, err)
    if (allocated(err)) return
    call start_driven_motion(angles%held%drives, plan, start, t, driven, err, requested%derivatives)
    if (allocated(err)) return
    call note_angles(angles, driven)
    call show_angles(plan, angles, driven, err)
  end subroutine begin_with_angles

  !> Go on towards a time, as `advance` does: as far as the same angles lead, and not by more than many steps.
  subroutine advance_with_angles(model, plan, t, driven, angles, reached, err)
    type(model_type), intent(in) :: model                  !< the model
    type(plan_type), intent(inout) :: plan                 !< as the motion executes it
    real(wp), intent(in) :: t                              !< time to go to [s]
    type(driven_motion_type), intent(inout) :: driven      !< the driven motion
    type(ball_angles_type), intent(inout) :: angles        !< of the ball joints
    logical, intent(out) :: reached                        !< the motion is at this time
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    if (angles%in_use()) then
      call advance_short(plan, t, driven, angles, reached, err)
    else
      call advance(angles%held%drives, plan, driven, t, err, steps_at_once)
      reached = .not. driven%paused
    end if
    if (allocated(err)) return
    if (driven%paused) then
      if (angles_in_doubt(driven)) call change_angles(model, plan, driven, angles, err)
    else if (reached) then
      call show_angles(plan, angles, driven, err)
    end if
  end subroutine advance_with_angles

  !> Go on towards a time, as far as the angles of the data file can be continued at once.
  subroutine advance_short(plan, t, driven, angles, reached, err)
    type(plan_type), intent(in) :: plan                    !< as the motion executes it
    real(wp), intent(in) :: t                              !< time to go towards [s]
    type(driven_motion_type), intent(inout) :: driven      !< the driven motion
    type(ball_angles_type), intent(inout) :: angles        !< of the ball joints, some of which are replaced
    logical, intent(out) :: reached                        !< the motion is at this time
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(driven_motion_type) :: before
    real(wp) :: h
    integer :: i

    call copy_driven_motion(driven, before)
    h = min(angles%longest_way(), abs(t - before%state%t))
    do i = 1, most_halvings
      reached = .not. h < abs(t - before%state%t)
      if (reached) then
        call advance(angles%held%drives, plan, driven, t, err)
      else
        call advance(angles%held%drives, plan, driven, before%state%t + sign(h, t - before%state%t), err)
      end if
      if (allocated(err)) return
      reached = reached .and. .not. driven%paused
      if (angles%may_continue(driven%state)) exit
      call copy_driven_motion(before, driven)
      h = 0.5_wp*h
    end do
    call angles%continue_to(driven%state)
  end subroutine advance_short

  !> Start anew at the present position with other angles in the joints that are near gimbal lock, or with other angles of rods held.
  subroutine change_angles(model, plan, driven, angles, err)
    type(model_type), intent(in) :: model                  !< the model
    type(plan_type), intent(inout) :: plan                 !< as the motion executes it
    type(driven_motion_type), intent(inout) :: driven      !< the driven motion
    type(ball_angles_type), intent(inout) :: angles        !< of the ball joints
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(driven_motion_type) :: before
    type(partition_type) :: partition
    type(plan_type) :: changed_plan
    type(state_type) :: changed
    real(wp) :: t

    t = driven%predictor%t
    driven%state%t = t
    if (angles%in_use()) call show_angles(plan, angles, driven, err)
    if (allocated(err)) return
    if (size(angles%held%rods) > 0) then
      if (angles%in_use()) then
        call copy_plan(angles%plan, changed_plan)
        call copy_state(angles%state, changed)
      else
        call copy_plan(plan, changed_plan)
        call copy_state(driven%state, changed)
      end if
      partition = angles%held%partition
      call angles%restart(model, partition, changed_plan, changed, err)
    else
      call angles%change(driven%state, changed_plan, changed, err)
    end if
    if (allocated(err)) return
    call copy_driven_motion(driven, before)
    call copy_plan(changed_plan, plan)
    call start_driven_motion(angles%held%drives, plan, changed, t, driven, err, before%derivatives)
    if (allocated(err)) return
    driven%steps = before%steps
    driven%iterations = before%iterations
    driven%halvings = before%halvings
    driven%crossings = before%crossings
    driven%conditioning = before%conditioning
    driven%worst_closure = max(driven%worst_closure, before%worst_closure)
    call note_angles(angles, driven)
  end subroutine change_angles

  !> Copy a driven motion. The assignment stands here alone, because compilers write it out for all components.
  subroutine copy_driven_motion(from, to)
    type(driven_motion_type), intent(in) :: from    !< the driven motion
    type(driven_motion_type), intent(inout) :: to   !< the same afterwards

    to = from
  end subroutine copy_driven_motion

  !> Give the motion its angles, so that it pauses near their singular positions.
  pure subroutine note_angles(angles, driven)
    type(ball_angles_type), intent(in) :: angles        !< of the ball joints
    type(driven_motion_type), intent(inout) :: driven   !< the driven motion
    integer :: i

    if (size(angles%held%rods) > 0) driven%rods = angles%held%rods
    if (size(angles%joints) == 0) return
    allocate (driven%angles(size(angles%joints)))
    do i = 1, size(angles%joints)
      driven%angles(i)%turns = angles%turns_in_use(i)
      driven%angles(i)%second = angles%joints(i)%coordinates(2)
    end do
  end subroutine note_angles

  !> Show the present position in the angles of the data file, if others are in use.
  subroutine show_angles(plan, angles, driven, err)
    type(plan_type), intent(in) :: plan                    !< as the motion executes it
    type(ball_angles_type), intent(inout) :: angles        !< of the ball joints
    type(driven_motion_type), intent(inout) :: driven      !< the driven motion
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: dddq(plan%n_coordinates)

    if (.not. angles%in_use()) return
    call angles%continue_to(driven%state)
    dddq = 0.0_wp
    if (angles%in_lock() .and. driven%derivatives > 1) call find_third_derivatives(angles%held%drives, plan, driven, dddq)
    call angles%show(driven%state, dddq, err)
  end subroutine show_angles

  !> Third derivatives of all coordinates by a central difference of the accelerations, of one side at an end of the motion. They
  !> are zero where the motion leads to neither side.
  subroutine find_third_derivatives(drives, plan, driven, dddq)
    type(drive_slot_type), intent(in) :: drives(:)     !< of the driven coordinates
    type(plan_type), intent(in) :: plan                !< as the motion executes it
    type(driven_motion_type), intent(in) :: driven     !< the driven motion
    real(wp), intent(out) :: dddq(:)                   !< (M) [rad/s^3, m/s^3]
    type(driven_motion_type) :: other
    type(error_type), allocatable :: err
    real(wp) :: ddq(size(dddq), 2), t(2), dt
    integer :: i

    dt = third_derivative_step/max(maxval(abs(driven%state%dq)/plan%unit_of), &
                                   sqrt(maxval(abs(driven%state%ddq)/plan%unit_of)), tiny(dt)/epsilon(dt))
    do i = 1, 2
      call copy_driven_motion(driven, other)
      call advance(drives, plan, other, driven%state%t + (2*i - 3)*dt, err)
      t(i) = other%state%t
      ddq(:, i) = other%state%ddq
      if (allocated(err)) then
        t(i) = driven%state%t
        ddq(:, i) = driven%state%ddq
        deallocate (err)
      end if
    end do
    dddq = 0.0_wp
    if (abs(t(2) - t(1)) > 0.0_wp) dddq = (ddq(:, 2) - ddq(:, 1))/(t(2) - t(1))
  end subroutine find_third_derivatives
end module mech9_driven_angles
