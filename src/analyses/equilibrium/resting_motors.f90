!> Motors of a mechanism at rest: steady currents, integrals that hold their setpoints, and the coupling of motors with the
!> linearised motion.
!>
!> An integral part of a controller is at rest at its setpoint only. For the search of an equilibrium its coordinate is driven
!> there; the force of this drive is then that of the controller.
module mech9_resting_motors
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_assembly
  use mech9_equilibrium_failures, only: failure_no_equilibrium, failure_moving_setpoint
  use mech9_mechanism, only: mechanism_type
  use mech9_motor, only: motor_action_type
  use mech9_motor_states, only: start_motors, find_limits, find_action
  use mech9_partition, only: partition_type, driven_coordinate
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type, copy_state
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_resting_plan, only: plan_by_geometry
  use mech9_motion_variation, only: vary_motion
  use mech9_tree_forces, only: show_variation
  use mech9_equilibrium_search, only: tell_forces
  use mech9_resting_mechanism, only: resting_type, put_to_rest, stand_at, copy_resting
  implicit none
  private
  public :: held_position_type, motor_coupling_type, hold_setpoints, release_setpoints, couple_motors

  !> A closed position in which coordinates of controllers are driven to their setpoints.
  type :: held_position_type
    type(partition_type) :: partition   !< driven, free and dependent coordinates
    type(plan_type) :: plan             !< in space
    type(state_type) :: state           !< with rates and accelerations of the driven coordinates
  end type held_position_type

  !> Derivatives of forces and of the rates of motors' states, in SI units.
  type :: motor_coupling_type
    integer, allocatable :: states(:)               !< (s) numbers of the motors with a state
    integer, allocatable :: inputs(:)               !< (v) numbers of the motors with a voltage
    real(wp), allocatable :: force_by_state(:, :)   !< (n,s) of the forces on the free coordinates
    real(wp), allocatable :: force_by_input(:, :)   !< (n,v)
    real(wp), allocatable :: rate_by_q(:, :)        !< (s,n) of the rates of the states, by the free coordinates
    real(wp), allocatable :: rate_by_dq(:, :)       !< (s,n)
    real(wp), allocatable :: rate_by_state(:)       !< (s) each by its own state [1/s]
    real(wp), allocatable :: rate_by_input(:, :)    !< (s,v)
  end type motor_coupling_type

contains

  !> Drive the coordinates of controllers with an integral part to their setpoints. Without such controllers all stays as it is.
  !> Fails where the mechanism cannot be assembled there.
  subroutine hold_setpoints(mechanism, partition, plan, assembled, held, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: assembled           !< closed, with rates and accelerations of the driven coordinates
    type(held_position_type), intent(out) :: held       !< with driven coordinates in place of those with setpoints, at these
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: q(size(assembled%q)), rate, acceleration
    logical :: is_held(size(assembled%q))
    integer :: i

    held%partition = partition
    q = assembled%q
    is_held = .false.
    do i = 1, size(mechanism%motors)
      associate (motor => mechanism%motors(i)%motor)
        if (.not. motor%holds_setpoint()) cycle
        if (allocated(motor%over)) then
          call raise(err, exit_data, failure_moving_setpoint)
          err%failure%number = i
          err%failure%name = trim(motor%over%law%variable)
          err%place = motor%place
          return
        end if
        call motor%law%evaluate(assembled%t, q(motor%coordinate), rate, acceleration, err)
        if (allocated(err)) return
        is_held(motor%coordinate) = .true.
      end associate
    end do
    where (is_held) held%partition%kind = driven_coordinate
    ! setpoints may be far from the assembled position, which the plan of closed positions does not expect
    if (any(is_held)) &
      call make_plan(mechanism, held%partition, q, held%plan, held%state, err, planning_settings_type(in_space=.true.))
    if (allocated(err)) return
    if (any(is_held)) q = held%state%q
    call plan_by_geometry(mechanism, held%partition, plan, q, held%plan, held%state, err)
    if (allocated(err)) return
    held%state%t = assembled%t
    where (partition%kind == driven_coordinate)
      held%state%dq = assembled%dq
      held%state%ddq = assembled%ddq
    end where
  end subroutine hold_setpoints

  !> Give the motors of a mechanism at rest their states, and make the coordinates free again that were driven to setpoints.
  !> Fails with exit_assembly where a controller would need a force beyond its limit.
  subroutine release_setpoints(mechanism, partition, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    type(resting_type), intent(inout) :: resting        !< in equilibrium with driven setpoints; then without
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    class(resting_type), allocatable :: other
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: state
    type(motor_action_type) :: action
    real(wp) :: forces(size(resting%state%q)), values(size(mechanism%motors))
    integer :: i
    logical :: is_held

    if (size(mechanism%motors) == 0) return
    allocate (other, plan, state)
    forces = resting%linearisation%forces
    is_held = .false.
    do i = 1, size(mechanism%motors)
      call find_action(mechanism, resting%plan, i, resting%state, action, err)
      if (allocated(err)) return
      values(i) = action%value
      associate (motor => mechanism%motors(i)%motor)
        if (.not. motor%holds_setpoint()) cycle
        values(i) = motor%state_for(forces(motor%coordinate))
        is_held = .true.
      end associate
    end do
    call copy_state(resting%state, state)
    if (is_held) then
      call plan_by_geometry(mechanism, partition, resting%plan, resting%state%q, plan, state, err)
      if (allocated(err)) return
      state%t = resting%state%t
      where (partition%kind == driven_coordinate)
        state%dq = resting%state%dq
        state%ddq = resting%state%ddq
      end where
    end if
    call start_motors(mechanism, state)
    state%motor = values
    call refuse_limits(mechanism, resting%plan, forces, state, err)
    if (allocated(err)) return
    if (is_held) then
      call put_to_rest(mechanism, partition, plan, state, other, err)
      if (.not. allocated(err)) call copy_resting(other, resting)
    else
      call stand_at(mechanism, state, resting, err)
    end if
    if (.not. allocated(err)) call find_limits(mechanism, resting%plan, resting%state, err)
  end subroutine release_setpoints

  !> Fail where a controller with an integral part would need a force beyond its limit.
  subroutine refuse_limits(mechanism, plan, forces, state, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< any plan of it: setpoints that are held depend on no link
    real(wp), intent(in) :: forces(:)                   !< (M) that hold the setpoints [N m, N]
    type(state_type), intent(in) :: state               !< with the states of the motors
    type(error_type), allocatable, intent(out) :: err   !< the failure
    type(motor_action_type) :: action
    integer :: i

    do i = 1, size(mechanism%motors)
      associate (motor => mechanism%motors(i)%motor)
        if (.not. motor%holds_setpoint()) cycle
        call find_action(mechanism, plan, i, state, action, err)
        if (allocated(err)) return
        if (abs(action%demand) <= 1.0_wp) cycle
        call raise(err, exit_assembly, failure_no_equilibrium)
        call tell_forces(mechanism, [motor%coordinate], [motor%excess_of(forces(motor%coordinate))], &
                         [state%q(motor%coordinate)], err)
        return
      end associate
    end do
  end subroutine refuse_limits

  !> The coupling of the motors with the motion about an equilibrium. Fails where a law has no value.
  subroutine couple_motors(mechanism, resting, coupling, err)
    type(mechanism_type), intent(in) :: mechanism           !< the mechanism
    type(resting_type), intent(inout) :: resting            !< with the states of its motors; its last variation changes
    type(motor_coupling_type), intent(out) :: coupling      !< the coupling
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(motor_action_type) :: action
    real(wp), dimension(size(resting%free), size(resting%state%q)) :: by_position, rate_by_position, by_rate
    real(wp) :: variables(size(resting%free), 4, size(mechanism%motors))
    integer :: i, n, s, v

    call find_slopes(mechanism, resting, by_position, rate_by_position, by_rate, variables)
    n = size(resting%free)
    allocate (coupling%states(0), coupling%inputs(0))
    do i = 1, size(mechanism%motors)
      if (mechanism%motors(i)%motor%has_state()) coupling%states = [coupling%states, i]
      if (mechanism%motors(i)%motor%has_input()) coupling%inputs = [coupling%inputs, i]
    end do
    s = size(coupling%states)
    v = size(coupling%inputs)
    allocate (coupling%force_by_state(n, s), coupling%force_by_input(n, v), coupling%rate_by_q(s, n), coupling%rate_by_dq(s, n), &
              coupling%rate_by_state(s), coupling%rate_by_input(s, v), source=0.0_wp)
    do i = 1, size(mechanism%motors)
      call find_action(mechanism, resting%plan, i, resting%state, action, err)
      if (allocated(err)) return
      s = findloc(coupling%states, i, dim=1)
      v = findloc(coupling%inputs, i, dim=1)
      associate (k => mechanism%motors(i)%motor%coordinate)
        if (v > 0) coupling%force_by_input(:, v) = action%force_by_input*by_rate(:, k)
        if (s > 0) then
          coupling%force_by_state(:, s) = action%force_by_value*by_rate(:, k)
          coupling%rate_by_q(s, :) = action%rate_by_q*by_position(:, k) + action%rate_by_dq*rate_by_position(:, k)
          coupling%rate_by_dq(s, :) = action%rate_by_dq*by_rate(:, k)
          coupling%rate_by_state(s) = action%rate_by_value
          if (v > 0) coupling%rate_by_input(s, v) = action%rate_by_input
          coupling%rate_by_q(s, :) = coupling%rate_by_q(s, :) + action%rate_by_x*variables(:, 1, i) &
                                     + action%rate_by_dx*variables(:, 2, i)
          coupling%rate_by_dq(s, :) = coupling%rate_by_dq(s, :) + action%rate_by_x*variables(:, 3, i) &
                                      + action%rate_by_dx*variables(:, 4, i)
        end if
      end associate
    end do
  end subroutine couple_motors

  !> Derivatives of all coordinates and rates, and of the variables of motors' laws, by the free coordinates and their rates.
  subroutine find_slopes(mechanism, resting, by_position, rate_by_position, by_rate, variables)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< its last variation changes
    real(wp), intent(out) :: by_position(:, :)          !< (n,M) of coordinates by free coordinates
    real(wp), intent(out) :: rate_by_position(:, :)     !< (n,M) of rates by free coordinates
    real(wp), intent(out) :: by_rate(:, :)              !< (n,M) of rates by the rates of free coordinates
    real(wp), intent(out) :: variables(:, :, :)         !< (n,4,motors) of variables and of their derivatives in time by free
                                                        !< coordinates, and by their rates; 0 for laws of time
    integer :: i

    associate (variation => resting%linearisation%variation)
      do i = 1, size(resting%free)
        call variation%clear()
        variation%q(resting%free(i)) = 1.0_wp
        call vary_motion(resting%plan, resting%state, resting%linearisation%motion, variation)
        by_position(i, :) = variation%q
        rate_by_position(i, :) = variation%dq
        call find_variables(mechanism, resting, variables(i, 1:2, :))
        call variation%clear()
        variation%dq(resting%free(i)) = 1.0_wp
        call vary_motion(resting%plan, resting%state, resting%linearisation%motion, variation)
        by_rate(i, :) = variation%dq
        call find_variables(mechanism, resting, variables(i, 3:4, :))
      end do
    end associate
  end subroutine find_slopes

  !> Derivatives of the variables of motors' laws, and of their derivatives in time, in the last variation.
  subroutine find_variables(mechanism, resting, variables)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< with the variation, and the motion as loads read it
    real(wp), intent(out) :: variables(:, :)            !< (2,motors) the derivatives [unit of the data file]
    integer :: i

    variables = 0.0_wp
    associate (linearisation => resting%linearisation, tree => resting%linearisation%tree)
      call show_variation(resting%plan, linearisation%dynamics, resting%state, linearisation%variation, tree%change)
      do i = 1, size(mechanism%motors)
        associate (motor => mechanism%motors(i)%motor)
          if (allocated(motor%over)) &
            call motor%over%change_of_motion(tree%loads%view, tree%change, variables(1, i), variables(2, i))
        end associate
      end do
    end associate
  end subroutine find_variables
end module mech9_resting_motors
