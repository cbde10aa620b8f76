!> Text of any origin, cleaned for files that other programs read.
module mech9_printable
  implicit none
  private
  public :: printable, column_name, with_escapes, utf8_length

contains

  !> The text without bytes that could end or break a line or stop a reader: control characters
  !> become blanks, and bytes that are not UTF-8 become question marks. The length does not change.
  pure function printable(text) result(clean)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=len(text)) :: clean
    integer :: i, length

    clean = text
    i = 1
    do while (i <= len(text))
      length = utf8_length(text, i)
      if (length == 0) then
        clean(i:i) = '?'
      else if (is_control(text(i:i))) then
        clean(i:i) = ' '
      end if
      i = i + max(length, 1)
    end do
  end function printable

  !> The text as the name of a column: printable, and with underscores for blanks, quotes and `#`, which split
  !> names or end a line for readers of tables.
  pure function column_name(text) result(name)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=:), allocatable :: name
    integer :: i

    name = trim(printable(text))
    do i = 1, len(name)
      if (scan(name(i:i), ' "''#') > 0) name(i:i) = '_'
    end do
    if (name == '') name = '_'
  end function column_name

  !> Length of the text after some letters are replaced by escapes.
  pure integer function escaped_length(text, letters, escapes) result(length)
    character(len=*), intent(in) :: text        !< any bytes
    character(len=*), intent(in) :: letters     !< the letters that are replaced
    character(len=*), intent(in) :: escapes(:)  !< replacement of each of them, without trailing blanks
    integer :: i, k

    length = len(text)
    do i = 1, len(text)
      k = index(letters, text(i:i))
      if (k > 0) length = length + len_trim(escapes(k)) - 1
    end do
  end function escaped_length

  !> The text with escapes for the letters that have a special meaning in the file.
  pure function with_escapes(text, letters, escapes) result(safe)
    character(len=*), intent(in) :: text        !< any bytes
    character(len=*), intent(in) :: letters     !< the letters that are replaced
    character(len=*), intent(in) :: escapes(:)  !< replacement of each of them, padded with blanks
    character(len=:), allocatable :: safe
    integer :: i, k, n, length

    allocate (character(len=escaped_length(text, letters, escapes)) :: safe)
    n = 0
    do i = 1, len(text)
      k = index(letters, text(i:i))
      if (k == 0) then
        n = n + 1
        safe(n:n) = text(i:i)
      else
        length = len_trim(escapes(k))
        safe(n + 1:n + length) = escapes(k)
        n = n + length
      end if
    end do
  end function with_escapes

  !> Whether a byte is a control character.
  pure logical function is_control(letter)
    character, intent(in) :: letter  !< one byte

    is_control = iachar(letter) < 32 .or. iachar(letter) == 127
  end function is_control

  !> Number of bytes of the UTF-8 character that begins at a place; 0 where none does (a stray or missing
  !> continuation, an overlong form, a surrogate, or a number beyond the last one).
  pure integer function utf8_length(text, place) result(length)
    character(len=*), intent(in) :: text  !< any bytes
    integer, intent(in) :: place          !< number of the byte where the character may begin
    integer :: first, second, low, high, i

    first = ichar(text(place:place))
    ! the second byte reveals most of the wrong characters
    low = 128
    high = 191
    length = 0
    select case (first)
    case (0:127)
      length = 1
      return
    case (194:223)
      length = 2
    case (224:239)
      length = 3
      if (first == 224) low = 160
      if (first == 237) high = 159
    case (240:244)
      length = 4
      if (first == 240) low = 144
      if (first == 244) high = 143
    end select
    if (length == 0) return
    if (place + length - 1 > len(text)) then
      length = 0
      return
    end if
    second = ichar(text(place + 1:place + 1))
    if (second < low .or. second > high) then
      length = 0
      return
    end if
    do i = place + 2, place + length - 1
      if (ichar(text(i:i)) < 128 .or. ichar(text(i:i)) > 191) then
        length = 0
        return
      end if
    end do
  end function utf8_length
end module mech9_printable
