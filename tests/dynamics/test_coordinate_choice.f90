!> Other independent coordinates: which failures mean that they cannot serve, and which are something else.
module test_coordinate_choice
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data, exit_singular
  use mech9_partition, only: partition_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_requested, only: requested_by_results
  use mech9_replanning, only: replanning_type, wanted_type
  use mech9_coordinate_choice, only: carry_over
  use mech9_curved_pair, only: curved_pair_type
  use mech9_sample_mechanisms, only: four_bar
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('another_serves')) call choose(test, [.false., .true., .false., .false.], .false., 0, 'another coordinate serves')
    if (test%runs('two_cannot_serve')) &
      call choose(test, [.true., .true., .false., .false.], .false., exit_singular, 'two of one degree of freedom cannot serve')
    if (test%runs('broken_pair')) &
      call choose(test, [.false., .true., .false., .false.], .true., exit_data, 'a pair without a value is no matter of the choice')
  end subroutine run

  !> A crank and a rocker.
  subroutine new_four_bar(model)
    type(model_type), intent(out) :: model   !< the model

    call four_bar(0.4_wp, 0.15_wp, 0.35_wp, 0.3_wp, [0.0_wp, 1.0_wp, 1.0_wp, 1.7_wp], model)
  end subroutine new_four_bar

  !> Take other independent coordinates at the start of the unbroken four-bar.
  subroutine choose(test, independent, broken, code, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    logical, intent(in) :: independent(:)      !< (M)
    logical, intent(in) :: broken              !< a pair has no value from then on
    integer, intent(in) :: code                !< of the failure; 0: none
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(model_type) :: whole
    type(partition_type) :: partition
    type(plan_type) :: plan
    type(state_type) :: state
    type(wanted_type) :: wanted
    type(replanning_type) :: carried
    type(error_type), allocatable :: err

    call new_four_bar(whole)
    call make_plan(whole%mechanism, whole%problem%partition, whole%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a four-bar has a plan')
    if (broken) call break_pair(plan)
    state%t = 7.0_wp
    state%dq = [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp]
    wanted%requested = requested_by_results(whole%mechanism, whole%request%output)
    call whole%problem%partition%with_independent(whole%mechanism%structure, independent, partition)
    call carry_over(whole%mechanism, partition, plan, state, wanted, carried, err)
    if (code == 0) then
      call test%no_error(err, why//': the coordinates are accepted')
      if (allocated(err)) return
      call test%is_true(all(carried%plan%independent == pack([1, 2, 3, 4], independent)), &
                        why//': the chosen coordinates are the independent ones')
      ! both positions are closed to round-off over a conditioning of 0.1
      call test%near(maxval(abs(carried%state%q - state%q)), 0.0_wp, 1.0e-13_wp, why//': the position stays')
      call test%is_true(all(abs([carried%state%t - state%t, carried%state%dq - state%dq]) <= 0.0_wp), &
                        why//': time and rates stay')
    else
      call test%has_error(err, code, why//': the coordinates are refused')
    end if
  end subroutine choose

  !> Put a pair in the place of the third one whose procedure has no value anywhere.
  subroutine break_pair(plan)
    type(plan_type), intent(inout) :: plan   !< the plan of the four-bar, in space from now on
    type(curved_pair_type) :: pair

    pair%broken = .true.
    pair%coordinate = 3
    pair%reference = 1
    pair%moving = 4
    allocate (plan%pairs(3)%pair, source=pair)
    plan%steps(plan%step_of(3))%is_screw = .false.
    plan%planar%used = .false.
  end subroutine break_pair
end module test_coordinate_choice
