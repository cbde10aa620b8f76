!> The work of mech9d on a mechanism.
module mech9_dynamic_task
  use, intrinsic :: iso_fortran_env, only: output_unit
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_equilibrium_task, only: asks_for_equilibrium, find_rest
  use mech9_exponents_task, only: work_on_exponents
  use mech9_periodic_task, only: work_on_periodic
  use mech9_branch_task, only: work_on_branches
  use mech9_linear_task, only: work_on_linear_motion
  use mech9_law_times, only: check_times_of_laws
  use mech9_task, only: task_type, answers_only, print_check, check_motion
  use mech9_check_text, only: print_given
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_free_simulation, only: free_simulation_type
  use mech9_run, only: run_type
  use mech9_kinematic_task, only: work_driven
  use mech9_dynamic_report, only: dynamic_report_type, print_coefficients
  use mech9_run_task, only: carry_out
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
    class(model_type), allocatable, target :: used
    type(dynamic_report_type) :: report
    class(run_type), allocatable, target :: run
    type(picture_requests_type) :: pictures
    type(free_simulation_type), pointer :: simulation
    type(error_type), allocatable :: err

    if (asks_for_equilibrium(options)) then
      call find_rest(options, model, diagnostics, reported, kept)
      return
    end if
    if (options%has('at')) then
      reported = .false.
      call work_on_linear_motion(options, model, diagnostics)
      return
    end if
    if (options%has('exponents')) then
      call work_on_exponents(options, model, diagnostics, reported)
      return
    end if
    if (options%has('periodic')) then
      call work_on_periodic(options, model, diagnostics, reported, kept)
      return
    end if
    if (options%has('branch')) then
      call work_on_branches(options, model, variable, diagnostics, reported)
      return
    end if
    if (model%is_driven()) then
      call work_driven(options, model, variable, diagnostics, reported, kept)
      return
    end if
    reported = .false.
    if (options%has('check') .or. .not. answers_only(options)) call check_times_of_laws(model, .true., diagnostics)
    if (diagnostics%failed()) return
    allocate (run)
    allocate (used, source=model)
    call read_picture_requests(options, model, pictures, err)
    if (.not. allocated(err)) call run%motion%assemble(used, err)
    if (.not. allocated(err) .and. answers_only(options)) then
      call run%motion%prepare(used, err, pictures%any_wanted())
    else if (.not. allocated(err)) then
      call run%prepare(used, err, variable, pictures%any_wanted())
    end if
    if (allocated(err)) then
      if (options%has('check')) call print_given(output_unit, model, .true.)
      call diagnostics%add_error(err)
    else if (answers_only(options)) then
      simulation => run%motion%free()
      associate (motion => run%motion)
        call print_check(options, pictures, model, motion%plan, simulation%requested, motion%start, motion%way, diagnostics)
        if (options%has('check') .or. options%has('plan')) &
          call print_coefficients(output_unit, model%mechanism, motion%plan, simulation%coefficients)
      end associate
      if (options%has('check')) call check_motion(used, variable, run, err)
      if (allocated(err)) call diagnostics%add_error(err)
    else
      call carry_out(options, pictures, used, report, run, diagnostics, reported, kept)
    end if
    call run%close()
  end subroutine work
end module mech9_dynamic_task
