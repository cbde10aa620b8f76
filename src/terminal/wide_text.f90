!> Conversion of text between UTF-8 bytes and the code points that a line editor uses.
module mech9_wide_text
  use mech9_printable, only: utf8_length
  implicit none
  private
  public :: to_wide, to_bytes, code_point, unknown_character

  !> U+FFFD, which replaces bytes that form no character.
  integer, parameter :: unknown_character = int(z'FFFD')

contains

  !> The code points of a text with a zero at the end, the form of strings in C.
  pure function to_wide(text) result(points)
    character(len=*), intent(in) :: text  !< a text in UTF-8
    integer, allocatable :: points(:)
    integer :: i, n, length

    allocate (points(len(text) + 1), source=0)
    n = 0
    i = 1
    do while (i <= len(text))
      length = utf8_length(text, i)
      n = n + 1
      points(n) = code_point(text(i:i + max(length, 1) - 1))
      i = i + max(length, 1)
    end do
    points = points(:n + 1)
  end function to_wide

  !> The code point of one UTF-8 character; unknown_character where the bytes are none.
  pure integer function code_point(bytes) result(point)
    character(len=*), intent(in) :: bytes  !< the bytes of one character
    integer :: i

    point = unknown_character
    if (len(bytes) == 0) return
    if (utf8_length(bytes, 1) /= len(bytes)) return
    point = ichar(bytes(1:1))
    ! the first byte of two, three, four has five, four, three bits of the number
    if (len(bytes) > 1) point = iand(point, 2**(7 - len(bytes)) - 1)
    do i = 2, len(bytes)
      point = 64*point + iand(ichar(bytes(i:i)), 63)
    end do
  end function code_point

  !> Code points as UTF-8.
  pure function to_bytes(points) result(text)
    integer, intent(in) :: points(:)  !< code points, without a zero at the end
    character(len=:), allocatable :: text
    character(len=4*size(points)) :: buffer
    integer :: i, used, length, k

    used = 0
    do i = 1, size(points)
      length = bytes_of(points(i))
      do k = length, 2, -1
        buffer(used + k:used + k) = char(128 + iand(ishft(points(i), -6*(length - k)), 63))
      end do
      if (length == 1) then
        buffer(used + 1:used + 1) = char(iand(points(i), 127))
      else
        ! the first byte begins with as many one bits as there are bytes
        buffer(used + 1:used + 1) = char(256 - 2**(8 - length) + ishft(points(i), -6*(length - 1)))
      end if
      used = used + length
    end do
    text = buffer(:used)
  end function to_bytes

  !> Number of bytes of a code point in UTF-8.
  pure integer function bytes_of(point)
    integer, intent(in) :: point  !< a code point

    select case (point)
    case (128:2047)
      bytes_of = 2
    case (2048:65535)
      bytes_of = 3
    case (65536:1114111)
      bytes_of = 4
    case default
      bytes_of = 1
    end select
  end function bytes_of
end module mech9_wide_text
