!> The quantities of a driven motion with their derivatives by all parameters, without any results beside them.
module mech9_driven_quantities
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation
  use mech9_explained_assembly, only: assemble_driven_start
  use mech9_row_source, only: row_source_type, new_row_source
  implicit none
  private
  public :: find_driven_quantities

contains

  !> Make the driven motion of a model and take its quantities and their derivatives. Fails as a run with sensitivities would.
  subroutine find_driven_quantities(program_name, model, variable, numbers, gradient, err)
    character(len=*), intent(in) :: program_name            !< mech9k or mech9d; mech9d where all independent coordinates are driven
    type(model_type), intent(in), target :: model           !< the model, which requests quantities
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    real(wp), intent(out) :: numbers(:)                     !< (quantities)
    real(wp), intent(out) :: gradient(:, :)                 !< (parameters,quantities); NaN where a number has no derivative
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(driven_simulation_type), target :: simulation
    type(row_source_type) :: source
    type(plan_type) :: plan
    type(state_type) :: start
    real(wp), allocatable :: row(:)
    integer :: i

    call assemble_driven_start(model, plan, start, err)
    if (allocated(err)) return
    call new_driven_simulation(model, plan, start, simulation, .false., program_name == 'mech9d')
    call new_row_source(program_name, simulation, source)
    call source%add_sensitivities(variable, err)
    if (.not. allocated(err)) call source%begin_quantities(err)
    if (allocated(err)) return
    allocate (row(source%columns%width()))
    do i = 0, model%request%time%intervals
      call source%row_at(model%request%time%time(i), row, err)
      if (allocated(err)) return
    end do
    call source%quantities%finish()
    numbers = source%quantities%numbers
    gradient = source%quantities%gradient
  end subroutine find_driven_quantities
end module mech9_driven_quantities
