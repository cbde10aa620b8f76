!> Integration of a system of equations step by step, by a method chosen by name.
module mech9_integrator
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, raise, exit_integrator
  use mech9_ode_failures, only: failure_many_steps
  use mech9_ode_system, only: ode_system_type
  use mech9_integration_methods, only: integration_methods, tolerance_share, runge_kutta, automatic
  use mech9_stepper, only: stepper_type, stepper_counts_type, tolerances_type, stepped, evaluation_failed
  use mech9_sundials_stepper, only: sundials_stepper_type
  use mech9_sundials_system, only: system_box_type
  use mech9_sundials_runge_kutta, only: runge_kutta_type
  use mech9_sundials_multistep, only: multistep_type
  use mech9_automatic_stepper, only: automatic_type, new_automatic
  use mech9_integration_failure, only: check_method, check_tolerances, fail_by_outcome, fail_by_vanishing_step
  implicit none
  private
  public :: integrator_type, integration_statistics_type, add_statistics

  !> Trials that the system refused, in a row, before the integration is given up; each makes the step
  !> a quarter at most, so that all of them together make it 1e-24 of what it was.
  integer, parameter :: most_refusals = 40
  !> Steps from a start during which the time of the caller need not change: methods begin with steps of 1e-15 s and less, which
  !> grow by 20 and more from one to the next.
  integer, parameter :: most_first_steps = 30

  !> The work of an integration, from its creation on.
  type :: integration_statistics_type
    integer(long) :: steps = 0                  !< accepted
    integer(long) :: rate_evaluations = 0       !< all of them: for differences, too
    integer(long) :: jacobian_evaluations = 0   !< by an implicit method: by the system, or by differences of its rate
    integer(long) :: error_test_failures = 0    !< steps made again because of their error
    integer(long) :: convergence_failures = 0   !< implicit steps made again
    integer(long) :: implicit_steps = 0         !< accepted steps of bdf, of the automatic method
    integer :: method_changes = 0               !< of the automatic method
    integer(long) :: refusals = 0               !< trials that the system refused
    integer :: last_order = 0                   !< of the method in the last step
    real(wp) :: last_step = 0.0_wp              !< length of the last step [s]
  end type integration_statistics_type

  !> An integration under way. It must not be copied; `destroy` frees its memory.
  !>
  !> Its method counts time from where the integration began (the origin of the box), because steps are short beside a large
  !> time: sums of them would lose digits there, and SUNDIALS takes times for equal that differ by 1e-14 of their size.
  type :: integrator_type
    private
    type(system_box_type), pointer :: box => null()
    class(stepper_type), allocatable :: stepper
    real(wp) :: t = 0.0_wp               !< of the last accepted step, from the origin [s]
    real(wp) :: t_given_out = 0.0_wp     !< the same as the caller knows it [s]
    real(wp), allocatable :: y(:)        !< values at t
    real(wp), allocatable :: trial(:)    !< values at the end of the step being made
    logical :: fresh = .true.            !< no step since the creation or the last restart
    logical :: stopped = .false.         !< the last step ended at its stop
    real(wp) :: t_stop = 0.0_wp          !< of the last call [s]
    integer :: maximum_steps = 1000000   !< to one stop
    integer :: steps_to_stop = 0         !< accepted since the last stop was set
    integer :: steps_from_start = 0      !< accepted since the creation or the last restart, 30 at most
    integer(long) :: steps = 0           !< accepted since the creation
  contains
    procedure :: create
    procedure :: step
    procedure :: interpolate
    procedure :: correct
    procedure :: restart
    procedure :: limit
    procedure :: statistics
    procedure :: destroy
  end type integrator_type

contains

  !> Begin at (t, y). The system must have the target attribute (or be a pointer's target), outlive the
  !> integrator, and not be used by others meanwhile. Fails for an unknown method or useless tolerances.
  subroutine create(self, system, method, relative_tolerance, absolute_tolerance, t, y, err)
    class(integrator_type), intent(inout) :: self   !< an integrator, which is destroyed first
    class(ode_system_type), intent(inout), target :: system   !< the equations, which must be no temporary value
    character(len=*), intent(in) :: method              !< name, as in integration_methods; blank: the first one
    real(wp), intent(in) :: relative_tolerance          !< of each part of y, in a step
    real(wp), intent(in) :: absolute_tolerance(:)       !< of each part of y, in its unit
    real(wp), intent(in) :: t                           !< [s]
    real(wp), intent(in) :: y(:)   !< initial values, one for each variable
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(tolerances_type) :: tolerances
    real(wp) :: share
    integer :: index, outcome

    call self%destroy()
    call check_method(method, index, err)
    if (allocated(err)) return
    call check_tolerances(relative_tolerance, absolute_tolerance, size(y), err)
    if (allocated(err)) return
    allocate (self%box)
    self%box%system => system
    self%box%origin = t
    self%t = 0.0_wp
    self%t_given_out = t
    self%t_stop = t
    self%y = y
    self%trial = y
    share = tolerance_share(integration_methods(index), relative_tolerance)
    select case (integration_methods(index)%family)
    case (runge_kutta)
      allocate (runge_kutta_type :: self%stepper)
    case (automatic)
      allocate (automatic_type :: self%stepper)
    case default
      allocate (multistep_type :: self%stepper)
    end select
    tolerances = tolerances_type(relative_tolerance, absolute_tolerance)
    select type (stepper => self%stepper)
    class is (sundials_stepper_type)
      call stepper%start(integration_methods(index), self%box, tolerances%times(share), 0.0_wp, y, outcome)
    type is (automatic_type)
      call new_automatic(self%box, tolerances, 0.0_wp, y, stepper, outcome)
    end select
    if (outcome /= stepped) call fail_by_outcome(self%box, outcome, self%t_given_out, err)
  end subroutine create

  !> Make one accepted step towards t_stop and never beyond, or more where t is so large that one does not change it; the last
  !> one ends exactly there. With `farthest` a step may go on beyond t_stop, to there at most. On failure t and y are
  !> those of the last accepted step.
  subroutine step(self, t_stop, t, y, err, farthest)
    class(integrator_type), intent(inout) :: self       !< the integrator
    real(wp), intent(in) :: t_stop                      !< may lie before the start [s]
    real(wp), intent(inout) :: t                        !< end of the step [s]
    real(wp), intent(inout) :: y(:)                     !< values there
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), intent(in), optional :: farthest          !< in the same direction [s]
    real(wp) :: t_last

    t_last = t_stop
    if (present(farthest)) t_last = farthest
    ! a stop that is the present time but for round-off is reached
    if (.not. abs(t_stop - self%box%origin - self%t) > 0.0_wp) self%t_given_out = t_stop
    t = self%t_given_out
    y = self%y
    if (.not. abs(t_stop - t) > 0.0_wp) return
    do while (.not. abs(self%t_given_out - t) > 0.0_wp)
      call count_steps(self, t_stop, err)
      if (.not. allocated(err)) call take_step(self, t_last, err)
      if (allocated(err)) exit
    end do
    t = self%t_given_out
    y = self%y
  end subroutine step

  !> The method's own approximation of y at a time within the last step, if it has one; see its stepper.
  subroutine interpolate(self, t, y, found)
    class(integrator_type), intent(inout) :: self   !< the integrator
    real(wp), intent(in) :: t                       !< [s]
    real(wp), intent(out) :: y(:)                   !< values at t
    logical, intent(out) :: found                   !< whether the method can compute them; else y has no meaning

    call self%stepper%interpolate(t - self%box%origin, y, found)
  end subroutine interpolate

  !> Count the steps to each stop. Fails when there were too many.
  subroutine count_steps(self, t_stop, err)
    class(integrator_type), intent(inout) :: self       !< the integrator
    real(wp), intent(in) :: t_stop                      !< time at which the steps end [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (abs(t_stop - self%t_stop) > 0.0_wp) then
      self%t_stop = t_stop
      self%steps_to_stop = 0
    end if
    if (self%steps_to_stop < self%maximum_steps) return
    call raise(err, exit_integrator, failure_many_steps)
    err%failure%t = self%t_given_out
    err%failure%t_stop = t_stop
    err%failure%limit = self%maximum_steps
    err%failure%step = abs(self%stepper%next_step())
  end subroutine count_steps

  !> Make one accepted step. A step that the system refuses is made again, shorter.
  subroutine take_step(self, t_last, err)
    class(integrator_type), intent(inout) :: self       !< the integrator
    real(wp), intent(in) :: t_last                      !< latest end of the step [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: t_stop, t_new, reach
    integer :: outcome, trials

    self%box%broken = .false.
    t_stop = t_last - self%box%origin
    do trials = 1, most_refusals
      call self%stepper%advance(next_stop(self, t_stop), t_new, self%trial, outcome)
      if (outcome == stepped) then
        call accept_step(self, t_new, abs(t_new - t_stop) <= 0.0_wp, t_last, err)
        return
      end if
      if (outcome /= evaluation_failed .or. self%box%broken .or. .not. self%box%has_cause()) exit
      reach = self%box%t_failed - self%t
      if (abs(reach) < 16.0_wp*spacing(self%t_given_out)) exit   ! it fails here, whatever the step
      call self%stepper%restart(self%t, self%y, 0.25_wp*reach, outcome)
      if (outcome /= stepped) exit
      self%fresh = .true.
    end do
    call fail_by_outcome(self%box, outcome, self%t_given_out, err)
  end subroutine take_step

  !> Go on to the end of a step, whose values are in `trial`. Fails if it does not change the time.
  subroutine accept_step(self, t_new, stopped, t_last, err)
    class(integrator_type), intent(inout) :: self       !< the integrator
    real(wp), intent(in) :: t_new                       !< end of the step, from the origin [s]
    logical, intent(in) :: stopped                      !< the step ended at its stop
    real(wp), intent(in) :: t_last                      !< the stop [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: t

    t = merge(t_last, self%box%origin + t_new, stopped)
    self%steps_from_start = min(self%steps_from_start + 1, most_first_steps)
    if (.not. abs(t_new - self%t) > 0.0_wp .or. &
        (self%steps_from_start == most_first_steps .and. .not. abs(t - self%t_given_out) > 0.0_wp)) then
      call fail_by_vanishing_step(self%box, self%t_given_out, err)
      return
    end if
    self%t = t_new
    self%t_given_out = t
    self%y = self%trial
    self%fresh = .false.
    self%stopped = stopped
    self%steps = self%steps + 1
    self%steps_to_stop = self%steps_to_stop + 1
  end subroutine accept_step

  !> The stop that is given to the method: t_stop itself, or half the way where one step and a short rest would
  !> remain, because the methods need many steps to recover from a very short one.
  real(wp) function next_stop(self, t_stop)
    class(integrator_type), intent(inout) :: self   !< the integrator
    real(wp), intent(in) :: t_stop                  !< time at which the steps end, from the origin [s]
    real(wp) :: h, rest, half, enough

    next_stop = t_stop
    if (self%fresh) return
    h = abs(self%stepper%next_step())
    rest = abs(t_stop - self%t)
    if (self%stopped) then
      ! h is the last step, which the stop may have cut short; equal intervals must not be halved
      enough = 1.000001_wp*h
    else
      ! h is the next step; the method itself counts a stop as reached that is only round-off away
      enough = h + 50.0_wp*epsilon(h)*(abs(self%t) + h)
    end if
    if (rest <= enough .or. rest >= 2.0_wp*h) return
    half = self%t + 0.5_wp*(t_stop - self%t)
    if (abs(half - self%t) > 0.0_wp .and. abs(t_stop - half) > 0.0_wp) next_stop = half
  end function next_stop

  !> Go on from y, which differs from the result of the last step by no more than about the tolerance.
  subroutine correct(self, y, err)
    class(integrator_type), intent(inout) :: self       !< the integrator
    real(wp), intent(in) :: y(:)                        !< the corrected values
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: outcome

    self%y = y
    call self%stepper%correct(self%t, y, outcome)
    if (outcome /= stepped) call fail_by_outcome(self%box, outcome, self%t_given_out, err)
  end subroutine correct

  !> Begin anew at (t, y), after an event that changed the motion, with a first step of the given length
  !> or one that the method finds. The statistics continue.
  subroutine restart(self, t, y, err, first_step)
    class(integrator_type), intent(inout) :: self       !< the integrator
    real(wp), intent(in) :: t                           !< [s]
    real(wp), intent(in) :: y(:)                        !< values at t
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), intent(in), optional :: first_step        !< with its sign; 0: to be found [s]
    real(wp) :: h
    integer :: outcome

    h = 0.0_wp
    if (present(first_step)) h = first_step
    self%box%origin = t
    self%t = 0.0_wp
    self%t_given_out = t
    self%steps_from_start = 0
    call self%stepper%restart(self%t, y, h, outcome)
    self%y = y
    self%fresh = .true.
    if (outcome /= stepped) call fail_by_outcome(self%box, outcome, self%t_given_out, err)
  end subroutine restart

  !> Set limits; those that are not given stay.
  subroutine limit(self, err, maximum_steps, largest_step, first_step)
    class(integrator_type), intent(inout) :: self       !< the integrator
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, intent(in), optional :: maximum_steps      !< to one stop; 1000000 unless set
    real(wp), intent(in), optional :: largest_step      !< 0: none [s]
    real(wp), intent(in), optional :: first_step        !< with its sign; before the first step only [s]
    integer :: outcome

    outcome = stepped
    if (present(maximum_steps)) self%maximum_steps = maximum_steps
    if (present(largest_step)) call self%stepper%limit(largest_step, outcome)
    if (outcome == stepped .and. present(first_step)) call self%stepper%restart(self%t, self%y, first_step, outcome)
    if (outcome /= stepped) call fail_by_outcome(self%box, outcome, self%t_given_out, err)
  end subroutine limit

  !> The work of the integration so far.
  function statistics(self)
    class(integrator_type), intent(inout) :: self   !< the integrator
    type(integration_statistics_type) :: statistics
    type(stepper_counts_type) :: counts

    if (.not. associated(self%box)) return
    call self%stepper%counts(counts)
    statistics%steps = self%steps
    statistics%rate_evaluations = self%box%rate_evaluations
    statistics%jacobian_evaluations = counts%jacobian_evaluations
    statistics%error_test_failures = counts%error_test_failures
    statistics%convergence_failures = counts%convergence_failures
    statistics%implicit_steps = counts%implicit_steps
    statistics%method_changes = counts%method_changes
    statistics%refusals = self%box%refusals
    statistics%last_order = counts%last_order
    statistics%last_step = counts%last_step
  end function statistics

  !> Free the memory of the integration. An integrator can then be created again.
  subroutine destroy(self)
    class(integrator_type), intent(inout) :: self   !< the integrator

    if (allocated(self%stepper)) then
      call self%stepper%close()
      deallocate (self%stepper)
    end if
    if (associated(self%box)) deallocate (self%box)
    self%box => null()
    if (allocated(self%y)) deallocate (self%y)
    if (allocated(self%trial)) deallocate (self%trial)
    self%steps = 0
    self%steps_to_stop = 0
    self%steps_from_start = 0
    self%maximum_steps = 1000000
    self%fresh = .true.
  end subroutine destroy

  !> Add the counts of an integrator.
  pure subroutine add_statistics(counts, goes_on, all)
    type(integration_statistics_type), intent(in) :: counts   !< of the integrator
    logical, intent(in) :: goes_on                            !< its steps are those of the motion
    type(integration_statistics_type), intent(inout) :: all   !< the sums

    all%rate_evaluations = all%rate_evaluations + counts%rate_evaluations
    all%jacobian_evaluations = all%jacobian_evaluations + counts%jacobian_evaluations
    all%error_test_failures = all%error_test_failures + counts%error_test_failures
    all%convergence_failures = all%convergence_failures + counts%convergence_failures
    all%refusals = all%refusals + counts%refusals
    if (.not. goes_on) return
    all%steps = all%steps + counts%steps
    all%implicit_steps = all%implicit_steps + counts%implicit_steps
    all%method_changes = all%method_changes + counts%method_changes
    all%last_order = counts%last_order
    all%last_step = counts%last_step
  end subroutine add_statistics
end module mech9_integrator
