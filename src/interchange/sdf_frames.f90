!> Poses in SDF: each stands in a frame that it may name, which stands in another one.
!>
!> Models may hold models. Names of frames in a nested model have its name before them: `arm::hand` is the frame `hand` of the
!> model `arm`. The frame of a model itself is `__model__`.
module mech9_sdf_frames
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_name_table, only: name_table_type
  use mech9_pose, only: pose_type, compose, inverse
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: numbers_in, is_true
  use mech9_orientations, only: rotation_of_rpy, from_quaternion
  use mech9_robot, only: robot_type
  implicit none
  private
  public :: sdf_frames_type, list_frames, own_pose

  integer, parameter :: most_frames = 5000
  real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
  character(len=*), parameter :: model_frame = '__model__'

  !> A frame.
  type :: frame_type
    character(len=:), allocatable :: name    !< with those of the models around it
    character(len=:), allocatable :: parent  !< name of the frame in which its pose stands
    character(len=:), allocatable :: holder  !< name of the frame or link to which it is attached; empty: none
    type(pose_type) :: pose                  !< in the frame `parent`
  end type frame_type

  !> The frames of a model: its own, those of links, joints, elements <frame> and models in it.
  type :: sdf_frames_type
    integer :: count = 0                                !< number of frames
    type(frame_type), allocatable, private :: list(:)   !< the frames
    type(pose_type) :: model                            !< of the outermost model in the world
    type(name_table_type), private :: numbers           !< of the frames by their names
  contains
    procedure :: in_model
    procedure :: find_link
    procedure, private :: add
    procedure, private :: up_to
    procedure, private :: find
    procedure, private :: circle
  end type sdf_frames_type

contains

  !> List the frames of a model and of those in it.
  subroutine list_frames(tree, model, frames, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    integer, intent(in) :: model                       !< number of the element <model>
    type(sdf_frames_type), intent(out) :: frames       !< its frames
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(pose_type) :: placed
    character(len=:), allocatable :: frame

    allocate (frames%list(64))
    frame = tree%attribute(tree%child(model, 'pose'), 'relative_to')
    if (frame /= '' .and. frame /= 'world') &
      call tree%fail(model, "the model stands in the frame '"//frame//"' of the world; give its <pose> in the world itself", err)
    call own_pose(tree, model, frames%model, err)
    call frames%add(tree, 0, new_frame(model_frame, '', canonical_of(tree, model)), '', err)
    call list_scope(tree, model, '', frames, err)
    call place_of_model(tree, model, '', frames, placed, err)
    frames%model = compose(frames%model, inverse(placed))
  end subroutine list_frames

  !> List the frames in a model, which may hold others.
  recursive subroutine list_scope(tree, model, prefix, frames, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: model                         !< number of the element <model>
    character(len=*), intent(in) :: prefix               !< names of the models around its frames, each with :: behind it
    type(sdf_frames_type), intent(inout) :: frames       !< gets its frames
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: own, name
    type(pose_type) :: placed
    integer :: e, n

    e = tree%first_child(model)
    do while (e > 0 .and. .not. allocated(err))
      own = prefix//tree%attribute(e, 'name')
      select case (tree%name(e))
      case ('link')
        call frames%add(tree, e, new_frame(own, prefix//model_frame, own), prefix, err)
      case ('joint')
        ! the frame of a joint stands in that of its child
        name = ''
        if (tree%child(e, 'child') > 0) name = tree%content(tree%child(e, 'child'))
        call frames%add(tree, e, new_frame(own, scoped(prefix, name), scoped(prefix, name)), prefix, err)
      case ('model')
        call frames%add(tree, e, new_frame(own, prefix//model_frame, scoped(own//'::', canonical_of(tree, e))), prefix, err)
        n = frames%count
        call frames%add(tree, 0, new_frame(own//'::'//model_frame, own, own), prefix, err)
        call list_scope(tree, e, own//'::', frames, err)
        call place_of_model(tree, e, own//'::', frames, placed, err)
        if (.not. allocated(err)) frames%list(n)%pose = compose(frames%list(n)%pose, inverse(placed))
      end select
      e = tree%next_sibling(e)
    end do
    call list_elements(tree, model, prefix, frames, err)
  end subroutine list_scope

  !> List the elements <frame> of a model, whose links, joints and models are listed. Fails where one has the name of another part.
  subroutine list_elements(tree, model, prefix, frames, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: model                         !< number of the element <model>
    character(len=*), intent(in) :: prefix               !< names of the models around its frames, each with :: behind it
    type(sdf_frames_type), intent(inout) :: frames       !< gets its frames
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: own, holder
    integer :: e

    e = tree%child(model, 'frame')
    do while (e > 0 .and. .not. allocated(err))
      own = prefix//tree%attribute(e, 'name')
      if (frames%find(own) > 0) &
        call tree%fail(e, "the frame '"//own//"' has the name of a link, joint, model or frame beside it; "// &
                       'give it another name', err)
      holder = scoped(prefix, tree%attribute(e, 'attached_to'))
      call frames%add(tree, e, new_frame(own, holder, holder), prefix, err)
      e = tree%next_named(e, 'frame')
    end do
  end subroutine list_elements

  !> The name of the link, or of the model in it, that a model's own frame is attached to.
  function canonical_of(tree, model) result(name)
    type(xml_tree_type), intent(in) :: tree  !< the document
    integer, intent(in) :: model             !< number of the element <model>
    character(len=:), allocatable :: name

    name = tree%attribute(model, 'canonical_link')
    if (name == '') name = tree%attribute(tree%child(model, 'link'), 'name')
    if (name == '') name = tree%attribute(tree%child(model, 'model'), 'name')
  end function canonical_of

  !> The pose in a model of the frame that its <pose> places: that of `placement_frame`, or its own.
  subroutine place_of_model(tree, model, prefix, frames, pose, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: model                         !< number of the element <model>
    character(len=*), intent(in) :: prefix               !< names of the models around its frames
    type(sdf_frames_type), intent(in) :: frames          !< the frames, with those of the model
    type(pose_type), intent(out) :: pose                 !< in the model
    type(error_type), allocatable, intent(inout) :: err  !< the failure

    if (allocated(err) .or. .not. tree%has(model, 'placement_frame')) return
    call frames%up_to(tree, model, scoped(prefix, tree%attribute(model, 'placement_frame')), prefix//model_frame, pose, err)
  end subroutine place_of_model

  !> A name in a model with the names of the models around it; an empty one is the model's own frame.
  pure function scoped(prefix, name) result(full)
    character(len=*), intent(in) :: prefix  !< names of the models, each with :: behind it
    character(len=*), intent(in) :: name    !< name in the innermost of them
    character(len=:), allocatable :: full

    full = prefix//name
    if (name == '' .or. name == 'world') full = prefix//model_frame
  end function scoped

  !> A frame without its pose.
  pure function new_frame(name, parent, holder) result(frame)
    character(len=*), intent(in) :: name    !< its name with those of the models around it
    character(len=*), intent(in) :: parent  !< frame of its pose, unless its element names one
    character(len=*), intent(in) :: holder  !< link or frame to which it is attached
    type(frame_type) :: frame

    frame%name = name
    frame%parent = parent
    frame%holder = holder
  end function new_frame

  !> Add the frame of an element, which tells its pose and may name another frame for it.
  subroutine add(self, tree, element, frame, prefix, err)
    class(sdf_frames_type), intent(inout) :: self        !< the frames
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element; 0: none, the pose is the identity
    type(frame_type), intent(in) :: frame                !< the frame without its pose
    character(len=*), intent(in) :: prefix               !< names of the models around it
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(frame_type), allocatable :: longer(:)
    character(len=:), allocatable :: parent
    integer :: n

    n = self%count
    if (n == most_frames) call tree%fail(max(element, 1), 'the model has too many frames', err)
    if (allocated(err)) return
    if (n == size(self%list)) then
      allocate (longer(2*n))
      longer(:n) = self%list
      call move_alloc(longer, self%list)
    end if
    n = n + 1
    self%count = n
    self%list(n) = frame
    ! of a link and a joint of one name the later one counts
    call self%numbers%set(frame%name, n)
    if (element == 0) return
    parent = tree%attribute(tree%child(element, 'pose'), 'relative_to')
    if (parent /= '') self%list(n)%parent = scoped(prefix, parent)
    call own_pose(tree, element, self%list(n)%pose, err)
  end subroutine add

  !> Number of the frame of a name; 0: there is none.
  pure integer function find(self, name) result(number)
    class(sdf_frames_type), intent(in) :: self  !< the frames
    character(len=*), intent(in) :: name        !< with the names of the models around it

    number = self%numbers%find(name)
  end function find

  !> The pose of a frame in the outermost model.
  subroutine in_model(self, tree, element, prefix, name, pose, err)
    class(sdf_frames_type), intent(in) :: self           !< the frames
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element that names it, for messages
    character(len=*), intent(in) :: prefix               !< names of the models around that element
    character(len=*), intent(in) :: name                 !< the frame; empty, __model__ or world: that of the model
    type(pose_type), intent(out) :: pose                 !< its pose
    type(error_type), allocatable, intent(inout) :: err  !< the failure

    call self%up_to(tree, element, scoped(prefix, name), model_frame, pose, err)
  end subroutine in_model

  !> The pose of a frame in one around it.
  subroutine up_to(self, tree, element, name, root, pose, err)
    class(sdf_frames_type), intent(in) :: self           !< the frames
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element that names it, for messages
    character(len=*), intent(in) :: name                 !< the frame, with the names of the models around it
    character(len=*), intent(in) :: root                 !< the frame around it
    type(pose_type), intent(out) :: pose                 !< its pose
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: frame
    integer :: i, steps

    frame = name
    steps = 0
    do while (frame /= root .and. .not. allocated(err))
      i = self%find(frame)
      if (i == 0) call tree%fail(element, "there is no frame '"//frame//"'", err)
      steps = steps + 1
      if (steps > self%count) call tree%fail(element, self%circle(name), err)
      if (allocated(err)) return
      pose = compose(self%list(i)%pose, pose)
      frame = self%list(i)%parent
    end do
  end subroutine up_to

  !> The words about frames that stand in each other: the first of them on the way from a frame, and the others.
  pure function circle(self, name) result(words)
    class(sdf_frames_type), intent(in) :: self  !< the frames
    character(len=*), intent(in) :: name        !< a frame whose way does not end
    character(len=:), allocatable :: words
    integer :: way(self%count + 1), n, first

    n = 1
    way(1) = self%find(name)
    do
      first = findloc(way(:n), self%find(self%list(way(n))%parent), dim=1)
      if (first > 0) exit
      way(n + 1) = self%find(self%list(way(n))%parent)
      n = n + 1
    end do
    words = "the frame '"//self%list(way(first))%name//"' stands in itself"
    do first = first + 1, n
      words = words//", by way of '"//self%list(way(first))%name//"'"
    end do
  end function circle

  !> The number of a link of a robot, or of the link to which a frame is attached; 0: there is none.
  pure integer function find_link(self, robot, prefix, name) result(link)
    class(sdf_frames_type), intent(in) :: self  !< the frames
    type(robot_type), intent(in) :: robot       !< the robot with its links
    character(len=*), intent(in) :: prefix      !< names of the models around the element that names it
    character(len=*), intent(in) :: name        !< name of the link or frame
    character(len=:), allocatable :: frame
    integer :: i, steps

    frame = prefix//name
    link = robot%find_link(frame)
    do steps = 1, self%count
      if (link > 0) return
      i = self%find(frame)
      if (i == 0) return
      frame = self%list(i)%holder
      link = robot%find_link(frame)
    end do
  end function find_link

  !> The pose that an element tells by <pose>; the identity where it has none.
  subroutine own_pose(tree, element, pose, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(pose_type), intent(out) :: pose                 !< in the frame that it names
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: numbers(7)
    character(len=:), allocatable :: format
    integer :: e

    e = tree%child(element, 'pose')
    if (e == 0 .or. allocated(err)) return
    if (tree%content(e) == '') return
    numbers = 0.0_wp
    format = tree%attribute(e, 'rotation_format')
    select case (format)
    case ('', 'euler_rpy')
      call numbers_in(tree, e, tree%content(e), '<pose>', numbers(:6), err)
      if (is_true(tree%attribute(e, 'degrees'))) numbers(4:) = numbers(4:)*degree
      pose%r = rotation_of_rpy(numbers(4:6))
    case ('quat_xyzw')
      call numbers_in(tree, e, tree%content(e), '<pose>', numbers, err)
      if (.not. any(abs(numbers(4:)) > 0.0_wp)) call tree%fail(e, 'the quaternion of <pose> is zero; no rotation is 0 0 0 1', err)
      if (is_true(tree%attribute(e, 'degrees'))) call tree%fail(e, 'a quaternion has no degrees; leave degrees out', err)
      pose%r = from_quaternion([numbers(7), numbers(4:6)])
    case default
      call tree%fail(e, "unknown rotation_format '"//format//"'; the formats are euler_rpy and quat_xyzw", err)
    end select
    pose%p = numbers(:3)
  end subroutine own_pose
end module mech9_sdf_frames
