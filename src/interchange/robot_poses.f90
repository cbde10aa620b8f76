!> Poses of a robot's links at its start, and chains of links that move in a plane.
module mech9_robot_poses
  use mech9_kinds, only: wp
  use mech9_rotation, only: about_axis, cross
  use mech9_pose, only: pose_type, compose, inverse
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, prismatic_joint, spherical_joint
  implicit none
  private
  public :: all_poses, make_planar_loops_planar

  !> Axes within this angle of each other are parallel [rad]: files have few digits.
  real(wp), parameter :: parallel = 1.0e-6_wp

contains

  !> Poses of all links in the first one, by way of the joints that close no chain.
  subroutine all_poses(robot, poses, through)
    type(robot_type), intent(in) :: robot             !< the robot
    type(pose_type), intent(out) :: poses(:)          !< (links) the identity where no joints lead to a link
    integer, intent(out), optional :: through(:)      !< (links) number of the joint that leads to the link; 0: none
    logical :: known(size(poses)), grows
    integer :: k

    known = .false.
    known(1) = .true.
    if (present(through)) through = 0
    grows = .true.
    do while (grows)
      grows = .false.
      do k = 1, robot%n_joints
        associate (joint => robot%joints(k))
          if (joint%closes .or. .not. known(joint%links(1)) .or. known(joint%links(2))) cycle
          poses(joint%links(2)) = compose(poses(joint%links(1)), pose_at_start(joint))
          known(joint%links(2)) = .true.
          if (present(through)) through(joint%links(2)) = k
          grows = .true.
        end associate
      end do
    end do
  end subroutine all_poses

  !> Pose of the moving link in the reference link at the start.
  pure function pose_at_start(joint) result(pose)
    type(robot_joint_type), intent(in) :: joint  !< the joint
    type(pose_type) :: pose, motion

    if (joint%kind == revolute_joint) motion%r = about_axis(joint%axis, joint%start)
    if (joint%kind == prismatic_joint) motion%p = joint%start*joint%axis
    pose = compose(compose(joint%frames(1), motion), inverse(joint%frames(2)))
  end function pose_at_start

  !> A ball joint that closes a chain which moves in a plane only turns about the normal of this plane: it becomes a revolute one,
  !> without two freedoms that nothing determines.
  subroutine make_planar_loops_planar(robot)
    type(robot_type), intent(inout) :: robot  !< without fixed joints; its ball joints may change
    type(pose_type) :: poses(robot%n_links), at
    integer :: through(robot%n_links), k
    real(wp) :: normal(3)
    logical :: is_planar

    call all_poses(robot, poses, through)
    do k = 1, robot%n_joints
      if (.not. robot%joints(k)%closes .or. robot%joints(k)%kind /= spherical_joint) cycle
      call find_normal(robot, poses, through, robot%joints(k)%links, normal, is_planar)
      if (.not. is_planar) cycle
      at = compose(poses(robot%joints(k)%links(1)), robot%joints(k)%frames(1))
      robot%joints(k)%kind = revolute_joint
      robot%joints(k)%axis = matmul(normal, at%r)
      robot%joints(k)%remark = 'a ball joint, which only turns about the normal of a plane here'
    end do
  end subroutine make_planar_loops_planar

  !> The normal of the plane in which a chain of links moves.
  subroutine find_normal(robot, poses, through, ends, normal, is_planar)
    type(robot_type), intent(in) :: robot      !< the robot
    type(pose_type), intent(in) :: poses(:)    !< (links) at the start, in the first one
    integer, intent(in) :: through(:)          !< (links) number of the joint that leads to the link; 0: none
    integer, intent(in) :: ends(2)             !< numbers of the links at both ends of the chain
    real(wp), intent(out) :: normal(3)         !< in the first link, of length one
    logical, intent(out) :: is_planar          !< the chain moves in a plane
    logical :: in_chain(robot%n_joints)
    type(pose_type) :: at
    real(wp) :: axis(3)
    integer :: i, k, link

    ! joints on both ways to the first link do not move one end against the other
    in_chain = .false.
    do i = 1, 2
      link = ends(i)
      do while (through(link) > 0)
        in_chain(through(link)) = .not. in_chain(through(link))
        link = robot%joints(through(link))%links(1)
      end do
    end do
    normal = 0.0_wp
    is_planar = .true.
    do i = 1, 2
      do k = 1, robot%n_joints
        if (.not. in_chain(k)) cycle
        at = compose(poses(robot%joints(k)%links(1)), robot%joints(k)%frames(1))
        axis = matmul(at%r, robot%joints(k)%axis)
        if (robot%joints(k)%kind == revolute_joint) then
          if (.not. any(abs(normal) > 0.0_wp)) normal = axis
          is_planar = is_planar .and. norm2(cross(normal, axis)) < parallel
        else if (robot%joints(k)%kind == prismatic_joint) then
          is_planar = is_planar .and. abs(dot_product(normal, axis)) < parallel
        else
          is_planar = .false.
        end if
      end do
    end do
    is_planar = is_planar .and. any(abs(normal) > 0.0_wp)
  end subroutine find_normal
end module mech9_robot_poses
