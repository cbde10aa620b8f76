!> The data file of a design: the text of the data file with other values and positions, all else as it stands.
module test_design_file
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_document, only: document_type
  use mech9_model, only: model_type
  use mech9_design_text, only: text_of_design
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: document_from_text, model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: parameters = &
    "&parameter name='a', value=0.3, low=0.1, high=0.5, sets='pair(2).point(1)' / ! first"//eol// &
    "&parameter name='b', value = 1 , low=0.8, high=1.5, sets='pair(3).point(1)' /"//eol
  character(len=*), parameter :: drive = "&drive coordinate=1, kind='polynomial', coefficients=0.4, 1 /"//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('values_and_positions')) call values_and_positions(tester)
    if (tester%runs('reads_back')) call reads_back(tester)
    if (tester%runs('degrees')) call degrees(tester)
  end subroutine run

  subroutine design(tester, data, values, q, text)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: data                 !< data file
    real(wp), intent(in) :: values(:)                    !< of the parameters
    real(wp), intent(in) :: q(:)                         !< coordinates at the start [rad, m]
    character(len=:), allocatable, intent(out) :: text   !< data file of the design
    type(document_type) :: document
    type(model_type) :: model

    call document_from_text(tester, data, document)
    call model_from_text(tester, data, kinematics, model)
    call text_of_design(document, model, values, q, '! made'//eol, text)
  end subroutine design

  subroutine values_and_positions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text

    call design(tester, slider_crank//parameters//drive, [0.25_wp, 1.25_wp], [0.4_wp, 0.5_wp, 0.75_wp, 1.5_wp], text)
    call tester%is_true(index(text, '! made'//eol//'&mechanism') == 1, 'the history stands at the beginning')
    call tester%is_true(index(text, "low=0.1, high=0.5, sets='pair(2).point(1)' / ! first") > 0, 'all else stays, comments too')
    call tester%is_true(index(text, 'value=0.3') == 0 .and. index(text, 'position=1.2') == 0, 'old numbers are gone')
    call tester%is_true(index(text, '&initial coordinate=1') == 0, 'the driven coordinate needs no position')
    call tester%is_true(index(text, '&initial coordinate=2') > 0 .and. index(text, '&initial coordinate=3') > 0, 'others get one')
  end subroutine values_and_positions

  !> The numbers are written with all their digits.
  subroutine reads_back(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: values(2) = [1.0_wp/7.0_wp, acos(-1.0_wp)/3.0_wp], q(4) = [0.4_wp, -1.0_wp/3.0_wp, 2.0_wp/3.0_wp, 1.1_wp]
    character(len=:), allocatable :: text
    type(model_type) :: model

    call design(tester, slider_crank//parameters//drive, values, q, text)
    call model_from_text(tester, text, kinematics, model)
    call tester%is_true(all(abs([model%parameters(1)%value, model%parameters(2)%value] - values) <= 0.0_wp), 'values read back')
    call tester%is_true(all(abs(model%problem%initial%position(2:) - q(2:)) <= 0.0_wp), 'positions read back')
  end subroutine reads_back

  !> Positions have the unit of angles of the file.
  subroutine degrees(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: q(4) = [0.4_wp, 0.5_wp, 0.75_wp, 1.5_wp]
    character(len=:), allocatable :: text
    type(model_type) :: model

    call design(tester, "&mechanism angle_unit='deg', "//slider_crank(11:)//drive, [real(wp) ::], q, text)
    call model_from_text(tester, text, kinematics, model)
    ! a number goes to degrees and back, with two roundings
    call tester%is_true(all(abs(model%problem%initial%position(2:) - q(2:)) <= 4.0e-16_wp), 'positions in degrees read back')
    call tester%is_true(index(text, 'position=28.6478') > 0, 'half a radian is 28.6478 degrees')
  end subroutine degrees
end module test_design_file
