!> Constraints of MJCF that close chains: <connect> as ball joints, <weld> as fixed joints.
module mech9_mjcf_equality
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_pose, only: pose_type, compose, inverse
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_numbers, get_list
  use mech9_robot, only: robot_type, robot_joint_type, spherical_joint, fixed_joint
  use mech9_robot_poses, only: all_poses
  use mech9_orientations, only: from_quaternion
  use mech9_mjcf_settings, only: mjcf_settings_type
  implicit none
  private
  public :: read_equalities

contains

  !> Read all elements <equality> into a robot with all its bodies.
  subroutine read_equalities(tree, settings, robot, err)
    type(xml_tree_type), intent(in) :: tree            !< the document
    type(mjcf_settings_type), intent(in) :: settings   !< units and defaults
    type(robot_type), intent(inout) :: robot           !< gets joints
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(pose_type) :: poses(robot%n_links)
    integer :: group, e

    call all_poses(robot, poses)
    group = tree%child(1, 'equality')
    do while (group > 0)
      e = tree%first_child(group)
      do while (e > 0 .and. .not. allocated(err))
        if (tree%attribute(e, 'active') == 'false') then
          call robot%note(tree, e, '<'//tree%name(e)//'> that is not active')
        else if (tree%name(e) == 'connect' .or. tree%name(e) == 'weld') then
          call read_closing(tree, e, poses, robot, err)
        else if (tree%name(e) == 'joint' .and. robot%find_joint(tree%attribute(e, 'joint2')) > 0) then
          call read_polynomial(tree, e, robot, err)
        else
          call robot%note(tree, e, '<'//tree%name(e)//'> of <equality>'//names_of(tree, e))
        end if
        e = tree%next_sibling(e)
      end do
      group = tree%next_named(group, 'equality')
    end do
  end subroutine read_equalities

  !> Read <joint>: a polynomial of the displacement of one joint is that of another. Those of the first degree are taken over.
  subroutine read_polynomial(tree, element, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(robot_type), intent(inout) :: robot             !< its first joint follows the second one
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: factors(5)
    real(wp), allocatable :: list(:)
    integer :: first, second, n

    first = robot%find_joint(tree%attribute(element, 'joint1'))
    second = robot%find_joint(tree%attribute(element, 'joint2'))
    if (first == 0) call tree%fail(element, "there is no joint '"//tree%attribute(element, 'joint1')//"'", err)
    factors = [0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    call get_list(tree, element, 'polycoef', list, err)
    n = min(5, size(list))
    factors(:n) = list(:n)
    if (allocated(err)) return
    if (any(abs(factors(3:)) > 0.0_wp)) then
      call robot%note(tree, element, '<joint> of <equality>'//names_of(tree, element)//', which is not linear')
      return
    end if
    associate (joint => robot%joints(first), leader => robot%joints(second))
      joint%leader = leader%name
      joint%ratio = factors(2)
      joint%offset = joint%start + factors(1) - factors(2)*leader%start
    end associate
  end subroutine read_polynomial

  !> The joints that a constraint names, for a note.
  function names_of(tree, element) result(text)
    type(xml_tree_type), intent(in) :: tree  !< the document
    integer, intent(in) :: element           !< number of the element
    character(len=:), allocatable :: text

    text = ''
    if (tree%has(element, 'joint1')) text = " for joint '"//tree%attribute(element, 'joint1')//"'"
    if (tree%has(element, 'joint2')) text = text//" and joint '"//tree%attribute(element, 'joint2')//"'"
  end function names_of

  !> Read <connect> or <weld> as a joint.
  subroutine read_closing(tree, element, poses, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(pose_type), intent(in) :: poses(:)              !< (links) in the world, as the file places them
    type(robot_type), intent(inout) :: robot             !< gets the joint
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(robot_joint_type) :: joint
    real(wp) :: relpose(7)

    joint%name = tree%attribute(element, 'name')
    if (joint%name == '') joint%name = tree%name(element)//' '//to_text(element)
    joint%closes = .true.
    joint%kind = spherical_joint
    if (tree%name(element) == 'weld') joint%kind = fixed_joint
    if (tree%has(element, 'site1')) then
      call place_of_site('site1', 1)
      call place_of_site('site2', 2)
      if (joint%kind == fixed_joint) then
        call robot%note(tree, element, '<weld> by sites')
        return
      end if
    else
      joint%links = [link_of('body1'), link_of('body2')]
      if (allocated(err)) return
      call get_numbers(tree, element, 'anchor', joint%frames(1)%p, err)
      joint%frames(2) = compose(compose(inverse(poses(joint%links(2))), poses(joint%links(1))), joint%frames(1))
      relpose = 0.0_wp
      if (joint%kind == fixed_joint) call get_numbers(tree, element, 'relpose', relpose, err)
      if (any(abs(relpose(4:)) > 0.0_wp)) then
        joint%frames(1)%p = relpose(:3)
        joint%frames(1)%r = from_quaternion(relpose(4:))
        joint%frames(2) = pose_type()
      end if
    end if
    if (joint%links(1) == joint%links(2)) call tree%fail(element, '<'//tree%name(element)//'> joins a body with itself', err)
    call robot%add_joint(tree, element, joint, err)
  contains
    !> The number of the link that an attribute names; the world where it is not given.
    integer function link_of(name)
      character(len=*), intent(in) :: name  !< name of the attribute

      link_of = 1
      if (.not. tree%has(element, name)) return
      link_of = robot%find_link(tree%attribute(element, name))
      if (link_of == 0) call tree%fail(element, "there is no body '"//tree%attribute(element, name)//"'", err)
    end function link_of

    !> Take the place of a site.
    subroutine place_of_site(name, side)
      character(len=*), intent(in) :: name  !< name of the attribute
      integer, intent(in) :: side           !< first or second link
      integer :: i

      do i = 1, robot%n_points
        if (robot%points(i)%name /= tree%attribute(element, name)) cycle
        joint%links(side) = robot%points(i)%link
        joint%frames(side)%p = robot%points(i)%position
      end do
      if (joint%links(side) == 0) call tree%fail(element, "there is no site '"//tree%attribute(element, name)//"'", err)
    end subroutine place_of_site
  end subroutine read_closing
end module mech9_mjcf_equality
