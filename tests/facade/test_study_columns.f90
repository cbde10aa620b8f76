!> Columns of the runs of a study in an HDF5 file: rows that are written are read back, others are NaN, and another file gets the
!> same data sets.
module test_study_columns
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_columns, only: kinematic_columns
  use mech9_error, only: error_type, exit_data
  use mech9_hdf5_copying, only: extents_of, attribute_of
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: open_existing, read_texts
  use mech9_column_sets, only: new_column_set
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_data_file, only: data_file_type
  use mech9_study_columns, only: study_columns_type, refuse_varied_times
  use mech9_study_filling, only: fill_rows
  use mech9_text, only: string_type
  use mech9_checks, only: has_message
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_test_files, only: remove_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_study_columns.h5', second = 'test_study_columns_2.h5'
  character(len=*), parameter :: data = slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol// &
    '&time end=1, intervals=2 /'//eol//'&output derivatives=0 /'//eol
  integer, parameter :: runs = 4

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('there_and_back')) call there_and_back(tester)
    if (tester%runs('filling')) call filling(tester)
    if (tester%runs('varied_times')) call varied_times(tester)
  end subroutine run

  !> Make a file with the columns of four runs, of which the third one is written.
  subroutine write_file(tester, numbers)
    type(tester_type), intent(inout) :: tester                 !< counts the checks
    real(wp), allocatable, intent(out) :: numbers(:)           !< of the third run
    type(data_file_type) :: given
    type(study_columns_type) :: runs_columns
    type(hdf5_file_type) :: file
    type(error_type), allocatable :: err
    integer :: i

    call model_from_text(tester, data, kinematics, given%model)
    given%run_columns = kinematic_columns(given%model%mechanism, given%model%request%output)
    call file%create(path, err)
    call tester%no_error(err, 'a file')
    call file%put('run', [(i, i=1, runs)], 'number of the run')
    call file%make_scale('run')
    call runs_columns%create(file, given, runs)
    call tester%is_true(runs_columns%are_there() .and. runs_columns%numbers_of_run() == 3*given%run_columns%width(), &
                        'three times of a run')
    numbers = [(0.5_wp*i, i=1, runs_columns%numbers_of_run())]
    call file%flush()
    call runs_columns%write_run(file, 3, numbers)
    call runs_columns%close(file)
    call file%close()
    call tester%is_true(.not. allocated(file%failure), 'columns are written')
  end subroutine write_file

  subroutine there_and_back(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_columns_type) :: found, copied
    type(hdf5_file_type) :: file, other
    type(string_type), allocatable :: names(:)
    type(error_type), allocatable :: err
    real(wp), allocatable :: numbers(:), back(:, :)
    integer, allocatable :: extents(:)
    integer :: i, times(3)

    call write_file(tester, numbers)
    call open_existing(path, .false., file, err)
    call tester%no_error(err, 'the file is opened')
    call read_texts(file, 'study/columns', names)
    call extents_of(file, 'q', extents)
    call tester%is_true(all(extents == [4, 3, runs]), 'coordinates over runs and time')
    call tester%is_true(attribute_of(file, 'position', 'units') == 'm', 'points have their unit')
    call found%open_unknown(file, names, runs)
    ! the first column of each time is time itself, which has a scale of its own
    allocate (back(found%numbers_of_run(), 1))
    call tester%is_true(size(back) == size(numbers) - 3, 'all numbers but the times')
    call found%read_run(file, 3, back)
    call tester%is_true(all([(any(abs(back(:, 1) - numbers(i)) <= 0.0_wp), i=2, size(numbers)/3)]), 'the numbers of the first time')
    times = [1, 1 + size(numbers)/3, 1 + 2*size(numbers)/3]
    call tester%near(sum(back), sum(numbers) - sum(numbers(times)), 1.0e-14_wp, 'all numbers of the run')
    call found%read_run(file, 2, back)
    call tester%is_true(all(ieee_is_nan(back)), 'a run that is not made')
    call other%create(second, err)
    call other%put('run', [1, 2], 'number of the run')
    call other%make_scale('run')
    call copied%create_like(other, names, file, 2)
    call other%flush()
    call copied%close(other)
    call tester%is_true(.not. allocated(other%failure), 'another file has the same data sets')
    call extents_of(other, 'q', extents)
    call tester%is_true(all(extents == [4, 3, 2]), 'for its own runs')
    call found%close(file)
    call file%close()
    call other%close()
    call remove_file(path)
    call remove_file(second)
  end subroutine there_and_back

  !> All places are filled, the last column with a number.
  subroutine filling(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 100000
    type(hdf5_file_type) :: file
    type(hdf5_series_type) :: series, again
    type(error_type), allocatable :: err
    real(wp) :: rows(2, 3)

    call file%create(path, err)
    call series%start_fixed(2, 2, n, .false.)
    call series%add(new_column_set('a', [1], [integer ::], 'first', '1', [character(len=1) ::]))
    call series%add(new_column_set('b', [2], [integer ::], 'second', '1', [character(len=1) ::]))
    call series%create(file)
    call fill_rows(series, file, 2, n, -1)
    call file%flush()
    call series%close(file)
    call file%close()
    call tester%is_true(.not. allocated(file%failure), 'rows are filled')
    call open_existing(path, .false., file, err)
    call again%start_fixed(2, 2, n, .true.)
    call again%add(new_column_set('a', [1], [integer ::], 'first', '1', [character(len=1) ::]))
    call again%add(new_column_set('b', [2], [integer ::], 'second', '1', [character(len=1) ::]))
    call again%open(file)
    call again%read_rows(file, n - 2, rows)
    call tester%is_true(all(ieee_is_nan(rows(1, :))) .and. all(abs(rows(2, :) + 1.0_wp) <= 0.0_wp), 'the last rows')
    call again%read_rows(file, 1, rows)
    call tester%is_true(all(ieee_is_nan(rows(1, :))) .and. all(abs(rows(2, :) + 1.0_wp) <= 0.0_wp), 'the first rows')
    call again%close(file)
    call file%close()
    call remove_file(path)
  end subroutine filling

  !> Runs with other times have no common columns.
  subroutine varied_times(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(data_file_type) :: given
    type(error_type), allocatable :: err

    call model_from_text(tester, data//"&parameter name='a', sets='pair(2).point(1)' /"//eol, kinematics, given%model)
    call refuse_varied_times(given, err)
    call tester%no_error(err, 'a length may vary')
    call model_from_text(tester, data//"&parameter name='e', sets='time.end' /"//eol, kinematics, given%model)
    call refuse_varied_times(given, err)
    call has_message(tester, err, exit_data, "parameter 'e' sets time.end, and hdf5_runs=.true.", 'a time may not')
  end subroutine varied_times
end module test_study_columns
