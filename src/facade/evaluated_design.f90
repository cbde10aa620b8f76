!> One evaluation of a design: the quantities of its run, and their derivatives by the parameters.
module mech9_evaluated_design
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_explanation, only: explain
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_design_run, only: run_design, find_design_gradient, find_quantities
  use mech9_data_file, only: data_file_type
  implicit none
  private
  public :: check_quantities, evaluate_design

contains

  !> Fail where the runs of a data file do not have its quantities.
  subroutine check_quantities(given, err)
    class(data_file_type), intent(in) :: given            !< the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if a column is missing
    class(quantity_record_type), allocatable :: columns

    allocate (columns)
    call find_quantities(given%model, columns, err)
  end subroutine check_quantities

  !> Make the run of a design. Fails as the run does; the numbers are then of no use.
  subroutine evaluate_design(given, values, with_gradient, interruption, numbers, gradient, err)
    class(data_file_type), intent(inout), target :: given           !< the data file, with its variable model
    real(wp), intent(in) :: values(:)                               !< (parameters) in the units of the file
    logical, intent(in) :: with_gradient                            !< derivatives are taken
    class(interruption_type), intent(inout), target :: interruption !< is asked whether the run shall stop
    real(wp), intent(out) :: numbers(:)                             !< (quantities)
    real(wp), intent(out) :: gradient(:, :)                         !< (parameters,quantities); zero where none is taken
    type(error_type), allocatable, intent(out) :: err               !< allocated if the run failed
    class(model_type), allocatable, target :: model

    numbers = 0.0_wp
    gradient = 0.0_wp
    allocate (model)
    call given%variable%at(values, model, err)
    if (with_gradient .and. .not. allocated(err)) then
      call find_design_gradient(model, given%variable, numbers, gradient, err, interruption)
    else if (.not. allocated(err)) then
      call run_design(model, numbers, err, interruption=interruption)
    end if
    if (allocated(err)) call explain(err)
  end subroutine evaluate_design
end module mech9_evaluated_design
