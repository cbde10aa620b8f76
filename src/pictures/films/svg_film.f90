!> A film as one SVG that moves by itself. It has no script, so that it also plays where a page shows it as a picture.
module mech9_svg_film
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_film, only: film_type
  use mech9_film_clock, only: clock_decimals, clock_text
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, item_type, mark, label
  use mech9_drawing, only: drawing_type, draw_frame, drawing_order, outline_of
  use mech9_picture_style, only: styles, mark_svg
  use mech9_svg_picture, only: put_opening, put_item, put_surroundings, opening_of, tooltip_of, label_svg, &
    path_of, place_of
  use mech9_page, only: page_type
  use mech9_xml_text, only: decimal
  implicit none
  private
  public :: save_svg_film, duration_of

  !> The bounds of the time that a film takes to play [s].
  real(wp), parameter :: shortest = 3.0_wp, longest = 15.0_wp

contains

  !> Write the moving picture to a file. Errors are exit_file.
  subroutine save_svg_film(path, title, scene, film, projection, err)
    character(len=*), intent(in) :: path               !< name of the file
    character(len=*), intent(in) :: title              !< title of the mechanism, any text
    type(scene_type), intent(in) :: scene              !< nodes and items of the picture
    type(film_type), intent(in) :: film                !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection    !< from space to the page
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(page_type) :: page
    type(drawing_type), allocatable :: drawings(:)
    integer, allocatable :: order(:)
    integer :: i

    allocate (drawings(film%n_frames))
    do i = 1, film%n_frames
      drawings(i) = draw_frame(scene, film, projection, i)
    end do
    call page%line('<?xml version="1.0" encoding="UTF-8"?>')
    call put_opening(title, projection, page)
    order = drawing_order(scene, drawings(1))
    call page%line('<g id="scene">')
    do i = 1, size(order)
      associate (item => scene%items(order(i)))
        if (item%state > 0) call put_shown_while(scene%holds(item%state, :), duration_of(film), page)
        if (all(scene%node_link(item%nodes) == 1) .or. film%n_frames < 2) then
          call put_item(item, order(i), drawings(1), projection%symbol, page)
        else
          call put_moving(item, order(i), drawings, projection%symbol, duration_of(film), page)
        end if
        if (item%state > 0) call page%line('</g>')
      end associate
    end do
    call page%line('</g>')
    call put_surroundings(title, projection, .false., page)
    if (film%n_frames > 1) call put_clock(film, projection%height - 12.0_wp, page)
    call page%line('</svg>')
    call page%save(path, err)
  end subroutine save_svg_film

  !> Append the clock: the times of all frames stand below each other on a strip that moves behind a window.
  subroutine put_clock(film, foot, page)
    type(film_type), intent(in) :: film     !< poses and values at the outputs of the run
    real(wp), intent(in) :: foot            !< height at which the time stands on the page, downwards [px]
    type(page_type), intent(inout) :: page  !< text to which the page is appended
    integer, parameter :: line = 20                ! height of a line [px]
    integer :: i, decimals

    decimals = clock_decimals(film)
    call page%put('<svg id="time" x="90" y="'//decimal(foot - 14.0_wp)//'" width="160" height="'//to_text(line)// &
                  '" overflow="hidden"><g transform="translate(0 0)">'// &
                  '<animateTransform attributeName="transform" type="translate"'//timing(duration_of(film)))
    do i = 1, film%n_frames
      if (i > 1) call page%put(';')
      call page%put('0 '//to_text(-line*(i - 1)))
    end do
    call page%line('"/>')
    do i = 1, film%n_frames
      call page%line('<text class="small" x="0" y="'//to_text(line*(i - 1) + 14)//'">'// &
                     clock_text(film%times(i), decimals)//'</text>')
    end do
    call page%line('</g></svg>')
  end subroutine put_clock

  !> The time that a film takes to play [s]. It is the time of the motion, but not so short or so long that nobody could
  !> watch it.
  pure real(wp) function duration_of(film) result(duration)
    type(film_type), intent(in) :: film  !< poses and values at the outputs of the run

    duration = max(shortest, min(longest, abs(film%times(film%n_frames) - film%times(1))))
  end function duration_of

  !> Open a group that is shown in some frames only.
  subroutine put_shown_while(holds, duration, page)
    logical, intent(in) :: holds(:)         !< (frames) in which it is shown
    real(wp), intent(in) :: duration        !< time that the film takes to play [s]
    type(page_type), intent(inout) :: page  !< text to which the group is appended
    integer :: i

    call page%put('<g visibility="'//trim(word(1))//'"><animate attributeName="visibility"'//timing(duration))
    do i = 1, size(holds)
      if (i > 1) call page%put(';')
      call page%put(trim(word(i)))
    end do
    call page%line('"/>')

  contains

    !> The word for a frame.
    pure character(len=7) function word(frame)
      integer, intent(in) :: frame   !< number of the frame

      word = merge('visible', 'hidden ', holds(frame))
    end function word
  end subroutine put_shown_while

  !> Append an item with its form in each frame. A viewer without motion, or a print, shows the first frame.
  subroutine put_moving(item, number, drawings, symbol, duration, page)
    type(item_type), intent(in) :: item            !< one thing to draw
    integer, intent(in) :: number                  !< number of the item in the scene
    type(drawing_type), intent(in) :: drawings(:)  !< (frames) places of the nodes on the page in each frame
    real(wp), intent(in) :: symbol                 !< scale of symbols, 1 at full size
    real(wp), intent(in) :: duration               !< time that the film takes to play [s]
    type(page_type), intent(inout) :: page         !< text to which the page is appended

    call page%put(opening_of(item, number))
    select case (item%shape)
    case (mark, label)
      call page%put(' transform="translate('//place_of(item, drawings(1))//')">')
      call page%put('<animateTransform attributeName="transform" type="translate"'//timing(duration))
      call put_values(item, drawings, symbol, page)
      call page%put('"/>')
      if (item%shape == mark) then
        call page%put('<g transform="scale('//to_text(symbol, 6)//')">'//tooltip_of(item)//mark_svg(item%style, item%shift)//'</g>')
      else
        call page%put(label_svg(item))
      end if
    case default
      call page%put('>'//tooltip_of(item))
      call put_moving_path(item, drawings, symbol, duration, '', page)
      if (styles(item%style)%has_edge) call put_moving_path(item, drawings, symbol, duration, ' class="i"', page)
    end select
    call page%line('</g>')
  end subroutine put_moving

  !> Append a path with its form in each frame.
  subroutine put_moving_path(item, drawings, symbol, duration, class, page)
    type(item_type), intent(in) :: item            !< one thing to draw
    type(drawing_type), intent(in) :: drawings(:)  !< (frames) places of the nodes on the page in each frame
    real(wp), intent(in) :: symbol                 !< scale of symbols, 1 at full size
    real(wp), intent(in) :: duration               !< time that the film takes to play [s]
    character(len=*), intent(in) :: class          !< attribute with the class of the path; empty: none
    type(page_type), intent(inout) :: page         !< text to which the page is appended

    call page%put('<path'//class//' d="'//path_in(item, drawings(1), symbol)//'">')
    call page%put('<animate attributeName="d"'//timing(duration))
    call put_values(item, drawings, symbol, page)
    call page%put('"/></path>')
  end subroutine put_moving_path

  !> The beginning of an animation, up to its values. Frames follow each other without interpolation, since there are
  !> enough of them.
  pure function timing(duration) result(text)
    real(wp), intent(in) :: duration  !< time that the film takes to play [s]
    character(len=:), allocatable :: text

    text = ' calcMode="discrete" repeatCount="indefinite" dur="'//decimal(duration)//'s" values="'
  end function timing

  !> Append the forms of an item in all frames, with semicolons between them.
  subroutine put_values(item, drawings, symbol, page)
    type(item_type), intent(in) :: item            !< one thing to draw
    type(drawing_type), intent(in) :: drawings(:)  !< (frames) places of the nodes on the page in each frame
    real(wp), intent(in) :: symbol                 !< scale of symbols, 1 at full size
    type(page_type), intent(inout) :: page         !< text to which the page is appended
    integer :: i

    do i = 1, size(drawings)
      if (i > 1) call page%put(';')
      if (item%shape == mark .or. item%shape == label) then
        call page%put(place_of(item, drawings(i)))
      else
        call page%put(path_in(item, drawings(i), symbol))
      end if
    end do
  end subroutine put_values

  !> The path of an item in a frame. An animation needs a path even where the item is not seen; it then has no length.
  pure function path_in(item, drawing, symbol) result(path)
    type(item_type), intent(in) :: item        !< one thing to draw
    type(drawing_type), intent(in) :: drawing  !< places of the nodes on the page
    real(wp), intent(in) :: symbol             !< scale of symbols, 1 at full size
    character(len=:), allocatable :: path

    path = path_of(item, outline_of(item, drawing, symbol))
    if (path == '') path = 'M0 0'
  end function path_in
end module mech9_svg_film
