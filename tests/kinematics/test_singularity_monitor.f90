!> The singularity monitor on a four-bar whose singular positions are known: it trusts no step in which one may lie.
module test_singularity_monitor
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_block_solver, only: block_work_type, new_block_work
  use mech9_singularity_monitor, only: singularity_monitor_type, new_singularity_monitor, factorize_trial, monitor_step, &
    accept_jacobians
  use mech9_sample_mechanisms, only: four_bar
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess, four_bar_limit
  use mech9_testing, only: tester_type
  use mech9_frame_motion, only: place_all
  implicit none
  private
  public :: run

  !> Coupler and rocker are stretched out and folded at a crank between 0 and half a turn.
  type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.75_wp, coupler=1.0_wp, rocker=0.4_wp)

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_changes')) call check_changes(test)
    if (test%runs('check_signs')) call check_signs(test)
  end subroutine run

  !> Angle of the crank in the middle between its limits [rad].
  pure real(wp) function middle()
    middle = 0.5_wp*(four_bar_limit(bar, stretched=.false.) + four_bar_limit(bar, stretched=.true.))
  end function middle

  !> The four-bar between its limits, and its monitor.
  subroutine begin(test, plan, state, work, monitors)
    type(tester_type), intent(inout) :: test                       !< counts the checks
    type(plan_type), intent(inout) :: plan                         !< plan of the four-bar
    type(state_type), intent(inout) :: state                       !< its position
    type(block_work_type), intent(inout) :: work(1)                !< work space of its block
    type(singularity_monitor_type), intent(inout) :: monitors(1)   !< monitor of its block
    type(model_type) :: model
    type(error_type), allocatable :: err

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, middle(), 1), model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a four-bar has a plan and is assembled')
    if (allocated(err)) call test%finish()
    call test%is_true(size(plan%blocks) == 1, 'a four-bar is one block')
    work(1) = new_block_work(plan%blocks(1))
    monitors(1) = new_singularity_monitor(plan%blocks(1))
  end subroutine begin

  !> Place the four-bar at an angle of the crank, on a branch.
  subroutine go_to(test, plan, state, angle, branch)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(inout) :: plan     !< plan of the four-bar
    type(state_type), intent(inout) :: state   !< its position
    real(wp), intent(in) :: angle              !< angle of the crank [rad]
    integer, intent(in) :: branch              !< +1 or -1
    type(error_type), allocatable :: err

    state%q = four_bar_guess(bar, angle, branch)
    call place_all(plan, state, err)
    call test%no_error(err, 'the frames are in place')
  end subroutine go_to

  !> Take such a position as the start of a step.
  subroutine start_step(test, plan, state, work, monitors, angle, branch)
    type(tester_type), intent(inout) :: test                       !< counts the checks
    type(plan_type), intent(inout) :: plan                         !< plan of the four-bar
    type(state_type), intent(inout) :: state                       !< its position
    type(block_work_type), intent(inout) :: work(1)                !< work space of its block
    type(singularity_monitor_type), intent(inout) :: monitors(1)   !< monitor of its block
    real(wp), intent(in) :: angle                                  !< angle of the crank [rad]
    integer, intent(in) :: branch                                  !< +1 or -1

    call go_to(test, plan, state, angle, branch)
    call factorize_trial(plan, plan%blocks(1), state, work(1), monitors(1))
    call accept_jacobians(work, monitors)
  end subroutine start_step

  !> The measure of a step to a position, which is trusted up to 1.
  real(wp) function step_to(test, plan, state, work, monitors, angle, branch) result(worst)
    type(tester_type), intent(inout) :: test                       !< counts the checks
    type(plan_type), intent(inout) :: plan                         !< plan of the four-bar
    type(state_type), intent(inout) :: state                       !< its position
    type(block_work_type), intent(inout) :: work(1)                !< work space of its block
    type(singularity_monitor_type), intent(inout) :: monitors(1)   !< monitor of its block
    real(wp), intent(in) :: angle                                  !< angle of the crank [rad]
    integer, intent(in) :: branch                                  !< +1 or -1

    call go_to(test, plan, state, angle, branch)
    worst = 0.0_wp
    call monitor_step(plan, plan%blocks(1), state, .false., work(1), monitors(1), worst)
  end function step_to

  subroutine check_changes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: limit
    type(plan_type) :: plan
    type(state_type) :: state
    type(block_work_type) :: work(1)
    type(singularity_monitor_type) :: monitors(1)

    call begin(test, plan, state, work, monitors)
    limit = four_bar_limit(bar, stretched=.true.)
    call start_step(test, plan, state, work, monitors, middle(), 1)
    call test%near(step_to(test, plan, state, work, monitors, middle(), 1), 0.0_wp, 0.0_wp, &
                   'a step that leads nowhere changes nothing')
    call test%is_true(step_to(test, plan, state, work, monitors, middle() + 1.0e-3_wp, 1) < 0.1_wp, 'a short step is trusted')
    ! the Jacobian is singular at the limit, to the round-off of the angle there: the root of that of the crank
    call test%is_true(step_to(test, plan, state, work, monitors, limit, 1) > 1.0_wp, &
                      'a step that ends at a dead point is not trusted')
    call start_step(test, plan, state, work, monitors, limit - 1.0e-4_wp, 1)
    call test%is_true(step_to(test, plan, state, work, monitors, limit - 1.0e-4_wp, -1) > 1.0_wp, &
                      'a step to the other branch is not trusted, however near it is')
    call test%is_true(monitors(1)%trial_sign == -monitors(1)%sign, 'the determinant has another sign on the other branch')
  end subroutine check_changes

  !> A change of the determinant's sign refuses a step even if the Jacobian changes very little.
  subroutine check_signs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state
    type(block_work_type) :: work(1)
    type(singularity_monitor_type) :: monitors(1)

    call begin(test, plan, state, work, monitors)
    call start_step(test, plan, state, work, monitors, middle(), 1)
    monitors(1)%sign = -monitors(1)%sign
    call test%is_true(step_to(test, plan, state, work, monitors, middle(), 1) > 1.0_wp, 'a sign that changed is not passed over')
  end subroutine check_signs
end module test_singularity_monitor
