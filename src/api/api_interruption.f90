!> Interruption of calls, and their progress: a number of the caller that stops a call once it is not 0, and a function of the caller
!> that learns how far the call is and may stop it (include/mech9.h).
module mech9_api_interruption
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_long, c_ptr, c_funptr, c_null_ptr, c_null_funptr, c_associated, &
    c_f_pointer, c_f_procpointer
  use mech9, only: wp, interruption_type, error_type
  use mech9_clock, only: pacer_type
  implicit none
  private
  public :: flag_interruption_type, progress_type, new_interruption, end_progress

  !> Time between two calls of a function for progress [s].
  real(wp), parameter :: between = 0.1_wp

  abstract interface
    !> A function of the caller: other than 0 stops the call.
    integer(c_int) function c_progress_function(done, data) bind(c)
      import :: c_int, c_double, c_ptr
      real(c_double), value :: done   !< share of the call that is done, from 0 to 1
      type(c_ptr), value :: data      !< of the caller
    end function c_progress_function
  end interface

  interface
    !> The thread that runs.
    integer(c_long) function present_thread() bind(c, name='pthread_self')
      import :: c_long
    end function present_thread
  end interface

  !> The progress of one call; all copies of its interruption share it.
  type :: progress_type
    type(c_funptr) :: function = c_null_funptr          !< of the caller; null: nobody wants to know
    type(c_ptr) :: data = c_null_ptr                    !< is given to it
    type(pacer_type), private :: pacer
    real(wp), private :: share = 0.0_wp                 !< of the call that is done, from 0 to 1
    integer(c_int), private :: answer = 0               !< the last one that was not 0
    integer(c_long), private :: thread = 0              !< the only one that calls the function: that of the call
  end type progress_type

  !> Stops a call once a number of the caller is not 0, or once its function says so.
  type, extends(interruption_type) :: flag_interruption_type
    private
    integer(c_int), pointer :: stop => null()             !< of the caller; null: nobody stops the call
    type(progress_type), pointer :: progress => null()    !< of the call; null: nobody wants to know
  contains
    procedure :: is_wanted
    procedure :: tell
  end type flag_interruption_type

contains

  !> An interruption by a number of the caller, and by its function for progress.
  subroutine new_interruption(stop, interruption, progress)
    type(c_ptr), intent(in) :: stop                                 !< address of the number, or null
    type(flag_interruption_type), intent(out) :: interruption       !< reads it
    type(progress_type), intent(inout), target, optional :: progress   !< with the function; it must outlive the call
    integer(c_int), pointer :: flag

    if (c_associated(stop)) then
      call c_f_pointer(stop, flag)
      interruption%stop => flag
    end if
    if (.not. present(progress)) return
    if (.not. c_associated(progress%function)) return
    call progress%pacer%start(between)
    progress%thread = present_thread()
    interruption%progress => progress
  end subroutine new_interruption

  !> Whether the call shall stop.
  logical function is_wanted(self)
    class(flag_interruption_type), intent(in) :: self   !< the interruption
    integer(c_int), pointer, volatile :: flag           ! another thread may change it at any time

    is_wanted = .false.
    if (associated(self%stop)) then
      flag => self%stop
      is_wanted = flag /= 0
    end if
    if (is_wanted .or. .not. associated(self%progress)) return
    flag => self%progress%answer
    is_wanted = flag /= 0
    if (is_wanted) return
    if (present_thread() /= self%progress%thread) return
    if (.not. self%progress%pacer%due()) return
    call call_function(self%progress)
    is_wanted = self%progress%answer /= 0
  end function is_wanted

  !> Learn how far the call is.
  subroutine tell(self, share)
    class(flag_interruption_type), intent(inout) :: self   !< the interruption
    real(wp), intent(in) :: share                          !< of the call that is done, from 0 to 1

    if (associated(self%progress)) self%progress%share = share
  end subroutine tell

  !> Tell the caller how far the call is.
  subroutine call_function(progress)
    type(progress_type), intent(inout) :: progress   !< of the call, with a function
    procedure(c_progress_function), pointer :: listener

    call c_f_procpointer(progress%function, listener)
    progress%answer = listener(real(progress%share, c_double), progress%data)
  end subroutine call_function

  !> Tell the caller that a call is done, unless it failed.
  subroutine end_progress(progress, err)
    type(progress_type), intent(inout) :: progress              !< of the call
    type(error_type), allocatable, intent(in) :: err            !< its failure, if there is one

    if (allocated(err) .or. .not. c_associated(progress%function)) return
    progress%share = 1.0_wp
    call call_function(progress)
  end subroutine end_progress
end module mech9_api_interruption
