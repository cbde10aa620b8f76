!> Rigid stops in a driven motion, which must not pass them.
module mech9_driven_stops
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: touching
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_simulation_failures, only: failure_stop_passed
  use mech9_hermite, only: cubic_between
  use mech9_law, only: drive_slot_type
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_plan, only: plan_type
  use mech9_driven_motion, only: driven_motion_type, advance
  use mech9_driven_angles, only: copy_driven_motion
  use mech9_stop_contacts, only: stop_contacts_type
  implicit none
  private
  public :: check_stops

  !> Points between two outputs at which the way to a stop is looked at; the last one is the second output.
  integer, parameter :: looks = 16
  !> Trials of the search for the time of the passing, each of which halves an interval.
  integer, parameter :: most_trials = 60

contains

  !> Check the way from the last output to the present one: fail where a rigid end is passed, with the time of the passing. At the start
  !> there is no way before.
  subroutine check_stops(model, plan, drives, driven, before, contacts, err)
    type(model_type), intent(in) :: model                  !< the model
    type(plan_type), intent(in) :: plan                    !< as the motion executes it
    type(drive_slot_type), intent(in) :: drives(:)         !< of the independent coordinates
    type(driven_motion_type), intent(in) :: driven         !< the motion at the present output, with its rates
    real(wp), intent(in) :: before                         !< time of the last output; the present one at the start [s]
    type(stop_contacts_type), intent(inout) :: contacts    !< the ends, with the motion at the last output; then at the present one
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: t, h
    integer :: i, look

    h = driven%state%t - before
    if (contacts%in_doubt(plan, driven%state, h)) then
      do i = 1, size(contacts%ends)
        if (.not. contacts%ends(i)%is_rigid) cycle
        do look = merge(1, looks, abs(h) > 0.0_wp), looks
          t = driven%state%t - (1.0_wp - real(look, wp)/looks)*h
          if (look < looks) then
            if (.not. may_turn(look)) cycle
            call find_least(t - h/looks, t + h/looks, t)
          end if
          if (.not. way_at(t) < -touching*plan%unit_of(contacts%ends(i)%coordinate)) cycle
          call fail(t)
          return
        end do
      end do
    end if
    call contacts%note(driven%state)
  contains
    !> Whether the way may be least near a look, and the end passed there, by the cubic polynomial between the outputs.
    logical function may_turn(look)
      integer, intent(in) :: look   !< number of the look, below the last one
      real(wp) :: ways(-1:1)
      integer :: k

      associate (end => contacts%ends(i), state => driven%state)
        do k = -1, 1
          ways(k) = end%gap(cubic_between(contacts%q(i), h*contacts%dq(i), state%q(end%coordinate), h*state%dq(end%coordinate), &
                                          real(look + k, wp)/looks))
        end do
        may_turn = ways(0) <= min(ways(-1), ways(1)) .and. &
                   ways(0) < 0.1_wp*abs(h)*max(abs(contacts%dq(i)), abs(state%dq(end%coordinate)))
      end associate
    end function may_turn

    !> Find the time between two times at which the way is least, by golden section; a time at which it is below zero will do.
    subroutine find_least(from, to, time)
      real(wp), intent(in) :: from    !< the first time [s]
      real(wp), intent(in) :: to      !< the second time [s]
      real(wp), intent(out) :: time   !< the time [s]
      real(wp), parameter :: golden = 0.5_wp*(sqrt(5.0_wp) - 1.0_wp)
      real(wp) :: a, b, x(2), ways(2)
      integer :: trial

      a = from
      b = to
      do trial = 1, most_trials
        x = [b - golden*(b - a), a + golden*(b - a)]
        ways = [way_at(x(1)), way_at(x(2))]
        time = x(minloc(ways, dim=1))
        if (minval(ways) < -touching*plan%unit_of(contacts%ends(i)%coordinate)) return
        if (ways(1) < ways(2)) then
          b = x(2)
        else
          a = x(1)
        end if
        ! the way changes with the square of the distance from there: closer times show no more of it
        if (abs(b - a) < 1.0e-6_wp*abs(to - from)) return
      end do
    end subroutine find_least

    !> The way that is left to the end at a time before the present output; where the motion does not lead back, that of the present one.
    real(wp) function way_at(time) result(way)
      real(wp), intent(in) :: time   !< the time [s]
      type(driven_motion_type) :: other
      type(error_type), allocatable :: failure

      associate (end => contacts%ends(i))
        way = end%gap(driven%state%q(end%coordinate))
        if (.not. abs(time - driven%state%t) > 0.0_wp) return
        call copy_driven_motion(driven, other)
        call advance(drives, plan, other, time, failure)
        if (.not. allocated(failure)) way = end%gap(other%state%q(end%coordinate))
      end associate
    end function way_at

    !> Fail, with the time of the passing by bisection.
    subroutine fail(behind)
      real(wp), intent(in) :: behind   !< a time behind it [s]
      real(wp) :: first, last, middle, told
      integer :: trial

      first = before
      last = behind
      told = behind
      if (way_at(driven%state%t) < way_at(behind)) told = driven%state%t
      do trial = 1, most_trials
        middle = 0.5_wp*(first + last)
        if (.not. abs(last - first) > spacing(last)) exit
        if (way_at(middle) < 0.0_wp) then
          last = middle
        else
          first = middle
        end if
      end do
      associate (end => contacts%ends(i))
        call raise(err, exit_singular, failure_stop_passed)
        err%failure%t = last
        err%failure%t_stop = told
        err%failure%number = end%stop
        err%failure%coordinates = [end%coordinate]
        err%failure%values = reshape([end%limit, end%limit + end%direction*way_at(told)], [1, 2]) &
                             /unit_of(model%mechanism, end%coordinate)
        err%failure%name = trim(unit_name(model%mechanism, end%coordinate))
        err%place = model%mechanism%stops(end%stop)%place
      end associate
    end subroutine fail
  end subroutine check_stops
end module mech9_driven_stops
