!> Pairs of a robot: numbers of links and coordinates from the frame outwards, joints that close chains, and divided joints.
module test_pair_series
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_structure
  use mech9_xml_tree, only: xml_tree_type
  use mech9_orientations, only: rotation_of_rpy
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, prismatic_joint, helical_joint, cylindrical_joint, &
    universal_joint, spherical_joint, planar_joint, free_joint
  use mech9_pair_series, only: series_type, find_series
  use mech9_testing, only: tester_type
  use mech9_checks, only: has_message
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('order')) call order(tester)
    if (tester%runs('marked_loops')) call marked_loops(tester)
    if (tester%runs('freedoms')) call freedoms(tester)
    if (tester%runs('divided_universal')) call divided_universal(tester)
    if (tester%runs('hanging_link')) call hanging_link(tester)
  end subroutine run

  !> A robot of joints between links that are named by their numbers.
  subroutine robot_of(n_links, links, kinds, robot)
    integer, intent(in) :: n_links           !< number of links
    integer, intent(in) :: links(:, :)       !< (2,n) links of each joint
    integer, intent(in) :: kinds(:)          !< (n) kinds of the joints
    type(robot_type), intent(out) :: robot   !< the robot
    type(xml_tree_type) :: tree
    type(robot_joint_type) :: joint
    type(error_type), allocatable :: err
    integer :: i

    call tree%begin('c.xml')
    call tree%add_element(0, 'robot', 1, 1)
    call robot%begin('URDF')
    do i = 1, n_links
      call robot%add_link(tree, 1, 'link '//achar(48 + i), err)
    end do
    do i = 1, size(kinds)
      joint%name = 'joint '//achar(48 + i)
      joint%kind = kinds(i)
      joint%links = links(:, i)
      call robot%add_joint(tree, 1, joint, err)
    end do
    call robot%finish()
  end subroutine robot_of

  !> The joints are given from the outermost one to the frame, one of them with its links exchanged.
  subroutine order(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(error_type), allocatable :: err

    call robot_of(4, reshape([2, 4, 3, 4, 2, 3, 1, 3], [2, 4]), &
                  [revolute_joint, spherical_joint, prismatic_joint, revolute_joint], robot)
    call find_series(robot, series, err)
    call tester%no_error(err, 'a robot with a closed chain')
    call tester%is_true(series%n_links == 4 .and. all(series%number_of == [1, 4, 2, 3]), 'links from the frame outwards')
    call tester%is_true(all(series%pairs%joint == [4, 2, 2, 2, 3, 1]), 'pairs from the frame outwards, the closing one at the end')
    call tester%is_true(all(series%pairs%freedoms == [1, 3, 0, 0, 1, 1]), 'freedoms stand at first coordinates')
    call tester%is_true(all(series%closes .eqv. [.true., .false., .false., .false.]), 'joint 1 closes the chain')
    call tester%is_true(all(series%pairs(5)%links == [4, 2]), 'a joint keeps the order of its links')
  end subroutine order

  !> A loop that the file marks closes the chain, unless nothing else reaches a link.
  subroutine marked_loops(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(error_type), allocatable :: err
    integer, parameter :: turns(4) = revolute_joint

    call robot_of(4, reshape([1, 2, 1, 3, 2, 3, 1, 4], [2, 4]), turns, robot)
    robot%joints(1)%closes = .true.
    robot%joints(4)%closes = .true.
    call find_series(robot, series, err)
    call tester%no_error(err, 'a link that only a loop reaches')
    call tester%is_true(all(series%closes .eqv. [.true., .false., .false., .false.]), 'the marked loop closes the chain')
    call tester%is_true(all(series%number_of == [1, 3, 2, 4]), 'the others lead to the links')
    call tester%is_true(all(series%pairs%joint == [2, 3, 4, 1]), 'the pair that closes comes last')
  end subroutine marked_loops

  subroutine freedoms(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: kinds(8) = [revolute_joint, prismatic_joint, helical_joint, cylindrical_joint, universal_joint, &
                                      spherical_joint, planar_joint, free_joint]
    integer, parameter :: numbers(8) = [1, 1, 1, 2, 2, 3, 3, 6]
    type(robot_type) :: robot
    type(series_type) :: series
    type(error_type), allocatable :: err
    integer :: i

    do i = 1, size(kinds)
      call robot_of(2, reshape([1, 2], [2, 1]), kinds(i:i), robot)
      call find_series(robot, series, err)
      call tester%is_true(size(series%pairs) == numbers(i) .and. sum(series%pairs%freedoms) == numbers(i), 'freedoms of a joint')
      call tester%is_true(all(series%pairs%kind == kinds(i)) .and. series%n_links == 2, 'a joint that stays whole')
    end do
  end subroutine freedoms

  !> A universal joint whose links have turned frames becomes two turns with a massless link between them.
  subroutine divided_universal(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(error_type), allocatable :: err

    call robot_of(2, reshape([1, 2], [2, 1]), [universal_joint], robot)
    robot%joints(1)%frames(1)%r = rotation_of_rpy([0.0_wp, 0.0_wp, 0.3_wp])
    call find_series(robot, series, err)
    call tester%no_error(err, 'a universal joint')
    call tester%is_true(series%n_links == 3 .and. all(series%pairs%kind == revolute_joint), 'two turns')
    call tester%is_true(all(series%pairs(1)%links == [1, 2]) .and. all(series%pairs(2)%links == [2, series%number_of(2)]), 'links')
    call tester%is_true(all(series%pairs%freedoms == 1), 'each of them has one freedom')
    call tester%is_true(all(abs(series%pairs(1)%axis - robot%joints(1)%axis) <= 0.0_wp) .and. &
                        all(abs(series%pairs(2)%axis - robot%joints(1)%second) <= 0.0_wp), 'about the two axes of the joint')
  end subroutine divided_universal

  subroutine hanging_link(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(error_type), allocatable :: err

    call robot_of(4, reshape([1, 2, 3, 4], [2, 2]), [revolute_joint, revolute_joint], robot)
    call find_series(robot, series, err)
    call has_message(tester, err, exit_structure, "c.xml:1: no joints lead from the frame 'link 1' to link 'link 3'", &
                     'a link that no joints reach')
  end subroutine hanging_link
end module test_pair_series
