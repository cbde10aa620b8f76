!> Remedies for columns that a run does not have: the setting that records them, or the name that may be meant.
module test_missing_column
  use mech9_program_kind, only: kinematics
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type, kinematic_columns
  use mech9_missing_column, only: find_remedy
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('motion')) call motion(tester)
    if (tester%runs('forces')) call forces(tester)
    if (tester%runs('names')) call names(tester)
  end subroutine run

  !> The remedies of a run of the slider-crank with these settings.
  subroutine remedies(tester, output, name, expected)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: output       !< items of &output
    character(len=*), intent(in) :: name         !< of the column that is missing
    character(len=*), intent(in) :: expected     !< the right remedy
    type(model_type) :: model
    type(columns_type) :: columns
    character(len=:), allocatable :: remedy

    call model_from_text(tester, slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol// &
      "&time end=1, intervals=4 /"//eol//"&output "//output//" /"//eol, kinematics, model)
    columns = kinematic_columns(model%mechanism, model%request%output)
    call find_remedy(name, model, columns, remedy)
    call tester%is_true(remedy == expected, 'the remedy of '//name//' with '//output//': "'//remedy//'"')
  end subroutine remedies

  subroutine motion(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call remedies(tester, 'coordinates=1, 2', 'q4', '; coordinate 4 is not among coordinates in &output')
    call remedies(tester, 'derivatives=0', 'dq2', '; set derivatives=1 in &output')
    call remedies(tester, 'derivatives=1', 'ddq4', '; set derivatives=2 in &output')
    call remedies(tester, 'derivatives=0', 'B.vx', '; set derivatives=1 in &output')
    call remedies(tester, 'derivatives=0', 'B.az', '; set derivatives=2 in &output')
    call remedies(tester, 'conditioning=.false.', 'conditioning', '; set conditioning=.true. in &output')
  end subroutine motion

  subroutine forces(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call remedies(tester, 'derivatives=2', 'F1', '; set drive_forces=.true. in &output')
    call remedies(tester, 'derivatives=2', 'F2', '; coordinate 2 has no drive')
    call remedies(tester, 'derivatives=2', 'R3.fy', '; set reactions=.true. in &output')
    call remedies(tester, 'reactions=.true., reaction_pairs=1', 'R3.fy', '; pair 3 is not among reaction_pairs in &output')
    call remedies(tester, 'derivatives=2', 'C1', '; there are no couplings')
    call remedies(tester, 'derivatives=2', 'E.total', '; mech9d alone records energies')
  end subroutine forces

  subroutine names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: headings = '; columns are the headings of the table, and &output decides which there are'

    call remedies(tester, 'derivatives=2', 'B.vxx', '; did you mean ''B.vx''?')
    call remedies(tester, 'derivatives=2', 'something_else', headings)
    call remedies(tester, 'derivatives=2', 'q99999999999999999999', headings)
  end subroutine names
end module test_missing_column
