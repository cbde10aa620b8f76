!> Special points of a curve between two of its points: where a test changes its sign.
module mech9_special_points
  use mech9_kinds, only: wp
  use mech9_false_position, only: false_position_type, new_false_position
  use mech9_curve_tolerances, only: round_off_step, neutral_root, real_root
  use mech9_curve, only: curve_type, curve_point_type, verdict_type, regular, fold, branching, hopf, period_doubling, torus
  use mech9_curve_step, only: correction_type, correct_along, set_direction, branch_test
  implicit none
  private
  public :: regular, fold, branching, hopf, period_doubling, torus, range_end, curve_stride_type, test_of, locate, growing_pairs, &
    locate_hopf, growing_reals, locate_crossings

  !> A step along a curve, between two of its points.
  type :: curve_stride_type
    type(curve_point_type) :: from        !< the point before, with its direction
    type(curve_point_type) :: to          !< the point behind
    type(verdict_type) :: before          !< of the point before
    real(wp) :: length = 0.0_wp           !< distance of the point behind along this direction
  end type curve_stride_type

  !> The end of the range in which solutions have a meaning, which no table has.
  integer, parameter :: range_end = 6
  !> Largest number of trials for one point.
  integer, parameter :: most_trials = 60
  !> A search has ended where the test is below this part of its first values: round-off of the correction. For branch points it ends
  !> earlier, since the equations become singular there.
  real(wp), parameter :: zero_test = 1.0e-13_wp, zero_branch_test = 1.0e-4_wp
  !> A pair of roots that crosses is followed once it is within this part of its magnitude from the axis. The other pairs are farther away.
  real(wp), parameter :: crossed = 1.0e-3_wp

contains

  !> The test of a kind of point: it changes its sign there.
  real(wp) function test_of(curve, kind, point) result(test)
    class(curve_type), intent(in) :: curve         !< the problem
    integer, intent(in) :: kind                    !< fold, branching or range_end
    type(curve_point_type), intent(in) :: point    !< on the curve, with its direction

    select case (kind)
    case (fold)
      test = point%direction(size(point%direction))
    case (branching)
      test = branch_test(point, curve%scale)
    case default
      test = curve%gap(point)
    end select
  end function test_of

  !> Locate a zero of a test, to round-off, but for branch points.
  subroutine locate(curve, stride, kind, tests, distance, point, found)
    class(curve_type), intent(inout) :: curve           !< the problem
    type(curve_stride_type), intent(in) :: stride       !< between the points before and behind
    integer, intent(in) :: kind                         !< of point
    real(wp), intent(in) :: tests(2)                    !< at both points, of different sign
    real(wp), intent(out) :: distance                   !< of the point along the direction
    type(curve_point_type), intent(inout) :: point      !< with its direction
    logical, intent(out) :: found                       !< it was found
    type(false_position_type) :: search
    type(curve_point_type) :: trial
    real(wp) :: place, value, best
    integer :: i
    logical :: reached

    search = new_false_position(0.0_wp, -abs(tests(1)), stride%length, abs(tests(2)))
    best = huge(best)
    place = 0.0_wp
    do i = 1, most_trials
      call search%next(place, reached)
      if (.not. reached) exit
      call stand_at(curve, stride%from, place, trial, reached)
      if (.not. reached) exit
      value = -sign(1.0_wp, tests(1))*test_of(curve, kind, trial)
      if (abs(value) < best) then
        best = abs(value)
        distance = place
        point = trial
      end if
      if (best <= merge(zero_branch_test, zero_test, kind == branching)*maxval(abs(tests))) exit
      call search%take(place, value)
      if (search%behind - search%before <= round_off_step) exit
    end do
    found = best < maxval(abs(tests))
  end subroutine locate

  !> A point on the curve with its direction.
  subroutine stand_at(curve, from, distance, point, reached)
    class(curve_type), intent(inout) :: curve           !< the problem
    type(curve_point_type), intent(in) :: from          !< another point, with its direction
    real(wp), intent(in) :: distance                    !< along this direction
    type(curve_point_type), intent(inout) :: point      !< the point
    logical, intent(out) :: reached                     !< it was found
    type(correction_type) :: correction

    call correct_along(curve, from, distance, point, correction)
    reached = correction%done
    if (reached) call set_direction(point, from%direction, reached)
  end subroutine stand_at

  !> The number of conjugate pairs of roots that grow.
  pure integer function growing_pairs(verdict) result(pairs)
    type(verdict_type), intent(in) :: verdict   !< of a point

    pairs = count(is_pair(verdict%roots) .and. real(verdict%roots, wp) > neutral_root*abs(verdict%roots))
  end function growing_pairs

  !> The number of real roots that grow.
  pure integer function growing_reals(verdict) result(number)
    type(verdict_type), intent(in) :: verdict   !< of a point

    number = count(.not. is_pair(verdict%roots) .and. real(verdict%roots, wp) > 0.0_wp)
  end function growing_reals

  !> Locate the point at which several real roots begin or cease to grow, by bisection.
  subroutine locate_crossings(curve, stride, before, distance, point, found)
    class(curve_type), intent(inout) :: curve           !< the problem
    type(curve_stride_type), intent(in) :: stride       !< between the points before and behind
    integer, intent(in) :: before                       !< number of real roots that grow at the point before
    real(wp), intent(out) :: distance                   !< of the point along the direction
    type(curve_point_type), intent(inout) :: point      !< with its direction
    logical, intent(out) :: found                       !< it was found
    type(curve_point_type) :: trial
    type(verdict_type) :: verdict
    real(wp) :: low, middle
    integer :: i

    low = 0.0_wp
    distance = stride%length
    do i = 1, most_trials
      if (distance - low <= round_off_step) exit
      middle = 0.5_wp*(low + distance)
      call stand_at(curve, stride%from, middle, trial, found)
      if (.not. found) exit
      call curve%judge(trial, verdict)
      if (growing_reals(verdict) == before) then
        low = middle
      else
        distance = middle
        point = trial
      end if
    end do
    found = distance < stride%length
  end subroutine locate_crossings

  !> Whether a root is one of a conjugate pair.
  elemental logical function is_pair(root)
    complex(wp), intent(in) :: root   !< the root

    is_pair = abs(aimag(root)) > real_root*abs(root)
  end function is_pair

  !> Locate a Hopf point, where a pair of roots crosses the imaginary axis, between points with different numbers of growing pairs. Where
  !> two pairs without damping meet and part again, the point is where they meet. A pair that becomes real roots is none.
  subroutine locate_hopf(curve, stride, pairs, distance, point, found)
    class(curve_type), intent(inout) :: curve           !< the problem
    type(curve_stride_type), intent(in) :: stride       !< between the points before and behind
    integer, intent(in) :: pairs(2)                     !< number of growing pairs at both points
    real(wp), intent(out) :: distance                   !< of the point along the direction
    type(curve_point_type), intent(inout) :: point      !< with its direction
    logical, intent(out) :: found                       !< it was found
    type(false_position_type) :: search
    type(curve_point_type) :: trial
    real(wp) :: low, high, place, value, values(2), sense
    integer :: i, now
    logical :: undamped

    low = 0.0_wp
    high = stride%length
    distance = high
    values = 0.0_wp
    sense = sign(1.0_wp, real(pairs(2) - pairs(1), wp))
    call try(merge(low, high, pairs(1) < pairs(2)))
    if (.not. found) return
    ! without damping round-off alone decides on which side of the axis a pair lies
    undamped = abs(value) <= neutral_root
    do i = 1, most_trials
      if (.not. undamped .and. values(1) < 0.0_wp .and. values(2) > 0.0_wp .and. maxval(abs(values)) < crossed) exit
      if (high - low <= round_off_step) exit
      call try(0.5_wp*(low + high))
      if (.not. found) return
      if (now == pairs(1)) then
        low = place
        values(1) = value
      else
        high = place
        values(2) = value
        point = trial
        distance = high
      end if
    end do
    found = allocated(point%z) .and. distance < stride%length
    if (.not. undamped .and. values(1) < 0.0_wp .and. values(2) > 0.0_wp) then
      search = new_false_position(low, values(1), high, values(2))
      do i = 1, most_trials
        call search%next(distance, found)
        if (.not. found) exit
        call try(distance)
        if (.not. found) return
        point = trial
        if (abs(value) <= zero_test) exit
        call search%take(distance, value)
        if (search%behind - search%before <= round_off_step) exit
      end do
      found = .true.
    end if
    if (found) call try(distance)
    found = found .and. abs(value) <= crossed
  contains

    !> Judge a point between both. `value` is the real part of the pair next to the axis, over its magnitude, growing along the curve.
    subroutine try(at)
      real(wp), intent(in) :: at   !< its distance
      type(verdict_type) :: verdict
      real(wp) :: parts(64)
      integer :: k

      place = at
      call stand_at(curve, stride%from, at, trial, found)
      if (.not. found) return
      call curve%judge(trial, verdict)
      now = growing_pairs(verdict)
      parts = huge(1.0_wp)
      do k = 1, min(size(verdict%roots), size(parts))
        if (is_pair(verdict%roots(k))) parts(k) = real(verdict%roots(k), wp)/abs(verdict%roots(k))
      end do
      value = sense*parts(minloc(abs(parts), dim=1))
    end subroutine try
  end subroutine locate_hopf
end module mech9_special_points
