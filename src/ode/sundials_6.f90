!> The particulars of SUNDIALS 6, which are the modules of its parts, contexts and messages.
module mech9_sundials_6
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_int, c_int64_t, c_char, c_funloc, c_f_pointer
  use mech9_short_vectors, only: linear_combination
  use fsundials_context_mod, only: FSUNContext_Create, FSUNContext_Free
  use fsundials_nvector_mod, only: N_Vector, N_Vector_Ops, FN_VGetArrayPointer, FN_VDestroy
  use fsundials_matrix_mod, only: SUNMatrix, FSUNMatDestroy
  use fsundials_linearsolver_mod, only: SUNLinearSolver, FSUNLinSolFree
  use fsundials_nonlinearsolver_mod, only: SUNNonlinearSolver, FSUNNonlinSolFree
  use farkode_erkstep_mod, only: FERKStepSetErrHandlerFn
  use fcvode_mod, only: FCVodeSetErrHandlerFn
  implicit none
  private
  public :: N_Vector, FN_VGetArrayPointer, FN_VDestroy, SUNMatrix, FSUNMatDestroy
  public :: SUNLinearSolver, FSUNLinSolFree, SUNNonlinearSolver, FSUNNonlinSolFree
  public :: index_kind, last_stage_mistaken, open_context, close_context, silence_erkstep, silence_cvode, &
    form_own_sums

  !> Kind of the integers that count the parts of vectors and matrices.
  integer, parameter :: index_kind = c_int64_t
  !> ERKStep takes the last stage for the rate at the end of the step wherever that stage stands at the end in
  !> time. All methods but Dormand-Prince's lose their order by this: Verner's decreases to 3. With a function that is
  !> called after each step it evaluates the rate there, for all methods.
  logical, parameter :: last_stage_mistaken = .true.

contains

  !> Open a context for one integration alone, so that several run side by side.
  subroutine open_context(context, flag)
    type(c_ptr), intent(out) :: context   !< the new context
    integer(c_int), intent(out) :: flag   !< 0 when all is well
    type(c_ptr) :: no_communicator

    no_communicator = c_null_ptr
    flag = FSUNContext_Create(no_communicator, context)
  end subroutine open_context

  !> Give a context back.
  subroutine close_context(context)
    type(c_ptr), intent(inout) :: context   !< the context; null afterwards
    integer(c_int) :: flag

    flag = FSUNContext_Free(context)
  end subroutine close_context

  !> Keep ERKStep's messages from the terminal.
  subroutine silence_erkstep(memory, flag)
    type(c_ptr), intent(inout) :: memory   !< the integrator of SUNDIALS
    integer(c_int), intent(out) :: flag    !< 0 when all is well
    type(c_ptr) :: nothing

    nothing = c_null_ptr
    flag = FERKStepSetErrHandlerFn(memory, c_funloc(ignore_message), nothing)
  end subroutine silence_erkstep

  !> Keep CVODE's messages from the terminal.
  subroutine silence_cvode(memory, flag)
    type(c_ptr), intent(inout) :: memory   !< the integrator of SUNDIALS
    integer(c_int), intent(out) :: flag    !< 0 when all is well
    type(c_ptr) :: nothing

    nothing = c_null_ptr
    flag = FCVodeSetErrHandlerFn(memory, c_funloc(ignore_message), nothing)
  end subroutine silence_cvode

  !> Let linear combinations of this vector and of those made like it be formed by mech9_short_vectors.
  subroutine form_own_sums(vector)
    type(N_Vector), intent(inout) :: vector   !< a serial vector
    type(N_Vector_Ops), pointer :: operations

    call c_f_pointer(vector%ops, operations)
    operations%nvlinearcombination = c_funloc(linear_combination)
  end subroutine form_own_sums

  !> SUNDIALS calls this procedure with a message for the terminal; its meaning is known from the flag that follows.
  subroutine ignore_message(code, from_module, from_function, message, context) bind(c)
    integer(c_int), value :: code                            !< flag of SUNDIALS
    character(kind=c_char), intent(in) :: from_module(*)     !< name of the module of SUNDIALS, ends with a byte of zero
    character(kind=c_char), intent(in) :: from_function(*)   !< name of the function of SUNDIALS, ends with a byte of zero
    character(kind=c_char), intent(in) :: message(*)         !< its text, ends with a byte of zero
    type(c_ptr), value :: context                            !< unused
  end subroutine ignore_message
end module mech9_sundials_6
