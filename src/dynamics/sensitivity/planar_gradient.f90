!> Derivatives of required forces in a plane: a twist is a rotation about the normal and the shift of the point at the origin of frame 0,
!> a wrench a moment about this origin and a force.
module mech9_planar_gradient
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_inertia, only: inertia_in_axes
  use mech9_rotation, only: turn
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planar_motion, only: to_plane
  use mech9_planar_articulated, only: planar_body_type, planar_body
  use mech9_frame_variation, only: third_derivatives_type
  use mech9_twists, only: frame_twists_type
  use mech9_parameter_support, only: varied_constant_type
  use mech9_twists_at_position, only: planar_step_series, carry_in_plane
  use mech9_gradient_arithmetic, only: gradient_arithmetic_type
  implicit none
  private
  public :: planar_gradient_type, new_planar_gradient

  !> The bodies in the plane, with their present motion.
  type, extends(gradient_arithmetic_type) :: planar_gradient_type
    type(planar_body_type), allocatable, private :: bodies(:)   !< links with mass or inertia
    integer, allocatable, private :: links(:)                   !< their numbers
    real(wp), private :: gravity(2) = 0.0_wp                    !< in the plane's axes [m/s^2]
    real(wp), private :: axes(3, 3) = 0.0_wp                    !< of the plane, in those of frame 0
    real(wp), allocatable, private :: centres(:, :)             !< (2,bodies) mass centres [m]
    real(wp), allocatable, private :: velocities(:, :)          !< (2,bodies) their velocities [m/s]
    real(wp), allocatable, private :: proper(:, :)              !< (2,bodies) their accelerations less gravity [m/s^2]
  contains
    procedure :: find_twists
    procedure :: find_wrenches
    procedure :: add_rows
    procedure :: flatten_body
    procedure :: body_wrench
    procedure :: by_gravity
    procedure :: find_map
    procedure :: carry
    procedure :: twist_in_space
    procedure :: reduced_wrench
  end type planar_gradient_type

contains

  !> The bodies of a planar mechanism.
  subroutine new_planar_gradient(mechanism, plan, numbers, self)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(plan_type), intent(in) :: plan                    !< its plan, planar
    integer, intent(in) :: numbers(:)                      !< numbers of the bodies that count
    type(planar_gradient_type), intent(out) :: self        !< the arithmetic
    real(wp) :: gravity(3)
    integer :: i

    self%d = 3
    gravity = to_plane(plan%planar, mechanism%gravity)
    self%gravity = gravity(1:2)
    self%axes = plan%planar%axes
    allocate (self%bodies(size(numbers)), self%links(size(numbers)))
    do i = 1, size(numbers)
      self%bodies(i) = planar_body(plan, mechanism%bodies(numbers(i)))
      self%links(i) = mechanism%bodies(numbers(i))%link
    end do
    allocate (self%centres(2, size(numbers)), self%velocities(2, size(numbers)), self%proper(2, size(numbers)), source=0.0_wp)
    self%body_frames = self%bodies%frame
  end subroutine new_planar_gradient

  !> The twists of frames and steps in the present motion.
  pure subroutine find_twists(self, plan, state, third, twists)
    class(planar_gradient_type), intent(in) :: self       !< the arithmetic
    type(plan_type), intent(in) :: plan                   !< the plan, planar
    type(state_type), intent(in) :: state                 !< the motion
    type(third_derivatives_type), intent(in) :: third     !< without meaning: all axes are fixed
    type(frame_twists_type), intent(inout) :: twists      !< gets the twists
    integer :: s

    associate (f => state%planar%pose, v => state%planar%velocity, a => state%planar%acceleration)
      do s = 1, plan%n_coordinates
        twists%velocity(1, s) = v(1, s)
        twists%velocity(2, s) = v(2, s) + v(1, s)*f(4, s)
        twists%velocity(3, s) = v(3, s) - v(1, s)*f(3, s)
        twists%acceleration(1, s) = a(1, s)
        twists%acceleration(2, s) = a(2, s) + a(1, s)*f(4, s) + v(1, s)*v(3, s)
        twists%acceleration(3, s) = a(3, s) - a(1, s)*f(3, s) - v(1, s)*v(2, s)
        call planar_step_series(plan%planar, s, state%planar, 2, twists%step(:, :, s))
      end do
    end associate
  end subroutine find_twists

  !> Add the wrenches that the bodies need beyond their weights to those of their frames.
  pure subroutine find_wrenches(self, state, wrenches)
    class(planar_gradient_type), intent(inout) :: self   !< gets the motion of the bodies
    type(state_type), intent(in) :: state                !< the motion
    real(wp), intent(inout) :: wrenches(:, 0:)           !< (3,0:M) the sums
    real(wp) :: x, y, square, fx, fy
    integer :: i, s

    do i = 1, size(self%bodies)
      s = self%bodies(i)%frame
      associate (body => self%bodies(i), f => state%planar%pose(:, s), v => state%planar%velocity(:, s), &
                 a => state%planar%acceleration(:, s), centre => self%centres(:, i))
        x = f(1)*body%centre(1) - f(2)*body%centre(2)
        y = f(2)*body%centre(1) + f(1)*body%centre(2)
        square = v(1)**2
        centre(1) = f(3) + x
        centre(2) = f(4) + y
        self%velocities(1, i) = v(2) - v(1)*y
        self%velocities(2, i) = v(3) + v(1)*x
        self%proper(1, i) = a(2) - a(1)*y - square*x - self%gravity(1)
        self%proper(2, i) = a(3) + a(1)*x - square*y - self%gravity(2)
        fx = body%mass*self%proper(1, i)
        fy = body%mass*self%proper(2, i)
        wrenches(1, s) = wrenches(1, s) + body%inertia*a(1) + centre(1)*fy - centre(2)*fx
        wrenches(2, s) = wrenches(2, s) + fx
        wrenches(3, s) = wrenches(3, s) + fy
      end associate
    end do
  end subroutine find_wrenches

  !> Add the rows of the bodies' inertial forces, less their weights, in a virtual motion. Those by the rate of change of a twist, and
  !> by the twist itself, are couples.
  pure subroutine add_rows(self, virtual, rows)
    class(planar_gradient_type), intent(in) :: self       !< with the motion of the bodies
    real(wp), intent(in) :: virtual(:, 0:)                !< (3,0:M) twists of the frames in the virtual motion
    real(wp), intent(inout) :: rows(:, 0:, 0:)            !< (3,0:2,0:M) the sums
    real(wp) :: px, py
    integer :: i, s

    do i = 1, size(self%bodies)
      s = self%bodies(i)%frame
      associate (body => self%bodies(i), x => virtual(:, s), centre => self%centres(:, i), v => self%velocities(:, i))
        px = body%mass*(x(2) - x(1)*centre(2))
        py = body%mass*(x(3) + x(1)*centre(1))
        rows(1, 2, s) = rows(1, 2, s) + body%inertia*x(1) + centre(1)*py - centre(2)*px
        rows(2, 2, s) = rows(2, 2, s) + px
        rows(3, 2, s) = rows(3, 2, s) + py
        rows(1, 1, s) = rows(1, 1, s) + 2.0_wp*(v(1)*py - v(2)*px)
        rows(1, 0, s) = rows(1, 0, s) + self%gravity(1)*py - self%gravity(2)*px
      end associate
    end do
  end subroutine add_rows

  !> The change of mass, centre in the frame's axes, and inertia about the normal.
  pure function flatten_body(self, plan, number, change) result(numbers)
    class(planar_gradient_type), intent(in) :: self       !< the arithmetic
    type(plan_type), intent(in) :: plan                   !< the plan, planar
    integer, intent(in) :: number                         !< of the body in this arithmetic
    real(wp), intent(in) :: change(13)                    !< mass, centre and inertia by columns, in the link's own axes
    real(wp) :: numbers(13), r(3, 3), centre(3), inertia(3, 3)

    r = plan%planar%link_in_frame(self%links(number))%r
    centre = turn(r, change(2:4))
    inertia = inertia_in_axes(r, reshape(change(5:13), [3, 3]))
    numbers = 0.0_wp
    numbers(1) = change(1)
    numbers(2:3) = centre(1:2)
    numbers(4) = inertia(3, 3)
  end function flatten_body

  !> The change of the wrench that a body needs beyond its weight, by its numbers.
  pure subroutine body_wrench(self, state, number, change, wrench)
    class(planar_gradient_type), intent(in) :: self       !< with the motion of the bodies
    type(state_type), intent(in) :: state                 !< the motion
    integer, intent(in) :: number                         !< of the body in this arithmetic
    real(wp), intent(in) :: change(13)                    !< as from `flatten_body`
    real(wp), intent(out) :: wrench(:)                    !< (3) on the frame of the body
    real(wp) :: x, y

    associate (body => self%bodies(number), proper_here => self%proper(:, number), centre => self%centres(:, number), &
               s => self%bodies(number)%frame)
      associate (f => state%planar%pose(:, s), w => state%planar%velocity(1, s), alpha => state%planar%acceleration(1, s))
        x = f(1)*change(2) - f(2)*change(3)
        y = f(2)*change(2) + f(1)*change(3)
        wrench(2) = change(1)*proper_here(1) - body%mass*(alpha*y + w**2*x)
        wrench(3) = change(1)*proper_here(2) + body%mass*(alpha*x - w**2*y)
        wrench(1) = change(4)*alpha + body%mass*(x*proper_here(2) - y*proper_here(1)) + centre(1)*wrench(3) - centre(2)*wrench(2)
      end associate
    end associate
  end subroutine body_wrench

  !> The change of the force that a virtual motion requires, by gravity.
  pure function by_gravity(self, virtual, change) result(row)
    class(planar_gradient_type), intent(in) :: self       !< with the motion of the bodies
    real(wp), intent(in) :: virtual(:, 0:)                !< (3,0:M) twists of the frames in the virtual motion
    real(wp), intent(in) :: change(3)                     !< of gravity, in the axes of frame 0
    real(wp) :: row, x, y
    integer :: i

    x = dot_product(change, self%axes(:, 1))
    y = dot_product(change, self%axes(:, 2))
    row = 0.0_wp
    do i = 1, size(self%bodies)
      associate (body => self%bodies(i), t => virtual(:, self%bodies(i)%frame), centre => self%centres(:, i))
        row = row - body%mass*(x*(t(2) - t(1)*centre(2)) + y*(t(3) + t(1)*centre(1)))
      end associate
    end do
  end function by_gravity

  !> The wrenches that do the work of the multipliers of a closed chain's equations, which are written at the origin of its base.
  pure subroutine find_map(self, plan, c, state, map)
    class(planar_gradient_type), intent(in) :: self       !< the arithmetic
    type(plan_type), intent(in) :: plan                   !< the plan, planar
    integer, intent(in) :: c                              !< number of the closure
    type(state_type), intent(in) :: state                 !< the motion
    real(wp), intent(inout) :: map(:, :)                  !< (3,3) a wrench for each multiplier
    real(wp) :: per_length

    per_length = 1.0_wp/plan%planar%length
    associate (base => state%planar%pose(3:4, plan%planar%closures(c)%base))
      map(:, 1) = [1.0_wp, 0.0_wp, 0.0_wp]
      map(:, 2) = [-per_length*base(2), per_length, 0.0_wp]
      map(:, 3) = [per_length*base(1), 0.0_wp, per_length]
    end associate
  end subroutine find_map

  !> The twists of constants of the mechanism, seen from frame 0, with their derivatives in time.
  pure subroutine carry(self, plan, state, twists, constants, again, series)
    class(planar_gradient_type), intent(in) :: self           !< the arithmetic
    type(plan_type), intent(in) :: plan                       !< the plan, planar
    type(state_type), intent(in) :: state                     !< the motion
    type(frame_twists_type), intent(in) :: twists             !< of its frames
    type(varied_constant_type), intent(in) :: constants(:)    !< the constants, in the plane
    logical, intent(in) :: again                              !< twists of the ground are in `series` already
    real(wp), intent(inout), contiguous :: series(:, 0:, :)   !< (3,0:2,constants) gets the twists

    call carry_in_plane(size(constants), constants, state%planar, 2, again, series)
  end subroutine carry

  !> A twist in space, in the axes of frame 0.
  pure function twist_in_space(self, twist) result(whole)
    class(planar_gradient_type), intent(in) :: self       !< the arithmetic
    real(wp), intent(in) :: twist(:)                      !< (3) the twist
    real(wp) :: whole(6)

    whole(1:3) = twist(1)*self%axes(:, 3)
    whole(4:6) = twist(2)*self%axes(:, 1) + twist(3)*self%axes(:, 2)
  end function twist_in_space

  !> A wrench from its six numbers in space, in the axes of frame 0.
  pure subroutine reduced_wrench(self, whole, wrench)
    class(planar_gradient_type), intent(in) :: self       !< the arithmetic
    real(wp), intent(in) :: whole(6)                      !< in space
    real(wp), intent(out) :: wrench(:)                    !< (3) what does work in the plane

    wrench(1) = dot_product(whole(1:3), self%axes(:, 3))
    wrench(2) = dot_product(whole(4:6), self%axes(:, 1))
    wrench(3) = dot_product(whole(4:6), self%axes(:, 2))
  end subroutine reduced_wrench
end module mech9_planar_gradient
