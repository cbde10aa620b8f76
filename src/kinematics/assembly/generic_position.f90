!> A generic position: a closed position away from the start, at which ranks are judged if the start is, or may be, singular.
module mech9_generic_position
  use mech9_kinds, only: wp
  use mech9_assembly_tolerances, only: least_movement
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_plan, only: plan_type, block_type, within_range
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  implicit none
  private
  public :: generic_position_type, find_generic_position, free_block

  !> The generic position, as far as blocks needed it.
  type :: generic_position_type
    type(state_type) :: state              !< the position
    logical :: exists = .false.            !< there is a position in `state`
    integer :: closed_to = 0               !< number of the last step of the blocks that are closed there
    integer :: trials = 0                  !< number of whole positions that were tried
    type(random_type) :: random            !< source of the changes of coordinates
  end type generic_position_type

  !> Largest number of positions that are tried for all blocks together.
  integer, parameter :: most_trials = 40
  !> Largest number of positions that are tried for one block.
  integer, parameter :: most_trials_each = 12
  !> Blocks whose last step is at most this one are also closed with their independent coordinates free.
  integer, parameter :: largest_free_block = 200

contains

  !> Find a generic position that is closed for all the given blocks; `closed` is the success.
  !>
  !> First the independent coordinates are changed at random, by less and less, and the blocks are closed from coordinates
  !> that are changed too: where branches meet at the start, any of them serves. Where the independent coordinates cannot
  !> move in both directions from the start, half of the trials fail; where no trial closes, all coordinates are set free.
  subroutine find_generic_position(plan, blocks, start, generic, closed)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: blocks(:)   !< the first blocks of the plan, in their order
    type(state_type), intent(in) :: start   !< an assembled position of these blocks
    type(generic_position_type), intent(inout) :: generic   !< the generic position, as far as it is made
    logical, intent(out) :: closed   !< the position is closed for all these blocks
    integer :: trial, n

    n = size(blocks)
    closed = generic%exists .and. generic%closed_to >= blocks(n)%last_step
    if (closed) return
    if (generic%exists .and. generic%closed_to >= blocks(n)%first_step - 1) then
      do trial = 1, 3
        call close_next_block(plan, blocks(n), start, amount_of(trial), generic, closed)
        if (closed) return
      end do
    end if
    do trial = 1, most_trials_each
      if (generic%trials >= most_trials) exit
      call try_inputs(plan, blocks, start, amount_of(trial), generic, closed)
      if (closed) return
    end do
    if (blocks(n)%last_step <= largest_free_block) call try_all_free(plan, blocks(n), start, generic, closed)
  end subroutine find_generic_position

  !> The change of coordinates in a trial, in their units.
  pure real(wp) function amount_of(trial)
    integer, intent(in) :: trial   !< number of the trial, from 1

    amount_of = 0.3_wp/2.0_wp**modulo(trial - 1, 5)
  end function amount_of

  !> Change the independent coordinates and close all blocks.
  subroutine try_inputs(plan, blocks, start, amount, generic, closed)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: blocks(:)   !< the first blocks of the plan, in their order
    type(state_type), intent(in) :: start   !< an assembled position
    real(wp), intent(in) :: amount   !< change of the coordinates, in their units
    type(generic_position_type), intent(inout) :: generic   !< the generic position, as far as it is made
    logical, intent(out) :: closed   !< the position is closed for all these blocks
    real(wp) :: change
    integer :: i, k

    generic%trials = generic%trials + 1
    generic%exists = .true.
    generic%state = start
    generic%closed_to = 0
    closed = .true.
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      change = generic%random%symmetric()
      ! a change that is too small would let contradicting chains seem closed
      generic%state%q(k) = within_range(plan%steps(plan%step_of(k)), &
                                        start%q(k) + amount*plan%unit_of(k)*(change + sign(0.5_wp, change)))
    end do
    do i = 1, size(blocks)
      call close_next_block(plan, blocks(i), start, amount, generic, closed)
      if (.not. closed) return
    end do
  end subroutine try_inputs

  !> Close one more block from its coordinates at the start with random changes.
  subroutine close_next_block(plan, block, start, amount, generic, closed)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: start   !< an assembled position
    real(wp), intent(in) :: amount   !< change of the coordinates, in their units
    type(generic_position_type), intent(inout) :: generic   !< the generic position, as far as it is made
    logical, intent(out) :: closed   !< the block was closed
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    integer :: i, k

    work = new_block_work(block)
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      generic%state%q(k) = within_range(plan%steps(block%unknowns(i)), &
                                        start%q(k) + amount*plan%unit_of(k)*generic%random%symmetric())
    end do
    call assemble_block(plan, block, generic%state, work, .false., outcome, err)
    closed = outcome%closed .and. .not. allocated(err)
    if (closed) generic%closed_to = block%last_step
  end subroutine close_next_block

  !> Change all coordinates up to a block, the independent ones too, and close all these blocks as one.
  subroutine try_all_free(plan, last, start, generic, closed)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: last           !< the last block that must be closed
    type(state_type), intent(in) :: start   !< an assembled position
    type(generic_position_type), intent(inout) :: generic   !< the generic position, as far as it is made
    logical, intent(out) :: closed   !< the position is closed for all these blocks
    type(block_type) :: block
    integer :: trial

    block = free_block(plan, last%last_step, last%last_closure)
    do trial = 1, 3
      generic%state = start
      generic%exists = .true.
      generic%closed_to = 0
      call close_next_block(plan, block, start, amount_of(trial), generic, closed)
      ! a chain that cannot move returns to the start, which is not a generic position
      closed = closed .and. has_moved(plan, last, start, generic%state)
      if (closed) return
      generic%closed_to = 0
    end do
  end subroutine try_all_free

  !> Whether some coordinate on the loops of a block differs between two positions.
  pure logical function has_moved(plan, block, start, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: start   !< an assembled position
    type(state_type), intent(in) :: state   !< the other position
    integer :: c, i, k

    has_moved = block%last_closure < block%first_closure
    do c = block%first_closure, block%last_closure
      do i = 1, size(plan%closures(c)%loop%steps)
        k = plan%steps(plan%closures(c)%loop%steps(i))%coordinate
        has_moved = has_moved .or. abs(state%q(k) - start%q(k)) > least_movement*plan%unit_of(k)
      end do
    end do
  end function has_moved

  !> All steps and closures up to the given ones as one block, in which every coordinate is unknown.
  pure function free_block(plan, last_step, last_closure) result(block)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: last_step   !< number of the last step of the block
    integer, intent(in) :: last_closure   !< number of its last closure
    type(block_type) :: block
    integer :: i

    block%whole_loops = .true.
    block%arithmetic = merge(1, 0, size(plan%arithmetics) == 1)
    block%first_step = 1
    block%last_step = last_step
    block%first_closure = 1
    block%last_closure = last_closure
    block%unknowns = [(i, i=1, last_step)]
    block%coordinates = plan%steps(block%unknowns)%coordinate
    block%equations = sum(plan%closures(:last_closure)%rank)
    block%chains = plan%closures(:last_closure)%chain
  end function free_block
end module mech9_generic_position
