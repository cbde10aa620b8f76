!> Tolerances by which a free motion has the accuracy that is asked for, and its errors, which other runs tell.
!>
!> The motion is run with small tolerances, and with others that are ten thousand times as large. The difference is the error of
!> the second run, since that of the first is small beside it. (Estimates from the steps alone do not know how the motion itself
!> enlarges or reduces an error on the way.) The error at the end is nearly proportional to the tolerance: where it is too large,
!> it tells the tolerances of the next run.
module mech9_accuracy
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, exit_interrupted
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: point_motion
  use mech9_integration_methods, only: integration_methods, method_index, least_tolerance, automatic
  use mech9_integration_failure, only: check_method
  use mech9_integrator, only: integration_statistics_type
  use mech9_simulation, only: interruption_type, estimated_errors_type
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  implicit none
  private
  public :: find_accuracy

  !> The largest tolerance of a first run: steps of no tolerance at all may meet what the motion does not.
  real(wp), parameter :: loosest = 1.0e-3_wp
  !> Tolerances of the run that stands for the truth, as a part of those of the run that is judged. With a hundredth the largest
  !> error is right to a third, but small errors at single outputs are wrong by up to 800 times; with this part, by three.
  real(wp), parameter :: control_part = 1.0e-4_wp
  !> The largest such part by which a run is judged again without another run that stands for the truth.
  real(wp), parameter :: largest_part = 1.0e-3_wp
  !> An estimate that is this part of the allowed error may be wrong by the rest.
  real(wp), parameter :: certain_part = 0.8_wp
  !> Part of the allowed error that the next tolerances aim at.
  real(wp), parameter :: aimed_part = 0.3_wp
  !> Runs that are judged, before the least tolerances are taken.
  integer, parameter :: most_trials = 6

  !> The course of a run: recorded coordinates and points at the outputs.
  type :: course_type
    integer :: outputs = 0                         !< reached
    logical :: is_implicit = .false.               !< some of its steps were those of an implicit method
    real(wp), allocatable :: places(:, :)          !< (values, outputs) [rad, m]
    integer(long) :: evaluations = 0               !< of the accelerations
    type(error_type), allocatable :: failure       !< by which the run ended before the last output
  end type course_type

contains

  !> Find tolerances by which the motion has the accuracy that its request asks for, and the errors of the run with them. Where
  !> no tolerance gives this accuracy, the errors are those of the least one. Fails where the user interrupts.
  subroutine find_accuracy(model, plan, assembled, errors, err, pictures, interruption)
    type(model_type), intent(inout) :: model                         !< the model, with an accuracy; gets the tolerances
    type(plan_type), intent(in) :: plan                              !< its plan
    type(state_type), intent(in) :: assembled                        !< its closed position, with the independent rates
    type(estimated_errors_type), intent(out) :: errors               !< of the run with these tolerances
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    logical, intent(in), optional :: pictures                        !< the motion of all links is requested; not unless given
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the runs shall stop
    type(model_type), target :: varied
    type(course_type) :: truth, judged
    real(wp) :: tolerance, control, least
    integer :: method, trial

    varied = model
    varied%request%solver%accuracy = 0.0_wp
    call check_method(model%request%solver%method, method, err)
    if (allocated(err)) return
    least = least_tolerance(integration_methods(method))
    if (integration_methods(method)%family == automatic) &
      least = least_tolerance(integration_methods(method_index('prince-dormand')))
    errors%allowed = model%request%solver%accuracy
    tolerance = min(loosest, max(0.1_wp*errors%allowed, 10.0_wp*least))
    control = 1.0_wp
    do trial = 1, most_trials
      if (control > largest_part*tolerance .and. control > least) then
        control = max(control_part*tolerance, least)
        call run(varied, plan, assembled, control, truth, errors, err, pictures, interruption)
        if (allocated(err)) return
        if (truth%is_implicit) least = least_tolerance(integration_methods(method))
        tolerance = max(tolerance, 10.0_wp*least)
      end if
      call run(varied, plan, assembled, tolerance, judged, errors, err, pictures, interruption)
      if (allocated(err)) return
      call compare(truth, judged, errors)
      model%request%solver%relative_tolerance = tolerance
      model%request%solver%absolute_tolerance = tolerance
      if (maxval(errors%at) <= certain_part*errors%allowed .or. tolerance <= 10.0_wp*least) return
      tolerance = max(10.0_wp*least, next_tolerance(tolerance, maxval(errors%at), errors%allowed))
      if (trial == most_trials - 1) tolerance = 10.0_wp*least
    end do
  end subroutine find_accuracy

  !> A smaller tolerance, from the error of a run. One that is much too large says little about the next one.
  pure real(wp) function next_tolerance(tolerance, error, allowed)
    real(wp), intent(in) :: tolerance   !< of the run
    real(wp), intent(in) :: error       !< largest one of the run [rad, m]
    real(wp), intent(in) :: allowed     !< largest error that is allowed [rad, m]

    next_tolerance = tolerance*min(0.5_wp, max(1.0e-3_wp, aimed_part*allowed/error))
  end function next_tolerance

  !> Run the motion with a tolerance. A failure of the motion itself stays in the course; an interruption ends all runs.
  subroutine run(model, plan, assembled, tolerance, course, errors, err, pictures, interruption)
    type(model_type), intent(inout), target :: model                 !< gets the tolerance
    type(plan_type), intent(in) :: plan                              !< its plan
    type(state_type), intent(in) :: assembled                        !< its closed position, with the independent rates
    real(wp), intent(in) :: tolerance                                !< relative, and absolute [rad, m, per s]
    type(course_type), intent(out) :: course                         !< of the run
    type(estimated_errors_type), intent(inout) :: errors             !< counts the work
    type(error_type), allocatable, intent(out) :: err                !< allocated if the user interrupts
    logical, intent(in), optional :: pictures                        !< the motion of all links is requested; not unless given
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the run shall stop
    type(free_simulation_type), target :: simulation
    type(integration_statistics_type) :: counts
    integer :: i, n

    model%request%solver%relative_tolerance = tolerance
    model%request%solver%absolute_tolerance = tolerance
    n = size(model%mechanism%pairs)
    allocate (course%places(count(model%request%output%recorded(n)) + 3*size(model%mechanism%points), &
                            0:model%request%time%intervals))
    call new_free_simulation(model, plan, assembled, simulation, course%failure, pictures)
    simulation%with_energies = .false.
    simulation%with_conditioning = .false.
    do i = 0, model%request%time%intervals
      if (allocated(course%failure)) exit
      if (i == 0) then
        call simulation%start(course%failure, interruption)
      else
        call simulation%advance(model%request%time%time(i), course%failure)
      end if
      if (allocated(course%failure)) exit
      call take_places(model, simulation, course%places(:, i))
      course%outputs = i + 1
    end do
    counts = simulation%motion%statistics()
    course%is_implicit = counts%implicit_steps > 0
    errors%runs = errors%runs + 1
    errors%evaluations = errors%evaluations + counts%rate_evaluations
    call simulation%close()
    if (.not. allocated(course%failure)) return
    if (course%failure%code == exit_interrupted) call move_alloc(course%failure, err)
  end subroutine run

  !> The recorded coordinates and points of the present position.
  subroutine take_places(model, simulation, places)
    type(model_type), intent(in) :: model                            !< the model
    type(free_simulation_type), intent(in), target :: simulation     !< the motion
    real(wp), intent(out) :: places(:)                               !< coordinates, and points in the axes of link 1 [rad, m]
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    integer :: i, n

    call simulation%present(plan, state)
    places = 0.0_wp
    n = count(model%request%output%recorded(size(state%q)))
    places(:n) = pack(state%q, model%request%output%recorded(size(state%q)))
    do i = 1, size(model%mechanism%points)
      associate (point => model%mechanism%points(i))
        call point_motion(plan, state, point%link, point%position, places(n + 1:n + 3))
      end associate
      n = n + 3
    end do
  end subroutine take_places

  !> The errors of a run at the outputs that it and the truth reached. None is less than the last digit of the numbers.
  pure subroutine compare(truth, judged, errors)
    type(course_type), intent(in) :: truth                 !< the run with small tolerances
    type(course_type), intent(in) :: judged                !< the other run
    type(estimated_errors_type), intent(inout) :: errors   !< gets the errors, and the failure that ended one of the runs
    integer :: i, n

    n = min(truth%outputs, judged%outputs)
    if (allocated(errors%at)) deallocate (errors%at)
    allocate (errors%at(n))
    do i = 1, n
      associate (a => truth%places(:, i - 1), b => judged%places(:, i - 1))
        errors%at(i) = max(maxval(abs(a - b)), spacing(maxval(abs(a))))
      end associate
    end do
    if (allocated(errors%failure)) deallocate (errors%failure)
    if (allocated(truth%failure) .and. truth%outputs == n) then
      errors%failure = truth%failure
    else if (allocated(judged%failure)) then
      errors%failure = judged%failure
    end if
  end subroutine compare
end module mech9_accuracy
