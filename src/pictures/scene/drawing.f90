!> A drawing of a scene: places of nodes on the page, the order in which items cover each other, and the lines of each
!> item.
module mech9_drawing
  use mech9_kinds, only: wp
  use mech9_sorting, only: sort_by
  use mech9_film, only: film_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, item_type, facing_path, spring, in_thread, in_damper
  implicit none
  private
  public :: drawing_type, draw_frame, drawing_order, outline_of

  !> The places of all nodes on the page.
  type :: drawing_type
    real(wp), allocatable :: xy(:, :)     !< (2,n) [px]
    real(wp), allocatable :: depth(:)     !< (n) distance from the centre towards the viewer [px]
  end type drawing_type

  !> Depths are rounded to steps; items in the same step are drawn in the order of the scene.
  real(wp), parameter :: depth_steps = 0.5_wp   ! steps per px

contains

  !> The drawing of one frame of the film.
  pure function draw_frame(scene, film, projection, frame) result(drawing)
    type(scene_type), intent(in) :: scene            !< nodes and items of the picture
    type(film_type), intent(in) :: film              !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection  !< from space to the page
    integer, intent(in) :: frame                     !< number of the frame in the film
    type(drawing_type) :: drawing
    real(wp), allocatable :: places(:, :)
    integer :: i

    places = scene%places_at(film, frame)
    allocate (drawing%xy(2, scene%n_nodes), drawing%depth(scene%n_nodes))
    do i = 1, scene%n_nodes
      call projection%on_page(places(:, i), drawing%xy(:, i), drawing%depth(i))
    end do
    drawing%depth = drawing%depth*projection%scale
  end function draw_frame

  !> The numbers of the items in the order in which they are drawn. Bodies are drawn from the farthest to the nearest,
  !> each by the mean depth of its nodes. No body is drawn before those that it lies upon.
  pure function drawing_order(scene, drawing) result(order)
    type(scene_type), intent(in) :: scene      !< nodes and items of the picture
    type(drawing_type), intent(in) :: drawing  !< places of the nodes on the page
    integer, allocatable :: order(:)
    integer :: keys(scene%n_items), i, j

    keys = 0
    allocate (order(scene%n_items))
    order = [(i, i=1, scene%n_items)]
    if (scene%last_sorted <= scene%first_sorted) return
    do i = scene%first_sorted, scene%last_sorted
      associate (item => scene%items(i))
        keys(i) = nint(depth_steps*sum(drawing%depth(item%nodes))/size(item%nodes))
        do j = 1, size(item%above)
          if (item%above(j) > 0) keys(i) = max(keys(i), keys(item%above(j)))
        end do
      end associate
    end do
    call sort_by(real(keys, wp), order(scene%first_sorted:scene%last_sorted))
  end function drawing_order

  !> The corners of a path, of segments, or of the windings of a spring, on the page [px]. There are none where a facing
  !> path shows its back.
  pure function outline_of(item, drawing, symbol) result(corners)
    type(item_type), intent(in) :: item        !< one thing to draw
    type(drawing_type), intent(in) :: drawing  !< places of the nodes on the page
    real(wp), intent(in) :: symbol             !< scale of symbols, 1 at full size
    real(wp), allocatable :: corners(:, :)     !< (2,n)

    if (item%shape == spring) then
      associate (from => drawing%xy(:, item%nodes(1)), to => drawing%xy(:, item%nodes(2)), aside => symbol*item%shift(1))
        if (item%style == in_damper) then
          corners = damper(from, to, aside, symbol)
        else
          corners = windings(from, to, item%style == in_thread, aside, symbol)
        end if
      end associate
      return
    end if
    corners = drawing%xy(:, item%nodes)
    ! y points down on the page, so that a counterclockwise path has a negative area
    if (item%shape == facing_path) then
      if (area(corners) > -1.0e-3_wp) corners = corners(:, :0)
    end if
  end function outline_of

  !> The area within a closed path [px^2], positive if the path is clockwise on the page.
  pure real(wp) function area(corners)
    real(wp), intent(in) :: corners(:, :)  !< (2,n) corners of a closed path [px]
    integer :: i, next

    area = 0.0_wp
    do i = 1, size(corners, 2)
      next = mod(i, size(corners, 2)) + 1
      area = area + 0.5_wp*(corners(1, i)*corners(2, next) - corners(2, i)*corners(1, next))
    end do
  end function area

  !> The number of turns of a spring, or of a thread of a given length.
  pure integer function coil_count(is_thread, length, symbol)
    logical, intent(in) :: is_thread  !< it is the thread of a helical pair, not a spring
    real(wp), intent(in) :: length    !< distance between the ends [px]
    real(wp), intent(in) :: symbol    !< scale of symbols, 1 at full size

    coil_count = 10
    if (is_thread) coil_count = max(3, min(60, nint(length/(6.0_wp*symbol))))
  end function coil_count

  !> The distance to which the turns of a spring or a thread reach on either side [px].
  pure real(wp) function coil_height(is_thread, symbol)
    logical, intent(in) :: is_thread  !< it is the thread of a helical pair, not a spring
    real(wp), intent(in) :: symbol    !< scale of symbols, 1 at full size

    coil_height = merge(3.5_wp, 6.0_wp, is_thread)*symbol
  end function coil_height

  !> A zigzag from one place to another. A spring has straight ends, each a fifth of the distance long; a thread has none.
  pure function windings(from, to, is_thread, aside, symbol) result(corners)
    real(wp), intent(in) :: from(2)         !< first end [px]
    real(wp), intent(in) :: to(2)           !< second end [px]
    logical, intent(in) :: is_thread        !< it is the thread of a helical pair, not a spring
    real(wp), intent(in) :: aside           !< distance from the line between the ends [px]
    real(wp), intent(in) :: symbol          !< scale of symbols, 1 at full size
    real(wp), allocatable :: corners(:, :)  !< (2,n)
    real(wp) :: along(2), across(2), length, lead, at, side
    integer :: n, i

    along = to - from
    length = norm2(along)
    n = 2*coil_count(is_thread, length, symbol)
    allocate (corners(2, n + 3))
    across = 0.0_wp
    if (length > 0.0_wp) across = [-along(2), along(1)]/length
    lead = merge(0.0_wp, 0.2_wp, is_thread)
    corners(:, 1) = from
    corners(:, n + 3) = to
    do i = 0, n
      at = lead + (1.0_wp - 2.0_wp*lead)*i/n
      side = merge(0.0_wp, real(1 - 2*mod(i, 2), wp), i == 0 .or. i == n)
      corners(:, i + 2) = from + at*along + (aside + side*coil_height(is_thread, symbol))*across
    end do
  end function windings

  !> A cup with a piston in it, each with its rod. Every two corners are the ends of a line.
  pure function damper(from, to, aside, symbol) result(corners)
    real(wp), intent(in) :: from(2)  !< first end [px]
    real(wp), intent(in) :: to(2)    !< second end [px]
    real(wp), intent(in) :: aside    !< distance from the line between the ends [px]
    real(wp), intent(in) :: symbol   !< scale of symbols, 1 at full size
    real(wp) :: corners(2, 12)
    !> Places of the bottom and the rim of the cup and of the piston along the line, as parts of its length.
    real(wp), parameter :: bottom = 0.42_wp, rim = 0.66_wp, piston = 0.56_wp
    real(wp), parameter :: places(12) = [0.0_wp, bottom, bottom, bottom, bottom, rim, bottom, rim, piston, piston, piston, 1.0_wp]
    !> Distances of the corners from the line, in halves of the cup's width.
    real(wp), parameter :: sides(12) = [0.0_wp, 0.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -0.7_wp, 0.7_wp, &
                                        0.0_wp, 0.0_wp]
    real(wp), parameter :: half = 5.0_wp         !< half the width of the cup [px]
    real(wp) :: along(2), across(2)
    integer :: i

    along = to - from
    across = 0.0_wp
    if (norm2(along) > 0.0_wp) across = [-along(2), along(1)]/norm2(along)
    do i = 1, size(places)
      corners(:, i) = from + places(i)*along
      if (i > 1 .and. i < size(places)) corners(:, i) = corners(:, i) + (aside + half*symbol*sides(i))*across
    end do
  end function damper
end module mech9_drawing
