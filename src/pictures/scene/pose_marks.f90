!> Marks of poses that a link should take, in pictures of a design: an arrow along the x axis from the origin, and a shorter line along y.
!> The link has the same mark in its own colour, which covers that of a pose where the link takes it.
module mech9_pose_marks
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, segments, in_target, in_bracket
  implicit none
  private
  public :: pose_mark_type, add_poses

  !> One pose.
  type :: pose_mark_type
    integer :: link = 0                !< number of the link that should take it
    integer :: number = 0              !< of the pose, among those of its objective
    real(wp) :: place(3) = 0.0_wp      !< of the link's origin, in the system of link 1 [m]
    real(wp) :: turn(3, 3) = 0.0_wp    !< from the axes of the link to those of link 1
  end type pose_mark_type

  !> Lengths of both lines, and of the barbs of the arrow along and across [px].
  real(wp), parameter :: along_x = 34.0_wp, along_y = 14.0_wp, barb = 7.0_wp, half_barb = 3.0_wp

contains

  !> Add the marks of all poses, and one to each link that should take some.
  subroutine add_poses(poses, projection, scene)
    type(pose_mark_type), intent(in) :: poses(:)     !< the poses
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    real(wp), parameter :: own(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    real(wp), parameter :: origin(3) = 0.0_wp
    integer :: i, nodes(8)

    do i = 1, size(poses)
      call add_axes(1, poses(i)%place, poses(i)%turn, projection, scene, nodes)
      call scene%add_item(segments, in_target, nodes, text='pose '//to_text(poses(i)%number)//' of link '//to_text(poses(i)%link))
    end do
    do i = 1, size(poses)
      if (any(poses(:i - 1)%link == poses(i)%link)) cycle
      call add_axes(poses(i)%link, origin, own, projection, scene, nodes)
      call scene%add_item(segments, in_bracket, nodes, poses(i)%link)
    end do
  end subroutine add_poses

  !> Add the nodes of one mark.
  subroutine add_axes(link, place, turn, projection, scene, nodes)
    integer, intent(in) :: link                      !< number of the link that carries the mark
    real(wp), intent(in) :: place(3)                 !< its origin, in the system of the link [m]
    real(wp), intent(in) :: turn(3, 3)               !< its axes, in those of the link
    type(projection_type), intent(in) :: projection  !< from space to the page
    type(scene_type), intent(inout) :: scene         !< nodes and items of the picture
    integer, intent(out) :: nodes(8)                 !< numbers of the ends of four lines
    real(wp), parameter :: ends(2, 8) = reshape([0.0_wp, 0.0_wp, along_x, 0.0_wp, &
                                                 along_x, 0.0_wp, along_x - barb, half_barb, &
                                                 along_x, 0.0_wp, along_x - barb, -half_barb, &
                                                 0.0_wp, 0.0_wp, 0.0_wp, along_y], [2, 8])
    integer :: i

    do i = 1, size(nodes)
      call scene%add_node(link, place + projection%metres(1.0_wp)*matmul(turn(:, :2), ends(:, i)), nodes(i))
    end do
  end subroutine add_axes
end module mech9_pose_marks
