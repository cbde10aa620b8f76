!> Tests of mech9_json: documents letter by letter, as the standard (RFC 8259) has them.
module test_json
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, exit_internal, exit_file
  use mech9_json, only: json_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_document')) call test_document(tester)
    if (tester%runs('test_numbers')) call test_numbers(tester)
    if (tester%runs('test_misuse')) call test_misuse(tester)
  end subroutine run

  subroutine test_document(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(json_type) :: json
    type(error_type), allocatable :: err
    character, parameter :: nl = achar(10)

    call json%begin_object()
    call json%add('a "b"\', 'tab'//achar(9)//nl//achar(1)//char(255)//char(195)//char(169))
    call json%add('count', 3000000000_long)
    call json%begin_array('list')
    call json%add(1)
    call json%add(.false.)
    call json%add('x')
    call json%add(0.25_wp)
    call json%begin_object()
    call json%end_object()
    call json%end_array()
    call json%add('ok', .true.)
    call json%add('pair', [1.5_wp, -2.0_wp])
    call json%end_object()
    call json%save('document.json', err)
    call tester%no_error(err, 'a document is saved')
    call tester%is_true(file_text('document.json') == '{'//nl// &
      '  "a \"b\"\\": "tab\t\n\u0001\ufffd'//char(195)//char(169)//'",'//nl// &
      '  "count": 3000000000,'//nl// &
      '  "list": ['//nl//'    1,'//nl//'    false,'//nl//'    "x",'//nl//'    0.25,'//nl//'    {}'//nl//'  ],'//nl// &
      '  "ok": true,'//nl// &
      '  "pair": ['//nl//'    1.5,'//nl//'    -2'//nl//'  ]'//nl//'}'//nl, 'a document is right letter by letter')
  end subroutine test_document

  !> Every number comes back bit for bit, in the shortest form that does so among 15 to 17 digits.
  subroutine test_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(json_type) :: json
    type(error_type), allocatable :: err
    real(wp) :: numbers(8), read_back
    character(len=40) :: line
    integer :: unit, i

    numbers = [0.1_wp, 1.0_wp/3.0_wp, huge(1.0_wp), tiny(1.0_wp), -1.0e22_wp, 123456.789_wp, &
               transfer(shiftl(2047_long, 52), 1.0_wp), transfer(shiftl(4095_long, 51), 1.0_wp)]
    call json%begin_array()
    do i = 1, size(numbers)
      call json%add(numbers(i))
    end do
    call json%end_array()
    call json%save('numbers.json', err)
    call tester%no_error(err, 'numbers are saved')
    open (newunit=unit, file='numbers.json', action='read', status='old')
    read (unit, '(a)') line
    do i = 1, 6
      read (unit, '(a)') line
      read (line(:len_trim(line) - 1), *) read_back
      call tester%is_true(transfer(read_back, 0_long) == transfer(numbers(i), 0_long), 'a number comes back bit for bit: '//line)
      if (i == 1) call tester%is_true(line == '  0.1,', 'a tenth is written as 0.1')
    end do
    read (unit, '(a)') line
    call tester%is_true(line == '  null,', 'infinity is written as null')
    read (unit, '(a)') line
    call tester%is_true(line == '  null', 'a number that is none is written as null')
    close (unit)
  end subroutine test_numbers

  !> Calls that do not make a document are refused, not written.
  subroutine test_misuse(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(json_type) :: open_end, no_name, crossed, two, nothing, deep
    type(error_type), allocatable :: err
    integer :: i

    call open_end%begin_object()
    call open_end%save('bad.json', err)
    call tester%has_error(err, exit_internal, 'an object that does not end is refused')
    call no_name%begin_object()
    call no_name%add(1)
    call no_name%end_object()
    call no_name%save('bad.json', err)
    call tester%has_error(err, exit_internal, 'an item without a name in an object is refused')
    call crossed%begin_array()
    call crossed%end_object()
    call crossed%save('bad.json', err)
    call tester%has_error(err, exit_internal, 'an array that ends as an object is refused')
    call two%add(1)
    call two%add(2)
    call two%save('bad.json', err)
    call tester%has_error(err, exit_internal, 'two values at the top are refused')
    call nothing%save('bad.json', err)
    call tester%has_error(err, exit_internal, 'an empty document is refused')
    do i = 1, 100
      call deep%begin_array()
    end do
    do i = 1, 100
      call deep%end_array()
    end do
    call deep%save('bad.json', err)
    call tester%has_error(err, exit_internal, 'a document deeper than there is room for is refused')
    call test_full_disk(tester)
  end subroutine test_misuse

  subroutine test_full_disk(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(json_type) :: json
    type(error_type), allocatable :: err

    call json%add(1)
    call json%save('/dev/full', err)
    call tester%has_error(err, exit_file, 'a full disk is told')
  end subroutine test_full_disk

  !> The whole text of a small file.
  function file_text(path) result(text)
    character(len=*), intent(in) :: path   !< of the file
    character(len=:), allocatable :: text
    integer :: unit, size

    open (newunit=unit, file=path, action='read', status='old', access='stream', form='unformatted')
    inquire (unit, size=size)
    allocate (character(len=size) :: text)
    read (unit) text
    close (unit)
  end function file_text
end module test_json
