!> The script with which gnuplot draws the plots of a study.
module mech9_study_script
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_printable, only: printable
  use mech9_gnuplot, only: quoted, quoted_lines, quoted_path
  use mech9_plot_style, only: plot_style, picture_terminal, picture_title, axis_format, first_colour, second_colour
  use mech9_plot_axes, only: axis_step
  use mech9_plot_panels, only: axis_label
  use mech9_plot_blocks, only: block_of, find_layout
  use mech9_study_request, only: panel_type
  use mech9_study_figures, only: histogram_type, effect_type, map_type, find_histogram, find_effect, find_map
  implicit none
  private
  public :: study_script, study_terminal_script

  character, parameter :: line_end = achar(10)
  !> Points of a scatter plot: more would hide each other and make large files.
  integer, parameter :: most_points = 2000
  !> Width of a panel beside its horizontal axis, and more of it beside that of a map, where the scale of colours stands [px].
  integer, parameter :: beside_axis = 80, beside_map = 80

contains

  !> The script of a picture. Users can run it again, and its first line tells how.
  pure function study_script(title, panels, names, units, rows, picture, script) result(text)
    character(len=*), intent(in) :: title        !< title of the mechanism
    type(panel_type), intent(in) :: panels(:)    !< the plots in the picture
    type(string_type), intent(in) :: names(:)    !< of the columns
    type(string_type), intent(in) :: units(:)    !< of the columns; empty: not known
    real(wp), intent(in) :: rows(:, :)           !< (columns,runs) parameters and quantities, at least one run
    character(len=*), intent(in) :: picture      !< name of the file of the picture, without its folder
    character(len=*), intent(in) :: script       !< name of the file of the script, without its folder
    character(len=:), allocatable :: text
    type(string_type), allocatable :: lines(:)
    integer :: i, across, down, width, height

    call find_layout(size(panels), across, down, width, height)
    lines = picture_title(title, picture, width)
    text = '# gnuplot '//printable(script)//' draws '//printable(picture)//line_end//'set encoding utf8'//line_end// &
           picture_terminal(picture, width, height)//line_end//'set output '//quoted_path(picture)//line_end//plot_style()// &
           'unset key'//line_end// &
           'set palette defined (0 ''#352a87'', 1 ''#1283d4'', 2 ''#33b8a1'', 3 ''#d1bb59'', 4 ''#f9fb0e'')'//line_end
    do i = 1, size(panels)
      text = text//figure(i, panels(i), rows)
    end do
    if (size(panels) == 1) then
      text = text//'set title '//quoted_lines(lines)//line_end
    else
      text = text//'set multiplot layout '//to_text(down)//','//to_text(across)//' title '//quoted_lines(lines)//line_end
    end if
    do i = 1, size(panels)
      text = text//panel_commands(i, panels(i), names, units, rows, width/across - beside_axis)
    end do
    if (size(panels) > 1) text = text//'unset multiplot'//line_end
    text = text//'unset output'//line_end
  end function study_script

  !> The script of plots in letters, one below the other.
  pure function study_terminal_script(panels, names, units, rows, columns, lines) result(text)
    type(panel_type), intent(in) :: panels(:)    !< histograms, and pairs
    type(string_type), intent(in) :: names(:)    !< of the columns
    type(string_type), intent(in) :: units(:)    !< of the columns; empty: not known
    real(wp), intent(in) :: rows(:, :)           !< (columns,runs) parameters and quantities, at least one run
    integer, intent(in) :: columns               !< width of each plot in letters
    integer, intent(in) :: lines                 !< height of each plot in lines
    character(len=:), allocatable :: text
    integer :: i, y

    text = 'set encoding utf8'//line_end//'set terminal dumb mono noenhanced size '//to_text(columns)//','//to_text(lines)// &
           line_end//'unset key'//line_end//'set tics nomirror'//line_end
    do i = 1, size(panels)
      text = text//figure(i, panels(i), rows)//axis_commands(panels(i), names, units, rows)//'unset ylabel'//line_end
      y = panels(i)%columns(panels(i)%n)
      if (panels(i)%n == 1) then
        text = text//'set title ''runs'''//line_end//'set yrange [0:*]'//line_end//'plot '//block_name(i)//' using 1:2 with boxes'
      else
        text = text//'set title '//quoted(axis_label([y], names, units))//line_end//'set autoscale y'//line_end// &
               'plot '//block_name(i)//' using 1:2 with linespoints'
      end if
      text = text//line_end
    end do
  end function study_terminal_script

  !> The name of the block of data of a panel.
  pure function block_name(i) result(name)
    integer, intent(in) :: i   !< number of the panel
    character(len=:), allocatable :: name

    name = '$figure'//to_text(i)
  end function block_name

  !> The numbers of a panel as blocks of data. A histogram has middle, runs and width of each bar. A pair has x, mean
  !> and deviation of each group, and some of the runs in a block of their own. A map has the edges of each rectangle
  !> and its mean.
  pure function figure(i, panel, rows) result(text)
    integer, intent(in) :: i                   !< number of the panel
    type(panel_type), intent(in) :: panel      !< the panel
    real(wp), intent(in) :: rows(:, :)         !< (columns,runs)
    character(len=:), allocatable :: text
    type(histogram_type) :: histogram
    type(effect_type) :: effect
    type(map_type) :: map
    integer :: step

    select case (panel%n)
    case (1)
      call find_histogram(rows(panel%columns(1), :), histogram)
      text = block_of(block_name(i), bars_of(histogram))
    case (2)
      call find_effect(rows(panel%columns(1), :), rows(panel%columns(2), :), effect)
      step = 1 + (size(rows, 2) - 1)/most_points
      text = block_of(block_name(i), reshape([effect%x, effect%mean, effect%deviation], [size(effect%x), 3]))// &
             block_of(block_name(i)//'_runs', reshape([rows(panel%columns(1), ::step), rows(panel%columns(2), ::step)], &
                                                      [1 + (size(rows, 2) - 1)/step, 2]))
    case default
      call find_map(rows(panel%columns(1), :), rows(panel%columns(2), :), rows(panel%columns(3), :), map)
      text = block_of(block_name(i), rectangles_of(map))
    end select
  end function figure

  !> The bars of a histogram.
  pure function bars_of(histogram) result(numbers)
    type(histogram_type), intent(in) :: histogram   !< the histogram
    real(wp) :: numbers(size(histogram%counts), 3)
    integer :: n

    n = size(histogram%counts)
    numbers(:, 1) = 0.5_wp*(histogram%edges(:n) + histogram%edges(2:))
    numbers(:, 2) = histogram%counts
    numbers(:, 3) = histogram%edges(2:) - histogram%edges(:n)
  end function bars_of

  !> The rectangles of a map that hold runs.
  pure function rectangles_of(map) result(numbers)
    type(map_type), intent(in) :: map   !< the map
    real(wp), allocatable :: numbers(:, :)
    integer :: column, row, n

    allocate (numbers(count(map%counts > 0), 5))
    n = 0
    do row = 1, size(map%counts, 2)
      do column = 1, size(map%counts, 1)
        if (map%counts(column, row) == 0) cycle
        n = n + 1
        numbers(n, :4) = [map%x_edges(column), map%x_edges(column + 1), map%y_edges(row), map%y_edges(row + 1)]
        numbers(n, 5) = map%sums(column, row)/map%counts(column, row)
      end do
    end do
  end function rectangles_of

  !> The commands for one panel of a picture.
  pure function panel_commands(i, panel, names, units, rows, width) result(text)
    integer, intent(in) :: i                     !< number of the panel
    type(panel_type), intent(in) :: panel        !< the panel
    type(string_type), intent(in) :: names(:)    !< of the columns
    type(string_type), intent(in) :: units(:)    !< of the columns; empty: not known
    real(wp), intent(in) :: rows(:, :)           !< (columns,runs)
    integer, intent(in) :: width                 !< length of the horizontal axis [px]
    character(len=:), allocatable :: text, block, step

    block = block_name(i)
    step = axis_step(ends_of(rows(panel%columns(1), :)), width - merge(beside_map, 0, panel%n > 2), &
                     units(panel%columns(1))%text)
    if (step == '') step = 'autofreq'
    text = axis_commands(panel, names, units, rows)//'set xtics '//step//line_end
    select case (panel%n)
    case (1)
      text = text//'set ylabel ''runs'''//line_end//'set format y ''%g'''//line_end//'set autoscale'//line_end// &
             'set yrange [0:*]'//line_end// &
             'plot '//block//' using 1:2:3 with boxes fill solid 0.6 border lc rgb '''//first_colour//''' lc rgb '''// &
             first_colour//''''//line_end
    case (2)
      text = text//'set autoscale'//line_end//'plot '//block//'_runs using 1:2 with points pt 7 ps 0.2 lc rgb ''#999999'', \'// &
             line_end//'     '//block//' using 1:2:3 with yerrorbars lw 1.5 pt 7 ps 0.5 lc rgb '''//second_colour//''', \'// &
             line_end//'     '//block//' using 1:2 with lines lw 2 lc rgb '''//second_colour//''''//line_end
    case default
      text = text//'set autoscale fix'//line_end//'set cblabel '//quoted(axis_label([panel%columns(3)], names, units))// &
             ' offset 1.5,0'//line_end//'set format cb '//axis_format(ends_of(rows(panel%columns(3), :)))//line_end// &
             'plot '//block//' using (0.5*($1+$2)):(0.5*($3+$4)):1:2:3:4:5 with boxxyerror fill solid noborder lc palette'//line_end
    end select
  end function panel_commands

  !> The commands for labels and numbers of the axes along which the columns of a panel stand.
  pure function axis_commands(panel, names, units, rows) result(text)
    type(panel_type), intent(in) :: panel        !< the panel
    type(string_type), intent(in) :: names(:)    !< of the columns
    type(string_type), intent(in) :: units(:)    !< of the columns; empty: not known
    real(wp), intent(in) :: rows(:, :)           !< (columns,runs)
    character(len=:), allocatable :: text

    text = 'set xlabel '//quoted(axis_label([panel%columns(1)], names, units))//line_end// &
           'set format x '//axis_format(ends_of(rows(panel%columns(1), :)))//line_end
    if (panel%n > 1) text = text//'set ylabel '//quoted(axis_label([panel%columns(2)], names, units))//line_end// &
                            'set format y '//axis_format(ends_of(rows(panel%columns(2), :)))//line_end
  end function axis_commands

  !> The least and the greatest one of some numbers.
  pure function ends_of(numbers) result(ends)
    real(wp), intent(in) :: numbers(:)   !< at least one
    real(wp) :: ends(2)

    ends = [minval(numbers), maxval(numbers)]
  end function ends_of
end module mech9_study_script
