!> Motions followed from their start, for tests that hold them against closed forms.
module mech9_followed_motions
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_tolerances, only: near_singular
  use mech9_planning, only: make_plan
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, set_inputs
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: begin_motion, angle_between, at_crossing

  !> Round-off of closing a chain, some units [rad, m of mechanisms of 1 m].
  real(wp), parameter :: round_off = 1.0e-15_wp
  !> The least pivot at the positions beside a crossing between which a polynomial leads through it: the first is taken where
  !> the pivot falls below `near_singular`, the second halfway from there, and a step halves pivots at most.
  real(wp), parameter :: pivot = 0.25_wp*near_singular
  !> Largest errors within a crossing: of positions, of rates over the fastest rate, of accelerations over its square. Round-off
  !> over the pivot is left in a position, and once more over the pivot in each derivative; the polynomial of twelve terms
  !> multiplies them by some tens.
  real(wp), parameter :: at_crossing(0:2) = 40.0_wp*round_off/[pivot, pivot**2, pivot**3]

contains

  !> Plan and assemble at time t, and start there. Without a position the test ends.
  subroutine begin_motion(test, model, t, plan, driven, start_error)
    type(tester_type), intent(inout) :: test                              !< counts the checks
    type(model_type), intent(in) :: model                                 !< the model
    real(wp), intent(in) :: t                                             !< time of the start [s]
    type(plan_type), intent(out) :: plan                                  !< its plan
    type(driven_motion_type), intent(out) :: driven                       !< its driven motion, at the start
    type(error_type), allocatable, intent(out), optional :: start_error   !< of a start that need not go well
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), dimension(size(model%mechanism%pairs)) :: q, dq, ddq

    q = model%problem%initial%position
    call set_inputs(model%problem%drives, t, q, dq, ddq, err)
    call test%no_error(err, 'drives have values')
    call make_plan(model%mechanism, model%problem%partition, q, plan, state, err)
    call test%no_error(err, 'the mechanism has a plan and is assembled')
    if (allocated(err)) call test%finish()
    call start_driven_motion(model%problem%drives, plan, state, t, driven, err)
    if (present(start_error)) then
      call move_alloc(err, start_error)
    else
      call test%no_error(err, 'start')
    end if
  end subroutine begin_motion

  !> The distance of two angles, whole turns aside [rad].
  elemental real(wp) function angle_between(a, b)
    real(wp), intent(in) :: a   !< first angle [rad]
    real(wp), intent(in) :: b   !< second angle [rad]

    angle_between = abs(modulo(a - b + pi, 2.0_wp*pi) - pi)
  end function angle_between
end module mech9_followed_motions
