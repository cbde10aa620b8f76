!> Constraints of MJCF that close chains, and joints that follow others.
module test_mjcf_equality
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_pose, only: transformed
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, spherical_joint, fixed_joint
  use mech9_mjcf_settings, only: mjcf_settings_type
  use mech9_mjcf_equality, only: read_equalities
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, has_message
  use xml_texts, only: read_lines
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_mjcf_equality.xml'
  real(wp), parameter :: tol = 1.0e-14_wp   ! sums of a few numbers of order one

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('connect')) call connect(tester)
    if (tester%runs('sites')) call sites(tester)
    if (tester%runs('weld')) call weld(tester)
    if (tester%runs('followers')) call followers(tester)
    if (tester%runs('not_taken')) call not_taken(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  !> A world with the bodies a at (1, 0, 0) and b at (4, 0, 0), both turned about z by a quarter; read constraints into it.
  subroutine read_into(tester, line, robot, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: line                 !< the elements in <equality>
    type(robot_type), intent(out) :: robot               !< the robot
    type(error_type), allocatable, intent(out) :: err    !< failure of the reader
    type(xml_tree_type) :: tree
    type(mjcf_settings_type) :: settings
    type(robot_joint_type) :: joint

    call read_lines(tester, path, [character(len=110) :: '<mujoco><equality>', line, '</equality></mujoco>'], tree)
    call robot%begin('MJCF')
    call robot%add_link(tree, 1, 'world', err)
    call robot%add_link(tree, 1, 'a', err)
    call robot%add_link(tree, 1, 'b', err)
    joint%kind = revolute_joint
    joint%axis = [0.0_wp, 0.0_wp, 1.0_wp]
    joint%frames(1)%r = reshape([0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    joint%frames(1)%p(1) = 1.0_wp
    joint%name = 'j'
    joint%links = [1, 2]
    call robot%add_joint(tree, 1, joint, err)
    joint%frames(1)%p(1) = 4.0_wp
    joint%name = 'k'
    joint%links = [1, 3]
    call robot%add_joint(tree, 1, joint, err)
    call robot%add_point('s', 2, [7.0_wp, 0.0_wp, 0.0_wp])
    call robot%add_point('t', 3, [0.0_wp, 8.0_wp, 0.0_wp])
    call read_equalities(tree, settings, robot, err)
  end subroutine read_into

  !> The anchor stands in the first body; both frames are at one place of the world.
  subroutine connect(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_into(tester, '<connect name="c" body1="a" body2="b" anchor="0 2 0"/>', robot, err)
    call tester%no_error(err, 'two bodies that are connected')
    if (robot%n_joints /= 3) return
    associate (c => robot%joints(3))
      call tester%is_true(c%kind == spherical_joint .and. c%closes .and. all(c%links == [2, 3]), 'a ball joint that closes a chain')
      call near_vector(tester, c%frames(1)%p, [0.0_wp, 2.0_wp, 0.0_wp], tol, 'its place in the first body')
      ! the anchor lies at x = 1 - 2 in the world, which is y = 2 + 3 in the second body
      call near_vector(tester, c%frames(2)%p, [0.0_wp, 5.0_wp, 0.0_wp], tol, 'its place in the second body')
    end associate
    call read_into(tester, '<connect body1="a" anchor="0 2 0"/>', robot, err)
    call tester%no_error(err, 'a body that is connected with the world')
    if (robot%n_joints /= 3) return
    call tester%is_true(all(robot%joints(3)%links == [2, 1]), 'the second body is the world unless it is given')
    call near_vector(tester, robot%joints(3)%frames(2)%p, [-1.0_wp, 0.0_wp, 0.0_wp], tol, 'the place in the world')
  end subroutine connect

  subroutine sites(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_into(tester, '<connect site1="s" site2="t"/>', robot, err)
    call tester%no_error(err, 'two sites that are connected')
    if (robot%n_joints /= 3) return
    call tester%is_true(all(robot%joints(3)%links == [2, 3]), 'they tell the bodies')
    call near_vector(tester, robot%joints(3)%frames(1)%p, [7.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'the first place')
    call near_vector(tester, robot%joints(3)%frames(2)%p, [0.0_wp, 8.0_wp, 0.0_wp], 0.0_wp, 'the second place')
  end subroutine sites

  !> A weld holds the bodies as they stand, or in the pose that is told.
  subroutine weld(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_into(tester, '<weld body1="a" body2="b"/>', robot, err)
    call tester%no_error(err, 'a weld')
    if (robot%n_joints /= 3) return
    call tester%is_true(robot%joints(3)%kind == fixed_joint, 'it is a fixed joint')
    call near_vector(tester, transformed(robot%joints(3)%frames(2), [0.0_wp, 0.0_wp, 0.0_wp]), [0.0_wp, 3.0_wp, 0.0_wp], tol, &
                     'the place of the first body in the second one')
    call read_into(tester, '<weld body1="a" body2="b" relpose="1 2 3 0 1 0 0"/>', robot, err)
    if (robot%n_joints /= 3) return
    call near_vector(tester, transformed(robot%joints(3)%frames(1), [1.0_wp, 1.0_wp, 1.0_wp]), [2.0_wp, 1.0_wp, 2.0_wp], tol, &
                     'the pose of the second body in the first one: half a turn about x')
  end subroutine weld

  !> The displacement of j is a polynomial of that of k.
  subroutine followers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_into(tester, '<joint joint1="j" joint2="k" polycoef="0.5 -2"/>', robot, err)
    call tester%is_true(robot%joints(1)%leader == 'k' .and. .not. allocated(robot%joints(2)%leader), 'j follows k')
    call near_vector(tester, [robot%joints(1)%offset, robot%joints(1)%ratio], [0.5_wp, -2.0_wp], 0.0_wp, 'offset and factor')
    call read_into(tester, '<joint joint1="j" joint2="k"/>', robot, err)
    call near_vector(tester, [robot%joints(1)%offset, robot%joints(1)%ratio], [0.0_wp, 1.0_wp], 0.0_wp, 'they are equal by default')
    call read_into(tester, '<joint joint1="j" joint2="k" polycoef="0 1 0 2"/>', robot, err)
    call tester%no_error(err, 'a polynomial of the third degree')
    call tester%is_true(.not. allocated(robot%joints(1)%leader) .and. robot%n_notes == 1, 'it is not taken over')
  end subroutine followers

  subroutine not_taken(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_into(tester, '<connect body1="a" body2="b" active="false"/><tendon/><weld site1="s" site2="t"/>', robot, err)
    call tester%no_error(err, 'constraints that are not taken over')
    call tester%is_true(robot%n_joints == 2 .and. robot%n_notes == 3, 'three notes')
  end subroutine not_taken

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused('<connect body1="a" body2="c"/>', "there is no body 'c'")
    call refused('<connect body1="a" body2="a"/>', '<connect> joins a body with itself')
    call refused('<connect site1="s" site2="u"/>', "there is no site 'u'")
    call refused('<joint joint1="l" joint2="k"/>', "there is no joint 'l'")
    call refused('<connect body1="a" body2="b" anchor="1"/>', "'anchor' must hold 3 numbers, not 1")
  contains
    subroutine refused(line, words)
      character(len=*), intent(in) :: line    !< the constraint
      character(len=*), intent(in) :: words   !< part of the message
      type(robot_type) :: robot
      type(error_type), allocatable :: err

      call read_into(tester, line, robot, err)
      call has_message(tester, err, exit_data, path//':2:1: '//words, 'a refusal')
    end subroutine refused
  end subroutine refusals
end module test_mjcf_equality
