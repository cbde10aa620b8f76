!> The title of a mechanism in as many lines as a picture has room for.
module mech9_title_lines
  use mech9_text, only: string_type
  use mech9_printable, only: printable, utf8_length
  implicit none
  private
  public :: title_lines, letters_of

  !> An ellipsis in UTF-8, which stands where a title goes on but there is no more room.
  character(len=*), parameter :: more = char(226)//char(128)//char(166)

contains

  !> A title in lines, broken at blanks, or within words that are longer than a line. If it takes more lines than allowed,
  !> the last line ends with an ellipsis.
  pure function title_lines(title, room, most) result(lines)
    character(len=*), intent(in) :: title       !< title of the mechanism, any bytes
    integer, intent(in) :: room                 !< largest number of letters in a line, at least two
    integer, intent(in) :: most                 !< largest number of lines, at least one
    type(string_type), allocatable :: lines(:)  !< lines of printable text; at least one, which can be empty
    type(string_type) :: found(most)
    character(len=:), allocatable :: left
    integer :: n, last

    left = trim(adjustl(printable(title)))
    do n = 1, most
      if (n == most .and. letters_of(left) > room) then
        last = bytes_of(left, room - 1)
        found(n)%text = trim(left(:last))//more
        exit
      end if
      last = end_of_line(left, room)
      found(n)%text = trim(left(:last))
      left = trim(adjustl(left(last + 1:)))
      if (left == '') exit
    end do
    lines = found(:min(n, most))
  end function title_lines

  !> The number of the last byte of the first line of a text.
  pure integer function end_of_line(text, room) result(last)
    character(len=*), intent(in) :: text  !< text that is left, in UTF-8
    integer, intent(in) :: room           !< largest number of letters in a line
    integer :: blank

    last = bytes_of(text, room)
    if (last == len(text)) return
    if (text(last + 1:last + 1) == ' ') return
    blank = index(text(:last), ' ', back=.true.)
    if (blank > 1) last = blank
  end function end_of_line

  !> The width of a text, in letters of the usual width.
  pure integer function letters_of(text) result(letters)
    character(len=*), intent(in) :: text  !< in UTF-8
    integer :: i, halves

    halves = 0
    i = 1
    do while (i <= len(text))
      halves = halves + halves_of(text, i)
      i = i + max(1, utf8_length(text, i))
    end do
    letters = (halves + 1)/2
  end function letters_of

  !> The number of bytes of a text that fit into a number of letters. They are whole characters, at least one.
  pure integer function bytes_of(text, letters) result(bytes)
    character(len=*), intent(in) :: text  !< in UTF-8
    integer, intent(in) :: letters        !< largest number of letters
    integer :: halves

    bytes = 0
    halves = 0
    do while (bytes < len(text))
      halves = halves + halves_of(text, bytes + 1)
      if (halves > 2*letters .and. bytes > 0) return
      bytes = bytes + max(1, utf8_length(text, bytes + 1))
    end do
  end function bytes_of

  !> The width of the character at a place, in halves of a small letter. Characters of three or more bytes, among them
  !> letters of East Asia and pictures, are two letters wide.
  pure integer function halves_of(text, place) result(halves)
    character(len=*), intent(in) :: text  !< in UTF-8
    integer, intent(in) :: place          !< place of the first byte of the character

    halves = 2
    if (index('fijlrtI''"|.,:;!()[]- ', text(place:place)) > 0) halves = 1
    if (index('ABCDEFGHKLNOPQRSTUVXYZw&', text(place:place)) > 0) halves = 3
    if (index('MWm%@', text(place:place)) > 0) halves = 4
    if (utf8_length(text, place) > 2) halves = 4
  end function halves_of
end module mech9_title_lines
