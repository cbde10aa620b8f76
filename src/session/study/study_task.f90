!> The runs of a study, one for each set of parameter values, each with a row of a table.
module mech9_study_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_usage, exit_data, exit_interrupted
  use mech9_text, only: to_text
  use mech9_clock, only: seconds
  use mech9_version, only: version
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_explanation, only: explain
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_study_values, only: values_of_run
  use mech9_columns, only: columns_type
  use mech9_table, only: table_type
  use mech9_row_source, only: row_source_type
  use mech9_written_files, only: result_paths_type, find_result_paths, standard_output_path
  use mech9_progress, only: progress_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_design_run, only: run_design, find_quantities
  use mech9_study_sums, only: study_sums_type
  use mech9_study_words, only: print_study, save_study_report
  implicit none
  private
  public :: work_on_study

contains

  !> Carry out the study that a data file describes.
  subroutine work_on_study(program_name, options, varied, model, diagnostics, reported)
    character(len=*), intent(in) :: program_name            !< mech9k or mech9d
    type(command_line_type), intent(in) :: options          !< the command line
    class(variable_model_type), intent(inout) :: varied     !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< a report was asked for, and it is written
    type(result_paths_type) :: paths
    type(quantity_record_type) :: quantities
    type(columns_type) :: columns
    type(table_type) :: table
    type(error_type), allocatable :: err

    reported = .false.
    call check_study(program_name, model, quantities, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
      return
    end if
    call find_result_paths(options, model%request%output, paths)
    if (paths%table == '' .and. .not. options%has('no-write')) paths%table = standard_output_path
    if (.not. options%has('quiet')) call print_notes(model, options%part())
    columns = columns_of_study(model, quantities)
    if (paths%table /= '') call table%open(paths%table, model%mechanism%title, program_name//' '//version, &
                                           columns%names(:columns%count), columns%units(:columns%count), err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
      return
    end if
    call carry_out(program_name, options, varied, model, quantities, table, paths%table, diagnostics, reported)
  end subroutine work_on_study

  !> Report a study that cannot be carried out, and find the columns of its quantities.
  subroutine check_study(program_name, model, quantities, err)
    character(len=*), intent(in) :: program_name            !< mech9k or mech9d
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(quantity_record_type), intent(out) :: quantities   !< with their columns
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed

    if (model%request%study%kind == '') then
      call raise(err, exit_usage, '--study carries out the study of a group &study, and this file has none')
    else if (model%request%output%sensitivities) then
      call raise(err, exit_data, 'a study records no sensitivities: leave out sensitivities in &output', &
                 model%request%output%sensitivities_place)
    else
      call find_quantities(program_name, model, quantities, err)
    end if
  end subroutine check_study

  !> Tell what the user may have expected of the study, and does not get.
  subroutine print_notes(model, part)
    type(model_type), intent(in) :: model   !< the model
    integer, intent(in) :: part(2)          !< number of the part that is made, and how many parts there are

    if (model%request%output%hdf5 /= '') &
      write (error_unit, '(a)') 'note: a study writes no HDF5 file; its results are in the table'
    if (part(1) > model%request%study%runs) &
      write (error_unit, '(a)') 'note: this part has no runs: the study has '//to_text(model%request%study%runs)
  end subroutine print_notes

  !> The columns of the table of a study.
  function columns_of_study(model, quantities) result(columns)
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(columns_type) :: columns
    integer :: i

    allocate (columns%names(0), columns%units(0), columns%long_names(0))
    call columns%append('run', '')
    do i = 1, size(model%parameters)
      call columns%append(model%parameters(i)%name, '')
    end do
    do i = 1, size(model%request%quantities)
      call columns%append(model%request%quantities(i)%name, quantities%unit_of(i))
    end do
    call columns%append('exit_code', '')
  end function columns_of_study

  !> Make the runs, close the table, and tell how the study went. Where every run failed, the first failure is that of the study.
  subroutine carry_out(program_name, options, varied, model, quantities, table, path, diagnostics, reported)
    character(len=*), intent(in) :: program_name            !< mech9k or mech9d
    type(command_line_type), intent(in) :: options          !< the command line
    class(variable_model_type), intent(inout) :: varied     !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(quantity_record_type), intent(in) :: quantities    !< with their columns
    type(table_type), intent(inout) :: table                !< open, if there is one; closed on return
    character(len=*), intent(in) :: path                    !< of the table; '-' is standard output; empty: no table
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(inout) :: reported                      !< the report is written
    type(study_sums_type) :: values, sums
    type(error_type), allocatable :: err, first, at_close
    real(wp) :: clock
    logical :: quiet, written

    quiet = options%has('quiet')
    clock = seconds()
    call make_runs(program_name, quiet, options%part(), varied, model, table, path /= '', values, sums, first, err)
    if (path /= '') call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
    if (.not. quiet) call print_study(error_unit, model, quantities, sums, seconds() - clock)
    written = path /= '' .and. path /= standard_output_path
    if (allocated(err)) written = written .and. err%code == exit_interrupted
    if (written .and. .not. quiet) write (error_unit, '(2a)') 'table: ', path
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else if (allocated(first) .and. sums%done == 0) then
      call diagnostics%add_error(first)
    else if (allocated(first) .and. .not. quiet) then
      call print_failure(first, diagnostics)
    end if
    if (.not. options%has('report')) return
    call save_study_report(options%argument('report'), program_name, model, quantities, values, sums, path, diagnostics, err)
    reported = .true.
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine carry_out

  !> Print the message of a failed run, with its place in the data file.
  subroutine print_failure(failure, diagnostics)
    type(error_type), intent(in) :: failure               !< of the run
    type(diagnostics_type), intent(in) :: diagnostics     !< of the program, which knows the data file
    type(diagnostics_type) :: own

    own%sources = diagnostics%sources
    call own%add_error(failure)
    call own%report(error_unit)
  end subroutine print_failure

  !> Make the runs of a part and write their rows. A run that fails is a row with its code and without quantities (NaN).
  subroutine make_runs(program_name, quiet, part, varied, model, table, has_table, values, sums, first, err)
    character(len=*), intent(in) :: program_name               !< mech9k or mech9d
    logical, intent(in) :: quiet                               !< no progress is shown
    integer, intent(in) :: part(2)                             !< number of the part that is made, and how many parts there are
    class(variable_model_type), intent(inout) :: varied        !< the model as a function of its parameters
    type(model_type), intent(in) :: model                      !< the model with the values of the data file
    type(table_type), intent(inout) :: table                   !< open, if there is one
    logical, intent(in) :: has_table                           !< there is a table
    type(study_sums_type), intent(inout) :: values             !< gets the sums of the parameters over all runs
    type(study_sums_type), intent(inout) :: sums               !< gets the sums of the quantities over the runs
    type(error_type), allocatable, intent(out) :: first        !< error of the first run that failed, with the number of the run
    type(error_type), allocatable, intent(out) :: err          !< allocated where rows cannot be written, or the user interrupts
    type(progress_type) :: progress
    type(error_type), allocatable :: failure
    real(wp), allocatable :: row(:)
    integer :: run, n

    n = size(model%parameters)
    call values%begin(n)
    call sums%begin(size(model%request%quantities))
    allocate (row(n + size(model%request%quantities) + 2))
    call progress%start(program_name, quiet)
    ! runs go round the parts, so that each has its share of long ones
    do run = part(1), model%request%study%runs, part(2)
      row(1) = run
      call values_of_run(model%request%study, model%parameters, run, row(2:n + 1))
      call make_run(program_name, varied, row(2:n + 1), row(n + 2:size(row) - 1), failure)
      row(size(row)) = 0.0_wp
      if (allocated(failure)) then
        if (failure%code == exit_interrupted) then
          call move_alloc(failure, err)
          exit
        end if
        row(size(row)) = failure%code
        call sums%add_failure(run, failure%code)
        if (.not. allocated(first)) call keep_first(run, failure, first)
      else
        call sums%add(row(n + 2:size(row) - 1))
      end if
      call values%add(row(2:n + 1))
      if (has_table) call table%write_row(row, err)
      if (allocated(err)) exit
      call progress%update(real(run, wp)/model%request%study%runs)
    end do
    call progress%finish()
  end subroutine make_runs

  !> Keep the failure of the first run that failed, with the number of the run in its message.
  subroutine keep_first(run, failure, first)
    integer, intent(in) :: run                                   !< its number
    type(error_type), allocatable, intent(inout) :: failure      !< of the run; moved
    type(error_type), allocatable, intent(out) :: first          !< gets this error

    call move_alloc(failure, first)
    call explain(first)
    call add_place(first, 'run '//to_text(run))
  end subroutine keep_first

  !> Make one run.
  subroutine make_run(program_name, varied, values, numbers, err)
    character(len=*), intent(in) :: program_name            !< mech9k or mech9d
    class(variable_model_type), intent(inout) :: varied     !< the model as a function of its parameters
    real(wp), intent(in) :: values(:)                       !< of the parameters, in the units of the file
    real(wp), intent(out) :: numbers(:)                     !< the quantities; NaN where the run failed
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(model_type), target :: model
    type(row_source_type) :: source

    call varied%at(values, model, err)
    if (.not. allocated(err)) call run_design(program_name, model, source, numbers, err)
    if (allocated(err)) numbers = ieee_value(1.0_wp, ieee_quiet_nan)
  end subroutine make_run
end module mech9_study_task
