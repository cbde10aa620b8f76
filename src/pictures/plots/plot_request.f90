!> The request for a plot: the argument of --plot, read against the columns of the results.
!>
!>     [TARGET:][section:]NAME,NAME:NAME,NAME,...
!>
!> Of a pair of names the second is drawn over the first, and so are the single names behind it, up to the next pair. Single names
!> before all pairs are drawn over time. TARGET is the file of the picture (.svg, .png or .pdf), or `term` for the terminal.
!> Without names the coordinates are drawn. With `section`, names are columns of the section, and single names are drawn over the number
!> of the point.
module mech9_plot_request
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, nearest_name
  use mech9_path, only: ending_of
  implicit none
  private
  public :: plot_request_type, curve_type, read_plot_request, target_of_plot, is_picture, is_of_section, take_target, take_name

  !> One curve: the numbers of its two columns.
  type :: curve_type
    integer :: x = 1, y = 1
  end type curve_type

  type :: plot_request_type
    character(len=:), allocatable :: target     !< file of the picture; empty: to be chosen
    logical :: in_terminal = .false.
    logical :: of_section = .false.             !< points of the section are drawn in place of the motion
    type(curve_type), allocatable :: curves(:)
  end type plot_request_type

  !> The largest number of curves that are drawn if no name is given: the number of colours.
  integer, parameter :: most_curves = 7
  !> The largest number of names that a message lists.
  integer, parameter :: most_names = 40
  !> The number of letters of a name that are compared when the nearest name is looked for.
  integer, parameter :: longest_name = 64
  character(len=*), parameter :: terminal = 'term'
  !> The word for points of the section.
  character(len=*), parameter :: section = 'section'

contains

  !> Read a request. An unknown name is an error of the command line (exit_usage).
  pure subroutine read_plot_request(text, names, request, err)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(string_type), intent(in) :: names(:)          !< names of the columns of the results, the time first
    type(plot_request_type), intent(out) :: request    !< request for the plot
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(curve_type) :: curve
    integer :: at

    call take_target(text, request, at)
    request%of_section = is_of_section(text)
    if (request%of_section) at = at + len(section) + 1
    allocate (request%curves(0))
    if (at > len(text)) then
      call take_coordinates(names, request)
      return
    end if
    do
      call take_curve(text, names, at, curve, err)
      if (allocated(err)) return
      request%curves = [request%curves, curve]
      if (at > len(text)) return
      if (text(at:at) /= ',') then
        call raise(err, exit_usage, "--plot: a comma is missing before '"//text(at:)//"'")
        return
      end if
      at = at + 1
    end do
  end subroutine read_plot_request

  !> Whether a request is for the points of the section.
  pure logical function is_of_section(text)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(plot_request_type) :: request
    integer :: at

    call take_target(text, request, at)
    is_of_section = text(min(at, len(text) + 1):) == section
    if (len(text) >= at + len(section)) is_of_section = is_of_section .or. text(at:at + len(section)) == section//':'
  end function is_of_section

  !> Find the place where a plot is to be drawn: the file of a picture, '-' for the terminal, or empty if nothing is
  !> said.
  pure subroutine target_of_plot(text, target)
    character(len=*), intent(in) :: text                  !< the argument of --plot
    character(len=:), allocatable, intent(out) :: target  !< file of the picture; '-': the terminal; empty: not said
    type(plot_request_type) :: request
    integer :: at

    call take_target(text, request, at)
    target = request%target
    if (request%in_terminal) target = '-'
  end subroutine target_of_plot

  !> Whether a file of this name can be a picture that gnuplot makes.
  pure logical function is_picture(path)
    character(len=*), intent(in) :: path  !< name of the file

    select case (ending_of(path))
    case ('svg', 'png', 'pdf')
      is_picture = .true.
    case default
      is_picture = .false.
    end select
  end function is_picture

  !> Read the target before the names: a picture or the terminal. `at` is the place where the names begin.
  pure subroutine take_target(text, request, at)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(plot_request_type), intent(inout) :: request  !< request for the plot
    integer, intent(out) :: at                         !< place in `text` where the names begin
    integer :: colon

    request%target = ''
    at = 1
    do colon = 1, len(text) + 1
      if (colon <= len(text)) then
        if (text(colon:colon) /= ':') cycle
      end if
      if (text(:colon - 1) == terminal) then
        request%in_terminal = .true.
      else if (is_picture(text(:colon - 1))) then
        request%target = text(:colon - 1)
      else
        cycle
      end if
      at = colon + 1
      return
    end do
  end subroutine take_target

  !> Request the coordinates q1, q2 and so on, up to the number of colours.
  pure subroutine take_coordinates(names, request)
    type(string_type), intent(in) :: names(:)          !< names of the columns of the results, the time first
    type(plot_request_type), intent(inout) :: request  !< request for the plot
    integer :: i

    do i = 1, size(names)
      if (size(request%curves) == most_curves) exit
      if (len(names(i)%text) < 2) cycle
      if (names(i)%text(1:1) == 'q' .and. verify(names(i)%text(2:), '0123456789') == 0) &
        request%curves = [request%curves, curve_type(x=1, y=i)]
    end do
  end subroutine take_coordinates

  !> Read a curve, written as NAME or NAME:NAME, and move `at` behind it. A single name is drawn over the column of the
  !> curve before it.
  pure subroutine take_curve(text, names, at, curve, err)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(string_type), intent(in) :: names(:)          !< names of the columns of the results, the time first
    integer, intent(inout) :: at                       !< place in `text` where the curve begins; afterwards the place behind it
    type(curve_type), intent(inout) :: curve           !< numbers of the two columns; before, those of the curve before it
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    call take_name(text, names, at, curve%y, err)
    if (allocated(err) .or. text(at:min(at, len(text))) /= ':') return
    at = at + 1
    curve%x = curve%y
    call take_name(text, names, at, curve%y, err)
  end subroutine take_curve

  !> Read the name that begins at a place, and move `at` behind it. Names may hold commas and colons: the longest name
  !> that fits and ends where an item can end is taken.
  pure subroutine take_name(text, names, at, column, err)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(string_type), intent(in) :: names(:)          !< names of the columns of the results, the time first
    integer, intent(inout) :: at                       !< place in `text` where the name begins; afterwards the place behind it
    integer, intent(out) :: column                     !< number of the column
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=*), parameter :: ends = ' ,:'
    integer :: i, length, after

    call skip_blanks(text, at)
    column = 1
    length = 0
    do i = 1, size(names)
      after = at + len(names(i)%text)
      if (len(names(i)%text) <= length .or. after - 1 > len(text)) cycle
      if (text(at:after - 1) /= names(i)%text .or. scan(text(after:)//',', ends) /= 1) cycle
      column = i
      length = len(names(i)%text)
    end do
    if (length == 0) call refuse_name(text(at:at - 2 + scan(text(at:)//',', ends)), names, err)
    at = at + length
    call skip_blanks(text, at)
  end subroutine take_name

  !> Move a place in a text over the blanks that begin there.
  pure subroutine skip_blanks(text, at)
    character(len=*), intent(in) :: text  !< the argument of --plot
    integer, intent(inout) :: at          !< place in `text`; afterwards the next place without a blank

    do while (text(at:min(at, len(text))) == ' ' .and. at <= len(text))
      at = at + 1
    end do
  end subroutine skip_blanks

  !> Refuse an unknown name, with the nearest name or a list of the names.
  pure subroutine refuse_name(word, names, err)
    character(len=*), intent(in) :: word               !< the unknown name
    type(string_type), intent(in) :: names(:)          !< names of the columns of the results, the time first
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: nearest, hint
    character(len=longest_name) :: known(size(names))
    integer :: i

    if (word == '') then
      call raise(err, exit_usage, '--plot: a name of a column is missing, as in --plot q1,P.x:P.y')
      return
    end if
    do i = 1, size(names)
      known(i) = names(i)%text
    end do
    nearest = nearest_name(word, known)
    if (nearest /= '') then
      hint = "; did you mean '"//nearest//"'?"
    else
      hint = '; the columns are'
      do i = 1, min(size(names), most_names)
        hint = hint//' '//names(i)%text
      end do
      if (size(names) > most_names) hint = hint//' ...'
    end if
    call raise(err, exit_usage, "--plot: no column of the results is named '"//word//"'"//hint)
  end subroutine refuse_name
end module mech9_plot_request
