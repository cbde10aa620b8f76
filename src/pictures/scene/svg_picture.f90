!> A frame of a film as a picture in SVG, alone or as the part of a page that a script moves.
module mech9_svg_picture
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_film, only: film_type
  use mech9_film_clock, only: clock_decimals, clock_text
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, item_type, closed_path, facing_path, mark, label, in_pairs, in_stop, in_pushed, &
                         as_stuck, in_force, in_velocity, in_acceleration, in_surface, as_sphere, &
                         in_target, as_pole, in_moment, in_load, in_weight, in_touching
  use mech9_drawing, only: drawing_type, draw_frame, drawing_order, outline_of
  use mech9_picture_style, only: styles, colour_of, style_sheet, mark_svg
  use mech9_page, only: page_type
  use mech9_title_lines, only: title_lines
  use mech9_xml_text, only: xml_text, decimal
  implicit none
  private
  public :: save_sketch, put_picture, put_opening, put_item, put_surroundings, opening_of, tooltip_of, label_svg, path_of, &
            place_of, scale_length

  !> The length of the axes in the corner [px], and the distance of their names as a multiple of this length.
  real(wp), parameter, public :: axis_length = 26.0_wp, beyond_axis = 1.36_wp
  !> Axes that are seen shorter than this are taken to point to the viewer [px].
  real(wp), parameter, public :: shortest_axis = 2.0_wp

  !> The widths of a letter of a title and of a small letter [px].
  real(wp), parameter :: title_letter = 9.0_wp, small_letter = 6.6_wp

contains

  !> Write one frame of the film as a separate picture. Errors are exit_file.
  subroutine save_sketch(path, title, scene, film, projection, frame, err)
    character(len=*), intent(in) :: path               !< name of the file
    character(len=*), intent(in) :: title              !< title of the mechanism, any text
    type(scene_type), intent(in) :: scene              !< nodes and items of the picture
    type(film_type), intent(in) :: film                !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection    !< from space to the page
    integer, intent(in) :: frame                       !< number of the frame in the film
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(page_type) :: page

    call page%line('<?xml version="1.0" encoding="UTF-8"?>')
    call put_picture(title, scene, film, projection, frame, .false., page)
    call page%save(path, err)
  end subroutine save_sketch

  !> Append the picture of one frame to a page.
  subroutine put_picture(title, scene, film, projection, frame, is_turned, page)
    character(len=*), intent(in) :: title           !< title of the mechanism, any text
    type(scene_type), intent(in) :: scene           !< nodes and items of the picture
    type(film_type), intent(in) :: film             !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection !< from space to the page
    integer, intent(in) :: frame                    !< number of the frame in the film
    logical, intent(in) :: is_turned                !< a script turns and moves it: it needs all axes, and the items of other frames
    type(page_type), intent(inout) :: page          !< text to which the picture is appended
    type(drawing_type) :: drawing
    integer, allocatable :: order(:)
    integer :: i

    call put_opening(title, projection, page)
    drawing = draw_frame(scene, film, projection, frame)
    order = drawing_order(scene, drawing)
    call page%line('<g id="scene">')
    do i = 1, size(order)
      ! a stop that pushes is shown by films alone
      if (is_turned .or. scene%items(order(i))%state == 0 .or. &
          (scene%items(order(i))%style == as_pole .and. scene%shows(scene%items(order(i)), frame))) &
        call put_item(scene%items(order(i)), order(i), drawing, projection%symbol, page)
    end do
    call page%line('</g>')
    call put_surroundings(title, projection, is_turned, page)
    if (film%n_frames > 1) &
      call page%line('<text class="small" id="time" x="90" y="'//decimal(projection%height - 12.0_wp)//'">'// &
                     clock_text(film%times(frame), clock_decimals(film))//'</text>')
    call page%line('</svg>')
  end subroutine put_picture

  !> Append the beginning of a picture, up to its items, to a page.
  subroutine put_opening(title, projection, page)
    character(len=*), intent(in) :: title            !< title of the mechanism, any text
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(page_type), intent(inout) :: page           !< text to which the picture is appended

    call page%line('<svg xmlns="http://www.w3.org/2000/svg" class="mech9" viewBox="0 0 '//decimal(projection%width)//' '// &
                   decimal(projection%height)//'" width="'//decimal(projection%width)//'" height="'// &
                   decimal(projection%height)//'">')
    call page%line('<title>'//xml_text(title)//'</title>')
    call page%put('<style>'//new_line('a')//style_sheet(projection%symbol))
    call page%line('</style>')
    call page%line('<rect width="100%" height="100%" fill="#ffffff"/>')
  end subroutine put_opening

  !> Append one item of the scene; scripts find it by its `number`.
  subroutine put_item(item, number, drawing, symbol, page)
    type(item_type), intent(in) :: item        !< one thing to draw
    integer, intent(in) :: number              !< number of the item in the scene
    type(drawing_type), intent(in) :: drawing  !< places of the nodes on the page
    real(wp), intent(in) :: symbol             !< scale of symbols, 1 at full size
    type(page_type), intent(inout) :: page     !< text to which the picture is appended
    character(len=:), allocatable :: path

    call page%put(opening_of(item, number))
    select case (item%shape)
    case (mark)
      call page%put(' transform="translate('//place_of(item, drawing)//') scale('//to_text(symbol, 6)//')">'// &
                    tooltip_of(item)//mark_svg(item%style, item%shift)//'</g>')
    case (label)
      call page%put(' transform="translate('//place_of(item, drawing)//')">'//label_svg(item)//'</g>')
    case default
      path = '<path d="'//path_of(item, outline_of(item, drawing, symbol))//'"'
      call page%put('>'//tooltip_of(item)//path//'/>')
      if (styles(item%style)%has_edge) call page%put(path//' class="i"/>')
      call page%put('</g>')
    end select
    call page%line('')
  end subroutine put_item

  !> The opening tag of an item without its closing bracket. It holds the classes and the number of the item, and the
  !> coordinates of a joint.
  pure function opening_of(item, number) result(tag)
    type(item_type), intent(in) :: item  !< one thing to draw
    integer, intent(in) :: number        !< number of the item in the scene
    character(len=:), allocatable :: tag

    tag = '<g class="'//classes_of(item)//'" data-i="'//to_text(number)//'"'
    if (item%shape == label) tag = '<g data-i="'//to_text(number)//'"'
    if (allocated(item%text) .and. item%shape /= label .and. .not. has_tooltip(item)) tag = tag//' data-joint="'//item%text//'"'
  end function opening_of

  !> Whether a browser shows the text of an item under the pointer: it is a stop, a mark of friction, an arrow, a contact, a pose or a pole.
  pure logical function has_tooltip(item)
    type(item_type), intent(in) :: item  !< one thing to draw
    integer, parameter :: with_tooltips(*) = [in_stop, in_pushed, as_stuck, in_force, in_velocity, in_acceleration, in_surface, &
                                              as_sphere, in_target, as_pole, in_moment, in_load, in_weight, in_touching]

    has_tooltip = allocated(item%text) .and. any(item%style == with_tooltips)
  end function has_tooltip

  !> The text that a browser shows under the pointer, as a title; empty for most items.
  pure function tooltip_of(item) result(svg)
    type(item_type), intent(in) :: item  !< one thing to draw
    character(len=:), allocatable :: svg

    svg = ''
    if (has_tooltip(item)) svg = '<title>'//xml_text(item%text)//'</title>'
  end function tooltip_of

  !> The SVG of a label at the place (0, 0).
  pure function label_svg(item) result(svg)
    type(item_type), intent(in) :: item  !< one thing to draw
    character(len=:), allocatable :: svg

    svg = '<text class="'//classes_of(item)//'">'//xml_text(item%text)//'</text>'
  end function label_svg

  !> The classes of an item in the style sheet.
  pure function classes_of(item) result(classes)
    type(item_type), intent(in) :: item  !< one thing to draw
    character(len=:), allocatable :: classes

    classes = trim(styles(item%style)%name)
    if (item%shape == closed_path) classes = classes//' sheet'
    if (item%link == 1) classes = classes//' l7'
    if (item%link > 1) classes = classes//' l'//to_text(colour_of(item%link))
  end function classes_of

  !> The place of a mark or a label, as two numbers.
  pure function place_of(item, drawing) result(text)
    type(item_type), intent(in) :: item        !< one thing to draw
    type(drawing_type), intent(in) :: drawing  !< places of the nodes on the page
    character(len=:), allocatable :: text
    real(wp) :: at(2)

    at = drawing%xy(:, item%nodes(1))
    if (item%shape == label) at = at + item%shift
    text = decimal(at(1))//' '//decimal(at(2))
  end function place_of

  !> The path data of lines through the corners of an item.
  pure function path_of(item, corners) result(path)
    type(item_type), intent(in) :: item    !< one thing to draw
    real(wp), intent(in) :: corners(:, :)  !< (2,n) corners of the path [px]
    character(len=:), allocatable :: path
    character(len=24) :: corner
    integer :: i, used, length
    logical :: starts

    ! there is room for the longest numbers, since lengthening the text letter by letter would take quadratic time
    allocate (character(len=24*size(corners, 2) + 1) :: path)
    used = 0
    do i = 1, size(corners, 2)
      starts = i == 1 .or. (in_pairs(item) .and. mod(i, 2) == 1)
      corner = merge('M', 'L', starts)//decimal(corners(1, i))//' '//decimal(corners(2, i))
      length = len_trim(corner)
      path(used + 1:used + length) = corner(:length)
      used = used + length
    end do
    if (item%shape == closed_path .or. item%shape == facing_path) then
      path(used + 1:used + 1) = 'Z'
      if (size(corners, 2) > 0) used = used + 1
    end if
    path = path(:used)
  end function path_of

  !> Append the title, the scale and the axes.
  subroutine put_surroundings(title, projection, all_axes, page)
    character(len=*), intent(in) :: title            !< title of the mechanism, any text
    type(projection_type), intent(in) :: projection  !< from space to the page
    logical, intent(in) :: all_axes                  !< draw also an axis that points to the viewer
    type(page_type), intent(inout) :: page           !< text to which the picture is appended
    real(wp) :: bar, foot

    foot = projection%height - 14.0_wp
    call put_title(title, projection, page)
    bar = scale_length(projection)
    call page%line('<g id="scale"><path stroke="#222" stroke-width="1.5" d="M'//decimal(projection%width - 90.0_wp - &
                   projection%scale*bar)//' '//decimal(foot - 5.0_wp)//'v5h'//decimal(projection%scale*bar)//'v-5"/>'// &
                   '<text class="small" x="'//decimal(projection%width - 82.0_wp)//'" y="'//decimal(foot + 2.0_wp)//'">'// &
                   to_text(bar/projection%length, 3)//' '//trim(projection%length_name)//'</text></g>')
    call put_axes(projection, all_axes, page)
  end subroutine put_surroundings

  !> Append the title, in one line if it fits, otherwise in up to three smaller ones.
  subroutine put_title(title, projection, page)
    character(len=*), intent(in) :: title            !< title of the mechanism, any text
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(page_type), intent(inout) :: page           !< text to which the picture is appended
    type(string_type), allocatable :: lines(:)
    integer :: i

    lines = title_lines(title, nint((projection%width - 28.0_wp)/title_letter), 2)
    if (size(lines) == 1) then
      call page%line('<text class="title" x="14" y="24">'//xml_text(lines(1)%text)//'</text>')
      return
    end if
    lines = title_lines(title, nint((projection%width - 28.0_wp)/small_letter), 3)
    do i = 1, size(lines)
      call page%line('<text class="small" x="14" y="'//to_text(6 + 14*i)//'">'//xml_text(lines(i)%text)//'</text>')
    end do
  end subroutine put_title

  !> The length that the bar of the scale stands for [m].
  pure real(wp) function scale_length(projection)
    type(projection_type), intent(in) :: projection  !< from space to the page

    scale_length = projection%length*round_length(90.0_wp/projection%scale/projection%length)
  end function scale_length

  !> The largest of the numbers 1, 2, 5, 10, 20, ... and 0.5, 0.2, 0.1, ... that is not greater than the length.
  pure real(wp) function round_length(length)
    real(wp), intent(in) :: length  !< the length, positive, in the unit of the picture
    real(wp) :: power

    power = 10.0_wp**floor(log10(length))
    round_length = power
    if (5.0_wp*power <= length) then
      round_length = 5.0_wp*power
    else if (2.0_wp*power <= length) then
      round_length = 2.0_wp*power
    end if
  end function round_length

  !> Append the axes of link 1 as they are seen. An axis that points to the viewer is not drawn.
  subroutine put_axes(projection, all_axes, page)
    type(projection_type), intent(in) :: projection  !< from space to the page
    logical, intent(in) :: all_axes                  !< draw also an axis that points to the viewer
    type(page_type), intent(inout) :: page           !< text to which the picture is appended
    character, parameter :: names(3) = ['x', 'y', 'z']
    real(wp) :: tip(2)
    integer :: i

    call page%line('<g id="axes" transform="translate(38 '//decimal(projection%height - 36.0_wp)//')">')
    do i = 1, 3
      tip = axis_length*[projection%view%right(i), -projection%view%up(i)]
      if (norm2(tip) < shortest_axis .and. .not. all_axes) cycle
      call page%line('<path stroke="#222" stroke-width="1.2" d="M0 0L'//decimal(tip(1))//' '//decimal(tip(2))//'"/>'// &
                     '<text class="small" text-anchor="middle" dominant-baseline="central" x="'//decimal(beyond_axis*tip(1))// &
                     '" y="'//decimal(beyond_axis*tip(2))//'">'//names(i)//'</text>')
    end do
    call page%line('</g>')
  end subroutine put_axes
end module mech9_svg_picture
