!> Mechanisms from texts in the form of data files.
module mech9_text_models
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: model_from_text

contains

  !> The model that a text describes.
  subroutine model_from_text(tester, text, needs_drives, model)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of a data file
    logical, intent(in) :: needs_drives          !< all independent coordinates are driven, as in kinematics
    type(model_type), intent(out) :: model       !< the model
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call read_model(document, needs_drives, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'the text of a mechanism is read: '//text(:min(len(text), 60)))
  end subroutine model_from_text
end module mech9_text_models
