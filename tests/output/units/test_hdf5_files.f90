!> HDF5 files: texts, numbers and series that are written are read back by the library itself; files appear as a whole.
module test_hdf5_files
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_file
  use mech9_text, only: string_type
  use mech9_facts, only: facts_type
  use mech9_fact_layout, only: put_facts
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: open_existing, read_text, read_texts, read_integer, has_data_set
  use mech9_column_sets, only: new_column_set
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_hdf5_copying, only: copy_data_sets, extents_of, scales_of, attribute_of
  use mech9_scale_layout, only: find_common_unit
  use mech9_checks, only: near_matrix, has_message
  use mech9_test_files, only: save_lines, remove_file, text_of_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_hdf5_files.h5', second = 'test_hdf5_files_2.h5'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('values')) call values(tester)
    if (tester%runs('appearance')) call appearance(tester)
    if (tester%runs('rows')) call rows(tester)
    if (tester%runs('rows_out_of_order')) call rows_out_of_order(tester)
    if (tester%runs('copies')) call copies(tester)
    if (tester%runs('failures')) call failures(tester)
    if (tester%runs('units')) call units(tester)
  end subroutine run

  subroutine values(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(hdf5_file_type) :: file
    type(facts_type) :: facts
    type(error_type), allocatable :: err
    type(string_type) :: names(3)
    type(string_type), allocatable :: texts(:)
    character(len=:), allocatable :: text
    integer, allocatable :: extents(:)
    integer :: number

    names(1)%text = 'one'
    names(2)%text = ''
    names(3)%text = 'ends with blanks  '
    call facts%add('steps', 12, 'how many')
    call facts%add('method', 'bdf', 'which')
    call file%create(path, err)
    call tester%no_error(err, 'a file')
    call file%put('a/b/text', 'in a group of a group', 'a text')
    call file%put('texts', names, 'some texts')
    call file%put('matrix', reshape([1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, 6.0_wp], [3, 2]), 'a matrix', 'm')
    call put_facts(facts, file, 'run', .false.)
    call file%flush()
    call file%close()
    call tester%is_true(.not. allocated(file%failure), 'all of it is written')
    call open_existing(path, .false., file, err)
    call tester%no_error(err, 'the file is read')
    call read_text(file, 'a/b/text', text)
    call tester%is_true(text == 'in a group of a group', 'a text: '//text)
    call read_texts(file, 'texts', texts)
    call tester%is_true(size(texts) == 3, 'three texts')
    if (size(texts) == 3) call tester%is_true(texts(1)%text == 'one' .and. len(texts(2)%text) == 0 .and. &
                                              len(texts(3)%text) == len(names(3)%text), 'an empty one, and blanks at an end')
    call extents_of(file, 'matrix', extents)
    call tester%is_true(all(extents == [3, 2]), 'extents in Fortran order')
    call tester%is_true(attribute_of(file, 'matrix', 'units') == 'm', 'an attribute')
    call tester%is_true(attribute_of(file, 'matrix', 'long_name') == 'a matrix', 'another attribute')
    call tester%is_true(attribute_of(file, 'matrix', 'other') == '', 'an attribute that is not there')
    call read_integer(file, 'run/steps', number)
    call read_text(file, 'run/method', text)
    call tester%is_true(number == 12 .and. text == 'bdf', 'facts')
    call tester%is_true(has_data_set(file, 'run'), 'there is a data set')
    call tester%is_true(.not. has_data_set(file, 'run/none'), 'there is no data set')
    call tester%is_true(.not. allocated(file%failure), 'all of it is read')
    call file%close()
    call remove_file(path)
  end subroutine values

  !> An older file stays until the new one is flushed; a file that never is does not appear.
  subroutine appearance(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(hdf5_file_type) :: file
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    logical :: exists

    call save_lines(tester, path, ['older'])
    call file%create(path, err)
    call file%put('x', 1, 'a number')
    call text_of_file(tester, path, text)
    call tester%is_true(text == 'older'//achar(10), 'the older file is there')
    call file%flush()
    call text_of_file(tester, path, text)
    call tester%is_true(index(text, 'HDF') == 2, 'the new file is there')
    call file%close()
    call remove_file(path)
    call file%create(path, err)
    call file%close()
    inquire (file=path, exist=exists)
    call tester%is_true(.not. exists, 'a file that was never flushed')
    inquire (file='.'//path//'.part', exist=exists)
    call tester%is_true(.not. exists, 'nothing of it is left')
  end subroutine appearance

  !> A series of a scale, a vector and whole numbers, some rows at a time; compressed, too.
  subroutine rows(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call write_and_read(0, 7)
    call write_and_read(6, 7)
    call write_and_read(0, 3000)
    call write_and_read(9, 3000)
  contains
    subroutine write_and_read(compression, n)
      integer, intent(in) :: compression   !< of the data sets
      integer, intent(in) :: n             !< rows
      type(hdf5_file_type) :: file
      type(hdf5_series_type) :: series
      type(error_type), allocatable :: err
      integer, allocatable :: extents(:)
      type(string_type), allocatable :: scales(:)
      real(wp) :: numbers(4, n)
      integer :: i, k

      numbers = reshape([((real(i, wp)/(k + 2), k=1, 3), real(i, wp), i=1, n)], [4, n])
      call file%create(path, err)
      call series%start(3, 4, n, compression)
      call series%add(new_column_set('time', [1], [integer ::], 'time', 's', [character(len=5) ::]))
      call series%add(new_column_set('vector', [2, 3], [2], 'two numbers', 'm', ['/time', '/axis']))
      call series%add(new_column_set('count', [4], [integer ::], 'a whole number', '1', ['/time'], whole=.true.))
      call series%create(file)
      call file%put('axis', [1, 2], 'number of the axis')
      call file%make_scale('axis')
      call series%attach(file)
      do i = 1, n, 5
        call series%append_rows(file, numbers(:, i:min(i + 4, n)))
      end do
      call series%hand_over(file, at_end=.true.)
      call file%flush()
      call series%close(file)
      call file%close()
      call tester%is_true(.not. allocated(file%failure), 'rows are written')
      call open_existing(path, .false., file, err)
      call extents_of(file, 'vector', extents)
      call tester%is_true(all(extents == [2, n]), 'all rows are there')
      call scales_of(file, 'vector', [character(len=5) :: 'time', 'axis'], scales)
      if (size(scales) == 2) call tester%is_true(index(scales(1)%text, 'time') > 0 .and. index(scales(2)%text, 'axis') > 0, &
                                                 'scales')
      call file%close()
      call remove_file(path)
    end subroutine write_and_read
  end subroutine rows

  !> Rows of a fixed number have places; they come in any order and are read back in theirs.
  subroutine rows_out_of_order(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 50
    type(hdf5_file_type) :: file
    type(hdf5_series_type) :: series, again
    type(error_type), allocatable :: err
    real(wp) :: back(2, n), expected(2, n)
    integer :: i, place

    expected = reshape([(real(i, wp), -0.5_wp*i, i=1, n)], [2, n])
    call file%create(path, err)
    call series%start_fixed(2, 2, n, .false.)
    call series%add(new_column_set('a', [1], [integer ::], 'first', '1', [character(len=1) ::]))
    call series%add(new_column_set('b', [2], [integer ::], 'second', '1', [character(len=1) ::]))
    call series%create(file)
    do i = 1, n
      place = 1 + modulo(i*7, n)      ! 7 and 50 have no common factor: each place comes once
      call series%write_row_at(file, place, expected(:, place))
    end do
    call series%hand_over(file)
    call file%flush()
    call series%close(file)
    call file%close()
    call tester%is_true(.not. allocated(file%failure), 'rows are written')
    call open_existing(path, .false., file, err)
    call again%start_fixed(2, 2, n, .true.)
    call again%add(new_column_set('a', [1], [integer ::], 'first', '1', [character(len=1) ::]))
    call again%add(new_column_set('b', [2], [integer ::], 'second', '1', [character(len=1) ::]))
    call again%open(file)
    call again%read_rows(file, 1, back)
    call near_matrix(tester, back, expected, 0.0_wp, 'all rows')
    call again%read_rows(file, 11, back(:, :3))
    call near_matrix(tester, back(:, :3), expected(:, 11:13), 0.0_wp, 'rows in the middle')
    call again%close(file)
    call file%close()
    call remove_file(path)
  end subroutine rows_out_of_order

  !> Data sets that are copied keep extents, descriptions and scales; names that the file does not have are left out.
  subroutine copies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(hdf5_file_type) :: from, to
    type(error_type), allocatable :: err
    type(string_type), allocatable :: scales(:)
    integer, allocatable :: extents(:)

    call from%create(path, err)
    call from%put('axis', [1, 2, 3], 'number of the axis')
    call from%make_scale('axis')
    call from%put('vector', [0.5_wp, 1.5_wp, 2.5_wp], 'a vector', 'N')
    call from%attach_scales('vector', ['/axis'])
    call from%flush()
    call to%create(second, err)
    call copy_data_sets(from, to, [character(len=6) :: 'axis', 'vector', 'none'])
    call tester%is_true(.not. (allocated(from%failure) .or. allocated(to%failure)), 'data sets are copied')
    call extents_of(to, 'vector', extents)
    call tester%is_true(all(extents == [3]), 'extents')
    call tester%is_true(attribute_of(to, 'vector', 'units') == 'N', 'unit')
    call scales_of(to, 'vector', [character(len=6) :: 'axis'], scales)
    call tester%is_true(size(scales) == 1 .and. .not. allocated(to%failure), 'the scale is attached')
    call tester%is_true(.not. has_data_set(to, 'none'), 'others are left out')
    call from%close()
    call to%close()
    call remove_file(path)
    call remove_file(second)
  end subroutine copies

  subroutine failures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(hdf5_file_type) :: file
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text

    call file%create('', err)
    call has_message(tester, err, exit_file, "'' is not the name of a file for HDF5 results", 'no name')
    call file%create('there_is_no_such_folder/x.h5', err)
    call has_message(tester, err, exit_file, "cannot open 'there_is_no_such_folder/x.h5' for writing", 'no folder')
    call open_existing('there_is_no_such_file.h5', .false., file, err)
    call tester%has_error(err, exit_file, 'no file')
    call file%create(path, err)
    call file%put('x', 1, 'a number')
    call file%flush()
    call file%close()
    call open_existing(path, .false., file, err)
    call read_text(file, 'none', text)
    call tester%is_true(allocated(file%failure), 'a data set that is not there')
    call file%fail('another failure')
    call tester%is_true(index(file%failure%message, 'another failure') == 0, 'the first failure stays')
    call file%close()
    call remove_file(path)
  end subroutine failures

  !> One unit for all, or all units.
  subroutine units(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: list(3), same(2)

    list(1)%text = 'rad'
    list(2)%text = 'm'
    list(3)%text = 'rad'
    same(1)%text = 'rad'
    same(2)%text = 'rad'
    call tester%is_true(common_unit(list) == 'rad or m', 'two units: '//common_unit(list))
    call tester%is_true(common_unit(same) == 'rad', 'one unit')
    call tester%is_true(common_unit(list(:0)) == '', 'no numbers')
    list(1)%text = 'N m'
    list(2)%text = 'N'
    call tester%is_true(common_unit(list(:2)) == 'N m or N', 'a unit that is a part of another one: '//common_unit(list(:2)))
  end subroutine units

  !> The unit of some coordinates as a text.
  function common_unit(units) result(text)
    type(string_type), intent(in) :: units(:)   !< of the coordinates
    character(len=:), allocatable :: text

    call find_common_unit(units, text)
  end function common_unit
end module test_hdf5_files
