!> The memory of a program: where the system grants no more of it, the program says so and ends with exit_file.
!>
!> These procedures replace those of the C library in the programs, but not in other programs that use the library of
!> this project. gfortran's code does not check whether memory for a copy was granted, and its runtime library ends with a
!> backtrace. No procedure that needs memory itself may be called here.
module mech9_memory_guard
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_size_t, c_char, c_ptr, c_associated
  use mech9_error, only: exit_file
  implicit none
  private
  public :: guarded_malloc, guarded_calloc, guarded_realloc

  integer(c_int), parameter :: standard_error = 2
  !> Digits of the largest size.
  integer, parameter :: most_digits = 20
  character(len=*), parameter :: beginning = 'out of memory: ', ending = ' bytes more were not granted; the mechanism, or what '// &
    'is kept of its motion, is too large for this machine or for its limit (ulimit -v)'//achar(10)

  interface
    type(c_ptr) function c_malloc(size) bind(c, name='__libc_malloc')
      import :: c_ptr, c_size_t
      integer(c_size_t), value :: size   !< [bytes]
    end function c_malloc

    type(c_ptr) function c_calloc(count, size) bind(c, name='__libc_calloc')
      import :: c_ptr, c_size_t
      integer(c_size_t), value :: count   !< elements
      integer(c_size_t), value :: size    !< of one element [bytes]
    end function c_calloc

    type(c_ptr) function c_realloc(memory, size) bind(c, name='__libc_realloc')
      import :: c_ptr, c_size_t
      type(c_ptr), value :: memory       !< as granted before
      integer(c_size_t), value :: size   !< [bytes]
    end function c_realloc

    integer(c_long) function c_write(descriptor, bytes, count) bind(c, name='write')
      import :: c_int, c_long, c_size_t, c_char
      integer(c_int), value :: descriptor              !< an open file
      character(kind=c_char), intent(in) :: bytes(*)   !< the bytes to be written
      integer(c_size_t), value :: count                !< of the bytes
    end function c_write

    subroutine c_exit_at_once(code) bind(c, name='_exit')
      import :: c_int
      integer(c_int), value :: code   !< exit code
    end subroutine c_exit_at_once
  end interface

contains

  !> Memory of a size.
  recursive function guarded_malloc(size) result(memory) bind(c, name='malloc')
    integer(c_size_t), value :: size         !< [bytes]
    type(c_ptr) :: memory

    memory = c_malloc(size)
    if (.not. c_associated(memory) .and. size /= 0) call end_program(size)
  end function guarded_malloc

  !> Memory for an array, cleared.
  recursive function guarded_calloc(count, size) result(memory) bind(c, name='calloc')
    integer(c_size_t), value :: count   !< elements
    integer(c_size_t), value :: size    !< of one [bytes]
    type(c_ptr) :: memory

    memory = c_calloc(count, size)
    if (.not. c_associated(memory) .and. count /= 0 .and. size /= 0) call end_program(count*size)
  end function guarded_calloc

  !> The same memory with another size, perhaps at another address.
  recursive function guarded_realloc(memory, size) result(moved) bind(c, name='realloc')
    type(c_ptr), value :: memory       !< as granted before; null: none
    integer(c_size_t), value :: size   !< [bytes]
    type(c_ptr) :: moved

    moved = c_realloc(memory, size)
    if (.not. c_associated(moved) .and. size /= 0) call end_program(size)
  end function guarded_realloc

  !> Say that there is no memory, and end without any other work.
  recursive subroutine end_program(size)
    integer(c_size_t), intent(in) :: size   !< memory that was not granted [bytes]
    character(kind=c_char, len=len(beginning) + most_digits + len(ending)) :: words
    integer(c_size_t) :: rest
    integer(c_long) :: written
    integer :: n, digits, i

    digits = 1
    rest = max(size, 0_c_size_t)/10
    do while (rest > 0)
      digits = digits + 1
      rest = rest/10
    end do
    words(:len(beginning)) = beginning
    rest = max(size, 0_c_size_t)
    do i = len(beginning) + digits, len(beginning) + 1, -1
      words(i:i) = achar(iachar('0') + int(mod(rest, 10_c_size_t)))
      rest = rest/10
    end do
    n = len(beginning) + digits
    words(n + 1:n + len(ending)) = ending
    written = c_write(standard_error, words, int(n + len(ending), c_size_t))
    call c_exit_at_once(int(exit_file, c_int))
  end subroutine end_program
end module mech9_memory_guard
