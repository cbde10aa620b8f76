!> A free motion: the equations of motion are integrated from time to time, in other independent coordinates where the present
!> ones come to a singular position.
module mech9_free_simulation
  use mech9_kinds, only: wp
  use mech9_simulation_tolerances, only: doubtful_conditioning, refused_conditioning, regular_conditioning, longest_stick
  use mech9_error, only: error_type, raise, exit_singular, exit_integrator
  use mech9_simulation_failures, only: failure_lost_angles
  use mech9_model, only: model_type
  use mech9_stop_contacts, only: find_contacts
  use mech9_contact_events, only: begin_contacts
  use mech9_plan, only: plan_type, copy_plan
  use mech9_state, only: state_type, copy_state
  use mech9_block_equations, only: largest_gap
  use mech9_requested, only: requested_by_results, add_forces, add_section, leave_out_unrequested, request_planned
  use mech9_conditioning, only: conditioning_type
  use mech9_energy, only: kinetic_energy, potential_energy
  use mech9_integrator, only: integration_statistics_type
  use mech9_integrated_vector, only: unpack_state
  use mech9_motion_system, only: set_motion_system
  use mech9_held_angles, only: copy_drives
  use mech9_free_start, only: keep_coefficients
  use mech9_integrated_motion, only: integrated_motion_type
  use mech9_event_passing, only: stop_at_events
  use mech9_friction_heat, only: show_heat
  use mech9_stopped_motion, only: name_cause, name_cause_at_start, stall_watch_type, name_singular_chains
  use mech9_variable_model, only: variable_model_type
  use mech9_sensitivity, only: sensitivity_type, new_given_sensitivity
  use mech9_varied_motion, only: varied_motion_type
  use mech9_simulation, only: simulation_type, simulation_statistics_type, standing_type
  use mech9_coordinate_changes, only: add_change, same_replaced, same_independent
  implicit none
  private
  public :: free_simulation_type, new_free_simulation

  type, extends(simulation_type) :: free_simulation_type
    type(integrated_motion_type) :: motion
    type(conditioning_type) :: conditioning       !< the worst of all positions
    real(wp), allocatable :: coefficients(:, :)   !< a_pr at the start, lower triangle [kg m^2, kg m, kg]
    real(wp) :: end = 0.0_wp                      !< steps go to this time at most, unless a later one is asked for [s]
    logical, private :: steps_onto = .false.      !< no step may go beyond the time that is asked for
    type(stall_watch_type), private :: stall      !< whether steps stay short
  contains
    procedure :: begin
    procedure :: go_to
    procedure :: take_changes
    procedure :: stand_at_step
    procedure :: stride
    procedure :: end_of_stride
    procedure :: leave_joint
    procedure :: may_jump
    procedure :: look_at
    procedure :: present
    procedure :: present_for_forces
    procedure :: begin_sensitivity
    procedure :: show_sensitivity
    procedure :: begin_varied_motion
    procedure :: show_varied_motion
    procedure :: present_closure
    procedure :: watch_conditioning
    procedure :: energies
    procedure :: count_work
    procedure :: standing
    procedure :: plans
    procedure :: close => close_simulation
    procedure, private :: step
    procedure, private :: change_coordinates
    procedure, private :: change_angles
    procedure, private :: continue_angles
  end type free_simulation_type

contains

  !> A free motion from its assembled start; the accelerations there are worked out. To be closed at the end, also where this
  !> failed.
  subroutine new_free_simulation(model, plan, assembled, simulation, err, pictures)
    type(model_type), intent(in), target :: model           !< the model; it must outlive the simulation
    type(plan_type), intent(in) :: plan                     !< its plan
    type(state_type), intent(in) :: assembled               !< its closed position, with the rates of independent coordinates
    type(free_simulation_type), intent(out) :: simulation   !< to be started
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    logical, intent(in), optional :: pictures               !< the motion of all links is requested; not unless given
    type(plan_type) :: used, given
    type(state_type) :: start

    simulation%model => model
    simulation%with_energies = model%request%output%energies
    simulation%with_conditioning = model%request%output%conditioning
    simulation%with_error = model%request%solver%accuracy > 0.0_wp
    simulation%motion%t = model%request%time%start
    simulation%end = model%request%time%end
    allocate (simulation%coordinate_changes(0))
    simulation%requested = requested_by_results(model%mechanism, model%request%output, pictures)
    call add_section(model%request%section, simulation%requested)
    call add_forces(model%mechanism, simulation%requested)
    call copy_plan(plan, used)
    call leave_out_unrequested(used, simulation%requested)
    call request_planned(used, simulation%requested)
    call copy_state(assembled, start)
    call copy_plan(used, given)
    call simulation%motion%angles%begin(model, simulation%requested, used, start, err)
    if (allocated(err)) return
    allocate (simulation%motion%system)
    call simulation%motion%system%make_room()
    call copy_plan(used, simulation%motion%system%plan)
    call copy_state(start, simulation%motion%system%state)
    associate (held => simulation%motion%angles%held)
      call copy_drives(held%drives, simulation%motion%system%drives)
      call set_motion_system(model, held%partition, simulation%motion%system, err)
    end associate
    if (allocated(err)) then
      call name_cause_at_start(model, plan, assembled, err)
      return
    end if
    simulation%coefficients = simulation%motion%system%work%coefficients
    if (.not. simulation%motion%angles%in_use()) return
    ! with other angles held, those of the data file may be singular; the coefficients do not depend on which is held
    if (all(simulation%motion%angles%held%rods%is_free)) &
      call keep_coefficients(model, given, assembled, simulation%coefficients, err)
    if (.not. allocated(err)) call add_change(simulation%motion, simulation%coordinate_changes)
  end subroutine new_free_simulation

  !> Begin to integrate. The position at the start is that of the system.
  subroutine begin(self, t, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                            !< time of the start [s]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    self%motion%t = t
    call find_contacts(self%model%mechanism, self%motion%contacts)
    if (self%model%mechanism%has_frictions()) then
      allocate (self%motion%heat(size(self%model%mechanism%frictions)), source=0.0_wp)
      self%motion%heat_before = self%motion%heat
    end if
    call self%motion%begin(err)
    if ((size(self%motion%contacts%ends) > 0 .or. allocated(self%motion%system%friction)) .and. .not. allocated(err)) then
      call begin_contacts(self%motion%system, self%motion%contacts, err)
      if (.not. allocated(err)) call pass_event(self, .true., err)
    end if
    if (.not. allocated(err)) call self%motion%show_angles(err)
  end subroutine begin

  !> Pass what ended the last step: a joint of a law, the limit of a motor, or an event of a contact. At the start, contacts are met alone.
  subroutine pass_event(self, at_start, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    logical, intent(in) :: at_start                      !< there was no step yet
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    integer :: before, rubbing

    before = self%motion%systems
    rubbing = 0
    ! angles are continued within the step, which is forgotten behind the event
    if (.not. at_start) call continue_to_step(self, err)
    if (allocated(err)) return
    if (at_start) call self%motion%meet_events(0, 0, rubbing, 0.0_wp*self%motion%system%state%dq, .true., self%events, &
                                                self%impacts, err)
    if (.not. at_start) call self%motion%pass_joint(self%events, self%impacts, err)
    if (allocated(err)) return
    call self%stall%forget()
    if (self%motion%systems > before .and. .not. same_independent(self%motion, self%coordinate_changes)) &
      call add_change(self%motion, self%coordinate_changes)
  end subroutine pass_event

  !> The motion at time t, by steps up to there or beyond.
  subroutine go_to(self, t, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                            !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    logical :: found

    self%steps_onto = .false.
    found = .false.
    associate (motion => self%motion)
      do
        do while ((t - motion%t)*sign(1.0_wp, self%end - self%model%request%time%start) > 0.0_wp)
          call self%stop_if_interrupted(t, err)
          if (.not. allocated(err)) call self%step(t, err)
          if (allocated(err)) return
        end do
        if (.not. abs(t - motion%t) > 0.0_wp) then
          ! a time that lies before the joint by more than round-off is asked for to see this side
          if (motion%system%interval%is_end(t) .and. .not. motion%system%interval%is_before_end(t)) &
            call pass_event(self, .false., err)
          if (allocated(err)) return
          exit
        end if
        call self%motion%look_between(t, found)
        if (found .and. allocated(motion%system%friction)) call show_heat(motion, t, found, err)
        if (found .or. allocated(err)) exit
        self%steps_onto = .true.
        if (allocated(motion%system%friction)) motion%heat = motion%heat_before
        call motion%step_back(t, err)
        if (allocated(err)) return
      end do
      if (allocated(err)) return
      if (.not. found) then
        call motion%system%move_to(t, motion%y, err)
        if (allocated(motion%system%friction)) motion%system%state%heat = motion%heat
      end if
      if (.not. allocated(err)) call self%continue_angles(t, err)
      if (.not. allocated(err)) call motion%show_angles(err)
    end associate
  end subroutine go_to

  !> Go on from the time at which the system stands with numbers of loads or motors of the model that were changed. Steps no longer go
  !> beyond the times that are asked for, since more changes may come.
  subroutine take_changes(self, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation, started
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    integer :: rubbing

    rubbing = 0
    self%t = self%motion%system%state%t
    self%end = self%t
    if (self%motion%contacts%any_held() .or. allocated(self%motion%system%friction)) then
      ! stops and frictions hold other coordinates under other loads
      if (allocated(self%motion%system%friction)) self%motion%heat = self%motion%system%state%heat
      self%motion%t = self%t
      self%motion%y = self%motion%system%vector()
      call self%motion%meet_events(0, 0, rubbing, 0.0_wp*self%motion%system%state%dq, .false., self%events, self%impacts, err)
    else
      call self%motion%restart(self%t, self%motion%system%vector(), err)
    end if
    if (.not. allocated(err)) call self%motion%show_angles(err)
  end subroutine take_changes

  !> Stand at the end of the last step that was accepted, after a failure beyond it.
  subroutine stand_at_step(self, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation, started
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    call self%motion%system%move_to(self%motion%t, self%motion%y, err)
    if (.not. allocated(err)) call self%continue_angles(self%motion%t, err)
    if (.not. allocated(err)) call self%motion%show_angles(err)
  end subroutine stand_at_step

  !> Make a step. It may go beyond the time.
  subroutine stride(self, t, from, to, at_joint, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation, started
    real(wp), intent(in) :: t                            !< time to go towards [s]
    real(wp), intent(out) :: from                        !< start of the step [s]
    real(wp), intent(inout) :: to                        !< end of the step before; then of this one [s]
    logical, intent(out) :: at_joint                     !< rates may jump at its end, or the equations of motion change
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    self%steps_onto = .false.
    at_joint = .false.
    do
      from = self%motion%t
      call self%stop_if_interrupted(t, err)
      if (.not. allocated(err)) call self%step(t, err)
      if (allocated(err)) return
      if (abs(self%motion%t - from) > 0.0_wp) exit
    end do
    to = self%motion%t
    at_joint = self%motion%system%interval%is_end(to)
  end subroutine stride

  !> The end of the last step [s].
  pure real(wp) function end_of_stride(self, known)
    class(free_simulation_type), intent(in) :: self   !< the simulation, started
    real(wp), intent(in) :: known                     !< the end of the last stride [s]

    end_of_stride = self%motion%t
  end function end_of_stride

  !> Pass what ended the last step, and stand behind it.
  subroutine leave_joint(self, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation, started
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    if (self%motion%system%interval%is_end(self%motion%t)) call pass_event(self, .false., err)
    if (.not. allocated(err)) call self%stand_at_step(err)
  end subroutine leave_joint

  !> Whether stops, contacts or frictions may let rates or accelerations jump.
  pure logical function may_jump(self)
    class(free_simulation_type), intent(in) :: self   !< the simulation

    may_jump = self%model%mechanism%has_contacts() .or. self%model%mechanism%has_frictions() .or. &
               size(self%model%mechanism%stops) > 0
  end function may_jump

  !> Stand at a time within the last step, before what ended it.
  subroutine look_at(self, t, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation, started
    real(wp), intent(in) :: t                            !< the time [s]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    if (abs(t - self%motion%t) > 0.0_wp) then
      call self%go_to(t, err)
    else
      call self%stand_at_step(err)
      if (allocated(self%motion%heat)) self%motion%system%state%heat = self%motion%heat
    end if
  end subroutine look_at

  !> Continue the angles of the data file to a time within the last step, over ways that are short enough, if others are
  !> integrated. The system stands at this time before and after.
  subroutine continue_angles(self, t, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                            !< time within the last step [s]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    real(wp) :: part, to

    associate (motion => self%motion, angles => self%motion%angles)
      if (.not. angles%in_use()) return
      if (angles%may_continue(motion%system%state)) then
        call angles%continue_to(motion%system%state)
        return
      end if
      part = 0.5_wp*(t - angles%t)
      do while (abs(t - angles%t) > 0.0_wp)
        to = angles%t + part
        if (abs(part) >= abs(t - angles%t)) to = t
        call stand_at(self, to, err)
        if (allocated(err)) return
        if (angles%may_continue(motion%system%state)) then
          call angles%continue_to(motion%system%state)
          part = 2.0_wp*part
        else
          part = 0.5_wp*(to - angles%t)
        end if
      end do
    end associate
  end subroutine continue_angles

  !> Move the system to a time within the last step, or to its end.
  subroutine stand_at(self, t, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                            !< the time [s]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    logical :: found

    if (.not. abs(t - self%motion%t) > 0.0_wp) then
      call self%motion%system%move_to(t, self%motion%y, err)
      return
    end if
    call self%motion%look_between(t, found)
    if (found) return
    call raise(err, exit_singular, failure_lost_angles)
    err%failure%t = t
    err%failure%coordinates = self%motion%angles%replaced_coordinates()
    call name_singular_chains(self%motion%system, t, doubtful_conditioning, err)
  end subroutine stand_at

  !> One accepted step towards t, with a change of coordinates before it where that helps. It may go beyond, but near
  !> a singular position of the independent coordinates, where the times that are asked for are ends of steps.
  subroutine step(self, t, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                            !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(error_type), allocatable :: failure
    real(wp) :: target, farthest, from, longest
    logical :: changed, is_regular, stalls

    if (self%motion%system%interval%is_end(self%motion%t)) call pass_event(self, .false., err)
    if (.not. allocated(err)) call self%change_angles(err)
    if (allocated(err)) return
    associate (motion => self%motion)
      is_regular = motion%conditioning_here > doubtful_conditioning
      if (is_regular) motion%look_below = doubtful_conditioning
      if (motion%conditioning_here < motion%look_below) then
        call self%change_coordinates(changed, err)
        if (allocated(err)) return
        is_regular = motion%conditioning_here > doubtful_conditioning
      end if
      motion%system%refuse_below = merge(refused_conditioning, 0.0_wp, is_regular)
      target = t
      farthest = t
      from = motion%t
      if (motion%conditioning_here > regular_conditioning .and. .not. self%steps_onto .and. &
        (self%end - t)*(t - motion%t) > 0.0_wp) &
        farthest = self%end
      if (motion%system%any_sticks() .or. motion%contacts%any_held()) then
        ! steps do not see the loads on what is held, which may change with time
        associate (time => self%model%request%time)
          longest = longest_stick*merge(time%end - time%start, farthest - motion%t, abs(time%end - time%start) > 0.0_wp)
        end associate
        target = nearer(target, motion%t + longest, motion%t)
        farthest = nearer(farthest, motion%t + longest, motion%t)
      end if
      if (motion%system%interval%ends) then
        target = nearer(target, motion%system%interval%ahead, motion%t)
        farthest = nearer(farthest, motion%system%interval%ahead, motion%t)
      end if
      call motion%integrator%step(target, motion%t, motion%y, failure, farthest)
      if (.not. allocated(failure)) then
        motion%conditioning_here = motion%system%conditioning()
        call motion%dense_output%add(motion%system, motion%t, motion%y)
        call stop_at_events(motion, err)
        associate (time => self%model%request%time)
          call self%stall%note(abs(motion%t - from), abs(time%end - time%start), motion%conditioning_here, stalls)
        end associate
        if (stalls .and. .not. allocated(err)) call self%stall%name_stall(motion%system, motion%t, motion%y, err)
        return
      end if
    end associate
    ! perhaps the integrator stopped at a singular position of these coordinates only
    if (failure%code == exit_singular .or. failure%code == exit_integrator) then
      call self%change_coordinates(changed, err)
      if (changed .or. allocated(err)) return
    end if
    call name_cause(self%motion%system, self%motion%t, self%motion%y, self%coefficients, failure)
    call move_alloc(failure, err)
  end subroutine step

  !> The nearer one of two times ahead.
  pure real(wp) function nearer(a, b, t)
    real(wp), intent(in) :: a   !< a time [s]
    real(wp), intent(in) :: b   !< another time [s]
    real(wp), intent(in) :: t   !< the present time [s]

    nearer = a
    if (abs(b - t) < abs(a - t)) nearer = b
  end function nearer

  !> Go on in better conditioned independent coordinates, if there are any; that is an event.
  subroutine change_coordinates(self, changed, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    logical, intent(out) :: changed                      !< the independent coordinates are others now
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    call self%motion%change_coordinates(changed, err)
    if (changed) call add_change(self%motion, self%coordinate_changes)
  end subroutine change_coordinates

  !> Go on with other angles in ball joints that are near gimbal lock; that is an event.
  subroutine change_angles(self, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    logical :: changed

    associate (motion => self%motion)
      if (size(motion%angles%joints) == 0 .and. size(motion%angles%held%rods) == 0) return
      call continue_to_step(self, err)
      if (.not. allocated(err)) call motion%change_angles(changed, err)
      if (allocated(err)) return
    end associate
    associate (changes => self%coordinate_changes)
      if (changed) changed = .not. (same_replaced(self%motion, changes) .and. same_independent(self%motion, changes))
    end associate
    if (changed) call add_change(self%motion, self%coordinate_changes)
  end subroutine change_angles

  !> Continue the angles of the data file to the end of the last step, if others are integrated.
  subroutine continue_to_step(self, err)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    associate (motion => self%motion)
      if (.not. motion%angles%in_use()) return
      call unpack_state(motion%system%plan, motion%t, motion%y, motion%system%state)
      call self%continue_angles(motion%t, err)
    end associate
  end subroutine continue_to_step

  !> The plan in the present independent coordinates and the present state, in the angles of the data file.
  subroutine present(self, plan, state)
    class(free_simulation_type), intent(in), target :: self   !< the simulation
    type(plan_type), pointer, intent(out) :: plan             !< the plan that is executed
    type(state_type), pointer, intent(out) :: state           !< the present state

    if (self%motion%angles%in_use()) then
      plan => self%motion%angles%plan
      state => self%motion%angles%state
    else
      plan => self%motion%system%plan
      state => self%motion%system%state
    end if
  end subroutine present

  !> The plan and the state in the angles that are integrated, where wrenches are the same in these.
  subroutine present_for_forces(self, plan, state)
    class(free_simulation_type), intent(in), target :: self   !< the simulation
    type(plan_type), pointer, intent(out) :: plan             !< the plan
    type(state_type), pointer, intent(out) :: state           !< the present state

    call self%present(plan, state)
    if (.not. self%motion%angles%give_same_wrenches()) return
    plan => self%motion%system%plan
    state => self%motion%system%state
  end subroutine present_for_forces

  !> Integrate the derivatives of the motion by all parameters as well, from the start on. Fails where they do not exist.
  subroutine begin_sensitivity(self, variable, highest, sensitivity, err)
    class(free_simulation_type), intent(inout) :: self                 !< the simulation
    class(variable_model_type), intent(inout), target :: variable      !< the model as a function of its parameters; outlives it
    integer, intent(in) :: highest                                     !< order of the highest derivative in time
    type(sensitivity_type), intent(out) :: sensitivity                 !< room for the results
    type(error_type), allocatable, intent(out) :: err                  !< allocated if it failed

    call self%motion%begin_sensitivity(variable, err)
    if (allocated(err)) return
    call new_given_sensitivity(self%model, highest, sensitivity)
  end subroutine begin_sensitivity

  !> Find the derivatives of the present motion by all parameters.
  subroutine show_sensitivity(self, sensitivity, err)
    class(free_simulation_type), intent(inout) :: self       !< the simulation
    type(sensitivity_type), intent(inout) :: sensitivity     !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed

    call self%motion%system%show_sensitivity(err)
    if (allocated(err)) return
    associate (motion => self%motion%system%sensitivity%motion)
      call sensitivity%changes%put(1, motion%q, motion%points)
    end associate
    sensitivity%waiting = 1
  end subroutine show_sensitivity

  !> Prepare the derivatives of all frames by all parameters. The integration finds them in any case.
  subroutine begin_varied_motion(self, variable, err)
    class(free_simulation_type), intent(inout) :: self                 !< the simulation, after begin_sensitivity
    class(variable_model_type), intent(inout), target :: variable      !< the model as a function of its parameters
    type(error_type), allocatable, intent(out) :: err                  !< never allocated

  end subroutine begin_varied_motion

  !> The derivatives of all frames in the present motion, after show_sensitivity for it.
  subroutine show_varied_motion(self, motion, err)
    class(free_simulation_type), intent(inout), target :: self       !< the simulation
    type(varied_motion_type), pointer, intent(out) :: motion         !< the derivatives; they change with the next time
    type(error_type), allocatable, intent(out) :: err                !< never allocated

    motion => self%motion%system%sensitivity%motion
  end subroutine show_varied_motion

  !> Largest closure error of the present position [m].
  real(wp) function present_closure(self)
    class(free_simulation_type), intent(in) :: self   !< the simulation

    present_closure = largest_gap(self%motion%system%plan, self%motion%system%state)
  end function present_closure

  !> Take the conditioning of the present position into account.
  subroutine watch_conditioning(self, always)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    logical, intent(in) :: always                        !< work it out in any case

    if (always) then
      call self%conditioning%update(self%t, self%motion%system%work%blocks, self%least_conditioning)
    else
      call self%conditioning%update_by_pivots(self%t, self%motion%system%work%blocks)
    end if
  end subroutine watch_conditioning

  !> Energies of the present position.
  subroutine energies(self, kinetic, potential)
    class(free_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(out) :: kinetic                     !< of all bodies [J]
    real(wp), intent(out) :: potential                   !< of gravity and springs [J]

    associate (system => self%motion%system)
      kinetic = kinetic_energy(self%model%mechanism, system%plan, system%state)
      potential = potential_energy(self%model%mechanism, system%plan, system%state, system%work%view)
    end associate
  end subroutine energies

  !> Steps of the integrators, evaluations of the accelerations, and iterations of Newton's method.
  subroutine count_work(self, statistics)
    class(free_simulation_type), intent(inout) :: self              !< the simulation
    type(simulation_statistics_type), intent(inout) :: statistics   !< gets the work
    type(integration_statistics_type) :: counts

    counts = self%motion%statistics()
    statistics%steps = counts%steps
    statistics%evaluations = counts%rate_evaluations
    statistics%newton_iterations = self%motion%iterations()
  end subroutine count_work

  !> How many plans the motion had before the present one: one for each choice of coordinates.
  pure integer function plans(self)
    class(free_simulation_type), intent(in) :: self   !< the simulation

    plans = self%motion%systems
  end function plans

  !> The end of the last step, and the coordinate that moves fastest there.
  type(standing_type) function standing(self)
    class(free_simulation_type), intent(inout) :: self              !< the simulation
    type(integration_statistics_type) :: counts

    counts = self%motion%statistics()
    standing%t = self%motion%t
    standing%step = abs(counts%last_step)
    standing%conditioning = self%motion%conditioning_here
    associate (system => self%motion%system)
      standing%fastest = maxloc(abs(system%state%dq)/system%plan%unit_of, dim=1)
      standing%rate = system%state%dq(standing%fastest)
    end associate
  end function standing

  !> Free the memory of the motion.
  subroutine close_simulation(self)
    class(free_simulation_type), intent(inout) :: self   !< the simulation

    call self%motion%close()
    self%started = .false.
  end subroutine close_simulation
end module mech9_free_simulation
