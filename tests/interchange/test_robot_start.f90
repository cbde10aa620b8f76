!> A start for closed chains: a slider-crank, whose positions are known, from guesses that do not close it.
module test_robot_start
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_assembly
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_robot_start, only: find_start
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: crank = 0.3_wp, rod = 1.0_wp
  !> The position is closed to the tolerance of the assembly, which lies below this.
  real(wp), parameter :: tol = 1.0e-9_wp

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('crank_chosen')) call crank_chosen(tester)
    if (tester%runs('all_preferred')) call all_preferred(tester)
    if (tester%runs('straight_start')) call straight_start(tester)
    if (tester%runs('open_chain')) call open_chain(tester)
  end subroutine run

  !> Crank, rod, and a slider whose line lies at a height; links of the lengths above.
  subroutine slider_crank(tester, height, model)
    type(tester_type), intent(inout) :: tester     !< counts the checks
    character(len=*), intent(in) :: height         !< of the line [m]
    type(model_type), intent(out) :: model         !< the mechanism
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('s.nml', &
      "&mechanism links=4, coordinates=4 /"//achar(10)//"&structure cq=1 /"//achar(10)// &
      "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//achar(10)// &
      "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /"//achar(10)// &
      "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /"//achar(10)// &
      "&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, point=0,"//height//",0, moving_point=0,0,0 /"//achar(10)// &
      "&initial coordinate=1, position=0 /"//achar(10)), document, diagnostics)
    call read_model(document, dynamics, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'the data file is right')
  end subroutine slider_crank

  !> The end of the rod lies on the line, at the place of the slider.
  subroutine is_closed(tester, q, height)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), intent(in) :: q(4)                 !< coordinates [rad, m]
    real(wp), intent(in) :: height               !< of the line [m]

    call tester%near(crank*cos(q(1)) + rod*cos(q(1) + q(2)), q(4), tol, 'the rod ends at the slider')
    call tester%near(crank*sin(q(1)) + rod*sin(q(1) + q(2)), height, tol, 'the rod ends on the line')
  end subroutine is_closed

  subroutine crank_chosen(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(error_type), allocatable :: err
    real(wp) :: q(4)
    logical :: independent(4), moved

    call slider_crank(tester, '0.1', model)
    q = [0.4_wp, 0.0_wp, 0.0_wp, 1.2_wp]
    call find_start(model%mechanism, [.true., .false., .false., .false.], q, independent, moved, err)
    call tester%no_error(err, 'the chain closes')
    call tester%is_true(all(independent .eqv. [.true., .false., .false., .false.]) .and. .not. moved, 'the crank stays independent')
    call tester%near(q(1), 0.4_wp, 0.0_wp, 'it keeps its value')
    call is_closed(tester, q, 0.1_wp)
    call tester%near(q(4), crank*cos(0.4_wp) + sqrt(rod**2 - (0.1_wp - crank*sin(0.4_wp))**2), tol, 'the slider by its formula')
  end subroutine crank_chosen

  !> One freedom has one independent coordinate.
  subroutine all_preferred(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(error_type), allocatable :: err
    real(wp) :: q(4)
    logical :: independent(4), moved
    logical, parameter :: every(4) = .true.

    call slider_crank(tester, '0.1', model)
    q = [0.4_wp, 0.0_wp, 0.0_wp, 1.2_wp]
    call find_start(model%mechanism, every, q, independent, moved, err)
    call tester%no_error(err, 'the chain closes')
    call tester%is_true(count(independent) == 1, 'one coordinate is independent')
    call is_closed(tester, q, 0.1_wp)
  end subroutine all_preferred

  !> A crank as long as the rod, stretched on the line: the chain may go on in two ways, and the start lies beside it. The chain of
  !> this suite is stretched, too, but goes on in one way only, so that it stays.
  subroutine straight_start(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(error_type), allocatable :: err
    real(wp) :: q(4)
    logical :: independent(4), moved

    call slider_crank(tester, '0', model)
    q = [0.0_wp, 0.0_wp, 0.0_wp, 1.3_wp]
    call find_start(model%mechanism, [.true., .false., .false., .false.], q, independent, moved, err)
    call tester%no_error(err, 'the chain closes')
    call tester%is_true(.not. moved, 'a stretched slider-crank is not singular for its crank')
    call is_closed(tester, q, 0.0_wp)
    q = [0.0_wp, 0.0_wp, 0.0_wp, 1.3_wp]
    call find_start(model%mechanism, [.false., .false., .false., .true.], q, independent, moved, err)
    call tester%no_error(err, 'the chain closes, although the slider stands at its end')
    call tester%is_true(count(independent) == 1, 'one coordinate is independent')
    call is_closed(tester, q, 0.0_wp)
  end subroutine straight_start

  !> A line that the rod does not reach.
  subroutine open_chain(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(error_type), allocatable :: err
    real(wp) :: q(4)
    logical :: independent(4), moved

    call slider_crank(tester, '2', model)
    q = [0.4_wp, 0.0_wp, 0.0_wp, 1.2_wp]
    call find_start(model%mechanism, [.true., .false., .false., .false.], q, independent, moved, err)
    call tester%has_error(err, exit_assembly, 'a chain that closes nowhere')
  end subroutine open_chain
end module test_robot_start
