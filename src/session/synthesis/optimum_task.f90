!> The search for the best design: from many starts to a table of distinct designs, and the data file of the best one.
module mech9_optimum_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_data, exit_assembly, exit_interrupted
  use mech9_failure, only: failure_interrupted
  use mech9_clock, only: seconds
  use mech9_version, only: version
  use mech9_command_line, only: command_line_type
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_objective, only: pose_objective, quantity_objective
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_explained_assembly, only: assemble_driven_start
  use mech9_explanation, only: explain
  use mech9_columns, only: columns_type
  use mech9_table, only: table_type
  use mech9_text_file, only: replace_text
  use mech9_written_files, only: result_paths_type, find_result_paths, standard_output_path
  use mech9_progress, only: progress_type
  use mech9_user_calls, only: calls_user_procedures
  use mech9_study_threads, only: threads_of_machine
  use mech9_start_threads, only: make_in_threads
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_design_file, only: text_of_design
  use mech9_optimum_words, only: print_optimum, history_of_design, save_optimum_report
  implicit none
  private
  public :: work_on_optimum

  integer, parameter :: most_threads = 1024   !< the system may refuse more

contains

  !> Carry out the search that a data file describes.
  subroutine work_on_optimum(program_name, options, document, variable, model, diagnostics, reported)
    character(len=*), intent(in) :: program_name                    !< mech9k
    type(command_line_type), intent(in) :: options                  !< the command line
    type(document_type), intent(in) :: document                     !< the data file
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                           !< the model with the values of the data file
    type(diagnostics_type), intent(inout) :: diagnostics            !< gets the errors
    logical, intent(out) :: reported                                !< a report was asked for, and it is written
    type(synthesis_type), allocatable, target :: synthesis
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err
    real(wp) :: clock

    reported = .false.
    allocate (synthesis)
    clock = seconds()
    call check_request(options, model, err)
    if (.not. allocated(err)) call assemble_driven_start(model, plan, start, err)
    if (.not. allocated(err)) call new_synthesis(variable, model, plan, synthesis, err)
    if (allocated(err)) then
      call explain(err)
      call diagnostics%add_error(err)
      return
    end if
    call make_starts(program_name, options, variable, model, synthesis, err)
    call synthesis%keep_verified()
    if (.not. options%has('quiet')) call print_optimum(error_unit, model, synthesis, seconds() - clock)
    if (size(synthesis%optima) == 0 .and. .not. allocated(err)) &
      call raise(err, exit_assembly, 'no start led to a design that can be assembled and that moves through the whole run; '// &
                 'give more starts in &optimum, or other ranges of the parameters')
    if (allocated(err)) call diagnostics%add_error(err)
    call write_results(program_name, options, document, model, synthesis, diagnostics)
    if (.not. options%has('report')) return
    call save_optimum_report(options%argument('report'), program_name, model, synthesis, table_of(options, model), diagnostics, err)
    reported = .true.
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine work_on_optimum

  !> Report a search that cannot be made.
  subroutine check_request(options, model, err)
    type(command_line_type), intent(in) :: options        !< the command line
    type(model_type), intent(in) :: model                 !< the model with the values of the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it cannot

    if (size(model%request%objectives) == 0) then
      call raise(err, exit_usage, '--optimize meets the groups &objective as well as possible, and this file has none')
    else if (any(model%request%objectives%kind == pose_objective .or. model%request%objectives%kind == quantity_objective) .or. &
             size(model%request%limits) > 0) then
      call raise(err, exit_usage, 'this version searches for paths and functions without limits only')
    else if (.not. any(model%parameters%has_range)) then
      call raise(err, exit_data, 'no parameter is varied: give ''low'' and ''high'' in at least one &parameter', &
                 model%request%objectives(1)%place)
    else if (.not. abs(model%request%time%end - model%request%time%start) > 0.0_wp) then
      call raise(err, exit_data, 'the run has no length, so that no motion can meet the objective; change &time', &
                 model%request%objectives(1)%place)
    else if (options%has('out') .and. options%has('set')) then
      call raise(err, exit_usage, '--out writes the data file with the best values, and would not have the changes by --set; '// &
                 'write them into the data file, or leave --out out')
    end if
  end subroutine check_request

  !> Make all starts. Fails where the user interrupts; the starts so far then count.
  subroutine make_starts(program_name, options, variable, model, synthesis, err)
    character(len=*), intent(in) :: program_name             !< mech9k
    type(command_line_type), intent(in) :: options           !< the command line
    class(variable_model_type), intent(in) :: variable       !< the model as a function of its parameters
    type(model_type), intent(in) :: model                    !< the model
    type(synthesis_type), intent(inout) :: synthesis         !< gets the optima
    type(error_type), allocatable, intent(out) :: err        !< allocated if the user interrupts
    type(progress_type) :: progress
    integer :: threads

    threads = threads_of_machine()
    ! a user's procedures may keep numbers from call to call
    if (calls_user_procedures(model)) threads = 1
    threads = min(options%number('threads', threads), most_threads)
    call progress%start(program_name, options%has('quiet'))
    call make_in_threads(variable, synthesis, model%request%optimum%seed, model%request%optimum%starts, threads, progress)
    call progress%finish()
    if (synthesis%done == model%request%optimum%starts) return
    call raise(err, exit_interrupted, failure_interrupted)
    call explain(err)
  end subroutine make_starts

  !> The path of the table; '-' is standard output; empty: no table.
  function table_of(options, model) result(path)
    type(command_line_type), intent(in) :: options   !< the command line
    type(model_type), intent(in) :: model            !< the model
    character(len=:), allocatable :: path
    type(result_paths_type) :: paths

    call find_result_paths(options, model%request%output, paths)
    path = paths%table
    if (path == '' .and. .not. options%has('no-write')) path = standard_output_path
  end function table_of

  !> Write the table of the distinct designs, and the data file of the best one.
  subroutine write_results(program_name, options, document, model, synthesis, diagnostics)
    character(len=*), intent(in) :: program_name            !< mech9k
    type(command_line_type), intent(in) :: options          !< the command line
    type(document_type), intent(in) :: document             !< the data file
    type(model_type), intent(in) :: model                   !< the model
    type(synthesis_type), intent(in) :: synthesis           !< with its optima, best first
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    character(len=:), allocatable :: path, history, text
    real(wp) :: values(size(model%parameters))
    type(error_type), allocatable :: err

    path = table_of(options, model)
    if (path /= '') call write_table(path, program_name, model, synthesis, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else if (path /= '' .and. path /= standard_output_path .and. .not. options%has('quiet')) then
      write (error_unit, '(2a)') 'table: ', path
    end if
    if (.not. options%has('out') .or. size(synthesis%optima) == 0) return
    call history_of_design(program_name//' '//version, model, synthesis, history)
    values = synthesis%space%values
    values(synthesis%space%varied) = synthesis%optima(1)%x
    call text_of_design(document, model, values, synthesis%optima(1)%q, history, text)
    call replace_text(options%argument('out'), text, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else if (.not. options%has('quiet')) then
      write (error_unit, '(2a)') 'best design: ', options%argument('out')
    end if
  end subroutine write_results

  !> Write a row for each distinct design, best first.
  subroutine write_table(path, program_name, model, synthesis, err)
    character(len=*), intent(in) :: path                    !< of the table; '-' is standard output
    character(len=*), intent(in) :: program_name            !< mech9k
    type(model_type), intent(in) :: model                   !< the model
    type(synthesis_type), intent(in) :: synthesis           !< with its optima, best first
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close
    type(columns_type) :: columns
    type(table_type) :: table
    real(wp) :: row(size(model%parameters) + 2)
    integer :: i, n

    n = size(model%parameters)
    allocate (columns%names(0), columns%units(0), columns%long_names(0))
    call columns%append('value', '')
    do i = 1, n
      call columns%append(model%parameters(i)%name, '')
    end do
    call columns%append('starts', '')
    call table%open(path, model%mechanism%title, program_name//' '//version, columns%names(:columns%count), &
                    columns%units(:columns%count), err)
    if (allocated(err)) return
    do i = 1, size(synthesis%optima)
      row(1) = synthesis%optima(i)%value
      row(2:n + 1) = synthesis%space%values
      row(1 + synthesis%space%varied) = synthesis%optima(i)%x
      row(n + 2) = synthesis%optima(i)%starts
      call table%write_row(row, err)
      if (allocated(err)) exit
    end do
    call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine write_table
end module mech9_optimum_task
