!> The data file of the best design of a search.
module mech9_best_design
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_version, only: name_and_version
  use mech9_document, only: document_type
  use mech9_design_text, only: text_of_design
  use mech9_model, only: model_type
  use mech9_synthesis, only: synthesis_type
  implicit none
  private
  public :: text_of_best

contains

  !> Form the data file of the best design, which begins with comments on the search.
  subroutine text_of_best(document, model, synthesis, text)
    type(document_type), intent(in) :: document             !< the data file
    type(model_type), intent(in) :: model                   !< the model
    type(synthesis_type), intent(in) :: synthesis           !< with its optima, best first
    character(len=:), allocatable, intent(out) :: text      !< of the data file
    class(model_type), allocatable :: designed
    type(error_type), allocatable :: err
    character(len=:), allocatable :: history

    allocate (designed)
    call history_of_design(model, synthesis, history)
    ! there is such a model, because its motion was followed
    call synthesis%space%variable%at(synthesis%values_of(1), designed, err)
    call text_of_design(document, designed, synthesis%values_of(1), synthesis%optima(1)%q, history, text)
  end subroutine text_of_best

  !> Write comments that tell where a design comes from.
  subroutine history_of_design(model, synthesis, text)
    type(model_type), intent(in) :: model                    !< the model
    type(synthesis_type), intent(in) :: synthesis            !< with its optima, best first
    character(len=:), allocatable, intent(out) :: text       !< comments, as whole lines

    text = '! The best design that '//name_and_version(model%program)//' found by --optimize from '// &
           counted(synthesis%done, 'start')//', seed '//to_text(model%request%optimum%seed)//'.'//achar(10)// &
           '! Value: '//to_text(synthesis%optima(1)%value, 12)//', to which '//counted(synthesis%optima(1)%starts, 'start')// &
           ' led. The positions in &initial are those of its assembly.'//achar(10)
  end subroutine history_of_design
end module mech9_best_design
