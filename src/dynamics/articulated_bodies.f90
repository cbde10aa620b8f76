!> Accelerations of open chains by articulated bodies (Featherstone in docs/reference/bibliography.md), without a matrix, in
!> O(links).
!>
!> Lagrange's equations of a mechanism without closed chains are those of Newton and Euler link by link. The links
!> beyond a step, towards the tips, resist a motion (dw, dv) of its frame with a wrench that is linear in it,
!>   torque = J dw + H dv + torque_0,   force = H^T dw + M dv + force_0,
!> about the frame's origin, in fixed axes. A first pass inward eliminates the steps' accelerations from the tips to
!> link 1: with the screw S of a step, U = (J H; H^T M) S and D = S . U,
!>   ddq = (Q - S . wrench_0 - U . (motion of the parent, carried to the origin of this frame)) / D,
!> so that the inertia less U U^T / D passes to the parent. A second pass outward finds the accelerations. The motions
!> (dw, dv) are accelerations less those that rates alone give, so that no other terms of the rates appear.
!>
!> Both passes go over a run of open steps; mech9_cluster_bodies does the same for a closed cluster.
module mech9_articulated_bodies
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, combine, cross
  implicit none
  private
  public :: articulated_type, articulated_work_type, new_articulated, new_articulated_work, add_to_frame, set_bodies, &
    go_inward, go_outward, pass_inward, pass_outward, rigid_inertia, add_to_parent, body_wrench, set_rigid_body, in_fixed_axes

  !> The steps and bodies of a mechanism in the form that the passes use. Indices are the numbers of frames, which are those of
  !> the steps.
  type :: articulated_type
    integer, allocatable :: parent(:)            !< (M) frame from which each step departs, 0 for that of link 1
    integer, allocatable :: coordinate(:)        !< (M) number of the coordinate of each step
    integer, allocatable :: place(:)             !< (M) its place among the independent coordinates, or 0
    logical, allocatable :: slides(:)            !< (M) the frame's origin moves by its own step
    real(wp), allocatable :: mass(:)             !< (M) of the frame's bodies together [kg]
    real(wp), allocatable :: moment(:, :)        !< (3,M) mass times centre, in the frame [kg m]
    real(wp), allocatable :: inertia(:, :, :)    !< (3,3,M) about the frame's origin, in the frame [kg m^2]
  end type articulated_type

  !> Scratch of the passes, sized once, in fixed axes. A wrench is (torque about the frame's origin, force) [N m, N]; a
  !> motion is (angular acceleration, acceleration of the frame's origin) [rad/s^2, m/s^2].
  type :: articulated_work_type
    real(wp), allocatable :: applied(:, :)       !< (6,M) wrench of the loads on each frame: to be set before
    real(wp), allocatable :: inertia(:, :, :)    !< (3,9,0:M) J, H, M side by side [kg m^2, kg m, kg]
    real(wp), allocatable :: wrench(:, :)        !< (6,0:M) torque_0 and force_0
    real(wp), allocatable :: column(:, :)        !< (6,M) U
    real(wp), allocatable :: pivot(:)            !< (M) D
    real(wp), allocatable :: rest(:)             !< (M) Q - S . wrench_0
    real(wp), allocatable :: amount(:, :)        !< (5,0:M) links beyond a step, as if rigid: mass, moment, sum of m r^2
    real(wp), allocatable :: motion(:, :)        !< (6,0:M) accelerations less those that rates alone give
  end type articulated_work_type

contains

  !> A mechanism whose frames have no mass yet; `add_to_frame` gives them mass.
  pure function new_articulated(parent, coordinate, place, slides) result(chains)
    integer, intent(in) :: parent(:)       !< (M) frame from which each step departs
    integer, intent(in) :: coordinate(:)   !< (M) number of the coordinate of each step
    integer, intent(in) :: place(:)        !< (M) its place among the independent coordinates, or 0
    logical, intent(in) :: slides(:)       !< (M) whether the frame's origin moves by its own step
    type(articulated_type) :: chains

    chains%parent = parent
    chains%coordinate = coordinate
    chains%place = place
    chains%slides = slides
    allocate (chains%mass(size(parent)), chains%moment(3, size(parent)), chains%inertia(3, 3, size(parent)), source=0.0_wp)
  end function new_articulated

  !> Room for the passes over a number of steps, without loads.
  pure function new_articulated_work(m) result(work)
    integer, intent(in) :: m   !< number of steps
    type(articulated_work_type) :: work

    allocate (work%applied(6, m), work%column(6, m), work%pivot(m), work%rest(m), source=0.0_wp)
    allocate (work%inertia(3, 9, 0:m), work%wrench(6, 0:m), work%amount(5, 0:m), work%motion(6, 0:m), source=0.0_wp)
  end function new_articulated_work

  !> Add the mass and inertia of a body to the frame with which it moves.
  pure subroutine add_to_frame(chains, frame, mass, centre, inertia)
    type(articulated_type), intent(inout) :: chains   !< the mechanism
    integer, intent(in) :: frame                      !< number of the frame
    real(wp), intent(in) :: mass                      !< of the body [kg]
    real(wp), intent(in) :: centre(3)                 !< mass centre, from the frame's origin, in the frame's axes [m]
    real(wp), intent(in) :: inertia(3, 3)             !< tensor about the centre, in the frame's axes [kg m^2]
    integer :: i

    chains%mass(frame) = chains%mass(frame) + mass
    chains%moment(:, frame) = chains%moment(:, frame) + mass*centre
    associate (total => chains%inertia(:, :, frame))
      do i = 1, 3
        total(:, i) = total(:, i) + inertia(:, i) - mass*centre*centre(i)
        total(i, i) = total(i, i) + mass*dot_product(centre, centre)
      end do
    end associate
  end subroutine add_to_frame

  !> The inertia of the own bodies of each marked frame in fixed axes, and the wrench that these bodies require for the motion by
  !> rates alone, less that of the loads and of gravity.
  pure subroutine set_bodies(m, marked, mass, moment, tensor, gravity, r, omega, alpha, a, applied, inertia, wrench, amount)
    integer, intent(in) :: m                        !< number of steps
    logical, intent(in) :: marked(0:m)              !< the frames
    real(wp), intent(in) :: mass(m)                 !< of the bodies of each frame together [kg]
    real(wp), intent(in) :: moment(3, m)            !< mass times centre, in the frame's axes [kg m]
    real(wp), intent(in) :: tensor(3, 3, m)         !< inertia about the frame's origin, in its axes [kg m^2]
    real(wp), intent(in) :: gravity(3)              !< acceleration of free fall, fixed axes [m/s^2]
    real(wp), intent(in) :: r(3, 3, 0:m)            !< rotation of each frame
    real(wp), intent(in) :: omega(3, 0:m)           !< angular velocity of each frame, fixed axes [rad/s]
    real(wp), intent(in) :: alpha(3, 0:m)           !< angular acceleration that rates alone give, fixed axes [rad/s^2]
    real(wp), intent(in) :: a(3, 0:m)               !< acceleration of each origin that rates alone give, fixed axes [m/s^2]
    real(wp), intent(in) :: applied(6, m)           !< wrench of the loads on each frame, fixed axes [N m, N]
    real(wp), intent(inout) :: inertia(3, 9, 0:m)   !< gets J, H, M of each frame but 0
    real(wp), intent(inout) :: wrench(6, 0:m)       !< gets the wrench of each frame but 0
    real(wp), intent(inout) :: amount(5, 0:m)       !< gets mass, moment and sum of m r^2 of each frame but 0
    real(wp) :: h(3), j(3, 3)
    integer :: s

    do s = 1, m
      if (.not. marked(s)) cycle
      if (mass(s) > 0.0_wp .or. tensor(1, 1, s) + tensor(2, 2, s) + tensor(3, 3, s) > 0.0_wp) then
        h = turn(r(:, :, s), moment(:, s))
        j = in_fixed_axes(r(:, :, s), tensor(:, :, s))
        call set_rigid_body(mass(s), h, j, inertia(:, :, s), amount(:, s))
        call body_wrench(mass(s), h, j, omega(:, s), alpha(:, s), a(:, s) - gravity, wrench(:, s))
        wrench(:, s) = wrench(:, s) - applied(:, s)
      else
        wrench(:, s) = -applied(:, s)
        amount(:, s) = 0.0_wp
        inertia(:, :, s) = 0.0_wp
      end if
    end do
  end subroutine set_bodies

  !> The inertia J, H, M and the amount of a rigid body.
  pure subroutine set_rigid_body(mass, h, j, inertia, amount)
    real(wp), intent(in) :: mass            !< of the body [kg]
    real(wp), intent(in) :: h(3)            !< mass times centre, fixed axes [kg m]
    real(wp), intent(in) :: j(3, 3)         !< inertia about the frame's origin, fixed axes [kg m^2]
    real(wp), intent(out) :: inertia(3, 9)  !< J, H, M, fixed axes
    real(wp), intent(out) :: amount(5)      !< mass, moment and sum of m r^2
    integer :: i

    inertia(:, 1:3) = j
    ! a motion dv requires the torque h x dv
    inertia(:, 4) = [0.0_wp, h(3), -h(2)]
    inertia(:, 5) = [-h(3), 0.0_wp, h(1)]
    inertia(:, 6) = [h(2), -h(1), 0.0_wp]
    inertia(:, 7:9) = 0.0_wp
    do i = 1, 3
      inertia(i, 6 + i) = mass
    end do
    amount(1) = mass
    amount(2:4) = h
    amount(5) = 0.5_wp*(j(1, 1) + j(2, 2) + j(3, 3))
  end subroutine set_rigid_body

  !> The wrench that a rigid body requires for a motion, about the origin of its frame:
  !>   torque = h x a + J alpha + omega x J omega,   force = m a + alpha x h + omega x (omega x h).
  !> All vectors are in the same axes.
  pure subroutine body_wrench(mass, h, j, omega, alpha, proper, wrench)
    real(wp), intent(in) :: mass         !< of the body [kg]
    real(wp), intent(in) :: h(3)         !< mass times centre [kg m]
    real(wp), intent(in) :: j(3, 3)      !< inertia about the frame's origin [kg m^2]
    real(wp), intent(in) :: omega(3)     !< angular velocity [rad/s]
    real(wp), intent(in) :: alpha(3)     !< angular acceleration [rad/s^2]
    real(wp), intent(in) :: proper(3)    !< proper acceleration of the frame's origin: less that of free fall [m/s^2]
    real(wp), intent(out) :: wrench(6)   !< torque and force [N m, N]
    real(wp) :: spin(3), change(3), along, square

    ! written out, because calls of `cross` would cost as much as their arithmetic
    spin = j(:, 1)*omega(1) + j(:, 2)*omega(2) + j(:, 3)*omega(3)
    change = j(:, 1)*alpha(1) + j(:, 2)*alpha(2) + j(:, 3)*alpha(3)
    along = omega(1)*h(1) + omega(2)*h(2) + omega(3)*h(3)
    square = omega(1)**2 + omega(2)**2 + omega(3)**2
    wrench(1) = h(2)*proper(3) - h(3)*proper(2) + change(1) + omega(2)*spin(3) - omega(3)*spin(2)
    wrench(2) = h(3)*proper(1) - h(1)*proper(3) + change(2) + omega(3)*spin(1) - omega(1)*spin(3)
    wrench(3) = h(1)*proper(2) - h(2)*proper(1) + change(3) + omega(1)*spin(2) - omega(2)*spin(1)
    wrench(4) = mass*proper(1) + alpha(2)*h(3) - alpha(3)*h(2) + omega(1)*along - square*h(1)
    wrench(5) = mass*proper(2) + alpha(3)*h(1) - alpha(1)*h(3) + omega(2)*along - square*h(2)
    wrench(6) = mass*proper(3) + alpha(1)*h(2) - alpha(2)*h(1) + omega(3)*along - square*h(3)
  end subroutine body_wrench

  !> The tensor r t r^T, by its lower triangle.
  pure function in_fixed_axes(r, t) result(turned)
    real(wp), intent(in) :: r(3, 3)   !< rotation of the frame
    real(wp), intent(in) :: t(3, 3)   !< symmetric tensor in the frame's axes
    real(wp) :: turned(3, 3)          !< the tensor in fixed axes
    real(wp) :: half(3, 3)
    integer :: i, k

    half = combine(r, t)
    do k = 1, 3
      do i = k, 3
        turned(i, k) = half(i, 1)*r(k, 1) + half(i, 2)*r(k, 2) + half(i, 3)*r(k, 3)
        turned(k, i) = turned(i, k)
      end do
    end do
  end function in_fixed_axes

  !> Eliminate the accelerations of a run of open steps, the last one first. All vectors are in fixed axes.
  pure subroutine go_inward(first, last, m, parent, coordinate, slides, p, axis_w, axis_v, forces, inertia, wrench, amount, &
                            column, pivot, rest, found)
    integer, intent(in) :: first                    !< first step of the run
    integer, intent(in) :: last                     !< last step of the run
    integer, intent(in) :: m                        !< number of steps of the plan
    integer, intent(in) :: parent(m)                !< frame from which each step departs
    integer, intent(in) :: coordinate(m)            !< number of the coordinate of each step
    logical, intent(in) :: slides(m)                !< whether the frame's origin moves by its own step
    real(wp), intent(in) :: p(3, 0:m)               !< origin of each frame [m]
    real(wp), intent(in) :: axis_w(3, m)            !< angular velocity that each step gives per unit rate
    real(wp), intent(in) :: axis_v(3, m)            !< velocity of the new origin per unit rate
    real(wp), intent(in) :: forces(m)               !< generalized force on each coordinate [N m or N]
    real(wp), intent(inout) :: inertia(3, 9, 0:m)   !< J, H, M of each frame's own bodies; then of all links beyond it too
    real(wp), intent(inout) :: wrench(6, 0:m)       !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(inout) :: amount(5, 0:m)       !< mass, moment and sum of m r^2 in the same way, as if rigid
    real(wp), intent(inout) :: column(6, m)         !< gets U of each step of the run
    real(wp), intent(inout) :: pivot(m)             !< gets D of each step of the run
    real(wp), intent(inout) :: rest(m)              !< gets Q - S . wrench_0 of each step of the run
    logical, intent(out) :: found                   !< whether all coordinates of the run have inertia
    real(wp) :: u(6), part(6), arm(3)
    integer :: s, i

    found = .true.
    do s = last, first, -1
      u(1:3) = turn(inertia(:, 1:3, s), axis_w(:, s))
      u(4:6) = turn_back(inertia(:, 4:6, s), axis_w(:, s))
      rest(s) = forces(coordinate(s)) - dot_product(axis_w(:, s), wrench(1:3, s))
      pivot(s) = dot_product(axis_w(:, s), u(1:3))
      if (slides(s)) then
        u(1:3) = u(1:3) + turn(inertia(:, 4:6, s), axis_v(:, s))
        u(4:6) = u(4:6) + turn(inertia(:, 7:9, s), axis_v(:, s))
        rest(s) = rest(s) - dot_product(axis_v(:, s), wrench(4:6, s))
        pivot(s) = dot_product(axis_w(:, s), u(1:3)) + dot_product(axis_v(:, s), u(4:6))
      end if
      column(:, s) = u
      ! a pivot within round-off counts as zero, as in the Cholesky factors
      found = pivot(s) > 8.0_wp*m*epsilon(1.0_wp)*rigid_inertia(amount(:, s), axis_w(:, s), axis_v(:, s))
      if (.not. found) return
      if (parent(s) == 0) cycle
      part = u*(1.0_wp/pivot(s))
      do i = 1, 3
        inertia(:, i, s) = inertia(:, i, s) - u(1:3)*part(i)
        inertia(:, 3 + i, s) = inertia(:, 3 + i, s) - u(1:3)*part(3 + i)
        inertia(:, 6 + i, s) = inertia(:, 6 + i, s) - u(4:6)*part(3 + i)
      end do
      wrench(:, s) = wrench(:, s) + part*rest(s)
      arm = p(:, s) - p(:, parent(s))
      call add_to_parent(arm, inertia(:, :, s), wrench(:, s), amount(:, s), inertia(:, :, parent(s)), &
                         wrench(:, parent(s)), amount(:, parent(s)))
    end do
  end subroutine go_inward

  !> An upper bound of the inertia about a screw of all links that it moves, as if rigid: the measure of round-off in a pivot.
  pure real(wp) function rigid_inertia(amount, w, v)
    real(wp), intent(in) :: amount(5)   !< mass, moment and sum of m r^2 about the frame's origin, fixed axes [kg, kg m, kg m^2]
    real(wp), intent(in) :: w(3)        !< angular velocity of the screw per unit rate, fixed axes
    real(wp), intent(in) :: v(3)        !< velocity of the frame's origin per unit rate, fixed axes

    rigid_inertia = dot_product(w, w)*amount(5) + dot_product(v, v)*amount(1) &
                    + 2.0_wp*abs(dot_product(v, cross(w, amount(2:4))))
  end function rigid_inertia

  !> Add the inertia and wrench of a frame to those of its parent, about the parent's origin:
  !> J' = J + [arm] H'^T - H [arm], H' = H + [arm] M. All vectors are in fixed axes.
  pure subroutine add_to_parent(arm, inertia, wrench, amount, parent_inertia, parent_wrench, parent_amount)
    real(wp), intent(in) :: arm(3)                    !< from the parent's origin to the frame's [m]
    real(wp), intent(in) :: inertia(3, 9)             !< J, H, M of the frame
    real(wp), intent(in) :: wrench(6)                 !< torque and force on the frame [N m, N]
    real(wp), intent(in) :: amount(5)                 !< mass, moment and sum of m r^2 of the frame
    real(wp), intent(inout) :: parent_inertia(3, 9)   !< J, H, M of the parent
    real(wp), intent(inout) :: parent_wrench(6)       !< torque and force on the parent [N m, N]
    real(wp), intent(inout) :: parent_amount(5)       !< mass, moment and sum of m r^2 of the parent
    real(wp) :: h(3, 3), j(3, 3)
    integer :: i

    ! written out, because a call of `cross` for each column would cost as much as its arithmetic
    do i = 1, 3
      h(1, i) = inertia(1, 3 + i) + (arm(2)*inertia(3, 6 + i) - arm(3)*inertia(2, 6 + i))
      h(2, i) = inertia(2, 3 + i) + (arm(3)*inertia(1, 6 + i) - arm(1)*inertia(3, 6 + i))
      h(3, i) = inertia(3, 3 + i) + (arm(1)*inertia(2, 6 + i) - arm(2)*inertia(1, 6 + i))
    end do
    do i = 1, 3
      j(1, i) = inertia(1, i) + (arm(2)*h(i, 3) - arm(3)*h(i, 2))
      j(2, i) = inertia(2, i) + (arm(3)*h(i, 1) - arm(1)*h(i, 3))
      j(3, i) = inertia(3, i) + (arm(1)*h(i, 2) - arm(2)*h(i, 1))
    end do
    j(:, 1) = j(:, 1) + arm(2)*inertia(:, 6) - arm(3)*inertia(:, 5)
    j(:, 2) = j(:, 2) + arm(3)*inertia(:, 4) - arm(1)*inertia(:, 6)
    j(:, 3) = j(:, 3) + arm(1)*inertia(:, 5) - arm(2)*inertia(:, 4)
    parent_inertia(:, 1:3) = parent_inertia(:, 1:3) + j
    parent_inertia(:, 4:6) = parent_inertia(:, 4:6) + h
    parent_inertia(:, 7:9) = parent_inertia(:, 7:9) + inertia(:, 7:9)
    parent_wrench(1:3) = parent_wrench(1:3) + wrench(1:3) + cross(arm, wrench(4:6))
    parent_wrench(4:6) = parent_wrench(4:6) + wrench(4:6)
    parent_amount(1) = parent_amount(1) + amount(1)
    parent_amount(2:4) = parent_amount(2:4) + amount(2:4) + amount(1)*arm
    parent_amount(5) = parent_amount(5) + amount(5) + 2.0_wp*dot_product(arm, amount(2:4)) + amount(1)*dot_product(arm, arm)
  end subroutine add_to_parent

  !> Find the accelerations of a run of open steps, the first step first. All vectors are in fixed axes.
  pure subroutine go_outward(first, last, m, parent, place, p, axis_w, axis_v, column, pivot, rest, motion, accelerations)
    integer, intent(in) :: first                !< first step of the run
    integer, intent(in) :: last                 !< last step of the run
    integer, intent(in) :: m                    !< number of steps of the plan
    integer, intent(in) :: parent(m)            !< frame from which each step departs
    integer, intent(in) :: place(m)             !< place of each step's coordinate among the independent ones
    real(wp), intent(in) :: p(3, 0:m)           !< origin of each frame [m]
    real(wp), intent(in) :: axis_w(3, m)        !< angular velocity that each step gives per unit rate
    real(wp), intent(in) :: axis_v(3, m)        !< velocity of the new origin per unit rate
    real(wp), intent(in) :: column(6, m)        !< U of each step
    real(wp), intent(in) :: pivot(m)            !< D of each step
    real(wp), intent(in) :: rest(m)             !< Q - S . wrench_0 of each step
    real(wp), intent(inout) :: motion(6, 0:m)   !< gets accelerations less those that rates alone give; zero for frame 0
    real(wp), intent(inout) :: accelerations(*)   !< (independent coordinates) gets those of the run [rad/s^2, m/s^2]
    real(wp) :: dw(3), dv(3), x
    integer :: s

    do s = first, last
      dw = motion(1:3, parent(s))
      dv = motion(4:6, parent(s)) + cross(dw, p(:, s) - p(:, parent(s)))
      x = (rest(s) - dot_product(column(1:3, s), dw) - dot_product(column(4:6, s), dv))/pivot(s)
      accelerations(place(s)) = x
      motion(1:3, s) = dw + x*axis_w(:, s)
      motion(4:6, s) = dv + x*axis_v(:, s)
    end do
  end subroutine go_outward

  !> Pass the inertia and the wrench of a run of driven open steps to the parents, the last step first: a step whose acceleration
  !> is given resists like a rigid joint. All vectors are in fixed axes.
  pure subroutine pass_inward(first, last, m, parent, p, inertia, wrench, amount)
    integer, intent(in) :: first                    !< first step of the run
    integer, intent(in) :: last                     !< last step of the run
    integer, intent(in) :: m                        !< number of steps of the plan
    integer, intent(in) :: parent(m)                !< frame from which each step departs
    real(wp), intent(in) :: p(3, 0:m)               !< origin of each frame [m]
    real(wp), intent(inout) :: inertia(3, 9, 0:m)   !< J, H, M of each frame's own bodies; then of all links beyond it too
    real(wp), intent(inout) :: wrench(6, 0:m)       !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(inout) :: amount(5, 0:m)       !< mass, moment and sum of m r^2 in the same way, as if rigid
    integer :: s

    do s = last, first, -1
      if (parent(s) == 0) cycle
      call add_to_parent(p(:, s) - p(:, parent(s)), inertia(:, :, s), wrench(:, s), amount(:, s), inertia(:, :, parent(s)), &
                         wrench(:, parent(s)), amount(:, parent(s)))
    end do
  end subroutine pass_inward

  !> Move the frames of a run of driven open steps with their parents, the first step first: their own accelerations are among
  !> those that rates and drives give. All vectors are in fixed axes.
  pure subroutine pass_outward(first, last, m, parent, p, motion)
    integer, intent(in) :: first                    !< first step of the run
    integer, intent(in) :: last                     !< last step of the run
    integer, intent(in) :: m                        !< number of steps of the plan
    integer, intent(in) :: parent(m)                !< frame from which each step departs
    real(wp), intent(in) :: p(3, 0:m)               !< origin of each frame [m]
    real(wp), intent(inout) :: motion(6, 0:m)       !< gets accelerations less those that rates and drives give
    integer :: s

    do s = first, last
      motion(1:3, s) = motion(1:3, parent(s))
      motion(4:6, s) = motion(4:6, parent(s)) + cross(motion(1:3, parent(s)), p(:, s) - p(:, parent(s)))
    end do
  end subroutine pass_outward
end module mech9_articulated_bodies
