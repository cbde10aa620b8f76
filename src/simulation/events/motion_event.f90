!> Events of a motion that is not smooth: impacts, stops and contacts that close and open, and friction that sticks and slips.
module mech9_motion_event
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: most_events, most_events_at_once
  implicit none
  private
  public :: motion_event_type, motion_events_type, event_impact, event_close, event_open, event_stick, event_slip, event_lift

  !> Kinds of events, as they are written.
  character(len=*), parameter :: event_impact = 'impact', event_close = 'close ', event_open = 'open  ', &
    event_stick = 'stick ', event_slip = 'slip  ', event_lift = 'lift  '

  !> One event.
  type :: motion_event_type
    real(wp) :: t = 0.0_wp              !< time [s]
    character(len=6) :: kind = ''       !< one of the kinds above
    character(len=8) :: group = ''      !< kind of the group of the data file that it belongs to
    integer :: number = 0               !< of that group
    logical :: has_impulse = .false.    !< there is an impulse
    real(wp) :: impulse = 0.0_wp        !< on the coordinate, positive while it grows [N m s, N s]
  end type motion_event_type

  !> Events in the order of time.
  type :: motion_events_type
    integer :: count = 0                                !< how many there are
    type(motion_event_type), allocatable :: items(:)    !< the events, then room for more; not allocated: there was none yet
    real(wp), private :: t_met = 0.0_wp                 !< time of the last meeting of contacts and frictions [s]
    integer, private :: meetings = 0                    !< how many there were before it at this time
    real(wp), allocatable :: time_rates(:)              !< (P) derivatives of the time of the last event by the parameters; NaN: not
                                                        !< known; not allocated: none are integrated
  contains
    procedure :: add
    procedure :: judge_progress
    procedure :: first_jump
  end type motion_events_type

contains

  !> Add an event.
  pure subroutine add(self, event)
    class(motion_events_type), intent(inout) :: self   !< the events
    type(motion_event_type), intent(in) :: event       !< the next one
    type(motion_event_type), allocatable :: more(:)
    integer :: i

    if (.not. allocated(self%items)) allocate (self%items(16))
    if (self%count == size(self%items)) then
      allocate (more(2*self%count))
      more(:self%count) = self%items
      call move_alloc(more, self%items)
    end if
    self%count = self%count + 1
    ! the end of endless impacts is known before it comes
    do i = self%count, 2, -1
      if (self%items(i - 1)%t <= event%t) exit
      self%items(i) = self%items(i - 1)
    end do
    self%items(i) = event
  end subroutine add

  !> Judge whether there are so many events, or so many at the present time, that the motion makes no progress. Meetings that change
  !> nothing count, too.
  pure subroutine judge_progress(self, before, t, stalls)
    class(motion_events_type), intent(inout) :: self   !< the events
    integer, intent(in) :: before                      !< how many there were before the last ones
    real(wp), intent(in) :: t                          !< the present time [s]
    logical, intent(out) :: stalls                     !< the motion makes no progress

    self%meetings = merge(0, self%meetings + 1, abs(t - self%t_met) > 0.0_wp)
    self%t_met = t
    stalls = self%count > most_events .or. self%meetings > most_events_at_once
    if (stalls .or. self%count == before .or. self%count <= most_events_at_once) return
    stalls = .not. abs(self%items(self%count)%t - self%items(self%count - most_events_at_once)%t) > 0.0_wp
  end subroutine judge_progress

  !> The lowest derivative of positions in time that jumps behind one time, up to another one that has come: 1 rates, 2 accelerations, 3
  !> none. The last events are looked at first.
  pure integer function first_jump(self, from, to) result(jump)
    class(motion_events_type), intent(in) :: self   !< the events so far
    real(wp), intent(in) :: from                    !< the time before [s]
    real(wp), intent(in) :: to                      !< the time that has come [s]
    real(wp) :: direction
    integer :: i

    jump = 3
    direction = sign(1.0_wp, to - from)
    do i = self%count, 1, -1
      if ((self%items(i)%t - from)*direction <= 0.0_wp) return
      if ((self%items(i)%t - to)*direction > 0.0_wp) cycle
      jump = min(jump, merge(1, 2, self%items(i)%kind == event_impact))
    end do
  end function first_jump
end module mech9_motion_event
