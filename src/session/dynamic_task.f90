!> The work of mech9d on a mechanism.
module mech9_dynamic_task
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_equilibrium_task, only: asks_for_equilibrium, find_rest
  use mech9_law_times, only: check_times_of_laws
  use mech9_task, only: task_type, answers_only, print_check, print_given, begin_run, end_run
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_facts, only: facts_type
  use mech9_results, only: results_type
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_free_simulation, only: free_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_row_source, only: row_source_type, new_row_source
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_recording, only: recording_outcome_type, record
  use mech9_start_way_text, only: print_start_way
  use mech9_kinematic_task, only: work_driven
  use mech9_dynamic_report, only: print_dynamic_report, save_dynamic_report, print_coefficients, &
                                   dynamic_facts, write_dynamics, write_events
  implicit none
  private
  public :: dynamic_task_type, dynamic_task

  type, extends(task_type) :: dynamic_task_type
  contains
    procedure :: work
  end type dynamic_task_type

contains

  !> The task of mech9d.
  pure function dynamic_task() result(task)
    type(dynamic_task_type) :: task

    task%program = dynamics
  end function dynamic_task

  !> Make the plan, assemble the mechanism, compute its state at the start, and run unless only an answer is requested.
  subroutine work(self, options, model, variable, diagnostics, reported, kept)
    class(dynamic_task_type), intent(in) :: self            !< the dynamic task
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in), target :: model           !< the model
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well, for a look at them after the run
    type(model_type), target :: used
    type(model_motion_type), target :: motion
    type(picture_requests_type) :: pictures
    type(free_simulation_type), pointer :: simulation
    type(error_type), allocatable :: err

    if (asks_for_equilibrium(options)) then
      call find_rest(options, model, diagnostics, reported, kept)
      return
    end if
    if (model%is_driven()) then
      call work_driven(options, model, variable, diagnostics, reported, kept)
      return
    end if
    reported = .false.
    if (options%has('check') .or. .not. answers_only(options)) call check_times_of_laws(model, .true., diagnostics)
    if (diagnostics%failed()) return
    used = model
    call read_picture_requests(options, model, pictures, err)
    if (.not. allocated(err)) call motion%assemble(used, err)
    if (.not. allocated(err)) &
      call motion%prepare(used, err, pictures%any_wanted() .or. model%request%output%with_derivatives())
    if (allocated(err)) then
      if (options%has('check')) call print_given(model, .true.)
      call diagnostics%add_error(err)
    else if (answers_only(options)) then
      simulation => motion%free()
      call print_check(options, pictures, model, motion%plan, simulation%requested, motion%start, motion%way, diagnostics)
      if (options%has('check') .or. options%has('plan')) call print_coefficients(output_unit, motion%plan, simulation%coefficients)
      if (options%has('check')) call check_motion(model, variable, simulation, err)
      if (allocated(err)) call diagnostics%add_error(err)
    else
      call carry_out(options, pictures, used, variable, motion, diagnostics, reported, kept)
    end if
    call motion%close()
  end subroutine work

  !> Fail in a check where a run would fail at its start.
  subroutine check_motion(model, variable, simulation, err)
    type(model_type), intent(in), target :: model                     !< the model
    class(variable_model_type), intent(inout), target :: variable     !< the model as a function of its parameters
    type(free_simulation_type), intent(inout), target :: simulation   !< is started
    type(error_type), allocatable, intent(out) :: err                 !< allocated if it failed
    type(row_source_type), allocatable :: source
    real(wp), allocatable :: row(:)

    allocate (source)
    call new_row_source(simulation, source)
    if (model%request%output%with_derivatives()) call source%add_sensitivities(variable, err)
    if (.not. allocated(err)) call source%begin_quantities(err)
    if (allocated(err)) return
    allocate (row(source%columns%width()))
    call source%row_at(model%request%time%start, row, err)
  end subroutine check_motion

  !> The run itself and its report.
  subroutine carry_out(options, pictures, model, variable, motion, diagnostics, reported, kept)
    type(command_line_type), intent(in) :: options                    !< the command line
    type(picture_requests_type), intent(in) :: pictures               !< the pictures of the mechanism that are requested
    type(model_type), intent(inout), target :: model                  !< of the simulation; gets the tolerances for an accuracy
    class(variable_model_type), intent(inout), target :: variable     !< the model as a function of its parameters
    type(model_motion_type), intent(inout), target :: motion          !< prepared
    type(diagnostics_type), intent(inout) :: diagnostics              !< gets the errors
    logical, intent(out) :: reported                                  !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept             !< gets the rows as well, for a look at them after the run
    type(free_simulation_type), pointer :: simulation
    type(row_source_type), allocatable :: source
    type(results_type), target :: results
    type(facts_type) :: facts
    type(hdf5_sink_type), pointer :: hdf5
    type(recording_outcome_type) :: outcome
    type(signal_interruption_type), target :: interruption
    type(error_type), allocatable :: err
    logical :: ready

    simulation => motion%free()
    allocate (source)
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
    if (simulation%with_error) then
      call interruption%words%start(model%program, 'no row yet', 'a run that tells the accuracy', options%has('quiet'), &
                                    with_progress=.true.)
      call motion%find_tolerances(model, err, pictures%any_wanted(), interruption)
      call interruption%words%finish()
    end if
    call dynamic_facts(model, motion%plan, outcome, simulation, facts)
    call results%write_facts(facts)
    hdf5 => results%hdf5()
    if (associated(hdf5)) call write_dynamics(hdf5, motion%plan, simulation)
    if (.not. allocated(err)) call record(source, model, results, options%has('quiet'), outcome, err, kept)
    if (.not. options%has('quiet')) call print_dynamic_report(error_unit, results%table_path, outcome, simulation)
    if (allocated(err)) call diagnostics%add_error(err)
    call dynamic_facts(model, motion%plan, outcome, simulation, facts)
    call results%write_facts(facts, diagnostics%code())
    if (associated(hdf5)) call write_events(hdf5, simulation)
    call end_run(options, pictures, model, source, results, diagnostics)
    if (.not. reported) return
    call save_dynamic_report(options%argument('report'), model, motion%plan, results%table_path, diagnostics, &
                             outcome, simulation, err, source%forces%unique, source%quantities)
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine carry_out
end module mech9_dynamic_task
