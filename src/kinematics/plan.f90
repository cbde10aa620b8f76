!> The plan: everything about a mechanism that can be decided once, laid out for execution.
!> Uses kinds, pose, pair, planar_plan.
!>
!> Each pair is one *step* from a frame to a new frame; frame 0 belongs to link 1, frame s is reached
!> by step s. A frame sits on the axis of the pair by which it was reached, with that axis as its z,
!> so that a step with a fixed axis is one constant pose followed by one turn and one slide. A step
!> that would reach a link already known makes a second frame of that link instead, and a *closure*
!> says where this frame must be. Steps are grouped in *blocks*: the chains whose closures are
!> solved together; blocks are executed in order.
module mech9_plan
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type
  use mech9_pair, only: pair_slot_type
  use mech9_planar_plan, only: planar_plan_type
  implicit none
  private
  public :: plan_type, step_type, closure_type, path_type, block_type

  !> One step: from frame `parent` through pair `coordinate` to the frame of the step's own number.
  type :: step_type
    integer :: parent = 0
    integer :: coordinate = 0
    integer :: link = 0             !< the link whose frame (or second frame) is reached
    integer :: chain = 0            !< number of its chain among all chains of the structural vectors
    logical :: reversed = .false.   !< run through against the pair's own direction
    logical :: is_screw = .true.    !< fixed axis; otherwise plan%pairs(coordinate) is asked
    logical :: dependent = .true.
    type(pose_type) :: before       !< axis frame (user pair: departing link) in the parent frame
    real(wp) :: turn = 0.0_wp       !< rotation about z per unit of q, sign by direction
    real(wp) :: slide = 0.0_wp      !< advance along z per unit of q, sign by direction
    real(wp) :: offset = 0.0_wp     !< added to q
  end type step_type

  !> The steps of a closed chain, as seen by its closure.
  type :: path_type
    integer, allocatable :: steps(:)    !< all steps of the loop; in the end only those of its block
    real(wp), allocatable :: signs(:)   !< +1 towards the closing frame, -1 towards the target
    !> Frames from which these steps lead to the closing frame and to the target; the same, unless steps of
    !> earlier blocks were left out.
    integer :: stems(2) = 0
  end type path_type

  !> What a closed chain must satisfy: frame `closing` coincides with `in_target` of frame `target`.
  type :: closure_type
    integer :: chain = 0              !< number of the closed chain, as in nrw
    integer :: closing = 0            !< the frame made by the chain's last step
    integer :: target = 0             !< the other frame of that link
    type(pose_type) :: in_target      !< where the closing frame must be, in the target frame
    integer :: base = 0               !< frame in which the loop starts: nearest common to both ends
    integer :: rank = 6               !< dimension of the space of motions of the loop: its equations
    !> How many of the equations are independent while the loop moves: fewer where it is overconstrained.
    integer :: offers = 6
    !> Rows that pick the independent equations out of a screw (w, v/length) at the base frame's origin,
    !> in its axes: orthonormal, constant. Only the first `rank` count.
    real(wp) :: rows(6, 6) = 0.0_wp
    type(path_type) :: path
  end type closure_type

  !> Chains that are solved together (or pieces of open chains: no closures). A step belongs to the
  !> block that determines its coordinate, an independent one to the first block that needs it.
  type :: block_type
    integer :: first_step = 0, last_step = 0
    integer :: last_moved = huge(1)            !< accelerations of later frames serve only the block itself
    integer :: first_closure = 1, last_closure = 0
    integer, allocatable :: chains(:)          !< numbers of its closed chains, as in nrw
    integer :: equations = 0                   !< rows: sum of the closures' ranks
    logical :: is_constant = .false.           !< its Jacobian: nothing turns in its loops
    integer, allocatable :: unknowns(:)        !< steps of its dependent coordinates
    integer, allocatable :: coordinates(:)     !< these themselves
  end type block_type

  type :: plan_type
    integer :: n_links = 0
    integer :: n_coordinates = 0
    real(wp) :: length = 1.0_wp                     !< the mechanism's size [m]; weighs rotations against lengths
    real(wp) :: data_tolerance = 0.0_wp             !< redundant equations may stay open by this: rad, parts of `length`
    real(wp) :: origin(3) = 0.0_wp                  !< of frame 0 in link 1 [m]
    type(step_type), allocatable :: steps(:)
    type(closure_type), allocatable :: closures(:)
    type(block_type), allocatable :: blocks(:)
    integer, allocatable :: step_of(:)              !< step of each coordinate
    integer, allocatable :: frame_of(:)             !< first frame of each link
    type(pose_type), allocatable :: link_in_frame(:)  !< each link's own system in its first frame
    real(wp), allocatable :: unit_of(:)             !< what counts as one in each coordinate: 1 rad, or `length`
    integer, allocatable :: independent(:)          !< coordinates, ascending
    type(pair_slot_type), allocatable :: pairs(:)   !< only those without a fixed axis are set
    type(planar_plan_type) :: planar                !< the same in planar arithmetic, if that can be used
  end type plan_type
end module mech9_plan
