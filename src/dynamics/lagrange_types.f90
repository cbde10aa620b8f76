!> The data of Lagrange's equations: the plan of dynamics, Jacobians and scratch, and the abstract arithmetic, in space or in a
!> plane, that works on them.
!>
!> Columns of Jacobians are kept only where a frame depends on the independent coordinate: frame s has the entries
!> first(s) .. first(s+1)-1 of one long list. All frames of a closed block share one set of coordinates; along an open chain the
!> set grows by each coordinate.
module mech9_lagrange_types
  use mech9_kinds, only: wp
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type
  use mech9_expectation, only: expectation_type
  use mech9_articulated_bodies, only: articulated_work_type
  use mech9_planar_articulated, only: planar_work_type
  implicit none
  private
  public :: frame_body_type, dynamics_plan_type, jacobian_type, lagrange_work_type, dynamics_arithmetic_type

  !> A link with mass, in its frame.
  type :: frame_body_type
    integer :: link = 0
    integer :: frame = 0
    real(wp) :: mass = 0.0_wp             !< [kg]
    real(wp) :: centre(3) = 0.0_wp        !< in the frame [m]
    real(wp) :: inertia(3, 3) = 0.0_wp    !< about the centre, frame axes [kg m^2]
    logical :: is_point = .true.          !< no inertia but its mass
  end type frame_body_type

  !> What Lagrange's equations do in one way in space and in another in a plane; with the constant data that this needs.
  type, abstract :: dynamics_arithmetic_type
  contains
    procedure(work_maker), deferred :: make_work
    procedure(block_factorizer), deferred :: factorize_block
    procedure(block_mover), deferred :: move_regular_block
    procedure(jacobian_spreader), deferred :: spread_jacobian
    procedure(column_finder), deferred :: closing_column
    procedure(inertia_adder), deferred :: add_inertia
    procedure(force_adder), deferred :: add_link_force
    procedure(open_chain_solver), deferred :: solve_open_chains
    procedure(energy_of), deferred :: kinetic_energy
  end type dynamics_arithmetic_type

  !> Everything of dynamics that can be decided once.
  type :: dynamics_plan_type
    type(frame_body_type), allocatable :: bodies(:)    !< none of link 1, none without mass
    real(wp) :: gravity(3) = 0.0_wp                    !< in the axes of frame 0 [m/s^2]
    integer, allocatable :: place_of(:)                !< (M) number of a coordinate among the independent ones, 0
    integer, allocatable :: first(:)                   !< (0:M+1) first entry of each frame
    integer, allocatable :: column(:)                  !< (entries) number of the independent coordinate
    integer, allocatable :: parent_entry(:)            !< (entries) the same column in the parent frame, 0 for none
    integer, allocatable :: target_entry(:)            !< (entries) of closing frames: the same column in the target frame
    logical, allocatable :: carries(:)                 !< (0:M) a mass, a load or a later chain depends on the frame
    integer, allocatable :: acting(:)                  !< numbers of the loads that may move anything
    logical, allocatable :: load_links(:)              !< (N) links whose motion loads ask for
    integer, allocatable :: loaded(:)                  !< the same without link 1, which stays where it is
    logical :: open_chains = .false.                   !< no chain is closed: accelerations by articulated bodies
    class(dynamics_arithmetic_type), allocatable :: arithmetic
  end type dynamics_plan_type

  !> Entries as in the dynamics plan: derivatives of a frame's angular velocity and of the velocity of its
  !> origin (fixed axes) by the rate of an independent coordinate; `b` is dq_k/dq_i of the step's coordinate.
  type :: jacobian_type
    real(wp), allocatable :: w(:, :)    !< (3, entries)
    real(wp), allocatable :: v(:, :)    !< (3, entries)
    real(wp), allocatable :: flat(:, :) !< (3, entries) in planar arithmetic, instead of both
    real(wp), allocatable :: b(:)       !< (entries)
  end type jacobian_type

  !> Scratch and results of one evaluation, sized once.
  type :: lagrange_work_type
    type(block_work_type), allocatable :: blocks(:)
    real(wp), allocatable :: sides(:, :)             !< right-hand sides for B; room for any block
    type(jacobian_type) :: jacobian
    !> What rates and accelerations are expected to be, by continuation from before: B, entry by entry, and
    !> the accelerations that rates alone give. They only count beside noise; zero will do.
    type(expectation_type) :: expectation
    logical :: expects = .false.                     !< the two below are those of this evaluation
    real(wp), allocatable :: expected_b(:)
    real(wp), allocatable :: expected_ddq(:)
    !> Of find_equations, and of find_motion where the plan does without articulated bodies.
    real(wp), allocatable :: coefficients(:, :)      !< a_pr, lower triangle
    real(wp), allocatable :: factors(:, :)
    real(wp), allocatable :: velocity_terms(:)       !< h_p
    real(wp), allocatable :: forces(:)               !< Q_p
    real(wp), allocatable :: accelerations(:)        !< of the independent coordinates
    type(motion_view_type) :: view
    type(force_sum_type) :: sum
    type(articulated_work_type) :: articulated       !< of open chains in space
    type(planar_work_type) :: planar                 !< of open chains in a plane
  end type lagrange_work_type

  abstract interface

    !> Room for the columns of frames and for the passes over open chains.
    pure subroutine work_maker(self, plan, dynamics, work)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(lagrange_work_type), intent(inout) :: work       !< gets the room
    end subroutine work_maker

    !> Factorize the Jacobian of a block at the position in `state`.
    subroutine block_factorizer(self, plan, b, state, work)
      import :: dynamics_arithmetic_type, plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      integer, intent(in) :: b                              !< number of the block
      type(state_type), intent(in) :: state                 !< with the frames in place
      type(lagrange_work_type), intent(inout) :: work       !< gets the factors
    end subroutine block_factorizer

    !> Rates, Jacobian entries and accelerations from rates of a well conditioned block in a way of its own; `moved` is false
    !> where there is none, and nothing is changed then.
    subroutine block_mover(self, plan, dynamics, b, conditioning, state, work, moved)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, state_type, lagrange_work_type, wp
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      integer, intent(in) :: b                              !< number of the block
      real(wp), intent(in) :: conditioning                  !< of its Jacobian
      type(state_type), intent(inout) :: state              !< gets the motion of the block
      type(lagrange_work_type), intent(inout) :: work       !< with the block factorized; gets the entries
      logical, intent(out) :: moved                         !< whether it was done
    end subroutine block_mover

    !> Outward recursion of the Jacobian's entries over the frames of a block.
    pure subroutine jacobian_spreader(self, plan, dynamics, block, state, all_frames, jacobian)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, block_type, state_type, jacobian_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(block_type), intent(in) :: block                 !< the block
      type(state_type), intent(in) :: state                 !< with the frames in place
      logical, intent(in) :: all_frames                     !< also frames that carry nothing
      type(jacobian_type), intent(inout) :: jacobian        !< with `b` of the block's steps
    end subroutine jacobian_spreader

    !> The opening of a closure per unit rate of one independent coordinate, from the entries of its two frames.
    pure subroutine column_finder(self, plan, c, state, jacobian, e, t, column)
      import :: dynamics_arithmetic_type, plan_type, state_type, jacobian_type, wp
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      integer, intent(in) :: c                              !< number of the closure
      type(state_type), intent(in) :: state                 !< with the frames in place
      type(jacobian_type), intent(in) :: jacobian           !< entries of all frames
      integer, intent(in) :: e                              !< entry of the closing frame
      integer, intent(in) :: t                              !< entry of the target frame; 0: it does not move
      real(wp), intent(out), contiguous :: column(:)        !< (rank) in the equations of the closure
    end subroutine column_finder

    !> Add a_pr (21), the velocity terms of (19) and weights of all bodies.
    pure subroutine inertia_adder(self, dynamics, state, work)
      import :: dynamics_arithmetic_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with the accelerations that rates alone give
      type(lagrange_work_type), intent(inout) :: work       !< with the entries of the Jacobian; gets the sums
    end subroutine inertia_adder

    !> Add the generalized forces (25) of the loads on one link.
    pure subroutine force_adder(self, plan, dynamics, state, link, work)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with the frames in place
      integer, intent(in) :: link                           !< that loads act on
      type(lagrange_work_type), intent(inout) :: work       !< with the loads' forces; gets the generalized ones
    end subroutine force_adder

    !> Accelerations of open chains by articulated bodies. `found` is false where a coordinate has no inertia.
    pure subroutine open_chain_solver(self, plan, dynamics, state, work, found)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with the accelerations that rates alone give
      type(lagrange_work_type), intent(inout) :: work       !< with the loads' forces; gets the accelerations
      logical, intent(out) :: found                         !< whether all coordinates have inertia
    end subroutine open_chain_solver

    !> Sum over the bodies of half m v^2 of the centre and half omega . I omega.
    pure real(wp) function energy_of(self, dynamics, state)
      import :: dynamics_arithmetic_type, dynamics_plan_type, state_type, wp
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with its velocities; the result is in J
    end function energy_of
  end interface
end module mech9_lagrange_types
