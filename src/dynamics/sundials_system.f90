!> A system of equations as SUNDIALS calls it: the box that holds it, and the functions that open the box.
!> Uses kinds, error, text, ode_system, sundials.
module mech9_sundials_system
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_double, c_f_pointer, c_loc
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, raise, exit_integrator
  use mech9_text, only: to_text
  use mech9_ode_system, only: ode_system_type, is_recoverable
  use mech9_sundials, only: N_Vector, FN_VGetArrayPointer, SUNMatrix
  use fsunmatrix_dense_mod, only: FSUNDenseMatrix_Data
  implicit none
  private
  public :: system_box_type, evaluate_rate, settle_step, evaluate_jacobian

  !> What travels through C: the system, and the failure of its last evaluation.
  type :: system_box_type
    class(ode_system_type), pointer :: system => null()
    type(error_type), allocatable :: err   !< of the last evaluation
    real(wp) :: t = 0.0_wp                 !< of the last evaluation [s]
    integer(long) :: rate_evaluations = 0
    integer(long) :: jacobian_evaluations = 0
  end type system_box_type

contains

  !> Called by SUNDIALS for y' = f(t, y). Answers 0; 1 if a smaller step may help; -1 if nothing does.
  integer(c_int) function evaluate_rate(t, y, ydot, context) bind(c) result(answer)
    real(c_double), value :: t
    type(N_Vector), target :: y, ydot
    type(c_ptr), value :: context
    type(system_box_type), pointer :: box
    real(c_double), pointer :: y_values(:), ydot_values(:)

    call c_f_pointer(context, box)
    y_values => FN_VGetArrayPointer(y)
    ydot_values => FN_VGetArrayPointer(ydot)
    box%t = t
    box%rate_evaluations = box%rate_evaluations + 1
    call box%system%rate(t, y_values, ydot_values, box%err)
    if (.not. allocated(box%err)) call must_be_finite(ydot_values, 'rate of change', box%err)
    answer = answer_to(box%err)
  end function evaluate_rate

  !> Called by SUNDIALS after a step that passed its error test: lets the system settle. Answers as evaluate_rate.
  integer(c_int) function settle_step(t, y, context) bind(c) result(answer)
    real(c_double), value :: t
    type(N_Vector), target :: y
    type(c_ptr), value :: context
    type(system_box_type), pointer :: box
    real(c_double), pointer :: y_values(:)

    answer = 0
    call c_f_pointer(context, box)
    if (.not. box%system%settles) return
    y_values => FN_VGetArrayPointer(y)
    box%t = t
    call box%system%settle(t, y_values, box%err)
    answer = answer_to(box%err)
  end function settle_step

  !> Called by SUNDIALS for the derivatives of f in y. Answers as evaluate_rate.
  integer(c_int) function evaluate_jacobian(t, y, ydot, jac, context, work1, work2, work3) bind(c) result(answer)
    real(c_double), value :: t
    type(N_Vector), target :: y, ydot
    type(SUNMatrix), target :: jac
    type(c_ptr), value :: context
    type(N_Vector), target :: work1, work2, work3
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
    box%t = t
    box%jacobian_evaluations = box%jacobian_evaluations + 1
    call box%system%jacobian(t, y_values, ydot_values, columns, box%err)
    if (.not. allocated(box%err)) call must_be_finite(entries, 'Jacobian', box%err)
    answer = answer_to(box%err)
  end function evaluate_jacobian

  !> Fails where a number is not finite.
  pure subroutine must_be_finite(numbers, what, err)
    real(wp), intent(in) :: numbers(:)
    character(len=*), intent(in) :: what
    type(error_type), allocatable, intent(inout) :: err
    integer :: i

    do i = 1, size(numbers)
      if (ieee_is_finite(numbers(i))) cycle
      call raise(err, exit_integrator, what//' number '//to_text(i)//' is not finite')
      return
    end do
  end subroutine must_be_finite

  !> The answer that SUNDIALS understands.
  pure integer(c_int) function answer_to(err)
    type(error_type), allocatable, intent(in) :: err

    answer_to = 0
    if (.not. allocated(err)) return
    answer_to = merge(1, -1, is_recoverable(err))
  end function answer_to
end module mech9_sundials_system
