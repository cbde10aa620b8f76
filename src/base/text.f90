!> Text helpers for numbers, lower case, lists and nearest names.
!>
!> Functions here and wherever threads may meet have results of explicit length: gfortran keeps the length of
!> a result `character(len=:), allocatable` in a static variable of the caller, which threads would share.
module mech9_text
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: string_type, to_text, exact_digits, some_of, lower, join, texts_of_one_length, nearest_name, starts_with, &
            in_apostrophes

  integer, parameter :: longest_real = 48     !< characters of a real number

  !> A text of any length, for arrays of texts.
  type :: string_type
    character(len=:), allocatable :: text
  end type string_type

  !> A number as text without surrounding blanks.
  interface to_text
    module procedure integer_to_text, long_to_text, real_to_text, digits_to_text, integers_to_text, separated_integers
  end interface to_text

contains

  ! Lengths of results stand first: gfortran must see them before the functions whose results have them.

  !> Letters of an integer as text: its digits, and a minus sign if it has one.
  pure integer function integer_length(number) result(length)
    integer(long), intent(in) :: number   !< the number to be written
    integer(long) :: rest

    length = merge(2, 1, number < 0)
    rest = number/10
    do while (rest /= 0)
      length = length + 1
      rest = rest/10
    end do
  end function integer_length

  !> Letters of a real number as text.
  pure integer function real_length(number, digits) result(length)
    real(wp), intent(in) :: number   !< the number to be written
    integer, intent(in) :: digits    !< significant digits, 1 or more
    character(len=longest_real) :: buffer

    call write_real(number, digits, buffer)
    length = len_trim(buffer)
  end function real_length

  !> Letters of a text between apostrophes.
  pure integer function length_in_apostrophes(plain) result(length)
    character(len=*), intent(in) :: plain   !< the text
    integer :: i

    length = len(plain) + count([(plain(i:i) == '''', i=1, len(plain))]) + 2
  end function length_in_apostrophes

  !> Letters of a list of integers.
  pure integer function integers_length(numbers, separator) result(length)
    integer, intent(in) :: numbers(:)           !< integers in the order in which they are written
    character(len=*), intent(in) :: separator   !< stands between two neighbours
    integer :: i

    length = len(separator)*max(size(numbers) - 1, 0)
    do i = 1, size(numbers)
      length = length + integer_length(int(numbers(i), long))
    end do
  end function integers_length

  !> Letters of the beginning of a list of integers, with the number of those left out.
  pure integer function some_length(numbers, most) result(length)
    integer, intent(in) :: numbers(:)   !< integers in the order in which they are written
    integer, intent(in) :: most         !< so many are written

    length = integers_length(numbers(:min(size(numbers), most)), ', ')
    if (size(numbers) > most) &
      length = length + len(' and  more') + integer_length(int(size(numbers) - most, long))
  end function some_length

  !> Letters of texts in one line.
  pure integer function joined_length(strings, separator) result(length)
    type(string_type), intent(in) :: strings(:)   !< texts, all of them allocated
    character(len=*), intent(in) :: separator     !< stands between two neighbours
    integer :: i

    length = len(separator)*max(size(strings) - 1, 0)
    do i = 1, size(strings)
      length = length + len(strings(i)%text)
    end do
  end function joined_length

  !> Letters of the nearest name; 0 where none is near.
  pure integer function nearest_length(word, known) result(length)
    character(len=*), intent(in) :: word       !< the word that is not known
    character(len=*), intent(in) :: known(:)   !< blank-padded names
    integer :: place

    length = 0
    place = nearest_place(word, known)
    if (place > 0) length = len_trim(known(place))
  end function nearest_length

  !> A default integer.
  pure function integer_to_text(number) result(text)
    integer, intent(in) :: number   !< the number to be written
    character(len=integer_length(int(number, long))) :: text
    integer :: rest, digit, i

    ! digit by digit, which is ten times as fast as a formatted write
    rest = number
    do i = len(text), 1, -1
      digit = abs(mod(rest, 10))
      text(i:i) = achar(iachar('0') + digit)
      rest = rest/10
    end do
    if (number < 0) text(1:1) = '-'
  end function integer_to_text

  !> A long integer.
  pure function long_to_text(number) result(text)
    integer(long), intent(in) :: number   !< the number to be written
    character(len=integer_length(number)) :: text

    write (text, '(i0)') number
  end function long_to_text

  !> How many significant digits a real number needs as text, so that the same number is read from it: 15 to 17.
  pure integer function exact_digits(number) result(digits)
    real(wp), intent(in) :: number   !< the number to be written
    character(len=longest_real) :: buffer
    real(wp) :: again
    integer :: status

    do digits = 15, 16
      call write_real(number, digits, buffer)
      read (buffer, *, iostat=status) again
      if (status == 0 .and. .not. abs(again - number) > 0.0_wp) return
    end do
    digits = 17
  end function exact_digits

  !> A real number with six significant digits.
  pure function real_to_text(number) result(text)
    real(wp), intent(in) :: number   !< the number to be written
    character(len=real_length(number, 6)) :: text

    text = digits_to_text(number, 6)
  end function real_to_text

  !> A real number with a given number of significant digits.
  pure function digits_to_text(number, digits) result(text)
    real(wp), intent(in) :: number   !< the number to be written
    integer, intent(in) :: digits    !< significant digits, 1 or more
    character(len=real_length(number, digits)) :: text
    character(len=longest_real) :: buffer

    call write_real(number, digits, buffer)
    text = buffer
  end function digits_to_text

  !> A real number without an exponent where that is readable, padded with blanks: 0.25, 1200, 1.5e-7.
  pure subroutine write_real(number, digits, text)
    real(wp), intent(in) :: number                     !< the number to be written
    integer, intent(in) :: digits                      !< significant digits, 1 or more
    character(len=longest_real), intent(out) :: text   !< the number, followed by blanks
    character(len=longest_real) :: buffer
    character(len=16) :: form
    integer :: exponent

    if (ieee_is_nan(number)) then
      text = 'NaN'
      return
    else if (abs(number) > huge(number)) then
      text = merge('Infinity ', '-Infinity', number > 0.0_wp)
      return
    else if (abs(number) <= 0.0_wp) then
      text = '0'
      return
    end if
    write (form, '(a,i0,a)') '(es48.', digits - 1, 'e3)'
    write (buffer, form) number
    read (buffer(index(buffer, 'E') + 1:), *) exponent
    if (exponent >= -4 .and. exponent < max(digits, 6)) then
      write (form, '(a,i0,a)') '(f48.', max(digits - 1 - exponent, 0), ')'
      write (buffer, form) number
      text = adjustl(buffer)
      if (index(text, '.') > 0) text = without_zeros(trim(text))
    else
      text = adjustl(buffer(:index(buffer, 'E') - 1))
      text = trim(without_zeros(trim(text)))//'e'//to_text(exponent)
    end if
    if (text(1:1) == '.') text = '0'//trim(text)
    if (starts_with(text, '-.')) text = '-0'//trim(text(2:))
  end subroutine write_real

  !> A decimal number without the zeros at its end, padded with blanks.
  pure function without_zeros(number) result(text)
    character(len=*), intent(in) :: number   !< a decimal number with a point, without blanks
    character(len=len(number)) :: text
    integer :: last

    last = verify(number, '0', back=.true.)
    if (number(last:last) == '.') last = last - 1
    text = number(:last)
  end function without_zeros

  !> Integers separated by commas: "1, 2, 5".
  pure function integers_to_text(numbers) result(text)
    integer, intent(in) :: numbers(:)   !< integers in the order in which they are written
    character(len=integers_length(numbers, ', ')) :: text

    text = separated_integers(numbers, ', ')
  end function integers_to_text

  !> Integers with a separator between them.
  pure function separated_integers(numbers, separator) result(text)
    integer, intent(in) :: numbers(:)           !< integers in the order in which they are written
    character(len=*), intent(in) :: separator   !< stands between two neighbours
    character(len=integers_length(numbers, separator)) :: text
    integer :: i, n, next

    n = 0
    do i = 1, size(numbers)
      if (i > 1) then
        text(n + 1:n + len(separator)) = separator
        n = n + len(separator)
      end if
      next = n + integer_length(int(numbers(i), long))
      write (text(n + 1:next), '(i0)') numbers(i)
      n = next
    end do
  end function separated_integers

  !> Integers separated by commas, "1, 2, 5"; only the beginning of a long list, "1, 2, 3 and 12 more".
  pure function some_of(numbers, most) result(text)
    integer, intent(in) :: numbers(:)   !< integers in the order in which they are written
    integer, intent(in) :: most         !< so many are written
    character(len=some_length(numbers, most)) :: text

    text = to_text(numbers(:min(size(numbers), most)))
    if (size(numbers) > most) text = trim(text)//' and '//to_text(size(numbers) - most)//' more'
  end function some_of

  !> The text in lower case (ASCII letters only; other bytes stay).
  pure function lower(text) result(lowered)
    character(len=*), intent(in) :: text   !< any text
    character(len=len(text)) :: lowered
    integer :: i

    do i = 1, len(text)
      select case (text(i:i))
      case ('A':'Z')
        lowered(i:i) = achar(iachar(text(i:i)) + 32)
      case default
        lowered(i:i) = text(i:i)
      end select
    end do
  end function lower

  !> A text between apostrophes, as in data files and Fortran: those within it stand twice.
  pure function in_apostrophes(plain) result(text)
    character(len=*), intent(in) :: plain   !< the text
    character(len=length_in_apostrophes(plain)) :: text
    integer :: i, n

    n = 1
    text(1:1) = ''''
    do i = 1, len(plain)
      n = n + 1
      text(n:n) = plain(i:i)
      if (plain(i:i) == '''') then
        n = n + 1
        text(n:n) = ''''
      end if
    end do
    text(n + 1:) = ''''
  end function in_apostrophes

  !> Whether a text has this beginning, blanks at its end included.
  pure logical function starts_with(text, beginning)
    character(len=*), intent(in) :: text        !< any text
    character(len=*), intent(in) :: beginning   !< the beginning, with all its blanks

    starts_with = .false.
    if (len(text) >= len(beginning)) starts_with = text(:len(beginning)) == beginning
  end function starts_with

  !> Texts in one line, with a separator between them.
  pure function join(strings, separator) result(text)
    type(string_type), intent(in) :: strings(:)   !< texts, all of them allocated
    character(len=*), intent(in) :: separator     !< stands between two neighbours
    character(len=joined_length(strings, separator)) :: text
    integer :: i, n

    n = 0
    do i = 1, size(strings)
      if (i > 1) then
        text(n + 1:n + len(separator)) = separator
        n = n + len(separator)
      end if
      text(n + 1:n + len(strings(i)%text)) = strings(i)%text
      n = n + len(strings(i)%text)
    end do
  end function join

  !> Pad texts with blanks to the length of the longest.
  pure subroutine texts_of_one_length(texts, array)
    type(string_type), intent(in) :: texts(:)                   !< the texts, all of them allocated
    character(len=:), allocatable, intent(out) :: array(:)      !< (texts)
    integer :: i, longest

    longest = 0
    do i = 1, size(texts)
      longest = max(longest, len(texts(i)%text))
    end do
    allocate (character(len=longest) :: array(size(texts)))
    do i = 1, size(texts)
      array(i) = texts(i)%text
    end do
  end subroutine texts_of_one_length

  !> The name that was probably meant: the known name that the fewest single-letter edits and exchanges of
  !> neighbours lead to; empty where none is near (more than a third of the letters differ).
  pure function nearest_name(word, known) result(name)
    character(len=*), intent(in) :: word       !< the word that is not known
    character(len=*), intent(in) :: known(:)   !< blank-padded names
    character(len=nearest_length(word, known)) :: name

    name = ''
    if (len(name) > 0) name = known(nearest_place(word, known))
  end function nearest_name

  !> Number of the nearest name among the known ones; 0 where none is near.
  pure integer function nearest_place(word, known) result(place)
    character(len=*), intent(in) :: word       !< the word that is not known
    character(len=*), intent(in) :: known(:)   !< blank-padded names
    integer :: i, distance, best

    place = 0
    best = 1 + max(1, (len_trim(word) + 1)/3)
    do i = 1, size(known)
      distance = edit_distance(lower(trim(word)), lower(trim(known(i))))
      if (distance < best) then
        best = distance
        place = i
      end if
    end do
  end function nearest_place

  !> The least number of insertions, deletions, changes and exchanges of neighbours that turn a into b.
  pure integer function edit_distance(a, b) result(distance)
    character(len=*), intent(in) :: a   !< one word, upper and lower case different
    character(len=*), intent(in) :: b   !< the other word
    integer :: d(-1:len(a), -1:len(b)), i, j, change

    do i = 0, len(a)
      d(i, 0) = i
    end do
    do j = 0, len(b)
      d(0, j) = j
    end do
    do j = 1, len(b)
      do i = 1, len(a)
        change = merge(0, 1, a(i:i) == b(j:j))
        d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + change)
        if (i > 1 .and. j > 1) then
          if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) &
            d(i, j) = min(d(i, j), d(i - 2, j - 2) + 1)
        end if
      end do
    end do
    distance = d(len(a), len(b))
  end function edit_distance
end module mech9_text
