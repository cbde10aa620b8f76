!> A film as an animated GIF, which gnuplot draws, and frames of a video.
!>
!> gnuplot is given polygons and circles only. Lines are polygons that run forth and back; bands and plates are drawn as
!> their outlines.
module mech9_gif_film
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, raise, add_place, exit_file
  use mech9_text, only: string_type, to_text
  use mech9_film, only: film_type
  use mech9_film_clock, only: clock_decimals, clock_text
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, item_type, closed_path, facing_path, mark, label, in_pin, in_cross, in_cam, in_stop, &
                         in_pushed, as_stand, as_ring, as_ball, as_dot, as_centre, as_free, as_name, as_number, &
                         as_input, as_leader, as_coil, as_cup, as_stuck, as_sphere, as_pole, in_surface, &
                         in_pairs
  use mech9_drawing, only: drawing_type, draw_frame, drawing_order, outline_of
  use mech9_picture_style, only: style_type, styles, dark_colours, light_colours, signal, light_signal, colour_of, ink, &
                                  edge, coil_corners, cup_corners
  use mech9_svg_film, only: duration_of
  use mech9_svg_picture, only: scale_length, axis_length, beyond_axis, shortest_axis
  use mech9_gnuplot, only: quoted, quoted_path, run_gnuplot, gnuplot_package
  use mech9_title_lines, only: title_lines
  use mech9_page, only: page_type
  use mech9_xml_text, only: decimal
  implicit none
  private
  public :: save_gif_film, script_type, begin_script, put_frame

  !> The largest number of frames; a GIF of more frames would be too large for its use.
  integer, parameter :: most_frames = 120
  !> The number of dots for each px of other pictures. Programs that show the picture smaller smooth the edges of a GIF,
  !> which gnuplot does not do.
  real(wp), parameter :: zoom = 1.5_wp
  !> The font: any one without serifs that can be scaled, and its size [pt].
  character(len=*), parameter :: font = 'sans,12'
  character(len=*), parameter :: grey = '#d0d0d0', pale = '#ececec', white = '#ffffff', hatch = '#555555', thin = '#777777', &
                                 none = ''
  !> The number of steps in a quarter of a circle.
  integer, parameter :: quarter = 4

  !> The script that is being written, and the number of the latest object in it.
  type :: script_type
    type(page_type) :: page
    integer :: objects = 0
    real(wp) :: symbol = 1.0_wp
  contains
    procedure :: polygon
    procedure :: circle
    procedure :: polyline
  end type script_type

contains

  !> Draw the film by gnuplot. Errors are exit_file, also if gnuplot is not installed.
  subroutine save_gif_film(path, title, scene, film, projection, err)
    character(len=*), intent(in) :: path               !< name of the file
    character(len=*), intent(in) :: title              !< title of the mechanism, any text
    type(scene_type), intent(in) :: scene              !< nodes and items of the picture
    type(film_type), intent(in) :: film                !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection    !< from space to the page
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(script_type) :: script
    logical :: found
    integer :: stride, frames, i, delay, decimals

    stride = (film%n_frames + most_frames - 1)/most_frames
    frames = (film%n_frames + stride - 1)/stride
    delay = max(2, nint(100.0_wp*duration_of(film)/frames))
    call begin_script('gif animate delay '//to_text(delay)//' loop 0', zoom, path, projection, script)
    decimals = clock_decimals(film)
    do i = 1, frames
      call put_frame(title, scene, film, projection, 1 + (i - 1)*stride, decimals, script)
    end do
    call script%page%line('unset output')
    call run_gnuplot(script%page%text(), found, err, picture=path)
    if (.not. allocated(err) .and. .not. found) &
      call raise(err, exit_file, 'a GIF is drawn by gnuplot, which is not here; install '//gnuplot_package// &
                 ', or let the name end in .html or .svg')
    call add_place(err, 'no moving picture '//path)
  end subroutine save_gif_film

  !> Begin the script of frames: a page without axes, on which places are px of other pictures.
  subroutine begin_script(terminal, zoom, path, projection, script)
    character(len=*), intent(in) :: terminal         !< terminal of gnuplot, with settings of its own
    real(wp), intent(in) :: zoom                     !< dots for each px of other pictures
    character(len=*), intent(in) :: path             !< file that gnuplot writes
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(script_type), intent(out) :: script         !< the script

    script%symbol = projection%symbol
    call script%page%line('set terminal '//terminal//' size '//to_text(nint(zoom*projection%width))//','// &
                          to_text(nint(zoom*projection%height))//' noenhanced font "'//font//'" linewidth '//decimal(zoom))
    call script%page%line('set output '//quoted_path(path))
    call script%page%line('unset border; unset tics; unset key; set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0')
    call script%page%line('set xrange [0:'//decimal(projection%width)//']; set yrange ['//decimal(projection%height)//':0]')
  end subroutine begin_script

  !> Append one frame of the film to the script.
  subroutine put_frame(title, scene, film, projection, frame, decimals, script)
    character(len=*), intent(in) :: title            !< title of the mechanism, any text
    type(scene_type), intent(in) :: scene            !< nodes and items of the picture
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: frame                     !< number of the frame in the film
    integer, intent(in) :: decimals                  !< decimals of the clock
    type(script_type), intent(inout) :: script       !< script to which the commands are appended
    type(drawing_type) :: drawing
    integer, allocatable :: order(:)
    integer :: i

    drawing = draw_frame(scene, film, projection, frame)
    order = drawing_order(scene, drawing)
    script%objects = 0
    call script%page%line('unset object; unset label')
    call put_title(title, projection%width, script)
    call put_text(clock_text(film%times(frame), decimals), [90.0_wp, projection%height - 16.0_wp], 'left', ink, script)
    call put_scale(projection, script)
    call put_axes(projection, script)
    do i = 1, size(order)
      associate (item => scene%items(order(i)))
        if (.not. scene%shows(item, frame)) cycle
        select case (item%shape)
        case (mark)
          call put_mark(item, drawing%xy(:, item%nodes(1)), script)
        case (label)
          call put_label(item, drawing%xy(:, item%nodes(1)) + item%shift, script)
        case default
          call put_path(item, outline_of(item, drawing, projection%symbol), script)
        end select
      end associate
    end do
    call script%page%line('plot NaN notitle')
  end subroutine put_frame

  !> Draw the bar of the scale.
  subroutine put_scale(projection, script)
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(script_type), intent(inout) :: script       !< script to which the commands are appended
    real(wp) :: right, left, foot

    right = projection%width - 90.0_wp
    left = right - projection%scale*scale_length(projection)
    foot = projection%height - 14.0_wp
    call script%polyline(reshape([left, foot - 5.0_wp, left, foot, right, foot, right, foot - 5.0_wp], [2, 4]), ink, 1.5_wp)
    call put_text(to_text(scale_length(projection)/projection%length, 3)//' '//trim(projection%length_name), &
                  [right + 8.0_wp, foot - 2.0_wp], 'left', ink, script)
  end subroutine put_scale

  !> Draw the axes of link 1, except an axis that points to the viewer.
  subroutine put_axes(projection, script)
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(script_type), intent(inout) :: script       !< script to which the commands are appended
    character, parameter :: names(3) = ['x', 'y', 'z']
    real(wp) :: foot(2), tip(2)
    integer :: i

    foot = [38.0_wp, projection%height - 36.0_wp]
    do i = 1, 3
      tip = axis_length*[projection%view%right(i), -projection%view%up(i)]
      if (norm2(tip) < shortest_axis) cycle
      call script%polyline(reshape([foot, foot + tip], [2, 2]), ink, 1.2_wp)
      call put_text(names(i), foot + beyond_axis*tip, 'center', ink, script)
    end do
  end subroutine put_axes

  !> Draw the title, in two lines if one has no room for it. Fonts of GIFs have only one size.
  subroutine put_title(title, width, script)
    character(len=*), intent(in) :: title       !< title of the mechanism, any text
    real(wp), intent(in) :: width               !< width of the picture [px]
    type(script_type), intent(inout) :: script  !< script to which the commands are appended
    real(wp), parameter :: letter = 7.0_wp, line = 16.0_wp
    type(string_type), allocatable :: lines(:)
    integer :: i

    lines = title_lines(title, nint((width - 28.0_wp)/letter), 2)
    do i = 1, size(lines)
      call put_text(lines(i)%text, [14.0_wp, 4.0_wp + line*i], 'left', ink, script)
    end do
  end subroutine put_title

  !> Draw a polygon. It is not filled if the colour of its inside is empty.
  subroutine polygon(self, corners, fill, line, width)
    class(script_type), intent(inout) :: self  !< script to which the commands are appended
    real(wp), intent(in) :: corners(:, :)      !< (2,n) corners of the polygon [px]
    character(len=*), intent(in) :: fill       !< colour of the inside; empty: not filled
    character(len=*), intent(in) :: line       !< colour of the line
    real(wp), intent(in) :: width              !< width of the border [px]
    integer :: i

    if (size(corners, 2) < 2) return
    self%objects = self%objects + 1
    call self%page%put('set object '//to_text(self%objects)//' polygon from ')
    do i = 1, size(corners, 2)
      call self%page%put(decimal(corners(1, i))//','//decimal(corners(2, i))//' to ')
    end do
    call self%page%put(decimal(corners(1, 1))//','//decimal(corners(2, 1)))
    if (fill == none) then
      call self%page%put(' fs empty')
    else
      call self%page%put(' fc rgb "'//fill//'" fs solid 1')
    end if
    call self%page%line(' border lc rgb "'//line//'" lw '//decimal(width))
  end subroutine polygon

  !> Draw a line from corner to corner, as a polygon that runs forth and back.
  subroutine polyline(self, corners, line, width)
    class(script_type), intent(inout) :: self  !< script to which the commands are appended
    real(wp), intent(in) :: corners(:, :)      !< (2,n) corners of the line [px]
    character(len=*), intent(in) :: line       !< colour of the line
    real(wp), intent(in) :: width              !< width of the line [px]
    integer :: order(max(0, 2*size(corners, 2) - 1))

    order = forth_and_back(size(corners, 2))
    call self%polygon(corners(:, order), none, line, width)
  end subroutine polyline

  !> The numbers from 1 to n and back to 1.
  pure function forth_and_back(n) result(numbers)
    integer, intent(in) :: n  !< number of corners
    integer :: numbers(max(0, 2*n - 1))
    integer :: i

    numbers = [(i, i=1, n), (i, i=n - 1, 1, -1)]
  end function forth_and_back

  !> Draw a filled circle.
  subroutine circle(self, centre, radius, fill, line, width)
    class(script_type), intent(inout) :: self  !< script to which the commands are appended
    real(wp), intent(in) :: centre(2)          !< centre of the circle [px]
    real(wp), intent(in) :: radius             !< radius of the circle [px]
    character(len=*), intent(in) :: fill       !< colour of the inside; empty: not filled
    character(len=*), intent(in) :: line       !< colour of the line
    real(wp), intent(in) :: width              !< width of the line [px]

    self%objects = self%objects + 1
    call self%page%line('set object '//to_text(self%objects)//' circle at '//decimal(centre(1))//','//decimal(centre(2))// &
                        ' size '//decimal(radius)//' fc rgb "'//fill//'" fs solid 1 border lc rgb "'//line//'" lw '// &
                        decimal(width))
  end subroutine circle

  !> Draw an item that is a path, plate, band or spring.
  subroutine put_path(item, corners, script)
    type(item_type), intent(in) :: item         !< one thing to draw
    real(wp), intent(in) :: corners(:, :)       !< (2,n) corners of the item [px]
    type(script_type), intent(inout) :: script  !< script to which the commands are appended
    character(len=7) :: dark, light
    integer :: i

    dark = styles(item%style)%colour
    if (dark == '') dark = dark_colours(colour_of(item%link))
    light = light_colours(colour_of(item%link))
    if (item%style == in_pin .or. item%style == in_cross) light = grey
    if (item%style == in_pushed) light = light_signal
    associate (style => styles(item%style))
      if (item%shape == facing_path) then
        call script%polygon(corners, white, dark, style%width)
      else if (item%style == in_surface) then
        call script%polygon(corners, pale, dark, style%width)
      else if (item%style == in_cam) then
        call script%polygon(corners, light, dark, edge)
      else if (item%style == in_stop .or. item%style == in_pushed) then
        ! a plate is often seen along one of its sides
        call script%polygon(band(distinct(corners), 0.5_wp*style%width*script%symbol), light, dark, edge)
      else if (item%shape == closed_path) then
        call script%polygon(band(corners, 0.5_wp*style%width*script%symbol), light, dark, edge)
      else if (in_pairs(item) .or. style%has_edge) then
        do i = 1, size(corners, 2) - 1, 2
          call put_segment(style, corners(:, i:i + 1), light, dark, script)
        end do
      else
        call script%polyline(corners, dark, style%width)
      end if
    end associate
  end subroutine put_path

  !> The corners of a path without those that follow one at the same place; at least two.
  pure function distinct(corners) result(kept)
    real(wp), intent(in) :: corners(:, :)    !< (2,n) corners of a closed path, at least two [px]
    real(wp), allocatable :: kept(:, :)
    real(wp), parameter :: least = 0.05_wp
    logical :: apart(size(corners, 2))
    integer :: i, n

    n = size(corners, 2)
    apart = [(norm2(corners(:, i) - corners(:, 1 + modulo(i - 2, n))) > least, i=1, n)]
    if (count(apart) < 2) apart(:2) = .true.
    kept = corners(:, pack([(i, i=1, n)], apart))
  end function distinct

  !> Draw one segment of an item: a line, or a band with cut or round ends.
  subroutine put_segment(style, ends, light, dark, script)
    type(style_type), intent(in) :: style       !< style of the item
    real(wp), intent(in) :: ends(2, 2)          !< (2,2) the two ends [px]
    character(len=*), intent(in) :: light       !< colour of the inside
    character(len=*), intent(in) :: dark        !< colour of the edge
    type(script_type), intent(inout) :: script  !< script to which the commands are appended
    real(wp) :: half(2)

    if (.not. style%has_edge) then
      call script%polyline(ends, dark, style%width)
    else if (style%butt) then
      half = ends(:, 2) - ends(:, 1)
      half = 0.5_wp*style%width*script%symbol*[-half(2), half(1)]/max(norm2(half), 1.0e-6_wp)
      call script%polygon(reshape([ends(:, 1) + half, ends(:, 2) + half, ends(:, 2) - half, ends(:, 1) - half], [2, 4]), &
                          light, dark, edge)
    else
      call script%polygon(band(ends, 0.5_wp*style%width*script%symbol), light, dark, edge)
    end if
  end subroutine put_segment

  !> The outline at a distance around a convex plate, or around a bar with two ends.
  pure function band(corners, radius) result(around)
    real(wp), intent(in) :: corners(:, :)  !< (2,n) corners of the plate, or the two ends of the bar [px]
    real(wp), intent(in) :: radius         !< distance of the outline from the corners [px]
    real(wp), allocatable :: around(:, :)
    real(wp) :: before(2), after(2), from, sweep, sense
    integer :: n, i, j

    n = size(corners, 2)
    allocate (around(2, n*(2*quarter + 1)))
    sense = sign(1.0_wp, sum([(corners(1, i)*corners(2, 1 + mod(i, n)) - corners(2, i)*corners(1, 1 + mod(i, n)), i=1, n)]))
    do i = 1, n
      before = corners(:, i) - corners(:, 1 + mod(i + n - 2, n))
      after = corners(:, 1 + mod(i, n)) - corners(:, i)
      ! the outside is on the right or on the left, by the sense in which the corners run
      from = atan2(-sense*before(1), sense*before(2))
      sweep = atan2(-sense*after(1), sense*after(2)) - from
      sweep = sense*modulo(sense*sweep, 2.0_wp*pi)
      do j = 0, 2*quarter
        around(:, (i - 1)*(2*quarter + 1) + j + 1) = corners(:, i) + radius*[cos(from + sweep*j/(2*quarter)), &
                                                                            sin(from + sweep*j/(2*quarter))]
      end do
    end do
  end function band

  !> Draw a mark like that of mech9_picture_style.
  subroutine put_mark(item, at, script)
    type(item_type), intent(in) :: item         !< one thing to draw
    real(wp), intent(in) :: at(2)               !< place on the page [px]
    type(script_type), intent(inout) :: script  !< script to which the commands are appended
    real(wp) :: s, down
    integer :: i

    s = script%symbol
    select case (item%style)
    case (as_stand)
      down = sign(15.0_wp, item%shift(2))*s
      call script%polygon(reshape([at, at + [-9.0_wp*s, down], at + [9.0_wp*s, down]], [2, 3]), '#e8e8e8', ink, 1.5_wp)
      call script%polyline(reshape([at + [-14.0_wp*s, down], at + [14.0_wp*s, down]], [2, 2]), ink, 1.5_wp)
      do i = -2, 2
        call script%polyline(reshape([at + [6*i*s, down], at + [(6*i - 4)*s, 1.4_wp*down]], [2, 2]), hatch, 1.0_wp)
      end do
    case (as_ring)
      call script%circle(at, 5.0_wp*s, white, ink, 1.5_wp)
    case (as_ball)
      call script%circle(at, 7.5_wp*s, grey, ink, 1.5_wp)
    case (as_dot)
      call script%circle(at, 3.2_wp*s, dark_colours(colour_of(item%link)), ink, 0.5_wp)
    case (as_centre)
      call script%circle(at, 4.6_wp*s, white, ink, 1.5_wp)
      call script%circle(at, 1.5_wp*s, ink, ink, 1.0_wp)
    case (as_stuck)
      call script%circle(at, 3.4_wp*s, signal, ink, 0.5_wp)
    case (as_sphere)
      call script%circle(at, s*item%shift(1), light_colours(colour_of(item%link)), thin, 1.2_wp)
    case (as_pole)
      call script%circle(at, 4.0_wp*s, white, ink, 1.5_wp)
      call script%polyline(reshape([at - [9.0_wp*s, 0.0_wp], at + [9.0_wp*s, 0.0_wp]], [2, 2]), ink, 1.4_wp)
      call script%polyline(reshape([at - [0.0_wp, 9.0_wp*s], at + [0.0_wp, 9.0_wp*s]], [2, 2]), ink, 1.4_wp)
    case (as_leader)
      call script%polyline(reshape([at, at + s*item%shift], [2, 2]), thin, 0.8_wp)
    case (as_coil)
      call script%polyline(spread(at, 2, 41) + s*coil_corners(), ink, 1.4_wp)
    case (as_cup)
      call script%polyline(spread(at, 2, 15) + s*cup_corners(), ink, 1.4_wp)
      call script%polyline(reshape([at, at - [0.0_wp, 14.0_wp*s]], [2, 2]), ink, 1.4_wp)
    case (as_free)
      call script%polygon(reshape([at(1), at(2) - 7*s, at(1) + 7*s, at(2), at(1), at(2) + 7*s, at(1) - 7*s, at(2)], [2, 4]), &
                          white, ink, 1.5_wp)
    end select
  end subroutine put_mark

  !> Draw a label of the scene.
  subroutine put_label(item, at, script)
    type(item_type), intent(in) :: item         !< one thing to draw
    real(wp), intent(in) :: at(2)               !< place on the page [px]
    type(script_type), intent(inout) :: script  !< script to which the commands are appended
    !> gnuplot puts the middle of a text at its place; other pictures put its baseline there.
    real(wp), parameter :: to_middle(2) = [0.0_wp, -3.5_wp]
    character(len=7) :: colour

    colour = ink
    if (item%link > 0) colour = dark_colours(colour_of(item%link))
    if (item%style == as_input) colour = dark_colours(2)
    select case (item%style)
    case (as_name)
      call put_text(item%text, at + to_middle, 'left', colour, script)
    case (as_number)
      call put_text(item%text, at, 'center', colour, script)
    case default
      call put_text(item%text, at + to_middle, 'right', colour, script)
    end select
  end subroutine put_label

  !> Draw a text at a place.
  subroutine put_text(text, at, side, colour, script)
    character(len=*), intent(in) :: text        !< any text
    real(wp), intent(in) :: at(2)               !< place on the page [px]
    character(len=*), intent(in) :: side        !< alignment: left, center or right
    character(len=*), intent(in) :: colour      !< colour of the text
    type(script_type), intent(inout) :: script  !< script to which the commands are appended

    call script%page%line('set label '//quoted(text)//' at '//decimal(at(1))//','//decimal(at(2))//' '//side// &
                          ' noenhanced front textcolor rgb "'//colour//'"')
  end subroutine put_text
end module mech9_gif_film
