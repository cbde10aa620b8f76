!> URDF in the neutral form: links, inertias turned into the axes of the link, joints with frames and ranges, loops, and refusals.
module test_urdf_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, revolute_joint, prismatic_joint, spherical_joint, free_joint
  use mech9_urdf_reader, only: read_urdf, read_loops
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, near_matrix, has_message
  use xml_texts, only: read_lines, symmetric
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_urdf_reader.xml'
  real(wp), parameter :: tol = 1.0e-14_wp   ! a rotation and two products
  !> Two links without mass.
  character(len=100), parameter :: two_links(2) = [character(len=100) :: '<robot name="r">', '<link name="a"/><link name="b"/>']

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('masses')) call masses(tester)
    if (tester%runs('joints')) call joints(tester)
    if (tester%runs('root')) call root(tester)
    if (tester%runs('loops')) call loops(tester)
    if (tester%runs('notes')) call notes(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  subroutine read_robot(tester, lines, robot, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: lines(:)             !< the document
    type(robot_type), intent(out) :: robot               !< the robot
    type(error_type), allocatable, intent(out) :: err    !< failure of the reader
    type(xml_tree_type) :: tree

    call read_lines(tester, path, lines, tree)
    call robot%begin('URDF')
    call read_urdf(tree, robot, err)
  end subroutine read_robot

  !> A quarter turn about z takes the axis x of the inertia to the axis y of the link.
  subroutine masses(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<robot name="r"><link name="a"><inertial>', &
      '<origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><mass value="4"/>', &
      '<inertia ixx="1" iyy="2" izz="3" ixy="0.1" ixz="0.2" iyz="0.3"/></inertial></link></robot>'], robot, err)
    call tester%no_error(err, 'a link with its mass')
    call tester%is_true(robot%name == 'r' .and. robot%n_links == 1 .and. robot%links(1)%name == 'a', 'names')
    call tester%near(robot%links(1)%mass, 4.0_wp, 0.0_wp, 'the mass')
    call near_vector(tester, robot%links(1)%centre, [1.0_wp, 2.0_wp, 3.0_wp], 0.0_wp, 'the mass centre')
    call near_matrix(tester, robot%links(1)%inertia, symmetric([2.0_wp, 1.0_wp, 3.0_wp, -0.1_wp, -0.3_wp, 0.2_wp]), tol, &
                     'the tensor in the axes of the link')
  end subroutine masses

  subroutine joints(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: two_links, &
      '<joint name="j" type="revolute" independent="true"><parent link="a"/><child link="b"/>', &
      '<origin xyz="0 0 1" rpy="1.5707963267948966 0 0"/><axis xyz="0 0 2"/>', &
      '<limit lower="0.5" upper="1.5"/><dynamics damping="0.7"/></joint>', '<link name="c"/>', &
      '<joint name="k" type="prismatic"><parent link="b"/><child link="c"/>', &
      '<limit lower="-1" upper="2"/><mimic joint="j" multiplier="-2" offset="0.25"/></joint></robot>'], robot, err)
    call tester%no_error(err, 'two joints')
    if (robot%n_joints /= 2) return
    associate (j => robot%joints(1), k => robot%joints(2))
      call tester%is_true(j%kind == revolute_joint .and. all(j%links == [1, 2]) .and. j%is_preferred, 'the first joint')
      call near_vector(tester, j%frames(1)%p, [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp, 'its place')
      call near_vector(tester, j%frames(1)%r(:, 2), [0.0_wp, 0.0_wp, 1.0_wp], tol, 'a quarter roll takes y to z')
      call near_vector(tester, j%axis, [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp, 'its axis has length one')
      call near_vector(tester, j%range, [0.5_wp, 1.5_wp], 0.0_wp, 'its range')
      call tester%near(j%start, 1.0_wp, 0.0_wp, 'it starts in the middle of a range without zero')
      call tester%near(j%damping, 0.7_wp, 0.0_wp, 'its damping')
      call tester%is_true(k%kind == prismatic_joint .and. all(k%links == [2, 3]) .and. k%leader == 'j', 'the second joint')
      call near_vector(tester, [k%ratio, k%offset, k%start], [-2.0_wp, 0.25_wp, 0.0_wp], 0.0_wp, 'ratio, offset and start')
      call near_vector(tester, k%axis, [1.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'an axis is x unless it is given')
    end associate
  end subroutine joints

  !> The link that is no child is the frame and comes first.
  subroutine root(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: two_links, '<joint name="j" type="floating"><parent link="b"/>', &
      '<child link="a"/></joint></robot>'], robot, err)
    call tester%no_error(err, 'a robot whose frame comes last')
    call tester%is_true(robot%links(1)%name == 'b' .and. all(robot%joints(1)%links == [1, 2]), 'the frame is link 1')
    call tester%is_true(robot%joints(1)%kind == free_joint, 'floating joints are free')
    call read_robot(tester, [character(len=110) :: two_links, '</robot>'], robot, err)
    call has_message(tester, err, exit_data, path//":2:17: link 'b' hangs on no joint, and neither does link 'a'", 'two frames')
  end subroutine root

  !> A loop has a frame in each of its links. It may stand in a file of its own.
  subroutine loops(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: two_links, '<joint name="j" type="continuous"><parent link="a"/>', &
      '<child link="b"/></joint></robot>'], robot, err)
    call tester%is_true(.not. robot%joints(1)%has_range, 'continuous joints have no range')
    call read_lines(tester, path, [character(len=110) :: '<loops><loop name="l" type="spherical">', &
      '<predecessor link="a"><origin xyz="1 0 0"/></predecessor><successor link="b"><origin xyz="0 2 0"/></successor>', &
      '</loop></loops>'], tree)
    call read_loops(tree, robot, err)
    call tester%no_error(err, 'a loop')
    if (robot%n_joints /= 2) return
    associate (l => robot%joints(2))
      call tester%is_true(l%closes .and. l%kind == spherical_joint .and. all(l%links == [1, 2]), 'it closes a chain')
      call near_vector(tester, [l%frames(1)%p, l%frames(2)%p], [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp], 0.0_wp, &
                       'its frames in both links')
    end associate
  end subroutine loops

  subroutine notes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: two_links, '<joint name="j" type="prismatic"><parent link="a"/>', &
      '<child link="b"/><dynamics friction="1"/><limit effort="3"/><calibration/></joint>', '<transmission/></robot>'], robot, err)
    call tester%no_error(err, 'a robot with more than its mechanism')
    call tester%is_true(robot%n_notes == 4, 'four things are not taken over')
    call tester%is_true(robot%notes(1)%text == "the friction of joint 'j'" .and. robot%notes(1)%place == path//':4', 'friction')
    call tester%is_true(robot%notes(4)%text == '<transmission>', 'elements of the robot')
  end subroutine notes

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused('<joint name="j" type="hinge"><child link="b"/></joint>', ":3:1: unknown type 'hinge' of a joint")
    call refused('<joint type="fixed"><child link="b"/></joint>', ":3:1: <joint> needs 'name'")
    call refused('<joint name="j" type="fixed"><child link="b"/></joint>', ":3:1: joint 'j' has no <parent>")
    call refused('<joint name="j" type="fixed"><parent link="x"/><child link="b"/></joint>', ":3:30: there is no link 'x', which")
    call refused('<joint name="j" type="fixed"><parent link="b"/><child link="b"/></joint>', "joint 'j' joins a link with itself")
    call refused('<joint name="j" type="fixed"><parent link="a"/><child link="c"/></joint>', ":3:48: there is no link 'c', which")
    call refused('<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 0"/></joint>', &
                 ':3:68: the axis has no direction')
    call refused('<joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 0"/></joint>', &
                 "'xyz' must hold 3 numbers, not 2")
    call refused('<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint><xacro:macro/>', 'expand it by xacro')
    call refused('<link name="c"><inertial><mass value="-1"/></inertial></link>', "link 'b' hangs on no joint")
  contains
    subroutine refused(line, words)
      character(len=*), intent(in) :: line    !< third line of the document
      character(len=*), intent(in) :: words   !< part of the message
      type(robot_type) :: robot
      type(error_type), allocatable :: err

      call read_robot(tester, [character(len=110) :: two_links, line, '</robot>'], robot, err)
      call has_message(tester, err, exit_data, words, 'a refusal')
    end subroutine refused
  end subroutine refusals
end module test_urdf_reader
