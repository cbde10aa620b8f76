!> The script with which gnuplot draws a plot.
module mech9_plot_script
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_number_format, only: number_format_type, number_width
  use mech9_printable, only: printable, column_name
  use mech9_title_lines, only: letters_of
  use mech9_gnuplot, only: quoted, quoted_lines, quoted_path
  use mech9_plot_style, only: plot_style, picture_terminal, picture_title, axis_format
  use mech9_plot_request, only: curve_type
  use mech9_plot_data, only: plot_data_type
  use mech9_plot_panels, only: panels_of, axis_label, over_time
  use mech9_plot_axes, only: axis_commands
  use mech9_plot_layout, only: layout_type, find_plot_layout, picture_width, margins, equal_scales, ranges_of, curve_name
  use mech9_event_words, only: told_events_type
  use mech9_event_marks, only: event_marks, event_key, no_marks
  implicit none
  private
  public :: picture_script, terminal_script

  character, parameter :: line_end = achar(10)
  character(len=*), parameter :: data_block = '$data', data_end = 'end_of_data'
  !> Each row is marked if there are at most this many.
  integer, parameter :: few_rows = 30
  !> Room that a letter of the label of an upward axis takes [px].
  real(wp), parameter :: label_letter = 9.0_wp
  !> Points of a section are larger if there are at most this many.
  integer, parameter :: few_points = 300
  character(len=*), parameter :: large_dots = 'points pointtype 7 pointsize 0.5', small_dots = 'points pointtype 7 pointsize 0.2'

contains

  !> The script of a picture. Users can run it again, and its first line tells how.
  pure function picture_script(title, curves, data, picture, script, table, events) result(text)
    character(len=*), intent(in) :: title      !< title of the mechanism
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=*), intent(in) :: picture    !< name of the file of the picture, without its folder
    character(len=*), intent(in) :: script     !< name of the file of the script, without its folder
    character(len=*), intent(in) :: table      !< file with the results, without its folder; empty: the script holds the data
    type(told_events_type), intent(in) :: events     !< those of the run, which are marked over the time
    character(len=:), allocatable :: text, source, key
    type(string_type), allocatable :: lines(:)
    type(curve_type), allocatable :: own(:)
    type(layout_type) :: layout
    integer :: panels(size(curves)), i
    logical :: marked

    panels = panels_of(curves, data%names, data%units)
    lines = picture_title(title, picture, picture_width(curves, panels, data, events%count > 0))
    call find_plot_layout(curves, panels, data, events%count > 0, size(lines), layout)
    source = data_block
    text = '# gnuplot '//printable(script)//' draws '//printable(picture)//line_end// &
           'set encoding utf8'//line_end// &
           picture_terminal(picture, layout%width, layout%height)//line_end// &
           'set output '//quoted_path(picture)//line_end//plot_style()
    if (table == '') then
      text = text//inline_data(data)
    else
      source = quoted_path(table)
    end if
    if (maxval(panels) == 1) then
      text = text//'set title '//quoted_lines(lines)//line_end
    else
      text = text//'set multiplot title '//quoted_lines(lines)//line_end
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
      text = text//panel(own, data, source, layout, i)//key//line_end
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
      text = text//'set title '//quoted(axis_label(own%y, data%labels, data%units))//line_end// &
             terminal_axes(own, data)//curve_commands(own, data, data_block, &
                                                      with=trim(merge('points', 'lines ', data%are_points)))//line_end
    end do
  end function terminal_script

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

  !> The commands for one panel: its axes and its curves, without the end of the last line.
  pure function panel(curves, data, source, layout, i) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=*), intent(in) :: source     !< the data as a word of the script: a block of data or a file
    type(layout_type), intent(in) :: layout    !< places of all panels
    integer, intent(in) :: i                   !< number of the panel
    character(len=:), allocatable :: text

    text = margins(layout, i)//axes(curves, data, layout%right(i) - layout%left(i), layout%top(i) - layout%bottom(i))
    ! panels over time share the axis of the last one
    if (i < size(layout%left) .and. over_time(curves(1))) &
      text = text//'unset xlabel'//line_end//'set format x '''''//line_end
    if (data%are_points) then
      text = text//curve_commands(curves, data, source, with=trim(merge(large_dots, small_dots, data%count <= few_points)))
    else
      text = text//curve_commands(curves, data, source, &
                                  with=trim(merge('linespoints', 'lines      ', data%count <= few_rows)))
    end if
  end function panel

  !> The commands for labels, ranges and marks.
  pure function axes(curves, data, width, height) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer, intent(in) :: width               !< of the area between the axes [px]
    integer, intent(in) :: height              !< of the area between the axes [px]
    character(len=:), allocatable :: text
    real(wp) :: ranges(2, 2)
    logical :: true_shape

    true_shape = equal_scales(curves, data)
    ranges(:, 1) = data%extent(curves%x)
    ranges(:, 2) = data%extent(curves%y)
    text = labels(curves, data)//'set ylabel '//upward_label(axis_label(curves%y, data%labels, data%units), height)//line_end// &
           merge('set size ratio -1', 'set size noratio ', true_shape)//line_end
    if (true_shape) ranges = ranges_of(curves, data, width, height)
    text = text//axis_commands('x', ranges(:, 1), data%units(curves(1)%x)%text, width, true_shape .or. over_time(curves(1)))// &
           axis_commands('y', ranges(:, 2), data%units(curves(1)%y)%text, height, true_shape)
  end function axes

  !> The commands for the label to the right, and for the numbers: they have as many digits as distinguish them.
  pure function labels(curves, data) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=:), allocatable :: text

    text = 'set xlabel '//quoted(axis_label(curves%x, data%labels, data%units))//line_end// &
           'set format x '//axis_format(data%extent(curves%x))//line_end// &
           'set format y '//axis_format(data%extent(curves%y))//line_end
  end function labels

  !> The label of an upward axis as a string of gnuplot; its unit stands in a line of its own if the axis is too short.
  pure function upward_label(label, height) result(string)
    character(len=*), intent(in) :: label   !< the label
    integer, intent(in) :: height           !< of the axis [px]
    character(len=:), allocatable :: string
    integer :: at

    at = index(label, ' [', back=.true.)
    if (at > 1 .and. letters_of(label)*label_letter > height) then
      string = quoted_lines([string_type(label(:at - 1)), string_type(label(at + 1:))])
    else
      string = quoted(label)
    end if
  end function upward_label

  !> The commands for labels and ranges of a plot in the terminal.
  pure function terminal_axes(curves, data) result(text)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    character(len=:), allocatable :: text
    integer, parameter :: unit_square = 1000
    real(wp) :: ranges(2, 2)

    text = labels(curves, data)//'unset ylabel'//line_end
    if (equal_scales(curves, data)) then
      ranges = ranges_of(curves, data, unit_square, unit_square)
      text = text//'set size ratio -1'//line_end//'set xrange '//range_text(ranges(:, 1))//line_end// &
             'set yrange '//range_text(ranges(:, 2))//line_end
    else
      text = text//'set size noratio'//line_end//'set autoscale'//line_end
      if (over_time(curves(1))) text = text//'set autoscale xfix'//line_end
    end if
  end function terminal_axes

  !> A range as gnuplot writes it.
  pure function range_text(ends) result(text)
    real(wp), intent(in) :: ends(2)  !< least and greatest value
    character(len=:), allocatable :: text

    text = '['//to_text(ends(1), 9)//':'//to_text(ends(2), 9)//']'
  end function range_text

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
end module mech9_plot_script
