!> Whether a model calls procedures that its user wrote.
module mech9_user_calls
  use mech9_model, only: model_type
  use mech9_procedure_pair, only: procedure_pair_type
  use mech9_procedure_drive, only: procedure_drive_type
  use mech9_procedure_load, only: procedure_load_type
  use mech9_procedure_coupling, only: procedure_coupling_type
  implicit none
  private
  public :: calls_user_procedures

contains

  !> Whether a pair, a drive, a load or a coupling of a model is a user's procedure. Such procedures may keep numbers of their own
  !> from call to call, so that it is the user who knows whether threads may call them at the same time.
  pure logical function calls_user_procedures(model) result(calls)
    type(model_type), intent(in) :: model   !< the model
    type(procedure_pair_type) :: pair
    type(procedure_drive_type) :: drive
    type(procedure_load_type) :: load
    type(procedure_coupling_type) :: coupling
    integer :: i

    calls = .false.
    do i = 1, size(model%mechanism%pairs)
      calls = calls .or. same_type_as(model%mechanism%pairs(i)%pair, pair)
    end do
    do i = 1, size(model%problem%drives)
      calls = calls .or. same_type_as(model%problem%drives(i)%drive, drive)
    end do
    do i = 1, size(model%mechanism%loads)
      calls = calls .or. same_type_as(model%mechanism%loads(i)%load, load)
    end do
    if (.not. allocated(model%mechanism%couplings)) return
    do i = 1, size(model%mechanism%couplings)
      calls = calls .or. same_type_as(model%mechanism%couplings(i)%coupling, coupling)
    end do
  end function calls_user_procedures
end module mech9_user_calls
