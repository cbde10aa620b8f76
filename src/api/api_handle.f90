!> Handles of C: memory that begins with the mark of its kind.
module mech9_api_handle
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_associated, c_f_pointer
  implicit none
  private
  public :: is_live
  public :: error_mark, mechanism_mark, results_mark, positions_mark, simulation_mark, equations_mark, no_mark

  !> Marks of the kinds of handles; a destroyed one has none.
  integer(c_int), parameter :: no_mark = 0, error_mark = 901, mechanism_mark = 902, results_mark = 903, positions_mark = 904, &
    simulation_mark = 905, equations_mark = 906

contains

  !> Whether a handle of a kind is at an address. One that was destroyed is told where its memory was not used again.
  logical function is_live(address, mark)
    type(c_ptr), intent(in) :: address       !< of the handle, or null
    integer(c_int), intent(in) :: mark       !< of the kind
    integer(c_int), pointer :: found

    is_live = .false.
    if (.not. c_associated(address)) return
    call c_f_pointer(address, found)
    is_live = found == mark
  end function is_live
end module mech9_api_handle
