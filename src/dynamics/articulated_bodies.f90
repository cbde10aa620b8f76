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
  use mech9_state, only: state_type
  implicit none
  private
  public :: rigid_body_type, articulated_body_type, chain_step_type, articulated_type, articulated_work_type, new_articulated, &
    new_articulated_work, add_to_rigid_body, set_bodies, go_inward, go_outward, pass_inward, pass_outward, rigid_inertia, &
    add_to_parent, body_wrench, set_rigid_body, in_fixed_axes

  !> Bodies that move with one frame, together, in its axes.
  type :: rigid_body_type
    real(wp) :: mass = 0.0_wp          !< [kg]
    real(wp) :: moment(3) = 0.0_wp     !< mass times centre, from the frame's origin [kg m]
    real(wp) :: tensor(3, 3) = 0.0_wp  !< inertia about the frame's origin [kg m^2]
  end type rigid_body_type

  !> All links beyond a step as one body that resists a motion of the step's frame, in fixed axes.
  type :: articulated_body_type
    real(wp) :: inertia(3, 9) = 0.0_wp   !< J, H, M side by side [kg m^2, kg m, kg]
    real(wp) :: wrench(6) = 0.0_wp       !< torque_0 about the frame's origin, and force_0 [N m, N]
    real(wp) :: amount(5) = 0.0_wp       !< as if rigid: mass, moment, sum of m r^2 [kg, kg m, kg m^2]
  end type articulated_body_type

  !> A step whose acceleration is eliminated.
  type :: eliminated_step_type
    real(wp) :: column(6) = 0.0_wp   !< U
    real(wp) :: pivot = 0.0_wp       !< D
    real(wp) :: rest = 0.0_wp        !< Q - S . wrench_0
  end type eliminated_step_type

  !> A step as the passes use it.
  type :: chain_step_type
    integer :: parent = 0         !< frame from which the step departs, 0 for that of link 1
    integer :: coordinate = 0     !< number of its coordinate
    integer :: place = 0          !< place of the coordinate among the independent ones, or 0
    logical :: slides = .false.   !< the frame's origin moves by its own step
  end type chain_step_type

  !> The steps and bodies of a mechanism in the form that the passes use. Indices are the numbers of frames, which are those of
  !> the steps.
  type :: articulated_type
    type(chain_step_type), allocatable :: steps(:)    !< (M)
    type(rigid_body_type), allocatable :: bodies(:)   !< (M) those of each frame
  end type articulated_type

  !> Scratch of the passes, sized once, in fixed axes. A wrench is (torque about the frame's origin, force) [N m, N]; a
  !> motion is (angular acceleration, acceleration of the frame's origin) [rad/s^2, m/s^2].
  type :: articulated_work_type
    real(wp), allocatable :: applied(:, :)                  !< (6,M) wrench of the loads on each frame: to be set before
    type(articulated_body_type), allocatable :: bodies(:)   !< (0:M) the frame's own bodies, then with all links beyond it
    type(eliminated_step_type), allocatable :: steps(:)     !< (M)
    real(wp), allocatable :: motion(:, :)                   !< (6,0:M) accelerations less those that rates alone give
  end type articulated_work_type

contains

  !> A mechanism whose frames have no mass yet; `add_to_rigid_body` gives them mass.
  pure function new_articulated(steps) result(chains)
    type(chain_step_type), intent(in) :: steps(:)   !< (M) its steps
    type(articulated_type) :: chains

    chains%steps = steps
    allocate (chains%bodies(size(steps)))
  end function new_articulated

  !> Room for the passes over a number of steps, without loads.
  pure function new_articulated_work(m) result(work)
    integer, intent(in) :: m   !< number of steps
    type(articulated_work_type) :: work

    allocate (work%bodies(0:m), work%steps(m))
    allocate (work%applied(6, m), work%motion(6, 0:m), source=0.0_wp)
  end function new_articulated_work

  !> Add the mass and inertia of a body to those that move with its frame.
  pure subroutine add_to_rigid_body(total, mass, centre, inertia)
    type(rigid_body_type), intent(inout) :: total   !< the bodies of the frame
    real(wp), intent(in) :: mass                    !< of the body [kg]
    real(wp), intent(in) :: centre(3)               !< mass centre, from the frame's origin, in the frame's axes [m]
    real(wp), intent(in) :: inertia(3, 3)           !< tensor about the centre, in the frame's axes [kg m^2]
    integer :: i

    total%mass = total%mass + mass
    total%moment = total%moment + mass*centre
    do i = 1, 3
      total%tensor(:, i) = total%tensor(:, i) + inertia(:, i) - mass*centre*centre(i)
      total%tensor(i, i) = total%tensor(i, i) + mass*dot_product(centre, centre)
    end do
  end subroutine add_to_rigid_body

  !> The inertia of the own bodies of each marked frame in fixed axes, and the wrench that these bodies require for the motion by
  !> rates alone, less that of the loads and of gravity.
  pure subroutine set_bodies(bodies, marked, gravity, state, work)
    type(rigid_body_type), intent(in), contiguous :: bodies(:)   !< (M) those of each frame
    logical, intent(in) :: marked(0:*)                   !< the frames
    real(wp), intent(in) :: gravity(3)                   !< acceleration of free fall, fixed axes [m/s^2]
    type(state_type), intent(in) :: state                !< with the accelerations that rates alone give
    type(articulated_work_type), intent(inout) :: work   !< with the loads' wrenches; gets the bodies of each frame but 0
    integer :: m

    m = size(bodies)
    call set_each(bodies, state%r, state%omega, state%alpha, state%a, work%applied, work%bodies)

  contains

    !> The same from plain arrays.
    pure subroutine set_each(bodies, r, omega, alpha, a, applied, resisting)
      type(rigid_body_type), intent(in) :: bodies(m)                    !< those of each frame
      real(wp), intent(in) :: r(3, 3, 0:*)                              !< (3,3,0:M) rotation of each frame, to fixed axes [1]
      real(wp), intent(in) :: omega(3, 0:*)                             !< angular velocity of each frame, fixed axes [rad/s]
      real(wp), intent(in) :: alpha(3, 0:*)                             !< angular acceleration that rates alone give [rad/s^2]
      real(wp), intent(in) :: a(3, 0:*)                                 !< acceleration of each origin that rates alone give [m/s^2]
      real(wp), intent(in) :: applied(6, *)                             !< wrench of the loads on each frame [N m, N]
      type(articulated_body_type), intent(inout) :: resisting(0:*)      !< gets these of each frame but 0
      real(wp) :: h(3), j(3, 3)
      integer :: s

      do s = 1, m
        if (.not. marked(s)) cycle
        associate (own => bodies(s), body => resisting(s))
          if (own%mass > 0.0_wp .or. own%tensor(1, 1) + own%tensor(2, 2) + own%tensor(3, 3) > 0.0_wp) then
            h = turn(r(:, :, s), own%moment)
            j = in_fixed_axes(r(:, :, s), own%tensor)
            call set_rigid_body(own%mass, h, j, body%inertia, body%amount)
            call body_wrench(own%mass, h, j, omega(:, s), alpha(:, s), a(:, s) - gravity, body%wrench)
            body%wrench = body%wrench - applied(:, s)
          else
            body%wrench = -applied(:, s)
            body%amount = 0.0_wp
            body%inertia = 0.0_wp
          end if
        end associate
      end do
    end subroutine set_each
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
  pure subroutine go_inward(first, last, steps, state, forces, work, found)
    integer, intent(in) :: first                         !< first step of the run
    integer, intent(in) :: last                          !< last step of the run
    type(chain_step_type), intent(in), contiguous :: steps(:)   !< (M) the steps of the plan
    type(state_type), intent(in) :: state                !< with origins of the frames and screws of the steps
    real(wp), intent(in) :: forces(*)                    !< (M) generalized force on each coordinate [N m or N]
    type(articulated_work_type), intent(inout) :: work   !< with the bodies of the frames; gets the steps of the run
    logical, intent(out) :: found                        !< whether all coordinates of the run have inertia
    real(wp) :: round_off

    ! a pivot within round-off counts as zero, as in the Cholesky factors
    round_off = 8.0_wp*size(steps)*epsilon(1.0_wp)
    call eliminate(steps, state%p, state%axis_w, state%axis_v, work%bodies, work%steps, found)

  contains

    !> The same from plain arrays.
    pure subroutine eliminate(steps, p, axis_w, axis_v, bodies, eliminated, found)
      type(chain_step_type), intent(in) :: steps(*)                  !< the steps of the plan
      real(wp), intent(in) :: p(3, 0:*)                              !< origin of each frame [m]
      real(wp), intent(in) :: axis_w(3, *)                           !< (3,M) angular velocity that each step gives per unit rate, fixed axes [1, rad/m]
      real(wp), intent(in) :: axis_v(3, *)                           !< (3,M) velocity of the new origin per unit rate, fixed axes [m/rad, 1]
      type(articulated_body_type), intent(inout) :: bodies(0:*)      !< each frame's own bodies; then with all links beyond it
      type(eliminated_step_type), intent(inout) :: eliminated(*)     !< gets the steps of the run
      logical, intent(out) :: found                                  !< whether all coordinates of the run have inertia
      real(wp) :: u(6), part(6)
      integer :: s, i

      found = .true.
      do s = last, first, -1
        associate (step => steps(s), body => bodies(s))
          u(1:3) = turn(body%inertia(:, 1:3), axis_w(:, s))
          u(4:6) = turn_back(body%inertia(:, 4:6), axis_w(:, s))
          eliminated(s)%rest = forces(step%coordinate) - dot_product(axis_w(:, s), body%wrench(1:3))
          eliminated(s)%pivot = dot_product(axis_w(:, s), u(1:3))
          if (step%slides) then
            u(1:3) = u(1:3) + turn(body%inertia(:, 4:6), axis_v(:, s))
            u(4:6) = u(4:6) + turn(body%inertia(:, 7:9), axis_v(:, s))
            eliminated(s)%rest = eliminated(s)%rest - dot_product(axis_v(:, s), body%wrench(4:6))
            eliminated(s)%pivot = dot_product(axis_w(:, s), u(1:3)) + dot_product(axis_v(:, s), u(4:6))
          end if
          eliminated(s)%column = u
          found = eliminated(s)%pivot > round_off*rigid_inertia(body%amount, axis_w(:, s), axis_v(:, s))
          if (.not. found) return
          if (step%parent == 0) cycle
          part = u*(1.0_wp/eliminated(s)%pivot)
          do i = 1, 3
            body%inertia(:, i) = body%inertia(:, i) - u(1:3)*part(i)
            body%inertia(:, 3 + i) = body%inertia(:, 3 + i) - u(1:3)*part(3 + i)
            body%inertia(:, 6 + i) = body%inertia(:, 6 + i) - u(4:6)*part(3 + i)
          end do
          body%wrench = body%wrench + part*eliminated(s)%rest
          call add_to_parent(p(:, s) - p(:, step%parent), bodies(s), bodies(step%parent))
        end associate
      end do
    end subroutine eliminate
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
  pure subroutine add_to_parent(arm, body, parent)
    real(wp), intent(in) :: arm(3)                         !< from the parent's origin to the frame's [m]
    type(articulated_body_type), intent(in) :: body        !< the frame with all links beyond it
    type(articulated_body_type), intent(inout) :: parent   !< the parent alike; grows
    real(wp) :: h(3, 3), j(3, 3)
    integer :: i

    ! written out, because a call of `cross` for each column would cost as much as its arithmetic
    do i = 1, 3
      h(1, i) = body%inertia(1, 3 + i) + (arm(2)*body%inertia(3, 6 + i) - arm(3)*body%inertia(2, 6 + i))
      h(2, i) = body%inertia(2, 3 + i) + (arm(3)*body%inertia(1, 6 + i) - arm(1)*body%inertia(3, 6 + i))
      h(3, i) = body%inertia(3, 3 + i) + (arm(1)*body%inertia(2, 6 + i) - arm(2)*body%inertia(1, 6 + i))
    end do
    do i = 1, 3
      j(1, i) = body%inertia(1, i) + (arm(2)*h(i, 3) - arm(3)*h(i, 2))
      j(2, i) = body%inertia(2, i) + (arm(3)*h(i, 1) - arm(1)*h(i, 3))
      j(3, i) = body%inertia(3, i) + (arm(1)*h(i, 2) - arm(2)*h(i, 1))
    end do
    j(:, 1) = j(:, 1) + arm(2)*body%inertia(:, 6) - arm(3)*body%inertia(:, 5)
    j(:, 2) = j(:, 2) + arm(3)*body%inertia(:, 4) - arm(1)*body%inertia(:, 6)
    j(:, 3) = j(:, 3) + arm(1)*body%inertia(:, 5) - arm(2)*body%inertia(:, 4)
    parent%inertia(:, 1:3) = parent%inertia(:, 1:3) + j
    parent%inertia(:, 4:6) = parent%inertia(:, 4:6) + h
    parent%inertia(:, 7:9) = parent%inertia(:, 7:9) + body%inertia(:, 7:9)
    parent%wrench(1:3) = parent%wrench(1:3) + body%wrench(1:3) + cross(arm, body%wrench(4:6))
    parent%wrench(4:6) = parent%wrench(4:6) + body%wrench(4:6)
    parent%amount(1) = parent%amount(1) + body%amount(1)
    parent%amount(2:4) = parent%amount(2:4) + body%amount(2:4) + body%amount(1)*arm
    parent%amount(5) = parent%amount(5) + body%amount(5) + 2.0_wp*dot_product(arm, body%amount(2:4)) &
                       + body%amount(1)*dot_product(arm, arm)
  end subroutine add_to_parent

  !> Find the accelerations of a run of open steps, the first step first. All vectors are in fixed axes.
  pure subroutine go_outward(first, last, steps, state, work, accelerations)
    integer, intent(in) :: first                         !< first step of the run
    integer, intent(in) :: last                          !< last step of the run
    type(chain_step_type), intent(in) :: steps(*)        !< (M) the steps of the plan
    type(state_type), intent(in) :: state                !< with origins of the frames and screws of the steps
    type(articulated_work_type), intent(inout) :: work   !< with the eliminated steps; gets the motion of the run's frames
    real(wp), intent(inout) :: accelerations(*)          !< (independent coordinates) gets those of the run [rad/s^2, m/s^2]

    call move(state%p, state%axis_w, state%axis_v, work%steps, work%motion, accelerations)

  contains

    !> The same from plain arrays.
    pure subroutine move(p, axis_w, axis_v, eliminated, motion, accelerations)
      real(wp), intent(in) :: p(3, 0:*)                           !< origin of each frame [m]
      real(wp), intent(in) :: axis_w(3, *)                        !< (3,M) angular velocity that each step gives per unit rate, fixed axes [1, rad/m]
      real(wp), intent(in) :: axis_v(3, *)                        !< (3,M) velocity of the new origin per unit rate, fixed axes [m/rad, 1]
      type(eliminated_step_type), intent(in) :: eliminated(*)     !< the steps
      real(wp), intent(inout) :: motion(6, 0:*)                   !< (6,0:M) accelerations less the part by rates alone, fixed axes; 0 for frame 0 [rad/s^2, m/s^2]
      real(wp), intent(inout) :: accelerations(*)                 !< of the independent coordinates [rad/s^2, m/s^2]
      real(wp) :: dw(3), dv(3), x
      integer :: s

      do s = first, last
        associate (parent => steps(s)%parent, step => eliminated(s))
          dw = motion(1:3, parent)
          dv = motion(4:6, parent) + cross(dw, p(:, s) - p(:, parent))
          x = (step%rest - dot_product(step%column(1:3), dw) - dot_product(step%column(4:6), dv))/step%pivot
          accelerations(steps(s)%place) = x
          motion(1:3, s) = dw + x*axis_w(:, s)
          motion(4:6, s) = dv + x*axis_v(:, s)
        end associate
      end do
    end subroutine move
  end subroutine go_outward

  !> Pass the inertia and the wrench of a run of driven open steps to the parents, the last step first: a step whose acceleration
  !> is given resists like a rigid joint. All vectors are in fixed axes.
  pure subroutine pass_inward(first, last, steps, p, bodies)
    integer, intent(in) :: first                                !< first step of the run
    integer, intent(in) :: last                                 !< last step of the run
    type(chain_step_type), intent(in) :: steps(*)               !< (M) the steps of the plan
    real(wp), intent(in) :: p(3, 0:*)                           !< origin of each frame [m]
    type(articulated_body_type), intent(inout) :: bodies(0:*)   !< each frame's own bodies; then with all links beyond it
    integer :: s

    do s = last, first, -1
      if (steps(s)%parent == 0) cycle
      call add_to_parent(p(:, s) - p(:, steps(s)%parent), bodies(s), bodies(steps(s)%parent))
    end do
  end subroutine pass_inward

  !> Move the frames of a run of driven open steps with their parents, the first step first: their own accelerations are among
  !> those that rates and drives give. All vectors are in fixed axes.
  pure subroutine pass_outward(first, last, steps, p, motion)
    integer, intent(in) :: first                    !< first step of the run
    integer, intent(in) :: last                     !< last step of the run
    type(chain_step_type), intent(in) :: steps(*)   !< (M) the steps of the plan
    real(wp), intent(in) :: p(3, 0:*)               !< origin of each frame [m]
    real(wp), intent(inout) :: motion(6, 0:*)       !< (6,0:M) gets accelerations less those that rates and drives give, fixed axes [rad/s^2, m/s^2]
    integer :: s

    do s = first, last
      associate (parent => steps(s)%parent)
        motion(1:3, s) = motion(1:3, parent)
        motion(4:6, s) = motion(4:6, parent) + cross(motion(1:3, parent), p(:, s) - p(:, parent))
      end associate
    end do
  end subroutine pass_outward
end module mech9_articulated_bodies
