!> One run of a study: the quantities of a motion, and its columns where they are wanted, without any files.
module mech9_design_run
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: simulation_type, interruption_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  use mech9_accuracy, only: find_accuracy
  use mech9_explained_assembly, only: assemble_driven_start, assemble_free_start
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
    type(driven_simulation_type), target :: driven
    type(free_simulation_type), target :: free
    type(plan_type) :: plan
    type(state_type) :: start

    if (present(interruption)) call interruption%begin_run()
    if (model%is_driven()) then
      call assemble_driven_start(model, plan, start, err)
      if (allocated(err)) return
      call new_driven_simulation(model, plan, start, driven, .false., model%program == dynamics)
      call take_quantities(model, driven, source, numbers, err, rows, interruption)
    else
      call assemble_free_start(model, plan, start, err)
      if (.not. allocated(err)) call new_free_simulation(model, plan, start, free, err)
      if (.not. allocated(err) .and. free%with_error) &
        call find_accuracy(model, plan, start, free%errors, err, interruption=interruption)
      if (.not. allocated(err)) call take_quantities(model, free, source, numbers, err, rows, interruption)
      call free%close()
    end if
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
  subroutine take_quantities(model, simulation, source, numbers, err, rows, interruption)
    type(model_type), intent(in) :: model                          !< the model
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
