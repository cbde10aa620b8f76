!> The interface of everything that takes the rows of a run: a table, a file of another kind, a picture.
module mech9_result_sink
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_motion_event, only: motion_events_type
  use mech9_event_words, only: told_events_type, tell_events
  implicit none
  private
  public :: result_sink_type, sink_slot_type, append_sink, mark_events

  !> A sink is open when it is handed to a recording.
  type, abstract :: result_sink_type
    logical :: takes_poses = .false.  !< its rows contain the columns of the poses after the others
    logical :: is_lacking = .false.   !< its words tell of a file that could not be made, and are printed even with --quiet
  contains
    procedure(rows_interface), deferred :: write_rows
    procedure :: flush => flush_nothing
    procedure :: mark => mark_nothing
    procedure(close_interface), deferred :: close
    procedure :: words => no_words
  end type result_sink_type

  !> One sink of any kind, for arrays of them.
  type :: sink_slot_type
    class(result_sink_type), allocatable :: sink
  end type sink_slot_type

  abstract interface
    !> Take rows, which follow the earlier ones; they may be held back for a moment. Errors name the file.
    subroutine rows_interface(self, rows, err)
      import :: result_sink_type, error_type, wp
      class(result_sink_type), intent(inout) :: self     !< the result sink
      real(wp), intent(in), contiguous :: rows(:, :)     !< (columns, rows) numbers of the rows, in the columns given at the opening
      type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    end subroutine rows_interface

    !> Write all rows and close the files, even when writing fails. Does nothing to a sink that is closed.
    subroutine close_interface(self, err)
      import :: result_sink_type, error_type
      class(result_sink_type), intent(inout) :: self     !< the result sink
      type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    end subroutine close_interface
  end interface

contains

  !> Write the rows that are held back; by default there are none.
  subroutine flush_nothing(self, err)
    class(result_sink_type), intent(inout) :: self     !< the result sink
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
  end subroutine flush_nothing

  !> Take the events of the run, before the sink is closed; by default it has no use for them.
  subroutine mark_nothing(self, events)
    class(result_sink_type), intent(inout) :: self     !< the result sink
    type(told_events_type), intent(in) :: events       !< in the order of time
  end subroutine mark_nothing

  !> Hand the events of a run to its sinks, before these are closed.
  subroutine mark_events(slots, events, mechanism)
    type(sink_slot_type), intent(inout) :: slots(:)    !< the open sinks of the run
    type(motion_events_type), intent(in) :: events     !< in the order of time
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(told_events_type) :: told
    integer :: i

    call tell_events(events, mechanism, told)
    do i = 1, size(slots)
      call slots(i)%sink%mark(told)
    end do
  end subroutine mark_events

  !> A line for the user about the files written, after the sink is closed; by default there is none.
  function no_words(self) result(words)
    class(result_sink_type), intent(in) :: self  !< the result sink
    character(len=:), allocatable :: words

    words = ''
  end function no_words

  !> Append a sink.
  subroutine append_sink(slots, sink)
    type(sink_slot_type), allocatable, intent(inout) :: slots(:)  !< the open sinks of a run
    class(result_sink_type), allocatable, intent(inout) :: sink   !< the sink to append; not allocated afterwards
    type(sink_slot_type), allocatable :: grown(:)
    integer :: i

    allocate (grown(size(slots) + 1))
    do i = 1, size(slots)
      call move_alloc(slots(i)%sink, grown(i)%sink)
    end do
    call move_alloc(sink, grown(size(grown))%sink)
    call move_alloc(grown, slots)
  end subroutine append_sink
end module mech9_result_sink
