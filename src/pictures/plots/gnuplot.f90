!> The run of gnuplot as a child process, and texts in a form that is harmless in its scripts.
module mech9_gnuplot
  use, intrinsic :: iso_fortran_env, only: int64
  use mech9_error, only: error_type, raise, exit_file
  use mech9_text, only: string_type, to_text
  use mech9_path, only: ending_of
  use mech9_text_file, only: text_file_type
  use mech9_printable, only: printable, with_escapes
  use mech9_child_process, only: child_outcome_type, run_child
  implicit none
  private
  public :: quoted, quoted_lines, quoted_path, run_gnuplot, gnuplot_package

  !> The name of gnuplot and of its package, for messages.
  character(len=*), parameter :: gnuplot_package = 'gnuplot (Debian: apt-get install gnuplot-nox)'
  !> The number of bytes at the end of a picture that hold its last mark, and line ends or a check sum behind it.
  integer, parameter :: longest_end = 12
  !> The trailer of a GIF, which is its last byte.
  character(len=*), parameter :: gif_end = ';'

contains

  !> Any text as a string of gnuplot. Between single quotes only the single quote has a meaning. A text that holds one
  !> stands between double quotes, and letters with a meaning there are written as octal numbers. Doubled single quotes
  !> are no remedy: gnuplot does not take them at the beginning of a string, and not four of them. Control characters,
  !> which could end the line, become blanks.
  pure function quoted(text) result(string)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=:), allocatable :: string

    if (index(text, '''') == 0) then
      string = ''''//printable(text)//''''
    else
      string = '"'//escaped(text)//'"'
    end if
  end function quoted

  !> Several lines as one string of gnuplot.
  pure function quoted_lines(lines) result(string)
    type(string_type), intent(in) :: lines(:)  !< lines of any bytes, at least one
    character(len=:), allocatable :: string
    integer :: i

    string = quoted(lines(1)%text)
    if (size(lines) == 1) return
    string = escaped(lines(1)%text)
    do i = 2, size(lines)
      string = string//'\n'//escaped(lines(i)%text)
    end do
    string = '"'//string//'"'
  end function quoted_lines

  !> Any text as it stands between double quotes.
  pure function escaped(text) result(safe)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=:), allocatable :: safe

    safe = with_escapes(printable(text), '"\`', ['\042', '\134', '\140'])
  end function escaped

  !> The name of a file as a string of gnuplot. A path that begins with a folder always means a file, while `<`, `|`, `$`,
  !> `+` or `-` at the beginning have other meanings. Bytes that cannot stand in a line are written as octal numbers
  !> between double quotes, and so are letters that have a meaning there.
  pure function quoted_path(path) result(string)
    character(len=*), intent(in) :: path  !< name of the file
    character(len=:), allocatable :: string, place
    character(len=3) :: octal
    integer :: i

    place = path
    if (path(1:min(1, len(path))) /= '/') place = './'//path
    if (printable(place) == place) then
      string = quoted(place)
      return
    end if
    string = '"'
    do i = 1, len(place)
      if (scan(place(i:i), '"\`@$%') > 0 .or. ichar(place(i:i)) < 32 .or. ichar(place(i:i)) > 126) then
        write (octal, '(o3.3)') ichar(place(i:i))
        string = string//'\'//octal
      else
        string = string//place(i:i)
      end if
    end do
    string = string//'"'
  end function quoted_path

  !> Let gnuplot carry out a script. If gnuplot is not installed `found` is false; if it fails, the error gives the
  !> reason. If gnuplot cannot open the picture it draws on standard output, and with `picture` this output is dropped.
  subroutine run_gnuplot(script, found, err, folder, picture)
    character(len=*), intent(in) :: script             !< commands of gnuplot
    logical, intent(out) :: found                      !< gnuplot is there
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=*), intent(in), optional :: folder   !< folder in which gnuplot works; the current one unless given
    character(len=*), intent(in), optional :: picture  !< file that the script makes, from the current folder
    type(child_outcome_type) :: outcome
    type(string_type) :: words(1)

    found = .false.
    words(1)%text = 'gnuplot'
    call run_child(words, script, outcome, err, folder, drop_output=present(picture))
    if (allocated(err)) return
    found = outcome%found
    if (.not. found) return
    if (present(picture)) call check_picture(picture, outcome%code /= 0, err)
    if (outcome%code /= 0 .and. .not. allocated(err)) &
      call raise(err, exit_file, 'gnuplot ended with '//to_text(outcome%code)//': '//trim(printable(outcome%error_output)))
  end subroutine run_gnuplot

  !> Check that a picture can be written and was written to its end, since gnuplot does not notice that a disk is full.
  !> Otherwise there is an error.
  subroutine check_picture(path, failed, err)
    character(len=*), intent(in) :: path               !< file of the picture
    logical, intent(in) :: failed                      !< gnuplot ended with an error, so that only the reason is sought
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(text_file_type) :: file
    character(len=longest_end) :: last
    logical :: whole

    if (failed) then
      ! the words of the system for a file that cannot be opened are plainer than those of gnuplot
      call file%open(path, err)
      if (.not. allocated(err)) call file%close(err)
      return
    end if
    call read_end(path, last)
    select case (ending_of(path))
    case ('svg')
      whole = index(last, '</svg>') > 0
    case ('pdf')
      whole = index(last, '%%EOF') > 0
    case ('png')
      whole = index(last, 'IEND') > 0
    case default
      whole = last(longest_end:) == gif_end
    end select
    if (.not. whole) call raise(err, exit_file, 'the picture could not be written to its end; is the disk full?')
  end subroutine check_picture

  !> Read the last bytes of a file; they are blanks for a file without enough bytes, such as a device.
  subroutine read_end(path, last)
    character(len=*), intent(in) :: path             !< name of the file
    character(len=longest_end), intent(out) :: last  !< last bytes of the file, or blanks
    character(len=longest_end) :: bytes
    integer(int64) :: length
    integer :: unit, status

    last = ''
    inquire (file=path, size=length)
    if (length < longest_end) return
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=status)
    if (status /= 0) return
    read (unit, pos=length - longest_end + 1, iostat=status) bytes
    close (unit)
    if (status == 0) last = bytes
  end subroutine read_end
end module mech9_gnuplot
