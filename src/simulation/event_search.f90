!> The search for the time within the last step at which a value passes zero, on the motion itself.
module mech9_event_search
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: round_off_of_impacts, limit_of_sticking, at_rest
  use mech9_simulation_tolerances, only: shortest_step, least_motion
  use mech9_error, only: error_type
  use mech9_limit_watch, only: find_excess
  use mech9_false_position, only: false_position_type, new_false_position
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_contact_motion, only: place_of_contact, acceleration_of_contact
  use mech9_stop_contacts, only: gap_motion, look_at_gap
  use mech9_smooth_parts, only: gap_look_type
  use mech9_integrated_motion, only: integrated_motion_type
  implicit none
  private
  public :: locate, value_at, of_motor, of_contact, of_rate, of_friction, of_paradox, of_rubbing, of_turn, of_rubbing_turn, &
    of_corner, slip_acceleration, way_beyond

  !> Values that are zero at a time that is searched: the excess of a motor, the passing of an end of a stop, the rate of its coordinate,
  !> how far a pair with friction is beyond its present mode, minus the determinant of frictions, how far the friction of a contact of
  !> links is beyond its present mode, the acceleration of a pair and of a contact that slip, along the slip, and the way of a ball beyond the
  !> end of a stretch of its profile.
  integer, parameter :: of_motor = 1, of_contact = 2, of_rate = 3, of_friction = 4, of_paradox = 5, of_rubbing = 6, of_turn = 7, &
                        of_rubbing_turn = 8, of_corner = 9
  !> The end of a stretch is passed by this part of the mechanism's length, or by the way in some spacings of the time: more than round-off.
  real(wp), parameter :: beyond_stretch = 1.0e-12_wp
  real(wp), parameter :: spacings_beyond = 64.0_wp
  !> Trials of the search for a time.
  integer, parameter :: most_trials = 100

contains

  !> Find the time at which a value passes zero upward, by false position with halved values (Illinois) on the motion within the step.
  subroutine locate(motion, what, i, from, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< the value: one of the constants above; negative: minus it
    integer, intent(in) :: i                                !< number of the motor, of the end of a stop, or of the friction
    real(wp), intent(in) :: from                            !< a time before the passing [s]
    real(wp), intent(inout) :: t                            !< a time behind it; then the time of the passing [s]
    logical, intent(out) :: passed                          !< the value there is above zero
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(false_position_type) :: search
    real(wp) :: first, last, value
    integer :: trial
    logical :: found

    call value_at(motion, what, i, t, last, err)
    passed = last > 0.0_wp
    if (.not. passed .or. allocated(err)) return
    call value_at(motion, what, i, from, first, err)
    if (allocated(err)) return
    search = new_false_position(from, first, t, last)
    t = from
    do trial = 1, most_trials
      call search%next(t, found)
      if (.not. found) return
      call value_at(motion, what, i, t, value, err)
      if (allocated(err) .or. abs(value) <= epsilon(value)) return
      call search%take(t, value)
    end do
  end subroutine locate

  !> A value at a time within the last step. Where the motion there cannot be found, it is that of the end of the step.
  subroutine value_at(motion, what, i, t, value, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< the value: one of the constants above; negative: minus it
    integer, intent(in) :: i                                !< number of the motor, of the end of a stop, or of the friction
    real(wp), intent(in) :: t                               !< time within the last step [s]
    real(wp), intent(out) :: value                          !< of a motor in parts of its limit
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: from, y(size(motion%y)), gap(2), margin
    logical :: found

    call motion%dense_output%start_of_step(from, y)
    found = .false.
    if (.not. abs(t - from) > 0.0_wp) then
      call motion%system%move_to(from, y, err)
      found = .true.
    else if (abs(t - motion%t) > 0.0_wp .and. abs(motion%t - from) > shortest_step*spacing(t)) then
      call motion%look_between(t, found)
    end if
    if (.not. found) call motion%system%move_to(motion%t, motion%y, err)
    if (allocated(err)) return
    select case (abs(what))
    case (of_motor)
      call find_excess(motion%system, i, value, err)
    case (of_contact)
      value = passing_of_contact(motion, i)
    case (of_friction)
      value = passing_of_friction(motion, i)
    case (of_paradox)
      associate (friction => motion%system%friction)
        value = -friction%balance%least_determinant(motion%system%model%mechanism%frictions, friction%modes)
      end associate
    case (of_rubbing)
      value = passing_of_rubbing(motion, i)
    case (of_turn)
      value = slip_acceleration(motion, of_friction, i)
    case (of_rubbing_turn)
      value = slip_acceleration(motion, of_rubbing, i)
    case (of_corner)
      call way_beyond(motion, i, value, margin)
    case default
      gap = gap_motion(motion%system%model%mechanism, motion%system%plan, motion%system%state, motion%contacts%ends(i))
      value = gap(2)
    end select
    if (what < 0) value = -value
  end subroutine value_at

  !> How far a contact has passed, in the state of the system: above zero where it should be met, left or released.
  pure real(wp) function passing_of_contact(motion, i) result(value)
    type(integrated_motion_type), intent(in) :: motion   !< the motion
    integer, intent(in) :: i                             !< number of the end
    real(wp) :: gap(2)
    integer :: j

    associate (end => motion%contacts%ends(i), system => motion%system)
      if (end%held .and. end%contact > 0) then
        value = -system%contact%forces(1, end%contact) - round_off_of_impacts*norm2(system%contact%forces(:, end%contact))
      else if (end%held) then
        value = -end%direction*system%state%stop_force(end%stop)
        do j = 1, size(system%held)
          if (system%held(j)%stop == end%stop) value = value - round_off_of_impacts*system%held(j)%size_of_terms
        end do
      else
        gap = gap_motion(system%model%mechanism, system%plan, system%state, end)
        value = -gap(1)
        if (end%closed) value = -value
        if (end%is_rigid) value = value - end%hidden_gap(system%plan, system%state)
      end if
    end associate
  end function passing_of_contact

  !> How far the ball of a contact is beyond the end of the stretch of its profile and a margin, in the state of the system.
  pure subroutine way_beyond(motion, i, value, margin)
    type(integrated_motion_type), intent(in) :: motion   !< the motion
    integer, intent(in) :: i                             !< number of the end of this contact, which has a stretch
    real(wp), intent(out) :: value                       !< the way beyond both [m]
    real(wp), intent(out) :: margin                      !< the margin [m]
    type(gap_look_type) :: look

    associate (system => motion%system)
      look = look_at_gap(system%model%mechanism, system%plan, system%state, motion%contacts%ends(i))
      margin = max(beyond_stretch*system%plan%length, spacings_beyond*spacing(system%state%t)*look%place%passing_speed)
      value = look%place%past - margin
    end associate
  end subroutine way_beyond

  !> How far the friction of a contact of links is beyond its present mode, in the state of the system: above zero where it should act otherwise.
  pure real(wp) function passing_of_rubbing(motion, i) result(value)
    type(integrated_motion_type), intent(in) :: motion   !< the motion
    integer, intent(in) :: i                             !< number of the contact of links
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface

    associate (system => motion%system, contact => motion%system%model%mechanism%contacts(i))
      if (system%contact%sticks(i)) then
        value = system%contact%excess(contact, i) - (limit_of_sticking - 1.0_wp)
      else
        call place_of_contact(contact, system%plan, system%state, place, ball, surface)
        value = -dot_product(place%slip, system%contact%direction(:, i))
      end if
    end associate
  end function passing_of_rubbing

  !> The acceleration of a pair or of a contact of links that slips, along its slip, in the state of the system.
  pure real(wp) function slip_acceleration(motion, what, i) result(acceleration)
    type(integrated_motion_type), intent(in) :: motion   !< the motion
    integer, intent(in) :: what                          !< of_friction, or of_rubbing for a contact of links
    integer, intent(in) :: i                             !< number of the friction, or of the contact

    associate (system => motion%system)
      if (what == of_friction) then
        acceleration = system%friction%modes%direction(i)*system%state%ddq(system%model%mechanism%frictions(i)%coordinate)
      else
        acceleration = dot_product(system%contact%direction(:, i), &
                                   acceleration_of_contact(system%model%mechanism%contacts(i), system%plan, system%state))
      end if
    end associate
  end function slip_acceleration

  !> How far a pair with friction is beyond its present mode, in the state of the system: above zero where it should act otherwise.
  pure real(wp) function passing_of_friction(motion, i) result(value)
    type(integrated_motion_type), intent(in) :: motion   !< the motion
    integer, intent(in) :: i                             !< number of the friction

    associate (system => motion%system, friction => motion%system%friction)
      associate (rate => system%state%dq(system%model%mechanism%frictions(i)%coordinate))
        if (friction%modes%slips(i)) then
          value = -friction%modes%direction(i)*rate
        else if (friction%modes%group(i) > 0) then
          value = abs(friction%balance%utilization(i)) - limit_of_sticking
        else
          associate (time => system%model%request%time)
            value = abs(rate) - 2.0_wp*at_rest*sum(abs(friction%rows(:, i)*system%state%dq(system%plan%independent))) &
                    - least_motion*system%plan%unit_of(system%model%mechanism%frictions(i)%coordinate) &
                    /max(abs(time%end - time%start), least_motion)
          end associate
        end if
      end associate
    end associate
  end function passing_of_friction
end module mech9_event_search
