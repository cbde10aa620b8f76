!> Threads of the system itself. The thread sanitizer knows these and follows what they do; of the OpenMP library it knows
!> nothing, and takes its barriers for races.
module posix_threads
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_funptr, c_null_ptr, c_funloc, c_loc, c_intptr_t
  use many_runs, only: run_type, carry_out
  implicit none
  private
  public :: share_type, run_in_threads

  !> The runs of one thread.
  type :: share_type
    type(run_type), allocatable :: runs(:)
  end type share_type

  interface
    integer(c_int) function pthread_create(thread, attributes, work, argument) bind(c)
      import :: c_int, c_ptr, c_funptr, c_intptr_t
      integer(c_intptr_t), intent(out) :: thread   !< its handle
      type(c_ptr), value :: attributes             !< a null pointer: none
      type(c_funptr), value :: work                !< the function that the thread carries out
      type(c_ptr), value :: argument               !< of this function
    end function pthread_create

    integer(c_int) function pthread_join(thread, answer) bind(c)
      import :: c_int, c_intptr_t, c_ptr
      integer(c_intptr_t), value :: thread   !< its handle
      type(c_ptr), value :: answer           !< gets the result of its function; a null pointer: not wanted
    end function pthread_join
  end interface

contains

  !> A thread for each share. `failed` where the system gave no thread.
  subroutine run_in_threads(shares, failed)
    type(share_type), intent(inout), target :: shares(:)   !< of the work
    logical, intent(out) :: failed                         !< the system gave no thread
    integer(c_intptr_t) :: threads(size(shares))
    integer :: i, started

    started = 0
    do i = 1, size(shares)
      if (pthread_create(threads(i), c_null_ptr, c_funloc(work_on_share), c_loc(shares(i))) /= 0) exit
      started = i
    end do
    failed = started < size(shares)
    do i = 1, started
      if (pthread_join(threads(i), c_null_ptr) /= 0) failed = .true.
    end do
  end subroutine run_in_threads

  type(c_ptr) function work_on_share(argument) bind(c) result(answer)
    use, intrinsic :: iso_c_binding, only: c_f_pointer
    type(c_ptr), value :: argument   !< address of the share
    type(share_type), pointer :: share
    integer :: i

    call c_f_pointer(argument, share)
    do i = 1, size(share%runs)
      call carry_out(share%runs(i))
    end do
    answer = c_null_ptr
  end function work_on_share
end module posix_threads
