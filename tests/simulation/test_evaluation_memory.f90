!> The dynamics of closed chains allocates no memory in an evaluation of the rates of change, and none when it closes the chains
!> after a step.
module test_evaluation_memory
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_loaded_mechanisms, only: loaded_fig1, five_bar, loaded_loop, two_loops
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
    if (test%runs('five_bars')) call five_bars(test)
    if (test%runs('spatial_chains')) call spatial_chains(test)
  end subroutine run

  subroutine planar_chains(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), target :: model

    call loaded_fig1(5, model)
    call count_calls(test, model, 2, 'planar chains, one after the other')
    call loaded_fig1(1, model)
    call count_calls(test, model, 1, 'planar chains that are solved together')
  end subroutine planar_chains

  subroutine five_bars(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), target :: model

    call five_bar(model)
    call count_calls(test, model, 1, 'a planar chain of two degrees of freedom')
  end subroutine five_bars

  subroutine spatial_chains(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), target :: model

    call loaded_loop(model)
    call count_calls(test, model, 1, 'a spatial chain')
    call two_loops([1, 5], model)
    call count_calls(test, model, 2, 'spatial chains, one after the other, and an open branch')
    call two_loops([1, 9], model)
    call count_calls(test, model, 1, 'spatial chains that are solved together')
  end subroutine spatial_chains

  !> Small steps by Euler's method, as good as any here, each with two evaluations and the closing of the chains.
  subroutine count_calls(test, model, blocks, why)
    type(tester_type), intent(inout) :: test        !< counts the checks
    type(model_type), intent(in), target :: model   !< with closed chains, bodies and loads of all kinds
    integer, intent(in) :: blocks                   !< number of its blocks with closed chains
    character(len=*), intent(in) :: why             !< its name, printed where a check fails
    type(motion_system_type) :: system
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: y(:), ydot(:)
    integer :: i, before

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    call test%is_true(count(plan%blocks%last_closure >= plan%blocks%first_closure) == blocks, why//': the chains are blocks')
    state%dq(plan%independent) = [(0.5_wp*cos(2.0_wp*i), i=1, size(plan%independent))]
    system%plan = plan
    system%state = state
    call set_motion_system(model, model%problem%partition, system, err)
    call test%no_error(err, why//': there is a system')
    if (allocated(err)) return
    y = system%vector()
    allocate (ydot, source=y)
    ! room for the two evaluations from which rates are extrapolated is made where they are first kept, after the first steps
    do i = -2, 0
      call step_on(system, 1.0e-3_wp*i, y, ydot, err)
      call test%no_error(err, why//': the first steps succeed')
    end do
    before = calls
    call test%is_true(before > 0, 'the counter of allocations counts')
    do i = 1, 10
      call step_on(system, 1.0e-3_wp*i, y, ydot, err)
      if (allocated(err)) exit
    end do
    call test%is_true(calls == before, why//': ten steps of evaluations and closing allocate nothing')
    call test%no_error(err, why//': the steps succeed')
  end subroutine count_calls

  !> One step of a thousandth of a second to time t.
  subroutine step_on(system, t, y, ydot, err)
    type(motion_system_type), intent(inout) :: system   !< gives the rates
    real(wp), intent(in) :: t                           !< time at the end of the step [s]
    real(wp), intent(inout) :: y(:)                     !< the vector, at the start of the step in, at its end out
    real(wp), intent(inout) :: ydot(:)                  !< scratch
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i

    call system%rate(t - 1.0e-3_wp, y, ydot, err)
    if (allocated(err)) return
    do i = 1, size(y)
      y(i) = y(i) + 1.0e-3_wp*ydot(i)
    end do
    call system%rate(t, y, ydot, err)
    if (allocated(err)) return
    call system%project(t, y, err)
    if (allocated(err)) return
    call system%present(err)
  end subroutine step_on
end module test_evaluation_memory
