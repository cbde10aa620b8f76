!> Robots in SDF, the format of Gazebo: links and joints of one model and of those in it, whose joints may close chains.
module mech9_sdf_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_pose, only: pose_type, compose
  use mech9_inertia, only: inertia_in_axes
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_content, get_content_number, is_true
  use mech9_robot, only: robot_type, robot_joint_type, fixed_joint, free_joint
  use mech9_sdf_frames, only: sdf_frames_type, list_frames, own_pose
  use mech9_sdf_joints, only: read_joints
  implicit none
  private
  public :: read_sdf

contains

  !> Read a document whose root is <sdf>. The world is the frame; a model that no joint holds to it moves freely.
  subroutine read_sdf(tree, robot, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(robot_type), intent(inout) :: robot           !< an empty robot; gets links and joints
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(sdf_frames_type) :: frames
    integer :: world, model

    world = tree%child(1, 'world')
    model = tree%child(1, 'model')
    if (model == 0) model = tree%child(world, 'model')
    if (model == 0) then
      call tree%fail(1, 'there is no <model>', err)
      return
    end if
    robot%name = tree%attribute(model, 'name')
    robot%gravity = [0.0_wp, 0.0_wp, -9.8_wp]
    call get_content(tree, world, 'gravity', robot%gravity, err)
    if (allocated(err)) return
    call note_world(tree, world, model, robot)
    call list_frames(tree, model, frames, err)
    if (allocated(err)) return
    call robot%add_link(tree, model, 'world', err)
    call read_links(tree, model, '', robot, err)
    call read_joints(tree, model, '', frames, robot, err)
    if (.not. allocated(err)) call hold_model(tree, model, frames, robot, err)
  end subroutine read_sdf

  !> Note the parts of the world, and the models beside the first one, which are not taken over.
  subroutine note_world(tree, world, model, robot)
    type(xml_tree_type), intent(in) :: tree   !< the document
    integer, intent(in) :: world              !< number of the element <world>; 0: none
    integer, intent(in) :: model              !< number of the element of the model that is read
    type(robot_type), intent(inout) :: robot  !< gets the notes
    integer :: e

    e = tree%next_named(model, 'model')
    if (e > 0) call robot%note(tree, e, 'the models behind the first one')
    e = tree%first_child(world)
    do while (e > 0)
      if (all(tree%name(e) /= [character(len=7) :: 'model', 'gravity'])) call robot%note(tree, e, '<'//tree%name(e)//'> of worlds')
      e = tree%next_sibling(e)
    end do
  end subroutine note_world

  !> Read the links of a model and of those in it.
  recursive subroutine read_links(tree, model, prefix, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: model                         !< number of the element <model>
    character(len=*), intent(in) :: prefix               !< names of the models around its links, each with :: behind it
    type(robot_type), intent(inout) :: robot             !< gets the links
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    integer :: e

    e = tree%first_child(model)
    do while (e > 0 .and. .not. allocated(err))
      select case (tree%name(e))
      case ('link')
        call read_link(tree, e, prefix//tree%attribute(e, 'name'), robot, err)
      case ('model')
        call read_links(tree, e, prefix//tree%attribute(e, 'name')//'::', robot, err)
      case ('include')
        call tree%fail(e, '<include> in a model is not followed; write the whole model in one file', err)
      case ('static')
        if (prefix /= '') call robot%note(tree, e, '<static> of models in models')
      case ('joint', 'pose', 'frame')
      case default
        call robot%note(tree, e, '<'//tree%name(e)//'> of models')
      end select
      e = tree%next_sibling(e)
    end do
  end subroutine read_links

  !> Read a link with its mass, which is 1 kg with moments of 1 kg m^2 unless the file tells it.
  subroutine read_link(tree, element, name, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <link>
    character(len=*), intent(in) :: name                 !< its name, with those of the models around it
    type(robot_type), intent(inout) :: robot             !< gets the link
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=3), parameter :: names(6) = ['ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz']
    type(pose_type) :: centre
    real(wp) :: mass, j(6)
    integer :: e, inertial, i

    call robot%add_link(tree, element, name, err)
    e = tree%first_child(element)
    do while (e > 0 .and. .not. allocated(err))
      if (all(tree%name(e) /= [character(len=8) :: 'inertial', 'pose'])) call robot%note(tree, e, '<'//tree%name(e)//'> of links')
      e = tree%next_sibling(e)
    end do
    inertial = tree%child(element, 'inertial')
    mass = 1.0_wp
    call get_content_number(tree, inertial, 'mass', mass, err)
    j = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    do i = 1, size(names)
      call get_content_number(tree, tree%child(inertial, 'inertia'), names(i), j(i), err)
    end do
    if (inertial > 0) then
      call own_pose(tree, inertial, centre, err)
      if (tree%attribute(tree%child(inertial, 'pose'), 'relative_to') /= '') &
        call tree%fail(inertial, '<pose> of <inertial> must stand in its link, without relative_to', err)
      if (is_true(tree%attribute(inertial, 'auto'))) call robot%note(tree, inertial, 'the inertia that shapes would give (auto)')
    end if
    if (mass < 0.0_wp) call tree%fail(element, "the mass of link '"//name//"' is negative", err)
    if (allocated(err)) return
    associate (link => robot%links(robot%n_links))
      link%mass = mass
      link%centre = centre%p
      link%inertia = inertia_in_axes(centre%r, reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), j(3)], [3, 3]))
    end associate
  end subroutine read_link

  !> Each group of links that no joint holds to the world is fixed to it in a static model, and moves freely in others.
  subroutine hold_model(tree, model, frames, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: model                         !< number of the element <model>
    type(sdf_frames_type), intent(in) :: frames          !< all frames
    type(robot_type), intent(inout) :: robot             !< gets joints
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(robot_joint_type) :: joint
    type(pose_type) :: pose
    logical :: held(robot%n_links), grows
    integer :: i, k, e

    held = .false.
    held(1) = .true.
    joint%kind = free_joint
    e = tree%child(model, 'static')
    if (e > 0) then
      if (is_true(tree%content(e))) joint%kind = fixed_joint
    end if
    do i = 1, robot%n_links
      if (.not. held(i)) then
        pose = pose_type()
        call frames%in_model(tree, model, '', robot%links(i)%name, pose, err)
        joint%name = 'world to '//robot%links(i)%name
        joint%links = [1, i]
        joint%frames(1) = compose(frames%model, pose)
        call robot%add_joint(tree, model, joint, err)
        held(i) = .true.
      end if
      grows = .true.
      do while (grows)
        grows = .false.
        do k = 1, robot%n_joints
          associate (links => robot%joints(k)%links)
            if (held(links(1)) .eqv. held(links(2))) cycle
            held(links) = .true.
            grows = .true.
          end associate
        end do
      end do
    end do
  end subroutine hold_model
end module mech9_sdf_reader
