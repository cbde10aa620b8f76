!> The motion of frames that keep one normal: poses, velocities and accelerations in the plane, and the conversion of vectors.
!>
!> A pose is (cosine, sine, x, y) in the plane's axes, from the origin of frame 0. A velocity is the angular velocity about the
!> normal and the velocity of the frame's origin; an acceleration is the angular acceleration and that of the origin.
module mech9_planar_motion
  use mech9_kinds, only: wp
  use mech9_sine_cosine, only: cosines_and_sines
  use mech9_rotation, only: add_small_angle
  use mech9_planar_plan, only: planar_plan_type, planar_step_type
  use mech9_state, only: planar_motion_type
  use mech9_planar_formulas, only: step_velocity, step_acceleration
  implicit none
  private
  public :: new_planar_motion, place_in_plane, change_in_plane, planar_velocities, planar_accelerations, to_space, to_plane

contains

  !> Room for frames 0 .. m, all at rest and in the place of frame 0.
  pure function new_planar_motion(m) result(motion)
    integer, intent(in) :: m   !< number of steps
    type(planar_motion_type) :: motion

    allocate (motion%pose(4, 0:m), motion%angle(m), motion%turn(2, m), motion%slide(2, m), source=0.0_wp)
    allocate (motion%velocity(3, 0:m), motion%acceleration(3, 0:m), source=0.0_wp)
    motion%pose(1, :) = 1.0_wp
    motion%turn(1, :) = 1.0_wp
  end function new_planar_motion

  !> Poses of the frames first .. last.
  pure subroutine place_in_plane(planar, first, last, q, motion)
    type(planar_plan_type), intent(in) :: planar        !< the plan in planar arithmetic
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    real(wp), intent(in), contiguous :: q(:)            !< (M) coordinates [rad, m]
    type(planar_motion_type), intent(inout) :: motion   !< gets the angles, poses and slides of these frames

    call find_angles(planar%steps, first, last, q, motion%angle)
    call cosines_and_sines(last - first + 1, motion%angle(first:last), motion%turn(:, first:last))
    call place(planar%steps, first, last, q, motion%turn, motion%pose, motion%slide)
  end subroutine place_in_plane

  !> Poses of the frames first .. last after a small change of some coordinates. The cosines and sines of their angles are
  !> corrected to second order and not computed anew.
  pure subroutine change_in_plane(planar, first, last, changed, change, q, motion)
    type(planar_plan_type), intent(in) :: planar        !< the plan in planar arithmetic
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    integer, intent(in) :: changed(:)                   !< steps whose coordinates have changed
    real(wp), intent(in) :: change(:)                   !< changes of their coordinates; of turns [rad]
    real(wp), intent(in), contiguous :: q(:)            !< (M) coordinates after the change [rad, m]
    type(planar_motion_type), intent(inout) :: motion   !< gets the poses and slides of these frames
    integer :: i

    do i = 1, size(changed)
      if (planar%steps(changed(i))%turns) &
        call add_small_angle(planar%steps(changed(i))%turn*change(i), motion%turn(:, changed(i)))
    end do
    call place(planar%steps, first, last, q, motion%turn, motion%pose, motion%slide)
  end subroutine change_in_plane

  ! Arrays of which all but the last extent is known: the compiler keeps their addresses in registers.

  !> The angles by which the steps first .. last turn.
  pure subroutine find_angles(steps, first, last, q, angles)
    type(planar_step_type), intent(in) :: steps(*)   !< steps of the plan
    integer, intent(in) :: first                     !< steps from this one
    integer, intent(in) :: last                      !< to this one
    real(wp), intent(in) :: q(*)                     !< (M) coordinates [rad, m]
    real(wp), intent(inout) :: angles(*)             !< (M) angle by which each step turns [rad]
    integer :: i

    do i = first, last
      angles(i) = steps(i)%turn*q(steps(i)%coordinate) + steps(i)%angle
    end do
  end subroutine find_angles

  !> Poses of the frames first .. last from the cosines and sines of their steps, from plain arrays.
  pure subroutine place(steps, first, last, q, cs, f, slide)
    type(planar_step_type), intent(in) :: steps(*)   !< steps of the plan
    integer, intent(in) :: first                     !< frames from this one
    integer, intent(in) :: last                      !< to this one
    real(wp), intent(in) :: q(*)                     !< (M) coordinates [rad, m]
    real(wp), intent(in) :: cs(2, *)                 !< cosine and sine of the angle by which each step turns
    real(wp), intent(inout) :: f(4, 0:*)             !< (cosine, sine, x, y) pose of each frame [m]
    real(wp), intent(inout) :: slide(2, *)           !< velocity of each frame's origin per unit rate
    real(wp) :: x, y, cp, sp
    integer :: i, p

    do i = first, last
      p = steps(i)%parent
      cp = f(1, p)
      sp = f(2, p)
      x = steps(i)%place(1)
      y = steps(i)%place(2)
      if (steps(i)%turns) then
        f(1, i) = cp*cs(1, i) - sp*cs(2, i)
        f(2, i) = sp*cs(1, i) + cp*cs(2, i)
      else
        x = x + q(steps(i)%coordinate)*steps(i)%slide(1)
        y = y + q(steps(i)%coordinate)*steps(i)%slide(2)
        slide(1, i) = cp*steps(i)%slide(1) - sp*steps(i)%slide(2)
        slide(2, i) = sp*steps(i)%slide(1) + cp*steps(i)%slide(2)
        f(1, i) = cp
        f(2, i) = sp
      end if
      f(3, i) = f(3, p) + cp*x - sp*y
      f(4, i) = f(4, p) + sp*x + cp*y
    end do
  end subroutine place

  !> Velocities of the frames first .. last.
  pure subroutine planar_velocities(planar, first, last, dq, motion)
    type(planar_plan_type), intent(in) :: planar        !< the plan in planar arithmetic
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    real(wp), intent(in), contiguous :: dq(:)           !< (M) rates [rad/s, m/s]
    type(planar_motion_type), intent(inout) :: motion   !< poses in; velocities of these frames out

    call find_velocities(planar%steps, first, last, dq, motion%pose, motion%slide, motion%velocity)
  end subroutine planar_velocities

  !> Velocities of the frames first .. last, from plain arrays.
  pure subroutine find_velocities(steps, first, last, dq, f, slide, v)
    type(planar_step_type), intent(in) :: steps(*)   !< steps of the plan
    integer, intent(in) :: first                     !< frames from this one
    integer, intent(in) :: last                      !< to this one
    real(wp), intent(in) :: dq(*)                    !< (M) rates [rad/s, m/s]
    real(wp), intent(in) :: f(4, 0:*)                !< (cosine, sine, x, y) pose of each frame [m]
    real(wp), intent(in) :: slide(2, *)              !< velocity of each frame's origin per unit rate
    real(wp), intent(inout) :: v(3, 0:*)             !< velocity of each frame [rad/s, m/s]
    integer :: i, p

    do i = first, last
      p = steps(i)%parent
      call step_velocity(steps(i), dq(steps(i)%coordinate), f(3:4, i) - f(3:4, p), slide(:, i), v(:, p), v(:, i))
    end do
  end subroutine find_velocities

  !> Accelerations of the frames first .. last.
  pure subroutine planar_accelerations(planar, first, last, dq, ddq, motion)
    type(planar_plan_type), intent(in) :: planar        !< the plan in planar arithmetic
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    real(wp), intent(in), contiguous :: dq(:)           !< (M) rates [rad/s, m/s]
    real(wp), intent(in), contiguous :: ddq(:)          !< (M) accelerations [rad/s^2, m/s^2]
    type(planar_motion_type), intent(inout) :: motion   !< poses and velocities in; accelerations of these frames out

    call find_accelerations(planar%steps, motion%pose, motion%slide, motion%velocity, motion%acceleration)

  contains

    !> The same from plain arrays.
    pure subroutine find_accelerations(steps, f, slide, v, a)
      type(planar_step_type), intent(in) :: steps(*)   !< steps of the plan
      real(wp), intent(in) :: f(4, 0:*)                !< (cosine, sine, x, y) pose of each frame [m]
      real(wp), intent(in) :: slide(2, *)              !< velocity of each frame's origin per unit rate
      real(wp), intent(in) :: v(3, 0:*)                !< velocity of each frame [rad/s, m/s]
      real(wp), intent(inout) :: a(3, 0:*)             !< acceleration of each frame [rad/s^2, m/s^2]
      integer :: i, k, p

      do i = first, last
        p = steps(i)%parent
        k = steps(i)%coordinate
        call step_acceleration(steps(i), [dq(k), ddq(k)], f(3:4, i) - f(3:4, p), slide(:, i), v(1, p), a(:, p), a(:, i))
      end do
    end subroutine find_accelerations
  end subroutine planar_accelerations

  !> A vector in the axes of frame 0, from its components in the plane's axes.
  pure function to_space(planar, x, y, z) result(vector)
    type(planar_plan_type), intent(in) :: planar   !< the plan in planar arithmetic
    real(wp), intent(in) :: x                      !< component along the plane's first axis
    real(wp), intent(in) :: y                      !< component along the plane's second axis
    real(wp), intent(in) :: z                      !< component along the normal
    real(wp) :: vector(3)

    if (planar%in_xy_plane) then
      vector(1) = x
      vector(2) = y
      vector(3) = z
    else
      vector = planar%axes(:, 1)*x + planar%axes(:, 2)*y + planar%axes(:, 3)*z
    end if
  end function to_space

  !> A vector in the plane's axes, from its components in the axes of frame 0.
  pure function to_plane(planar, vector) result(seen)
    type(planar_plan_type), intent(in) :: planar   !< the plan in planar arithmetic
    real(wp), intent(in) :: vector(3)              !< components in the axes of frame 0
    real(wp) :: seen(3)

    seen = vector
    if (.not. planar%in_xy_plane) seen = matmul(vector, planar%axes)
  end function to_plane
end module mech9_planar_motion
