!> The state of motion of a mechanism.
module mech9_state
  use mech9_kinds, only: wp
  implicit none
  private
  public :: state_type, planar_motion_type, copy_state

  !> The motion of frames in planar arithmetic: in the plane's axes, from the origin of frame 0. A pose is (cosine, sine, x, y); a
  !> velocity is the angular velocity about the normal and the velocity of the frame's origin, and accelerations alike.
  type :: planar_motion_type
    real(wp), allocatable :: pose(:, :)           !< (4,0:M) cosine, sine, x, y [m]
    real(wp), allocatable :: angle(:)             !< (M) angle by which each step turns [rad]
    real(wp), allocatable :: turn(:, :)           !< (2,M) its cosine and sine
    real(wp), allocatable :: slide(:, :)          !< (2,M) velocity of the new origin per unit rate
    real(wp), allocatable :: velocity(:, :)       !< (3,0:M) [rad/s, m/s]
    real(wp), allocatable :: acceleration(:, :)   !< (3,0:M) [rad/s^2, m/s^2]
  end type planar_motion_type

  !> The state of motion. All vectors are in the axes of frame 0, positions from its origin. The last index is the number
  !> of the frame, or of the step that made it. In planar arithmetic
  !> the motion of the frames is in `planar` only, and the arrays for space are not allocated.
  type :: state_type
    real(wp) :: t = 0.0_wp                       !< time [s]
    real(wp), allocatable :: q(:)                !< (M) coordinates [rad, m]
    real(wp), allocatable :: dq(:)               !< (M) rates [rad/s, m/s]
    real(wp), allocatable :: ddq(:)              !< (M) accelerations [rad/s^2, m/s^2]
    real(wp), allocatable :: motor(:)            !< states of the motors: currents [A], integrals [rad s, m s]; not allocated: they
                                                 !< have come to rest
    real(wp), allocatable :: motor_rate(:)       !< derivatives of these states in time
    integer, allocatable :: limited(:)           !< limits at which the motors work: -1, 0 for none, 1
    real(wp), allocatable :: stop_force(:)       !< forces of rigid stops on their coordinates; not allocated: none holds [N m, N]
    logical, allocatable :: pressed(:, :)        !< (2,stops) ends of compliant stops that push; not allocated: their penetration tells
    real(wp), allocatable :: friction(:)         !< forces of frictions on their coordinates; not allocated: they are not known [N m, N]
    real(wp), allocatable :: heat(:)             !< energy that each friction has taken; not allocated: no pair has friction [J]
    real(wp), allocatable :: contact_force(:, :) !< (3,contacts) forces on their balls, fixed axes; not allocated: not known [N]
    integer, allocatable :: stretch(:)           !< (contacts) stretch of its profile on which a contact stays; 0: the nearest foot
                                                 !< counts; not allocated: it does for all
    real(wp), allocatable :: curve(:, :)         !< (0:2,couplings) functions of couplings and their derivatives; not allocated:
                                                 !< all couplings are linear
    real(wp), allocatable :: angle(:)            !< (M) angle by which each step turns [rad]
    real(wp), allocatable :: turn(:, :)          !< (2,M) its cosine and sine
    real(wp), allocatable :: r(:, :, :)          !< (3,3,0:M) rotation of each frame
    real(wp), allocatable :: p(:, :)             !< (3,0:M) origin of each frame [m]
    real(wp), allocatable :: axis_w(:, :)        !< (3,M) angular velocity that each step gives per unit rate
    real(wp), allocatable :: axis_v(:, :)        !< (3,M) velocity of the new origin per unit rate
    real(wp), allocatable :: axis_w_rate(:, :)   !< (3,M) derivative of axis_w in q, with the parent frame fixed
    real(wp), allocatable :: axis_v_rate(:, :)   !< (3,M) that of axis_v; both are zero but for user pairs
    real(wp), allocatable :: omega(:, :)         !< (3,0:M) angular velocity [rad/s]
    real(wp), allocatable :: v(:, :)             !< (3,0:M) velocity of the origin [m/s]
    real(wp), allocatable :: alpha(:, :)         !< (3,0:M) angular acceleration [rad/s^2]
    real(wp), allocatable :: a(:, :)             !< (3,0:M) acceleration of the origin [m/s^2]
    type(planar_motion_type) :: planar           !< of the frames, where the plan is planar
  end type state_type

contains

  !> Copy a state. The assignment stands here alone, because compilers write it out for all components.
  pure subroutine copy_state(from, to)
    type(state_type), intent(in) :: from    !< the state
    type(state_type), intent(inout) :: to   !< the same afterwards

    to = from
  end subroutine copy_state
end module mech9_state
