!> The reason why a call of HDF5 failed, in a few words.
module mech9_hdf5_reason
  use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_ptr, c_funptr, c_char, c_loc, c_funloc, c_f_pointer, c_null_char, &
                                         c_associated
  implicit none
  private
  public :: last_reason

  integer, parameter :: longest = 1024

  !> H5E_error2_t of the C library.
  type, bind(c) :: error_record_type
    integer(c_int64_t) :: class, major, minor
    integer(c_int) :: line
    type(c_ptr) :: procedure_name, file_name, description
  end type error_record_type

  type, bind(c) :: words_type
    character(kind=c_char) :: letters(longest)
  end type words_type

  !> Number of the stack of errors of the present call, and its order from the innermost failure outwards.
  integer(c_int64_t), parameter :: present_stack = 0
  integer(c_int), parameter :: inner_first = 0

  interface
    integer(c_int) function c_walk(stack, direction, visitor, context) bind(c, name='H5Ewalk2')
      import :: c_int64_t, c_int, c_funptr, c_ptr
      integer(c_int64_t), value :: stack  !< number of the stack of errors
      integer(c_int), value :: direction  !< inner_first
      type(c_funptr), value :: visitor    !< the procedure called for each error
      type(c_ptr), value :: context       !< address handed to the visitor
    end function c_walk
  end interface

contains

  !> The reason of the last failure: the message of the operating system where that failed.
  function last_reason() result(text)
    character(len=:), allocatable :: text
    type(words_type), target :: words
    integer :: status, first, length

    words%letters = ' '
    status = c_walk(present_stack, inner_first, c_funloc(take_innermost), c_loc(words))
    text = trim(transfer(words%letters, repeat(' ', longest)))
    if (text == '') text = 'unknown reason'
    if (index(text, 'unable to lock') > 0) then
      text = 'another program has it open'
      return
    end if
    first = index(text, "error message = '")
    if (first == 0) return
    text = (text(first + len("error message = '"):))
    length = index(text, "'") - 1
    if (length > 0) text = text(:length)
  end function last_reason

  !> Keep the reason of the innermost failure. HDF5 calls this function for each failure on the stack.
  function take_innermost(number, record, context) bind(c) result(status)
    integer(c_int), value :: number                !< position of the error on the stack, from 0
    type(error_record_type), intent(in) :: record  !< the error
    type(c_ptr), value :: context                  !< address of the words that get the reason
    integer(c_int) :: status
    type(words_type), pointer :: words
    character(kind=c_char), pointer :: letters(:)
    integer :: i

    status = 0
    if (number /= 0 .or. .not. c_associated(record%description)) return
    call c_f_pointer(context, words)
    call c_f_pointer(record%description, letters, [longest])
    do i = 1, longest
      if (letters(i) == c_null_char) exit
      words%letters(i) = letters(i)
    end do
  end function take_innermost
end module mech9_hdf5_reason
