!> The work of mech9k on a mechanism, and that of mech9d where all independent coordinates are driven.
module mech9_kinematic_task
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_requested, only: requested_by_results
  use mech9_driven_motion, only: set_inputs
  use mech9_driven_simulation, only: driven_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_row_source, only: row_source_type, new_row_source
  use mech9_law_times, only: check_times_of_laws
  use mech9_task, only: task_type, answers_only, print_check, print_given, begin_run, end_run
  use mech9_range_text, only: print_ranges
  use mech9_cam_task, only: work_on_cams
  use mech9_facts, only: facts_type
  use mech9_results, only: results_type
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_recording, only: recording_outcome_type, record
  use mech9_start_way_text, only: print_start_way
  use mech9_kinematic_report, only: print_kinematic_report, save_kinematic_report, kinematic_facts
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

    call work_driven(options, model, variable, diagnostics, reported, kept)
  end subroutine work

  !> The work on a mechanism whose independent coordinates are all driven.
  subroutine work_driven(options, model, variable, diagnostics, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in), target :: model               !< the model
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well, for a look at them after the run
    type(model_motion_type), target :: motion
    type(picture_requests_type) :: pictures
    type(error_type), allocatable :: err

    reported = .false.
    if (options%has('check') .or. options%has('cam') .or. .not. answers_only(options)) &
      call check_times_of_laws(model, model%program == dynamics .or. model%request%output%with_forces(), diagnostics)
    if (diagnostics%failed()) return
    call read_picture_requests(options, model, pictures, err)
    if (.not. allocated(err)) call motion%assemble(model, err)
    if (allocated(err)) then
      if (options%has('check')) call print_given(model, model%program == dynamics)
      call diagnostics%add_error(err)
      return
    end if
    if (answers_only(options)) then
      call print_check(options, pictures, model, motion%plan, &
                       requested_by_results(model%mechanism, model%request%output, pictures%any_wanted()), motion%start, &
                       motion%way, diagnostics)
      if (options%has('range')) call print_ranges(output_unit, model, motion%plan, motion%start)
      if (options%has('check')) call check_motion(model, variable, motion, err)
      if (options%has('cam') .and. .not. allocated(err)) &
        call work_on_cams(options, model, motion%plan, motion%start, diagnostics, reported, err)
      if (allocated(err)) call diagnostics%add_error(err)
      return
    end if
    call motion%prepare(model, err, pictures%any_wanted())
    if (.not. allocated(err)) call carry_out(options, pictures, model, variable, motion, diagnostics, reported, kept)
  end subroutine work_driven

  !> Fail in a check where a run would fail: at a start from which the motion cannot begin, or at drives without values
  !> at the end of the time.
  subroutine check_motion(model, variable, motion, err)
    type(model_type), intent(in), target :: model           !< the model
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(model_motion_type), intent(inout), target :: motion   !< assembled; is started
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(row_source_type), allocatable :: source
    real(wp), dimension(size(model%mechanism%pairs)) :: q, dq, ddq
    real(wp), allocatable :: row(:)

    call motion%prepare(model, err)
    if (allocated(err)) return
    allocate (source)
    call new_row_source(motion%simulation, source)
    if (model%request%output%with_derivatives()) call source%add_sensitivities(variable, err)
    if (.not. allocated(err)) call source%begin_quantities(err)
    if (allocated(err)) return
    allocate (row(source%columns%width()))
    call source%row_at(model%request%time%start, row, err)
    if (.not. allocated(err)) call set_inputs(model%problem%drives, model%request%time%end, q, dq, ddq, err)
  end subroutine check_motion

  !> The run itself and its report.
  subroutine carry_out(options, pictures, model, variable, motion, diagnostics, reported, kept)
    type(command_line_type), intent(in) :: options                      !< the command line
    type(picture_requests_type), intent(in) :: pictures                 !< the pictures of the mechanism that are requested
    type(model_type), intent(in), target :: model                           !< the model
    class(variable_model_type), intent(inout), target :: variable               !< the model as a function of its parameters
    type(model_motion_type), intent(inout), target :: motion            !< prepared
    type(diagnostics_type), intent(inout) :: diagnostics                !< gets the errors
    logical, intent(out) :: reported                                    !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept               !< gets the rows as well, for a look at them after the run
    type(driven_simulation_type), pointer :: simulation
    type(row_source_type), allocatable :: source
    type(results_type), target :: results
    type(facts_type) :: facts
    type(recording_outcome_type) :: outcome
    type(error_type), allocatable :: err
    logical :: ready

    allocate (source)
    simulation => motion%driven()
    call new_row_source(simulation, source)
    call source%forces%judge(model, motion%plan, motion%start)
    reported = .false.
    if (model%request%output%with_derivatives()) call source%add_sensitivities(variable, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
      return
    end if
    call begin_run(options, pictures, model, motion%plan, simulation%requested, source, results, diagnostics, ready)
    if (.not. options%has('quiet')) call print_start_way(error_unit, model%mechanism, motion%way)
    reported = ready .and. options%has('report')
    if (.not. ready) return
    call kinematic_facts(simulation%plan, outcome, simulation%driven, facts)
    call results%write_facts(facts)
    call record(source, model, results, options%has('quiet'), outcome, err, kept)
    if (.not. options%has('quiet')) &
      call print_kinematic_report(error_unit, model, simulation%plan, results%table_path, outcome, simulation%driven)
    if (allocated(err)) call diagnostics%add_error(err)
    call kinematic_facts(simulation%plan, outcome, simulation%driven, facts)
    call results%write_facts(facts, diagnostics%code())
    call end_run(options, pictures, model, source, results, diagnostics)
    if (.not. reported) return
    call save_kinematic_report(options%argument('report'), model, simulation%plan, results%table_path, diagnostics, &
                               outcome, simulation%driven, err, source%forces%unique, source%quantities)
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine carry_out
end module mech9_kinematic_task
