!> Ends of stops, and surfaces of links, as contacts: the gap that is left to each, and whether it is closed.
!>
!> A rigid end that is closed holds its coordinate like a drive that does not move, as long as its force pushes; a rigid contact of links has
!> a force that leaves the gap no acceleration. A compliant one is a load; its contact begins and ends where its force is not smooth.
module mech9_stop_contacts
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: round_off_of_gaps, several_coordinates
  use mech9_contact, only: contact_place_type
  use mech9_motion_view, only: link_motion_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_smooth_parts, only: gap_look_type
  use mech9_contact_motion, only: contact_motion_type, place_of_contact, acceleration_of_contact
  implicit none
  private
  public :: stop_contact_type, stop_contacts_type, find_contacts, gap_motion, gap_acceleration, look_at_gap

  !> One end of a stop, or one contact of links.
  type :: stop_contact_type
    integer :: stop = 0                  !< number of the stop; 0: links touch
    integer :: coordinate = 0            !< number of its coordinate; 0: links touch
    integer :: direction = 1             !< of the force on the coordinate: 1 at the low end, -1 at the high one
    real(wp) :: limit = 0.0_wp           !< value of the coordinate at the end [rad, m]
    real(wp) :: restitution = 0.0_wp     !< of impacts
    logical :: is_rigid = .true.         !< it cannot be pressed in
    logical :: closed = .false.          !< a rigid end touches and pushes; a compliant one is pressed in
    logical :: held = .false.            !< it has a force of its own: the coordinate is driven at the limit, or the gap has no acceleration;
                                         !< a closed rigid one without this is held by others
    integer :: contact = 0               !< place of the contact of links among all; 0: the end of a stop
    integer :: of_group = 0              !< number of its group &contact
    integer :: stretch = 0               !< of its profile, on which a contact that acts stays; 0: the nearest foot counts
  contains
    procedure :: gap
    procedure :: is_stop
    procedure :: group
    procedure :: number
    procedure :: unit
    procedure :: hidden_gap
  end type stop_contact_type

  !> All ends of all stops, and their motion at the start of a step.
  type :: stop_contacts_type
    type(stop_contact_type), allocatable :: ends(:)
    real(wp), allocatable :: gap(:)      !< (ends) gaps at the start of the step [rad, m]
    real(wp), allocatable :: rate(:)     !< (ends) their rates there, those of the last evaluation before it [rad/s, m/s]
    type(contact_place_type), allocatable :: place(:)   !< (ends) those of contacts of links there
    real(wp), allocatable :: force(:)    !< (ends) forces of those that are held there, positive while they push [N m, N]
    integer :: n_stops = 0               !< how many of the ends belong to stops; those of contacts of links stand behind them
    integer :: behind = 0                !< number of the end whose curve the ball is behind at the event that lies ahead; 0: none
    integer :: corrections = 0           !< how often the time of the event that lies ahead was corrected
  contains
    procedure :: note
    procedure :: show_pressed
    procedure :: choose_stretches
    procedure :: show_stretches
    procedure :: pass_end_of_stretch
    procedure :: any_held
    procedure :: held_coordinates
    procedure :: note_gaps
    procedure :: in_doubt
  end type stop_contacts_type

  !> A polynomial of the third degree through the ends of a step may be wrong by this part of its range within the step.
  real(wp), parameter :: doubtful_part = 0.1_wp

contains

  !> The gap that is left to the end; negative: the penetration [rad, m].
  pure real(wp) function gap(self, q)
    class(stop_contact_type), intent(in) :: self   !< the end
    real(wp), intent(in) :: q                      !< the coordinate [rad, m]

    gap = self%direction*(q - self%limit)
  end function gap

  !> Whether it is the end of a stop, and no contact of links.
  pure logical function is_stop(self)
    class(stop_contact_type), intent(in) :: self   !< the end

    is_stop = self%contact == 0
  end function is_stop

  !> The kind of its group in the data file.
  pure character(len=8) function group(self)
    class(stop_contact_type), intent(in) :: self   !< the end

    group = merge('stop   ', 'contact', self%contact == 0)
  end function group

  !> The number of its group in the data file.
  pure integer function number(self)
    class(stop_contact_type), intent(in) :: self   !< the end

    number = merge(self%stop, self%of_group, self%contact == 0)
  end function number

  !> The unit in which its gap counts [rad, m].
  pure real(wp) function unit(self, plan)
    class(stop_contact_type), intent(in) :: self   !< the end
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism

    unit = plan%length
    if (self%contact == 0) unit = plan%unit_of(self%coordinate)
  end function unit

  !> The gap that round-off hides, by that of the coordinates and by that of the time, in which drives move on: a rigid end is met
  !> or left where the gap has passed zero by more [rad, m].
  pure real(wp) function hidden_gap(self, plan, state)
    class(stop_contact_type), intent(in) :: self   !< the end
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< the state, with all rates
    real(wp) :: by_time, unit

    unit = self%unit(plan)
    by_time = spacing(state%t)*maxval(abs(state%dq)/plan%unit_of, mask=plan%driven)
    hidden_gap = max(round_off_of_gaps*max(unit, abs(self%limit)), &
                     several_coordinates*unit*max(by_time, maxval(spacing(state%q)/plan%unit_of)))
  end function hidden_gap

  !> The gap in a state, and its rate; that needs the velocities of links.
  pure function gap_motion(mechanism, plan, state, end) result(motion)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(plan_type), intent(in) :: plan              !< its plan
    type(state_type), intent(in) :: state            !< the state
    type(stop_contact_type), intent(in) :: end       !< the end
    real(wp) :: motion(2)
    type(gap_look_type) :: look

    look = look_at_gap(mechanism, plan, state, end)
    motion = [look%gap, look%rate]
  end function gap_motion

  !> The gap in a state, its rate, and the place of a contact of links; no acceleration. It needs the velocities of links.
  pure function look_at_gap(mechanism, plan, state, end) result(look)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(plan_type), intent(in) :: plan              !< its plan
    type(state_type), intent(in) :: state            !< the state
    type(stop_contact_type), intent(in) :: end       !< the end
    type(gap_look_type) :: look
    type(link_motion_type) :: ball, surface

    look%t = state%t
    if (end%contact == 0) then
      look%gap = end%gap(state%q(end%coordinate))
      look%rate = end%direction*state%dq(end%coordinate)
    else
      call place_of_contact(mechanism%contacts(end%contact), plan, state, look%place, ball, surface)
      look%gap = look%place%gap
      look%rate = look%place%gap_rate()
    end if
  end function look_at_gap

  !> The second derivative of the gap in a state with all accelerations [rad/s^2, m/s^2].
  pure real(wp) function gap_acceleration(mechanism, plan, state, end) result(acceleration)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(plan_type), intent(in) :: plan              !< its plan
    type(state_type), intent(in) :: state            !< the state
    type(stop_contact_type), intent(in) :: end       !< the end
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface

    if (end%contact == 0) then
      acceleration = end%direction*state%ddq(end%coordinate)
    else
      associate (contact => mechanism%contacts(end%contact))
        call place_of_contact(contact, plan, state, place, ball, surface)
        acceleration = dot_product(place%normal, acceleration_of_contact(contact, plan, state))
      end associate
    end if
  end function gap_acceleration

  !> All ends of the stops and all contacts of links, open.
  pure subroutine find_contacts(mechanism, contacts)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(stop_contacts_type), intent(out) :: contacts     !< the ends of its stops, and its contacts of links
    integer :: i, end, n, n_links

    n_links = 0
    if (mechanism%has_contacts()) n_links = size(mechanism%contacts)
    n = n_links
    do i = 1, size(mechanism%stops)
      n = n + count([(mechanism%stops(i)%has_end(end), end=1, 2)])
    end do
    allocate (contacts%ends(n))
    allocate (contacts%gap(n), contacts%rate(n), contacts%force(n), source=0.0_wp)
    allocate (contacts%place(n))
    n = 0
    do i = 1, size(mechanism%stops)
      do end = 1, 2
        if (.not. mechanism%stops(i)%has_end(end)) cycle
        n = n + 1
        associate (stops => mechanism%stops)
          contacts%ends(n) = stop_contact_type(i, stops(i)%coordinate, 3 - 2*end, stops(i)%ends(end), stops(i)%restitution, &
                                               stops(i)%is_rigid)
        end associate
      end do
    end do
    contacts%n_stops = n
    do i = 1, n_links
      contacts%ends(n + i) = stop_contact_type(contact=i, of_group=mechanism%contacts(i)%number, &
                                               restitution=mechanism%contacts(i)%restitution, &
                                               is_rigid=mechanism%contacts(i)%is_rigid)
    end do
  end subroutine find_contacts

  !> Note the motion from which the next step begins.
  pure subroutine note(self, mechanism, plan, state)
    class(stop_contacts_type), intent(inout) :: self   !< the ends
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(plan_type), intent(in) :: plan                !< its plan
    type(state_type), intent(in) :: state              !< the state there; rates of dependent coordinates may be a little older
    integer :: i

    call self%note_gaps(mechanism, plan, state)
    do i = 1, size(self%ends)
      self%force(i) = pushing_force(mechanism, plan, state, self%ends(i))
    end do
  end subroutine note

  !> The force of a rigid end in a state, positive while it pushes [N m, N].
  pure real(wp) function pushing_force(mechanism, plan, state, end) result(force)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(plan_type), intent(in) :: plan              !< its plan
    type(state_type), intent(in) :: state            !< the state, with the forces
    type(stop_contact_type), intent(in) :: end       !< the end
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface

    force = 0.0_wp
    if (end%contact > 0) then
      if (.not. allocated(state%contact_force)) return
      call place_of_contact(mechanism%contacts(end%contact), plan, state, place, ball, surface)
      force = dot_product(place%normal, state%contact_force(:, end%contact))
    else if (allocated(state%stop_force)) then
      force = end%direction*state%stop_force(end%stop)
    end if
  end function pushing_force

  !> Show a state which compliant ends push, and the contacts of links which of them act. Does nothing where there are none.
  pure subroutine show_pressed(self, state, contact)
    class(stop_contacts_type), intent(in) :: self   !< the ends
    type(state_type), intent(inout) :: state        !< gets compliant ends
    class(contact_motion_type), allocatable, intent(inout) :: contact   !< contacts of links; not allocated: there are none
    integer :: i

    do i = 1, size(self%ends)
      if (self%ends(i)%contact == 0) cycle
      associate (k => self%ends(i)%contact)
        contact%acts(k) = merge(self%ends(i)%held, self%ends(i)%closed, self%ends(i)%is_rigid)
        if (.not. contact%acts(k)) contact%forces(:, k) = 0.0_wp
      end associate
    end do
    if (count(.not. self%ends%is_rigid .and. self%ends%contact == 0) == 0) return
    if (.not. allocated(state%pressed)) allocate (state%pressed(2, maxval(self%ends%stop)))
    state%pressed = .false.
    do i = 1, size(self%ends)
      if (self%ends(i)%contact > 0) cycle
      if (self%ends(i)%closed) state%pressed((3 - self%ends(i)%direction)/2, self%ends(i)%stop) = .not. self%ends(i)%is_rigid
    end do
  end subroutine show_pressed

  !> Choose the stretches of their profiles on which contacts stay that act from now on, and show them a state. Only forces that follow from
  !> accelerations jump where a stretch ends: those of rigid contacts and of friction.
  pure subroutine choose_stretches(self, mechanism, plan, state, contact)
    class(stop_contacts_type), intent(inout) :: self         !< the ends
    type(mechanism_type), intent(in) :: mechanism            !< the mechanism
    type(plan_type), intent(in) :: plan                      !< its plan
    type(state_type), intent(inout) :: state                 !< gets the stretches
    type(contact_motion_type), allocatable, intent(in) :: contact   !< contacts of links, which of them act; not allocated: there are none
    type(gap_look_type) :: look
    integer :: i

    if (.not. allocated(contact)) return
    do i = self%n_stops + 1, size(self%ends)
      associate (end => self%ends(i), touched => mechanism%contacts(self%ends(i)%contact))
        if (.not. allocated(touched%profile)) cycle
        if (.not. (contact%acts(end%contact) .and. (touched%is_rigid .or. touched%has_friction()) .and. &
                   touched%profile%is_divided())) then
          end%stretch = 0
        else if (end%stretch == 0) then
          look = look_at_gap(mechanism, plan, state, end)
          end%stretch = touched%profile%stretch_of(look%place%part)
        end if
      end associate
    end do
    call self%show_stretches(state)
  end subroutine choose_stretches

  !> Show a state the stretches on which contacts stay.
  pure subroutine show_stretches(self, state)
    class(stop_contacts_type), intent(in) :: self   !< the ends
    type(state_type), intent(inout) :: state        !< gets the stretches

    if (all(self%ends%stretch == 0)) then
      if (allocated(state%stretch)) deallocate (state%stretch)
    else
      state%stretch = self%ends(self%n_stops + 1:)%stretch
    end if
  end subroutine show_stretches

  !> Let a contact go on with the stretch that follows where the ball is past the end of the present one, and show a state.
  pure subroutine pass_end_of_stretch(self, i, mechanism, plan, state)
    class(stop_contacts_type), intent(inout) :: self         !< the ends
    integer, intent(in) :: i                                 !< number of the end of this contact
    type(mechanism_type), intent(in) :: mechanism            !< the mechanism
    type(plan_type), intent(in) :: plan                      !< its plan
    type(state_type), intent(inout) :: state                 !< gets the stretch
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface

    associate (end => self%ends(i), contact => mechanism%contacts(self%ends(i)%contact))
      call place_of_contact(contact, plan, state, place, ball, surface)
      end%stretch = contact%profile%next_stretch(end%stretch, contact%centre_in_plane(ball, surface))
    end associate
    call self%show_stretches(state)
  end subroutine pass_end_of_stretch

  !> Whether any rigid end has a force of its own.
  pure logical function any_held(self)
    class(stop_contacts_type), intent(in) :: self   !< the ends

    any_held = any(self%ends%held)
  end function any_held

  !> Whether an end holds each coordinate.
  pure function held_coordinates(self, n) result(held)
    class(stop_contacts_type), intent(in) :: self   !< the ends
    integer, intent(in) :: n                        !< number of coordinates
    logical :: held(n)
    integer :: i

    held = .false.
    do i = 1, size(self%ends)
      if (self%ends(i)%held .and. self%ends(i)%contact == 0) held(self%ends(i)%coordinate) = .true.
    end do
  end function held_coordinates

  !> Whether any end that is not held may have been passed within a step. The answer costs no evaluation.
  pure logical function in_doubt(self, mechanism, plan, state, h)
    class(stop_contacts_type), intent(in) :: self   !< the ends, with the motion at the start of the step
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(in) :: state           !< positions at the end of the step, with the rates of the last evaluation
    real(wp), intent(in) :: h                       !< length of the step, with its sign [s]
    type(gap_look_type) :: now
    integer :: i

    in_doubt = stop_in_doubt(self, state%q, state%dq, plan%unit_of, h)
    do i = self%n_stops + 1, size(self%ends)
      if (in_doubt) return
      if (self%ends(i)%held) cycle
      now = look_at_gap(mechanism, plan, state, self%ends(i))
      in_doubt = .not. is_far(self%gap(i), self%rate(i), now%gap, now%rate, h, plan%length, self%ends(i)%closed)
      if (.not. in_doubt) &
        in_doubt = .not. mechanism%contacts(self%ends(i)%contact)%is_smooth_between(self%place(i), now%place, h)
    end do
  end function in_doubt

  !> Note the motion from which the next step begins, without forces.
  pure subroutine note_gaps(self, mechanism, plan, state)
    class(stop_contacts_type), intent(inout) :: self   !< the ends
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(plan_type), intent(in) :: plan                !< its plan
    type(state_type), intent(in) :: state              !< the state there; rates of dependent coordinates may be a little older
    type(gap_look_type) :: look
    integer :: i

    call note_stops(self%n_stops, self%ends, state%q, state%dq, self%gap, self%rate)
    do i = self%n_stops + 1, size(self%ends)
      look = look_at_gap(mechanism, plan, state, self%ends(i))
      self%gap(i) = look%gap
      self%rate(i) = look%rate
      self%place(i) = look%place
    end do
  end subroutine note_gaps

  !> Note the gaps of ends of stops. The shapes are explicit, so that the loop needs no strides.
  pure subroutine note_stops(n, ends, q, dq, gap, rate)
    integer, intent(in) :: n                         !< number of the ends
    type(stop_contact_type), intent(in) :: ends(n)   !< the ends
    real(wp), intent(in) :: q(*)                     !< (M) coordinates [rad, m]
    real(wp), intent(in) :: dq(*)                    !< (M) their rates [rad/s, m/s]
    real(wp), intent(inout) :: gap(n)                !< gets the gaps [rad, m]
    real(wp), intent(inout) :: rate(n)               !< gets their rates [rad/s, m/s]
    integer :: i

    do i = 1, n
      gap(i) = ends(i)%direction*(q(ends(i)%coordinate) - ends(i)%limit)
      rate(i) = ends(i)%direction*dq(ends(i)%coordinate)
    end do
  end subroutine note_stops

  !> Whether an end of a stop that is not held may have been passed within a step.
  pure logical function stop_in_doubt(contacts, q, dq, unit, h) result(in_doubt)
    type(stop_contacts_type), intent(in) :: contacts   !< the ends, with the motion at the start of the step
    real(wp), intent(in) :: q(*)                       !< (M) coordinates at the end of the step [rad, m]
    real(wp), intent(in) :: dq(*)                      !< (M) their rates [rad/s, m/s]
    real(wp), intent(in) :: unit(*)                    !< (M) units in which coordinates count [rad, m]
    real(wp), intent(in) :: h                          !< length of the step, with its sign [s]
    integer :: i, c

    in_doubt = .false.
    do i = 1, contacts%n_stops
      associate (end => contacts%ends(i))
        if (end%held) cycle
        c = end%coordinate
        in_doubt = .not. is_far(contacts%gap(i), contacts%rate(i), end%direction*(q(c) - end%limit), end%direction*dq(c), &
                                h, unit(c), end%closed)
      end associate
      if (in_doubt) return
    end do
  end function stop_in_doubt

  !> Whether a gap surely kept its sign within a step: the control points of the polynomial through the ends of the step lie far from zero,
  !> and it does not leave their hull.
  pure logical function is_far(gap, rate, gap_now, rate_now, h, unit, closed)
    real(wp), intent(in) :: gap        !< the gap at the start of the step [rad, m]
    real(wp), intent(in) :: rate       !< its rate there [rad/s, m/s]
    real(wp), intent(in) :: gap_now    !< the gap at the end of the step [rad, m]
    real(wp), intent(in) :: rate_now   !< its rate there [rad/s, m/s]
    real(wp), intent(in) :: h          !< length of the step, with its sign [s]
    real(wp), intent(in) :: unit       !< unit in which the gap counts [rad, m]
    logical, intent(in) :: closed      !< the end is closed: the gap is below zero
    real(wp) :: first, last, least, greatest

    first = gap + h*rate/3.0_wp
    last = gap_now - h*rate_now/3.0_wp
    least = min(gap, first, last, gap_now)
    greatest = max(gap, first, last, gap_now)
    if (closed) then
      is_far = -greatest >= doubtful_part*(greatest - least) + 1.0e-9_wp*unit
    else
      is_far = least >= doubtful_part*(greatest - least) + 1.0e-9_wp*unit
    end if
  end function is_far
end module mech9_stop_contacts
