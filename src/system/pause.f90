!> Waiting without work.
module mech9_pause
  use, intrinsic :: iso_c_binding, only: c_int
  use mech9_kinds, only: wp
  implicit none
  private
  public :: pause_for

  interface
    integer(c_int) function c_usleep(microseconds) bind(c, name='usleep')
      import :: c_int
      integer(c_int), value :: microseconds   !< less than a million; useconds_t is an unsigned integer of this size
    end function c_usleep
  end interface

contains

  !> Wait without work. A signal ends the wait.
  subroutine pause_for(time)
    real(wp), intent(in) :: time   !< less than a second [s]
    integer(c_int) :: status

    status = c_usleep(int(1.0e6_wp*time, c_int))
  end subroutine pause_for
end module mech9_pause
