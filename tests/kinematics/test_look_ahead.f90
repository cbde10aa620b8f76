!> The look-ahead and the crossing of branches, on four-bars whose singular positions are known in closed form.
module test_look_ahead
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_singularity_monitor, only: is_near
  use mech9_branch_stepping, only: branch_stepper_type, step_towards
  use mech9_special_position, only: finding_type, look_ahead, nothing_special, dead_point, branch_point
  use mech9_branch_crossing, only: branch_crossing_type, build_crossing, position_within
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion
  use mech9_sample_mechanisms, only: four_bar, drive
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess, four_bar_limit
  use mech9_followed_motions, only: at_crossing
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_dead_point')) call check_dead_point(test)
    if (test%runs('check_crossing')) call check_crossing(test)
    if (test%runs('check_close_branches')) call check_close_branches(test)
  end subroutine run

  !> Drive the crank of a four-bar by one rad per second, until it is near a singular position.
  subroutine come_near(test, model, plan, stepper, bar, start, t)
    type(tester_type), intent(inout) :: test            !< counts the checks
    type(model_type), intent(out) :: model              !< a four-bar
    type(plan_type), intent(out) :: plan                !< its plan
    type(branch_stepper_type), intent(out) :: stepper   !< its motion, near the singular position
    type(four_bar_type), intent(in) :: bar              !< lengths of the four-bar
    real(wp), intent(in) :: start                       !< angle of the crank at time 0 [rad]
    real(wp), intent(in) :: t                           !< a time beyond the singular position [s]
    type(driven_motion_type) :: driven
    type(state_type) :: assembled
    type(error_type), allocatable :: err
    logical :: stuck
    integer :: refused_by, step

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, start, 1), model)
    call drive(model, 1, [start, 1.0_wp])
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, assembled, err)
    call test%no_error(err, 'a four-bar has a plan and is assembled')
    if (allocated(err)) call test%finish()
    call start_driven_motion(model%problem%drives, plan, assembled, 0.0_wp, driven, err)
    call test%no_error(err, 'the motion of a four-bar starts')
    stepper = driven%branch_stepper_type
    do step = 1, 1000
      call step_towards(model%problem%drives, plan, stepper, t, stuck, refused_by, err)
      if (allocated(err) .or. stuck .or. is_near(stepper%monitors(1))) exit
    end do
    call test%is_true(is_near(stepper%monitors(1)) .and. .not. stuck, 'regular steps lead near the singular position')
  end subroutine come_near

  !> Coupler and rocker stretched out: the crank cannot go on.
  subroutine check_dead_point(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.75_wp, coupler=1.0_wp, rocker=0.4_wp)
    type(finding_type) :: finding
    real(wp) :: limit
    type(model_type) :: model
    type(plan_type) :: plan
    type(branch_stepper_type) :: stepper

    limit = four_bar_limit(bar, stretched=.true.)
    call come_near(test, model, plan, stepper, bar, limit - 0.4_wp, 2.0_wp)
    call look_ahead(model%problem%drives, plan, stepper, 1, 1.0_wp, finding)
    call test%is_true(finding%kind == dead_point .and. finding%block == 1, 'a dead point is found')
    ! the square-root law leaves terms of higher order in the distance of the last step, some 1e-11
    call test%near(finding%t, 0.4_wp, 1.0e-9_wp, 'the dead point is found at its time')
  end subroutine check_dead_point

  !> A parallelogram is flat at half a turn, where the branch of the antiparallelogram crosses.
  subroutine check_crossing(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.5_wp, coupler=1.0_wp, rocker=0.5_wp)
    real(wp), parameter :: start = pi - 0.5_wp
    type(finding_type) :: finding
    type(branch_crossing_type) :: crossing
    type(error_type), allocatable :: err
    real(wp) :: t
    integer :: i
    type(model_type) :: model
    type(plan_type) :: plan
    type(branch_stepper_type) :: stepper

    call come_near(test, model, plan, stepper, bar, start, 2.0_wp)
    call look_ahead(model%problem%drives, plan, stepper, 1, 1.0_wp, finding)
    call test%is_true(finding%kind == branch_point, 'a crossing is found')
    ! the time is extrapolated from positions of the probe that lie within a small part of the distance
    call test%near(finding%t, 0.5_wp, 1.0e-6_wp, 'the crossing is found at its time')
    call build_crossing(model%problem%drives, plan, stepper, finding%t, crossing, err)
    call test%no_error(err, 'the motion through the crossing is looked for without a failure')
    call test%is_true(crossing%exists .and. .not. crossing%ends, 'the motion through the crossing is found')
    call test%is_true(crossing%from < 0.5_wp .and. crossing%to > 0.5_wp, 'the motion leads from before the crossing to beyond it')
    do i = 0, 8
      t = crossing%from + (crossing%to - crossing%from)*i/8.0_wp
      call position_within(model%problem%drives, plan, crossing, t, stepper, err)
      call test%no_error(err, 'a position within the crossing is found')
      ! the rocker stays parallel to the crank, and the coupler to the ground; the polynomial of this linear motion is exact
      call test%near(maxval(abs(stepper%state%q - [start + t, -start - t, start + t, start + t])), 0.0_wp, at_crossing(0), &
                     'a position within the crossing is that of the parallelogram')
      call test%near(maxval(abs(stepper%state%dq - [1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp])), 0.0_wp, at_crossing(1), &
                     'rates within the crossing are those of the parallelogram')
    end do
  end subroutine check_crossing

  !> With a coupler that is a little longer the branches pass each other at a distance.
  subroutine check_close_branches(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.5_wp, coupler=1.00001_wp, rocker=0.5_wp)
    type(finding_type) :: finding
    type(model_type) :: model
    type(plan_type) :: plan
    type(branch_stepper_type) :: stepper

    call come_near(test, model, plan, stepper, bar, pi - 0.5_wp, 2.0_wp)
    call look_ahead(model%problem%drives, plan, stepper, 1, 1.0_wp, finding)
    call test%is_true(finding%kind == nothing_special, 'branches that only come close are no crossing')
    call test%is_true(finding%t > 0.5_wp, 'no crossing is found until the branches are apart again')
  end subroutine check_close_branches
end module test_look_ahead
