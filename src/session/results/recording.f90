!> Recording a motion: rows are computed and written by turns, whatever computes them.
module mech9_recording
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_interrupted
  use mech9_text, only: to_text
  use mech9_clock, only: seconds, pacer_type
  use mech9_mechanism, only: mechanism_type
  use mech9_requested, only: requested_type
  use mech9_columns, only: columns_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_film, only: film_type
  use mech9_results, only: results_type
  use mech9_progress, only: progress_type
  use mech9_system, only: interrupted
  implicit none
  private
  public :: motion_source_type, recording_outcome_type, record, stop_if_interrupted

  !> Rows that are computed before they are written together, so that both can be timed without a
  !> clock in the inner loop.
  integer, parameter :: rows_together = 256
  !> ... unless they take longer than this: they are written then, lest a run that is killed lose them [s].
  real(wp), parameter :: longest_wait = 0.25_wp

  !> What computes rows.
  type, abstract :: motion_source_type
    character(len=6) :: program_name = ''
    type(columns_type) :: columns
    type(requested_type) :: requested              !< what it works out
    type(film_type), allocatable :: film   !< takes the position of each row, where it is allocated
  contains
    procedure(row_interface), deferred :: row_at
  end type motion_source_type

  abstract interface
    !> Go on to output time t and give its row. Output times come in order, the first one is the start.
    subroutine row_interface(self, t, row, err)
      import :: motion_source_type, error_type, wp
      class(motion_source_type), intent(inout) :: self   !< the motion source
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: row(:)
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine row_interface
  end interface

  !> How the recording went.
  type :: recording_outcome_type
    integer :: rows = 0
    real(wp) :: seconds_solving = 0.0_wp
    real(wp) :: seconds_writing = 0.0_wp
  end type recording_outcome_type

contains

  !> Rows at all output times, into the results, which stay open. When the motion cannot go on, or the
  !> user interrupts, what was computed is written first.
  subroutine record(source, mechanism, results, quiet, outcome, err, kept)
    class(motion_source_type), intent(inout) :: source
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(results_type), intent(inout) :: results
    logical, intent(in) :: quiet
    type(recording_outcome_type), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(kept_rows_type), intent(inout), optional :: kept   !< for who looks at the rows after the run
    type(error_type), allocatable :: stopped, at_flush
    type(progress_type) :: progress
    type(pacer_type) :: pacer
    real(wp), allocatable :: rows(:, :)
    real(wp) :: clock
    integer :: next, count

    allocate (rows(source%columns%width(), rows_together), source=0.0_wp)
    if (present(kept)) &
      call kept%begin(mechanism%title, source%columns%names(:source%columns%count), &
                      source%columns%units(:source%columns%count), mechanism%time%intervals + 1)
    clock = seconds()
    call progress%start(source%program_name, quiet)
    call pacer%start(longest_wait)
    next = 0
    do while (next <= mechanism%time%intervals .and. .not. allocated(stopped))
      call lap(clock, outcome%seconds_writing)
      call compute_rows(source, mechanism, progress, pacer, next, rows, count, stopped)
      call lap(clock, outcome%seconds_solving)
      outcome%rows = outcome%rows + count
      if (present(kept)) call kept%take(rows(:source%columns%count, :count))
      call results%write_rows(rows(:, :count), err)
      if (allocated(err)) exit
    end do
    call progress%finish()
    call results%flush(at_flush)
    call lap(clock, outcome%seconds_writing)
    if (.not. allocated(err)) call move_alloc(at_flush, err)
    if (.not. allocated(err)) call move_alloc(stopped, err)
  end subroutine record

  !> The next rows, from output number `next` on; fewer than fit where the motion or the run ends, or takes long.
  subroutine compute_rows(source, mechanism, progress, pacer, next, rows, count, err)
    class(motion_source_type), intent(inout) :: source
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(progress_type), intent(inout) :: progress
    type(pacer_type), intent(inout) :: pacer
    integer, intent(inout) :: next
    real(wp), intent(inout) :: rows(:, :)
    integer, intent(out) :: count
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    count = 0
    do while (count < size(rows, 2) .and. next <= mechanism%time%intervals)
      call stop_if_interrupted(mechanism%time%time(next), err)
      if (allocated(err)) return
      call source%row_at(mechanism%time%time(next), rows(:, count + 1), err)
      if (allocated(err)) return
      count = count + 1
      next = next + 1
      call progress%update(real(next, wp)/max(1, mechanism%time%intervals))
      if (pacer%due()) return
    end do
  end subroutine compute_rows

  !> An error where the user wants the run to end. What takes long to come to an output asks on the way.
  subroutine stop_if_interrupted(t, err)
    real(wp), intent(in) :: t            !< the output that comes next [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (interrupted()) call raise(err, exit_interrupted, 'interrupted before t = '//to_text(t, 10)//' s')
  end subroutine stop_if_interrupted

  !> Add the time since `clock` to a sum and set the clock.
  subroutine lap(clock, sum)
    real(wp), intent(inout) :: clock, sum
    real(wp) :: now

    now = seconds()
    sum = sum + (now - clock)
    clock = now
  end subroutine lap
end module mech9_recording
