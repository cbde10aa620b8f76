!> Pages of text that grow, facts in reports, and files of rows in a list.
module test_pages_and_sinks
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_file
  use mech9_facts, only: facts_type
  use mech9_json, only: json_type
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type, kinematic_columns
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: open_existing, read_texts, has_data_set
  use mech9_hdf5_copying, only: extents_of
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_result_sink, only: result_sink_type, sink_slot_type, append_sink
  use mech9_text, only: string_type
  use mech9_page, only: page_type
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_test_files, only: remove_file, text_of_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_pages_and_sinks.h5'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('pages')) call pages(tester)
    if (tester%runs('facts')) call facts(tester)
    if (tester%runs('sinks')) call sinks(tester)
  end subroutine run

  subroutine pages(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(page_type) :: page
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: i

    call tester%is_true(page%is_empty() .and. page%text() == '', 'a page begins empty')
    call page%put('')
    call tester%is_true(page%is_empty(), 'no text is no beginning')
    do i = 1, 20000
      call page%line('12345678')
    end do
    call page%put(' end ')
    text = page%text()
    call tester%is_true(len(text) == 180005, 'a page grows')
    call tester%is_true(text(179992:) == '12345678'//eol//' end ', 'its end: '//text(179992:))
    call page%save(path, err)
    call text_of_file(tester, path, text)
    call tester%is_true(text == page%text(), 'a page is saved with all blanks')
    call remove_file(path)
    call page%save('there_is_no_such_folder/page', err)
    call tester%has_error(err, exit_file, 'a folder that is not there')
  end subroutine pages

  !> More facts than the first places, in their order.
  subroutine facts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(facts_type) :: list
    type(json_type) :: json
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: i

    do i = 1, 40
      call list%add('n'//achar(97 + mod(i, 26))//achar(97 + i/26), i, 'a count')
    end do
    call list%add('half', 0.5_wp, 'a number', 's')
    call list%add('name', 'a "b"', 'a text')
    call json%begin_object()
    call list%to_json(json)
    call json%end_object()
    call json%save(path, err)
    call tester%no_error(err, 'a report')
    call text_of_file(tester, path, text)
    call tester%is_true(index(text, '"nba": 1') > 0 .and. index(text, '"nba": 1') < index(text, '"nob": 40'), 'counts in order')
    call tester%is_true(index(text, '"half": 0.5') > 0 .and. index(text, '"name": "a \"b\""') > 0, 'a number and a text: '//text)
    call remove_file(path)
  end subroutine facts

  !> An HDF5 file that takes rows and events of a run.
  subroutine sinks(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(columns_type) :: columns
    type(hdf5_sink_type), allocatable :: file_sink
    class(result_sink_type), allocatable :: sink
    type(sink_slot_type), allocatable :: slots(:)
    type(hdf5_file_type) :: file
    type(error_type), allocatable :: err
    type(string_type), allocatable :: points(:)
    integer, allocatable :: extents(:)
    real(wp), allocatable :: rows(:, :)

    call model_from_text(tester, slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol// &
      "&time end=1, intervals=4 /"//eol//"&output derivatives=1, poses=.true. /"//eol, kinematics, model)
    columns = kinematic_columns(model%mechanism, model%request%output)
    allocate (file_sink, slots(0))
    call file_sink%open(path, model%mechanism, model%request, columns, err)
    call tester%no_error(err, 'a file for rows')
    call tester%is_true(file_sink%takes_poses .and. file_sink%words() == 'HDF5 file: '//path, 'its words')
    call file_sink%begin_changes(1)
    call file_sink%write_changes(reshape([0.5_wp, 2.0_wp, 1.0_wp], [3, 1]))
    call move_alloc(file_sink, sink)
    call append_sink(slots, sink)
    call tester%is_true(size(slots) == 1 .and. .not. allocated(sink), 'the sink is in the list')
    allocate (rows(columns%width(), 3), source=1.0_wp)
    call slots(1)%sink%write_rows(rows, err)
    call slots(1)%sink%write_rows(rows(:, :2), err)
    call slots(1)%sink%flush(err)
    call slots(1)%sink%close(err)
    call tester%no_error(err, 'rows are written')
    call open_existing(path, .false., file, err)
    call extents_of(file, 'q', extents)
    call tester%is_true(all(extents == [4, 5]), 'coordinates of five rows')
    call extents_of(file, 'velocity', extents)
    call tester%is_true(all(extents == [3, 1, 5]), 'velocities of one point')
    call extents_of(file, 'rotation', extents)
    call tester%is_true(all(extents == [3, 3, 4, 5]), 'rotations of four links')
    call extents_of(file, 'coordinate_changes/independent', extents)
    call tester%is_true(all(extents == [1, 1]), 'one event')
    call tester%is_true(.not. has_data_set(file, 'ddq'), 'what is not recorded is not there')
    call read_texts(file, 'point', points)
    if (size(points) == 1) call tester%is_true(points(1)%text == 'B', 'the name of the point')
    call tester%is_true(.not. allocated(file%failure), 'all of it is there')
    call file%close()
    call remove_file(path)
  end subroutine sinks
end module test_pages_and_sinks
