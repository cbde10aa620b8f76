!> Columns of frames: the derivatives of the motions of frames by the rates of those independent coordinates that move them.
!>
!> An entry is one column of one frame. The entries of a frame stand side by side, in ascending order of their coordinates.
module mech9_frame_columns
  use mech9_kinds, only: wp
  implicit none
  private
  public :: frame_entries_type, jacobian_type

  !> The entries of all frames, and the frames on which their clusters stand.
  type :: frame_entries_type
    integer, allocatable :: first(:)          !< (0:M+1) first entry of each frame
    integer, allocatable :: column(:)         !< (entries) place of the coordinate among the independent ones
    integer, allocatable :: local(:)          !< (entries) place of the coordinate among those of its cluster
    integer, allocatable :: parent_entry(:)   !< (entries) the same column in the parent frame, 0 for none
    integer, allocatable :: target_entry(:)   !< (entries) of closing frames: the same column in the target frame, or 0
    integer, allocatable :: support(:)        !< (M) frame on which the cluster of each step stands
  end type frame_entries_type

  !> Derivatives of a frame's angular velocity and of the velocity of its origin, in fixed axes, by the rate of an independent
  !> coordinate. `b` is B = dq_k/dq_i of the coordinate k of the frame's step.
  type :: jacobian_type
    real(wp), allocatable :: w(:, :)    !< (3, entries) angular velocity per unit rate
    real(wp), allocatable :: v(:, :)    !< (3, entries) velocity of the origin per unit rate
    real(wp), allocatable :: flat(:, :) !< (3, entries) in planar arithmetic, of both: w about the normal, v in the plane
    real(wp), allocatable :: b(:)       !< (entries) rate of the step's coordinate per unit rate
  end type jacobian_type
end module mech9_frame_columns
