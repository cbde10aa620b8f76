!> The plan holds everything about a mechanism that can be decided once, in a form that is ready for execution.
!>
!> Each pair is one *step* from a frame to a new frame; frame 0 belongs to link 1, frame s is reached by step s. A frame sits on
!> the axis of the pair by which it was reached, with that axis as its z, so that a step with a fixed axis is one constant pose
!> followed by one turn and one slide. A step that would reach a link already known makes a second frame of that link instead,
!> and a *closure* says at which pose this frame must be. Steps are grouped in *blocks*: the chains whose closures are solved
!> together; blocks are executed in order. A coupling is a closure with one equation between the coordinates of some steps.
!>
!> An *arithmetic*, in space or in a plane, computes the poses and velocities of the frames of a block; a *constraint* gives
!> the equations that a chain must satisfy. Both are abstract here.
module mech9_plan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_pose, only: pose_type
  use mech9_pair, only: pair_slot_type
  use mech9_coupling, only: coupling_slot_type, curve_order
  use mech9_planar_plan, only: planar_plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: plan_type, step_type, closure_type, loop_type, block_type, arithmetic_type, arithmetic_slot_type, &
    constraint_type, constraint_slot_type, new_state, copy_plan, within_range, without_periods

  !> One step: from frame `parent` through pair `coordinate` to the frame of the step's own number.
  type :: step_type
    integer :: parent = 0           !< frame from which the step leads
    integer :: coordinate = 0       !< number of the pair and its coordinate
    integer :: link = 0             !< number of the link whose frame, or second frame, is reached
    integer :: chain = 0            !< number of its chain among all chains of the structural vectors
    logical :: reversed = .false.   !< the step leads from the moving link of the pair to its reference link
    logical :: is_screw = .true.    !< the axis is fixed; otherwise plan%pairs(coordinate) gives the motion
    logical :: dependent = .true.   !< the coordinate is dependent
    type(pose_type) :: before       !< pose of the axis, or of the pair's frame from which the step leads, in the parent frame
    real(wp) :: turn = 0.0_wp       !< rotation about z per unit of q, sign by direction
    real(wp) :: slide = 0.0_wp      !< advance along z per unit of q, sign by direction
    real(wp) :: offset = 0.0_wp     !< added to q [rad, m]
    real(wp) :: period = 0.0_wp     !< change of q that leads to the same position: a full turn [rad], a closed curve [m]; 0: none
    logical :: searchable = .true.  !< q can be changed in a search; a user's pair may have no pose elsewhere
    real(wp) :: range(2) = [-huge(1.0_wp), huge(1.0_wp)]   !< least and greatest q [rad, m]
  end type step_type

  !> Steps of a loop, in ascending order.
  type :: loop_type
    integer, allocatable :: steps(:)    !< their numbers
    real(wp), allocatable :: signs(:)   !< +1 for a step towards the closing frame, -1 for one towards the target
    !> Frames from which these steps lead to the closing frame and to the target; the same in a whole loop. In a plane of a
    !> spatial mechanism, 0 stands for its base.
    integer :: stems(2) = 0
  end type loop_type

  !> A closed chain: frame `closing` coincides with `in_target` of frame `target`. Or a coupling: its loop consists of the steps of
  !> its coordinates, one sign for all, and it has no frames.
  type :: closure_type
    integer :: chain = 0           !< number of the closed chain, as in nrw; of a coupling: its number with a minus sign
    integer :: coupling = 0        !< number of the coupling; 0 for a closed chain
    real(wp) :: weight = 1.0_wp    !< factor of a coupling's equation
    integer :: closing = 0         !< the frame made by the chain's last step
    integer :: target = 0          !< the other frame of that link
    type(pose_type) :: in_target   !< pose that the closing frame must have in the target frame
    integer :: base = 0            !< frame in which the loop starts, the last that the paths to both ends have in common
    integer :: rank = 6            !< number of equations, the dimension of the space of motions of the loop
    !> Number of equations that are independent while the loop moves; less than `rank` where it is overconstrained.
    integer :: independent_equations = 6
    !> Rows that select the equations from a screw (w, v/length) at the base frame's origin,
    !> in its axes: orthonormal, constant. Only the first `rank` count.
    real(wp) :: rows(6, 6) = 0.0_wp
    type(loop_type) :: loop   !< from the base frame
    type(loop_type) :: part   !< its steps in the block that solves it
  end type closure_type

  !> Chains that are solved together (or pieces of open chains: no closures). A step belongs to the
  !> block that determines its coordinate, one with an independent coordinate to the first block that needs it.
  type :: block_type
    integer :: first_step = 0, last_step = 0         !< its steps
    integer :: last_moved = huge(1)                  !< last frame whose acceleration is used outside the block
    integer :: first_closure = 1, last_closure = 0   !< its closures, which are also its constraints
    integer, allocatable :: chains(:)                !< numbers of its closed chains, as in nrw, and of couplings, negative
    integer :: equations = 0                         !< number of equations of its constraints
    integer :: arithmetic = 1                        !< number among the plan's arithmetics; 0: each step in that of its own block
    logical :: is_shown = .false.                    !< some of its frames are planar and are read in space
    logical :: whole_loops = .false.                 !< all coordinates of the loops are unknowns, also those of earlier blocks
    logical :: is_constant = .false.                 !< its Jacobian is constant: nothing turns in its loops, couplings are linear
    logical :: is_linear = .false.                   !< all its closures are linear couplings
    real(wp) :: regular_pivot = 0.0_wp               !< far from singular positions, by a coupling that is not linear; 0: none
    integer, allocatable :: unknowns(:)              !< steps of its dependent coordinates
    integer, allocatable :: coordinates(:)           !< its dependent coordinates, in the order of `unknowns`
  end type block_type

  !> An arithmetic for the poses, velocities and accelerations of the frames of a block. It has no data.
  type, abstract :: arithmetic_type
  contains
    procedure(make_frames_interface), deferred, nopass :: make_frames
    procedure(place_interface), deferred, nopass :: place
    procedure(change_interface), deferred, nopass :: place_after_change
    procedure(spread_interface), deferred, nopass :: spread_velocities
    procedure(spread_interface), deferred, nopass :: spread_accelerations
    procedure(link_motion_interface), deferred, nopass :: link_motion
    procedure(point_motion_interface), deferred, nopass :: point_motion
    procedure(link_turning_interface), deferred, nopass :: link_turning
    procedure(step_screw_interface), deferred, nopass :: step_screw
  end type arithmetic_type

  !> One of several arithmetics.
  type :: arithmetic_slot_type
    class(arithmetic_type), allocatable :: kind
  end type arithmetic_slot_type

  !> Equations that the coordinates must satisfy; residuals are in rad for rotations, in parts of plan%length for translations.
  type, abstract :: constraint_type
    integer :: equations = 0   !< their number
  contains
    procedure(residual_interface), deferred :: residual
    procedure(jacobian_interface), deferred :: jacobian
    procedure(column_interface), deferred :: column
    procedure(rates_interface), deferred :: rates
    procedure(opening_interface), deferred :: opening
    procedure(gap_interface), deferred :: gap
  end type constraint_type

  !> One of several constraints.
  type :: constraint_slot_type
    class(constraint_type), allocatable :: item
  end type constraint_slot_type

  !> The plan of a mechanism.
  type :: plan_type
    integer :: n_links = 0                          !< N
    integer :: n_coordinates = 0                    !< M
    real(wp) :: length = 1.0_wp                     !< the mechanism's size [m], by which translations are divided
    real(wp) :: least_length = huge(1.0_wp)         !< length of the shortest link whose pairs are apart [m]
    integer :: shortest_link = 0                    !< number of that link; 0: none
    real(wp) :: data_tolerance = 0.0_wp             !< allowed residual of redundant equations: rad, parts of `length`
    real(wp) :: origin(3) = 0.0_wp                  !< origin of frame 0 in link 1 [m]
    type(step_type), allocatable :: steps(:)        !< (M)
    type(closure_type), allocatable :: closures(:)  !< in the order of blocks
    type(constraint_slot_type), allocatable :: constraints(:)   !< constraint c is that of closure c
    type(arithmetic_slot_type), allocatable :: arithmetics(:)   !< all that blocks use; the first is that of the mechanism
    type(block_type), allocatable :: blocks(:)      !< in the order of execution
    integer, allocatable :: step_of(:)              !< step of each coordinate
    integer, allocatable :: frame_of(:)             !< first frame of each link
    type(pose_type), allocatable :: link_in_frame(:)  !< each link's own system in its first frame
    real(wp), allocatable :: unit_of(:)             !< unit of each coordinate: 1 rad, or `length`
    real(wp), allocatable :: result_unit(:)         !< (M) one unit of each coordinate in results and messages [rad, m]
    real(wp), allocatable :: rate_unit(:)           !< (M) one unit of the rate of each coordinate in them [rad/s, m/s]
    character(len=12) :: rate_names = ''            !< units of rates of angles and of lengths in them, as rad/s, m/s
    integer, allocatable :: independent(:)          !< coordinates, ascending
    logical, allocatable :: driven(:)               !< (M) a drive gives the motion of the coordinate
    integer, allocatable :: free(:)                 !< independent coordinates without a drive, ascending
    integer, allocatable :: free_places(:)          !< their places among the independent ones
    type(pair_slot_type), allocatable :: pairs(:)   !< (M) only pairs without a fixed axis are set
    type(coupling_slot_type), allocatable :: couplings(:)   !< of the mechanism
    logical :: has_curves = .false.                 !< some of them are not linear
    type(planar_plan_type) :: planar                !< the plan in planar arithmetic, as far as that can be used
  end type plan_type

  abstract interface

    !> Room in a state for frames 0 .. m, all in the place of frame 0 and at rest.
    pure subroutine make_frames_interface(m, state)
      import :: state_type
      integer, intent(in) :: m                   !< steps
      type(state_type), intent(inout) :: state   !< gets room for the frames
    end subroutine make_frames_interface

    !> Poses of frames and the screws of their steps, from the coordinates in `state`. The frames that they start from must
    !> be in place. Fails only where a user pair has no pose.
    subroutine place_interface(plan, first, last, state, err)
      import :: plan_type, state_type, error_type
      type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
      integer, intent(in) :: first                        !< frames from this one
      integer, intent(in) :: last                         !< to this one
      type(state_type), intent(inout) :: state            !< coordinates in; poses and screws of these frames out
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine place_interface

    !> Poses of frames after a small change of the coordinates of some steps. The cosines and sines of their angles are
    !> corrected to second order and not computed anew.
    subroutine change_interface(plan, first, last, changed, change, state, err)
      import :: plan_type, state_type, error_type, wp
      type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
      integer, intent(in) :: first                        !< frames from this one
      integer, intent(in) :: last                         !< to this one
      integer, intent(in) :: changed(:)                   !< steps
      real(wp), intent(in) :: change(:)                   !< of their coordinates, in units of these
      type(state_type), intent(inout) :: state            !< its coordinates are changed already
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine change_interface

    !> Velocities, or accelerations, of frames from those of the coordinates in `state`.
    pure subroutine spread_interface(plan, first, last, state)
      import :: plan_type, state_type
      type(plan_type), intent(in) :: plan        !< the plan of the mechanism
      integer, intent(in) :: first               !< frames from this one
      integer, intent(in) :: last                !< to this one
      type(state_type), intent(inout) :: state   !< coordinates and their rates in; the motion of these frames out
    end subroutine spread_interface

    !> A link's own system, its angular velocity and the velocity of its origin, in the system of link 1.
    pure subroutine link_motion_interface(plan, state, link, r, p, omega, v)
      import :: plan_type, state_type, wp
      type(plan_type), intent(in) :: plan     !< the plan of the mechanism
      type(state_type), intent(in) :: state   !< with the motion of the frames
      integer, intent(in) :: link             !< number of the link
      real(wp), intent(out) :: r(3, 3)        !< rotation
      real(wp), intent(out) :: p(3)           !< origin [m]
      real(wp), intent(out) :: omega(3)       !< [rad/s]
      real(wp), intent(out) :: v(3)           !< of the origin [m/s]
    end subroutine link_motion_interface

    !> Position, velocity and acceleration of a point of a link, in the system of link 1.
    pure subroutine point_motion_interface(plan, state, link, place, position, velocity, acceleration)
      import :: plan_type, state_type, wp
      type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
      type(state_type), intent(in) :: state                !< with the motion of the frames
      integer, intent(in) :: link                          !< number of the link
      real(wp), intent(in) :: place(3)                     !< of the point, in the link's own system [m]
      real(wp), intent(out) :: position(3)                 !< [m]
      real(wp), intent(out), optional :: velocity(3)       !< [m/s]
      real(wp), intent(out), optional :: acceleration(3)   !< [m/s^2]
    end subroutine point_motion_interface

    !> The angular acceleration of a link, in the axes of link 1.
    pure subroutine link_turning_interface(plan, state, link, alpha)
      import :: plan_type, state_type, wp
      type(plan_type), intent(in) :: plan     !< the plan of the mechanism
      type(state_type), intent(in) :: state   !< with the accelerations of the frames
      integer, intent(in) :: link             !< number of the link
      real(wp), intent(out) :: alpha(3)       !< [rad/s^2]
    end subroutine link_turning_interface

    !> The angular velocity and the velocity of the new frame's origin that a step gives per unit rate, and the position of
    !> this origin, in the axes of frame 0, from its origin.
    pure subroutine step_screw_interface(plan, state, s, w, v, place)
      import :: plan_type, state_type, wp
      type(plan_type), intent(in) :: plan     !< the plan of the mechanism
      type(state_type), intent(in) :: state   !< with the motion of the frames
      integer, intent(in) :: s                !< step
      real(wp), intent(out) :: w(3)           !< [rad per unit of q]
      real(wp), intent(out) :: v(3)           !< [m per unit of q]
      real(wp), intent(out) :: place(3)       !< [m]
    end subroutine step_screw_interface

    !> The residual of the equations at the position in `state`: rad, parts of plan%length.
    pure subroutine residual_interface(self, plan, state, values)
      import :: constraint_type, plan_type, state_type, wp
      class(constraint_type), intent(in) :: self       !< the constraint
      type(plan_type), intent(in) :: plan              !< the plan of the mechanism
      type(state_type), intent(in) :: state            !< with the position of the frames
      real(wp), intent(out), contiguous :: values(:)   !< (equations)
    end subroutine residual_interface

    !> Derivatives of the equations with respect to the coordinates of steps of a loop, each in its unit, into the rows from
    !> `row` + 1 on. Columns of other coordinates are left as they are, and steps before those of the block are left out; an
    !> allocatable argument knows the number of its first step.
    pure subroutine jacobian_interface(self, plan, loop, column_of, state, row, matrix)
      import :: constraint_type, plan_type, loop_type, state_type, wp
      class(constraint_type), intent(in) :: self            !< the constraint
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(loop_type), intent(in) :: loop                   !< the steps
      integer, allocatable, intent(in) :: column_of(:)      !< (steps of the block) column of each step; 0: none
      type(state_type), intent(in) :: state                 !< with the position of the frames
      integer, intent(in) :: row                            !< number of rows of `matrix` before those of this constraint
      real(wp), intent(inout), contiguous :: matrix(:, :)   !< Jacobian of all constraints of the block
    end subroutine jacobian_interface

    !> Derivatives of the equations with respect to the coordinate of one step, in its unit.
    pure subroutine column_interface(self, plan, s, sign, state, values)
      import :: constraint_type, plan_type, state_type, wp
      class(constraint_type), intent(in) :: self       !< the constraint
      type(plan_type), intent(in) :: plan              !< the plan of the mechanism
      integer, intent(in) :: s                         !< step
      real(wp), intent(in) :: sign                     !< of the step in the loop
      type(state_type), intent(in) :: state            !< with the position of the frames
      real(wp), intent(out), contiguous :: values(:)   !< (equations)
    end subroutine column_interface

    !> First or second time derivatives of the residual at the rates, or rates and accelerations, in `state`.
    pure subroutine rates_interface(self, plan, order, state, values)
      import :: constraint_type, plan_type, state_type, wp
      class(constraint_type), intent(in) :: self       !< the constraint
      type(plan_type), intent(in) :: plan              !< the plan of the mechanism
      integer, intent(in) :: order                     !< 1 or 2
      type(state_type), intent(in) :: state            !< with the velocities, or velocities and accelerations, of the frames
      real(wp), intent(out), contiguous :: values(:)   !< (equations)
    end subroutine rates_interface

    !> The equations' values for a motion of the closing frame relative to the target.
    pure subroutine opening_interface(self, plan, state, w, v, values)
      import :: constraint_type, plan_type, state_type, wp
      class(constraint_type), intent(in) :: self       !< the constraint
      type(plan_type), intent(in) :: plan              !< the plan of the mechanism
      type(state_type), intent(in) :: state            !< with the position of the frames
      real(wp), intent(in) :: w(3)                     !< angular velocity, in the axes of frame 0
      real(wp), intent(in) :: v(3)                     !< velocity of the closing frame's origin, in the axes of frame 0 [m]
      real(wp), intent(out), contiguous :: values(:)   !< (equations)
    end subroutine opening_interface

    !> The residual of all equations, redundant ones included, as a length [m]; rotations are multiplied by the
    !> mechanism's size.
    pure real(wp) function gap_interface(self, plan, state)
      import :: constraint_type, plan_type, state_type, wp
      class(constraint_type), intent(in) :: self   !< the constraint
      type(plan_type), intent(in) :: plan          !< the plan of the mechanism
      type(state_type), intent(in) :: state        !< with the position of the frames
    end function gap_interface
  end interface

contains

  !> A value of a step's coordinate that a search has changed, thrown back from the ends of its range into it.
  pure real(wp) function within_range(step, q) result(inside)
    type(step_type), intent(in) :: step   !< the step
    real(wp), intent(in) :: q             !< value of its coordinate [rad, m]
    real(wp) :: width

    inside = q
    if (q >= step%range(1) .and. q <= step%range(2)) return
    width = step%range(2) - step%range(1)
    inside = modulo(q - step%range(1), 2.0_wp*width)
    inside = step%range(1) + min(inside, 2.0_wp*width - inside)
  end function within_range

  !> A difference of values of a step's coordinate without whole periods, at most half a period.
  pure real(wp) function without_periods(step, difference) result(rest)
    type(step_type), intent(in) :: step       !< the step
    real(wp), intent(in) :: difference        !< of two values of its coordinate [rad, m]

    rest = difference
    if (step%period > 0.0_wp) rest = difference - step%period*anint(difference/step%period)
  end function without_periods

  !> A state with room for all frames of a plan; all its numbers are zero, and nothing is known.
  pure function new_state(plan) result(state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type) :: state
    integer :: i

    allocate (state%q(plan%n_coordinates), state%dq(plan%n_coordinates), state%ddq(plan%n_coordinates), source=0.0_wp)
    if (plan%has_curves) allocate (state%curve(0:curve_order, size(plan%couplings)), source=0.0_wp)
    do i = 1, size(plan%arithmetics)
      call plan%arithmetics(i)%kind%make_frames(plan%n_coordinates, state)
    end do
  end function new_state

  !> Copy a plan. The assignment stands here alone, because compilers write it out for all components.
  pure subroutine copy_plan(from, to)
    type(plan_type), intent(in) :: from    !< the plan
    type(plan_type), intent(inout) :: to   !< the same afterwards

    to = from
  end subroutine copy_plan
end module mech9_plan
