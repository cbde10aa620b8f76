!> A monotonic clock, and a pacer that tells cheaply when an interval is over.
module mech9_clock
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: seconds, pacer_type

  !> The largest number of calls of a pacer between two readings of the clock. A reading takes some 30 ns,
  !> so that a call takes half a nanosecond; and a loop that slows down is noticed soon.
  integer, parameter :: longest_stride = 64

  !> A pacer is called at each turn of a loop and tells about once per interval that it is over. It reads the
  !> clock at each call while calls are slow, and only at some of them while they are fast.
  type :: pacer_type
    private
    real(wp) :: interval = 1.0_wp    !< [s]
    real(wp) :: last_time = 0.0_wp   !< start of the present interval [s]
    real(wp) :: last_look = 0.0_wp   !< the last reading of the clock [s]
    integer :: stride = 1            !< calls from one reading to the next
    integer :: calls = 0             !< since the last reading
  contains
    procedure :: start
    procedure :: due
  end type pacer_type

contains

  !> A monotonic time [s] from an arbitrary origin; only differences mean anything.
  real(wp) function seconds()
    integer(long) :: count, rate

    call system_clock(count, rate)
    ! whole seconds apart, so that no digit is lost after a long uptime
    seconds = real(count/rate, wp) + real(mod(count, rate), wp)/real(rate, wp)
  end function seconds

  !> Begin; the first interval starts now.
  subroutine start(self, interval)
    class(pacer_type), intent(inout) :: self   !< the pacer
    real(wp), intent(in) :: interval           !< [s]

    self%interval = interval
    self%last_time = seconds()
    self%last_look = self%last_time
    self%stride = 1
    self%calls = 0
  end subroutine start

  !> Whether an interval has passed since `start` or since this last was true.
  logical function due(self)
    class(pacer_type), intent(inout) :: self   !< the pacer
    real(wp) :: now

    due = .false.
    self%calls = self%calls + 1
    if (self%calls < self%stride) return
    self%calls = 0
    now = seconds()
    if (now - self%last_look < 0.05_wp*self%interval) then
      self%stride = min(2*self%stride, longest_stride)
    else
      self%stride = 1
    end if
    self%last_look = now
    due = now - self%last_time >= self%interval
    if (due) self%last_time = now
  end function due
end module mech9_clock
