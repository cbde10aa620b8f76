!> The derivatives of required forces that go inward over a mechanism as rows, against the linearised equations of motion, which
!> vary the whole motion outward.
module test_force_gradient
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_motion, complete_accelerations
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces, find_matrix, &
    by_position, by_rate, by_acceleration
  use mech9_varied_motion, only: varied_motion_type
  use mech9_force_gradient, only: force_gradient_type, new_force_gradient, find_force_gradient
  use mech9_loaded_mechanisms, only: check_each_mechanism
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Both ways solve with the factors of chains whose conditioning is some tenths, a dozen sums after one another.
  real(wp), parameter :: round_off = 1.0e-11_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    call check_each_mechanism(test, compare)
  end subroutine run

  !> Compare both ways in a motion with random rates.
  subroutine compare(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the model
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(state_type) :: state
    type(force_gradient_type) :: gradient
    type(varied_motion_type) :: motion
    type(error_type), allocatable :: err
    type(random_type) :: random
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    do i = 1, size(plan%independent)
      state%dq(plan%independent(i)) = random%symmetric()
    end do
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    call find_motion(model%mechanism, plan, dynamics, state, work, err)
    call test%no_error(err, why//': the motion is found')
    if (allocated(err)) return
    call complete_accelerations(plan, dynamics, work, state)
    allocate (motion%tangents(0))
    motion%plan = plan
    call new_force_gradient(model, plan, dynamics, motion%tangents, gradient)
    call find_force_gradient(model, state, motion, work, gradient, err)
    call test%no_error(err, why//': the derivatives are found')
    call compare_matrix(test, model, state, plan%free, by_position, gradient%by_position, why//': by coordinates')
    call compare_matrix(test, model, state, plan%free, by_rate, gradient%by_rate, why//': by rates')
    call compare_matrix(test, model, state, plan%free, by_acceleration, gradient%by_acceleration, why//': by accelerations')
  end subroutine compare

  !> Compare one matrix with that of the linearised equations in space.
  subroutine compare_matrix(test, model, motion, free, by, found, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    type(state_type), intent(in) :: motion     !< its motion
    integer, intent(in) :: free(:)             !< the free coordinates
    integer, intent(in) :: by                  !< by_position, by_rate or by_acceleration
    real(wp), intent(in) :: found(:, :)        !< the derivatives
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(plan_type) :: plan
    type(state_type) :: state
    type(linearisation_type) :: linearisation
    type(error_type), allocatable :: err
    real(wp) :: expected(size(free), size(free)), magnitude
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, motion%q, plan, state, err, planning_settings_type(in_space=.true.))
    call test%no_error(err, why//': there is a plan in space')
    if (allocated(err)) return
    state%dq(free) = motion%dq(free)
    state%ddq(free) = motion%ddq(free)
    call new_linearisation(model%mechanism, plan, linearisation)
    call find_forces(model%mechanism, plan, state, linearisation, err)
    if (.not. allocated(err)) call find_matrix(model%mechanism, plan, state, by, free, linearisation, expected, magnitude, err)
    call test%no_error(err, why//': the equations are linearised')
    do i = 1, size(free)
      expected(:, i) = expected(:, i)/(plan%unit_of(free)*plan%unit_of(free(i)))
    end do
    call test%near(maxval(abs(found - expected)), 0.0_wp, round_off*max(maxval(abs(expected)), magnitude), why)
  end subroutine compare_matrix
end module test_force_gradient
