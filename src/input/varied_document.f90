!> The model of a data file as a function of its parameters: the file is read and checked once, and its numbers change in memory.
module mech9_varied_document
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise
  use mech9_source, only: source_type, span_type
  use mech9_document, only: document_type
  use mech9_checker, only: check_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parameter, only: parameter_type
  use mech9_parameter_reader, only: read_parameters, place_parameters
  use mech9_reader, only: read_checked
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  implicit none
  private
  public :: varied_document_type, new_varied_document

  type, extends(variable_model_type) :: varied_document_type
    private
    type(document_type) :: document                       !< checked, with an item for each target
    type(source_type), allocatable :: sources(:)          !< the texts that it comes from
    type(parameter_type), allocatable :: parameters(:)
    logical :: needs_drives = .false.                     !< every independent coordinate must be driven
  contains
    procedure :: at
  end type varied_document_type

contains

  !> Prepare a document that has been read without errors.
  pure subroutine new_varied_document(document, sources, needs_drives, varied)
    type(document_type), intent(in) :: document           !< the data file as groups and items, with the changes by --set
    type(source_type), intent(in) :: sources(:)           !< the texts that it comes from, for messages: those of its diagnostics
    logical, intent(in) :: needs_drives                   !< every independent coordinate must be driven
    type(varied_document_type), intent(out) :: varied     !< the model as a function of the parameters
    type(diagnostics_type) :: diagnostics

    varied%document = document
    varied%sources = sources
    varied%needs_drives = needs_drives
    diagnostics%sources = sources
    call check_document(varied%document, diagnostics)
    call read_parameters(varied%document, varied%parameters, diagnostics)
  end subroutine new_varied_document

  !> The model with other values of its parameters. Fails with the first error that a data file with these numbers would have.
  subroutine at(self, values, model, err)
    class(varied_document_type), intent(inout) :: self   !< the model as a function; it keeps these values
    real(wp), intent(in) :: values(:)                    !< of all parameters, in their order, in the units of the data file
    type(model_type), intent(out) :: model               !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(diagnostics_type) :: diagnostics
    character(len=:), allocatable :: text
    type(span_type) :: span

    diagnostics%sources = self%sources
    self%parameters%value = values
    call place_parameters(self%document, self%parameters, diagnostics)
    model%parameters = self%parameters
    call read_checked(self%document, self%needs_drives, model, diagnostics)
    if (.not. diagnostics%failed()) return
    call diagnostics%get(1, text, span)
    call raise(err, diagnostics%code(), text, diagnostics%place(span))
  end subroutine at
end module mech9_varied_document
