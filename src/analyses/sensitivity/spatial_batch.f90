!> The motion of frames and steps in space at several positions at once, with the position as the fastest index.
module mech9_spatial_batch
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: spatial_batch_type, new_spatial_batch, take_spatial, find_turning, find_twists

  !> All in the axes of frame 0, from its origin. Frame 0 is at rest. A twist is the rotation, then the shift of the point at the origin
  !> of frame 0.
  type :: spatial_batch_type
    real(wp), allocatable :: r(:, :, :, :, :)            !< (batch,3,3,0:2,0:M) rotation of each frame with its derivatives in time
    real(wp), allocatable :: p(:, :, :, :)               !< (batch,3,0:2,0:M) origin of each frame with its derivatives in time [m]
    real(wp), allocatable :: omega(:, :, :)              !< (batch,3,0:M) angular velocity of each frame [rad/s]
    real(wp), allocatable :: alpha(:, :, :)              !< (batch,3,0:M) angular acceleration of each frame [rad/s^2]
    real(wp), allocatable :: step(:, :, :, :)            !< (batch,6,0:2,M) twist of each step per unit rate, with its derivatives in time
    real(wp), allocatable, private :: velocity(:, :, :)  !< (batch,6,0:M) of each frame as a twist [rad/s, m/s]
    real(wp), allocatable, private :: acceleration(:, :, :)   !< (batch,6,0:M) derivative of `velocity` in time
  end type spatial_batch_type

contains

  !> Frames that are all at rest, as frame 0 stays.
  pure function new_spatial_batch(m) result(batch)
    integer, intent(in) :: m   !< number of steps
    type(spatial_batch_type) :: batch
    integer :: i

    allocate (batch%r(batch_size, 3, 3, 0:2, 0:m), batch%p(batch_size, 3, 0:2, 0:m), batch%omega(batch_size, 3, 0:m), &
              batch%alpha(batch_size, 3, 0:m), batch%step(batch_size, 6, 0:2, m), batch%velocity(batch_size, 6, 0:m), &
              batch%acceleration(batch_size, 6, 0:m), source=0.0_wp)
    do i = 1, 3
      batch%r(:, i, i, 0, :) = 1.0_wp
    end do
  end function new_spatial_batch

  !> Take the motion of some frames and steps at one position.
  pure subroutine take_spatial(state, frames, steps, position, highest, batch)
    type(state_type), intent(in) :: state              !< the motion
    integer, intent(in) :: frames(:)                   !< the frames that matter, without frame 0
    integer, intent(in) :: steps(:)                    !< the steps that matter
    integer, intent(in) :: position                    !< number of the position in the batch
    integer, intent(in) :: highest                     !< order of the highest derivative
    type(spatial_batch_type), intent(inout) :: batch   !< gets the motion
    integer :: i, j, k

    do i = 1, size(frames)
      k = frames(i)
      do j = 1, 3
        call put(state%r(1, j, k), position, batch%r(1, 1, j, 0, k))
      end do
      call put(state%p(1, k), position, batch%p(1, 1, 0, k))
      if (highest == 0) cycle
      call put(state%v(1, k), position, batch%p(1, 1, 1, k))
      call put(state%omega(1, k), position, batch%omega(1, 1, k))
      if (highest == 1) cycle
      call put(state%a(1, k), position, batch%p(1, 1, 2, k))
      call put(state%alpha(1, k), position, batch%alpha(1, 1, k))
    end do
    do i = 1, size(steps)
      call put(state%axis_w(1, steps(i)), position, batch%step(1, 1, 0, steps(i)))
      call put(state%axis_v(1, steps(i)), position, batch%step(1, 4, 0, steps(i)))
    end do
  end subroutine take_spatial

  ! The next procedures take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> Put a vector into its place among those at other positions.
  pure subroutine put(vector, position, vectors)
    real(wp), intent(in) :: vector(3)                    !< the vector
    integer, intent(in) :: position                      !< number of the position in the batch
    real(wp), intent(inout) :: vectors(batch_size, 3)    !< gets it

    vectors(position, 1) = vector(1)
    vectors(position, 2) = vector(2)
    vectors(position, 3) = vector(3)
  end subroutine put

  !> The motion of frames as twists, and the twists of steps with their derivatives in time, from velocities that were taken. The steps
  !> have axes that are fixed in the frames from which they lead.
  pure subroutine find_twists(n, plan, frames, steps, highest, batch)
    integer, intent(in) :: n                           !< number of positions
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    integer, intent(in) :: frames(:)                   !< frames from which these steps lead
    integer, intent(in) :: steps(:)                    !< the steps
    integer, intent(in) :: highest                     !< order of the highest derivative
    type(spatial_batch_type), intent(inout) :: batch   !< with the motion of the frames and steps
    integer :: i

    do i = 1, size(frames)
      associate (k => frames(i))
        if (k > 0 .and. highest > 0) &
          call find_frame_twists(n, batch%p(1, 1, 0, k), batch%omega(1, 1, k), batch%alpha(1, 1, k), highest, &
                                 batch%velocity(1, 1, k), batch%acceleration(1, 1, k))
      end associate
    end do
    do i = 1, size(steps)
      associate (s => steps(i), k => plan%steps(steps(i))%parent)
        call subtract_cross(n, batch%step(1, 1, 0, s), batch%p(1, 1, 0, s), batch%step(1, 4, 0, s))
        if (highest == 0 .or. k == 0) cycle
        call set_bracket(n, batch%velocity(1, 1, k), batch%step(1, 1, 0, s), batch%step(1, 1, 1, s))
        if (highest == 1) cycle
        call set_bracket(n, batch%acceleration(1, 1, k), batch%step(1, 1, 0, s), batch%step(1, 1, 2, s))
        call add_bracket(n, batch%velocity(1, 1, k), batch%step(1, 1, 1, s), batch%step(1, 1, 2, s))
      end associate
    end do
  end subroutine find_twists

  !> Velocity and acceleration of a frame as twists.
  pure subroutine find_frame_twists(n, p, omega, alpha, highest, velocity, acceleration)
    integer, intent(in) :: n                                  !< number of positions
    real(wp), intent(in) :: p(batch_size, 3, 0:2)             !< origin of the frame with its derivatives in time [m]
    real(wp), intent(in) :: omega(batch_size, 3)              !< its angular velocity [rad/s]
    real(wp), intent(in) :: alpha(batch_size, 3)              !< its angular acceleration [rad/s^2]
    integer, intent(in) :: highest                            !< order of the highest derivative
    real(wp), intent(inout) :: velocity(batch_size, 6)        !< the twist [rad/s, m/s]
    real(wp), intent(inout) :: acceleration(batch_size, 6)    !< its derivative in time
    integer :: i, r

    do r = 1, 3
      do i = 1, n
        velocity(i, r) = omega(i, r)
        velocity(i, 3 + r) = p(i, r, 1)
      end do
    end do
    call subtract_cross(n, omega, p(1, 1, 0), velocity(1, 4))
    if (highest == 1) return
    do r = 1, 3
      do i = 1, n
        acceleration(i, r) = alpha(i, r)
        acceleration(i, 3 + r) = p(i, r, 2)
      end do
    end do
    call subtract_cross(n, alpha, p(1, 1, 0), acceleration(1, 4))
    call subtract_cross(n, omega, p(1, 1, 1), acceleration(1, 4))
  end subroutine find_frame_twists

  !> Subtract a vector product.
  pure subroutine subtract_cross(n, u, v, w)
    integer, intent(in) :: n                       !< number of positions
    real(wp), intent(in) :: u(batch_size, 3)       !< left factor
    real(wp), intent(in) :: v(batch_size, 3)       !< right factor
    real(wp), intent(inout) :: w(batch_size, 3)    !< the difference
    integer :: i

    do i = 1, n
      w(i, 1) = w(i, 1) - (u(i, 2)*v(i, 3) - u(i, 3)*v(i, 2))
      w(i, 2) = w(i, 2) - (u(i, 3)*v(i, 1) - u(i, 1)*v(i, 3))
      w(i, 3) = w(i, 3) - (u(i, 1)*v(i, 2) - u(i, 2)*v(i, 1))
    end do
  end subroutine subtract_cross

  !> The derivative in time of a twist b that is fixed in a body which moves with twist a.
  pure subroutine set_bracket(n, a, b, c)
    integer, intent(in) :: n                       !< number of positions
    real(wp), intent(in) :: a(batch_size, 6)       !< twist of the body
    real(wp), intent(in) :: b(batch_size, 6)       !< the fixed twist
    real(wp), intent(inout) :: c(batch_size, 6)    !< the derivative
    integer :: i, r

    do r = 1, 6
      do i = 1, n
        c(i, r) = 0.0_wp
      end do
    end do
    call add_bracket(n, a, b, c)
  end subroutine set_bracket

  !> Add such a derivative.
  pure subroutine add_bracket(n, a, b, c)
    integer, intent(in) :: n                       !< number of positions
    real(wp), intent(in) :: a(batch_size, 6)       !< twist of the body
    real(wp), intent(in) :: b(batch_size, 6)       !< the fixed twist
    real(wp), intent(inout) :: c(batch_size, 6)    !< the sum
    integer :: i

    do i = 1, n
      c(i, 1) = c(i, 1) + (a(i, 2)*b(i, 3) - a(i, 3)*b(i, 2))
      c(i, 2) = c(i, 2) + (a(i, 3)*b(i, 1) - a(i, 1)*b(i, 3))
      c(i, 3) = c(i, 3) + (a(i, 1)*b(i, 2) - a(i, 2)*b(i, 1))
    end do
    do i = 1, n
      c(i, 4) = c(i, 4) + (a(i, 2)*b(i, 6) - a(i, 3)*b(i, 5) + a(i, 5)*b(i, 3) - a(i, 6)*b(i, 2))
      c(i, 5) = c(i, 5) + (a(i, 3)*b(i, 4) - a(i, 1)*b(i, 6) + a(i, 6)*b(i, 1) - a(i, 4)*b(i, 3))
      c(i, 6) = c(i, 6) + (a(i, 1)*b(i, 5) - a(i, 2)*b(i, 4) + a(i, 4)*b(i, 2) - a(i, 5)*b(i, 1))
    end do
  end subroutine add_bracket

  !> The derivatives in time of the rotations of some frames.
  pure subroutine find_turning(n, frames, highest, batch)
    integer, intent(in) :: n                           !< number of positions
    integer, intent(in) :: frames(:)                   !< the frames, without frame 0
    integer, intent(in) :: highest                     !< order of the highest derivative
    type(spatial_batch_type), intent(inout) :: batch   !< with the motion of the frames
    integer :: j, c

    if (highest == 0) return
    do j = 1, size(frames)
      associate (k => frames(j))
        do c = 1, 3
          call turn_column(n, batch%omega(1, 1, k), batch%alpha(1, 1, k), highest, batch%r(1, 1, c, 0, k), batch%r(1, 1, c, 1, k), &
                           batch%r(1, 1, c, 2, k))
        end do
      end associate
    end do
  end subroutine find_turning

  !> The derivatives in time of a direction that is fixed in a frame.
  pure subroutine turn_column(n, w, alpha, highest, a, first, second)
    integer, intent(in) :: n                             !< number of positions
    real(wp), intent(in) :: w(batch_size, 3)             !< angular velocity of the frame [rad/s]
    real(wp), intent(in) :: alpha(batch_size, 3)         !< its angular acceleration [rad/s^2]
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(in) :: a(batch_size, 3)             !< the direction
    real(wp), intent(inout) :: first(batch_size, 3)      !< its first derivative
    real(wp), intent(inout) :: second(batch_size, 3)     !< its second derivative
    integer :: i

    do i = 1, n
      first(i, 1) = w(i, 2)*a(i, 3) - w(i, 3)*a(i, 2)
      first(i, 2) = w(i, 3)*a(i, 1) - w(i, 1)*a(i, 3)
      first(i, 3) = w(i, 1)*a(i, 2) - w(i, 2)*a(i, 1)
    end do
    if (highest == 1) return
    do i = 1, n
      second(i, 1) = alpha(i, 2)*a(i, 3) - alpha(i, 3)*a(i, 2) + w(i, 2)*first(i, 3) - w(i, 3)*first(i, 2)
      second(i, 2) = alpha(i, 3)*a(i, 1) - alpha(i, 1)*a(i, 3) + w(i, 3)*first(i, 1) - w(i, 1)*first(i, 3)
      second(i, 3) = alpha(i, 1)*a(i, 2) - alpha(i, 2)*a(i, 1) + w(i, 1)*first(i, 2) - w(i, 2)*first(i, 1)
    end do
  end subroutine turn_column
end module mech9_spatial_batch
