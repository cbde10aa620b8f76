!> The work of mech9k on a mechanism, and that of mech9d where all independent coordinates are driven.
module mech9_kinematic_task
  use, intrinsic :: iso_fortran_env, only: output_unit
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_requested, only: requested_by_results
  use mech9_run, only: run_type
  use mech9_branch_task, only: work_on_branches
  use mech9_law_times, only: check_times_of_laws
  use mech9_task, only: task_type, answers_only, print_check, check_motion
  use mech9_check_text, only: print_given
  use mech9_range_text, only: print_ranges
  use mech9_cam_task, only: work_on_cams
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_kinematic_report, only: kinematic_report_type
  use mech9_run_task, only: carry_out
  implicit none
  private
  public :: kinematic_task_type, kinematic_task, work_driven

  type, extends(task_type) :: kinematic_task_type
  contains
    procedure :: work
  end type kinematic_task_type

contains

  !> The task of mech9k.
  pure function kinematic_task() result(task)
    type(kinematic_task_type) :: task

    task%program = kinematics
  end function kinematic_task

  !> Make the plan, assemble the mechanism, and run unless only an answer is requested.
  subroutine work(self, options, model, variable, diagnostics, reported, kept)
    class(kinematic_task_type), intent(in) :: self          !< the kinematic task
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in), target :: model           !< the model
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well, for a look at them after the run

    if (options%has('branch')) then
      call work_on_branches(options, model, variable, diagnostics, reported)
      return
    end if
    call work_driven(options, model, variable, diagnostics, reported, kept)
  end subroutine work

  !> Carry out the work on a mechanism whose independent coordinates are all driven.
  subroutine work_driven(options, model, variable, diagnostics, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in), target :: model               !< the model
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well, for a look at them after the run
    class(model_type), allocatable, target :: used
    type(kinematic_report_type) :: report
    class(run_type), allocatable, target :: run
    type(picture_requests_type) :: pictures
    type(error_type), allocatable :: err

    reported = .false.
    if (options%has('check') .or. options%has('cam') .or. .not. answers_only(options)) &
      call check_times_of_laws(model, model%program == dynamics .or. model%request%output%with_forces(), diagnostics)
    if (diagnostics%failed()) return
    allocate (run)
    allocate (used, source=model)
    call read_picture_requests(options, model, pictures, err)
    if (.not. allocated(err)) call run%motion%assemble(used, err)
    if (allocated(err)) then
      if (options%has('check')) call print_given(output_unit, model, model%program == dynamics)
      call diagnostics%add_error(err)
      return
    end if
    if (answers_only(options)) then
      call print_check(options, pictures, model, run%motion%plan, &
                       requested_by_results(model%mechanism, model%request%output, pictures%any_wanted()), run%motion%start, &
                       run%motion%way, diagnostics)
      if (options%has('range')) call print_ranges(output_unit, model, run%motion%plan, run%motion%start)
      if (options%has('check')) call check_motion(used, variable, run, err)
      if (options%has('cam') .and. .not. allocated(err)) &
        call work_on_cams(options, model, run%motion%plan, run%motion%start, diagnostics, reported, err)
      if (allocated(err)) call diagnostics%add_error(err)
      return
    end if
    call run%prepare(used, err, variable, pictures%any_wanted())
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else
      call carry_out(options, pictures, used, report, run, diagnostics, reported, kept)
    end if
  end subroutine work_driven
end module mech9_kinematic_task
