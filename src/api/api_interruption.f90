!> Interruption of a call from another thread or a signal handler of C: a number that stops the call once it is not 0.
module mech9_api_interruption
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_associated, c_f_pointer
  use mech9, only: interruption_type
  implicit none
  private
  public :: flag_interruption_type, new_interruption

  !> Stops a call once a number of the caller is not 0.
  type, extends(interruption_type) :: flag_interruption_type
    private
    integer(c_int), pointer :: stop => null()   !< of the caller; null: nobody stops the call
  contains
    procedure :: is_wanted
  end type flag_interruption_type

contains

  !> An interruption by a number of the caller.
  subroutine new_interruption(stop, interruption)
    type(c_ptr), intent(in) :: stop                              !< address of the number, or null
    type(flag_interruption_type), intent(out) :: interruption    !< reads it
    integer(c_int), pointer :: flag

    if (.not. c_associated(stop)) return
    call c_f_pointer(stop, flag)
    interruption%stop => flag
  end subroutine new_interruption

  !> Whether the call shall stop.
  logical function is_wanted(self)
    class(flag_interruption_type), intent(in) :: self   !< the interruption
    integer(c_int), pointer, volatile :: flag           ! another thread may change it at any time

    is_wanted = .false.
    if (.not. associated(self%stop)) return
    flag => self%stop
    is_wanted = flag /= 0
  end function is_wanted
end module mech9_api_interruption
