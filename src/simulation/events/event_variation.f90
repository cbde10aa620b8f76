!> Derivatives of a motion by parameters through an event: a jump of rates or accelerations at a time that depends on the parameters.
!>
!> With the state x, the event h(t, x, p) = 0 and the jump x' = g(t, x, p), derivatives s of the state at a fixed time become those at the
!> event by the derivative of its time, dt/dp = -(h_x s + h_p)/(rate of h), as s + (rate of x) dt/dp. They pass the jump by the derivative
!> of g, and go back to a fixed time by - (rate of x') dt/dp. As a matrix this is the saltation g_x + (f' - g_x f - g_t) h_x/(h_t + h_x f):
!> M. A. Aizerman and F. R. Gantmakher, On the Stability of Periodic Motions, J. Appl. Math. Mech. 22 (1958); P. C. Müller, Calculation of
!> Lyapunov Exponents for Dynamic Systems with Discontinuities, Chaos Solitons Fractals 5 (1995); R. I. Leine and H. Nijmeijer, Dynamics and
!> Bifurcations of Non-Smooth Mechanical Systems, Springer 2004; with parameters I. A. Hiskens and M. A. Pai, Trajectory Sensitivity
!> Analysis of Hybrid Systems, IEEE Trans. Circuits Syst. I 47 (2000).
module mech9_event_variation
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_event_failures, only: cause_grazing, cause_several_impacts, cause_start_on_stop, cause_no_motion, &
    cause_drive_jumps, cause_breaks_loose, cause_held_hit, cause_contact_loose, &
    cause_contact_rest, cause_slip_at_rest, cause_corner_rest
  use mech9_event_tolerances, only: grazing, least_rebound
  use mech9_state, only: state_type, copy_state
  use mech9_tangent, only: tangent_type
  use mech9_variable_model, only: variable_model_type
  use mech9_integration_tolerances, only: round_off_of_jumps
  use mech9_frame_motion, only: place_all
  use mech9_motion_system, only: motion_system_type
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_contact_change, only: of_restitution
  use mech9_contact_motion, only: place_of_contact, acceleration_of_contact
  use mech9_varied_contacts, only: contact_variation_type, vary_contact, varied_numbers
  use mech9_stop_contacts, only: stop_contact_type, gap_motion, gap_acceleration
  use mech9_release_rate, only: find_use_rate
  use mech9_event_refusals, only: refuse, refuse_at, hits_others
  use mech9_contact_equations, only: contact_equations_type, find_contact_equations
  use mech9_held_directions, only: hold_directions
  use mech9_motion_event, only: motion_events_type
  use mech9_varied_impact, only: impact_type, add_varied_impact, meet_targets
  implicit none
  private
  public :: event_variation_type, meet_rubbing, end_passage

  !> The derivatives at one event: at first at its time held fixed, then carried along with the time of the event.
  type :: event_variation_type
    real(wp), allocatable :: time(:)          !< (P) derivatives of the time of the event [s]
    logical :: knows_time = .false.           !< these are known; else they are zero, and nothing jumps
    real(wp), allocatable :: q(:, :, :)       !< (P,0:1,M) derivatives of all coordinates and their rates
    real(wp), allocatable :: motors(:, :)     !< (P,motors) those of the states of motors
    real(wp), allocatable :: dq(:)            !< (M) rates of all coordinates before the event [rad/s, m/s]
    real(wp), allocatable :: ddq(:)           !< (M) their accelerations before it [rad/s^2, m/s^2]
    real(wp), allocatable :: motor_rates(:)   !< (motors) rates of the states of motors before it
    real(wp), allocatable :: gaps(:, :, :)    !< (P,0:2,contacts) derivatives of gaps, of their rates, and of slips in the direction in which
                                              !< contacts slide, at a fixed time before it [m, m/s]
    real(wp), allocatable :: slips(:, :, :)   !< (P,3,contacts) derivatives of slips at a fixed time before it, fixed axes [m/s]
    real(wp), allocatable :: past(:, :)       !< (P,contacts) derivatives of ways past the end of a stretch of a profile [m]
    real(wp), allocatable :: past_rate(:)     !< (contacts) rates of these ways [m/s]
    logical, allocatable :: rests(:)          !< (contacts) there is no slip before it
    logical, allocatable :: acted(:)          !< (contacts) there is a force before it
    real(wp), allocatable :: gap_motion(:, :) !< (0:2,contacts) the gaps, their rates and accelerations before it [m]
  contains
    procedure :: begin
    procedure :: set_time
    procedure :: meet_stop
    procedure :: meet_friction
    procedure :: meet_corner
    procedure :: pass_contacts
    procedure :: put_behind
    procedure :: hand_on
    procedure :: check_start
  end type event_variation_type

contains

  !> The derivatives of a gap by all parameters, at a fixed time [rad, m].
  function varied_gap(self, tangents, end) result(changes)
    type(event_variation_type), intent(in) :: self  !< the derivatives, at a fixed time
    type(tangent_type), intent(in) :: tangents(:)   !< (P) derivatives of the constants
    type(stop_contact_type), intent(in) :: end      !< the end of a stop, or a contact
    real(wp) :: changes(size(tangents))

    if (end%is_stop()) then
      changes = end%direction*(self%q(:, 0, end%coordinate) - varied_number(tangents, end, merge(1, 2, end%direction > 0)))
    else
      changes = self%gaps(:, 0, end%contact)
    end if
  end function varied_gap

  !> The derivatives of a number of a stop by all parameters.
  pure function varied_number(tangents, end, place) result(changes)
    type(tangent_type), intent(in) :: tangents(:)   !< (P) derivatives of the constants
    type(stop_contact_type), intent(in) :: end      !< an end of the stop
    integer, intent(in) :: place                    !< 1: the low end, 2: the high one, 3: the restitution
    real(wp) :: changes(size(tangents))
    integer :: p

    changes = 0.0_wp
    do p = 1, size(tangents)
      if (tangents(p)%stops(end%stop)%varies) changes(p) = tangents(p)%stops(end%stop)%change(place)
    end do
  end function varied_number

  !> The derivatives of the restitution of a stop or a contact by all parameters.
  function varied_restitution(system, end) result(changes)
    class(motion_system_type), intent(in) :: system        !< the system
    type(stop_contact_type), intent(in) :: end             !< the end of a stop, or a contact
    real(wp) :: changes(size(system%sensitivity%motion%tangents))
    real(wp), allocatable :: numbers(:)
    integer :: p

    associate (tangents => system%sensitivity%motion%tangents)
      if (end%is_stop()) then
        changes = varied_number(tangents, end, 3)
        return
      end if
      changes = 0.0_wp
      do p = 1, size(tangents)
        numbers = varied_numbers(system%model%mechanism, tangents(p), end%contact)
        if (size(numbers) > 0) changes(p) = numbers(of_restitution)
      end do
    end associate
  end function varied_restitution

  !> The rate of a gap before the event, and its derivative in time.
  pure function motion_before(self, end) result(motion)
    type(event_variation_type), intent(in) :: self         !< the event
    type(stop_contact_type), intent(in) :: end             !< the end of a stop, or a contact
    real(wp) :: motion(2)

    if (end%is_stop()) then
      motion = end%direction*[self%dq(end%coordinate), self%ddq(end%coordinate)]
    else
      motion = self%gap_motion(1:2, end%contact)
    end if
  end function motion_before

  !> The derivatives of the rate of a gap before the event by all parameters, carried along with its time.
  function rate_carried(self, end) result(changes)
    type(event_variation_type), intent(in) :: self         !< the derivatives, carried along
    type(stop_contact_type), intent(in) :: end             !< the end of a stop, or a contact
    real(wp) :: changes(size(self%time))

    if (end%is_stop()) then
      changes = end%direction*self%q(:, 1, end%coordinate)
    else
      changes = self%gaps(:, 1, end%contact) + self%time*self%gap_motion(2, end%contact)
    end if
  end function rate_carried

  !> Begin at the time of an event, which at first does not change with parameters.
  subroutine begin(self, system, of_held, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives
    class(motion_system_type), intent(inout) :: system     !< the system before the event, with its motion
    real(wp), intent(in) :: of_held(:)                     !< (M) rates that held coordinates would have if nothing held them [rad/s, m/s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if they do not exist in this position

    if (any(abs(of_held) > 0.0_wp)) call refuse(system, cause_drive_jumps, 0, err)
    if (.not. allocated(err)) call system%show_sensitivity(err)
    if (allocated(err)) return
    associate (q => system%sensitivity%motion%q)
      allocate (self%q(size(q, 1), 0:1, size(q, 3)))
      self%q = q(:, 0:1, :)
    end associate
    self%motors = system%sensitivity%motors(:, :, 0)
    self%dq = system%state%dq
    self%ddq = system%state%ddq
    self%motor_rates = spread(0.0_wp, 1, size(self%motors, 2))
    if (allocated(system%state%motor)) self%motor_rates = system%state%motor_rate
    self%time = spread(0.0_wp, 1, size(self%q, 1))
    if (allocated(system%contact)) call keep_gaps(self, system)
  end subroutine begin

  !> Keep the gaps of all contacts before the event, and their derivatives.
  subroutine keep_gaps(self, system)
    class(event_variation_type), intent(inout) :: self     !< gets them
    class(motion_system_type), intent(in) :: system        !< the system before the event, with its motion
    type(stop_contact_type) :: end
    type(contact_variation_type) :: variation
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface
    integer :: i

    if (allocated(self%gaps)) deallocate (self%gaps, self%slips, self%rests, self%gap_motion, self%past, self%past_rate)
    associate (n => size(system%model%mechanism%contacts), mechanism => system%model%mechanism)
      allocate (self%gaps(size(self%time), 0:2, n), self%slips(size(self%time), 3, n), self%rests(n), self%gap_motion(0:2, n), &
                self%past(size(self%time), n), self%past_rate(n))
      self%acted = system%contact%acts
      do i = 1, n
        end = stop_contact_type(contact=i, is_rigid=mechanism%contacts(i)%is_rigid)
        self%gap_motion(0:1, i) = gap_motion(mechanism, system%plan, system%state, end)
        self%gap_motion(2, i) = gap_acceleration(mechanism, system%plan, system%state, end)
        call vary_contact(system%model, system%sensitivity%motion, i, variation)
        self%gaps(:, 0:1, i) = variation%gaps(:, 0:1)
        self%gaps(:, 2, i) = matmul(variation%slips(:, :, 0), system%contact%direction(:, i))
        self%slips(:, :, i) = variation%slips(:, :, 0)
        self%past(:, i) = variation%past
        call place_of_contact(mechanism%contacts(i), system%plan, system%state, place, ball, surface)
        self%past_rate(i) = place%past_rate
        self%rests(i) = norm2(place%slip - place%gap_rate()*place%normal) <= round_off_of_jumps*place%speed
      end do
    end associate
  end subroutine keep_gaps

  !> Carry the derivatives along with the time of the event.
  pure subroutine set_time(self, time)
    class(event_variation_type), intent(inout) :: self     !< the derivatives at a fixed time
    real(wp), intent(in) :: time(:)                        !< (P) derivatives of the time [s]
    integer :: p

    self%time = time
    self%knows_time = .true.
    do p = 1, size(time)
      self%q(p, 0, :) = self%q(p, 0, :) + time(p)*self%dq
      self%q(p, 1, :) = self%q(p, 1, :) + time(p)*self%ddq
      self%motors(p, :) = self%motors(p, :) + time(p)*self%motor_rates
    end do
  end subroutine set_time

  !> Take the time at which a rigid end of a stop, or a contact, is met. Fails where it is met without a rate.
  subroutine meet_stop(self, system, end, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives, at a fixed time
    class(motion_system_type), intent(in) :: system        !< the system
    type(stop_contact_type), intent(in) :: end             !< the end
    type(error_type), allocatable, intent(out) :: err      !< allocated if there are no derivatives
    real(wp) :: motion(2)

    motion = motion_before(self, end)
    if (.not. motion(1)**2 > 2.0_wp*grazing*least_rebound*abs(motion(2))*end%unit(system%plan)) then
      call refuse_at(system, cause_grazing, end, err)
    else
      call self%set_time(-varied_gap(self, system%sensitivity%motion%tangents, end)/motion(1))
    end if
  end subroutine meet_stop

  !> Take the time at which a pair with friction comes to rest, or begins to slip. Where its coefficients at rest and of sliding are the
  !> same, accelerations do not jump when it begins to slip, and the time does not matter. Fails where there are no derivatives.
  subroutine meet_friction(self, system, number, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives, at a fixed time
    class(motion_system_type), intent(inout) :: system     !< the system before the event, with its modes of friction
    integer, intent(in) :: number                          !< of the friction
    type(error_type), allocatable, intent(out) :: err      !< allocated if there are no derivatives
    integer :: group

    group = system%friction%modes%group(number)
    associate (frictions => system%model%mechanism%frictions, k => system%model%mechanism%frictions(number)%coordinate)
      if (group > 0) then
        if (.not. any(system%friction%modes%group == group .and. abs(frictions%static - frictions%dynamic) > 0.0_wp)) return
        if (count(system%friction%modes%group == group) > 1) then
          call refuse(system, cause_breaks_loose, number, err)
        else
          call break_loose(self, system, number, err)
        end if
      else if (.not. abs(self%ddq(k)) > 0.0_wp) then
        call refuse(system, cause_no_motion, number, err)
      else
        call self%set_time(-self%q(:, 1, k)/self%ddq(k))
      end if
    end associate
  end subroutine meet_friction

  !> Take the time at which a contact that slides comes to rest. Where one that sticks begins to slide, accelerations do not jump if its
  !> coefficients at rest and of sliding are the same, and the time does not matter. Fails where there are no derivatives.
  subroutine meet_rubbing(self, system, end, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives, at a fixed time
    class(motion_system_type), intent(in) :: system        !< the system before the event, with its modes of contacts
    type(stop_contact_type), intent(in) :: end             !< the contact
    type(error_type), allocatable, intent(out) :: err      !< allocated if there are no derivatives
    real(wp) :: acceleration

    associate (contact => system%model%mechanism%contacts(end%contact), direction => system%contact%direction(:, end%contact))
      if (system%contact%sticks(end%contact)) then
        if (contact%static_friction > contact%sliding_friction) call refuse_at(system, cause_contact_loose, end, err)
        return
      end if
      acceleration = dot_product(direction, acceleration_of_contact(contact, system%plan, system%state))
      if (.not. acceleration < 0.0_wp) then
        call refuse_at(system, cause_contact_rest, end, err)
      else
        call self%set_time(-self%gaps(:, 2, end%contact)/acceleration)
      end if
    end associate
  end subroutine meet_rubbing

  !> Take the time at which the ball of a contact comes to the end of a stretch of its profile. Fails where it comes to rest there.
  subroutine meet_corner(self, system, end, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives, at a fixed time
    class(motion_system_type), intent(in) :: system        !< the system before the event
    type(stop_contact_type), intent(in) :: end             !< the contact
    type(error_type), allocatable, intent(out) :: err      !< allocated if there are no derivatives

    associate (time => system%model%request%time, rate => self%past_rate(end%contact))
      if (.not. abs(rate*(time%end - time%start)) > grazing*system%plan%length) then
        call refuse_at(system, cause_corner_rest, end, err)
      else
        call self%set_time(-self%past(:, end%contact)/rate)
      end if
    end associate
  end subroutine meet_corner

  !> Take the time at which a pair that sticks alone comes to its bound, above that of sliding: the part of the bound that it needs is 1
  !> there. Fails where this part does not change in time.
  subroutine break_loose(self, system, number, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives, at a fixed time
    class(motion_system_type), intent(inout) :: system     !< the system before the event; stands there afterwards
    integer, intent(in) :: number                          !< of the friction
    type(error_type), allocatable, intent(out) :: err      !< allocated if there are no derivatives
    real(wp) :: changes(size(self%time)), rate
    logical :: found

    call system%vary_friction(number, changes, err)
    if (.not. allocated(err)) call find_use_rate(system, number, rate, found, err)
    if (allocated(err)) return
    if (found) found = rate > 0.0_wp
    if (found) then
      call self%set_time(-changes/rate)
    else
      call refuse(system, cause_breaks_loose, number, err)
    end if
  end subroutine break_loose

  !> Pass an impact, if there is one, and what contacts do from now on. Fails where derivatives do not exist.
  subroutine pass_contacts(self, system, contacts, after, impact, at_start, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives, at a fixed time; then carried along, behind an impact
    class(motion_system_type), intent(inout) :: system     !< the system, with all rates behind the event; stays as it is
    type(stop_contact_type), intent(in) :: contacts(:)     !< all ends, as before the event
    type(stop_contact_type), intent(in) :: after(:)        !< all ends, as they are from now on
    type(impact_type), intent(in) :: impact                !< the impact; not allocated parts: there is none
    logical, intent(in) :: at_start                        !< the motion begins with it
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    if (allocated(impact%ends)) then
      call pass_impact(self, system, contacts, impact, at_start, err)
    else if (at_start) then
      call hold_directions(system, after, err)
      if (.not. allocated(err)) self%q = system%sensitivity%motion%q(:, 0:1, :)
      if (allocated(system%contact) .and. .not. allocated(err)) call keep_gaps(self, system)
    end if
    if (.not. allocated(err)) call check_rest(self, system, contacts, impact, at_start, err)
  end subroutine pass_contacts

  !> Pass an impact on rigid stops and contacts. No stop and no friction holds a coordinate in the plan of the system. Fails where derivatives do not
  !> exist.
  subroutine pass_impact(self, system, contacts, impact, at_start, err)
    class(event_variation_type), intent(inout) :: self     !< the derivatives, at a fixed time; then carried along, behind the impact
    class(motion_system_type), intent(inout) :: system     !< the system, with all rates behind the impact; stays as it is
    type(stop_contact_type), intent(in) :: contacts(:)     !< all ends, as before the impact
    type(impact_type), intent(in) :: impact                !< the impact
    logical, intent(in) :: at_start                        !< the motion begins with it
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(contact_equations_type) :: equations
    type(state_type) :: behind
    real(wp) :: target(size(self%time), size(impact%ends)), motion(2)
    integer :: i

    associate (ends => contacts(impact%ends))
      if (count(.not. ends%held) > 1 .or. hits_others(contacts, impact%ends, self%gap_motion, system%plan%length)) then
        call refuse_at(system, cause_several_impacts, ends(findloc(ends%held, .false., dim=1)), err)
        return
      end if
      do i = 1, size(ends)
        if (ends(i)%held) cycle
        if (at_start) then
          call check_met_at_start(self, system, ends(i), err)
        else
          call self%meet_stop(system, ends(i), err)
        end if
        if (allocated(err)) return
      end do
      call find_contact_equations(system, [(.false., i=1, system%plan%n_coordinates)], ends, equations, err)
      if (allocated(err)) return
      do i = 1, size(ends)
        motion = motion_before(self, ends(i))
        target(:, i) = 0.0_wp
        if (.not. ends(i)%held) then
          target(:, i) = -impact%restitution(i)*rate_carried(self, ends(i))
          if (impact%restitution(i) > 0.0_wp) target(:, i) = target(:, i) - motion(1)*varied_restitution(system, ends(i))
        else if (abs(motion(1)) > equations%round_off(i) .and. impact%restitution(i) > 0.0_wp .and. .not. ends(i)%is_stop()) then
          call refuse_at(system, cause_held_hit, ends(i), err)
          return
        end if
      end do
      call copy_state(system%state, behind)
      call give_to(self, system)
      call add_varied_impact(system, ends, impact, self%dq, behind%dq, err)
      if (.not. allocated(err)) call meet_targets(system, ends, impact, equations, behind%dq, target, err)
      if (.not. allocated(err)) self%q = system%sensitivity%motion%q(:, 0:1, :)
      deallocate (system%sensitivity%motion%held)
      call copy_state(behind, system%state)
      if (.not. allocated(err)) call place_all(system%plan, system%state, err)
    end associate
  end subroutine pass_impact

  !> Give the derivatives to those of the system, so that all coordinates move along with the time of the event.
  subroutine give_to(self, system)
    type(event_variation_type), intent(in) :: self         !< the derivatives, carried along
    class(motion_system_type), intent(inout) :: system     !< gets them
    integer :: i, k

    associate (sensitivity => system%sensitivity, plan => system%plan)
      do i = 1, size(plan%free)
        sensitivity%values(:, i, 0:1) = self%q(:, :, plan%free(i))
      end do
      sensitivity%motors(:, :, 0) = self%motors
      if (allocated(sensitivity%motion%held)) deallocate (sensitivity%motion%held)
      allocate (sensitivity%motion%held(size(self%time), 0:2, plan%n_coordinates), source=0.0_wp)
      do k = 1, plan%n_coordinates
        if (.not. plan%driven(k)) cycle
        sensitivity%motion%held(:, 0, k) = self%time*self%dq(k)
        sensitivity%motion%held(:, 1, k) = self%time*self%ddq(k)
      end do
    end associate
  end subroutine give_to

  !> Put the derivatives behind the event into the vector of a system whose held coordinates stay.
  subroutine put_behind(self, system, t, y, err)
    class(event_variation_type), intent(in) :: self        !< the derivatives, carried along
    class(motion_system_type), intent(inout) :: system     !< the system, which goes on behind the event
    real(wp), intent(in) :: t                              !< time of the event [s]
    real(wp), intent(inout) :: y(:)                        !< the vector behind it; its derivatives change
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    integer :: i

    call system%move_to(t, y, err)
    if (.not. allocated(err)) call system%pass_limits(err)
    if (allocated(err)) return
    associate (sensitivity => system%sensitivity, free => system%plan%free, state => system%state)
      do i = 1, size(free)
        sensitivity%values(:, i, 0) = self%q(:, 0, free(i)) - self%time*state%dq(free(i))
        sensitivity%values(:, i, 1) = self%q(:, 1, free(i)) - self%time*state%ddq(free(i))
      end do
      sensitivity%motors(:, :, 0) = motors_behind(self, state)
    end associate
    y = system%vector()
  end subroutine put_behind

  !> Let another system, in which other coordinates are held, go on with the derivatives behind the event.
  subroutine hand_on(self, variable, other, err)
    class(event_variation_type), intent(in) :: self           !< the derivatives, carried along
    class(variable_model_type), intent(inout) :: variable     !< the model as a function of its parameters
    class(motion_system_type), intent(inout) :: other         !< the other system, with its motion
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    real(wp), allocatable :: values(:, :, :), held(:, :, :)
    integer :: i, k

    associate (m => other%plan%n_coordinates, n => size(self%time))
      allocate (values(n, 0:2, m), source=0.0_wp)
      if (allocated(other%held)) allocate (held(n, 0:2, m), source=0.0_wp)
      do k = 1, m
        values(:, 0, k) = self%q(:, 0, k) - self%time*other%state%dq(k)
        values(:, 1, k) = self%q(:, 1, k) - self%time*other%state%ddq(k)
      end do
    end associate
    if (allocated(held)) then
      do i = 1, size(other%held)
        held(:, 0, other%held(i)%coordinate) = self%q(:, 0, other%held(i)%coordinate)
      end do
    end if
    call other%begin_sensitivity(variable, err, values, motors_behind(self, other%state), held)
  end subroutine hand_on

  !> The derivatives of the states of motors behind the event at a fixed time.
  pure function motors_behind(self, state) result(motors)
    type(event_variation_type), intent(in) :: self    !< the derivatives, carried along
    type(state_type), intent(in) :: state             !< the motion behind the event
    real(wp) :: motors(size(self%motors, 1), size(self%motors, 2))
    integer :: i

    motors = self%motors
    if (.not. allocated(state%motor)) return
    do i = 1, size(motors, 2)
      motors(:, i) = motors(:, i) - self%time*state%motor_rate(i)
    end do
  end function motors_behind

  !> End with an event, and keep the derivatives of its time.
  pure subroutine end_passage(passage, at_start, events)
    type(event_variation_type), allocatable, intent(inout) :: passage   !< the derivatives at the event; then not allocated
    logical, intent(in) :: at_start                        !< the motion begins with the event
    type(motion_events_type), intent(inout) :: events      !< gets the derivatives

    if (.not. allocated(passage)) return
    if (allocated(events%time_rates)) deallocate (events%time_rates)
    events%time_rates = passage%time
    if (.not. (passage%knows_time .or. at_start)) events%time_rates = ieee_value(0.0_wp, ieee_quiet_nan)
    deallocate (passage)
  end subroutine end_passage

  !> Fail where a parameter moves a start away from a stop or a contact that holds it there, or behind it.
  subroutine check_start(self, system, ends, err)
    class(event_variation_type), intent(in) :: self        !< the derivatives at the start
    class(motion_system_type), intent(in) :: system        !< the system there
    type(stop_contact_type), intent(in) :: ends(:)         !< all ends, closed or open as they are from the start on
    type(error_type), allocatable, intent(out) :: err      !< allocated where derivatives do not exist
    integer :: i

    call check_start_of_slip(self, system, err)
    do i = 1, size(ends)
      if (allocated(err)) return
      if (ends(i)%is_rigid .and. ends(i)%closed) call check_met_at_start(self, system, ends(i), err)
    end do
  end subroutine check_start

  !> Fail where a parameter moves a start away from a stop or a contact that is met there, or behind it; also where it changes the rate of
  !> the gap of a contact that is closed from the start on.
  subroutine check_met_at_start(self, system, end, err)
    class(event_variation_type), intent(in) :: self        !< the derivatives at the start
    class(motion_system_type), intent(in) :: system        !< the system there
    type(stop_contact_type), intent(in) :: end             !< the end
    type(error_type), allocatable, intent(out) :: err      !< allocated where derivatives do not exist
    real(wp) :: moves(size(self%time))
    integer :: p

    associate (sensitivity => system%sensitivity, parameters => system%model%parameters, time => system%model%request%time)
      moves = abs(varied_gap(self, sensitivity%motion%tangents, end))
      if (end%closed .and. .not. end%is_stop()) then
        ! a contact that is hit at the start may be hit at another rate
        if (abs(time%end - time%start)*self%gap_motion(1, end%contact) > -round_off_of_jumps*end%unit(system%plan)) &
          moves = moves + abs(time%end - time%start)*abs(self%gaps(:, 1, end%contact))
      end if
      do p = 1, size(moves)
        ! a stop takes from directions what it holds
        if (size(parameters(p)%targets) == 0 .and. end%is_stop()) cycle
        if (moves(p) <= round_off_of_jumps*sensitivity%size_of(p)*end%unit(system%plan)) cycle
        call refuse_at(system, cause_start_on_stop, end, err)
        return
      end do
    end associate
  end subroutine check_met_at_start

  !> Fail where a contact with friction begins to act without a slip, and parameters change the slip: its friction would turn round, or stop
  !> the change at once. In an impact this happens by an impulse.
  subroutine check_rest(self, system, ends, impact, at_start, err)
    class(event_variation_type), intent(in) :: self        !< the derivatives at the event
    class(motion_system_type), intent(in) :: system        !< the system, with the contacts that act from now on
    type(stop_contact_type), intent(in) :: ends(:)         !< all ends
    type(impact_type), intent(in) :: impact                !< the impact; not allocated parts: there is none
    logical, intent(in) :: at_start                        !< the motion begins with the event
    type(error_type), allocatable, intent(out) :: err      !< allocated where derivatives do not exist
    real(wp) :: duration
    integer :: i, p

    if (.not. allocated(self%rests)) return
    associate (contacts => system%model%mechanism%contacts, time => system%model%request%time)
      duration = abs(time%end - time%start)
      do i = 1, size(contacts)
        if (.not. (contacts(i)%has_friction() .and. system%contact%acts(i) .and. self%rests(i))) cycle
        if (self%acted(i) .and. .not. at_start) cycle
        if (allocated(impact%ends)) then
          if (any(ends(impact%ends)%contact == i)) cycle
        end if
        do p = 1, size(self%time)
          if (duration*norm2(self%slips(p, :, i)) <= round_off_of_jumps*system%sensitivity%size_of(p)*system%plan%length) cycle
          call refuse_at(system, cause_slip_at_rest, ends(findloc(ends%contact, i, dim=1)), err)
          return
        end do
      end do
    end associate
  end subroutine check_rest

  !> Fail where a pair begins to slip from rest at the start, and a parameter changes its rate: its friction would turn round.
  subroutine check_start_of_slip(self, system, err)
    class(event_variation_type), intent(in) :: self        !< the derivatives at the start
    class(motion_system_type), intent(in) :: system        !< the system there
    type(error_type), allocatable, intent(out) :: err      !< allocated where derivatives do not exist
    integer :: i, p

    if (.not. allocated(system%friction)) return
    do i = 1, size(system%model%mechanism%frictions)
      associate (friction => system%model%mechanism%frictions(i), parameters => system%model%parameters)
        if (friction%is_smooth .or. abs(self%dq(friction%coordinate)) > 0.0_wp) cycle
        do p = 1, size(self%time)
          if (size(parameters(p)%targets) == 0 .or. .not. abs(self%q(p, 1, friction%coordinate)) > 0.0_wp) cycle
          call refuse(system, cause_no_motion, i, err)
          return
        end do
      end associate
    end do
  end subroutine check_start_of_slip
end module mech9_event_variation
