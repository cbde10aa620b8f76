!> The text of an input, with the places at which its lines begin.
!>
!> Every value that is read keeps its span of the text, so that a message can point there.
module mech9_source
  use mech9_error, only: error_type, place_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_file_bytes, only: read_bytes
  implicit none
  private
  public :: source_type, span_type, read_source, source_from_text

  !> Bytes first..last of one of several sources; source 0 means no place at all.
  type :: span_type
    integer :: source = 0
    integer :: first = 0
    integer :: last = 0
  end type span_type

  type :: source_type
    character(len=:), allocatable :: name  !< a path as the user wrote it, or '--set'
    character(len=:), allocatable :: text  !< without a byte order mark
    integer, allocatable :: line_start(:)  !< first byte of each line
    logical :: is_file = .true.            !< false: a text without lines for the user, such as --set
    logical :: is_ascii = .true.           !< every byte is a character
  contains
    procedure :: place
    procedure :: line_bounds
    procedure :: byte_at
  end type source_type

  character(len=*), parameter :: line_feed = achar(10), carriage_return = achar(13)

contains

  !> Read a whole file, or a pipe. Fails with exit_file where it cannot be read, and with exit_data
  !> where it is empty, not a text, or XML.
  subroutine read_source(path, source, err)
    character(len=*), intent(in) :: path               !< path of the file or pipe
    type(source_type), intent(out) :: source           !< its text with the places of the lines
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: text

    call read_bytes(path, text, err)
    if (.not. allocated(err)) call refuse_no_text(text, err)
    if (allocated(err)) then
      source = source_from_text(path, '')
      return
    end if
    if (len(text) >= 3) then
      if (text(:3) == char(239)//char(187)//char(191)) text = text(4:)   ! the byte order mark of UTF-8
    end if
    source = source_from_text(path, text)
    if (begins_as_xml(text)) call raise(err, exit_data, 'this is XML, not a data file; --import makes a data file of a robot '// &
                                        'in URDF, MJCF or SDF: --import FILE --out NEW.nml')
  end subroutine read_source

  !> Whether the first thing in a text is an element, a declaration or a comment of XML.
  pure logical function begins_as_xml(text)
    character(len=*), intent(in) :: text  !< the whole text
    integer :: at

    at = verify(text, ' '//achar(9)//line_feed//carriage_return)
    begins_as_xml = .false.
    if (at > 0 .and. at < len(text)) &
      begins_as_xml = text(at:at) == '<' .and. scan(text(at + 1:at + 1), '?!abcdefghijklmnopqrstuvwxyz') == 1
  end function begins_as_xml

  !> A source made from a text.
  pure function source_from_text(name, text, is_file) result(source)
    character(len=*), intent(in) :: name      !< path of the file, or '--set'
    character(len=*), intent(in) :: text      !< the whole text
    logical, intent(in), optional :: is_file  !< whether lines and columns are shown to the user; true if absent
    type(source_type) :: source

    source%name = name
    source%text = text
    if (present(is_file)) source%is_file = is_file
    source%is_ascii = all_ascii(text)
    call find_lines(source)
  end function source_from_text

  !> Fail where the bytes are not a text that could be a data file.
  pure subroutine refuse_no_text(text, err)
    character(len=*), intent(in) :: text               !< the whole text
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: at

    if (len(text) == 0) then
      call raise(err, exit_data, 'the whole file is empty')
      return
    end if
    if (len(text) >= 2) then
      if (text(:2) == char(255)//char(254) .or. text(:2) == char(254)//char(255)) then
        call raise(err, exit_data, 'the whole file is written in UTF-16; save it as UTF-8 or plain text')
        return
      end if
    end if
    at = index(text, achar(0))
    if (at > 0) call raise(err, exit_data, 'this is a binary file, not a text (its byte '//to_text(at)//' is zero)')
  end subroutine refuse_no_text

  !> Find the beginnings of the lines, which end with LF, CR LF or CR alone.
  pure subroutine find_lines(self)
    type(source_type), intent(inout) :: self  !< the source
    integer :: i, n, pass

    do pass = 1, 2
      n = 1
      if (pass == 2) self%line_start(1) = 1
      do i = 1, len(self%text)
        if (.not. ends_line(self%text, i)) cycle
        n = n + 1
        if (pass == 2) self%line_start(n) = i + 1
      end do
      if (pass == 1) allocate (self%line_start(n))
    end do
  end subroutine find_lines

  !> Whether a byte is the last one of a line end.
  pure logical function ends_line(text, i)
    character(len=*), intent(in) :: text  !< the whole text
    integer, intent(in) :: i              !< number of a byte

    ends_line = text(i:i) == line_feed
    if (text(i:i) == carriage_return) then
      ends_line = .true.
      if (i < len(text)) ends_line = text(i + 1:i + 1) /= line_feed
    end if
  end function ends_line

  !> Line of a byte, and its column counted in characters (a UTF-8 character counts once).
  pure type(place_type) function place(self, byte)
    class(source_type), intent(in) :: self  !< the source
    integer, intent(in) :: byte             !< number of a byte; it may be one beyond the end
    integer :: low, high, middle, i

    low = 1
    high = size(self%line_start)
    do while (low < high)
      middle = (low + high + 1)/2
      if (self%line_start(middle) <= byte) then
        low = middle
      else
        high = middle - 1
      end if
    end do
    place%line = low
    place%column = 1 + byte - self%line_start(low)
    if (self%is_ascii) return
    place%column = 1
    do i = self%line_start(low), min(byte, len(self%text) + 1) - 1
      if (.not. continues_character(self%text(i:i))) place%column = place%column + 1
    end do
    if (byte <= len(self%text)) then
      if (continues_character(self%text(byte:byte))) place%column = max(place%column - 1, 1)
    end if
  end function place

  !> First and last byte of a line, without its end; first > last where it is empty.
  pure subroutine line_bounds(self, line, first, last)
    class(source_type), intent(in) :: self  !< the source
    integer, intent(in) :: line             !< number of the line, from 1
    integer, intent(out) :: first           !< number of its first byte
    integer, intent(out) :: last            !< number of its last byte before the line end

    first = self%line_start(line)
    last = len(self%text)
    if (line < size(self%line_start)) last = self%line_start(line + 1) - 1
    do while (last >= first)
      if (scan(self%text(last:last), line_feed//carriage_return) == 0) exit
      last = last - 1
    end do
  end subroutine line_bounds

  !> The byte of a place; 0 where the text has no such place.
  pure integer function byte_at(self, position) result(byte)
    class(source_type), intent(in) :: self    !< the source
    type(place_type), intent(in) :: position  !< line and column, both from 1; columns count characters
    integer :: first, last, column

    byte = 0
    if (position%line < 1 .or. position%line > size(self%line_start)) return
    call self%line_bounds(position%line, first, last)
    column = 0
    do byte = first, last
      if (.not. continues_character(self%text(byte:byte))) column = column + 1
      if (column >= position%column) return
    end do
  end function byte_at

  !> Whether all bytes of a text are ASCII characters.
  pure logical function all_ascii(text)
    character(len=*), intent(in) :: text  !< the whole text
    integer :: i

    all_ascii = .false.
    do i = 1, len(text)
      if (iachar(text(i:i)) > 127) return
    end do
    all_ascii = .true.
  end function all_ascii

  !> Whether a byte is not the first of a UTF-8 character.
  pure logical function continues_character(byte)
    character, intent(in) :: byte  !< one byte of a text in UTF-8

    continues_character = iachar(byte) >= 128 .and. iachar(byte) < 192
  end function continues_character
end module mech9_source
