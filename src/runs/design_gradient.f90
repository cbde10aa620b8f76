!> The quantities of one run with their derivatives by all parameters, without any files.
module mech9_design_gradient
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: interruption_type
  use mech9_model_motion, only: model_motion_type
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
    type(model_motion_type), target :: motion
    type(row_source_type) :: source

    if (present(interruption)) call interruption%begin_run()
    model%request%output%gradients = .true.
    call motion%assemble(model, err)
    if (.not. allocated(err)) call motion%prepare(model, err, pictures=.not. model%is_driven())
    if (.not. allocated(err)) call take_gradient(variable, source, motion, model, err, interruption)
    if (.not. allocated(err)) then
      numbers = source%quantities%numbers
      gradient = source%quantities%gradient
    end if
    call motion%close()
  end subroutine find_design_gradient

  !> Go through all outputs of a motion with its derivatives.
  subroutine take_gradient(variable, source, motion, model, err, interruption)
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(row_source_type), intent(inout) :: source                  !< rows of the run, with its quantities; made anew
    type(model_motion_type), intent(inout), target :: motion        !< prepared
    type(model_type), intent(inout) :: model                        !< its model; gets the tolerances where an accuracy is requested
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop

    call new_row_source(motion%simulation, source)
    call source%add_sensitivities(variable, err)
    if (.not. allocated(err)) call source%begin_quantities(err)
    if (.not. allocated(err)) call motion%find_tolerances(model, err, interruption=interruption)
    if (allocated(err)) return
    if (present(interruption)) source%interruption => interruption
    call source%go_through(err)
    source%interruption => null()
    if (allocated(err)) return
    call source%quantities%finish()
  end subroutine take_gradient
end module mech9_design_gradient
