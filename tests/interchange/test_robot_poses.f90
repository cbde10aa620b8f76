!> Poses of the links of a robot at its start, and ball joints that become revolute in plane chains.
module test_robot_poses
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_pose, only: pose_type
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, prismatic_joint, spherical_joint
  use mech9_robot_poses, only: all_poses, make_planar_loops_planar
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector
  implicit none
  private
  public :: run

  real(wp), parameter :: pi = acos(-1.0_wp)
  real(wp), parameter :: tol = 1.0e-14_wp   ! three rotations and sums of numbers of order one

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('open_chain')) call open_chain(tester)
    if (tester%runs('plane_loop')) call plane_loop(tester)
    if (tester%runs('spatial_loops')) call spatial_loops(tester)
  end subroutine run

  !> Links 2 to 4 on the frame one behind the other, each a step along x, and a ball joint from the last one to the frame. The
  !> joints are listed from the last one to the first one.
  subroutine loop(axes, kinds, robot)
    real(wp), intent(in) :: axes(3, 3)        !< axes of the three joints, in the order of the links
    integer, intent(in) :: kinds(3)           !< their kinds
    type(robot_type), intent(out) :: robot    !< the robot
    type(xml_tree_type) :: tree
    type(robot_joint_type) :: joint
    type(error_type), allocatable :: err
    integer :: i

    call tree%begin('c.xml')
    call tree%add_element(0, 'robot', 1, 1)
    call robot%begin('URDF')
    do i = 1, 4
      call robot%add_link(tree, 1, 'link '//achar(48 + i), err)
    end do
    joint%name = 'ball'
    joint%kind = spherical_joint
    joint%links = [4, 1]
    joint%closes = .true.
    call robot%add_joint(tree, 1, joint, err)
    joint%closes = .false.
    do i = 3, 1, -1
      joint%name = 'joint '//achar(48 + i)
      joint%kind = kinds(i)
      joint%links = [i, i + 1]
      joint%axis = axes(:, i)
      joint%frames(1)%p = [1.0_wp, 0.0_wp, 0.0_wp]
      call robot%add_joint(tree, 1, joint, err)
    end do
    call robot%finish()
  end subroutine loop

  !> Quarter turns about z, and a slide across.
  subroutine open_chain(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(pose_type) :: poses(4)
    integer :: through(4)

    call loop(reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, -1.0_wp], [3, 3]), &
              [revolute_joint, prismatic_joint, revolute_joint], robot)
    robot%joints(4)%start = 0.5_wp*pi
    robot%joints(3)%start = 2.0_wp
    robot%joints(2)%start = 0.5_wp*pi
    call all_poses(robot, poses, through)
    call tester%is_true(all(through == [0, 4, 3, 2]), 'the joints that lead to the links')
    call near_vector(tester, [poses(2)%p, poses(2)%r(:, 1)], [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], tol, 'link 2')
    call near_vector(tester, [poses(3)%p, poses(3)%r(:, 1)], [-1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], tol, 'link 3')
    call near_vector(tester, [poses(4)%p, poses(4)%r(:, 1)], [-1.0_wp, 2.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], tol, 'link 4')
  end subroutine open_chain

  !> The axis of the new joint is the normal of the plane.
  subroutine plane_loop(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    real(wp), parameter :: n(3) = [0.0_wp, 0.6_wp, 0.8_wp]

    call loop(reshape([n, -n, n], [3, 3]), [revolute_joint, revolute_joint, revolute_joint], robot)
    call make_planar_loops_planar(robot)
    call tester%is_true(robot%joints(1)%kind == revolute_joint, 'a chain of parallel axes')
    call tester%is_true(allocated(robot%joints(1)%remark), 'a remark tells the change')
    call tester%near(abs(dot_product(robot%joints(1)%axis, n)), 1.0_wp, tol, 'its axis is parallel to the others')
    call loop(reshape([n, [1.0_wp, 0.0_wp, 0.0_wp], n], [3, 3]), [revolute_joint, prismatic_joint, revolute_joint], robot)
    call make_planar_loops_planar(robot)
    call tester%is_true(robot%joints(1)%kind == revolute_joint, 'a slide across the axes')
  end subroutine plane_loop

  subroutine spatial_loops(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], y(3) = [0.0_wp, 1.0_wp, 0.0_wp]

    call stays(reshape([z, y, z], [3, 3]), [revolute_joint, revolute_joint, revolute_joint], 'axes across each other')
    call stays(reshape([z, z, z], [3, 3]), [revolute_joint, prismatic_joint, revolute_joint], 'a slide along the axes')
    call stays(reshape([z, z, z], [3, 3]), [revolute_joint, spherical_joint, revolute_joint], 'another ball joint')
    call stays(reshape([y, z, y], [3, 3]), [prismatic_joint, prismatic_joint, prismatic_joint], 'slides alone')
  contains
    subroutine stays(axes, kinds, why)
      real(wp), intent(in) :: axes(3, 3)      !< axes of the three joints
      integer, intent(in) :: kinds(3)         !< their kinds
      character(len=*), intent(in) :: why     !< the chain in words
      type(robot_type) :: robot

      call loop(axes, kinds, robot)
      call make_planar_loops_planar(robot)
      call tester%is_true(robot%joints(1)%kind == spherical_joint .and. .not. allocated(robot%joints(1)%remark), why)
    end subroutine stays
  end subroutine spatial_loops
end module test_robot_poses
