!> The plan of a sparse QR factorization by fronts (multifrontal; Duff and Reid, Davis in docs/reference/bibliography.md).
!>
!> The equations of a block of closed chains come in groups, one for each constraint, and each group has derivatives with
!> respect to the unknowns of its own loop only. Unknowns that occur in the same groups are a class. A *front* is a small full
!> matrix: it takes all rows in which the unknowns of one or more classes occur, eliminates these unknowns, its pivots, and
!> passes the rows that remain on to a later front, its parent. So the legs of a platform, whose unknowns occur in one
!> closure each, are eliminated one by one, and the rest is a small matrix of the leg that all closures share.
!>
!> The order is found by the least front: the next class is the one whose front has the fewest numbers.
module mech9_front_plan
  use mech9_kinds, only: wp
  implicit none
  private
  public :: front_plan_type, front_type, row_groups_type, new_front_plan, add_diagonal

  !> Fronts are used where they need at most this part of the operations of the full matrix.
  real(wp), parameter :: worthwhile_part = 0.5_wp
  !> Matrices with fewer columns are factorized as a whole.
  integer, parameter :: least_columns = 7

  !> One front. Its columns are the pivots, then the others, which are also columns of its parent.
  type :: front_type
    integer :: rows = 0         !< number of rows
    integer :: pivots = 0       !< number of columns that are eliminated
    integer :: columns = 0      !< number of all columns
    integer :: original = 0     !< number of rows that are rows of the matrix; the rest comes from earlier fronts
    integer :: value = 0        !< number of values of all fronts before it
    integer :: row = 0          !< number of rows of all fronts before it
    integer :: column = 0       !< number of columns of all fronts before it
    integer :: pivot = 0        !< number of pivots of all fronts before it
    integer :: square = 0       !< number of squares of columns of all fronts before it that have children
    logical :: has_children = .false.   !< earlier fronts pass rows on to it
    logical :: shares_parent = .false.  !< it has no children, and its other columns are those of its parent in the same order
    integer :: parent = 0       !< number of the front that takes its remaining rows; 0: none
    integer :: parent_row = 0   !< number of rows of the parent before these
  end type front_type

  !> The fronts of a matrix, children before parents.
  type :: front_plan_type
    logical :: used = .false.               !< fronts save work
    integer :: m = 0                        !< rows of the matrix
    integer :: n = 0                        !< columns of the matrix
    type(front_type), allocatable :: fronts(:)
    integer, allocatable :: rows(:)         !< row of the matrix, at the place of each original row of each front
    integer, allocatable :: columns(:)      !< column of the matrix, at the place of each column of each front
    integer, allocatable :: places(:)       !< its number among the columns of the parent, the same for columns beyond the pivots
    integer :: sign = 1                     !< of the determinant of the permutations of rows and columns, where m = n
  end type front_plan_type

  !> The rows of a matrix in groups, one behind the other.
  type :: row_groups_type
    integer :: n = 0                     !< number of columns of the matrix
    integer, allocatable :: sizes(:)     !< (groups) number of rows of each group
    integer, allocatable :: first(:)     !< (groups+1) columns of group g are members(first(g):first(g+1)-1)
    integer, allocatable :: members(:)   !< columns in which the rows of each group are not zero
  end type row_groups_type

  !> A list of numbers.
  type :: list_type
    integer, allocatable :: items(:)   !< the numbers
  end type list_type

  !> Groups of rows and classes of columns while the fronts are planned.
  type :: graph_type
    integer :: n_groups = 0                      !< number of groups so far
    integer, allocatable :: rows(:)              !< (groups) number of rows of each group
    integer, allocatable :: first_row(:)         !< (groups) number of the first row of each group of the matrix
    integer, allocatable :: made_by(:)           !< (groups) front whose remaining rows are the group; 0: rows of the matrix
    type(list_type), allocatable :: classes(:)   !< (groups) classes that occur in each group
    type(list_type), allocatable :: groups(:)    !< (classes) groups in which each class occurs; none after its elimination
    type(list_type), allocatable :: members(:)   !< (classes) columns of each class
  end type graph_type

contains

  !> The plan for a matrix whose rows come in groups. It is used only where it saves work.
  pure function new_front_plan(groups) result(plan)
    type(row_groups_type), intent(in) :: groups   !< the rows of the matrix
    type(front_plan_type) :: plan
    type(graph_type) :: graph
    integer, allocatable :: cost(:)
    integer :: c

    plan%m = sum(groups%sizes)
    plan%n = groups%n
    allocate (plan%fronts(0), plan%rows(0), plan%columns(0))
    if (plan%n < least_columns .or. plan%m < plan%n .or. size(groups%sizes) < 2) return
    graph = new_graph(plan%n, groups%sizes, groups%first, groups%members)
    allocate (cost(size(graph%members)))
    do c = 1, size(cost)
      cost(c) = cost_of(graph, c)
    end do
    do while (any(cost > 0))
      call add_front(graph, minloc(cost, 1, cost > 0), plan, cost)
      if (plan%fronts(size(plan%fronts))%rows < plan%fronts(size(plan%fronts))%pivots) return
    end do
    if (sum(plan%fronts%pivots) < plan%n) return
    call find_places(plan)
    plan%used = sum(2.0_wp*plan%fronts%pivots*plan%fronts%rows*plan%fronts%columns) <= &
                worthwhile_part*(4.0_wp/3.0_wp)*plan%m*real(plan%n, wp)**2
    if (plan%used .and. plan%m == plan%n) plan%sign = sign_of(plan)
  end function new_front_plan

  !> Add one row for each column, in which no other column occurs. Columns that occur in the same groups share a group of such rows,
  !> so that they remain a class.
  pure subroutine add_diagonal(groups, row_of)
    type(row_groups_type), intent(inout) :: groups   !< the rows of the matrix; gets those of the diagonal behind them
    integer, intent(out) :: row_of(:)                !< (columns) number of the row of each column
    integer :: class_of(groups%n), n_classes, class, i, m

    m = sum(groups%sizes)
    call find_classes(groups%n, size(groups%sizes), groups%first, groups%members, class_of, n_classes)
    do class = 1, n_classes
      do i = 1, groups%n
        if (class_of(i) /= class) cycle
        m = m + 1
        row_of(i) = m
        groups%members = [groups%members, i]
      end do
      groups%sizes = [groups%sizes, count(class_of == class)]
      groups%first = [groups%first, size(groups%members) + 1]
    end do
  end subroutine add_diagonal

  !> The groups of rows and the classes of columns of a matrix.
  pure function new_graph(n, sizes, lists, members) result(graph)
    integer, intent(in) :: n            !< number of columns
    integer, intent(in) :: sizes(:)     !< (groups) number of rows of each group, one behind the other
    integer, intent(in) :: lists(:)     !< (groups+1) columns of group g are members(lists(g):lists(g+1)-1)
    integer, intent(in) :: members(:)   !< columns in which the rows of each group are not zero
    type(graph_type) :: graph
    integer :: class_of(n), n_classes, g, i

    graph%n_groups = size(sizes)
    ! each front makes a group, and there are at most as many fronts as columns
    allocate (graph%rows(size(sizes) + n), graph%first_row(size(sizes) + n), graph%made_by(size(sizes) + n), source=0)
    allocate (graph%classes(size(sizes) + n))
    call find_classes(n, size(sizes), lists, members, class_of, n_classes)
    allocate (graph%members(n_classes), graph%groups(n_classes))
    do i = 1, n_classes
      allocate (graph%members(i)%items(0), graph%groups(i)%items(0))
    end do
    do i = 1, n
      call append(graph%members(class_of(i)), i)
    end do
    do g = 1, size(sizes)
      graph%rows(g) = sizes(g)
      graph%first_row(g) = sum(sizes(:g - 1)) + 1
      allocate (graph%classes(g)%items(0))
      do i = lists(g), lists(g + 1) - 1
        ! once for each class: at its first column
        if (graph%members(class_of(members(i)))%items(1) /= members(i)) cycle
        call append(graph%classes(g), class_of(members(i)))
        call append(graph%groups(class_of(members(i))), g)
      end do
    end do
  end function new_graph

  !> Classes of columns that occur in the same groups: all columns are one class at first, and each group takes its own columns
  !> out of every class.
  pure subroutine find_classes(n, n_groups, lists, members, class_of, n_classes)
    integer, intent(in) :: n              !< number of columns
    integer, intent(in) :: n_groups       !< number of groups
    integer, intent(in) :: lists(:)       !< (groups+1) columns of group g are members(lists(g):lists(g+1)-1)
    integer, intent(in) :: members(:)     !< columns in which the rows of each group are not zero
    integer, intent(out) :: class_of(n)   !< class of each column, numbered in the order of their first columns
    integer, intent(out) :: n_classes     !< number of classes
    integer :: taken_out(size(members) + 1), number(size(members) + 1), g, i, before

    class_of = 1
    n_classes = 1
    do g = 1, n_groups
      taken_out(:n_classes) = 0
      do i = lists(g), lists(g + 1) - 1
        before = class_of(members(i))
        if (taken_out(before) == 0) then
          n_classes = n_classes + 1
          taken_out(before) = n_classes
          taken_out(n_classes) = n_classes
        end if
        class_of(members(i)) = taken_out(before)
      end do
    end do
    number = 0
    n_classes = 0
    do i = 1, n
      if (number(class_of(i)) == 0) then
        n_classes = n_classes + 1
        number(class_of(i)) = n_classes
      end if
      class_of(i) = number(class_of(i))
    end do
  end subroutine find_classes

  !> The number of values of the front that eliminates a class.
  pure integer function cost_of(graph, c) result(cost)
    type(graph_type), intent(in) :: graph   !< groups and classes
    integer, intent(in) :: c                !< number of the class
    integer :: i

    associate (classes => classes_in(graph, graph%groups(c)%items))
      cost = 0
      do i = 1, size(classes)
        cost = cost + size(graph%members(classes(i))%items)
      end do
      cost = max(1, cost*sum(graph%rows(graph%groups(c)%items)))
    end associate
  end function cost_of

  !> All classes that occur in some groups, each once.
  pure function classes_in(graph, groups) result(classes)
    type(graph_type), intent(in) :: graph   !< groups and classes
    integer, intent(in) :: groups(:)        !< numbers of the groups
    integer, allocatable :: classes(:)
    logical :: found(size(graph%members))
    integer :: i

    found = .false.
    do i = 1, size(groups)
      found(graph%classes(groups(i))%items) = .true.
    end do
    classes = pack([(i, i=1, size(found))], found)
  end function classes_in

  !> Eliminate a class, and with it all others that occur only in the same groups, by a new front. The groups are replaced by
  !> that of the rows which remain.
  pure subroutine add_front(graph, c, plan, cost)
    type(graph_type), intent(inout) :: graph       !< groups and classes
    integer, intent(in) :: c                       !< number of the class
    type(front_plan_type), intent(inout) :: plan   !< gets the front
    integer, intent(inout) :: cost(:)              !< (classes) of the front that would eliminate each class; 0: eliminated
    integer, allocatable :: groups(:), classes(:), others(:)
    type(front_type) :: front
    integer :: i, number

    groups = graph%groups(c)%items
    classes = classes_in(graph, groups)
    others = [integer ::]
    number = size(plan%fronts) + 1
    front%row = size(plan%rows)
    front%column = size(plan%columns)
    do i = 1, size(classes)
      if (all_in(graph%groups(classes(i))%items, groups)) then
        plan%columns = [plan%columns, graph%members(classes(i))%items]
        cost(classes(i)) = 0
      else
        others = [others, classes(i)]
      end if
    end do
    front%pivots = size(plan%columns) - front%column
    do i = 1, size(others)
      plan%columns = [plan%columns, graph%members(others(i))%items]
    end do
    front%columns = size(plan%columns) - front%column
    call take_rows(graph, groups, number, front, plan)
    graph%n_groups = graph%n_groups + 1
    graph%rows(graph%n_groups) = front%rows - front%pivots
    graph%made_by(graph%n_groups) = number
    graph%classes(graph%n_groups)%items = others
    do i = 1, size(others)
      associate (list => graph%groups(others(i)))
        list%items = [pack(list%items, .not. is_in(list%items, groups)), graph%n_groups]
        cost(others(i)) = cost_of(graph, others(i))
      end associate
    end do
    plan%fronts = [plan%fronts, front]
  end subroutine add_front

  !> The rows of a front: first those of the matrix, then those that earlier fronts pass on.
  pure subroutine take_rows(graph, groups, number, front, plan)
    type(graph_type), intent(in) :: graph          !< groups and classes
    integer, intent(in) :: groups(:)               !< numbers of the groups that it takes
    integer, intent(in) :: number                  !< number of the front
    type(front_type), intent(inout) :: front       !< gets the numbers of its rows
    type(front_plan_type), intent(inout) :: plan   !< gets the rows; earlier fronts get their parent
    integer :: i, g, j

    do i = 1, size(groups)
      g = groups(i)
      if (graph%made_by(g) == 0) plan%rows = [plan%rows, (graph%first_row(g) + j - 1, j=1, graph%rows(g))]
    end do
    front%original = size(plan%rows) - front%row
    front%rows = front%original
    do i = 1, size(groups)
      g = groups(i)
      if (graph%made_by(g) == 0) cycle
      plan%fronts(graph%made_by(g))%parent = number
      plan%fronts(graph%made_by(g))%parent_row = front%rows
      front%has_children = .true.
      front%rows = front%rows + graph%rows(g)
      plan%rows = [plan%rows, (0, j=1, graph%rows(g))]
    end do
  end subroutine take_rows

  !> The places of each front's values, and of its columns among those of its parent.
  pure subroutine find_places(plan)
    type(front_plan_type), intent(inout) :: plan   !< with its fronts; gets their places
    integer :: number(plan%n), f, i

    allocate (plan%places(size(plan%columns)), source=0)
    do f = 1, size(plan%fronts) - 1
      associate (front => plan%fronts(f), next => plan%fronts(f + 1))
        next%value = front%value + front%rows*front%columns
        next%pivot = front%pivot + front%pivots
        next%square = front%square + merge(front%columns**2, 0, front%has_children)
      end associate
    end do
    do f = 1, size(plan%fronts)
      associate (front => plan%fronts(f))
        if (front%parent == 0) cycle
        associate (parent => plan%fronts(front%parent))
          do i = 1, parent%columns
            number(plan%columns(parent%column + i)) = i
          end do
        end associate
        do i = front%column + front%pivots + 1, front%column + front%columns
          plan%places(i) = number(plan%columns(i))
        end do
        front%shares_parent = shares_parent(plan%fronts(front%parent)%columns, front%has_children, &
                                            plan%places(front%column + front%pivots + 1:front%column + front%columns))
      end associate
    end do
  end subroutine find_places

  !> Whether a front without children has all columns of its parent, in their order, beside its pivots.
  pure logical function shares_parent(n_parent, has_children, places)
    integer, intent(in) :: n_parent       !< columns of the parent
    logical, intent(in) :: has_children   !< earlier fronts pass rows on to the front
    integer, intent(in) :: places(:)      !< places of the front's other columns among those of the parent
    integer :: i

    shares_parent = .false.
    if (has_children .or. size(places) /= n_parent) return
    shares_parent = all(places == [(i, i=1, n_parent)])
  end function shares_parent

  !> The sign of the determinant of the permutations that bring rows and columns into the order in which fronts eliminate them.
  pure integer function sign_of(plan) result(sign)
    type(front_plan_type), intent(in) :: plan   !< of a square matrix
    integer :: rows(size(plan%rows)), order(plan%n), f, i

    rows = plan%rows
    do f = 1, size(plan%fronts)
      associate (front => plan%fronts(f))
        order(front%pivot + 1:front%pivot + front%pivots) = rows(front%row + 1:front%row + front%pivots)
        if (front%parent == 0) cycle
        i = plan%fronts(front%parent)%row + front%parent_row
        rows(i + 1:i + front%rows - front%pivots) = rows(front%row + front%pivots + 1:front%row + front%rows)
      end associate
    end do
    sign = sign_of_order(order)
    do f = 1, size(plan%fronts)
      associate (front => plan%fronts(f))
        order(front%pivot + 1:front%pivot + front%pivots) = plan%columns(front%column + 1:front%column + front%pivots)
      end associate
    end do
    sign = sign*sign_of_order(order)
  end function sign_of

  !> The sign of a permutation: -1 for each cycle of an even number of places.
  pure integer function sign_of_order(order)
    integer, intent(in) :: order(:)   !< the numbers from 1 on, each once
    logical :: seen(size(order))
    integer :: i, j

    sign_of_order = 1
    seen = .false.
    do i = 1, size(order)
      if (seen(i)) cycle
      j = order(i)
      do while (j /= i)
        seen(j) = .true.
        sign_of_order = -sign_of_order
        j = order(j)
      end do
    end do
  end function sign_of_order

  !> Append a number to a list.
  pure subroutine append(list, number)
    type(list_type), intent(inout) :: list   !< the list that grows
    integer, intent(in) :: number            !< its new last number

    list%items = [list%items, number]
  end subroutine append

  !> A mask of those of some numbers that are in a list.
  pure function is_in(numbers, list) result(found)
    integer, intent(in) :: numbers(:)   !< any numbers
    integer, intent(in) :: list(:)      !< the list
    logical :: found(size(numbers))
    integer :: i

    do i = 1, size(numbers)
      found(i) = any(list == numbers(i))
    end do
  end function is_in

  !> Whether all of some numbers are in a list.
  pure logical function all_in(numbers, list)
    integer, intent(in) :: numbers(:)   !< any numbers
    integer, intent(in) :: list(:)      !< the list

    all_in = all(is_in(numbers, list))
  end function all_in
end module mech9_front_plan
