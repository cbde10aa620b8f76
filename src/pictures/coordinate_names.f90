!> The names of coordinates beside their joints, placed for the first frame of a film. Uses kinds, film,
!> projection, scene, drawing, label_places, pair_symbols.
module mech9_coordinate_names
  use mech9_kinds, only: wp
  use mech9_film, only: film_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, closed_path, segments, label, in_plate, in_tube, as_stand, as_coordinate, as_input
  use mech9_drawing, only: drawing_type, draw_frame
  use mech9_label_places, only: name_shift
  use mech9_pair_symbols, only: symbols_type, names_of
  implicit none
  private
  public :: add_coordinate_names

contains

  !> Add the names to a scene that holds all links and stands.
  subroutine add_coordinate_names(independent, film, projection, symbols, scene)
    logical, intent(in) :: independent(:)         !< (M)
    type(film_type), intent(in) :: film
    type(projection_type), intent(in) :: projection
    type(symbols_type), intent(in) :: symbols
    type(scene_type), intent(inout) :: scene
    type(drawing_type) :: drawing
    integer, allocatable :: pairs(:)
    real(wp), allocatable :: bars(:, :, :)
    real(wp) :: shift(2)
    integer :: joint, k

    drawing = draw_frame(scene, film, projection, 1)
    call find_bars(scene, drawing, bars)
    do joint = 1, size(symbols%joint)
      if (symbols%joint(joint) /= joint) cycle
      pairs = pack([(k, k=1, size(symbols%joint))], symbols%joint == joint)
      shift = name_shift(drawing%xy(:, symbols%node(joint)), len(names_of(pairs)), on_frame(pairs, symbols, scene), &
                         symbols%hangs(joint), bars)
      call scene%add_item(label, merge(as_input, as_coordinate, any(independent(pairs))), symbols%node(joint:joint), &
                          text=names_of(pairs), shift=shift)
    end do
  end subroutine add_coordinate_names

  !> Whether a joint has a stand, or a guide of the frame that is drawn below it.
  pure logical function on_frame(pairs, symbols, scene)
    integer, intent(in) :: pairs(:)
    type(symbols_type), intent(in) :: symbols
    type(scene_type), intent(in) :: scene
    integer :: i

    on_frame = .false.
    do i = 1, size(pairs)
      if (symbols%guide(1, pairs(i)) > 0) on_frame = on_frame .or. scene%node_link(symbols%guide(1, pairs(i))) == 1
    end do
    do i = 1, scene%n_items
      if (scene%items(i)%style == as_stand) on_frame = on_frame .or. any(symbols%node(pairs) == scene%items(i)%nodes(1))
    end do
  end function on_frame

  !> The bars of all links and the edges of their plates, on the page.
  pure subroutine find_bars(scene, drawing, bars)
    type(scene_type), intent(in) :: scene
    type(drawing_type), intent(in) :: drawing
    real(wp), allocatable, intent(out) :: bars(:, :, :)   !< (2,2,n) their ends [px]
    integer, allocatable :: ends(:, :)
    integer :: pass, n, i, j

    do pass = 1, 2
      n = 0
      do i = scene%first_sorted, scene%last_sorted
        associate (item => scene%items(i))
          if (item%style /= in_plate .and. item%style /= in_tube) cycle
          do j = 1, size(item%nodes)
            if (item%shape == segments .and. mod(j, 2) == 0) cycle
            if (item%shape /= closed_path .and. j == size(item%nodes)) cycle
            n = n + 1
            if (pass == 2) ends(:, n) = [item%nodes(j), item%nodes(1 + mod(j, size(item%nodes)))]
          end do
        end associate
      end do
      if (pass == 1) allocate (ends(2, n))
    end do
    allocate (bars(2, 2, n))
    do i = 1, n
      bars(:, :, i) = drawing%xy(:, ends(:, i))
    end do
  end subroutine find_bars
end module mech9_coordinate_names
