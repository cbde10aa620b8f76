!> QR of small matrices by Householder reflections (Businger and Golub in docs/reference/bibliography.md).
!>
!> The loops stand in files of their own and are compiled three times: for any size, and, with the size known
!> to the compiler, for the two most frequent sizes, three equations of a planar or spherical chain and six of a
!> spatial one. The compiler unrolls these loops, which halves the time.
module mech9_householder
  use mech9_kinds, only: wp
  implicit none
  private
  public :: nearly_dependent, householder, reflect, reflect_back, back_substitute, substitute_above_round_off, solve_by_transposed

  !> Columns with a pivot below this part of the largest are nearly dependent: round-off may determine their unknowns.
  real(wp), parameter :: nearly_dependent = 0.05_wp

contains

  !> QR with column pivoting of any small matrix.
  pure subroutine householder(m, n, a, pivot, tau, sign_of_det, norms)
    integer, intent(in) :: m              !< number of rows
    integer, intent(in) :: n              !< number of columns
    real(wp), intent(inout) :: a(m, n)    !< (m,n) the matrix; its factors afterwards
    integer, intent(out) :: pivot(n)      !< column of the matrix at each place
    real(wp), intent(out) :: tau(n)       !< scales of the reflections
    integer, intent(out) :: sign_of_det   !< of a square matrix: -1 or 1
    real(wp), intent(out) :: norms(n)     !< scratch

    if (m == 3 .and. n == 3) then
      call factorize_3(a, pivot, tau, sign_of_det, norms)
    else if (m == 6 .and. n == 6) then
      call factorize_6(a, pivot, tau, sign_of_det, norms)
    else
      call factorize(m, n, a, pivot, tau, sign_of_det, norms)
    end if
  end subroutine householder

  !> b becomes Q^T b, with the first n reflections.
  pure subroutine reflect(m, n, a, tau, b)
    integer, intent(in) :: m          !< number of rows
    integer, intent(in) :: n          !< number of columns used
    real(wp), intent(in) :: a(m, n)   !< factors, as `householder` leaves them
    real(wp), intent(in) :: tau(n)    !< scales of the reflections
    real(wp), intent(inout) :: b(m)   !< right-hand side; Q^T b afterwards

    if (m == 3 .and. n == 3) then
      call reflect_3(a, tau, b)
    else if (m == 6 .and. n == 6) then
      call reflect_6(a, tau, b)
    else
      call reflect_any(m, n, a, tau, b)
    end if
  end subroutine reflect

  !> The first n numbers of b become R^-1 b.
  pure subroutine back_substitute(m, n, a, reciprocal, b)
    integer, intent(in) :: m                !< number of rows
    integer, intent(in) :: n                !< number of columns used
    real(wp), intent(in) :: a(m, n)         !< factors, as `householder` leaves them
    real(wp), intent(in) :: reciprocal(n)   !< of the diagonal of R
    real(wp), intent(inout) :: b(n)         !< Q^T b; the solution afterwards

    if (m == 3 .and. n == 3) then
      call substitute_3(a, reciprocal, b)
    else if (m == 6 .and. n == 6) then
      call substitute_6(a, reciprocal, b)
    else
      call substitute(m, n, a, reciprocal, b)
    end if
  end subroutine back_substitute

  !> b becomes Q b, with the first n reflections.
  pure subroutine reflect_back(m, n, a, tau, b)
    integer, intent(in) :: m          !< number of rows
    integer, intent(in) :: n          !< number of columns used
    real(wp), intent(in) :: a(m, n)   !< factors, as `householder` leaves them
    real(wp), intent(in) :: tau(n)    !< scales of the reflections
    real(wp), intent(inout) :: b(m)   !< any vector; Q b afterwards
    real(wp) :: s
    integer :: i, j

    do j = n, 1, -1
      s = b(j)
      do i = j + 1, m
        s = s + a(i, j)*b(i)
      end do
      s = s*tau(j)
      b(j) = b(j) - s
      do i = j + 1, m
        b(i) = b(i) - s*a(i, j)
      end do
    end do
  end subroutine reflect_back

  !> The shortest y for which a^T y = b, in the first `rank` equations in the order of the pivots.
  pure subroutine solve_by_transposed(m, n, rank, a, tau, reciprocal, y)
    integer, intent(in) :: m                !< number of rows
    integer, intent(in) :: n                !< number of columns
    integer, intent(in) :: rank             !< columns used
    real(wp), intent(in) :: a(m, n)         !< factors, as `householder` or LAPACK leaves them
    real(wp), intent(in) :: tau(n)          !< scales of the reflections
    real(wp), intent(in) :: reciprocal(n)   !< of the diagonal of R
    real(wp), intent(inout) :: y(m)         !< b in the order of the pivots, behind its first `rank` numbers zero; the solution
    integer :: i, j

    do j = 1, rank
      do i = 1, j - 1
        y(j) = y(j) - a(i, j)*y(i)
      end do
      y(j) = y(j)*reciprocal(j)
    end do
    call reflect_back(m, min(m, n), a, tau, y)
  end subroutine solve_by_transposed

  !> R^-1 b in the first `rank` columns, with zeros for the unknowns of nearly dependent columns that round-off alone can explain.
  pure subroutine substitute_above_round_off(m, rank, a, reciprocal, lengths, round_off, b)
    integer, intent(in) :: m                   !< number of rows
    integer, intent(in) :: rank                !< columns that are used
    real(wp), intent(in) :: a(m, rank)         !< factors, as `householder` leaves them
    real(wp), intent(in) :: reciprocal(rank)   !< of the diagonal of R
    real(wp), intent(in) :: lengths(rank)      !< of the pivots
    real(wp), intent(in) :: round_off          !< error of x by round-off in a well determined column, in the unit of x
    real(wp), intent(inout) :: b(m)            !< Q^T b; the solution in its first `rank` numbers afterwards
    real(wp) :: s
    integer :: i, j

    do j = rank, 1, -1
      b(j) = b(j)*reciprocal(j)
      s = lengths(j)/lengths(1)
      if (s < nearly_dependent .and. abs(b(j))*s**2 <= round_off) b(j) = 0.0_wp
      do i = 1, j - 1
        b(i) = b(i) - a(i, j)*b(j)
      end do
    end do
  end subroutine substitute_above_round_off

  ! The arguments that these procedures share are declared and described in the included files.

  !> `householder` for any size.
  pure subroutine factorize(m, n, a, pivot, tau, sign_of_det, norms)
    integer, intent(in) :: m   !< number of rows
    integer, intent(in) :: n   !< number of columns
    include 'factorization.inc'
  end subroutine factorize

  !> `householder` for three rows and columns.
  pure subroutine factorize_3(a, pivot, tau, sign_of_det, norms)
    integer, parameter :: m = 3, n = 3
    include 'factorization.inc'
  end subroutine factorize_3

  !> `householder` for six rows and columns.
  pure subroutine factorize_6(a, pivot, tau, sign_of_det, norms)
    integer, parameter :: m = 6, n = 6
    include 'factorization.inc'
  end subroutine factorize_6

  !> `reflect` for any size.
  pure subroutine reflect_any(m, n, a, tau, b)
    integer, intent(in) :: m   !< number of rows
    integer, intent(in) :: n   !< number of columns
    include 'reflection.inc'
  end subroutine reflect_any

  !> `reflect` for three rows and columns.
  pure subroutine reflect_3(a, tau, b)
    integer, parameter :: m = 3, n = 3
    include 'reflection.inc'
  end subroutine reflect_3

  !> `reflect` for six rows and columns.
  pure subroutine reflect_6(a, tau, b)
    integer, parameter :: m = 6, n = 6
    include 'reflection.inc'
  end subroutine reflect_6

  !> `back_substitute` for any size.
  pure subroutine substitute(m, n, a, reciprocal, b)
    integer, intent(in) :: m   !< number of rows
    integer, intent(in) :: n   !< number of columns
    include 'substitution.inc'
  end subroutine substitute

  !> `back_substitute` for three rows and columns.
  pure subroutine substitute_3(a, reciprocal, b)
    integer, parameter :: m = 3, n = 3
    include 'substitution.inc'
  end subroutine substitute_3

  !> `back_substitute` for six rows and columns.
  pure subroutine substitute_6(a, reciprocal, b)
    integer, parameter :: m = 6, n = 6
    include 'substitution.inc'
  end subroutine substitute_6
end module mech9_householder
