!> The interface of simulations: a motion is the same in one go and in pieces, stops where it is interrupted, counts its work, and
!> refuses times behind it and open chains.
!>
!> Compares the program with itself: a motion in one go, in pieces and after an interruption.
module test_simulation
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, exit_usage, exit_data, exit_singular, exit_integrator, exit_interrupted
  use mech9_dynamics_failures, only: failure_no_inertia
  use mech9_force_gradient_failures, only: failure_lost_inertia
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_explanation, only: explain
  use mech9_simulation, only: simulation_type, simulation_statistics_type, estimated_errors_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation, assemble_driven
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  use mech9_free_start, only: assemble_free
  use mech9_accuracy, only: find_accuracy
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_ode_system, only: is_recoverable
  use mech9_testing, only: tester_type
  use simulation_doubles, only: countdown_type, open_chains_type
  implicit none
  private
  public :: run

  !> A parallelogram would be special; this four-bar's crank turns fully.
  character(len=*), parameter :: pairs = &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=0.8,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''revolute'', axis=0,0,1, point=0.9,0,0, moving_point=0.7,0,0 / '
  character(len=*), parameter :: four_bar = '&structure cq=1 / '//pairs// &
    '&initial coordinate=2, position=0.5 / &initial coordinate=3, position=-2 / '
  character(len=*), parameter :: driven = four_bar//'&drive coordinate=1, kind=''polynomial'', coefficients=0.6,5 / '
  character(len=*), parameter :: masses = '&body link=3, mass=2, centre=0.4,0,0, inertia=0,0,0.1,0,0,0 / '// &
    '&gravity acceleration=0,-9.81,0 / &time end=2 / '
  character(len=*), parameter :: tight = '&solver relative_tolerance=1e-10, absolute_tolerance=1e-12 / '
  character(len=*), parameter :: loaded = four_bar//masses//'&initial coordinate=1, position=0.6, velocity=5 / '
  character(len=*), parameter :: free = loaded//tight
  !> The same, described by the rocker, which swings: its angle is singular at the ends of its range.
  character(len=*), parameter :: by_rocker = '&structure cq=4 / '//pairs//masses//tight//&
    '&initial coordinate=1, position=2.1 / '// &
    '&initial coordinate=2, position=-1.64 / &initial coordinate=3, position=-1.53 / '// &
    '&initial coordinate=4, position=-1.07, velocity=2 / '

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    ! positions are closed to 1e-15 over a conditioning of 0.1, and rates are 5 rad/s
    if (test%runs('pieces_driven')) call check_pieces(test, driven, .true., 1e-12_wp)
    ! 2 s are some 200 steps; each errs by 1e-10, and errors grow as the motion's own differences do
    if (test%runs('pieces_free')) call check_pieces(test, free, .false., 1e-7_wp)
    if (test%runs('pieces_by_rocker')) call check_pieces(test, by_rocker, .false., 1e-7_wp)
    if (test%runs('interruption_driven')) call check_interruption(test, driven, .true., 1, 1.0_wp, 'before t = 1 s')
    ! 5000 rad are some ten thousand steps; the motion asks after each thousand of them
    if (test%runs('interruption_on_the_way')) call check_interruption(test, driven, .true., 4, 1000.0_wp, 'before t = ')
    if (test%runs('interruption_free')) call check_interruption(test, free, .false., 1, 1.0_wp, 'before t = 1 s')
    if (test%runs('interruption_later')) call check_interruption(test, free, .false., 7, 1.0_wp, 'before t = 1 s')
    if (test%runs('check_statistics')) call check_statistics(test)
    if (test%runs('order_of_times_driven')) call check_order_of_times(test, driven, .true.)
    if (test%runs('order_of_times_free')) call check_order_of_times(test, free, .false.)
    if (test%runs('check_open_chains')) call check_open_chains(test)
    if (test%runs('check_accuracy')) call check_accuracy(test)
    if (test%runs('check_interrupted_accuracy')) call check_interrupted_accuracy(test)
    if (test%runs('check_lost_inertia')) call check_lost_inertia(test)
  end subroutine run

  !> A simulation of a text in the form of a data file, not started.
  subroutine new_simulation(test, text, is_driven, simulation)
    type(tester_type), intent(inout) :: test                         !< counts the checks
    character(len=*), intent(in) :: text                             !< groups of the data file
    logical, intent(in) :: is_driven                                 !< all independent coordinates are driven
    class(simulation_type), allocatable, intent(out) :: simulation   !< not started
    type(driven_simulation_type), allocatable :: of_drives
    type(free_simulation_type), allocatable :: of_forces
    type(model_type), pointer :: model
    type(plan_type) :: plan
    type(state_type) :: assembled
    type(error_type), allocatable :: err

    allocate (model)
    call read(test, text, is_driven, model)
    if (is_driven) then
      allocate (of_drives)
      call assemble_driven(model, plan, assembled, err)
      call new_driven_simulation(model, plan, assembled, of_drives)
      call move_alloc(of_drives, simulation)
    else
      allocate (of_forces)
      call assemble_free(model, plan, assembled, err)
      if (.not. allocated(err)) call new_free_simulation(model, plan, assembled, of_forces, err)
      call move_alloc(of_forces, simulation)
    end if
    call test%no_error(err, 'a four-bar has a simulation')
  end subroutine new_simulation

  !> Close a simulation that `new_simulation` made, and give back its model.
  subroutine end_simulation(simulation)
    class(simulation_type), intent(inout) :: simulation   !< the simulation

    call simulation%close()
    deallocate (simulation%model)
  end subroutine end_simulation

  subroutine read(test, text, is_driven, model)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< text of a data file
    logical, intent(in) :: is_driven           !< all independent coordinates are driven
    type(model_type), intent(out) :: model     !< mechanism that it describes
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('text', text), document, diagnostics)
    call read_model(document, merge(kinematics, dynamics, is_driven), model, diagnostics)
    call test%is_true(.not. diagnostics%failed(), 'the text is sound')
  end subroutine read

  !> Coordinates and rates of the present state.
  function numbers(simulation)
    class(simulation_type), intent(in), target :: simulation   !< at some time
    real(wp), allocatable :: numbers(:)
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    call simulation%present(plan, state)
    numbers = [state%q, state%dq]
  end function numbers

  !> The motion at its end by one call, and by many.
  subroutine check_pieces(test, text, is_driven, tolerance)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< text of a data file
    logical, intent(in) :: is_driven           !< all independent coordinates are driven
    real(wp), intent(in) :: tolerance          !< of coordinates [rad] and rates [rad/s]
    class(simulation_type), allocatable :: whole, pieces
    type(error_type), allocatable :: err
    integer :: i

    call new_simulation(test, text, is_driven, whole)
    call new_simulation(test, text, is_driven, pieces)
    call whole%start(err)
    call whole%advance(2.0_wp, err)
    call test%no_error(err, 'the motion succeeds in one go')
    call pieces%start(err)
    do i = 1, 64
      if (.not. allocated(err)) call pieces%advance(2.0_wp*i/64, err)
    end do
    call test%no_error(err, 'the motion succeeds in pieces')
    call test%is_true(maxval(abs(numbers(whole) - numbers(pieces))) <= tolerance, 'the motion in pieces is that in one go')
    call pieces%advance(2.0_wp, err)
    call test%no_error(err, 'the present time can be asked for again')
    call test%is_true(maxval(abs(numbers(whole) - numbers(pieces))) <= tolerance, 'the present time leads to where the motion was')
    call end_simulation(whole)
    call end_simulation(pieces)
  end subroutine check_pieces

  !> A motion that is interrupted at the given question stops there with its code; asked again it goes on to the same end.
  subroutine check_interruption(test, text, is_driven, question, t, words)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< text of a data file
    logical, intent(in) :: is_driven           !< all independent coordinates are driven
    integer, intent(in) :: question            !< after the one of the start
    real(wp), intent(in) :: t                  !< time to go to [s]
    character(len=*), intent(in) :: words      !< of the message
    class(simulation_type), allocatable :: whole, interrupted
    type(error_type), allocatable :: err
    integer, target :: left

    call new_simulation(test, text, is_driven, whole)
    call whole%start(err)
    call whole%advance(t, err)
    call new_simulation(test, text, is_driven, interrupted)
    left = 1 + question
    call interrupted%start(err, countdown_type(left))
    call test%no_error(err, 'the motion starts')
    call interrupted%advance(t, err)
    call test%has_error(err, exit_interrupted, 'an interruption stops a motion')
    call explain(err)
    call test%is_true(index(err%message, words) > 0, 'the message of an interruption says before which time')
    call test%is_true(interrupted%t < t, 'an interrupted motion stands before the time that was asked for')
    call interrupted%advance(t, err)
    call test%no_error(err, 'an interrupted motion goes on when it is asked again')
    ! a free motion goes on with the steps that it would have taken; a driven one closes again, as in pieces
    call test%is_true(maxval(abs(numbers(whole) - numbers(interrupted))) <= 1e-12_wp, &
                      'an interrupted motion goes on to the same position')
    call end_simulation(interrupted)
    call new_simulation(test, text, is_driven, interrupted)
    left = 1
    call interrupted%start(err, countdown_type(left))
    call test%has_error(err, exit_interrupted, 'the start can be interrupted')
    call end_simulation(interrupted)
    call end_simulation(whole)
  end subroutine check_interruption

  !> Counts grow with every advance, across changes of coordinates too, and begin at nothing.
  subroutine check_statistics(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    class(simulation_type), allocatable :: simulation
    type(simulation_statistics_type) :: now, before
    type(error_type), allocatable :: err
    logical :: grow
    integer :: i

    call new_simulation(test, by_rocker, .false., simulation)
    now = simulation%statistics()
    call test%is_true(now%positions == 0 .and. now%steps == 0 .and. now%evaluations == 0, 'nothing was done before the start')
    call simulation%start(err)
    grow = .true.
    do i = 1, 20
      before = simulation%statistics()
      call simulation%advance(0.1_wp*i, err)
      now = simulation%statistics()
      grow = grow .and. now%positions == before%positions + 1 .and. now%steps >= before%steps &
             .and. now%evaluations >= before%evaluations .and. now%newton_iterations >= before%newton_iterations
    end do
    call test%no_error(err, 'a four-bar described by its rocker moves')
    call test%is_true(grow, 'no count of the work falls')
    call test%is_true(size(simulation%coordinate_changes) > 0, 'another coordinate takes the place of the rocker')
    call test%is_true(all(simulation%coordinate_changes%t > 0.0_wp) .and. all(simulation%coordinate_changes%t < 2.0_wp), &
                      'the change of coordinates happens within the motion')
    ! each accepted step of the method takes several evaluations, and 2 s at this tolerance are more than 20 steps
    call test%is_true(now%evaluations > now%steps .and. now%newton_iterations > 0 .and. now%steps > 20_long, &
                      'each step takes evaluations and iterations')
    call end_simulation(simulation)
  end subroutine check_statistics

  !> No motion without a start, and none back.
  subroutine check_order_of_times(test, text, is_driven)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< text of a data file
    logical, intent(in) :: is_driven           !< all independent coordinates are driven
    class(simulation_type), allocatable :: simulation
    type(error_type), allocatable :: err
    real(wp), allocatable :: there(:)

    call new_simulation(test, text, is_driven, simulation)
    call simulation%advance(0.5_wp, err)
    call test%has_error(err, exit_usage, 'a motion that was not started is refused')
    call simulation%start(err)
    call simulation%advance(0.5_wp, err)
    there = numbers(simulation)
    call simulation%advance(0.25_wp, err)
    call test%has_error(err, exit_usage, 'a time before the present one is refused')
    call test%is_true(all(abs(numbers(simulation) - there) <= 0.0_wp), 'a refused time changes nothing')
    call end_simulation(simulation)
  end subroutine check_order_of_times

  !> A simulation fails at a position whose chains are open by more than 1e-9 of the size, and does not show it.
  subroutine check_open_chains(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(open_chains_type) :: simulation
    type(model_type), target :: model
    type(plan_type) :: plan
    type(state_type) :: assembled
    type(error_type), allocatable :: err

    call read(test, driven, .true., model)
    call assemble_driven(model, plan, assembled, err)
    call new_driven_simulation(model, plan, assembled, simulation%driven_simulation_type)
    simulation%gap = 0.9e-9_wp*plan%length
    call simulation%start(err)
    call test%no_error(err, 'chains that are open by less than 1e-9 of the size are accepted')
    simulation%gap = 1.1e-9_wp*plan%length
    call simulation%advance(0.1_wp, err)
    call test%has_error(err, exit_singular, 'chains that are open by more are refused')
  end subroutine check_open_chains

  !> The tolerances for an accuracy, and errors that are those of the run with them; where a position has no error that is
  !> known, the motion ends.
  subroutine check_accuracy(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), target :: model
    type(free_simulation_type), target :: simulation
    type(plan_type) :: plan
    type(state_type) :: assembled
    type(estimated_errors_type) :: errors
    type(error_type), allocatable :: err
    integer :: i

    call read(test, loaded//'&solver accuracy=1e-7 / ', .false., model)
    call assemble_free(model, plan, assembled, err)
    call find_accuracy(model, plan, assembled, errors, err)
    call test%no_error(err, 'an accuracy that is asked for is reached')
    call test%is_true(size(errors%at) == 101 .and. maxval(errors%at) <= 1e-7_wp, 'no output is worse than the accuracy')
    call test%is_true(minval(errors%at) > 0.0_wp, 'no output is told to be exact')
    call test%is_true(errors%runs >= 2 .and. errors%evaluations > 100, 'the work for the accuracy is counted')
    call test%is_true(model%request%solver%relative_tolerance < 1e-7_wp .and. &
                      abs(model%request%solver%relative_tolerance - model%request%solver%absolute_tolerance) <= 0.0_wp, &
                      'the accuracy gives both tolerances')
    call new_free_simulation(model, plan, assembled, simulation, err)
    simulation%errors = errors
    simulation%errors%at = errors%at(:3)
    allocate (simulation%errors%failure)
    simulation%errors%failure%code = exit_singular
    call simulation%start(err)
    do i = 1, 2
      if (.not. allocated(err)) call simulation%advance(model%request%time%time(i), err)
    end do
    call test%no_error(err, 'positions with known errors are found')
    call test%near(simulation%largest_error, maxval(errors%at(:3)), 0.0_wp, 'the largest error is kept')
    call simulation%advance(model%request%time%time(3), err)
    call test%has_error(err, exit_singular, 'a time at which no error is known is refused')
    call simulation%close()
  end subroutine check_accuracy

  !> The runs for an accuracy stop where the user interrupts.
  subroutine check_interrupted_accuracy(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), target :: model
    type(plan_type) :: plan
    type(state_type) :: assembled
    type(estimated_errors_type) :: errors
    type(countdown_type) :: countdown
    type(error_type), allocatable :: err
    integer, target :: left

    call read(test, loaded//'&solver accuracy=1e-7 / ', .false., model)
    call assemble_free(model, plan, assembled, err)
    left = 150
    countdown%left => left
    call find_accuracy(model, plan, assembled, errors, err, interruption=countdown)
    call test%has_error(err, exit_interrupted, 'runs for an accuracy can be interrupted')
    call test%is_true(errors%runs == 1, 'the first run for an accuracy stops, and no other begins')
  end subroutine check_interrupted_accuracy

  !> Two bars with one mass, at the end of the second one: stretched, both turn it alike, and the matrix of the coefficients of
  !> motion, (4, 2; 2, 1) kg m^2, is singular without any round-off. A trial of an integration there fails so that a smaller step
  !> is tried; a system made there has data that are at fault.
  subroutine check_lost_inertia(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), parameter :: bars = '&structure cq=1, 2 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
      '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=1,0,0, moving_point=0,0,0 / '// &
      '&initial coordinate=1, position=0 / &initial coordinate=2, position=1 / &body link=3, mass=1, centre=1,0,0 / &time end=1 /'
    type(model_type), target :: model
    type(motion_system_type) :: system, stretched
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err
    real(wp) :: rate(4)

    call read(test, bars, .false., model)
    call assemble_free(model, plan, start, err)
    system%plan = plan
    system%state = start
    if (.not. allocated(err)) call set_motion_system(model, model%problem%partition, system, err)
    call test%no_error(err, 'two bars with one mass have inertia where they are not stretched')
    call system%rate(0.1_wp, [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], rate, err)
    call check_failure(test, err, exit_integrator, failure_lost_inertia, 'a trial step to the stretched position')
    if (allocated(err)) call test%is_true(is_recoverable(err), 'a smaller step is tried after a loss of inertia')
    model%problem%initial%position = 0.0_wp
    call assemble_free(model, plan, start, err)
    stretched%plan = plan
    stretched%state = start
    if (.not. allocated(err)) call set_motion_system(model, model%problem%partition, stretched, err)
    call check_failure(test, err, exit_data, failure_no_inertia, 'a start in the stretched position')
  end subroutine check_lost_inertia

  !> Check the code and the kind of a failure about the second coordinate.
  subroutine check_failure(test, err, code, kind, name)
    type(tester_type), intent(inout) :: test           !< counts the checks
    type(error_type), allocatable, intent(in) :: err   !< the failure
    integer, intent(in) :: code                        !< expected exit code
    integer, intent(in) :: kind                        !< expected kind
    character(len=*), intent(in) :: name               !< of what fails

    call test%is_true(allocated(err), name//' fails')
    if (.not. allocated(err)) return
    call test%is_true(err%code == code, name//' fails with the code of its cause')
    call test%is_true(allocated(err%failure), name//' fails in numbers')
    if (.not. allocated(err%failure)) return
    call test%is_true(err%failure%kind == kind, name//' fails by its cause')
    call test%is_true(all(err%failure%coordinates == 2), name//' fails by the second coordinate')
  end subroutine check_failure
end module test_simulation
