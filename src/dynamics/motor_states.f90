!> The states of motors in a state of motion: their start, their rates, and the limits at which motors work.
module mech9_motor_states
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: unlocked
  use mech9_motor, only: motor_type, motor_motion_type, motor_action_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: point_motion
  implicit none
  private
  public :: start_motors, find_motor_rates, motion_of_state, find_action, find_limits, has_limits

contains

  !> Put the motors into a state of motion, without current and with integrals that begin at zero. Nothing is done where there are
  !> none, or where they have states already.
  subroutine start_motors(mechanism, state)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(state_type), intent(inout) :: state        !< gets the states of the motors

    if (size(mechanism%motors) == 0 .or. allocated(state%motor)) return
    allocate (state%motor(size(mechanism%motors)), state%motor_rate(size(mechanism%motors)), source=0.0_wp)
    allocate (state%limited(size(mechanism%motors)), source=unlocked)
  end subroutine start_motors

  !> The action of a motor in a state of motion with all coordinates, rates and accelerations. Fails where its law has no value.
  subroutine find_action(mechanism, plan, i, state, action, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan in which the motion is given
    integer, intent(in) :: i                            !< number of the motor
    type(state_type), intent(in) :: state               !< the state of motion
    type(motor_action_type), intent(out) :: action      !< the action
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    associate (motor => mechanism%motors(i)%motor)
      call motor%act(motion_of_state(motor, plan, i, state), action, err)
    end associate
  end subroutine find_action

  !> The motion of a motor's coordinate and of the variable of its law, and the motor's state, in a state of motion.
  pure function motion_of_state(motor, plan, i, state) result(motion)
    class(motor_type), intent(in) :: motor              !< the motor
    type(plan_type), intent(in) :: plan                 !< the plan in which the motion is given
    integer, intent(in) :: i                            !< its number
    type(state_type), intent(in) :: state               !< the state of motion
    type(motor_motion_type) :: motion
    real(wp), dimension(3) :: position, velocity, acceleration

    motion%t = state%t
    motion%q = state%q(motor%coordinate)
    motion%dq = state%dq(motor%coordinate)
    motion%ddq = state%ddq(motor%coordinate)
    if (allocated(motor%over)) then
      associate (over => motor%over)
        if (over%link > 0) then
          call point_motion(plan, state, over%link, over%position, position, velocity, acceleration)
          call over%follow_point(position, velocity, acceleration, motion%x, motion%dx, motion%ddx)
        else
          call over%follow(state%q, state%dq, state%ddq, motion%x, motion%dx, motion%ddx)
        end if
      end associate
    end if
    motion%steady = .not. allocated(state%motor)
    if (motion%steady) return
    motion%value = state%motor(i)
    motion%limited = state%limited(i)
  end function motion_of_state

  !> The rates of the motors' states.
  subroutine find_motor_rates(mechanism, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan in which the motion is given
    type(state_type), intent(inout) :: state            !< with the rates of all coordinates; gets those of the motors' states
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(motor_action_type) :: action
    integer :: i

    if (.not. allocated(state%motor)) return
    do i = 1, size(state%motor)
      call find_action(mechanism, plan, i, state, action, err)
      if (allocated(err)) return
      state%motor_rate(i) = action%rate
    end do
  end subroutine find_motor_rates

  !> Whether the force of any motor has a limit.
  pure logical function has_limits(mechanism)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer :: i

    has_limits = .false.
    do i = 1, size(mechanism%motors)
      has_limits = has_limits .or. mechanism%motors(i)%motor%has_limit()
    end do
  end function has_limits

  !> The limits at which the motors work, by the forces that they would have without.
  subroutine find_limits(mechanism, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan in which the motion is given
    type(state_type), intent(inout) :: state            !< with the rates of all coordinates and links; gets the limits
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(motor_action_type) :: action
    integer :: i

    if (.not. allocated(state%motor)) return
    do i = 1, size(state%motor)
      state%limited(i) = unlocked
      call find_action(mechanism, plan, i, state, action, err)
      if (allocated(err)) return
      state%limited(i) = 0
      if (abs(action%demand) > 1.0_wp) state%limited(i) = nint(sign(1.0_wp, action%demand))
    end do
  end subroutine find_limits
end module mech9_motor_states
