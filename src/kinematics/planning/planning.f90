!> The making of the plan: frames, spaces of motion, blocks, and the assembled start.
!>
!> Structure and ranks of the loops propose the blocks. The rank of a block's Jacobian at a closed position then shows whether
!> the block determines its coordinates: at the start and, if that is singular, at a generic position. A block that does not
!> determine them is joined with the next ones until it does.
module mech9_planning
  use mech9_kinds, only: wp
  use mech9_tolerances, only: inexact_dimensions, rank_tolerance_for
  use mech9_planning_tolerances, only: contradicting_rates, near_guesses
  use mech9_error, only: error_type, raise, exit_structure
  use mech9_planning_failures, only: failure_large_block, failure_undetermined_block, failure_contradictory_inputs
  use mech9_partition, only: partition_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type, new_state
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type, leave_out_unrequested
  use mech9_spanning_tree, only: lay_out_frames
  use mech9_geometric_order, only: order_by_geometry
  use mech9_arithmetics, only: set_in_space, set_in_plane, set_blocks_in_planes
  use mech9_frame_motion, only: place_all
  use mech9_planar_layout, only: lay_out_in_plane
  use mech9_planar_blocks, only: lay_out_planes
  use mech9_known_loops, only: take_known_loops
  use mech9_loop_space, only: find_loop_spaces
  use mech9_loop_rank, only: find_offers
  use mech9_tree_paths, only: split_loops
  use mech9_blocks, only: make_blocks, count_block
  use mech9_random, only: random_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block, solve_rates
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  use mech9_assemblies, only: close_from_random_starts
  use mech9_generic_position, only: generic_position_type, find_generic_position
  use mech9_release, only: move_inputs
  use mech9_diagnosis, only: judge_choice, refuse_open, refuse_undetermined, refuse_locked
  use mech9_finite_motion, only: locked_chain_type, find_locked_chain
  implicit none
  private
  public :: planning_settings_type, make_plan, plan_blocks_in_planes, find_constants

  !> Largest number of unknowns of one block, whose equations are a full matrix: more would need too much memory and time.
  integer, parameter :: most_unknowns = 3000

  !> Outcome of the assembly of a block: it determines all its coordinates, or it is too small and must be joined with the next one,
  !> or it does not close near the guesses, where only such positions count.
  integer, parameter :: is_complete = 1, is_too_small = 2, is_missed = 3

  !> How a plan is made.
  type :: planning_settings_type
    logical :: in_space = .false.                    !< use spatial arithmetic even where planar arithmetic is possible
    type(requested_type), allocatable :: requested   !< blocks that do not serve these are left out; not allocated: none are
    type(plan_type), pointer :: known => null()      !< the plan in other independent coordinates, for size and properties of loops;
                                                     !< not owned
  end type planning_settings_type

contains

  !> Make the plan of a mechanism and its assembled start, the positions of all coordinates for the given independent ones.
  !> Fails with exit_structure if the independent coordinates do not determine the dependent ones, and with exit_assembly if
  !> the chains do not close.
  subroutine make_plan(mechanism, partition, start, plan, state, err, settings)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< driven, free and dependent coordinates, and the order of computation
    real(wp), intent(in) :: start(:)        !< (M) values of the independent coordinates, guesses of the others [rad, m]
    type(plan_type), intent(out) :: plan   !< the plan of the mechanism
    type(state_type), intent(out) :: state  !< the assembled start
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(planning_settings_type), intent(in), optional :: settings   !< how it is made; the default ones unless given
    type(planning_settings_type) :: chosen
    type(generic_position_type) :: generic
    logical :: missed

    if (present(settings)) chosen = settings
    call propose_plan(mechanism, partition, start, chosen, plan, state, err)
    if (allocated(err)) return
    call assemble_blocks(plan, .not. associated(chosen%known), state, generic, missed, err)
    if (missed) then
      call find_start(mechanism, partition, plan, start, state)
      call assemble_blocks(plan, .false., state, generic, missed, err)
    end if
    if (allocated(err)) return
    call check_inputs(plan, state, generic, err)
    if (allocated(err)) return
    ! a plan with `requested` is made for other independent coordinates of a mechanism that is known to move
    if (.not. allocated(chosen%requested)) call check_motion(plan, state, err)
    if (allocated(err)) return
    if (.not. (chosen%in_space .or. plan%planar%used)) call plan_blocks_in_planes(plan, state, err)
    if (allocated(chosen%requested)) call leave_out_unrequested(plan, chosen%requested)
    call find_constants(plan)
  end subroutine make_plan

  !> Lay out frames, loops and blocks by structure and ranks, before any block is assembled.
  subroutine propose_plan(mechanism, partition, start, settings, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< driven, free and dependent coordinates, and the order of computation
    real(wp), intent(in) :: start(:)        !< (M) values of the independent coordinates, guesses of the others [rad, m]
    type(planning_settings_type), intent(in) :: settings   !< how the plan is made
    type(plan_type), intent(out) :: plan   !< the plan with the proposed blocks
    type(state_type), intent(out) :: state  !< with the coordinates of the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if the blocks cannot determine all coordinates
    logical, allocatable :: ranked(:), complete(:)

    if (associated(settings%known)) then
      call lay_out_frames(mechanism, partition, start, plan, settings%known%length)
    else
      call lay_out_frames(mechanism, partition, start, plan)
    end if
    call set_in_space(plan)
    state = new_state(plan)
    state%q = start
    allocate (ranked(size(plan%closures)), complete(size(plan%closures)), source=.false.)
    if (associated(settings%known)) call take_known_loops(settings%known, plan, ranked, complete)
    call find_loop_spaces(plan, start, ranked, complete, err)
    if (allocated(err)) return
    call find_offers(plan, start, ranked)
    call propose_blocks(plan, state, err)
    if (allocated(err)) return
    call set_in_space(plan)
    if (allocated(settings%requested)) call leave_out_unrequested(plan, settings%requested)
    if (.not. settings%in_space) then
      call lay_out_in_plane(plan)
      call set_in_plane(plan)
    end if
    state = new_state(plan)
    state%q = start
  end subroutine propose_plan

  !> Find coordinates from which the blocks close at once, where they do not close near the guesses. The search goes through the
  !> chains in the order of the geometry, so that it does not depend on the numbers of links and coordinates.
  subroutine find_start(mechanism, partition, plan, start, state)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< driven, free and dependent coordinates
    type(plan_type), intent(in) :: plan             !< the plan with the proposed blocks
    real(wp), intent(in) :: start(:)                !< (M) values of the independent coordinates, guesses of the others [rad, m]
    type(state_type), intent(inout) :: state        !< gets the closed position, or the guesses where none was found
    type(partition_type) :: ordered
    type(plan_type) :: other
    type(state_type) :: position
    type(generic_position_type) :: generic
    type(error_type), allocatable :: err
    logical :: missed

    state%q = start
    call order_by_geometry(mechanism, partition, plan, start, ordered)
    call propose_plan(mechanism, ordered, start, planning_settings_type(), other, position, err)
    if (.not. allocated(err)) call assemble_blocks(other, .false., position, generic, missed, err)
    if (.not. allocated(err)) state%q = position%q
  end subroutine find_start

  !> Plan the planar blocks of an assembled mechanism in planar arithmetic. The blocks were found and assembled in space, where
  !> blocks of different arithmetics can be joined.
  subroutine plan_blocks_in_planes(plan, state, err)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism, in space
    type(state_type), intent(inout) :: state   !< the assembled start; gets its frames in the planes
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: q(plan%n_coordinates)

    call lay_out_planes(plan)
    if (.not. allocated(plan%planar%planes)) return
    call set_blocks_in_planes(plan)
    q = state%q
    state = new_state(plan)
    state%q = q
    call place_all(plan, state, err)
  end subroutine plan_blocks_in_planes

  !> Propose blocks by the structure and the ranks of the loops. Fails if they cannot determine all coordinates.
  subroutine propose_blocks(plan, state, err)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, allocatable :: undetermined(:)
    logical :: closed

    call make_blocks(plan, undetermined)
    if (size(undetermined) > 0) then
      ! a loop may offer more equations together with others than alone: at most the dimension of its motions
      plan%closures%independent_equations = plan%closures%rank
      call make_blocks(plan, undetermined)
    end if
    if (size(undetermined) > 0) then
      call judge_choice(plan, state, closed, err)
      if (.not. allocated(err)) call refuse_undetermined(undetermined, err)
    else if (maxval(unknowns_of(plan%blocks)) > most_unknowns) then
      call raise(err, exit_structure, failure_large_block)
      err%failure%number = maxval(unknowns_of(plan%blocks))
      err%failure%limit = most_unknowns
    end if
  end subroutine propose_blocks

  !> Assemble the proposed blocks one after the other and join those that prove too small.
  subroutine assemble_blocks(plan, near_only, state, generic, missed, err)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism; gets the blocks, unless they are missed
    logical, intent(in) :: near_only   !< only closed positions near the guesses count
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(generic_position_type), intent(out) :: generic   !< a generic position, as far as it was made
    logical, intent(out) :: missed   !< a block does not close near the guesses, where only such positions count
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(block_type), allocatable :: blocks(:)
    type(state_type) :: trial
    integer :: b, n, outcome
    logical :: closed

    allocate (blocks(size(plan%blocks)))
    n = 0
    missed = .false.
    outcome = is_complete
    do b = 1, size(plan%blocks)
      if (outcome == is_complete) then
        n = n + 1
        blocks(n) = plan%blocks(b)
      else
        blocks(n)%last_step = plan%blocks(b)%last_step
        blocks(n)%last_closure = plan%blocks(b)%last_closure
        call count_block(plan, blocks(n))
        call split_loops(blocks(n), plan)
      end if
      call assemble_next(plan, blocks(:n), near_only, state, generic, outcome, err)
      missed = outcome == is_missed
      if (allocated(err) .or. missed) return
    end do
    plan%blocks = blocks(:n)
    if (outcome == is_complete) return
    trial = state
    call judge_choice(plan, trial, closed, err)
    if (.not. allocated(err)) call refuse_block(failure_undetermined_block, blocks(n), err)
  end subroutine assemble_blocks

  !> Assemble the last block on the closed blocks before it, and find whether all its coordinates are determined.
  subroutine assemble_next(plan, blocks, near_only, state, generic, outcome, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: blocks(:)   !< the blocks so far; the last one is to be assembled
    logical, intent(in) :: near_only   !< only a closed position near the guesses counts
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(generic_position_type), intent(inout) :: generic   !< a generic position, as far as it was made
    integer, intent(out) :: outcome   !< is_complete, is_too_small or is_missed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(block_work_type) :: work
    type(assembly_outcome_type) :: assembly
    real(wp) :: guess(size(blocks(size(blocks))%coordinates))
    logical :: closed

    outcome = is_too_small
    associate (block => blocks(size(blocks)))
      guess = state%q(block%coordinates)   ! no other coordinate changes here
      work = new_block_work(block)
      call assemble_block(plan, block, state, work, .not. near_only, assembly, err)
      if (allocated(err)) return
      if (near_only) then
        if (.not. assembly%closed .or. &
            any(abs(state%q(block%coordinates) - guess) > near_guesses*plan%unit_of(block%coordinates))) then
          outcome = is_missed
          return
        end if
      end if
      if (.not. assembly%closed) then
        call assemble_by_other_starts(plan, blocks, assembly, state, err)
        if (allocated(err)) return
        generic%exists = .false.
      end if
      call factorize_block(plan, block, state, work)
      if (determines_all()) outcome = is_complete
      if (outcome == is_complete .and. .not. generic%exists) return
      ! a generic position shows whether the start is singular or the rank is small everywhere
      call find_generic_position(plan, blocks, state, generic, closed)
      if (outcome == is_complete .or. .not. closed) return
      call factorize_block(plan, block, generic%state, work)
      if (determines_all()) outcome = is_complete
    end associate

  contains

    !> Whether the block, whose Jacobian is factorized, determines all its coordinates.
    logical function determines_all()
      determines_all = work%equations%rank(rank_tolerance_for(plan%data_tolerance)) == size(work%change)
    end function determines_all
  end subroutine assemble_next

  !> Assemble the last block where it does not close with the present assembly of the blocks before it: with other assemblies
  !> of these, then by a motion from a position that is closed with free independent coordinates. Fails if neither closes it.
  subroutine assemble_by_other_starts(plan, blocks, outcome, state, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: blocks(:)   !< the blocks so far; the last one is to be assembled
    type(assembly_outcome_type), intent(in) :: outcome   !< result of the assembly that failed
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(state_type) :: trial
    logical :: closed

    if (size(blocks) > 1) then
      call close_from_random_starts(plan, blocks, state, closed)
      if (closed) return
    end if
    trial = state
    call judge_choice(plan, trial, closed, err)
    if (allocated(err)) return
    if (closed) then
      call move_inputs(plan, state%q, trial, closed)
      if (closed) then
        state = trial
        return
      end if
    end if
    call refuse_open(plan, state, outcome, err)
  end subroutine assemble_by_other_starts

  !> Check that the independent coordinates can move at any rates, over a finite motion.
  subroutine check_inputs(plan, state, generic, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(generic_position_type), intent(inout) :: generic   !< a generic position, as far as it was made
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(state_type) :: trial
    type(block_work_type) :: work
    type(random_type) :: random
    real(wp) :: remainder
    integer :: b, i
    logical :: closed, free

    free = .true.
    trial = state
    ! redundant equations must agree not only at the start
    if (generic%exists .or. any(plan%blocks%equations > unknowns_of(plan%blocks))) then
      call find_generic_position(plan, plan%blocks, state, generic, closed)
      if (closed) then
        trial = generic%state
      else
        call judge_choice(plan, trial, closed, err)
        if (allocated(err)) return
        trial = state
      end if
    end if
    do i = 1, size(plan%independent)
      trial%dq(plan%independent(i)) = plan%unit_of(plan%independent(i))*random%symmetric()
    end do
    do b = 1, size(plan%blocks)
      work = new_block_work(plan%blocks(b))
      if (plan%blocks(b)%equations > 0) call factorize_block(plan, plan%blocks(b), trial, work)
      call solve_rates(plan, plan%blocks(b), trial, work, remainder)
      free = remainder <= max(contradicting_rates, inexact_dimensions*plan%data_tolerance)
      if (.not. free) exit
    end do
    if (free) return
    trial = state
    call judge_choice(plan, trial, closed, err)
    if (.not. allocated(err)) call refuse_block(failure_contradictory_inputs, plan%blocks(b), err)
  end subroutine check_inputs

  !> Check that chains with redundant equations stay closed when they move.
  subroutine check_motion(plan, state, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state      !< the assembled start
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(locked_chain_type) :: locked

    call find_locked_chain(plan, state, locked)
    if (locked%exists) call refuse_locked(plan, locked, err)
  end subroutine check_motion

  pure elemental integer function unknowns_of(block)
    type(block_type), intent(in) :: block   !< the block

    unknowns_of = size(block%unknowns)
  end function unknowns_of

  !> Fail because of the chains of a block.
  pure subroutine refuse_block(kind, block, err)
    integer, intent(in) :: kind             !< of the failure
    type(block_type), intent(in) :: block   !< the block
    type(error_type), allocatable, intent(out) :: err   !< always allocated

    call raise(err, exit_structure, kind)
    err%failure%chains = block%chains
  end subroutine refuse_block

  !> Mark blocks whose Jacobian never changes because all steps of their loops slide and their couplings are linear.
  pure subroutine find_constants(plan)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    integer :: b, c

    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        block%is_constant = size(block%unknowns) > 0
        do c = block%first_closure, block%last_closure
          if (plan%closures(c)%coupling > 0) then
            block%is_constant = block%is_constant .and. plan%couplings(plan%closures(c)%coupling)%coupling%is_linear()
            cycle
          end if
          associate (loop => plan%steps(plan%closures(c)%loop%steps))
            block%is_constant = block%is_constant .and. all(loop%is_screw) .and. .not. any(abs(loop%turn) > 0.0_wp)
          end associate
        end do
      end associate
    end do
  end subroutine find_constants
end module mech9_planning
