!> The script with which gnuplot draws targets and the design that meets them best.
module mech9_fit_script
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_printable, only: printable
  use mech9_gnuplot, only: quoted, quoted_lines, quoted_path
  use mech9_plot_style, only: plot_style, picture_terminal, picture_title, axis_format, first_colour, second_colour
  use mech9_plot_axes, only: axis_commands
  use mech9_plot_blocks, only: block_of, find_layout
  implicit none
  private
  public :: fit_panel_type, fit_script, fit_terminal_script

  !> One panel. Targets and places have directions where these count: those of the x axis of a link.
  type :: fit_panel_type
    character(len=:), allocatable :: title         !< of the panel
    character(len=:), allocatable :: x_label       !< of the axis to the right
    character(len=:), allocatable :: y_label       !< of the axis upwards
    logical :: equal_scales = .false.              !< both axes are lengths
    logical :: is_error = .false.                  !< differences are shown, as lines from zero
    real(wp), allocatable :: curve(:, :)           !< (n,2) motion of the design; not used for differences
    real(wp), allocatable :: targets(:, :)         !< (m,4) places of the targets, and directions; the differences in column 2
    real(wp), allocatable :: reached(:, :)         !< (m,4) places of the design at the times of the targets, and directions
  end type fit_panel_type

  character, parameter :: line_end = achar(10)
  !> Most targets that are numbered in a plane, and along a function, where their order can be seen.
  integer, parameter :: most_in_plane = 60, most_of_function = 12
  !> Room of a digit, and the height of a number [px].
  real(wp), parameter :: digit = 9.0_wp, line_height = 15.0_wp
  !> Room around the area between the axes of a panel: at its left and right, above and below [px]; above all of several panels, and of
  !> a line of the title of one.
  integer, parameter :: beside(2) = [100, 30], above = 36, below = 116, head = 46, title_line = 20
  !> Place of the legend above the lower end of a panel [px].
  integer, parameter :: legend = 16
  !> Half of an axis with equal scales, in parts of the length of the values: directions are drawn beyond these.
  real(wp), parameter :: half_axis = 0.62_wp
  !> Length of a direction in parts of the size of the targets.
  real(wp), parameter :: arrow = 0.08_wp

contains

  !> The script of a picture. Users can run it again, and its first line tells how.
  pure function fit_script(title, panels, picture, script) result(text)
    character(len=*), intent(in) :: title              !< title of the mechanism
    type(fit_panel_type), intent(in) :: panels(:)      !< at least one
    character(len=*), intent(in) :: picture            !< name of the file of the picture, without its folder
    character(len=*), intent(in) :: script             !< name of the file of the script, without its folder
    character(len=:), allocatable :: text
    type(string_type), allocatable :: lines(:)
    integer :: i, across, down, width, height, first
    integer :: boxes(4, size(panels))

    call find_layout(size(panels), across, down, width, height)
    lines = picture_title(title, picture, width)
    text = '# gnuplot '//printable(script)//' draws '//printable(picture)//line_end//'set encoding utf8'//line_end// &
           picture_terminal(picture, width, height)//line_end//'set output '//quoted_path(picture)//line_end//plot_style()
    first = head
    if (size(panels) == 1) first = title_line*size(lines)
    do i = 1, size(panels)
      boxes(:, i) = [mod(i - 1, across)*(width/across) + beside(1), (mod(i - 1, across) + 1)*(width/across) - beside(2), &
                     height - first - ((i - 1)/across + 1)*((height - first)/down) + below, &
                     height - first - ((i - 1)/across)*((height - first)/down) - above]
      text = text//blocks_of(i, panels(i))//numbers_of(i, panels(i), real(boxes(2:4:2, i) - boxes(1:3:2, i), wp))
    end do
    if (size(panels) == 1) then
      text = text//'set title '//quoted_lines(lines)//line_end
    else
      text = text//'set multiplot layout '//to_text(down)//','//to_text(across)//' title '//quoted_lines(lines)//line_end
    end if
    do i = 1, size(panels)
      if (size(panels) > 1) text = text//'set title '//quoted(panels(i)%title)//line_end
      text = text//margins_of(boxes(:, i), width, height)//axes_of(panels(i), boxes(:, i))//curves_of(i, panels(i))
    end do
    if (size(panels) > 1) text = text//'unset multiplot'//line_end
    text = text//'unset output'//line_end
  end function fit_script

  !> The script of panels in letters, one below the other.
  pure function fit_terminal_script(panels, columns, lines) result(text)
    type(fit_panel_type), intent(in) :: panels(:)      !< at least one
    integer, intent(in) :: columns                     !< width of each panel in letters
    integer, intent(in) :: lines                       !< height of each panel in lines
    character(len=:), allocatable :: text
    integer :: i

    text = 'set encoding utf8'//line_end//'set terminal dumb mono noenhanced size '//to_text(columns)//','//to_text(lines)// &
           line_end//'unset key'//line_end//'set tics nomirror'//line_end
    do i = 1, size(panels)
      text = text//blocks_of(i, panels(i))//'set title '//quoted(panels(i)%title)//line_end//'plot '
      if (.not. panels(i)%is_error) text = text//name_of('curve', i)//' using 1:2 with lines, '
      text = text//name_of('targets', i)//' using 1:2 with points pt 15'//line_end
    end do
  end function fit_terminal_script

  !> The name of a block of data of a panel.
  pure function name_of(kind, i) result(name)
    character(len=*), intent(in) :: kind   !< of the block
    integer, intent(in) :: i               !< number of the panel
    character(len=:), allocatable :: name

    name = '$'//kind//to_text(i)
  end function name_of

  !> The data of a panel: the curve; the targets with their directions and numbers, and so the places reached; the gaps between
  !> both.
  pure function blocks_of(i, panel) result(text)
    integer, intent(in) :: i                      !< number of the panel
    type(fit_panel_type), intent(in) :: panel     !< the panel
    character(len=:), allocatable :: text
    integer :: k, m
    real(wp) :: size_of_targets

    m = size(panel%targets, 1)
    text = ''
    if (.not. panel%is_error) text = block_of(name_of('curve', i), panel%curve)
    size_of_targets = norm2([maxval(panel%targets(:, 1)) - minval(panel%targets(:, 1)), &
                             maxval(panel%targets(:, 2)) - minval(panel%targets(:, 2))])
    text = text//block_of(name_of('targets', i), reshape([panel%targets(:, :2), arrow*size_of_targets*panel%targets(:, 3:), &
                                                          reshape([(real(k, wp), k=1, m)], [m, 1])], [m, 5]))
    if (panel%is_error) return
    text = text//block_of(name_of('reached', i), reshape([panel%reached(:, :2), arrow*size_of_targets*panel%reached(:, 3:)], &
                                                         [m, 4]))// &
           block_of(name_of('gaps', i), reshape([panel%targets(:, :2), panel%reached(:, :2) - panel%targets(:, :2)], [m, 4]))
  end function blocks_of

  !> The numbers that are written beside targets, with their places.
  pure function numbers_of(i, panel, sides) result(text)
    integer, intent(in) :: i                      !< number of the panel
    type(fit_panel_type), intent(in) :: panel     !< the panel
    real(wp), intent(in) :: sides(2)              !< width and height of the area between its axes [px]
    character(len=:), allocatable :: text
    integer, allocatable :: shown(:)

    text = ''
    if (.not. is_numbered(panel)) return
    shown = numbers_with_room(panel, sides)
    text = block_of(name_of('numbers', i), reshape([panel%targets(shown, :2), real(shown, wp)], [size(shown), 3]))
  end function numbers_of

  !> Whether the targets of a panel are numbered.
  pure logical function is_numbered(panel)
    type(fit_panel_type), intent(in) :: panel     !< the panel

    is_numbered = .not. panel%is_error .and. &
                  size(panel%targets, 1) <= merge(most_in_plane, most_of_function, panel%equal_scales)
  end function is_numbered

  !> The targets whose numbers do not cover each other: the first and the last one before those between.
  pure function numbers_with_room(panel, sides) result(shown)
    type(fit_panel_type), intent(in) :: panel     !< the panel
    real(wp), intent(in) :: sides(2)              !< width and height of the area between its axes [px]
    integer, allocatable :: shown(:)
    logical :: has_room(size(panel%targets, 1))
    real(wp) :: places(size(panel%targets, 1), 2), ends(2, 2), scale(2)
    integer :: i, k, m

    m = size(panel%targets, 1)
    ends = reshape([ends_of(panel, 1), ends_of(panel, 2)], [2, 2])
    scale = sides/max(ends(2, :) - ends(1, :), tiny(1.0_wp))
    if (panel%equal_scales) scale = minval(scale)/(2.0_wp*half_axis)
    places = panel%targets(:, :2)*spread(scale, 1, m)
    has_room = .false.
    do k = 1, m
      i = modulo(k - 2, m) + 1
      has_room(i) = all(abs(places(:, 1) - places(i, 1)) >= digit*len(to_text(m)) .or. &
                        abs(places(:, 2) - places(i, 2)) >= line_height .or. .not. has_room)
    end do
    shown = pack([(i, i=1, m)], has_room)
  end function numbers_with_room

  !> The commands for the place of a panel, and of its legend below it.
  pure function margins_of(box, width, height) result(text)
    integer, intent(in) :: box(4)                 !< left, right, lower and upper side of the area between the axes [px]
    integer, intent(in) :: width                  !< of the picture [px]
    integer, intent(in) :: height                 !< of the picture [px]
    character(len=:), allocatable :: text

    text = 'set lmargin at screen '//part(box(1), width)//line_end//'set rmargin at screen '//part(box(2), width)//line_end// &
           'set bmargin at screen '//part(box(3), height)//line_end//'set tmargin at screen '//part(box(4), height)//line_end// &
           'set key at screen '//part((box(1) + box(2))/2, width)//', screen '//part(box(3) - below + legend, height)// &
           ' center center horizontal Left reverse samplen 2'//line_end
  end function margins_of

  !> A part of a length as text.
  pure function part(place, length) result(text)
    integer, intent(in) :: place    !< distance from its beginning [px]
    integer, intent(in) :: length   !< the length [px]
    character(len=:), allocatable :: text

    text = to_text(real(place, wp)/length, 6)
  end function part

  !> The commands for the axes of a panel. Ranges with equal scales fill its area.
  pure function axes_of(panel, box) result(text)
    type(fit_panel_type), intent(in) :: panel     !< the panel
    integer, intent(in) :: box(4)                 !< left, right, lower and upper side of the area between the axes [px]
    character(len=:), allocatable :: text
    real(wp) :: x(2), y(2), scale

    x = ends_of(panel, 1)
    y = ends_of(panel, 2)
    text = 'set xlabel '//quoted(panel%x_label)//line_end//'set ylabel '//quoted(panel%y_label)//line_end// &
           'set format x '//axis_format(x)//line_end//'set format y '//axis_format(y)//line_end// &
           merge('set size ratio -1', 'set size noratio ', panel%equal_scales)//line_end
    if (panel%equal_scales) then
      scale = half_axis*max((x(2) - x(1))/(box(2) - box(1)), (y(2) - y(1))/(box(4) - box(3)))
      x = 0.5_wp*(x(1) + x(2)) + scale*(box(2) - box(1))*[-1.0_wp, 1.0_wp]
      y = 0.5_wp*(y(1) + y(2)) + scale*(box(4) - box(3))*[-1.0_wp, 1.0_wp]
    end if
    text = text//axis_commands('x', x, unit_in(panel%x_label), box(2) - box(1), panel%equal_scales)// &
           axis_commands('y', y, unit_in(panel%y_label), box(4) - box(3), panel%equal_scales)
  end function axes_of

  !> The unit at the end of a label, between brackets; empty where there is none.
  pure function unit_in(label) result(unit)
    character(len=*), intent(in) :: label   !< such as q1 [deg]
    character(len=:), allocatable :: unit
    integer :: from

    from = index(label, '[', back=.true.)
    unit = ''
    if (from > 0) unit = label(from + 1:max(from, len_trim(label) - 1))
  end function unit_in

  !> Least and greatest number on an axis.
  pure function ends_of(panel, axis) result(ends)
    type(fit_panel_type), intent(in) :: panel     !< the panel
    integer, intent(in) :: axis                   !< 1 or 2
    real(wp) :: ends(2)

    ends = [minval(panel%targets(:, axis)), maxval(panel%targets(:, axis))]
    if (panel%is_error) return
    ends = [min(ends(1), minval(panel%curve(:, axis))), max(ends(2), maxval(panel%curve(:, axis)))]
  end function ends_of

  !> The command that draws a panel.
  pure function curves_of(i, panel) result(text)
    integer, intent(in) :: i                      !< number of the panel
    type(fit_panel_type), intent(in) :: panel     !< the panel
    character(len=:), allocatable :: text
    character(len=*), parameter :: next = ', \'//line_end//'     '

    if (panel%is_error) then
      text = 'plot '//name_of('targets', i)//' using 1:2 with impulses lw 1.5 lc rgb '''//first_colour//''' notitle'//next// &
             name_of('targets', i)//' using 1:2 with points pt 7 ps 0.5 lc rgb '''//first_colour// &
             ''' title ''best design less target'''//line_end
      return
    end if
    text = 'plot '//name_of('curve', i)//' using 1:2 with lines lw 2 lc rgb '''//first_colour//''' title ''best design'''//next// &
           name_of('gaps', i)//' using 1:2:3:4 with vectors nohead lw 1 lc rgb ''#404040'' notitle'//next// &
           name_of('reached', i)//' using 1:2 with points pt 6 ps 0.6 lc rgb '''//first_colour//''' notitle'//next// &
           name_of('targets', i)//' using 1:2 with points pt 7 ps 0.6 lc rgb '''//second_colour//''' title ''targets'''
    if (any(abs(panel%targets(:, 3:)) > 0.0_wp)) &
      text = text//next//name_of('reached', i)//' using 1:2:3:4 with vectors nohead lw 2 lc rgb '''//first_colour//''' notitle'// &
             next//name_of('targets', i)//' using 1:2:3:4 with vectors nohead lw 2 lc rgb '''//second_colour//''' notitle'
    if (is_numbered(panel)) &
      text = text//next//name_of('numbers', i)// &
             ' using 1:2:(sprintf(''%.0f'', $3)) with labels offset character 1,0.5 font '',10'' tc rgb ''#404040'' notitle'
    text = text//line_end
  end function curves_of
end module mech9_fit_script
