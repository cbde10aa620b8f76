!> A position step, with velocities, accelerations and its row of results, allocates nothing.
program test_no_allocation
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
  type(tester_type) :: test
  type(model_type) :: model

  call fig1(5, model)
  call drive(model, 5, [0.5_wp, 6.0_wp])
  call count_calls('planar chains')
  call fig1(1, model)
  call drive(model, 1, [-1.0_wp, 0.1_wp])
  call count_calls('chains solved together')
  call general_loop(model)
  call drive(model, 1, [0.0_wp, 0.1_wp])
  call count_calls('a spatial chain')
  call test%finish()

contains

  subroutine count_calls(name)
    character(len=*), intent(in) :: name   !< of the mechanism, for the report of a failure
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
end program test_no_allocation
