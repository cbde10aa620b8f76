!> Multistep methods of variable order by SUNDIALS' CVODE: Adams-Moulton and backward differences.
module mech9_sundials_multistep
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_associated, c_int, c_long, c_double, c_loc, &
    c_funloc, c_f_pointer
  use mech9_kinds, only: wp, long
  use mech9_integration_methods, only: integration_method_type
  use mech9_stepper, only: stepper_counts_type, stepped, evaluation_failed
  use mech9_sundials, only: N_Vector, FN_VGetArrayPointer, SUNMatrix, FSUNMatDestroy, SUNLinearSolver, &
    FSUNLinSolFree, SUNNonlinearSolver, FSUNNonlinSolFree, index_kind, silence_cvode
  use mech9_sundials_stepper, only: sundials_stepper_type, most_failures, meaning
  use mech9_sundials_system, only: evaluate_rate, evaluate_jacobian
  use fcvode_mod, only: FCVodeCreate, FCVodeFree, FCVodeInit, FCVodeReInit, FCVode, FCVodeSVtolerances, &
    FCVodeSetUserData, FCVodeSetLinearSolver, FCVodeSetNonlinearSolver, FCVodeSetJacFn, FCVodeSetMaxHnilWarns, &
    FCVodeSetMaxErrTestFails, FCVodeSetMaxConvFails, FCVodeSetNonlinConvCoef, FCVodeSetInitStep, FCVodeSetMaxStep, &
    FCVodeSetStopTime, &
    FCVodeGetNonlinearSystemData, FCVodeGetDky, FCVodeGetCurrentStep, FCVodeGetLastStep, FCVodeGetNumJacEvals, FCVodeGetLastOrder, &
    FCVodeGetNumErrTestFails, FCVodeGetNumStepSolveFails, &
    CV_ADAMS, CV_BDF, CV_ONE_STEP, CV_MEM_FAIL
  use fsunmatrix_dense_mod, only: FSUNDenseMatrix
  use fsunlinsol_dense_mod, only: FSUNLinSol_Dense
  use fsunnonlinsol_fixedpoint_mod, only: FSUNNonlinSol_FixedPoint
  implicit none
  private
  public :: multistep_type

  !> Newton's method ends when this part of the error that is allowed in a step is left. (CVODE's own part, 0.1, costs the stiff
  !> governor half as many evaluations again, and saves other motions a tenth; bench/measurements.md.)
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
    procedure :: open_method
    procedure :: set_up
    procedure :: stop_at
    procedure :: turn_back
    procedure :: make_step
    procedure :: finish_step
    procedure :: begin_anew
    procedure :: interpolate
    procedure :: correct
    procedure :: limit
    procedure :: next_step
    procedure :: counts => count_so_far
    procedure :: free_method
  end type multistep_type

contains

  !> Open CVODE.
  subroutine open_method(self, method, flag)
    class(multistep_type), intent(inout) :: self          !< the method
    type(integration_method_type), intent(in) :: method   !< adams or bdf
    integer(c_int), intent(out) :: flag                   !< 0 when all is well

    flag = CV_MEM_FAIL
    self%memory = FCVodeCreate(merge(CV_ADAMS, CV_BDF, method%name == 'adams'), self%context)
    if (.not. c_associated(self%memory)) return
    call silence_cvode(self%memory, flag)
    if (flag == 0) flag = FCVodeInit(self%memory, c_funloc(evaluate_rate), self%t, self%vector)
  end subroutine open_method

  !> Give CVODE the tolerances, the solver of its equations and the limits.
  subroutine set_up(self, method, relative, absolute, flag)
    class(multistep_type), intent(inout) :: self          !< the method
    type(integration_method_type), intent(in) :: method   !< adams or bdf
    real(wp), intent(in) :: relative                      !< tolerance of each variable, in a step
    type(N_Vector), intent(inout) :: absolute             !< tolerances of the variables; SUNDIALS keeps a copy
    integer(c_int), intent(out) :: flag                   !< 0 when all is well

    flag = FCVodeSVtolerances(self%memory, relative, absolute)
    if (flag == 0) call set_solver(self, method, flag)
    if (flag == 0) call set_options(self, flag)
    if (flag == 0) call find_history(self, flag)
  end subroutine set_up

  !> Adams' equations are solved by iterating them, those of backward differences by Newton's method.
  subroutine set_solver(self, method, flag)
    class(multistep_type), intent(inout) :: self          !< the method at work
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
    class(multistep_type), intent(inout) :: self  !< the method at work
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
    class(multistep_type), intent(inout) :: self  !< the method at work
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

  !> CVODE keeps the stop.
  subroutine stop_at(self, time, flag)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: time                   !< latest end of the step [s]
    integer(c_int), intent(out) :: flag            !< 0 when all is well

    flag = FCVodeSetStopTime(self%memory, time)
  end subroutine stop_at

  !> A step against the direction of the last one needs a restart.
  subroutine turn_back(self, time, flag)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: time                   !< latest end of the step [s]
    integer(c_int), intent(out) :: flag            !< 0 when all is well

    self%values = self%history
    call self%begin_anew(0.0_wp, flag)
    if (flag == 0) call self%stop_at(time, flag)
  end subroutine turn_back

  !> A step of CVODE.
  subroutine make_step(self, t_stop, t_reached, flag)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                 !< latest end of the step [s]
    real(c_double), intent(out) :: t_reached(1)    !< end of the step [s]
    integer(c_int), intent(out) :: flag            !< its answer

    flag = FCVode(self%memory, t_stop, self%vector, t_reached, CV_ONE_STEP)
  end subroutine make_step

  !> CVODE goes on after a failure of any kind, and lets no system project.
  subroutine finish_step(self, t, y, outcome)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< end of the step [s]
    real(wp), intent(inout) :: y(:)                !< values there
    integer, intent(out) :: outcome                !< `stepped`, or why it failed
    logical :: projected

    outcome = merge(evaluation_failed, stepped, self%box%broken)
    if (self%box%broken .or. .not. self%box%system%projects) return
    call self%box%project(t, y, projected)
    if (projected) then
      self%history = y
    else
      outcome = evaluation_failed
    end if
  end subroutine finish_step

  !> The polynomial of the method gives the values.
  subroutine interpolate(self, t, y, found)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                      !< a time within the last step [s]
    real(wp), intent(out) :: y(:)                  !< values at t
    logical, intent(out) :: found                  !< whether the method can compute them

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

  !> The method returns to the first order, as all multistep methods must.
  subroutine begin_anew(self, time, flag)
    class(multistep_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: time                   !< length of the first step with its sign; 0: to be found [s]
    integer(c_int), intent(out) :: flag            !< 0 when all is well
    type(stepper_counts_type) :: counts

    call self%counts(counts)
    self%earlier = counts
    flag = FCVodeReInit(self%memory, self%t, self%vector)
    if (flag == 0) flag = FCVodeSetInitStep(self%memory, time)
    self%last_step = 0.0_wp
  end subroutine begin_anew

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

  !> Free the memory of CVODE and its solvers.
  subroutine free_method(self)
    class(multistep_type), intent(inout) :: self   !< the method
    integer(c_int) :: flag

    if (c_associated(self%memory)) call FCVodeFree(self%memory)
    if (associated(self%linear)) flag = FSUNLinSolFree(self%linear)
    if (associated(self%matrix)) call FSUNMatDestroy(self%matrix)
    if (associated(self%nonlinear)) flag = FSUNNonlinSolFree(self%nonlinear)
    self%linear => null()
    self%matrix => null()
    self%nonlinear => null()
    self%history => null()
  end subroutine free_method
end module mech9_sundials_multistep
