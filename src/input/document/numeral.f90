!> Conversion of the text of a number to its value, with a reason where it has none.
module mech9_numeral
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: numeral_type, read_numeral

  type :: numeral_type
    logical :: is_integer = .false.  !< written without point and exponent
    integer(long) :: whole = 0       !< value of an integer that is not too large
    real(wp) :: number = 0.0_wp
    character(len=:), allocatable :: problem  !< why it is no number; unallocated where all is well
  end type numeral_type

  character(len=*), parameter :: digits = '0123456789'

contains

  !> Read an integer or a real: 12, -3., .5, 1e-3, 1.0d0.
  pure subroutine read_numeral(text, numeral)
    character(len=*), intent(in) :: text        !< the text, without blanks around it
    type(numeral_type), intent(out) :: numeral  !< the value, or the reason why there is none
    character(len=:), allocatable :: plain       ! allocatable because a text may be too long for the stack
    integer :: point_free, mantissa_end, exponent, magnitude

    if (is_not_finite(text)) then
      numeral%problem = 'is not a finite number'
      return
    end if
    mantissa_end = scan(text, 'eEdDqQ') - 1
    if (mantissa_end < 0) mantissa_end = len(text)
    exponent = 0
    if (.not. is_mantissa(text(:mantissa_end))) then
      numeral%problem = 'is not a number'
    else if (mantissa_end < len(text)) then
      if (.not. is_exponent(text(mantissa_end + 2:))) numeral%problem = 'is not a number'
    end if
    if (allocated(numeral%problem)) return
    if (mantissa_end < len(text)) exponent = exponent_value(text(mantissa_end + 2:))

    point_free = verify(text, '+-'//digits)
    numeral%is_integer = point_free == 0
    call first_digit_weight(text(:mantissa_end), magnitude)
    if (magnitude == -huge(1)) return            ! all digits are zero
    magnitude = magnitude + exponent
    if (magnitude < -400) return                 ! smaller than any number: zero
    plain = text
    if (mantissa_end < len(text)) plain(mantissa_end + 1:mantissa_end + 1) = 'e'
    if (exceeds_range(plain(:mantissa_end), magnitude)) then
      numeral%problem = 'is too large for a number'
      return
    end if
    read (plain, *) numeral%number
    if (numeral%is_integer .and. magnitude < 18) read (plain, *) numeral%whole
    if (numeral%is_integer .and. magnitude >= 18) numeral%whole = merge(-1, 1, text(1:1) == '-')*huge(1_long)
  end subroutine read_numeral

  !> Whether a text is NaN or an infinity in a usual spelling, with or without a sign.
  pure logical function is_not_finite(text)
    character(len=*), intent(in) :: text  !< a value as it is written, without quotes
    character(len=3) :: head
    integer :: i, first

    first = 1
    if (len(text) > 0) first = merge(2, 1, scan(text(1:1), '+-') == 1)
    is_not_finite = .false.
    if (len(text) - first + 1 < 3) return
    head = text(first:first + 2)
    do i = 1, 3
      if (head(i:i) >= 'A' .and. head(i:i) <= 'Z') head(i:i) = achar(iachar(head(i:i)) + 32)
    end do
    is_not_finite = head == 'nan' .or. head == 'inf'
    if (len(text) - first + 1 > 3) is_not_finite = is_not_finite .and. scan(text(first + 3:first + 3), '(iI') == 1
  end function is_not_finite

  !> Whether a text is digits, with a sign or none, and with at most one point among them.
  pure logical function is_mantissa(text)
    character(len=*), intent(in) :: text  !< the numeral up to its exponent letter
    integer :: first, point

    is_mantissa = .false.
    if (len(text) == 0) return
    first = merge(2, 1, scan(text(1:1), '+-') == 1)
    if (scan(text(first:), digits) == 0 .or. verify(text(first:), digits//'.') > 0) return
    point = index(text, '.')
    is_mantissa = point == index(text, '.', back=.true.)
  end function is_mantissa

  !> Whether a text is digits, with a sign or none.
  pure logical function is_exponent(text)
    character(len=*), intent(in) :: text  !< the numeral after its exponent letter
    integer :: first

    is_exponent = .false.
    if (len(text) == 0) return
    first = merge(2, 1, scan(text(1:1), '+-') == 1)
    is_exponent = len(text) >= first .and. verify(text(first:), digits) == 0
  end function is_exponent

  !> The value of an exponent; a very large one becomes 100000000 or a little less, which is too large as well.
  pure integer function exponent_value(text) result(exponent)
    character(len=*), intent(in) :: text  !< the numeral after its exponent letter, already checked
    integer :: i

    exponent = 0
    do i = merge(2, 1, scan(text(1:1), '+-') == 1), len(text)
      exponent = min(10*exponent + index(digits, text(i:i)) - 1, 100000000)
    end do
    if (text(1:1) == '-') exponent = -exponent
  end function exponent_value

  !> Power of ten of the first digit that is not zero; -huge where there is none.
  pure subroutine first_digit_weight(mantissa, weight)
    character(len=*), intent(in) :: mantissa  !< the numeral up to its exponent letter, already checked
    integer, intent(out) :: weight            !< power of ten of the first digit that is not zero
    integer :: point, lead

    weight = -huge(1)
    lead = scan(mantissa, '123456789')
    if (lead == 0) return
    point = index(mantissa, '.')
    if (point == 0) point = len(mantissa) + 1
    weight = point - lead
    if (weight > 0) weight = weight - 1
  end subroutine first_digit_weight

  !> Whether a numeral is too large, found before the conversion: that of the Fortran library would raise a floating-point trap.
  pure logical function exceeds_range(mantissa, magnitude)
    character(len=*), intent(in) :: mantissa  !< the numeral up to its exponent letter, already checked
    integer, intent(in) :: magnitude          !< power of ten of the first digit that is not zero
    character(len=17), parameter :: largest = '17976931348623157'
    character(len=17) :: lead
    integer :: i, n

    exceeds_range = magnitude > 308
    if (magnitude /= 308) return
    lead = repeat('0', len(lead))
    n = 0
    do i = scan(mantissa, '123456789'), len(mantissa)
      if (mantissa(i:i) == '.' .or. n == len(lead)) cycle
      n = n + 1
      lead(n:n) = mantissa(i:i)
    end do
    exceeds_range = lead > largest
  end function exceeds_range
end module mech9_numeral
