!> The motion between the ends of steps: where the polynomial is as good as the ends, where it is not, and what tells
!> another branch. Closed form: a slide on a spring swings as q = cos t.
module test_dense_output
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_singular
  use mech9_model, only: model_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_expectation, only: expectation_type
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_dense_output, only: dense_output_type
  use mech9_sample_mechanisms, only: new_mechanism, add_prismatic, frame, four_bar
  use mech9_loaded_mechanisms, only: without_loads, add_body, add_load
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], origin(3) = 0.0_wp
  real(wp), parameter :: inertia(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('swinging')) call swinging(test)
    if (test%runs('branches')) call branches(test)
    if (test%runs('trust')) call trust(test)
    if (test%runs('expectations')) call expectations(test)
  end subroutine run

  !> One slide of 1 kg on a spring of 1 N/m.
  subroutine swing(test, system)
    type(tester_type), intent(inout) :: test            !< counts the checks
    type(motion_system_type), intent(inout) :: system   !< begun at its start
    type(model_type), pointer :: model
    type(coordinate_load_type) :: load

    allocate (model)
    call new_mechanism(2, reshape([1, 2], [2, 1]), [1], model)
    call add_prismatic(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call without_loads(model)
    call add_body(model, 2, 1.0_wp, origin, inertia)
    load%coordinate = 1
    load%stiffness = 1.0_wp
    call add_load(model, load)
    model%problem%initial%position = 1.0_wp
    call begin(test, model, 0.0_wp, system)
  end subroutine swing

  !> A crank-rocker with a heavy crank, assembled at the guess.
  subroutine rocker(test, guess, system)
    type(tester_type), intent(inout) :: test            !< counts the checks
    real(wp), intent(in) :: guess(4)                    !< of the coordinates [rad]
    type(motion_system_type), intent(inout) :: system   !< begun at its start
    type(model_type), pointer :: model

    allocate (model)
    call four_bar(0.4_wp, 0.15_wp, 0.35_wp, 0.3_wp, guess, model)
    call without_loads(model)
    call add_body(model, 2, 1.0_wp, origin, inertia)
    call begin(test, model, 2.0_wp, system)
  end subroutine rocker

  !> The system of a mechanism at its start.
  subroutine begin(test, model, rate, system)
    type(tester_type), intent(inout) :: test            !< counts the checks
    type(model_type), intent(in), target :: model       !< the system refers to it
    real(wp), intent(in) :: rate                        !< of the independent coordinate [rad/s, m/s]
    type(motion_system_type), intent(inout) :: system   !< begun at its start
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'the mechanism has a plan')
    if (allocated(err)) return
    state%t = 0.0_wp
    state%dq(plan%independent) = rate
    system%plan = plan
    system%state = state
    call set_motion_system(model, model%problem%partition, system, err)
    call test%no_error(err, 'the mechanism has equations of motion')
  end subroutine begin

  !> The end of a step of the swing at time t.
  subroutine add_end(test, system, dense_output, t)
    type(tester_type), intent(inout) :: test                 !< counts the checks
    type(motion_system_type), intent(inout) :: system        !< moved to this end
    type(dense_output_type), intent(inout) :: dense_output   !< takes the end
    real(wp), intent(in) :: t                                !< time of the end [s]
    type(error_type), allocatable :: err
    real(wp) :: y(2)

    y = [cos(t), -sin(t)]
    call system%move_to(t, y, err)
    call test%no_error(err, 'the motion is found at the end of a step')
    call dense_output%add(system, t, y)
  end subroutine add_end

  !> Compare what is found at time t with the closed form.
  subroutine check_swing(test, system, dense_output, t, expected, why)
    type(tester_type), intent(inout) :: test                 !< counts the checks
    type(motion_system_type), intent(inout) :: system        !< closes the chains at time t
    type(dense_output_type), intent(inout) :: dense_output   !< the dense output that is checked
    real(wp), intent(in) :: t                                !< [s]
    logical, intent(in) :: expected                          !< it is found
    character(len=*), intent(in) :: why                      !< the statement that is checked, printed where it is wrong
    type(error_type), allocatable :: err
    real(wp) :: y(2)
    logical :: found

    call dense_output%find(system, t, y, found, err)
    call test%no_error(err, why//': there is no error')
    call test%is_true(found .eqv. expected, why//': the answer is right')
    ! the tolerance that is allowed for the worse of two polynomials
    if (found) call test%near(maxval(abs(y - [cos(t), -sin(t)])), 0.0_wp, &
                              system%model%request%solver%relative_tolerance + system%model%request%solver%absolute_tolerance, why)
  end subroutine check_swing

  !> Steps one after the other, a new beginning, and points inside a long step.
  subroutine swinging(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(motion_system_type) :: system
    type(dense_output_type) :: dense_output
    real(wp) :: t, y(2)
    integer :: i

    call swing(test, system)
    call dense_output%begin()
    call add_end(test, system, dense_output, 0.0_wp)
    call check_swing(test, system, dense_output, 0.0_wp, .false., 'one end alone is not enough')
    do i = 1, 9
      call add_end(test, system, dense_output, 0.1_wp*i)
      ! only some steps are looked into: the values known for earlier steps are not those of this one
      if (mod(i, 4) == 0) call check_swing(test, system, dense_output, 0.1_wp*i - 0.03_wp, .true., &
          'the swing is found within a short step')
    end do
    call dense_output%start_of_step(t, y)
    call test%near(t, 0.8_wp, 1.0e-15_wp, 'the time at which the step began is known')
    call test%near(y(1), cos(0.8_wp), 1.0e-15_wp, 'the position in which the step began is known')
    call dense_output%begin()
    call add_end(test, system, dense_output, 0.9_wp)
    call check_swing(test, system, dense_output, 0.9_wp, .false., 'a new beginning knows no steps before it')
    ! in 1.8 s a polynomial through its ends is right to some thousandths only
    call add_end(test, system, dense_output, 2.7_wp)
    call check_swing(test, system, dense_output, 1.5_wp, .false., 'the swing is not found within a long step')
    do i = 1, 3
      t = 0.9_wp + 0.45_wp*i
      call dense_output%insert(t, [cos(t), -sin(t)])
      call test%is_true(dense_output%count_inserted() == i, 'points within the long step are counted')
    end do
    call check_swing(test, system, dense_output, 1.5_wp, .true., 'the swing is found within a long step with points inside')
    call dense_output%insert(2.0_wp, [9.0_wp, 9.0_wp])
    call test%is_true(dense_output%count_inserted() == 3, 'no more points are taken than there is room for')
    call add_end(test, system, dense_output, 2.8_wp)
    call test%is_true(dense_output%count_inserted() == 0, 'the next step has no points inside')
    call check_swing(test, system, dense_output, 2.75_wp, .true., 'the swing is found within a short step after a long one')
    do i = 1, 3
      t = 2.8_wp + 0.1_wp*i
      call add_end(test, system, dense_output, t)
    end do
    call add_end(test, system, dense_output, 4.9_wp)
    do i = 1, 3
      t = 3.1_wp + 0.45_wp*i
      call dense_output%insert(t, [cos(t), -sin(t)])
    end do
    call check_swing(test, system, dense_output, 3.9_wp, .true., 'the swing is found within another step with points inside')
    deallocate (system%model)
  end subroutine swinging

  !> Both branches of a crank-rocker have the same crank angles and Jacobians of opposite sign.
  subroutine branches(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(motion_system_type) :: upper, lower
    type(dense_output_type) :: dense_output
    type(error_type), allocatable :: err

    call rocker(test, [0.3_wp, 1.0_wp, 0.8_wp, 2.0_wp], upper)
    call rocker(test, [0.3_wp, -1.6_wp, -0.8_wp, -2.4_wp], lower)
    call test%is_true(abs(upper%state%q(4) - lower%state%q(4)) > 0.5_wp, 'the four-bar has two branches')
    call dense_output%begin()
    call dense_output%add(upper, 0.0_wp, upper%vector())
    call dense_output%add(upper, 0.1_wp, upper%vector())
    call test%is_true(.not. dense_output%crosses(), 'a step on one branch crosses nothing')
    call test%is_true(dense_output%agrees(upper), 'a state on the branch of the step agrees with it')
    call test%is_true(.not. dense_output%agrees(lower), 'a state on the other branch does not agree with the step')
    call upper%move_to(0.2_wp, lower%vector(), err)
    call test%no_error(err, 'the motion is found on the other branch')
    call dense_output%add(upper, 0.2_wp, upper%vector())
    call test%is_true(dense_output%crosses(), 'a step from branch to branch is told')
    deallocate (upper%model, lower%model)
  end subroutine branches

  !> The limit of the change that closing makes to a state of an integrator or a polynomial, and the nearness of a singular
  !> state at which it is refused.
  subroutine trust(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(motion_system_type) :: system
    type(error_type), allocatable :: err
    real(wp), allocatable :: closed(:), y(:), ydot(:)
    logical :: ok

    call rocker(test, [0.3_wp, 1.0_wp, 0.8_wp, 2.0_wp], system)
    closed = system%vector()
    allocate (y, source=closed)
    allocate (ydot(size(y)))
    ! both limits are a few times the error of any step that is worth its name
    y(2:4) = closed(2:4) + 1.0e-6_wp*[1.0_wp, -2.0_wp, 1.0_wp]
    call system%close_near(0.0_wp, y, ok, err)
    call test%no_error(err, 'a small error inside a step is no failure')
    call test%is_true(ok, 'a small error inside a step is closed')
    ! both are closed to round-off over a conditioning of 0.1
    call test%near(maxval(abs(system%state%q - closed(:4))), 0.0_wp, 1.0e-13_wp, 'chains with a small error close where they were')
    y(2:4) = closed(2:4) + 5.0e-3_wp*[1.0_wp, -2.0_wp, 1.0_wp]
    call system%close_near(0.0_wp, y, ok, err)
    call test%is_true(.not. ok, 'a large error inside a step is not trusted')
    call system%project(0.0_wp, y, err)
    call test%no_error(err, 'a large error at the end of a step is no failure')
    call test%near(maxval(abs(y(:4) - closed(:4))), 0.0_wp, 1.0e-13_wp, 'a large error at the end of a step is closed')
    y(2:4) = closed(2:4) + 0.1_wp*[1.0_wp, -2.0_wp, 1.0_wp]
    call system%project(0.0_wp, y, err)
    call test%has_error(err, exit_singular, 'a still larger error at the end of a step is refused')
    call system%rate(0.0_wp, closed, ydot, err)
    call test%no_error(err, 'a state with any conditioning is accepted without a limit')
    system%refuse_below = 2.0_wp
    call system%rate(0.0_wp, closed, ydot, err)
    call test%has_error(err, exit_singular, 'a state is refused where its conditioning is below the limit')
    deallocate (system%model)
  end subroutine trust

  !> Straight lines through what was found at two times; at one time the value there.
  subroutine expectations(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(expectation_type) :: expectation
    real(wp) :: b(2), ddq(1)

    b = [7.0_wp, 8.0_wp]
    ddq = 9.0_wp
    call expectation%continue_to(1.0_wp, b, ddq)
    call test%near(sum(b) + sum(ddq), 24.0_wp, 1.0e-15_wp, 'an expectation that knows nothing changes nothing')
    call expectation%remember(1.0_wp, [1.0_wp, 2.0_wp], [3.0_wp])
    call expectation%continue_to(5.0_wp, b, ddq)
    call test%near(maxval(abs([b - [1.0_wp, 2.0_wp], ddq - 3.0_wp])), 0.0_wp, 1.0e-15_wp, &
                   'an expectation from one time is its values')
    call expectation%remember(3.0_wp, [2.0_wp, 0.0_wp], [7.0_wp])
    call expectation%remember(3.0_wp, [5.0_wp, 5.0_wp], [5.0_wp])
    call expectation%continue_to(4.0_wp, b, ddq)
    call test%near(maxval(abs([b - [2.5_wp, -1.0_wp], ddq - 9.0_wp])), 0.0_wp, 1.0e-14_wp, &
                   'an expectation from two times is a straight line')
    call expectation%remember(4.0_wp, [2.0_wp, 0.0_wp], [8.0_wp])
    call expectation%continue_to(6.0_wp, b, ddq)
    call test%near(maxval(abs([b - [2.0_wp, 0.0_wp], ddq - 10.0_wp])), 0.0_wp, 1.0e-14_wp, &
                   'an expectation from three times is a line through the last two')
  end subroutine expectations
end module test_dense_output
