!> Links that fixed joints join become one, with the masses of all, the points of all, and the joints between the others.
module test_rigid_links
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_orientations, only: rotation_of_rpy
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, robot_joint_type, fixed_joint, revolute_joint
  use mech9_rigid_links, only: join_rigid_links
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, near_matrix, has_message
  implicit none
  private
  public :: run

  real(wp), parameter :: tol = 1.0e-14_wp   ! two poses and sums of a few numbers of order one

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('dumb_bell')) call dumb_bell(tester)
    if (tester%runs('turned_links')) call turned_links(tester)
    if (tester%runs('joints_and_points')) call joints_and_points(tester)
    if (tester%runs('contradictions')) call contradictions(tester)
  end subroutine run

  !> A frame and three links of 1 kg at their origins; joints 1 to 3 lead from link to link, each a step along x.
  subroutine chain(kinds, robot)
    integer, intent(in) :: kinds(3)           !< kinds of the joints
    type(robot_type), intent(out) :: robot    !< the robot
    type(xml_tree_type) :: tree
    type(robot_joint_type) :: joint
    type(error_type), allocatable :: err
    integer :: i

    call tree%begin('c.xml')
    call tree%add_element(0, 'robot', 1, 1)
    call robot%begin('URDF')
    call robot%add_link(tree, 1, 'link 1', err)
    do i = 1, 3
      call robot%add_link(tree, 1, 'link '//achar(49 + i), err)
      robot%links(i + 1)%mass = 1.0_wp
      joint%name = 'joint '//achar(48 + i)
      joint%kind = kinds(i)
      joint%links = [i, i + 1]
      joint%frames(1)%p = [1.0_wp, 0.0_wp, 0.0_wp]
      call robot%add_joint(tree, 1, joint, err)
    end do
  end subroutine chain

  !> Two masses at a distance of 1 have a moment of 2 (1/2)^2 about their middle.
  subroutine dumb_bell(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call chain([revolute_joint, revolute_joint, fixed_joint], robot)
    call robot%finish()
    call join_rigid_links(robot, err)
    call tester%no_error(err, 'two links are joined')
    call tester%is_true(robot%n_links == 3 .and. robot%n_joints == 2 .and. size(robot%joints) == 2, 'a link and a joint are gone')
    call tester%is_true(robot%links(3)%name == 'link 3', 'the joined link has the first name')
    call near_vector(tester, [robot%links(3)%mass, robot%links(3)%centre], [2.0_wp, 0.5_wp, 0.0_wp, 0.0_wp], tol, 'mass, centre')
    call near_vector(tester, [robot%links(3)%inertia(1, 1), robot%links(3)%inertia(2, 2), robot%links(3)%inertia(3, 3)], &
                     [0.0_wp, 0.5_wp, 0.5_wp], tol, 'moments about the middle')
    call tester%is_true(robot%points(1)%name == 'link 4' .and. robot%points(1)%link == 3, 'the second link is a point')
    call near_vector(tester, robot%points(1)%position, [1.0_wp, 0.0_wp, 0.0_wp], tol, 'in its place')
  end subroutine dumb_bell

  !> The tensor of a turned link is turned: trace and determinant stay where the link has no other mass beside it.
  subroutine turned_links(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err
    real(wp), parameter :: moments(3) = [1.0_wp, 2.0_wp, 3.0_wp]
    real(wp) :: r(3, 3), expected(3, 3)
    integer :: i

    call chain([revolute_joint, fixed_joint, revolute_joint], robot)
    r = rotation_of_rpy([0.3_wp, -0.4_wp, 1.1_wp])
    robot%joints(2)%frames(1)%r = r
    robot%links(2)%mass = 0.0_wp
    robot%links(3)%centre = [0.2_wp, 0.0_wp, 0.0_wp]
    expected = 0.0_wp
    do i = 1, 3
      robot%links(3)%inertia(i, i) = moments(i)
      ! the sum of the dyads of the principal axes
      expected = expected + moments(i)*spread(r(:, i), 2, 3)*spread(r(:, i), 1, 3)
    end do
    call robot%finish()
    call join_rigid_links(robot, err)
    call near_matrix(tester, robot%links(2)%inertia, expected, tol, 'the tensor in the axes of the first link')
    call near_vector(tester, robot%links(2)%centre, [1.0_wp, 0.0_wp, 0.0_wp] + 0.2_wp*r(:, 1), tol, 'the mass centre')
    call near_vector(tester, robot%joints(2)%frames(1)%p, [1.0_wp, 0.0_wp, 0.0_wp] + r(:, 1), tol, 'the next joint')
  end subroutine turned_links

  !> A joint between two links of one body cannot move and is left out.
  subroutine joints_and_points(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    type(robot_joint_type) :: joint
    type(error_type), allocatable :: err

    call chain([fixed_joint, fixed_joint, revolute_joint], robot)
    call tree%begin('d.xml')
    call tree%add_element(0, 'joint', 5, 1)
    joint%name = 'idle'
    joint%kind = revolute_joint
    joint%links = [1, 3]
    call robot%add_joint(tree, 1, joint, err)
    call robot%add_point('tip', 3, [0.0_wp, 2.0_wp, 0.0_wp])
    call robot%finish()
    call join_rigid_links(robot, err)
    call tester%no_error(err, 'links are joined to the frame')
    call tester%is_true(robot%n_links == 2 .and. robot%n_joints == 1 .and. robot%joints(1)%name == 'joint 3', 'one joint moves')
    call tester%is_true(all(robot%joints(1)%links == [1, 2]), 'its links have their new numbers')
    call near_vector(tester, robot%joints(1)%frames(1)%p, [3.0_wp, 0.0_wp, 0.0_wp], tol, 'it stands three steps from the frame')
    call tester%is_true(robot%n_notes == 1 .and. robot%notes(1)%place == 'd.xml:5:1', 'the other one is noted')
    call near_vector(tester, robot%points(1)%position, [2.0_wp, 2.0_wp, 0.0_wp], tol, 'a point keeps its place in space')
    call tester%is_true(robot%points(1)%link == 1 .and. size(robot%points) == 3, 'points of the frame')
  end subroutine joints_and_points

  !> A fixed joint that closes a chain must agree with the others.
  subroutine contradictions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call close(2.0_wp, 0.0_wp, .true.)
    call close(2.001_wp, 0.0_wp, .true.)
    call close(2.1_wp, 0.0_wp, .false.)
    call close(2.0_wp, 0.01_wp, .false.)
  contains
    subroutine close(x, angle, agrees)
      real(wp), intent(in) :: x           !< distance that the joint wants between its links [m]
      real(wp), intent(in) :: angle       !< turn between them [rad]
      logical, intent(in) :: agrees       !< whether the others do not contradict it
      type(robot_type) :: robot
      type(xml_tree_type) :: tree
      type(robot_joint_type) :: joint
      type(error_type), allocatable :: err

      call chain([fixed_joint, fixed_joint, revolute_joint], robot)
      call tree%begin('d.xml')
      call tree%add_element(0, 'joint', 5, 1)
      joint%name = 'brace'
      joint%links = [1, 3]
      joint%frames(1)%p(1) = x
      joint%frames(1)%r = rotation_of_rpy([0.0_wp, 0.0_wp, angle])
      call robot%add_joint(tree, 1, joint, err)
      call robot%finish()
      call join_rigid_links(robot, err)
      if (agrees) then
        call tester%no_error(err, 'a fixed joint that agrees with the others')
      else
        call has_message(tester, err, exit_data, "d.xml:5:1: joint 'brace' joins links rigidly", 'one that does not')
      end if
    end subroutine close
  end subroutine contradictions
end module test_rigid_links
