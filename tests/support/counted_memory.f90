!> Counts calls of malloc, realloc and calloc, where the linker sends them here: -Wl,--wrap=malloc,--wrap=realloc,--wrap=calloc.
module mech9_counted_memory
  use, intrinsic :: iso_c_binding, only: c_ptr, c_size_t
  implicit none
  private
  public :: calls

  !> Number of allocations so far.
  integer :: calls = 0

  interface
    type(c_ptr) function real_malloc(size) bind(c, name='__real_malloc')
      import :: c_ptr, c_size_t
      integer(c_size_t), value :: size   !< of memory [bytes]
    end function real_malloc
    type(c_ptr) function real_realloc(old, size) bind(c, name='__real_realloc')
      import :: c_ptr, c_size_t
      type(c_ptr), value :: old          !< the memory so far
      integer(c_size_t), value :: size   !< of memory [bytes]
    end function real_realloc
    type(c_ptr) function real_calloc(count, size) bind(c, name='__real_calloc')
      import :: c_ptr, c_size_t
      integer(c_size_t), value :: count   !< pieces of memory
      integer(c_size_t), value :: size    !< of each [bytes]
    end function real_calloc
  end interface

contains

  type(c_ptr) function counted_malloc(size) bind(c, name='__wrap_malloc')
    integer(c_size_t), value :: size   !< of memory [bytes]

    calls = calls + 1
    counted_malloc = real_malloc(size)
  end function counted_malloc

  type(c_ptr) function counted_realloc(old, size) bind(c, name='__wrap_realloc')
    type(c_ptr), value :: old          !< the memory so far
    integer(c_size_t), value :: size   !< of memory [bytes]

    calls = calls + 1
    counted_realloc = real_realloc(old, size)
  end function counted_realloc

  type(c_ptr) function counted_calloc(count, size) bind(c, name='__wrap_calloc')
    integer(c_size_t), value :: count   !< pieces of memory
    integer(c_size_t), value :: size    !< of each [bytes]

    calls = calls + 1
    counted_calloc = real_calloc(count, size)
  end function counted_calloc
end module mech9_counted_memory
