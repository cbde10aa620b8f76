!> Recording of a motion: rows are computed and written alternately.
module mech9_recording
  use mech9_program_kind, only: program_names
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_interrupted
  use mech9_clock, only: seconds, pacer_type
  use mech9_system, only: interrupted
  use mech9_text, only: to_text
  use mech9_data_file, only: data_file_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_results, only: results_type
  use mech9_progress, only: progress_type
  use mech9_standing_text, only: standing_text
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_waiting_words, only: first_words_after
  implicit none
  private
  public :: record

  !> Rows that are computed before they are written together, so that both can be timed without a
  !> clock in the inner loop.
  integer, parameter :: rows_together = 256
  !> Time after which computed rows are written even if there are fewer, so that a killed run does not lose them [s].
  real(wp), parameter :: longest_wait = 0.25_wp

contains

  !> Record the rows at all output times in the results, which stay open. When the motion cannot go on, or the user
  !> interrupts, the computed rows are written first. A motion that takes long to its next output pauses: earlier rows
  !> reach the files, and the user is told its place.
  subroutine record(given, results, quiet, err, kept)
    type(data_file_type), intent(inout) :: given                !< the data file, with its run; it gets the outcome
    type(results_type), intent(inout) :: results                !< open
    logical, intent(in) :: quiet                                !< no progress is shown
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows, for use after the run
    type(error_type), allocatable :: stopped, at_flush
    type(progress_type) :: progress
    type(pacer_type) :: pacer
    type(pacer_type), pointer :: pause
    type(signal_interruption_type), pointer :: interruption
    real(wp), allocatable :: rows(:, :)
    real(wp) :: clock, last_row, words_after
    integer :: next, count
    logical :: held_back

    allocate (rows(given%run%source%columns%width(), rows_together), source=0.0_wp)
    if (present(kept)) call begin_kept(given, kept)
    clock = seconds()
    call progress%start(program_names(given%model%program), quiet)
    call pacer%start(longest_wait)
    allocate (pause, interruption)
    call pause%start(longest_wait)
    interruption%pause => pause
    given%run%source%interruption => interruption
    last_row = clock
    words_after = first_words_after
    held_back = .false.
    next = 0
    do while (next <= given%model%request%time%intervals .and. .not. allocated(stopped))
      call lap(clock, given%outcome%seconds_writing)
      call compute_rows(given, progress, pacer, next, rows, count, stopped)
      call lap(clock, given%outcome%seconds_solving)
      given%outcome%rows = given%outcome%rows + count
      if (present(kept)) call kept%take(rows(:given%run%source%columns%count, :count))
      call results%write_rows(rows(:, :count), err)
      if (allocated(err)) exit
      if (count > 0) then
        last_row = clock
        words_after = first_words_after
        held_back = .true.
      else if (held_back) then
        call results%flush(err)
        if (allocated(err)) exit
        held_back = .false.
      end if
      if (.not. is_pause(stopped)) cycle
      deallocate (stopped)
      call progress%update(part_done(given))
      if (quiet .or. clock - last_row < words_after) cycle
      call tell_standing(given, int(clock - last_row), progress)
      words_after = 2.0_wp*words_after
    end do
    given%run%source%interruption => null()
    deallocate (pause, interruption)
    call progress%finish()
    if (.not. (allocated(stopped) .or. allocated(err) .or. given%run%source%quantities%is_empty())) &
      call given%run%source%quantities%finish()
    call results%flush(at_flush)
    call lap(clock, given%outcome%seconds_writing)
    if (.not. allocated(err)) call move_alloc(at_flush, err)
    if (.not. allocated(err)) call move_alloc(stopped, err)
  end subroutine record

  !> Begin to keep rows.
  subroutine begin_kept(given, kept)
    type(data_file_type), intent(in) :: given        !< the data file, with its run
    type(kept_rows_type), intent(inout) :: kept      !< gets names and units

    associate (columns => given%run%source%columns)
      call kept%begin(given%model%mechanism%title, columns%names(:columns%count), columns%units(:columns%count), &
                      given%model%request%time%intervals + 1)
    end associate
    kept%parts = given%model%mechanism%names
  end subroutine begin_kept

  !> Whether a motion stopped for a pause and not for the user.
  logical function is_pause(stopped)
    type(error_type), allocatable, intent(in) :: stopped   !< why it stopped, if it did

    is_pause = allocated(stopped)
    if (is_pause) is_pause = stopped%code == exit_interrupted
    if (is_pause) is_pause = .not. interrupted()
  end function is_pause

  !> Tell where the motion stands.
  subroutine tell_standing(given, waited, progress)
    type(data_file_type), intent(inout) :: given     !< the data file, with its run
    integer, intent(in) :: waited                    !< time without a new row [s]
    type(progress_type), intent(inout) :: progress   !< of the recording

    call progress%say(program_names(given%model%program)//': no new row for '//to_text(waited)//' s: the motion is at '// &
                      standing_text(given%model, given%run%source%standing()))
  end subroutine tell_standing

  !> The part of the run's time that is over.
  real(wp) function part_done(given)
    type(data_file_type), intent(inout) :: given   !< the data file, with its run

    associate (time => given%model%request%time, standing => given%run%source%standing())
      part_done = 0.0_wp
      if (abs(time%end - time%start) > 0.0_wp) part_done = (standing%t - time%start)/(time%end - time%start)
    end associate
  end function part_done

  !> Compute the next rows, from output number `next` on; there are fewer where the motion or the run ends, or takes long.
  subroutine compute_rows(given, progress, pacer, next, rows, count, err)
    type(data_file_type), intent(inout) :: given                !< the data file, with its run
    type(progress_type), intent(inout) :: progress              !< is told of each row
    type(pacer_type), intent(inout) :: pacer                    !< says when rows must be written
    integer, intent(inout) :: next                              !< number of the next output, from 0 on
    real(wp), intent(inout), contiguous :: rows(:, :)           !< (width, most rows)
    integer, intent(out) :: count                               !< rows that were computed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: taken

    count = 0
    taken = 0
    do while (taken < size(rows, 2) .and. next <= given%model%request%time%intervals)
      call given%run%source%add_row(given%model%request%time%time(next), rows, count, err)
      if (allocated(err)) return
      taken = taken + 1
      next = next + 1
      call progress%update(real(next, wp)/max(1, given%model%request%time%intervals))
      if (pacer%due()) exit
    end do
    call given%run%source%complete(rows, count, err)
  end subroutine compute_rows

  !> Add the time since `clock` to a sum and set the clock.
  subroutine lap(clock, sum)
    real(wp), intent(inout) :: clock   !< a time before [s]; set to now
    real(wp), intent(inout) :: sum     !< gets the time since then [s]
    real(wp) :: now

    now = seconds()
    sum = sum + (now - clock)
    clock = now
  end subroutine lap
end module mech9_recording
