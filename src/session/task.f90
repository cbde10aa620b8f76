!> The interface of a program's work on a mechanism, and procedures that all tasks share.
module mech9_task
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_program_kind, only: kinematics
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type
  use mech9_kinds, only: wp
  use mech9_driven_motion, only: set_inputs
  use mech9_run, only: run_type
  use mech9_picture_requests, only: picture_requests_type
  use mech9_mobility_report, only: mobility_report_type, report_mobility
  use mech9_assemblies_text, only: print_assemblies
  use mech9_structure_graph, only: save_structure_graph
  use mech9_structure_text, only: print_mobility, print_mobility_report
  use mech9_start_path, only: start_way_type
  use mech9_check_text, only: print_given, print_start
  use mech9_plan_text, only: print_plan
  implicit none
  private
  public :: task_type, answers_only, print_check, check_motion

  type, abstract :: task_type
    integer :: program = kinematics   !< or dynamics
  contains
    procedure(work_interface), deferred :: work
  end type task_type

  abstract interface
    !> Carry out the options. Errors are added to `diagnostics`, which knows the places in the data file.
    subroutine work_interface(self, options, model, variable, diagnostics, reported, kept)
      import :: task_type, command_line_type, model_type, variable_model_type, diagnostics_type, kept_rows_type
      class(task_type), intent(in) :: self                    !< the task
      type(command_line_type), intent(in) :: options          !< the command line
      type(model_type), intent(in), target :: model           !< the model
      class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
      type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
      logical, intent(out) :: reported                        !< a report was asked for, and it is written: there was a run
      type(kept_rows_type), intent(inout), optional :: kept   !< the rows of a run, for who looks at them after it
    end subroutine work_interface
  end interface

contains

  !> Whether the options request an answer instead of a run.
  pure logical function answers_only(options)
    type(command_line_type), intent(in) :: options   !< the command line

    answers_only = options%has('check') .or. options%has('plan') .or. options%has('branches') &
                   .or. options%has('graph') .or. options%has('range') .or. options%has('cam')
  end function answers_only

  !> Carry out --check, --plan, --branches and --graph, and --sketch beside them.
  subroutine print_check(options, pictures, model, plan, requested, start, way, diagnostics)
    type(command_line_type), intent(in) :: options         !< the command line
    type(picture_requests_type), intent(in) :: pictures    !< the pictures of the mechanism that are requested
    type(model_type), intent(in) :: model              !< the model
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(requested_type), intent(in) :: requested          !< the requested part of the motion
    type(state_type), intent(in) :: start                  !< assembled position
    type(start_way_type), intent(in) :: way                !< how the start was reached from the drawn position
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    type(mobility_report_type) :: report
    type(error_type), allocatable :: err

    if (options%has('check')) then
      call report_mobility(model%mechanism, plan, start, report)
      call print_mobility_report(output_unit, model%mechanism, plan, report)
    else if (options%has('plan')) then
      call print_mobility(output_unit, model%mechanism, plan)
    end if
    if (options%has('plan')) call print_plan(output_unit, model%mechanism, plan, requested)
    if (options%has('branches')) call print_assemblies(output_unit, model%mechanism, plan, start, options%number('starts', 100))
    if (options%has('graph')) call draw_graph(options, model, plan, diagnostics)
    if (options%has('check')) then
      call print_given(output_unit, model, pictures%with_masses)
      call print_start(output_unit, model, plan, start, way)
    end if
    if (options%has('sketch')) call pictures%save_start(model, plan, start, err)
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine print_check

  !> Carry out --graph.
  subroutine draw_graph(options, model, plan, diagnostics)
    type(command_line_type), intent(in) :: options         !< the command line
    type(model_type), intent(in) :: model              !< the model
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    type(error_type), allocatable :: err
    character(len=:), allocatable :: said
    logical :: drawn

    call save_structure_graph(options%argument('graph'), model%mechanism, plan, drawn, said, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else if (.not. (drawn .and. options%has('quiet'))) then
      write (error_unit, '(a)') said
    end if
  end subroutine draw_graph

  !> Fail in a check where a run would fail. The motion cannot begin at the start, or drives have no values at the end
  !> of the time.
  subroutine check_motion(model, variable, run, err)
    type(model_type), intent(in), target :: model                   !< the model
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(run_type), intent(inout), target :: run                    !< with its motion assembled; its first row is computed
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed
    real(wp), allocatable :: row(:)

    call run%prepare(model, err, variable)
    if (.not. allocated(err)) call run%source%begin_section(err)
    if (allocated(err)) return
    allocate (row(run%source%columns%width()))
    call run%source%row_at(model%request%time%start, row, err)
    if (.not. allocated(err)) call check_drives(model, err)
  end subroutine check_motion

  !> Fail where a drive has no value at the end of the time.
  subroutine check_drives(model, err)
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated if one has none
    real(wp), dimension(size(model%mechanism%pairs)) :: q, dq, ddq

    call set_inputs(model%problem%drives, model%request%time%end, q, dq, ddq, err)
  end subroutine check_drives
end module mech9_task
