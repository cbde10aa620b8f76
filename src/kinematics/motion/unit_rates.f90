!> Rates of all coordinates for a rate of one of each independent coordinate alone.
module mech9_unit_rates
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block, solve_rates
  implicit none
  private
  public :: find_unit_rates

contains

  !> Find these rates in a closed position.
  subroutine find_unit_rates(plan, state, rates)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< the position, with placed frames
    real(wp), allocatable, intent(out) :: rates(:, :)     !< (M, independent) in units of the coordinates
    type(state_type) :: moving
    type(block_work_type), allocatable :: work(:)
    integer :: b, i, k

    allocate (rates(plan%n_coordinates, size(plan%independent)), work(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      work(b) = new_block_work(plan%blocks(b))
      if (plan%blocks(b)%equations > 0) call factorize_block(plan, plan%blocks(b), state, work(b))
    end do
    moving = state
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      moving%dq = 0.0_wp
      moving%dq(k) = plan%unit_of(k)
      do b = 1, size(plan%blocks)
        call solve_rates(plan, plan%blocks(b), moving, work(b))
      end do
      rates(:, i) = moving%dq/plan%unit_of
    end do
  end subroutine find_unit_rates
end module mech9_unit_rates
