!> Planar arithmetic: poses, velocities and accelerations of frames that keep one normal, and how these look in space.
!>
!> A pose is (cosine, sine, x, y) in frame 0 of the plane; a velocity is the angular velocity about the
!> normal and the velocity of the frame's origin, an acceleration likewise.
module mech9_planar_motion
  use mech9_kinds, only: wp
  use mech9_sine_cosine, only: cosines_and_sines
  use mech9_rotation, only: add_small_angle
  use mech9_planar_plan, only: planar_plan_type, planar_step_type
  use mech9_state, only: planar_motion_type
  use mech9_planar_formulas, only: step_velocity, step_acceleration
  implicit none
  private
  public :: new_planar_motion, place_in_plane, change_in_plane, planar_velocities, planar_accelerations, &
    find_accelerations, to_space, to_plane

contains

  !> Room for frames 0 .. m, all at rest and in place of frame 0.
  pure function new_planar_motion(m) result(motion)
    integer, intent(in) :: m
    type(planar_motion_type) :: motion

    allocate (motion%pose(4, 0:m), motion%angle(m), motion%turn(2, m), motion%slide(2, m), source=0.0_wp)
    allocate (motion%velocity(3, 0:m), motion%acceleration(3, 0:m), source=0.0_wp)
    motion%pose(1, :) = 1.0_wp
    motion%turn(1, :) = 1.0_wp
  end function new_planar_motion

  !> Poses of the frames first .. last.
  pure subroutine place_in_plane(planar, first, last, q, motion)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    real(wp), intent(in), contiguous :: q(:)      !< (M)
    type(planar_motion_type), intent(inout) :: motion

    call find_angles(size(q), planar%steps, first, last, q, motion%angle)
    call cosines_and_sines(last - first + 1, motion%angle(first:last), motion%turn(:, first:last))
    call place(size(q), planar%steps, first, last, q, motion%turn, motion%pose, motion%slide)
  end subroutine place_in_plane

  !> The same after a small change of some coordinates: their angles are turned on, not computed anew.
  pure subroutine change_in_plane(planar, first, last, changed, change, q, motion)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    integer, intent(in) :: changed(:)             !< steps
    real(wp), intent(in) :: change(:)             !< of their coordinates
    real(wp), intent(in), contiguous :: q(:)      !< (M) all coordinates afterwards
    type(planar_motion_type), intent(inout) :: motion
    integer :: i

    do i = 1, size(changed)
      if (planar%steps(changed(i))%turns) &
        call add_small_angle(planar%steps(changed(i))%turn*change(i), motion%turn(:, changed(i)))
    end do
    call place(size(q), planar%steps, first, last, q, motion%turn, motion%pose, motion%slide)
  end subroutine change_in_plane

  ! Arrays of known shape, apart from their types: the compiler then keeps their addresses in registers.

  pure subroutine find_angles(m, steps, first, last, q, angles)
    integer, intent(in) :: m, first, last
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(in) :: q(m)
    real(wp), intent(inout) :: angles(m)
    integer :: i

    do i = first, last
      angles(i) = steps(i)%turn*q(steps(i)%coordinate) + steps(i)%angle
    end do
  end subroutine find_angles

  pure subroutine place(m, steps, first, last, q, cs, f, slide)
    integer, intent(in) :: m, first, last
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(in) :: q(m), cs(2, m)
    real(wp), intent(inout) :: f(4, 0:m), slide(2, m)
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
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    real(wp), intent(in), contiguous :: dq(:)     !< (M)
    type(planar_motion_type), intent(inout) :: motion

    call find_velocities(size(dq), planar%steps, first, last, dq, motion%pose, motion%slide, motion%velocity)
  end subroutine planar_velocities

  pure subroutine find_velocities(m, steps, first, last, dq, f, slide, v)
    integer, intent(in) :: m, first, last
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(in) :: dq(m), f(4, 0:m), slide(2, m)
    real(wp), intent(inout) :: v(3, 0:m)
    integer :: i, p

    do i = first, last
      p = steps(i)%parent
      call step_velocity(steps(i), dq(steps(i)%coordinate), f(3, i) - f(3, p), f(4, i) - f(4, p), slide(:, i), v(:, p), v(:, i))
    end do
  end subroutine find_velocities

  !> Accelerations of the frames first .. last.
  pure subroutine planar_accelerations(planar, first, last, dq, ddq, motion)
    type(planar_plan_type), intent(in) :: planar
    integer, intent(in) :: first, last
    real(wp), intent(in), contiguous :: dq(:), ddq(:)   !< (M)
    type(planar_motion_type), intent(inout) :: motion

    call find_accelerations(size(dq), planar%steps, first, last, dq, ddq, motion%pose, motion%slide, &
                            motion%velocity, motion%acceleration)
  end subroutine planar_accelerations

  !> The same from plain arrays.
  pure subroutine find_accelerations(m, steps, first, last, dq, ddq, f, slide, v, a)
    integer, intent(in) :: m, first, last
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(in) :: dq(m), ddq(m), f(4, 0:m), slide(2, m), v(3, 0:m)
    real(wp), intent(inout) :: a(3, 0:m)
    integer :: i, p

    do i = first, last
      p = steps(i)%parent
      call step_acceleration(steps(i), dq(steps(i)%coordinate), ddq(steps(i)%coordinate), f(3, i) - f(3, p), &
                             f(4, i) - f(4, p), slide(:, i), v(1, p), a(:, p), a(:, i))
    end do
  end subroutine find_accelerations

  !> A vector in the plane's axes, given by its part in the plane and that along the normal, in the axes of frame 0.
  pure function to_space(planar, x, y, z) result(vector)
    type(planar_plan_type), intent(in) :: planar
    real(wp), intent(in) :: x, y, z
    real(wp) :: vector(3)

    if (planar%in_xy_plane) then
      vector(1) = x
      vector(2) = y
      vector(3) = z
    else
      vector = planar%axes(:, 1)*x + planar%axes(:, 2)*y + planar%axes(:, 3)*z
    end if
  end function to_space

  !> A vector in the axes of frame 0, in those of the plane.
  pure function to_plane(planar, vector) result(seen)
    type(planar_plan_type), intent(in) :: planar
    real(wp), intent(in) :: vector(3)
    real(wp) :: seen(3)

    seen = vector
    if (.not. planar%in_xy_plane) seen = matmul(vector, planar%axes)
  end function to_plane
end module mech9_planar_motion
