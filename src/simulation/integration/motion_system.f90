!> The motion as differential equations for an integrator.
!>
!> The vector that is integrated holds all coordinates, the rates of the free ones and the states of motors; then, where they are
!> asked for, derivatives of free coordinates and of their rates by parameters. The motion of driven coordinates is that of their drives. An evaluation takes the positions as they are, and the chains are closed after each
!> accepted step: half the cost of closing them in every evaluation, at the same error (docs/explanation/design-decisions.md).
module mech9_motion_system
  use mech9_kinds, only: wp, long
  use mech9_integration_tolerances, only: trusted_between_steps, trusted_closing
  use mech9_error, only: error_type, raise, add_place, exit_singular, exit_integrator
  use mech9_ode_failures, only: failure_infinite_rate
  use mech9_dynamics_failures, only: failure_no_inertia
  use mech9_force_gradient_failures, only: failure_lost_inertia
  use mech9_integration_failures, only: failure_singular_step, failure_unclosed_step, failure_drive_jumps
  use mech9_law, only: drive_slot_type
  use mech9_partition, only: partition_type
  use mech9_motion_view, only: unlocked
  use mech9_motor, only: motor_action_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_integrated_vector, only: length_of_vector, pack_state, pack_rates, unpack_state
  use mech9_block_solver, only: newton_outcome_type, close_block
  use mech9_ode_system, only: ode_system_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_expectation, only: expectation_type
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_motion, find_equations, check_inertia, complete_accelerations
  use mech9_generalized_forces, only: show_state
  use mech9_motor_states, only: start_motors, find_motor_rates, find_limits, find_action
  use mech9_frame_motion, only: place_all
  use mech9_branch_stepping, only: set_inputs
  use mech9_held_angles, only: copy_drives
  use mech9_smooth_interval, only: smooth_interval_type
  use mech9_stop_forces, only: held_coordinate_type, find_stop_forces
  use mech9_friction_motion, only: friction_motion_type, begin_frictions, prepare_frictions, find_frictions, find_heat_rates
  use mech9_contact_motion, only: contact_motion_type, begin_contact_motion, find_contact_motion, correct_positions, correct_rates
  use mech9_variable_model, only: variable_model_type
  use mech9_motion_sensitivity, only: motion_sensitivity_type, new_motion_sensitivity
  use mech9_varied_contacts, only: find_varied_contacts
  use mech9_varied_frictions, only: varied_frictions_type, find_varied_frictions, vary_use
  implicit none
  private
  public :: motion_system_type, set_motion_system, free_system

  !> The equations of motion of a model in its present coordinates, with the state of the last evaluation. Parts that are
  !> polymorphic are copied by calls, which keeps the code of copies small.
  type, extends(ode_system_type) :: motion_system_type
    type(model_type), pointer :: model => null()     !< constant, the same for all systems of a motion
    type(partition_type) :: partition                !< of the coordinates, as they are now
    type(drive_slot_type), allocatable :: drives(:)  !< of the driven coordinates, as they are now
    class(plan_type), allocatable :: plan
    class(dynamics_plan_type), allocatable :: dynamics
    class(lagrange_work_type), allocatable :: work
    class(state_type), allocatable :: state          !< of the last evaluation, or after the projection
    integer(long) :: iterations = 0                  !< of Newton's method, all blocks
    !> Trials with a worse conditioned block are refused: a step must not cross a singular position unseen.
    real(wp) :: refuse_below = 0.0_wp
    logical, private :: just_projected = .false.
    logical, private :: has_inertia = .false.        !< all free coordinates had inertia in the position with which it was made
    type(smooth_interval_type) :: interval           !< in which the present steps lie
    type(held_coordinate_type), allocatable :: held(:)          !< coordinates that stops or friction hold; not allocated: none
    class(friction_motion_type), allocatable :: friction        !< frictions of pairs; not allocated: there are none
    class(contact_motion_type), allocatable :: contact          !< contacts of links; not allocated: there are none
    type(motion_sensitivity_type), allocatable :: sensitivity   !< derivatives by parameters, where they are integrated, too
    class(varied_frictions_type), allocatable, private :: varied_frictions   !< those of frictions
  contains
    procedure :: make_room
    procedure :: hand_on_modes
    procedure :: any_sticks
    procedure :: size_of_vector
    procedure :: size_of_motion
    procedure :: count_varied
    procedure :: begin_sensitivity
    procedure :: show_sensitivity
    procedure :: vary_friction
    procedure :: vector
    procedure :: rate
    procedure :: take_vector
    procedure :: project
    procedure :: close_near
    procedure :: move_to
    procedure :: resume
    procedure :: present => show_present
    procedure :: conditioning
    procedure :: signs
    procedure :: pass_limits
  end type motion_system_type

contains

  !> Make room for the parts that are set from outside and for those that follow from them, where there is none yet.
  subroutine make_room(self)
    class(motion_system_type), intent(inout) :: self   !< the system

    if (.not. allocated(self%plan)) allocate (self%plan)
    if (.not. allocated(self%state)) allocate (self%state)
    if (.not. allocated(self%dynamics)) allocate (self%dynamics, self%work)
  end subroutine make_room

  !> Make the system from its plan and an assembled start with the independent rates, which stand in it. The motion there is found,
  !> and work%coefficients are those of the start. What an earlier system knows of frames and blocks that stay is copied. The
  !> drives are those of the model unless they stand in the system.
  subroutine set_motion_system(model, partition, system, err, known)
    type(model_type), intent(in), target :: model        !< the model; it must outlive the system
    type(partition_type), intent(in) :: partition        !< of the coordinates
    class(motion_system_type), intent(inout) :: system   !< the system, with plan and state; then with its motion
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    class(motion_system_type), intent(in), optional :: known   !< the system in other coordinates, whose plan has the same frames

    call system%make_room()
    system%projects = .true.
    system%model => model
    system%partition = partition
    if (.not. allocated(system%drives)) call copy_drives(model%problem%drives, system%drives)
    if (present(known)) then
      call make_dynamics_plan(model%mechanism, system%plan, system%dynamics, known%plan, known%dynamics)
    else
      call make_dynamics_plan(model%mechanism, system%plan, system%dynamics)
    end if
    call make_work(system%plan, system%dynamics, system%work)
    call start_motors(model%mechanism, system%state)
    if (model%mechanism%has_frictions()) then
      if (.not. allocated(system%friction)) allocate (system%friction)
      call begin_frictions(model%mechanism, system%state, system%friction)
      call prepare_frictions(model%mechanism, system%plan, system%state, system%friction)
    end if
    if (model%mechanism%has_contacts()) then
      if (.not. allocated(system%contact)) then
        allocate (system%contact)
        call begin_contact_motion(model%mechanism, system%contact)
      end if
      if (.not. allocated(system%state%contact_force)) &
        allocate (system%state%contact_force(3, size(model%mechanism%contacts)), source=0.0_wp)
    end if
    call system%interval%begin(model, system%state%t)
    ! reports show the coefficients of the start; articulated bodies do without
    if (system%dynamics%articulated) &
      call find_equations(model%mechanism, system%plan, system%dynamics, system%state, system%work, err)
    if (.not. allocated(err)) call system%present(err)
    if (.not. allocated(err)) call begin_limits(system, err)
    if (.not. allocated(err)) call check_inertia(system%plan, system%dynamics, system%work, err)
    system%has_inertia = .not. allocated(err)
    call point_at_pair(model, err)
  end subroutine set_motion_system

  !> Say in which place of the data file the pair is whose coordinate has no inertia.
  subroutine point_at_pair(model, err)
    type(model_type), intent(in) :: model                  !< the model
    type(error_type), allocatable, intent(inout) :: err    !< the failure of its start, or none

    if (.not. allocated(err)) return
    if (.not. allocated(err%failure)) return
    if (err%failure%kind == failure_no_inertia) &
      call add_place(err, place=model%mechanism%pairs(err%failure%coordinates(1))%pair%place)
  end subroutine point_at_pair

  !> Make the scratch for evaluations.
  subroutine make_work(plan, dynamics, work)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(lagrange_work_type), intent(inout) :: work    !< made anew

    work = new_lagrange_work(plan, dynamics)
  end subroutine make_work

  !> Rates and accelerations by the equations of motion. A coordinate without inertia is a fault of the data only in the position
  !> with which the system was made; in later ones it is a failure of the integration, which a smaller step may avoid.
  subroutine accelerate(self, err, with_sticking)
    class(motion_system_type), intent(inout) :: self    !< the motion system, with placed frames and independent rates
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical, intent(in), optional :: with_sticking      !< frictions of pairs that stick are found, too; not unless given
    integer :: k
    logical :: rubs, touches

    touches = .false.
    if (allocated(self%contact)) touches = self%contact%any_acts()
    rubs = .false.
    if (allocated(self%friction)) rubs = present(with_sticking) .or. self%friction%modes%any_slips() .or. &
                                         any(self%model%mechanism%frictions%is_smooth)
    if (rubs) then
      call find_frictions(self%model%mechanism, self%plan, self%dynamics, self%state, self%work, self%friction, self%contact, err)
    else if (touches) then
      if (allocated(self%friction)) self%state%friction = 0.0_wp
      call find_contact_motion(self%model%mechanism, self%plan, self%dynamics, self%state, self%work, self%contact, err)
    else
      if (allocated(self%friction)) self%state%friction = 0.0_wp
      if (allocated(self%contact)) self%state%contact_force = 0.0_wp
      call find_motion(self%model%mechanism, self%plan, self%dynamics, self%state, self%work, err)
    end if
    if (.not. (allocated(err) .and. self%has_inertia)) return
    if (.not. allocated(err%failure)) return
    if (err%failure%kind /= failure_no_inertia) return
    k = err%failure%coordinates(1)
    if (all(abs(self%work%coefficients) <= huge(1.0_wp))) then
      call raise(err, exit_integrator, failure_lost_inertia)
      err%failure%coordinates = [k]
    else
      call raise(err, exit_integrator, failure_infinite_rate)
      err%failure%number = k
    end if
  end subroutine accelerate

  !> Let the motors begin to work at limits, unless they do already: from here on these change at events alone.
  subroutine begin_limits(self, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system, with all rates; its state gets the limits
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of a motor has no value

    if (.not. allocated(self%state%limited)) return
    if (any(self%state%limited == unlocked)) call find_limits(self%model%mechanism, self%plan, self%state, err)
  end subroutine begin_limits

  !> Let another system hold the same coordinates, and let its frictions act in the same way.
  subroutine hand_on_modes(self, other)
    class(motion_system_type), intent(in) :: self        !< the present system
    class(motion_system_type), intent(inout) :: other    !< the other one, before it is set

    if (allocated(self%held)) other%held = self%held
    if (allocated(self%contact)) allocate (other%contact, source=self%contact)
    if (.not. allocated(self%friction)) return
    allocate (other%friction)
    other%friction%modes = self%friction%modes
    other%friction%held = self%friction%held
    other%friction%wrenches%unique = self%friction%wrenches%unique
  end subroutine hand_on_modes

  !> Whether pairs stick, whose coordinates drives hold, or contacts.
  pure logical function any_sticks(self)
    class(motion_system_type), intent(in) :: self        !< the system

    any_sticks = .false.
    if (allocated(self%friction)) any_sticks = size(self%friction%held) > 0
    if (allocated(self%contact)) any_sticks = any_sticks .or. self%contact%any_sticks()
  end function any_sticks

  !> Length of the vector that is integrated.
  pure integer function size_of_vector(self)
    class(motion_system_type), intent(in) :: self   !< the motion system

    size_of_vector = self%size_of_motion() + 2*self%count_varied()
    if (allocated(self%sensitivity)) size_of_vector = size_of_vector + size(self%sensitivity%motors(:, :, 0))
  end function size_of_vector

  !> Length of the part of the vector that is the motion itself.
  pure integer function size_of_motion(self)
    class(motion_system_type), intent(in) :: self   !< the motion system

    size_of_motion = length_of_vector(self%plan, size(self%model%mechanism%motors))
  end function size_of_motion

  !> How many derivatives of free coordinates by parameters are integrated.
  pure integer function count_varied(self)
    class(motion_system_type), intent(in) :: self   !< the motion system

    count_varied = 0
    if (allocated(self%sensitivity)) count_varied = size(self%sensitivity%values(:, :, 0))
  end function count_varied

  !> The vector of the present state.
  pure function vector(self) result(y)
    class(motion_system_type), intent(in) :: self   !< the motion system
    real(wp) :: y(self%size_of_vector())

    call pack_state(self%plan, self%state, y)
    if (.not. allocated(self%sensitivity)) return
    call self%sensitivity%pack(y(self%size_of_motion() + 1:))
  end function vector

  !> Integrate the derivatives by all parameters as well, from those of the free coordinates and their rates that are given, or
  !> from those that the start of the motion has. To be called before the integration begins.
  subroutine begin_sensitivity(self, variable, err, values, motors, held)
    class(motion_system_type), intent(inout) :: self        !< the motion system, with its motion
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp), intent(in), optional :: values(:, 0:, :)      !< (P,0:2,M) derivatives of all coordinates
    real(wp), intent(in), optional :: motors(:, :)          !< (P,motors) those of the motors' states
    real(wp), allocatable, intent(in), optional :: held(:, :, :)   !< (P,0:2,M) those of driven coordinates beside their drives' numbers

    allocate (self%sensitivity)
    call new_motion_sensitivity(variable, self%model, self%plan, self%dynamics, self%sensitivity, err)
    if (allocated(err)) return
    if (present(motors)) self%sensitivity%motors(:, :, 0) = motors
    if (present(held)) then
      if (allocated(held)) allocate (self%sensitivity%motion%held(size(held, 1), 0:2, size(held, 3)), source=held)
    end if
    if (present(values)) then
      self%sensitivity%values(:, :, 0) = values(:, 0, self%plan%free)
      self%sensitivity%values(:, :, 1) = values(:, 1, self%plan%free)
    else
      call self%sensitivity%start()
    end if
    call self%present(err)
    ! the whole motion shows where derivatives do not exist
    if (.not. allocated(err)) call self%show_sensitivity(err)
  end subroutine begin_sensitivity

  !> Find the derivatives of the whole present motion by all parameters.
  subroutine show_sensitivity(self, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system, with its motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%sensitivity%complete(self%model, self%state, err)
  end subroutine show_sensitivity

  !> Find the derivatives of the part of its bound that a pair needs which sticks alone, at a state that is presented.
  subroutine vary_friction(self, number, changes, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system, with its motion
    integer, intent(in) :: number                       !< of the friction
    real(wp), intent(out) :: changes(:)                 !< (P) the derivatives
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call vary_accelerations(self, err, with_sticking=.true.)
    if (.not. allocated(err)) call vary_use(self%model, self%plan, self%state, self%friction, self%sensitivity, &
                                            self%varied_frictions, number, changes, err)
  end subroutine vary_friction

  !> Find the derivatives of the free accelerations, for a motion whose accelerations are complete.
  subroutine vary_accelerations(self, err, with_sticking)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical, intent(in), optional :: with_sticking      !< frictions of pairs that stick are found, too; not unless given
    logical :: rubs

    call self%sensitivity%find_accelerations(self%model, self%state, self%work, err)
    if (allocated(self%contact) .and. .not. allocated(err)) call find_varied_contacts(self%model, self%plan, self%dynamics, &
      self%state, self%work, self%contact, self%sensitivity, err)
    if (allocated(err) .or. .not. allocated(self%friction)) return
    rubs = present(with_sticking) .or. self%friction%modes%any_slips() .or. any(self%model%mechanism%frictions%is_smooth)
    if (.not. rubs) return
    if (.not. allocated(self%varied_frictions)) allocate (self%varied_frictions)
    call find_varied_frictions(self%model, self%plan, self%state, self%friction, self%sensitivity, self%varied_frictions, err)
  end subroutine vary_accelerations

  !> Take time, coordinates and free rates from a vector, and the motion of the driven coordinates from their drives. Fails where
  !> a drive has no value.
  subroutine take_vector(self, t, y, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system; gets the state, whose frames are not placed yet
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the vector
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call unpack_state(self%plan, t, y, self%state)
    if (allocated(self%sensitivity)) call self%sensitivity%unpack(y(self%size_of_motion() + 1:))
    self%state%t = self%interval%time_inside(t)
    call set_inputs(self%drives, self%state%t, self%state%q, self%state%dq, self%state%ddq, err)
  end subroutine take_vector

  !> Let the motors work at other limits behind a joint: the one that passes its limit there, and all whose forces jump.
  subroutine pass_limits(self, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system behind the joint, with all rates
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of a motor has no value
    type(motor_action_type) :: action
    integer :: before

    if (size(self%model%mechanism%motors) == 0) return
    before = 0
    if (self%interval%motor > 0) before = self%state%limited(self%interval%motor)
    call find_limits(self%model%mechanism, self%plan, self%state, err)
    if (allocated(err)) return
    if (self%interval%motor > 0) then
      ! the demand is the limit but for round-off, which must not decide
      self%state%limited(self%interval%motor) = 0
      call find_action(self%model%mechanism, self%plan, self%interval%motor, self%state, action, err)
      if (allocated(err)) return
      if (before == 0) self%state%limited(self%interval%motor) = nint(sign(1.0_wp, action%demand))
      self%interval%motor = 0
    end if
    call self%present(err)
  end subroutine pass_limits

  !> Fail where a drive is elsewhere than its rates have led since the last step: it jumps.
  subroutine check_drives(self, y, err)
    class(motion_system_type), intent(in) :: self       !< the motion system, with the driven positions in its state
    real(wp), intent(in) :: y(:)                        !< the vector at the end of a step, with their integrated rates
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i, k

    do i = 1, size(self%drives)
      k = self%drives(i)%drive%coordinate
      if (abs(self%state%q(k) - y(k)) <= trusted_closing*self%plan%unit_of(k)) cycle
      call raise(err, exit_singular, failure_drive_jumps)
      err%failure%t = self%state%t
      err%failure%coordinates = [k]
      return
    end do
  end subroutine check_drives

  !> Derivatives of the vector. A trial state in a singular position fails with exit_singular.
  subroutine rate(self, t, y, ydot, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the vector: all coordinates, rates of the free ones, states of motors
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call take_vector(self, t, y, err)
    if (.not. allocated(err)) call place_all(self%plan, self%state, err)
    if (.not. allocated(err)) call accelerate(self, err)
    if (allocated(err)) return
    if (self%conditioning() < self%refuse_below) then
      call raise(err, exit_singular, failure_singular_step)
      return
    end if
    if (self%just_projected) call remember(self)
    call find_motor_rates(self%model%mechanism, self%plan, self%state, err)
    if (allocated(err)) return
    call pack_rates(self%plan, self%state, self%work%accelerations, ydot)
    if (.not. allocated(self%sensitivity)) return
    call complete_accelerations(self%plan, self%dynamics, self%work, self%state)
    call vary_accelerations(self, err)
    if (allocated(err)) return
    call self%sensitivity%pack_rates(ydot(self%size_of_motion() + 1:))
  end subroutine rate

  !> Keep the accelerations of the first evaluation after an accepted step.
  pure subroutine remember(self)
    class(motion_system_type), intent(inout) :: self   !< the motion system

    self%just_projected = .false.
    ! there are no accelerations to expect where all coordinates are independent
    if (size(self%plan%closures) == 0) return
    call self%work%expectation%remember(self%state%t, self%work%jacobian%b, self%state%ddq)
  end subroutine remember

  !> Close the chains after an accepted step, and put the closed positions into the vector.
  subroutine project(self, t, y, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    real(wp), intent(in) :: t                           !< time of the end of the step [s]
    real(wp), intent(inout) :: y(:)   !< the vector: coordinates, free rates, motors; closed on return
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: failed

    call take_vector(self, t, y, err)
    if (.not. allocated(err)) call check_drives(self, y, err)
    if (.not. allocated(err)) call close_chains(self, trusted_closing, failed, err)
    if (allocated(err)) return
    if (failed > 0) then
      call raise(err, exit_singular, failure_unclosed_step)
      err%failure%chains = self%plan%blocks(failed)%chains
      err%failure%t = t
      return
    end if
    call close_contacts(self, trusted_closing, failed, err)
    if (allocated(err)) return
    call pack_state(self%plan, self%state, y)
    self%just_projected = .true.
  end subroutine project

  !> Close the chains of the present state. A block fails if it does not close, or changes a coordinate by more than is trusted.
  subroutine close_chains(self, trusted, failed, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    real(wp), intent(in) :: trusted                     !< change of a coordinate, in its unit
    integer, intent(out) :: failed                      !< number of the block that does not close; 0: none
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(newton_outcome_type) :: outcome
    integer :: b

    failed = 0
    do b = 1, size(self%plan%blocks)
      call close_block(self%plan, self%plan%blocks(b), self%state, self%work%blocks(b), outcome, err)
      if (allocated(err)) return
      self%iterations = self%iterations + outcome%iterations
      failed = b
      if (.not. outcome%converged .or. outcome%correction > trusted) return
    end do
    failed = 0
  end subroutine close_chains

  !> Take the errors of integration from the gaps and the slips of contacts that are closed, in the present state with closed chains.
  subroutine close_contacts(self, trusted, failed, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    real(wp), intent(in) :: trusted                     !< change of a coordinate by which chains are closed, in its unit
    integer, intent(out) :: failed                      !< number of the block that does not close; 0: none
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, parameter :: most_corrections = 6
    integer :: correction
    logical :: corrected

    failed = 0
    if (.not. allocated(self%contact)) return
    do correction = 1, most_corrections
      call correct_positions(self%model%mechanism, self%plan, self%dynamics, self%state, self%work, self%contact, corrected, err)
      if (allocated(err) .or. .not. corrected) exit
      call close_chains(self, trusted, failed, err)
      if (allocated(err) .or. failed > 0) return
    end do
    if (allocated(err)) return
    call correct_rates(self%model%mechanism, self%plan, self%dynamics, self%state, self%work, self%contact, err)
  end subroutine close_contacts

  !> Find a state within a step, with its rates and accelerations: the chains are closed from the vector y, an approximation.
  !> `ok` is false where they are not certain to close on the same branch.
  subroutine close_near(self, t, y, ok, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    real(wp), intent(in) :: t                           !< time between the projected states [s]
    real(wp), intent(in) :: y(:)                        !< the vector: all coordinates, rates of the free ones, states of motors
    logical, intent(out) :: ok                          !< the chains are certain to close on the same branch
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: failed

    ok = .false.
    call take_vector(self, t, y, err)
    if (allocated(err)) return
    call close_chains(self, trusted_between_steps, failed, err)
    if (allocated(err) .or. failed > 0) return
    call close_contacts(self, trusted_between_steps, failed, err)
    if (allocated(err) .or. failed > 0) return
    call self%present(err)
    self%state%t = t
    ok = .not. allocated(err)
  end subroutine close_near

  !> Move to a vector with closed chains, and find its rates and accelerations.
  subroutine move_to(self, t, y, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< projected values
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call take_vector(self, t, y, err)
    if (.not. allocated(err)) call place_all(self%plan, self%state, err)
    if (.not. allocated(err)) call self%present(err)
    self%state%t = t
  end subroutine move_to

  !> Go on with the expectation that held before side steps.
  pure subroutine resume(self, expectation)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    type(expectation_type), intent(in) :: expectation   !< continuation of rates from the positions before the steps aside

    self%work%expectation = expectation
    self%just_projected = .false.
  end subroutine resume

  !> Find all velocities and accelerations of a state whose frames are in place, and show the state in work%view as loads see
  !> it, for results.
  subroutine show_present(self, err)
    class(motion_system_type), intent(inout) :: self    !< the motion system
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call accelerate(self, err, with_sticking=.true.)
    if (allocated(err)) return
    call complete_accelerations(self%plan, self%dynamics, self%work, self%state)
    if (allocated(self%friction)) call find_heat_rates(self%model%mechanism, self%state, self%friction)
    if (allocated(self%held)) &
      call find_stop_forces(self%model%mechanism, self%plan, self%dynamics, self%held, self%state, self%work, err)
    if (.not. allocated(err)) call find_motor_rates(self%model%mechanism, self%plan, self%state, err)
    if (.not. allocated(err)) call show_state(self%plan, self%dynamics, self%state, self%work%view)
    if (allocated(self%sensitivity) .and. .not. allocated(err)) call vary_accelerations(self, err, with_sticking=.true.)
  end subroutine show_present

  !> The worst block's pivot ratio at the last evaluation: 1 is best, 0 a singular position.
  pure real(wp) function conditioning(self)
    class(motion_system_type), intent(in) :: self   !< the motion system

    conditioning = self%work%conditioning
  end function conditioning

  !> The signs of the determinants of the blocks' Jacobians at the last evaluation; those of a branch change in singular
  !> positions only.
  subroutine signs(self, found)
    class(motion_system_type), intent(inout) :: self   !< the motion system
    integer, intent(out) :: found(:)                   !< (blocks)
    integer :: b

    do b = 1, size(self%work%blocks)
      found(b) = self%work%blocks(b)%equations%determinant_sign()
    end do
  end subroutine signs

  !> Free a system, if there is one, by the one final procedure of its type; code for it would take 60 kB at each place.
  subroutine free_system(system)
    type(motion_system_type), pointer, intent(inout) :: system   !< owned; then null
    class(motion_system_type), pointer :: whole

    if (.not. associated(system)) return
    whole => system
    system => null()
    deallocate (whole)
  end subroutine free_system
end module mech9_motion_system
