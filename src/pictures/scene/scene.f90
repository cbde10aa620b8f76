!> A scene is the content of a picture, as points of links and the lines, plates and marks between them. It depends
!> neither on the view nor on the format of the picture.
module mech9_scene
  use mech9_kinds, only: wp
  use mech9_film, only: film_type
  implicit none
  private
  public :: scene_type, item_type
  public :: open_path, closed_path, facing_path, segments, spring, mark, label
  public :: in_trace, in_curve, in_guide, in_ground, in_hatch, in_plate, in_block, in_tube, in_pin, in_pin_end, in_spring, &
            in_thread, in_cross, in_cam, as_stand, as_ring, as_ball, as_dot, as_centre, as_free, as_name, as_number, &
            as_coordinate, as_input, as_leader, in_damper, as_coil, as_cup, in_force, in_stop, in_pushed, &
            in_bracket, as_stuck, in_velocity, in_acceleration, in_surface, in_rolling, as_sphere, in_target, &
            as_pole, in_moment, in_load, in_weight, in_touching, in_pairs

  !> The shape of an item. A facing path is a flat outline that is drawn only if its front, round which it runs
  !> counterclockwise, is turned to the viewer. Segments join each node of an odd number to the next one.
  integer, parameter :: open_path = 0, closed_path = 1, facing_path = 2, segments = 3, spring = 4, mark = 5, label = 6

  !> The style of an item: its meaning, and how it is drawn.
  integer, parameter :: in_trace = 1, in_curve = 2, in_guide = 3, in_ground = 4, in_hatch = 5, in_plate = 6, in_block = 7, &
                        in_tube = 8, in_pin = 9, in_pin_end = 10, in_spring = 11, in_thread = 12, in_cross = 13, in_cam = 14, &
                        as_stand = 15, as_ring = 16, as_ball = 17, as_dot = 18, as_centre = 19, as_free = 20, &
                        as_name = 21, as_number = 22, as_coordinate = 23, as_input = 24, as_leader = 25, &
                        in_damper = 26, as_coil = 27, as_cup = 28, in_force = 29, in_stop = 30, in_pushed = 31, &
                        in_bracket = 32, as_stuck = 33, in_velocity = 34, in_acceleration = 35, in_surface = 36, in_rolling = 37, &
                        as_sphere = 38, in_target = 39, as_pole = 40, in_moment = 41, in_load = 42, in_weight = 43, &
                        in_touching = 44

  !> One thing to draw.
  type :: item_type
    integer :: shape = open_path
    integer :: style = in_plate
    integer :: link = 0                       !< link whose colour the item has; 0: none
    integer, allocatable :: nodes(:)
    integer :: above(4) = 0                   !< items below this one, whatever their depth
    character(len=:), allocatable :: text     !< text of a label, names of the coordinates of a joint, or that under the pointer
    integer :: state = 0                      !< number of the state in which alone it is shown; 0: it is shown always
    !> For a ball, the first number is its radius [px]. For a label, its place relative to its node, to the right and down [px]. For a stand, its direction; for a
    !> leading line, its end, also to the right and down. For a spring or damper, the first number is its distance from
    !> the line between its nodes.
    real(wp) :: shift(2) = 0.0_wp
  end type item_type

  !> Nodes are points of links. Items stand in the order in which they are drawn. Those from `first_sorted` to
  !> `last_sorted` are bodies in space, and a nearer body covers a farther one.
  type :: scene_type
    integer :: n_nodes = 0, n_items = 0
    integer, allocatable :: node_link(:)
    real(wp), allocatable :: node_at(:, :)    !< (3,n) place of each node in the system of its link [m]
    type(item_type), allocatable :: items(:)
    integer :: first_sorted = 1, last_sorted = 0
    logical, allocatable :: holds(:, :)       !< (states,frames) whether each state holds, such as that a stop pushes
  contains
    procedure :: add_node
    procedure :: add_item
    procedure :: add_shifted
    procedure :: add_label
    procedure :: show_while
    procedure :: shows
    procedure :: places_at
  end type scene_type

contains

  !> Whether the corners of an item belong together in twos, each two the ends of a separate line.
  pure logical function in_pairs(item)
    type(item_type), intent(in) :: item  !< one thing to draw

    in_pairs = item%shape == segments .or. item%style == in_damper
  end function in_pairs

  !> Add one more point of a link.
  pure subroutine add_node(self, link, at, node)
    class(scene_type), intent(inout) :: self  !< nodes and items of the picture
    integer, intent(in) :: link               !< number of the link that carries the point
    real(wp), intent(in) :: at(3)             !< the point, in the system of the link [m]
    integer, intent(out) :: node              !< number of the new node
    integer, allocatable :: links(:)
    real(wp), allocatable :: places(:, :)

    if (.not. allocated(self%node_link)) allocate (self%node_link(64), self%node_at(3, 64))
    if (self%n_nodes == size(self%node_link)) then
      allocate (links(2*self%n_nodes), places(3, 2*self%n_nodes))
      links(:self%n_nodes) = self%node_link
      places(:, :self%n_nodes) = self%node_at
      call move_alloc(links, self%node_link)
      call move_alloc(places, self%node_at)
    end if
    self%n_nodes = self%n_nodes + 1
    node = self%n_nodes
    self%node_link(node) = link
    self%node_at(:, node) = at
  end subroutine add_node

  !> Add one more thing to draw, above those that are there.
  pure subroutine add_item(self, shape, style, nodes, link, above, text)
    class(scene_type), intent(inout) :: self        !< nodes and items of the picture
    integer, intent(in) :: shape                    !< shape of the item, one of the numbers from open_path to label
    integer, intent(in) :: style                    !< style of the item, one of the in_ and as_ numbers
    integer, intent(in) :: nodes(:)                 !< numbers of the nodes
    integer, intent(in), optional :: link           !< number of the link whose colour the item has; none unless given
    integer, intent(in), optional :: above(:)       !< numbers of items below this one; the first four count, and zeros do not
    character(len=*), intent(in), optional :: text  !< names of the coordinates of a joint
    type(item_type), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(self%items)) allocate (self%items(32))
    if (self%n_items == size(self%items)) then
      allocate (grown(2*self%n_items))
      do i = 1, self%n_items
        call move_item(self%items(i), grown(i))
      end do
      call move_alloc(grown, self%items)
    end if
    self%n_items = self%n_items + 1
    self%items(self%n_items) = item_type()
    associate (item => self%items(self%n_items))
      item%shape = shape
      item%style = style
      item%nodes = nodes
      if (present(link)) item%link = link
      if (present(above)) item%above(:min(4, size(above))) = above(:min(4, size(above)))
      if (present(text)) item%text = text
    end associate
  end subroutine add_item

  !> Move the content of an item to another item.
  pure subroutine add_shifted(self, shape, style, nodes, shift, above)
    class(scene_type), intent(inout) :: self        !< nodes and items of the picture
    integer, intent(in) :: shape                    !< shape of the item, one of the numbers from open_path to label
    integer, intent(in) :: style                    !< style of the item, one of the in_ and as_ numbers
    integer, intent(in) :: nodes(:)                 !< numbers of the nodes
    real(wp), intent(in) :: shift(2)                !< to the right and down [px]; see item_type
    integer, intent(in), optional :: above(:)       !< numbers of items below this one; the first four count, and zeros do not

    call self%add_item(shape, style, nodes)
    associate (item => self%items(self%n_items))
      item%shift = shift
      if (present(above)) item%above(:min(4, size(above))) = above(:min(4, size(above)))
    end associate
  end subroutine add_shifted

  !> One more label is added.
  pure subroutine add_label(self, style, node, text, shift, link)
    class(scene_type), intent(inout) :: self        !< nodes and items of the picture
    integer, intent(in) :: style                    !< style of the label, one of the as_ numbers
    integer, intent(in) :: node                     !< number of the node
    character(len=*), intent(in) :: text            !< its text
    real(wp), intent(in) :: shift(2)                !< displacement from the node, to the right and down [px]
    integer, intent(in), optional :: link           !< number of the link whose colour the label has; none unless given

    call self%add_item(label, style, [node], link, text=text)
    self%items(self%n_items)%shift = shift
  end subroutine add_label

  !> Let the last item be shown in some frames only. It is left out if these are none.
  pure subroutine show_while(self, frames)
    class(scene_type), intent(inout) :: self  !< nodes and items of the picture
    logical, intent(in) :: frames(:)          !< (frames) in which the item is shown
    integer :: n

    if (.not. any(frames)) then
      self%n_items = self%n_items - 1
      return
    end if
    if (.not. allocated(self%holds)) allocate (self%holds(0, size(frames)))
    n = size(self%holds, 1) + 1
    self%holds = transpose(reshape([transpose(self%holds), frames], [size(frames), n]))
    self%items(self%n_items)%state = n
  end subroutine show_while

  !> Whether an item is shown in a frame.
  pure logical function shows(self, item, frame)
    class(scene_type), intent(in) :: self  !< nodes and items of the picture
    type(item_type), intent(in) :: item    !< one of its items
    integer, intent(in) :: frame           !< number of the frame in the film

    shows = item%state == 0
    if (.not. shows) shows = self%holds(item%state, frame)
  end function shows

  !> The content of an item is moved to another item.
  pure subroutine move_item(from, to)
    type(item_type), intent(inout) :: from  !< loses its nodes and its text
    type(item_type), intent(inout) :: to    !< receives them

    to%shape = from%shape
    to%style = from%style
    to%link = from%link
    to%above = from%above
    to%shift = from%shift
    to%state = from%state
    call move_alloc(from%nodes, to%nodes)
    if (allocated(from%text)) call move_alloc(from%text, to%text)
  end subroutine move_item

  !> The places of all nodes in a frame of the film, in the system of link 1 [m].
  pure function places_at(self, film, frame) result(places)
    class(scene_type), intent(in) :: self  !< nodes and items of the picture
    type(film_type), intent(in) :: film    !< poses and values at the outputs of the run
    integer, intent(in) :: frame           !< number of the frame in the film
    real(wp), allocatable :: places(:, :)  !< (3,n)
    integer :: i

    allocate (places(3, self%n_nodes))
    do i = 1, self%n_nodes
      places(:, i) = film%position(frame, self%node_link(i), self%node_at(:, i))
    end do
  end function places_at
end module mech9_scene
