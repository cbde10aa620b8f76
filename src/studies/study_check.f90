!> Whether the study of a model can be made.
module mech9_study_check
  use mech9_error, only: error_type, raise, exit_usage, exit_data
  use mech9_model, only: model_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_design_run, only: find_quantities
  implicit none
  private
  public :: check_study

contains

  !> Find the columns of the quantities of a study. Fails with exit_usage where the model has no study, and with exit_data where
  !> its runs cannot record what is requested.
  subroutine check_study(model, quantities, err)
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(quantity_record_type), intent(out) :: quantities   !< with their columns
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed

    associate (output => model%request%output)
      if (model%request%study%kind == '') then
        call raise(err, exit_usage, '--study carries out the study of a group &study, and this file has none')
      else if (output%with_derivatives()) then
        call raise(err, exit_data, 'a study records no '//trim(merge('sensitivities', 'gradients    ', output%sensitivities))// &
                   ': leave out '//trim(merge('sensitivities', 'gradients    ', output%sensitivities))//' in &output', &
                   output%sensitivities_place)
      else
        call find_quantities(model, quantities, err)
      end if
    end associate
  end subroutine check_study
end module mech9_study_check
