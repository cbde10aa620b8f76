!> The time within a step at which a motor passes the limit of its force, an end of a stop is met or left, a pair with friction comes to
!> rest or begins to slip, or a ball comes to the end of a stretch of its profile. The motion goes back to the start of the step and stops at that time, as at a joint of a law of time.
!>
!> A coordinate comes to an end of its stop where the gap is zero; a polynomial of the fifth degree through the ends of the
!> step shows where it may come near, also where it turns back within the step. What counts is the motion itself there.
module mech9_event_passing
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: touching, round_off_of_gaps
  use mech9_error, only: error_type
  use mech9_hermite, only: hermite_type, build_hermite, cubic_between
  use mech9_integrated_motion, only: integrated_motion_type
  use mech9_event_search, only: locate, value_at, of_motor, of_contact, of_rate
  use mech9_value_passing, only: find_passing
  use mech9_friction_passing, only: find_friction, find_rubbing
  use mech9_corner_passing, only: find_corner, correct_corner
  use mech9_smooth_parts, only: gap_look_type, smooth_parts_type, begin_parts
  use mech9_stop_contacts, only: gap_motion, gap_acceleration, look_at_gap
  use mech9_contact_events, only: refuse_jump
  use mech9_friction_heat, only: take_heat
  implicit none
  private
  public :: stop_at_events

  !> Points within a step at which the gap to a stop is looked at; the last one is its end.
  integer, parameter :: looks = 16

  !> Corrections of a time by Newton's method, and the largest one in parts of the step.
  integer, parameter :: most_corrections = 8
  real(wp), parameter :: largest_correction = 0.5_wp

contains

  !> Judge the last step: where a motor passed its limit or a contact changed within it, the motion is at the start of the step
  !> afterwards, and a stop lies at that time.
  subroutine stop_at_events(motion, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: from, times(5), y(size(motion%y))
    integer :: motor, contact, friction, rubbing, corner, found(5), soonest, met, slipping, turning, i
    logical :: motors, contacts, frictions, rubs, corners

    motors = motion%limits%is_needed(motion%system)
    contacts = size(motion%contacts%ends) > 0
    frictions = allocated(motion%system%friction)
    rubs = .false.
    if (allocated(motion%system%contact)) &
      rubs = any(motion%system%contact%acts .and. motion%system%model%mechanism%contacts%static_friction > 0.0_wp)
    corners = any(motion%contacts%ends%stretch /= 0)
    if (.not. (motors .or. contacts .or. frictions)) return
    call motion%dense_output%start_of_step(from, y)
    if (contacts) contacts = motion%contacts%any_held() .or. &
                             motion%contacts%in_doubt(motion%system%model%mechanism, motion%system%plan, motion%system%state, &
                                                      motion%t - from)
    if (motors .or. contacts .or. frictions .or. rubs .or. corners .or. motion%system%interval%contact > 0) &
      call motion%system%move_to(motion%t, motion%y, err)
    if (allocated(err)) return
    motor = 0
    contact = 0
    friction = 0
    rubbing = 0
    corner = 0
    associate (interval => motion%system%interval)
      if (interval%is_end(motion%t)) then
        slipping = interval%friction
        turning = interval%corner
        motors = .false.
        ! the step was judged before it was made anew up to the event
        contacts = contacts .and. .not. interval%ends_at_event()
        frictions = frictions .and. .not. interval%ends_at_event()
        rubs = rubs .and. .not. interval%ends_at_event()
        corners = corners .and. .not. interval%ends_at_event()
        met = interval%contact
        if (met > 0) call correct_landing(motion, from, met, err)
        if (slipping > 0 .and. .not. allocated(err)) call correct_rest(motion, from, slipping, err)
        if (turning > 0 .and. .not. allocated(err)) call correct_corner(motion, from, turning, err)
      end if
    end associate
    if (allocated(err)) return
    times = motion%t
    if (motors) call find_motor(motion, from, motor, times(1), err)
    if (contacts .and. .not. allocated(err)) call find_contact(motion, from, y, contact, times(2), err)
    if (frictions .and. .not. allocated(err)) call find_friction(motion, from, y, friction, times(3), err)
    if (rubs .and. .not. allocated(err)) call find_rubbing(motion, from, y, rubbing, times(4), err)
    if (corners .and. .not. allocated(err)) call find_corner(motion, from, corner, times(5), err)
    if (allocated(err)) return
    found = [motor, contact, friction, rubbing, corner]
    if (any(found > 0)) then
      soonest = minloc(abs(times - from), dim=1, mask=found > 0)
      found(:soonest - 1) = 0
      found(soonest + 1:) = 0
      call motion%step_back(times(soonest), err)
      call motion%system%interval%end_at_event(times(soonest), found(1), found(2), found(3), found(4), found(5))
      motion%contacts%corrections = 0
    else
      if (allocated(motion%system%friction) .and. abs(motion%t - from) > 0.0_wp) call take_heat(motion, err)
      if (allocated(err)) return
      if (motors .or. contacts .or. rubs .or. corners .or. allocated(motion%system%friction)) &
        call motion%system%move_to(motion%t, motion%y, err)
      if (.not. allocated(err)) call motion%note_start(err)
      do i = 1, size(motion%contacts%ends)
        if (.not. allocated(err)) call refuse_jump(motion%system, motion%contacts%ends(i), err)
      end do
    end if
  end subroutine stop_at_events

  !> Correct the time of a step that was made onto a rigid end, by Newton's method: dense output is as exact as the tolerances of the
  !> integration, and steps are more exact than that. Where the end is not met there, because dense output was wrong, there is no event.
  subroutine correct_landing(motion, from, contact, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step, where the system stands
    real(wp), intent(in) :: from                            !< start of the step [s]
    integer, intent(in) :: contact                          !< number of the end
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: now(2), gap, rate, unit, change

    associate (end => motion%contacts%ends(contact), system => motion%system, corrections => motion%contacts%corrections)
      if (end%held .or. .not. end%is_rigid .or. contact == motion%contacts%behind) return
      unit = end%unit(system%plan)
      now = gap_motion(system%model%mechanism, system%plan, system%state, end)
      gap = now(1)
      rate = now(2)*sign(1.0_wp, motion%t - from)
      if (abs(gap) <= epsilon(gap)*max(unit, abs(end%limit)) .and. rate < 0.0_wp) return
      change = huge(change)
      if (rate < 0.0_wp) change = -gap/rate
      if (corrections < most_corrections .and. abs(change) < largest_correction*abs(motion%t - from)) then
        change = sign(change, (motion%t - from)*change)
        if (abs(change) <= spacing(motion%t)) return
        corrections = corrections + 1
        change = motion%t + change
        call motion%step_back(change, err)
        call system%interval%end_at_event(change, 0, contact, 0, 0, 0)
      else if (gap > touching*unit .or. rate > 0.0_wp) then
        call system%interval%forget_event()
        call motion%note_start(err)
      end if
    end associate
  end subroutine correct_landing

  !> Correct the time of a step that was made to the rest of a pair that slips, by Newton's method.
  subroutine correct_rest(motion, from, friction, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step, where the system stands
    real(wp), intent(in) :: from                            !< start of the step [s]
    integer, intent(in) :: friction                         !< number of the friction
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: change
    integer :: k

    associate (system => motion%system, corrections => motion%contacts%corrections)
      if (.not. system%friction%modes%slips(friction)) return
      k = system%model%mechanism%frictions(friction)%coordinate
      if (.not. abs(system%state%ddq(k)) > 0.0_wp .or. corrections >= most_corrections) return
      change = -system%state%dq(k)/system%state%ddq(k)
      if (abs(change) <= spacing(motion%t) .or. abs(change) >= largest_correction*abs(motion%t - from)) return
      corrections = corrections + 1
      change = motion%t + change
      call motion%step_back(change, err)
      call system%interval%end_at_event(change, 0, 0, friction, 0, 0)
    end associate
  end subroutine correct_rest

  !> Find the motor that passes its limit first, and the time.
  subroutine find_motor(motion, from, motor, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    real(wp), intent(in) :: from                            !< start of the step [s]
    integer, intent(out) :: motor                           !< its number; 0: none passes its limit
    real(wp), intent(out) :: t                              !< time of the passing [s]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: part, value
    logical :: passed

    t = motion%t
    call motion%limits%find_passing(motion%system, motion%t - from, motor, part, err)
    if (motor == 0 .or. allocated(err)) return
    if (part < 1.0_wp) then
      t = from + part*(motion%t - from)
      call value_at(motion, of_motor, motor, t, value, err)
      if (allocated(err)) return
      if (.not. value > 0.0_wp) t = motion%t
    end if
    call locate(motion, of_motor, motor, from, t, passed, err)
    if (.not. passed) motor = 0
  end subroutine find_motor

  !> Find the end of a stop that is met or left first, and the time.
  subroutine find_contact(motion, from, y, contact, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(in) :: y(:)                            !< the vector there
    integer, intent(out) :: contact                         !< number of the end; 0: none
    real(wp), intent(out) :: t                              !< time of the passing [s]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(gap_look_type) :: looks(size(motion%contacts%ends), 2)
    real(wp) :: found_at
    integer :: i
    logical :: passed, jumps

    contact = 0
    motion%contacts%behind = 0
    t = motion%t
    call keep(2)
    call motion%system%move_to(from, y, err)
    if (allocated(err)) return
    call keep(1)
    do i = 1, size(motion%contacts%ends)
      jumps = .false.
      if (motion%contacts%ends(i)%held) then
        call find_passing(motion, of_contact, i, from, found_at, passed, err)
      else
        call find_first_meeting(motion, i, looks(i, 1), looks(i, 2), found_at, passed, jumps, err)
      end if
      if (allocated(err)) return
      if (.not. passed) cycle
      if (contact > 0 .and. abs(found_at - from) >= abs(t - from)) cycle
      contact = i
      t = found_at
      motion%contacts%behind = merge(i, 0, jumps)
    end do
  contains
    !> Keep the motion of the gaps at one end of the step.
    subroutine keep(place)
      integer, intent(in) :: place   !< 1: at the start, 2: at the end

      do i = 1, size(motion%contacts%ends)
        looks(i, place) = present_look(motion, i)
      end do
    end subroutine keep
  end subroutine find_contact

  !> The motion of a gap in the state of the system.
  pure function present_look(motion, i) result(look)
    type(integrated_motion_type), intent(in) :: motion   !< the motion
    integer, intent(in) :: i                             !< number of the end
    type(gap_look_type) :: look

    associate (end => motion%contacts%ends(i), system => motion%system)
      look = look_at_gap(system%model%mechanism, system%plan, system%state, end)
      look%acceleration = gap_acceleration(system%model%mechanism, system%plan, system%state, end)
    end associate
  end function present_look

  !> Find the first time in a step at which an end that is not held is met, or a compliant one is left, or a time at which a ball is behind a
  !> curve that it did not meet.
  subroutine find_first_meeting(motion, i, first, last, t, passed, jumps, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: i                                !< number of the end
    type(gap_look_type), intent(in) :: first                !< the gap at the start of the step
    type(gap_look_type), intent(in) :: last                 !< the gap at its end
    real(wp), intent(out) :: t                              !< time of the meeting [s]
    logical, intent(out) :: passed                          !< it is met within the step, or the ball is behind it
    logical, intent(out) :: jumps                           !< the ball is behind it and did not meet it
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(smooth_parts_type) :: parts
    real(wp) :: rate
    logical :: goes_on

    jumps = .false.
    call begin_parts(first, last, parts)
    goes_on = .true.
    do while (goes_on)
      if (.not. motion%contacts%ends(i)%is_stop()) then
        associate (contact => motion%system%model%mechanism%contacts(motion%contacts%ends(i)%contact))
          do while (parts%must_halve(contact))
            call value_at(motion, of_rate, i, 0.5_wp*(parts%first%t + parts%last%t), rate, err)
            if (allocated(err)) return
            call parts%halve(present_look(motion, i))
          end do
          t = parts%last%t
          jumps = parts%jumps(contact)
          passed = jumps
          if (passed) return
        end associate
      end if
      call find_meeting(motion, i, parts%first, parts%last, t, passed, err)
      if (passed .or. allocated(err)) return
      call parts%go_on(goes_on)
    end do
  end subroutine find_first_meeting

  !> Find the time at which an end that is not held is met, or a compliant one is left, in a part of a step in which its gap is smooth.
  subroutine find_meeting(motion, i, first, last, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: i                                !< number of the end
    type(gap_look_type), intent(in) :: first                !< the gap at the start of the part
    type(gap_look_type), intent(in) :: last                 !< the gap at its end
    real(wp), intent(out) :: t                              !< time of the meeting [s]
    logical, intent(out) :: passed                          !< it is met within the part
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(hermite_type) :: polynomial
    real(wp), dimension(1) :: at, rate, acceleration
    real(wp) :: h, before, before_rate, value, margin, sign_of_gap, turn
    integer :: look
    logical :: leaves

    passed = .false.
    t = last%t
    h = last%t - first%t
    associate (end => motion%contacts%ends(i), gap => [first%gap, last%gap], gap_rate => [first%rate, last%rate])
      ! the gap is positive on the side where the motion is
      sign_of_gap = merge(-1.0_wp, 1.0_wp, end%closed)
      call build_hermite([first%t, last%t], reshape(gap, [1, 2]), reshape(gap_rate, [1, 2]), &
                         reshape([first%acceleration, last%acceleration], [1, 2]), polynomial)
      before = first%t
      before_rate = sign_of_gap*gap_rate(1)*sign(1.0_wp, h)
      leaves = sign_of_gap*gap(1) < 0.0_wp .and. before_rate > 0.0_wp
      do look = 1, looks
        t = first%t + real(look, wp)/looks*h
        if (look == looks) t = last%t
        call polynomial%evaluate(t, at, rate, acceleration)
        margin = abs(at(1) - cubic_between(gap(1), h*gap_rate(1), gap(2), h*gap_rate(2), (t - first%t)/h))
        at = sign_of_gap*at
        rate = sign_of_gap*rate*sign(1.0_wp, h)
        if (before_rate < 0.0_wp .and. rate(1) > 0.0_wp .and. at(1) - abs(rate(1)*(t - before)) < margin) then
          ! it turns back between these times: near the end of the stop, perhaps beyond it
          call locate_turn(motion, i, before, t, turn, err)
          if (allocated(err)) return
          call value_at(motion, of_contact, i, turn, value, err)
          if (allocated(err)) return
          if (value > 0.0_wp) t = turn
        else
          value = -1.0_wp
          if (at(1) < margin + round_off_of_gaps*end%unit(motion%system%plan)) &
            call value_at(motion, of_contact, i, t, value, err)
          if (allocated(err)) return
        end if
        ! round-off may leave the start a little behind the end that it moves away from
        if (leaves) leaves = at(1) < 0.0_wp .and. rate(1) > 0.0_wp
        passed = value > 0.0_wp .and. .not. leaves
        if (passed) exit
        before = t
        before_rate = rate(1)
      end do
    end associate
    if (.not. passed) return
    ! a motion that just left the end turns before it comes back
    call value_at(motion, of_contact, i, before, value, err)
    if (allocated(err)) return
    if (value > -touching*motion%contacts%ends(i)%unit(motion%system%plan)) then
      call locate_turn(motion, i, before, t, turn, err)
      if (allocated(err)) return
      before = turn
    end if
    call locate(motion, of_contact, i, before, t, passed, err)
  end subroutine find_meeting

  !> Find the time between two times at which the rate of a gap changes its sign; the first one where it does not.
  subroutine locate_turn(motion, i, from, to, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: i                                !< number of the end
    real(wp), intent(in) :: from                            !< time before [s]
    real(wp), intent(in) :: to                              !< time behind [s]
    real(wp), intent(out) :: t                              !< the time [s]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: first, last
    logical :: passed

    t = from
    call value_at(motion, of_rate, i, from, first, err)
    if (allocated(err)) return
    call value_at(motion, of_rate, i, to, last, err)
    if (allocated(err) .or. first*last >= 0.0_wp) return
    t = to
    call locate(motion, sign(of_rate, nint(sign(1.0_wp, last))), i, from, t, passed, err)
  end subroutine locate_turn

end module mech9_event_passing
