!> A branch in one direction, from one of its points on: steps, special points on the way, and the end (pseudo-arclength continuation,
!> Keller; conventions of AUTO, Doedel, in docs/reference/bibliography.md).
module mech9_curve_tracing
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_curve_tolerances, only: least_curve_step, first_part, most_turn, most_departure, same_point, &
    same_direction, near_special, near_branching
  use mech9_curve, only: curve_type, curve_point_type, verdict_type
  use mech9_curve_step, only: correction_type, correct, correct_along, set_direction
  use mech9_special_points, only: regular, fold, branching, period_doubling, range_end, curve_stride_type, test_of, locate, &
    growing_pairs, locate_hopf, growing_reals, locate_crossings
  use mech9_branch_point, only: branch_point_type, polish_branch_point
  use mech9_curve_branch, only: curve_branch_type, curve_settings_type, ends_low, ends_high, ends_points, ends_closed, ends_range, &
    ends_failed, ends_stopped, ends_special
  implicit none
  private
  public :: trace, shortest_way

  !> A special point within a step.
  type :: event_type
    integer :: kind = regular             !< of point
    real(wp) :: distance = 0.0_wp         !< from the beginning of the step
    type(curve_point_type) :: point       !< the point
    integer :: row = regular              !< kind of its row, where the branch ends at it
    logical :: is_guess = .false.         !< it counts only where its exact place is found
  end type event_type

  !> Steps of Newton's method at which the next step may be longer, and at which it is shorter.
  integer, parameter :: few_steps = 4, many_steps = 7
  !> Factor by which a step grows, and cosine of the angle of directions above which it may.
  real(wp), parameter :: growth_of_step = 1.5_wp, little_turn = 0.996_wp

contains

  !> Trace the branch from a point with its direction. Branch points on the way are added to a list.
  subroutine trace(curve, start, kind, settings, branch, met)
    class(curve_type), intent(inout) :: curve                         !< the problem
    type(curve_point_type), intent(in) :: start                       !< the point, with its direction
    integer, intent(in) :: kind                                       !< of this point
    type(curve_settings_type), intent(in) :: settings                 !< bounds
    type(curve_branch_type), intent(inout) :: branch                  !< gets the points
    type(branch_point_type), allocatable, intent(inout) :: met(:)     !< gets the branch points
    type(curve_stride_type) :: stride
    type(verdict_type) :: verdict
    real(wp) :: h
    logical :: done

    stride%from = start
    call curve%judge(stride%from, stride%before)
    call branch%add(stride%from, stride%before, kind)
    h = first_part*settings%step
    associate (last => branch%ends(2))
      do
        last%reason = ends_points
        if (branch%count >= settings%points) return
        last%reason = ends_stopped
        if (curve%is_stopped()) return
        call step_on(curve, stride, settings%step, h, branch, done)
        if (.not. done) return
        last%reason = 0
        call pass_events(curve, start, merge(kind, regular, branch%count == 1), settings, stride, branch, met)
        if (last%reason > 0) return
        call curve%judge(stride%to, verdict)
        call branch%add(stride%to, verdict, regular)
        stride%before = verdict
        call go_on(curve, stride%to, stride%from, done)
        last%reason = ends_failed
        if (.not. done) return
      end do
    end associate
  end subroutine trace

  !> Make a step: shorter ones are tried until one is accepted.
  subroutine step_on(curve, stride, longest, h, branch, done)
    class(curve_type), intent(inout) :: curve              !< the problem
    type(curve_stride_type), intent(inout) :: stride       !< from its first point; gets the next one, with its direction
    real(wp), intent(in) :: longest                        !< longest step
    real(wp), intent(inout) :: h                           !< length to be tried; then that of the next step
    type(curve_branch_type), intent(inout) :: branch       !< gets the length tried last, and the reason where no step is accepted
    logical, intent(out) :: done                           !< one is accepted
    type(correction_type) :: correction
    real(wp) :: turn

    associate (a => stride%from, b => stride%to)
      do
        branch%ends(2)%last_step = h
        turn = -1.0_wp
        call correct_along(curve, a, h, b, correction)
        done = correction%done
        if (done) call set_direction(b, a%direction, done)
        if (done) then
          turn = dot_product(a%direction, b%direction)
          done = turn >= most_turn .and. norm2(b%z - a%z - h*a%direction) <= most_departure*h
        end if
        if (done) exit
        if (h < least_curve_step) then
          branch%ends(2)%reason = ends_failed
          if (allocated(correction%err)) branch%ends(2)%err = correction%err
          return
        end if
        h = 0.5_wp*h
      end do
      stride%length = dot_product(b%z - a%z, a%direction)
    end associate
    if (correction%steps <= few_steps .and. turn > little_turn) h = min(longest, growth_of_step*h)
    if (correction%steps >= many_steps) h = h/growth_of_step
  end subroutine step_on

  !> Go on from a point: other unknowns may serve better there.
  subroutine go_on(curve, b, a, done)
    class(curve_type), intent(inout) :: curve          !< the problem
    type(curve_point_type), intent(in) :: b            !< the point that was reached
    type(curve_point_type), intent(inout) :: a         !< the same for the next step
    logical, intent(out) :: done                       !< it has a direction
    type(curve_point_type) :: kept
    real(wp) :: direction(size(b%z))

    direction = b%direction
    kept = b
    a = b
    call change(curve, a)
    done = .true.
    if (any(a%place /= kept%place) .or. a%equations /= kept%equations) call set_direction(a, direction, done)
  end subroutine go_on

  !> Take other unknowns where they can be taken.
  subroutine change(curve, a)
    class(curve_type), intent(inout) :: curve          !< the problem
    type(curve_point_type), intent(inout) :: a         !< the point
    type(curve_point_type) :: other
    type(error_type), allocatable :: err

    other = a
    call curve%change_unknowns(other, err)
    if (.not. allocated(err)) then
      if (any(other%place /= a%place) .or. other%equations /= a%equations) a = other
    end if
  end subroutine change

  !> Add the special points within a step to the branch, in their order, and the point where the branch ends, if it does.
  subroutine pass_events(curve, start, from, settings, stride, branch, met)
    class(curve_type), intent(inout) :: curve                         !< the problem
    type(curve_point_type), intent(in) :: start                       !< the point at which the branch began
    integer, intent(in) :: from                                       !< kind of the start in the first step from it, else regular
    type(curve_settings_type), intent(in) :: settings                 !< bounds
    type(curve_stride_type), intent(in) :: stride                     !< the step
    type(curve_branch_type), intent(inout) :: branch                  !< gets the points
    type(branch_point_type), allocatable, intent(inout) :: met(:)     !< gets the branch points
    type(event_type) :: events(3), last
    type(branch_point_type) :: found
    type(verdict_type) :: verdict
    integer :: i, next
    logical :: done

    call find_end(curve, start, settings, stride, last, branch)
    if (from /= branching .and. from /= period_doubling) then
      call look_for(branching, events(1))
      call look_for(fold, events(2))
      if (events(1)%kind == branching .and. events(2)%kind == fold .and. &
          abs(events(1)%distance - events(2)%distance) < near_branching*stride%length) events(2)%kind = regular
    end if
    ! a pair of multipliers is on the unit circle where periods double, within errors
    if (from /= period_doubling) call judge_behind()
    do
      next = 0
      do i = 1, size(events)
        if (events(i)%kind == regular) cycle
        if (branch%ends(2)%reason > 0 .and. events(i)%distance > last%distance - near_special*stride%length) cycle
        if (next == 0) next = i
        if (events(i)%distance < events(next)%distance) next = i
      end do
      if (next == 0) exit
      if (events(next)%kind == branching) then
        call keep_direction(stride%from, stride%to, events(next)%point)
        call polish_branch_point(curve, events(next)%point, found)
        if (events(next)%is_guess .and. .not. found%is_polished) then
          events(next)%kind = regular
          cycle
        end if
        events(next)%point = found%point
        found%doublings = branch%doublings
        call end_at_halving(curve, found, branch, last, done)
        met = [met, found]
        if (done) exit
      else if (events(next)%kind == period_doubling) then
        call keep_doubling(events(next)%point, branch%doublings, met)
      end if
      call curve%judge(events(next)%point, verdict)
      call branch%add(events(next)%point, verdict, events(next)%kind)
      events(next)%kind = regular
    end do
    if (branch%ends(2)%reason == 0) return
    if (last%kind == regular .or. branch%ends(2)%reason == ends_closed) then
      call curve%judge(last%point, verdict)
      call branch%add(last%point, verdict, last%row)
      if (branch%ends(2)%reason == ends_closed) branch%kind(branch%count) = branch%kind(1)
    end if
  contains

    !> Look for a point where a test changes its sign.
    subroutine look_for(kind, event)
      integer, intent(in) :: kind                  !< of point
      type(event_type), intent(inout) :: event     !< gets it, if there is one
      real(wp) :: tests(2)
      logical :: is_there

      tests = [test_of(curve, kind, stride%from), test_of(curve, kind, stride%to)]
      if (.not. tests(1)*tests(2) < 0.0_wp) return
      call locate(curve, stride, kind, tests, event%distance, event%point, is_there)
      if (.not. is_there .and. kind == branching) then
        call guess_between(curve, stride%from, stride%to, tests, event%point, is_there)
        event%is_guess = .true.
        event%distance = stride%length*abs(tests(1))/sum(abs(tests))
      end if
      if (is_there) event%kind = kind
    end subroutine look_for

    !> Look for a Hopf point, and for one where an even number of roots crosses at once, which no test shows.
    subroutine judge_behind()
      type(verdict_type) :: behind
      logical :: is_there

      if (size(stride%before%roots) == 0) return
      call curve%judge(stride%to, behind)
      if (growing_pairs(stride%before) /= growing_pairs(behind)) then
        call locate_hopf(curve, stride, [growing_pairs(stride%before), growing_pairs(behind)], events(3)%distance, &
                         events(3)%point, is_there)
        if (is_there) events(3)%kind = curve%kind_of_crossing(events(3)%point)
      else if (abs(growing_reals(stride%before) - growing_reals(behind)) > 1 .and. all(events%kind == regular)) then
        call locate_crossings(curve, stride, growing_reals(stride%before), events(3)%distance, events(3)%point, is_there)
        if (is_there) events(3)%kind = branching
      end if
    end subroutine judge_behind
  end subroutine pass_events

  !> Keep a point at which periods double, on the branch with the single period.
  subroutine keep_doubling(point, doublings, met)
    type(curve_point_type), intent(in) :: point                       !< the point, with its direction
    integer, intent(in) :: doublings                                  !< of the branch
    type(branch_point_type), allocatable, intent(inout) :: met(:)     !< gets it
    type(branch_point_type) :: found

    found%point = point
    found%doubles = .true.
    found%knows_single = .true.
    found%doublings = doublings
    met = [met, found]
  end subroutine keep_doubling

  !> End a branch at a branch point where solutions repeat already after half their period: behind it they are the same, only begun half
  !> a period later.
  subroutine end_at_halving(curve, found, branch, last, done)
    class(curve_type), intent(inout) :: curve              !< the problem
    type(branch_point_type), intent(inout) :: found        !< the branch point; then that of the single period
    type(curve_branch_type), intent(inout) :: branch       !< gets the reason
    type(event_type), intent(inout) :: last                !< gets the point
    logical, intent(out) :: done                           !< solutions repeat there
    type(curve_point_type) :: half

    done = .false.
    if (found%is_polished) call curve%halve(found%point, half, done)
    if (.not. done) return
    branch%ends(2)%reason = ends_special
    last%kind = regular
    last%row = period_doubling
    last%point = found%point
    found%point = half
    found%doubles = .true.
    found%knows_double = .true.
    found%doublings = branch%doublings - 1
  end subroutine end_at_halving

  !> A guess of a branch point within a step, where the curve could not be followed to it: a branch that turns back there crosses the other
  !> one so that points near by are not apart.
  subroutine guess_between(curve, a, b, tests, point, found)
    class(curve_type), intent(inout) :: curve          !< the problem
    type(curve_point_type), intent(in) :: a            !< the point before
    type(curve_point_type), intent(in) :: b            !< the point behind
    real(wp), intent(in) :: tests(2)                   !< (2) values of the test at both points, of different sign
    type(curve_point_type), intent(inout) :: point     !< the guess, with the direction of the branch
    logical, intent(out) :: found                      !< the equations have a value there
    type(error_type), allocatable :: err
    real(wp) :: way(size(a%z))

    way = b%z - a%z
    curve%equations = a%equations
    call curve%evaluate(a%place, a%z + way*(abs(tests(1))/sum(abs(tests))), point, err)
    found = .not. allocated(err)
    if (.not. found) return
    point%direction = way/norm2(way)
    point%tangent = point%direction(point%place)
  end subroutine guess_between

  !> Keep the direction of a branch at a branch point within a step: so near to it the equations may tell that of the other branch. The way
  !> from one end of the step to the other is not far from it.
  pure subroutine keep_direction(a, b, point)
    type(curve_point_type), intent(in) :: a            !< the point before
    type(curve_point_type), intent(in) :: b            !< the point behind
    type(curve_point_type), intent(inout) :: point     !< near the branch point, with a direction
    real(wp) :: way(size(a%z))

    way = (b%z - a%z)/norm2(b%z - a%z)
    if (dot_product(way, point%direction) >= most_turn) return
    point%direction = way
    point%tangent = way(point%place)
  end subroutine keep_direction

  !> Find where a branch ends within a step: where it began, at a limit of the parameter, or where solutions lose their meaning.
  subroutine find_end(curve, start, settings, stride, last, branch)
    class(curve_type), intent(inout) :: curve              !< the problem
    type(curve_point_type), intent(in) :: start            !< the point at which the branch began
    type(curve_settings_type), intent(in) :: settings      !< bounds
    type(curve_stride_type), intent(in) :: stride          !< the step
    type(event_type), intent(out) :: last                  !< the end; without a point where it is the point before
    type(curve_branch_type), intent(inout) :: branch       !< gets the reason; 0: none
    type(event_type) :: barrier
    real(wp) :: limit, tests(2)
    logical :: found
    integer :: m

    if (branch%count > 2) call find_start(curve, start, stride, last, branch, found)
    if (branch%ends(2)%reason == ends_closed) return
    associate (a => stride%from, b => stride%to)
      m = size(a%z)
      if (b%z(m) < settings%low .or. b%z(m) > settings%high) then
        limit = merge(settings%low, settings%high, b%z(m) < settings%low)
        branch%ends(2)%reason = merge(ends_low, ends_high, b%z(m) < settings%low)
        call reach_limit(curve, a, b, limit, last, found)
        if (.not. found) last%kind = range_end
        if (found) last%distance = dot_product(last%point%z - a%z, a%direction)
      end if
      tests = [test_of(curve, range_end, a), test_of(curve, range_end, b)]
      if (tests(2) >= 0.0_wp) return
      found = tests(1) > 0.0_wp
      barrier%distance = 0.0_wp
      if (found) then
        call curve%meet_end(a, b, barrier%point, barrier%row)
        if (barrier%row /= regular) then
          barrier%distance = dot_product(barrier%point%z - a%z, a%direction)
        else
          call locate(curve, stride, range_end, tests, barrier%distance, barrier%point, found)
        end if
      end if
    end associate
    ! the limit of the parameter may come first
    if (branch%ends(2)%reason > 0 .and. last%kind == regular .and. last%distance < barrier%distance) return
    branch%ends(2)%reason = merge(ends_range, ends_special, barrier%row == regular)
    last = barrier
    if (.not. found) last%kind = range_end
  end subroutine find_end

  !> The point at which the parameter has its limit.
  subroutine reach_limit(curve, a, b, limit, last, found)
    class(curve_type), intent(inout) :: curve          !< the problem
    type(curve_point_type), intent(in) :: a            !< within the limit
    type(curve_point_type), intent(in) :: b            !< beyond it
    real(wp), intent(in) :: limit                      !< of the parameter
    type(event_type), intent(inout) :: last            !< gets the point
    logical, intent(out) :: found                      !< it was found
    type(correction_type) :: correction
    real(wp) :: normal(size(a%place)), part
    integer :: m

    m = size(a%z)
    found = abs(limit - a%z(m)) > 0.0_wp
    if (.not. found) return
    part = (limit - a%z(m))/(b%z(m) - a%z(m))
    normal = 0.0_wp
    normal(size(normal)) = 1.0_wp
    call correct(curve, a, normal, limit - a%z(m), part*(b%z(a%place) - a%z(a%place)), last%point, correction)
    found = correction%done
    if (.not. found) return
    call set_direction(last%point, a%direction, found)
    last%point%z(m) = limit
  end subroutine reach_limit

  !> Find the point where the branch began within a step, and end there.
  subroutine find_start(curve, start, stride, last, branch, found)
    class(curve_type), intent(inout) :: curve              !< the problem
    type(curve_point_type), intent(in) :: start            !< the point at which the branch began
    type(curve_stride_type), intent(in) :: stride          !< the step
    type(event_type), intent(inout) :: last                !< gets the point
    type(curve_branch_type), intent(inout) :: branch       !< gets the reason
    logical, intent(out) :: found                          !< it lies within the step
    type(correction_type) :: correction
    type(curve_point_type) :: point
    real(wp) :: way(size(stride%from%z)), normal(size(stride%from%place)), distance

    associate (a => stride%from)
      way = shortest_way(curve, a%z, start%z)
      distance = dot_product(way, a%direction)
      found = distance > 0.0_wp .and. distance <= stride%length .and. &
              norm2(way - distance*a%direction) < most_departure*stride%length
      if (.not. found) return
      ! the plane goes through the start, so that a curve which comes back meets it there
      normal = matmul(a%direction, a%slopes)
      call correct(curve, a, normal, dot_product(normal, way(a%place)), way(a%place), point, correction)
      found = correction%done
      if (found) call set_direction(point, a%direction, found)
      if (found) found = norm2(shortest_way(curve, point%z, start%z)) < same_point .and. &
                         dot_product(point%direction, start%direction) > same_direction
      if (.not. found) return
      branch%ends(2)%reason = ends_closed
      branch%ends(2)%turns = (a%z + way - start%z)
    end associate
    where (curve%period > 0.0_wp)
      branch%ends(2)%turns = anint(branch%ends(2)%turns/curve%period)
    elsewhere
      branch%ends(2)%turns = 0.0_wp
    end where
    last%distance = distance
    last%point = start
    last%point%z = start%z + branch%ends(2)%turns*curve%period
  end subroutine find_start

  !> The way from one image to another, up to periods.
  pure function shortest_way(curve, from, to) result(way)
    class(curve_type), intent(in) :: curve    !< the problem
    real(wp), intent(in) :: from(:)           !< (m) one image
    real(wp), intent(in) :: to(:)             !< (m) the other one
    real(wp) :: way(size(from))

    way = to - from
    where (curve%period > 0.0_wp) way = way - curve%period*anint(way/curve%period)
  end function shortest_way
end module mech9_curve_tracing
