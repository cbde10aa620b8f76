!> The labels of a scene: names of points, names of coordinates at their joints, and numbers of links. Their places are
!> chosen for the first frame of a film.
module mech9_scene_labels
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_part_names, only: part_names_type, name_in, label_of, longest_called
  use mech9_mechanism, only: mechanism_type
  use mech9_film, only: film_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, closed_path, segments, mark, as_name, as_number, as_coordinate, &
                         as_input, as_leader
  use mech9_drawing, only: drawing_type, draw_frame
  use mech9_label_places, only: obstacles_type, label_type, spot_type, spots_around, place_labels
  use mech9_label_obstacles, only: find_obstacles, clear_radius
  use mech9_pair_symbols, only: symbols_type
  implicit none
  private
  public :: add_labels

  !> Links, or coordinates, are labelled if there are at most this many.
  integer, parameter :: most_labelled = 24
  !> Widths and heights of letters [px]: of names of points, of coordinates, of independent coordinates, and of numbers.
  real(wp), parameter :: name_letter = 8.2_wp, name_height = 11.0_wp, coordinate_letter = 6.3_wp, input_letter = 7.0_wp, &
                         coordinate_height = 10.0_wp, number_letter = 7.0_wp, number_height = 9.5_wp
  !> The distance to which letters reach below their line, and the room between two names [px].
  real(wp), parameter :: below = 2.0_wp, between = 4.0_wp

  !> A label that will be added to the scene when its place is chosen.
  type :: entry_type
    type(label_type) :: label                    !< spots where it can stand
    integer :: style = as_name
    integer :: node = 0                          !< node of the label; 0: a new node on a link, at the chosen spot
    integer :: link = 0                          !< link whose colour the label has
    integer :: pairs(most_labelled) = 0          !< pairs whose coordinates are named, followed by zeros
    integer :: n_pairs = 0
    integer :: columns = 1                       !< number of coordinates in a row
    integer :: first_stacked = huge(1)           !< first of the spots in which the names stand one below the other
    character(len=:), allocatable :: text
    real(wp), allocatable :: places(:, :)        !< (3,spots) place of a number at each spot, in the system of link 1 [m]
  end type entry_type

  !> The first frame of a film on the page.
  type :: sheet_type
    type(projection_type) :: projection   !< from space to the page
    type(drawing_type) :: drawing         !< places of the nodes on the page
  end type sheet_type

contains

  !> Add the labels to a scene that is otherwise complete.
  subroutine add_labels(mechanism, film, projection, symbols, nodes, shapes, scene)
    type(mechanism_type), intent(in) :: mechanism !< the mechanism
    type(film_type), intent(in) :: film     !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection !< from space to the page
    type(symbols_type), intent(in) :: symbols !< nodes and joints of the pairs
    integer, intent(in) :: nodes(:)         !< (points) number of the node of each point
    integer, intent(in) :: shapes(:, :)     !< (2,links) number of the item that shows each link, and of a node of the link; 0: none
    type(scene_type), intent(inout) :: scene !< nodes and items of the picture
    type(obstacles_type) :: obstacles
    type(sheet_type) :: sheet
    type(label_type), allocatable :: labels(:)
    type(entry_type), allocatable :: entries(:)
    integer :: n, i

    sheet%projection = projection
    sheet%drawing = draw_frame(scene, film, projection, 1)
    call find_obstacles(scene, sheet%drawing, projection, obstacles)
    allocate (entries(size(nodes) + size(symbols%joint) + size(shapes, 2)))
    n = 0
    do i = 1, size(nodes)
      n = n + 1
      call enter_name(mechanism%points(i)%name, nodes(i), scene, sheet, entries(n))
    end do
    if (size(symbols%joint) <= most_labelled) then
      do i = 1, size(symbols%joint)
        if (symbols%joint(i) /= i) cycle
        n = n + 1
        call enter_coordinates(i, mechanism%names, film%independent, symbols, scene, sheet, entries(n))
      end do
    end if
    if (size(shapes, 2) <= most_labelled) then
      do i = 2, size(shapes, 2)
        if (all(shapes(:, i) == 0)) cycle
        n = n + 1
        call enter_number(i, mechanism%names, shapes(:, i), film, scene, sheet, entries(n))
      end do
    end if
    labels = entries(:n)%label
    call place_labels(obstacles, [projection%width, projection%height], labels)
    do i = 1, n
      entries(i)%label = labels(i)
      call add_entry(entries(i), mechanism%names, film, sheet, scene)
    end do
  end subroutine add_labels

  !> Form the label with the name of a point.
  subroutine enter_name(name, node, scene, sheet, entry)
    character(len=*), intent(in) :: name             !< name of the point
    integer, intent(in) :: node                      !< number of the node of the point
    type(scene_type), intent(in) :: scene            !< nodes and items of the picture
    type(sheet_type), intent(in) :: sheet            !< the first frame on the page
    type(entry_type), intent(out) :: entry           !< text, node and spots of the label

    entry%style = as_name
    entry%node = node
    entry%text = name
    entry%label%at = sheet%drawing%xy(:, node)
    associate (at => entry%label%at)
      entry%label%spots = spots_around(at, clear_radius(scene, sheet%drawing, sheet%projection%symbol, at), &
                                 [name_letter*len(name), name_height], to_left=.false.)
    end associate
  end subroutine enter_name

  !> Form the label with the names of the coordinates of a joint, in a row or one below the other.
  subroutine enter_coordinates(joint, names, independent, symbols, scene, sheet, entry)
    integer, intent(in) :: joint                     !< number of the first pair of the joint
    type(part_names_type), intent(in) :: names       !< of pairs, which stand for those of coordinates
    logical, intent(in) :: independent(:)            !< (M) which coordinates are independent
    type(symbols_type), intent(in) :: symbols        !< nodes and joints of the pairs
    type(scene_type), intent(in) :: scene            !< nodes and items of the picture
    type(sheet_type), intent(in) :: sheet            !< the first frame on the page
    type(entry_type), intent(out) :: entry           !< text, node and spots of the label
    type(spot_type), allocatable :: stacked(:)
    real(wp), parameter :: dislike = 2.0_wp
    real(wp) :: widths(most_labelled), clear
    integer :: k, n

    n = 0
    do k = 1, size(symbols%joint)
      if (symbols%joint(k) /= joint) cycle
      n = n + 1
      entry%pairs(n) = k
      widths(n) = width_of(coordinate_label(names, k), independent(k))
    end do
    entry%n_pairs = n
    entry%style = as_coordinate
    entry%node = symbols%node(joint)
    entry%label%at = sheet%drawing%xy(:, entry%node)
    associate (at => entry%label%at)
      clear = clear_radius(scene, sheet%drawing, sheet%projection%symbol, at)
      entry%label%spots = spots_around(at, clear, [sum(widths(:n)) + between*(n - 1), coordinate_height], to_left=.true.)
      if (n == 1) return
      stacked = spots_around(at, clear, [maxval(widths(:n)), coordinate_height*n], to_left=.true.)
      stacked%cost = stacked%cost + dislike
      entry%first_stacked = size(entry%label%spots) + 1
      entry%label%spots = [entry%label%spots, stacked]
    end associate
  end subroutine enter_coordinates

  !> Form the label with the number of a link: on its bars or its plate, beside them, or with a leading line. The number
  !> of a link that is drawn at one place only stands beside this place.
  subroutine enter_number(link, names, shape, film, scene, sheet, entry)
    integer, intent(in) :: link                      !< number of the link
    type(part_names_type), intent(in) :: names       !< of links, which stand for their numbers
    integer, intent(in) :: shape(2)                  !< number of the item that shows the link, and of a node of the link; 0: none
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(scene_type), intent(in) :: scene            !< nodes and items of the picture
    type(sheet_type), intent(in) :: sheet            !< the first frame on the page
    type(entry_type), intent(out) :: entry           !< text, node and spots of the label
    real(wp) :: size_of_box(2)
    real(wp), allocatable :: places(:, :)

    entry%style = as_number
    entry%link = link
    entry%text = trim(label_of(names%links, link))
    size_of_box = [number_letter*len(entry%text), number_height]
    entry%label%owner = link
    entry%label%of_place = .false.
    if (shape(1) == 0) then
      entry%node = shape(2)
      associate (at => sheet%drawing%xy(:, entry%node), symbol => sheet%projection%symbol)
        entry%label%spots = spots_around(at, max(9.0_wp*symbol, clear_radius(scene, sheet%drawing, symbol, at)), size_of_box, &
                                         to_left=.false.)
      end associate
      return
    end if
    places = scene%places_at(film, 1)
    associate (item => scene%items(shape(1)))
      if (item%shape == closed_path) then
        call look_in_plate(places(:, item%nodes), sheet%projection, size_of_box, entry%places, entry%label%spots)
      else
        call look_on_bars(places(:, item%nodes), item%shape == segments, sheet%projection, size_of_box, entry%places, &
                          entry%label%spots)
      end if
    end associate
  end subroutine enter_number

  !> List spots within a plate: in its middle, and between the middle and its corners.
  subroutine look_in_plate(corners, projection, size_of_box, places, spots)
    real(wp), intent(in) :: corners(:, :)                  !< (3,n) corners in the system of link 1 [m]
    type(projection_type), intent(in) :: projection        !< from space to the page
    real(wp), intent(in) :: size_of_box(2)                 !< width and height of the number [px]
    real(wp), allocatable, intent(out) :: places(:, :)     !< (3,spots) in the system of link 1 [m]
    type(spot_type), allocatable, intent(out) :: spots(:)  !< the spots, in order of preference
    integer, parameter :: most_corners = 24
    real(wp), parameter :: parts(3) = [0.25_wp, 0.5_wp, 0.7_wp]
    real(wp) :: middle(3)
    integer :: i, j, n, step

    middle = sum(corners, 2)/size(corners, 2)
    step = 1 + (size(corners, 2) - 1)/most_corners
    allocate (places(3, 1 + size(parts)*size(corners, 2)), spots(1 + size(parts)*size(corners, 2)))
    n = 1
    places(:, 1) = middle
    do i = 1, size(parts)
      do j = 1, size(corners, 2), step
        n = n + 1
        places(:, n) = middle + parts(i)*(corners(:, j) - middle)
      end do
    end do
    places = places(:, :n)
    spots = spots(:n)
    do i = 1, n
      spots(i) = spot_at(places(:, i), [0.0_wp, 0.0_wp], projection, size_of_box, 0.3_wp*i)
    end do
  end subroutine look_in_plate

  !> List spots on bars, beside bars, and at the end of a leading line.
  subroutine look_on_bars(ends, apart, projection, size_of_box, places, spots)
    real(wp), intent(in) :: ends(:, :)     !< (3,n) ends of the bars in the system of link 1 [m]
    logical, intent(in) :: apart           !< each bar has two ends of its own; else each bar goes on from the end of the one before
    type(projection_type), intent(in) :: projection !< from space to the page
    real(wp), intent(in) :: size_of_box(2) !< width and height of the number [px]
    real(wp), allocatable, intent(out) :: places(:, :) !< (3,spots) in the system of link 1 [m]
    type(spot_type), allocatable, intent(out) :: spots(:) !< the spots, in order of preference
    !> Parts of a bar's length. The first ones are not quite in the middle, where the mass centre often is.
    real(wp), parameter :: parts(11) = [0.4_wp, 0.6_wp, 0.5_wp, 0.33_wp, 0.67_wp, 0.25_wp, 0.75_wp, 0.18_wp, 0.82_wp, 0.12_wp, &
                                        0.88_wp]
    !> Distances from the bar [px] of spots on it, beside it and farther away, and their additional costs.
    real(wp), parameter :: offsets(5) = [0.0_wp, 11.0_wp, -11.0_wp, 26.0_wp, -26.0_wp]
    real(wp), parameter :: prices(5) = [0.0_wp, 9.0_wp, 9.5_wp, 20.0_wp, 20.5_wp]
    !> A long bar is preferred to a short one by this part of its length; no bar is longer than this on a page [px].
    real(wp), parameter :: by_length = 0.02_wp, longest = 1000.0_wp
    real(wp) :: along(2), across(2), place(3), first(2), last(2), cost, depth
    integer :: bars, i, j, k, n, at

    bars = merge(size(ends, 2)/2, size(ends, 2) - 1, apart)
    n = size(offsets)*size(parts)*bars
    allocate (places(3, n), spots(n))
    n = 0
    do i = 1, bars
      at = merge(2*i - 1, i, apart)
      call projection%on_page(ends(:, at), first, depth)
      call projection%on_page(ends(:, at + 1), last, depth)
      along = last - first
      across = [0.0_wp, 1.0_wp]
      if (norm2(along) > 1.0e-6_wp) across = [along(2), -along(1)]/norm2(along)
      do j = 1, size(parts)
        place = ends(:, at) + parts(j)*(ends(:, at + 1) - ends(:, at))
        cost = 0.5_wp*j + by_length*(longest - norm2(along))
        do k = 1, size(offsets)
          n = n + 1
          places(:, n) = place
          spots(n) = spot_at(place, offsets(k)*across, projection, size_of_box, cost + prices(k))
        end do
      end do
    end do
  end subroutine look_on_bars

  !> A spot beside a place. A distant spot has a leading line.
  pure function spot_at(place, offset, projection, size_of_box, cost) result(spot)
    real(wp), intent(in) :: place(3)                 !< place in the system of link 1 [m]
    real(wp), intent(in) :: offset(2)                !< from that place to the middle of the box, to the right and down [px]
    type(projection_type), intent(in) :: projection  !< from space to the page
    real(wp), intent(in) :: size_of_box(2)           !< width and height of the label [px]
    real(wp), intent(in) :: cost                     !< cost of the spot, in px of a covered bar
    type(spot_type) :: spot
    real(wp), parameter :: near = 15.0_wp
    real(wp) :: at(2), depth

    call projection%on_page(place, at, depth)
    spot%low = at + offset - 0.5_wp*size_of_box
    spot%high = at + offset + 0.5_wp*size_of_box
    spot%cost = cost
    if (norm2(offset) < near) return
    spot%from = at
    spot%to = at + offset*(1.0_wp - 0.6_wp*number_height/norm2(offset))
  end function spot_at

  !> Add a label at its chosen spot, with its leading line.
  subroutine add_entry(entry, names, film, sheet, scene)
    type(entry_type), intent(in) :: entry            !< text and node of the label, with its chosen spot
    type(part_names_type), intent(in) :: names       !< of pairs, which stand for those of coordinates
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(sheet_type), intent(in) :: sheet            !< the first frame on the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp) :: at(2), depth
    integer :: node

    associate (chosen => entry%label%chosen, spot => entry%label%spots(entry%label%chosen))
      node = entry%node
      if (node == 0) then
        call scene%add_node(entry%link, film%local(1, entry%link, entry%places(:, chosen)), node)
        call sheet%projection%on_page(entry%places(:, chosen), at, depth)
      else
        at = sheet%drawing%xy(:, node)
      end if
      if (any(abs(spot%to - spot%from) > 0.0_wp)) &
        call scene%add_shifted(mark, as_leader, [node], (spot%to - at)/sheet%projection%symbol)
      select case (entry%style)
      case (as_name)
        call scene%add_label(as_name, node, entry%text, [spot%low(1), spot%high(2) - below] - at)
      case (as_number)
        call scene%add_label(as_number, node, entry%text, 0.5_wp*(spot%low + spot%high) - at, entry%link)
      case default
        call add_coordinates(entry, at, names, film%independent, scene)
      end select
    end associate
  end subroutine add_entry

  !> Add the names of coordinates within their common box, each as a separate label, since only independent coordinates
  !> have a colour.
  subroutine add_coordinates(entry, at, names, independent, scene)
    type(entry_type), intent(in) :: entry     !< node of the joint, and the chosen spot
    real(wp), intent(in) :: at(2)             !< place of the joint on the page [px]
    type(part_names_type), intent(in) :: names   !< of pairs, which stand for those of coordinates
    logical, intent(in) :: independent(:)     !< (M) which coordinates are independent
    type(scene_type), intent(inout) :: scene  !< nodes and items of the picture
    real(wp) :: last(2)
    logical :: stacked
    integer :: i, k

    stacked = entry%label%chosen >= entry%first_stacked
    associate (spot => entry%label%spots(entry%label%chosen))
      ! a label of this kind ends at its place
      last = [spot%low(1), spot%high(2) - below]
      if (stacked) last = [spot%high(1), spot%low(2) + coordinate_height - below]
    end associate
    do i = 1, entry%n_pairs
      k = entry%pairs(i)
      if (.not. stacked) last(1) = last(1) + width_of(coordinate_label(names, k), independent(k))
      call scene%add_label(merge(as_input, as_coordinate, independent(k)), entry%node, trim(coordinate_label(names, k)), last - at)
      if (stacked) then
        last(2) = last(2) + coordinate_height
      else
        last(1) = last(1) + between
      end if
    end do
  end subroutine add_coordinates

  !> The label of a coordinate: the name of its pair, or q with its number.
  pure character(len=longest_called) function coordinate_label(names, k) result(label)
    type(part_names_type), intent(in) :: names   !< of pairs
    integer, intent(in) :: k                     !< number of the coordinate

    label = name_in(names%coordinates, k)
    if (label == '') label = 'q'//to_text(k)
  end function coordinate_label

  !> The width of the label of a coordinate [px].
  pure real(wp) function width_of(label, is_independent)
    character(len=*), intent(in) :: label      !< the label
    logical, intent(in) :: is_independent      !< the coordinate is independent

    width_of = merge(input_letter, coordinate_letter, is_independent)*len_trim(label)
  end function width_of
end module mech9_scene_labels
