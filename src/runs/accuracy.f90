!> Tolerances by which a free motion has the accuracy that is asked for, and its errors, estimated from other runs.
!>
!> The motion is run with small tolerances, and with others that are ten thousand times as large. The difference is the error of
!> the second run, since that of the first is small beside it. (Estimates from the steps alone do not know how the motion itself
!> enlarges or reduces an error on the way.) The error at the end is nearly proportional to the tolerance: where it is too large,
!> it gives the tolerances of the next run.
!>
!> At the least tolerances of a method the first run has an error that is not small: that of round-off, which adds up
!> over its steps. A run with twice these tolerances makes other steps and shows it, with a margin since runs by one
!> method share a part of it. Where this is not small against the accuracy, a run by prince-dormand, which loses least,
!> is the reference. Where no larger tolerances serve, the run with the least ones is judged, too. Where `auto` cannot
!> have the accuracy by backward differences, prince-dormand makes all steps. In a very stiff motion it would make too
!> many: then it is neither the reference nor the result.
module mech9_accuracy
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, exit_interrupted
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: point_motion
  use mech9_integration_methods, only: integration_method_type, integration_methods, method_index, &
    least_tolerance, automatic, prince_dormand_table
  use mech9_integration_failure, only: check_method
  use mech9_integrator, only: integration_statistics_type
  use mech9_simulation, only: simulation_type, interruption_type, estimated_errors_type
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  implicit none
  private
  public :: find_accuracy

  !> The largest tolerance of a first run: steps of no tolerance at all may meet what the motion does not.
  real(wp), parameter :: loosest = 1.0e-3_wp
  !> Tolerances of the reference run, as a part of those of the run that is judged. With a hundredth the largest
  !> error is right to a third, but small errors at single outputs are wrong by up to 800 times; with this part, by three.
  real(wp), parameter :: control_part = 1.0e-4_wp
  !> The largest such part by which a run is judged again without another reference run.
  real(wp), parameter :: largest_part = 1.0e-3_wp
  !> An estimate that is this part of the allowed error may be wrong by the rest.
  real(wp), parameter :: certain_part = 0.8_wp
  !> Part of the allowed error that the next tolerances aim at.
  real(wp), parameter :: aimed_part = 0.3_wp
  !> Runs that are judged, before the least tolerances are taken.
  integer, parameter :: most_trials = 6
  !> Tolerances of the run that shows the round-off of another one by the same method, over those of this one.
  real(wp), parameter :: tolerance_of_other = 2.0_wp
  !> The error of a run by prince-dormand with the least tolerances, over this difference: it is as large if it is truncation.
  real(wp), parameter :: of_difference = 2.0_wp
  !> The same by another method, whose runs share a part of their round-off: six was measured (bdf on the stiff governor).
  real(wp), parameter :: of_difference_shared = 10.0_wp
  !> Such an error that is below this part of the allowed one need not be known better.
  real(wp), parameter :: small_part = 0.1_wp
  !> Steps of a run by prince-dormand, over those of the run that it is to judge, at most. A step takes some four times as long
  !> as one of bdf.
  integer, parameter :: most_steps = 30

  !> The course of a run: recorded coordinates and points at the outputs.
  type :: course_type
    integer :: outputs = 0                         !< reached
    logical :: is_implicit = .false.               !< some of its steps were those of an implicit method
    logical :: is_too_long = .false.               !< it ended since it took more steps than it may
    integer(long) :: steps = 0                     !< of the integrator
    real(wp) :: tolerance = 1.0_wp                 !< relative, and absolute [rad, m, per s]
    real(wp), allocatable :: places(:, :)          !< (values, outputs) [unit of the file]
    type(error_type), allocatable :: failure       !< by which the run ended before the last output
  end type course_type

  !> A search for tolerances.
  type :: search_type
    type(model_type), pointer :: model => null()             !< its tolerances and its method change; not owned
    type(plan_type), pointer :: plan => null()               !< its plan; not owned
    type(state_type), pointer :: assembled => null()         !< its closed position; not owned
    logical :: pictures = .false.                            !< the motion of all links is requested
    class(interruption_type), pointer :: interruption => null()   !< of the user; null: there is none; not owned
    type(integration_method_type) :: method                  !< makes the steps
    real(wp) :: least = 0.0_wp                               !< its least tolerance
    logical :: is_met = .false.                              !< the errors are below the allowed one
    type(course_type) :: with_least                          !< the run with the least tolerances, as soon as there is one
    type(course_type) :: reference                           !< the run with small tolerances
    logical :: is_too_stiff = .false.                        !< prince-dormand would take too many steps
    real(wp), allocatable :: round_off(:)                    !< (outputs) error of the reference; 0: small beside others [unit of the file]
  end type search_type

  !> A run stops where the user wants it, or after a number of steps.
  type, extends(interruption_type) :: step_limit_type
    class(interruption_type), pointer :: of_user => null()   !< null: the user cannot interrupt; not owned
    integer(long), pointer :: left => null()                 !< steps that are left; not owned
  contains
    procedure :: is_wanted
    procedure :: watch
  end type step_limit_type

contains

  !> Find tolerances by which the motion has the accuracy that its request asks for, and the errors of the run with them. Where
  !> no tolerance gives this accuracy, the errors are those of the least one. Fails where the user interrupts.
  subroutine find_accuracy(model, plan, assembled, errors, err, pictures, interruption)
    type(model_type), intent(inout) :: model                         !< with an accuracy; gets the tolerances, and perhaps another method
    type(plan_type), intent(in), target :: plan                      !< its plan
    type(state_type), intent(in), target :: assembled                !< its closed position, with the independent rates
    type(estimated_errors_type), intent(out) :: errors               !< of the run with these tolerances
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    logical, intent(in), optional :: pictures                        !< the motion of all links is requested; not unless given
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the runs shall stop
    class(model_type), allocatable, target :: varied
    type(search_type) :: search
    integer :: method

    allocate (varied, source=model)
    varied%request%solver%accuracy = 0.0_wp
    call check_method(model%request%solver%method, method, err)
    if (allocated(err)) return
    search%model => varied
    search%plan => plan
    search%assembled => assembled
    if (present(pictures)) search%pictures = pictures
    if (present(interruption)) search%interruption => interruption
    search%method = integration_methods(method)
    search%least = least_tolerance(search%method)
    if (search%method%family == automatic) search%least = least_tolerance(best_method())
    errors%allowed = model%request%solver%accuracy
    call find_tolerance(search, errors, err)
    if (allocated(err)) return
    if (.not. search%is_met .and. search%with_least%is_implicit .and. search%method%family == automatic) then
      if (search%is_too_stiff) then
        errors%limit_of_steps = most_steps
      else
        search%method = best_method()
        search%least = least_tolerance(search%method)
        search%with_least = search%reference
        call find_tolerance(search, errors, err)
      end if
    end if
    model%request%solver%method = errors%method
    model%request%solver%relative_tolerance = errors%tolerance
    model%request%solver%absolute_tolerance = errors%tolerance
  end subroutine find_accuracy

  !> The method that loses least by round-off.
  pure type(integration_method_type) function best_method()
    best_method = integration_methods(method_index('prince-dormand'))
  end function best_method

  !> Find the tolerances by the method of the search, and the errors of the run with them.
  subroutine find_tolerance(search, errors, err)
    type(search_type), intent(inout) :: search             !< by one method; a reference that is known already stays
    type(estimated_errors_type), intent(inout) :: errors   !< with the allowed one; get method, tolerance and errors
    type(error_type), allocatable, intent(out) :: err      !< allocated if the user interrupts
    type(course_type) :: judged
    real(wp) :: tolerance
    integer :: trial

    errors%method = trim(search%method%name)
    associate (units => search%model%mechanism%units)
      tolerance = min(loosest, max(0.1_wp*errors%allowed*min(units%length, units%angle), 10.0_wp*search%least))
    end associate
    do trial = 1, most_trials
      if (trial == most_trials) tolerance = search%least
      if (search%reference%tolerance > max(largest_part*tolerance, search%least)) then
        call find_reference(search, max(control_part*tolerance, search%least), errors, err)
        if (allocated(err)) return
      end if
      if (tolerance <= 10.0_wp*search%least) exit
      call run(search, search%method, tolerance, judged, errors, err)
      if (allocated(err)) return
      call judge(search, judged, certain_part*errors%allowed, errors)
      if (search%is_met) return
      tolerance = next_tolerance(tolerance, maxval(errors%at), errors%allowed)
    end do
    call judge(search, search%with_least, errors%allowed, errors)
  end subroutine find_tolerance

  !> The errors of a run, with the round-off of the reference.
  subroutine judge(search, judged, largest, errors)
    type(search_type), intent(inout) :: search             !< with the reference
    type(course_type), intent(in) :: judged                !< the run
    real(wp), intent(in) :: largest                        !< error by which the accuracy is met [unit of the file]
    type(estimated_errors_type), intent(inout) :: errors   !< get tolerance and errors

    call compare(search%reference, judged, errors)
    errors%at = errors%at + search%round_off(:size(errors%at))
    errors%tolerance = judged%tolerance
    search%is_met = maxval(errors%at) <= largest
  end subroutine judge

  !> The reference run. With the least tolerances it has an error by round-off. Where this counts, prince-dormand's run
  !> is the reference, unless it takes too many steps.
  subroutine find_reference(search, tolerance, errors, err)
    type(search_type), intent(inout) :: search             !< gets this run and its round-off
    real(wp), intent(in) :: tolerance                      !< relative, and absolute [rad, m, per s]
    type(estimated_errors_type), intent(inout) :: errors   !< counts the work
    type(error_type), allocatable, intent(out) :: err      !< allocated if the user interrupts
    type(course_type) :: best

    call run(search, search%method, tolerance, search%reference, errors, err)
    if (allocated(err)) return
    if (allocated(search%round_off)) deallocate (search%round_off)
    allocate (search%round_off(search%reference%outputs), source=0.0_wp)
    if (search%reference%is_implicit) search%least = least_tolerance(search%method)
    if (tolerance > search%least) return
    search%with_least = search%reference
    if (search%method%family == automatic .and. .not. search%reference%is_implicit .or. &
        search%method%table == prince_dormand_table) then
      call find_round_off(search, best_method(), of_difference, errors, err)
      return
    end if
    call find_round_off(search, search%method, of_difference_shared, errors, err)
    if (allocated(err)) return
    if (maxval(search%round_off) <= small_part*errors%allowed) return
    call run(search, best_method(), least_tolerance(best_method()), best, errors, err, most_steps*search%with_least%steps)
    if (allocated(err)) return
    search%is_too_stiff = best%is_too_long
    if (search%is_too_stiff) return
    search%reference = best
    call find_round_off(search, best_method(), of_difference, errors, err)
  end subroutine find_reference

  !> The round-off of the reference, from another run by the same method.
  subroutine find_round_off(search, method, factor, errors, err)
    type(search_type), intent(inout) :: search             !< with the reference; gets its round-off
    type(integration_method_type), intent(in) :: method    !< by which it was run
    real(wp), intent(in) :: factor                         !< error over difference
    type(estimated_errors_type), intent(inout) :: errors   !< counts the work
    type(error_type), allocatable, intent(out) :: err      !< allocated if the user interrupts
    type(course_type) :: other
    type(estimated_errors_type) :: differences
    integer :: i

    call run(search, method, tolerance_of_other*least_tolerance(method), other, errors, err)
    if (allocated(err)) return
    call compare(search%reference, other, differences)
    search%reference%outputs = size(differences%at)
    if (allocated(differences%failure)) search%reference%failure = differences%failure
    search%round_off = [(factor*maxval(differences%at(:i)), i=1, size(differences%at))]
  end subroutine find_round_off

  !> A smaller tolerance, from the error of a run. One that is much too large says little about the next one.
  pure real(wp) function next_tolerance(tolerance, error, allowed)
    real(wp), intent(in) :: tolerance   !< of the run
    real(wp), intent(in) :: error       !< largest one of the run [unit of the file]
    real(wp), intent(in) :: allowed     !< largest error that is allowed [unit of the file]

    next_tolerance = tolerance*min(0.5_wp, max(1.0e-3_wp, aimed_part*allowed/error))
  end function next_tolerance

  !> Run the motion with a tolerance. A failure of the motion itself stays in the course; an interruption ends all runs.
  subroutine run(search, method, tolerance, course, errors, err, steps_allowed)
    type(search_type), intent(in) :: search                !< its model gets method and tolerance
    type(integration_method_type), intent(in) :: method    !< of the run
    real(wp), intent(in) :: tolerance                      !< relative, and absolute [rad, m, per s]
    type(course_type), intent(out) :: course               !< of the run
    type(estimated_errors_type), intent(inout) :: errors   !< counts the work
    type(error_type), allocatable, intent(out) :: err      !< allocated if the user interrupts
    integer(long), intent(in), optional :: steps_allowed   !< after these the run ends; any number if absent
    type(free_simulation_type), target :: simulation
    type(integration_statistics_type) :: counts
    type(step_limit_type) :: limit
    integer(long), target :: left
    integer :: i

    course%tolerance = tolerance
    left = huge(left)
    if (present(steps_allowed)) left = steps_allowed
    limit%left => left
    limit%of_user => search%interruption
    associate (model => search%model)
      model%request%solver%method = trim(method%name)
      model%request%solver%relative_tolerance = tolerance
      model%request%solver%absolute_tolerance = tolerance
      allocate (course%places(count(model%request%output%recorded(size(model%mechanism%pairs))) + 3*size(model%mechanism%points), &
                              0:model%request%time%intervals))
      call new_free_simulation(model, search%plan, search%assembled, simulation, course%failure, search%pictures)
      simulation%with_energies = .false.
      simulation%with_conditioning = .false.
      do i = 0, model%request%time%intervals
        if (allocated(course%failure)) exit
        if (i == 0) then
          call simulation%start(course%failure, limit)
        else
          call simulation%advance(model%request%time%time(i), course%failure)
        end if
        if (allocated(course%failure)) exit
        call take_places(model, simulation, course%places(:, i))
        course%outputs = i + 1
      end do
    end associate
    counts = simulation%motion%statistics()
    course%is_implicit = counts%implicit_steps > 0
    course%steps = counts%steps
    errors%runs = errors%runs + 1
    errors%evaluations = errors%evaluations + counts%rate_evaluations
    call simulation%close()
    if (.not. allocated(course%failure)) return
    if (course%failure%code /= exit_interrupted) return
    course%is_too_long = left < 0
    if (.not. course%is_too_long) call move_alloc(course%failure, err)
  end subroutine run

  !> Whether the user wants a run to stop, or its steps are used up. The runs ask before each step.
  logical function is_wanted(self)
    class(step_limit_type), intent(in) :: self   !< the limit

    is_wanted = .false.
    if (associated(self%of_user)) is_wanted = self%of_user%is_wanted()
    if (is_wanted) return
    self%left = self%left - 1
    is_wanted = self%left < 0
  end function is_wanted

  !> Let the user's interruption see where a run stands.
  subroutine watch(self, simulation)
    class(step_limit_type), intent(inout) :: self          !< the limit
    class(simulation_type), intent(inout) :: simulation    !< the run

    if (associated(self%of_user)) call self%of_user%watch(simulation)
  end subroutine watch

  !> The recorded coordinates and points of the present position.
  subroutine take_places(model, simulation, places)
    type(model_type), intent(in) :: model                            !< the model
    type(free_simulation_type), intent(in), target :: simulation     !< the motion
    real(wp), intent(out) :: places(:)                               !< coordinates, and points in the axes of link 1 [unit of the file]
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    logical :: recorded(size(model%mechanism%pairs))
    integer :: i, k, n

    call simulation%present(plan, state)
    places = 0.0_wp
    recorded = model%request%output%recorded(size(recorded))
    n = 0
    do k = 1, size(recorded)
      if (.not. recorded(k)) cycle
      n = n + 1
      places(n) = state%q(k)/plan%result_unit(k)
    end do
    do i = 1, size(model%mechanism%points)
      associate (point => model%mechanism%points(i))
        call point_motion(plan, state, point%link, point%position, places(n + 1:n + 3))
        places(n + 1:n + 3) = places(n + 1:n + 3)/model%mechanism%units%length
      end associate
      n = n + 3
    end do
  end subroutine take_places

  !> The errors of a run at the outputs that it and the reference reached. None is less than the last digit of the numbers.
  pure subroutine compare(reference, judged, errors)
    type(course_type), intent(in) :: reference             !< the run with small tolerances
    type(course_type), intent(in) :: judged                !< the other run
    type(estimated_errors_type), intent(inout) :: errors   !< gets the errors, and the failure that ended one of the runs
    integer :: i, n

    n = min(reference%outputs, judged%outputs)
    if (allocated(errors%at)) deallocate (errors%at)
    allocate (errors%at(n))
    do i = 1, n
      associate (a => reference%places(:, i - 1), b => judged%places(:, i - 1))
        errors%at(i) = max(maxval(abs(a - b)), spacing(maxval(abs(a))))
      end associate
    end do
    if (allocated(errors%failure)) deallocate (errors%failure)
    if (allocated(reference%failure) .and. reference%outputs == n) then
      errors%failure = reference%failure
    else if (allocated(judged%failure)) then
      errors%failure = judged%failure
    end if
  end subroutine compare
end module mech9_accuracy
