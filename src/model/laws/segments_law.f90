!> A law in segments, each with a motion law of cam design; it may repeat.
!>
!> A drive that repeats and ends at another value than it begins with advances by the difference in each period, as that of an
!> indexing table does. The law of a load returns to its first value.
module mech9_segments_law
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_law, only: law_type, refuse_time, repetition_type, stands_still, repeats_after, never_repeats
  use mech9_cam_curves, only: cam_curve, cam_third, steepest_slope_of, find_inner_joints, most_inner_joints
  use mech9_cam_integrals, only: cam_integrals
  implicit none
  private
  public :: segments_law_type

  !> n segments between n + 1 times.
  type, extends(law_type) :: segments_law_type
    real(wp), allocatable :: times(:)     !< (n+1) ends of the segments, increasing [s]
    real(wp), allocatable :: values(:)    !< (n+1) the coordinate there [rad, m]
    integer, allocatable :: curves(:)     !< (n) numbers of the motion laws
    logical :: repeats = .false.          !< after the last time it begins again
  contains
    procedure :: evaluate
    procedure :: greatest_rate
    procedure :: next_joint
    procedure :: joint_rate
    procedure :: check_time
    procedure :: repetition
    procedure :: constants
    procedure :: vary
    procedure :: antiderivatives
    procedure :: vary_antiderivatives
    procedure :: has_value_at
    procedure, private :: rounds_before
  end type segments_law_type

contains

  !> The law and its derivatives, at a joint those of the segment after it. Fails outside its times unless it repeats.
  subroutine evaluate(self, t, q, dq, ddq, err)
    class(segments_law_type), intent(in) :: self        !< the law
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(out) :: q                          !< the coordinate [rad, m]
    real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: x, span, rise, s, ds, dds, rounds
    integer :: i, n

    call self%check_time(t, 'a value is asked for at', err)
    if (allocated(err)) return
    n = size(self%curves)
    rounds = self%rounds_before(t)
    x = t - rounds*(self%times(n + 1) - self%times(1))
    i = segment_of(self, x)
    span = self%times(i + 1) - self%times(i)
    rise = self%values(i + 1) - self%values(i)
    call cam_curve(self%curves(i), max(0.0_wp, min(1.0_wp, (x - self%times(i))/span)), s, ds, dds)
    q = self%values(i) + rise*s
    if (self%coordinate > 0) q = q + rounds*(self%values(n + 1) - self%values(1))
    dq = rise*ds/span
    ddq = rise*dds/span**2
  end subroutine evaluate

  !> How the law repeats: after its last time, where it begins again.
  pure type(repetition_type) function repetition(self) result(found)
    class(segments_law_type), intent(in) :: self   !< the law

    found%kind = never_repeats
    if (.not. any(abs(self%values - self%values(1)) > 0.0_wp)) then
      found%kind = stands_still
    else if (self%repeats) then
      found%kind = repeats_after
      found%period = self%times(size(self%times)) - self%times(1)
      if (self%coordinate > 0) found%advance = self%values(size(self%values)) - self%values(1)
    end if
  end function repetition

  !> The times and the values.
  pure subroutine constants(self, values)
    class(segments_law_type), intent(in) :: self     !< the law
    real(wp), allocatable, intent(out) :: values(:)  !< (2n+2) the times, then the values

    values = [self%times, self%values]
  end subroutine constants

  !> The derivatives by one parameter, from those of the times and values; at a joint those of the segment after it.
  subroutine vary(self, change, t, q, dq, ddq)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: change(:)              !< (2n+2) derivatives of the times, then of the values
    real(wp), intent(in) :: t                      !< time [s]
    real(wp), intent(out) :: q                     !< derivative of the coordinate [rad, m]
    real(wp), intent(out) :: dq                    !< derivative of its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                   !< derivative of its acceleration [rad/s^2, m/s^2]
    real(wp) :: x, x_change, part, part_change, stretch, span, rise, rise_change, s, ds, dds, ddds, rounds
    integer :: i, n

    n = size(self%curves)
    rounds = self%rounds_before(t)
    x = t - rounds*(self%times(n + 1) - self%times(1))
    x_change = -rounds*(change(n + 1) - change(1))
    i = segment_of(self, x)
    associate (times => change(:n + 1), values => change(n + 2:))
      span = self%times(i + 1) - self%times(i)
      stretch = (times(i + 1) - times(i))/span
      rise = self%values(i + 1) - self%values(i)
      rise_change = values(i + 1) - values(i)
      part = max(0.0_wp, min(1.0_wp, (x - self%times(i))/span))
      part_change = (x_change - times(i))/span - part*stretch
      call cam_curve(self%curves(i), part, s, ds, dds)
      ddds = cam_third(self%curves(i), part)
      q = values(i) + rise_change*s + rise*ds*part_change
      if (self%coordinate > 0) q = q + rounds*(values(n + 1) - values(1))
      dq = ((rise_change - rise*stretch)*ds + rise*dds*part_change)/span
      ddq = ((rise_change - 2.0_wp*rise*stretch)*dds + rise*ddds*part_change)/span**2
    end associate
  end subroutine vary

  !> Fail outside the times of the segments, unless they repeat. Output times are sums and may miss the ends by round-off.
  subroutine check_time(self, t, demand, err)
    class(segments_law_type), intent(in) :: self        !< the law
    real(wp), intent(in) :: t                           !< the time [s]
    character(len=*), intent(in) :: demand              !< the words before this time
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is no value

    if (self%has_value_at(t)) return
    call refuse_time(self, 'law in segments', self%times(1), self%times(size(self%times)), t, demand, 'add segments'// &
                     trim(merge(', give period=,', '               ', self%variable == 't')), err)
  end subroutine check_time

  !> Whether the segments hold a value, or repeat.
  pure logical function has_value_at(self, x)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: x                      !< its variable [s, or its unit]

    has_value_at = self%repeats .or. &
                   (x >= self%times(1) - slack(self, x) .and. x <= self%times(size(self%times)) + slack(self, x))
  end function has_value_at

  !> Number of whole periods before a time; 0 where nothing repeats.
  pure real(wp) function rounds_before(self, t)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: t                      !< time [s]

    rounds_before = 0.0_wp
    if (self%repeats) rounds_before = &
      real(floor((t - self%times(1))/(self%times(size(self%times)) - self%times(1)), selected_int_kind(15)), wp)
  end function rounds_before

  !> Round-off in a time, in which it may miss an end; the error of another variable, which a motion leads there.
  pure real(wp) function slack(self, t)
    class(segments_law_type), intent(in) :: self  !< the law
    real(wp), intent(in) :: t                     !< time [s]
    real(wp), parameter :: of_time = 1.0e-12_wp, of_motion = 1.0e-9_wp   ! parts of all segments

    slack = merge(of_time, of_motion, self%variable == 't')*(self%times(size(self%times)) - self%times(1)) + 64.0_wp*spacing(t)
  end function slack

  !> Number of the segment at a time of the first period.
  pure integer function segment_of(self, x) result(i)
    type(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: x                     !< time in the first period [s]

    do i = size(self%curves), 2, -1
      if (x >= self%times(i)) return
    end do
  end function segment_of

  !> The bound is the greatest rate of all segments between the two times.
  function greatest_rate(self, t, h) result(rate)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: t                      !< beginning of the interval [s]
    real(wp), intent(in) :: h                      !< length of the interval [s]; may be negative
    real(wp) :: rate
    real(wp) :: period, from, to
    integer :: i

    period = self%times(size(self%times)) - self%times(1)
    from = min(t, t + h) - self%rounds_before(min(t, t + h))*period
    to = from + abs(h)
    rate = 0.0_wp
    do i = 1, size(self%curves)
      if (.not. (overlaps(0.0_wp) .or. self%repeats .and. (overlaps(period) .or. abs(h) > period))) cycle
      rate = max(rate, abs(self%values(i + 1) - self%values(i))*steepest_slope_of(self%curves(i)) &
                 /(self%times(i + 1) - self%times(i)))
    end do
  contains
    !> Whether a segment, later by some time, lies between the times.
    pure logical function overlaps(later)
      real(wp), intent(in) :: later   !< [s]

      overlaps = self%times(i) + later <= to .and. self%times(i + 1) + later >= from
    end function overlaps
  end function greatest_rate

  !> The next end of a segment, or time within one at which the fourth derivative of its law jumps.
  pure real(wp) function next_joint(self, t, direction)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: t                      !< time; a joint there does not count [s]
    real(wp), intent(in) :: direction              !< +1 for later times, -1 for earlier ones
    real(wp) :: period, joint, least, parts(0:most_inner_joints)
    integer :: i, k, n, round

    next_joint = sign(huge(t), direction)
    period = self%times(size(self%times)) - self%times(1)
    least = 4.0_wp*slack(self, t)
    do round = -1, 1
      if (round /= 0 .and. .not. self%repeats) cycle
      do i = 1, size(self%times)
        call find_parts(self, i, parts, n)
        do k = 0, n
          joint = time_of(self, i, parts(k)) + (self%rounds_before(t) + round)*period
          if ((joint - t)*direction > least .and. (next_joint - joint)*direction > 0.0_wp) next_joint = joint
        end do
      end do
    end do
  end function next_joint

  !> The joints of the segment behind a time, in parts of its duration. The last time has no segment.
  pure subroutine find_parts(self, i, parts, n)
    class(segments_law_type), intent(in) :: self           !< the law
    integer, intent(in) :: i                               !< number of the time
    real(wp), intent(out) :: parts(0:most_inner_joints)    !< 0 for this time itself, then n others, in parts of the duration [1]
    integer, intent(out) :: n                              !< how many joints there are within the segment

    parts = 0.0_wp
    n = 0
    if (i <= size(self%curves)) call find_inner_joints(self%curves(i), parts(1:), n)
  end subroutine find_parts

  !> A time in the segment behind another one [s].
  pure real(wp) function time_of(self, i, part)
    class(segments_law_type), intent(in) :: self   !< the law
    integer, intent(in) :: i                       !< number of the time
    real(wp), intent(in) :: part                   !< of the segment's duration; 0 at its beginning [1]

    time_of = self%times(i)
    if (part > 0.0_wp) time_of = time_of + part*(self%times(i + 1) - self%times(i))
  end function time_of

  !> The derivative of the time of a joint by one parameter. In later periods the duration of these counts, too.
  pure real(wp) function joint_rate(self, change, joint)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: change(:)              !< (2n+2) derivatives of the times, then of the values
    real(wp), intent(in) :: joint                  !< time of the joint [s]
    real(wp) :: period, rounds, distance, nearest, parts(0:most_inner_joints)
    integer :: i, k, n, inside

    n = size(self%curves)
    period = self%times(n + 1) - self%times(1)
    ! a time in the part behind it gives its period without round-off
    rounds = self%rounds_before(joint + 0.0625_wp*minval(self%times(2:) - self%times(:n)))
    joint_rate = 0.0_wp
    nearest = huge(nearest)
    do i = 1, n + 1
      call find_parts(self, i, parts, inside)
      do k = 0, inside
        distance = abs(time_of(self, i, parts(k)) + rounds*period - joint)
        if (.not. distance < nearest) cycle
        nearest = distance
        joint_rate = change(i) + rounds*(change(n + 1) - change(1))
        if (k > 0) joint_rate = joint_rate + parts(k)*(change(i + 1) - change(i))
      end do
    end do
  end function joint_rate

  !> The law, its integral from the first time, and the integral of this one.
  pure subroutine antiderivatives(self, x, value, first, second)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: x                      !< its variable [s, or its unit]
    real(wp), intent(out) :: value                 !< the law
    real(wp), intent(out) :: first                 !< its integral
    real(wp), intent(out) :: second                !< the integral of the integral
    real(wp) :: sums(2), changes(2), zeros(2*size(self%times))

    zeros = 0.0_wp
    call integrate_all(self, zeros, x, value, sums, changes)
    first = sums(1)
    second = sums(2)
  end subroutine antiderivatives

  !> The derivatives of both integrals by one parameter, from those of the times and values.
  pure subroutine vary_antiderivatives(self, change, x, first, second)
    class(segments_law_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: change(:)              !< (2n+2) derivatives of the times, then of the values
    real(wp), intent(in) :: x                      !< its variable [s, or its unit]
    real(wp), intent(out) :: first                 !< derivative of the integral
    real(wp), intent(out) :: second                !< derivative of the integral of the integral
    real(wp) :: value, sums(2), changes(2)

    call integrate_all(self, change, x, value, sums, changes)
    first = changes(1)
    second = changes(2)
  end subroutine vary_antiderivatives

  !> Both integrals up to a place, whole periods before it included, with their derivatives by one parameter.
  pure subroutine integrate_all(self, change, x, value, sums, changes)
    type(segments_law_type), intent(in) :: self    !< the law
    real(wp), intent(in) :: change(:)              !< (2n+2) derivatives of the times, then of the values
    real(wp), intent(in) :: x                      !< its variable [s, or its unit]
    real(wp), intent(out) :: value                 !< the law
    real(wp), intent(out) :: sums(2)               !< the integral, and its integral
    real(wp), intent(out) :: changes(2)            !< their derivatives
    real(wp) :: rounds, period, period_change, inside, into, into_change, whole(2), whole_changes(2), last
    integer :: n

    n = size(self%times)
    rounds = self%rounds_before(x)
    period = self%times(n) - self%times(1)
    period_change = change(n) - change(1)
    inside = x - rounds*period
    call integrate_period(self, change, inside, -rounds*period_change, value, sums, changes)
    if (.not. abs(rounds) > 0.0_wp) return
    call integrate_period(self, change, self%times(n), change(n), last, whole, whole_changes)
    into = inside - self%times(1) + 0.5_wp*(rounds - 1.0_wp)*period
    into_change = -rounds*period_change - change(1) + 0.5_wp*(rounds - 1.0_wp)*period_change
    sums(2) = sums(2) + rounds*(whole(1)*into + whole(2))
    changes(2) = changes(2) + rounds*(whole_changes(1)*into + whole(1)*into_change + whole_changes(2))
    sums(1) = sums(1) + rounds*whole(1)
    changes(1) = changes(1) + rounds*whole_changes(1)
  end subroutine integrate_all

  !> Both integrals from the first time up to a place in the first period, with their derivatives by one parameter.
  pure subroutine integrate_period(self, change, x, x_change, value, sums, changes)
    type(segments_law_type), intent(in) :: self    !< the law
    real(wp), intent(in) :: change(:)              !< (2n+2) derivatives of the times, then of the values
    real(wp), intent(in) :: x                      !< the place
    real(wp), intent(in) :: x_change               !< its derivative
    real(wp), intent(out) :: value                 !< the law
    real(wp), intent(out) :: sums(2)               !< the integral, and its integral
    real(wp), intent(out) :: changes(2)            !< their derivatives
    real(wp) :: h, h_change, rise, rise_change, u, u_change, s, ds, dds, first, second, way, way_change
    integer :: i, last, n

    n = size(self%times)
    last = segment_of(self, x)
    sums = 0.0_wp
    changes = 0.0_wp
    do i = 1, last
      h = self%times(i + 1) - self%times(i)
      h_change = change(i + 1) - change(i)
      rise = self%values(i + 1) - self%values(i)
      rise_change = change(n + i + 1) - change(n + i)
      u = 1.0_wp
      u_change = 0.0_wp
      if (i == last) then
        u = max(0.0_wp, min(1.0_wp, (x - self%times(i))/h))
        u_change = (x_change - change(i) - u*h_change)/h
      end if
      way = u*h
      way_change = u_change*h + u*h_change
      call cam_curve(self%curves(i), u, s, ds, dds)
      call cam_integrals(self%curves(i), u, first, second)
      value = self%values(i) + rise*s
      changes(2) = changes(2) + changes(1)*way + sums(1)*way_change &
                   + 2.0_wp*h*h_change*(0.5_wp*self%values(i)*u**2 + rise*second) &
                   + h**2*(0.5_wp*change(n + i)*u**2 + rise_change*second + (self%values(i)*u + rise*first)*u_change)
      sums(2) = sums(2) + sums(1)*way + h**2*(0.5_wp*self%values(i)*u**2 + rise*second)
      changes(1) = changes(1) + h_change*(self%values(i)*u + rise*first) &
                   + h*(change(n + i)*u + rise_change*first + value*u_change)
      sums(1) = sums(1) + h*(self%values(i)*u + rise*first)
    end do
  end subroutine integrate_period
end module mech9_segments_law
