!> A film as a page that a browser plays without any other file. It holds the first picture, the places of everything in
!> all frames, the values of the recorded columns, and a script.
module mech9_html_film
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_part_names, only: part_names_type, name_column
  use mech9_rotation, only: quaternion
  use mech9_mechanism, only: mechanism_type
  use mech9_film, only: film_type
  use mech9_film_clock, only: clock_decimals
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, label, spring, in_thread, in_damper
  use mech9_svg_picture, only: put_picture
  use mech9_film_page, only: put_page_style, put_picture_style, put_controls, put_script
  use mech9_page, only: page_type
  use mech9_xml_text, only: xml_text, decimal
  implicit none
  private
  public :: save_html_film

  !> Places are whole multiples of this part of the page's width, which is far finer than a screen shows.
  real(wp), parameter :: finest = 1.0e-5_wp
  !> Components of quaternions are whole multiples of 1/steps.
  real(wp), parameter :: steps = 1.0e5_wp
  !> The number of significant digits of the values of columns.
  integer, parameter :: digits = 6

contains

  !> Write the page to a file. Errors are exit_file.
  subroutine save_html_film(path, mechanism, scene, film, projection, plot, err)
    character(len=*), intent(in) :: path  !< name of the file
    type(mechanism_type), intent(in) :: mechanism   !< its title and names
    type(scene_type), intent(in) :: scene !< nodes and items of the picture
    type(film_type), intent(in) :: film   !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection !< from space to the page
    character(len=*), intent(in) :: plot  !< columns that are plotted at first, as for --plot; empty: some coordinates
    type(error_type), allocatable, intent(out) :: err !< allocated if it failed
    type(page_type) :: page

    call page%line('<!DOCTYPE html>')
    call page%line('<html lang="en"><head><meta charset="utf-8"/>')
    call page%line('<meta http-equiv="Content-Security-Policy" content="default-src ''none''; img-src data:; '// &
                   'style-src ''unsafe-inline''; script-src ''unsafe-inline''"/>')
    call page%line('<meta name="viewport" content="width=device-width, initial-scale=1"/>')
    call page%line('<title>'//xml_text(mechanism%title)//'</title>')
    call page%line('<style>')
    call put_page_style(page)
    call page%line('</style><style id="picture-style">')
    call put_picture_style(page)
    call page%line('</style></head><body><main><section aria-label="film"><h1>'//xml_text(mechanism%title)//'</h1><figure>')
    call put_picture(mechanism%title, scene, film, projection, 1, .true., page)
    call page%line('</figure>')
    call put_controls(page)
    call page%line('</section><div id="beside"><details id="curves"><summary>Plot</summary>')
    call page%line('<input id="columns" type="search" list="column-names" placeholder="columns: q1,q2 or P.x:P.y" '// &
                   'aria-label="Columns of the plot"/>')
    call page%line('<datalist id="column-names"></datalist><svg id="plot" role="img" aria-label="plot"></svg>')
    call page%line('<p id="plot-note"></p>')
    call page%line('</details><details id="values"><summary>Values</summary>')
    call page%line('<input id="filter" type="search" placeholder="names, or parts of them: q1 P." aria-label="Names of columns"/>')
    call page%line('<dl id="list"></dl><p id="more"></p></details></div></main>')
    call page%line('<script>')
    call put_film(scene, film, mechanism%names, projection, plot, page)
    call put_script(page)
    call page%line('</script></body></html>')
    call page%save(path, err)
  end subroutine save_html_film

  !> Append the data for the script as one constant.
  subroutine put_film(scene, film, names, projection, plot, page)
    type(scene_type), intent(in) :: scene            !< nodes and items of the picture
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(part_names_type), intent(in) :: names       !< of links and pairs
    type(projection_type), intent(in) :: projection  !< from space to the page
    character(len=*), intent(in) :: plot             !< columns that are plotted at first, as for --plot; empty: some coordinates
    type(page_type), intent(inout) :: page           !< text to which the page is appended
    integer :: numbers(size(film%p, 2))              !< numbers of the links that have nodes; 0: other links, and link 1
    real(wp) :: unit
    integer :: i, count

    unit = finest*projection%width/projection%scale
    numbers = 0
    count = 0
    do i = 1, scene%n_nodes
      if (scene%node_link(i) == 1 .or. numbers(scene%node_link(i)) > 0) cycle
      count = count + 1
      numbers(scene%node_link(i)) = count
    end do
    call page%put('const film = {unit: '//to_text(unit, 17)//', scale: '//to_text(projection%scale, 17))
    call page%put(', length: '//to_text(projection%length, 17)//', lengthUnit: "'//trim(projection%length_name)//'"')
    call page%put(', symbol: '//to_text(projection%symbol, 6)//', middle: ['//decimal(projection%middle(1))//', '// &
                  decimal(projection%middle(2))//'], sorted: ['//to_text(scene%first_sorted)//', '// &
                  to_text(scene%last_sorted)//'],'//new_line('a')//'view: [')
    do i = 1, 3
      call page%put(to_text(projection%view%right(i), 9)//',')
    end do
    do i = 1, 3
      call page%put(to_text(projection%view%up(i), 9)//',')
    end do
    call page%put(to_text(projection%view%toward(1), 9)//','//to_text(projection%view%toward(2), 9)//','// &
                  to_text(projection%view%toward(3), 9))
    call page%line('],')
    call page%line('planar: '//trim(merge('true ', 'false', projection%view%along_normal))//', decimals: '// &
                   to_text(clock_decimals(film))//',')
    call put_nodes(scene, numbers, projection%centre, unit, page)
    call put_items(scene, page)
    call put_frames(film, numbers, count, projection%centre, unit, page)
    call put_states(scene, page)
    call put_values(film, names, page)
    ! names of columns hold no letter that has a meaning here
    if (scan(plot, '"<\') == 0) call page%line('plot: "'//plot//'",')
    call page%line('};')
  end subroutine put_film

  !> Append the nodes: the number of the link, and the place in it. Places of link 1 are relative to the middle of the
  !> picture.
  subroutine put_nodes(scene, numbers, centre, unit, page)
    type(scene_type), intent(in) :: scene   !< nodes and items of the picture
    integer, intent(in) :: numbers(:)       !< (links) number of each link in the script; 0: the link has no nodes, or is link 1
    real(wp), intent(in) :: centre(3)       !< place in the middle of the picture, in the system of link 1 [m]
    real(wp), intent(in) :: unit            !< length that 1 stands for in the script [m]
    type(page_type), intent(inout) :: page  !< text to which the page is appended
    integer :: i

    call page%put('links: [')
    do i = 1, scene%n_nodes
      call page%put(to_text(numbers(scene%node_link(i)))//',')
    end do
    call page%put('],'//new_line('a')//'points: [')
    do i = 1, scene%n_nodes
      if (scene%node_link(i) == 1) then
        call put_steps((scene%node_at(:, i) - centre)/unit, page)
      else
        call put_steps(scene%node_at(:, i)/unit, page)
      end if
    end do
    call page%line('],')
  end subroutine put_nodes

  !> Append numbers as whole numbers, each with a comma behind it.
  subroutine put_steps(values, page)
    real(wp), intent(in) :: values(:)       !< the numbers, rounded here
    type(page_type), intent(inout) :: page  !< text to which the page is appended
    integer :: i

    do i = 1, size(values)
      call page%put(to_text(nint(max(-2.0e9_wp, min(2.0e9_wp, values(i)))))//',')
    end do
  end subroutine put_steps

  !> Append the items, with numbers of nodes from 0. Items of link 1 alone stand still.
  subroutine put_items(scene, page)
    type(scene_type), intent(in) :: scene   !< nodes and items of the picture
    type(page_type), intent(inout) :: page  !< text to which the page is appended
    integer :: i

    call page%line('items: [')
    do i = 1, scene%n_items
      associate (item => scene%items(i))
        call page%put('{shape: '//to_text(item%shape)//', nodes: ['//to_text(item%nodes - 1, ',')//'], above: ['// &
                      to_text(pack(item%above, item%above > 0), ',')//']')
        if (all(scene%node_link(item%nodes) == 1)) call page%put(', still: true')
        if (item%state > 0) call page%put(', state: '//to_text(item%state))
        if (item%style == in_thread) call page%put(', thread: true')
        if (item%style == in_damper) call page%put(', damper: true')
        if (item%shape == label .or. item%shape == spring) then
          call page%put(', shift: ['//decimal(item%shift(1))//', '//decimal(item%shift(2))//']')
        else
          call page%put(', shift: [0, 0]')
        end if
        call page%line('},')
      end associate
    end do
    call page%line('],')
  end subroutine put_items

  !> Append the times, and for each frame the place and the quaternion of each link.
  subroutine put_frames(film, numbers, count, centre, unit, page)
    type(film_type), intent(in) :: film     !< poses and values at the outputs of the run
    integer, intent(in) :: numbers(:)       !< (links) number of each link in the script; 0: the link has no nodes, or is link 1
    integer, intent(in) :: count            !< number of links that have a number
    real(wp), intent(in) :: centre(3)       !< place in the middle of the picture, in the system of link 1 [m]
    real(wp), intent(in) :: unit            !< length that 1 stands for in the script [m]
    type(page_type), intent(inout) :: page  !< text to which the page is appended
    integer :: links(count), frame, i

    do i = 1, size(numbers)
      if (numbers(i) > 0) links(numbers(i)) = i
    end do
    call page%put('times: [')
    do frame = 1, film%n_frames
      call page%put(to_text(film%times(frame), 9)//',')
    end do
    call page%line('],')
    call page%line('poses: [')
    do frame = 1, film%n_frames
      call page%put('[')
      do i = 1, count
        call put_steps((film%p(:, links(i), frame) - centre)/unit, page)
        call put_steps(steps*turn_of(film%r(:, :, links(i), frame)), page)
      end do
      call page%line('],')
    end do
    call page%line('],')
  end subroutine put_frames

  !> The quaternion of a rotation times a factor, as that of an arrow round an axis: the square of its length is the factor.
  pure function turn_of(r) result(q)
    real(wp), intent(in) :: r(3, 3)    !< the rotation times the factor
    real(wp) :: q(4), factor

    factor = norm2(r(:, 1))
    q = 0.0_wp
    if (factor > 0.0_wp) q = sqrt(factor)*quaternion(r/factor)
  end function turn_of

  !> Append, for each state, a letter for each frame: 1 where it holds.
  subroutine put_states(scene, page)
    type(scene_type), intent(in) :: scene   !< nodes, items and states of the picture
    type(page_type), intent(inout) :: page  !< text to which the page is appended
    integer :: i

    call page%put('holds: [')
    if (allocated(scene%holds)) then
      do i = 1, size(scene%holds, 1)
        call page%put('"'//letters(scene%holds(i, :))//'",')
      end do
    end if
    call page%line('],')

  contains

    !> A letter for each frame.
    pure function letters(holds) result(text)
      logical, intent(in) :: holds(:)   !< (frames)
      character(len=size(holds)) :: text
      integer :: frame

      do frame = 1, size(holds)
        text(frame:frame) = merge('1', '0', holds(frame))
      end do
    end function letters
  end subroutine put_states

  !> Append the names and units of the recorded columns, by numbers and by the names of pairs and links, and their values in each frame.
  subroutine put_values(film, names, page)
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(part_names_type), intent(in) :: names       !< of links and pairs
    type(page_type), intent(inout) :: page           !< text to which the page is appended
    type(string_type), allocatable :: called(:)
    integer :: frame, i

    call put_words('names', film%names, page)
    called = film%names
    do i = 1, size(called)
      call name_column(names, called(i)%text)
    end do
    call put_words('called', called, page)
    call put_words('units', film%units, page)
    call page%line('values: [')
    do frame = 1, film%n_frames
      call page%put('[')
      do i = 1, size(film%names)
        call page%put(to_text(film%values(i, frame), digits)//',')
      end do
      call page%line('],')
    end do
    call page%line('],')
  end subroutine put_values

  !> Append a list of words, such as names of columns and units. The words have no quotes in them.
  subroutine put_words(name, words, page)
    character(len=*), intent(in) :: name       !< name of the list
    type(string_type), intent(in) :: words(:)  !< the words, without quotes in them
    type(page_type), intent(inout) :: page     !< text to which the page is appended
    integer :: i

    call page%put(name//': [')
    do i = 1, size(words)
      call page%put('"'//words(i)%text//'",')
    end do
    call page%line('],')
  end subroutine put_words
end module mech9_html_film
