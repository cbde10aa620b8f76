!> Explicit Runge-Kutta methods by SUNDIALS' ERKStep.
module mech9_sundials_runge_kutta
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_associated, c_int, c_long, c_double, c_loc, c_funloc
  use mech9_kinds, only: wp, long
  use mech9_integration_methods, only: integration_method_type, step_tolerance_type, prince_dormand_table, &
    dormand_prince_table, verner_table, fehlberg_table, kutta_merson_table
  use mech9_butcher_tables, only: butcher_table_type, kutta_merson, prince_dormand
  use mech9_step_choice, only: next_step_length, safety
  use mech9_stepper, only: stepper_counts_type, stepped, evaluation_failed, too_inaccurate, &
    too_accurate, out_of_memory, refused
  use mech9_sundials, only: N_Vector, FN_VDestroy, last_stage_mistaken, silence_erkstep, form_own_sums
  use mech9_sundials_stepper, only: sundials_stepper_type, most_failures
  use mech9_sundials_system, only: system_box_type, evaluate_rate, settle_step
  use farkode_mod, only: FARKodeButcherTable_Create, FARKodeButcherTable_Free, ARK_SUCCESS, ARK_TSTOP_RETURN, &
    ARK_ONE_STEP, ARK_ERR_FAILURE, ARK_TOO_MUCH_ACC, ARK_RHSFUNC_FAIL, ARK_FIRST_RHSFUNC_ERR, ARK_REPTD_RHSFUNC_ERR, &
    ARK_UNREC_RHSFUNC_ERR, ARK_POSTPROCESS_STEP_FAIL, ARK_MEM_FAIL, ARK_ILL_INPUT, &
    ARKODE_DORMAND_PRINCE_7_4_5, ARKODE_VERNER_8_5_6, ARKODE_FEHLBERG_13_7_8
  use farkode_erkstep_mod, only: FERKStepCreate, FERKStepFree, FERKStepReset, FERKStepEvolve, FERKStepSVtolerances, &
    FERKStepSetUserData, FERKStepSetTableNum, FERKStepSetTable, FERKStepSetInterpolantDegree, &
    FERKStepSetMaxHnilWarns, FERKStepSetMaxErrTestFails, FERKStepSetPostprocessStepFn, FERKStepSetInitStep, &
    FERKStepSetErrorBias, FERKStepSetSafetyFactor, FERKStepSetAdaptivityFn, &
    FERKStepSetMaxStep, FERKStepSetStopTime, FERKStepGetCurrentStep, FERKStepGetLastStep, FERKStepGetNumErrTestFails
  use fnvector_serial_mod, only: FN_VEnableFusedOps_Serial
  implicit none
  private
  public :: runge_kutta_type, new_runge_kutta

  !> A Runge-Kutta method at work.
  type, extends(sundials_stepper_type) :: runge_kutta_type
    private
    integer :: order = 0   !< of the method
  contains
    procedure :: advance
    procedure :: interpolate
    procedure :: correct
    procedure :: restart
    procedure :: limit
    procedure :: next_step
    procedure :: counts => count_so_far
    procedure :: close => close_runge_kutta
  end type runge_kutta_type

contains

  !> The method at work on the system in the box, from (t, y). `outcome` is `stepped` when all is well.
  subroutine new_runge_kutta(method, box, tolerance, t, y, stepper, outcome)
    type(integration_method_type), intent(in) :: method   !< one of the Runge-Kutta methods
    type(system_box_type), pointer, intent(in) :: box     !< holds the system; must outlive the stepper
    type(step_tolerance_type), intent(in) :: tolerance    !< of the steps
    real(wp), intent(in) :: t                             !< [s]
    real(wp), intent(in) :: y(:)                          !< initial values
    type(runge_kutta_type), intent(inout) :: stepper      !< the method at work
    integer, intent(out) :: outcome                       !< `stepped`, or why it failed
    integer(c_int) :: flag
    logical :: opened

    outcome = out_of_memory
    stepper%order = method%order
    call stepper%open_steps(box, t, y, opened)
    if (.not. opened) return
    flag = FN_VEnableFusedOps_Serial(stepper%vector, 1_c_int)   ! a tenth to a fifth faster
    if (flag /= 0) return
    call form_own_sums(stepper%vector)
    stepper%memory = FERKStepCreate(c_funloc(evaluate_rate), t, stepper%vector, stepper%context)
    if (.not. c_associated(stepper%memory)) return
    call silence_erkstep(stepper%memory, flag)
    if (flag == 0) call set_tolerance(stepper, tolerance, flag)
    if (flag == 0) call set_table(stepper, method, flag)
    if (flag == 0) call set_options(stepper, method, flag)
    outcome = merge(stepped, refused, flag == 0)
  end subroutine new_runge_kutta

  !> Give ERKStep the tolerance.
  subroutine set_tolerance(self, tolerance, flag)
    type(runge_kutta_type), intent(inout) :: self   !< the method at work
    type(step_tolerance_type), intent(in) :: tolerance   !< of the steps
    integer(c_int), intent(out) :: flag             !< 0 when all is well
    type(N_Vector), pointer :: absolute

    flag = ARK_MEM_FAIL
    absolute => self%new_vector(tolerance%absolute)
    if (.not. associated(absolute)) return
    flag = FERKStepSVtolerances(self%memory, tolerance%relative, absolute)   ! SUNDIALS keeps a copy
    call FN_VDestroy(absolute)
  end subroutine set_tolerance

  !> Give SUNDIALS the coefficients. A method whose table is not known is refused.
  subroutine set_table(self, method, flag)
    type(runge_kutta_type), intent(inout) :: self         !< the method at work
    type(integration_method_type), intent(in) :: method   !< the Runge-Kutta method
    integer(c_int), intent(out) :: flag                   !< ARK_SUCCESS when all is well

    select case (method%table)
    case (prince_dormand_table)
      call set_own_table(self, prince_dormand(), flag)
    case (dormand_prince_table)
      flag = FERKStepSetTableNum(self%memory, ARKODE_DORMAND_PRINCE_7_4_5)
    case (verner_table)
      flag = FERKStepSetTableNum(self%memory, ARKODE_VERNER_8_5_6)
    case (fehlberg_table)
      flag = FERKStepSetTableNum(self%memory, ARKODE_FEHLBERG_13_7_8)
    case (kutta_merson_table)
      call set_own_table(self, kutta_merson(), flag)
    case default
      flag = ARK_ILL_INPUT
    end select
  end subroutine set_table

  !> Give ERKStep coefficients of mech9_butcher_tables.
  subroutine set_own_table(self, table, flag)
    type(runge_kutta_type), intent(inout) :: self   !< the method at work
    type(butcher_table_type), intent(in) :: table   !< coefficients of the method
    integer(c_int), intent(out) :: flag             !< 0 when all is well
    real(c_double), target :: c(table%stages), b(table%stages), d(table%stages), a(table%stages**2)
    type(c_ptr) :: handed

    c = table%c
    b = table%b
    d = table%d
    a = reshape(transpose(table%a), [size(a)])   ! row by row
    handed = FARKodeButcherTable_Create(int(table%stages, c_int), int(table%order, c_int), &
                                        int(table%embedded_order, c_int), c, a, b, d)
    flag = ARK_MEM_FAIL
    if (.not. c_associated(handed)) return
    flag = FERKStepSetTable(self%memory, handed)   ! SUNDIALS keeps a copy
    call FARKodeButcherTable_Free(handed)
  end subroutine set_own_table

  !> Give ERKStep the box, the choice of steps and the limits, and keep its warnings from the terminal.
  subroutine set_options(self, method, flag)
    type(runge_kutta_type), intent(inout) :: self         !< the method at work
    type(integration_method_type), intent(in) :: method   !< the Runge-Kutta method
    integer(c_int), intent(out) :: flag                   !< 0 when all is well
    type(c_ptr) :: nothing

    nothing = c_null_ptr
    flag = FERKStepSetUserData(self%memory, c_loc(self%box))
    if (flag == 0) flag = FERKStepSetErrorBias(self%memory, 1.0_wp)
    if (flag == 0) flag = FERKStepSetSafetyFactor(self%memory, safety)
    if (flag == 0) flag = FERKStepSetAdaptivityFn(self%memory, c_funloc(choose_step), nothing)
    ! interpolation is never used here, and SUNDIALS' better interpolant would evaluate more rates
    if (flag == 0) flag = FERKStepSetInterpolantDegree(self%memory, 1_c_int)
    if (flag == 0) flag = FERKStepSetMaxHnilWarns(self%memory, -1_c_int)
    if (flag == 0) flag = FERKStepSetMaxErrTestFails(self%memory, most_failures)
    if (flag /= 0) return
    self%box%reuses_last_rate = last_stage_mistaken .and. method%reuses_last
    if (self%box%system%settles .or. (last_stage_mistaken .and. .not. method%reuses_last)) &
      flag = FERKStepSetPostprocessStepFn(self%memory, c_funloc(settle_step))
  end subroutine set_options

  !> SUNDIALS calls this function for the length of the next step, or of a new trial. It answers 0.
  integer(c_int) function choose_step(y, t, h1, h2, h3, e1, e2, e3, q, p, h_new, context) bind(c) result(answer)
    type(N_Vector) :: y                    !< values at the end of the last step; unused
    real(c_double), value :: t             !< end of the last step; unused [s]
    real(c_double), value :: h1            !< length of the last step, made or tried, with its sign [s]
    real(c_double), value :: h2            !< length of the accepted step before it; 0: none [s]
    real(c_double), value :: h3            !< length of the one before that; unused [s]
    real(c_double), value :: e1            !< error of the last step, as a part of the allowed one
    real(c_double), value :: e2            !< error of the step before it
    real(c_double), value :: e3            !< error of the one before that; unused
    integer(c_int), value :: q             !< order of the method
    integer(c_int), value :: p             !< order of the embedded method
    real(c_double), intent(out) :: h_new   !< length of the next step, with its sign [s]
    type(c_ptr), value :: context          !< unused

    h_new = next_step_length(h1, h2, e1, e2, int(p) + 1)
    answer = 0
  end function choose_step

  !> A step against the direction of the last one is prepared by turn_back.
  subroutine advance(self, t_stop, t, y, outcome)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                   !< latest end of the step [s]
    real(wp), intent(out) :: t                       !< end of the step [s]
    real(wp), intent(out) :: y(:)                    !< values there
    integer, intent(out) :: outcome                  !< `stepped`, or why it failed
    real(c_double) :: t_reached(1)
    integer(c_int) :: flag

    if ((t_stop - self%t)*self%last_step < 0.0_wp) then
      call turn_back(self, t_stop, flag)
    else
      flag = FERKStepSetStopTime(self%memory, t_stop)
    end if
    if (flag == 0) flag = FERKStepEvolve(self%memory, t_stop, self%vector, t_reached, ARK_ONE_STEP)
    outcome = meaning(flag)
    if (outcome /= stepped) return
    call self%note_step(t_reached(1), t, y)
  end subroutine advance

  !> ERKStep accepts no stop against the direction of its last step. The first step back is therefore set to half of the
  !> way to the stop at most; as it can only become smaller, it needs no stop.
  subroutine turn_back(self, t_stop, flag)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                   !< latest end of the step [s]
    integer(c_int), intent(out) :: flag              !< 0 when all is well
    real(wp) :: half

    half = 0.5_wp*(t_stop - self%t)
    flag = FERKStepSetInitStep(self%memory, sign(min(abs(self%last_step), abs(half)), half))
    if (flag == 0) flag = FERKStepReset(self%memory, self%t, self%vector)
  end subroutine turn_back

  !> The outcome that an answer of SUNDIALS means.
  pure integer function meaning(flag)
    integer(c_int), intent(in) :: flag   !< answer of a function of ERKStep

    select case (flag)
    case (ARK_SUCCESS, ARK_TSTOP_RETURN)
      meaning = stepped
    case (ARK_RHSFUNC_FAIL, ARK_FIRST_RHSFUNC_ERR, ARK_REPTD_RHSFUNC_ERR, ARK_UNREC_RHSFUNC_ERR, &
          ARK_POSTPROCESS_STEP_FAIL)
      meaning = evaluation_failed
    case (ARK_ERR_FAILURE)
      meaning = too_inaccurate
    case (ARK_TOO_MUCH_ACC)
      meaning = too_accurate
    case (ARK_MEM_FAIL)
      meaning = out_of_memory
    case default
      meaning = refused
    end select
  end function meaning

  !> The method has no approximation of its own order inside a step.
  subroutine interpolate(self, t, y, found)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                        !< a time within the last step [s]
    real(wp), intent(out) :: y(:)                    !< values at the end of the last step
    logical, intent(out) :: found                    !< whether that is the time t

    y = self%values
    found = abs(t - self%t) <= 0.0_wp
  end subroutine interpolate

  !> A correction takes one more evaluation of the rate.
  subroutine correct(self, t, y, outcome)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                        !< end of the last step [s]
    real(wp), intent(in) :: y(:)                     !< the corrected values there
    integer, intent(out) :: outcome                  !< `stepped`, or why it failed

    self%values = y
    outcome = meaning(FERKStepReset(self%memory, t, self%vector))
  end subroutine correct

  !> The next step starts from the given values.
  subroutine restart(self, t, y, first_step, outcome)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                        !< time of the beginning [s]
    real(wp), intent(in) :: y(:)                     !< values there
    real(wp), intent(in) :: first_step               !< its length with its sign; 0: to be found [s]
    integer, intent(out) :: outcome                  !< `stepped`, or why it failed
    integer(c_int) :: flag

    self%values = y
    self%t = t
    flag = FERKStepSetInitStep(self%memory, first_step)
    if (flag == 0) flag = FERKStepReset(self%memory, t, self%vector)
    outcome = meaning(flag)
  end subroutine restart

  !> ERKStep keeps the limit.
  subroutine limit(self, largest_step, outcome)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: largest_step             !< length of the longest step; 0: no limit [s]
    integer, intent(out) :: outcome                  !< `stepped`, or why it failed

    outcome = meaning(FERKStepSetMaxStep(self%memory, largest_step))
  end subroutine limit

  !> The step that ERKStep tries next.
  real(wp) function next_step(self)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work
    real(c_double) :: h(1)
    integer(c_int) :: flag

    h = 0.0_wp
    flag = FERKStepGetCurrentStep(self%memory, h)
    next_step = h(1)
  end function next_step

  !> The counts of ERKStep; the order is that of the method.
  subroutine count_so_far(self, counts)
    class(runge_kutta_type), intent(inout) :: self     !< the method at work
    type(stepper_counts_type), intent(out) :: counts   !< the counts since the creation
    integer(c_long) :: number(1)
    real(c_double) :: h(1)
    integer(c_int) :: flag

    number = 0
    h = 0.0_wp
    flag = FERKStepGetNumErrTestFails(self%memory, number)
    counts%error_test_failures = int(number(1), long)
    flag = FERKStepGetLastStep(self%memory, h)
    counts%last_step = h(1)
    counts%last_order = self%order
  end subroutine count_so_far

  !> Free the memory of SUNDIALS.
  subroutine close_runge_kutta(self)
    class(runge_kutta_type), intent(inout) :: self   !< the method at work

    if (c_associated(self%memory)) call FERKStepFree(self%memory)
    call self%close_steps()
  end subroutine close_runge_kutta
end module mech9_sundials_runge_kutta
