!> The runs of a study, one for each set of parameter values, each with a row of a table.
module mech9_study_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_interrupted
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_clock, only: seconds
  use mech9_version, only: version
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_study_values, only: values_of_run
  use mech9_columns, only: columns_type
  use mech9_table, only: table_type
  use mech9_row_source, only: row_source_type
  use mech9_written_files, only: result_paths_type, find_result_paths, standard_output_path
  use mech9_progress, only: progress_type
  use mech9_run_words, only: duration
  use mech9_design_run, only: run_design
  use mech9_study_sums, only: study_sums_type
  implicit none
  private
  public :: work_on_study

contains

  !> Carry out the study that a data file describes.
  subroutine work_on_study(program_name, options, varied, model, diagnostics)
    character(len=*), intent(in) :: program_name            !< mech9k or mech9d
    type(command_line_type), intent(in) :: options          !< the command line
    class(variable_model_type), intent(inout) :: varied     !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets what is wrong
    type(result_paths_type) :: paths
    type(columns_type) :: columns
    type(table_type) :: table
    type(study_sums_type) :: sums
    type(error_type), allocatable :: err, at_close
    real(wp) :: clock

    if (model%request%study%kind == '') then
      call raise(err, exit_usage, '--study carries out the study of a group &study, and this file has none')
      call diagnostics%add_error(err)
      return
    end if
    call find_result_paths(options, model%request%output, paths)
    if (paths%table == '' .and. .not. options%has('no-write')) paths%table = standard_output_path
    if (model%request%output%hdf5 /= '' .and. .not. options%has('quiet')) &
      write (error_unit, '(a)') 'note: a study writes no HDF5 file; its results are in the table'
    columns = columns_of_study(model)
    if (paths%table /= '') call table%open(paths%table, model%mechanism%title, program_name//' '//version, &
                                           columns%names(:columns%count), columns%units(:columns%count), err)
    clock = seconds()
    if (.not. allocated(err)) call make_runs(program_name, options%has('quiet'), options%part(), varied, model, table, &
                                            paths%table /= '', sums, err)
    if (paths%table /= '') call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
    if (allocated(err)) call diagnostics%add_error(err)
    if (options%has('quiet')) return
    call print_summary(error_unit, model, sums, seconds() - clock)
    if (paths%table /= '' .and. paths%table /= standard_output_path) write (error_unit, '(2a)') 'table: ', paths%table
  end subroutine work_on_study

  !> The columns of the table of a study.
  pure function columns_of_study(model) result(columns)
    type(model_type), intent(in) :: model   !< the model
    type(columns_type) :: columns
    integer :: i

    allocate (columns%names(0), columns%units(0), columns%long_names(0))
    call columns%append('run', '')
    do i = 1, size(model%parameters)
      call columns%append(model%parameters(i)%name, '')
    end do
    do i = 1, size(model%request%quantities)
      call columns%append(model%request%quantities(i)%name, '')
    end do
    call columns%append('exit_code', '')
  end function columns_of_study

  !> Make the runs of a part and write their rows. A run that fails is a row with its code and without quantities (NaN).
  subroutine make_runs(program_name, quiet, part, varied, model, table, has_table, sums, err)
    character(len=*), intent(in) :: program_name            !< mech9k or mech9d
    logical, intent(in) :: quiet                            !< no progress is shown
    integer, intent(in) :: part(2)                          !< number of the part that is made, and how many parts there are
    class(variable_model_type), intent(inout) :: varied     !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(table_type), intent(inout) :: table                !< open, if there is one
    logical, intent(in) :: has_table                        !< there is a table
    type(study_sums_type), intent(inout) :: sums            !< gets the sums over the runs
    type(error_type), allocatable, intent(out) :: err       !< allocated where rows cannot be written, or the user interrupts
    type(progress_type) :: progress
    type(error_type), allocatable :: failure
    real(wp), allocatable :: row(:)
    integer :: run, n

    n = size(model%parameters)
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
      else
        call sums%add(row(n + 2:size(row) - 1))
      end if
      if (has_table) call table%write_row(row, err)
      if (allocated(err)) exit
      call progress%update(real(run, wp)/model%request%study%runs)
    end do
    call progress%finish()
  end subroutine make_runs

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

  !> Print how the study went: failed runs by code, and for runs that were drawn the means and deviations of the quantities.
  subroutine print_summary(unit, model, sums, time)
    integer, intent(in) :: unit                   !< Fortran unit to write to
    type(model_type), intent(in) :: model         !< the model
    type(study_sums_type), intent(in) :: sums     !< over the runs
    real(wp), intent(in) :: time                  !< time that the study took [s]
    real(wp), dimension(size(model%request%quantities)) :: deviation, of_mean, of_deviation
    integer :: i
    logical :: drawn

    if (.not. allocated(sums%mean)) return
    write (unit, '(a)') counted(sums%done + sum(sums%failed), 'run')//': '//duration(time)
    do i = 1, sums%n_codes
      write (unit, '(a)') counted(sums%failed(i), 'run')//' failed with exit code '//to_text(sums%codes(i))// &
        ', the first one is run '//to_text(sums%first_failed(i))
    end do
    drawn = all(model%request%study%kind /= ['grid', 'list'])
    deviation = sums%deviation()
    of_mean = sums%error_of_mean()
    of_deviation = sums%error_of_deviation()
    do i = 1, size(deviation)
      if (sums%done == 0) exit
      associate (name => model%request%quantities(i)%name)
        if (drawn) write (unit, '(a)') name//': mean '//to_text(sums%mean(i), 8)//' (standard error '//to_text(of_mean(i), 2)// &
          '), deviation '//to_text(deviation(i), 6)//' (standard error '//to_text(of_deviation(i), 2)//')'
        write (unit, '(a)') name//': '//to_text(sums%low(i), 8)//' to '//to_text(sums%high(i), 8)
      end associate
    end do
  end subroutine print_summary
end module mech9_study_task
