!> The neutral form of a robot: its lists, the names in them, joints that follow others, and notes.
module test_robot
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_text, only: to_text
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, prismatic_joint, helical_joint, spherical_joint, &
    universal_joint, most_links, most_joints
  use mech9_testing, only: tester_type
  use mech9_checks, only: has_message
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('names')) call names(tester)
    if (tester%runs('sizes')) call sizes(tester)
    if (tester%runs('universal_axes')) call universal_axes(tester)
    if (tester%runs('leaders')) call leaders(tester)
    if (tester%runs('bad_leaders')) call bad_leaders(tester)
    if (tester%runs('notes')) call notes(tester)
  end subroutine run

  !> An empty robot and a document of one element.
  subroutine start(robot, tree)
    type(robot_type), intent(out) :: robot     !< the robot
    type(xml_tree_type), intent(out) :: tree   !< the document

    call tree%begin('r.xml')
    call tree%add_element(0, 'robot', 4, 2)
    call robot%begin('URDF')
  end subroutine start

  pure function joint_named(name, kind) result(joint)
    character(len=*), intent(in) :: name   !< its name
    integer, intent(in) :: kind            !< one of the kinds
    type(robot_joint_type) :: joint

    joint%name = name
    joint%kind = kind
  end function joint_named

  subroutine names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err

    call start(robot, tree)
    call robot%add_link(tree, 1, 'base', err)
    call robot%add_link(tree, 1, 'arm', err)
    call robot%add_joint(tree, 1, joint_named('arm', revolute_joint), err)
    call robot%add_point('tip', 2, [1.0_wp, 2.0_wp, 3.0_wp])
    call tester%no_error(err, 'a link and a joint may have one name')
    call tester%is_true(robot%find_link('arm') == 2 .and. robot%find_link('hand') == 0, 'links are found by name')
    call tester%is_true(robot%find_joint('arm') == 1 .and. robot%find_joint('base') == 0, 'joints are found by name')
    call tester%is_true(robot%links(2)%place == 'r.xml:4' .and. robot%joints(1)%place == 'r.xml:4:2', 'they have places')
    call robot%add_link(tree, 1, 'arm', err)
    call has_message(tester, err, exit_data, "r.xml:4:2: there are two links 'arm'", 'two links of a name are refused')
    deallocate (err)
    call robot%add_joint(tree, 1, joint_named('arm', revolute_joint), err)
    call has_message(tester, err, exit_data, "there are two joints 'arm'", 'two joints of a name are refused')
    call robot%finish()
    call tester%is_true(all([size(robot%links), size(robot%joints), size(robot%points)] == [2, 1, 1]), 'lists are cut')
    call tester%is_true(robot%points(1)%name == 'tip' .and. robot%points(1)%link == 2, 'the point stays')
  end subroutine names

  !> Lists grow up to their largest sizes, and no further.
  subroutine sizes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err
    integer :: i

    call start(robot, tree)
    do i = 1, most_links
      call robot%add_link(tree, 1, 'link '//to_text(i), err)
    end do
    do i = 1, most_joints
      call robot%add_joint(tree, 1, joint_named('joint '//to_text(i), revolute_joint), err)
    end do
    call tester%no_error(err, 'lists grow')
    call tester%is_true(robot%find_link('link '//to_text(most_links)) == most_links, 'the last link is in its place')
    call tester%is_true(robot%find_joint('joint 1') == 1, 'the first joint is in its place')
    call robot%add_link(tree, 1, 'more', err)
    call has_message(tester, err, exit_data, 'more than '//to_text(most_links)//' links', 'more links are refused')
    deallocate (err)
    call robot%add_joint(tree, 1, joint_named('more', revolute_joint), err)
    call has_message(tester, err, exit_data, 'more than '//to_text(most_joints)//' joints', 'more joints are refused')
  end subroutine sizes

  subroutine universal_axes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    type(robot_joint_type) :: joint
    type(error_type), allocatable :: err

    call start(robot, tree)
    joint = joint_named('cross', universal_joint)
    call robot%add_joint(tree, 1, joint, err)
    call tester%no_error(err, 'axes across each other are good')
    joint%name = 'same'
    joint%second = -joint%axis
    call robot%add_joint(tree, 1, joint, err)
    call has_message(tester, err, exit_data, "the two axes of joint 'same' are parallel", 'opposite axes are refused')
  end subroutine universal_axes

  !> A joint with one freedom follows another one with one freedom.
  subroutine leaders(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    type(robot_joint_type) :: joint
    type(error_type), allocatable :: err
    integer :: k

    call start(robot, tree)
    call robot%add_joint(tree, 1, joint_named('turn', revolute_joint), err)
    call robot%add_joint(tree, 1, joint_named('ball', spherical_joint), err)
    joint = joint_named('slide', prismatic_joint)
    joint%leader = 'turn'
    call robot%add_joint(tree, 1, joint, err)
    joint = joint_named('screw', helical_joint)
    joint%leader = 'ball'
    call robot%add_joint(tree, 1, joint, err)
    joint = joint_named('second ball', spherical_joint)
    joint%leader = 'turn'
    call robot%add_joint(tree, 1, joint, err)
    call tester%is_true(all([(robot%leader_of(k), k=1, 5)] == [0, 0, 1, 0, 0]), 'only joints with one freedom lead and follow')
    call robot%judge_leaders(err)
    call tester%no_error(err, 'all of these leaders exist')
  end subroutine leaders

  subroutine bad_leaders(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call judge('nobody', 1.0_wp, "there is no joint 'nobody', which joint 'follower' follows")
    call judge('follower', 1.0_wp, "joint 'follower' follows itself")
    call judge('leader', 0.0_wp, 'with the factor 0 and cannot move')
  contains
    subroutine judge(leader, ratio, words)
      character(len=*), intent(in) :: leader   !< name of the joint that is followed
      real(wp), intent(in) :: ratio            !< factor
      character(len=*), intent(in) :: words    !< part of the message
      type(robot_type) :: robot
      type(xml_tree_type) :: tree
      type(robot_joint_type) :: joint
      type(error_type), allocatable :: err

      call start(robot, tree)
      call robot%add_joint(tree, 1, joint_named('leader', revolute_joint), err)
      joint = joint_named('follower', revolute_joint)
      joint%leader = leader
      joint%ratio = ratio
      call robot%add_joint(tree, 1, joint, err)
      call robot%judge_leaders(err)
      call has_message(tester, err, exit_data, 'r.xml:4:2: ', 'the place of the joint')
      call has_message(tester, err, exit_data, words, 'the fault of the leader')
    end subroutine judge
  end subroutine bad_leaders

  subroutine notes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    integer :: i

    call start(robot, tree)
    call robot%note(tree, 1, '<light>')
    call robot%note_at('r.xml:9', '<sensor>')
    call robot%note_at('r.xml:11', '<light>')
    call tester%is_true(robot%n_notes == 2 .and. robot%notes(1)%times == 2, 'equal notes are counted')
    call tester%is_true(robot%notes(1)%place == 'r.xml:4', 'the place of the first one is kept')
    do i = 1, 500
      call robot%note_at('r.xml', 'thing '//to_text(i))
    end do
    call tester%is_true(robot%n_notes == 200, 'no more than 200 notes are kept')
    call tester%is_true(robot%notes(200)%text == 'other things, which are not listed', 'the last one tells so')
    call tester%is_true(sum(robot%notes(:200)%times) == 503, 'all of them are counted')
  end subroutine notes
end module test_robot
