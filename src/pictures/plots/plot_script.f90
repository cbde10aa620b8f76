!> The script with which gnuplot draws a plot.
module mech9_plot_script
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_number_format, only: number_format_type, number_width
  use mech9_printable, only: printable, column_name
  use mech9_gnuplot, only: quoted, quoted_lines, quoted_path
  use mech9_plot_style, only: plot_style, picture_terminal, picture_title, axis_format, digits_needed
  use mech9_plot_request, only: curve_type
  use mech9_plot_data, only: plot_data_type
  use mech9_plot_panels, only: panels_of, axis_label, over_time
  use mech9_motion_event, only: motion_events_type
  use mech9_event_marks, only: event_marks, event_key, no_marks
  implicit none
  private
  public :: picture_script, terminal_script

  character, parameter :: line_end = achar(10)
  character(len=*), parameter :: data_block = '$data', data_end = 'end_of_data'
  !> Each row is marked if there are at most this many.
  integer, parameter :: few_rows = 30
  !> The least ratio of the sides of a panel with equal scales.
  real(wp), parameter :: flattest = 0.2_wp

contains

  !> The script of a picture. Users can run it again, and its first line tells how.
  pure function picture_script(title, curves, data, picture, script, table, events) result(text)
    character(len=*), intent(in) :: title      !< title of the mechanism
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=*), intent(in) :: picture    !< name of the file of the picture, without its folder
    character(len=*), intent(in) :: script     !< name of the file of the script, without its folder
    character(len=*), intent(in) :: table      !< file with the results, without its folder; empty: the script holds the data
    type(motion_events_type), intent(in) :: events   !< those of the run, which are marked over the time
    character(len=:), allocatable :: text, source, key
    type(string_type), allocatable :: lines(:)
    type(curve_type), allocatable :: own(:)
    integer :: panels(size(curves)), i, width, height
    logical :: marked

    panels = panels_of(curves, data%names, data%units)
    call find_size(curves, panels, data, width, height)
    lines = picture_title(title, picture, width)
    source = data_block
    text = '# gnuplot '//printable(script)//' draws '//printable(picture)//line_end// &
           'set encoding utf8'//line_end// &
           picture_terminal(picture, width, height)//line_end// &
           'set output '//quoted_path(picture)//line_end//plot_style()
    if (table == '') then
      text = text//inline_data(data)
    else
      source = quoted_path(table)
    end if
    if (maxval(panels) == 1) then
      text = text//'set title '//quoted_lines(lines)//line_end
    else
      text = text//stack(lines, curves, panels, data, events%count > 0)
    end if
    marked = .false.
    key = ''
    do i = 1, maxval(panels)
      own = pack(curves, panels == i)
      if (events%count > 0 .and. (over_time(own(1)) .neqv. marked)) then
        marked = .not. marked
        if (marked) text = text//event_marks(events, data%extent(own%x))
        if (marked) key = event_key(events, data%extent(own%x))
        if (.not. marked) text = text//no_marks
      end if
      text = text//panel(own, data, source, stacked=maxval(panels) > 1, last=i == maxval(panels))//key//line_end
      key = ''
    end do
    if (maxval(panels) > 1) text = text//'unset multiplot'//line_end
    text = text//'unset output'//line_end
  end function picture_script

  !> The script of a plot in letters, with one panel below the other.
  pure function terminal_script(curves, data, columns, rows) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer, intent(in) :: columns             !< width of each panel in letters
    integer, intent(in) :: rows                !< height of each panel in lines
    character(len=:), allocatable :: text
    type(curve_type), allocatable :: own(:)
    integer :: panels(size(curves)), i

    panels = panels_of(curves, data%names, data%units)
    text = 'set encoding utf8'//line_end//'set terminal dumb mono noenhanced size '//to_text(columns)//','// &
           to_text(rows)//line_end//'set key above'//line_end//'set tics nomirror'//line_end//inline_data(data)
    do i = 1, maxval(panels)
      own = pack(curves, panels == i)
      ! a dumb terminal cannot turn the label of the upward axis, so that it stands above the panel
      text = text//'set title '//quoted(axis_label(own%y, data%names, data%units))//line_end// &
             axes(own, data, '')//curve_commands(own, data, data_block, with='lines')//line_end
    end do
  end function terminal_script

  !> Choose the size of a picture, from the number of its panels or from the shape of its ranges.
  pure subroutine find_size(curves, panels, data, width, height)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    integer, intent(in) :: panels(:)           !< number of the panel of each curve
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer, intent(out) :: width              !< width of the picture [px]
    integer, intent(out) :: height             !< height of the picture [px]

    width = 960
    height = 540
    if (maxval(panels) > 1) then
      height = 120 + 230*maxval(panels)
    else if (equal_scales(curves, data)) then
      call true_shape(curves, data, width, height)
    end if
  end subroutine find_size

  !> Compute the size of a picture with equal scales, whose area has the shape of the ranges of its axes.
  pure subroutine true_shape(curves, data, width, height)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer, intent(out) :: width              !< width of the picture [px]
    integer, intent(out) :: height             !< height of the picture [px]
    integer, parameter :: longer_side = 700, letter = 9
    real(wp) :: sides(2)

    sides = spans(curves, data)
    sides = longer_side*sides/maxval(sides)
    width = nint(sides(1)) + 140
    height = nint(sides(2)) + 130
    if (size(curves) > 1) width = width + letter*(longest_name(curves, data) + 3)
  end subroutine true_shape

  !> The lengths of axes with equal scales, without margins. A straight path along an axis gets some room at right angles
  !> to it.
  pure function spans(curves, data) result(sides)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    real(wp) :: sides(2), ends(2)

    ends = data%extent(curves%x)
    sides(1) = ends(2) - ends(1)
    ends = data%extent(curves%y)
    sides(2) = ends(2) - ends(1)
    sides = max(sides, flattest*maxval(sides))
  end function spans

  !> The rows as a block of data within the script: names first, then numbers.
  pure function inline_data(data) result(text)
    type(plot_data_type), intent(in) :: data  !< rows and columns that are plotted
    character(len=:), allocatable :: text, rows
    type(number_format_type) :: format
    integer :: i, j, at

    format = number_format_type()
    allocate (character(len=data%count*(size(data%columns)*number_width + 1)) :: rows)
    at = 0
    do j = 1, data%count
      do i = 1, size(data%columns)
        call format%put(data%values(i, j), rows(at + 1:at + number_width))
        at = at + number_width
      end do
      at = at + 1
      rows(at:at) = line_end
    end do
    text = data_block//' << '//data_end//line_end
    do i = 1, size(data%columns)
      text = text//' '//column_name(data%names(data%columns(i))%text)
    end do
    text = text//line_end//rows//data_end//line_end
  end function inline_data

  !> The commands for panels above each other. Their axes have one length whatever their labels are.
  pure function stack(lines, curves, panels, data, with_events) result(text)
    type(string_type), intent(in) :: lines(:)  !< lines of the title
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    integer, intent(in) :: panels(:)           !< number of the panel of each curve
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    logical, intent(in) :: with_events         !< the key has the kinds of events
    character(len=:), allocatable :: text
    type(curve_type), allocatable :: own(:)
    integer, parameter :: longest_kind = 6
    integer :: i, left, right

    left = 12
    right = 4
    do i = 1, maxval(panels)
      own = pack(curves, panels == i)
      left = max(left, 6 + letters_needed(data%extent(own%y)))
      if (size(own) > 1) right = max(right, 6 + longest_name(own, data))
      if (with_events .and. over_time(own(1))) right = max(right, 6 + longest_kind)
    end do
    text = 'set multiplot layout '//to_text(maxval(panels))//',1 title '//quoted_lines(lines)//' margins char '// &
           to_text(left)//',char '//to_text(right)//',char 4,char '//to_text(2 + size(lines))//' spacing char '// &
           merge('2', '5', all(over_time(curves)))//line_end
  end function stack

  !> The number of letters of the longest name of a curve.
  pure integer function longest_name(curves, data)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer :: i

    longest_name = 0
    do i = 1, size(curves)
      longest_name = max(longest_name, len(curve_name(curves(i), data)))
    end do
  end function longest_name

  !> The commands for one panel: its axes and its curves, without the end of the last line.
  pure function panel(curves, data, source, stacked, last) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=*), intent(in) :: source     !< the data as a word of the script: a block of data or a file
    logical, intent(in) :: stacked             !< the picture has several panels
    logical, intent(in) :: last                !< the panel is the lowest one
    character(len=:), allocatable :: text

    text = axes(curves, data, axis_label(curves%y, data%names, data%units))
    ! panels over time share the axis of the last one
    if (stacked .and. .not. last .and. over_time(curves(1))) &
      text = text//'unset xlabel'//line_end//'set format x '''''//line_end
    text = text//curve_commands(curves, data, source, &
                                with=trim(merge('linespoints', 'lines      ', data%count <= few_rows)))
  end function panel

  !> The commands for labels and ranges. Numbers are written with as many digits as distinguish them.
  pure function axes(curves, data, label) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=*), intent(in) :: label      !< label of the upward axis
    character(len=:), allocatable :: text
    real(wp) :: x(2), y(2), sides(2)

    x = data%extent(curves%x)
    y = data%extent(curves%y)
    text = 'set xlabel '//quoted(axis_label(curves%x, data%names, data%units))//line_end// &
           'set ylabel '//quoted(label)//line_end// &
           'set format x '//axis_format(x)//line_end//'set format y '//axis_format(y)//line_end
    if (equal_scales(curves, data)) then
      sides = spans(curves, data)
      text = text//'set size ratio -1'//line_end// &
             'set xrange '//axis_range(x, sides(1))//line_end//'set yrange '//axis_range(y, sides(2))//line_end
    else
      text = text//'set size noratio'//line_end//'set autoscale'//line_end
      if (over_time(curves(1))) text = text//'set autoscale xfix'//line_end
    end if
  end function axes

  !> Whether both axes have the same unit, so that the picture shows true shapes.
  pure logical function equal_scales(curves, data)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted

    equal_scales = data%units(curves(1)%x)%text == data%units(curves(1)%y)%text .and. .not. over_time(curves(1))
    if (equal_scales) equal_scales = maxval(spans(curves, data)) > tiny(1.0_wp)
  end function equal_scales

  !> The range of an axis around the values, with a margin.
  pure function axis_range(ends, span) result(text)
    real(wp), intent(in) :: ends(2)  !< least and greatest value
    real(wp), intent(in) :: span     !< length of the axis, without margins
    character(len=:), allocatable :: text
    real(wp) :: middle, half

    middle = 0.5_wp*(ends(1) + ends(2))
    half = 0.55_wp*span
    text = '['//to_text(middle - half, 9)//':'//to_text(middle + half, 9)//']'
  end function axis_range

  !> The number of letters that the numbers of an axis take: their digits, and more for numbers like -3.5e-13 or -0.00035.
  pure integer function letters_needed(ends)
    real(wp), intent(in) :: ends(2)  !< least and greatest value on the axis
    real(wp), parameter :: smallest_short = 1e-2_wp, largest_short = 1e6_wp
    integer, parameter :: exponent = 4
    real(wp) :: size

    size = maxval(abs(ends))
    letters_needed = digits_needed(ends)
    if ((size > 0.0_wp .and. size < smallest_short) .or. size >= largest_short) letters_needed = letters_needed + exponent
  end function letters_needed

  !> The plot command, without the end of its line.
  pure function curve_commands(curves, data, source, with) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=*), intent(in) :: source     !< the data as a word of the script: a block of data or a file
    character(len=*), intent(in) :: with       !< style of the curves
    character(len=:), allocatable :: text
    integer :: i

    text = 'plot '
    do i = 1, size(curves)
      text = text//source
      if (source /= data_block .and. data%stride > 1) text = text//' every '//to_text(data%stride)
      text = text//' using '//quoted(column_name(data%names(curves(i)%x)%text))//':'// &
             quoted(column_name(data%names(curves(i)%y)%text))//' with '//with//' linetype '//to_text(i)
      if (size(curves) == 1) then
        text = text//' notitle'
      else
        text = text//' title '//quoted(curve_name(curves(i), data))
      end if
      if (i < size(curves)) text = text//', \'//line_end//'     '
    end do
  end function curve_commands

  !> The name of a curve in the key.
  pure function curve_name(curve, data) result(name)
    type(curve_type), intent(in) :: curve     !< the curve with its two columns
    type(plot_data_type), intent(in) :: data  !< rows and columns that are plotted
    character(len=:), allocatable :: name

    name = data%names(curve%y)%text
    if (.not. over_time(curve)) name = data%names(curve%x)%text//':'//name
  end function curve_name
end module mech9_plot_script
