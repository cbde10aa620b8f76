!> Real numbers as text of 17 significant digits, correctly rounded, in columns of equal width.
!>
!> A number is m 2^e with an integer m < 2^53. Its 17 digits are the integer nearest to m 2^e 10^p
!> for the right power p, and that product is taken in integers: 10^p stands in a table as a
!> 120-bit integer g times a power of two, and m g has so many bits after the 17 digits that they decide the
!> rounding, except for very few numbers; those are converted by a formatted write, which is slower.
module mech9_number_format
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: number_format_type, number_width

  !> Width of a number as text: a blank, the sign, 17 digits and the point, up to E-308.
  integer, parameter :: number_width = 25

  !> Integers that hold the product of two of kind `long`.
  integer, parameter :: wide = selected_int_kind(38)
  !> Powers of ten that bring the largest and the smallest number to 17 digits.
  integer, parameter :: least_power = -292, greatest_power = 340
  !> Halves of a table entry, and limbs of the long integers it is made from.
  integer, parameter :: half_bits = 60, limb_bits = 30, limbs = 32
  integer(long), parameter :: limb_mask = maskr(limb_bits, long)
  integer(long), parameter :: ten_to_8 = 100000000_long
  integer(long), parameter :: ten_to_16 = ten_to_8*ten_to_8, ten_to_17 = 10*ten_to_16

  character(len=*), parameter :: pairs = &
    '0001020304050607080910111213141516171819202122232425262728293031323334353637383940414243444546474849'// &
    '5051525354555657585960616263646566676869707172737475767778798081828384858687888990919293949596979899'

  !> The table of powers of ten; made by `number_format_type()`, about ten microseconds.
  type :: number_format_type
    private
    !> 10^p = (high 2^60 + low + d) 2^(binary_exponent(p)), 2^59 <= high < 2^60, 0 <= d < 1;
    !> d = 0 for p = 0 .. 51.
    integer(long) :: high(least_power:greatest_power)
    integer(long) :: low(least_power:greatest_power)
  contains
    procedure :: put
  end type number_format_type

  interface number_format_type
    module procedure new_number_format
  end interface number_format_type

contains

  !> The table, exactly truncated: 5^p from p = 0 upwards by multiplication, and floor(2^n/5^p)
  !> downwards by repeated division, which truncates to the same number as one division would.
  pure function new_number_format() result(self)
    type(number_format_type) :: self
    integer(long) :: number(limbs)
    integer :: p

    number = 0
    number(6) = 1
    do p = 0, greatest_power
      call leading_bits(number, self%high(p), self%low(p))
      call multiply_by_5(number)
    end do
    number = 0
    number(limbs) = 1
    do p = -1, least_power, -1
      call divide_by_5(number)
      call leading_bits(number, self%high(p), self%low(p))
    end do
  end function new_number_format

  !> Multiply a long integer by 5.
  pure subroutine multiply_by_5(number)
    integer(long), intent(inout) :: number(limbs)  !< long integer, least limb first
    integer(long) :: carry
    integer :: i

    carry = 0
    do i = 1, limbs
      carry = carry + 5*number(i)
      number(i) = iand(carry, limb_mask)
      carry = shiftr(carry, limb_bits)
    end do
  end subroutine multiply_by_5

  !> Divide a long integer by 5, without the remainder.
  pure subroutine divide_by_5(number)
    integer(long), intent(inout) :: number(limbs)  !< long integer, least limb first
    integer(long) :: rest
    integer :: i

    rest = 0
    do i = limbs, 1, -1
      rest = ior(shiftl(rest, limb_bits), number(i))
      number(i) = rest/5
      rest = rest - 5*number(i)
    end do
  end subroutine divide_by_5

  !> The first 120 bits of a long integer (which has more than that), in two halves.
  pure subroutine leading_bits(number, high, low)
    integer(long), intent(in) :: number(limbs)  !< long integer, least limb first
    integer(long), intent(out) :: high          !< the first 60 bits
    integer(long), intent(out) :: low           !< the next 60 bits
    integer(long) :: aligned(4)
    integer :: top, bits, i

    top = limbs
    do while (number(top) == 0)
      top = top - 1
    end do
    bits = int(bit_size(number)) - leadz(number(top))
    do i = 1, 4
      aligned(i) = iand(ior(shiftl(number(top + 1 - i), limb_bits - bits), &
                            shiftr(number(top - i), bits)), limb_mask)
    end do
    high = ior(shiftl(aligned(1), limb_bits), aligned(2))
    low = ior(shiftl(aligned(3), limb_bits), aligned(4))
  end subroutine leading_bits

  !> Write a number into a field, at its right end: `-1.2345678901234567E+00`. A number that is not finite
  !> becomes `NaN`, `Infinity` or `-Infinity`.
  pure subroutine put(self, number, field)
    class(number_format_type), intent(in) :: self      !< the table of powers of ten
    real(wp), intent(in) :: number                     !< any number, also one that is not finite
    character(len=number_width), intent(out) :: field  !< the number as text, at the right end
    integer(long) :: bits, mantissa, digits
    integer :: binary_exponent, exponent, shift
    logical :: decided

    bits = transfer(number, bits)
    mantissa = ibits(bits, 0, 52)
    binary_exponent = int(ibits(bits, 52, 11))
    if (binary_exponent == 2047) then
      field = not_finite(mantissa /= 0, bits < 0)
      return
    else if (binary_exponent > 0) then
      mantissa = ibset(mantissa, 52)
      binary_exponent = binary_exponent - 1075
    else if (mantissa /= 0) then
      shift = leadz(mantissa) - 11
      mantissa = shiftl(mantissa, shift)
      binary_exponent = -1074 - shift
    else
      call put_digits(0_long, 0, bits < 0, field)
      return
    end if
    call find_digits(self, mantissa, binary_exponent, digits, exponent, decided)
    if (.not. decided) call read_digits(number, digits, exponent)
    call put_digits(digits, exponent, bits < 0, field)
  end subroutine put

  !> The text of a number that is not finite.
  pure function not_finite(is_nan, negative) result(field)
    logical, intent(in) :: is_nan    !< whether it is not a number
    logical, intent(in) :: negative  !< whether its sign bit is set
    character(len=number_width) :: field

    if (is_nan) then
      field = 'NaN'
    else if (negative) then
      field = '-Infinity'
    else
      field = 'Infinity'
    end if
    field = adjustr(field)
  end function not_finite

  !> The 17 digits of mantissa 2^binary_exponent, and the power of ten of the first of them.
  pure subroutine find_digits(self, mantissa, binary_exponent, digits, exponent, decided)
    type(number_format_type), intent(in) :: self  !< the table of powers of ten
    integer(long), intent(in) :: mantissa         !< the mantissa as an integer, from 2^52 to 2^53 - 1
    integer, intent(in) :: binary_exponent        !< power of 2 that multiplies the mantissa
    integer(long), intent(out) :: digits          !< the digits as an integer, from 10^16 to 10^17 - 1
    integer, intent(out) :: exponent              !< power of ten of the first digit
    logical, intent(out) :: decided               !< whether 120 bits decide the rounding
    integer(wide) :: product
    integer(long) :: fraction, half
    integer :: p, shift

    ! floor(log10(2) n), which is the exponent or one less
    exponent = shifta((binary_exponent + 52)*78913, 18)
    do
      p = 16 - exponent
      ! the true product lies in [product, product + 2), in units of the bits kept
      product = int(mantissa, wide)*int(self%high(p), wide) &
                + shiftr(int(mantissa, wide)*int(self%low(p), wide), half_bits)
      ! floor(log2(10) p) is the binary exponent of 10^p
      shift = half_bits - 1 - binary_exponent - shifta(p*1741647, 19)
      digits = int(shiftr(product, shift), long)
      if (digits < ten_to_17) exit
      exponent = exponent + 1
    end do
    fraction = int(ibits(product, 0, shift), long)
    half = shiftl(1_long, shift - 1)
    decided = .true.
    if (p >= 0 .and. p <= 24) then
      ! the product is exact, and a tie is possible only here: m 5^p, an odd number below
      ! 2 10^17, has no more factors 5; a tie is rounded to the even digit, as by every formatted write
      if (fraction > half .or. (fraction == half .and. btest(digits, 0))) digits = digits + 1
    else
      if (fraction >= half) digits = digits + 1
      decided = fraction /= half - 1
    end if
    if (digits == ten_to_17) then
      digits = ten_to_16
      exponent = exponent + 1
    end if
  end subroutine find_digits

  !> Find the digits by the compiler's formatted write, which is exact for every number but slow.
  pure subroutine read_digits(number, digits, exponent)
    real(wp), intent(in) :: number        !< a finite number other than zero
    integer(long), intent(out) :: digits  !< the 17 digits as an integer
    integer, intent(out) :: exponent      !< power of ten of the first digit
    character(len=24) :: text
    character(len=17) :: digits_text

    write (text, '(es24.16e3)') abs(number)
    digits_text = text(2:2)//text(4:19)
    read (digits_text, '(i17)') digits
    read (text(21:24), '(i4)') exponent
  end subroutine read_digits

  !> Write the digits into a field, with an exponent of two digits, or three where two are not enough.
  pure subroutine put_digits(digits, exponent, negative, field)
    integer(long), intent(in) :: digits                !< the 17 digits as an integer
    integer, intent(in) :: exponent                    !< power of ten of the first digit
    logical, intent(in) :: negative                    !< whether the number has a minus sign
    character(len=number_width), intent(out) :: field  !< the number as text, at the right end
    integer(long) :: first, upper, rest
    integer :: at, size

    size = abs(exponent)
    at = merge(3, 2, size < 100)
    first = digits/ten_to_16
    rest = digits - first*ten_to_16
    upper = rest/ten_to_8
    field(:at) = ''
    if (negative) field(at:at) = '-'
    field(at + 1:at + 1) = achar(48 + int(first))
    field(at + 2:at + 2) = '.'
    call put_8_digits(int(upper), field(at + 3:at + 10))
    call put_8_digits(int(rest - upper*ten_to_8), field(at + 11:at + 18))
    field(at + 19:at + 19) = 'E'
    field(at + 20:at + 20) = merge('-', '+', exponent < 0)
    if (at == 2) then
      field(23:23) = achar(48 + size/100)
      size = mod(size, 100)
    end if
    field(24:25) = pairs(2*size + 1:2*size + 2)
  end subroutine put_digits

  !> Write eight digits of a number.
  pure subroutine put_8_digits(number, text)
    integer, intent(in) :: number          !< from 0 to 99999999
    character(len=8), intent(out) :: text  !< its digits, with leading zeros
    integer :: upper, lower, a, c

    upper = number/10000
    lower = number - upper*10000
    a = upper/100
    c = lower/100
    text(1:2) = pairs(2*a + 1:2*a + 2)
    text(3:4) = pairs(2*(upper - 100*a) + 1:2*(upper - 100*a) + 2)
    text(5:6) = pairs(2*c + 1:2*c + 2)
    text(7:8) = pairs(2*(lower - 100*c) + 1:2*(lower - 100*c) + 2)
  end subroutine put_8_digits
end module mech9_number_format
