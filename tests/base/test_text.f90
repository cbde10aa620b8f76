!> Texts: numbers as text and back, case, lists, nearest names.
module test_text
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf, ieee_negative_inf
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type, to_text, lower, join, nearest_name, starts_with, in_apostrophes
  use mech9_counted, only: counted
  use mech9_random, only: random_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('integers_as_text')) call integers_as_text(test)
    if (test%runs('integers_with_nouns')) call integers_with_nouns(test)
    if (test%runs('reals_as_text')) call reals_as_text(test)
    if (test%runs('reals_read_back')) call reals_read_back(test)
    if (test%runs('pieces_of_text')) call pieces_of_text(test)
    if (test%runs('near_names')) call near_names(test)
  end subroutine run

  subroutine same(test, text, expected)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< the text that was made
    character(len=*), intent(in) :: expected   !< the right text

    ! lengths too: Fortran takes 'a' and 'a ' for equal
    call test%is_true(text == expected .and. len(text) == len(expected), '"'//text//'" should be "'//expected//'"')
  end subroutine same

  subroutine integers_as_text(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: none(0) = [integer ::]

    call same(test, to_text(0), '0')
    call same(test, to_text(-7), '-7')
    call same(test, to_text(huge(1)), '2147483647')
    call same(test, to_text(-huge(1)), '-2147483647')
    call same(test, to_text(huge(1_long)), '9223372036854775807')
    call same(test, to_text(-huge(1_long)), '-9223372036854775807')
    call same(test, to_text(none), '')
    call same(test, to_text([5]), '5')
    call same(test, to_text([1, -2, 30]), '1, -2, 30')
    call same(test, to_text([1, -2, 30], ' '), '1 -2 30')
  end subroutine integers_as_text

  subroutine integers_with_nouns(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call same(test, counted(1, 'position'), '1 position')
    call same(test, counted(0, 'position'), '0 positions')
    call same(test, counted(12, 'assembly'), '12 assemblies')
    call same(test, counted(1_long, 'assembly'), '1 assembly')
    call same(test, counted(2_long, 'day'), '2 days')
  end subroutine integers_with_nouns

  subroutine reals_as_text(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call same(test, to_text(0.0_wp), '0')
    call same(test, to_text(-0.0_wp), '0')
    call same(test, to_text(1.0_wp), '1')
    call same(test, to_text(-1.0_wp), '-1')
    call same(test, to_text(0.25_wp), '0.25')
    call same(test, to_text(-0.25_wp), '-0.25')
    call same(test, to_text(1200.0_wp), '1200')
    call same(test, to_text(100000.0_wp), '100000')
    call same(test, to_text(999999.0_wp), '999999')
    call same(test, to_text(1000000.0_wp), '1e6')
    call same(test, to_text(999999.7_wp), '1e6')        ! rounds up into one more digit
    call same(test, to_text(0.99999996_wp), '1')
    call same(test, to_text(9.999996_wp, 6), '10')
    call same(test, to_text(1.5e-7_wp), '1.5e-7')
    call same(test, to_text(1.0e-4_wp), '0.0001')
    call same(test, to_text(9.9999999e-5_wp), '0.0001')
    call same(test, to_text(1.0e-5_wp), '1e-5')
    call same(test, to_text(-2.5e300_wp), '-2.5e300')
    call same(test, to_text(1.0e100_wp, 17), '1e100')
    call same(test, to_text(3.0_wp, 1), '3')
    call same(test, to_text(0.04_wp, 1), '0.04')
    call same(test, to_text(1.0_wp/3.0_wp, 3), '0.333')
    call same(test, to_text(12345678.0_wp, 8), '12345678')
    call same(test, to_text(ieee_value(1.0_wp, ieee_quiet_nan)), 'NaN')
    call same(test, to_text(ieee_value(1.0_wp, ieee_positive_inf)), 'Infinity')
    call same(test, to_text(ieee_value(1.0_wp, ieee_negative_inf)), '-Infinity')
  end subroutine reals_as_text

  !> 17 digits give back the very number, 6 digits half a unit of the sixth.
  subroutine reals_read_back(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    character(len=48) :: text
    real(wp) :: number, back
    logical :: exact, close, short
    integer :: i

    exact = .true.
    close = .true.
    short = .true.
    do i = 1, 3000
      number = random%symmetric()*10.0_wp**(nint(300.0_wp*random%symmetric()))
      text = to_text(number, 17)
      read (text, *) back
      exact = exact .and. abs(back - number) <= 0.0_wp
      number = random%symmetric()*10.0_wp**(nint(8.0_wp*random%symmetric()))
      text = to_text(number)
      read (text, *) back
      close = close .and. abs(back - number) <= 0.500001e-5_wp*abs(number)
      short = short .and. len_trim(text) <= 13 .and. verify(trim(text), '0123456789.e-') == 0
    end do
    number = huge(number)
    text = to_text(number, 17)
    read (text, *) back
    exact = exact .and. abs(back - number) <= 0.0_wp
    call test%is_true(exact, 'seventeen digits give back the number itself')
    call test%is_true(close, 'six digits give back a number to half a unit of the sixth')
    call test%is_true(short, 'a number of six digits takes no more than 13 letters, none of them strange')
  end subroutine reals_read_back

  subroutine pieces_of_text(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(string_type) :: words(3)
    character(len=2) :: umlaut

    umlaut = char(195)//char(132)   ! a letter of two bytes in UTF-8
    call same(test, lower('PAIR_2 [Az@]'), 'pair_2 [az@]')
    call same(test, lower(''), '')
    call same(test, lower(umlaut), umlaut)
    call test%is_true(starts_with('dq1', 'dq'), 'a text starts with its beginning')
    call test%is_true(starts_with('dq1', ''), 'any text starts with nothing')
    call test%is_true(starts_with('dq', 'dq'), 'a text starts with itself')
    call test%is_true(.not. starts_with('d', 'dq'), 'a text does not start with a longer one')
    call test%is_true(.not. starts_with('d', 'd '), 'a text does not start with itself and a blank')
    call same(test, in_apostrophes('the crank''s'), '''the crank''''s''')
    call same(test, in_apostrophes(''), '''''')
    words(1)%text = 'one'
    words(2)%text = ''
    words(3)%text = ' b'
    call same(test, join(words(:0), ', '), '')
    call same(test, join(words(:1), ', '), 'one')
    call same(test, join(words, '; '), 'one; ;  b')
  end subroutine pieces_of_text

  subroutine near_names(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=12), parameter :: known(5) = [character(len=12) :: &
                                                'revolute', 'prismatic', 'helical', 'user', 'axis']

    call same(test, nearest_name('revolute', known), 'revolute')
    call same(test, nearest_name('revolutte', known), 'revolute')   ! one too many
    call same(test, nearest_name('rvolute', known), 'revolute')     ! one missing
    call same(test, nearest_name('revolvte', known), 'revolute')    ! one changed
    call same(test, nearest_name('revoltue', known), 'revolute')    ! two exchanged
    call same(test, nearest_name('PRISMATIC', known), 'prismatic')  ! whatever the case
    call same(test, nearest_name('  axis'(3:)//'   ', known), 'axis')
    call same(test, nearest_name('uesr', known), 'user')            ! an exchange is one edit, not two
    call same(test, nearest_name('axes', known), 'axis')
    call same(test, nearest_name('cylinder', known), '')
    call same(test, nearest_name('', known), '')
    call same(test, nearest_name('revolute', [character(len=4) ::]), '')
  end subroutine near_names
end module test_text
