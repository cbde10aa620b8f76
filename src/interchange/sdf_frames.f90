!> Poses in SDF: each stands in a frame that it may name, which stands in another one.
module mech9_sdf_frames
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_pose, only: pose_type, compose
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: numbers_in, is_true
  use mech9_urdf_reader, only: rotation_of_rpy
  implicit none
  private
  public :: sdf_frames_type, list_frames, own_pose

  integer, parameter :: most_frames = 5000
  real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp

  !> The frames of a model: its own, those of links, joints and elements <frame>.
  type :: sdf_frames_type
    integer :: count = 0                          !< number of frames
    type(string_type), allocatable :: names(:)    !< their names
    type(string_type), allocatable :: parents(:)  !< names of the frames in which their poses stand; empty: the model
    type(pose_type), allocatable :: poses(:)      !< in these frames
  contains
    procedure :: in_model
    procedure, private :: add
  end type sdf_frames_type

contains

  !> List the frames of a model.
  subroutine list_frames(tree, model, frames, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    integer, intent(in) :: model                       !< number of the element <model>
    type(sdf_frames_type), intent(out) :: frames       !< its frames
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: parent
    integer :: e

    allocate (frames%names(64), frames%parents(64), frames%poses(64))
    e = tree%first_child(model)
    do while (e > 0 .and. .not. allocated(err))
      parent = ''
      select case (tree%name(e))
      case ('link')
        call frames%add(tree, e, parent, err)
      case ('joint')
        ! the frame of a joint stands in that of its child
        if (tree%child(e, 'child') > 0) parent = tree%content(tree%child(e, 'child'))
        call frames%add(tree, e, parent, err)
      case ('frame')
        parent = tree%attribute(e, 'attached_to')
        call frames%add(tree, e, parent, err)
      end select
      e = tree%next_sibling(e)
    end do
  end subroutine list_frames

  !> Add the frame of an element, which may name another one for its pose.
  subroutine add(self, tree, element, parent, err)
    class(sdf_frames_type), intent(inout) :: self        !< the frames
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    character(len=*), intent(in) :: parent               !< frame of its pose, unless it names one
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(string_type), allocatable :: names(:), parents(:)
    type(pose_type), allocatable :: poses(:)
    integer :: n

    n = self%count
    if (n == most_frames) call tree%fail(element, 'the model has too many frames', err)
    if (n == size(self%names)) then
      allocate (names(2*n), parents(2*n), poses(2*n))
      names(:n) = self%names
      parents(:n) = self%parents
      poses(:n) = self%poses
      call move_alloc(names, self%names)
      call move_alloc(parents, self%parents)
      call move_alloc(poses, self%poses)
    end if
    n = n + 1
    self%names(n)%text = tree%attribute(element, 'name')
    self%parents(n)%text = parent
    if (tree%attribute(tree%child(element, 'pose'), 'relative_to') /= '') &
      self%parents(n)%text = tree%attribute(tree%child(element, 'pose'), 'relative_to')
    call own_pose(tree, element, self%poses(n), err)
    self%count = n
  end subroutine add

  !> The pose of a frame in the model.
  subroutine in_model(self, tree, element, name, pose, err)
    class(sdf_frames_type), intent(in) :: self           !< the frames
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element that names it, for messages
    character(len=*), intent(in) :: name                 !< the frame; empty, __model__ or world: the model
    type(pose_type), intent(out) :: pose                 !< its pose
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: frame
    integer :: i, steps

    frame = name
    steps = 0
    do while (.not. (frame == '' .or. frame == '__model__' .or. frame == 'world') .and. .not. allocated(err))
      do i = self%count, 1, -1
        if (self%names(i)%text == frame) exit
      end do
      if (i == 0) call tree%fail(element, "there is no frame '"//frame//"'", err)
      steps = steps + 1
      if (steps > self%count) call tree%fail(element, "the frame '"//name//"' stands in itself, by way of others", err)
      if (allocated(err)) return
      pose = compose(self%poses(i), pose)
      frame = self%parents(i)%text
    end do
  end subroutine in_model

  !> The pose that an element tells by <pose>; the identity where it has none.
  subroutine own_pose(tree, element, pose, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(pose_type), intent(out) :: pose                 !< in the frame that it names
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: numbers(6)
    integer :: e

    e = tree%child(element, 'pose')
    if (e == 0) return
    if (tree%content(e) == '') return
    if (tree%attribute(e, 'rotation_format') == 'quat_xyzw') then
      call tree%fail(e, 'poses with quaternions are not known; write roll, pitch and yaw', err)
      return
    end if
    numbers = 0.0_wp
    call numbers_in(tree, e, tree%content(e), '<pose>', numbers, err)
    if (is_true(tree%attribute(e, 'degrees'))) numbers(4:) = numbers(4:)*degree
    pose%p = numbers(:3)
    pose%r = rotation_of_rpy(numbers(4:))
  end subroutine own_pose
end module mech9_sdf_frames
