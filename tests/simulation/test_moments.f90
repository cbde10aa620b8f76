!> Computations of simulations at single moments: coefficients of motion and impulses of drives in closed form, gimbal lock, the
!> intervals between joints of laws, and the guard of closed chains.
module test_moments
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_singular
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_motion_coefficients, only: find_coefficients
  use mech9_drive_impulse, only: find_impulse
  use mech9_stopped_motion, only: find_lock
  use mech9_smooth_interval, only: smooth_interval_type
  use mech9_closure_guard, only: check_closure
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Rods of a length with a mass at their ends.
  real(wp), parameter :: m = 2.0_wp, l = 0.8_wp
  character(len=*), parameter :: double_pendulum = '&structure cq=1,2 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0,-0.8,0, moving_point=0,0,0 / '// &
    '&body link=2, mass=2, centre=0,-0.8,0 / &body link=3, mass=2, centre=0,-0.8,0 / '// &
    '&initial coordinate=1, position=0.3 / &initial coordinate=2, position=0.9 / '
  character(len=*), parameter :: on_slide = '&structure cq=1,2 / '// &
    '&pair coordinate=1, links=1,2, kind=''prismatic'', axis=1,0,0, zero=0,1,0 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, zero=1,0,0 / '// &
    '&body link=2, mass=5 / &body link=3, mass=2, centre=0,-0.8,0 / &initial coordinate=2, position=0.7 / '// &
    '&drive coordinate=1, kind=''polynomial'', coefficients=0 / '
  character(len=*), parameter :: segments = '&load kind=''coordinate'', coordinate=2, force=3, law=''segments'', '// &
    'times=0.5,1,2, values=0,1,0, laws=''harmonic'' / '

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('coefficients')) call coefficients(test)
    if (test%runs('impulse')) call impulse(test)
    if (test%runs('impulse_of_rods')) call impulse_of_rods(test)
    if (test%runs('locks')) call locks(test)
    if (test%runs('intervals')) call intervals(test)
    if (test%runs('backwards')) call backwards(test)
    if (test%runs('motor_limit')) call motor_limit(test)
    if (test%runs('guard')) call guard(test)
  end subroutine run

  !> The plan of a model, and its position.
  subroutine prepare(test, text, model, plan, state)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< of a data file
    type(model_type), intent(out) :: model     !< the model
    type(plan_type), intent(out) :: plan       !< its plan
    type(state_type), intent(out) :: state     !< its position
    type(error_type), allocatable :: err

    call model_from_text(test, text, dynamics, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'there is a plan')
  end subroutine prepare

  !> Those of the double pendulum with the angle c between its rods: m l^2 (3 + 2 cos c, 1 + cos c; 1 + cos c, 1).
  subroutine coefficients(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: a(:, :)

    call prepare(test, double_pendulum, model, plan, state)
    state%dq = [0.5_wp, -1.0_wp]
    call find_coefficients(model%mechanism, plan, state, a, err)
    call test%no_error(err, 'there are coefficients')
    ! sums of a few products of numbers of order one
    call test%near(maxval(abs([a(1, 1), a(2, 1), a(2, 2)] - m*l**2*[3.0_wp + 2.0_wp*cos(0.9_wp), 1.0_wp + cos(0.9_wp), 1.0_wp])), &
                   0.0_wp, 1.0e-14_wp, 'the coefficients are those of the closed form')
  end subroutine coefficients

  !> A slide that is pushed to another rate turns the pendulum on it by -cos q/l per rate: nothing turns it about its pin.
  subroutine impulse(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: changes(2, 3)

    changes = reshape([1.0_wp, 0.0_wp, -0.3_wp, 0.0_wp, 0.0_wp, 0.0_wp], [2, 3])
    call push(test, on_slide, changes)
    call test%near(maxval(abs(changes(1, :) - [1.0_wp, -0.3_wp, 0.0_wp])), 0.0_wp, 0.0_wp, 'driven rates change as given')
    call test%near(maxval(abs(changes(2, :) + cos(0.7_wp)/l*changes(1, :))), 0.0_wp, 1.0e-14_wp, 'the pendulum turns')
  end subroutine impulse

  !> The upper rod of a double pendulum is driven: the lower one keeps its moment of momentum about the pin, so that its angle changes by
  !> -(1 + cos c) per rate.
  subroutine impulse_of_rods(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: changes(2, 1)

    changes(:, 1) = [2.0_wp, 0.0_wp]
    call push(test, double_pendulum//'&drive coordinate=1, kind=''polynomial'', coefficients=0.3 / ', changes)
    call test%near(changes(2, 1), -2.0_wp*(1.0_wp + cos(0.9_wp)), 1.0e-14_wp, 'the lower rod turns back')
  end subroutine impulse_of_rods

  !> The changes of free rates of a mechanism.
  subroutine push(test, text, changes)
    type(tester_type), intent(inout) :: test     !< counts the checks
    character(len=*), intent(in) :: text         !< of a data file
    real(wp), intent(inout) :: changes(:, :)     !< (M,several) of the rates; those of driven ones are given
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(error_type), allocatable :: err

    call prepare(test, text, model, plan, state)
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    call find_impulse(model, plan, dynamics, state, work, changes, err)
    call test%no_error(err, 'there is an impulse')
  end subroutine push

  !> Two coordinates that can move together without moving any mass are in lock, whatever their units; a nearly singular matrix is no
  !> lock where that of the start was like it.
  subroutine locks(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: unit(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    real(wp) :: a(3, 3), scaled(3, 3), units(3)
    integer :: i, j

    ! coordinates 1 and 3 turn about the same line
    a = unit
    a(3, 1) = 1.0_wp - 1.0e-15_wp
    units = [1.0e3_wp, 1.0_wp, 1.0e-4_wp]
    do i = 1, 3
      do j = 1, 3
        scaled(i, j) = a(i, j)*units(i)*units(j)
      end do
    end do
    call test%is_true(all(find_lock(a, unit) .eqv. [.true., .false., .true.]), 'both are in lock')
    call test%is_true(all(find_lock(scaled, unit) .eqv. [.true., .false., .true.]), 'in other units, too')
    call test%is_true(.not. any(find_lock(unit, unit)), 'a regular matrix is in no lock')
    call test%is_true(.not. any(find_lock(a, a)), 'nor is one as at the start')
  end subroutine locks

  !> Segments between 0.5, 1 and 2 s: an interval ends at the next of these times.
  subroutine intervals(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(smooth_interval_type) :: interval

    call prepare(test, on_slide//segments//'&time end=3 / ', model, plan, state)
    call interval%begin(model, 0.0_wp)
    call test%is_true(interval%ends, 'there are joints')
    call test%near(interval%ahead, 0.5_wp, 0.0_wp, 'the first one')
    call interval%begin(model, 0.5_wp)
    call test%near(interval%ahead, 1.0_wp, 0.0_wp, 'from a joint to the next one')
    call test%is_true(interval%time_inside(0.5_wp) > 0.5_wp .and. interval%time_inside(1.0_wp) < 1.0_wp, 'its ends lie inside')
    ! a little more than round-off
    call test%near(interval%time_inside(0.5_wp), 0.5_wp, 1.0e-9_wp, 'close to its beginning')
    call test%near(interval%time_inside(1.0_wp), 1.0_wp, 1.0e-9_wp, 'close to its end')
    call test%near(interval%time_inside(0.7_wp), 0.7_wp, 0.0_wp, 'times within stay')
    call test%is_true(interval%is_end(1.0_wp) .and. .not. interval%is_end(0.9_wp), 'it is known where it ends')
    call interval%end_at_event(0.7_wp, 0, 1, 0, 0, 0)
    call test%near(interval%time_inside(0.7_wp), 0.7_wp, 0.0_wp, 'the time of an event stays, where laws are smooth')
    call interval%end_at_event(1.0_wp, 0, 1, 0, 0, 0)
    call test%is_true(interval%time_inside(1.0_wp) < 1.0_wp, 'but at a joint it lies inside')
    call interval%begin(model, 2.5_wp)
    call test%is_true(interval%ahead >= huge(1.0_wp), 'after the last joint none comes')
    call test%is_true(.not. interval%is_end(2.9_wp), 'nothing ends')
  end subroutine intervals

  !> Backwards in time the same joints come in the other order.
  subroutine backwards(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(smooth_interval_type) :: interval

    call prepare(test, on_slide//segments//'&time start=3, end=0 / ', model, plan, state)
    call interval%begin(model, 3.0_wp)
    call test%near(interval%ahead, 2.0_wp, 0.0_wp, 'the last joint comes first')
    call interval%begin(model, 1.0_wp)
    call test%near(interval%ahead, 0.5_wp, 0.0_wp, 'then the one before')
    call test%is_true(interval%time_inside(1.0_wp) < 1.0_wp .and. interval%time_inside(0.5_wp) > 0.5_wp, 'its ends lie inside')
  end subroutine backwards

  !> Without joints an interval has no end, until a motor passes its limit.
  subroutine motor_limit(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(smooth_interval_type) :: interval

    call prepare(test, on_slide//'&time end=3 / ', model, plan, state)
    call interval%begin(model, 0.0_wp)
    call test%is_true(.not. interval%ends, 'there is no joint')
    call test%near(interval%time_inside(0.0_wp), 0.0_wp, 0.0_wp, 'all times stay')
    call interval%end_at_event(1.5_wp, 2, 0, 0, 0, 0)
    call test%is_true(interval%is_end(1.5_wp) .and. interval%motor == 2, 'it ends where a motor passes its limit')
  end subroutine motor_limit

  !> A position is refused where a gap is no round-off of the mechanism's size.
  subroutine guard(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err

    call prepare(test, double_pendulum, model, plan, state)
    call check_closure(plan, 0.5_wp, 1.0e-15_wp*plan%length, err)
    call test%no_error(err, 'round-off is closed')
    call check_closure(plan, 0.5_wp, 0.1_wp*plan%length, err)
    call test%has_error(err, exit_singular, 'a tenth of the size is open')
    if (.not. allocated(err)) return
    call test%near(err%failure%t, 0.5_wp, 0.0_wp, 'the failure tells its time')
    call test%near(err%failure%gap, 0.1_wp*plan%length, 0.0_wp, 'and its gap')
  end subroutine guard
end module test_moments
