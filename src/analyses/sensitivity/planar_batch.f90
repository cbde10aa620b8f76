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
    real(wp), allocatable :: pose(:, :, :)           !< (batch,4,0:M) cosine, sine, x, y [m]
    real(wp), allocatable :: velocity(:, :, :)       !< (batch,3,0:M) of each frame [rad/s, m/s]
    real(wp), allocatable :: acceleration(:, :, :)   !< (batch,3,0:M) of each frame [rad/s^2, m/s^2]
    real(wp), allocatable :: slide(:, :, :)          !< (batch,2,M) velocity of each frame's origin per unit rate
    real(wp), allocatable :: spin(:, :, :, :)        !< (batch,2,0:2,0:M) cosine and sine with their derivatives in time
  end type planar_batch_type

contains

  !> Frames that are all at rest, as frame 0 stays.
  pure function new_planar_batch(m) result(batch)
    integer, intent(in) :: m   !< number of steps
    type(planar_batch_type) :: batch

    allocate (batch%pose(batch_size, 4, 0:m), batch%velocity(batch_size, 3, 0:m), batch%acceleration(batch_size, 3, 0:m), &
              batch%slide(batch_size, 2, m), batch%spin(batch_size, 2, 0:2, 0:m), source=0.0_wp)
    batch%pose(:, 1, :) = 1.0_wp
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

    call take_plane(size(frames), frames, ubound(motion%pose, 2), motion%pose, motion%velocity, motion%acceleration, position, &
                    highest, batch%pose, batch%velocity, batch%acceleration)
    do i = 1, size(slides)
      batch%slide(position, :, slides(i)) = motion%slide(:, slides(i))
    end do
  end subroutine take_planar

  ! The next procedures take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> Take the motion of the frames at one position, from plain arrays.
  pure subroutine take_plane(n, frames, m, pose, velocity, acceleration, position, highest, poses, velocities, accelerations)
    integer, intent(in) :: n                                            !< number of frames that matter
    integer, intent(in) :: frames(n)                                    !< these frames, without frame 0
    integer, intent(in) :: m                                            !< number of steps
    real(wp), intent(in) :: pose(4, 0:m)                                !< of each frame [m]
    real(wp), intent(in) :: velocity(3, 0:m)                            !< of each frame [rad/s, m/s]
    real(wp), intent(in) :: acceleration(3, 0:m)                        !< of each frame [rad/s^2, m/s^2]
    integer, intent(in) :: position                                     !< number of the position in the batch
    integer, intent(in) :: highest                                      !< order of the highest derivative
    real(wp), intent(inout) :: poses(batch_size, 4, 0:m)                !< gets the poses
    real(wp), intent(inout) :: velocities(batch_size, 3, 0:m)           !< gets the velocities
    real(wp), intent(inout) :: accelerations(batch_size, 3, 0:m)        !< gets the accelerations
    integer :: i, k

    do i = 1, n
      k = frames(i)
      poses(position, 1, k) = pose(1, k)
      poses(position, 2, k) = pose(2, k)
      poses(position, 3, k) = pose(3, k)
      poses(position, 4, k) = pose(4, k)
      if (highest == 0) cycle
      velocities(position, 1, k) = velocity(1, k)
      velocities(position, 2, k) = velocity(2, k)
      velocities(position, 3, k) = velocity(3, k)
      if (highest == 1) cycle
      accelerations(position, 1, k) = acceleration(1, k)
      accelerations(position, 2, k) = acceleration(2, k)
      accelerations(position, 3, k) = acceleration(3, k)
    end do
  end subroutine take_plane

  !> Cosine and sine of some frames with their derivatives in time.
  pure subroutine find_spins(n, frames, highest, batch)
    integer, intent(in) :: n                           !< number of positions
    integer, intent(in) :: frames(:)                   !< the frames, without frame 0
    integer, intent(in) :: highest                     !< order of the highest derivative
    type(planar_batch_type), intent(inout) :: batch    !< with the motion of the frames
    integer :: j

    do j = 1, size(frames)
      associate (k => frames(j))
        call find_spin(n, batch%pose(:, :, k), batch%velocity(:, :, k), batch%acceleration(:, :, k), highest, &
                       batch%spin(:, :, :, k))
      end associate
    end do
  end subroutine find_spins

  !> Cosine and sine of a frame with their derivatives in time.
  pure subroutine find_spin(n, pose, velocity, acceleration, highest, spin)
    integer, intent(in) :: n                                !< number of positions
    real(wp), intent(in) :: pose(batch_size, 4)             !< of the frame [m]
    real(wp), intent(in) :: velocity(batch_size, 3)         !< of the frame [rad/s, m/s]
    real(wp), intent(in) :: acceleration(batch_size, 3)     !< of the frame [rad/s^2, m/s^2]
    integer, intent(in) :: highest                          !< order of the highest derivative
    real(wp), intent(inout) :: spin(batch_size, 2, 0:2)     !< the result
    integer :: i

    do i = 1, n
      spin(i, 1, 0) = pose(i, 1)
      spin(i, 2, 0) = pose(i, 2)
    end do
    if (highest == 0) return
    do i = 1, n
      spin(i, 1, 1) = -velocity(i, 1)*pose(i, 2)
      spin(i, 2, 1) = velocity(i, 1)*pose(i, 1)
    end do
    if (highest == 1) return
    do i = 1, n
      spin(i, 1, 2) = -acceleration(i, 1)*pose(i, 2) - velocity(i, 1)**2*pose(i, 1)
      spin(i, 2, 2) = acceleration(i, 1)*pose(i, 1) - velocity(i, 1)**2*pose(i, 2)
    end do
  end subroutine find_spin
end module mech9_planar_batch
