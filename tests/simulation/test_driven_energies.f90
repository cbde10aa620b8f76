!> Energies of a driven motion are the same whether planar blocks are computed in their planes or in space.
!>
!> Compares the program with itself: planar and spatial arithmetic.
module test_driven_energies
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation
  use mech9_mixed_mechanisms, only: mixed_axes, mixed_mechanism
  use mech9_loaded_mechanisms, only: load_everything
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('mixed_mechanisms')) call mixed_mechanisms(test)
  end subroutine run

  !> Mechanisms of spatial and planar blocks at random.
  subroutine mixed_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(random_type) :: random
    real(wp) :: flat(2), space(2)
    integer :: trial

    do trial = 1, 6
      call mixed_mechanism(mixed_axes(modulo(trial, 2)*5, random), model)
      call load_everything(random, model)
      call find_energies(test, model, .false., flat)
      call find_energies(test, model, .true., space)
      ! at the start, where round-off has not grown through the blocks; rates are known to round-off over the conditioning
      call test%near(flat(1)/max(1.0_wp, space(1)), space(1)/max(1.0_wp, space(1)), 1.0e-8_wp, 'kinetic energy')
      call test%near(flat(2), space(2), 1.0e-10_wp, 'potential energy')
    end do
  end subroutine mixed_mechanisms

  !> The energies at the start of the driven motion.
  subroutine find_energies(test, model, in_space, energies)
    type(tester_type), intent(inout) :: test        !< counts the checks
    type(model_type), intent(in), target :: model   !< the model
    logical, intent(in) :: in_space                 !< in spatial arithmetic throughout
    real(wp), intent(out) :: energies(2)            !< kinetic and potential [J]
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_simulation_type) :: simulation
    type(error_type), allocatable :: err

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, start, err, &
                   planning_settings_type(in_space=in_space))
    call test%no_error(err, 'plan')
    call new_driven_simulation(model, plan, start, simulation)
    call simulation%start(err)
    call test%no_error(err, 'start')
    call simulation%energies(energies(1), energies(2))
  end subroutine find_energies
end module test_driven_energies
