!> What is particular to SUNDIALS 6: the modules of its parts, contexts, messages.
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
    quicken

  !> Kind of the integers that count the parts of vectors and matrices.
  integer, parameter :: index_kind = c_int64_t
  !> ERKStep takes the last stage for the rate at the end of the step wherever it stands at the end in
  !> time, which costs other methods than Dormand-Prince's their order: Verner's falls to 3. It works the
  !> rate out where a function follows each step, then for all methods, needed or not.
  logical, parameter :: last_stage_mistaken = .true.

contains

  !> A context of its own for each integration, so that several run side by side. `flag` is 0 when all is well.
  subroutine open_context(context, flag)
    type(c_ptr), intent(out) :: context
    integer(c_int), intent(out) :: flag
    type(c_ptr) :: no_communicator

    no_communicator = c_null_ptr
    flag = FSUNContext_Create(no_communicator, context)
  end subroutine open_context

  !> Give a context back.
  subroutine close_context(context)
    type(c_ptr), intent(inout) :: context
    integer(c_int) :: flag

    flag = FSUNContext_Free(context)
  end subroutine close_context

  !> Keep ERKStep's messages from the terminal.
  subroutine silence_erkstep(memory, flag)
    type(c_ptr), intent(inout) :: memory
    integer(c_int), intent(out) :: flag
    type(c_ptr) :: nothing

    nothing = c_null_ptr
    flag = FERKStepSetErrHandlerFn(memory, c_funloc(say_nothing), nothing)
  end subroutine silence_erkstep

  !> Keep CVODE's messages from the terminal.
  subroutine silence_cvode(memory, flag)
    type(c_ptr), intent(inout) :: memory
    integer(c_int), intent(out) :: flag
    type(c_ptr) :: nothing

    nothing = c_null_ptr
    flag = FCVodeSetErrHandlerFn(memory, c_funloc(say_nothing), nothing)
  end subroutine silence_cvode

  !> Let sums of this vector and of those made after it be formed our own way.
  subroutine quicken(vector)
    type(N_Vector), intent(inout) :: vector
    type(N_Vector_Ops), pointer :: operations

    call c_f_pointer(vector%ops, operations)
    operations%nvlinearcombination = c_funloc(linear_combination)
  end subroutine quicken

  !> Called by SUNDIALS with a message for the terminal; what it means is told by the flag it returns.
  subroutine say_nothing(code, from_module, from_function, message, context) bind(c)
    integer(c_int), value :: code
    character(kind=c_char), intent(in) :: from_module(*), from_function(*), message(*)
    type(c_ptr), value :: context
  end subroutine say_nothing
end module mech9_sundials_6
