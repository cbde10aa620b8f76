!> A recorded run of a slider-crank: rows by the formulas of its motion, forces by the balance of power, and the same numbers in all
!> files.
module test_recording
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_command_line, only: command_line_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation
  use mech9_error, only: error_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_force_record, only: reacting_pairs
  use mech9_hdf5_copying, only: extents_of
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: open_existing, read_text, has_data_set
  use mech9_kept_rows, only: kept_rows_type
  use mech9_model, only: model_type
  use mech9_data_file, only: data_file_type
  use mech9_plan, only: plan_type
  use mech9_recording, only: record
  use mech9_results, only: results_type
  use mech9_row_source, only: row_source_type, new_row_source
  use mech9_state, only: state_type
  use mech9_small_models, only: slider_crank, crank, rod, eol
  use mech9_text_models, only: document_from_text, model_from_text
  use mech9_test_files, only: remove_file, text_of_file
  use mech9_testing, only: tester_type
  use option_words, only: options_of
  implicit none
  private
  public :: run

  character(len=*), parameter :: stem = 'test_recording'
  integer, parameter :: n = 300   !< intervals, more than the rows that are written together

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('driven_run')) call driven_run(tester)
    if (tester%runs('wrong_quantity')) call wrong_quantity(tester)
  end subroutine run

  !> The crank turns at 3 rad/s against a force on the slide, without masses.
  subroutine driven_run(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: data = slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0.2, 3 /"//eol// &
      '&time end=2, intervals=300 /'//eol//"&load kind='coordinate', coordinate=4, force=-2 /"//eol// &
      '&output drive_forces=.true., reactions=.true., reaction_pairs=4 /'//eol
    type(data_file_type), target :: given
    type(command_line_type) :: options
    type(results_type) :: results
    type(kept_rows_type) :: kept
    type(error_type), allocatable :: err

    call document_from_text(tester, data, given%document)
    call model_from_text(tester, data, kinematics, given%model)
    call tester%is_true(all(reacting_pairs(given%model) .eqv. [.false., .false., .false., .true.]), &
                        'one pair has its forces recorded')
    allocate (given%run)
    call given%run%motion%assemble(given%model, err)
    call tester%no_error(err, 'the start')
    call given%run%prepare(given%model, err)
    call tester%no_error(err, 'the run is prepared')
    call options_of(tester, 'a.nml --table '//stem//'.dat --hdf5 '//stem//'.h5 --quiet', options)
    call results%open(options, given, err)
    call tester%no_error(err, 'files are opened')
    call record(given, results, .true., err, kept)
    call tester%no_error(err, 'the run is recorded')
    call results%close(err)
    call tester%no_error(err, 'files are closed')
    call tester%is_true(given%outcome%rows == n + 1, 'a row for each output')
    call given%close_run()
    call check_rows(tester, kept)
    call check_files(tester, data)
  end subroutine driven_run

  !> The place of the slider, its rate, and the torque that balances the power of the force.
  subroutine check_rows(tester, kept)
    type(tester_type), intent(inout) :: tester    !< counts the checks
    type(kept_rows_type), intent(in) :: kept      !< all rows
    real(wp), allocatable :: t(:), q(:), x(:), dx(:), torque(:)
    real(wp), parameter :: force = 2.0_wp
    real(wp), parameter :: tol = 1.0e-11_wp   ! chains are closed to round-off, and rates follow from their factors

    call column('t', t)
    call column('q4', x)
    call column('dq4', dx)
    call column('F1', torque)
    call tester%is_true(size(t) == n + 1 .and. size(torque) == n + 1, 'columns are found')
    if (size(torque) /= n + 1) return
    q = 0.2_wp + 3.0_wp*t
    call tester%near(maxval(abs(x - (crank*cos(q) + sqrt(rod**2 - (crank*sin(q))**2)))), 0.0_wp, tol, 'the place of the slider')
    call tester%near(maxval(abs(dx + 3.0_wp*crank*sin(q)*(1.0_wp + crank*cos(q)/sqrt(rod**2 - (crank*sin(q))**2)))), 0.0_wp, tol, &
                     'its rate')
    call tester%near(maxval(abs(3.0_wp*torque - force*dx)), 0.0_wp, tol, 'the powers of drive and load balance')
  contains
    !> The numbers of a column.
    subroutine column(name, numbers)
      character(len=*), intent(in) :: name                    !< its heading
      real(wp), allocatable, intent(out) :: numbers(:)        !< (rows)
      character(len=:), allocatable :: meant
      integer :: i

      allocate (numbers(0))
      call kept%column(name, i, meant)
      if (i > 0) numbers = kept%rows(i, :kept%count)
    end subroutine column
  end subroutine check_rows

  !> The table has a line for each row, and the HDF5 file the same number, with the data file beside them.
  subroutine check_files(tester, data)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: data         !< text of the data file
    type(hdf5_file_type) :: file
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer, allocatable :: extents(:)
    integer :: i

    call text_of_file(tester, stem//'.dat', text)
    text = eol//text
    call tester%is_true(count([(text(i:i) == eol .and. scan(adjustl(text(i + 1:min(i + 12, len(text)))), '-0123456789') == 1, &
                                i=1, len(text) - 1)]) == n + 1, 'lines of numbers in the table')
    call open_existing(stem//'.h5', .false., file, err)
    call tester%no_error(err, 'the HDF5 file')
    call extents_of(file, 'reaction_force', extents)
    call tester%is_true(all(extents == [3, 1, n + 1]), 'forces of one pair')
    call extents_of(file, 'drive_force', extents)
    call tester%is_true(all(extents == [1, n + 1]), 'forces of one drive')
    call tester%is_true(has_data_set(file, 'structure/nrg') .and. .not. allocated(file%failure), 'the structure')
    call read_text(file, 'provenance/data', text)
    call tester%is_true(text == data, 'the data file stands in it')
    call file%close()
    call remove_file(stem//'.dat')
    call remove_file(stem//'.h5')
  end subroutine check_files

  !> A quantity of a column that is not recorded is refused before the run.
  subroutine wrong_quantity(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type), target :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_simulation_type), allocatable, target :: simulation
    type(row_source_type), allocatable :: source
    type(error_type), allocatable :: err

    call model_from_text(tester, slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0.2, 3 /"//eol// &
      "&time end=2, intervals=3 /"//eol//"&quantity name='f', of='F1', take='max' /"//eol, kinematics, model)
    call assemble_model(model, plan, start, err)
    allocate (simulation, source)
    call new_driven_simulation(model, plan, start, simulation)
    call new_row_source(simulation, source)
    call source%begin_quantities(err)
    call tester%is_true(allocated(err), 'a column that is not there')
    if (allocated(err)) call tester%is_true(index(err%message, 'drive_forces=.true.') > 0, 'its remedy: '//err%message)
  end subroutine wrong_quantity
end module test_recording
