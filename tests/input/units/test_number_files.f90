!> Files of numbers beside the data file: tables, curves and lists, with comments, headings, and errors at their places.
module test_number_files
  use mech9_kinds, only: wp
  use mech9_diagnostics, only: diagnostics_type
  use mech9_error, only: error_type, exit_file
  use mech9_number_file, only: number_file_type, read_number_file
  use mech9_source, only: span_type
  use mech9_table_file, only: read_table_file, read_curve_file, beside
  use mech9_checks, only: near_vector, near_matrix
  use mech9_test_files, only: save_lines, remove_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_number_files.txt'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('tables')) call tables(tester)
    if (tester%runs('bad_tables')) call bad_tables(tester)
    if (tester%runs('curves')) call curves(tester)
    if (tester%runs('lists')) call lists(tester)
    if (tester%runs('folders')) call folders(tester)
  end subroutine run

  !> The first message, with its place in the file.
  function first_message(diagnostics) result(message)
    type(diagnostics_type), intent(in) :: diagnostics   !< with errors or without
    character(len=:), allocatable :: message
    integer :: i

    message = ''
    if (diagnostics%known() == 0) return
    call diagnostics%render(1, message)
    i = index(message, achar(10))
    if (i > 0) message = message(:i - 1)
  end function first_message

  subroutine read_table(tester, lines, points, ok, diagnostics)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    character(len=*), intent(in) :: lines(:)              !< of the file
    real(wp), allocatable, intent(out) :: points(:, :)    !< (2,n) numbers of the lines
    logical, intent(out) :: ok                            !< no error was reported
    type(diagnostics_type), intent(out) :: diagnostics    !< gets the errors

    call save_lines(tester, path, lines)
    call read_table_file(path, span_type(), 't', 'q', points, ok, diagnostics)
    call remove_file(path)
  end subroutine read_table

  subroutine tables(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(diagnostics_type) :: diagnostics
    real(wp), allocatable :: points(:, :)
    logical :: ok

    call read_table(tester, [character(len=30) :: '# comment', 't, q', '0 1', '', ' 1e0,2.5 # one', achar(9)//'2'//achar(9)//'3', &
                             '3 -4'//achar(13)], points, ok, diagnostics)
    call tester%is_true(ok, 'a table: '//first_message(diagnostics))
    call near_vector(tester, points(1, :), [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp], 0.0_wp, 'times')
    call near_vector(tester, points(2, :), [1.0_wp, 2.5_wp, 3.0_wp, -4.0_wp], 0.0_wp, 'values')
  end subroutine tables

  subroutine bad_tables(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(diagnostics_type) :: diagnostics
    real(wp), allocatable :: points(:, :)
    logical :: ok

    call says([character(len=12) :: '0 1', '1 2', '1 3', '2 4'], path//':3:1: t must increase from line to line')
    call says([character(len=12) :: '0 1', '1', '2 3', '3 4'], path//':2:1: each line holds two numbers, t and q; this one has 1')
    call says([character(len=12) :: '0 1', '1 2', '2 3'], 'a smooth curve needs at least 4 points, and the table has 3')
    call says([character(len=12) :: '0 1', '1 x', '2 3', '3 4'], path//':2:3: ')
    call read_table_file('there_is_no_such_file', span_type(), 't', 'q', points, ok, diagnostics)
    call tester%is_true(.not. ok .and. diagnostics%code() == exit_file, 'a file that is not there')
  contains
    subroutine says(lines, words)
      character(len=*), intent(in) :: lines(:)   !< of the file
      character(len=*), intent(in) :: words      !< part of the message

      call read_table(tester, lines, points, ok, diagnostics)
      call tester%is_true(.not. ok .and. index(first_message(diagnostics), words) > 0, 'message: '//first_message(diagnostics))
    end subroutine says
  end subroutine bad_tables

  !> Curves in a plane and in space, and chosen columns in any order.
  subroutine curves(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=20), parameter :: plane(4) = [character(len=20) :: '0 1', '2 3', '4 5', '6 7']
    character(len=20), parameter :: space(4) = [character(len=20) :: '0 1 9', '2 3 8', '4 5 7', '6 7 6']

    call gives(plane, [integer ::], reshape([0, 1, 0, 2, 3, 0, 4, 5, 0, 6, 7, 0], [3, 4]))
    call gives(space, [integer ::], reshape([0, 1, 9, 2, 3, 8, 4, 5, 7, 6, 7, 6], [3, 4]))
    call gives(space, [3, 1], reshape([9, 0, 0, 8, 2, 0, 7, 4, 0, 6, 6, 0], [3, 4]))
    call says([plane(:3), space(4:)], [integer ::], path//':4:1: each line holds the coordinates of a point')
    call says(plane, [1, 3], path//":1:1: column 3 is asked for by 'columns', and this line has 2 numbers")
    call says(plane(:3), [integer ::], 'a curve needs at least 4 points, and the file has 3')
    call parts([character(len=12) :: '', '0 0', '1 0', '', '# side', '1 1', '', '', '0 1', ' '], [.false., .true., .true., .false.])
  contains
    !> Empty lines between points make corners; comments do not, nor empty lines before and behind all points.
    subroutine parts(lines, expected)
      character(len=*), intent(in) :: lines(:)   !< of the file
      logical, intent(in) :: expected(:)         !< (n) which points are corners
      type(diagnostics_type) :: diagnostics
      type(span_type), allocatable :: spans(:)
      real(wp), allocatable :: points(:, :)
      logical, allocatable :: corners(:)
      logical :: ok

      call save_lines(tester, path, lines)
      call read_curve_file(path, span_type(), [integer ::], 2, points, spans, corners, ok, diagnostics)
      call remove_file(path)
      call tester%is_true(ok .and. size(corners) == size(expected), 'a curve with corners: '//first_message(diagnostics))
      if (size(corners) == size(expected)) call tester%is_true(all(corners .eqv. expected), 'its corners')
    end subroutine parts

    subroutine gives(lines, chosen, expected)
      character(len=*), intent(in) :: lines(:)   !< of the file
      integer, intent(in) :: chosen(:)           !< columns
      integer, intent(in) :: expected(:, :)      !< (3,n) the right points
      type(diagnostics_type) :: diagnostics
      type(span_type), allocatable :: spans(:)
      real(wp), allocatable :: points(:, :)
      logical, allocatable :: corners(:)
      logical :: ok

      call save_lines(tester, path, lines)
      call read_curve_file(path, span_type(), chosen, 4, points, spans, corners, ok, diagnostics)
      call remove_file(path)
      call tester%is_true(ok, 'a curve: '//first_message(diagnostics))
      call near_matrix(tester, points, real(expected, wp), 0.0_wp, 'its points')
      call tester%is_true(size(spans) == 4 .and. .not. any(corners), 'places of the points, and no corner')
    end subroutine gives

    subroutine says(lines, chosen, words)
      character(len=*), intent(in) :: lines(:)   !< of the file
      integer, intent(in) :: chosen(:)           !< columns
      character(len=*), intent(in) :: words      !< part of the message
      type(diagnostics_type) :: diagnostics
      type(span_type), allocatable :: spans(:)
      real(wp), allocatable :: points(:, :)
      logical, allocatable :: corners(:)
      logical :: ok

      call save_lines(tester, path, lines)
      call read_curve_file(path, span_type(), chosen, 4, points, spans, corners, ok, diagnostics)
      call remove_file(path)
      call tester%is_true(.not. ok .and. index(first_message(diagnostics), words) > 0, 'message: '//first_message(diagnostics))
    end subroutine says
  end subroutine curves

  !> Lines of any numbers; the first ones are kept, all are counted, and a bad line is left out.
  subroutine lists(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(number_file_type) :: lines
    type(diagnostics_type) :: diagnostics
    type(error_type), allocatable :: err

    call save_lines(tester, path, [character(len=20) :: '# words', '1; 2, 3', '', '4 five', '#', '6 7 # 8', '9'])
    call read_number_file(path, 2, lines, diagnostics, err)
    call tester%no_error(err, 'a file of numbers')
    call tester%is_true(all(lines%counts == [3, 2, 1]), 'numbers of each line')
    if (size(lines%counts) == 3) then
      call near_matrix(tester, lines%numbers(:, :2), reshape([1.0_wp, 2.0_wp, 6.0_wp, 7.0_wp], [2, 2]), 0.0_wp, 'the first ones')
      call tester%near(lines%numbers(1, 3), 9.0_wp, 0.0_wp, 'the last line')
    end if
    call tester%is_true(diagnostics%count == 1 .and. index(first_message(diagnostics), path//":4:3: 'five' ") == 1, &
                        'a word: '//first_message(diagnostics))
    call remove_file(path)
    call read_number_file(path, 2, lines, diagnostics, err)
    call tester%has_error(err, exit_file, 'a file that is not there')
  end subroutine lists

  !> Names of files are meant from the folder of the data file.
  subroutine folders(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(beside('a/b.nml', 't.dat') == 'a/t.dat' .and. beside('b.nml', 't.dat') == 't.dat', 'beside the data file')
    call tester%is_true(beside('a/b.nml', '/t.dat') == '/t.dat', 'a whole path')
  end subroutine folders
end module test_number_files
