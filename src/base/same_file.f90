!> Whether two names mean one file. Uses nothing.
module mech9_same_file
  use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_null_char, c_associated
  implicit none
  private
  public :: same_file

  !> Bytes of the longest path of the system, with the one that ends it.
  integer, parameter :: longest_path = 4096

  interface
    type(c_ptr) function c_realpath(path, resolved) bind(c, name='realpath')
      import :: c_ptr, c_char
      character(kind=c_char), intent(in) :: path(*)
      character(kind=c_char), intent(out) :: resolved(*)
    end function c_realpath
  end interface

contains

  !> Whether two paths lead to one file that is there, by whatever folders and links.
  logical function same_file(first, second)
    character(len=*), intent(in) :: first, second
    character(len=longest_path) :: first_place, second_place

    call find_place(first, first_place)
    call find_place(second, second_place)
    same_file = first_place /= '' .and. first_place == second_place
  end function same_file

  !> The path without detours; empty where nothing is there.
  subroutine find_place(path, place)
    character(len=*), intent(in) :: path
    character(len=longest_path), intent(out) :: place
    character(kind=c_char) :: resolved(longest_path)
    integer :: i

    place = ''
    if (index(path, c_null_char) > 0) return
    if (.not. c_associated(c_realpath(path//c_null_char, resolved))) return
    do i = 1, longest_path
      if (resolved(i) == c_null_char) exit
      place(i:i) = resolved(i)
    end do
  end subroutine find_place
end module mech9_same_file
