!> The plan in planar arithmetic: of a planar mechanism, or of the planar blocks of a spatial one.
!>
!> All frames of a plane have its normal as their z axis. Frames have the numbers and origins of those of the plan itself.
!> In a planar mechanism, frame 0 has the axes `axes`. In a spatial mechanism there are several planes, each fixed in its base,
!> a frame of the plan; frame 0 of the planar arithmetic then stands for the base of each plane, so that the planar motion is
!> the motion relative to the base.
module mech9_planar_plan
  use mech9_kinds, only: wp
  use mech9_failure, only: failure_type
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type
  implicit none
  private
  public :: planar_plan_type, planar_step_type, planar_closure_type, plane_type

  !> One step. Its constant parts are folded together, so that only an angle or a displacement remains, linear in q.
  type :: planar_step_type
    integer :: parent = 0           !< frame from which the step leads
    integer :: coordinate = 0       !< number of the pair and its coordinate
    logical :: turns = .true.       !< it turns about the normal; else it slides, and its frame stays parallel
    real(wp) :: turn = 0.0_wp       !< rotation about the normal per unit of q: 1, -1, or 0
    real(wp) :: angle = 0.0_wp      !< rotation at q = 0 [rad]
    real(wp) :: place(2) = 0.0_wp   !< new origin in the parent frame at q = 0 [m]
    real(wp) :: slide(2) = 0.0_wp   !< displacement of the new origin in the parent frame per unit of q
  end type planar_step_type

  !> The pose that the closing frame must have in the target frame.
  type :: planar_closure_type
    integer :: closing = 0          !< the frame made by the chain's last step
    integer :: target = 0           !< the other frame of that link
    integer :: base = 0             !< frame at whose origin residuals and rates are expressed
    real(wp) :: cosine = 1.0_wp     !< cosine of the angle from the target frame to the closing frame
    real(wp) :: sine = 0.0_wp       !< sine of this angle
    real(wp) :: place(2) = 0.0_wp   !< origin of the closing frame in the target frame [m]
  end type planar_closure_type

  !> A plane of blocks of a spatial mechanism.
  type :: plane_type
    integer :: base = 0                  !< frame of the plan in which the plane is fixed, with its origin in that of the frame
    real(wp) :: axes(3, 3) = identity    !< turns components in the plane's axes into those of the base
  end type plane_type

  !> The plan of a planar mechanism, or the reason why there is none and the planes of its planar blocks.
  type :: planar_plan_type
    logical :: used = .false.                          !< the whole mechanism is in planar arithmetic
    type(failure_type), allocatable :: why_not         !< the reason, where it is not
    real(wp) :: axes(3, 3) = identity                  !< turns components in the plane's axes into those of frame 0
    logical :: in_xy_plane = .true.                        !< the plane's axes are those of frame 0
    real(wp) :: length = 1.0_wp                        !< the mechanism's size [m]
    type(planar_step_type), allocatable :: steps(:)    !< (M)
    type(planar_closure_type), allocatable :: closures(:)   !< in the order of those of the plan
    real(wp), allocatable :: height(:)                 !< (0:M) of each frame's origin above that of frame 0, or of the base [m]
    !> Each link's own system in its first frame, moved along the normal to the height of frame 0.
    type(pose_type), allocatable :: link_in_frame(:)
    type(plane_type), allocatable :: planes(:)         !< of the planar blocks of a spatial mechanism
    integer, allocatable :: plane_of(:)                !< (0:M) the plane of each frame of a planar block; 0: it moves in space
    !> (3,3,0:M) turns components in each frame of the plan into those in the planar frame of the same number.
    real(wp), allocatable :: to_planar(:, :, :)
    logical, allocatable :: shown(:)                   !< (0:M) the frame of a planar block is read in space, see mech9_planar_view
  end type planar_plan_type
end module mech9_planar_plan
