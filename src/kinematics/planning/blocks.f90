!> The smallest blocks of chains that must be solved together, and the order of these blocks.
!>
!> Each unknown is assigned to a closed chain that can determine it (a matching). A chain then depends on the unknowns of its
!> loop that are assigned to other chains, and on those that place the links on which its loop stands. Chains that depend
!> on each other, directly or through others, are a block (a strongly connected component); each block comes after those on
!> which it depends. Matching and components together are the decomposition of Dulmage and Mendelsohn
!> (docs/reference/bibliography.md).
module mech9_blocks
  use mech9_kinds, only: wp
  use mech9_tree_paths, only: find_loop, split_loops, ascending
  use mech9_plan, only: plan_type, step_type, closure_type, block_type
  use mech9_chain_matching, only: loop_lists_type, match_chains
  use mech9_strong_components, only: graph_type, strong_components
  implicit none
  private
  public :: make_blocks, count_block

contains

  !> Divide a plan into blocks and sort its steps and closures by them. If no chain can determine some of the unknowns, the
  !> plan is left unchanged, without blocks.
  subroutine make_blocks(plan, undetermined)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    integer, allocatable, intent(out) :: undetermined(:)   !< numbers of the coordinates that no closed chain can determine
    integer :: owner(plan%n_coordinates)                   ! chain that determines the coordinate of each step
    integer :: block_of_step(plan%n_coordinates), block_of_closure(size(plan%closures)), n_blocks, s

    call match_chains(loops_of(plan), plan%closures%independent_equations, owner)
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
    block%is_linear = .true.
    do s = block%first_closure, block%last_closure
      if (plan%closures(s)%coupling > 0) then
        if (plan%couplings(plan%closures(s)%coupling)%coupling%is_linear()) cycle
        block%regular_pivot = 1.0_wp           ! the weights of couplings make their greatest derivatives one
      end if
      block%is_linear = .false.
    end do
  end subroutine count_block

  !> The steps with unknown coordinates on each loop, outermost first: the outermost steps are those of the chain itself.
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

  !> Blocks of the closures and of the steps with unknown coordinates. The graph has a node for each step and, after these,
  !> one for each closure; the edges of a node lead to the nodes on which it depends.
  subroutine find_blocks(plan, owner, block_of_step, block_of_closure, n_blocks)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: owner(:)   !< (M) number of the closure that determines the coordinate of each step; 0 if none
    integer, intent(out) :: block_of_step(:)   !< (M) number of the block of each step; 0 where its coordinate is given
    integer, intent(out) :: block_of_closure(:)   !< number of the block of each closure
    integer, intent(out) :: n_blocks   !< number of blocks
    type(graph_type) :: graph
    integer :: component(plan%n_coordinates + size(plan%closures))
    integer :: block_of(plan%n_coordinates + size(plan%closures))
    integer :: m, n, i, c

    m = plan%n_coordinates
    graph = dependence_graph(plan, owner)
    call strong_components(graph, [(m + c, c=1, size(plan%closures)), (i, i=1, m)], component, n)
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

  !> A step depends on its parent and, where its coordinate is unknown, on the closure that determines it; a closure depends on
  !> all steps of its loop.
  function dependence_graph(plan, owner) result(graph)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: owner(:)   !< (M) number of the closure that determines the coordinate of each step; 0 if none
    type(graph_type) :: graph
    integer :: m, c, s, n

    m = plan%n_coordinates
    graph%n = m + size(plan%closures)
    n = 2*m
    do c = 1, size(plan%closures)
      n = n + size(plan%closures(c)%loop%steps)
    end do
    allocate (graph%first(graph%n + 1), graph%heads(n))
    n = 0
    do s = 1, m
      graph%first(s) = n + 1
      if (plan%steps(s)%parent > 0) call add(plan%steps(s)%parent)
      if (owner(s) > 0) call add(m + owner(s))
    end do
    do c = 1, size(plan%closures)
      graph%first(m + c) = n + 1
      do s = 1, size(plan%closures(c)%loop%steps)
        call add(plan%closures(c)%loop%steps(s))
      end do
    end do
    graph%first(graph%n + 1) = n + 1

  contains

    !> Add an edge from the present node.
    subroutine add(head)
      integer, intent(in) :: head   !< node that must come before the present one

      n = n + 1
      graph%heads(n) = head
    end subroutine add
  end function dependence_graph

  !> Steps whose coordinates are given go into the first block that depends on them. Steps on which no closure depends are open
  !> chains, each of which has its own block at the end.
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

  !> Sort steps and closures by their blocks, in the same order within each block, and set the ranges of the blocks.
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

  !> Put the steps, and the frames they make, in their new order.
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

  !> Put the closures in their new order, with the new numbers of steps and frames.
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
        if (closure%coupling > 0) then
          closure%loop%steps = ascending(place(closure%loop%steps))
        else
          call find_loop(plan%steps, closure)
        end if
      end associate
    end do
    call move_alloc(closures, plan%closures)
  end subroutine renumber_closures
end module mech9_blocks
