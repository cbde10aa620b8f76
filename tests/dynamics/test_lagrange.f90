!> Coefficients of motion, velocity terms and generalized forces against (21), (19) and (25) taken
!> literally, on open, planar, spatial and multi-chain mechanisms with all kinds of loads.
module test_lagrange
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_equations
  use mech9_energy, only: kinetic_energy
  use mech9_literal_lagrange, only: literal_type, literal_equations
  use mech9_loaded_mechanisms, only: check_each_mechanism
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

  !> Differences of closed positions lose 2/h = 128 units of round-off, those of their differences the
  !> square of that, 16,000 units, both times the conditioning of the chains, some hundreds: 1e-11 and
  !> 1e-9 of the largest number are left.
  subroutine compare(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the model
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(plan_type) :: plan
    type(state_type) :: state
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(literal_type) :: literal
    type(error_type), allocatable :: err
    integer :: i, n

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    n = size(plan%independent)
    state%dq(plan%independent) = [(1.3_wp - 0.7_wp*i, i=1, n)]
    call find_equations(model%mechanism, plan, dynamics, state, work, err)
    call test%no_error(err, why//': the equations are found')
    call literal_equations(model, plan, state, literal, err)
    call test%no_error(err, why//': the literal equations are found')
    if (allocated(err)) return
    do i = 1, n
      call check_numbers(test, work%coefficients(i:, i), literal%coefficients(i:, i), &
                         maxval(abs(literal%coefficients)), 1.0e-11_wp, why//': the coefficients are those of (21)')
    end do
    call check_numbers(test, work%velocity_terms, literal%velocity_terms, maxval(abs(literal%velocity_terms)), &
                       1.0e-9_wp, why//': the velocity terms are those of (19)')
    call check_numbers(test, work%forces, literal%forces, maxval(abs(literal%forces)), 1.0e-11_wp, &
                       why//': the generalized forces are those of (25)')
    call test%near(kinetic_energy(model%mechanism, plan, state), &
                   0.5_wp*dot_product(state%dq(plan%independent), &
                                      matmul(literal%coefficients, state%dq(plan%independent))), &
                   1.0e-11_wp, why//': the kinetic energy is that of (20)')
  end subroutine compare

  !> Agreement against the largest number of its kind.
  subroutine check_numbers(test, numbers, expected, scale, tolerance, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: numbers(:)         !< numbers that are checked
    real(wp), intent(in) :: expected(:)        !< the right numbers, as many
    real(wp), intent(in) :: scale              !< the largest number of their kind
    real(wp), intent(in) :: tolerance          !< over the scale
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong

    call test%is_true(scale > 1.0e-3_wp, why//': there is something to compare')
    call test%near(maxval(abs(numbers - expected))/scale, 0.0_wp, tolerance, why)
  end subroutine check_numbers
end module test_lagrange
