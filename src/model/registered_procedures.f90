!> Procedures of a user that are registered while a program runs: functions of C by their addresses. They stand beside those that
!> are linked, and come before them.
module mech9_registered_procedures
  use, intrinsic :: iso_c_binding, only: c_funptr, c_null_funptr, c_ptr, c_null_ptr, c_associated
  implicit none
  private
  public :: registered_procedure_type, registered_procedures_type

  !> A function, and what its user wants to have back in each call.
  type :: registered_procedure_type
    type(c_funptr) :: address = c_null_funptr
    type(c_ptr) :: data = c_null_ptr             !< not owned
  contains
    procedure :: exists
  end type registered_procedure_type

  !> The functions for groups of kind 'user'; one that does not exist leaves them to the linked procedures.
  type :: registered_procedures_type
    type(registered_procedure_type) :: pair
    type(registered_procedure_type) :: drive
    type(registered_procedure_type) :: coupling
    type(registered_procedure_type) :: force
  end type registered_procedures_type

contains

  !> Whether a function is registered.
  pure logical function exists(self)
    class(registered_procedure_type), intent(in) :: self   !< the procedure

    exists = c_associated(self%address)
  end function exists
end module mech9_registered_procedures
