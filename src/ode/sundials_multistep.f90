!> Multistep methods of variable order by SUNDIALS' CVODE: Adams-Moulton and backward differences.
module mech9_sundials_multistep
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_associated, c_int, c_long, c_double, c_loc, &
    c_funloc, c_f_pointer
  use mech9_kinds, only: wp, long
  use mech9_integration_methods, only: integration_method_type, step_tolerance_type
  use mech9_stepper, only: stepper_counts_type, stepped, evaluation_failed, too_inaccurate, &
    not_convergent, too_accurate, out_of_memory, refused
  use mech9_sundials, only: N_Vector, FN_VGetArrayPointer, FN_VDestroy, SUNMatrix, FSUNMatDestroy, SUNLinearSolver, &
    FSUNLinSolFree, SUNNonlinearSolver, FSUNNonlinSolFree, index_kind, silence_cvode
  use mech9_sundials_stepper, only: sundials_stepper_type, most_failures
  use mech9_sundials_system, only: system_box_type, evaluate_rate, evaluate_jacobian
  use fcvode_mod, only: FCVodeCreate, FCVodeFree, FCVodeInit, FCVodeReInit, FCVode, FCVodeSVtolerances, &
    FCVodeSetUserData, FCVodeSetLinearSolver, FCVodeSetNonlinearSolver, FCVodeSetJacFn, FCVodeSetMaxHnilWarns, &
    FCVodeSetMaxErrTestFails, FCVodeSetMaxConvFails, FCVodeSetNonlinConvCoef, FCVodeSetInitStep, FCVodeSetMaxStep, &
    FCVodeSetStopTime, &
    FCVodeGetNonlinearSystemData, FCVodeGetDky, FCVodeGetCurrentStep, FCVodeGetLastStep, FCVodeGetNumJacEvals, FCVodeGetLastOrder, &
    FCVodeGetNumErrTestFails, FCVodeGetNumStepSolveFails, &
    CV_ADAMS, CV_BDF, CV_ONE_STEP, CV_SUCCESS, CV_TSTOP_RETURN, CV_TOO_MUCH_ACC, CV_ERR_FAILURE, CV_CONV_FAILURE, &
    CV_LSETUP_FAIL, CV_LSOLVE_FAIL, CV_RHSFUNC_FAIL, CV_FIRST_RHSFUNC_ERR, CV_REPTD_RHSFUNC_ERR, &
    CV_UNREC_RHSFUNC_ERR, CV_MEM_FAIL
  use fsunmatrix_dense_mod, only: FSUNDenseMatrix
  use fsunlinsol_dense_mod, only: FSUNLinSol_Dense
  use fsunnonlinsol_fixedpoint_mod, only: FSUNNonlinSol_FixedPoint
  implicit none
  private
  public :: multistep_type, new_multistep

  !> Newton's method ends when this part of the error that is allowed in a step is left. (CVODE's own part, 0.1, costs the stiff
  !> governor half as many evaluations again, and saves other motions a tenth; docs/measurements.md.)
  real(c_double), parameter :: newton_part = 0.01_c_double

  !> A multistep method at work.
  type, extends(sundials_stepper_type) :: multistep_type
    private
    real(c_double), pointer :: history(:) => null()            !< y at the last step, as the method goes on from it
    type(SUNMatrix), pointer :: matrix => null()               !< of Newton's method
    type(SUNLinearSolver), pointer :: linear => null()         !< of Newton's method
    type(SUNNonlinearSolver), pointer :: nonlinear => null()   !< of Adams' methods
    type(stepper_counts_type) :: earlier                       !< counted before the last restart
  contains
    procedure :: advance
    procedure :: interpolate
    procedure :: correct
    procedure :: restart
    procedure :: limit
    procedure :: next_step
    procedure :: counts => count_so_far
    procedure :: close => close_multistep
  end type multistep_type

contains

  !> The method at work on the system in the box, from (t, y). `outcome` is `stepped` when all is well.
  subroutine new_multistep(method, box, tolerance, t, y, stepper, outcome)
    type(integration_method_type), intent(in) :: method   !< adams or bdf
    type(system_box_type), pointer, intent(in) :: box     !< holds the system; must outlive the stepper
    type(step_tolerance_type), intent(in) :: tolerance    !< of the steps
    real(wp), intent(in) :: t                             !< [s]
    real(wp), intent(in) :: y(:)                          !< initial values
    type(multistep_type), intent(inout) :: stepper        !< the method at work
    integer, intent(out) :: outcome                       !< `stepped`, or why it failed
    integer(c_int) :: flag
    logical :: opened

    outcome = out_of_memory
    call stepper%open_steps(box, t, y, opened)
    if (.not. opened) return
    stepper%memory = FCVodeCreate(merge(CV_ADAMS, CV_BDF, method%name == 'adams'), stepper%context)
    if (.not. c_associated(stepper%memory)) return
    call silence_cvode(stepper%memory, flag)
    if (flag == 0) flag = FCVodeInit(stepper%memory, c_funloc(evaluate_rate), t, stepper%vector)
    if (flag == 0) call set_tolerance(stepper, tolerance, flag)
    if (flag == 0) call set_solver(stepper, method, flag)
    if (flag == 0) call set_options(stepper, flag)
    if (flag == 0) call find_history(stepper, flag)
    outcome = merge(stepped, refused, flag == 0)
  end subroutine new_multistep

  !> Give CVODE the tolerance.
  subroutine set_tolerance(self, tolerance, flag)
    type(multistep_type), intent(inout) :: self     !< the method at work
    type(step_tolerance_type), intent(in) :: tolerance   !< of the steps
    integer(c_int), intent(out) :: flag             !< 0 when all is well
    type(N_Vector), pointer :: absolute

    flag = CV_MEM_FAIL
    absolute => self%new_vector(tolerance%absolute)
    if (.not. associated(absolute)) return
    flag = FCVodeSVtolerances(self%memory, tolerance%relative, absolute)   ! SUNDIALS keeps a copy
    call FN_VDestroy(absolute)
  end subroutine set_tolerance

  !> Adams' equations are solved by iterating them, those of backward differences by Newton's method.
  subroutine set_solver(self, method, flag)
    type(multistep_type), intent(inout) :: self           !< the method at work
    type(integration_method_type), intent(in) :: method   !< adams or bdf
    integer(c_int), intent(out) :: flag                   !< 0 when all is well
    integer(index_kind) :: n

    flag = CV_MEM_FAIL
    if (method%name == 'adams') then
      self%nonlinear => FSUNNonlinSol_FixedPoint(self%vector, 0_c_int, self%context)
      if (associated(self%nonlinear)) flag = FCVodeSetNonlinearSolver(self%memory, self%nonlinear)
      return
    end if
    n = size(self%values, kind=index_kind)
    self%matrix => FSUNDenseMatrix(n, n, self%context)
    if (.not. associated(self%matrix)) return
    self%linear => FSUNLinSol_Dense(self%vector, self%matrix, self%context)
    if (.not. associated(self%linear)) return
    flag = FCVodeSetLinearSolver(self%memory, self%linear, self%matrix)
    if (flag == 0 .and. self%box%system%has_jacobian) flag = FCVodeSetJacFn(self%memory, c_funloc(evaluate_jacobian))
  end subroutine set_solver

  !> Give CVODE the box and the limits, and keep its warnings from the terminal.
  subroutine set_options(self, flag)
    type(multistep_type), intent(inout) :: self   !< the method at work
    integer(c_int), intent(out) :: flag           !< 0 when all is well

    flag = FCVodeSetUserData(self%memory, c_loc(self%box))
    if (flag == 0) flag = FCVodeSetMaxHnilWarns(self%memory, -1_c_int)
    if (flag == 0) flag = FCVodeSetMaxErrTestFails(self%memory, most_failures)
    if (flag == 0 .and. associated(self%linear)) flag = FCVodeSetNonlinConvCoef(self%memory, newton_part)
    if (flag == 0) flag = FCVodeSetMaxConvFails(self%memory, most_failures)
  end subroutine set_options

  !> Find the memory in which CVODE keeps y at the last step, the first column of its Nordsieck array. Between steps
  !> CVODE gives it out as the prediction. The method goes on from a small change there without a restart, as it does
  !> after CVODE's own projection, which only backward differences have.
  subroutine find_history(self, flag)
    type(multistep_type), intent(inout) :: self   !< the method at work
    integer(c_int), intent(out) :: flag           !< 0 when all is well
    type(c_ptr), target :: found(4)
    type(c_ptr) :: at(4), context
    real(c_double) :: t(1), gamma(1), rl1(1)
    type(N_Vector), pointer :: vector
    integer :: i

    found = c_null_ptr
    context = c_null_ptr
    do i = 1, size(at)
      at(i) = c_loc(found(i))
    end do
    flag = FCVodeGetNonlinearSystemData(self%memory, t, at(1), at(2), at(3), gamma, rl1, at(4), context)
    if (flag /= 0) return
    call c_f_pointer(found(1), vector)   ! the others: y, its rate, and the next column
    self%history => FN_VGetArrayPointer(vector)
  end subroutine find_history

  !> A step against the direction of the last one needs a restart.
  subroutine advance(self, t_stop, t, y, outcome)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                 !< latest end of the step [s]
    real(wp), intent(out) :: t                     !< end of the step [s]
    real(wp), intent(out) :: y(:)                  !< values there
    integer, intent(out) :: outcome                !< `stepped`, or why it failed
    real(c_double) :: t_reached(1)
    integer(c_int) :: flag
    logical :: settled

    if ((t_stop - self%t)*self%last_step < 0.0_wp) then
      call self%restart((self%t), self%history, 0.0_wp, outcome)
      if (outcome /= stepped) return
    end if
    flag = FCVodeSetStopTime(self%memory, t_stop)
    if (flag == 0) flag = FCVode(self%memory, t_stop, self%vector, t_reached, CV_ONE_STEP)
    outcome = meaning(flag)
    if (outcome /= stepped) return
    call self%note_step(t_reached(1), t, y)
    if (self%box%broken) then
      outcome = evaluation_failed
      return
    end if
    if (.not. self%box%system%settles) return
    call self%box%settle(t, y, settled)
    if (settled) then
      self%history = y
    else
      outcome = evaluation_failed
    end if
  end subroutine advance

  !> The outcome that an answer of SUNDIALS means.
  pure integer function meaning(flag)
    integer(c_int), intent(in) :: flag   !< answer of a function of CVODE

    select case (flag)
    case (CV_SUCCESS, CV_TSTOP_RETURN)
      meaning = stepped
    case (CV_RHSFUNC_FAIL, CV_FIRST_RHSFUNC_ERR, CV_REPTD_RHSFUNC_ERR, CV_UNREC_RHSFUNC_ERR, CV_LSETUP_FAIL)
      meaning = evaluation_failed
    case (CV_ERR_FAILURE)
      meaning = too_inaccurate
    case (CV_CONV_FAILURE, CV_LSOLVE_FAIL)
      meaning = not_convergent
    case (CV_TOO_MUCH_ACC)
      meaning = too_accurate
    case (CV_MEM_FAIL)
      meaning = out_of_memory
    case default
      meaning = refused
    end select
  end function meaning

  !> The polynomial of the method gives the values.
  subroutine interpolate(self, t, y, found)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< a time within the last step [s]
    real(wp), intent(out) :: y(:)                  !< values at t
    logical, intent(out) :: found                  !< whether the method can tell them

    found = FCVodeGetDky(self%memory, t, 0_c_int, self%vector) == 0
    y = self%values
  end subroutine interpolate

  !> The method keeps its step and its order.
  subroutine correct(self, t, y, outcome)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< end of the last step [s]
    real(wp), intent(in) :: y(:)                   !< the corrected values there
    integer, intent(out) :: outcome                !< `stepped`, or why it failed

    if (abs(self%last_step) > 0.0_wp) then
      self%history = y
      outcome = stepped
    else
      call self%restart(t, y, 0.0_wp, outcome)
    end if
  end subroutine correct

  !> The method falls back to the first order, as all multistep methods must.
  subroutine restart(self, t, y, first_step, outcome)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< time of the beginning [s]
    real(wp), intent(in) :: y(:)                   !< values there
    real(wp), intent(in) :: first_step             !< its length with its sign; 0: to be found [s]
    integer, intent(out) :: outcome                !< `stepped`, or why it failed
    type(stepper_counts_type) :: counts
    integer(c_int) :: flag

    call self%counts(counts)
    self%earlier = counts
    self%values = y
    flag = FCVodeReInit(self%memory, t, self%vector)
    if (flag == 0) flag = FCVodeSetInitStep(self%memory, first_step)
    self%t = t
    self%last_step = 0.0_wp
    outcome = meaning(flag)
  end subroutine restart

  !> CVODE keeps the limit.
  subroutine limit(self, largest_step, outcome)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: largest_step           !< length of the longest step; 0: no limit [s]
    integer, intent(out) :: outcome                !< `stepped`, or why it failed

    outcome = meaning(FCVodeSetMaxStep(self%memory, largest_step))
  end subroutine limit

  !> The step that CVODE tries next.
  real(wp) function next_step(self)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(c_double) :: h(1)
    integer(c_int) :: flag

    h = 0.0_wp
    flag = FCVodeGetCurrentStep(self%memory, h)
    next_step = h(1)
  end function next_step

  !> The counts of CVODE, which begin anew at a restart, are added to the earlier ones.
  subroutine count_so_far(self, counts)
    class(multistep_type), intent(inout) :: self       !< the method at work
    type(stepper_counts_type), intent(out) :: counts   !< the counts since the creation
    integer(c_long) :: number(1)
    integer(c_int) :: order(1), flag
    real(c_double) :: h(1)

    number = 0
    order = 0
    h = 0.0_wp
    flag = FCVodeGetNumErrTestFails(self%memory, number)
    counts%error_test_failures = self%earlier%error_test_failures + int(number(1), long)
    flag = FCVodeGetNumStepSolveFails(self%memory, number)
    counts%convergence_failures = self%earlier%convergence_failures + int(number(1), long)
    counts%jacobian_evaluations = self%earlier%jacobian_evaluations
    if (associated(self%linear) .and. abs(self%last_step) > 0.0_wp) then   ! counted anew from the first step after a restart
      flag = FCVodeGetNumJacEvals(self%memory, number)
      counts%jacobian_evaluations = counts%jacobian_evaluations + int(number(1), long)
    end if
    flag = FCVodeGetLastStep(self%memory, h)
    counts%last_step = h(1)
    flag = FCVodeGetLastOrder(self%memory, order)
    counts%last_order = int(order(1))
  end subroutine count_so_far

  !> Free the memory of SUNDIALS.
  subroutine close_multistep(self)
    class(multistep_type), intent(inout) :: self   !< the method at work
    integer(c_int) :: flag

    if (c_associated(self%memory)) call FCVodeFree(self%memory)
    if (associated(self%linear)) flag = FSUNLinSolFree(self%linear)
    if (associated(self%matrix)) call FSUNMatDestroy(self%matrix)
    if (associated(self%nonlinear)) flag = FSUNNonlinSolFree(self%nonlinear)
    self%linear => null()
    self%matrix => null()
    self%nonlinear => null()
    self%history => null()
    call self%close_steps()
  end subroutine close_multistep
end module mech9_sundials_multistep
