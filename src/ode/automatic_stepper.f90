!> A method of integration that goes over from Prince-Dormand's explicit method to backward differences where the motion is stiff,
!> and back where it no longer is.
!>
!> Two evaluations of the explicit method at the end of a step tell how fast the equations react to a change (Hairer and Wanner
!> in docs/bibliography.md). Where the product with the length of steps stays at the limit of stability, stability and not
!> accuracy holds the steps down: the implicit method goes on. While it does, this measure is found by a power iteration of its own
!> now and then, and tells how long the steps of the explicit method could be.
module mech9_automatic_stepper
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type
  use mech9_integration_methods, only: integration_methods, method_index, step_tolerance_type, tolerance_for
  use mech9_stepper, only: stepper_type, stepper_counts_type, stepped
  use mech9_sundials_system, only: system_box_type
  use mech9_sundials_runge_kutta, only: runge_kutta_type, new_runge_kutta
  use mech9_sundials_multistep, only: multistep_type, new_multistep
  implicit none
  private
  public :: automatic_type, new_automatic

  !> Length of a step times the measure of stiffness: from here on stability holds the steps of the explicit method down, at the
  !> tolerance 1e-6 and above. Below it the steps shrink, those that stability holds down too, about as these powers of it do.
  real(wp), parameter :: stiff_product = 2.5_wp, loose_tolerance = 1.0e-6_wp, power_of_tolerance = 1.0_wp/16.0_wp
  !> The same product of the steps that the explicit method would make on the implicit one's way.
  real(wp), parameter :: stable_product = 6.0_wp
  !> Stiff steps after which the implicit method goes on: at first, growing with each time that it did not pay, and at most.
  integer, parameter :: first_patience = 3, patience_growth = 4, most_patience = 3000
  !> Calm steps in a row after which earlier stiff ones do not count.
  integer, parameter :: calm = 3
  !> The start of the implicit method costs as much as so many steps: it does not go on where fewer of the same length lead to the
  !> end, unless so many were stiff.
  real(wp), parameter :: few_steps = 120.0_wp
  integer, parameter :: many_stiff = 30
  !> Number of steps of the implicit method before its stiffness is looked at for the first time, and from one look to the next.
  integer, parameter :: steps_between = 100
  !> The implicit method did not pay if it is left after this number of looks or fewer.
  integer, parameter :: few_looks = 2
  !> Evaluations in a step of the explicit method.
  real(wp), parameter :: explicit_evaluations = 12.0_wp
  !> Cost of an evaluation in the implicit method, with the method's own work, in evaluations of the explicit one.
  real(wp), parameter :: implicit_cost = 2.0_wp
  !> The explicit method goes on where it costs less than this part of the implicit one.
  real(wp), parameter :: worthwhile = 0.7_wp

  !> The method at work.
  type, extends(stepper_type) :: automatic_type
    private
    type(system_box_type), pointer :: box => null()         !< the system
    type(runge_kutta_type), pointer :: explicit => null()   !< owned
    type(multistep_type), pointer :: implicit => null()     !< owned; null until it is needed first
    class(stepper_type), pointer :: active => null()        !< the one that made the last step
    logical :: is_implicit = .false.                        !< it is the implicit one
    logical :: goes_over = .false.                          !< the other one makes the next step
    type(step_tolerance_type) :: tolerance                  !< of the steps
    real(wp) :: largest_step = 0.0_wp                       !< 0: no limit [s]
    real(wp) :: t = 0.0_wp                                  !< end of the last step [s]
    real(wp), allocatable :: y(:)                           !< values there
    real(wp) :: stiff_from = stiff_product                  !< product of step and stiffness
    integer :: patience = first_patience                    !< stiff steps after which the implicit method goes on
    integer :: stiff_steps = 0                              !< of the explicit method
    integer :: calm_steps = 0                               !< after the last stiff one
    integer :: steps_since = 0                              !< of the implicit method, since the last look at the stiffness
    integer :: looks = 0                                    !< at the stiffness, since the implicit method went on
    real(wp) :: t_since = 0.0_wp                            !< time of that look [s]
    integer(long) :: evaluations_since = 0                  !< up to it
    real(wp), allocatable :: direction(:)                   !< of the change to which the equations react most
    real(wp) :: last_ratio = 0.0_wp                         !< of reaction and change; 0: none [1/s]
    type(stepper_counts_type) :: counted                    !< steps by the implicit method, and changes of the method
  contains
    procedure :: advance
    procedure :: interpolate
    procedure :: correct
    procedure :: restart
    procedure :: limit
    procedure :: next_step
    procedure :: counts => count_so_far
    procedure :: close => close_automatic
  end type automatic_type

contains

  !> The method at work on the system in the box, from (t, y). `outcome` is `stepped` when all is well.
  subroutine new_automatic(box, tolerance, t, y, stepper, outcome)
    type(system_box_type), pointer, intent(in) :: box   !< holds the system; must outlive the stepper
    type(step_tolerance_type), intent(in) :: tolerance  !< of the steps
    real(wp), intent(in) :: t                           !< [s]
    real(wp), intent(in) :: y(:)                        !< initial values
    type(automatic_type), intent(inout) :: stepper      !< the method at work
    integer, intent(out) :: outcome                     !< `stepped`, or why it failed

    stepper%box => box
    stepper%tolerance = tolerance
    stepper%stiff_from = stiff_product*min(1.0_wp, (tolerance%relative/loose_tolerance)**power_of_tolerance)
    stepper%t = t
    stepper%y = y
    stepper%direction = y
    call box%watch(size(y))
    allocate (stepper%explicit)
    stepper%active => stepper%explicit
    call new_runge_kutta(integration_methods(method_index('prince-dormand')), box, tolerance, t, y, stepper%explicit, outcome)
  end subroutine new_automatic

  !> A step of the active method, after which its stiffness is judged.
  subroutine advance(self, t_stop, t, y, outcome)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                 !< latest end of the step [s]
    real(wp), intent(out) :: t                     !< end of the step [s]
    real(wp), intent(out) :: y(:)                  !< values there
    integer, intent(out) :: outcome                !< `stepped`, or why it failed

    if (self%goes_over) then
      call go_over(self, t_stop, outcome)
      if (outcome /= stepped) return
    end if
    if (.not. self%is_implicit) call watch_last_stages(self, t_stop)
    call self%active%advance(t_stop, t, y, outcome)
    if (outcome /= stepped) return
    if (self%is_implicit) then
      call judge_implicit(self, t, y)
    else
      call judge_explicit(self, abs(t - self%t), abs(t_stop - t))
    end if
    self%t = t
    self%y = y
  end subroutine advance

  !> Let the evaluations at the end of the explicit method's next step be watched, and no others.
  subroutine watch_last_stages(self, t_stop)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                 !< latest end of the step [s]
    real(wp), parameter :: nearly_all = 0.95_wp    ! part of the step before its last stages

    self%box%t_from = self%t
    self%box%reach = nearly_all*min(abs(self%explicit%next_step()), abs(t_stop - self%t))
  end subroutine watch_last_stages

  !> Let the implicit method make the next step where the last steps of the explicit one were stiff.
  subroutine judge_explicit(self, step, rest)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: step                   !< length of the last step [s]
    real(wp), intent(in) :: rest                   !< time that is left to where steps must end [s]

    if (step*self%box%reaction > self%stiff_from) then
      self%stiff_steps = self%stiff_steps + 1
      self%calm_steps = 0
      self%goes_over = self%stiff_steps >= self%patience .and. (rest > few_steps*step .or. self%stiff_steps >= many_stiff)
    else
      self%calm_steps = self%calm_steps + 1
      if (self%calm_steps == calm) self%stiff_steps = 0
    end if
  end subroutine judge_explicit

  !> Let the explicit method make the next step where it would cost less. A method that is left so soon is tried again later.
  subroutine judge_implicit(self, t, y)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< end of the last step [s]
    real(wp), intent(in) :: y(:)                   !< values there
    real(wp) :: stiffness, explicit_cost, own_cost
    integer(long) :: evaluations

    self%counted%implicit_steps = self%counted%implicit_steps + 1
    self%steps_since = self%steps_since + 1
    if (self%steps_since < steps_between) return
    self%looks = self%looks + 1
    evaluations = self%box%rate_evaluations
    call find_stiffness(self, t, y, stiffness)
    if (stiffness > 0.0_wp) then
      explicit_cost = explicit_evaluations*stiffness/stable_product
      own_cost = implicit_cost*(evaluations - self%evaluations_since)/abs(t - self%t_since)
      self%goes_over = explicit_cost < worthwhile*own_cost
    end if
    call begin_look(self, t)
  end subroutine judge_implicit

  !> Begin to count steps and evaluations of the implicit method.
  subroutine begin_look(self, t)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< present time [s]

    self%steps_since = 0
    self%t_since = t
    self%evaluations_since = self%box%rate_evaluations
  end subroutine begin_look

  !> A step of the power iteration: the change to which the equations react most, and the ratio of both. A reaction that turns the
  !> change, as that of an oscillation, has different ratios from step to step: the mean of two counts.
  subroutine find_stiffness(self, t, y, stiffness)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< present time [s]
    real(wp), intent(in) :: y(:)                   !< values there
    real(wp), intent(out) :: stiffness             !< largest eigenvalue of the Jacobian, about; 0: not known [1/s]
    type(error_type), allocatable :: err
    real(wp) :: change, length, ratio, rate(size(y)), changed(size(y))

    stiffness = 0.0_wp
    length = norm2(self%direction)
    if (.not. length > 0.0_wp) return
    change = sqrt(epsilon(change))*(1.0_wp + norm2(y))
    call self%box%system%rate(self%box%origin + t, y, rate, err)
    if (.not. allocated(err)) &
      call self%box%system%rate(self%box%origin + t, y + (change/length)*self%direction, changed, err)
    self%box%rate_evaluations = self%box%rate_evaluations + 2
    if (allocated(err)) return
    self%direction = changed - rate
    ratio = norm2(self%direction)/change
    if (self%last_ratio > 0.0_wp) stiffness = sqrt(ratio*self%last_ratio)
    self%last_ratio = ratio
  end subroutine find_stiffness

  !> Start the other method from the end of the last step.
  subroutine go_over(self, t_stop, outcome)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                 !< the next step goes towards this time [s]
    integer, intent(out) :: outcome                !< `stepped`, or why it failed
    real(wp) :: first_step

    self%goes_over = .false.
    self%counted%method_changes = self%counted%method_changes + 1
    self%is_implicit = .not. self%is_implicit
    self%box%watches = .not. self%is_implicit
    if (self%is_implicit) then
      self%direction = self%box%direction
      self%last_ratio = 0.0_wp
      self%looks = 0
      call start_implicit(self, outcome)
      call begin_look(self, self%t)
    else
      if (self%looks > few_looks) then
        self%patience = first_patience
      else
        self%patience = min(patience_growth*self%patience, most_patience)
      end if
      self%stiff_steps = 0
      self%calm_steps = 0
      first_step = sign(0.5_wp*stable_product/self%last_ratio, t_stop - self%t)
      self%active => self%explicit
      call self%explicit%restart(self%t, self%y, first_step, outcome)
    end if
  end subroutine go_over

  !> Start the implicit method from the end of the last step; make it where it is needed first.
  subroutine start_implicit(self, outcome)
    class(automatic_type), intent(inout) :: self   !< the method at work
    integer, intent(out) :: outcome                !< `stepped`, or why it failed

    if (associated(self%implicit)) then
      call self%implicit%restart(self%t, self%y, 0.0_wp, outcome)
    else
      allocate (self%implicit)
      associate (method => integration_methods(method_index('bdf')))
        call new_multistep(method, self%box, tolerance_for(method, self%tolerance), self%t, self%y, self%implicit, outcome)
      end associate
      if (outcome == stepped) call self%implicit%limit(self%largest_step, outcome)
    end if
    self%active => self%implicit
  end subroutine start_implicit

  !> The method that made the last step tells the values within it.
  subroutine interpolate(self, t, y, found)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< a time within the last step [s]
    real(wp), intent(out) :: y(:)                  !< values at t
    logical, intent(out) :: found                  !< whether the method can tell them

    call self%active%interpolate(t, y, found)
  end subroutine interpolate

  !> Both methods may go on from the corrected values.
  subroutine correct(self, t, y, outcome)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< end of the last step [s]
    real(wp), intent(in) :: y(:)                   !< the corrected values there
    integer, intent(out) :: outcome                !< `stepped`, or why it failed

    self%y = y
    call self%active%correct(t, y, outcome)
  end subroutine correct

  !> The active method starts anew; whether it is stiff there is found out again.
  subroutine restart(self, t, y, first_step, outcome)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< beginning of the next step [s]
    real(wp), intent(in) :: y(:)                   !< values there
    real(wp), intent(in) :: first_step             !< its length with its sign; 0: to be found [s]
    integer, intent(out) :: outcome                !< `stepped`, or why it failed

    self%t = t
    self%y = y
    self%goes_over = .false.
    self%stiff_steps = 0
    self%calm_steps = 0
    call begin_look(self, t)
    call self%active%restart(t, y, first_step, outcome)
  end subroutine restart

  !> Both methods keep the limit.
  subroutine limit(self, largest_step, outcome)
    class(automatic_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: largest_step           !< length of the longest step; 0: no limit [s]
    integer, intent(out) :: outcome                !< `stepped`, or why it failed

    self%largest_step = largest_step
    call self%explicit%limit(largest_step, outcome)
    if (outcome == stepped .and. associated(self%implicit)) call self%implicit%limit(largest_step, outcome)
  end subroutine limit

  !> The step that the active method tries next.
  real(wp) function next_step(self)
    class(automatic_type), intent(inout) :: self   !< the method at work

    next_step = self%active%next_step()
  end function next_step

  !> The counts of both methods; order and length of the last step are those of the active one.
  subroutine count_so_far(self, counts)
    class(automatic_type), intent(inout) :: self       !< the method at work
    type(stepper_counts_type), intent(out) :: counts   !< the counts since the creation
    type(stepper_counts_type) :: of_explicit, of_implicit

    call self%explicit%counts(of_explicit)
    if (associated(self%implicit)) call self%implicit%counts(of_implicit)
    counts = of_explicit
    if (self%is_implicit) counts = of_implicit
    counts%error_test_failures = of_explicit%error_test_failures + of_implicit%error_test_failures
    counts%convergence_failures = of_explicit%convergence_failures + of_implicit%convergence_failures
    counts%jacobian_evaluations = of_explicit%jacobian_evaluations + of_implicit%jacobian_evaluations
    counts%implicit_steps = self%counted%implicit_steps
    counts%method_changes = self%counted%method_changes
  end subroutine count_so_far

  !> Free the memory of both methods.
  subroutine close_automatic(self)
    class(automatic_type), intent(inout) :: self   !< the method at work

    self%active => null()
    if (associated(self%explicit)) then
      call self%explicit%close()
      deallocate (self%explicit)
    end if
    if (associated(self%implicit)) then
      call self%implicit%close()
      deallocate (self%implicit)
    end if
  end subroutine close_automatic
end module mech9_automatic_stepper
