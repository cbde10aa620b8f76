!> The events of contacts at one time: impacts, which ends of stops are closed and hold their coordinates afterwards, and which links touch.
!>
!> A contact that falls back after each impact touches for good in finite time: with the rate u after an impact and the acceleration -a, the
!> flights last 2u/a, e 2u/a, e^2 2u/a, ..., together 2u/(a (1 - e)).
module mech9_contact_events
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: touching, drawn_behind_stop, jumped_behind, least_rebound, hidden_rebound, endless_part, &
    pressing
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_event_failures, only: failure_stop_start, failure_contact_start, failure_contact_behind
  use mech9_result_units, only: unit_of, unit_name
  use mech9_motion_event, only: motion_event_type, motion_events_type, event_impact, event_close, event_open, event_lift, &
    event_stick, event_slip
  use mech9_motion_system, only: motion_system_type
  use mech9_stop_contacts, only: stop_contact_type, stop_contacts_type, gap_motion, gap_acceleration
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_contact_motion, only: correct_rates, place_of_contact, acceleration_of_contact
  use mech9_varied_impact, only: impact_type
  use mech9_contact_equations, only: contact_equations_type, contact_outcome_type, shock_type, find_contact_equations, &
    find_impact, find_pushing
  implicit none
  private
  public :: begin_contacts, meet_contacts, find_pressed, refuse_jump

  !> A contact comes to rest where that takes this part of the rates at most: far more than errors of integration ...
  real(wp), parameter :: lost_at_rest = 1.0e-3_wp
  !> ... or as much as the accelerations take within so many times the time by which the event may be early.
  real(wp), parameter :: longest_lead = 1.0e2_wp
  !> A contact has turned back where this part of its direction at least is against the earlier one.
  real(wp), parameter :: turned_back = 0.5_wp

contains

  !> Close the compliant ends that are pressed in at the start. Fails where a rigid one is passed already.
  subroutine begin_contacts(system, contacts, err)
    class(motion_system_type), intent(inout) :: system     !< the system at the start; its state shows the ends that push
    type(stop_contacts_type), intent(inout) :: contacts    !< all ends, open
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: motion(2)
    integer :: i

    do i = 1, size(contacts%ends)
      associate (end => contacts%ends(i))
        motion = gap_motion(system%model%mechanism, system%plan, system%state, end)
        if (motion(1) >= -drawn_behind_stop*end%unit(system%plan)) cycle
        end%closed = .not. end%is_rigid
        if (end%closed) cycle
        call raise(err, exit_data, merge(failure_stop_start, failure_contact_start, end%is_stop()))
        err%failure%number = end%number()
        if (end%is_stop()) then
          err%failure%coordinates = [end%coordinate]
          err%failure%values = reshape([system%state%q(end%coordinate), end%limit], [1, 2]) &
                               /unit_of(system%model%mechanism, end%coordinate)
          err%failure%name = trim(unit_name(system%model%mechanism, end%coordinate))
          err%place = system%model%mechanism%stops(end%stop)%place
        else
          err%failure%values = reshape([motion(1)], [1, 1])
          err%place = system%model%mechanism%contacts(end%contact)%place
        end if
        return
      end associate
    end do
    call show_ends(system, contacts)
  end subroutine begin_contacts

  !> Show the system which compliant ends push, which contacts of links act, and the stretches of their profiles.
  subroutine show_ends(system, contacts)
    class(motion_system_type), intent(inout) :: system     !< the system; its state and its contacts get them
    type(stop_contacts_type), intent(inout) :: contacts    !< all ends; get the stretches of contacts that act from now on

    call contacts%show_pressed(system%state, system%contact)
    call contacts%choose_stretches(system%model%mechanism, system%plan, system%state, system%contact)
  end subroutine show_ends

  !> Meet all contacts at the present state of the system, whose independent rates change at impacts. A compliant end that is met or left is
  !> noted alone. Fails where drives move a coordinate beyond its stop.
  subroutine meet_contacts(system, met, rubbing, of_held, contacts, impulses, changes, impact, holds_change, events, err, again)
    class(motion_system_type), intent(inout) :: system                     !< the system, moved to the time, with all rates
    integer, intent(in) :: met                                             !< number of the end that is met or left; 0: none
    integer, intent(inout) :: rubbing              !< number of the contact of links that comes to rest or can stick no longer; 0: none.
                                                   !< It is 0 afterwards where the contact came to rest
    real(wp), intent(in) :: of_held(:)                                     !< (M) rates that held coordinates would have if nothing held them
    type(stop_contacts_type), intent(inout) :: contacts                    !< all ends; those that are closed and held change
    real(wp), intent(out) :: impulses(:)                                   !< (M) on coordinates, positive while they grow [N m s, N s]
    real(wp), intent(out) :: changes(:)                                    !< (M) of the rates of all coordinates [rad/s, m/s]
    type(impact_type), intent(out) :: impact                               !< not allocated parts: there is none
    logical, intent(out) :: holds_change                                   !< other coordinates are to be held
    type(motion_events_type), intent(inout) :: events                      !< gets the events
    type(error_type), allocatable, intent(out) :: err                      !< allocated if it failed
    logical, intent(in), optional :: again         !< they were met at this time, and `rubbing` can stick no longer; not unless given
    integer, allocatable :: touch(:)
    real(wp), allocatable :: by_contact(:, :), ends_after(:)
    type(contact_outcome_type) :: outcome
    integer :: i
    logical :: comes_to_rest

    holds_change = .false.
    impulses = 0.0_wp
    changes = 0.0_wp
    if (met > 0) then
      call refuse_jump(system, contacts%ends(met), err)
      if (allocated(err)) return
      call pass_compliant_end(system%state%t, contacts%ends(met), events)
      if (.not. (contacts%ends(met)%is_stop() .or. contacts%ends(met)%is_rigid)) &
        system%contact%sticks(contacts%ends(met)%contact) = .false.
    end if
    call show_ends(system, contacts)
    touch = pack([(i, i=1, size(contacts%ends))], [(touches(system, contacts%ends(i), i == met), i=1, size(contacts%ends))])
    if (allocated(system%contact)) system%state%contact_force = 0.0_wp
    if (size(touch) == 0) then
      system%state%dq = system%state%dq + of_held
      return
    end if
    call settle(system, contacts, touch, err)
    if (allocated(err)) return
    changes = -system%state%dq
    system%state%dq = system%state%dq + of_held
    comes_to_rest = .false.
    if (rubbing > 0) comes_to_rest = .not. system%contact%sticks(rubbing)
    if (present(again)) comes_to_rest = comes_to_rest .and. .not. again
    if (comes_to_rest) call bring_to_rest(system, rubbing, comes_to_rest, err)
    if (allocated(err)) return
    if (comes_to_rest) rubbing = 0
    call find_outcome(system, contacts, touch, met, rubbing, by_contact, ends_after, outcome, err)
    if (allocated(err)) return
    changes = changes + system%state%dq
    if (any(by_contact(1, :) > 0.0_wp)) impact = impact_of(contacts%ends, touch, by_contact(1, :), ends_after, outcome)
    do i = 1, size(touch)
      associate (end => contacts%ends(touch(i)))
        if (end%is_stop()) then
          holds_change = holds_change .or. (outcome%holds(i) .neqv. end%held)
          impulses(end%coordinate) = impulses(end%coordinate) + end%direction*by_contact(1, i)
        end if
        if (end%is_rigid) then
          call note_events(system%state%t, end, by_contact(1, i), ends_after(i), outcome%holds(i), events)
          end%closed = outcome%holds(i)
          end%held = outcome%holds(i)
        end if
        if (.not. end%is_stop()) call take_friction(system, end, outcome%sticks(i), outcome%direction(:, i), events)
      end associate
    end do
    call show_ends(system, contacts)
    if (.not. allocated(system%contact)) return
    call rest_exactly(system, err)
    if (allocated(err)) return
    ! impulses of pairs are those of contacts, too
    system%state%contact_force = 0.0_wp
    do i = 1, size(touch)
      if (.not. contacts%ends(touch(i))%is_stop()) &
        system%state%contact_force(:, contacts%ends(touch(i))%contact) = outcome%impulse(:, i)
    end do
  end subroutine meet_contacts

  !> The impact on ends of stops and on contacts.
  pure type(impact_type) function impact_of(ends, touch, impulse, ends_after, outcome) result(impact)
    type(stop_contact_type), intent(in) :: ends(:)     !< all ends
    integer, intent(in) :: touch(:)                    !< numbers of those that touch
    real(wp), intent(in) :: impulse(:)                 !< (touch) along their normals [N m s, N s]
    real(wp), intent(in) :: ends_after(:)              !< (touch) time until endless impacts end; negative: there are none [s]
    type(contact_outcome_type), intent(in) :: outcome  !< with the impulses of contacts
    logical :: has(size(touch))
    integer :: i

    has = impulse > 0.0_wp
    impact%ends = pack(touch, has)
    impact%impulse = pack(impulse, has)
    impact%restitution = pack(merge(0.0_wp, ends(touch)%restitution, ends_after >= 0.0_wp), has)
    impact%whole = outcome%impulse(:, pack([(i, i=1, size(touch))], has))
    impact%sticks = pack(outcome%stopped, has)
  end function impact_of

  !> Fail where a ball is far behind its surface that is open: it has come round an end of a path.
  subroutine refuse_jump(system, end, err)
    class(motion_system_type), intent(in) :: system    !< the system
    type(stop_contact_type), intent(in) :: end         !< the end that is met or left
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    real(wp) :: motion(2)

    if (end%is_stop() .or. end%closed) return
    motion = gap_motion(system%model%mechanism, system%plan, system%state, end)
    if (motion(1) >= -jumped_behind*end%unit(system%plan)) return
    call raise(err, exit_singular, failure_contact_behind)
    err%failure%number = end%number()
    err%failure%t = system%state%t
    err%failure%values = reshape([motion(1)], [1, 1])
    err%place = system%model%mechanism%contacts(end%contact)%place
  end subroutine refuse_jump

  !> Take from a contact of links that comes to rest the slip that errors of integration have left. Where the slip vanishes because no
  !> coordinate moves the contact along itself, as at a dead point, the rates stay: the contact slides on, the other way.
  subroutine bring_to_rest(system, number, rests, err)
    class(motion_system_type), intent(inout) :: system     !< the system; its independent rates change
    integer, intent(in) :: number                          !< of the contact
    logical, intent(out) :: rests                          !< the contact can come to rest
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface
    real(wp) :: before(size(system%plan%independent)), slip, deceleration, change, by_time

    associate (contact => system%model%mechanism%contacts(number), plan => system%plan, state => system%state, &
               units => system%plan%unit_of(system%plan%independent))
      before = state%dq(plan%independent)
      call place_of_contact(contact, plan, state, place, ball, surface)
      slip = norm2(place%slip - place%gap_rate()*place%normal)
      deceleration = norm2(acceleration_of_contact(contact, plan, state))
      by_time = slip*maxval(abs(state%ddq(plan%independent)/units))
      system%contact%sticks(number) = .true.
      call rest_exactly(system, err)
      system%contact%sticks(number) = .false.
      if (allocated(err)) return
      change = maxval(abs(state%dq(plan%independent) - before)/units)
      rests = change <= lost_at_rest*maxval(abs(before)/units) .or. change*deceleration <= longest_lead*by_time
      if (.not. rests) state%dq(plan%independent) = before
    end associate
  end subroutine bring_to_rest

  !> Correct the independent rates by round-off, so that closed contacts of links have no rates.
  subroutine rest_exactly(system, err)
    class(motion_system_type), intent(inout) :: system     !< the system; its independent rates change
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    call correct_rates(system%model%mechanism, system%plan, system%dynamics, system%state, system%work, system%contact, err)
  end subroutine rest_exactly

  !> Let a contact of links slide or stick from now on.
  subroutine take_friction(system, end, sticks, direction, events)
    class(motion_system_type), intent(inout) :: system         !< the system
    type(stop_contact_type), intent(in) :: end                 !< the contact, closed or open as it is from now on
    logical, intent(in) :: sticks                              !< friction holds it
    real(wp), intent(in) :: direction(3)                       !< in which it slides, of length 1; fixed axes
    type(motion_events_type), intent(inout) :: events          !< gets the event

    associate (k => end%contact, contact => system%contact)
      if (end%closed .and. ((sticks .neqv. contact%sticks(k)) .or. &
                            (.not. sticks .and. contact%forces(1, k) > 0.0_wp .and. &
                                                                 dot_product(direction, contact%direction(:, k)) < -turned_back))) &
        call events%add(motion_event_type(system%state%t, merge(event_stick, event_slip, sticks), 'contact', end%number()))
      contact%sticks(k) = sticks .and. end%closed
      contact%direction(:, k) = direction
    end associate
  end subroutine take_friction

  !> Find whether contacts do not agree with the frictions of pairs, which were chosen after them: frictions and loads press one that touches
  !> and rests, but does not hold its coordinate, or a contact of links has a force or a friction that its mode does not allow.
  subroutine find_pressed(system, contacts, met, pressed, err)
    class(motion_system_type), intent(inout) :: system     !< the system, with the rates of independent coordinates and its modes of friction
    type(stop_contacts_type), intent(in) :: contacts       !< all ends
    integer, intent(in) :: met                             !< number of the end that was met or released, and judged; 0: none
    logical, intent(out) :: pressed                        !< there is one
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(contact_equations_type) :: equations
    integer, allocatable :: judged(:)
    integer :: i

    pressed = .false.
    if (all(system%model%mechanism%frictions%is_smooth) .and. .not. allocated(system%contact)) return
    judged = pack([(i, i=1, size(contacts%ends))], [(may_disagree(i), i=1, size(contacts%ends))])
    if (size(judged) == 0) return
    call find_contact_equations(system, contacts%held_coordinates(system%plan%n_coordinates), contacts%ends(judged), equations, err)
    if (.not. allocated(err)) call system%present(err)
    if (allocated(err)) return
    do i = 1, size(judged)
      associate (end => contacts%ends(judged(i)))
        if (end%contact > 0 .and. (end%held .or. .not. end%is_rigid)) then
          pressed = pressed .or. is_contradicted(system, end%contact, norm2(equations%slip(:, i)) <= equations%still(i))
        else
          pressed = pressed .or. (abs(equations%rates(i)) <= equations%round_off(i) .and. .not. equations%g(i, i) <= 0.0_wp .and. &
                                  gap_acceleration(system%model%mechanism, system%plan, system%state, end) &
                                  < -pressing*maxval(abs(system%state%ddq)))
        end if
      end associate
    end do
  contains
    !> Whether an end can disagree: a contact of links that acts, or an end that touches and does not hold its coordinate.
    logical function may_disagree(i)
      integer, intent(in) :: i   !< number of the end

      associate (end => contacts%ends(i))
        may_disagree = touches(system, end, .false.)
        if (.not. (end%contact > 0 .and. (end%held .or. .not. end%is_rigid))) &
          may_disagree = may_disagree .and. i /= met .and. .not. end%held
      end associate
    end function may_disagree
  end subroutine find_pressed

  !> Whether the force of a contact of links that acts contradicts its mode.
  pure logical function is_contradicted(system, number, rests)
    class(motion_system_type), intent(in) :: system        !< the system, with its forces and accelerations
    integer, intent(in) :: number                          !< of the contact
    logical, intent(in) :: rests                           !< it has no slip
    real(wp) :: acceleration(3)

    associate (contact => system%model%mechanism%contacts(number), acting => system%contact)
      is_contradicted = acting%forces(1, number) < -pressing*maxval(abs(acting%forces))
      if (.not. contact%has_friction()) return
      if (acting%sticks(number)) then
        is_contradicted = is_contradicted .or. acting%excess(contact, number) > pressing
      else if (rests) then
        acceleration = acceleration_of_contact(contact, system%plan, system%state)
        is_contradicted = is_contradicted .or. &
                          dot_product(acceleration, acting%direction(:, number)) < -pressing*maxval(abs(system%state%ddq))
      end if
    end associate
  end function is_contradicted

  !> Whether a rigid end touches, or a compliant contact of links is pressed.
  pure logical function touches(system, end, is_met)
    class(motion_system_type), intent(in) :: system   !< the system
    type(stop_contact_type), intent(in) :: end        !< the end
    logical, intent(in) :: is_met                     !< it is met or left now
    real(wp) :: motion(2)

    touches = end%held .or. (is_met .and. end%is_rigid)
    if (.not. end%is_rigid) touches = end%closed .and. .not. end%is_stop()
    if (touches .or. .not. end%is_rigid) return
    motion = gap_motion(system%model%mechanism, system%plan, system%state, end)
    touches = motion(1) <= max(touching*end%unit(system%plan), 4.0_wp*spacing(end%limit))
  end function touches

  !> Move the contacts that touch onto their ends, from which the integration leaves them a little: by the least motion, weighed by mass.
  subroutine settle(system, contacts, touch, err)
    class(motion_system_type), intent(inout) :: system     !< the system; its position changes by the errors of integration
    type(stop_contacts_type), intent(in) :: contacts       !< all ends
    integer, intent(in) :: touch(:)                        !< numbers of the rigid ones that touch
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(contact_equations_type) :: equations
    real(wp) :: motion(2), t, y(system%size_of_vector()), rates(size(system%plan%independent))
    integer :: i

    if (all(contacts%ends(touch)%held .or. .not. contacts%ends(touch)%is_rigid)) return
    call find_contact_equations(system, contacts%held_coordinates(system%plan%n_coordinates), contacts%ends(touch), equations, err)
    if (allocated(err)) return
    associate (q => system%state%q, moved => system%plan%independent(equations%free))
      do i = 1, size(touch)
        associate (end => contacts%ends(touch(i)))
          if (end%held .or. .not. (equations%g(i, i) > 0.0_wp .and. end%is_rigid)) cycle
          motion = gap_motion(system%model%mechanism, system%plan, system%state, end)
          q(moved) = q(moved) - motion(1)/equations%g(i, i)*equations%answers(:, 1, i)
        end associate
      end do
    end associate
    t = system%state%t
    y = system%vector()
    ! drives that hold sticking pairs must not take the rates that an impact has given these
    rates = system%state%dq(system%plan%independent)
    call system%project(t, y, err)
    system%state%dq(system%plan%independent) = rates
    if (.not. allocated(err)) call system%present(err)
    system%state%t = t
  end subroutine settle

  !> Note that a compliant end is met or left. Does nothing to a rigid one.
  pure subroutine pass_compliant_end(t, end, events)
    real(wp), intent(in) :: t                                          !< time [s]
    type(stop_contact_type), intent(inout) :: end                      !< the end
    type(motion_events_type), intent(inout) :: events                  !< gets the event

    if (end%is_rigid) return
    end%closed = .not. end%closed
    call events%add(motion_event_type(t, event_of(end, end%closed), end%group(), end%number()))
  end subroutine pass_compliant_end

  !> The kind of the event by which an end closes or opens.
  pure character(len=6) function event_of(end, closes)
    type(stop_contact_type), intent(in) :: end   !< the end
    logical, intent(in) :: closes                !< it closes

    event_of = event_close
    if (.not. closes) event_of = merge(event_open, event_lift, end%is_stop())
  end function event_of

  !> Find impulses and the contacts that push afterwards. Where endless impacts would end at once, they are left out.
  subroutine find_outcome(system, contacts, touch, met, slides_on, impulses, ends_after, outcome, err)
    class(motion_system_type), intent(inout) :: system             !< the system; its independent rates change
    type(stop_contacts_type), intent(in) :: contacts               !< all ends
    integer, intent(in) :: touch(:)                                !< numbers of the rigid ones that touch
    integer, intent(in) :: met                                     !< number of the end that is met, or released if it is held; 0: none
    integer, intent(in) :: slides_on                               !< number of the contact of links that can stick no longer; 0: none
    real(wp), allocatable, intent(out) :: impulses(:, :)           !< (3,touch) of impacts, along normal and tangents [N m s, N s]
    real(wp), allocatable, intent(out) :: ends_after(:)            !< (touch) time until endless impacts end; negative: there are none [s]
    type(contact_outcome_type), intent(out) :: outcome             !< gets modes and directions of the contacts
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    type(contact_equations_type) :: equations, after
    logical :: held(system%plan%n_coordinates)
    real(wp), dimension(size(touch)) :: restitution, rates
    real(wp) :: before(size(system%plan%independent)), duration, time, height
    integer :: i, round
    logical :: cut

    allocate (impulses(3, size(touch)))
    allocate (ends_after(size(touch)), source=-1.0_wp)
    held = contacts%held_coordinates(size(held))
    duration = abs(system%model%request%time%end - system%model%request%time%start)
    associate (ends => contacts%ends(touch))
      call find_contact_equations(system, held, ends, equations, err)
      if (allocated(err)) return
      restitution = ends%restitution
      before = system%state%dq(system%plan%independent)
      ! a contact that comes to rest may press others, whose impacts then end, too
      do round = 0, size(touch)
        system%state%dq(system%plan%independent) = before
        call meet(err)
        if (allocated(err)) return
        cut = .false.
        do i = 1, size(touch)
          if (.not. (impulses(1, i) > 0.0_wp .and. rates(i) > 0.0_wp .and. outcome%accelerations(i) < 0.0_wp)) cycle
          if (restitution(i) >= 1.0_wp) cycle
          time = 2.0_wp*rates(i)/(-outcome%accelerations(i)*(1.0_wp - restitution(i)))
          height = -0.5_wp*rates(i)**2/outcome%accelerations(i)
          ! rebounds within the round-off of the gap are not impacts
          if (height > hidden_rebound*ends(i)%hidden_gap(system%plan, system%state) .and. &
              (height > least_rebound*ends(i)%unit(system%plan) .or. time > endless_part*duration)) cycle
          ends_after(i) = time
          restitution(i) = 0.0_wp
          cut = .true.
        end do
        if (.not. cut) exit
      end do
    end associate
  contains
    !> Find the impact, and the contacts that push after it.
    subroutine meet(err)
      type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
      type(shock_type) :: shock
      logical :: at_rest(size(touch))
      integer :: sliding

      call find_impact(system, contacts%ends(touch), equations, restitution, shock, err)
      if (allocated(err)) return
      impulses = shock%impulses
      rates = shock%rates
      at_rest = .not. abs(rates) > 0.0_wp
      ! the force of a released end passes zero: round-off must not close it again
      if (.not. any(impulses(1, :) > 0.0_wp)) at_rest = at_rest .and. .not. (touch == met .and. contacts%ends(touch)%held)
      sliding = 0
      if (slides_on > 0) sliding = findloc(contacts%ends(touch)%contact, slides_on, dim=1)
      if (.not. equations%rubs .or. .not. any(abs(impulses) > 0.0_wp)) then
        call find_pushing(system, contacts%ends(touch), equations, at_rest, sliding, outcome, err)
      else
        ! slips are others after an impact
        call find_contact_equations(system, held, contacts%ends(touch), after, err)
        if (allocated(err)) return
        call after%allow_change(system%state%dq(system%plan%independent) - before)
        call find_pushing(system, contacts%ends(touch), after, at_rest, sliding, outcome, err)
      end if
      if (allocated(err)) return
      outcome%stopped = shock%stopped
      do i = 1, size(touch)
        outcome%impulse(:, i) = matmul(equations%axes(:, :, i), impulses(:, i))
      end do
    end subroutine meet
  end subroutine find_outcome

  !> Note the events of one rigid end.
  pure subroutine note_events(t, end, impulse, ends_after, holds, events)
    real(wp), intent(in) :: t                                          !< time [s]
    type(stop_contact_type), intent(in) :: end                         !< the end, as it was
    real(wp), intent(in) :: impulse                                    !< of an impact; 0: there is none [N m s, N s]
    real(wp), intent(in) :: ends_after                                 !< time until endless impacts end; negative: there are none [s]
    logical, intent(in) :: holds                                       !< it is closed from now on
    type(motion_events_type), intent(inout) :: events                  !< gets the events

    if (impulse > 0.0_wp .and. .not. ends_after >= 0.0_wp) &
      call events%add(motion_event_type(t, event_impact, end%group(), end%number(), .true., end%direction*impulse))
    if (holds .and. .not. end%held) &
      call events%add(motion_event_type(t + max(ends_after, 0.0_wp), event_close, end%group(), end%number()))
    if (end%held .and. .not. holds) call events%add(motion_event_type(t, event_of(end, .false.), end%group(), end%number()))
  end subroutine note_events
end module mech9_contact_events
