!> The files of a study: a table with a row for each run.
module mech9_study_results
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_version, only: version
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type
  use mech9_table, only: table_type
  use mech9_written_files, only: result_paths_type, standard_output_path
  use mech9_quantity_record, only: quantity_record_type
  use mech9_run_maker, only: made_run_type
  implicit none
  private
  public :: study_results_type

  type :: study_results_type
    type(result_paths_type) :: paths                !< of the files; empty where there is none
    type(table_type), private :: table
    real(wp), allocatable, private :: row(:)        !< of the table
  contains
    procedure :: open => open_results
    procedure :: write_run
    procedure :: close => close_results
    procedure :: print_paths
  end type study_results_type

contains

  !> Open the files that are asked for. After an error none is open.
  subroutine open_results(self, program_name, model, quantities, paths, err)
    class(study_results_type), intent(out) :: self            !< the files
    character(len=*), intent(in) :: program_name              !< mech9k or mech9d
    type(model_type), intent(in) :: model                     !< the model with the values of the data file
    type(quantity_record_type), intent(in) :: quantities      !< with their columns
    type(result_paths_type), intent(in) :: paths              !< of the files
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(columns_type) :: columns

    self%paths = paths
    columns = columns_of_study(model, quantities)
    allocate (self%row(columns%count), source=0.0_wp)
    if (paths%table /= '') call self%table%open(paths%table, model%mechanism%title, program_name//' '//version, &
                                                columns%names(:columns%count), columns%units(:columns%count), err)
  end subroutine open_results

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

  !> Write a run. Runs come in the order of their numbers.
  subroutine write_run(self, run, err)
    class(study_results_type), intent(inout) :: self       !< the files
    type(made_run_type), intent(in) :: run                 !< the run
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    integer :: n

    if (self%paths%table == '') return
    n = 1 + size(run%values)
    self%row(1) = run%number
    self%row(2:n) = run%values
    self%row(n + 1:n + size(run%quantities)) = run%quantities
    self%row(size(self%row)) = run%exit_code
    call self%table%write_row(self%row, err)
  end subroutine write_run

  !> Close the files.
  subroutine close_results(self, err)
    class(study_results_type), intent(inout) :: self     !< the files
    type(error_type), allocatable, intent(out) :: err    !< allocated if rows could not be written

    if (self%paths%table /= '') call self%table%close(err)
  end subroutine close_results

  !> Print where the results are.
  subroutine print_paths(self, unit)
    class(study_results_type), intent(in) :: self   !< the files
    integer, intent(in) :: unit                     !< Fortran unit to write to

    if (self%paths%table /= '' .and. self%paths%table /= standard_output_path) write (unit, '(2a)') 'table: ', self%paths%table
  end subroutine print_paths
end module mech9_study_results
