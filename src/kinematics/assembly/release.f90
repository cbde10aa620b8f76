!> Assembly with the independent coordinates set free, and a motion that moves these back to their given values.
!>
!> A position in which all chains close is found more easily if every coordinate may change. The mobility can be judged
!> there, and the given values may be reached from there by a motion.
module mech9_release
  use mech9_kinds, only: wp
  use mech9_assembly_tolerances, only: least_part_of_carrying
  use mech9_error, only: error_type
  use mech9_plan, only: plan_type, block_type, without_periods
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, newton_outcome_type, close_block
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  use mech9_generic_position, only: free_block
  implicit none
  private
  public :: close_free, move_inputs, most_free_coordinates

  !> Mechanisms with more coordinates are not closed as one block.
  integer, parameter :: most_free_coordinates = 500

contains

  !> Close all chains from the coordinates in `state`, all of which may change.
  subroutine close_free(plan, state, may_restart, outcome, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    logical, intent(in) :: may_restart   !< try changed guesses where the given one fails
    type(assembly_outcome_type), intent(out) :: outcome   !< result of the assembly
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(block_type) :: block
    type(block_work_type) :: work

    block = free_block(plan, plan%n_coordinates, size(plan%closures))
    work = new_block_work(block)
    call assemble_block(plan, block, state, work, may_restart, outcome, err)
  end subroutine close_free

  !> Move the independent coordinates from a closed position to given values and keep the chains closed; `arrived` shows
  !> whether that was possible. Angles change by at most half a turn.
  subroutine move_inputs(plan, target, state, arrived)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: target(:)   !< (M) coordinates; only those of the independent ones count [rad, m]
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    logical, intent(out) :: arrived   !< the given values were reached
    type(block_type) :: block
    type(block_work_type) :: work
    type(newton_outcome_type) :: newton
    type(error_type), allocatable :: err
    real(wp) :: from(size(plan%independent)), distance(size(plan%independent)), before(plan%n_coordinates)
    real(wp) :: done, part
    integer :: s

    block = free_block(plan, plan%n_coordinates, size(plan%closures))
    block%unknowns = pack([(s, s=1, plan%n_coordinates)], plan%steps%dependent)
    block%coordinates = plan%steps(block%unknowns)%coordinate
    work = new_block_work(block)
    from = state%q(plan%independent)
    distance = target(plan%independent) - from
    do s = 1, size(distance)
      associate (step => plan%steps(plan%step_of(plan%independent(s))))
        distance(s) = without_periods(step, distance(s))
      end associate
    end do
    done = 0.0_wp
    part = 0.1_wp
    before = state%q
    do while (done < 1.0_wp .and. part >= least_part_of_carrying)
      part = min(part, 1.0_wp - done)
      state%q = before
      state%q(plan%independent) = from + (done + part)*distance
      if (done + part >= 1.0_wp) state%q(plan%independent) = target(plan%independent)
      call close_block(plan, block, state, work, newton, err)
      if (.not. allocated(err) .and. newton%converged .and. newton%correction < 0.5_wp) then
        before = state%q
        done = done + part
        part = 2.0_wp*part
      else
        part = 0.25_wp*part
      end if
    end do
    arrived = done >= 1.0_wp
    state%q = before
  end subroutine move_inputs
end module mech9_release
