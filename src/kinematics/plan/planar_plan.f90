!> The plan of a planar mechanism as its arithmetic wants it: frames with one common normal.
!>
!> All frames have the normal of the plane as their z axis, frame 0 the axes `axes`. Frames have the numbers
!> and origins of the plan's own; where a frame is needed in space, the plane's arithmetic is led back to it.
module mech9_planar_plan
  use mech9_kinds, only: wp
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type
  implicit none
  private
  public :: planar_plan_type, planar_step_type, planar_closure_type

  !> One step: constant parts are folded, what is left is an angle or a way that grows with q.
  type :: planar_step_type
    integer :: parent = 0
    integer :: coordinate = 0
    logical :: turns = .true.         !< about the normal; else it slides, and its frame stays parallel
    real(wp) :: turn = 0.0_wp         !< rotation about the normal per unit of q: 1, -1, or 0
    real(wp) :: angle = 0.0_wp        !< rotation at q = 0 [rad]
    real(wp) :: place(2) = 0.0_wp     !< of the new origin in the parent frame at q = 0 [m]
    real(wp) :: slide(2) = 0.0_wp     !< its way in the parent frame per unit of q
  end type planar_step_type

  !> Where the closing frame must be in the target frame.
  type :: planar_closure_type
    integer :: closing = 0
    integer :: target = 0
    integer :: base = 0                !< frame at whose origin errors and rates are written
    real(wp) :: cosine = 1.0_wp        !< of the closing frame's angle
    real(wp) :: sine = 0.0_wp
    real(wp) :: place(2) = 0.0_wp      !< [m]
  end type planar_closure_type

  type :: planar_plan_type
    logical :: used = .false.
    character(len=:), allocatable :: why_not           !< in words, where it is not
    real(wp) :: axes(3, 3) = identity                  !< turns components in the plane's axes into those of frame 0
    logical :: upright = .true.                        !< these are the same
    real(wp) :: length = 1.0_wp                        !< the mechanism's size [m]
    type(planar_step_type), allocatable :: steps(:)
    type(planar_closure_type), allocatable :: closures(:)
    real(wp), allocatable :: height(:)                 !< (0:M) of each frame's origin above that of frame 0 [m]
    !> Each link's own system in its first frame, put to the height of frame 0.
    type(pose_type), allocatable :: link_in_frame(:)
  end type planar_plan_type
end module mech9_planar_plan
