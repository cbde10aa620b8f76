!> Lagrange's equations in planar arithmetic: columns of frames, inertia of links and forces on them, in the plane.
!>
!> A column is (angular velocity about the normal, velocity of the frame's origin in the plane's axes) per unit rate of an
!> independent coordinate. Poses, velocities and accelerations of frames are in the plane's axes, from the origin of frame 0.
module mech9_planar_lagrange
  use mech9_kinds, only: wp
  use mech9_plan, only: block_type
  use mech9_planar_plan, only: planar_plan_type, planar_step_type
  use mech9_planar_motion, only: to_plane
  use mech9_planar_formulas, only: step_velocity
  use mech9_state, only: planar_motion_type
  use mech9_planar_articulated, only: planar_body_type
  use mech9_frame_columns, only: jacobian_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  implicit none
  private
  public :: spread_columns, add_inertia, planar_wrench

contains

  !> Outward recursion of the columns of those frames of a block that are marked.
  pure subroutine spread_columns(steps, block, first, parent_entry, marked, motion, jacobian)
    type(planar_step_type), intent(in) :: steps(*)   !< the steps of the plan
    type(block_type), intent(in) :: block            !< the block
    integer, intent(in) :: first(0:*)                !< (0:M+1) first entry of each frame
    integer, intent(in) :: parent_entry(*)           !< (entries) the same column in the parent frame, 0 for none
    logical, intent(in) :: marked(0:*)               !< (0:M) the columns of the frame are found
    type(planar_motion_type), intent(in) :: motion   !< with the poses of the frames
    type(jacobian_type), intent(inout) :: jacobian   !< with `b`; gets the columns of these frames

    call spread(motion%pose, motion%slide, jacobian%b, jacobian%flat)

  contains

    !> The same from plain arrays.
    pure subroutine spread(f, slide, b, columns)
      real(wp), intent(in) :: f(4, 0:*)            !< pose of each frame: cosine, sine, origin [m]
      real(wp), intent(in) :: slide(2, *)          !< (2,M) velocity of each new origin per unit rate, the plane's axes [m/rad, 1]
      real(wp), intent(in) :: b(*)                 !< (entries) B, rate of the step's coordinate per unit rate of an independent one [1, rad/m, m/rad]
      real(wp), intent(inout) :: columns(3, *)     !< (3,entries) gets the columns of these frames, the plane's axes [1, m/rad]
      real(wp) :: arm(2), carried(3)
      integer :: s, e

      do s = block%first_step, block%last_step
        if (.not. marked(s)) cycle
        arm = f(3:4, s) - f(3:4, steps(s)%parent)
        do e = first(s), first(s + 1) - 1
          carried = 0.0_wp
          if (parent_entry(e) > 0) carried = columns(:, parent_entry(e))
          call step_velocity(steps(s), b(e), arm, slide(:, s), carried, columns(:, e))
        end do
      end do
    end subroutine spread
  end subroutine spread_columns

  !> Add the bodies' coefficients of motion, velocity terms, and weights.
  pure subroutine add_inertia(bodies, gravity, f, v, a, dynamics, work)
    type(planar_body_type), intent(in), contiguous :: bodies(:)   !< links with mass or inertia
    real(wp), intent(in) :: gravity(2)                 !< acceleration of free fall, in the plane's axes [m/s^2]
    real(wp), intent(in) :: f(4, 0:*)                  !< (4,0:M) pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: v(3, 0:*)                  !< (3,0:M) velocity of each frame [rad/s, m/s]
    real(wp), intent(in) :: a(3, 0:*)                  !< (3,0:M) acceleration that rates alone give [rad/s^2, m/s^2]
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(lagrange_work_type), intent(inout) :: work    !< with the columns of all frames; gets the sums
    integer :: n

    n = size(work%forces)
    call add_each(dynamics%first, dynamics%column, work%jacobian%flat, work%coefficients, work%velocity_terms, work%forces)

  contains

    !> The same from plain arrays.
    pure subroutine add_each(first, numbers, columns, coefficients, velocity_terms, forces)
      integer, intent(in) :: first(0:*)                  !< first entry of each frame
      integer, intent(in) :: numbers(*)                  !< place of each entry's coordinate among the independent ones
      real(wp), intent(in) :: columns(3, *)              !< (3,entries) columns of all frames, the plane's axes [1, m/rad]
      real(wp), intent(inout) :: coefficients(n, *)      !< (n,n) a_pr, lower triangle [kg m^2, kg m, kg]
      real(wp), intent(inout) :: velocity_terms(*)       !< (n) h_p [N m, N]
      real(wp), intent(inout) :: forces(*)               !< Q_p [N m or N]
      real(wp) :: x, y, force_x, force_y, torque, c_x, c_y, spin
      integer :: i, s, e, d, p, r

      do i = 1, size(bodies)
        s = bodies(i)%frame
        x = f(1, s)*bodies(i)%centre(1) - f(2, s)*bodies(i)%centre(2)
        y = f(2, s)*bodies(i)%centre(1) + f(1, s)*bodies(i)%centre(2)
        force_x = bodies(i)%mass*(a(2, s) - a(1, s)*y - v(1, s)**2*x)
        force_y = bodies(i)%mass*(a(3, s) + a(1, s)*x - v(1, s)**2*y)
        torque = bodies(i)%inertia*a(1, s)
        do e = first(s), first(s + 1) - 1
          p = numbers(e)
          c_x = columns(2, e) - columns(1, e)*y
          c_y = columns(3, e) + columns(1, e)*x
          velocity_terms(p) = velocity_terms(p) + c_x*force_x + c_y*force_y + columns(1, e)*torque
          c_x = bodies(i)%mass*c_x
          c_y = bodies(i)%mass*c_y
          forces(p) = forces(p) + c_x*gravity(1) + c_y*gravity(2)
          spin = x*c_y - y*c_x + bodies(i)%inertia*columns(1, e)
          do d = e, first(s + 1) - 1
            r = numbers(d)
            coefficients(r, p) = coefficients(r, p) + columns(1, d)*spin + columns(2, d)*c_x + columns(3, d)*c_y
          end do
        end do
      end do
    end subroutine add_each
  end subroutine add_inertia

  !> A force and a torque about the origin of a link's own system, as a torque about the origin of its frame and a force in the
  !> plane.
  pure function planar_wrench(planar, link, f, force, torque) result(wrench)
    type(planar_plan_type), intent(in) :: planar   !< the plan in the plane
    integer, intent(in) :: link                    !< number of the link
    real(wp), intent(in) :: f(4)                   !< pose of the link's frame: cosine, sine, origin [m]
    real(wp), intent(in) :: force(3)               !< in the axes of frame 0 [N]
    real(wp), intent(in) :: torque(3)              !< in the axes of frame 0 [N m]
    real(wp) :: wrench(3)                         !< in the plane's axes [N m, N]
    real(wp) :: pull(3), spin(3), x, y

    pull = to_plane(planar, force)
    spin = to_plane(planar, torque)
    associate (arm => planar%link_in_frame(link)%p)
      x = f(1)*arm(1) - f(2)*arm(2)
      y = f(2)*arm(1) + f(1)*arm(2)
    end associate
    wrench(1) = spin(3) + x*pull(2) - y*pull(1)
    wrench(2:3) = pull(1:2)
  end function planar_wrench
end module mech9_planar_lagrange
