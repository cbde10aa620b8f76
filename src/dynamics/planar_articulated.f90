!> Articulated bodies in planar arithmetic: accelerations of open chains whose motion keeps to one plane.
!>
!> The method is that of mech9_articulated_bodies, with wrenches (torque about the normal, force) and motions (dw, dv) in the
!> plane's axes:
!>   torque = J dw + H . dv + torque_0,   force = H dw + M dv + force_0.
module mech9_planar_articulated
  use mech9_kinds, only: wp
  use mech9_pose, only: transformed
  use mech9_inertia, only: inertia_in_axes
  use mech9_body, only: body_type
  use mech9_plan, only: plan_type
  use mech9_planar_plan, only: planar_step_type
  use mech9_state, only: planar_motion_type
  implicit none
  private
  public :: planar_body_type, articulated_plate_type, planar_work_type, planar_body, new_planar_work, set_bodies, go_inward, &
    go_outward, pass_inward, pass_outward, add_to_parent

  !> A link with mass or inertia, in its frame in the plane.
  type :: planar_body_type
    integer :: frame = 0                  !< number of the link's first frame
    real(wp) :: mass = 0.0_wp             !< [kg]
    real(wp) :: centre(2) = 0.0_wp        !< mass centre, from the frame's origin, in the frame's axes [m]
    real(wp) :: inertia = 0.0_wp          !< about the normal through the centre [kg m^2]
  end type planar_body_type

  !> All links beyond a step as one body that resists a motion of the step's frame, in the plane's axes.
  type :: articulated_plate_type
    real(wp) :: inertia(6) = 0.0_wp   !< J, Hx, Hy, Mxx, Mxy, Myy [kg m^2, kg m, kg]
    real(wp) :: wrench(3) = 0.0_wp    !< torque_0 about the frame's origin, and force_0 [N m, N]
    real(wp) :: amount(4) = 0.0_wp    !< as if rigid: mass, moment, inertia [kg, kg m, kg m^2]
  end type articulated_plate_type

  !> A step whose acceleration is eliminated.
  type :: eliminated_step_type
    real(wp) :: column(3) = 0.0_wp   !< U
    real(wp) :: pivot = 0.0_wp       !< D
    real(wp) :: rest = 0.0_wp        !< Q - S . wrench_0
  end type eliminated_step_type

  !> Scratch of the passes, sized once, in the plane's axes.
  type :: planar_work_type
    real(wp), allocatable :: applied(:, :)                   !< (3,M) wrench of the loads on each frame: to be set before [N m, N]
    type(articulated_plate_type), allocatable :: bodies(:)   !< (0:M) the frame's own bodies, then with all links beyond it
    type(eliminated_step_type), allocatable :: steps(:)      !< (M)
    real(wp), allocatable :: motion(:, :)                    !< (3,0:M) accelerations less those that rates alone give
  end type planar_work_type

contains

  !> The data of a body that matter in the plane.
  pure function planar_body(plan, body) result(flat)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(body_type), intent(in) :: body   !< the body in its link's own system
    type(planar_body_type) :: flat
    real(wp) :: centre(3), inertia(3, 3)

    associate (in_frame => plan%planar%link_in_frame(body%link))
      centre = transformed(in_frame, body%centre)
      inertia = inertia_in_axes(in_frame%r, body%inertia)
    end associate
    flat = planar_body_type(plan%frame_of(body%link), body%mass, centre(1:2), inertia(3, 3))
  end function planar_body

  !> Room for the passes over a number of steps, without loads.
  pure function new_planar_work(m) result(work)
    integer, intent(in) :: m   !< number of steps
    type(planar_work_type) :: work

    allocate (work%bodies(0:m), work%steps(m))
    allocate (work%applied(3, m), work%motion(3, 0:m), source=0.0_wp)
  end function new_planar_work

  !> The inertia of each frame's own bodies, and the wrench that these bodies require for the motion by rates alone, less that of
  !> the loads in work%applied and of gravity. Poses and motions are in the plane's axes.
  pure subroutine set_bodies(bodies, gravity, motion, work)
    type(planar_body_type), intent(in), contiguous :: bodies(:)   !< links with mass or inertia
    real(wp), intent(in) :: gravity(2)                !< acceleration of free fall [m/s^2]
    type(planar_motion_type), intent(in) :: motion    !< with the accelerations that rates alone give
    type(planar_work_type), intent(inout) :: work     !< with the loads' wrenches; gets `bodies`
    integer :: m, n

    m = size(work%applied, 2)
    n = size(bodies)
    call set_each(bodies, motion%pose, motion%velocity, motion%acceleration, work%applied, work%bodies)

  contains

    !> The same from plain arrays.
    pure subroutine set_each(bodies, f, v, a, applied, plates)
      type(planar_body_type), intent(in) :: bodies(n)                !< links with mass or inertia
      real(wp), intent(in) :: f(4, 0:*)                              !< pose of each frame: cosine, sine, origin [m]
      real(wp), intent(in) :: v(3, 0:*)                              !< velocity of each frame [rad/s, m/s]
      real(wp), intent(in) :: a(3, 0:*)                              !< acceleration that rates alone give [rad/s^2, m/s^2]
      real(wp), intent(in) :: applied(3, m)                          !< wrench of the loads on each frame [N m, N]
      type(articulated_plate_type), intent(inout) :: plates(0:m)     !< gets those of each frame
      integer :: i, k

      do k = 0, m
        plates(k)%inertia = 0.0_wp
        plates(k)%amount = 0.0_wp
        if (k > 0) plates(k)%wrench = -applied(:, k)
      end do
      do i = 1, n
        k = bodies(i)%frame
        call add_body(bodies(i), gravity, f(:, k), v(:, k), a(:, k), plates(k))
      end do
    end subroutine set_each
  end subroutine set_bodies

  !> Add a body's inertia about the origin of its frame, and the wrench that the body requires for the motion by rates alone,
  !> less its weight. Vectors are in the plane's axes.
  pure subroutine add_body(body, gravity, f, v, a, plate)
    type(planar_body_type), intent(in) :: body            !< the body
    real(wp), intent(in) :: gravity(2)                    !< acceleration of free fall [m/s^2]
    real(wp), intent(in) :: f(4)                          !< pose of its frame: cosine, sine, origin [m]
    real(wp), intent(in) :: v(3)                          !< velocity of its frame [rad/s, m/s]
    real(wp), intent(in) :: a(3)                          !< acceleration of its frame that rates alone give [rad/s^2, m/s^2]
    type(articulated_plate_type), intent(inout) :: plate  !< of the frame
    real(wp) :: x, y, j, force(2)

    x = f(1)*body%centre(1) - f(2)*body%centre(2)
    y = f(2)*body%centre(1) + f(1)*body%centre(2)
    j = body%inertia + body%mass*(x**2 + y**2)
    plate%inertia(1) = plate%inertia(1) + j
    plate%inertia(2) = plate%inertia(2) - body%mass*y
    plate%inertia(3) = plate%inertia(3) + body%mass*x
    plate%inertia(4) = plate%inertia(4) + body%mass
    plate%inertia(6) = plate%inertia(6) + body%mass
    force(1) = body%mass*(a(2) - a(1)*y - v(1)**2*x - gravity(1))
    force(2) = body%mass*(a(3) + a(1)*x - v(1)**2*y - gravity(2))
    plate%wrench(1) = plate%wrench(1) + body%inertia*a(1) + x*force(2) - y*force(1)
    plate%wrench(2:3) = plate%wrench(2:3) + force
    plate%amount(1) = plate%amount(1) + body%mass
    plate%amount(2) = plate%amount(2) + body%mass*x
    plate%amount(3) = plate%amount(3) + body%mass*y
    plate%amount(4) = plate%amount(4) + j
  end subroutine add_body

  !> Eliminate the accelerations of a run of open steps, the last one first. Vectors are in the plane's axes.
  pure subroutine go_inward(first, last, steps, motion, forces, work, found)
    integer, intent(in) :: first                      !< first step of the run
    integer, intent(in) :: last                       !< last step of the run
    type(planar_step_type), intent(in), contiguous :: steps(:)   !< (M) the steps of the plan
    type(planar_motion_type), intent(in) :: motion    !< with the poses of the frames
    real(wp), intent(in) :: forces(*)                 !< (M) generalized force on each coordinate [N m or N]
    type(planar_work_type), intent(inout) :: work     !< with the bodies of the frames; gets the steps of the run
    logical, intent(out) :: found                     !< whether all coordinates of the run have inertia
    real(wp) :: round_off

    ! a pivot within round-off counts as zero, as in the Cholesky factors
    round_off = 8.0_wp*size(steps)*epsilon(1.0_wp)
    call eliminate(steps, motion%pose, motion%slide, work%bodies, work%steps, found)

  contains

    !> The same from plain arrays.
    pure subroutine eliminate(steps, f, slide, plates, eliminated, found)
      type(planar_step_type), intent(in) :: steps(*)                 !< the steps of the plan
      real(wp), intent(in) :: f(4, 0:*)                              !< pose of each frame: cosine, sine, origin [m]
      real(wp), intent(in) :: slide(2, *)                            !< (2,M) velocity of each new origin per unit rate, the plane's axes [m/rad, 1]
      type(articulated_plate_type), intent(inout) :: plates(0:*)     !< each frame's own bodies; then with all links beyond it
      type(eliminated_step_type), intent(inout) :: eliminated(*)     !< gets the steps of the run
      logical, intent(out) :: found                                  !< whether all coordinates of the run have inertia
      real(wp) :: u(3), part(3), rigid, s(2)
      integer :: i, p

      found = .true.
      do i = last, first, -1
        associate (plate => plates(i), step => eliminated(i))
          p = steps(i)%parent
          step%rest = forces(steps(i)%coordinate)
          if (steps(i)%turns) then
            u = steps(i)%turn*plate%inertia(1:3)
            step%pivot = steps(i)%turn*u(1)
            step%rest = step%rest - steps(i)%turn*plate%wrench(1)
            rigid = plate%amount(4)
          else
            s = slide(:, i)
            u(1) = plate%inertia(2)*s(1) + plate%inertia(3)*s(2)
            u(2) = plate%inertia(4)*s(1) + plate%inertia(5)*s(2)
            u(3) = plate%inertia(5)*s(1) + plate%inertia(6)*s(2)
            step%pivot = s(1)*u(2) + s(2)*u(3)
            step%rest = step%rest - s(1)*plate%wrench(2) - s(2)*plate%wrench(3)
            rigid = plate%amount(1)*(s(1)**2 + s(2)**2)
          end if
          step%column = u
          found = step%pivot > round_off*rigid
          if (.not. found) return
          if (p == 0) cycle
          part = u*(1.0_wp/step%pivot)
          plate%inertia(1:3) = plate%inertia(1:3) - u(1)*part
          plate%inertia(4) = plate%inertia(4) - u(2)*part(2)
          plate%inertia(5) = plate%inertia(5) - u(2)*part(3)
          plate%inertia(6) = plate%inertia(6) - u(3)*part(3)
          plate%wrench = plate%wrench + part*step%rest
        end associate
        call add_to_parent(f(3:4, i) - f(3:4, p), plates(i), plates(p))
      end do
    end subroutine eliminate
  end subroutine go_inward

  !> Add the inertia and wrench of a frame to those of its parent, about the parent's origin: per unit of dw, the frame's origin
  !> moves by (-y, x). Vectors are in the plane's axes.
  pure subroutine add_to_parent(arm, plate, parent)
    real(wp), intent(in) :: arm(2)                          !< from the parent's origin to the frame's [m]
    type(articulated_plate_type), intent(in) :: plate       !< the frame with all links beyond it
    type(articulated_plate_type), intent(inout) :: parent   !< the parent alike; grows
    real(wp) :: h(2), x, y

    x = arm(1)
    y = arm(2)
    h(1) = plate%inertia(2) - plate%inertia(4)*y + plate%inertia(5)*x
    h(2) = plate%inertia(3) - plate%inertia(5)*y + plate%inertia(6)*x
    parent%inertia(1) = parent%inertia(1) + plate%inertia(1) - y*(plate%inertia(2) + h(1)) + x*(plate%inertia(3) + h(2))
    parent%inertia(2:3) = parent%inertia(2:3) + h
    parent%inertia(4:6) = parent%inertia(4:6) + plate%inertia(4:6)
    parent%wrench(1) = parent%wrench(1) + plate%wrench(1) - y*plate%wrench(2) + x*plate%wrench(3)
    parent%wrench(2:3) = parent%wrench(2:3) + plate%wrench(2:3)
    parent%amount(1) = parent%amount(1) + plate%amount(1)
    parent%amount(2) = parent%amount(2) + plate%amount(2) + plate%amount(1)*x
    parent%amount(3) = parent%amount(3) + plate%amount(3) + plate%amount(1)*y
    parent%amount(4) = parent%amount(4) + plate%amount(4) + 2.0_wp*(x*plate%amount(2) + y*plate%amount(3)) &
                       + plate%amount(1)*(x**2 + y**2)
  end subroutine add_to_parent

  !> Find the accelerations of a run of open steps, the first step first. Vectors are in the plane's axes.
  pure subroutine go_outward(first, last, steps, place_of, motion, work, accelerations)
    integer, intent(in) :: first                     !< first step of the run
    integer, intent(in) :: last                      !< last step of the run
    type(planar_step_type), intent(in) :: steps(*)   !< (M) the steps of the plan
    integer, intent(in) :: place_of(*)               !< (M) place of a coordinate among the independent ones, or 0
    type(planar_motion_type), intent(in) :: motion   !< with the poses of the frames
    type(planar_work_type), intent(inout) :: work    !< with the eliminated steps; gets the motion of the run's frames
    real(wp), intent(inout) :: accelerations(*)      !< (independent coordinates) gets those of the run [rad/s^2, m/s^2]

    call move(motion%pose, motion%slide, work%steps, work%motion, accelerations)

  contains

    !> The same from plain arrays.
    pure subroutine move(f, slide, eliminated, motion, accelerations)
      real(wp), intent(in) :: f(4, 0:*)                          !< pose of each frame: cosine, sine, origin [m]
      real(wp), intent(in) :: slide(2, *)                        !< (2,M) velocity of each new origin per unit rate, the plane's axes [m/rad, 1]
      type(eliminated_step_type), intent(in) :: eliminated(*)    !< the steps
      real(wp), intent(inout) :: motion(3, 0:*)                  !< (3,0:M) accelerations less the part by rates alone, the plane's axes; 0 for frame 0 [rad/s^2, m/s^2]
      real(wp), intent(inout) :: accelerations(*)                !< of the independent coordinates [rad/s^2, m/s^2]
      real(wp) :: x, d(3)
      integer :: i, p

      do i = first, last
        p = steps(i)%parent
        d = motion(:, p)
        d(2) = d(2) - d(1)*(f(4, i) - f(4, p))
        d(3) = d(3) + d(1)*(f(3, i) - f(3, p))
        associate (step => eliminated(i))
          x = (step%rest - step%column(1)*d(1) - step%column(2)*d(2) - step%column(3)*d(3))/step%pivot
        end associate
        accelerations(place_of(steps(i)%coordinate)) = x
        if (steps(i)%turns) then
          d(1) = d(1) + steps(i)%turn*x
        else
          d(2:3) = d(2:3) + slide(:, i)*x
        end if
        motion(:, i) = d
      end do
    end subroutine move
  end subroutine go_outward

  !> Pass the inertia and the wrench of a run of driven open steps to the parents, the last step first: a step whose acceleration
  !> is given resists like a rigid joint. Vectors are in the plane's axes.
  pure subroutine pass_inward(first, last, steps, f, plates)
    integer, intent(in) :: first                                 !< first step of the run
    integer, intent(in) :: last                                  !< last step of the run
    type(planar_step_type), intent(in) :: steps(*)               !< (M) the steps of the plan
    real(wp), intent(in) :: f(4, 0:*)                            !< pose of each frame: cosine, sine, origin [m]
    type(articulated_plate_type), intent(inout) :: plates(0:*)   !< each frame's own bodies; then with all links beyond it
    integer :: i, p

    do i = last, first, -1
      p = steps(i)%parent
      if (p > 0) call add_to_parent(f(3:4, i) - f(3:4, p), plates(i), plates(p))
    end do
  end subroutine pass_inward

  !> Move the frames of a run of driven open steps with their parents, the first step first: their own accelerations are among
  !> those that rates and drives give. Vectors are in the plane's axes.
  pure subroutine pass_outward(first, last, steps, f, motion)
    integer, intent(in) :: first                     !< first step of the run
    integer, intent(in) :: last                      !< last step of the run
    type(planar_step_type), intent(in) :: steps(*)   !< (M) the steps of the plan
    real(wp), intent(in) :: f(4, 0:*)                !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(inout) :: motion(3, 0:*)        !< (3,0:M) gets accelerations less those that rates and drives give, the plane's axes [rad/s^2, m/s^2]
    integer :: i, p

    do i = first, last
      p = steps(i)%parent
      motion(1, i) = motion(1, p)
      motion(2, i) = motion(2, p) - motion(1, p)*(f(4, i) - f(4, p))
      motion(3, i) = motion(3, p) + motion(1, p)*(f(3, i) - f(3, p))
    end do
  end subroutine pass_outward
end module mech9_planar_articulated
