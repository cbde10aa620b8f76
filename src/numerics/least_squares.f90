!> Least squares by QR with column pivoting: factorized once, solved for several right-hand sides.
!>
!> Small matrices, the rule in mechanisms, are factorized by the Householder loops of mech9_householder,
!> which are faster than a call of LAPACK there; larger ones by LAPACK. Three well determined equations in three unknowns
!> are solved by cofactors, which are faster still; their QR factors are found only where more than a solution is
!> wanted. Sparse matrices that are clearly regular are factorized by fronts (mech9_front_factors), without exchange of
!> columns; those with column pivoting are found only where other pivots are wanted. Nothing is allocated after `create`.
module mech9_least_squares
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgeqp3, dormqr
  use mech9_householder, only: nearly_dependent, householder, reflect, back_substitute, substitute_above_round_off, &
    solve_by_transposed
  use mech9_cofactors, only: invert_by_cofactors
  use mech9_matrix_norms, only: distance_in_full
  use mech9_front_plan, only: front_plan_type
  use mech9_front_factors, only: front_factors_type, new_front_factors
  implicit none
  private
  public :: least_squares_type, nearly_dependent

  !> From this number of columns on LAPACK is called.
  integer, parameter :: lapack_from = 24

  !> A sparse matrix whose least pivot is above this part of the largest is regular, and may be factorized by fronts. Below, all
  !> pivots are found as for full matrices, so that ranks and singular positions are judged by the same numbers.
  real(wp), parameter :: clearly_regular = 1.0e-4_wp

  !> A matrix, its factors, and scratch of the right size.
  type :: least_squares_type
    integer :: m = 0                            !< equations
    integer :: n = 0                            !< unknowns
    real(wp), allocatable :: a(:, :)            !< (m,n): the matrix; overwritten by `factorize`
    integer, allocatable, private :: pivot(:)   !< column of the matrix at each place
    real(wp), allocatable, private :: lengths(:)      !< of the pivots, not increasing
    real(wp) :: regular_pivot = 0.0_wp          !< pivots of matrices that are far from singular, where this is known; 0: it is not
    logical :: by_cofactors = .false.           !< a is still the matrix, and `inverse` solves
    real(wp) :: inverse(3, 3) = 0.0_wp          !< of the matrix, where that is solved by cofactors
    logical, private :: by_fronts = .false.     !< a is still the matrix, and `fronts` solves
    type(front_factors_type), private :: fronts !< factors of a sparse matrix
    integer, allocatable, private :: order(:)
    real(wp), allocatable, private :: tau(:)
    real(wp), allocatable, private :: reciprocal(:)   !< of the pivots that are not lost in round-off
    integer, private :: safe_rank = 0                 !< columns that are independent beyond round-off
    integer, private :: sign_of_det = 1   !< of the matrix, where cofactors, fronts or Householder loops give it
    real(wp), allocatable, private :: norms(:)
    real(wp), allocatable, private :: work(:)
  contains
    procedure :: create
    procedure :: factorize
    procedure :: take_inverse
    procedure :: solve
    procedure :: solve_transposed
    procedure :: rank
    procedure :: conditioning
    procedure :: largest_pivot
    procedure :: least_pivot
    procedure :: least_singular_value
    procedure :: determinant_sign
    procedure :: distance
  end type least_squares_type

contains

  !> Make room for m equations in n unknowns.
  pure subroutine create(self, m, n, fronts)
    class(least_squares_type), intent(inout) :: self       !< gets room for the matrix and its factors
    integer, intent(in) :: m                               !< number of equations
    integer, intent(in) :: n                               !< number of unknowns
    type(front_plan_type), intent(in), optional :: fronts  !< of a sparse matrix, which is zero outside their groups
    type(front_factors_type) :: no_fronts

    self%m = m
    self%n = n
    self%by_fronts = .false.
    self%fronts = no_fronts
    if (present(fronts)) self%fronts = new_front_factors(fronts)
    if (allocated(self%a)) deallocate (self%a, self%pivot, self%order, self%tau, self%reciprocal, self%norms, &
                                       self%lengths, self%work)
    allocate (self%a(m, n), self%tau(n), self%reciprocal(n), self%norms(n), self%lengths(min(m, n)), source=0.0_wp)
    allocate (self%pivot(n), self%order(n), source=0)
    allocate (self%work(merge(max(m, 2*n + (n + 1)*32, 32*32), n, n >= lapack_from)), source=0.0_wp)
  end subroutine create

  !> Factorize a matrix, or the one that stands in `a`.
  subroutine factorize(self, matrix)
    class(least_squares_type), intent(inout) :: self             !< the least squares problem: its matrix and factors
    real(wp), intent(in), contiguous, optional :: matrix(:, :)   !< (m,n); absent: the one in `a`

    if (present(matrix)) call copy(self%m*self%n, matrix, self%a)
    self%by_cofactors = .false.
    self%by_fronts = .false.
    if (self%m == 3 .and. self%n == 3) then
      ! a number is read sooner where it was written than from a copy of several at once
      if (present(matrix)) then
        call invert_by_cofactors(matrix, self%inverse, self%lengths, self%sign_of_det)
      else
        call invert_by_cofactors(self%a, self%inverse, self%lengths, self%sign_of_det)
      end if
      self%by_cofactors = self%lengths(3) > nearly_dependent*self%lengths(1)
    else if (self%fronts%plan%used) then
      call self%fronts%factorize(self%a)
      self%by_fronts = self%fronts%diagonal_ratio > clearly_regular
    end if
    if (self%by_cofactors) then
      self%safe_rank = 3
    else if (self%by_fronts) then
      self%safe_rank = self%n
      self%sign_of_det = self%fronts%sign_of_det
    else
      call find_factors(self)
    end if
  end subroutine factorize

  !> Take a regular matrix of three rows and columns whose inverse has been found, and stands in `inverse` already.
  pure subroutine take_inverse(self, matrix, pivots, sign_of_det)
    class(least_squares_type), intent(inout) :: self   !< gets the matrix
    real(wp), intent(in) :: matrix(3, 3)               !< (3,3) the matrix
    real(wp), intent(in) :: pivots(3)                  !< (3) its pivots, not increasing and clearly above zero
    integer, intent(in) :: sign_of_det                 !< sign of its determinant: -1 or 1

    call copy(9, matrix, self%a)
    self%lengths(1) = pivots(1)
    self%lengths(2) = pivots(2)
    self%lengths(3) = pivots(3)
    self%sign_of_det = sign_of_det
    self%by_cofactors = .true.
    self%by_fronts = .false.
    self%safe_rank = 3
  end subroutine take_inverse

  !> The QR factorization of the matrix that stands in `a`.
  subroutine find_factors(self)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors
    integer :: info, j

    self%by_cofactors = .false.
    self%by_fronts = .false.
    if (self%n < lapack_from) then
      call householder(self%m, self%n, self%a, self%pivot, self%tau, self%sign_of_det, self%norms)
    else
      self%pivot = 0
      call dgeqp3(self%m, self%n, self%a, self%m, self%pivot, self%tau, self%work, size(self%work), info)
    end if
    do j = 1, size(self%lengths)
      self%lengths(j) = abs(self%a(j, j))
    end do
    self%safe_rank = rank_within(self, 16.0_wp*epsilon(1.0_wp)*max(self%m, self%n))
    do j = 1, self%safe_rank
      self%reciprocal(j) = 1.0_wp/self%a(j, j)
    end do
  end subroutine find_factors

  !> x for which |a x - b| is least, and the length of the residual; columns beyond the numerical rank are not used.
  !>
  !> With `round_off`, an unknown of a nearly dependent column is left at zero where round-off alone can explain its value:
  !> its error is larger than that of a well determined one by the square of the ratio of the largest pivot to its own.
  subroutine solve(self, b, x, remainder, tolerance, round_off)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors
    real(wp), intent(inout), contiguous :: b(:)        !< (m) right-hand side; overwritten
    real(wp), intent(out) :: x(:)                      !< (n) the solution
    real(wp), intent(out), optional :: remainder       !< length of the residual a x - b
    real(wp), intent(in), optional :: tolerance        !< part of the largest pivot, below which a column is not used
    real(wp), intent(in), optional :: round_off            !< error of x by round-off in a well determined column, in the unit of x
    real(wp) :: conditioning
    integer :: j, k, info, rank

    if (self%by_fronts) then
      if (needs_pivots(self, tolerance, round_off)) call find_factors(self)
    end if
    if (self%by_fronts) then
      call self%fronts%solve(b, x, remainder)
      return
    end if
    rank = self%safe_rank
    if (present(tolerance)) rank = min(rank, rank_within(self, tolerance))
    if (self%by_cofactors) then
      if (rank == 3) then
        ! no column is nearly dependent, so that `round_off` has no effect
        do j = 1, 3
          x(j) = self%inverse(j, 1)*b(1) + self%inverse(j, 2)*b(2) + self%inverse(j, 3)*b(3)
        end do
        if (present(remainder)) remainder = 0.0_wp
        return
      end if
      call find_factors(self)
    end if
    k = min(self%m, self%n)
    if (self%n < lapack_from) then
      call reflect(self%m, k, self%a, self%tau, b)
    else
      call dormqr('L', 'T', self%m, 1, k, self%a, self%m, self%tau, b, self%m, self%work, size(self%work), info)
    end if
    if (present(remainder)) remainder = norm2(b(rank + 1:self%m))
    conditioning = 1.0_wp
    if (present(round_off)) conditioning = self%conditioning()
    if (conditioning < nearly_dependent) then
      call substitute_above_round_off(self%m, rank, self%a, self%reciprocal, self%lengths, round_off, b)
    else
      call back_substitute(self%m, rank, self%a, self%reciprocal, b)
    end if
    if (rank < self%n) x = 0.0_wp
    do j = 1, rank
      x(self%pivot(j)) = b(j)
    end do
  end subroutine solve

  !> The shortest y for which a^T y = b, where the columns of a are independent; equations of others are left out.
  pure subroutine solve_transposed(self, b, y, regularity)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors
    real(wp), intent(inout), contiguous :: b(:)        !< (n) right-hand side; overwritten
    real(wp), intent(out), contiguous :: y(:)          !< (m) the solution
    real(wp), intent(out), optional :: regularity      !< least number on the diagonal of R over the largest one
    integer :: j

    if (present(regularity)) regularity = self%lengths(self%n)/max(self%lengths(1), tiny(regularity))
    if (self%by_fronts) then
      if (present(regularity)) regularity = self%fronts%diagonal_ratio
      call self%fronts%solve_transposed(b, y)
    else if (self%by_cofactors) then
      y = matmul(b, self%inverse)
    else
      y = 0.0_wp
      do j = 1, self%safe_rank
        y(j) = b(self%pivot(j))
      end do
      call solve_by_transposed(self%m, self%n, self%safe_rank, self%a, self%tau, self%reciprocal, y)
    end if
  end subroutine solve_transposed

  !> Find the largest and the least pivot of a matrix that is factorized by fronts. If the matrix is not clearly regular, it is
  !> factorized with column pivoting instead.
  subroutine find_pivots(self)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors

    if (.not. self%by_fronts .or. self%fronts%judged) return
    call self%fronts%find_distances()
    self%lengths(1) = self%fronts%largest
    self%lengths(self%n) = self%fronts%least
    if (.not. self%fronts%least > clearly_regular*self%fronts%largest) call find_factors(self)
  end subroutine find_pivots

  !> Whether a solution depends on the pivots between the largest and the least, which fronts do not give.
  logical function needs_pivots(self, tolerance, round_off) result(needs)
    class(least_squares_type), intent(inout) :: self   !< the matrix, factorized by fronts
    real(wp), intent(in), optional :: tolerance        !< part of the largest pivot, below which a column is not used
    real(wp), intent(in), optional :: round_off        !< nearly dependent columns may be left out
    real(wp) :: least

    least = 0.0_wp
    if (present(tolerance)) least = tolerance
    if (present(round_off)) least = max(least, nearly_dependent)
    needs = .false.
    if (least > 0.0_wp) needs = .not. self%conditioning() > least
  end function needs_pivots

  !> Copy the elements of an array in the order of memory.
  pure subroutine copy(n, from, to)
    integer, intent(in) :: n          !< number of elements
    real(wp), intent(in) :: from(n)   !< elements of the matrix
    real(wp), intent(out) :: to(n)    !< the same elements

    to = from
  end subroutine copy

  !> Number of columns that are independent beyond round-off.
  integer function rank(self, tolerance)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors
    real(wp), intent(in), optional :: tolerance        !< against the largest; round-off unless given

    if (self%by_fronts .and. present(tolerance)) then
      if (needs_pivots(self, tolerance)) call find_factors(self)
    end if
    rank = self%safe_rank
    if (present(tolerance) .and. .not. self%by_fronts) rank = rank_within(self, tolerance)
  end function rank

  !> Number of pivots above this part of the largest.
  pure integer function rank_within(self, tolerance) result(rank)
    class(least_squares_type), intent(in) :: self   !< the least squares problem: its matrix and factors
    real(wp), intent(in) :: tolerance               !< part of the largest pivot that a column must exceed

    do rank = 0, size(self%lengths) - 1
      if (.not. self%lengths(rank + 1) > tolerance*self%lengths(1)) return
    end do
  end function rank_within

  !> Root of the sum of squares of the differences between two matrices of the problem's shape and sparsity.
  pure real(wp) function distance(self, a, b)
    class(least_squares_type), intent(in) :: self   !< the least squares problem
    real(wp), intent(in) :: a(self%m, self%n)       !< the first matrix
    real(wp), intent(in) :: b(self%m, self%n)       !< the second one

    if (self%fronts%plan%used) then
      distance = self%fronts%distance(a, b)
    else
      distance = distance_in_full(self%m*self%n, a, b)
    end if
  end function distance

  !> Length of the largest pivot: about the largest singular value; 0 where there is none.
  real(wp) function largest_pivot(self)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors

    call find_pivots(self)
    largest_pivot = 0.0_wp
    if (size(self%lengths) > 0) largest_pivot = self%lengths(1)
  end function largest_pivot

  !> Length of the least pivot: about the least singular value, somewhat above it; 0 where there are fewer
  !> equations than unknowns, or none.
  real(wp) function least_pivot(self)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors

    call find_pivots(self)
    least_pivot = 0.0_wp
    if (self%n > 0 .and. self%m >= self%n) least_pivot = self%lengths(self%n)
  end function least_pivot

  !> Least against largest pivot, or against a regular pivot that is larger: about the reciprocal condition number; 0 where columns
  !> depend on each other, 1 where there are none. A single column is judged by its regular pivot alone.
  real(wp) function conditioning(self)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors

    call find_pivots(self)
    conditioning = 1.0_wp
    if (self%n == 0) return
    conditioning = 0.0_wp
    if (self%m < self%n) return
    if (self%lengths(1) > 0.0_wp) conditioning = self%lengths(self%n)/max(self%lengths(1), self%regular_pivot)
  end function conditioning

  !> The least singular value, by inverse iteration with the factors; 0 where columns depend on each
  !> other, huge where there are none.
  function least_singular_value(self) result(least)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors
    real(wp) :: least
    integer, parameter :: most_iterations = 200
    real(wp) :: before, length
    integer :: iteration, i, n

    n = self%n
    least = huge(least)
    if (n == 0) return
    least = 0.0_wp
    if (self%rank() < n) return
    call find_pivots(self)
    if (self%by_fronts) then
      least = self%fronts%least_singular_value()
      return
    end if
    if (self%by_cofactors) call find_factors(self)
    ! column pivoting leaves the left singular vector of the least singular value mostly along the last row of R; the
    ! small other numbers serve where it does not
    do i = 1, n
      self%work(i) = 0.01_wp
    end do
    self%work(n) = 1.0_wp
    do iteration = 1, most_iterations
      before = least
      call solve_upper(self%a, n, self%work)
      length = norm2(self%work(:n))
      self%work(:n) = self%work(:n)/length
      call solve_upper_transposed(self%a, n, self%work)
      ! |R^-T v| for a unit vector v that tends to the right singular vector is 1/least
      length = norm2(self%work(:n))
      self%work(:n) = self%work(:n)/length
      least = 1.0_wp/length
      if (abs(least - before) <= 1.0e-14_wp*least) return
    end do
  end function least_singular_value

  !> x = R^-1 x with the upper triangle R of a.
  pure subroutine solve_upper(a, n, x)
    real(wp), intent(in) :: a(:, :)   !< upper triangle R in its first n rows and columns
    integer, intent(in) :: n          !< order of R
    real(wp), intent(inout) :: x(:)   !< right-hand side; the solution afterwards
    integer :: i, j

    do j = n, 1, -1
      x(j) = x(j)/a(j, j)
      do i = 1, j - 1
        x(i) = x(i) - a(i, j)*x(j)
      end do
    end do
  end subroutine solve_upper

  !> x = R^-T x.
  pure subroutine solve_upper_transposed(a, n, x)
    real(wp), intent(in) :: a(:, :)   !< upper triangle R in its first n rows and columns
    integer, intent(in) :: n          !< order of R
    real(wp), intent(inout) :: x(:)   !< right-hand side; the solution afterwards
    integer :: i, j

    do j = 1, n
      do i = 1, j - 1
        x(j) = x(j) - a(i, j)*x(i)
      end do
      x(j) = x(j)/a(j, j)
    end do
  end subroutine solve_upper_transposed

  !> Sign of the determinant of a square matrix; 1 for others.
  integer function determinant_sign(self) result(sign)
    class(least_squares_type), intent(inout) :: self   !< the least squares problem: its matrix and factors
    integer :: j, place, next

    sign = 1
    if (self%m /= self%n) return
    if (self%n < lapack_from .or. self%by_fronts) then
      sign = self%sign_of_det
      return
    end if
    do j = 1, self%n
      if (self%a(j, j) < 0.0_wp) sign = -sign
      if (abs(self%tau(j)) > 0.0_wp) sign = -sign   ! a reflection
    end do
    ! sign of the permutation: undo it by exchanges
    self%order = self%pivot
    do j = 1, self%n
      place = j
      do while (self%order(place) /= j)
        next = self%order(place)
        self%order(place) = self%order(next)
        self%order(next) = next
        sign = -sign
      end do
    end do
  end function determinant_sign
end module mech9_least_squares
