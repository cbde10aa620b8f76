!> Rigid stops in a driven motion, which must not pass them.
module mech9_driven_stops
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: touching
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_driven_failures, only: failure_stop_passed, failure_contact_passed
  use mech9_hermite, only: cubic_between
  use mech9_law, only: drive_slot_type
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_plan, only: plan_type
  use mech9_driven_motion, only: driven_motion_type, advance
  use mech9_driven_angles, only: copy_driven_motion
  use mech9_smooth_parts, only: gap_look_type, smooth_parts_type, begin_parts
  use mech9_stop_contacts, only: stop_contacts_type, look_at_gap
  implicit none
  private
  public :: check_stops

  !> Points between two outputs at which the gap of a stop is looked at; the last one is the second output.
  integer, parameter :: looks = 16
  !> Trials of the search for the time of the passing, each of which halves an interval.
  integer, parameter :: most_trials = 60

contains

  !> Check the motion from the last output to the present one: fail where a rigid end is passed, with the time of the first passing.
  !> At the start there is no output before.
  subroutine check_stops(model, plan, drives, driven, before, contacts, err)
    type(model_type), intent(in) :: model                  !< the model
    type(plan_type), intent(in) :: plan                    !< as the motion executes it
    type(drive_slot_type), intent(in) :: drives(:)         !< of the independent coordinates
    type(driven_motion_type), intent(in) :: driven         !< the motion at the present output, with its rates
    real(wp), intent(in) :: before                         !< time of the last output; the present one at the start [s]
    type(stop_contacts_type), intent(inout) :: contacts    !< the ends, with the motion at the last output; then at the present one
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: h

    h = driven%state%t - before
    if (contacts%in_doubt(model%mechanism, plan, driven%state, h)) call search()
    call contacts%note_gaps(model%mechanism, plan, driven%state)
  contains
    !> Search for the first passing of any end since the last output, and fail there.
    subroutine search()
      real(wp) :: t_passed, t_behind, t_first, t_told, soonest
      integer :: i, first
      logical :: passed

      first = 0
      soonest = huge(soonest)
      do i = 1, size(contacts%ends)
        if (.not. contacts%ends(i)%is_rigid) cycle
        call find_passing(i, passed, t_passed, t_behind)
        if (.not. passed) cycle
        if (abs(t_passed - before) >= soonest) cycle
        first = i
        soonest = abs(t_passed - before)
        t_first = t_passed
        t_told = t_behind
      end do
      if (first > 0) call fail(first, t_first, t_told)
    end subroutine search

    !> Find the first passing of an end since the last output: a time at which the gap is clearly below zero, and by bisection from there
    !> that at which it is zero.
    subroutine find_passing(i, passed, t_passed, t_behind)
      integer, intent(in) :: i              !< number of the end
      logical, intent(out) :: passed        !< it is passed
      real(wp), intent(out) :: t_passed     !< when [s]
      real(wp), intent(out) :: t_behind     !< a time behind it: the present output where the gap is least there [s]
      type(gap_look_type) :: at_last
      type(smooth_parts_type) :: parts
      real(wp) :: first, middle
      integer :: trial
      logical :: goes_on

      at_last = gap_look_type(before, contacts%gap(i), contacts%rate(i), 0.0_wp, contacts%place(i))
      call begin_parts(at_last, look_at_gap(model%mechanism, plan, driven%state, contacts%ends(i)), parts)
      goes_on = .true.
      do while (goes_on)
        if (.not. contacts%ends(i)%is_stop()) then
          do while (parts%must_halve(model%mechanism%contacts(contacts%ends(i)%contact)))
            call parts%halve(look_at(i, 0.5_wp*(parts%first%t + parts%last%t)))
          end do
        end if
        call find_behind(i, parts%first, parts%last, passed, t_behind)
        if (passed) exit
        call parts%go_on(goes_on)
      end do
      if (.not. passed) return
      first = parts%first%t
      t_passed = t_behind
      do trial = 1, most_trials
        middle = 0.5_wp*(first + t_passed)
        if (.not. abs(t_passed - first) > spacing(t_passed)) exit
        if (gap_at(i, middle) < 0.0_wp) then
          t_passed = middle
        else
          first = middle
        end if
      end do
      if (gap_at(i, driven%state%t) < gap_at(i, t_behind)) t_behind = driven%state%t
    end subroutine find_passing

    !> Find a time at which the gap is clearly below zero, in a time in which it is smooth.
    subroutine find_behind(i, from, to, passed, time)
      integer, intent(in) :: i                   !< number of the end
      type(gap_look_type), intent(in) :: from    !< the gap at the beginning
      type(gap_look_type), intent(in) :: to      !< the gap at the end
      logical, intent(out) :: passed             !< there is such a time
      real(wp), intent(out) :: time              !< the time [s]
      real(wp) :: duration
      integer :: look

      duration = to%t - from%t
      do look = merge(1, looks, abs(duration) > 0.0_wp), looks
        time = to%t - (1.0_wp - real(look, wp)/looks)*duration
        if (look < looks) then
          if (.not. may_turn(from, to, look)) cycle
          call find_least(i, time - duration/looks, time + duration/looks, time)
        end if
        passed = gap_at(i, time) < -touching*contacts%ends(i)%unit(plan)
        if (passed) exit
      end do
    end subroutine find_behind

    !> Whether the gap may be least near a look, and the end passed there, by the cubic polynomial between two times.
    pure logical function may_turn(from, to, look)
      type(gap_look_type), intent(in) :: from   !< the gap at the first time
      type(gap_look_type), intent(in) :: to     !< the gap at the second one
      integer, intent(in) :: look               !< number of the look, below the last one
      real(wp) :: gaps(-1:1), duration
      integer :: k

      duration = to%t - from%t
      do k = -1, 1
        gaps(k) = cubic_between(from%gap, duration*from%rate, to%gap, duration*to%rate, real(look + k, wp)/looks)
      end do
      may_turn = gaps(0) <= min(gaps(-1), gaps(1)) .and. gaps(0) < 0.1_wp*abs(duration)*max(abs(from%rate), abs(to%rate))
    end function may_turn

    !> Find the time between two times at which the gap is least, by golden section; a time at which it is below zero will do.
    subroutine find_least(i, from, to, time)
      integer, intent(in) :: i        !< number of the end
      real(wp), intent(in) :: from    !< the first time [s]
      real(wp), intent(in) :: to      !< the second time [s]
      real(wp), intent(out) :: time   !< the time [s]
      real(wp), parameter :: golden = 0.5_wp*(sqrt(5.0_wp) - 1.0_wp)
      real(wp) :: a, b, x(2), gaps(2)
      integer :: trial

      a = from
      b = to
      do trial = 1, most_trials
        x = [b - golden*(b - a), a + golden*(b - a)]
        gaps = [gap_at(i, x(1)), gap_at(i, x(2))]
        time = x(minloc(gaps, dim=1))
        if (minval(gaps) < -touching*contacts%ends(i)%unit(plan)) return
        if (gaps(1) < gaps(2)) then
          b = x(2)
        else
          a = x(1)
        end if
        ! the gap changes with the square of the distance from there: closer times show no more of it
        if (abs(b - a) < 1.0e-6_wp*abs(to - from)) return
      end do
    end subroutine find_least

    !> The gap of an end at a time before the present output; where the motion does not lead back, that of the present one.
    real(wp) function gap_at(i, time) result(gap)
      integer, intent(in) :: i       !< number of the end
      real(wp), intent(in) :: time   !< the time [s]
      type(gap_look_type) :: look

      look = look_at(i, time)
      gap = look%gap
    end function gap_at

    !> The motion of this gap.
    type(gap_look_type) function look_at(i, time) result(look)
      integer, intent(in) :: i       !< number of the end
      real(wp), intent(in) :: time   !< the time [s]
      type(driven_motion_type) :: other
      type(error_type), allocatable :: failure

      look = look_at_gap(model%mechanism, plan, driven%state, contacts%ends(i))
      if (abs(time - driven%state%t) > 0.0_wp) then
        call copy_driven_motion(driven, other)
        call advance(drives, plan, other, time, failure)
        if (.not. allocated(failure)) look = look_at_gap(model%mechanism, plan, other%state, contacts%ends(i))
      end if
      look%t = time
    end function look_at

    !> Fail because an end was passed.
    subroutine fail(i, t_passed, t_behind)
      integer, intent(in) :: i              !< number of the end
      real(wp), intent(in) :: t_passed      !< when it was passed [s]
      real(wp), intent(in) :: t_behind      !< a time behind it, for which the coordinate is told [s]

      associate (end => contacts%ends(i))
        call raise(err, exit_singular, merge(failure_stop_passed, failure_contact_passed, end%is_stop()))
        err%failure%t = t_passed
        err%failure%t_stop = t_behind
        err%failure%number = end%number()
        if (.not. end%is_stop()) then
          err%failure%values = reshape([gap_at(i, t_behind)], [1, 1])
          err%place = model%mechanism%contacts(end%contact)%place
          return
        end if
        err%failure%coordinates = [end%coordinate]
        err%failure%values = reshape([end%limit, end%limit + end%direction*gap_at(i, t_behind)], [1, 2]) &
                             /unit_of(model%mechanism, end%coordinate)
        err%failure%name = trim(unit_name(model%mechanism, end%coordinate))
        err%place = model%mechanism%stops(end%stop)%place
      end associate
    end subroutine fail
  end subroutine check_stops
end module mech9_driven_stops
