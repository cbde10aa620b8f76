!> A closed chain of a planar mechanism with three unknowns at many positions at once: its equations, their Jacobian, and the motion that
!> keeps it closed. The position is the fastest index and runs innermost.
!>
!> A frame is given by six numbers: cosine, sine, x, y in the plane's axes, from the origin of frame 0, and the velocity of its origin
!> per unit rate, where its step slides. All arrays of the inner procedures have known shapes, so that the compiler keeps their
!> addresses in registers and computes several positions at once.
module mech9_planar_loop
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_step_type, planar_closure_type
  implicit none
  private
  public :: planar_loop_type, turn_on, place_frames, find_residual, find_column, multiply

  !> A closed chain that determines three coordinates by itself.
  type :: planar_loop_type
    integer :: closure = 0                !< number of its closure
    integer :: first_step = 0             !< first step of its block
    integer :: last_step = 0              !< last step of its block
    integer :: unknowns(3) = 0            !< steps of the three unknown coordinates; 0: the block has no unknowns
    integer :: coordinates(3) = 0         !< numbers of these coordinates
    real(wp) :: units(3) = 1.0_wp         !< their units: 1 rad, or the length of the mechanism [m]
    integer, allocatable :: given(:)      !< steps of the loop whose coordinates are known before
    real(wp), allocatable :: signs(:)     !< (M) of each step in the loop: 1 or -1; 0: not in it
  end type planar_loop_type

contains

  !> Turn cosines and sines on by angles of at most a quarter of a radian, by the series of sine and cosine.
  pure subroutine turn_on(n, angle, c, s)
    integer, intent(in) :: n             !< number of positions
    real(wp), intent(in) :: angle(n)     !< [rad]
    real(wp), intent(inout) :: c(n)      !< cosines
    real(wp), intent(inout) :: s(n)      !< sines
    real(wp) :: z, ds, dc, before
    integer :: i

    ! the first terms that are left out are below 1e-17
    do i = 1, n
      z = angle(i)**2
      ds = angle(i)*(1.0_wp - z*(1.0_wp/6.0_wp - z*(1.0_wp/120.0_wp - z*(1.0_wp/5040.0_wp - z*(1.0_wp/362880.0_wp &
           - z*(1.0_wp/39916800.0_wp))))))
      dc = z*(-0.5_wp + z*(1.0_wp/24.0_wp - z*(1.0_wp/720.0_wp - z*(1.0_wp/40320.0_wp - z*(1.0_wp/3628800.0_wp &
           - z*(1.0_wp/479001600.0_wp))))))
      before = c(i)
      c(i) = c(i) + (dc*c(i) - ds*s(i))
      s(i) = s(i) + (dc*s(i) + ds*before)
    end do
  end subroutine turn_on

  !> Poses of the frames first .. last.
  pure subroutine place_frames(n, steps, first, last, q, turn, frames)
    integer, intent(in) :: n                                   !< number of positions
    type(planar_step_type), intent(in) :: steps(:)             !< (M) the steps
    integer, intent(in) :: first                               !< frames from this one
    integer, intent(in) :: last                                !< to this one
    real(wp), intent(in), contiguous :: q(:, :)                !< (room,M) coordinates [rad, m]
    real(wp), intent(in), contiguous :: turn(:, :, :)          !< (room,2,M) cosine and sine of the angle by which each step turns
    real(wp), intent(inout), contiguous :: frames(:, :, 0:)    !< (room,6,0:M) the frames
    integer :: k, p, room

    room = size(frames, 1)
    do k = first, last
      p = steps(k)%parent
      if (steps(k)%turns) then
        call place_turned(n, room, steps(k)%place(1), steps(k)%place(2), frames(:, :, p), turn(:, :, k), frames(:, :, k))
      else
        call place_slid(n, room, steps(k), frames(:, :, p), q(:, steps(k)%coordinate), frames(:, :, k))
      end if
    end do
  end subroutine place_frames

  !> Poses of a frame that is turned against its parent. The poses of the two are separate arguments, so that several can be found at once.
  pure subroutine place_turned(n, lead, x, y, parent, turn, frame)
    integer, intent(in) :: n                    !< number of positions
    integer, intent(in) :: lead                 !< room for so many positions
    real(wp), intent(in) :: x                   !< place of the frame along the parent's first axis [m]
    real(wp), intent(in) :: y                   !< the same along its second axis [m]
    real(wp), intent(in) :: parent(lead, 6)     !< the parent
    real(wp), intent(in) :: turn(lead, 2)       !< cosines and sines of the angle between the two
    real(wp), intent(inout) :: frame(lead, 6)   !< gets the poses
    integer :: i

    do i = 1, n
      frame(i, 1) = parent(i, 1)*turn(i, 1) - parent(i, 2)*turn(i, 2)
      frame(i, 2) = parent(i, 2)*turn(i, 1) + parent(i, 1)*turn(i, 2)
      frame(i, 3) = parent(i, 3) + (parent(i, 1)*x - parent(i, 2)*y)
      frame(i, 4) = parent(i, 4) + (parent(i, 2)*x + parent(i, 1)*y)
    end do
  end subroutine place_turned

  !> Poses of a frame that slides in its parent.
  pure subroutine place_slid(n, lead, step, parent, q, frame)
    integer, intent(in) :: n                        !< number of positions
    integer, intent(in) :: lead                     !< room for so many positions
    type(planar_step_type), intent(in) :: step      !< the step
    real(wp), intent(in) :: parent(lead, 6)         !< the parent
    real(wp), intent(in) :: q(lead)                 !< coordinates of the step [m]
    real(wp), intent(inout) :: frame(lead, 6)       !< gets the poses and the velocity
    real(wp) :: x, y
    integer :: i

    do i = 1, n
      x = step%place(1) + q(i)*step%slide(1)
      y = step%place(2) + q(i)*step%slide(2)
      frame(i, 1) = parent(i, 1)
      frame(i, 2) = parent(i, 2)
      frame(i, 3) = parent(i, 3) + (parent(i, 1)*x - parent(i, 2)*y)
      frame(i, 4) = parent(i, 4) + (parent(i, 2)*x + parent(i, 1)*y)
      frame(i, 5) = parent(i, 1)*step%slide(1) - parent(i, 2)*step%slide(2)
      frame(i, 6) = parent(i, 2)*step%slide(1) + parent(i, 1)*step%slide(2)
    end do
  end subroutine place_slid

  !> The three equations of a closure: the angle, and the displacement at the origin of the base frame in lengths of the mechanism.
  pure subroutine find_residual(n, lead, m, closure, per_length, frames, r)
    integer, intent(in) :: n                             !< number of positions
    integer, intent(in) :: lead                          !< room for so many positions
    integer, intent(in) :: m                             !< number of steps
    type(planar_closure_type), intent(in) :: closure     !< the closure
    real(wp), intent(in) :: per_length                   !< one over the mechanism's size [1/m]
    real(wp), intent(in) :: frames(lead, 6, 0:m)         !< the frames
    real(wp), intent(inout) :: r(lead, 3)                !< gets the equations [rad, lengths of the mechanism]
    real(wp) :: c, s, x, y
    logical :: is_small
    integer :: i, e, t, b

    e = closure%closing
    t = closure%target
    b = closure%base
    is_small = .true.
    do i = 1, n
      c = frames(i, 1, t)*closure%cosine - frames(i, 2, t)*closure%sine
      s = frames(i, 2, t)*closure%cosine + frames(i, 1, t)*closure%sine
      x = c*frames(i, 1, e) + s*frames(i, 2, e)
      y = c*frames(i, 2, e) - s*frames(i, 1, e)
      r(i, 1) = y
      r(i, 2) = x
      is_small = is_small .and. x > 0.0_wp .and. abs(y) < 1.0e-2_wp
    end do
    if (is_small) then
      do i = 1, n
        y = r(i, 1)**2
        r(i, 1) = r(i, 1)*(1.0_wp + y*(1.0_wp/6.0_wp + y*(3.0_wp/40.0_wp + y*(5.0_wp/112.0_wp))))
      end do
    else
      do i = 1, n
        r(i, 1) = atan2(r(i, 1), r(i, 2))
      end do
    end if
    do i = 1, n
      x = frames(i, 3, e) - frames(i, 3, t) - (frames(i, 1, t)*closure%place(1) - frames(i, 2, t)*closure%place(2))
      y = frames(i, 4, e) - frames(i, 4, t) - (frames(i, 2, t)*closure%place(1) + frames(i, 1, t)*closure%place(2))
      r(i, 2) = (x - r(i, 1)*(frames(i, 4, b) - frames(i, 4, e)))*per_length
      r(i, 3) = (y + r(i, 1)*(frames(i, 3, b) - frames(i, 3, e)))*per_length
    end do
  end subroutine find_residual

  !> Derivatives of the three equations by the coordinate of one step.
  pure subroutine find_column(n, lead, step, factors, frame, base, column)
    integer, intent(in) :: n                        !< number of positions
    integer, intent(in) :: lead                     !< room for so many positions
    type(planar_step_type), intent(in) :: step      !< the step
    real(wp), intent(in) :: factors(2)              !< sign of the step in the loop times the unit, and this over the size [1/m]
    real(wp), intent(in) :: frame(lead, 6)          !< the step's frame
    real(wp), intent(in) :: base(lead, 6)           !< the base frame
    real(wp), intent(inout) :: column(lead, 3)      !< gets the derivatives
    real(wp) :: w
    integer :: i

    w = factors(2)
    if (step%turns) then
      w = w*step%turn
      do i = 1, n
        column(i, 1) = factors(1)*step%turn
        column(i, 2) = w*(frame(i, 4) - base(i, 4))
        column(i, 3) = w*(base(i, 3) - frame(i, 3))
      end do
    else
      do i = 1, n
        column(i, 1) = 0.0_wp
        column(i, 2) = w*frame(i, 5)
        column(i, 3) = w*frame(i, 6)
      end do
    end if
  end subroutine find_column

  !> Matrices of three rows times vectors.
  pure subroutine multiply(n, lead, matrix, vector, product)
    integer, intent(in) :: n                           !< number of positions
    integer, intent(in) :: lead                        !< room for so many positions
    real(wp), intent(in) :: matrix(lead, 3, 3)         !< the matrices
    real(wp), intent(in) :: vector(lead, 3)            !< the vectors
    real(wp), intent(inout) :: product(lead, 3)        !< gets the products
    integer :: i, j

    do j = 1, 3
      do i = 1, n
        product(i, j) = matrix(i, j, 1)*vector(i, 1) + matrix(i, j, 2)*vector(i, 2) + matrix(i, j, 3)*vector(i, 3)
      end do
    end do
  end subroutine multiply
end module mech9_planar_loop
