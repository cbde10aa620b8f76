!> A system of equations as SUNDIALS calls it, in a box that is passed through C, and the functions that open the box.
module mech9_sundials_system
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_double, c_f_pointer, c_loc
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, raise, exit_integrator
  use mech9_ode_failures, only: failure_infinite_rate, failure_infinite_jacobian
  use mech9_ode_system, only: ode_system_type, is_recoverable
  use mech9_short_vectors, only: length_of, numbers_of
  use mech9_sundials, only: N_Vector, FN_VGetArrayPointer, SUNMatrix
  use fsunmatrix_dense_mod, only: FSUNDenseMatrix_Data
  implicit none
  private
  public :: system_box_type, evaluate_rate, project_step, evaluate_jacobian

  !> The box that is passed through C: the system, and the outcomes of its evaluations.
  type :: system_box_type
    class(ode_system_type), pointer :: system => null()
    real(wp) :: origin = 0.0_wp                !< time of the system at which that of SUNDIALS is 0 [s]
    type(error_type), allocatable :: err       !< of the last evaluation
    type(error_type), allocatable :: failure   !< the last failure of all evaluations
    real(wp) :: t_failed = 0.0_wp              !< time of this failure, counted from the origin [s]
    logical :: broken = .false.                !< no smaller step helps against this failure
    integer(long) :: failed_at = 0             !< rate evaluations up to this failure
    integer(long) :: rate_evaluations = 0      !< in all
    integer(long) :: refusals = 0              !< failures that a smaller step may help
    !> Whether the rate after a projection is taken from the last stage, of the same time and nearly the same y.
    logical :: reuses_last_rate = .false.
    logical :: watches = .false.               !< the reaction of the equations to changes is watched
    real(wp) :: t_from = 0.0_wp                !< start of the step that is made [s]
    real(wp) :: reach = 0.0_wp                 !< evaluations that are not so far from it are not watched [s]
    real(wp) :: reaction = 0.0_wp              !< change of the rate over the change of y, in two evaluations at one time [1/s]
    real(wp), allocatable :: direction(:)      !< change of the rate in these evaluations
    real(wp), allocatable, private :: y_before(:), rate_before(:)   !< of the last evaluation
    real(wp), private :: t_before = 0.0_wp     !< of the last evaluation [s]
    logical :: has_projected = .false.                  !< y was just projected, and SUNDIALS evaluates the rate there next
    real(c_double), pointer :: last_rate(:) => null()   !< the rate of the last stage, in SUNDIALS' memory
  contains
    procedure :: project
    procedure :: has_cause
    procedure :: watch
  end type system_box_type

contains

  !> SUNDIALS calls this function for y' = f(t, y). It answers 0; 1 if a smaller step may help; -1 if nothing helps.
  integer(c_int) function evaluate_rate(t, y, ydot, context) bind(c) result(answer)
    real(c_double), value :: t       !< time from the origin [s]
    type(N_Vector), target :: y      !< values at t
    type(N_Vector), target :: ydot   !< gets the derivatives of y in time
    type(c_ptr), value :: context    !< address of the box
    type(system_box_type), pointer :: box
    real(c_double), pointer :: y_values(:), ydot_values(:)
    integer :: i, n

    answer = -1
    call c_f_pointer(context, box)
    if (box%broken) return   ! CVODE's iteration goes on after a failure of any kind
    n = int(length_of(c_loc(y)))
    call c_f_pointer(numbers_of(c_loc(y)), y_values, [n])
    call c_f_pointer(numbers_of(c_loc(ydot)), ydot_values, [n])
    if (box%has_projected) then
      box%has_projected = .false.
      do i = 1, size(ydot_values)
        ydot_values(i) = box%last_rate(i)
      end do
      answer = 0
      return
    end if
    box%last_rate => ydot_values
    box%rate_evaluations = box%rate_evaluations + 1
    call box%system%rate(box%origin + t, y_values, ydot_values, box%err)
    if (.not. allocated(box%err)) call must_be_finite(ydot_values, failure_infinite_rate, box%err)
    answer = answer_to(box, t)
    if (box%watches .and. answer == 0 .and. abs(t - box%t_from) >= box%reach) call compare(box, t, y_values, ydot_values)
  end function evaluate_rate

  !> Watch the reaction of the equations from now on.
  subroutine watch(self, n)
    class(system_box_type), intent(inout) :: self   !< the box
    integer, intent(in) :: n                        !< number of variables

    allocate (self%direction(n), self%y_before(n), self%rate_before(n), source=0.0_wp)
    self%t_before = -huge(self%t_before)
    self%watches = .true.
  end subroutine watch

  !> Compare an evaluation with the last one, if both are of one time. The last two stages of a Runge-Kutta method are.
  pure subroutine compare(box, t, y, ydot)
    type(system_box_type), intent(inout) :: box   !< keeps the evaluation for the next one
    real(wp), intent(in) :: t                     !< time of the evaluation, from the origin [s]
    real(wp), intent(in) :: y(:)                  !< values at t
    real(wp), intent(in) :: ydot(:)               !< derivatives of y in time
    real(wp), parameter :: large = 1.0e150_wp   ! larger numbers have no squares
    real(wp) :: change, reaction
    integer :: i

    if (abs(t - box%t_before) <= 0.0_wp .and. maxval(abs(y)) < large .and. maxval(abs(ydot)) < large) then
      change = 0.0_wp
      reaction = 0.0_wp
      do i = 1, size(y)
        box%direction(i) = ydot(i) - box%rate_before(i)
        change = change + (y(i) - box%y_before(i))**2
        reaction = reaction + box%direction(i)**2
      end do
      if (change > 0.0_wp) box%reaction = sqrt(reaction)/sqrt(change)
    end if
    box%t_before = t
    do i = 1, size(y)
      box%y_before(i) = y(i)
      box%rate_before(i) = ydot(i)
    end do
  end subroutine compare

  !> Project y. SUNDIALS calls this function after a step that passed its error test. It answers as evaluate_rate.
  integer(c_int) function project_step(t, y, context) bind(c) result(answer)
    real(c_double), value :: t      !< time from the origin [s]
    type(N_Vector), target :: y     !< values at t; the projected ones afterwards
    type(c_ptr), value :: context   !< address of the box
    type(system_box_type), pointer :: box
    real(c_double), pointer :: y_values(:)
    logical :: projected

    call c_f_pointer(context, box)
    y_values => FN_VGetArrayPointer(y)
    call box%project(t, y_values, projected)
    box%has_projected = projected .and. box%reuses_last_rate
    answer = merge(0, 1, projected)
  end function project_step

  !> SUNDIALS calls this function for the derivatives of f in y. It answers as evaluate_rate.
  integer(c_int) function evaluate_jacobian(t, y, ydot, jac, context, work1, work2, work3) bind(c) result(answer)
    real(c_double), value :: t        !< time from the origin [s]
    type(N_Vector), target :: y       !< values at t
    type(N_Vector), target :: ydot    !< derivatives of y in time at t
    type(SUNMatrix), target :: jac    !< gets the derivatives of ydot in y, a dense matrix
    type(c_ptr), value :: context     !< address of the box
    type(N_Vector), target :: work1   !< scratch, unused
    type(N_Vector), target :: work2   !< scratch, unused
    type(N_Vector), target :: work3   !< scratch, unused
    type(system_box_type), pointer :: box
    real(c_double), pointer :: y_values(:), ydot_values(:), entries(:), columns(:, :)
    integer :: n

    call c_f_pointer(context, box)
    y_values => FN_VGetArrayPointer(y)
    ydot_values => FN_VGetArrayPointer(ydot)
    entries => FSUNDenseMatrix_Data(jac)
    n = size(y_values)
    ! SUNDIALS 6 gives the first entry only
    call c_f_pointer(c_loc(entries(1)), columns, [n, n])
    call c_f_pointer(c_loc(columns(1, 1)), entries, [n*n])
    call box%system%jacobian(box%origin + t, y_values, ydot_values, columns, box%err)
    if (.not. allocated(box%err)) call must_be_finite(entries, failure_infinite_jacobian, box%err)
    answer = answer_to(box, t)
  end function evaluate_jacobian

  !> Project y after a step, if the system has a projection.
  subroutine project(self, t, y, projected)
    class(system_box_type), intent(inout) :: self   !< the box
    real(wp), intent(in) :: t                       !< time from the origin [s]
    real(wp), intent(inout) :: y(:)                 !< values at t; the projected ones afterwards
    logical, intent(out) :: projected               !< false: the step must be made again

    projected = .true.
    if (.not. self%system%projects) return
    call self%system%project(self%origin + t, y, self%err)
    projected = answer_to(self, t) == 0
  end subroutine project

  !> Whether a failure of the system explains why the integration cannot go on: one that no smaller step helps against, or
  !> one so recent that the steps became short because of it.
  pure logical function has_cause(self)
    class(system_box_type), intent(in) :: self   !< the box
    integer, parameter :: recent = 100   ! rate evaluations of some steps, and of a Jacobian by differences

    has_cause = .false.
    if (allocated(self%failure)) has_cause = self%broken .or. self%rate_evaluations - self%failed_at <= recent
  end function has_cause

  !> Fails where a number is not finite.
  pure subroutine must_be_finite(numbers, kind, err)
    real(wp), intent(in) :: numbers(:)                    !< values to be checked
    integer, intent(in) :: kind                           !< kind of failure where one is not finite
    type(error_type), allocatable, intent(inout) :: err   !< allocated if it failed
    integer :: i

    do i = 1, size(numbers)
      if (ieee_is_finite(numbers(i))) cycle
      call raise(err, exit_integrator, kind)
      err%failure%number = i
      return
    end do
  end subroutine must_be_finite

  !> The answer to SUNDIALS after an evaluation at time t. Failures are kept in the box.
  integer(c_int) function answer_to(box, t) result(answer)
    type(system_box_type), intent(inout) :: box   !< keeps the failure of the evaluation, if it failed
    real(wp), intent(in) :: t                     !< time of the evaluation, from the origin [s]

    answer = 0
    if (.not. allocated(box%err)) return
    box%failure = box%err
    box%t_failed = t
    box%failed_at = box%rate_evaluations
    box%broken = .not. is_recoverable(box%err)
    if (.not. box%broken) box%refusals = box%refusals + 1
    answer = merge(-1, 1, box%broken)
  end function answer_to
end module mech9_sundials_system
