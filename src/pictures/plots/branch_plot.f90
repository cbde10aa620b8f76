!> Plots of branches over a parameter, by gnuplot: stable positions as full lines, unstable ones as broken lines, marks at special points.
module mech9_branch_plot
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_path, only: name_of
  use mech9_printable, only: printable
  use mech9_heading, only: heading_type
  use mech9_terminal_size, only: find_terminal_size
  use mech9_gnuplot, only: quoted, quoted_lines, quoted_path
  use mech9_plot_style, only: plot_style, picture_terminal, picture_title, axis_format, first_colour, second_colour
  use mech9_plot_request, only: plot_request_type, curve_type, read_plot_request
  use mech9_plot_panels, only: axis_label
  use mech9_plot_blocks, only: find_layout
  use mech9_plot_drawing, only: draw_picture, draw_in_terminal, script_of_plot
  implicit none
  private
  public :: branch_rows_type, read_branch_plot, draw_branch_plot

  !> The rows of branches, as they are drawn.
  type :: branch_rows_type
    type(heading_type) :: heading           !< title and columns: branch, point, parameter, then others; the last one is the type
    type(heading_type) :: labels            !< the same with the names of columns that the picture shows
    real(wp), allocatable :: rows(:, :)     !< (columns,rows)
    logical, allocatable :: stable(:)       !< (rows) the position is stable
  end type branch_rows_type

  character, parameter :: line_end = achar(10)
  !> Column of the parameter.
  integer, parameter :: of_parameter = 3
  !> Kinds of special points with their names and their symbols.
  integer, parameter :: kinds = 5
  character(len=15), parameter :: names_of_kinds(kinds) = [character(len=15) :: 'fold', 'branch point', 'Hopf point', &
                                                           'period doubling', 'torus']
  integer, parameter :: symbols(kinds) = [7, 5, 9, 11, 13]

contains

  !> Read the request before the work, so that a wrong name costs no time (exit_usage). Single names are drawn over the parameter.
  subroutine read_branch_plot(text, names, request, err)
    character(len=*), intent(in) :: text                  !< the argument of --plot
    type(string_type), intent(in) :: names(:)             !< of the columns
    type(plot_request_type), intent(out) :: request       !< the request
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed

    call read_plot_request(text, names, request, err)
    if (allocated(err)) return
    where (request%curves%x == 1) request%curves%x = of_parameter
  end subroutine read_branch_plot

  !> Draw a plot, as a picture with its script beside it, or in the terminal.
  subroutine draw_branch_plot(text, branches, picture, said, is_lacking, err)
    character(len=*), intent(in) :: text                  !< the argument of --plot
    type(branch_rows_type), intent(in) :: branches        !< rows of all branches, at least one
    character(len=*), intent(in) :: picture               !< file of the picture, unless `text` names one
    character(len=:), allocatable, intent(out) :: said    !< a line for the user; empty: nothing to say
    logical, intent(out) :: is_lacking                    !< gnuplot is not here
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(plot_request_type) :: request
    character(len=:), allocatable :: path
    integer :: columns, lines

    said = ''
    is_lacking = .false.
    call read_branch_plot(text, branches%heading%names, request, err)
    if (allocated(err)) return
    if (request%in_terminal) then
      call find_terminal_size(columns, lines)
      call draw_in_terminal(script_in_letters(request%curves, branches, columns, lines), err)
      return
    end if
    path = picture
    if (request%target /= '') path = request%target
    call draw_picture(path, script(request%curves, branches, name_of(path), name_of(script_of_plot(path))), said, is_lacking, err)
  end subroutine draw_branch_plot

  !> The script of a picture. Users can run it again, and its first line tells how.
  pure function script(curves, branches, picture, own_name) result(text)
    type(curve_type), intent(in) :: curves(:)             !< the panels, each with its two columns
    type(branch_rows_type), intent(in) :: branches        !< rows of all branches
    character(len=*), intent(in) :: picture               !< name of the file of the picture, without its folder
    character(len=*), intent(in) :: own_name              !< name of the file of the script, without its folder
    character(len=:), allocatable :: text
    type(string_type), allocatable :: lines(:)
    integer :: i, across, down, width, height

    call find_layout(size(curves), across, down, width, height)
    lines = picture_title(branches%heading%title, picture, width)
    text = '# gnuplot '//printable(own_name)//' draws '//printable(picture)//line_end//'set encoding utf8'//line_end// &
           picture_terminal(picture, width, height)//line_end//'set output '//quoted_path(picture)//line_end//plot_style()// &
           'set key outside above horizontal center'//line_end
    do i = 1, size(curves)
      text = text//blocks(curves(i), i, branches)
    end do
    if (size(curves) == 1) then
      text = text//'set title '//quoted_lines(lines)//line_end
    else
      text = text//'set multiplot layout '//to_text(down)//','//to_text(across)//' title '//quoted_lines(lines)//line_end
    end if
    do i = 1, size(curves)
      text = text//axes(curves(i), branches)//commands(i, branches, .false.)
    end do
    if (size(curves) > 1) text = text//'unset multiplot'//line_end
    text = text//'unset output'//line_end
  end function script

  !> The script of a plot in letters, with one panel below the other.
  pure function script_in_letters(curves, branches, columns, lines) result(text)
    type(curve_type), intent(in) :: curves(:)             !< the panels, each with its two columns
    type(branch_rows_type), intent(in) :: branches        !< rows of all branches
    integer, intent(in) :: columns                        !< width of each panel in letters
    integer, intent(in) :: lines                          !< height of each panel in lines
    character(len=:), allocatable :: text
    integer :: i

    text = 'set encoding utf8'//line_end//'set terminal dumb mono noenhanced size '//to_text(columns)//','//to_text(lines)// &
           line_end//'set key above'//line_end//'set tics nomirror'//line_end
    do i = 1, size(curves)
      text = text//blocks(curves(i), i, branches)//axes(curves(i), branches)//commands(i, branches, .true.)
    end do
  end function script_in_letters

  !> The labels of a panel.
  pure function axes(curve, branches) result(text)
    type(curve_type), intent(in) :: curve                 !< its two columns
    type(branch_rows_type), intent(in) :: branches        !< rows of all branches
    character(len=:), allocatable :: text

    associate (names => branches%labels%names, units => branches%heading%units)
      text = 'set xlabel '//quoted(axis_label([curve%x], names, units))//line_end//'set format x '// &
             axis_format(ends_of(branches%rows(curve%x, :)))//line_end//'set ylabel '// &
             quoted(axis_label([curve%y], names, units))//line_end//'set format y '// &
             axis_format(ends_of(branches%rows(curve%y, :)))//line_end
    end associate
  end function axes

  !> The least and the greatest one of some numbers that have values.
  pure function ends_of(numbers) result(ends)
    real(wp), intent(in) :: numbers(:)   !< at least one
    real(wp) :: ends(2)
    integer :: i

    ends = [huge(1.0_wp), -huge(1.0_wp)]
    do i = 1, size(numbers)
      if (ieee_is_finite(numbers(i))) ends = [min(ends(1), numbers(i)), max(ends(2), numbers(i))]
    end do
    if (ends(1) > ends(2)) ends = 0.0_wp
  end function ends_of

  !> The plot command of a panel.
  pure function commands(panel, branches, in_letters) result(text)
    integer, intent(in) :: panel                          !< its number
    type(branch_rows_type), intent(in) :: branches        !< rows of all branches
    logical, intent(in) :: in_letters                     !< for the terminal
    character(len=:), allocatable :: text
    logical :: judged
    integer :: kind

    judged = .not. all(branches%stable)
    text = 'plot '
    if (any(branches%stable)) call add('stable', 'lines lt 1'//style(' lw 2 lc rgb '''//first_colour//''''), &
                                       trim(merge('stable   ', 'positions', judged)))
    if (judged) call add('unstable', 'lines lt 2'//style(' lw 2 dashtype 2 lc rgb '''//second_colour//''''), 'unstable')
    do kind = 1, kinds
      if (.not. any(nint(branches%rows(size(branches%rows, 1), :)) == kind)) cycle
      call add('kind_'//to_text(kind), 'points'//style(' pt '//to_text(symbols(kind))//' ps 0.8 lc rgb ''#000000'''), &
               trim(names_of_kinds(kind)))
    end do
    text = text//line_end
  contains

    !> Add a block of data.
    pure subroutine add(block, with, title)
      character(len=*), intent(in) :: block   !< its name
      character(len=*), intent(in) :: with    !< style
      character(len=*), intent(in) :: title   !< in the key

      if (len(text) > 5) text = text//', \'//line_end//'     '
      text = text//'$'//block//'_'//to_text(panel)//' using 1:2 with '//with//' title '//quoted(title)
    end subroutine add

    !> A style, which a plot in letters does not have.
    pure function style(words)
      character(len=*), intent(in) :: words   !< of a picture
      character(len=:), allocatable :: style

      style = words
      if (in_letters) style = ''
    end function style
  end function commands

  !> The blocks of data of a panel: parts of stable and of unstable positions, and points of each kind.
  pure function blocks(curve, panel, branches) result(text)
    type(curve_type), intent(in) :: curve                 !< its two columns
    integer, intent(in) :: panel                          !< its number
    type(branch_rows_type), intent(in) :: branches        !< rows of all branches
    character(len=:), allocatable :: text, points
    integer :: kind, i

    text = ''
    if (any(branches%stable)) text = text//'$stable_'//to_text(panel)//' << end'//line_end//lines_of(.true.)//'end'//line_end
    if (.not. all(branches%stable)) &
      text = text//'$unstable_'//to_text(panel)//' << end'//line_end//lines_of(.false.)//'end'//line_end
    do kind = 1, kinds
      points = ''
      do i = 1, size(branches%stable)
        if (nint(branches%rows(size(branches%rows, 1), i)) == kind) points = points//numbers(i)
      end do
      if (points /= '') text = text//'$kind_'//to_text(kind)//'_'//to_text(panel)//' << end'//line_end//points//'end'//line_end
    end do
  contains

    !> The parts of branches between points of one stability.
    pure function lines_of(stable) result(lines)
      logical, intent(in) :: stable   !< of the positions
      character(len=:), allocatable :: lines
      integer :: j, last

      lines = ''
      last = 0
      do j = 2, size(branches%stable)
        if (nint(branches%rows(1, j)) /= nint(branches%rows(1, j - 1)) .or. (is_stable(j) .neqv. stable)) cycle
        if (last /= j - 1) lines = lines//line_end//numbers(j - 1)
        lines = lines//numbers(j)
        last = j
      end do
      if (lines == '') lines = 'NaN NaN'//line_end
    end function lines_of

    !> Whether positions between a row and the one before are stable. A special point is none of both.
    pure logical function is_stable(j)
      integer, intent(in) :: j   !< the row

      is_stable = branches%stable(j)
      if (branches%rows(size(branches%rows, 1), j) > 0.5_wp) is_stable = branches%stable(j - 1)
    end function is_stable

    !> The two numbers of a row.
    pure function numbers(j)
      integer, intent(in) :: j   !< the row
      character(len=:), allocatable :: numbers

      numbers = number(branches%rows(curve%x, j))//' '//number(branches%rows(curve%y, j))//line_end
    end function numbers

    !> A number as gnuplot reads it.
    pure function number(value) result(word)
      real(wp), intent(in) :: value   !< may have no value
      character(len=:), allocatable :: word

      word = 'NaN'
      if (ieee_is_finite(value)) word = to_text(value, 9)
    end function number
  end function blocks
end module mech9_branch_plot
