!> Coefficients of Runge-Kutta methods against all conditions of their orders, one for each rooted tree (Hairer, Nørsett and Wanner in
!> docs/reference/bibliography.md): the weights times the elementary weights of the tree are one over its density.
module test_butcher_tables
  use mech9_kinds, only: wp
  use mech9_butcher_tables, only: butcher_table_type, kutta_merson, prince_dormand
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('kutta_merson')) call check(test, kutta_merson(), 'Kutta and Merson')
    if (test%runs('prince_dormand')) call check(test, prince_dormand(), 'Prince and Dormand')
  end subroutine run

  !> All conditions of a table, and that those of the next order are not all kept.
  subroutine check(test, table, name)
    type(tester_type), intent(inout) :: test       !< counts the checks
    type(butcher_table_type), intent(in) :: table  !< the coefficients
    character(len=*), intent(in) :: name           !< of the method
    integer :: i, order
    real(wp) :: worst

    do i = 1, table%stages
      call test%near(sum(table%a(i, :)), table%c(i), 1.0e-14_wp, name//': a stage stands at the sum of its coefficients')
      call test%near(maxval(abs(table%a(i, i:))), 0.0_wp, 0.0_wp, name//': it is explicit')
    end do
    do order = 1, table%order
      call try_trees(table, table%b, order, worst)
      ! coefficients up to some ten, of 16 digits
      call test%near(worst, 0.0_wp, 1.0e-14_wp, name//': conditions of the solution')
      if (order > table%embedded_order) cycle
      call try_trees(table, table%d, order, worst)
      call test%near(worst, 0.0_wp, 1.0e-14_wp, name//': conditions of the embedded solution')
    end do
    call try_trees(table, table%b, table%order + 1, worst)
    call test%is_true(worst > 1.0e-6_wp, name//': its order is no higher')
    call try_trees(table, table%d, table%embedded_order + 1, worst)
    call test%is_true(worst > 1.0e-6_wp, name//': the embedded order is no higher')
  end subroutine check

  !> The worst error of the conditions of all trees with so many nodes. A tree is the sequence of its nodes' levels: each node hangs on
  !> the last one before it that lies one level lower.
  subroutine try_trees(table, weights, order, worst)
    type(butcher_table_type), intent(in) :: table   !< the coefficients
    real(wp), intent(in) :: weights(:)              !< of the stages
    integer, intent(in) :: order                    !< number of nodes
    real(wp), intent(out) :: worst                  !< largest difference
    integer :: level(order), i

    worst = 0.0_wp
    level = [(i, i=0, order - 1)]
    do
      worst = max(worst, abs(error_of(table, weights, level)))
      ! the next sequence: the last level that may fall does, and those after it rise again
      i = order
      do while (i > 1)
        if (level(i) > 1) exit
        i = i - 1
      end do
      if (i <= 1) return
      level(i) = level(i) - 1
      do i = i + 1, order
        level(i) = level(i - 1) + 1
      end do
    end do
  end subroutine try_trees

  !> The weights times the elementary weights of a tree, less one over its density.
  pure real(wp) function error_of(table, weights, level) result(error)
    type(butcher_table_type), intent(in) :: table   !< the coefficients
    real(wp), intent(in) :: weights(:)              !< of the stages
    integer, intent(in) :: level(:)                 !< of each node
    real(wp) :: elementary(table%stages, size(level)), density
    integer :: nodes(size(level)), i, parent

    elementary = 1.0_wp
    nodes = 1
    density = 1.0_wp
    do i = size(level), 2, -1
      parent = i - 1
      do while (level(parent) /= level(i) - 1)
        parent = parent - 1
      end do
      elementary(:, parent) = elementary(:, parent)*matmul(table%a, elementary(:, i))
      density = density*nodes(i)
      nodes(parent) = nodes(parent) + nodes(i)
    end do
    density = density*nodes(1)
    error = dot_product(weights, elementary(:, 1)) - 1.0_wp/density
  end function error_of
end module test_butcher_tables
