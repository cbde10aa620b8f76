!> Joints of SDF: their frames in both links, axes, limits, springs, and joints that follow others.
module mech9_sdf_joints
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: unit
  use mech9_pose, only: pose_type, compose, inverse
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_content, get_content_number, is_true, place_in, one_of
  use mech9_robot, only: robot_type, robot_joint_type, fixed_joint, revolute_joint, prismatic_joint, helical_joint, &
                         universal_joint, spherical_joint, note_of_ranges
  use mech9_sdf_frames, only: sdf_frames_type
  implicit none
  private
  public :: read_joints

  !> Words for the kinds of joints. In SDF the two axes of `revolute2` need not be at a right angle, nor need those of universal
  !> pairs here.
  character(len=*), parameter :: words(*) = [character(len=10) :: 'fixed', 'revolute', 'continuous', 'prismatic', 'screw', &
                                             'universal', 'revolute2', 'ball']
  integer, parameter :: kinds(*) = [fixed_joint, revolute_joint, revolute_joint, prismatic_joint, helical_joint, universal_joint, &
                                    universal_joint, spherical_joint]
  !> Limits of this size are none.
  real(wp), parameter :: no_limit = 1.0e15_wp

contains

  !> Read the joints of a model and of those in it.
  recursive subroutine read_joints(tree, model, prefix, frames, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: model                         !< number of the element <model>
    character(len=*), intent(in) :: prefix               !< names of the models around its joints
    type(sdf_frames_type), intent(in) :: frames          !< all frames
    type(robot_type), intent(inout) :: robot             !< a robot with its links; gets the joints
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    integer :: e

    e = tree%first_child(model)
    do while (e > 0 .and. .not. allocated(err))
      if (tree%name(e) == 'model') call read_joints(tree, e, prefix//tree%attribute(e, 'name')//'::', frames, robot, err)
      if (tree%name(e) == 'joint') then
        if (tree%attribute(e, 'type') == 'gearbox') then
          call robot%note(tree, e, "joint '"//prefix//tree%attribute(e, 'name')//"' of the type gearbox; write &coupling "// &
                          "kind='gear' with the coordinates of both shafts in its place")
        else
          call read_joint(tree, e, prefix, frames, robot, err)
        end if
      end if
      e = tree%next_sibling(e)
    end do
  end subroutine read_joints

  !> Read a joint. One whose child has a parent already closes a chain.
  subroutine read_joint(tree, element, prefix, frames, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <joint>
    character(len=*), intent(in) :: prefix               !< names of the models around it
    type(sdf_frames_type), intent(in) :: frames          !< all frames
    type(robot_type), intent(inout) :: robot             !< gets the joint
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: word
    type(robot_joint_type) :: joint
    type(pose_type) :: in_model
    integer :: place, k

    word = tree%attribute(element, 'type')
    place = place_in(words, word)
    if (place == 0) call tree%fail(element, "unknown type '"//word//"' of a joint; "//one_of(words), err)
    if (allocated(err)) return
    joint%kind = kinds(place)
    joint%name = prefix//tree%attribute(element, 'name')
    call frames%in_model(tree, element, prefix, tree%attribute(element, 'name'), in_model, err)
    call take_side('parent', joint%links(1), joint%frames(1))
    call take_side('child', joint%links(2), joint%frames(2))
    if (joint%links(1) == joint%links(2)) call tree%fail(element, "joint '"//joint%name//"' joins a link with itself", err)
    joint%axis = [0.0_wp, 0.0_wp, 1.0_wp]
    call read_axis(tree, tree%child(element, 'axis'), prefix, frames, in_model, joint%axis, err)
    call read_axis(tree, tree%child(element, 'axis2'), prefix, frames, in_model, joint%second, err)
    call get_content_number(tree, element, 'screw_thread_pitch', joint%pitch, err)
    if (joint%kind == helical_joint .and. tree%child(element, 'screw_thread_pitch') == 0) &
      call tree%fail(element, "the screw '"//joint%name//"' needs <screw_thread_pitch>, its advance per turn", err)
    if (any(joint%kind == [revolute_joint, prismatic_joint])) call read_limits(tree, tree%child(element, 'axis'), joint, robot, err)
    if (any(joint%kind == [revolute_joint, prismatic_joint, helical_joint])) &
      call read_leader(tree, tree%child(tree%child(element, 'axis'), 'mimic'), prefix, joint, robot, err)
    call note_parts(tree, element, joint, robot)
    do k = 1, robot%n_joints
      if (robot%joints(k)%links(2) == joint%links(2)) joint%closes = .true.
    end do
    call robot%add_joint(tree, element, joint, err)
  contains
    !> One of both links of the joint, with the frame of the joint in it.
    subroutine take_side(name, link, frame)
      character(len=*), intent(in) :: name      !< parent or child
      integer, intent(inout) :: link            !< gets the number of the link
      type(pose_type), intent(inout) :: frame   !< gets the frame
      type(pose_type) :: pose
      character(len=:), allocatable :: link_name
      integer :: e

      e = tree%child(element, name)
      if (e == 0) call tree%fail(element, "joint '"//joint%name//"' has no <"//name//'>', err)
      if (allocated(err)) return
      link_name = tree%content(e)
      link = 1
      if (link_name /= 'world') link = frames%find_link(robot, prefix, link_name)
      if (link == 0) call tree%fail(e, "there is no link '"//prefix//link_name//"', which joint '"//joint%name//"' names", err)
      if (allocated(err)) return
      pose = inverse(frames%model)
      if (link > 1) then
        pose = pose_type()
        call frames%in_model(tree, e, '', robot%links(link)%name, pose, err)
      end if
      frame = compose(inverse(pose), in_model)
    end subroutine take_side
  end subroutine read_joint

  !> The direction of an axis in the frame of its joint. It stays as it is where there is none.
  subroutine read_axis(tree, element, prefix, frames, in_model, axis, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <axis> or <axis2>; 0: none
    character(len=*), intent(in) :: prefix               !< names of the models around it
    type(sdf_frames_type), intent(in) :: frames          !< all frames
    type(pose_type), intent(in) :: in_model              !< of the joint in the outermost model
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
    call frames%in_model(tree, element, prefix, frame, pose, err)
    axis = matmul(matmul(pose%r, axis), in_model%r)
  end subroutine read_axis

  !> Range, spring and damper of a joint.
  subroutine read_limits(tree, axis, joint, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: axis                          !< number of the element <axis>; 0: none
    type(robot_joint_type), intent(inout) :: joint       !< gets the axes
    type(robot_type), intent(inout) :: robot             !< gets notes
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: friction
    integer :: limit, dynamics

    limit = tree%child(axis, 'limit')
    joint%range = [-no_limit, no_limit]
    call get_content_number(tree, limit, 'lower', joint%range(1), err)
    call get_content_number(tree, limit, 'upper', joint%range(2), err)
    joint%has_range = any(abs(joint%range) < no_limit)
    if (joint%has_range) joint%start = min(max(0.0_wp, joint%range(1)), joint%range(2))
    if (all(abs(joint%range) < no_limit) .and. abs(joint%start) > 0.0_wp) joint%start = 0.5_wp*sum(joint%range)
    if (joint%has_range) call robot%note(tree, axis, note_of_ranges)
    if (tree%child(limit, 'effort') > 0 .or. tree%child(limit, 'velocity') > 0) &
      call robot%note(tree, limit, 'limits of efforts and velocities')
    dynamics = tree%child(axis, 'dynamics')
    friction = 0.0_wp
    call get_content_number(tree, dynamics, 'damping', joint%damping, err)
    call get_content_number(tree, dynamics, 'spring_stiffness', joint%stiffness, err)
    call get_content_number(tree, dynamics, 'spring_reference', joint%rest, err)
    call get_content_number(tree, dynamics, 'friction', friction, err)
    if (abs(friction) > 0.0_wp) call robot%note(tree, axis, "the friction of joint '"//joint%name//"'")
  end subroutine read_limits

  !> Read <mimic>: the coordinate is multiplier (coordinate of the leader - reference) + offset.
  subroutine read_leader(tree, mimic, prefix, joint, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: mimic                         !< number of the element <mimic>; 0: none
    character(len=*), intent(in) :: prefix               !< names of the models around it
    type(robot_joint_type), intent(inout) :: joint       !< gets leader, ratio and offset
    type(robot_type), intent(inout) :: robot             !< gets notes
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: reference

    if (mimic == 0) return
    if (tree%attribute(mimic, 'axis') == 'axis2') then
      call robot%note(tree, mimic, "the coupling of joint '"//joint%name//"' with the second axis of joint '"//prefix// &
                      tree%attribute(mimic, 'joint')//"'")
      return
    end if
    if (.not. tree%has(mimic, 'joint')) call tree%fail(mimic, "<mimic> needs 'joint', the joint that is followed", err)
    if (tree%child(mimic, 'multiplier') == 0) call tree%fail(mimic, '<mimic> needs <multiplier>', err)
    joint%leader = prefix//tree%attribute(mimic, 'joint')
    reference = 0.0_wp
    call get_content_number(tree, mimic, 'multiplier', joint%ratio, err)
    call get_content_number(tree, mimic, 'offset', joint%offset, err)
    call get_content_number(tree, mimic, 'reference', reference, err)
    joint%offset = joint%offset - joint%ratio*reference
  end subroutine read_leader

  !> Note the parts of a joint that are not taken over.
  subroutine note_parts(tree, element, joint, robot)
    type(xml_tree_type), intent(in) :: tree         !< the document
    integer, intent(in) :: element                  !< number of the element <joint>
    type(robot_joint_type), intent(in) :: joint     !< the joint
    type(robot_type), intent(inout) :: robot        !< gets the notes
    integer :: e, part

    e = tree%first_child(element)
    do while (e > 0)
      select case (tree%name(e))
      case ('parent', 'child', 'pose', 'screw_thread_pitch', 'thread_pitch')
      case ('axis', 'axis2')
        part = tree%first_child(e)
        do while (part > 0)
          if (.not. is_taken(tree%name(part), joint%kind, tree%name(e) == 'axis')) &
            call robot%note(tree, part, '<'//tree%name(part)//'> of <'//tree%name(e)//"> of joint '"//joint%name//"'")
          part = tree%next_sibling(part)
        end do
      case default
        call robot%note(tree, e, '<'//tree%name(e)//'> of joints')
      end select
      e = tree%next_sibling(e)
    end do
  end subroutine note_parts

  !> Whether a part of an axis is taken over.
  pure logical function is_taken(name, kind, is_first)
    character(len=*), intent(in) :: name  !< name of the element in <axis>
    integer, intent(in) :: kind           !< kind of the joint
    logical, intent(in) :: is_first       !< the axis is the first one of the joint

    select case (name)
    case ('xyz', 'use_parent_model_frame')
      is_taken = .true.
    case ('limit', 'dynamics')
      is_taken = is_first .and. any(kind == [revolute_joint, prismatic_joint])
    case ('mimic')
      is_taken = is_first .and. any(kind == [revolute_joint, prismatic_joint, helical_joint])
    case default
      is_taken = .false.
    end select
  end function is_taken
end module mech9_sdf_joints
