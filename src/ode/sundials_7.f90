!> The particulars of SUNDIALS 7, which are the one module of its parts, contexts and messages.
module mech9_sundials_7
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_int, c_int32_t
  use fsundials_core_mod, only: FSUNContext_Create, FSUNContext_Free, FSUNContext_ClearErrHandlers, &
    FSUNContext_SetLogger, &
    N_Vector, FN_VGetArrayPointer, FN_VDestroy, SUNMatrix, FSUNMatDestroy, &
    SUNLinearSolver, FSUNLinSolFree, SUNNonlinearSolver, FSUNNonlinSolFree
  use mech9_no_communicator, only: no_communicator
  implicit none
  private
  public :: N_Vector, FN_VGetArrayPointer, FN_VDestroy, SUNMatrix, FSUNMatDestroy
  public :: SUNLinearSolver, FSUNLinSolFree, SUNNonlinearSolver, FSUNNonlinSolFree
  public :: index_kind, last_stage_mistaken, open_context, close_context, silence_erkstep, silence_cvode, &
    form_own_sums

  !> Kind of the integers that count the parts of vectors and matrices.
  integer, parameter :: index_kind = c_int32_t
  !> ERKStep knows which methods end with the rate at the end of the step.
  logical, parameter :: last_stage_mistaken = .false.

contains

  !> Open a context for one integration alone, so that several run side by side, without the handlers that
  !> write messages to the terminal.
  subroutine open_context(context, flag)
    type(c_ptr), intent(out) :: context   !< the new context
    integer(c_int), intent(out) :: flag   !< 0 when all is well
    type(c_ptr) :: no_logger

    flag = FSUNContext_Create(no_communicator, context)
    if (flag /= 0) return
    flag = FSUNContext_ClearErrHandlers(context)
    if (flag /= 0) return
    no_logger = c_null_ptr
    flag = FSUNContext_SetLogger(context, no_logger)
  end subroutine open_context

  !> Give a context back.
  subroutine close_context(context)
    type(c_ptr), intent(inout) :: context   !< the context; null afterwards
    integer(c_int) :: flag

    flag = FSUNContext_Free(context)
  end subroutine close_context

  !> Keep ERKStep's messages from the terminal: its context already does.
  subroutine silence_erkstep(memory, flag)
    type(c_ptr), intent(inout) :: memory   !< the integrator of SUNDIALS
    integer(c_int), intent(out) :: flag    !< 0: all is well

    flag = 0
  end subroutine silence_erkstep

  !> Sums of vectors are left to SUNDIALS.
  subroutine form_own_sums(vector)
    type(N_Vector), intent(inout) :: vector   !< a serial vector
  end subroutine form_own_sums

  !> Keep CVODE's messages from the terminal: its context already does.
  subroutine silence_cvode(memory, flag)
    type(c_ptr), intent(inout) :: memory   !< the integrator of SUNDIALS
    integer(c_int), intent(out) :: flag    !< 0: all is well

    flag = 0
  end subroutine silence_cvode
end module mech9_sundials_7
