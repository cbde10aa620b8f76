!> The sparse QR factorization by fronts, solutions with it, and the distance from a singular matrix.
!>
!> Reflections are as stable in any order of columns. But the diagonal of R shows the rank only where columns are exchanged.
!> Instead, the distance of each column from the span of all others is found: it is 1 over the length of its row of R^-1. The
!> least of them is at least the least singular value, and at most that times the root of the number of columns. The squares of
!> these lengths are the diagonal of the covariance (R^T R)^-1, and of that each front needs only the part of its own columns,
!> which follows from that of its parent (Erisman and Tinney in docs/reference/bibliography.md).
module mech9_front_factors
  use mech9_kinds, only: wp
  use mech9_householder, only: reflect_back
  use mech9_front_plan, only: front_plan_type
  use mech9_front_kernels, only: gather, take_rows, eliminate, add_squares, add_differences, pass_rows, reflect, substitute, &
    take_covariance, invert, fill_covariance
  implicit none
  private
  public :: front_factors_type, new_front_factors

  !> The factors of a matrix.
  type :: front_factors_type
    type(front_plan_type) :: plan               !< its fronts
    real(wp) :: diagonal_ratio = 0.0_wp         !< least number on the diagonal of R over the largest one
    logical :: judged = .false.                 !< the next three are those of the present matrix
    real(wp) :: largest = 0.0_wp                !< length of the longest column
    real(wp) :: least = 0.0_wp                  !< least distance of a column from the span of all others
    integer :: nearest = 0                      !< number of that column
    integer :: sign_of_det = 1                  !< of a square matrix: -1 or 1
    real(wp), allocatable :: values(:)          !< R and reflections of each front, column by column
    real(wp), allocatable :: scales(:)          !< (n) of the reflections
    real(wp), allocatable :: reciprocals(:)     !< (n) of the diagonal of R
    real(wp), allocatable :: sides(:)           !< (rows of all fronts) right-hand sides
    real(wp), allocatable :: squares(:)         !< (n) scratch: squares of the lengths of columns
    real(wp), allocatable :: variances(:)       !< (n) diagonal of (R^T R)^-1, in the order in which columns are eliminated
    real(wp), allocatable :: covariances(:)     !< (R^T R)^-1 for the columns of each front that has children
    real(wp), allocatable :: inverse(:)         !< scratch: R^-1 among the pivots of one front, then its product with R
    real(wp), allocatable :: product(:)         !< scratch: product of the latter and the covariance of the other columns
    real(wp), allocatable :: of_others(:)       !< scratch: the covariance of the other columns of one front
  contains
    procedure :: factorize
    procedure :: find_distances
    procedure :: distance
    procedure :: solve
    procedure :: solve_transposed
    procedure :: least_singular_value
  end type front_factors_type

contains

  !> Room for the factors of matrices that have a plan.
  pure function new_front_factors(plan) result(self)
    type(front_plan_type), intent(in) :: plan   !< the fronts
    type(front_factors_type) :: self
    integer :: p, r

    self%plan = plan
    if (.not. plan%used) return
    associate (fronts => plan%fronts)
      p = maxval(fronts%pivots)
      r = maxval(fronts%columns - fronts%pivots)
      allocate (self%values(sum(fronts%rows*fronts%columns)), self%sides(sum(fronts%rows)), source=0.0_wp)
      allocate (self%covariances(sum(fronts%columns**2, fronts%has_children)), source=0.0_wp)
    end associate
    allocate (self%scales(plan%n), self%reciprocals(plan%n), self%squares(plan%n), self%variances(plan%n), source=0.0_wp)
    allocate (self%inverse(p*(p + r)), self%product(max(1, p*r)), self%of_others(max(1, r*r)), source=0.0_wp)
  end function new_front_factors

  !> Factorize a matrix.
  pure subroutine factorize(self, matrix)
    class(front_factors_type), intent(inout) :: self   !< gets the factors
    real(wp), intent(in), contiguous :: matrix(:, :)   !< (m,n) zero outside the groups of the plan
    integer :: f

    self%judged = .false.
    self%sign_of_det = self%plan%sign
    do f = 1, size(self%plan%fronts)
      associate (front => self%plan%fronts(f), plan => self%plan)
        call gather(front, plan%rows(front%row + 1:), plan%columns(front%column + 1:), plan%m, matrix, &
                    self%values(front%value + 1:))
        call eliminate(front%rows, front%pivots, front%columns, self%values(front%value + 1:), &
                       self%scales(front%pivot + 1:), self%reciprocals(front%pivot + 1:), self%sign_of_det)
        if (front%parent == 0) cycle
        ! the values of a parent stand behind those of its fronts
        associate (parent => plan%fronts(front%parent), last => front%value + front%rows*front%columns)
          call pass_rows(front, self%values(front%value + 1:last), plan%places(front%column + 1:), parent, &
                         self%values(parent%value + 1:))
        end associate
      end associate
    end do
    self%diagonal_ratio = least_against_largest(self%plan%n, self%reciprocals)
  end subroutine factorize

  !> The least number on a diagonal over the largest one, from their reciprocals, of which those of zeros are 0.
  pure real(wp) function least_against_largest(n, reciprocals) result(ratio)
    integer, intent(in) :: n                  !< number of columns
    real(wp), intent(in) :: reciprocals(n)    !< of the diagonal
    real(wp) :: low, high
    integer :: i

    low = abs(reciprocals(1))
    high = low
    do i = 2, n
      low = min(low, abs(reciprocals(i)))
      high = max(high, abs(reciprocals(i)))
    end do
    ratio = 0.0_wp
    if (low > 0.0_wp) ratio = low/high
  end function least_against_largest

  !> The length of the longest column and the least distance of a column from the span of the others, by the diagonal of the
  !> covariance, front by front from the last. No number on the diagonal of R may be zero.
  pure subroutine find_distances(self)
    class(front_factors_type), intent(inout) :: self   !< with R; gets the two numbers and the number of the nearest column
    real(wp) :: most
    integer :: f, i, r

    self%judged = .true.
    self%squares = 0.0_wp
    do f = 1, size(self%plan%fronts)
      associate (front => self%plan%fronts(f), plan => self%plan)
        call add_squares(front%rows, front%pivots, front%columns, self%values(front%value + 1:), &
                         plan%columns(front%column + 1:), plan%n, self%squares)
      end associate
    end do
    self%largest = sqrt(maxval(self%squares))
    do f = size(self%plan%fronts), 1, -1
      associate (front => self%plan%fronts(f), plan => self%plan)
        r = front%columns - front%pivots
        if (front%shares_parent) then
          call invert(front, self%values(front%value + 1:), self%reciprocals(front%pivot + 1:), &
                      self%covariances(plan%fronts(front%parent)%square + 1:), self%inverse, self%product, &
                      self%variances(front%pivot + 1:))
          cycle
        end if
        if (front%parent > 0) then
          associate (parent => plan%fronts(front%parent))
            call take_covariance(r, plan%places(front%column + front%pivots + 1:), parent%columns, &
                                 self%covariances(parent%square + 1:), self%of_others)
          end associate
        end if
        call invert(front, self%values(front%value + 1:), self%reciprocals(front%pivot + 1:), self%of_others, self%inverse, &
                    self%product, self%variances(front%pivot + 1:))
        if (front%has_children) call fill_covariance(front, self%inverse, self%product, self%of_others, &
                                                     self%covariances(front%square + 1:))
      end associate
    end do
    i = maxloc(self%variances, 1)
    most = self%variances(i)
    do f = size(self%plan%fronts), 1, -1
      if (self%plan%fronts(f)%pivot < i) exit
    end do
    self%nearest = self%plan%columns(self%plan%fronts(f)%column + i - self%plan%fronts(f)%pivot)
    self%least = 1.0_wp/sqrt(most)
  end subroutine find_distances

  !> Root of the sum of squares of the differences between two matrices that have the plan.
  pure real(wp) function distance(self, a, b)
    class(front_factors_type), intent(in) :: self   !< with the plan
    real(wp), intent(in) :: a(self%plan%m, self%plan%n)   !< the first matrix, zero outside the groups of the plan
    real(wp), intent(in) :: b(self%plan%m, self%plan%n)   !< the second one
    real(wp) :: total
    integer :: f

    total = 0.0_wp
    do f = 1, size(self%plan%fronts)
      associate (front => self%plan%fronts(f), plan => self%plan)
        if (front%original > 0) &
          call add_differences(front, plan%rows(front%row + 1:), plan%columns(front%column + 1:), plan%m, a, b, total)
      end associate
    end do
    distance = sqrt(total)
  end function distance

  !> x for which |a x - b| is least.
  pure subroutine solve(self, b, x, remainder)
    class(front_factors_type), intent(inout) :: self   !< the factors; scratch
    real(wp), intent(in), contiguous :: b(:)           !< (m) right-hand side
    real(wp), intent(inout), contiguous :: x(:)        !< (n) gets the solution
    real(wp), intent(out), optional :: remainder       !< length of the residual a x - b
    real(wp) :: square
    integer :: f, i, first

    square = 0.0_wp
    do f = 1, size(self%plan%fronts)
      associate (front => self%plan%fronts(f), plan => self%plan)
        call take_rows(front%original, plan%rows(front%row + 1:), plan%m, b, self%sides(front%row + 1:))
        call reflect(front%rows, front%pivots, self%values(front%value + 1:), self%scales(front%pivot + 1:), &
                     self%sides(front%row + 1:))
        if (front%parent == 0) then
          do i = front%row + front%pivots + 1, front%row + front%rows
            square = square + self%sides(i)**2
          end do
        else
          first = plan%fronts(front%parent)%row + front%parent_row - front%pivots
          do i = front%pivots + 1, front%rows
            self%sides(first + i) = self%sides(front%row + i)
          end do
        end if
      end associate
    end do
    if (present(remainder)) remainder = sqrt(square)
    call substitute_fronts(self, x)
  end subroutine solve

  !> x = R^-1 y. The numbers of y stand in the right-hand sides, those of each front at its own place.
  pure subroutine substitute_fronts(self, x)
    class(front_factors_type), intent(inout) :: self   !< with right-hand sides; these are overwritten
    real(wp), intent(inout), contiguous :: x(:)        !< (n) gets the solution
    integer :: f

    do f = size(self%plan%fronts), 1, -1
      associate (front => self%plan%fronts(f), plan => self%plan)
        call substitute(front, self%values(front%value + 1:), self%reciprocals(front%pivot + 1:), &
                        plan%columns(front%column + 1:), self%sides(front%row + 1:), x)
      end associate
    end do
  end subroutine substitute_fronts

  !> The least singular value, by inverse iteration: it begins with the column that is nearest to the span of the others.
  real(wp) function least_singular_value(self) result(least)
    class(front_factors_type), intent(inout) :: self   !< the factors; scratch
    integer, parameter :: most_iterations = 200
    real(wp) :: before, length
    integer :: iteration

    associate (x => self%squares)
      x = 0.01_wp
      x(self%nearest) = 1.0_wp
      least = 0.0_wp
      do iteration = 1, most_iterations
        before = least
        x = x/norm2(x)
        call substitute_transposed(self, x)
        call substitute_fronts(self, x)
        ! |(R^T R)^-1 v| for a unit vector v that tends to the right singular vector is 1/least^2
        length = norm2(x)
        least = 1.0_wp/sqrt(length)
        if (abs(least - before) <= 1.0e-14_wp*least) return
      end do
    end associate
  end function least_singular_value

  !> The shortest y for which a^T y = b.
  pure subroutine solve_transposed(self, b, y)
    class(front_factors_type), intent(inout) :: self   !< the factors; scratch
    real(wp), intent(inout), contiguous :: b(:)        !< (n) right-hand side; overwritten
    real(wp), intent(inout), contiguous :: y(:)        !< (m) gets the solution
    integer :: f, i, first

    call substitute_transposed(self, b)
    do f = size(self%plan%fronts), 1, -1
      associate (front => self%plan%fronts(f), plan => self%plan)
        first = front%row
        if (front%parent > 0) first = plan%fronts(front%parent)%row + front%parent_row - front%pivots
        do i = front%pivots + 1, front%rows
          self%sides(front%row + i) = 0.0_wp
          if (front%parent > 0) self%sides(front%row + i) = self%sides(first + i)
        end do
        call reflect_back(front%rows, front%pivots, self%values(front%value + 1:), self%scales(front%pivot + 1:), &
                          self%sides(front%row + 1:))
        do i = 1, front%original
          y(plan%rows(front%row + i)) = self%sides(front%row + i)
        end do
      end associate
    end do
  end subroutine solve_transposed

  !> y = R^-T x. The numbers of y become right-hand sides, those of each front at its own place.
  pure subroutine substitute_transposed(self, x)
    class(front_factors_type), intent(inout) :: self   !< the factors; gets right-hand sides
    real(wp), intent(inout), contiguous :: x(:)        !< (n) overwritten
    integer :: f, i, j, k

    do f = 1, size(self%plan%fronts)
      associate (front => self%plan%fronts(f), plan => self%plan)
        do j = 1, front%columns
          k = front%value + (j - 1)*front%rows
          associate (number => x(plan%columns(front%column + j)))
            do i = 1, min(j - 1, front%pivots)
              number = number - self%values(k + i)*self%sides(front%row + i)
            end do
            if (j <= front%pivots) self%sides(front%row + j) = number*self%reciprocals(front%pivot + j)
          end associate
        end do
      end associate
    end do
  end subroutine substitute_transposed
end module mech9_front_factors
