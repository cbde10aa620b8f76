!> Documents and models from texts in the form of data files, which must be right.
module mech9_text_models
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_checker, only: check_document
  use mech9_reader, only: read_model
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_model, only: model_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: document_from_text, checked_from_text, model_from_text, varied_from_text

contains

  !> The groups of a text.
  subroutine document_from_text(tester, text, document)
    type(tester_type), intent(inout) :: tester      !< counts the checks
    character(len=*), intent(in) :: text            !< of a data file
    type(document_type), intent(out) :: document    !< its groups
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call judge(tester, text, diagnostics)
  end subroutine document_from_text

  !> The groups of a text, held against the grammar.
  subroutine checked_from_text(tester, text, document, diagnostics)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    character(len=*), intent(in) :: text                  !< of a data file
    type(document_type), intent(out) :: document          !< its groups
    type(diagnostics_type), intent(out) :: diagnostics    !< without errors, with the text

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call check_document(document, diagnostics)
    call judge(tester, text, diagnostics)
  end subroutine checked_from_text

  !> The model that a text describes.
  subroutine model_from_text(tester, text, program, model)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of a data file
    integer, intent(in) :: program               !< kinematics or dynamics
    type(model_type), intent(out) :: model       !< the model
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call read_model(document, program, model, diagnostics)
    call judge(tester, text, diagnostics)
  end subroutine model_from_text

  !> The model that a text describes, as a function of its parameters.
  subroutine varied_from_text(tester, text, program, varied, model)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: text                 !< of a data file
    integer, intent(in) :: program                       !< kinematics or dynamics
    type(varied_document_type), intent(out) :: varied    !< the model as a function of its parameters
    type(model_type), intent(out) :: model               !< the model of the values in the text
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call read_model(document, program, model, diagnostics)
    call judge(tester, text, diagnostics)
    call new_varied_document(document, diagnostics%sources, program, varied)
  end subroutine varied_from_text

  !> Check that nothing is wrong with a text, and print the errors where something is.
  subroutine judge(tester, text, diagnostics)
    type(tester_type), intent(inout) :: tester          !< counts the checks
    character(len=*), intent(in) :: text                !< of the data file
    type(diagnostics_type), intent(in) :: diagnostics   !< of the text

    call tester%is_true(.not. diagnostics%failed(), 'the text of a mechanism is right: '//text(:min(len(text), 60)))
    if (diagnostics%failed()) call diagnostics%report(6)
  end subroutine judge
end module mech9_text_models
