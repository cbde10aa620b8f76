!> Texts of C: bytes up to a zero.
module mech9_api_text
  use, intrinsic :: iso_c_binding, only: c_char, c_ptr, c_size_t, c_null_char, c_null_ptr, c_associated, c_f_pointer, c_loc
  implicit none
  private
  public :: c_text_type, read_c_text

  !> A text that a handle shows to C. Its address holds until the handle changes it or is destroyed.
  type :: c_text_type
    private
    character(kind=c_char), pointer :: bytes(:) => null()   !< owned; the last one is zero
  contains
    procedure :: put
    procedure :: address
    procedure :: clear
  end type c_text_type

  interface
    !> Number of bytes before the zero.
    pure integer(c_size_t) function length_of_c_text(text) bind(c, name='strlen')
      import :: c_ptr, c_size_t
      type(c_ptr), value, intent(in) :: text   !< address of the first byte
    end function length_of_c_text
  end interface

contains

  !> Read a text of C; a null pointer is an empty text.
  subroutine read_c_text(address, text)
    type(c_ptr), intent(in) :: address                   !< of its first byte, or null
    character(len=:), allocatable, intent(out) :: text   !< without the zero
    character(kind=c_char), pointer :: bytes(:)
    integer :: i, n

    n = 0
    if (c_associated(address)) n = int(length_of_c_text(address))
    allocate (character(len=n) :: text)
    if (n == 0) return
    call c_f_pointer(address, bytes, [n])
    do i = 1, n
      text(i:i) = bytes(i)
    end do
  end subroutine read_c_text

  !> Take a text. What stands after a zero in it is left out.
  pure subroutine put(self, text)
    class(c_text_type), intent(inout) :: self   !< gets the text
    character(len=*), intent(in) :: text        !< the text
    integer :: i

    call self%clear()
    allocate (self%bytes(len(text) + 1))
    do i = 1, len(text)
      self%bytes(i) = text(i:i)
    end do
    self%bytes(len(text) + 1) = c_null_char
  end subroutine put

  !> Address of the first byte; null where there is no text.
  type(c_ptr) function address(self)
    class(c_text_type), intent(in) :: self   !< the text

    address = c_null_ptr
    if (associated(self%bytes)) address = c_loc(self%bytes)
  end function address

  !> Free the text.
  pure subroutine clear(self)
    class(c_text_type), intent(inout) :: self   !< the text

    if (associated(self%bytes)) deallocate (self%bytes)
  end subroutine clear
end module mech9_api_text
