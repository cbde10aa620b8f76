!> Starts in positions where branches cross: where only one way leads on it is taken, with rates and
!> accelerations by their limits; where two do they are named; at a dead point there is none.
module test_special_start
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_singular
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_driven_motion, only: driven_motion_type, advance
  use mech9_sample_mechanisms, only: drive, four_bar
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess, four_bar_limit, slider_crank
  use mech9_followed_motions, only: begin_motion, at_crossing
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('kites')) call kites(test)
    if (test%runs('two_ways')) call two_ways(test)
    if (test%runs('dead_start')) call dead_start(test)
  end subroutine run

  subroutine kites(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: n

    do n = 1, 4
      call kite(test, 10**(n - 1), 1.0_wp)
      call kite(test, 10**(n - 1), -30.0_wp)
    end do
  end subroutine kites

  !> A kite whose crank lies on the ground: coupler and rocker could turn together, but only one motion takes
  !> the crank along. q4 = q1/2 + 90 degrees - acos(short sin(q1/2)/long).
  subroutine kite(test, n, speed)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< outputs
    real(wp), intent(in) :: speed              !< of the crank [rad/s]
    real(wp), parameter :: long = 1.0_wp, short = 0.7_wp
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: half, root, position, rate, acceleration
    integer :: j

    call four_bar(short, short, long, long, [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], model)
    call drive(model, 1, [0.0_wp, speed])
    call begin_motion(test, model, 0.0_wp, plan, driven, err)
    call test%no_error(err, 'a kite starts')
    do j = 0, n
      if (allocated(err)) exit
      half = 0.5_wp*driven%state%q(1)
      root = sqrt(long**2 - (short*sin(half))**2)
      position = half + 0.5_wp*pi - acos(short*sin(half)/long)
      rate = (0.5_wp + 0.5_wp*short*cos(half)/root)*speed
      acceleration = 0.25_wp*short*sin(half)*(short**2*cos(half)**2/root**3 - 1.0_wp/root)*speed**2
      call test%near(driven%state%q(4) - position, 0.0_wp, at_crossing(0), 'a kite: the rocker has the position of the closed form')
      call test%near((driven%state%dq(4) - rate)/speed, 0.0_wp, at_crossing(1), &
                     'a kite: the rocker has the rate of the closed form')
      call test%near((driven%state%ddq(4) - acceleration)/speed**2, 0.0_wp, at_crossing(2), &
                     'a kite: the rocker has the acceleration of the closed form')
      if (j < n) call advance(model%problem%drives, plan, driven, (j + 1)*1.5_wp/(abs(speed)*n), err)
    end do
    call test%no_error(err, 'a kite goes on')
  end subroutine kite

  !> A flat parallelogram: as parallelogram dq4 = dq1, crossed dq4 = -dq1 (ground + crank)/(ground - crank).
  !> Equal arms at a right angle: the slider moves by -2 r dq1, or not at all.
  subroutine two_ways(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err

    call four_bar(1.0_wp, 0.6_wp, 1.0_wp, 0.6_wp, [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], model)
    call drive(model, 1, [0.0_wp, 1.0_wp])
    call begin_motion(test, model, 0.0_wp, plan, driven, err)
    call refused(test, err, 'dq4 = 1 ', 'dq4 = -4 ')
    call slider_crank(0.3_wp, 0.3_wp, 0.0_wp, 0.5_wp*pi, 1, model)
    model%problem%initial%position(4) = 0.0_wp
    call drive(model, 1, [0.5_wp*pi, 2.0_wp])
    call begin_motion(test, model, 0.0_wp, plan, driven, err)
    call refused(test, err, 'dq4 = -1.2 ', 'dq4 = 0 ')
  end subroutine two_ways

  !> The message tells of both rates.
  subroutine refused(test, err, first, second)
    type(tester_type), intent(inout) :: test           !< counts the checks
    type(error_type), allocatable, intent(in) :: err   !< the failure
    character(len=*), intent(in) :: first              !< words of the first rate
    character(len=*), intent(in) :: second             !< words of the second rate
    character(len=:), allocatable :: text
    integer :: i

    call test%has_error(err, exit_singular, 'a start from which two ways lead on ends with exit code 6')
    if (.not. allocated(err)) return
    text = message_of(err)
    do i = 1, len(text)
      if (text(i:i) == ',' .or. text(i:i) == ';') text(i:i) = ' '
    end do
    call test%is_true(index(text, first) > 0, 'the message tells one way: '//first)
    call test%is_true(index(text, second) > 0, 'the message tells the other way: '//second)
    if (index(text, first) == 0 .or. index(text, second) == 0) print '(a)', text
  end subroutine refused

  subroutine dead_start(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: limit

    bar = four_bar_type(ground=1.2_wp, crank=0.7_wp, coupler=0.9_wp, rocker=0.4_wp)
    limit = four_bar_limit(bar, stretched=.true.)
    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, limit, 1), model)
    call drive(model, 1, [limit, -1.0_wp])
    call begin_motion(test, model, 0.0_wp, plan, driven, err)
    call test%has_error(err, exit_singular, 'a start at a dead point ends with exit code 6')
    if (allocated(err)) call test%is_true(index(message_of(err), 'dead point') > 0, &
                                          'the message about a start at a dead point says so')
  end subroutine dead_start
end module test_special_start
