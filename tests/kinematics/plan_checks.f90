!> Checks that any plan must pass, whatever the mechanism.
module mech9_plan_checks
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block, solve_rates
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: check_order, check_closed, check_smallest, block_sizes, rates_of

  !> Blocks with more chains are not tried in all divisions.
  integer, parameter :: most_chains = 12

contains

  !> Every step and closure is in one block, frames stand on frames that are there before them, and a
  !> block has as many equations as unknowns or more.
  subroutine check_order(test, plan, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(in) :: plan        !< its plan
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    integer :: b, c, s, step, closure
    logical :: right

    right = .true.
    step = 0
    closure = 0
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        right = right .and. block%first_step == step + 1 .and. block%first_closure == closure + 1
        right = right .and. block%equations >= size(block%unknowns)
        step = block%last_step
        closure = block%last_closure
        do s = block%first_step, block%last_step
          right = right .and. plan%steps(s)%parent < s .and. plan%step_of(plan%steps(s)%coordinate) == s
        end do
        do c = block%first_closure, block%last_closure
          right = right .and. max(plan%closures(c)%closing, plan%closures(c)%target) <= block%last_step
          right = right .and. plan%steps(plan%closures(c)%closing)%link == link_of(plan, plan%closures(c)%target)
        end do
      end associate
    end do
    right = right .and. step == plan%n_coordinates .and. closure == size(plan%closures)
    call test%is_true(right, why//': steps, closures and blocks stand in a valid order')
  end subroutine check_order

  pure integer function link_of(plan, frame)
    type(plan_type), intent(in) :: plan   !< its plan
    integer, intent(in) :: frame          !< its number

    link_of = 1
    if (frame > 0) link_of = plan%steps(frame)%link
  end function link_of

  !> All chains are closed: a sum over the steps of a loop leaves some units of round-off, of lengths up
  !> to the reach of the whole mechanism.
  subroutine check_closed(test, plan, state, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(in) :: plan        !< its plan
    type(state_type), intent(in) :: state      !< its state
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp) :: largest, reach
    integer :: c

    reach = plan%length
    if (plan%planar%used) then
      reach = max(reach, maxval(abs(state%planar%pose(3:4, :))))
    else
      reach = max(reach, maxval(abs(state%p)))
    end if
    largest = 0.0_wp
    do c = 1, size(plan%closures)
      largest = max(largest, plan%constraints(c)%item%gap(plan, state))
    end do
    call test%near(largest/reach, 0.0_wp, 1.0e-13_wp, why//': the chains are closed to round-off')
  end subroutine check_closed

  !> No block could be divided: the loops of any part of its chains, and the frames they stand on, leave more
  !> unknowns than the part has equations (the condition of Hall, with strict inequality).
  subroutine check_smallest(test, plan, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(in) :: plan        !< its plan
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    integer :: b
    logical :: smallest

    smallest = .true.
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        if (block%equations > size(block%unknowns) .or. size(block%chains) > most_chains) cycle
        smallest = smallest .and. cannot_be_divided(plan, block)
      end associate
    end do
    call test%is_true(smallest, why//': no block could be smaller')
  end subroutine check_smallest

  pure logical function cannot_be_divided(plan, block)
    type(plan_type), intent(in) :: plan     !< its plan
    type(block_type), intent(in) :: block   !< one of its blocks
    logical :: met(0:plan%n_coordinates)
    integer :: part, c, s, equations, n

    cannot_be_divided = .true.
    n = size(block%chains)
    do part = 1, 2**n - 2
      met = .false.
      equations = 0
      do c = 1, n
        if (.not. btest(part, c - 1)) cycle
        associate (closure => plan%closures(block%first_closure + c - 1))
          met(closure%part%steps) = .true.
          equations = equations + closure%rank
        end associate
      end do
      do s = block%last_step, block%first_step, -1
        if (met(s)) met(plan%steps(s)%parent) = .true.
      end do
      if (count(met(block%unknowns)) <= equations) cannot_be_divided = .false.
    end do
  end function cannot_be_divided

  !> Unknowns of the blocks that have any.
  pure function block_sizes(plan) result(sizes)
    type(plan_type), intent(in) :: plan   !< its plan
    integer, allocatable :: sizes(:)
    integer :: b

    sizes = [(size(plan%blocks(b)%unknowns), b=1, size(plan%blocks))]
    sizes = pack(sizes, sizes > 0)
  end function block_sizes

  !> Rates of all coordinates from those of the independent ones, block by block.
  subroutine rates_of(plan, state, rates)
    type(plan_type), intent(in) :: plan     !< its plan
    type(state_type), intent(in) :: state   !< closed, with rates of the independent coordinates
    real(wp), intent(inout) :: rates(:)     !< on entry those of the independent coordinates
    type(state_type) :: moving
    type(block_work_type) :: work
    integer :: b

    moving = state
    moving%dq = rates
    do b = 1, size(plan%blocks)
      work = new_block_work(plan%blocks(b))
      if (size(plan%blocks(b)%unknowns) > 0) call factorize_block(plan, plan%blocks(b), moving, work)
      call solve_rates(plan, plan%blocks(b), moving, work)
    end do
    rates = moving%dq
  end subroutine rates_of
end module mech9_plan_checks
