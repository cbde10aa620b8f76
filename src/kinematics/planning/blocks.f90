!> The smallest blocks: which chains must be solved together, and in which order.
!>
!> Each unknown is given to a closed chain that can determine it. A chain then needs the unknowns on
!> its loop that belong to other chains, and those that place the links its loop stands on. Chains
!> that need each other, directly or around, are a block; blocks come in the order of these needs.
module mech9_blocks
  use mech9_tree_paths, only: find_loop, split_loops
  use mech9_plan, only: plan_type, step_type, closure_type, block_type
  use mech9_chain_matching, only: loop_lists_type, match_chains
  use mech9_strong_components, only: graph_type, strong_components
  implicit none
  private
  public :: make_blocks, count_block

contains

  !> Divide a plan into blocks and put its steps and closures in their order. Where some unknowns have
  !> no chain that could determine them, the plan is left as it is, in no blocks.
  subroutine make_blocks(plan, undetermined)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    integer, allocatable, intent(out) :: undetermined(:)   !< numbers of the coordinates that no closed chain can determine
    integer :: owner(plan%n_coordinates)                   ! chain that determines the coordinate of each step
    integer :: block_of_step(plan%n_coordinates), block_of_closure(size(plan%closures)), n_blocks, s

    call match_chains(loops_of(plan), plan%closures%offers, owner)
    undetermined = pack(plan%steps%coordinate, plan%steps%dependent .and. owner == 0)
    if (size(undetermined) > 0) return
    call find_blocks(plan, owner, block_of_step, block_of_closure, n_blocks)
    call place_free_steps(plan, owner, block_of_closure, block_of_step, n_blocks)
    allocate (plan%blocks(n_blocks))
    call sort_plan(plan, block_of_step, block_of_closure)
    do s = 1, n_blocks
      call count_block(plan, plan%blocks(s))
      call split_loops(plan%blocks(s), plan)
    end do
  end subroutine make_blocks

  !> Unknowns, equations and chains of a block from its ranges.
  pure subroutine count_block(plan, block)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(inout) :: block   !< the block
    integer :: s

    block%unknowns = pack([(s, s=block%first_step, block%last_step)], &
                          plan%steps(block%first_step:block%last_step)%dependent)
    block%coordinates = plan%steps(block%unknowns)%coordinate
    block%equations = sum(plan%closures(block%first_closure:block%last_closure)%rank)
    block%chains = plan%closures(block%first_closure:block%last_closure)%chain
  end subroutine count_block

  !> The steps with unknown coordinates on each loop, outermost first: these belong to the chain itself.
  pure function loops_of(plan) result(loops)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(loop_lists_type) :: loops
    integer :: c, i, n

    loops%n_chains = size(plan%closures)
    loops%n_unknowns = plan%n_coordinates
    allocate (loops%first(loops%n_chains + 1))
    loops%first(1) = 1
    do c = 1, loops%n_chains
      loops%first(c + 1) = loops%first(c) + count(plan%steps(plan%closures(c)%loop%steps)%dependent)
    end do
    allocate (loops%unknowns(loops%first(loops%n_chains + 1) - 1))
    n = 0
    do c = 1, loops%n_chains
      associate (steps => plan%closures(c)%loop%steps)
        do i = size(steps), 1, -1
          if (.not. plan%steps(steps(i))%dependent) cycle
          n = n + 1
          loops%unknowns(n) = steps(i)
        end do
      end associate
    end do
  end function loops_of

  !> Blocks of the closures and of the steps with unknown coordinates. The graph has a node for each
  !> step and, behind them, one for each closure; each leads to what must be there before it.
  subroutine find_blocks(plan, owner, block_of_step, block_of_closure, n_blocks)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: owner(:)   !< (M) number of the closure that determines the coordinate of each step; 0 if none
    integer, intent(out) :: block_of_step(:)   !< (M) number of the block of each step; 0 where its coordinate is given
    integer, intent(out) :: block_of_closure(:)   !< number of the block of each closure
    integer, intent(out) :: n_blocks   !< number of blocks
    type(graph_type) :: requested
    integer :: component(plan%n_coordinates + size(plan%closures))
    integer :: block_of(plan%n_coordinates + size(plan%closures))
    integer :: m, n, i, c

    m = plan%n_coordinates
    requested = graph_of_needs(plan, owner)
    call strong_components(requested, [(m + c, c=1, size(plan%closures)), (i, i=1, m)], component, n)
    ! components without a closure are single steps whose coordinates are given
    block_of = 0
    do c = 1, size(plan%closures)
      block_of(component(m + c)) = 1
    end do
    n_blocks = 0
    do i = 1, n
      if (block_of(i) == 0) cycle
      n_blocks = n_blocks + 1
      block_of(i) = n_blocks
    end do
    block_of_step = block_of(component(:m))
    block_of_closure = block_of(component(m + 1:))
  end subroutine find_blocks

  !> A step needs its parent and, where its coordinate is unknown, the closure that determines it; a
  !> closure needs all steps of its loop.
  function graph_of_needs(plan, owner) result(requested)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: owner(:)   !< (M) number of the closure that determines the coordinate of each step; 0 if none
    type(graph_type) :: requested
    integer :: m, c, s, n

    m = plan%n_coordinates
    requested%n = m + size(plan%closures)
    n = 2*m
    do c = 1, size(plan%closures)
      n = n + size(plan%closures(c)%loop%steps)
    end do
    allocate (requested%first(requested%n + 1), requested%heads(n))
    n = 0
    do s = 1, m
      requested%first(s) = n + 1
      if (plan%steps(s)%parent > 0) call add(plan%steps(s)%parent)
      if (owner(s) > 0) call add(m + owner(s))
    end do
    do c = 1, size(plan%closures)
      requested%first(m + c) = n + 1
      do s = 1, size(plan%closures(c)%loop%steps)
        call add(plan%closures(c)%loop%steps(s))
      end do
    end do
    requested%first(requested%n + 1) = n + 1

  contains

    subroutine add(head)
      integer, intent(in) :: head   !< node that must come before the present one

      n = n + 1
      requested%heads(n) = head
    end subroutine add
  end function graph_of_needs

  !> Steps whose coordinates are given go into the first block that needs them; what no closure needs
  !> are open chains, each of which has its own block at the end.
  pure subroutine place_free_steps(plan, owner, block_of_closure, block_of_step, n_blocks)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: owner(:)   !< (M) number of the closure that determines the coordinate of each step; 0 if none
    integer, intent(in) :: block_of_closure(:)   !< number of the block of each closure
    integer, intent(inout) :: block_of_step(:)   !< (M) number of the block of each step; gets those of the given coordinates
    integer, intent(inout) :: n_blocks   !< number of blocks; raised by those of open chains
    integer :: c, i, s, chain

    do s = 1, plan%n_coordinates
      if (owner(s) == 0) block_of_step(s) = huge(s)
    end do
    do c = 1, size(plan%closures)
      do i = 1, size(plan%closures(c)%loop%steps)
        s = plan%closures(c)%loop%steps(i)
        if (owner(s) == 0) block_of_step(s) = min(block_of_step(s), block_of_closure(c))
      end do
    end do
    do s = plan%n_coordinates, 1, -1
      i = plan%steps(s)%parent
      if (i == 0) cycle
      if (owner(i) == 0) block_of_step(i) = min(block_of_step(i), block_of_step(s))
    end do
    chain = 0
    do s = 1, plan%n_coordinates
      if (block_of_step(s) < huge(s)) cycle
      if (plan%steps(s)%chain /= chain) n_blocks = n_blocks + 1
      chain = plan%steps(s)%chain
      block_of_step(s) = n_blocks
    end do
  end subroutine place_free_steps

  !> Steps and closures in the order of their blocks, otherwise as before, and the ranges of the blocks.
  pure subroutine sort_plan(plan, block_of_step, block_of_closure)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    integer, intent(in) :: block_of_step(:)   !< (M) number of the block of each step
    integer, intent(in) :: block_of_closure(:)   !< number of the block of each closure
    integer :: place(0:plan%n_coordinates)      ! new number of each step, and of the frame it makes
    integer :: last(0:size(plan%blocks))
    integer :: order(size(plan%closures))

    call counting_sort(block_of_step, size(plan%blocks), last, place(1:))
    place(0) = 0
    plan%blocks%first_step = last(:size(plan%blocks) - 1) + 1
    plan%blocks%last_step = last(1:)
    call renumber_steps(plan, place)
    call counting_sort(block_of_closure, size(plan%blocks), last, order)
    plan%blocks%first_closure = last(:size(plan%blocks) - 1) + 1
    plan%blocks%last_closure = last(1:)
    call renumber_closures(plan, place, order)
  end subroutine sort_plan

  !> New place of each item by its key; items of one key keep their order.
  pure subroutine counting_sort(keys, n_keys, last, place)
    integer, intent(in) :: keys(:)          !< 1 .. n_keys
    integer, intent(in) :: n_keys   !< number of keys
    integer, intent(out) :: last(0:)        !< last place of each key
    integer, intent(out) :: place(:)   !< new place of each item
    integer :: next(n_keys), i

    last = 0
    do i = 1, size(keys)
      last(keys(i)) = last(keys(i)) + 1
    end do
    do i = 1, n_keys
      last(i) = last(i) + last(i - 1)
    end do
    next = last(:n_keys - 1)
    do i = 1, size(keys)
      next(keys(i)) = next(keys(i)) + 1
      place(i) = next(keys(i))
    end do
  end subroutine counting_sort

  pure subroutine renumber_steps(plan, place)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    integer, intent(in) :: place(0:)   !< (0:M) new number of each step and of the frame that it makes
    type(step_type), allocatable :: steps(:)
    integer :: s

    allocate (steps(size(plan%steps)))
    do s = 1, size(steps)
      steps(place(s)) = plan%steps(s)
      steps(place(s))%parent = place(plan%steps(s)%parent)
      plan%step_of(plan%steps(s)%coordinate) = place(s)
    end do
    call move_alloc(steps, plan%steps)
    plan%frame_of = place(plan%frame_of)
  end subroutine renumber_steps

  pure subroutine renumber_closures(plan, place, order)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    integer, intent(in) :: place(0:)      !< new number of each step and frame
    integer, intent(in) :: order(:)       !< new number of each closure
    type(closure_type), allocatable :: closures(:)
    integer :: c

    allocate (closures(size(plan%closures)))
    do c = 1, size(closures)
      closures(order(c)) = plan%closures(c)
      associate (closure => closures(order(c)))
        closure%closing = place(closure%closing)
        closure%target = place(closure%target)
      end associate
      call find_loop(plan%steps, closures(order(c)))
    end do
    call move_alloc(closures, plan%closures)
  end subroutine renumber_closures
end module mech9_blocks
