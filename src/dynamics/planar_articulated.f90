!> Articulated bodies in planar arithmetic: accelerations of open chains whose motion keeps to one plane.
!>
!> The method is that of mech9_articulated_bodies, with wrenches (torque about the normal, force) and motions (dw, dv) in the
!> plane's axes:
!>   torque = J dw + H . dv + torque_0,   force = H dw + M dv + force_0.
module mech9_planar_articulated
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_step_type
  use mech9_planar_lagrange, only: planar_body_type
  implicit none
  private
  public :: planar_work_type, new_planar_work, set_bodies, go_inward, go_outward, pass_inward, pass_outward, &
    add_to_parent

  !> Scratch of the passes, sized once, in the plane's axes. An inertia is (J, Hx, Hy, Mxx, Mxy, Myy) [kg m^2, kg m, kg].
  type :: planar_work_type
    real(wp), allocatable :: applied(:, :)       !< (3,M) wrench of the loads on each frame: to be set before [N m, N]
    real(wp), allocatable :: inertia(:, :)       !< (6,0:M) inertia of all links beyond a step
    real(wp), allocatable :: wrench(:, :)        !< (3,0:M) torque_0 and force_0 [N m, N]
    real(wp), allocatable :: column(:, :)        !< (3,M) U
    real(wp), allocatable :: pivot(:)            !< (M) D
    real(wp), allocatable :: rest(:)             !< (M) Q - S . wrench_0
    real(wp), allocatable :: amount(:, :)        !< (4,0:M) links beyond a step, as if rigid: mass, moment, inertia
    real(wp), allocatable :: motion(:, :)        !< (3,0:M) accelerations less those that rates alone give
  end type planar_work_type

contains

  !> Room for the passes over a number of steps, without loads.
  pure function new_planar_work(m) result(work)
    integer, intent(in) :: m   !< number of steps
    type(planar_work_type) :: work

    allocate (work%applied(3, m), work%column(3, m), work%pivot(m), work%rest(m), source=0.0_wp)
    allocate (work%inertia(6, 0:m), work%wrench(3, 0:m), work%amount(4, 0:m), work%motion(3, 0:m), source=0.0_wp)
  end function new_planar_work

  !> The inertia of each frame's own bodies, and the wrench that these bodies require for the motion by rates alone, less that of
  !> the loads in work%applied and of gravity. Poses and motions are in the plane's axes.
  pure subroutine set_bodies(m, bodies, gravity, f, v, a, work)
    integer, intent(in) :: m                          !< number of steps
    type(planar_body_type), intent(in) :: bodies(:)   !< links with mass or inertia
    real(wp), intent(in) :: gravity(2)                !< acceleration of free fall [m/s^2]
    real(wp), intent(in) :: f(4, 0:m)                 !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: v(3, 0:m)                 !< velocity of each frame [rad/s, m/s]
    real(wp), intent(in) :: a(3, 0:m)                 !< acceleration of each frame that rates alone give [rad/s^2, m/s^2]
    type(planar_work_type), intent(inout) :: work     !< with the loads' wrenches; gets `inertia`, `wrench`, `amount`
    integer :: i

    work%inertia = 0.0_wp
    work%amount = 0.0_wp
    work%wrench(:, 1:) = -work%applied
    do i = 1, size(bodies)
      call add_body(bodies(i), gravity, f(:, bodies(i)%frame), v(:, bodies(i)%frame), a(:, bodies(i)%frame), &
                    work%inertia(:, bodies(i)%frame), work%wrench(:, bodies(i)%frame), work%amount(:, bodies(i)%frame))
    end do
  end subroutine set_bodies

  !> Add a body's inertia about the origin of its frame, and the wrench that the body requires for the motion by rates alone,
  !> less its weight. Vectors are in the plane's axes.
  pure subroutine add_body(body, gravity, f, v, a, inertia, wrench, amount)
    type(planar_body_type), intent(in) :: body   !< the body
    real(wp), intent(in) :: gravity(2)           !< acceleration of free fall [m/s^2]
    real(wp), intent(in) :: f(4)                 !< pose of its frame: cosine, sine, origin [m]
    real(wp), intent(in) :: v(3)                 !< velocity of its frame [rad/s, m/s]
    real(wp), intent(in) :: a(3)                 !< acceleration of its frame that rates alone give [rad/s^2, m/s^2]
    real(wp), intent(inout) :: inertia(6)        !< J, Hx, Hy, Mxx, Mxy, Myy of the frame
    real(wp), intent(inout) :: wrench(3)         !< torque about the frame's origin and force on the frame [N m, N]
    real(wp), intent(inout) :: amount(4)         !< mass, moment and inertia of the frame [kg, kg m, kg m^2]
    real(wp) :: x, y, j, force(2)

    x = f(1)*body%centre(1) - f(2)*body%centre(2)
    y = f(2)*body%centre(1) + f(1)*body%centre(2)
    j = body%inertia + body%mass*(x**2 + y**2)
    inertia(1) = inertia(1) + j
    inertia(2) = inertia(2) - body%mass*y
    inertia(3) = inertia(3) + body%mass*x
    inertia(4) = inertia(4) + body%mass
    inertia(6) = inertia(6) + body%mass
    force(1) = body%mass*(a(2) - a(1)*y - v(1)**2*x - gravity(1))
    force(2) = body%mass*(a(3) + a(1)*x - v(1)**2*y - gravity(2))
    wrench(1) = wrench(1) + body%inertia*a(1) + x*force(2) - y*force(1)
    wrench(2:3) = wrench(2:3) + force
    amount(1) = amount(1) + body%mass
    amount(2) = amount(2) + body%mass*x
    amount(3) = amount(3) + body%mass*y
    amount(4) = amount(4) + j
  end subroutine add_body

  !> Eliminate the accelerations of a run of open steps, the last one first. Vectors are in the plane's axes.
  pure subroutine go_inward(first, last, m, steps, f, slide, forces, inertia, wrench, amount, column, pivot, rest, found)
    integer, intent(in) :: first                     !< first step of the run
    integer, intent(in) :: last                      !< last step of the run
    integer, intent(in) :: m                         !< number of steps of the plan
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: slide(2, m)              !< velocity of each new origin per unit rate
    real(wp), intent(in) :: forces(m)                !< generalized force on each coordinate [N m or N]
    real(wp), intent(inout) :: inertia(6, 0:m)       !< J, H, M of each frame's own bodies; then of all links beyond it too
    real(wp), intent(inout) :: wrench(3, 0:m)        !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(inout) :: amount(4, 0:m)        !< mass, moment and inertia in the same way, as if rigid
    real(wp), intent(inout) :: column(3, m)          !< gets U of each step of the run
    real(wp), intent(inout) :: pivot(m)              !< gets D of each step of the run
    real(wp), intent(inout) :: rest(m)               !< gets Q - S . wrench_0 of each step of the run
    logical, intent(out) :: found                    !< whether all coordinates of the run have inertia
    real(wp) :: u(3), part(3), rigid, s(2)
    integer :: i, p

    found = .true.
    do i = last, first, -1
      p = steps(i)%parent
      rest(i) = forces(steps(i)%coordinate)
      if (steps(i)%turns) then
        u = steps(i)%turn*inertia(1:3, i)
        pivot(i) = steps(i)%turn*u(1)
        rest(i) = rest(i) - steps(i)%turn*wrench(1, i)
        rigid = amount(4, i)
      else
        s = slide(:, i)
        u(1) = inertia(2, i)*s(1) + inertia(3, i)*s(2)
        u(2) = inertia(4, i)*s(1) + inertia(5, i)*s(2)
        u(3) = inertia(5, i)*s(1) + inertia(6, i)*s(2)
        pivot(i) = s(1)*u(2) + s(2)*u(3)
        rest(i) = rest(i) - s(1)*wrench(2, i) - s(2)*wrench(3, i)
        rigid = amount(1, i)*(s(1)**2 + s(2)**2)
      end if
      column(:, i) = u
      ! a pivot within round-off counts as zero, as in the Cholesky factors
      found = pivot(i) > 8.0_wp*m*epsilon(1.0_wp)*rigid
      if (.not. found) return
      if (p == 0) cycle
      part = u*(1.0_wp/pivot(i))
      inertia(1:3, i) = inertia(1:3, i) - u(1)*part
      inertia(4, i) = inertia(4, i) - u(2)*part(2)
      inertia(5, i) = inertia(5, i) - u(2)*part(3)
      inertia(6, i) = inertia(6, i) - u(3)*part(3)
      wrench(:, i) = wrench(:, i) + part*rest(i)
      call add_to_parent(f(3, i) - f(3, p), f(4, i) - f(4, p), inertia(:, i), wrench(:, i), amount(:, i), &
                         inertia(:, p), wrench(:, p), amount(:, p))
    end do
  end subroutine go_inward

  !> Add the inertia and wrench of a frame to those of its parent, about the parent's origin: per unit of dw, the frame's origin
  !> moves by (-y, x). Vectors are in the plane's axes.
  pure subroutine add_to_parent(x, y, inertia, wrench, amount, parent_inertia, parent_wrench, parent_amount)
    real(wp), intent(in) :: x                      !< from the parent's origin to the frame's, along the first axis [m]
    real(wp), intent(in) :: y                      !< the same along the second axis [m]
    real(wp), intent(in) :: inertia(6)             !< J, Hx, Hy, Mxx, Mxy, Myy of the frame
    real(wp), intent(in) :: wrench(3)              !< torque and force on the frame [N m, N]
    real(wp), intent(in) :: amount(4)              !< mass, moment and inertia of the frame
    real(wp), intent(inout) :: parent_inertia(6)   !< J, Hx, Hy, Mxx, Mxy, Myy of the parent
    real(wp), intent(inout) :: parent_wrench(3)    !< torque and force on the parent [N m, N]
    real(wp), intent(inout) :: parent_amount(4)    !< mass, moment and inertia of the parent
    real(wp) :: h(2)

    h(1) = inertia(2) - inertia(4)*y + inertia(5)*x
    h(2) = inertia(3) - inertia(5)*y + inertia(6)*x
    parent_inertia(1) = parent_inertia(1) + inertia(1) - y*(inertia(2) + h(1)) + x*(inertia(3) + h(2))
    parent_inertia(2:3) = parent_inertia(2:3) + h
    parent_inertia(4:6) = parent_inertia(4:6) + inertia(4:6)
    parent_wrench(1) = parent_wrench(1) + wrench(1) - y*wrench(2) + x*wrench(3)
    parent_wrench(2:3) = parent_wrench(2:3) + wrench(2:3)
    parent_amount(1) = parent_amount(1) + amount(1)
    parent_amount(2) = parent_amount(2) + amount(2) + amount(1)*x
    parent_amount(3) = parent_amount(3) + amount(3) + amount(1)*y
    parent_amount(4) = parent_amount(4) + amount(4) + 2.0_wp*(x*amount(2) + y*amount(3)) + amount(1)*(x**2 + y**2)
  end subroutine add_to_parent

  !> Find the accelerations of a run of open steps, the first step first. Vectors are in the plane's axes.
  pure subroutine go_outward(first, last, m, steps, place_of, f, slide, column, pivot, rest, motion, accelerations)
    integer, intent(in) :: first                     !< first step of the run
    integer, intent(in) :: last                      !< last step of the run
    integer, intent(in) :: m                         !< number of steps of the plan
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    integer, intent(in) :: place_of(m)               !< place of a coordinate among the independent ones, or 0
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: slide(2, m)              !< velocity of each new origin per unit rate
    real(wp), intent(in) :: column(3, m)             !< U of each step
    real(wp), intent(in) :: pivot(m)                 !< D of each step
    real(wp), intent(in) :: rest(m)                  !< Q - S . wrench_0 of each step
    real(wp), intent(inout) :: motion(3, 0:m)        !< gets accelerations less those that rates alone give; zero for frame 0
    real(wp), intent(inout) :: accelerations(*)      !< (independent coordinates) gets those of the run [rad/s^2, m/s^2]
    real(wp) :: x, d(3)
    integer :: i, p

    do i = first, last
      p = steps(i)%parent
      d = motion(:, p)
      d(2) = d(2) - d(1)*(f(4, i) - f(4, p))
      d(3) = d(3) + d(1)*(f(3, i) - f(3, p))
      x = (rest(i) - column(1, i)*d(1) - column(2, i)*d(2) - column(3, i)*d(3))/pivot(i)
      accelerations(place_of(steps(i)%coordinate)) = x
      if (steps(i)%turns) then
        d(1) = d(1) + steps(i)%turn*x
      else
        d(2:3) = d(2:3) + slide(:, i)*x
      end if
      motion(:, i) = d
    end do
  end subroutine go_outward

  !> Pass the inertia and the wrench of a run of driven open steps to the parents, the last step first: a step whose acceleration
  !> is given resists like a rigid joint. Vectors are in the plane's axes.
  pure subroutine pass_inward(first, last, m, steps, f, inertia, wrench, amount)
    integer, intent(in) :: first                     !< first step of the run
    integer, intent(in) :: last                      !< last step of the run
    integer, intent(in) :: m                         !< number of steps of the plan
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(inout) :: inertia(6, 0:m)       !< J, H, M of each frame's own bodies; then of all links beyond it too
    real(wp), intent(inout) :: wrench(3, 0:m)        !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(inout) :: amount(4, 0:m)        !< mass, moment and inertia in the same way, as if rigid
    integer :: i, p

    do i = last, first, -1
      p = steps(i)%parent
      if (p == 0) cycle
      call add_to_parent(f(3, i) - f(3, p), f(4, i) - f(4, p), inertia(:, i), wrench(:, i), amount(:, i), &
                         inertia(:, p), wrench(:, p), amount(:, p))
    end do
  end subroutine pass_inward

  !> Move the frames of a run of driven open steps with their parents, the first step first: their own accelerations are among
  !> those that rates and drives give. Vectors are in the plane's axes.
  pure subroutine pass_outward(first, last, m, steps, f, motion)
    integer, intent(in) :: first                     !< first step of the run
    integer, intent(in) :: last                      !< last step of the run
    integer, intent(in) :: m                         !< number of steps of the plan
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(inout) :: motion(3, 0:m)        !< gets accelerations less those that rates and drives give
    integer :: i, p

    do i = first, last
      p = steps(i)%parent
      motion(1, i) = motion(1, p)
      motion(2, i) = motion(2, p) - motion(1, p)*(f(4, i) - f(4, p))
      motion(3, i) = motion(3, p) + motion(1, p)*(f(3, i) - f(3, p))
    end do
  end subroutine pass_outward
end module mech9_planar_articulated
