!> Dead points, found to 1e-9 and better, and positions where branches cross, which are passed on the branch
!> with continuous velocities: everything against closed forms.
module test_special_positions
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_singular
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_driven_motion, only: driven_motion_type, advance
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_sample_mechanisms, only: drive, four_bar
  use mech9_planar_mechanisms, only: slider_crank, watt_six_bar, four_bar_type, four_bar_guess, four_bar_limit
  use mech9_followed_motions, only: begin_motion, angle_between, at_crossing
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

  !> Outputs over one and a half turns: few; some of them exactly at special positions; many.
  integer, parameter :: outputs(5) = [1, 6, 36, 100, 3000]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('dead_points')) call dead_points(test)
    if (test%runs('crossings')) call crossings(test)
  end subroutine run

  subroutine dead_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i
    type(random_type) :: random

    do i = 1, 20
      call check_dead_point(test, 0.3_wp*abs(random%symmetric()) + 0.01_wp)
      call check_dead_point(test, 10.0_wp**(-0.35_wp*i - 1.0_wp))
      call check_slider_dead_point(test, random)
    end do
  end subroutine dead_points

  subroutine crossings(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i

    do i = 1, size(outputs)
      call check_parallelogram(test, outputs(i), 0.31_wp)
      call check_parallelogram(test, outputs(i), 0.5_wp*pi)
      call check_antiparallelogram(test, outputs(i))
      call check_kite(test, outputs(i))
      call check_equal_arms(test, outputs(i), 0.25_wp*pi)
      call check_touched_dead_point(test, outputs(i))
      call check_two_at_once(test, outputs(i))
    end do
  end subroutine crossings

  !> A crank that cannot turn fully because the longest and the shortest link are too long by `excess`
  !> together: it stops on both sides where coupler and rocker are in line.
  subroutine check_dead_point(test, excess)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: excess             !< sum of ground and rocker less that of coupler and crank [m]
    type(four_bar_type) :: bar
    type(model_type) :: model
    real(wp) :: limit
    integer :: branch, direction

    ! not of Grashof's kind: crank and ground are the two middle links or hold the longest
    bar = four_bar_type(ground=1.2_wp, crank=0.7_wp, coupler=0.9_wp, rocker=0.4_wp)
    bar%ground = bar%coupler + bar%crank - bar%rocker + excess
    limit = four_bar_limit(bar, stretched=.true.)
    do branch = -1, 1, 2
      do direction = -1, 1, 2
        call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, &
                      four_bar_guess(bar, 0.5_wp*limit, branch), model)
        call drive(model, 1, [0.5_wp*limit, direction*2.0_wp])
        if (direction > 0) call find_end(test, model, limit, direction, 'a four-bar')
        ! the other way: through zero to the same limit on the other side, unless the links fold before it
        if (direction < 0 .and. bar%ground - bar%crank > abs(bar%coupler - bar%rocker)) &
          call find_end(test, model, -limit, direction, 'a four-bar, backwards')
      end do
    end do
  end subroutine check_dead_point

  !> A crank longer than what the coupler reaches: sin = (l + e)/r.
  subroutine check_slider_dead_point(test, random)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    type(model_type) :: model
    real(wp) :: crank, coupler, offset
    integer :: branch

    crank = 1.0_wp + 0.3_wp*random%symmetric()
    coupler = 0.6_wp + 0.05_wp*random%symmetric()
    offset = 0.05_wp*random%symmetric()
    do branch = -1, 1, 2
      call slider_crank(crank, coupler, offset, 0.1_wp, branch, model)
      call drive(model, 1, [0.1_wp, 0.4_wp, 0.3_wp])
      call find_end(test, model, asin((coupler + offset)/crank), 1, 'a slider-crank')
    end do
  end subroutine check_slider_dead_point

  !> Run to the dead point with few and with many outputs.
  subroutine find_end(test, model, limit, direction, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    real(wp), intent(in) :: limit              !< the crank at the dead point [rad]
    integer, intent(in) :: direction           !< +1 or -1: of the crank
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    integer :: n, j

    do n = 1, 1000, 333
      call begin_motion(test, model, 0.0_wp, plan, driven)
      do j = 1, n
        call advance(model%problem%drives, plan, driven, 4.0_wp*j/n, err)
        if (allocated(err)) exit
        call test%is_true((limit - driven%state%q(1))*direction > 0.0_wp, name//': no output lies beyond the dead point')
      end do
      call test%has_error(err, exit_singular, name//': the motion to a dead point ends with exit code 6')
      if (.not. allocated(err)) cycle
      ! the closed form itself loses no digits; the square-root law that the limit is taken from is exact
      ! to the square of the last distance, about 1e-9
      call test%near(driven%limit(1), limit, 1.0e-10_wp, name//': the limit is that of the closed form')
      ! and the motion goes on to 1e-9 of the time that was left when the limit was found
      call test%near(driven%state%q(1), limit, 1.0e-9_wp, name//': the motion stops at the dead point')
      call test%is_true((limit - driven%state%q(1))*direction > 0.0_wp, name//': the motion stops just short of the dead point')
      call test%is_true(index(message_of(err), 'dead point') > 0 .and. index(message_of(err), 'q1') > 0, &
                        name//': the message names the dead point and the coordinate')
    end do
  end subroutine find_end

  !> Turn the crank by one and a half turns and compare coordinates 2 to 4, their rates and accelerations
  !> with multiples of the crank's: coupler against crank, rocker against coupler, rocker.
  subroutine check_proportional(test, model, n, start, expected, factors, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the model
    integer, intent(in) :: n                   !< outputs
    real(wp), intent(in) :: start              !< of the crank
    real(wp), intent(in) :: expected(2:4)      !< at the crank's angle zero
    real(wp), intent(in) :: factors(2:4)       !< of coordinates 2 to 4 over the crank
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    integer :: j

    call drive(model, 1, [start, 3.0_wp*pi, merge(0.5_wp, 0.0_wp, start < 1.0_wp)])
    call begin_motion(test, model, 0.0_wp, plan, driven)
    do j = 1, n
      call advance(model%problem%drives, plan, driven, real(j, wp)/n, err)
      if (allocated(err)) exit
      associate (state => driven%state)
        call test%near(maxval(angle_between(state%q(2:), expected + factors*state%q(1))), 0.0_wp, at_crossing(0), &
                       name//': the positions are proportional')
        call test%near(maxval(abs(state%dq(2:) - factors*state%dq(1))), 0.0_wp, at_crossing(1)*abs(state%dq(1)), &
                       name//': the rates are proportional')
        call test%near(maxval(abs(state%ddq(2:) - factors*state%ddq(1))), 0.0_wp, at_crossing(2)*state%dq(1)**2, &
                       name//': the accelerations are proportional')
      end associate
    end do
    call test%no_error(err, name//' goes on')
    ! the direction that the equations do not determine there opens chains by its error times the pivot, which is round-off
    call test%is_true(driven%worst_closure < 1.0e-13_wp*plan%length, name//' stays closed')
  end subroutine check_proportional

  !> The rocker turns with the crank, the coupler stays parallel to the ground, also through the flat positions.
  subroutine check_parallelogram(test, n, start)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< outputs
    real(wp), intent(in) :: start              !< angle of the crank at the start [rad]
    type(model_type) :: model

    call four_bar(1.0_wp, 0.4_wp, 1.0_wp, 0.4_wp, [start, -start, start, start], model)
    call check_proportional(test, model, n, start, [0.0_wp, 0.0_wp, 0.0_wp], [-1.0_wp, 1.0_wp, 1.0_wp], 'a parallelogram')
  end subroutine check_parallelogram

  !> The same links crossed: the tangents of half the angles of crank and rocker have a fixed product, hence
  !> the rate below.
  subroutine check_antiparallelogram(test, n)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< outputs
    real(wp), parameter :: ground = 1.0_wp, crank = 0.4_wp, start = 0.5_wp*pi
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: gap, rate
    integer :: j

    bar = four_bar_type(ground, crank, ground, crank)
    call four_bar(ground, crank, ground, crank, four_bar_guess(bar, start, -1), model)
    call drive(model, 1, [start, 3.0_wp*pi])
    call begin_motion(test, model, 0.0_wp, plan, driven)
    call test%is_true(angle_between(driven%state%q(4), start) > 1.0_wp, 'the antiparallelogram is not the parallelogram')
    do j = 1, n
      call advance(model%problem%drives, plan, driven, real(j, wp)/n, err)
      if (allocated(err)) exit
      associate (a => driven%state%q(1), b => driven%state%q(4))
        ! the pins are apart by the coupler's length, and the rocker turns against the crank
        gap = hypot(ground + crank*(cos(b) - cos(a)), crank*(sin(b) - sin(a))) - ground
        call test%near(gap, 0.0_wp, at_crossing(0), 'an antiparallelogram: the positions are those of the closed form')
        rate = -(ground**2 - crank**2)/(ground**2 + crank**2 - 2.0_wp*ground*crank*cos(a))*driven%state%dq(1)
        call test%near((driven%state%dq(4) - rate)/driven%state%dq(1), 0.0_wp, at_crossing(1), &
                       'an antiparallelogram: the rates are those of the closed form')
      end associate
    end do
    call test%no_error(err, 'an antiparallelogram goes on')
  end subroutine check_antiparallelogram

  !> Crank and ground alike, coupler and rocker alike: where the crank lies on the ground its pin is in the
  !> pivot of the rocker, which could then turn by itself; the kite passes.
  subroutine check_kite(test, n)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< outputs
    real(wp), parameter :: long = 1.0_wp, short = 0.7_wp
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: half, expected, rate
    integer :: j

    bar = four_bar_type(short, short, long, long)
    call four_bar(short, short, long, long, four_bar_guess(bar, 0.25_wp*pi, 1), model)
    call drive(model, 1, [0.25_wp*pi, -3.0_wp*pi])
    call begin_motion(test, model, 0.0_wp, plan, driven)
    do j = 1, n
      call advance(model%problem%drives, plan, driven, real(j, wp)/n, err)
      if (allocated(err)) exit
      ! the diagonal 2 short sin(q1/2), with its sign, points along q1/2 + 90 degrees
      half = 0.5_wp*driven%state%q(1)
      expected = half + 0.5_wp*pi - acos(short*sin(half)/long)
      rate = (0.5_wp + 0.5_wp*short*cos(half)/sqrt(long**2 - (short*sin(half))**2))*driven%state%dq(1)
      call test%near(angle_between(driven%state%q(4), expected), 0.0_wp, at_crossing(0), &
                     'a kite: the rocker has the angle of the closed form')
      call test%near((driven%state%dq(4) - rate)/driven%state%dq(1), 0.0_wp, at_crossing(1), &
                     'a kite: the rocker has the rate of the closed form')
    end do
    call test%no_error(err, 'a kite goes on')
  end subroutine check_kite

  !> Crank and coupler alike: x = 2 r cos q1 goes through zero, where the crank could turn without the slider.
  subroutine check_equal_arms(test, n, start)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< outputs
    real(wp), intent(in) :: start              !< angle of the crank at the start [rad]
    real(wp), parameter :: arm = 0.6_wp
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    integer :: j

    call slider_crank(arm, arm, 0.0_wp, start, 1, model)
    call drive(model, 1, [start, 3.0_wp*pi])
    call begin_motion(test, model, 0.0_wp, plan, driven)
    do j = 1, n
      call advance(model%problem%drives, plan, driven, real(j, wp)/n, err)
      if (allocated(err)) exit
      associate (state => driven%state)
        call test%near(state%q(4) - 2.0_wp*arm*cos(state%q(1)), 0.0_wp, at_crossing(0), &
                       'equal arms: the slider has the position of the closed form')
        call test%near(state%dq(4)/state%dq(1) + 2.0_wp*arm*sin(state%q(1)), 0.0_wp, at_crossing(1), &
                       'equal arms: the slider has the rate of the closed form')
        call test%near(state%ddq(4)/state%dq(1)**2 + 2.0_wp*arm*cos(state%q(1)), 0.0_wp, at_crossing(2), &
                       'equal arms: the slider has the acceleration of the closed form')
      end associate
    end do
    call test%no_error(err, 'equal arms go on')
  end subroutine check_equal_arms

  !> A drive that comes to rest just at the dead point and turns back: the mechanism swings through to its
  !> other branch with continuous velocity.
  subroutine check_touched_dead_point(test, n)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< outputs
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    type(harmonic_law_type) :: swing
    real(wp) :: limit, guess(4)
    integer :: j

    bar = four_bar_type(ground=1.2_wp, crank=0.7_wp, coupler=0.9_wp, rocker=0.4_wp)
    limit = four_bar_limit(bar, stretched=.true.)
    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.7_wp*limit, 1), model)
    swing%coordinate = 1
    swing%mean = 0.7_wp*limit
    swing%amplitude = 0.3_wp*limit
    swing%angular_frequency = pi
    deallocate (model%problem%drives)
    allocate (model%problem%drives(1))
    allocate (model%problem%drives(1)%drive, source=swing)
    call begin_motion(test, model, 0.0_wp, plan, driven)
    do j = 1, n
      call advance(model%problem%drives, plan, driven, real(j, wp)/n, err)
      if (allocated(err)) exit
    end do
    call test%no_error(err, 'a dead point that is only touched is passed')
    ! half a period later the crank is back, and the rocker on the other side
    guess = four_bar_guess(bar, 0.7_wp*limit, -1)
    ! far from the dead point again: round-off over a pivot of 0.1 and more
    call test%near(maxval(angle_between(driven%state%q, guess)), 0.0_wp, 1.0e-13_wp, &
                   'a dead point that is only touched leads to the other side')
  end subroutine check_touched_dead_point

  !> A parallelogram, and a second one on its coupler: both are flat at once.
  subroutine check_two_at_once(test, n)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: n                   !< outputs
    real(wp), parameter :: start = 0.8_wp, crank = 0.4_wp
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: point(2), pin(2)
    integer :: j

    bar = four_bar_type(1.0_wp, crank, 1.0_wp, crank)
    ! link 5 is fixed to nothing but moves like a second coupler: it joins the coupler at its middle
    point = crank*[cos(start), sin(start)] + [0.5_wp, 0.0_wp]
    pin = [1.7_wp, 0.0_wp] + crank*[cos(start), sin(start)]
    call watt_six_bar(bar, [0.5_wp, 0.0_wp], [1.7_wp, 0.0_wp], [1.2_wp, crank], start, 1, 1, model)
    model%problem%initial%position = [start, -start, start, start, 0.0_wp, start, start]
    call drive(model, 1, [start, 3.0_wp*pi])
    call begin_motion(test, model, 0.0_wp, plan, driven)
    call test%near(norm2(pin - point), 1.2_wp, 1.0e-14_wp, 'the second parallelogram closes')
    do j = 1, n
      call advance(model%problem%drives, plan, driven, real(j, wp)/n, err)
      if (allocated(err)) exit
      call test%near(angle_between(driven%state%q(7), driven%state%q(1)), 0.0_wp, at_crossing(0), &
                     'two parallelograms: the second rocker has the angle of the crank')
      call test%near(driven%state%dq(7)/driven%state%dq(1), 1.0_wp, at_crossing(1), &
                     'two parallelograms: the second rocker has the rate of the crank')
    end do
    call test%no_error(err, 'two parallelograms go on')
  end subroutine check_two_at_once
end module test_special_positions
