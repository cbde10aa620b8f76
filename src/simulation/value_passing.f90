!> The time within a step at which a value that need not change evenly first passes zero: the utilization of a pair that sticks, or the force
!> of a closed stop or contact. Steps do not see the loads on what is held.
module mech9_value_passing
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_integrated_motion, only: integrated_motion_type
  use mech9_event_search, only: locate, value_at, of_contact
  implicit none
  private
  public :: find_passing, find_before

  !> Places within a step at which a value is looked at: a load that swings does not have all of them in one phase. Divisions of the
  !> step where it does not change evenly, and the part of its size by which it may then deviate from an even change.
  real(wp), parameter :: looks_within(3) = [0.29_wp, 0.53_wp, 0.81_wp]
  integer, parameter :: deepest = 8
  real(wp), parameter :: even = 1.0e-6_wp
  !> The shortest interval that is looked into, in parts of the whole time. At a corner of a path round-off decides between two forces.
  real(wp), parameter :: shortest_interval = 1.0e-8_wp
  !> Halvings on the way back to the start of a step, where a pair began to slip or to stick.
  integer, parameter :: most_halvings = 30

contains

  !> Find the first time in a step at which a value is above zero. Where it does not change evenly, the step is looked at in more places.
  subroutine find_passing(motion, what, i, from, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< the value: a constant of the event search
    integer, intent(in) :: i                                !< number of the end of a stop, of the friction, or of the contact
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(out) :: t                              !< the time [s]
    logical, intent(out) :: passed                          !< it lies within the step
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: first, last, before, size_of_value, shortest

    passed = .false.
    t = motion%t
    call value_at(motion, what, i, from, first, err)
    if (.not. allocated(err)) call value_at(motion, what, i, motion%t, last, err)
    if (allocated(err)) return
    size_of_value = 1.0_wp
    if (what == of_contact) size_of_value = size_of_force(motion, i, max(abs(first), abs(last)))
    associate (time => motion%system%model%request%time)
      shortest = shortest_interval*abs(time%end - time%start)
    end associate
    before = from
    if (abs(motion%t - from) > shortest) then
      call look_within(from, first, motion%t, last, 0)
    else
      passed = last > 0.0_wp
    end if
    if (.not. passed .or. allocated(err)) return
    call find_before(motion, what, i, from, before, t, err)
    if (.not. allocated(err)) call locate(motion, what, i, before, t, passed, err)
  contains
    !> Look for the first time between two ones at which the value is above zero.
    recursive subroutine look_within(a, value_a, b, value_b, depth)
      real(wp), intent(in) :: a         !< the first time [s]
      real(wp), intent(in) :: value_a   !< the value there, in parts of a bound or as a force [1, N, N m]
      real(wp), intent(in) :: b         !< the second time [s]
      real(wp), intent(in) :: value_b   !< the value there, in parts of a bound or as a force [1, N, N m]
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
          deviation > even*size_of_value .and. abs(b - a) > shortest) then
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
  end subroutine find_passing

  !> The size of the force of an end, from which deviations count: that of the terms that make it up, at a stop, or its own.
  pure real(wp) function size_of_force(motion, i, largest) result(size_of_value)
    type(integrated_motion_type), intent(in) :: motion   !< the motion; its system stands at the end of a step
    integer, intent(in) :: i                             !< number of the end
    real(wp), intent(in) :: largest                      !< of the force at both ends of the step [N, N m]
    integer :: j

    size_of_value = max(largest, tiny(largest))
    associate (end => motion%contacts%ends(i), system => motion%system)
      if (end%contact > 0 .or. .not. allocated(system%held)) return
      do j = 1, size(system%held)
        if (system%held(j)%stop == end%stop) size_of_value = max(size_of_value, system%held(j)%size_of_terms)
      end do
    end associate
  end function size_of_force

  !> Find a time at which a pair is in its present mode, before one at which it is not: a pair that just began to slip has no rate.
  subroutine find_before(motion, what, i, from, before, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: what                             !< the value: a constant of the event search
    integer, intent(in) :: i                                !< number of the end of a stop, of the friction, or of the contact
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
end module mech9_value_passing
