!> The coefficients of the equations of motion in a given position.
module mech9_motion_coefficients
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_equations
  implicit none
  private
  public :: find_coefficients

contains

  !> The coefficients of motion in a position.
  subroutine find_coefficients(mechanism, plan, assembled, coefficients, err)
    type(mechanism_type), intent(in) :: mechanism            !< the mechanism
    type(plan_type), intent(in) :: plan                      !< its plan
    type(state_type), intent(in) :: assembled                !< the position, with rates
    real(wp), allocatable, intent(out) :: coefficients(:, :) !< a_pr, lower triangle [kg m^2, kg m, kg]
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(state_type) :: state

    call make_dynamics_plan(mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    state = assembled
    call find_equations(mechanism, plan, dynamics, state, work, err)
    if (.not. allocated(err)) coefficients = work%coefficients
  end subroutine find_coefficients
end module mech9_motion_coefficients
