!> The operations of the derivatives of required forces that differ between space and a plane.
module mech9_gradient_arithmetic
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_variation, only: third_derivatives_type
  use mech9_twists, only: frame_twists_type
  use mech9_parameter_support, only: varied_constant_type
  implicit none
  private
  public :: gradient_arithmetic_type

  !> The bodies of a mechanism in the arithmetic of a plane or of space. Twists have d numbers, a rotation, then the shift of the point
  !> at the origin of frame 0; wrenches have a moment about this origin, then a force.
  type, abstract :: gradient_arithmetic_type
    integer :: d = 0                        !< numbers of a twist
    integer, allocatable :: body_frames(:)  !< numbers of the frames in which the bodies are fixed
  contains
    procedure(find_twists_interface), deferred :: find_twists
    procedure(find_wrenches_interface), deferred :: find_wrenches
    procedure(add_rows_interface), deferred :: add_rows
    procedure(flatten_interface), deferred :: flatten_body
    procedure(body_wrench_interface), deferred :: body_wrench
    procedure(by_gravity_interface), deferred :: by_gravity
    procedure(find_map_interface), deferred :: find_map
    procedure(carry_interface), deferred :: carry
    procedure(in_space_interface), deferred :: twist_in_space
    procedure(reduce_interface), deferred :: reduced_wrench
  end type gradient_arithmetic_type

  abstract interface
    !> The twists of frames and steps in the present motion.
    pure subroutine find_twists_interface(self, plan, state, third, twists)
      import :: gradient_arithmetic_type, plan_type, state_type, third_derivatives_type, frame_twists_type
      class(gradient_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan, in this arithmetic
      type(state_type), intent(in) :: state                 !< the motion
      type(third_derivatives_type), intent(in) :: third     !< of pairs without a fixed axis
      type(frame_twists_type), intent(inout) :: twists      !< gets the twists
    end subroutine find_twists_interface

    !> Add the wrenches that the bodies need beyond their weights to those of their frames.
    pure subroutine find_wrenches_interface(self, state, wrenches)
      import :: gradient_arithmetic_type, state_type, wp
      class(gradient_arithmetic_type), intent(inout) :: self   !< gets the motion of the bodies
      type(state_type), intent(in) :: state                    !< the motion
      real(wp), intent(inout) :: wrenches(:, 0:)               !< (d,0:M) the sums
    end subroutine find_wrenches_interface

    !> Add the rows of the bodies' inertial forces, less their weights, in a virtual motion, as seen by observers who move with them.
    pure subroutine add_rows_interface(self, virtual, rows)
      import :: gradient_arithmetic_type, wp
      class(gradient_arithmetic_type), intent(in) :: self   !< with the motion of the bodies
      real(wp), intent(in) :: virtual(:, 0:)                !< (d,0:M) twists of the frames in the virtual motion
      real(wp), intent(inout) :: rows(:, 0:, 0:)            !< (d,0:2,0:M) the sums
    end subroutine add_rows_interface

    !> The change of mass, centre and inertia of a body in the form that `body_wrench` takes.
    pure function flatten_interface(self, plan, number, change) result(numbers)
      import :: gradient_arithmetic_type, plan_type, wp
      class(gradient_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan, in this arithmetic
      integer, intent(in) :: number                         !< of the body in this arithmetic
      real(wp), intent(in) :: change(13)                    !< mass, centre and inertia by columns, in the link's own axes
      real(wp) :: numbers(13)
    end function flatten_interface

    !> The change of the wrench that a body needs beyond its weight, by its numbers.
    pure subroutine body_wrench_interface(self, state, number, change, wrench)
      import :: gradient_arithmetic_type, state_type, wp
      class(gradient_arithmetic_type), intent(in) :: self   !< with the motion of the bodies
      type(state_type), intent(in) :: state                 !< the motion
      integer, intent(in) :: number                         !< of the body in this arithmetic
      real(wp), intent(in) :: change(13)                    !< as from `flatten_body`
      real(wp), intent(out) :: wrench(:)                    !< (d) on the frame of the body
    end subroutine body_wrench_interface

    !> The change of the force that a virtual motion requires, by gravity.
    pure function by_gravity_interface(self, virtual, change) result(row)
      import :: gradient_arithmetic_type, wp
      class(gradient_arithmetic_type), intent(in) :: self   !< with the motion of the bodies
      real(wp), intent(in) :: virtual(:, 0:)                !< (d,0:M) twists of the frames in the virtual motion
      real(wp), intent(in) :: change(3)                     !< of gravity, in the axes of frame 0
      real(wp) :: row
    end function by_gravity_interface

    !> The wrenches that do the work of the multipliers of a closed chain's equations.
    pure subroutine find_map_interface(self, plan, c, state, map)
      import :: gradient_arithmetic_type, plan_type, state_type, wp
      class(gradient_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan, in this arithmetic
      integer, intent(in) :: c                              !< number of the closure
      type(state_type), intent(in) :: state                 !< the motion
      real(wp), intent(inout) :: map(:, :)                  !< (d,equations) a wrench for each multiplier
    end subroutine find_map_interface

    !> The twists of constants of the mechanism, seen from frame 0, with their derivatives in time.
    pure subroutine carry_interface(self, plan, state, twists, constants, again, series)
      import :: gradient_arithmetic_type, plan_type, state_type, frame_twists_type, varied_constant_type, wp
      class(gradient_arithmetic_type), intent(in) :: self       !< the arithmetic
      type(plan_type), intent(in) :: plan                       !< the plan, in this arithmetic
      type(state_type), intent(in) :: state                     !< the motion
      type(frame_twists_type), intent(in) :: twists             !< of its frames
      type(varied_constant_type), intent(in) :: constants(:)    !< the constants
      logical, intent(in) :: again                              !< twists of the ground are in `series` already
      real(wp), intent(inout), contiguous :: series(:, 0:, :)   !< (d,0:2,constants) gets the twists
    end subroutine carry_interface

    !> A twist in space, in the axes of frame 0.
    pure function in_space_interface(self, twist) result(whole)
      import :: gradient_arithmetic_type, wp
      class(gradient_arithmetic_type), intent(in) :: self   !< the arithmetic
      real(wp), intent(in) :: twist(:)                      !< (d) the twist
      real(wp) :: whole(6)
    end function in_space_interface

    !> A wrench from its six numbers in space, in the axes of frame 0.
    pure subroutine reduce_interface(self, whole, wrench)
      import :: gradient_arithmetic_type, wp
      class(gradient_arithmetic_type), intent(in) :: self   !< the arithmetic
      real(wp), intent(in) :: whole(6)                      !< in space
      real(wp), intent(out) :: wrench(:)                    !< (d) what does work in this arithmetic
    end subroutine reduce_interface
  end interface
end module mech9_gradient_arithmetic
