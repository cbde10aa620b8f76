!> gnuplot as a process, and text made harmless in its scripts. Uses error, text, printable,
!> child_process.
module mech9_gnuplot
  use mech9_error, only: error_type, raise, exit_file
  use mech9_text, only: string_type, to_text
  use mech9_printable, only: printable
  use mech9_child_process, only: child_outcome_type, run_child
  implicit none
  private
  public :: quoted, quoted_path, run_gnuplot, gnuplot_package

  !> What installs it, for messages.
  character(len=*), parameter :: gnuplot_package = 'gnuplot (Debian: apt-get install gnuplot-nox)'

contains

  !> Any text as a string of gnuplot. Between single quotes nothing has a meaning but the single quote;
  !> control characters, which could end the line, become blanks.
  pure function quoted(text) result(string)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: string
    character(len=len(text)) :: clean
    integer :: i

    clean = printable(text)
    string = ''''
    do i = 1, len(clean)
      string = string//clean(i:i)
      if (clean(i:i) == '''') string = string//''''
    end do
    string = string//''''
  end function quoted

  !> The name of a file as a string of gnuplot. A path that begins with a folder is only ever a file: `<`,
  !> `|`, `$`, `+` or `-` at the beginning mean other things. Bytes that cannot stand in a line are written
  !> as octal numbers, for which double quotes are needed, and hence for all that has a meaning there.
  pure function quoted_path(path) result(string)
    character(len=*), intent(in) :: path
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

  !> Let gnuplot carry out a script. Where it is not there, `found` is false; where it fails, the error
  !> says why.
  subroutine run_gnuplot(script, found, err, folder)
    character(len=*), intent(in) :: script
    logical, intent(out) :: found
    type(error_type), allocatable, intent(out) :: err
    character(len=*), intent(in), optional :: folder   !< where it works; here unless given
    type(child_outcome_type) :: outcome
    type(string_type) :: words(1)

    found = .false.
    words(1)%text = 'gnuplot'
    call run_child(words, script, outcome, err, folder)
    if (allocated(err)) return
    found = outcome%found
    if (found .and. outcome%code /= 0) &
      call raise(err, exit_file, 'gnuplot ended with '//to_text(outcome%code)//': '//trim(printable(outcome%said)))
  end subroutine run_gnuplot
end module mech9_gnuplot
