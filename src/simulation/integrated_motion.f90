!> A free motion under integration: the equations of motion in the present independent coordinates, their integrator, and the change to other coordinates.
module mech9_integrated_motion
  use mech9_kinds, only: wp, long
  use mech9_integration_tolerances, only: worthwhile_improvement
  use mech9_simulation_tolerances, only: doubtful_conditioning
  use mech9_error, only: error_type, raise, exit_singular, exit_integrator
  use mech9_simulation_failures, only: failure_many_events, failure_unheld_stop
  use mech9_variable_model, only: variable_model_type
  use mech9_partition, only: partition_type
  use mech9_block_solver, only: work_count_type, work_of
  use mech9_replanning, only: replanning_type, wanted_type
  use mech9_expectation, only: expectation_type
  use mech9_ode_system, only: is_recoverable
  use mech9_integrator, only: integrator_type, integration_statistics_type, add_statistics
  use mech9_coordinate_choice, only: best_independent, carry_over, worth_taking
  use mech9_integrated_vector, only: pack_state
  use mech9_motion_system, only: motion_system_type, free_system
  use mech9_joint_passing, only: pass_law_joint => pass_joint
  use mech9_ball_angles, only: ball_angles_type
  use mech9_other_angles, only: take_angles, show_in_angles, set_in_partition, refuse_angles, refuse_parameters, &
    hand_on_sensitivity
  use mech9_dense_output, only: dense_output_type
  use mech9_limit_watch, only: limit_watch_type
  use mech9_stop_contacts, only: stop_contacts_type
  use mech9_contact_motion, only: note_slip
  use mech9_contact_events, only: meet_contacts, find_pressed
  use mech9_friction_events, only: choose_modes, fail_undecided
  use mech9_held_coordinates, only: choose_held, hold_by_drives
  use mech9_motion_event, only: motion_events_type
  use mech9_event_variation, only: event_variation_type, meet_rubbing, end_passage
  use mech9_varied_impact, only: impact_type
  use mech9_impact_watcher, only: impact_watcher_type
  use mech9_side_steps, only: side_steps_type, begin_integration
  implicit none
  private
  public :: integrated_motion_type

  !> A free motion under integration. It must not be copied: the integrator keeps hold of the system.
  type :: integrated_motion_type
    type(motion_system_type), pointer :: system => null()   !< owned
    class(variable_model_type), pointer :: variable => null()   !< the model by its parameters, for their derivatives; not owned
    type(ball_angles_type) :: angles              !< of ball joints, as in the data file
    type(integrator_type) :: integrator
    type(dense_output_type) :: dense_output       !< motion within the last step
    type(limit_watch_type) :: limits              !< demands on the motors there
    type(stop_contacts_type) :: contacts          !< ends of stops, with their motion there
    type(side_steps_type) :: aside                !< steps to times at which dense output is not certain
    real(wp) :: t = 0.0_wp                        !< end of the last step [s]
    real(wp), allocatable :: y(:)                 !< the integrated vector there
    real(wp) :: conditioning_here = 0.0_wp        !< worst pivot ratio there
    real(wp), allocatable :: heat(:)              !< energy that each friction has taken up to there [J]
    real(wp), allocatable :: heat_before(:)       !< up to the start of the last step [J]
    type(event_variation_type), allocatable, private :: passage   !< derivatives at the present event; not allocated: none are integrated
    real(wp) :: log_volume = 0.0_wp               !< sum of logarithms of what the volume of directions was multiplied by where coordinates
                                                  !< were changed
    integer :: systems = 0                        !< how many systems in other coordinates there were before the present one
    real(wp) :: look_below = doubtful_conditioning             !< conditioning at which other coordinates are looked for
    type(integration_statistics_type), private :: before   !< of the integrators before the present one
    type(work_count_type), private :: work_before          !< for the blocks of the systems before the present one
  contains
    procedure :: begin
    procedure :: meet_events
    procedure :: note_start
    procedure :: begin_sensitivity
    procedure :: change_coordinates
    procedure :: change_angles
    procedure :: show_angles
    procedure, private :: begin_passage
    procedure, private :: hold_coordinates
    procedure, private :: insert
    procedure :: look_between
    procedure :: step_back
    procedure :: pass_joint
    procedure :: restart
    procedure :: statistics
    procedure :: work_done
    procedure :: iterations
    procedure :: close => close_motion
  end type integrated_motion_type

contains

  !> Begin to integrate at the present state of the system.
  subroutine begin(self, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    self%y = self%system%vector()
    self%conditioning_here = self%system%conditioning()
    call self%dense_output%begin()
    call self%dense_output%add(self%system, self%t, self%y)
    call begin_integration(self%integrator, self%system, self%t, self%y, err)
    if (.not. allocated(err)) call self%note_start(err)
  end subroutine begin

  !> Integrate the derivatives by all parameters as well, from the start on. Fails where they are not known.
  subroutine begin_sensitivity(self, variable, err)
    class(integrated_motion_type), intent(inout) :: self               !< the motion, before it begins
    class(variable_model_type), intent(inout), target :: variable      !< the model as a function of its parameters; outlives it
    type(error_type), allocatable, intent(out) :: err                  !< allocated if it failed

    call refuse_parameters(self%system%model, self%angles, self%t, err)
    if (allocated(err)) return
    self%variable => variable
    call self%system%begin_sensitivity(variable, err)
  end subroutine begin_sensitivity

  !> Go on in better conditioned independent coordinates, if there are any. Where the others cannot serve, the motion goes on
  !> in the present ones; any other failure ends it.
  subroutine change_coordinates(self, changed, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    logical, intent(out) :: changed                        !< the independent coordinates are others now
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(motion_system_type), pointer :: other
    type(ball_angles_type) :: angles
    type(error_type), allocatable :: failure
    type(wanted_type) :: wanted
    logical :: independent(self%system%plan%n_coordinates), made

    changed = .false.
    self%system%refuse_below = 0.0_wp
    ! the state of the last accepted step, with the rates of all coordinates
    call self%system%project(self%t, self%y, failure)
    if (.not. allocated(failure)) call self%system%present(failure)
    if (gives_up(failure, err)) return
    call best_independent(self%system%plan, self%system%state, independent)
    if (all(independent .eqv. self%system%partition%independent())) then
      call look_when_worse(self)
      return
    end if
    allocate (other)
    call other%make_room()
    wanted = worth_taking(self%system%conditioning(), self%system%work%blocks)
    call take_partition(self, self%system%partition%in_same_order(independent), wanted, other, angles, made, err)
    if (made) changed = other%conditioning() >= worthwhile_improvement*self%system%conditioning()
    if (changed) then
      if (allocated(self%system%sensitivity)) &
        call hand_on_sensitivity(self%system, self%angles, angles, self%variable, other, self%log_volume, err)
      self%angles = angles
      call replace_system(self, other)
      if (.not. allocated(err)) call self%begin(err)
    else
      call free_system(other)
      if (made) call look_when_worse(self)
    end if
  end subroutine change_coordinates

  !> Look for other coordinates again when the present ones have become clearly worse.
  subroutine look_when_worse(self)
    class(integrated_motion_type), intent(inout) :: self   !< the motion

    self%look_below = self%system%conditioning()/worthwhile_improvement
  end subroutine look_when_worse

  !> Make the system with another partition of the coordinates, at the present state. What belongs to frames and blocks that do not
  !> change is copied. The system is not made where these coordinates cannot serve, or the change is not worthwhile.
  subroutine take_partition(self, partition, worth, other, angles, made, err)
    class(integrated_motion_type), intent(inout) :: self       !< the motion
    type(partition_type), intent(in) :: partition              !< the partition
    type(wanted_type), intent(in) :: worth                     !< conditioning for which the change is worth making
    type(motion_system_type), intent(inout) :: other           !< the system in these coordinates
    type(ball_angles_type), intent(inout) :: angles            !< of ball joints, for this system
    logical, intent(out) :: made                               !< the system was made
    type(error_type), allocatable, intent(out) :: err          !< allocated if the motion ends
    type(error_type), allocatable :: failure
    type(wanted_type) :: wanted
    type(replanning_type) :: carried

    made = .false.
    wanted = worth
    wanted%requested = self%angles%requested
    wanted%from_known_only = self%angles%in_use()
    call self%show_angles(err)
    if (allocated(err)) return
    call carry_over(self%system%model%mechanism, partition, self%system%plan, self%system%state, wanted, carried, failure)
    if (gives_up(failure, err)) return
    if (carried%rejected) then
      call look_when_worse(self)
      return
    end if
    call move_alloc(carried%plan, other%plan)
    call move_alloc(carried%state, other%state)
    angles = self%angles
    call set_in_partition(self%system, partition, carried%serves, angles, other, made, failure)
    if (gives_up(failure, err)) return
  end subroutine take_partition

  !> Go on with other angles in the ball joints whose present ones are near gimbal lock, or with other angles of rods held.
  subroutine change_angles(self, changed, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion, to whose end the angles are continued
    logical, intent(out) :: changed                        !< the angles are others now
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(motion_system_type), pointer :: other
    type(ball_angles_type) :: angles
    type(error_type), allocatable :: failure

    changed = .false.
    if (.not. (any(self%angles%in_doubt(self%y)) .or. self%angles%held%in_doubt(self%system%state))) return
    call self%system%project(self%t, self%y, failure)
    if (.not. allocated(failure)) call self%system%present(failure)
    if (.not. allocated(failure)) call self%show_angles(failure)
    if (gives_up(failure, err)) return
    angles = self%angles
    allocate (other)
    call other%make_room()
    call take_angles(self%system, self%angles, angles, other, failure)
    changed = .not. (gives_up(failure, err) .or. angles%move_as(self%angles))
    if (changed) then
      if (allocated(self%system%sensitivity)) &
        call hand_on_sensitivity(self%system, self%angles, angles, self%variable, other, self%log_volume, err)
      self%angles = angles
      call replace_system(self, other)
      if (.not. allocated(err)) call self%begin(err)
    else
      call free_system(other)
    end if
  end subroutine change_angles

  !> Show the present state of the system in the angles of the data file, if others are integrated.
  subroutine show_angles(self, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion, with angles continued to the present state
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    call show_in_angles(self%system, self%angles, err)
  end subroutine show_angles

  !> Whether there is a failure. One that has nothing to do with the choice of coordinates is handed on.
  logical function gives_up(failure, err)
    type(error_type), allocatable, intent(inout) :: failure   !< of trying other coordinates
    type(error_type), allocatable, intent(inout) :: err       !< the failure that ends the motion

    gives_up = allocated(failure)
    if (.not. gives_up) return
    if (.not. is_recoverable(failure)) call move_alloc(failure, err)
  end function gives_up

  !> Put another system into the place of the present one, and keep the counts of both.
  subroutine replace_system(self, other)
    class(integrated_motion_type), intent(inout) :: self     !< the motion
    type(motion_system_type), pointer, intent(in) :: other   !< in other coordinates, with its motion worked out; owned from now on

    call stop_integrators(self)
    other%iterations = self%system%iterations
    self%work_before = self%work_done()
    call free_system(self%system)
    self%system => other
    self%systems = self%systems + 1
    self%look_below = min(doubtful_conditioning, self%system%conditioning()/worthwhile_improvement)
  end subroutine replace_system

  !> Work out a point that divides the last step, for dense output.
  subroutine insert(self, part, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    real(wp), intent(in) :: part                           !< part of the step before the point, 0 to 1
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: from, y(size(self%y))

    call self%dense_output%start_of_step(from, y)
    call self%aside%reach(self%system, from, y, from + part*(self%t - from), err)
    if (.not. allocated(err)) call self%dense_output%insert(self%aside%t, self%aside%y)
  end subroutine insert

  !> The motion at a time within the last step: by the method's own interpolation, or by dense output from the ends of the last
  !> steps, or from these and points between them, or by steps onto it. `found` is false where none of these leads there.
  subroutine look_between(self, t, found)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    real(wp), intent(in) :: t                              !< time within the last step [s]
    logical, intent(out) :: found                          !< the system stands at this time
    type(error_type), allocatable :: err
    real(wp) :: from, y(size(self%y))
    logical :: knows_motion

    found = .false.
    if (self%dense_output%crosses()) return
    ! dense output does not know the derivatives of motors by parameters
    knows_motion = .not. allocated(self%system%sensitivity)
    if (.not. knows_motion) knows_motion = size(self%system%sensitivity%motors) == 0
    call self%integrator%interpolate(t, y, found)
    if (.not. found .and. knows_motion) call self%dense_output%find(self%system, t, y, found, err)
    if (.not. (found .or. self%dense_output%count_inserted() > 0) .and. knows_motion) then
      call self%insert(0.5_wp, err)
      if (.not. allocated(err)) call self%dense_output%find(self%system, t, y, found, err)
    end if
    if (.not. (found .or. allocated(err) .or. self%dense_output%count_inserted() > 1) .and. knows_motion) then
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

  !> Back to the start of the last step, to go onto time t within it.
  subroutine step_back(self, t, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    real(wp), intent(in) :: t                              !< time within the last step [s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(expectation_type) :: nothing

    call self%dense_output%start_of_step(self%t, self%y)
    call self%system%resume(nothing)
    call self%system%move_to(self%t, self%y, err)
    if (.not. allocated(err)) call self%integrator%restart(self%t, self%y, err, first_step=t - self%t)
    if (allocated(err)) return
    self%conditioning_here = self%system%conditioning()
    call self%dense_output%begin()
    call self%dense_output%add(self%system, self%t, self%y)
    call self%note_start(err)
  end subroutine step_back

  !> Pass a joint of the laws of time, the limit of a motor, or an event of a contact, at the end of the last step.
  subroutine pass_joint(self, events, impacts, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    type(motion_events_type), intent(inout) :: events      !< gets impacts, and stops that close and open
    class(impact_watcher_type), allocatable, intent(inout) :: impacts   !< gets the impulses of pairs; not allocated: they are not recorded
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: of_held(self%system%plan%n_coordinates)
    integer :: met, motor, friction, rubbing, corner

    met = self%system%interval%contact
    corner = self%system%interval%corner
    friction = self%system%interval%friction
    rubbing = self%system%interval%rubbing
    of_held = 0.0_wp
    if (self%system%interval%is_joint(self%t)) then
      call pass_law_joint(self%system, self%t, self%y, err, of_held)
      if (allocated(err)) return
    else
      motor = self%system%interval%motor
      call self%system%interval%forget_event()
      self%system%interval%motor = motor
    end if
    self%system%interval%corner = corner
    if (met > 0 .or. rubbing > 0 .or. corner > 0 .or. self%contacts%any_held() .or. allocated(self%system%friction)) then
      call self%meet_events(met, friction, rubbing, of_held, .false., events, impacts, err)
    else
      call self%restart((self%t), (self%y), err)
    end if
  end subroutine pass_joint

  !> Meet the contacts of stops and the changes of frictions at the end of the last step, and go on as they leave the motion.
  subroutine meet_events(self, met, friction, rubbing, of_held, at_start, events, impacts, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    integer, intent(in) :: met                             !< number of the end that is met, left or released; 0: none
    integer, intent(in) :: friction                        !< number of the friction that changes; 0: none
    integer, intent(inout) :: rubbing      !< number of the contact of links whose friction changes; 0: none, or it came to rest
    real(wp), intent(in) :: of_held(:)                     !< (M) rates that held coordinates would have if nothing held them [rad/s, m/s]
    logical, intent(in) :: at_start                        !< there was no step yet
    type(motion_events_type), intent(inout) :: events      !< gets impacts, stops that close and open, and pairs that stick and slip
    class(impact_watcher_type), allocatable, intent(inout) :: impacts   !< gets the impulses of pairs; not allocated: they are not recorded
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), dimension(self%system%plan%n_coordinates) :: impulses, changes
    type(stop_contacts_type) :: prior
    type(impact_type) :: impact
    integer :: before
    logical :: holds_change, stalls, hits, released

    before = events%count
    self%system%interval%contact = 0
    self%system%interval%friction = 0
    self%system%interval%rubbing = 0
    call self%system%move_to(self%t, self%y, err)
    if (.not. allocated(err)) call self%begin_passage(met, friction, of_held, released, err)
    if (allocated(self%passage) .and. rubbing > 0 .and. .not. allocated(err)) call meet_rubbing(self%passage, self%system, &
      self%contacts%ends(findloc(self%contacts%ends%contact, rubbing, dim=1)), err)
    if (self%system%interval%corner > 0 .and. .not. allocated(err)) call turn_corner(self, err)
    if (allocated(err)) return
    prior = self%contacts
    call meet_contacts(self%system, met, rubbing, of_held, self%contacts, impulses, changes, impact, holds_change, events, err)
    if (allocated(err)) return
    holds_change = holds_change .or. released
    if (allocated(self%passage)) call self%passage%pass_contacts(self%system, prior%ends, self%contacts%ends, impact, at_start, err)
    if (allocated(err)) return
    hits = any(abs(impulses) > 0.0_wp)
    if (allocated(self%system%contact)) hits = hits .or. any(abs(self%system%state%contact_force) > 0.0_wp)
    if (allocated(impacts) .and. hits .and. (self%angles%give_same_wrenches() .or. .not. self%angles%in_use())) &
      call impacts%take(self%system%plan, self%system%state, impulses, changes, err)
    if (allocated(err)) return
    if (allocated(self%system%friction)) call meet_frictions(self, met, friction, rubbing, at_start, holds_change, events, err)
    if (allocated(err)) return
    call events%judge_progress(before, self%t, stalls)
    if (stalls) then
      call raise(err, exit_integrator, failure_many_events)
      err%failure%t = self%t
      err%failure%limit = events%count
      return
    end if
    if (holds_change) then
      call self%hold_coordinates(err)
    else
      call pack_state(self%system%plan, self%system%state, self%y)
      if (allocated(self%passage)) call self%passage%put_behind(self%system, self%t, self%y, err)
      if (.not. allocated(err)) call self%restart((self%t), (self%y), err)
    end if
    if (allocated(self%passage) .and. at_start .and. .not. allocated(err)) &
      call self%passage%check_start(self%system, self%contacts%ends, err)
    if (.not. allocated(err)) call end_passage(self%passage, at_start, events)
  end subroutine meet_events

  !> Let the contact whose ball came to the end of a stretch of its profile go on with the next one.
  subroutine turn_corner(self, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion, whose system stands before the event
    type(error_type), allocatable, intent(inout) :: err    !< not allocated; then allocated if it failed

    associate (corner => self%system%interval%corner, system => self%system)
      if (allocated(self%passage)) call self%passage%meet_corner(system, self%contacts%ends(corner), err)
      if (allocated(err)) return
      call self%contacts%pass_end_of_stretch(corner, system%model%mechanism, system%plan, system%state)
      corner = 0
    end associate
    call self%system%move_to(self%t, self%y, err)
  end subroutine turn_corner

  !> Begin with the derivatives at an event, if any are integrated. Before an impact the coordinates that stops and frictions hold are
  !> released, since they take part in it.
  subroutine begin_passage(self, met, friction, of_held, released, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion, whose system stands before the event
    integer, intent(in) :: met                             !< number of the end that is met, left or released; 0: none
    integer, intent(in) :: friction                        !< number of the friction that changes; 0: none
    real(wp), intent(in) :: of_held(:)                     !< (M) rates that held coordinates would have if nothing held them [rad/s, m/s]
    logical, intent(out) :: released                       !< coordinates were released
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    released = .false.
    if (.not. allocated(self%system%sensitivity)) return
    if (allocated(self%passage)) deallocate (self%passage)
    allocate (self%passage)
    call self%passage%begin(self%system, of_held, err)
    if (friction > 0 .and. .not. allocated(err)) call self%passage%meet_friction(self%system, friction, err)
    if (met == 0 .or. .not. allocated(self%system%held) .or. allocated(err)) return
    released = self%contacts%ends(met)%is_rigid .and. .not. self%contacts%ends(met)%held
    if (.not. released) return
    call self%hold_coordinates(err, nothing=.true.)
    if (allocated(self%system%friction)) self%system%friction%held = [integer ::]
  end subroutine begin_passage

  !> Choose which pairs stick and which slip from now on. Where stops hold other coordinates, these are changed first. Frictions may press
  !> a contact that touches, which then closes, or change what contacts of links need, until both agree.
  subroutine meet_frictions(self, met, friction, slides_on, at_start, holds_change, events, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion, whose system has the rates of all independent coordinates
    integer, intent(in) :: met                             !< number of the end that is met, left or released; 0: none
    integer, intent(in) :: friction                        !< number of the friction that changes; 0: none
    integer, intent(inout) :: slides_on                    !< number of the contact of links that can stick no longer; 0: none
    logical, intent(in) :: at_start                        !< there was no step yet
    logical, intent(inout) :: holds_change                 !< other coordinates are to be held
    type(motion_events_type), intent(inout) :: events      !< gets pairs that stick and slip
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), dimension(self%system%plan%n_coordinates) :: impulses, changes
    type(impact_type) :: impact
    integer, allocatable :: sticking(:)
    integer :: round
    logical :: pressed

    do round = 0, 2*(size(self%contacts%ends) + size(self%system%model%mechanism%frictions))
      if (holds_change) self%system%friction%held = [integer ::]
      if (holds_change) call self%hold_coordinates(err)
      if (allocated(err)) return
      call choose_modes(self%system, friction, round, at_start, sticking, events, err)
      if (.not. allocated(err)) call find_pressed(self%system, self%contacts, met, pressed, err)
      if (allocated(err)) return
      if (.not. pressed) exit
      call meet_contacts(self%system, 0, slides_on, 0.0_wp*self%system%state%dq, self%contacts, impulses, changes, impact, &
                         holds_change, events, err, again=.true.)
      if (allocated(err)) return
    end do
    if (pressed) call fail_undecided(self%system, err)
    call self%system%friction%take_held(sticking, holds_change)
  end subroutine meet_frictions

  !> Go on with the coordinates held whose stops are closed, or whose pairs stick, and with all others released, at the present state.
  subroutine hold_coordinates(self, err, nothing)
    class(integrated_motion_type), intent(inout) :: self   !< the motion, whose system has the rates of all coordinates
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    logical, intent(in), optional :: nothing               !< nothing holds a coordinate for a moment
    type(motion_system_type), pointer :: other
    type(ball_angles_type) :: angles
    type(partition_type) :: partition
    type(stop_contacts_type) :: contacts
    integer, allocatable :: sticking(:)
    logical :: made

    sticking = [integer ::]
    contacts = self%contacts
    if (present(nothing)) contacts%ends%held = .false.
    if (allocated(self%system%friction) .and. .not. present(nothing)) sticking = self%system%friction%held
    call choose_held(self%system, contacts, sticking, partition)
    call hold_by_drives(contacts, sticking, self%system%state%q, self%angles%held%drives, self%system%held)
    allocate (other)
    call other%make_room()
    call take_partition(self, partition, wanted_type(), other, angles, made, err)
    if (made) then
      self%angles = angles
      call replace_system(self, other)
      self%y = self%system%vector()
      call self%system%project(self%t, self%y, err)
      if (.not. allocated(err)) call self%system%pass_limits(err)
      if (.not. allocated(err)) call self%system%present(err)
      if (allocated(self%passage) .and. .not. allocated(err)) call refuse_angles(self%angles, self%t, err)
      if (allocated(self%passage) .and. .not. allocated(err)) call self%passage%hand_on(self%variable, self%system, err)
      if (.not. allocated(err)) call self%begin(err)
    else
      call free_system(other)
      if (allocated(err)) return
      call raise(err, exit_singular, failure_unheld_stop)
      err%failure%t = self%t
      err%failure%coordinates = [pack(self%contacts%ends%coordinate, self%contacts%ends%held .and. self%contacts%ends%stop > 0), &
                                 sticking]
    end if
  end subroutine hold_coordinates

  !> Note demands on motors and the motion of contacts from which the next step begins.
  subroutine note_start(self, err)
    class(integrated_motion_type), intent(inout) :: self   !< the motion at the start of a step
    type(error_type), allocatable, intent(out) :: err      !< allocated if the law of a motor has no value

    call self%limits%note(self%system, err)
    associate (system => self%system)
      if (size(self%contacts%ends) > 0) call self%contacts%note(system%model%mechanism, system%plan, system%state)
      if (allocated(system%contact)) call note_slip(system%model%mechanism, system%plan, system%state, system%contact)
    end associate
  end subroutine note_start

  !> Go on from a state as if nothing had been before it.
  subroutine restart(self, t, y, err, first_step)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    real(wp), intent(in) :: t                              !< time [s]
    real(wp), intent(in) :: y(:)                           !< projected values
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), intent(in), optional :: first_step           !< with its sign; absent or 0: to be found [s]
    type(expectation_type) :: nothing

    self%t = t
    self%y = y
    call self%aside%forget()
    call self%system%resume(nothing)
    call self%system%move_to(self%t, self%y, err)
    if (.not. allocated(err)) call self%system%pass_limits(err)
    if (.not. allocated(err)) call self%integrator%restart(self%t, self%y, err, first_step)
    if (allocated(err)) return
    self%conditioning_here = self%system%conditioning()
    call self%dense_output%begin()
    call self%dense_output%add(self%system, self%t, self%y)
    call self%note_start(err)
  end subroutine restart

  !> Counts of all integrators of the motion together.
  function statistics(self) result(all)
    class(integrated_motion_type), intent(inout) :: self   !< the motion
    type(integration_statistics_type) :: all

    all = self%before
    call add_statistics(self%integrator%statistics(), .true., all)
    call add_statistics(self%aside%statistics(), .false., all)
  end function statistics

  !> Work for the blocks of all systems of the motion, the present one included.
  pure function work_done(self) result(all)
    class(integrated_motion_type), intent(in) :: self   !< the motion
    type(work_count_type) :: all

    all = self%work_before
    if (associated(self%system)) all = work_of(self%system%work%blocks, all)
  end function work_done

  !> Iterations of Newton's method, of all systems of the motion.
  pure integer(long) function iterations(self)
    class(integrated_motion_type), intent(in) :: self   !< the motion

    iterations = 0
    if (associated(self%system)) iterations = self%system%iterations
  end function iterations

  !> Keep the counts of the integrators and free their memory.
  subroutine stop_integrators(self)
    class(integrated_motion_type), intent(inout) :: self   !< the motion

    self%before = self%statistics()
    call self%integrator%destroy()
    call self%aside%close()
  end subroutine stop_integrators

  !> Free the memory of the integrators and of the system.
  subroutine close_motion(self)
    class(integrated_motion_type), intent(inout) :: self   !< the motion

    call stop_integrators(self)
    call free_system(self%system)
  end subroutine close_motion
end module mech9_integrated_motion
