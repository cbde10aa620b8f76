!> A position step, with velocities, accelerations and its row of results, allocates nothing.
module test_no_allocation
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_columns, only: columns_type, kinematic_columns
  use mech9_point, only: point_type
  use mech9_sample_mechanisms, only: drive, fig1, general_loop
  use mech9_testing, only: tester_type
  use mech9_counted_memory, only: calls
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('planar_chains')) call planar_chains(test)
    if (test%runs('chains_together')) call chains_together(test)
    if (test%runs('spatial_chain')) call spatial_chain(test)
  end subroutine run

  subroutine planar_chains(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call fig1(5, model)
    call drive(model, 5, [0.5_wp, 6.0_wp])
    call count_calls(test, model, 'planar chains')
  end subroutine planar_chains

  subroutine chains_together(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call fig1(1, model)
    call drive(model, 1, [-1.0_wp, 0.1_wp])
    call count_calls(test, model, 'chains solved together')
  end subroutine chains_together

  subroutine spatial_chain(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call general_loop(model)
    call drive(model, 1, [0.0_wp, 0.1_wp])
    call count_calls(test, model, 'a spatial chain')
  end subroutine spatial_chain

  subroutine count_calls(test, model, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the mechanism
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    type(plan_type) :: plan
    type(state_type) :: state
    type(driven_motion_type) :: driven
    type(columns_type) :: columns
    type(error_type), allocatable :: err
    real(wp) :: row(100)
    integer :: i, before

    deallocate (model%mechanism%points)
    allocate (model%mechanism%points(1))
    model%mechanism%points(1) = point_type('P', 3, [0.1_wp, 0.2_wp, 0.0_wp])
    columns = kinematic_columns(model%mechanism, model%request%output)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, name//': there is a plan')
    call start_driven_motion(model%problem%drives, plan, state, 0.0_wp, driven, err)
    call test%no_error(err, name//': the motion starts')
    before = calls
    call test%is_true(before > 0, 'the counter of allocations counts')
    do i = 1, 100
      call advance(model%problem%drives, plan, driven, 0.002_wp*i, err)
      if (allocated(err)) exit
      call columns%fill(model%mechanism, plan, driven%state, row)
    end do
    call test%is_true(calls == before, name//': a hundred positions allocate nothing')
    call test%no_error(err, name//': the motion goes on')
  end subroutine count_calls
end module test_no_allocation
