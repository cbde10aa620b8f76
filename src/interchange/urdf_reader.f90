!> Robots in URDF, with the joints that close chains: as <loop> elements of URDF+, or as joints to a link that has a parent.
module mech9_urdf_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_rotation, only: unit
  use mech9_pose, only: pose_type
  use mech9_inertia, only: inertia_in_axes
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_numbers, get_number, needed_attribute, is_true, place_in, one_of
  use mech9_orientations, only: rotation_of_rpy
  use mech9_robot, only: robot_type, robot_joint_type, fixed_joint, revolute_joint, prismatic_joint, cylindrical_joint, &
                         universal_joint, spherical_joint, planar_joint, free_joint, note_of_ranges, most_links, most_joints
  implicit none
  private
  public :: read_urdf, read_loops

  !> Words for the kinds of joints; those from `spherical` on are of loops.
  character(len=*), parameter :: words(*) = [character(len=11) :: 'fixed', 'revolute', 'continuous', 'prismatic', 'floating', &
                                             'planar', 'spherical', 'universal', 'cylindrical', 'free']
  integer, parameter :: kinds(*) = [fixed_joint, revolute_joint, revolute_joint, prismatic_joint, free_joint, planar_joint, &
                                    spherical_joint, universal_joint, cylindrical_joint, free_joint]

contains

  !> Read a document whose root is <robot>. The link without a parent is the frame.
  subroutine read_urdf(tree, robot, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(robot_type), intent(inout) :: robot           !< an empty robot; gets links and joints
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: e, root

    robot%name = tree%attribute(1, 'name')
    call count_parts(tree, err)
    if (allocated(err)) return
    call find_root(tree, root, err)
    if (allocated(err)) return
    call read_link(tree, root, robot, err)
    e = tree%first_child(1)
    do while (e > 0 .and. .not. allocated(err))
      if (tree%name(e) == 'link' .and. e /= root) call read_link(tree, e, robot, err)
      e = tree%next_sibling(e)
    end do
    if (.not. allocated(err)) call read_loops(tree, robot, err)
  end subroutine read_urdf

  !> Fail where there are too many elements to be compared with each other.
  subroutine count_parts(tree, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(error_type), allocatable, intent(out) :: err  !< allocated if there are
    integer :: e, n

    n = 0
    e = tree%first_child(1)
    do while (e > 0 .and. n <= most_links + most_joints)
      if (any(tree%name(e) == [character(len=5) :: 'link', 'joint', 'loop'])) n = n + 1
      if (n > most_links + most_joints) call tree%fail(e, 'the robot has too many links and joints: more than '// &
                                                       to_text(most_links + most_joints), err)
      e = tree%next_sibling(e)
    end do
  end subroutine count_parts

  !> The element of the link that is the child of no joint or loop. Where each link is the child of one, it is the first link.
  subroutine find_root(tree, root, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    integer, intent(out) :: root                       !< number of the element
    type(error_type), allocatable, intent(out) :: err  !< allocated if there are several, or no link at all
    integer :: e

    root = 0
    e = tree%child(1, 'link')
    if (e == 0) call tree%fail(1, 'the robot has no <link>', err)
    do while (e > 0)
      if (.not. is_child(tree, 'joint', 'child', tree%attribute(e, 'name')) .and. &
          .not. is_child(tree, 'loop', 'successor', tree%attribute(e, 'name'))) then
        if (root > 0) then
          if (tree%attribute(e, 'name') == tree%attribute(root, 'name')) &
            call tree%fail(e, "there are two links '"//tree%attribute(e, 'name')//"'", err)
          call refuse_unknown_child(tree, err)
          call tree%fail(e, "link '"//tree%attribute(e, 'name')//"' hangs on no joint, and neither does link '"// &
                         tree%attribute(root, 'name')//"'; only one link, the frame, may be without one", err)
          return
        end if
        root = e
      end if
      e = tree%next_named(e, 'link')
    end do
    if (root == 0) root = tree%child(1, 'link')
  end subroutine find_root

  !> Fail where a joint names a child that is no link of the robot.
  subroutine refuse_unknown_child(tree, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: link
    integer :: e

    e = tree%child(1, 'joint')
    do while (e > 0 .and. .not. allocated(err))
      link = tree%attribute(tree%child(e, 'child'), 'link')
      if (link /= '' .and. named_link(tree, link) == 0) &
        call tree%fail(tree%child(e, 'child'), "there is no link '"//link//"', which joint '"//tree%attribute(e, 'name')// &
                       "' names", err)
      e = tree%next_named(e, 'joint')
    end do
  end subroutine refuse_unknown_child

  !> The first <link> of a name; 0: there is none.
  integer function named_link(tree, name) result(element)
    type(xml_tree_type), intent(in) :: tree  !< the document
    character(len=*), intent(in) :: name     !< value of its attribute `name`

    element = tree%child(1, 'link')
    do while (element > 0)
      if (tree%attribute(element, 'name') == name) return
      element = tree%next_named(element, 'link')
    end do
  end function named_link

  !> Whether a link is the child of a joint, or the successor of a loop.
  logical function is_child(tree, joints, side, link)
    type(xml_tree_type), intent(in) :: tree  !< the document
    character(len=*), intent(in) :: joints   !< name of elements: joint or loop
    character(len=*), intent(in) :: side     !< name of the element in them that names the link
    character(len=*), intent(in) :: link     !< name of the link
    integer :: e

    is_child = .true.
    e = tree%child(1, joints)
    do while (e > 0)
      if (tree%attribute(tree%child(e, side), 'link') == link) return
      e = tree%next_named(e, joints)
    end do
    is_child = .false.
  end function is_child

  !> Read a link with its mass.
  subroutine read_link(tree, element, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <link>
    type(robot_type), intent(inout) :: robot             !< gets the link
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: name
    integer :: e

    if (allocated(err)) return
    name = needed_attribute(tree, element, 'name', err)
    call robot%add_link(tree, element, name, err)
    e = tree%first_child(element)
    do while (e > 0 .and. .not. allocated(err))
      if (tree%name(e) == 'inertial') then
        call read_inertial(tree, e, robot, err)
      else
        call robot%note(tree, e, '<'//tree%name(e)//'> of links')
      end if
      e = tree%next_sibling(e)
    end do
  end subroutine read_link

  !> Read mass, mass centre and inertia of the newest link.
  subroutine read_inertial(tree, element, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <inertial>
    type(robot_type), intent(inout) :: robot             !< gets them
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=3), parameter :: names(6) = ['ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz']
    type(pose_type) :: origin
    real(wp) :: j(6)
    integer :: i, e

    call get_origin(tree, tree%child(element, 'origin'), origin, err)
    e = tree%child(element, 'inertia')
    j = 0.0_wp
    do i = 1, size(names)
      call get_number(tree, e, names(i), j(i), err)
    end do
    associate (link => robot%links(robot%n_links))
      call get_number(tree, tree%child(element, 'mass'), 'value', link%mass, err)
      if (link%mass < 0.0_wp) call tree%fail(element, "the mass of link '"//link%name//"' is negative", err)
      link%centre = origin%p
      link%inertia = inertia_in_axes(origin%r, reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), j(3)], [3, 3]))
    end associate
  end subroutine read_inertial

  !> Read the joints and loops of a document, whose root may have any name, into a robot that has its links.
  subroutine read_loops(tree, robot, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(robot_type), intent(inout) :: robot           !< a robot with links; gets joints
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: e

    e = tree%first_child(1)
    do while (e > 0 .and. .not. allocated(err))
      select case (tree%name(e))
      case ('link')
      case ('joint')
        call read_joint(tree, e, 'parent', 'child', robot, err)
      case ('loop')
        call read_joint(tree, e, 'predecessor', 'successor', robot, err)
      case default
        if (index(tree%name(e), 'xacro:') == 1) then
          call tree%fail(e, 'this is a file of macros of xacro; expand it by xacro before it is imported', err)
        else
          call robot%note(tree, e, '<'//tree%name(e)//'>')
        end if
      end select
      e = tree%next_sibling(e)
    end do
  end subroutine read_loops

  !> Read a joint or a loop.
  subroutine read_joint(tree, element, first, second, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <joint> or <loop>
    character(len=*), intent(in) :: first                !< name of the element that names its reference link
    character(len=*), intent(in) :: second               !< name of the element that names its moving link
    type(robot_type), intent(inout) :: robot             !< gets the joint
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(robot_joint_type) :: joint
    character(len=:), allocatable :: word
    type(pose_type) :: inner
    integer :: place

    joint%name = needed_attribute(tree, element, 'name', err)
    word = needed_attribute(tree, element, 'type', err)
    place = place_in(words, word)
    if (place == 0) call tree%fail(element, "unknown type '"//word//"' of a joint; "//one_of(words), err)
    if (allocated(err)) return
    joint%kind = kinds(place)
    joint%links(1) = link_of(tree, element, first, robot, err)
    joint%links(2) = link_of(tree, element, second, robot, err)
    if (joint%links(1) == joint%links(2)) call tree%fail(element, "joint '"//joint%name//"' joins a link with itself", err)
    joint%closes = tree%name(element) == 'loop'
    call get_origin(tree, tree%child(element, 'origin'), joint%frames(1), err)
    if (joint%closes) then
      call get_origin(tree, tree%child(tree%child(element, first), 'origin'), inner, err)
      if (tree%child(element, 'origin') == 0) joint%frames(1) = inner
      call get_origin(tree, tree%child(tree%child(element, second), 'origin'), joint%frames(2), err)
    end if
    call get_axis(tree, tree%child(element, 'axis'), joint%axis, err)
    call get_axis(tree, tree%child(element, 'axis2'), joint%second, err)
    if (words(place) /= 'continuous') call read_limit(tree, tree%child(element, 'limit'), joint, err)
    call get_number(tree, tree%child(element, 'dynamics'), 'damping', joint%damping, err)
    if (tree%child(element, 'mimic') > 0) joint%leader = needed_attribute(tree, tree%child(element, 'mimic'), 'joint', err)
    call get_number(tree, tree%child(element, 'mimic'), 'multiplier', joint%ratio, err)
    call get_number(tree, tree%child(element, 'mimic'), 'offset', joint%offset, err)
    joint%is_preferred = is_true(tree%attribute(element, 'independent'))
    call note_parts(tree, element, joint%name, robot, err)
    call robot%add_joint(tree, element, joint, err)
  end subroutine read_joint

  !> The number of the link that an element of a joint names.
  integer function link_of(tree, element, name, robot, err) result(link)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <joint> or <loop>
    character(len=*), intent(in) :: name                 !< name of the element in it: parent, child, ...
    type(robot_type), intent(in) :: robot                !< the robot with its links
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    integer :: e

    e = tree%child(element, name)
    link = robot%find_link(tree%attribute(e, 'link'))
    if (e == 0) then
      call tree%fail(element, "joint '"//tree%attribute(element, 'name')//"' has no <"//name//'>', err)
    else if (link == 0) then
      call tree%fail(e, "there is no link '"//tree%attribute(e, 'link')//"', which joint '"// &
                     tree%attribute(element, 'name')//"' names", err)
    end if
  end function link_of

  !> The direction of an axis, at length one. It stays as it is where there is no element.
  subroutine get_axis(tree, element, axis, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element; 0: none
    real(wp), intent(inout) :: axis(3)                   !< direction, in the frame of the joint
    type(error_type), allocatable, intent(inout) :: err  !< the failure

    call get_numbers(tree, element, 'xyz', axis, err)
    if (allocated(err)) return
    axis = unit(axis)
    if (.not. any(abs(axis) > 0.0_wp)) call tree%fail(element, 'the axis has no direction: its components are all zero', err)
  end subroutine get_axis

  !> The range of a joint, and its start: zero, or the middle of a range without zero.
  subroutine read_limit(tree, element, joint, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <limit>; 0: none
    type(robot_joint_type), intent(inout) :: joint       !< gets its range
    type(error_type), allocatable, intent(inout) :: err  !< the failure

    if (.not. any([revolute_joint, prismatic_joint] == joint%kind)) return
    joint%has_range = tree%has(element, 'lower') .or. tree%has(element, 'upper')
    call get_number(tree, element, 'lower', joint%range(1), err)
    call get_number(tree, element, 'upper', joint%range(2), err)
    if (joint%has_range .and. (joint%range(1) > 0.0_wp .or. joint%range(2) < 0.0_wp)) joint%start = 0.5_wp*sum(joint%range)
  end subroutine read_limit

  !> Note the parts of a joint that are not taken over.
  subroutine note_parts(tree, element, name, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <joint> or <loop>
    character(len=*), intent(in) :: name                 !< name of the joint
    type(robot_type), intent(inout) :: robot             !< gets the notes
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: friction
    integer :: e

    friction = 0.0_wp
    e = tree%first_child(element)
    do while (e > 0)
      select case (tree%name(e))
      case ('parent', 'child', 'predecessor', 'successor', 'origin', 'axis', 'axis2', 'mimic')
      case ('dynamics')
        call get_number(tree, e, 'friction', friction, err)
        if (abs(friction) > 0.0_wp) call robot%note(tree, e, "the friction of joint '"//name//"'")
      case ('limit')
        if (tree%has(e, 'lower') .or. tree%has(e, 'upper')) call robot%note(tree, e, note_of_ranges)
        if (tree%has(e, 'effort') .or. tree%has(e, 'velocity')) call robot%note(tree, e, 'limits of efforts and velocities')
      case default
        call robot%note(tree, e, '<'//tree%name(e)//'> of joints')
      end select
      e = tree%next_sibling(e)
    end do
  end subroutine note_parts

  !> The pose of an element <origin>; the identity where there is none.
  subroutine get_origin(tree, element, pose, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element; 0: none
    type(pose_type), intent(out) :: pose                 !< of the new frame in that of the link
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: rpy(3)

    rpy = 0.0_wp
    call get_numbers(tree, element, 'xyz', pose%p, err)
    call get_numbers(tree, element, 'rpy', rpy, err)
    pose%r = rotation_of_rpy(rpy)
  end subroutine get_origin
end module mech9_urdf_reader
