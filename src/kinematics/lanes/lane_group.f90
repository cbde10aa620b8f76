!> Designs side by side: the planar motion of several mechanisms of one structure, whose numbers and coordinates stand beside each other.
!>
!> A lane is the place of one design. The number of the lane is the first index of all arrays, so that the processor computes several
!> designs by one instruction. No lane reads another one: a design has the same results in any lane and in any company.
!> A lane in which the motion can't go on in this way is left; its design is then to be followed alone.
module mech9_lane_group
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_planar_chain, only: planar_chain_type, new_planar_chain
  implicit none
  private
  public :: lane_group_type, lane_block_type, new_lane_group, fits_lanes, fill_lane, copy_lane

  !> Designs that stand side by side.
  integer, parameter, public :: lanes = 8

  !> A block: a closed chain with three unknowns, or steps that close none.
  type :: lane_block_type
    integer :: first = 1                  !< its first step
    integer :: last = 0                   !< its last step
    integer :: closure = 0                !< number of its closure; 0: it closes no chain
    integer :: ends(3) = 0                !< closing frame, target and base of the closure
    integer :: stems(2) = 0               !< frames of other blocks at which the two branches of the loop begin
    integer :: unknowns(3) = 0            !< steps of the unknown coordinates
    integer, allocatable :: given(:)      !< steps of the loop whose coordinates are given
    real(wp), allocatable :: signs(:)     !< (M) of each step in the loop: 1 or -1; 0: not in it
  end type lane_block_type

  !> The designs of a group. Arrays have lanes as their first index.
  type :: lane_group_type
    integer :: m = 0                                     !< number of steps
    type(lane_block_type), allocatable :: blocks(:)      !< in the order of execution
    integer, allocatable :: parent(:)                    !< (M) frame from which each step leads
    integer, allocatable :: coordinate(:)                !< (M) coordinate of each step
    logical, allocatable :: turns(:)                     !< (M) the step turns; else it slides
    real(wp), allocatable :: turn(:)                     !< (M) rotation about the normal per unit of q: 1, -1, or 0
    ! numbers of the designs
    real(wp), allocatable :: angle(:, :)                 !< (lanes,M) rotation of each step at q = 0 [rad]
    real(wp), allocatable :: place(:, :, :)              !< (lanes,2,M) its origin in the parent frame at q = 0 [m]
    real(wp), allocatable :: slide(:, :, :)              !< (lanes,2,M) displacement of the origin in the parent frame per unit of q
    real(wp), allocatable :: goal(:, :, :)               !< (lanes,4,closures) cosine, sine and place of the closing frame in the target
    real(wp), allocatable :: unit(:, :)                  !< (lanes,M) unit of each step's coordinate [rad, m]
    real(wp) :: per_length(lanes) = 1.0_wp               !< one over the mechanism's size [1/m]
    ! motion
    real(wp), allocatable :: q(:, :)                     !< (lanes,M) coordinates of the steps [rad, m]
    real(wp), allocatable :: dq(:, :)                    !< (lanes,M) their rates
    real(wp), allocatable :: ddq(:, :)                   !< (lanes,M) their accelerations
    real(wp), allocatable :: last(:, :, :)               !< (lanes,3,M) coordinate, rate and acceleration at the last position
    real(wp), allocatable :: higher(:, :, :)             !< (lanes,3,M) factors of h^3, h^4, h^5 of the polynomial that predicts
    real(wp), allocatable :: cs(:, :, :)                 !< (lanes,2,M) cosine and sine of the angle by which each step turns
    real(wp), allocatable :: pose(:, :, :)               !< (lanes,4,0:M) cosine, sine, x, y of each frame [m]
    real(wp), allocatable :: way(:, :, :)                !< (lanes,2,M) velocity of each frame's origin per unit rate of a slide
    real(wp), allocatable :: v(:, :, :)                  !< (lanes,3,0:M) velocity of each frame [rad/s, m/s]
    real(wp), allocatable :: a(:, :, :)                  !< (lanes,3,0:M) acceleration of each frame [rad/s^2, m/s^2]
    real(wp), allocatable :: jacobian(:, :, :, :)        !< (lanes,3,3,blocks) of the equations by the unknowns, each in its unit
    real(wp), allocatable :: before(:, :, :, :)          !< (lanes,3,3,blocks) the same at the last position
    real(wp), allocatable :: inverse(:, :, :, :)         !< (lanes,3,3,blocks) inverse of the Jacobian
    real(wp), allocatable :: volume(:, :)                !< (lanes,blocks) determinant of the Jacobian at the last position
    real(wp), allocatable :: largest_pivot(:, :)         !< (lanes,blocks) largest least pivot of all positions
    real(wp) :: refused(lanes) = 0.0_wp                  !< above 0: the motion of the lane could not be followed
  end type lane_group_type

contains

  !> Whether the motion of a plan can be followed in a lane: it is planar, and each block is a chain with three unknowns or closes none.
  pure logical function fits_lanes(plan) result(fits)
    type(plan_type), intent(in) :: plan       !< the plan
    type(planar_chain_type) :: chain
    integer :: b

    fits = .false.
    if (.not. plan%planar%used .or. plan%has_curves) return
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        if (block%whole_loops .or. block%is_shown) return
        if (block%first_closure > block%last_closure .and. size(block%unknowns) == 0) cycle
        if (block%equations /= 3 .or. block%is_linear .or. block%is_constant) return
        chain = new_planar_chain(plan, block)
        if (.not. chain%used) return
      end associate
    end do
    fits = .true.
  end function fits_lanes

  !> A group for designs of the structure of a plan, which fits lanes.
  pure subroutine new_lane_group(plan, group)
    type(plan_type), intent(in) :: plan                 !< the plan
    type(lane_group_type), intent(out) :: group         !< without designs
    integer :: b, m, n

    m = plan%n_coordinates
    n = size(plan%blocks)
    group%m = m
    allocate (group%blocks(n))
    group%parent = plan%planar%steps%parent
    group%coordinate = plan%planar%steps%coordinate
    group%turns = plan%planar%steps%turns
    group%turn = plan%planar%steps%turn
    do b = 1, n
      call take_block(plan, plan%blocks(b), group%blocks(b))
    end do
    allocate (group%angle(lanes, m), group%place(lanes, 2, m), group%slide(lanes, 2, m), group%unit(lanes, m), &
              group%goal(lanes, 4, size(plan%planar%closures)), source=0.0_wp)
    allocate (group%q(lanes, m), group%dq(lanes, m), group%ddq(lanes, m), group%last(lanes, 3, m), group%higher(lanes, 3, m), &
              group%cs(lanes, 2, m), group%pose(lanes, 4, 0:m), group%way(lanes, 2, m), group%v(lanes, 3, 0:m), &
              group%a(lanes, 3, 0:m), source=0.0_wp)
    allocate (group%jacobian(lanes, 3, 3, n), group%before(lanes, 3, 3, n), group%inverse(lanes, 3, 3, n), &
              group%volume(lanes, n), group%largest_pivot(lanes, n), source=0.0_wp)
    group%pose(:, 1, :) = 1.0_wp
    group%cs(:, 1, :) = 1.0_wp
  end subroutine new_lane_group

  !> Take the structure of a block.
  pure subroutine take_block(plan, block, taken)
    type(plan_type), intent(in) :: plan              !< the plan
    type(block_type), intent(in) :: block            !< its block
    type(lane_block_type), intent(out) :: taken      !< the block for lanes
    type(planar_chain_type) :: chain

    taken%first = block%first_step
    taken%last = block%last_step
    allocate (taken%signs(plan%n_coordinates), source=0.0_wp)
    allocate (taken%given(0))
    if (block%first_closure > block%last_closure) return
    chain = new_planar_chain(plan, block)
    taken%closure = block%first_closure
    taken%ends = [chain%closure%closing, chain%closure%target, chain%closure%base]
    taken%stems = chain%stems
    taken%unknowns = chain%unknowns
    taken%given = chain%given
    taken%signs(block%first_step:block%last_step) = chain%signs
  end subroutine take_block

  !> Give a lane the numbers of a design and its closed position. `fits` is false where its plan has another structure than the group.
  pure subroutine fill_lane(plan, q, lane, group, fits)
    type(plan_type), intent(in) :: plan                 !< plan of the design
    real(wp), intent(in) :: q(:)                        !< (M) its coordinates at the start [rad, m]
    integer, intent(in) :: lane                         !< number of the lane
    type(lane_group_type), intent(inout) :: group       !< the group
    logical, intent(out) :: fits                        !< the lane has the design
    type(lane_block_type) :: block
    integer :: b, c, s

    fits = fits_lanes(plan) .and. plan%n_coordinates == group%m .and. size(plan%blocks) == size(group%blocks)
    if (fits) fits = size(plan%planar%closures) == size(group%goal, 3)
    if (.not. fits) return
    associate (steps => plan%planar%steps)
      fits = all(steps%parent == group%parent .and. steps%coordinate == group%coordinate .and. (steps%turns .eqv. group%turns) &
                 .and. .not. abs(steps%turn - group%turn) > 0.0_wp)
    end associate
    do b = 1, size(group%blocks)
      if (.not. fits) return
      call take_block(plan, plan%blocks(b), block)
      fits = is_same(block, group%blocks(b))
    end do
    do s = 1, group%m
      associate (step => plan%planar%steps(s))
        group%angle(lane, s) = step%angle
        group%place(lane, :, s) = step%place
        group%slide(lane, :, s) = step%slide
        group%unit(lane, s) = plan%unit_of(step%coordinate)
        group%q(lane, s) = q(step%coordinate)
      end associate
    end do
    do c = 1, size(plan%planar%closures)
      associate (closure => plan%planar%closures(c))
        group%goal(lane, :, c) = [closure%cosine, closure%sine, closure%place]
      end associate
    end do
    group%per_length(lane) = 1.0_wp/plan%planar%length
    group%refused(lane) = 0.0_wp
  end subroutine fill_lane

  !> Whether two blocks have the same structure.
  pure logical function is_same(a, b)
    type(lane_block_type), intent(in) :: a   !< a block
    type(lane_block_type), intent(in) :: b   !< another one

    is_same = a%first == b%first .and. a%last == b%last .and. a%closure == b%closure .and. all(a%ends == b%ends) .and. &
              all(a%stems == b%stems) .and. all(a%unknowns == b%unknowns) .and. size(a%given) == size(b%given)
    if (is_same) is_same = all(a%given == b%given) .and. .not. any(abs(a%signs - b%signs) > 0.0_wp)
  end function is_same

  !> Copy the design of a lane, with its motion, to another one. A lane that is left goes on as a copy: its numbers stay harmless.
  pure subroutine copy_lane(from, to, group)
    integer, intent(in) :: from                      !< number of the lane
    integer, intent(in) :: to                        !< number of the other one
    type(lane_group_type), intent(inout) :: group    !< the group

    group%angle(to, :) = group%angle(from, :)
    group%place(to, :, :) = group%place(from, :, :)
    group%slide(to, :, :) = group%slide(from, :, :)
    group%goal(to, :, :) = group%goal(from, :, :)
    group%unit(to, :) = group%unit(from, :)
    group%per_length(to) = group%per_length(from)
    group%q(to, :) = group%q(from, :)
    group%dq(to, :) = group%dq(from, :)
    group%ddq(to, :) = group%ddq(from, :)
    group%last(to, :, :) = group%last(from, :, :)
    group%higher(to, :, :) = group%higher(from, :, :)
    group%cs(to, :, :) = group%cs(from, :, :)
    group%pose(to, :, :) = group%pose(from, :, :)
    group%way(to, :, :) = group%way(from, :, :)
    group%v(to, :, :) = group%v(from, :, :)
    group%a(to, :, :) = group%a(from, :, :)
    group%jacobian(to, :, :, :) = group%jacobian(from, :, :, :)
    group%before(to, :, :, :) = group%before(from, :, :, :)
    group%inverse(to, :, :, :) = group%inverse(from, :, :, :)
    group%volume(to, :) = group%volume(from, :)
    group%largest_pivot(to, :) = group%largest_pivot(from, :)
    group%refused(to) = group%refused(from)
  end subroutine copy_lane
end module mech9_lane_group
