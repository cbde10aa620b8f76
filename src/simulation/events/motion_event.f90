!> Events of a motion that is not smooth: impacts on stops, and stops that close and open.
module mech9_motion_event
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: most_events, most_events_at_once
  implicit none
  private
  public :: motion_event_type, motion_events_type, event_impact, event_close, event_open

  !> Kinds of events, as they are written.
  character(len=*), parameter :: event_impact = 'impact', event_close = 'close ', event_open = 'open  '

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
  contains
    procedure :: add
    procedure :: makes_no_progress
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

  !> Whether there are so many events, or so many at the time of the last one, that the motion makes no progress.
  pure logical function makes_no_progress(self, before)
    class(motion_events_type), intent(in) :: self   !< the events
    integer, intent(in) :: before                   !< how many there were before the last ones

    makes_no_progress = self%count > most_events
    if (makes_no_progress .or. self%count == before .or. self%count <= most_events_at_once) return
    makes_no_progress = .not. abs(self%items(self%count)%t - self%items(self%count - most_events_at_once)%t) > 0.0_wp
  end function makes_no_progress
end module mech9_motion_event
