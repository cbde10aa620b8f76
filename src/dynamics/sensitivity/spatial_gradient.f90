!> Derivatives of required forces in space: a twist is a rotation and the shift of the point at the origin of frame 0, a wrench a
!> moment about this origin and a force, all in the axes of frame 0.
module mech9_spatial_gradient
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_inertia, only: inertia_in_axes
  use mech9_rotation, only: turn, cross
  use mech9_pose, only: transformed
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_variation, only: third_derivatives_type
  use mech9_twists, only: frame_twists_type, find_frame_twists, find_step_twists
  use mech9_parameter_support, only: varied_constant_type
  use mech9_twists_at_position, only: carry_in_space
  use mech9_gradient_arithmetic, only: gradient_arithmetic_type
  implicit none
  private
  public :: spatial_gradient_type, new_spatial_gradient

  !> A body in its frame, with its present motion.
  type :: moving_body_type
    integer :: link = 0                   !< number of its link
    integer :: frame = 0                  !< number of the link's first frame
    real(wp) :: mass = 0.0_wp             !< [kg]
    real(wp) :: centre(3) = 0.0_wp        !< mass centre, from the frame's origin, in the frame's axes [m]
    real(wp) :: inertia(3, 3) = 0.0_wp    !< about the centre, in the frame's axes [kg m^2]
    real(wp) :: place(3) = 0.0_wp         !< mass centre, from the origin of frame 0 [m]
    real(wp) :: tensor(3, 3) = 0.0_wp     !< about the centre, in the axes of frame 0 [kg m^2]
    real(wp) :: omega(3) = 0.0_wp         !< angular velocity [rad/s]
    real(wp) :: alpha(3) = 0.0_wp         !< angular acceleration [rad/s^2]
    real(wp) :: velocity(3) = 0.0_wp      !< of the centre [m/s]
    real(wp) :: proper(3) = 0.0_wp        !< acceleration of the centre less gravity [m/s^2]
  end type moving_body_type

  !> The bodies in space.
  type, extends(gradient_arithmetic_type) :: spatial_gradient_type
    type(moving_body_type), allocatable, private :: bodies(:)   !< links with mass or inertia
    integer, allocatable, private :: frames(:)                  !< numbers of all frames, from 0 on
    real(wp), private :: gravity(3) = 0.0_wp                    !< [m/s^2]
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
  end type spatial_gradient_type

contains

  !> The bodies of a mechanism in space.
  subroutine new_spatial_gradient(mechanism, plan, numbers, self)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(plan_type), intent(in) :: plan                    !< its plan, in space
    integer, intent(in) :: numbers(:)                      !< numbers of the bodies that count
    type(spatial_gradient_type), intent(out) :: self       !< the arithmetic
    integer :: i

    self%d = 6
    self%gravity = mechanism%gravity
    self%frames = [(i, i=0, plan%n_coordinates)]
    allocate (self%bodies(size(numbers)))
    do i = 1, size(numbers)
      associate (given => mechanism%bodies(numbers(i)), body => self%bodies(i))
        body%link = given%link
        body%frame = plan%frame_of(given%link)
        body%mass = given%mass
        body%centre = transformed(plan%link_in_frame(given%link), given%centre)
        body%inertia = inertia_in_axes(plan%link_in_frame(given%link)%r, given%inertia)
      end associate
    end do
    self%body_frames = self%bodies%frame
  end subroutine new_spatial_gradient

  !> The twists of frames and steps in the present motion.
  pure subroutine find_twists(self, plan, state, third, twists)
    class(spatial_gradient_type), intent(in) :: self      !< the arithmetic
    type(plan_type), intent(in) :: plan                   !< the plan, in space
    type(state_type), intent(in) :: state                 !< the motion
    type(third_derivatives_type), intent(in) :: third     !< of pairs without a fixed axis
    type(frame_twists_type), intent(inout) :: twists      !< gets the twists

    call find_frame_twists(state, self%frames, 2, twists)
    call find_step_twists(plan, state, third, self%frames(2:), 2, twists)
  end subroutine find_twists

  !> Add the wrenches that the bodies need beyond their weights to those of their frames.
  pure subroutine find_wrenches(self, state, wrenches)
    class(spatial_gradient_type), intent(inout) :: self   !< gets the motion of the bodies
    type(state_type), intent(in) :: state                 !< the motion
    real(wp), intent(inout) :: wrenches(:, 0:)            !< (6,0:M) the sums
    real(wp) :: arm(3), force(3)
    integer :: i, s

    do i = 1, size(self%bodies)
      s = self%bodies(i)%frame
      associate (body => self%bodies(i))
        arm = turn(state%r(:, :, s), body%centre)
        body%place = state%p(:, s) + arm
        body%tensor = inertia_in_axes(state%r(:, :, s), body%inertia)
        body%omega = state%omega(:, s)
        body%alpha = state%alpha(:, s)
        body%velocity = state%v(:, s) + cross(body%omega, arm)
        body%proper = state%a(:, s) + cross(body%alpha, arm) + cross(body%omega, cross(body%omega, arm)) - self%gravity
        force = body%mass*body%proper
        wrenches(1:3, s) = wrenches(1:3, s) + turn(body%tensor, body%alpha) + cross(body%omega, turn(body%tensor, body%omega)) &
                           + cross(body%place, force)
        wrenches(4:6, s) = wrenches(4:6, s) + force
      end associate
    end do
  end subroutine find_wrenches

  !> Add the rows of the bodies' inertial forces, less their weights, in a virtual motion. Those by the rate of change of a twist, and
  !> by the twist itself, are couples.
  pure subroutine add_rows(self, virtual, rows)
    class(spatial_gradient_type), intent(in) :: self      !< with the motion of the bodies
    real(wp), intent(in) :: virtual(:, 0:)                !< (6,0:M) twists of the frames in the virtual motion
    real(wp), intent(inout) :: rows(:, 0:, 0:)            !< (6,0:2,0:M) the sums
    real(wp) :: w(3), spin(3), p(3)
    integer :: i, s

    do i = 1, size(self%bodies)
      s = self%bodies(i)%frame
      associate (body => self%bodies(i))
        w = virtual(1:3, s)
        p = body%mass*(virtual(4:6, s) + cross(w, body%place))
        spin = turn(body%tensor, w)
        rows(1:3, 2, s) = rows(1:3, 2, s) + spin + cross(body%place, p)
        rows(4:6, 2, s) = rows(4:6, 2, s) + p
        rows(1:3, 1, s) = rows(1:3, 1, s) + 2.0_wp*cross(body%velocity, p) + cross(body%omega, spin) &
                          - cross(w, turn(body%tensor, body%omega)) - turn(body%tensor, cross(body%omega, w))
        rows(1:3, 0, s) = rows(1:3, 0, s) + cross(self%gravity, p)
      end associate
    end do
  end subroutine add_rows

  !> The change of mass, centre and inertia in the frame's axes.
  pure function flatten_body(self, plan, number, change) result(numbers)
    class(spatial_gradient_type), intent(in) :: self      !< the arithmetic
    type(plan_type), intent(in) :: plan                   !< the plan, in space
    integer, intent(in) :: number                         !< of the body in this arithmetic
    real(wp), intent(in) :: change(13)                    !< mass, centre and inertia by columns, in the link's own axes
    real(wp) :: numbers(13), r(3, 3)

    r = plan%link_in_frame(self%bodies(number)%link)%r
    numbers(1) = change(1)
    numbers(2:4) = turn(r, change(2:4))
    numbers(5:13) = reshape(inertia_in_axes(r, reshape(change(5:13), [3, 3])), [9])
  end function flatten_body

  !> The change of the wrench that a body needs beyond its weight, by its numbers.
  pure subroutine body_wrench(self, state, number, change, wrench)
    class(spatial_gradient_type), intent(in) :: self      !< with the motion of the bodies
    type(state_type), intent(in) :: state                 !< the motion
    integer, intent(in) :: number                         !< of the body in this arithmetic
    real(wp), intent(in) :: change(13)                    !< as from `flatten_body`
    real(wp), intent(out) :: wrench(:)                    !< (6) on the frame of the body
    real(wp) :: force(3), arm(3), tensor(3, 3)

    associate (body => self%bodies(number), r => state%r(:, :, self%bodies(number)%frame))
      force = change(1)*body%proper
      wrench(1:3) = 0.0_wp
      if (any(abs(change(2:4)) > 0.0_wp)) then
        arm = turn(r, change(2:4))
        force = force + body%mass*(cross(body%alpha, arm) + cross(body%omega, cross(body%omega, arm)))
        wrench(1:3) = body%mass*cross(arm, body%proper)
      end if
      if (any(abs(change(5:13)) > 0.0_wp)) then
        tensor = inertia_in_axes(r, reshape(change(5:13), [3, 3]))
        wrench(1:3) = wrench(1:3) + turn(tensor, body%alpha) + cross(body%omega, turn(tensor, body%omega))
      end if
      wrench(1:3) = wrench(1:3) + cross(body%place, force)
      wrench(4:6) = force
    end associate
  end subroutine body_wrench

  !> The change of the force that a virtual motion requires, by gravity.
  pure function by_gravity(self, virtual, change) result(row)
    class(spatial_gradient_type), intent(in) :: self      !< with the motion of the bodies
    real(wp), intent(in) :: virtual(:, 0:)                !< (6,0:M) twists of the frames in the virtual motion
    real(wp), intent(in) :: change(3)                     !< of gravity, in the axes of frame 0
    real(wp) :: row
    integer :: i

    row = 0.0_wp
    do i = 1, size(self%bodies)
      associate (body => self%bodies(i), t => virtual(:, self%bodies(i)%frame))
        row = row - body%mass*dot_product(change, t(4:6) + cross(t(1:3), body%place))
      end associate
    end do
  end function by_gravity

  !> The wrenches that do the work of the multipliers of a closed chain's equations. All six equations are written at the closing
  !> frame's origin in the axes of frame 0, fewer of them at the base frame's origin in its axes.
  pure subroutine find_map(self, plan, c, state, map)
    class(spatial_gradient_type), intent(in) :: self      !< the arithmetic
    type(plan_type), intent(in) :: plan                   !< the plan, in space
    integer, intent(in) :: c                              !< number of the closure
    type(state_type), intent(in) :: state                 !< the motion
    real(wp), intent(inout) :: map(:, :)                  !< (6,equations) a wrench for each multiplier
    integer :: i

    associate (closure => plan%closures(c), b => plan%closures(c)%base)
      if (closure%rank == 6) then
        map = 0.0_wp
        do i = 1, 3
          map(i, i) = 1.0_wp
          map(3 + i, 3 + i) = 1.0_wp/plan%length
          map(1:3, 3 + i) = cross(state%p(:, closure%closing), map(4:6, 3 + i))
        end do
        return
      end if
      do i = 1, closure%rank
        map(4:6, i) = turn(state%r(:, :, b), closure%rows(4:6, i)/plan%length)
        map(1:3, i) = turn(state%r(:, :, b), closure%rows(1:3, i)) + cross(state%p(:, b), map(4:6, i))
      end do
    end associate
  end subroutine find_map

  !> The twists of constants of the mechanism, seen from frame 0, with their derivatives in time.
  pure subroutine carry(self, plan, state, twists, constants, again, series)
    class(spatial_gradient_type), intent(in) :: self          !< the arithmetic
    type(plan_type), intent(in) :: plan                       !< the plan, in space
    type(state_type), intent(in) :: state                     !< the motion
    type(frame_twists_type), intent(in) :: twists             !< of its frames
    type(varied_constant_type), intent(in) :: constants(:)    !< the constants
    logical, intent(in) :: again                              !< twists of the ground are in `series` already
    real(wp), intent(inout), contiguous :: series(:, 0:, :)   !< (6,0:2,constants) gets the twists

    call carry_in_space(plan, constants, state, twists, 2, again, series)
  end subroutine carry

  !> A twist in space: itself.
  pure function twist_in_space(self, twist) result(whole)
    class(spatial_gradient_type), intent(in) :: self      !< the arithmetic
    real(wp), intent(in) :: twist(:)                      !< (6) the twist
    real(wp) :: whole(6)

    whole = twist
  end function twist_in_space

  !> A wrench in space: itself.
  pure subroutine reduced_wrench(self, whole, wrench)
    class(spatial_gradient_type), intent(in) :: self      !< the arithmetic
    real(wp), intent(in) :: whole(6)                      !< in space
    real(wp), intent(out) :: wrench(:)                    !< (6) the same

    wrench = whole
  end subroutine reduced_wrench
end module mech9_spatial_gradient
