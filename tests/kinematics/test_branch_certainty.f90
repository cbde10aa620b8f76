!> The branch is kept however coarse the outputs are: four-bars, slider-cranks and six-bars on both
!> branches, over several turns, with up to 3000 outputs a turn or one in two turns, against their closed forms; also where
!> the branches come within a millionth of each other.
!>
!> Compares the program with itself in part: Fig. 1 with few and with many outputs; the other mechanisms have closed forms.
module test_branch_certainty
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_driven_motion, only: driven_motion_type, advance
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_sample_mechanisms, only: drive, four_bar, fig1
  use mech9_planar_mechanisms, only: two_circles, slider_crank, watt_six_bar, four_bar_type, random_crank, &
    four_bar_angle, four_bar_guess
  use mech9_followed_motions, only: begin_motion, angle_between
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: turns = 4
  !> Outputs; the first are two turns apart, and one.
  integer, parameter :: outputs(8) = [2, 4, 12, 16, 28, 120, 1204, 12000]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('four_bars')) call four_bars(test)
    if (test%runs('near_change_points')) call near_change_points(test)
    if (test%runs('slider_cranks_and_six_bars')) call slider_cranks_and_six_bars(test)
    if (test%runs('check_swinging_fig1')) call check_swinging_fig1(test)
  end subroutine run

  subroutine four_bars(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i
    type(random_type) :: random

    do i = 1, 40
      call check_four_bar(test, random_crank(random, 0.3_wp*abs(random%symmetric())), 'a four-bar')
    end do
  end subroutine four_bars

  !> The excess of the two middle lengths over the shortest and the longest is small: branches come as near as its root.
  subroutine near_change_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i
    type(random_type) :: random

    do i = 1, 40
      call check_four_bar(test, random_crank(random, 10.0_wp**(-0.2_wp*i - 1.0_wp)), 'a four-bar near its change-point')
    end do
  end subroutine near_change_points

  subroutine slider_cranks_and_six_bars(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i
    type(random_type) :: random

    do i = 1, 20
      call check_slider_crank(test, random, i)
      call check_six_bar(test, random)
    end do
  end subroutine slider_cranks_and_six_bars

  !> Both branches of a crank that turns fully: the angle of the rocker at every output by its triangle, and
  !> the number of its turns the same whatever the outputs.
  subroutine check_four_bar(test, bar, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type), intent(in) :: bar     !< its lengths
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: start, angle, worst, last
    integer :: branch, n, j

    start = 0.7_wp
    do branch = -1, 1, 2
      call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, start, branch), model)
      call drive(model, 1, [start, 2.0_wp*pi])
      do n = 1, size(outputs)
        call begin_motion(test, model, 0.0_wp, plan, driven)
        worst = 0.0_wp
        do j = 1, outputs(n)
          call advance(model%problem%drives, plan, driven, real(turns*j, wp)/outputs(n), err)
          if (allocated(err)) exit
          angle = four_bar_angle(bar, driven%state%q(1), branch)
          worst = max(worst, angle_between(driven%state%q(4), angle))
        end do
        call test%no_error(err, name//' goes on')
        ! positions are known to round-off over the least pivot, and so is the closed form; the nearest
        ! branch is apart by at least the least pivot, 1e-5
        call test%near(worst, 0.0_wp, 1.0e-9_wp, name//' stays on its branch')
        if (n == 1) last = driven%state%q(4)
        call test%near(driven%state%q(4), last, 1.0e-9_wp, name//': the rocker has made as many turns')
      end do
    end do
  end subroutine check_four_bar

  !> x = r cos + - root of l^2 - (r sin - e)^2; the crank at the i-th comes nearer and nearer to what it can turn.
  subroutine check_slider_crank(test, random, i)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: i                     !< number of the crank
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: crank, coupler, offset, angle, expected, worst
    integer :: branch, n, j

    crank = 0.5_wp + 0.2_wp*random%symmetric()
    offset = 0.3_wp*random%symmetric()
    coupler = crank + abs(offset) + 10.0_wp**(-0.4_wp*i)
    do branch = -1, 1, 2
      call slider_crank(crank, coupler, offset, 0.4_wp, branch, model)
      call drive(model, 1, [0.4_wp, 2.0_wp*pi])
      do n = 1, size(outputs)
        call begin_motion(test, model, 0.0_wp, plan, driven)
        worst = 0.0_wp
        do j = 1, outputs(n)
          call advance(model%problem%drives, plan, driven, real(turns*j, wp)/outputs(n), err)
          if (allocated(err)) exit
          angle = driven%state%q(1)
          expected = crank*cos(angle) + branch*sqrt(coupler**2 - (crank*sin(angle) - offset)**2)
          worst = max(worst, abs(driven%state%q(4) - expected))
        end do
        call test%no_error(err, 'a slider-crank goes on')
        call test%near(worst, 0.0_wp, 1.0e-9_wp, 'a slider-crank stays on its branch')
      end do
    end do
  end subroutine check_slider_crank

  !> A four-bar with a pair of links on its coupler: all four branches, by two intersections of circles.
  subroutine check_six_bar(test, random)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    type(four_bar_type) :: bar
    real(wp) :: at(2), pivot(2), expected, worst, joint(2), swing
    integer :: branch, second, n, j

    bar = random_crank(random, 0.1_wp)
    at = [0.5_wp, 0.4_wp]
    pivot = [0.4_wp + 0.3_wp*random%symmetric(), -2.2_wp]
    do branch = -1, 1, 2
      do second = -1, 1, 2
        call watt_six_bar(bar, at, pivot, [2.6_wp, 2.5_wp], 0.3_wp, branch, second, model)
        call drive(model, 1, [0.3_wp, 2.0_wp*pi])
        do n = 1, size(outputs)
          call begin_motion(test, model, 0.0_wp, plan, driven)
          worst = 0.0_wp
          do j = 1, outputs(n)
            call advance(model%problem%drives, plan, driven, real(turns*j, wp)/outputs(n), err)
            if (allocated(err)) exit
            worst = max(worst, angle_between(driven%state%q(4), four_bar_angle(bar, driven%state%q(1), branch)))
            swing = driven%state%q(1) + driven%state%q(2)
            joint = bar%crank*[cos(driven%state%q(1)), sin(driven%state%q(1))] &
                    + at(1)*[cos(swing), sin(swing)] + at(2)*[-sin(swing), cos(swing)]
            joint = two_circles(joint, 2.6_wp, pivot, 2.5_wp, second) - pivot
            expected = atan2(joint(2), joint(1))
            worst = max(worst, angle_between(driven%state%q(7), expected))
          end do
          call test%no_error(err, 'a six-bar goes on')
          ! round-off over the least pivot of two chains, the second of which is placed by the first; branches are far apart
          call test%near(worst, 0.0_wp, 1.0e-10_wp, 'a six-bar stays on its branches')
        end do
      end do
    end do
  end subroutine check_six_bar

  !> Two chains that are solved together, driven to and fro many times between two outputs.
  subroutine check_swinging_fig1(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    type(harmonic_law_type) :: swing
    real(wp) :: start(7), q(7)
    integer :: n, j

    call fig1(1, model)
    deallocate (model%problem%drives)
    allocate (model%problem%drives(1))
    swing%coordinate = 1
    swing%mean = -1.05_wp
    model%problem%initial%position(1) = swing%mean
    swing%amplitude = 0.1_wp
    swing%angular_frequency = 2.0_wp*pi
    do n = 1, 4
      allocate (model%problem%drives(1)%drive, source=swing)
      call begin_motion(test, model, 0.0_wp, plan, driven)
      start = driven%state%q
      do j = 1, 10**n
        ! at the last output the drive has swung forty-seven and a quarter times
        call advance(model%problem%drives, plan, driven, 47.25_wp*j/10**n, err)
        if (allocated(err)) exit
      end do
      call test%no_error(err, 'Fig. 1 swings on')
      if (n == 1) q = driven%state%q
      call test%is_true(maxval(abs(driven%state%q - start)) > 0.05_wp, 'Fig. 1 has moved')
      ! the drive's phase, 295 rad, has round-off of 6e-14, and the chain a conditioning of some hundredths
      call test%near(maxval(abs(driven%state%q - q)), 0.0_wp, 1.0e-11_wp, &
                     'Fig. 1 comes to the same position with few and with many outputs')
      deallocate (model%problem%drives(1)%drive)
    end do
  end subroutine check_swinging_fig1
end module test_branch_certainty
