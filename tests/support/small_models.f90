!> Documents and models from the text of data files, and a small mechanism whose motion is known: a slider-crank.
module mech9_small_models
  use mech9_kinds, only: wp
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: document_of, model_of, slider_crank, crank, rod, eol

  character, parameter :: eol = achar(10)
  real(wp), parameter :: crank = 0.3_wp, rod = 1.0_wp   !< lengths of the slider-crank [m]

  !> The slider-crank without drive and times: coordinates of crank, rod, slider and slide. The slide lies along x, and the
  !> crank turns about z; the point B is the slider.
  character(len=*), parameter :: slider_crank = &
    "&mechanism title='Slider-crank', links=4, coordinates=4 /"//eol// &
    "&structure cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0 /"//eol// &
    "&initial coordinate=4, position=1.2 /"//eol// &
    "&point name='B', link=4 /"//eol

contains

  !> The groups of a text, which must be right.
  subroutine document_of(tester, text, document)
    type(tester_type), intent(inout) :: tester         !< counts the checks
    character(len=*), intent(in) :: text               !< of a data file
    type(document_type), intent(out) :: document       !< its groups
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('case.nml', text), document, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'the text of the case can be read')
  end subroutine document_of

  !> The model of a text, which must be right.
  subroutine model_of(tester, text, needs_drives, model)
    type(tester_type), intent(inout) :: tester         !< counts the checks
    character(len=*), intent(in) :: text               !< of a data file
    logical, intent(in) :: needs_drives                !< independent coordinates are driven, as in kinematics
    type(model_type), intent(out) :: model             !< the model
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('case.nml', text), document, diagnostics)
    call read_model(document, needs_drives, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'the data file of the case is right')
    if (diagnostics%failed()) call diagnostics%report(6)
  end subroutine model_of
end module mech9_small_models
