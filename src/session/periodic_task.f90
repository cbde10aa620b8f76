!> The work of mech9d for --periodic: a periodic motion is found, and a run records one period of it.
module mech9_periodic_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_periodic_words, only: print_periodic
  use mech9_run_task, only: carry_out
  use mech9_signal_interruption, only: signal_interruption_type, answer_progress_type
  implicit none
  private
  public :: work_on_periodic

contains

  !> Find the periodic motions that --periodic asks for, and record the first one.
  subroutine work_on_periodic(options, given, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout), target :: given    !< the data file; it gets the errors
    logical, intent(out) :: reported                        !< the report is written
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well
    type(picture_requests_type) :: pictures
    type(answer_progress_type), target :: progress
    type(signal_interruption_type) :: interruption
    type(error_type), allocatable :: err

    reported = .false.
    call read_picture_requests(options, given, pictures, err)
    interruption%progress => progress
    call progress%line%start(program_names(given%model%program), options%has('quiet'))
    if (.not. allocated(err)) call given%find_periodic(interruption, err)
    call progress%line%finish()
    if (.not. allocated(err)) call given%run%prepare(given%model, err, pictures=pictures%any_wanted())
    if (allocated(err)) then
      ! motions that were found before an interruption are told
      if (.not. options%has('quiet')) call tell(given, .false.)
      call given%fail(err)
    else
      call carry_out(options, pictures, given, reported, kept)
      if (.not. options%has('quiet')) call tell(given, .true.)
    end if
    call given%close_run()
  end subroutine work_on_periodic

  !> Print the periodic motions that were found.
  subroutine tell(given, recorded)
    type(data_file_type), intent(in) :: given     !< the data file
    logical, intent(in) :: recorded               !< a run has recorded the first one

    if (.not. allocated(given%periodic)) return
    if (allocated(given%periodic%motions)) call print_periodic(error_unit, given%model, given%periodic, recorded)
  end subroutine tell
end module mech9_periodic_task
