!> What is watched from step to step, on a four-bar whose singular positions are known: no step is trusted that may have
!> passed one.
program test_singularity_monitor
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
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
  type(tester_type) :: test
  !> Coupler and rocker are stretched out and folded at a crank between 0 and half a turn.
  type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.75_wp, coupler=1.0_wp, rocker=0.4_wp)
  type(plan_type) :: plan
  type(state_type) :: state
  type(block_work_type) :: work(1)
  type(singularity_monitor_type) :: monitors(1)
  real(wp) :: middle

  middle = 0.5_wp*(four_bar_limit(bar, stretched=.false.) + four_bar_limit(bar, stretched=.true.))
  call begin()
  call watch_changes()
  call watch_signs()
  call test%finish()

contains

  subroutine begin()
    type(mechanism_type) :: mechanism
    type(error_type), allocatable :: err

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, middle, 1), mechanism)
    call make_plan(mechanism, mechanism%initial_position, plan, state, err)
    call test%no_error(err, 'plan and assembly')
    if (allocated(err)) call test%finish()
    call test%is_true(size(plan%blocks) == 1, 'one block')
    work(1) = new_block_work(plan%blocks(1))
    monitors(1) = new_singularity_monitor(plan%blocks(1))
  end subroutine begin

  subroutine go_to(angle, branch)
    real(wp), intent(in) :: angle
    integer, intent(in) :: branch
    type(error_type), allocatable :: err

    state%q = four_bar_guess(bar, angle, branch)
    call place_all(plan, state, err)
    call test%no_error(err, 'the frames are in place')
  end subroutine go_to

  subroutine depart(angle, branch)
    real(wp), intent(in) :: angle
    integer, intent(in) :: branch

    call go_to(angle, branch)
    call factorize_trial(plan, plan%blocks(1), state, work(1), monitors(1))
    call accept_jacobians(work, monitors)
  end subroutine depart

  !> What watching a step to a position adds: up to 1 it is trusted.
  real(wp) function step_to(angle, branch) result(worst)
    real(wp), intent(in) :: angle
    integer, intent(in) :: branch

    call go_to(angle, branch)
    worst = 0.0_wp
    call monitor_step(plan, plan%blocks(1), state, .false., work(1), monitors(1), worst)
  end function step_to

  subroutine watch_changes()
    real(wp) :: limit

    limit = four_bar_limit(bar, stretched=.true.)
    call depart(middle, 1)
    call test%near(step_to(middle, 1), 0.0_wp, 0.0_wp, 'nothing has changed where it stays')
    call test%is_true(step_to(middle + 1.0e-3_wp, 1) < 0.1_wp, 'a short step is trusted')
    ! the Jacobian is singular at the limit, to the round-off of the angle there: the root of that of the crank
    call test%is_true(step_to(limit, 1) > 1.0_wp, 'none that ends at a dead point')
    call depart(limit - 1.0e-4_wp, 1)
    call test%is_true(step_to(limit - 1.0e-4_wp, -1) > 1.0_wp, 'nor one to the other branch, however near it is')
    call test%is_true(monitors(1)%trial_sign == -monitors(1)%sign, 'whose determinant has the other sign')
  end subroutine watch_changes

  !> The sign alone is enough to refuse a step, were the change of the Jacobian ever so small.
  subroutine watch_signs()
    call depart(middle, 1)
    monitors(1)%sign = -monitors(1)%sign
    call test%is_true(step_to(middle, 1) > 1.0_wp, 'a sign that changed is not passed over')
  end subroutine watch_signs
end program test_singularity_monitor
