!> The work of mech9d for --periodic: a periodic motion is found, and a run records one period of it.
module mech9_periodic_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_periodic, only: periodic_found_type, find_periodic
  use mech9_periodic_run, only: take_periodic, start_periodic
  use mech9_periodic_words, only: print_periodic
  use mech9_run, only: run_type
  use mech9_run_task, only: carry_out
  use mech9_signal_interruption, only: signal_interruption_type
  implicit none
  private
  public :: work_on_periodic

contains

  !> Find the periodic motions that --periodic asks for, and record the first one.
  subroutine work_on_periodic(options, model, diagnostics, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< the report is written
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well
    class(model_type), allocatable, target :: used
    class(run_type), allocatable, target :: run
    type(picture_requests_type) :: pictures
    type(periodic_found_type) :: found
    type(error_type), allocatable :: err

    reported = .false.
    allocate (run)
    allocate (used, source=model)
    call read_picture_requests(options, model, pictures, err)
    if (.not. allocated(err)) call find_periodic(model, found, err, signal_interruption_type())
    if (.not. allocated(err)) then
      call take_periodic(found%motions(1), used)
      call run%motion%assemble(used, err)
    end if
    if (.not. allocated(err)) call start_periodic(found%motions(1), used, run%motion, err)
    if (.not. allocated(err)) call run%prepare(used, err, pictures=pictures%any_wanted())
    if (allocated(err)) then
      ! motions that were found before an interruption are told
      if (allocated(found%motions) .and. .not. options%has('quiet')) call print_periodic(error_unit, model, found, .false.)
      call diagnostics%add_error(err)
    else
      call carry_out(options, pictures, used, run, diagnostics, reported, kept, found)
      if (.not. options%has('quiet')) call print_periodic(error_unit, model, found, .true.)
    end if
    call run%close()
  end subroutine work_on_periodic
end module mech9_periodic_task
