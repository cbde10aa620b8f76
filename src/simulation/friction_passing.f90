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
  use mech9_event_search, only: locate, value_at, of_friction, of_paradox, of_rubbing
  implicit none
  private
  public :: find_friction, find_rubbing

  !> Points within a step at which rates and utilizations are looked at; the last one is its end.
  integer, parameter :: looks = 16
  !> Places within a step at which a utilization is looked at: a load that swings does not have all of them in one phase. Divisions of the
  !> step where it does not change evenly.
  real(wp), parameter :: looks_within(3) = [0.29_wp, 0.53_wp, 0.81_wp]
  integer, parameter :: deepest = 8
  !> Halvings on the way back to the start of a step, where a pair began to slip or to stick.
  integer, parameter :: most_halvings = 30

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
          call find_slip(motion, of_friction, i, from, found_at, passed, err)
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
          call find_slip(motion, of_rubbing, i, from, found_at, passed, err)
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

  !> Find the time at which the rate of a pair or a contact that slips vanishes.
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
    real(wp) :: h, before, x, value, at, least, round_off, size_of_position, backwards
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
    do look = 1, looks
      x = real(look, wp)/looks
      t = from + x*h
      if (look == looks) t = motion%t
      at = cubic_between(rate(1), h*acceleration(1), rate(2), h*acceleration(2), x)
      if (look == looks) at = rate(2)
      if (at > merge(0.0_wp, least, look == looks)) then
        leaves = .false.
        before = t
        cycle
      end if
      call value_at(motion, what, i, t, value, err)
      if (allocated(err)) return
      leaves = leaves .and. value >= 0.0_wp
      passed = value > backwards + merge(0.0_wp, round_off, look == looks) .and. .not. leaves
      if (passed) exit
      before = t
    end do
    if (.not. passed) return
    call find_before(motion, what, i, from, before, t, err)
    if (.not. allocated(err)) call locate(motion, what, i, before, t, passed, err)
  end subroutine find_rest

  !> Find a time at which a pair is in its present mode, before one at which it is not: a pair that just began to slip has no rate.
  subroutine find_before(motion, what, i, from, before, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< of_friction, or of_rubbing for a contact of links
    integer, intent(in) :: i                                !< number of the friction, or of the contact
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(inout) :: before                       !< a time before [s]
    real(wp), intent(inout) :: t                            !< a time behind; perhaps an earlier one then [s]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: value
    integer :: halving

    if (abs(before - from) > 0.0_wp) return
    before = t
    do halving = 1, most_halvings
      before = from + 0.5_wp*(before - from)
      call value_at(motion, what, i, before, value, err)
      if (allocated(err) .or. value < 0.0_wp) return
      t = before
    end do
    before = from
  end subroutine find_before

  !> Find the time at which a pair that sticks is at its bound, or one at rest begins to move. Where the utilization does not change evenly,
  !> the step is looked at in more places.
  subroutine find_slip(motion, what, i, from, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< of_friction, or of_rubbing for a contact of links
    integer, intent(in) :: i                                !< number of the friction, or of the contact
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(out) :: t                              !< the time [s]
    logical, intent(out) :: passed                          !< it lies within the step
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: first, last, before

    passed = .false.
    t = motion%t
    call value_at(motion, what, i, from, first, err)
    if (.not. allocated(err)) call value_at(motion, what, i, motion%t, last, err)
    if (allocated(err)) return
    before = from
    call look_within(from, first, motion%t, last, 0)
    if (.not. passed .or. allocated(err)) return
    call find_before(motion, what, i, from, before, t, err)
    if (.not. allocated(err)) call locate(motion, what, i, before, t, passed, err)
  contains
    !> Look for the first time between two ones at which the value is above zero.
    recursive subroutine look_within(a, value_a, b, value_b, depth)
      real(wp), intent(in) :: a         !< the first time [s]
      real(wp), intent(in) :: value_a   !< there
      real(wp), intent(in) :: b         !< the second time [s]
      real(wp), intent(in) :: value_b   !< there
      integer, intent(in) :: depth      !< halvings so far
      real(wp) :: times(3), values(3), deviation
      integer :: k

      times = a + looks_within*(b - a)
      values = -1.0_wp
      deviation = 0.0_wp
      do k = 1, 3
        call value_at(motion, what, i, times(k), values(k), err)
        if (allocated(err)) return
        deviation = max(deviation, abs(values(k) - (value_a + looks_within(k)*(value_b - value_a))))
        if (values(k) > 0.0_wp) exit
      end do
      k = min(k, 3)
      if (values(k) <= 0.0_wp .and. depth < deepest .and. max(maxval(values), value_a, value_b) + 4.0_wp*deviation > 0.0_wp .and. &
          deviation > 1.0e-6_wp) then
        call look_within(a, value_a, times(1), values(1), depth + 1)
        if (.not. (passed .or. allocated(err))) call look_within(times(1), values(1), times(2), values(2), depth + 1)
        if (.not. (passed .or. allocated(err))) call look_within(times(2), values(2), times(3), values(3), depth + 1)
        if (.not. (passed .or. allocated(err))) call look_within(times(3), values(3), b, value_b, depth + 1)
        return
      end if
      if (values(k) > 0.0_wp) then
        passed = .true.
        before = a
        if (k > 1) before = times(k - 1)
        t = times(k)
      else if (value_b > 0.0_wp) then
        passed = .true.
        before = times(3)
        t = b
      end if
    end subroutine look_within
  end subroutine find_slip

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
