!> One run of a study: the quantities of a motion, and its columns where they are wanted, without any files.
module mech9_design_run
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_simulation, only: simulation_type, interruption_type
  use mech9_model_motion, only: model_motion_type
  use mech9_row_source, only: row_source_type, new_row_source, find_columns
  use mech9_columns, only: columns_type
  use mech9_force_record, only: force_record_type
  use mech9_quantity_record, only: quantity_record_type
  implicit none
  private
  public :: run_design, find_quantities, columns_of_runs

contains

  !> Make the motion of a model and take its quantities. Fails as a run would; the quantities are then of no use, and rows have
  !> their numbers up to the failure.
  subroutine run_design(model, source, numbers, err, rows, interruption)
    type(model_type), intent(inout), target :: model      !< gets the tolerances where an accuracy is requested
    type(row_source_type), intent(inout) :: source        !< rows of the run; made anew
    real(wp), intent(out) :: numbers(:)                   !< (quantities)
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp), intent(inout), optional :: rows(:, :)       !< (columns,outputs) gets the columns of all outputs that are reached
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop
    type(model_motion_type), target :: motion

    if (present(interruption)) call interruption%begin_run()
    call motion%assemble(model, err)
    if (.not. allocated(err)) call motion%prepare(model, err)
    if (.not. allocated(err)) call motion%find_tolerances(model, err, interruption=interruption)
    if (.not. allocated(err)) call take_quantities(motion%simulation, source, numbers, err, rows, interruption)
    call motion%close()
  end subroutine run_design

  !> Find the columns of the quantities that the runs of a model will have. Fails with exit_data where one is not recorded.
  subroutine find_quantities(model, quantities, err)
    type(model_type), intent(in) :: model                   !< the model
    type(quantity_record_type), intent(out) :: quantities   !< with their columns
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(columns_type) :: columns

    call columns_of_runs(model, columns)
    call quantities%begin(model, columns, err)
  end subroutine find_quantities

  !> Find the columns that the runs of a model will have.
  subroutine columns_of_runs(model, columns)
    type(model_type), intent(in) :: model                   !< the model
    type(columns_type), intent(out) :: columns              !< of each run
    type(force_record_type) :: forces

    call find_columns(model, model%program == dynamics .and. model%request%output%energies, &
                      model%request%solver%accuracy > 0.0_wp .and. .not. model%is_driven(), columns, forces)
  end subroutine columns_of_runs

  !> Go through all outputs of a simulation.
  subroutine take_quantities(simulation, source, numbers, err, rows, interruption)
    class(simulation_type), intent(inout), target :: simulation    !< about to start
    type(row_source_type), intent(inout) :: source                 !< rows of the run; made anew
    real(wp), intent(out) :: numbers(:)                            !< (quantities)
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    real(wp), intent(inout), optional :: rows(:, :)                !< (columns,outputs) gets the columns of all outputs
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop

    call new_row_source(simulation, source)
    if (present(interruption)) source%interruption => interruption
    call source%begin_quantities(err)
    if (allocated(err)) return
    call source%go_through(err, rows)
    source%interruption => null()
    if (allocated(err)) return
    if (size(numbers) == 0) return
    call source%quantities%finish()
    numbers = source%quantities%numbers
  end subroutine take_quantities
end module mech9_design_run
