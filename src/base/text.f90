!> Small helpers for text: numbers as text, case, lists, nearest names. Uses mech9_kinds only.
module mech9_text
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: string_type, to_text, lower, join, nearest_name, starts_with

  !> One text of its own length, for arrays of texts.
  type :: string_type
    character(len=:), allocatable :: text
  end type string_type

  !> A number as text without surrounding blanks.
  interface to_text
    module procedure integer_to_text, long_to_text, real_to_text, integers_to_text
  end interface to_text

contains

  pure function integer_to_text(number) result(text)
    integer, intent(in) :: number
    character(len=:), allocatable :: text

    text = long_to_text(int(number, long))
  end function integer_to_text

  pure function long_to_text(number) result(text)
    integer(long), intent(in) :: number
    character(len=:), allocatable :: text
    character(len=24) :: buffer

    write (buffer, '(i0)') number
    text = trim(buffer)
  end function long_to_text

  !> A real number with as many significant digits as asked for (6 unless given), plain where
  !> that is readable: 0.25, 1200, 1.5E-07.
  pure function real_to_text(number, digits) result(text)
    real(wp), intent(in) :: number
    integer, intent(in), optional :: digits
    character(len=:), allocatable :: text
    character(len=48) :: buffer
    character(len=16) :: form
    integer :: n, last, exponent

    n = 6
    if (present(digits)) n = digits
    if (ieee_is_nan(number)) then
      text = 'NaN'
      return
    else if (abs(number) > huge(number)) then
      text = merge('Infinity ', '-Infinity', number > 0.0_wp)
      text = trim(text)
      return
    end if
    write (form, '(a,i0,a)') '(es48.', n - 1, 'e3)'
    write (buffer, form) number
    read (buffer(index(buffer, 'E') + 1:), *) exponent
    if (abs(number) <= 0.0_wp) then
      text = '0'
    else if (exponent >= -4 .and. exponent < max(n, 6)) then
      write (form, '(a,i0,a)') '(f48.', max(n - 1 - exponent, 0), ')'
      write (buffer, form) number
      text = trim(adjustl(buffer))
      if (index(text, '.') > 0) then
        last = verify(text, '0', back=.true.)
        if (text(last:last) == '.') last = last - 1
        text = text(:last)
      end if
    else
      last = index(buffer, 'E') - 1
      last = verify(buffer(:last), '0', back=.true.)
      if (buffer(last:last) == '.') last = last - 1
      text = trim(adjustl(buffer(:last)))//'e'//to_text(exponent)
    end if
    if (text(1:1) == '.') text = '0'//text
    if (starts_with(text, '-.')) text = '-0'//text(2:)
  end function real_to_text

  !> Integers separated by commas: "1, 2, 5".
  pure function integers_to_text(numbers, separator) result(text)
    integer, intent(in) :: numbers(:)
    character(len=*), intent(in), optional :: separator
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(numbers)
      if (i > 1) then
        if (present(separator)) then
          text = text//separator
        else
          text = text//', '
        end if
      end if
      text = text//integer_to_text(numbers(i))
    end do
  end function integers_to_text

  !> The text in lower case (ASCII letters only; other bytes stay).
  pure function lower(text) result(lowered)
    character(len=*), intent(in) :: text
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

  !> Whether a text has this beginning, blanks at its end included.
  pure logical function starts_with(text, beginning)
    character(len=*), intent(in) :: text, beginning

    starts_with = .false.
    if (len(text) >= len(beginning)) starts_with = text(:len(beginning)) == beginning
  end function starts_with

  !> Texts in one line, with a separator between them.
  pure function join(strings, separator) result(text)
    type(string_type), intent(in) :: strings(:)
    character(len=*), intent(in) :: separator
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(strings)
      if (i > 1) text = text//separator
      text = text//strings(i)%text
    end do
  end function join

  !> The name that was probably meant: the nearest of the known ones by single-letter edits and
  !> exchanges of neighbours; empty when none is near (more than a third of the letters differ).
  pure function nearest_name(word, known) result(name)
    character(len=*), intent(in) :: word
    character(len=*), intent(in) :: known(:)   !< blank-padded names
    character(len=:), allocatable :: name
    integer :: i, distance, best

    name = ''
    best = 1 + max(1, (len_trim(word) + 1)/3)
    do i = 1, size(known)
      distance = edit_distance(lower(trim(word)), lower(trim(known(i))))
      if (distance < best) then
        best = distance
        name = trim(known(i))
      end if
    end do
  end function nearest_name

  !> Fewest insertions, deletions, changes and exchanges of neighbours that turn a into b.
  pure integer function edit_distance(a, b) result(distance)
    character(len=*), intent(in) :: a, b
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
