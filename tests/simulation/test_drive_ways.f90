!> Ways of drives: steps within which no drive moves far, found one by one or known ahead.
module test_drive_ways
  use mech9_kinds, only: wp
  use mech9_law, only: drive_slot_type
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_segments_law, only: segments_law_type
  use mech9_plan, only: plan_type
  use mech9_drive_ways, only: short_ways_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('harmonic')) call harmonic(test)
    if (test%runs('segments')) call segments(test)
  end subroutine run

  !> A plan with units of coordinates alone.
  subroutine make_units(units, plan)
    real(wp), intent(in) :: units(:)        !< (M) units of coordinates
    type(plan_type), intent(out) :: plan    !< gets them

    allocate (plan%unit_of, source=units)
  end subroutine make_units

  !> A drive A sin(W t) in units u moves by at most A W h/u within h: a step is one way where this and an eighth of the period allow it,
  !> forwards and backwards, whatever the steps before it were.
  subroutine harmonic(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(harmonic_law_type) :: law
    type(drive_slot_type) :: drives(1)
    type(plan_type) :: plan
    type(short_ways_type) :: ways
    real(wp), parameter :: longest = 0.25_wp, unit = 2.0_wp
    real(wp), parameter :: lengths(4) = [0.004_wp, 0.11_wp, 0.3_wp, -0.05_wp]   ! of steps, a hundred of each [s]
    real(wp), parameter :: eighth = atan(1.0_wp)/3.0_wp   ! of the period, 2 pi/3 s
    real(wp) :: t, h, way, found
    integer :: i, k

    call make_units([unit], plan)
    law%coordinate = 1
    law%amplitude = 1.4_wp
    law%angular_frequency = 3.0_wp
    allocate (drives(1)%drive, source=law)
    ways = short_ways_type(longest)
    t = 0.0_wp
    do k = 1, size(lengths)
      h = lengths(k)
      way = abs(h)*law%amplitude*law%angular_frequency/unit
      do i = 1, 100
        found = ways%end_of_next(drives, plan, t, t + h) - t
        if (way <= longest .and. abs(h) <= eighth) then
          call test%near(found, h, 1.0e-12_wp, 'a short step is one way')
        else
          call test%is_true(abs(found) < abs(h) .and. found*h > 0.0_wp, 'a long step is divided')
          call test%is_true(abs(found)*law%amplitude*law%angular_frequency/unit <= longest, 'its part is a short way')
        end if
        t = t + h
      end do
    end do
  end subroutine harmonic

  !> A way ends where segments join, although the steps before it were known to be short.
  subroutine segments(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(segments_law_type) :: law
    type(drive_slot_type) :: drives(1)
    type(plan_type) :: plan
    type(short_ways_type) :: ways
    real(wp) :: t, next
    integer :: i

    call make_units([1.0_wp], plan)
    law%coordinate = 1
    law%times = [0.0_wp, 1.005_wp, 3.0_wp]
    law%values = [0.0_wp, 0.2_wp, 0.0_wp]
    law%curves = [1, 1]
    allocate (drives(1)%drive, source=law)
    ways = short_ways_type(0.25_wp)
    do i = 1, 200
      t = 0.01_wp*(i - 1)
      next = ways%end_of_next(drives, plan, t, t + 0.01_wp)
      call test%near(next, merge(1.005_wp, t + 0.01_wp, i == 101), 1.0e-12_wp, 'a way ends at a joint')
    end do
  end subroutine segments
end module test_drive_ways
