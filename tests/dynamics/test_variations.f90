!> The forces that a motion requires, and their derivatives by positions, rates and accelerations of the independent coordinates:
!> the forces against Lagrange's equations, the derivatives against differences of Lagrange's equations at closed positions.
module test_variations
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_equations
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces, find_matrix, &
    by_position, by_rate, by_acceleration
  use mech9_literal_lagrange, only: close_chains
  use mech9_loaded_mechanisms, only: check_each_mechanism, add_load
  use mech9_unknown_load, only: unknown_load_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    call check_each_mechanism(test, compare)
  end subroutine run

  !> Differences of sixteenth order over steps of 1/64 lose 2/h = 128 units of round-off times the conditioning of the chains,
  !> some hundreds, and the velocity terms that they differentiate as much again: 1e-9 of the largest number is left.
  subroutine compare(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the model; gets a load whose formula is not known
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(plan_type) :: plan
    type(state_type) :: state, moved
    type(linearisation_type) :: linearisation
    type(error_type), allocatable :: err
    type(random_type) :: random
    real(wp), allocatable :: matrix(:, :), expected(:, :), forces(:)
    real(wp) :: magnitude
    integer :: i, by, n

    call add_load(model, unknown_load_type(links=[2, model%mechanism%structure%n_links]))
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    n = size(plan%independent)
    do i = 1, n
      state%dq(plan%independent(i)) = random%symmetric()
      state%ddq(plan%independent(i)) = random%symmetric()
    end do
    call new_linearisation(model%mechanism, plan, linearisation)
    moved = state
    call find_forces(model%mechanism, plan, moved, linearisation, err)
    call test%no_error(err, why//': the forces are found')
    allocate (matrix(n, n), expected(n, n), forces(n))
    forces = linearisation%forces(plan%independent)
    call test%near(maxval(abs(forces - lagrange(model, plan, state)))/maxval(abs(forces)), 0.0_wp, 1.0e-11_wp, &
                   why//': the forces are those of Lagrange''s equations')
    do by = by_position, by_acceleration
      call find_matrix(model%mechanism, plan, moved, by, plan%independent, linearisation, matrix, magnitude, err)
      call test%no_error(err, why//': the derivatives are found')
      call differences(test, model, plan, state, by, expected)
      call test%is_true(maxval(abs(expected)) > 1.0e-3_wp, why//': there is something to compare')
      call test%is_true(magnitude > 0.1_wp*maxval(abs(expected)), why//': the magnitude of the terms is no less than their sum')
      call test%near(maxval(abs(matrix - expected))/maxval(abs(expected)), 0.0_wp, 1.0e-9_wp, &
                     why//': the derivatives of order '//achar(48 + by)//' are those of Lagrange''s equations')
    end do
  end subroutine compare

  !> a ddq + h - Q of Lagrange's equations.
  function lagrange(model, plan, state) result(forces)
    type(model_type), intent(in) :: model   !< the model
    type(plan_type), intent(in) :: plan     !< its plan
    type(state_type), intent(in) :: state   !< closed, with independent rates and accelerations
    real(wp) :: forces(size(plan%independent))
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(state_type) :: used
    type(error_type), allocatable :: err
    real(wp) :: a(size(forces), size(forces))
    integer :: i

    used = state
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    call find_equations(model%mechanism, plan, dynamics, used, work, err)
    do i = 1, size(forces)
      a(i:, i) = work%coefficients(i:, i)
      a(i, i:) = work%coefficients(i:, i)
    end do
    forces = matmul(a, state%ddq(plan%independent)) + work%velocity_terms - work%forces
  end function lagrange

  !> Derivatives of these forces by differences, in the units of the plan.
  subroutine differences(test, model, plan, state, by, matrix)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    type(plan_type), intent(in) :: plan        !< its plan
    type(state_type), intent(in) :: state      !< closed, with independent rates and accelerations
    integer, intent(in) :: by                  !< order of the derivative in time that is the parameter
    real(wp), intent(out) :: matrix(:, :)      !< a column for each independent coordinate
    real(wp), parameter :: h = 1.0_wp/64.0_wp
    type(state_type) :: moved
    type(error_type), allocatable :: err
    real(wp) :: values(size(matrix, 1), -half_width:half_width), second, error
    integer :: i, j, k

    do j = 1, size(matrix, 2)
      k = plan%independent(j)
      do i = -half_width, half_width
        moved = state
        select case (by)
        case (by_position)
          moved%q(k) = moved%q(k) + i*h*plan%unit_of(k)
        case (by_rate)
          moved%dq(k) = moved%dq(k) + i*h*plan%unit_of(k)
        case default
          moved%ddq(k) = moved%ddq(k) + i*h*plan%unit_of(k)
        end select
        call close_chains(plan, moved, err)
        call test%no_error(err, 'the displaced position closes')
        values(:, i) = lagrange(model, plan, moved)*plan%unit_of(plan%independent)
      end do
      do i = 1, size(matrix, 1)
        call derivatives_from_stencil(values(i, :), h, matrix(i, j), second, error)
      end do
    end do
  end subroutine differences
end module test_variations
