!> Robots in MJCF, the format of MuJoCo: bodies nested in each other, with their joints, frames, sites and shapes.
module mech9_mjcf_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_rotation, only: unit, about_axis
  use mech9_pose, only: pose_type, compose, transformed
  use mech9_inertia, only: inertia_in_axes
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_numbers, get_number, is_true, place_in, one_of
  use mech9_robot, only: robot_type, robot_link_type, robot_joint_type, fixed_joint, revolute_joint, prismatic_joint, &
                         spherical_joint, free_joint, note_of_ranges
  use mech9_mjcf_settings, only: mjcf_settings_type, read_settings
  use mech9_mjcf_masses, only: mjcf_around_type, read_inertial, add_geom
  use mech9_mjcf_equality, only: read_equalities
  implicit none
  private
  public :: read_mjcf

  !> The joints of a body while they are read one after the other.
  type :: joint_chain_type
    character(len=:), allocatable :: body  !< name of the body
    type(pose_type) :: start               !< of the body's frame in the link to which the next joint leads
    integer :: last = 1                    !< number of that link
    integer :: n = 0                       !< how many joints there are so far
  end type joint_chain_type

contains

  !> Read a document whose root is <mujoco>, without elements <include>. The world is the frame.
  subroutine read_mjcf(tree, robot, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(robot_type), intent(inout) :: robot           !< an empty robot; gets links and joints
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(mjcf_settings_type) :: settings
    integer :: e

    robot%name = tree%attribute(1, 'model')
    call refuse_unknown(tree, err)
    if (.not. allocated(err)) call read_settings(tree, settings, err)
    if (allocated(err)) return
    call robot%add_link(tree, 1, 'world', err)
    e = tree%first_child(1)
    do while (e > 0 .and. .not. allocated(err))
      select case (tree%name(e))
      case ('worldbody')
        call read_contents(tree, e, settings, mjcf_around_type(), robot, err)
      case ('option')
        call get_numbers(tree, e, 'gravity', robot%gravity, err)
        if (tree%attribute(tree%child(e, 'flag'), 'gravity') == 'disable') robot%gravity = 0.0_wp
      case ('compiler', 'default', 'equality', 'actuator')
      case default
        call robot%note(tree, e, '<'//tree%name(e)//'>')
      end select
      e = tree%next_sibling(e)
    end do
    if (.not. allocated(err)) call read_equalities(tree, settings, robot, err)
    if (.not. allocated(err)) call read_actuators(tree, robot)
  end subroutine read_mjcf

  !> Fail because of elements that make or bring bodies in ways that are not known here.
  subroutine refuse_unknown(tree, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(error_type), allocatable, intent(out) :: err  !< allocated if there are any
    integer :: e

    do e = 1, tree%count
      select case (tree%name(e))
      case ('attach', 'composite', 'flexcomp', 'replicate')
        call tree%fail(e, '<'//tree%name(e)//'> is not followed; let MuJoCo write the whole model into one file '// &
                       '(mj_saveLastXML)', err)
        return
      end select
    end do
  end subroutine refuse_unknown

  !> Read the elements in a body, in the world, or in a frame of one of these.
  recursive subroutine read_contents(tree, element, settings, around, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    type(mjcf_around_type), intent(in) :: around         !< link, frame and class of defaults in the element
    type(robot_type), intent(inout) :: robot             !< gets links, joints and masses
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(mjcf_around_type) :: own
    type(pose_type) :: pose
    integer :: e

    e = tree%first_child(element)
    do while (e > 0 .and. .not. allocated(err))
      own = around
      if (tree%has(e, 'class')) own%class = settings%class_of(tree, tree%attribute(e, 'class'), e, err)
      if (tree%has(e, 'childclass')) own%class = settings%class_of(tree, tree%attribute(e, 'childclass'), e, err)
      if (allocated(err)) return
      select case (tree%name(e))
      case ('body')
        call settings%get_pose(tree, e, 0, pose, err)
        own%frame = compose(around%frame, pose)
        call read_body(tree, e, settings, own, robot, err)
      case ('frame')
        call settings%get_pose(tree, e, 0, pose, err)
        own%frame = compose(around%frame, pose)
        call read_contents(tree, e, settings, own, robot, err)
      case ('site')
        call settings%get_pose(tree, e, own%class, pose, err)
        pose = compose(around%frame, pose)
        if (tree%has(e, 'name') .and. .not. allocated(err)) call robot%add_point(tree%attribute(e, 'name'), around%link, pose%p)
      case ('geom')
        if (around%from_geoms) call add_geom(tree, e, settings, own, robot, err)
      case ('inertial')
        if (around%link > 1 .and. .not. settings%from_geoms) call read_inertial_in(around%frame, robot%links(around%link))
      case ('joint', 'freejoint')
      case default
        call robot%note(tree, e, '<'//tree%name(e)//'> of bodies')
      end select
      e = tree%next_sibling(e)
    end do
  contains
    !> Read <inertial>, which stands in a frame of the link.
    subroutine read_inertial_in(frame, told)
      type(pose_type), intent(in) :: frame             !< the frame, in that of the link
      type(robot_link_type), intent(inout) :: told     !< the link

      call read_inertial(tree, e, settings, told, err)
      told%centre = transformed(frame, told%centre)
      told%inertia = inertia_in_axes(frame%r, told%inertia)
    end subroutine read_inertial_in
  end subroutine read_contents

  !> Read a body: its joints, with massless links between several of them, and its contents.
  recursive subroutine read_body(tree, element, settings, around, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    type(mjcf_around_type), intent(in) :: around         !< link around the body, pose of the body in it, class of defaults
    type(robot_type), intent(inout) :: robot             !< gets links, joints and masses
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: name
    type(mjcf_around_type) :: own
    type(joint_chain_type) :: chain
    type(robot_joint_type) :: joint

    if (allocated(err)) return
    name = tree%attribute(element, 'name')
    if (name == '') name = 'body '//to_text(element)
    if (is_true(tree%attribute(element, 'mocap'))) call robot%note(tree, element, "mocap of body '"//name//"', which is fixed now")
    own%class = around%class
    chain%body = name
    chain%start = around%frame
    chain%last = around%link
    call read_joints(tree, element, settings, own, chain, robot, err)
    if (chain%n == 0) then
      joint%name = 'fixed '//name
      joint%kind = fixed_joint
      joint%links(1) = around%link
      joint%frames(1) = around%frame
      call robot%add_joint(tree, element, joint, err)
    end if
    call robot%add_link(tree, element, name, err)
    if (allocated(err)) return
    ! bodies in this one change the number of links
    own%link = robot%n_links
    robot%joints(robot%n_joints)%links(2) = own%link
    own%from_geoms = settings%from_geoms
    if (.not. (own%from_geoms .or. settings%never_from_geoms)) own%from_geoms = .not. tells_inertia(tree, element)
    call read_contents(tree, element, settings, own, robot, err)
  end subroutine read_body

  !> Read the joints of a body, also those in its frames, with a massless link between each and the next.
  recursive subroutine read_joints(tree, element, settings, around, chain, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element of the body, or of a frame in it
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    type(mjcf_around_type), intent(in) :: around         !< frame of the element in that of the body, class of defaults in it
    type(joint_chain_type), intent(inout) :: chain       !< the joints so far
    type(robot_type), intent(inout) :: robot             !< gets joints, and links between them
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(mjcf_around_type) :: own
    type(pose_type) :: pose
    integer :: e

    e = tree%first_child(element)
    do while (e > 0 .and. .not. allocated(err))
      select case (tree%name(e))
      case ('frame')
        own = around
        if (tree%has(e, 'childclass')) own%class = settings%class_of(tree, tree%attribute(e, 'childclass'), e, err)
        call settings%get_pose(tree, e, 0, pose, err)
        own%frame = compose(around%frame, pose)
        call read_joints(tree, e, settings, own, chain, robot, err)
      case ('joint', 'freejoint')
        if (chain%n > 0) then
          call robot%add_link(tree, e, chain%body//' ('//to_text(chain%n)//')', err)
          if (allocated(err)) return
          robot%joints(robot%n_joints)%links(2) = robot%n_links
          chain%last = robot%n_links
          chain%start = pose_type()
        end if
        chain%n = chain%n + 1
        call read_joint(tree, e, settings, around, chain, robot, err)
      end select
      e = tree%next_sibling(e)
    end do
  end subroutine read_joints

  !> Whether a body, or a frame in it, has an element <inertial>.
  recursive logical function tells_inertia(tree, element) result(tells)
    type(xml_tree_type), intent(in) :: tree   !< the document
    integer, intent(in) :: element            !< number of the element of the body or frame
    integer :: e

    tells = tree%child(element, 'inertial') > 0
    e = tree%child(element, 'frame')
    do while (e > 0 .and. .not. tells)
      tells = tells_inertia(tree, e)
      e = tree%next_named(e, 'frame')
    end do
  end function tells_inertia

  !> Read the last joint of a chain, whose moving link follows.
  subroutine read_joint(tree, element, settings, around, chain, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element <joint> or <freejoint>
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    type(mjcf_around_type), intent(in) :: around         !< frame around the joint in that of the body, class of defaults in it
    type(joint_chain_type), intent(in) :: chain          !< the joints of the body up to this one, which leaves its last link
    type(robot_type), intent(inout) :: robot             !< gets the joint
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=9), parameter :: words(5) = [character(len=9) :: '', 'hinge', 'slide', 'ball', 'free']
    integer, parameter :: kinds(5) = [revolute_joint, revolute_joint, prismatic_joint, spherical_joint, free_joint]
    character(len=:), allocatable :: word
    type(robot_joint_type) :: joint
    type(pose_type) :: at
    integer :: class, place

    class = around%class
    if (tree%has(element, 'class')) class = settings%class_of(tree, tree%attribute(element, 'class'), element, err)
    word = tree%attribute(settings%holder(tree, element, class, 'type'), 'type')
    if (tree%name(element) == 'freejoint') word = 'free'
    place = place_in(words, word)
    if (place == 0) call tree%fail(element, "unknown type '"//word//"' of a joint; "//one_of(words(2:)), err)
    if (allocated(err)) return
    joint%kind = kinds(place)
    joint%name = tree%attribute(element, 'name')
    if (joint%name == '') joint%name = 'joint '//to_text(chain%n)//' of '//chain%body
    joint%links(1) = chain%last
    if (joint%kind /= free_joint) call get_numbers(tree, settings%holder(tree, element, class, 'pos'), 'pos', at%p, err)
    joint%axis = [0.0_wp, 0.0_wp, 1.0_wp]
    call get_numbers(tree, settings%holder(tree, element, class, 'axis'), 'axis', joint%axis, err)
    if (.not. any(abs(joint%axis) > 0.0_wp)) call tree%fail(element, 'the axis has no direction: its components are all zero', err)
    at%p = transformed(around%frame, at%p)
    joint%axis = matmul(around%frame%r, unit(joint%axis))
    joint%frames(1) = compose(chain%start, at)
    joint%frames(2) = at
    call read_springs(tree, element, settings, class, joint, robot, err)
    call robot%add_joint(tree, element, joint, err)
  end subroutine read_joint

  !> Reference, range, spring and damper of a joint. Its coordinate is the reference where the body stands as the file places it.
  subroutine read_springs(tree, element, settings, class, joint, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    integer, intent(in) :: class                         !< number of the element of its class of defaults
    type(robot_joint_type), intent(inout) :: joint       !< gets them
    type(robot_type), intent(inout) :: robot             !< gets notes
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: scale, armature, friction
    character(len=:), allocatable :: limited

    armature = 0.0_wp
    friction = 0.0_wp
    call get('armature', armature)
    call get('frictionloss', friction)
    call get('stiffness', joint%stiffness)
    call get('damping', joint%damping)
    if (abs(armature) > 0.0_wp) call robot%note(tree, element, "the armature of joint '"//joint%name//"'")
    if (abs(friction) > 0.0_wp) call robot%note(tree, element, "the friction of joint '"//joint%name//"'")
    limited = tree%attribute(settings%holder(tree, element, class, 'limited'), 'limited')
    joint%has_range = settings%holder(tree, element, class, 'range') > 0 .and. &
                      (limited == 'true' .or. (limited /= 'false' .and. settings%autolimits))
    if (joint%has_range) call robot%note(tree, element, note_of_ranges)
    if (all(joint%kind /= [revolute_joint, prismatic_joint])) then
      if (joint%stiffness > 0.0_wp .or. joint%damping > 0.0_wp) &
        call robot%note(tree, element, "spring and damper of joint '"//joint%name//"', which has several freedoms")
      joint%stiffness = 0.0_wp
      joint%damping = 0.0_wp
      joint%has_range = .false.
      return
    end if
    scale = merge(settings%angle_unit, 1.0_wp, joint%kind == revolute_joint)
    if (joint%has_range) call get_numbers(tree, settings%holder(tree, element, class, 'range'), 'range', joint%range, err)
    call get('ref', joint%start)
    call get('springref', joint%rest)
    joint%range = joint%range*scale
    joint%start = joint%start*scale
    joint%rest = joint%rest*scale
    if (joint%kind == revolute_joint) then
      joint%frames(1)%r = matmul(joint%frames(1)%r, about_axis(joint%axis, -joint%start))
    else
      joint%frames(1)%p = joint%frames(1)%p - matmul(joint%frames(1)%r, joint%axis)*joint%start
    end if
  contains
    !> A number of the joint or of its defaults.
    subroutine get(name, number)
      character(len=*), intent(in) :: name     !< name of the attribute
      real(wp), intent(inout) :: number        !< default before, value afterwards

      call get_number(tree, settings%holder(tree, element, class, name), name, number, err)
    end subroutine get
  end subroutine read_springs

  !> Actuators are not taken over, but their joints had better be independent.
  subroutine read_actuators(tree, robot)
    type(xml_tree_type), intent(in) :: tree   !< the document
    type(robot_type), intent(inout) :: robot  !< gets preferences and notes
    integer :: e, a, joint

    e = tree%child(1, 'actuator')
    do while (e > 0)
      a = tree%first_child(e)
      do while (a > 0)
        call robot%note(tree, a, '<'//tree%name(a)//'> of actuators')
        joint = robot%find_joint(tree%attribute(a, 'joint'))
        if (joint > 0) robot%joints(joint)%is_preferred = .true.
        a = tree%next_sibling(a)
      end do
      e = tree%next_named(e, 'actuator')
    end do
  end subroutine read_actuators
end module mech9_mjcf_reader
