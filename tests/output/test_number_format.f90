!> Tests of mech9_number_format against the compiler's formatted write, which is exact, and by
!> reading back. The hard cases were found by a search in exact integers (a m mod M next to M/2)
!> and their digits by arbitrary-precision arithmetic.
module test_number_format
  use mech9_kinds, only: wp, long
  use mech9_clock, only: seconds
  use mech9_number_format, only: number_format_type, number_width
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks
    type(number_format_type) :: format

    format = number_format_type()
    if (tester%runs('test_special')) call test_special(tester, format)
    if (tester%runs('test_ties')) call test_ties(tester, format)
    if (tester%runs('test_hard')) call test_hard(tester, format)
    if (tester%runs('test_edges')) call test_edges(tester, format)
    if (tester%runs('test_random')) call test_random(tester, format)
    if (tester%runs('test_speed')) call test_speed(tester, format)
  end subroutine run

  subroutine test_special(tester, format)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(number_format_type), intent(in) :: format   !< of the numbers

    call expect(tester, format, 0.0_wp, '0.0000000000000000E+00', 'zero')
    call expect(tester, format, -0.0_wp, '-0.0000000000000000E+00', 'the sign of zero stays')
    call expect(tester, format, 1.0_wp, '1.0000000000000000E+00', 'one')
    call expect(tester, format, -0.1_wp, '-1.0000000000000001E-01', &
                'a tenth is 0.1000000000000000055511...')
    call expect(tester, format, huge(1.0_wp), '1.7976931348623157E+308', 'the largest number')
    call expect(tester, format, -transfer(1_long, 1.0_wp), '-4.9406564584124654E-324', &
                'the smallest number, widest field')
    call expect(tester, format, transfer(shiftl(2047_long, 52), 1.0_wp), 'Infinity', 'infinity')
    call expect(tester, format, transfer(shiftl(4095_long, 52), 1.0_wp), '-Infinity', 'minus infinity')
    call expect(tester, format, transfer(shiftl(4095_long, 51), 1.0_wp), 'NaN', 'not a number')
  end subroutine test_special

  !> Numbers in the midst of two neighbours of 17 digits, exactly: to the even one.
  subroutine test_ties(tester, format)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(number_format_type), intent(in) :: format   !< of the numbers

    call expect(tester, format, 1234567890123456.25_wp, '1.2345678901234562E+15', 'tie, even below')
    call expect(tester, format, 1234567890123456.75_wp, '1.2345678901234568E+15', 'tie, even above')
    call expect(tester, format, 123456789012345.625_wp, '1.2345678901234562E+14', 'tie, even below, 14')
    call expect(tester, format, 123456789012345.375_wp, '1.2345678901234538E+14', 'tie, even above, 14')
  end subroutine test_ties

  !> Numbers whose digits beyond the 17th are nearest to a half, below it and above it.
  subroutine test_hard(tester, format)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(number_format_type), intent(in) :: format   !< of the numbers
    character(len=16), parameter :: bits(*) = [ &
      '2b659a2783ce70ab', '617348bd023ae858', '10f1d467e94b856e', '3086e22db4568793', &
      '5c6e735b3003e352', '618011f2d73116f4', '0730d9b828199006', &
      '4d73de005bd620df', '0d17c0747bd76fa1', '4d63de005bd620df', '0d07c0747bd76fa1', &
      '0eee16ee5d60cf47', '656a999ddec72aca']
    character(len=23), parameter :: text(*) = [character(len=23) :: &
      '1.2345501366327440E-99', '2.7111767708322121E+161', '4.7040027951341198E-227', &
      '6.3240271545917571E-75', '1.7706146115181413E+137', '4.5186279513870202E+161', &
      '4.8669387069477210E-274', '1.3076622631878654E+65', '1.3588129002659584E-245', &
      '6.5383113159393268E+64', '6.7940645013297918E-246', '9.2416489974642889E-237', &
      '3.4492932658871003E+180']
    character(len=16) :: word
    integer(long) :: pattern
    integer :: i

    do i = 1, size(bits)
      word = bits(i)
      read (word, '(z16)') pattern
      call expect(tester, format, transfer(pattern, 1.0_wp), trim(text(i)), 'hard to round: '//word)
    end do
  end subroutine test_hard

  subroutine expect(tester, format, number, text, why)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(number_format_type), intent(in) :: format   !< of the numbers
    real(wp), intent(in) :: number                   !< number that is written
    character(len=*), intent(in) :: text             !< the right text, without blanks before it
    character(len=*), intent(in) :: why              !< the statement that is checked, printed where it is wrong
    character(len=number_width) :: field

    call format%put(number, field)
    call tester%is_true(field == repeat(' ', number_width - len(text))//text, &
                        why//': '//field//' should be '//text)
  end subroutine expect

  !> Powers of two and of ten with their neighbours: where the number of digits changes.
  subroutine test_edges(tester, format)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(number_format_type), intent(in) :: format   !< of the numbers
    character(len=8) :: text
    real(wp) :: number
    integer :: i, wrong

    wrong = 0
    do i = -1074, 1023
      call count_wrong_near(format, scale(1.0_wp, i), wrong)
    end do
    call tester%is_true(wrong == 0, 'powers of two and their neighbours agree with the formatted write')
    wrong = 0
    do i = -307, 308
      write (text, '(a,i0)') '1e', i
      read (text, *) number
      call count_wrong_near(format, number, wrong)
    end do
    call tester%is_true(wrong == 0, 'powers of ten and their neighbours agree with the formatted write')
  end subroutine test_edges

  !> Count what is wrong at a number and three neighbours on either side, by their bits.
  subroutine count_wrong_near(format, number, wrong)
    type(number_format_type), intent(in) :: format   !< of the numbers
    real(wp), intent(in) :: number                   !< the middle one
    integer, intent(inout) :: wrong                  !< grows by the numbers whose text is wrong
    integer :: i

    do i = -3, 3
      if (.not. agrees(format, abs(transfer(transfer(number, 0_long) + i, 1.0_wp)))) wrong = wrong + 1
    end do
  end subroutine count_wrong_near

  !> A million random bit patterns: all exponents, signs, subnormal numbers, and what is not finite.
  subroutine test_random(tester, format)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(number_format_type), intent(in) :: format   !< of the numbers
    character(len=number_width) :: field
    integer(long) :: bits
    real(wp) :: number, read_back
    integer :: i, wrong, lost

    bits = 88172645463325252_long
    wrong = 0
    lost = 0
    do i = 1, 1000000
      bits = ieor(bits, shiftl(bits, 13))
      bits = ieor(bits, shiftr(bits, 7))
      bits = ieor(bits, shiftl(bits, 17))
      if (ibits(bits, 52, 11) == 2047) cycle
      number = transfer(bits, number)
      ! one in sixteen subnormal, which would else be one in two thousand
      if (mod(i, 16) == 0) number = transfer(iand(bits, not(shiftl(2047_long, 52))), number)
      if (.not. agrees(format, number)) wrong = wrong + 1
      call format%put(number, field)
      read (field, '(f25.0)') read_back
      if (transfer(read_back, bits) /= transfer(number, bits)) lost = lost + 1
    end do
    call tester%is_true(wrong == 0, 'a million random numbers agree with the formatted write')
    call tester%is_true(lost == 0, '17 digits bring a million random numbers back bit for bit')
  end subroutine test_random

  !> Whether a number's text is that of the compiler's formatted write, with a short exponent.
  logical function agrees(format, number)
    type(number_format_type), intent(in) :: format   !< of the numbers
    real(wp), intent(in) :: number                   !< number that is written
    character(len=number_width) :: field, expected

    write (expected, '(es25.16e3)') number
    if (expected(23:23) == '0') expected = ' '//expected(:22)//expected(24:)
    call format%put(number, field)
    agrees = field == expected
  end function agrees

  !> The reason to have it: it must be much faster than the formatted write. About 25 times in a
  !> release build; three times passes with run-time checks on a busy machine, too.
  subroutine test_speed(tester, format)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(number_format_type), intent(in) :: format   !< of the numbers
    integer, parameter :: many = 100000
    character(len=number_width) :: field
    real(wp) :: numbers(1000), start, own, compilers
    integer :: i

    call random_number(numbers)
    start = seconds()
    do i = 1, many
      call format%put(numbers(mod(i, 1000) + 1), field)
    end do
    own = seconds() - start
    start = seconds()
    do i = 1, many
      write (field, '(es25.16e3)') numbers(mod(i, 1000) + 1)
    end do
    compilers = seconds() - start
    print '(2(f0.1,a))', own/many*1.0e9_wp, ' ns a number, formatted write ', compilers/many*1.0e9_wp, ' ns'
    call tester%is_true(3*own < compilers, 'numbers are written at least three times as fast as by the formatted write')
  end subroutine test_speed
end module test_number_format
