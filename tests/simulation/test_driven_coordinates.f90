!> Drives that are not smooth, beside a free coordinate: a jump of the position ends the motion with its time and its coordinate.
module test_driven_coordinates
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_singular
  use mech9_integration_failures, only: failure_drive_jumps
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  use mech9_free_start, only: assemble_free
  use mech9_testing, only: tester_type
  use simulation_doubles, only: jumping_drive_type
  implicit none
  private
  public :: run

  !> A pendulum on a slide, and on the driven crank of a four-bar.
  character(len=*), parameter :: loads = '&gravity acceleration=0,-9.81,0 / &time end=2 / '
  character(len=*), parameter :: on_slide = '&structure cq=1,2 / '// &
    '&pair coordinate=1, links=1,2, kind=''prismatic'', axis=1,0,0 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1 / &initial coordinate=2, position=0.3 / '// &
    '&drive coordinate=1, kind=''polynomial'', coefficients=0 / &body link=3, mass=1, centre=0,-0.5,0 / '//loads
  character(len=*), parameter :: on_crank = '&structure cq=1,5 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0 / '// &
    '&pair coordinate=3, links=4,3, kind=''revolute'', axis=0,0,1, point=0.7,0.7,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''revolute'', axis=0,0,1, point=0.9,0,0 / '// &
    '&pair coordinate=5, links=2,5, kind=''revolute'', axis=0,0,1, point=0.3,0,0 / &initial coordinate=5, position=0.3 / '// &
    '&drive coordinate=1, kind=''polynomial'', coefficients=0 / &body link=5, mass=1, centre=0.3,-0.5,0 / '//loads

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('on_slide')) call check_jump(test, on_slide, 0.5_wp)
    if (test%runs('on_crank')) call check_jump(test, on_crank, 0.5_wp)
    if (test%runs('on_crank_backward')) call check_jump(test, on_crank, -0.1_wp)
  end subroutine run

  !> The motion with a drive that jumps at 1 s.
  subroutine check_jump(test, text, height)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< data file with a drive of coordinate 1
    real(wp), intent(in) :: height             !< of the jump [rad, m]
    type(diagnostics_type) :: diagnostics
    type(document_type) :: document
    type(model_type), target :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(free_simulation_type) :: simulation
    type(error_type), allocatable :: err
    integer :: i

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call read_model(document, dynamics, model, diagnostics)
    call test%is_true(.not. diagnostics%failed(), 'the data file is right')
    deallocate (model%problem%drives(1)%drive)
    allocate (model%problem%drives(1)%drive, source=jumping_drive_type(coordinate=1, rate=0.2_wp, t=1.0_wp, height=height))
    call assemble_free(model, plan, start, err)
    if (.not. allocated(err)) call new_free_simulation(model, plan, start, simulation, err)
    if (.not. allocated(err)) call simulation%start(err)
    call test%no_error(err, 'the motion begins')
    do i = 1, 20
      if (.not. allocated(err)) call simulation%advance(0.1_wp*i, err)
    end do
    call test%has_error(err, exit_singular, 'a jump of the drive ends the motion')
    if (allocated(err)) then
      call test%is_true(allocated(err%failure), 'with numbers')
      if (allocated(err%failure)) then
        call test%is_true(err%failure%kind == failure_drive_jumps, 'as a jump')
        call test%is_true(err%failure%coordinates(1) == 1, 'of its coordinate')
        call test%near(err%failure%t, 1.0_wp, 1.0e-6_wp, 'at its time')
      end if
    end if
    call simulation%close()
  end subroutine check_jump
end module test_driven_coordinates
