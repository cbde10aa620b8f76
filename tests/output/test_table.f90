!> Tests of mech9_table: what stands in the file is read back with plain reads.
module test_table
  use mech9_kinds, only: wp
  use mech9_clock, only: seconds
  use mech9_error, only: error_type, exit_file, exit_internal
  use mech9_text, only: string_type, to_text
  use mech9_table, only: table_type
  use mech9_heading, only: new_heading
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_contents')) call test_contents(tester)
    if (tester%runs('test_odd_words')) call test_odd_words(tester)
    if (tester%runs('test_commas')) call test_commas(tester)
    if (tester%runs('test_many_columns')) call test_many_columns(tester)
    if (tester%runs('test_many_rows')) call test_many_rows(tester)
    if (tester%runs('test_regular_flush')) call test_regular_flush(tester)
    if (tester%runs('test_failures')) call test_failures(tester)
  end subroutine run

  !> A table for the tests: columns t, q1 [rad].
  subroutine open_two_columns(table, path, err)
    type(table_type), intent(inout) :: table            !< opened
    character(len=*), intent(in) :: path                !< of its file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call table%open(path, new_heading('Two columns', words('t|q1'), words('s|rad')), 'mech9k 0.0', err)
  end subroutine open_two_columns

  subroutine test_contents(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(table_type) :: table
    type(error_type), allocatable :: err
    character(len=80) :: lines(7)
    real(wp) :: row(2)
    integer :: count

    call open_two_columns(table, 'contents.dat', err)
    call tester%no_error(err, 'a table is opened')
    call table%write_row([0.0_wp, -1.0_wp/3.0_wp], err)
    call table%write_row([0.1_wp, 1.0e-300_wp], err)
    call tester%no_error(err, 'a row is written')
    call table%close(err)
    call tester%no_error(err, 'a table is closed')
    call table%close(err)
    call tester%no_error(err, 'closing a table again does nothing')
    call read_lines('contents.dat', lines, count)
    call tester%is_true(count == 6, 'a table has three comments, the names and two rows')
    call tester%is_true(lines(1) == '# Two columns', 'the title stands in the first line')
    call tester%is_true(lines(2) == '# mech9k 0.0', 'the program stands in the second line')
    call tester%is_true(lines(3)(:8) == '# units:' .and. adjustl(lines(3)(9:25)) == 's' &
                        .and. adjustl(lines(3)(26:)) == 'rad', 'the units stand above their columns')
    call tester%is_true(adjustl(lines(4)(:25)) == 't' .and. adjustl(lines(4)(26:)) == 'q1', 'the names stand above their columns')
    read (lines(5), *) row
    call tester%is_true(all(abs(row - [0.0_wp, -1.0_wp/3.0_wp]) <= 0.0_wp), 'the first row comes back bit for bit')
    read (lines(6), *) row
    call tester%is_true(all(abs(row - [0.1_wp, 1.0e-300_wp]) <= 0.0_wp), 'the second row comes back bit for bit')
    call tester%is_true(len_trim(lines(5)) == 50 .and. len_trim(lines(6)) == 50, 'columns have one width')
  end subroutine test_contents

  !> Titles and names of any bytes leave a table that can be read.
  subroutine test_odd_words(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(table_type) :: table
    type(error_type), allocatable :: err
    character(len=100) :: lines(8)
    character(len=*), parameter :: e_acute = char(195)//char(169)
    integer :: count

    call table%open('odd.dat', new_heading('one'//achar(10)//'two'//achar(13)//achar(10)//achar(0)//'a'//achar(27) &
                                           //char(255)//e_acute//char(195), &
                                           words('t|a b#"c|'//repeat('n', 30)), words('|m/s|N m')), 'p', err)
    call tester%no_error(err, 'a table with a title of several lines is opened')
    call table%write_row([1.0_wp, 2.0_wp, 3.0_wp], err)
    call table%close(err)
    call read_lines('odd.dat', lines, count)
    call tester%is_true(count == 7, 'the table has a comment for each line of the title and no other lines')
    call tester%is_true(lines(1) == '# one' .and. lines(2) == '# two', 'each line of the title is a comment')
    call tester%is_true(lines(3) == '#  a ?'//e_acute//'?', 'control characters and broken UTF-8 are replaced')
    call tester%is_true(lines(5)(25:25) == '1' .and. lines(5)(48:50) == 'm/s' &
                        .and. adjustl(lines(5)(51:)) == 'N_m', 'a plain number has the unit 1')
    call tester%is_true(lines(6)(45:50) == 'a_b__c', 'a name is one word and no comment')
    call tester%is_true(lines(6)(51:) == ' '//repeat('n', 30), 'a long name keeps apart from its neighbour')
  end subroutine test_odd_words

  !> A file of comma-separated values: names, then rows, nothing else; names in quotes where they must be.
  subroutine test_commas(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(table_type) :: table
    type(error_type), allocatable :: err
    character(len=100) :: lines(4)
    real(wp) :: row(3)
    integer :: count

    call table%open('commas.CSV', new_heading('title', words('t|a, b|say "x"'), words('s|m|m')), 'p', err)
    call tester%no_error(err, 'a table with commas is opened')
    call table%write_row([0.1_wp, -1.0_wp/3.0_wp, 1.0e-300_wp], err)
    call table%write_row([0.0_wp, 1.0_wp, -huge(1.0_wp)], err)
    call table%close(err)
    call tester%no_error(err, 'a table with commas is closed')
    call read_lines('commas.CSV', lines, count)
    call tester%is_true(count == 3, 'a table with commas has the names and two rows')
    call tester%is_true(lines(1) == 't,"a, b","say ""x"""', 'names with commas and quotes are written in quotes')
    call tester%is_true(scan(trim(lines(2)), ' ') == 0 .and. scan(trim(lines(3)), ' ') == 0, &
                        'a table with commas has no blanks in its rows')
    read (lines(2), *) row
    call tester%is_true(all(abs(row - [0.1_wp, -1.0_wp/3.0_wp, 1.0e-300_wp]) <= 0.0_wp), &
                        'the first row with commas comes back bit for bit')
    read (lines(3), *) row
    call tester%is_true(all(abs(row - [0.0_wp, 1.0_wp, -huge(1.0_wp)]) <= 0.0_wp), &
                        'the second row with commas comes back bit for bit')
  end subroutine test_commas

  !> The lines above the rows grow with the columns, and their making does, too: eight times as many columns take eight times as
  !> long, where making them word by word would take 64 times as long.
  subroutine test_many_columns(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp) :: some, many

    call open_wide(tester, 5000, some)
    call open_wide(tester, 40000, many)
    call tester%is_true(many <= 30.0_wp*some + 0.5_wp, 'a table with many columns is opened in a time that follows their number')
  end subroutine test_many_columns

  !> Open a table with many columns, and read the line of names.
  subroutine open_wide(tester, columns, time)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(in) :: columns               !< how many columns
    real(wp), intent(out) :: time                !< to open and close the table [s]
    type(table_type) :: table
    type(error_type), allocatable :: err
    type(string_type), allocatable :: names(:), units(:)
    character(len=:), allocatable :: line
    real(wp) :: begin
    integer :: unit, i

    allocate (names(columns), units(columns))
    do i = 1, columns
      names(i)%text = 'q'//to_text(i)
      units(i)%text = 'rad'
    end do
    call cpu_time(begin)
    call table%open('wide.dat', new_heading('', names, units), 'p', err)
    call tester%no_error(err, 'a table with many columns is opened')
    call table%close(err)
    call cpu_time(time)
    time = time - begin
    allocate (character(len=25*columns) :: line)
    open (newunit=unit, file='wide.dat', action='read', status='old')
    read (unit, '(a)')
    read (unit, '(a)') line
    call tester%is_true(line(25*columns - 2:) == 'rad', 'the last unit ends the line of units')
    read (unit, '(a)') line
    call tester%is_true(all([(line(25*i - len(names(i)%text):25*i) == ' '//names(i)%text, i=1, columns)]), &
                        'each name stands at the end of its column')
    close (unit)
  end subroutine open_wide

  !> Several buffers full of rows: nothing is lost or torn where one ends.
  subroutine test_many_rows(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: rows = 50000
    type(table_type) :: table
    type(error_type), allocatable :: err
    character(len=80) :: line
    real(wp) :: row(2)
    integer :: unit, i, wrong

    call open_two_columns(table, 'many.dat', err)
    do i = 1, rows
      call table%write_row([real(i, wp), 1.0_wp/real(i, wp)], err)
      if (allocated(err)) exit
    end do
    call tester%no_error(err, 'the rows of a long table are written')
    call table%close(err)
    open (newunit=unit, file='many.dat', action='read', status='old')
    do i = 1, 4
      read (unit, '(a)') line
    end do
    wrong = 0
    do i = 1, rows
      read (unit, *) row
      if (any(abs(row - [real(i, wp), 1.0_wp/real(i, wp)]) > 0.0_wp)) wrong = wrong + 1
    end do
    close (unit)
    call tester%is_true(wrong == 0, '50000 rows come back bit for bit')
  end subroutine test_many_rows

  !> A slow run: what is more than a second old stands in the file, in whole rows, before it is closed.
  subroutine test_regular_flush(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(table_type) :: table
    type(error_type), allocatable :: err
    real(wp) :: start
    character(len=80) :: lines(20)
    integer :: count

    call open_two_columns(table, 'slow.dat', err)
    call table%write_row([1.0_wp, 1.0_wp], err)
    call read_lines('slow.dat', lines, count)
    call tester%is_true(count == 4, 'the head stands in the file at once, a row waits for more')
    start = seconds()
    do while (seconds() - start < 1.1_wp)
    end do
    ! the clock is looked at at every call here, for calls are slow
    call table%write_row([2.0_wp, 2.0_wp], err)
    call table%write_row([3.0_wp, 3.0_wp], err)
    call read_lines('slow.dat', lines, count)
    call tester%is_true(count >= 6 .and. all(len_trim(lines(5:6)) == 50), &
                        'after a second whole rows stand in the file')
    call table%close(err)
    call read_lines('slow.dat', lines, count)
    call tester%is_true(count == 7, 'all rows stand in the file in the end')
  end subroutine test_regular_flush

  subroutine test_failures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(table_type) :: table
    type(error_type), allocatable :: err
    integer :: i

    call open_two_columns(table, 'no/such/folder.dat', err)
    call tester%has_error(err, exit_file, 'a table in a folder that is not there is refused')
    call tester%is_true(index(err%message, 'no/such/folder.dat') > 0, 'the message about a folder that is not there names the file')
    call open_two_columns(table, '.', err)
    call tester%has_error(err, exit_file, 'a folder instead of a file is refused')
    call open_two_columns(table, '', err)
    call tester%has_error(err, exit_file, 'an empty name of a file is refused')
    call table%write_row([1.0_wp, 1.0_wp], err)
    call tester%has_error(err, exit_internal, 'a row for a table that is not open is refused')
    call table%open('short.dat', new_heading('', words('t'), words('s|m')), '', err)
    call tester%has_error(err, exit_internal, 'more units than names are refused')
    call open_two_columns(table, 'short.dat', err)
    call table%write_row([1.0_wp], err)
    call tester%has_error(err, exit_internal, 'a row that is too short is refused')
    call table%close(err)
    ! a disk that is full: the few bytes of the head are enough to notice
    call open_two_columns(table, '/dev/full', err)
    call tester%has_error(err, exit_file, 'a full disk is told')
    do i = 1, 2
      call table%write_row([1.0_wp, 1.0_wp], err)
    end do
    call table%close(err)
    call tester%has_error(err, exit_file, 'a full disk is noticed when the last rows leave the buffer')
    call table%close(err)
    call tester%no_error(err, 'a table that failed is closed all the same')
  end subroutine test_failures

  !> Words that are separated by `|` in the text. (Array constructors of these leak in gfortran 12.)
  function words(text) result(list)
    character(len=*), intent(in) :: text   !< words with `|` between them
    type(string_type), allocatable :: list(:)
    integer :: first, next, i

    allocate (list(1 + count([(text(i:i) == '|', i=1, len(text))])))
    first = 1
    do i = 1, size(list)
      next = index(text(first:)//'|', '|') + first - 1
      list(i)%text = text(first:next - 1)
      first = next + 1
    end do
  end function words

  !> The lines of a file; count may exceed what there is room for.
  subroutine read_lines(path, lines, count)
    character(len=*), intent(in) :: path        !< of the file
    character(len=*), intent(out) :: lines(:)   !< as many as there is room for
    integer, intent(out) :: count               !< lines of the file
    character(len=200) :: line
    integer :: unit, status

    lines = ''
    count = 0
    open (newunit=unit, file=path, action='read', status='old')
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      count = count + 1
      if (count <= size(lines)) lines(count) = line
    end do
    close (unit)
  end subroutine read_lines
end module test_table
