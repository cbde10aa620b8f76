!> Assembly of a mechanism at the start of a motion, with an error that explains oddities of its geometry where it fails.
module mech9_explained_assembly
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_start_path, only: start_way_type
  use mech9_driven_simulation, only: assemble_driven
  use mech9_free_start, only: assemble_free
  use mech9_geometry_words, only: explain_geometry
  implicit none
  private
  public :: assemble_model

contains

  !> Plan and closed position at the start of a model's motion; where coordinates are free, with the rates of the independent ones.
  subroutine assemble_model(model, plan, state, err, way)
    type(model_type), intent(in) :: model              !< the model
    type(plan_type), intent(out) :: plan               !< the plan of the mechanism
    type(state_type), intent(out) :: state             !< the closed position
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(start_way_type), intent(out), optional :: way !< how the start was reached from the drawn position

    if (model%is_driven()) then
      call assemble_driven(model, plan, state, err, way)
    else
      call assemble_free(model, plan, state, err, way)
    end if
    call explain_geometry(model%mechanism, err)
  end subroutine assemble_model
end module mech9_explained_assembly
