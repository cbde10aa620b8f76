!> Lagrange's equations in planar arithmetic: columns of frames, inertia of links and forces on them, in the plane.
!>
!> A column is (angular velocity about the normal, velocity of the frame's origin in the plane's axes) per unit rate of an
!> independent coordinate. Poses, velocities and accelerations of frames are in the plane's axes, from the origin of frame 0.
module mech9_planar_lagrange
  use mech9_kinds, only: wp
  use mech9_pose, only: transformed
  use mech9_inertia, only: inertia_in_axes
  use mech9_body, only: body_type
  use mech9_plan, only: plan_type
  use mech9_planar_plan, only: planar_plan_type, planar_step_type
  use mech9_planar_motion, only: to_plane
  use mech9_planar_formulas, only: step_velocity
  implicit none
  private
  public :: planar_body_type, planar_body, spread_columns, carry_columns, add_inertia, planar_wrench, add_link_force

  !> A link with mass or inertia, in its frame in the plane.
  type :: planar_body_type
    integer :: frame = 0                  !< number of the link's first frame
    real(wp) :: mass = 0.0_wp             !< [kg]
    real(wp) :: centre(2) = 0.0_wp        !< mass centre, from the frame's origin, in the frame's axes [m]
    real(wp) :: inertia = 0.0_wp          !< about the normal through the centre [kg m^2]
  end type planar_body_type

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

  !> Outward recursion of the columns of those of the frames first .. last that are marked.
  pure subroutine spread_columns(m, n, steps, first, last, entries, parent_entry, marked, b, f, slide, columns)
    integer, intent(in) :: m                         !< number of steps
    integer, intent(in) :: n                         !< number of entries
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    integer, intent(in) :: first                     !< frames from this one
    integer, intent(in) :: last                      !< to this one
    integer, intent(in) :: entries(0:m + 1)          !< first entry of each frame
    integer, intent(in) :: parent_entry(n)           !< the same column in the parent frame, 0 for none
    logical, intent(in) :: marked(0:m)               !< the columns of the frame are found
    real(wp), intent(in) :: b(n)                     !< B, rate of the step's coordinate per unit rate of an independent one
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: slide(2, m)              !< velocity of each new origin per unit rate
    real(wp), intent(inout) :: columns(3, n)         !< gets the columns of these frames
    real(wp) :: x, y
    integer :: s

    do s = first, last
      if (.not. marked(s)) cycle
      x = f(3, s) - f(3, steps(s)%parent)
      y = f(4, s) - f(4, steps(s)%parent)
      call carry_columns(n, entries(s), entries(s + 1) - 1, parent_entry, steps(s), slide(:, s), x, y, b, columns)
    end do
  end subroutine spread_columns

  !> The columns of one frame: those of its parent frame, carried to its origin, and the contribution of its own step.
  pure subroutine carry_columns(n, first, last, parent_entry, step, slide, x, y, b, columns)
    integer, intent(in) :: n                     !< number of entries of all frames
    integer, intent(in) :: first                 !< first entry of the frame
    integer, intent(in) :: last                  !< last entry of the frame
    integer, intent(in) :: parent_entry(n)       !< the same column in the parent frame, 0 for none
    type(planar_step_type), intent(in) :: step   !< the frame's step
    real(wp), intent(in) :: slide(2)             !< velocity of the frame's origin per unit rate of its step
    real(wp), intent(in) :: x                    !< from the parent's origin to the frame's, along the first axis [m]
    real(wp), intent(in) :: y                    !< the same along the second axis [m]
    real(wp), intent(in) :: b(n)                 !< B, rate of the step's coordinate per unit rate of an independent one
    real(wp), intent(inout) :: columns(3, n)     !< with those of the parent; gets those of the frame
    real(wp) :: carried(3)
    integer :: e

    do e = first, last
      carried = 0.0_wp
      if (parent_entry(e) > 0) carried = columns(:, parent_entry(e))
      call step_velocity(step, b(e), [x, y], slide, carried, columns(:, e))
    end do
  end subroutine carry_columns

  !> Add the bodies' coefficients of motion, velocity terms, and weights.
  pure subroutine add_inertia(n_bodies, bodies, m, n_entries, entries, numbers, columns, f, v, a, gravity, n, &
                              coefficients, velocity_terms, forces)
    integer, intent(in) :: n_bodies                          !< number of bodies
    type(planar_body_type), intent(in) :: bodies(n_bodies)   !< links with mass or inertia
    integer, intent(in) :: m                                 !< number of steps
    integer, intent(in) :: n_entries                         !< number of entries of all frames
    integer, intent(in) :: entries(0:m + 1)                  !< first entry of each frame
    integer, intent(in) :: numbers(n_entries)                !< place of each entry's coordinate among the independent ones
    real(wp), intent(in) :: columns(3, n_entries)            !< columns of all frames
    real(wp), intent(in) :: f(4, 0:m)                        !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: v(3, 0:m)                        !< velocity of each frame [rad/s, m/s]
    real(wp), intent(in) :: a(3, 0:m)                        !< acceleration of each frame that rates alone give [rad/s^2, m/s^2]
    real(wp), intent(in) :: gravity(2)                       !< acceleration of free fall, in the plane's axes [m/s^2]
    integer, intent(in) :: n                                 !< number of independent coordinates
    real(wp), intent(inout) :: coefficients(n, n)            !< a_pr, lower triangle
    real(wp), intent(inout) :: velocity_terms(n)             !< h_p
    real(wp), intent(inout) :: forces(n)                     !< Q_p [N m or N]
    real(wp) :: x, y, force_x, force_y, torque, c_x, c_y, spin
    integer :: i, s, e, d, p, r

    do i = 1, n_bodies
      s = bodies(i)%frame
      x = f(1, s)*bodies(i)%centre(1) - f(2, s)*bodies(i)%centre(2)
      y = f(2, s)*bodies(i)%centre(1) + f(1, s)*bodies(i)%centre(2)
      force_x = bodies(i)%mass*(a(2, s) - a(1, s)*y - v(1, s)**2*x)
      force_y = bodies(i)%mass*(a(3, s) + a(1, s)*x - v(1, s)**2*y)
      torque = bodies(i)%inertia*a(1, s)
      do e = entries(s), entries(s + 1) - 1
        p = numbers(e)
        c_x = columns(2, e) - columns(1, e)*y
        c_y = columns(3, e) + columns(1, e)*x
        velocity_terms(p) = velocity_terms(p) + c_x*force_x + c_y*force_y + columns(1, e)*torque
        c_x = bodies(i)%mass*c_x
        c_y = bodies(i)%mass*c_y
        forces(p) = forces(p) + c_x*gravity(1) + c_y*gravity(2)
        spin = x*c_y - y*c_x + bodies(i)%inertia*columns(1, e)
        do d = e, entries(s + 1) - 1
          r = numbers(d)
          coefficients(r, p) = coefficients(r, p) + columns(1, d)*spin + columns(2, d)*c_x + columns(3, d)*c_y
        end do
      end do
    end do
  end subroutine add_inertia

  !> Add the generalized forces of a force and a torque about the origin of a link's own system.
  pure subroutine add_link_force(planar, link, k, numbers, columns, f, force, torque, forces)
    type(planar_plan_type), intent(in) :: planar   !< the plan in the plane
    integer, intent(in) :: link                    !< number of the link
    integer, intent(in) :: k                       !< number of columns of its frame
    integer, intent(in) :: numbers(k)              !< place of each column's coordinate among the independent ones
    real(wp), intent(in) :: columns(3, k)          !< columns of the link's frame
    real(wp), intent(in) :: f(4)                   !< pose of the link's frame: cosine, sine, origin [m]
    real(wp), intent(in) :: force(3)               !< in the axes of frame 0 [N]
    real(wp), intent(in) :: torque(3)              !< in the axes of frame 0 [N m]
    real(wp), intent(inout) :: forces(:)           !< Q_p [N m or N]
    real(wp) :: wrench(3)
    integer :: p

    wrench = planar_wrench(planar, link, f, force, torque)
    do p = 1, k
      forces(numbers(p)) = forces(numbers(p)) + dot_product(columns(:, p), wrench)
    end do
  end subroutine add_link_force

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
