!> Making the plan: frames, spaces of motion, blocks, and the assembled start. Uses the kinematics
!> floor below it and the model.
!>
!> Chains are taken in the order of the structural vectors. A chain whose dependent coordinates are
!> all determined by its own closure is a block; one that leaves some free is joined with the next
!> chains until the block is square. Whether coordinates are determined is judged by the rank of the
!> Jacobian at a closed position: at the start, and where that is singular, also away from it.
module mech9_planning
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure, exit_assembly
  use mech9_text, only: to_text
  use mech9_structural_vectors, only: chain_type, chains_of
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type, new_state
  use mech9_frames, only: lay_out_frames
  use mech9_loop_space, only: find_loop_spaces
  use mech9_random, only: random_type
  use mech9_composition, only: place_frames
  use mech9_solver, only: block_work_type, new_block_work, factorize_block, solve_rates
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  use mech9_mobility, only: undetermined, overdetermined
  implicit none
  private
  public :: make_plan, chain_names

  !> Pivots below this fraction of the largest count as zero when ranks are found.
  real(wp), parameter :: rank_tolerance = 1.0e-9_wp

  !> A position away from the start, made when the rank at the start is in doubt.
  type :: elsewhere_type
    type(state_type) :: state
    logical :: exists = .false.
    logical :: closed = .false.
  end type elsewhere_type

contains

  !> The plan of a mechanism and its assembled start: positions of all coordinates for the given
  !> independent ones. Fails with exit_structure where the dependent coordinates are not determined
  !> by the independent ones, with exit_assembly where the chains do not close.
  subroutine make_plan(mechanism, start, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism
    real(wp), intent(in) :: start(:)        !< (M): independent coordinates as given, guesses of the others
    type(plan_type), intent(out) :: plan
    type(state_type), intent(out) :: state  !< assembled
    type(error_type), allocatable, intent(out) :: err
    type(chain_type), allocatable :: chains(:)
    type(block_type), allocatable :: blocks(:)
    type(elsewhere_type) :: elsewhere
    type(block_type) :: block
    integer :: i, n_blocks, step, closure
    logical :: complete

    call lay_out_frames(mechanism, plan)
    state = new_state(plan)
    state%q = start
    call find_loop_spaces(plan, start, err)
    if (allocated(err)) return
    chains = chains_of(mechanism%vectors)
    allocate (blocks(size(chains)))
    n_blocks = 0
    step = 0
    closure = 0
    complete = .true.
    do i = 1, size(chains)
      if (complete) block = block_type(first_step=step + 1, first_closure=closure + 1)
      step = step + chains(i)%last - chains(i)%first + 1
      if (chains(i)%closed) closure = closure + 1
      block%last_step = step
      block%last_closure = closure
      call count_block(plan, block)
      call try_block(plan, blocks(:n_blocks), block, state, elsewhere, complete, err)
      if (allocated(err)) return
      if (complete) then
        n_blocks = n_blocks + 1
        blocks(n_blocks) = block
      end if
    end do
    plan%blocks = blocks(:n_blocks)
    if (.not. complete) call refuse_free(plan, block, state, err)
    if (allocated(err)) return
    call check_inputs(plan, state, elsewhere, err)
    if (allocated(err)) return
    call trim_paths(plan)
  end subroutine make_plan

  !> Unknowns and equations of a block from its ranges.
  pure subroutine count_block(plan, block)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(inout) :: block
    integer :: s

    block%unknowns = pack([(s, s=block%first_step, block%last_step)], &
                          plan%steps(block%first_step:block%last_step)%dependent)
    block%equations = sum(plan%closures(block%first_closure:block%last_closure)%rank)
  end subroutine count_block

  !> Assemble a block and say whether its dependent coordinates are all determined.
  subroutine try_block(plan, before, block, state, elsewhere, complete, err)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: before(:)     !< the blocks already found
    type(block_type), intent(in) :: block
    type(state_type), intent(inout) :: state
    type(elsewhere_type), intent(inout) :: elsewhere
    logical, intent(out) :: complete
    type(error_type), allocatable, intent(out) :: err
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome

    complete = .false.
    if (size(block%unknowns) > block%equations) return
    work = new_block_work(block)
    call assemble_block(plan, block, state, work, .true., outcome, err)
    if (allocated(err)) return
    if (.not. outcome%closed) then
      call refuse_open(plan, block, state, outcome, err)
      return
    end if
    call factorize_block(plan, block, state, work)
    complete = work%equations%rank(rank_tolerance) == size(block%unknowns)
    if (complete) then
      if (elsewhere%exists .and. elsewhere%closed) call extend(plan, block, state, elsewhere, err)
      return
    end if
    ! a singular start, or a rank that is small everywhere?
    call go_elsewhere(plan, before, state, elsewhere, err)
    if (allocated(err) .or. .not. elsewhere%closed) return
    call extend(plan, block, state, elsewhere, err)
    if (allocated(err) .or. .not. elsewhere%closed) return
    call factorize_block(plan, block, elsewhere%state, work)
    complete = work%equations%rank(rank_tolerance) == size(block%unknowns)
  end subroutine try_block

  !> Make the position elsewhere: independent coordinates changed at random, all blocks so far closed.
  subroutine go_elsewhere(plan, before, state, elsewhere, err)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: before(:)
    type(state_type), intent(in) :: state
    type(elsewhere_type), intent(inout) :: elsewhere
    type(error_type), allocatable, intent(out) :: err
    type(random_type) :: random
    real(wp) :: amount
    integer :: trial, i, k

    if (elsewhere%exists) return
    elsewhere%exists = .true.
    amount = 0.3_wp
    do trial = 1, 6
      elsewhere%state = state
      elsewhere%closed = .true.
      do i = 1, size(plan%independent)
        k = plan%independent(i)
        elsewhere%state%q(k) = state%q(k) + amount*plan%unit_of(k)*random%symmetric()
      end do
      do i = 1, size(before)
        call extend(plan, before(i), state, elsewhere, err)
        if (allocated(err)) return
        if (.not. elsewhere%closed) exit
      end do
      if (elsewhere%closed) return
      amount = -0.5_wp*amount
    end do
  end subroutine go_elsewhere

  !> Close one more block elsewhere, from its coordinates at the start, somewhat changed: away from
  !> a singular start either way will do.
  subroutine extend(plan, block, state, elsewhere, err)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    type(elsewhere_type), intent(inout) :: elsewhere
    type(error_type), allocatable, intent(out) :: err
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(random_type) :: random
    integer :: i, k

    work = new_block_work(block)
    do i = 1, size(block%unknowns)
      k = plan%steps(block%unknowns(i))%coordinate
      elsewhere%state%q(k) = state%q(k) + 0.2_wp*plan%unit_of(k)*random%symmetric()
    end do
    call assemble_block(plan, block, elsewhere%state, work, .false., outcome, err)
    elsewhere%closed = outcome%closed
  end subroutine extend

  !> The independent coordinates must be free to move at any rates.
  subroutine check_inputs(plan, state, elsewhere, err)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    type(elsewhere_type), intent(in) :: elsewhere
    type(error_type), allocatable, intent(out) :: err
    type(state_type) :: trial
    type(block_work_type) :: work
    type(random_type) :: random
    real(wp) :: remainder
    integer :: b, i

    trial = state
    if (elsewhere%exists .and. elsewhere%closed) trial = elsewhere%state
    do i = 1, size(plan%independent)
      trial%dq(plan%independent(i)) = plan%unit_of(plan%independent(i))*random%symmetric()
    end do
    do b = 1, size(plan%blocks)
      work = new_block_work(plan%blocks(b))
      if (plan%blocks(b)%equations > 0) call factorize_block(plan, plan%blocks(b), trial, work)
      call solve_rates(plan, plan%blocks(b), trial, work, remainder)
      if (remainder > 1.0e-7_wp) then
        call raise(err, exit_structure, 'the independent coordinates cannot all move freely: '// &
                   chain_names(plan%blocks(b))//' would not stay closed; '// &
                   overdetermined(plan, plan%blocks(b), trial))
        return
      end if
    end do
  end subroutine check_inputs

  !> Coordinates that nothing determines.
  subroutine refuse_free(plan, block, state, err)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: err
    character(len=:), allocatable :: text

    call place_frames(plan, block%first_step, block%last_step, state, err)
    if (allocated(err)) return
    if (block%equations == 0) then
      text = 'nothing determines the coordinates of an open chain'
    else
      text = chain_names(block)//' cannot determine all '//to_text(size(block%unknowns))// &
             ' dependent coordinates from the independent ones'
    end if
    call raise(err, exit_structure, text//'; '//undetermined(plan, block, state))
  end subroutine refuse_free

  !> Chains that do not close.
  subroutine refuse_open(plan, block, state, outcome, err)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    type(assembly_outcome_type), intent(in) :: outcome
    type(error_type), allocatable, intent(out) :: err
    character(len=:), allocatable :: text

    associate (closure => plan%closures(outcome%worst_closure))
      text = 'the mechanism cannot be assembled: closed chain '//to_text(closure%chain)// &
             ' (it closes on link '//to_text(plan%steps(closure%closing)%link)//' through coordinate '// &
             to_text(plan%steps(closure%closing)%coordinate)//') stays open by '//to_text(outcome%gap, 3)// &
             ' m at best; '
      if (outcome%gap < 1.0e-5_wp*plan%length) then
        text = text//'so small a gap comes from directions or points given with too few digits, '// &
               'for a chain that moves only when its geometry is exact'
      else if (size(block%unknowns) == 0) then
        text = text//'it has no dependent coordinate to close it'
      else
        text = text//'check its dimensions and the independent coordinates, or give better guesses with &initial'
      end if
    end associate
    call raise(err, exit_assembly, text)
  end subroutine refuse_open

  !> "closed chain 2" or "closed chains 1 to 3".
  pure function chain_names(block) result(names)
    type(block_type), intent(in) :: block
    character(len=:), allocatable :: names

    if (block%last_closure < block%first_closure) then
      names = 'an open chain'
    else if (block%last_closure == block%first_closure) then
      names = 'closed chain '//to_text(block%first_closure)
    else
      names = 'closed chains '//to_text(block%first_closure)//' to '//to_text(block%last_closure)//' together'
    end if
  end function chain_names

  !> In time only a block's own steps move against its closures.
  subroutine trim_paths(plan)
    type(plan_type), intent(inout) :: plan
    integer :: b, c
    logical, allocatable :: own(:)

    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        associate (path => plan%closures(c)%path)
          own = path%steps >= plan%blocks(b)%first_step
          path%signs = pack(path%signs, own)
          path%steps = pack(path%steps, own)
        end associate
      end do
    end do
  end subroutine trim_paths
end module mech9_planning
