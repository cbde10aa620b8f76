!> A driven motion: all independent coordinates are given as functions of time.
module mech9_driven_simulation
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_motion_view, only: motion_view_type
  use mech9_plan, only: plan_type, copy_plan
  use mech9_state, only: state_type, copy_state
  use mech9_start_path, only: start_way_type, assemble_start
  use mech9_requested, only: requested_by_results, add_forces, add_stops, add_section, leave_out_unrequested
  use mech9_driven_motion, only: driven_motion_type, set_inputs
  use mech9_drive_ways, only: short_ways_type, end_of_way
  use mech9_driven_counts, only: driven_counts_type, keep_counts, return_to_counts
  use mech9_batch_products, only: batch_size
  use mech9_ball_angles, only: ball_angles_type
  use mech9_driven_angles, only: begin_with_angles, advance_with_angles
  use mech9_lagrange_types, only: dynamics_plan_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_generalized_forces, only: show_state
  use mech9_energy, only: kinetic_energy, potential_energy
  use mech9_stop_contacts, only: stop_contacts_type, find_contacts
  use mech9_clear_stops, only: clear_stops_type
  use mech9_driven_stops, only: check_stops
  use mech9_friction, only: bearing_terms
  use mech9_driven_frictions, only: driven_frictions_type, slip_directions, any_turns_round
  use mech9_driven_turns, only: driven_turns_type, directions_beside, directions_at_rest
  use mech9_simulation, only: simulation_type, simulation_statistics_type, standing_type
  implicit none
  private
  public :: driven_simulation_type, new_driven_simulation, assemble_driven

  !> A driven motion. Parts are polymorphic where these are copied by calls, which keeps the code of copies small.
  type, extends(simulation_type) :: driven_simulation_type
    class(plan_type), allocatable :: plan             !< of the requested part of the motion
    class(state_type), allocatable :: assembled       !< the closed position at the start
    class(driven_motion_type), allocatable :: driven
    type(ball_angles_type) :: angles                  !< of ball joints, as in the data file
    class(dynamics_plan_type), allocatable, private :: dynamics  !< made when energies are asked for first
    type(motion_view_type), allocatable, private :: view         !< of the present state, as loads see it
    type(stop_contacts_type), private :: contacts                !< ends of stops, with the motion at the last output
    type(clear_stops_type), private :: clear                     !< coordinates far from them
    logical, private :: watches_ends = .false.                   !< it has rigid ends, which it must not pass
    type(short_ways_type), private :: unseen                     !< ways between looks at rigid ends
    class(driven_frictions_type), allocatable :: frictions       !< not allocated: there are none, or no forces are requested
    type(driven_turns_type), private :: turns                    !< of pairs with friction; they come where frictions are allocated
    type(driven_counts_type), private :: kept_work(batch_size)   !< of positions that wait for their derivatives
  contains
    procedure :: begin
    procedure :: go_to
    procedure :: stride
    procedure :: end_of_stride
    procedure :: leave_joint
    procedure :: may_jump
    procedure :: look_at
    procedure :: note_output
    procedure :: present => present_state
    procedure :: present_for_forces
    procedure :: present_closure
    procedure :: watch_conditioning
    procedure :: energies
    procedure :: standing
    procedure :: count_work
    procedure :: keep_work
    procedure :: return_to_work
  end type driven_simulation_type

  !> Longest way of a drive within a stride, in the unit of its coordinate.
  real(wp), parameter :: longest_way = 0.1_wp
  !> Longest way of a drive between two looks at the gaps of stops and contacts, in the unit of its coordinate.
  real(wp), parameter :: longest_unseen = 0.25_wp
  !> Part of a way at whose end a pair that rested at its beginning is looked at.
  real(wp), parameter :: beside_part = 1.0e-2_wp

contains

  !> The plan, and the closed position at the start of the motion.
  subroutine assemble_driven(model, plan, state, err, way)
    type(model_type), intent(in) :: model           !< the model, with a drive for each independent coordinate
    type(plan_type), intent(out) :: plan                !< the plan of the mechanism
    type(state_type), intent(out) :: state              !< the closed position
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(start_way_type), intent(out), optional :: way  !< how the start was reached from the drawn position
    real(wp), dimension(size(model%mechanism%pairs)) :: q, dq, ddq

    q = model%problem%initial%position
    call set_inputs(model%problem%drives, model%request%time%start, q, dq, ddq, err)
    if (allocated(err)) return
    call assemble_start(model, q, plan, state, err, way)
    state%t = model%request%time%start
  end subroutine assemble_driven

  !> A driven motion from its assembled start.
  subroutine new_driven_simulation(model, plan, assembled, simulation, pictures, with_masses)
    type(model_type), intent(in), target :: model             !< the model; it must outlive the simulation
    type(plan_type), intent(in) :: plan                       !< its plan
    type(state_type), intent(in) :: assembled                 !< its closed position at the start
    type(driven_simulation_type), intent(out) :: simulation   !< to be started
    logical, intent(in), optional :: pictures                 !< the motion of all links is requested; not unless given
    logical, intent(in), optional :: with_masses              !< energies are requested as in dynamics; not unless given

    simulation%model => model
    allocate (simulation%plan, simulation%assembled, simulation%driven)
    call copy_plan(plan, simulation%plan)
    call copy_state(assembled, simulation%assembled)
    simulation%requested = requested_by_results(model%mechanism, model%request%output, pictures)
    if (present(with_masses)) simulation%with_energies = with_masses .and. model%request%output%energies
    if (simulation%with_energies) call add_forces(model%mechanism, simulation%requested)
    call add_stops(model%mechanism, simulation%requested)
    call add_section(model%request%section, simulation%requested)
    call leave_out_unrequested(simulation%plan, simulation%requested)
    simulation%with_conditioning = model%request%output%conditioning
    if (model%mechanism%has_frictions() .and. model%request%output%with_forces()) allocate (simulation%frictions)
    allocate (simulation%coordinate_changes(0))
  end subroutine new_driven_simulation

  !> The position at the start.
  subroutine begin(self, t, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                              !< time of the start [s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(state_type) :: start

    call copy_state(self%assembled, start)
    start%t = t
    call begin_with_angles(self%model, self%requested, self%plan, start, self%driven, self%angles, err)
    if (allocated(err)) return
    call find_contacts(self%model%mechanism, self%contacts)
    self%watches_ends = self%model%mechanism%has_rigid_ends()
    self%unseen = short_ways_type(longest_unseen)
    if (self%watches_ends) then
      call self%contacts%note(self%model%mechanism, self%plan, self%driven%state)
      call check_stops(self%model, self%plan, self%angles%held%drives, self%driven, t, self%contacts, err)
      call self%clear%begin(self%contacts, self%plan, self%driven%state)
    end if
    if (.not. allocated(self%frictions) .or. allocated(err)) return
    call self%turns%begin(self%model%mechanism, t, directions_behind(self))
    call find_frictions(self, counting_directions(self), err)
  end subroutine begin

  !> The position at time t, on the same branch. Whether the motion shall stop is asked after many steps, too.
  subroutine go_to(self, t, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                              !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    call move_to(self, t, err)
    if (allocated(self%frictions) .and. .not. allocated(err)) call find_frictions(self, counting_directions(self), err)
  end subroutine go_to

  !> Directions in which the frictions of pairs count at the present position.
  function counting_directions(self) result(directions)
    class(driven_simulation_type), intent(in) :: self   !< the simulation
    real(wp) :: directions(size(self%model%mechanism%frictions)), before(size(self%model%mechanism%frictions))

    associate (mechanism => self%model%mechanism, time => self%model%request%time)
      call directions_beside(mechanism, self%plan, self%angles%held%drives, self%driven, time_towards(self, time%start), before)
      directions = directions_at_rest(before, directions_behind(self), .not. abs(time%end - self%driven%state%t) > 0.0_wp)
    end associate
  end function counting_directions

  !> Directions of pairs with friction behind the present position; at the end of the motion, those of their rates.
  function directions_behind(self) result(directions)
    class(driven_simulation_type), intent(in) :: self   !< the simulation
    real(wp) :: directions(size(self%model%mechanism%frictions))

    call directions_beside(self%model%mechanism, self%plan, self%angles%held%drives, self%driven, &
                           time_towards(self, self%model%request%time%end), directions)
  end function directions_behind

  !> A time a little beside the present one, towards another; the present one if they are the same [s].
  real(wp) function time_towards(self, other) result(time)
    class(driven_simulation_type), intent(in) :: self   !< the simulation
    real(wp), intent(in) :: other                       !< the other time [s]

    associate (t => self%driven%state%t)
      time = t
      if (abs(other - t) > 0.0_wp) &
        time = t + beside_part*(end_of_way(self%model%problem%drives, self%plan, longest_way, t, other) - t)
    end associate
  end function time_towards

  !> Count an output at which pairs with friction are at rest.
  subroutine note_output(self)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation

    if (.not. allocated(self%frictions)) return
    if (self%frictions%at_rest) self%frictions%rest%outputs = self%frictions%rest%outputs + 1
  end subroutine note_output

  !> Move to the position at time t, whose frictions are not found yet.
  subroutine move_to(self, t, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: t                              !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: before, next
    logical :: reached

    do
      before = self%driven%state%t
      next = t
      if (self%watches_ends) then
        if (.not. self%unseen%knows(before, t)) next = self%unseen%end_of_next(self%model%problem%drives, self%plan, before, t)
      end if
      do
        call advance_with_angles(self%model, self%plan, next, self%driven, self%angles, reached, err)
        if (allocated(err)) return
        if (reached .and. .not. abs(t - next) > 0.0_wp) exit
        call self%stop_if_interrupted(self%driven%predictor%t, err)
        if (allocated(err)) return
        if (reached) exit
      end do
      if (self%watches_ends) call pass_ends(self, before, err)
      if (allocated(err) .or. .not. abs(t - next) > 0.0_wp) exit
    end do
  end subroutine move_to

  !> Check that no rigid end was passed since the last position.
  subroutine pass_ends(self, before, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: before                         !< time of the last position [s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if one was passed
    logical :: clear

    call self%clear%go_on(self%driven%state, self%driven%state%t - before, clear)
    if (clear) return
    call self%clear%recall(self%contacts)
    call check_stops(self%model, self%plan, self%angles%held%drives, self%driven, before, self%contacts, err)
    call self%clear%renew(self%contacts, self%plan, self%driven%state)
  end subroutine pass_ends

  !> Go on by a way within which no drive moves far, and the motion of the others is known well by its ends. It ends at the first time at
  !> which a pair with friction turns back, or its friction has a kink.
  subroutine stride(self, t, from, to, at_joint, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation, started
    real(wp), intent(in) :: t                              !< time to go towards [s]
    real(wp), intent(out) :: from                          !< start of the way [s]
    real(wp), intent(inout) :: to                          !< end of the way before; then of this one [s]
    logical, intent(out) :: at_joint                       !< frictions jump or have a kink at its end
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: next
    logical :: at_kink

    at_joint = .false.
    from = to
    next = end_of_way(self%model%problem%drives, self%plan, longest_way, from, t)
    call self%stop_if_interrupted(next, err)
    if (.not. allocated(err)) call move_to(self, next, err)
    if (allocated(err)) return
    if (self%turns%may_come) then
      call self%turns%find_first(self%model%mechanism, self%plan, self%angles%held%drives, self%driven, next)
      call end_at_kink(self, from, next, at_kink, err)
      if (.not. allocated(err)) call move_to(self, next, err)
      if (allocated(err)) return
      if (abs(self%model%request%time%end - next) > 0.0_wp) then
        call self%turns%note_end(next, directions_behind(self))
      else
        call self%turns%note_end(next)
      end if
      at_joint = self%turns%is_at_end .or. at_kink
    end if
    to = next
    if (allocated(self%frictions)) call self%look_at(next, err)
  end subroutine stride

  !> End a stride at the first time at which a term of a bearing load turns round, if there is one.
  subroutine end_at_kink(self, from, next, at_kink, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation; it stands anywhere in the stride afterwards
    real(wp), intent(in) :: from                           !< start of the stride [s]
    real(wp), intent(inout) :: next                        !< its end [s]
    logical, intent(out) :: at_kink                        !< there is one
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), dimension(2, bearing_terms, size(self%model%mechanism%frictions)) :: first, terms
    real(wp) :: before, middle

    at_kink = .false.
    ! terms are zero where the stride before ended at their turn
    before = from + beside_part*(next - from)
    call find_terms(before, first)
    if (.not. allocated(err)) call find_terms(next, terms)
    if (allocated(err)) return
    at_kink = any_turns_round(first, terms)
    if (.not. at_kink) return
    do while (abs(next - before) > 2.0_wp*spacing(max(abs(next), abs(before))))
      middle = 0.5_wp*(next + before)
      call find_terms(middle, terms)
      if (allocated(err)) return
      if (any_turns_round(first, terms)) then
        next = middle
      else
        before = middle
      end if
    end do
  contains
    !> Find the terms of all bearing loads at a time.
    subroutine find_terms(t, terms)
      real(wp), intent(in) :: t                  !< the time [s]
      real(wp), intent(out) :: terms(:, :, :)    !< (2,terms,frictions) [N]

      call move_to(self, t, err)
      if (.not. allocated(err)) call find_frictions(self, self%turns%directions_on(2, directions_now(self), .true.), err)
      if (.not. allocated(err)) call self%frictions%bearing_terms_of(self%model%mechanism%frictions, terms)
    end subroutine find_terms
  end subroutine end_at_kink

  !> Directions in which pairs slide, by their present rates.
  pure function directions_now(self) result(directions)
    class(driven_simulation_type), intent(in) :: self   !< the simulation
    real(wp) :: directions(size(self%model%mechanism%frictions))

    directions = slip_directions(self%model%mechanism, self%plan, self%driven%state)
  end function directions_now

  !> The end of the last stride, where pairs with friction may turn back [s].
  pure real(wp) function end_of_stride(self, known)
    class(driven_simulation_type), intent(in) :: self   !< the simulation, started
    real(wp), intent(in) :: known                       !< the end of the last stride as it was [s]

    end_of_stride = merge(self%turns%end, known, self%turns%may_come)
  end function end_of_stride

  !> Stand behind the turn at the end of the last stride.
  subroutine leave_joint(self, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation, started
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    if (.not. self%turns%is_at_end) return
    self%turns%is_left = .true.
    call self%look_at(self%turns%end, err)
  end subroutine leave_joint

  !> Whether frictions may jump where pairs turn back.
  pure logical function may_jump(self)
    class(driven_simulation_type), intent(in) :: self   !< the simulation

    may_jump = .false.
    if (allocated(self%frictions)) may_jump = .not. all(self%model%mechanism%frictions%is_smooth)
  end function may_jump

  !> Stand at a time within the last stride; at its end, on one side of a turn.
  subroutine look_at(self, t, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation, started
    real(wp), intent(in) :: t                              !< the time [s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    logical :: at_end
    integer :: side

    call move_to(self, t, err)
    if (.not. allocated(self%frictions) .or. allocated(err)) return
    at_end = self%turns%is_at_end .and. .not. abs(t - self%turns%end) > 0.0_wp
    side = merge(2, 1, at_end .and. self%turns%is_left)
    call find_frictions(self, self%turns%directions_on(side, directions_now(self), at_end), err)
  end subroutine look_at

  !> Find the frictions at the present time.
  subroutine find_frictions(self, directions, err)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: directions(:)                  !< (frictions) in which pairs slide: -1, 1; 0: at rest, or smooth [1]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    if (self%angles%in_use() .and. .not. self%angles%give_same_wrenches()) then
      call self%frictions%find(self%model%mechanism, self%angles%plan, self%angles%state, directions, err)
    else
      call self%frictions%find(self%model%mechanism, self%plan, self%driven%state, directions, err)
      if (self%angles%in_use()) self%angles%state%friction = self%driven%state%friction
    end if
  end subroutine find_frictions

  !> The plan and the present state.
  subroutine present_state(self, plan, state)
    class(driven_simulation_type), intent(in), target :: self   !< the simulation
    type(plan_type), pointer, intent(out) :: plan               !< the plan that is executed
    type(state_type), pointer, intent(out) :: state             !< the present state; before the start the assembled one

    plan => self%plan
    state => self%driven%state
    if (.not. self%started) then
      state => self%assembled
    else if (self%angles%in_use()) then
      plan => self%angles%plan
      state => self%angles%state
    end if
  end subroutine present_state

  !> The plan and the state in the angles that are in use, where wrenches are the same in these.
  subroutine present_for_forces(self, plan, state)
    class(driven_simulation_type), intent(in), target :: self   !< the simulation
    type(plan_type), pointer, intent(out) :: plan               !< the plan
    type(state_type), pointer, intent(out) :: state             !< the present state

    call self%present(plan, state)
    if (.not. self%angles%give_same_wrenches()) return
    plan => self%plan
    state => self%driven%state
  end subroutine present_for_forces

  !> Largest closure error of the present position [m].
  real(wp) function present_closure(self)
    class(driven_simulation_type), intent(in) :: self   !< the simulation

    present_closure = self%driven%closure
  end function present_closure

  !> The conditioning of the present position. Whether it is the worst was seen already.
  subroutine watch_conditioning(self, always)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    logical, intent(in) :: always                          !< work it out in any case

    if (always) call self%driven%conditioning%update(self%t, self%driven%work, self%least_conditioning)
  end subroutine watch_conditioning

  !> Energies of the present position.
  subroutine energies(self, kinetic, potential)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(out) :: kinetic                       !< of all bodies [J]
    real(wp), intent(out) :: potential                     !< of gravity and springs [J]

    if (.not. allocated(self%dynamics)) then
      allocate (self%dynamics, self%view)
      call make_dynamics_plan(self%model%mechanism, self%plan, self%dynamics)
      allocate (self%view%links(self%plan%n_links))
      allocate (self%view%q(self%plan%n_coordinates), self%view%dq(self%plan%n_coordinates), source=0.0_wp)
    end if
    call show_state(self%plan, self%dynamics, self%driven%state, self%view)
    kinetic = kinetic_energy(self%model%mechanism, self%plan, self%driven%state)
    potential = potential_energy(self%model%mechanism, self%plan, self%driven%state, self%view)
  end subroutine energies

  !> The place of the motion: the end of the last step.
  type(standing_type) function standing(self)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation

    standing%t = self%t
    if (.not. self%started) return
    associate (driven => self%driven)
      standing%t = driven%predictor%t
      if (driven%reach < huge(driven%reach)) standing%step = driven%reach
      if (size(driven%state%dq) > 0) standing%fastest = maxloc(abs(driven%state%dq)/self%plan%unit_of, dim=1)
      if (standing%fastest > 0) standing%rate = driven%state%dq(standing%fastest)
    end associate
  end function standing

  !> Steps of branch stepping, and their work.
  subroutine count_work(self, statistics)
    class(driven_simulation_type), intent(inout) :: self            !< the simulation
    type(simulation_statistics_type), intent(inout) :: statistics   !< gets the work

    statistics%steps = self%driven%steps
    statistics%newton_iterations = self%driven%iterations
    statistics%halvings = self%driven%halvings
    statistics%crossings = self%driven%crossings
  end subroutine count_work

  !> Keep the counts of branch stepping at the present position.
  subroutine keep_work(self, place)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    integer, intent(in) :: place                           !< number of the position among those that wait

    call keep_counts(self%driven, self%kept_work(place))
  end subroutine keep_work

  !> Return to the counts at an earlier position.
  subroutine return_to_work(self, place)
    class(driven_simulation_type), intent(inout) :: self   !< the simulation
    integer, intent(in) :: place                           !< number of the position among those that waited

    call return_to_counts(self%kept_work(place), self%driven)
  end subroutine return_to_work
end module mech9_driven_simulation
