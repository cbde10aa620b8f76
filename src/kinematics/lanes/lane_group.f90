!> Designs side by side: the planar motion of several mechanisms of one structure, whose numbers and coordinates stand beside each other.
!> Several motions of one mechanism can stand side by side, too.
!>
!> A lane is the place of one design. The number of the lane is the first index of all arrays, so that the processor computes several
!> designs by one instruction. No lane reads another one: a design has the same results in any lane and in any company.
!> A lane in which the motion can't go on in this way is left; its design is then to be followed alone.
module mech9_lane_group
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_planar_chain, only: planar_chain_type, new_planar_chain
  implicit none
  private
  public :: lane_group_type, lane_block_type, lane_step_type, is_plain, new_lane_group, fits_lanes, fill_lane, renew_lane, &
    copy_lane

  !> Designs that stand side by side.
  integer, parameter, public :: lanes = 16

  !> A step and its coordinate.
  type :: lane_step_type
    integer :: parent = 0                        !< frame from which it leads
    integer :: coordinate = 0                    !< its coordinate
    logical :: turns = .true.                    !< it turns; else it slides
    real(wp) :: turn = 0.0_wp                    !< rotation about the normal per unit of q: 1, -1, or 0
    ! numbers of the designs
    real(wp) :: angle(lanes) = 0.0_wp            !< rotation at q = 0 [rad]
    real(wp) :: place(lanes, 2) = 0.0_wp         !< its origin in the parent frame at q = 0 [m]
    real(wp) :: slide(lanes, 2) = 0.0_wp         !< displacement of the origin in the parent frame per unit of q
    real(wp) :: unit(lanes) = 1.0_wp             !< unit of the coordinate [rad, m]
    ! motion
    real(wp) :: q(lanes) = 0.0_wp                !< coordinate [rad, m]
    real(wp) :: dq(lanes) = 0.0_wp               !< its rate
    real(wp) :: ddq(lanes) = 0.0_wp              !< its acceleration
    real(wp) :: last(lanes, 3) = 0.0_wp          !< coordinate, rate and acceleration at the last position
    real(wp) :: higher(lanes, 3) = 0.0_wp        !< factors of h^3, h^4, h^5 of the polynomial that predicts
    real(wp) :: cs(lanes, 2) = 0.0_wp            !< cosine and sine of the angle by which it turns
  end type lane_step_type

  !> A frame.
  type :: lane_frame_type
    real(wp) :: pose(lanes, 4) = 0.0_wp          !< cosine, sine, x, y [m]
    real(wp) :: way(lanes, 2) = 0.0_wp           !< velocity of its origin per unit rate of a slide
    real(wp) :: v(lanes, 3) = 0.0_wp             !< velocity [rad/s, m/s]
    real(wp) :: a(lanes, 3) = 0.0_wp             !< acceleration [rad/s^2, m/s^2]
  end type lane_frame_type

  !> A block: a closed chain with three unknowns, or steps that close none.
  type :: lane_block_type
    integer :: first = 1                         !< its first step
    integer :: last = 0                          !< its last step
    integer :: closure = 0                       !< number of its closure; 0: it closes no chain
    integer :: ends(3) = 0                       !< closing frame, target and base of the closure
    integer :: stems(2) = 0                      !< frames of other blocks at which the two branches of the loop begin
    integer :: unknowns(3) = 0                   !< steps of the unknown coordinates
    integer, allocatable :: given(:)             !< steps of the loop whose coordinates are given
    real(wp), allocatable :: signs(:)            !< (M) of each step in the loop: 1 or -1; 0: not in it
    real(wp) :: goal(lanes, 4) = 0.0_wp          !< cosine, sine and place of the closing frame in the target
    real(wp) :: jacobian(lanes, 3, 3) = 0.0_wp   !< of the equations by the unknowns, each in its unit
    real(wp) :: before(lanes, 3, 3) = 0.0_wp     !< the same at the last position
    real(wp) :: inverse(lanes, 3, 3) = 0.0_wp    !< inverse of the Jacobian
    real(wp) :: volume(lanes) = 0.0_wp           !< determinant of the Jacobian at the last position
    real(wp) :: largest_pivot(lanes) = 0.0_wp    !< largest least pivot of all positions
  end type lane_block_type

  !> The designs of a group. Arrays of fixed extents, with lanes as their first index, have addresses that the compiler knows.
  type :: lane_group_type
    type(lane_block_type), allocatable :: blocks(:)      !< in the order of execution
    type(lane_step_type), allocatable :: steps(:)        !< (M)
    type(lane_frame_type), allocatable :: frames(:)      !< (0:M)
    real(wp) :: per_length(lanes) = 1.0_wp               !< one over the mechanism's size [1/m]
    real(wp) :: refused(lanes) = 0.0_wp                  !< above 0: the motion of the lane could not be followed
    ! the present step
    real(wp) :: h(lanes) = 0.0_wp                        !< its length [s]; 0: beside the last position
    real(wp) :: h_higher(lanes) = 0.0_wp                 !< the same, 0 where higher factors of polynomials do not serve
    real(wp) :: per_h(lanes) = 1.0_wp                    !< one over the length [1/s]
    real(wp) :: taken(lanes) = 0.0_wp                    !< length of the step to the last position; 0: no polynomial predicts from it [s]
  end type lane_group_type

contains

  !> Whether a mechanism has nothing beside its chains by which its motion could end, and no gaps that count as closed.
  pure logical function is_plain(mechanism)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism

    is_plain = .not. mechanism%data_tolerance > 0.0_wp .and. size(mechanism%motors) == 0 .and. size(mechanism%stops) == 0 .and. &
               .not. mechanism%has_frictions() .and. .not. mechanism%has_contacts()
    if (.not. is_plain .or. .not. allocated(mechanism%couplings)) return
    is_plain = size(mechanism%couplings) == 0
  end function is_plain

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
    integer :: b, s

    allocate (group%blocks(size(plan%blocks)), group%steps(plan%n_coordinates), group%frames(0:plan%n_coordinates))
    do s = 1, plan%n_coordinates
      associate (step => group%steps(s), planar => plan%planar%steps(s))
        step%parent = planar%parent
        step%coordinate = planar%coordinate
        step%turns = planar%turns
        step%turn = planar%turn
        step%cs(:, 1) = 1.0_wp
      end associate
    end do
    do b = 1, size(plan%blocks)
      call take_block(plan, plan%blocks(b), group%blocks(b))
    end do
    do s = 0, plan%n_coordinates
      group%frames(s)%pose(:, 1) = 1.0_wp
    end do
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
    integer :: b

    fits = fits_lanes(plan) .and. plan%n_coordinates == size(group%steps) .and. size(plan%blocks) == size(group%blocks)
    if (.not. fits) return
    associate (steps => plan%planar%steps)
      fits = all(steps%parent == group%steps%parent .and. steps%coordinate == group%steps%coordinate)
    end associate
    do b = 1, size(group%blocks)
      if (.not. fits) return
      call take_block(plan, plan%blocks(b), block)
      fits = is_same(block, group%blocks(b))
    end do
    call renew_lane(plan, q, lane, group, fits)
  end subroutine fill_lane

  !> Give a lane the numbers of a design, whose plan has the blocks and frames of the group, and its closed position. `fits` is false
  !> where its axes have other directions.
  pure subroutine renew_lane(plan, q, lane, group, fits)
    type(plan_type), intent(in) :: plan                 !< plan of the design
    real(wp), intent(in) :: q(:)                        !< (M) its coordinates at the start [rad, m]
    integer, intent(in) :: lane                         !< number of the lane
    type(lane_group_type), intent(inout) :: group       !< the group
    logical, intent(out) :: fits                        !< the lane has the design
    integer :: b, s

    fits = .false.
    do s = 1, size(group%steps)
      associate (step => plan%planar%steps(s), taken => group%steps(s))
        if ((step%turns .neqv. taken%turns) .or. abs(step%turn - taken%turn) > 0.0_wp) return
        taken%angle(lane) = step%angle
        taken%place(lane, :) = step%place
        taken%slide(lane, :) = step%slide
        taken%unit(lane) = plan%unit_of(step%coordinate)
        taken%q(lane) = q(step%coordinate)
      end associate
    end do
    fits = .true.
    do b = 1, size(group%blocks)
      group%blocks(b)%largest_pivot(lane) = 0.0_wp
      if (group%blocks(b)%closure == 0) cycle
      associate (closure => plan%planar%closures(group%blocks(b)%closure))
        group%blocks(b)%goal(lane, :) = [closure%cosine, closure%sine, closure%place]
      end associate
    end do
    group%per_length(lane) = 1.0_wp/plan%planar%length
    group%refused(lane) = 0.0_wp
  end subroutine renew_lane

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

    integer :: b, s

    group%per_length(to) = group%per_length(from)
    group%refused(to) = group%refused(from)
    group%h(to) = group%h(from)
    group%h_higher(to) = group%h_higher(from)
    group%per_h(to) = group%per_h(from)
    group%taken(to) = group%taken(from)
    do s = 1, size(group%steps)
      call copy_step(group%steps(s))
    end do
    do s = 0, ubound(group%frames, 1)
      associate (frame => group%frames(s))
        frame%pose(to, :) = frame%pose(from, :)
        frame%way(to, :) = frame%way(from, :)
        frame%v(to, :) = frame%v(from, :)
        frame%a(to, :) = frame%a(from, :)
      end associate
    end do
    do b = 1, size(group%blocks)
      associate (block => group%blocks(b))
        block%goal(to, :) = block%goal(from, :)
        block%jacobian(to, :, :) = block%jacobian(from, :, :)
        block%before(to, :, :) = block%before(from, :, :)
        block%inverse(to, :, :) = block%inverse(from, :, :)
        block%volume(to) = block%volume(from)
        block%largest_pivot(to) = block%largest_pivot(from)
      end associate
    end do

  contains

    !> Copy the numbers and the motion of a step.
    pure subroutine copy_step(step)
      type(lane_step_type), intent(inout) :: step   !< the step

      step%angle(to) = step%angle(from)
      step%place(to, :) = step%place(from, :)
      step%slide(to, :) = step%slide(from, :)
      step%unit(to) = step%unit(from)
      step%q(to) = step%q(from)
      step%dq(to) = step%dq(from)
      step%ddq(to) = step%ddq(from)
      step%last(to, :) = step%last(from, :)
      step%higher(to, :) = step%higher(from, :)
      step%cs(to, :) = step%cs(from, :)
    end subroutine copy_step
  end subroutine copy_lane
end module mech9_lane_group
