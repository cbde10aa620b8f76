!> The time within a step at which a pair or a contact with friction comes to rest or begins to slip, or at which frictions no longer have one
!> solution.
module mech9_friction_passing
  use mech9_kinds, only: wp
  use mech9_integration_tolerances, only: slip_of_errors
  use mech9_error, only: error_type
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_contact_motion, only: place_of_contact, acceleration_of_contact
  use mech9_friction_events, only: fail_in_paradox
  use mech9_hermite, only: cubic_between
  use mech9_integrated_motion, only: integrated_motion_type
  use mech9_event_search, only: locate, value_at, of_friction, of_paradox, of_rubbing, of_turn, of_rubbing_turn, &
    slip_acceleration
  use mech9_value_passing, only: find_passing, find_before
  implicit none
  private
  public :: find_friction, find_rubbing

  !> Points within a step at which rates and utilizations are looked at; the last one is its end.
  integer, parameter :: looks = 16

contains

  !> Find the friction that changes first, and the time. Fails where frictions have no solution or several from a time before that on.
  subroutine find_friction(motion, from, y, friction, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step; its system may stand elsewhere
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(in) :: y(:)                            !< the vector there
    integer, intent(out) :: friction                        !< its number; 0: none changes
    real(wp), intent(out) :: t                              !< time of the change [s]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp), dimension(size(motion%system%model%mechanism%frictions), 2) :: dq, ddq
    real(wp) :: found_at, paradox_at, determinant
    integer :: i
    logical :: passed, paradox

    friction = 0
    t = motion%t
    call motion%system%move_to(motion%t, motion%y, err)
    if (allocated(err)) return
    call keep(2)
    call find_paradox(motion, from, paradox_at, paradox, err)
    if (allocated(err)) return
    call motion%system%move_to(from, y, err)
    if (allocated(err)) return
    call keep(1)
    do i = 1, size(dq, 1)
      if (motion%system%model%mechanism%frictions(i)%is_smooth) cycle
      associate (modes => motion%system%friction%modes)
        if (modes%slips(i)) then
          call find_rest(motion, of_friction, i, from, modes%direction(i)*dq(i, :), modes%direction(i)*ddq(i, :), found_at, &
                         passed, err)
        else if (modes%group(i) == 0 .or. modes%leads(i)) then
          call find_passing(motion, of_friction, i, from, found_at, passed, err)
        else
          cycle
        end if
      end associate
      if (allocated(err)) return
      if (.not. passed) cycle
      if (friction > 0 .and. abs(found_at - from) >= abs(t - from)) cycle
      friction = i
      t = found_at
    end do
    if (.not. paradox) return
    if (friction > 0 .and. abs(t - from) <= abs(paradox_at - from)) return
    call value_at(motion, of_paradox, 0, paradox_at, determinant, err)
    if (.not. allocated(err)) call fail_in_paradox(motion%system, err)
  contains
    !> Keep the motion of the coordinates at one end of the step.
    subroutine keep(place)
      integer, intent(in) :: place   !< 1: at the start, 2: at the end

      associate (state => motion%system%state, frictions => motion%system%model%mechanism%frictions)
        dq(:, place) = state%dq(frictions%coordinate)
        ddq(:, place) = state%ddq(frictions%coordinate)
      end associate
    end subroutine keep
  end subroutine find_friction

  !> Find the contact of links whose friction changes first, and the time.
  subroutine find_rubbing(motion, from, y, rubbing, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step; its system may stand elsewhere
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(in) :: y(:)                            !< the vector there
    integer, intent(out) :: rubbing                         !< number of the contact; 0: none changes
    real(wp), intent(out) :: t                              !< time of the change [s]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp), dimension(size(motion%system%contact%acts), 2) :: rate, acceleration
    real(wp) :: found_at
    integer :: i
    logical :: passed

    rubbing = 0
    t = motion%t
    call motion%system%move_to(motion%t, motion%y, err)
    if (allocated(err)) return
    call keep(2)
    call motion%system%move_to(from, y, err)
    if (allocated(err)) return
    call keep(1)
    do i = 1, size(rate, 1)
      associate (contact => motion%system%contact)
        if (.not. (contact%acts(i) .and. motion%system%model%mechanism%contacts(i)%has_friction())) cycle
        if (contact%sticks(i)) then
          call find_passing(motion, of_rubbing, i, from, found_at, passed, err)
        else
          call find_rest(motion, of_rubbing, i, from, rate(i, :), acceleration(i, :), found_at, passed, err)
        end if
      end associate
      if (allocated(err)) return
      if (.not. passed) cycle
      if (rubbing > 0 .and. abs(found_at - from) >= abs(t - from)) cycle
      rubbing = i
      t = found_at
    end do
  contains
    !> Keep the slip in its direction at one end of the step.
    subroutine keep(place)
      integer, intent(in) :: place   !< 1: at the start, 2: at the end
      type(contact_place_type) :: at
      type(link_motion_type) :: ball, surface

      do i = 1, size(rate, 1)
        associate (contact => motion%system%model%mechanism%contacts(i), direction => motion%system%contact%direction(:, i))
          call place_of_contact(contact, motion%system%plan, motion%system%state, at, ball, surface)
          rate(i, place) = dot_product(direction, at%slip)
          acceleration(i, place) = dot_product(direction, acceleration_of_contact(contact, motion%system%plan, motion%system%state))
        end associate
      end do
    end subroutine keep
  end subroutine find_rubbing

  !> Find the time at which the rate of a pair or a contact that slips vanishes, also where it turns back at once.
  subroutine find_rest(motion, what, i, from, rate, acceleration, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< of_friction, or of_rubbing for a contact of links
    integer, intent(in) :: i                                !< number of the friction, or of the contact
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(in) :: rate(2)                         !< at both ends of the step, in the direction of slip [rad/s, m/s]
    real(wp), intent(in) :: acceleration(2)                 !< there [rad/s^2, m/s^2]
    real(wp), intent(out) :: t                              !< the time [s]
    logical, intent(out) :: passed                          !< it lies within the step
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: h, before, x, value, at, least, round_off, size_of_position, backwards, slope, slope_before, error_of_step
    integer :: look
    logical :: leaves

    passed = .false.
    h = motion%t - from
    t = motion%t
    before = from
    ! the cubic polynomial through rates and accelerations is wrong by a part of its range
    least = 0.05_wp*maxval(abs([rate(2) - rate(1), h*acceleration]))
    ! a pair that turned back begins with what the error of the time has left of its rate
    leaves = rate(1) <= 0.0_wp .and. h*acceleration(1) > 0.0_wp
    ! rates within the step come from positions, whose round-off is large over a short step
    size_of_position = motion%system%plan%length
    if (what == of_friction) then
      associate (k => motion%system%model%mechanism%frictions(i)%coordinate)
        size_of_position = max(motion%system%plan%unit_of(k), abs(motion%system%state%q(k)))
      end associate
    end if
    round_off = 16.0_wp*epsilon(h)*size_of_position/abs(h)
    ! a contact that begins to slide may go back by an error of the time of this event
    backwards = 0.0_wp
    associate (time => motion%system%model%request%time)
      if (what == of_rubbing) backwards = slip_of_errors*size_of_position/max(abs(time%end - time%start), abs(h))
    end associate
    if (rate(1) > backwards) backwards = 0.0_wp
    ! a change of sign below the error of a step is none
    associate (solver => motion%system%model%request%solver)
      error_of_step = solver%absolute_tolerance + solver%relative_tolerance*maxval(abs(rate))
    end associate
    slope_before = h*acceleration(1)
    do look = 1, looks
      x = real(look, wp)/looks
      t = from + x*h
      if (look == looks) t = motion%t
      at = cubic_between(rate(1), h*acceleration(1), rate(2), h*acceleration(2), x)
      if (look == looks) at = rate(2)
      if (at > least) then
        leaves = .false.
        before = t
        slope_before = 0.0_wp
        cycle
      end if
      call value_at(motion, what, i, t, value, err)
      if (allocated(err)) return
      slope = h*slip_acceleration(motion, what, i)
      if (look == looks) value = -rate(2)
      leaves = leaves .and. value >= 0.0_wp
      passed = value > backwards + merge(0.0_wp, round_off, look == looks) .and. .not. leaves
      if (passed) exit
      if (slope_before < 0.0_wp .and. slope > 0.0_wp .and. .not. leaves) then
        call look_at_turn(motion, what, i, before, backwards + round_off + error_of_step, t, passed, err)
        if (allocated(err)) return
        if (passed) exit
      end if
      before = t
      slope_before = slope
    end do
    if (.not. passed) return
    call find_before(motion, what, i, from, before, t, err)
    if (.not. allocated(err)) call locate(motion, what, i, before, t, passed, err)
  end subroutine find_rest

  !> Look whether a rate that turns back between two times has changed its sign there.
  subroutine look_at_turn(motion, what, i, before, margin, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< of_friction, or of_rubbing for a contact of links
    integer, intent(in) :: i                                !< number of the friction, or of the contact
    real(wp), intent(in) :: before                          !< time before the turn [s]
    real(wp), intent(in) :: margin                          !< the rate beyond zero that does not count [rad/s, m/s]
    real(wp), intent(inout) :: t                            !< time behind it; where the sign changes, the time of the turn [s]
    logical, intent(out) :: passed                          !< the sign changes
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: turn, value

    turn = t
    call locate(motion, merge(of_turn, of_rubbing_turn, what == of_friction), i, before, turn, passed, err)
    if (.not. passed .or. allocated(err)) return
    call value_at(motion, what, i, turn, value, err)
    if (allocated(err)) return
    passed = value > margin
    if (passed) t = turn
  end subroutine look_at_turn

  !> Find the time from which on frictions have no solution or several. The system stands at the end of the step before.
  subroutine find_paradox(motion, from, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(out) :: t                              !< the time [s]
    logical, intent(out) :: passed                          !< it lies within the step
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed

    passed = .false.
    t = motion%t
    associate (friction => motion%system%friction)
      if (.not. friction%modes%any_slips()) return
      if (friction%balance%least_determinant(motion%system%model%mechanism%frictions, friction%modes) <= 0.0_wp) &
        call locate(motion, of_paradox, 0, from, t, passed, err)
    end associate
  end subroutine find_paradox
end module mech9_friction_passing
