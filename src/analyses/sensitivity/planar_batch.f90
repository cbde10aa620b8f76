!> The motion of frames in the plane at several positions at once, with the position as the fastest index.
module mech9_planar_batch
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size
  use mech9_state, only: planar_motion_type
  implicit none
  private
  public :: planar_batch_type, new_planar_batch, take_planar, find_spins

  !> The motion of frames in the plane, in its axes from the origin of frame 0. Frame 0 is at rest.
  type :: planar_batch_type
    real(wp), allocatable :: place(:, :, :, :)    !< (batch,2,0:2,0:M) origin of each frame with its derivatives in time [m]
    real(wp), allocatable :: spin(:, :, :, :)     !< (batch,2,0:2,0:M) cosine and sine of each frame with their derivatives in time
    real(wp), allocatable :: turning(:, :, :)     !< (batch,2,0:M) angular velocity and acceleration of each frame [rad/s, rad/s^2]
    real(wp), allocatable :: slide(:, :, :)       !< (batch,2,M) velocity of each frame's origin per unit rate
  end type planar_batch_type

contains

  !> Frames that are all at rest, as frame 0 stays.
  pure function new_planar_batch(m) result(batch)
    integer, intent(in) :: m   !< number of steps
    type(planar_batch_type) :: batch

    allocate (batch%place(batch_size, 2, 0:2, 0:m), batch%spin(batch_size, 2, 0:2, 0:m), batch%turning(batch_size, 2, 0:m), &
              batch%slide(batch_size, 2, m), source=0.0_wp)
    batch%spin(:, 1, 0, :) = 1.0_wp
  end function new_planar_batch

  !> Take the motion of the frames at one position.
  pure subroutine take_planar(motion, frames, slides, position, highest, batch)
    type(planar_motion_type), intent(in) :: motion     !< the motion
    integer, intent(in) :: frames(:)                   !< the frames that matter, without frame 0
    integer, intent(in) :: slides(:)                   !< the steps that slide and matter
    integer, intent(in) :: position                    !< number of the position in the batch
    integer, intent(in) :: highest                     !< order of the highest derivative
    type(planar_batch_type), intent(inout) :: batch    !< gets the motion
    integer :: i

    call take_poses(position, frames, motion%pose, batch%spin, batch%place)
    if (highest > 0) call take_rates(position, frames, motion%velocity, motion%acceleration, batch%place, batch%turning)
    do i = 1, size(slides)
      batch%slide(position, :, slides(i)) = motion%slide(:, slides(i))
    end do
  end subroutine take_planar

  ! The next procedures take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> Take the poses of the frames at one position.
  pure subroutine take_poses(position, frames, poses, spins, places)
    integer, intent(in) :: position                            !< number of the position in the batch
    integer, intent(in) :: frames(:)                           !< the frames
    real(wp), intent(in) :: poses(4, 0:*)                      !< (4,0:M) cosine, sine, origin of each frame [m]
    real(wp), intent(inout) :: spins(batch_size, 2, 0:2, 0:*)  !< get cosine and sine
    real(wp), intent(inout) :: places(batch_size, 2, 0:2, 0:*) !< get the origins [m]
    integer :: i, k

    do i = 1, size(frames)
      k = frames(i)
      spins(position, 1, 0, k) = poses(1, k)
      spins(position, 2, 0, k) = poses(2, k)
      places(position, 1, 0, k) = poses(3, k)
      places(position, 2, 0, k) = poses(4, k)
    end do
  end subroutine take_poses

  !> Take the velocities and accelerations of the frames at one position. Accelerations that are not found are without meaning.
  pure subroutine take_rates(position, frames, velocities, accelerations, places, turning)
    integer, intent(in) :: position                            !< number of the position in the batch
    integer, intent(in) :: frames(:)                           !< the frames
    real(wp), intent(in) :: velocities(3, 0:*)                 !< (3,0:M) of each frame [rad/s, m/s]
    real(wp), intent(in) :: accelerations(3, 0:*)              !< (3,0:M) of each frame [rad/s^2, m/s^2]
    real(wp), intent(inout) :: places(batch_size, 2, 0:2, 0:*) !< get the derivatives of the origins [m/s, m/s^2]
    real(wp), intent(inout) :: turning(batch_size, 2, 0:*)     !< gets angular velocities and accelerations [rad/s, rad/s^2]
    integer :: i, k

    do i = 1, size(frames)
      k = frames(i)
      turning(position, 1, k) = velocities(1, k)
      places(position, 1, 1, k) = velocities(2, k)
      places(position, 2, 1, k) = velocities(3, k)
      turning(position, 2, k) = accelerations(1, k)
      places(position, 1, 2, k) = accelerations(2, k)
      places(position, 2, 2, k) = accelerations(3, k)
    end do
  end subroutine take_rates

  !> The derivatives in time of cosine and sine of some frames.
  pure subroutine find_spins(n, frames, highest, batch)
    integer, intent(in) :: n                           !< number of positions
    integer, intent(in) :: frames(:)                   !< the frames, without frame 0
    integer, intent(in) :: highest                     !< order of the highest derivative
    type(planar_batch_type), intent(inout) :: batch    !< with the motion of the frames
    integer :: j

    if (highest == 0) return
    do j = 1, size(frames)
      call find_spin(n, batch%turning(1, 1, frames(j)), highest, batch%spin(1, 1, 0, frames(j)))
    end do
  end subroutine find_spins

  !> The derivatives in time of cosine and sine of a frame.
  pure subroutine find_spin(n, turning, highest, spin)
    integer, intent(in) :: n                                !< number of positions
    real(wp), intent(in) :: turning(batch_size, 2)          !< angular velocity and acceleration [rad/s, rad/s^2]
    integer, intent(in) :: highest                          !< order of the highest derivative
    real(wp), intent(inout) :: spin(batch_size, 2, 0:2)     !< with cosine and sine; gets their derivatives
    integer :: i

    do i = 1, n
      spin(i, 1, 1) = -turning(i, 1)*spin(i, 2, 0)
      spin(i, 2, 1) = turning(i, 1)*spin(i, 1, 0)
    end do
    if (highest == 1) return
    do i = 1, n
      spin(i, 1, 2) = -turning(i, 2)*spin(i, 2, 0) - turning(i, 1)**2*spin(i, 1, 0)
      spin(i, 2, 2) = turning(i, 2)*spin(i, 1, 0) - turning(i, 1)**2*spin(i, 2, 0)
    end do
  end subroutine find_spin
end module mech9_planar_batch
