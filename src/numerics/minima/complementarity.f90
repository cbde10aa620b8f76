!> Linear complementarity: w = G z + b >= 0, z >= 0, and one of both zero in each row.
!>
!> G is symmetric and positive semidefinite, a Gram matrix. Rows are taken one by one, as D. Baraff does in Fast Contact Force
!> Computation for Nonpenetrating Rigid Bodies, SIGGRAPH 94, by the pivots of R. W. Cottle and G. B. Dantzig (1968): z of the row grows
!> until its w is zero, while w of the rows that were taken stays zero as long as their z is positive.
module mech9_complementarity
  use mech9_kinds, only: wp
  implicit none
  private
  public :: solve_complementarity

  !> A row depends on those that hold where less than this part of its diagonal is left: a hundred times the round-off of elimination.
  real(wp), parameter :: dependent_part = 1.0e-12_wp
  !> Pivots for each row before the search ends. Without cycles, which round-off may cause, a row needs a few.
  integer, parameter :: most_pivots = 50

contains

  !> Solve the problem. Rows with w above -round_off hold already; to it comes the round-off that elimination leaves in G z, which is
  !> large where rows that nearly depend on each other share a large z.
  pure subroutine solve_complementarity(n, g, b, round_off, z, holds, solved)
    integer, intent(in) :: n                  !< number of rows
    real(wp), intent(in) :: g(n, n)           !< G, symmetric and positive semidefinite
    real(wp), intent(in) :: b(n)              !< w for z = 0
    real(wp), intent(in) :: round_off(n)      !< of w in each row
    real(wp), intent(out) :: z(n)             !< the solution
    logical, intent(out) :: holds(n)          !< w of the row is zero, and z may be positive; these rows are independent of each other
    logical, intent(out) :: solved            !< there is a solution, and it was found
    real(wp) :: w(n), passed(n), direction(n), change(n), step
    integer :: trial, row, first
    logical :: blocked

    z = 0.0_wp
    holds = .false.
    solved = .false.
    row = 0
    do trial = 1, most_pivots*(n + 1)
      w = b + matmul(g, z)
      passed = matmul(abs(g), z)
      passed = -round_off - dependent_part*passed
      if (row == 0) row = worst_row(n, w, passed, holds)
      if (row == 0) exit
      call find_direction(n, g, holds, row, direction)
      change = matmul(g, direction)
      ! z of the row grows until w is zero, or z of another row is
      step = huge(step)
      if (change(row) > dependent_part*g(row, row)) step = -w(row)/change(row)
      call find_first(n, z, direction, holds, step, first, blocked)
      if (.not. (blocked .or. step < huge(step))) then
        if (w(row) < passed(row)) return
        row = 0
        cycle
      end if
      z = z + step*merge(direction, 0.0_wp, holds)
      z(row) = z(row) + step
      if (blocked) then
        z(first) = 0.0_wp
        holds(first) = .false.
      else
        holds(row) = .true.
        row = 0
      end if
    end do
    solved = trial <= most_pivots*(n + 1)
  end subroutine solve_complementarity

  !> The row that does not hold and whose w is farthest below zero, beyond round-off; 0: there is none.
  pure integer function worst_row(n, w, passed, holds) result(row)
    integer, intent(in) :: n                  !< number of rows
    real(wp), intent(in) :: w(n)              !< present w
    real(wp), intent(in) :: passed(n)         !< w below this is below zero, not within round-off
    logical, intent(in) :: holds(n)           !< rows whose w is zero
    integer :: i

    row = 0
    do i = 1, n
      if (holds(i) .or. w(i) >= passed(i)) cycle
      if (row == 0) row = i
      if (w(i) < w(row)) row = i
    end do
  end function worst_row

  !> The change of z by which z of one row grows by 1 while w of the rows that hold stays zero.
  pure subroutine find_direction(n, g, holds, row, direction)
    integer, intent(in) :: n                  !< number of rows
    real(wp), intent(in) :: g(n, n)           !< the matrix G
    logical, intent(in) :: holds(n)           !< rows whose w stays zero; they are independent
    integer, intent(in) :: row                !< the row whose z grows; it does not hold
    real(wp), intent(out) :: direction(n)     !< the change
    real(wp) :: a(n, n), right(n), factor
    integer :: places(n), i, j, k, m

    m = count(holds)
    places(:m) = pack([(i, i=1, n)], holds)
    a(:m, :m) = g(places(:m), places(:m))
    right(:m) = -g(places(:m), row)
    ! Gaussian elimination: the pivots of a positive definite matrix need no search
    do j = 1, m
      do i = j + 1, m
        factor = a(i, j)/a(j, j)
        a(i, j:m) = a(i, j:m) - factor*a(j, j:m)
        right(i) = right(i) - factor*right(j)
      end do
    end do
    do j = m, 1, -1
      do k = j + 1, m
        right(j) = right(j) - a(j, k)*right(k)
      end do
      right(j) = right(j)/a(j, j)
    end do
    direction = 0.0_wp
    direction(places(:m)) = right(:m)
    direction(row) = 1.0_wp
  end subroutine find_direction

  !> The row whose z comes to zero first within a step.
  pure subroutine find_first(n, z, direction, holds, step, first, blocked)
    integer, intent(in) :: n                  !< number of rows
    real(wp), intent(in) :: z(n)              !< present values
    real(wp), intent(in) :: direction(n)      !< their change
    logical, intent(in) :: holds(n)           !< rows whose z changes
    real(wp), intent(inout) :: step           !< length of the step; shorter afterwards where a z comes to zero
    integer, intent(out) :: first             !< the row
    logical, intent(out) :: blocked           !< there is one
    integer :: i

    first = 0
    do i = 1, n
      if (.not. holds(i) .or. direction(i) >= 0.0_wp) cycle
      if (z(i) >= -direction(i)*step) cycle
      step = max(0.0_wp, -z(i)/direction(i))
      first = i
    end do
    blocked = first > 0
  end subroutine find_first
end module mech9_complementarity
