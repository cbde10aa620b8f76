!> Quantities of a driven motion and their derivatives, without any results: the stroke of a slider-crank.
module test_design_gradient
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_model, only: model_type
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_design_run, only: find_design_gradient
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: eol = new_line('a')
  character(len=*), parameter :: slider_crank = &
    "&structure cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /"//eol// &
    "&initial coordinate=4, position=1.2 /"//eol// &
    "&drive coordinate=1, kind='polynomial', coefficients=0.4,10 /"//eol// &
    "&time end=0.7, intervals=40 /"//eol// &
    "&parameter name='crank', sets='pair(2).point(1)' / &parameter name='rod', sets='pair(3).point(1)' /"//eol// &
    "&quantity name='stroke', of='q4', take='range' / &quantity name='closure', of='closure', take='max' /"//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('stroke')) call stroke(tester)
  end subroutine run

  !> The stroke of a slider-crank is twice its crank.
  subroutine stroke(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(varied_document_type) :: varied
    type(model_type), target :: model
    type(error_type), allocatable :: err
    real(wp) :: numbers(2), gradient(2, 2)

    call parse_document(source_from_text('f.nml', slider_crank), document, diagnostics)
    call new_varied_document(document, diagnostics%sources, kinematics, varied)
    call varied%at([0.25_wp, 1.0_wp], model, err)
    call tester%is_true(.not. allocated(err), 'there is a model')
    if (allocated(err)) return
    call find_design_gradient(model, varied, numbers, gradient, err)
    call tester%is_true(.not. allocated(err), 'it moves')
    ! polynomials through outputs that are 1/36 of a turn apart
    call tester%near(numbers(1), 0.5_wp, 1.0e-9_wp, 'the stroke is twice the crank')
    call tester%near(gradient(1, 1), 2.0_wp, 1.0e-9_wp, 'its derivative by the crank')
    call tester%near(gradient(2, 1), 0.0_wp, 1.0e-9_wp, 'its derivative by the rod')
    call tester%is_true(all(ieee_is_nan(gradient(:, 2))), 'the error of closed chains has no derivative')
    call varied%at([0.3_wp, 0.25_wp], model, err)
    if (.not. allocated(err)) call find_design_gradient(model, varied, numbers, gradient, err)
    call tester%is_true(allocated(err), 'a rod that is too short fails')
  end subroutine stroke
end module test_design_gradient
