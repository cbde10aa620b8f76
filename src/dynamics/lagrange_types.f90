!> The data of Lagrange's equations: the plan of dynamics and scratch, and the abstract arithmetic, in space or in a
!> plane, that works on them.
!>
!> Columns of Jacobians are those of the motion relative to the frame on which a cluster stands (mech9_clusters). They are kept
!> only where a frame depends on an independent coordinate of its own cluster: frame s has the entries first(s) .. first(s+1)-1 of
!> one long list. All frames of a closed block share one set of coordinates; the frame of an open step has its own only.
!>
!> "The accelerations that rates alone give" are those of coordinates and frames when the independent coordinates keep their
!> rates. Fixed axes are those of frame 0. Numbers in parentheses are those of the paper's equations.
module mech9_lagrange_types
  use mech9_kinds, only: wp
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type
  use mech9_expectation, only: expectation_type
  use mech9_frame_columns, only: frame_entries_type, jacobian_type
  use mech9_tree_stages, only: stage_type
  use mech9_articulated_bodies, only: articulated_work_type
  use mech9_cluster_bodies, only: cluster_work_type
  use mech9_planar_articulated, only: planar_work_type
  implicit none
  private
  public :: frame_body_type, dynamics_plan_type, dynamics_slot_type, lagrange_work_type, dynamics_arithmetic_type

  !> A link with mass or inertia, in its frame.
  type :: frame_body_type
    integer :: link = 0                   !< number of the link
    integer :: frame = 0                  !< number of its first frame
    real(wp) :: mass = 0.0_wp             !< [kg]
    real(wp) :: centre(3) = 0.0_wp        !< mass centre, from the frame's origin, in the frame's axes [m]
    real(wp) :: inertia(3, 3) = 0.0_wp    !< tensor about the centre, in the frame's axes [kg m^2]
    logical :: is_point = .true.          !< the tensor is zero
  end type frame_body_type

  !> The operations of Lagrange's equations that differ between space and a plane, with the constant data that they use.
  type, abstract :: dynamics_arithmetic_type
  contains
    procedure(work_maker), deferred :: make_work
    procedure(block_factorizer), deferred :: factorize_block
    procedure(block_mover), deferred :: move_regular_block
    procedure(jacobian_spreader), deferred :: spread_jacobian
    procedure(column_finder), deferred :: closing_column
    procedure(inertia_adder), deferred :: add_inertia
    procedure(force_adder), deferred :: add_link_force
    procedure(tree_solver), deferred :: solve_tree
    procedure(tree_weigher), deferred :: weigh_tree
  end type dynamics_arithmetic_type

  !> Holds one arithmetic, so that those of different kinds can stand in one list.
  type :: dynamics_slot_type
    class(dynamics_arithmetic_type), allocatable :: kind   !< the arithmetic
  end type dynamics_slot_type

  !> The plan of dynamics holds everything of dynamics that can be decided once, with the entries of frames.
  type, extends(frame_entries_type) :: dynamics_plan_type
    type(frame_body_type), allocatable :: bodies(:)    !< links with mass or inertia, without link 1
    real(wp) :: gravity(3) = 0.0_wp                    !< in the axes of frame 0 [m/s^2]
    integer, allocatable :: place_of(:)                !< (M) place of a coordinate among the independent ones, or 0
    integer, allocatable :: held(:)                    !< places of driven coordinates among the independent ones
    logical, allocatable :: carries(:)                 !< (0:M) a mass, a load or a later chain depends on the frame
    logical, allocatable :: closed(:)                  !< (0:M) the frame belongs to a closed cluster
    logical, allocatable :: carries_columns(:)         !< (0:M) both; columns of other frames are not used in an evaluation
    integer, allocatable :: acting(:)                  !< numbers of the loads that are not idle
    logical :: stops_alone = .false.                   !< all of them are compliant stops, and there is no motor
    logical, allocatable :: load_links(:)              !< (N) whether a load acts on the link or reads its motion
    integer, allocatable :: loaded(:)                  !< numbers of these links but link 1, which does not move
    integer, allocatable :: first_closed(:)            !< (blocks) first step of the block in its closed cluster, or past its last
    type(stage_type), allocatable :: stages(:)         !< in the order of a sweep outward
    !> Accelerations by articulated bodies. Otherwise there is one closed cluster, on link 1, and they follow from the coefficients.
    logical :: articulated = .false.
    !> The arithmetic of the whole mechanism, in space or in a plane; then, in space, that of blocks in planes.
    type(dynamics_slot_type), allocatable :: arithmetics(:)
    integer, allocatable :: arithmetic_of(:)           !< (blocks) number of the arithmetic in which a block moves
    logical, allocatable :: in_space(:)                !< (0:M) the frame is not in a plane only: the sweeps use its motion in space
  end type dynamics_plan_type

  !> Scratch and results of one evaluation, sized once.
  type :: lagrange_work_type
    type(block_work_type), allocatable :: blocks(:)  !< equations of each block
    real(wp) :: conditioning = 1.0_wp                !< least pivot of a block's Jacobian over its largest, of the worst block
    real(wp), allocatable :: sides(:, :)             !< (equations of the largest block, independent coordinates) sides for B
    type(jacobian_type) :: jacobian                  !< of all frames
    !> B, entry by entry, and accelerations from rates, extrapolated from earlier evaluations. The extrapolated values matter
    !> only where round-off hides the true ones; zeros will do.
    type(expectation_type) :: expectation
    logical :: expects = .false.                     !< the two below are those of this evaluation
    real(wp), allocatable :: expected_b(:)           !< (entries) B
    real(wp), allocatable :: expected_ddq(:)         !< (M) accelerations that rates alone give [rad/s^2, m/s^2]
    !> Results of find_equations; find_motion needs these too, unless articulated bodies give the accelerations.
    real(wp), allocatable :: coefficients(:, :)      !< a_pr, lower triangle
    real(wp), allocatable :: factors(:, :)           !< their Cholesky factors, lower triangle
    real(wp), allocatable :: velocity_terms(:)       !< h_p
    real(wp), allocatable :: forces(:)               !< Q_p [N m or N]
    real(wp), allocatable :: accelerations(:)        !< of the independent coordinates [rad/s^2, m/s^2]
    type(motion_view_type) :: view                   !< the motion as loads read it
    type(force_sum_type) :: sum                      !< forces of all loads
    type(articulated_work_type) :: articulated       !< of articulated bodies in space
    type(planar_work_type) :: planar                 !< of articulated bodies in a plane
    type(cluster_work_type), allocatable :: clusters(:)   !< of each stage that is a closed cluster
  end type lagrange_work_type

  abstract interface

    !> Room for the columns of frames and for the passes of articulated bodies.
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
      type(state_type), intent(in) :: state                 !< with the poses of the frames
      type(lagrange_work_type), intent(inout) :: work       !< gets the factors
    end subroutine block_factorizer

    !> Rates, Jacobian entries and accelerations from rates of a well conditioned block, by a shorter way that an arithmetic may
    !> have. Where it has none, `moved` is false and nothing is changed.
    subroutine block_mover(self, plan, dynamics, b, state, work, moved)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      integer, intent(in) :: b                              !< number of the block
      type(state_type), intent(inout) :: state              !< gets the motion of the block
      type(lagrange_work_type), intent(inout) :: work       !< with the block factorized; gets the entries
      logical, intent(out) :: moved                         !< whether it was done
    end subroutine block_mover

    !> Outward recursion of the Jacobian's entries over the frames of a block that belong to its closed cluster.
    pure subroutine jacobian_spreader(self, plan, dynamics, block, state, all_frames, jacobian)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, block_type, state_type, jacobian_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(block_type), intent(in) :: block                 !< the block
      type(state_type), intent(in) :: state                 !< with the poses of the frames
      logical, intent(in) :: all_frames                     !< also frames of closed clusters that carry nothing
      type(jacobian_type), intent(inout) :: jacobian        !< with `b` of the block's steps
    end subroutine jacobian_spreader

    !> Velocity of the closing frame relative to the target, as rows of the closure's equations, per unit rate of one
    !> independent coordinate, from the entries of the two frames.
    pure subroutine column_finder(self, plan, c, state, jacobian, entries, column)
      import :: dynamics_arithmetic_type, plan_type, state_type, jacobian_type, wp
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      integer, intent(in) :: c                              !< number of the closure
      type(state_type), intent(in) :: state                 !< with the poses of the frames
      type(jacobian_type), intent(in) :: jacobian           !< entries of all frames
      integer, intent(in) :: entries(2)                     !< of the closing frame, and of the target frame or 0: it does not move
      real(wp), intent(out), contiguous :: column(:)        !< (rank) in the equations of the closure
    end subroutine column_finder

    !> Add the coefficients a_pr (21), the velocity terms of (19) and the weights of all bodies of one cluster on link 1.
    pure subroutine inertia_adder(self, dynamics, state, work)
      import :: dynamics_arithmetic_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with the accelerations that rates alone give
      type(lagrange_work_type), intent(inout) :: work       !< with the entries of the Jacobian; gets the sums
    end subroutine inertia_adder

    !> Add the generalized forces (25) of the loads on one link of one cluster on link 1.
    pure subroutine force_adder(self, plan, dynamics, state, link, work)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with the poses of the frames
      integer, intent(in) :: link                           !< number of the link
      type(lagrange_work_type), intent(inout) :: work       !< with the loads' forces; gets the generalized ones
    end subroutine force_adder

    !> Accelerations by articulated bodies. `found` is false where a coordinate has no inertia.
    pure subroutine tree_solver(self, plan, dynamics, state, work, found)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with the accelerations that rates alone give
      type(lagrange_work_type), intent(inout) :: work       !< with the loads' forces; gets the accelerations
      logical, intent(out) :: found                         !< whether all coordinates have inertia
    end subroutine tree_solver

    !> The coefficients a_pr (21), the velocity terms of (19), and the generalized forces of weights and of loads on links, of any
    !> tree of clusters.
    pure subroutine tree_weigher(self, plan, dynamics, state, work)
      import :: dynamics_arithmetic_type, plan_type, dynamics_plan_type, state_type, lagrange_work_type
      class(dynamics_arithmetic_type), intent(in) :: self   !< the arithmetic
      type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
      type(dynamics_plan_type), intent(in) :: dynamics      !< the plan of dynamics
      type(state_type), intent(in) :: state                 !< with the accelerations that rates alone give
      type(lagrange_work_type), intent(inout) :: work       !< with the columns of closed clusters; gets the results
    end subroutine tree_weigher
  end interface
end module mech9_lagrange_types
