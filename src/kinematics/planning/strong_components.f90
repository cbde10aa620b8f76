!> Strongly connected components of a directed graph, each after those to which it leads (Tarjan's algorithm without
!> recursion, in linear time and memory; docs/reference/bibliography.md).
module mech9_strong_components
  implicit none
  private
  public :: graph_type, strong_components

  !> A directed graph by lists: node i leads to heads(first(i):first(i+1)-1).
  type :: graph_type
    integer :: n = 0                      !< number of nodes
    integer, allocatable :: first(:)      !< (n+1) first edge of each node
    integer, allocatable :: heads(:)      !< node to which each edge leads
  end type graph_type

contains

  !> Number of the component of each node. Components are numbered as they are completed, searching
  !> from the nodes in the order given.
  subroutine strong_components(graph, order, component, n_components)
    type(graph_type), intent(in) :: graph   !< the graph
    integer, intent(in) :: order(:)   !< every node once, in the order in which searches start
    integer, intent(out) :: component(:)   !< (n) number of the component of each node
    integer, intent(out) :: n_components   !< number of components
    integer :: number(graph%n)      ! order of discovery, 0: not yet
    integer :: low(graph%n)         ! the earliest node of its component known so far
    integer :: next(graph%n)        ! edge to follow next
    integer :: path(graph%n)        ! nodes from the root of the search to the present one
    integer :: unfinished(graph%n)        ! nodes whose component is not complete
    integer :: i, node, head, depth, n_unfinished, n_found

    number = 0
    component = 0
    n_components = 0
    n_found = 0
    n_unfinished = 0
    do i = 1, size(order)
      if (number(order(i)) /= 0) cycle
      depth = 0
      call enter(order(i))
      do while (depth > 0)
        node = path(depth)
        if (next(node) < graph%first(node + 1)) then
          head = graph%heads(next(node))
          next(node) = next(node) + 1
          if (number(head) == 0) then
            call enter(head)
          else if (component(head) == 0) then
            low(node) = min(low(node), number(head))
          end if
        else
          if (low(node) == number(node)) call complete(node)
          depth = depth - 1
          if (depth > 0) low(path(depth)) = min(low(path(depth)), low(node))
        end if
      end do
    end do

  contains

    !> Begin with a node that was not found before.
    subroutine enter(new)
      integer, intent(in) :: new   !< node that the search reaches for the first time

      n_found = n_found + 1
      number(new) = n_found
      low(new) = n_found
      next(new) = graph%first(new)
      depth = depth + 1
      path(depth) = new
      n_unfinished = n_unfinished + 1
      unfinished(n_unfinished) = new
    end subroutine enter

    !> The nodes that are open since `root` was found are a component.
    subroutine complete(root)
      integer, intent(in) :: root   !< the node of the component that was found first
      integer :: last

      n_components = n_components + 1
      do
        last = unfinished(n_unfinished)
        n_unfinished = n_unfinished - 1
        component(last) = n_components
        if (last == root) return
      end do
    end subroutine complete
  end subroutine strong_components
end module mech9_strong_components
