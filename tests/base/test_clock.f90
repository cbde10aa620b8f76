!> The clock, and the pacer of long loops.
module test_clock
  use mech9_kinds, only: wp
  use mech9_clock, only: seconds, pacer_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('clock_goes_on')) call clock_goes_on(test)
    if (test%runs('pacer_keeps_time')) call pacer_keeps_time(test)
  end subroutine run

  subroutine clock_goes_on(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: before, now
    logical :: back
    integer :: i

    back = .false.
    before = seconds()
    do i = 1, 100000
      now = seconds()
      back = back .or. now < before
      before = now
    end do
    call test%is_true(.not. back, 'the clock never goes back')
  end subroutine clock_goes_on

  !> A pacer in a fast loop never tells before the interval is over, and tells again and again.
  subroutine pacer_keeps_time(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(pacer_type) :: pacer
    real(wp), parameter :: interval = 0.005_wp
    real(wp) :: origin, passed
    integer :: times

    origin = seconds()
    call pacer%start(interval)
    times = 0
    passed = 0.0_wp
    do while (times < 4 .and. passed < 60.0_wp)
      if (pacer%due()) times = times + 1
      passed = seconds() - origin
    end do
    call test%is_true(times == 4, 'intervals of 5 ms are over four times within a minute')
    call test%is_true(passed >= 4.0_wp*interval*(1.0_wp - 1.0e-6_wp), &
                      'four intervals of 5 ms are not over before their time has passed')

    call pacer%start(1.0e9_wp)
    call test%is_true(.not. pacer%due(), 'an interval of thirty years is not over yet')
    call pacer%start(0.0_wp)
    call test%is_true(pacer%due(), 'an interval of nothing is over at once')
  end subroutine pacer_keeps_time
end module test_clock
