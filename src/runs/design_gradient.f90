!> The quantities of one run with their derivatives by all parameters, without any files.
module mech9_design_gradient
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: simulation_type, interruption_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  use mech9_accuracy, only: find_accuracy
  use mech9_explained_assembly, only: assemble_driven_start, assemble_free_start
  use mech9_row_source, only: row_source_type, new_row_source
  implicit none
  private
  public :: find_design_gradient

contains

  !> Make the motion of a model and take its quantities and their derivatives. Fails as a run with derivatives would.
  subroutine find_design_gradient(model, variable, numbers, gradient, err, interruption)
    type(model_type), intent(inout), target :: model        !< with quantities; gets the tolerances where an accuracy is requested
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    real(wp), intent(out) :: numbers(:)                     !< (quantities)
    real(wp), intent(out) :: gradient(:, :)                 !< (parameters,quantities); NaN where a number has no derivative
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop
    type(driven_simulation_type), target :: driven
    type(free_simulation_type), target :: free
    type(plan_type) :: plan
    type(state_type) :: start

    if (present(interruption)) call interruption%begin_run()
    model%request%output%gradients = .true.
    if (model%is_driven()) then
      call assemble_driven_start(model, plan, start, err)
      if (allocated(err)) return
      call new_driven_simulation(model, plan, start, driven, .false., model%program == dynamics)
      call take_gradient(model, plan, start, variable, driven, numbers, gradient, err, interruption)
    else
      call assemble_free_start(model, plan, start, err)
      if (.not. allocated(err)) call new_free_simulation(model, plan, start, free, err, .true.)
      if (.not. allocated(err)) call take_gradient(model, plan, start, variable, free, numbers, gradient, err, interruption)
      call free%close()
    end if
  end subroutine find_design_gradient

  !> Go through all outputs of a simulation with its derivatives.
  subroutine take_gradient(model, plan, start, variable, simulation, numbers, gradient, err, interruption)
    type(model_type), intent(inout), target :: model                !< the model; gets the tolerances where an accuracy is requested
    type(plan_type), intent(in) :: plan                             !< its plan
    type(state_type), intent(in) :: start                           !< its assembled position
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    class(simulation_type), intent(inout), target :: simulation     !< about to start
    real(wp), intent(out) :: numbers(:)                             !< (quantities)
    real(wp), intent(out) :: gradient(:, :)                         !< (parameters,quantities); NaN where a number has no derivative
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop
    type(row_source_type) :: source

    call new_row_source(simulation, source)
    call source%add_sensitivities(variable, err)
    if (.not. allocated(err)) call source%begin_quantities(err)
    if (allocated(err)) return
    select type (simulation)
    type is (free_simulation_type)
      if (simulation%with_error) &
        call find_accuracy(model, plan, start, simulation%errors, err, interruption=interruption)
      if (allocated(err)) return
    end select
    if (present(interruption)) source%interruption => interruption
    call source%go_through(err)
    source%interruption => null()
    if (allocated(err)) return
    call source%quantities%finish()
    numbers = source%quantities%numbers
    gradient = source%quantities%gradient
  end subroutine take_gradient
end module mech9_design_gradient
