!> Robots in SDF, the format of Gazebo: links and joints of one model, whose joints may close chains.
module mech9_sdf_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: unit
  use mech9_pose, only: pose_type, compose, inverse
  use mech9_inertia, only: inertia_in_axes
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: numbers_in, is_true, place_in
  use mech9_robot, only: robot_type, robot_joint_type, fixed_joint, revolute_joint, prismatic_joint, helical_joint, &
                         universal_joint, spherical_joint, free_joint
  use mech9_sdf_frames, only: sdf_frames_type, list_frames, own_pose
  implicit none
  private
  public :: read_sdf

  !> Words for the kinds of joints.
  character(len=*), parameter :: words(*) = [character(len=10) :: 'fixed', 'revolute', 'continuous', 'prismatic', 'screw', &
                                             'universal', 'ball']
  integer, parameter :: kinds(*) = [fixed_joint, revolute_joint, revolute_joint, prismatic_joint, helical_joint, universal_joint, &
                                    spherical_joint]
  !> Limits of this size are none.
  real(wp), parameter :: no_limit = 1.0e15_wp

contains

  !> Read a document whose root is <sdf>. The world is the frame; a model that no joint holds to it moves freely.
  subroutine read_sdf(tree, robot, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(robot_type), intent(inout) :: robot           !< an empty robot; gets links and joints
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(sdf_frames_type) :: frames
    type(pose_type) :: at
    integer :: world, model, e

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
    e = tree%next_named(model, 'model')
    if (e > 0) call robot%note(tree, e, 'the models behind the first one')
    call list_frames(tree, model, frames, err)
    if (.not. allocated(err)) call own_pose(tree, model, at, err)
    if (allocated(err)) return
    call robot%add_link(tree, model, 'world', err)
    e = tree%first_child(model)
    do while (e > 0 .and. .not. allocated(err))
      select case (tree%name(e))
      case ('link')
        call read_link(tree, e, robot, err)
      case ('model', 'include')
        call tree%fail(e, '<'//tree%name(e)//'> in a model is not followed; write the whole model in one file', err)
      case ('joint', 'pose', 'static', 'frame')
      case default
        call robot%note(tree, e, '<'//tree%name(e)//'> of models')
      end select
      e = tree%next_sibling(e)
    end do
    e = tree%child(model, 'joint')
    do while (e > 0 .and. .not. allocated(err))
      call read_joint(tree, e, frames, at, robot, err)
      e = tree%next_named(e, 'joint')
    end do
    if (.not. allocated(err)) call hold_model(tree, model, frames, at, robot, err)
  end subroutine read_sdf

  !> The numbers in the text of an element of this name in an element. They stay as they are where there is none.
  subroutine get_content(tree, element, name, numbers, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element around it; 0: none
    character(len=*), intent(in) :: name                 !< its name
    real(wp), intent(inout) :: numbers(:)                !< defaults before, values afterwards
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    integer :: e

    e = tree%child(element, name)
    if (e > 0) call numbers_in(tree, e, tree%content(e), '<'//name//'>', numbers, err)
  end subroutine get_content

  !> The number in the text of an element of this name in an element. It stays as it is where there is none.
  subroutine get_one(tree, element, name, number, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element around it; 0: none
    character(len=*), intent(in) :: name                 !< its name
    real(wp), intent(inout) :: number                    !< default before, value afterwards
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: numbers(1)

    numbers = number
    call get_content(tree, element, name, numbers, err)
    number = numbers(1)
  end subroutine get_one

  !> Read a link with its mass, which is 1 kg with moments of 1 kg m^2 unless the file tells it.
  subroutine read_link(tree, element, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <link>
    type(robot_type), intent(inout) :: robot             !< gets the link
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=3), parameter :: names(6) = ['ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz']
    type(pose_type) :: centre
    real(wp) :: mass, j(6)
    integer :: e, inertial, i

    call robot%add_link(tree, element, tree%attribute(element, 'name'), err)
    e = tree%first_child(element)
    do while (e > 0)
      if (all(tree%name(e) /= [character(len=8) :: 'inertial', 'pose'])) call robot%note(tree, e, '<'//tree%name(e)//'> of links')
      e = tree%next_sibling(e)
    end do
    inertial = tree%child(element, 'inertial')
    mass = 1.0_wp
    call get_one(tree, inertial, 'mass', mass, err)
    j = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    do i = 1, size(names)
      call get_one(tree, tree%child(inertial, 'inertia'), names(i), j(i), err)
    end do
    if (inertial > 0) then
      call own_pose(tree, inertial, centre, err)
      if (tree%attribute(tree%child(inertial, 'pose'), 'relative_to') /= '') &
        call tree%fail(inertial, '<pose> of <inertial> must stand in its link, without relative_to', err)
      if (is_true(tree%attribute(inertial, 'auto'))) call robot%note(tree, inertial, 'the inertia that shapes would give (auto)')
    end if
    if (mass < 0.0_wp) call tree%fail(element, "the mass of link '"//tree%attribute(element, 'name')//"' is negative", err)
    if (allocated(err)) return
    associate (link => robot%links(robot%n_links))
      link%mass = mass
      link%centre = centre%p
      link%inertia = inertia_in_axes(centre%r, reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), j(3)], [3, 3]))
    end associate
  end subroutine read_link

  !> Read a joint. One whose child has a parent already closes a chain.
  subroutine read_joint(tree, element, frames, at, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <joint>
    type(sdf_frames_type), intent(in) :: frames          !< all frames of the model
    type(pose_type), intent(in) :: at                    !< of the model in the world
    type(robot_type), intent(inout) :: robot             !< gets the joint
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: word
    type(robot_joint_type) :: joint
    type(pose_type) :: in_model
    integer :: place, k

    word = tree%attribute(element, 'type')
    place = place_in(words, word)
    if (place == 0) call tree%fail(element, "joints of the type '"//word//"' are not known", err)
    if (allocated(err)) return
    joint%kind = kinds(place)
    joint%name = tree%attribute(element, 'name')
    call frames%in_model(tree, element, joint%name, in_model, err)
    call take_side(tree, element, 'parent', 1, frames, at, in_model, robot, joint, err)
    call take_side(tree, element, 'child', 2, frames, at, in_model, robot, joint, err)
    if (joint%links(1) == joint%links(2)) call tree%fail(element, "joint '"//joint%name//"' joins a link with itself", err)
    joint%axis = [0.0_wp, 0.0_wp, 1.0_wp]
    call read_axis(tree, tree%child(element, 'axis'), frames, in_model, joint%axis, err)
    call read_axis(tree, tree%child(element, 'axis2'), frames, in_model, joint%second, err)
    call get_one(tree, element, 'screw_thread_pitch', joint%pitch, err)
    if (joint%kind == helical_joint .and. tree%child(element, 'screw_thread_pitch') == 0) &
      call tree%fail(element, "the screw '"//joint%name//"' needs <screw_thread_pitch>, its advance per turn", err)
    if (any(joint%kind == [revolute_joint, prismatic_joint])) call read_limits(tree, tree%child(element, 'axis'), joint, robot, err)
    do k = 1, robot%n_joints
      if (robot%joints(k)%links(2) == joint%links(2)) joint%closes = .true.
    end do
    call robot%add_joint(tree, element, joint, err)
  end subroutine read_joint

  !> One of both links of a joint, with the frame of the joint in it.
  subroutine take_side(tree, element, name, side, frames, at, in_model, robot, joint, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <joint>
    character(len=*), intent(in) :: name                 !< parent or child
    integer, intent(in) :: side                          !< 1 or 2
    type(sdf_frames_type), intent(in) :: frames          !< all frames of the model
    type(pose_type), intent(in) :: at                    !< of the model in the world
    type(pose_type), intent(in) :: in_model              !< of the joint in the model
    type(robot_type), intent(in) :: robot                !< the robot with its links
    type(robot_joint_type), intent(inout) :: joint       !< gets link and frame
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(pose_type) :: pose
    character(len=:), allocatable :: link
    integer :: e

    e = tree%child(element, name)
    if (e == 0) call tree%fail(element, "joint '"//joint%name//"' has no <"//name//'>', err)
    if (allocated(err)) return
    link = tree%content(e)
    joint%links(side) = robot%find_link(link)
    if (joint%links(side) == 0) call tree%fail(e, "there is no link '"//link//"', which joint '"//joint%name//"' names", err)
    pose = inverse(at)
    if (joint%links(side) > 1) then
      pose = pose_type()
      call frames%in_model(tree, e, link, pose, err)
    end if
    joint%frames(side) = compose(inverse(pose), in_model)
  end subroutine take_side

  !> The direction of an axis in the frame of its joint. It stays as it is where there is none.
  subroutine read_axis(tree, element, frames, in_model, axis, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <axis> or <axis2>; 0: none
    type(sdf_frames_type), intent(in) :: frames          !< all frames of the model
    type(pose_type), intent(in) :: in_model              !< of the joint in the model
    real(wp), intent(inout) :: axis(3)                   !< of length one
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: frame
    type(pose_type) :: pose

    call get_content(tree, element, 'xyz', axis, err)
    if (allocated(err)) return
    if (.not. any(abs(axis) > 0.0_wp)) call tree%fail(element, 'the axis has no direction: its components are all zero', err)
    axis = unit(axis)
    frame = tree%attribute(tree%child(element, 'xyz'), 'expressed_in')
    if (element > 0) then
      if (tree%child(element, 'use_parent_model_frame') > 0) then
        if (is_true(tree%content(tree%child(element, 'use_parent_model_frame')))) frame = '__model__'
      end if
    end if
    if (frame == '') return
    call frames%in_model(tree, element, frame, pose, err)
    axis = matmul(matmul(pose%r, axis), in_model%r)
  end subroutine read_axis

  !> Range, spring and damper of a joint.
  subroutine read_limits(tree, axis, joint, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: axis                          !< number of the element <axis>; 0: none
    type(robot_joint_type), intent(inout) :: joint       !< gets them
    type(robot_type), intent(inout) :: robot             !< gets notes
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: friction
    integer :: dynamics

    joint%range = [-no_limit, no_limit]
    call get_one(tree, tree%child(axis, 'limit'), 'lower', joint%range(1), err)
    call get_one(tree, tree%child(axis, 'limit'), 'upper', joint%range(2), err)
    joint%has_range = any(abs(joint%range) < no_limit)
    if (joint%has_range) joint%start = min(max(0.0_wp, joint%range(1)), joint%range(2))
    if (all(abs(joint%range) < no_limit) .and. abs(joint%start) > 0.0_wp) joint%start = 0.5_wp*sum(joint%range)
    if (joint%has_range) call robot%note(tree, axis, 'ranges of joints, which data files do not have; comments of the data '// &
                                         'file tell them')
    dynamics = tree%child(axis, 'dynamics')
    friction = 0.0_wp
    call get_one(tree, dynamics, 'damping', joint%damping, err)
    call get_one(tree, dynamics, 'spring_stiffness', joint%stiffness, err)
    call get_one(tree, dynamics, 'spring_reference', joint%rest, err)
    call get_one(tree, dynamics, 'friction', friction, err)
    if (abs(friction) > 0.0_wp) call robot%note(tree, axis, "the friction of joint '"//joint%name//"'")
    if (tree%child(axis, 'mimic') > 0) call robot%note(tree, axis, "<mimic> of joint '"//joint%name//"'")
  end subroutine read_limits

  !> Each group of links that no joint holds to the world is fixed to it in a static model, and moves freely in others.
  subroutine hold_model(tree, model, frames, at, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: model                         !< number of the element <model>
    type(sdf_frames_type), intent(in) :: frames          !< all frames of the model
    type(pose_type), intent(in) :: at                    !< of the model in the world
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
        call frames%in_model(tree, model, robot%links(i)%name, pose, err)
        joint%name = 'world to '//robot%links(i)%name
        joint%links = [1, i]
        joint%frames(1) = compose(at, pose)
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
