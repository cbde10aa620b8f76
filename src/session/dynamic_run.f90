!> The run of mech9d: integrating the motion from output to output, in other independent coordinates where the present ones come
!> to a singular position.
module mech9_dynamic_run
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_singular, exit_integrator
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_block_solver, only: work_count_type, work_of
  use mech9_requested, only: requested_by_results, add_forces, leave_out, stay_with
  use mech9_conditioning, only: conditioning_type
  use mech9_energy, only: kinetic_energy, potential_energy
  use mech9_coordinate_choice, only: best_independent, with_independent
  use mech9_expectation, only: expectation_type
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_dense_output, only: dense_output_type
  use mech9_side_steps, only: side_steps_type, begin_integration
  use mech9_ode_system, only: is_recoverable
  use mech9_integrator, only: integrator_type, integration_statistics_type
  use mech9_columns, only: kinematic_columns
  use mech9_closure_guard, only: check_closure
  use mech9_recording, only: motion_source_type, stop_if_interrupted
  use mech9_geometry_text, only: explain_geometry
  use mech9_block_equations, only: largest_gap
  implicit none
  private
  public :: dynamic_run_type, event_type, start_dynamic_run, assemble_initial_state

  !> Below this conditioning other independent coordinates are looked for ...
  real(wp), parameter :: doubtful = 0.08_wp
  !> ... and taken if they are so many times better conditioned; else the next look is at so many
  !> times worse conditioning.
  real(wp), parameter :: worth_it = 4.0_wp
  !> Above this conditioning a step may go beyond outputs: it will not come to a singular position unseen.
  real(wp), parameter :: regular = 0.14_wp
  !> A step from a well conditioned state is made again, shorter, where it meets worse than this.
  real(wp), parameter :: refused = 0.03_wp

  !> A change of the independent coordinates.
  type :: event_type
    real(wp) :: t = 0.0_wp
    integer, allocatable :: independent(:)   !< from then on
  end type event_type

  type, extends(motion_source_type) :: dynamic_run_type
    type(motion_system_type), pointer :: system => null()   !< owned; the integrator keeps hold of it
    type(integrator_type) :: integrator
    real(wp), allocatable :: y(:)                 !< the integrated vector
    real(wp), allocatable :: coefficients(:, :)   !< a_pr at the start, lower triangle
    type(event_type), allocatable :: events(:)
    real(wp) :: t = 0.0_wp                        !< of the end of the last step [s]
    real(wp) :: end = 0.0_wp                      !< steps may go to there at most [s]
    type(dense_output_type) :: dense_output           !< outputs inside a step
    type(side_steps_type) :: aside                !< go onto outputs that are not certain otherwise
    logical :: steps_onto = .false.               !< no step may go beyond the next output
    real(wp) :: conditioning_here = 0.0_wp        !< at the end of the last step
    real(wp) :: look_below = doubtful             !< conditioning at which other coordinates are looked for
    logical :: started = .false.
    type(integration_statistics_type) :: before   !< of the integrators before the present one
    type(work_count_type) :: work_before          !< for the blocks of the systems before the present one
    real(wp) :: energy_at_start = 0.0_wp          !< [J]
    real(wp) :: largest_energy_change = 0.0_wp    !< of kinetic + potential, against the start [J]
    real(wp) :: worst_closure = 0.0_wp            !< [m]
    type(conditioning_type) :: conditioning       !< the worst of all outputs
  contains
    procedure :: row_at
    procedure :: statistics
    procedure :: work_done
    procedure :: close => close_run
    procedure, private :: go_to
    procedure, private :: step
    procedure, private :: look_between
    procedure, private :: insert
    procedure, private :: step_back
    procedure, private :: start_integrator
    procedure, private :: stop_integrator
    procedure, private :: change_coordinates
    procedure, private :: fill_energies
  end type dynamic_run_type

contains

  !> Plan and assembled initial state: positions and rates of the independent coordinates as given; those
  !> at rest need no velocity.
  subroutine assemble_initial_state(mechanism, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(out) :: plan   !< the plan of the mechanism
    type(state_type), intent(out) :: state   !< position and motion of the mechanism
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: k

    do k = 1, size(mechanism%pairs)
      if (mechanism%position_given(k) .or. .not. mechanism%structure%independent(k)) cycle
      call raise(err, exit_data, 'the independent coordinate '//to_text(k)//' of this pair has no initial position; '// &
                 'give &initial coordinate='//to_text(k)//', position=..., velocity=... /', &
                 mechanism%pairs(k)%pair%place)
      return
    end do
    call make_plan(mechanism, mechanism%initial_position, plan, state, err)
    call explain_geometry(mechanism, err)
    if (allocated(err)) return
    state%t = mechanism%time%start
    state%dq(plan%independent) = mechanism%initial_velocity(plan%independent)
  end subroutine assemble_initial_state

  !> A run from an assembled initial state; its motion at the start is worked out. To be closed at the end.
  subroutine start_dynamic_run(mechanism, plan, start, run, err, pictures)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start
    type(dynamic_run_type), intent(out) :: run
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical, intent(in), optional :: pictures      !< of the mechanism are wanted; not unless given
    type(plan_type) :: used

    run%program_name = 'mech9d'
    run%columns = kinematic_columns(mechanism)
    if (mechanism%output%energies) then
      call run%columns%append('E.kinetic', 'J', 'kinetic energy')
      call run%columns%append('E.potential', 'J', 'potential energy of gravity and springs')
      call run%columns%append('E.total', 'J', 'kinetic and potential energy')
    end if
    call run%columns%append('closure', 'm', 'largest error of a closed chain')
    if (mechanism%output%conditioning) &
      call run%columns%append('conditioning', '1', 'least singular value of the worst chains')
    run%t = mechanism%time%start
    run%end = mechanism%time%end
    allocate (run%events(0))
    run%requested = requested_by_results(mechanism, pictures)
    call add_forces(mechanism, run%requested)
    used = plan
    call leave_out(used, run%requested)
    call stay_with(used, run%requested)
    allocate (run%system)
    call set_motion_system(mechanism, used, start, run%system, err)
    if (allocated(err)) then
      if (err%code == exit_singular) &
        err%message = err%message//'; choose other independent coordinates, or start a little beside it'
      return
    end if
    run%coefficients = run%system%work%coefficients
  end subroutine start_dynamic_run

  !> State, energies and closure at time t.
  subroutine row_at(self, t, row, err)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    real(wp), intent(in) :: t
    real(wp), intent(inout) :: row(:)
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: gap
    integer :: next

    if (self%started) then
      call self%go_to(t, err)
    else
      call self%start_integrator(err)
    end if
    if (allocated(err)) return
    gap = largest_gap(self%system%plan, self%system%state)
    call check_closure(self%system%plan, t, gap, err)
    if (allocated(err)) return
    associate (system => self%system)
      call self%columns%fill(system%mechanism, system%plan, system%state, row)
      next = self%columns%motion + 1
      if (system%mechanism%output%energies) then
        call self%fill_energies(row(next:next + 2))
        next = next + 3
      end if
      call self%columns%fill_poses(system%plan, system%state, row)
      row(next) = gap
      if (system%mechanism%output%conditioning) then
        call self%conditioning%look(t, system%work%blocks, row(next + 1))
      else
        call self%conditioning%glance(t, system%work%blocks)
      end if
      if (allocated(self%film)) call self%film%take(system%mechanism, system%plan, system%state, row)
    end associate
    self%started = .true.
    self%worst_closure = max(self%worst_closure, row(next))
  end subroutine row_at

  !> Kinetic and potential energy and their sum [J], and how far that goes from the start.
  subroutine fill_energies(self, energies)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    real(wp), intent(out) :: energies(3)

    associate (system => self%system)
      energies(1) = kinetic_energy(system%dynamics, system%state)
      energies(2) = potential_energy(system%mechanism, system%plan, system%state, system%work%view)
    end associate
    energies(3) = energies(1) + energies(2)
    if (.not. self%started) self%energy_at_start = energies(3)
    self%largest_energy_change = max(self%largest_energy_change, abs(energies(3) - self%energy_at_start))
  end subroutine fill_energies

  !> The motion at time t, by steps up to there or beyond.
  subroutine go_to(self, t, err)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    real(wp), intent(in) :: t
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical :: found

    self%steps_onto = .false.
    do
      do while ((t - self%t)*sign(1.0_wp, self%end - self%system%mechanism%time%start) > 0.0_wp)
        call stop_if_interrupted(t, err)
        if (.not. allocated(err)) call self%step(t, err)
        if (allocated(err)) return
      end do
      if (.not. abs(t - self%t) > 0.0_wp) exit
      call self%look_between(t, found)
      if (found) return
      call self%step_back(t, err)
      if (allocated(err)) return
    end do
    call self%system%move_to(t, self%y, err)
  end subroutine go_to

  !> One accepted step towards t, with a change of coordinates before it where that helps. It may go beyond, but near
  !> a singular position of the independent coordinates, where outputs are ends of steps.
  subroutine step(self, t, err)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    real(wp), intent(in) :: t
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(error_type), allocatable :: failure
    real(wp) :: farthest
    logical :: changed, is_regular

    is_regular = self%conditioning_here > doubtful
    if (is_regular) self%look_below = doubtful
    if (self%conditioning_here < self%look_below) then
      call self%change_coordinates(changed, err)
      if (allocated(err)) return
      is_regular = self%conditioning_here > doubtful
    end if
    self%system%refuse_below = merge(refused, 0.0_wp, is_regular)
    farthest = t
    if (self%conditioning_here > regular .and. .not. self%steps_onto .and. (self%end - t)*(t - self%t) > 0.0_wp) &
      farthest = self%end
    call self%integrator%step(t, self%t, self%y, failure, farthest)
    if (.not. allocated(failure)) then
      self%conditioning_here = self%system%conditioning()
      call self%dense_output%add(self%system, self%t, self%y)
      return
    end if
    ! perhaps the integrator stopped at a singular position of these coordinates only
    if (failure%code == exit_singular .or. failure%code == exit_integrator) then
      call self%change_coordinates(changed, err)
      if (changed .or. allocated(err)) return
    end if
    call move_alloc(failure, err)
  end subroutine step

  !> The motion at a time within the last step: as the method tells it, or by the ends of the last steps, or with points
  !> between them, or by steps onto it. `found` is false where none of these leads there.
  subroutine look_between(self, t, found)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    real(wp), intent(in) :: t
    logical, intent(out) :: found
    type(error_type), allocatable :: err
    real(wp) :: from, y(size(self%y))

    found = .false.
    if (self%dense_output%crosses()) return
    call self%integrator%interpolate(t, y, found)
    if (.not. found) call self%dense_output%find(self%system, t, y, found, err)
    if (.not. (found .or. self%dense_output%count_inserted() > 0)) then
      call self%insert(0.5_wp, err)
      if (.not. allocated(err)) call self%dense_output%find(self%system, t, y, found, err)
    end if
    if (.not. (found .or. allocated(err) .or. self%dense_output%count_inserted() > 1)) then
      call self%insert(0.25_wp, err)
      if (.not. allocated(err)) call self%insert(0.75_wp, err)
      if (.not. allocated(err)) call self%dense_output%find(self%system, t, y, found, err)
    end if
    if (allocated(err)) return
    if (found) call self%system%close_near(t, y, found, err)
    if (found) found = self%dense_output%agrees(self%system)
    if (found) return
    call self%dense_output%start_of_step(from, y)
    call self%aside%reach(self%system, from, y, t, err)
    if (.not. allocated(err)) call self%system%move_to(t, self%aside%y, err)
    found = .not. allocated(err)
  end subroutine look_between

  !> Work out a point that divides the last step.
  subroutine insert(self, part, err)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    real(wp), intent(in) :: part
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: from, y(size(self%y))

    call self%dense_output%start_of_step(from, y)
    call self%aside%reach(self%system, from, y, from + part*(self%t - from), err)
    if (.not. allocated(err)) call self%dense_output%insert(self%aside%t, self%aside%y)
  end subroutine insert

  !> Back to the start of the last step, to go onto time t within it.
  subroutine step_back(self, t, err)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    real(wp), intent(in) :: t
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(expectation_type) :: nothing

    self%steps_onto = .true.
    call self%dense_output%start_of_step(self%t, self%y)
    call self%system%resume(nothing)
    call self%system%move_to(self%t, self%y, err)
    if (.not. allocated(err)) call self%integrator%restart(self%t, self%y, err, first_step=t - self%t)
    if (allocated(err)) return
    self%conditioning_here = self%system%conditioning()
    call self%dense_output%begin()
    call self%dense_output%add(self%system, self%t, self%y)
  end subroutine step_back

  subroutine start_integrator(self, err)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    self%y = self%system%vector()
    self%conditioning_here = self%system%conditioning()
    call self%dense_output%begin()
    call self%dense_output%add(self%system, self%t, self%y)
    call begin_integration(self%integrator, self%system, self%t, self%y, err)
  end subroutine start_integrator

  !> What all integrators of the run took together.
  function statistics(self) result(all)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    type(integration_statistics_type) :: all

    all = self%before
    call add_statistics(self%integrator%statistics(), .true., all)
    call add_statistics(self%aside%statistics(), .false., all)
  end function statistics

  !> What was done for the blocks of all systems of the run, the present one included.
  pure function work_done(self) result(all)
    class(dynamic_run_type), intent(in) :: self   !< the dynamic run
    type(work_count_type) :: all

    all = self%work_before
    if (associated(self%system)) all = work_of(self%system%work%blocks, all)
  end function work_done

  !> Add what an integrator took.
  pure subroutine add_statistics(own, goes_on, all)
    type(integration_statistics_type), intent(in) :: own
    logical, intent(in) :: goes_on        !< its steps are those of the motion
    type(integration_statistics_type), intent(inout) :: all

    all%rate_evaluations = all%rate_evaluations + own%rate_evaluations
    all%jacobian_evaluations = all%jacobian_evaluations + own%jacobian_evaluations
    all%error_test_failures = all%error_test_failures + own%error_test_failures
    all%convergence_failures = all%convergence_failures + own%convergence_failures
    all%refusals = all%refusals + own%refusals
    if (.not. goes_on) return
    all%steps = all%steps + own%steps
    all%last_order = own%last_order
    all%last_step = own%last_step
  end subroutine add_statistics

  !> Keep its counts and give back what it holds.
  subroutine stop_integrator(self)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run

    self%before = self%statistics()
    call self%integrator%destroy()
    call self%aside%close()
  end subroutine stop_integrator

  !> Go on in better conditioned independent coordinates, if there are any. Where the others cannot serve, the motion goes on
  !> in the present ones; any other failure ends it.
  subroutine change_coordinates(self, changed, err)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run
    logical, intent(out) :: changed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(motion_system_type), allocatable :: other
    type(error_type), allocatable :: failure
    type(mechanism_type) :: mechanism
    type(plan_type) :: plan
    type(state_type) :: state
    logical :: independent(self%system%plan%n_coordinates)

    changed = .false.
    self%system%refuse_below = 0.0_wp
    ! the state of the last accepted step, with the rates of all coordinates
    call self%system%settle(self%t, self%y, failure)
    if (.not. allocated(failure)) call self%system%present(failure)
    if (gives_up(failure, err)) return
    call best_independent(self%system%plan, self%system%state, independent)
    if (all(independent .eqv. self%system%mechanism%structure%independent)) then
      self%look_below = self%system%conditioning()/worth_it
      return
    end if
    call with_independent(self%system%mechanism, self%system%state, independent, self%requested, mechanism, plan, state, &
                          failure)
    if (gives_up(failure, err)) return
    allocate (other)
    call set_motion_system(mechanism, plan, state, other, failure)
    ! they may have no inertia in this position; what fails in any coordinates will do so in the present ones, too
    if (allocated(failure)) return
    if (other%conditioning() < worth_it*self%system%conditioning()) then
      self%look_below = self%system%conditioning()/worth_it
      return
    end if
    call self%stop_integrator()
    other%iterations = self%system%iterations
    self%work_before = self%work_done()
    deallocate (self%system)
    allocate (self%system, source=other)
    call add_event(self%events, self%t, plan%independent)
    self%look_below = min(doubtful, self%system%conditioning()/worth_it)
    changed = .true.
    call self%start_integrator(err)
  end subroutine change_coordinates

  !> Whether there is a failure. One that has nothing to do with the choice of coordinates is handed on.
  logical function gives_up(failure, err)
    type(error_type), allocatable, intent(inout) :: failure   !< of trying other coordinates
    type(error_type), allocatable, intent(inout) :: err       !< that ends the motion

    gives_up = allocated(failure)
    if (.not. gives_up) return
    if (.not. is_recoverable(failure)) call move_alloc(failure, err)
  end function gives_up

  !> One more event. By hand: an array constructor of them would leak (gfortran 12).
  pure subroutine add_event(events, t, independent)
    type(event_type), allocatable, intent(inout) :: events(:)
    real(wp), intent(in) :: t
    integer, intent(in) :: independent(:)
    type(event_type), allocatable :: grown(:)
    integer :: i

    allocate (grown(size(events) + 1))
    do i = 1, size(events)
      grown(i)%t = events(i)%t
      call move_alloc(events(i)%independent, grown(i)%independent)
    end do
    grown(size(grown))%t = t
    grown(size(grown))%independent = independent
    call move_alloc(grown, events)
  end subroutine add_event

  !> Give back what the integrator and the system hold.
  subroutine close_run(self)
    class(dynamic_run_type), intent(inout) :: self   !< the dynamic run

    call self%stop_integrator()
    if (associated(self%system)) deallocate (self%system)
    self%system => null()
  end subroutine close_run
end module mech9_dynamic_run
