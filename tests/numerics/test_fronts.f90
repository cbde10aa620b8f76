!> The factorization by fronts against that of the full matrix and against singular values.
module test_fronts
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_matrix
  use mech9_front_plan, only: front_plan_type, row_groups_type, new_front_plan, add_diagonal
  use mech9_least_squares, only: least_squares_type
  use mech9_lapack, only: dgesvd
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('fronts_follow_the_structure')) call fronts_follow_the_structure(test)
    if (test%runs('random_numbers')) call random_numbers(test)
    if (test%runs('diagonals')) call diagonals(test)
  end subroutine run

  subroutine random_numbers(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: trial
    type(random_type) :: random

    do trial = 1, 40
      call check_structure(test, random, platform(6, 6, 5), 'a platform on six legs')
      call check_structure(test, random, platform(4, 6, 4), 'a platform on four legs with more equations than unknowns')
      call check_structure(test, random, platform(5, 3, 2), 'a plane platform on five legs')
      call check_structure(test, random, ladder(6, 6), 'a ladder')
      call check_structure(test, random, two_floors(), 'a platform on a platform')
      call check_structure(test, random, random_structure(random), 'a structure at random')
    end do
  end subroutine random_numbers

  subroutine diagonals(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: trial
    type(random_type) :: random

    do trial = 1, 10
      call check_structure(test, random, with_diagonal(test, platform(6, 6, 5)), 'a platform on six legs with a diagonal')
    end do
  end subroutine diagonals

  !> A platform on legs: each group has the unknowns of the first leg and those of one other leg.
  pure function platform(legs, equations, unknowns) result(structure)
    integer, intent(in) :: legs        !< number of legs
    integer, intent(in) :: equations   !< rows of each group
    integer, intent(in) :: unknowns    !< columns of each leg
    type(row_groups_type) :: structure
    integer :: leg, i

    structure%n = legs*unknowns
    allocate (structure%sizes(legs - 1), source=equations)
    structure%first = [(2*unknowns*leg + 1, leg=0, legs - 1)]
    structure%members = [([(i, i=1, unknowns), (leg*unknowns + i, i=1, unknowns)], leg=1, legs - 1)]
  end function platform

  !> Loops of which each shares two unknowns with the next one.
  pure function ladder(loops, equations) result(structure)
    integer, intent(in) :: loops       !< number of loops
    integer, intent(in) :: equations   !< rows of each group
    type(row_groups_type) :: structure
    integer :: loop, i

    structure%n = loops*equations
    allocate (structure%sizes(loops), source=equations)
    structure%first = [((equations + 2)*(loop - 1) + 1, loop=1, loops), (equations + 2)*loops - 1]
    structure%members = [(equations*(loop - 1) + [(i, i=1, equations + 2)], loop=1, loops - 1), &
                         [(structure%n - equations + i, i=1, equations)]]
  end function ladder

  !> Two platforms of three legs, the second on the first; the two share no leg, but the unknowns of the first platform's leg.
  pure function two_floors() result(structure)
    type(row_groups_type) :: structure
    integer :: i

    structure%n = 24
    structure%sizes = [6, 6, 6, 6]
    structure%first = [1, 11, 21, 35, 49]
    structure%members = [[(i, i=1, 10)], [(i, i=1, 5)], [(10 + i, i=1, 5)], [(i, i=1, 5)], [(15 + i, i=1, 9)], &
                         [(i, i=1, 5)], [(15 + i, i=1, 4)], [(19 + i, i=1, 5)]]
  end function two_floors

  !> Up to eight groups of three or six rows in which unknowns occur at random.
  function random_structure(random) result(structure)
    type(random_type), intent(inout) :: random   !< source of the numbers
    type(row_groups_type) :: structure
    integer :: groups, g, i, n, rows
    logical, allocatable :: occurs(:)

    groups = 3 + int(2.5_wp*(1.0_wp + random%symmetric()))
    allocate (structure%sizes(groups), structure%first(groups + 1), structure%members(0))
    do g = 1, groups
      structure%sizes(g) = merge(3, 6, random%symmetric() > 0.0_wp)
    end do
    rows = sum(structure%sizes)
    n = rows - max(0, int(3.0_wp*random%symmetric()))
    structure%n = n
    structure%first(1) = 1
    do g = 1, groups
      ! every unknown occurs in the group whose rows have its number, so that the matrix is regular in general
      occurs = [(i > sum(structure%sizes(:g - 1)) .and. i <= sum(structure%sizes(:g)), i=1, n)]
      do i = 1, n
        if (random%symmetric() > 0.8_wp) occurs(i) = .true.
      end do
      ! the first two unknowns are a class, or belong to one
      occurs(2) = occurs(1)
      structure%members = [structure%members, pack([(i, i=1, n)], occurs)]
      structure%first(g + 1) = size(structure%members) + 1
    end do
  end function random_structure

  !> A structure with one more row for each column.
  function with_diagonal(test, structure) result(longer)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(row_groups_type), intent(in) :: structure   !< groups and columns
    type(row_groups_type) :: longer
    integer :: row_of(structure%n), m, i, g

    longer = structure
    call add_diagonal(longer, row_of)
    m = sum(structure%sizes)
    call test%is_true(sum(longer%sizes) == m + structure%n .and. minval(row_of) == m + 1 .and. maxval(row_of) == m + structure%n &
                      .and. all([(count(row_of == m + i) == 1, i=1, structure%n)]), 'each column has a row of its own')
    do i = 1, structure%n
      do g = 1, size(longer%sizes)
        if (row_of(i) <= sum(longer%sizes(:g))) exit
      end do
      call test%is_true(any(longer%members(longer%first(g):longer%first(g + 1) - 1) == i), &
                        'a column occurs in the group of its own row')
    end do
  end function with_diagonal

  !> A matrix with this structure, with entries at random.
  function matrix_of(random, structure) result(a)
    type(random_type), intent(inout) :: random       !< source of the numbers
    type(row_groups_type), intent(in) :: structure   !< groups and columns
    real(wp), allocatable :: a(:, :)
    integer :: g, i, row

    allocate (a(sum(structure%sizes), structure%n), source=0.0_wp)
    row = 0
    do g = 1, size(structure%sizes)
      do i = structure%first(g), structure%first(g + 1) - 1
        a(row + 1:row + structure%sizes(g), structure%members(i:i)) = random_matrix(random, structure%sizes(g), 1)
      end do
      row = row + structure%sizes(g)
    end do
  end function matrix_of

  !> Each leg of a platform is a front, and the leg that all groups share is the last one.
  subroutine fronts_follow_the_structure(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(row_groups_type) :: structure
    type(front_plan_type) :: plan

    structure = platform(6, 6, 5)
    plan = new_front_plan(structure)
    call test%is_true(plan%used, 'fronts save work on a platform')
    call test%is_true(all(plan%fronts%rows == [6, 6, 6, 6, 6, 5]), &
                      'a front has the rows of a closure, and the last one those that remain')
    call test%is_true(all(plan%fronts%pivots == 5), 'every front eliminates a leg')
    call test%is_true(all(plan%fronts(:5)%parent == 6), 'the legs pass their rows on to the last front')
    plan = new_front_plan(with_diagonal(test, structure))
    call test%is_true(plan%used .and. all(plan%fronts%pivots == 5) .and. all(plan%fronts(:5)%rows == 11), &
                      'with a diagonal, every leg remains a front')
    structure = platform(2, 6, 3)
    plan = new_front_plan(structure)
    call test%is_true(.not. plan%used, 'one group is a full matrix')
  end subroutine fronts_follow_the_structure

  !> Regular, nearly singular, and singular matrices of one structure.
  subroutine check_structure(test, random, structure, name)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(random_type), intent(inout) :: random       !< source of the numbers
    type(row_groups_type), intent(in) :: structure   !< groups and columns
    character(len=*), intent(in) :: name             !< of the structure, for the report of a failure
    real(wp), allocatable :: a(:, :)
    integer :: exponent, j

    a = matrix_of(random, structure)
    call check_matrix(test, random, structure, a, name)
    ! a column of the first group becomes dependent, or nearly dependent, on another of the same group
    j = structure%first(1)
    associate (first => a(:structure%sizes(1), structure%members(j)), second => a(:structure%sizes(1), structure%members(j + 1)))
      do exponent = 1, 4
        second = first + 10.0_wp**(-4*exponent)*second
        a(structure%sizes(1) + 1:, structure%members(j + 1)) = a(structure%sizes(1) + 1:, structure%members(j))
        call check_matrix(test, random, structure, a, name//', nearly singular')
      end do
      second = first
      call check_matrix(test, random, structure, a, name//', singular')
    end associate
  end subroutine check_structure

  !> Pivots, rank, least singular value, sign and solutions of a matrix by fronts and as a full one.
  subroutine check_matrix(test, random, structure, a, name)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(random_type), intent(inout) :: random       !< source of the numbers
    type(row_groups_type), intent(in) :: structure   !< groups and columns
    real(wp), intent(in) :: a(:, :)                  !< the matrix
    character(len=*), intent(in) :: name             !< for the report of a failure
    type(least_squares_type) :: by_fronts, full
    real(wp) :: b(size(a, 1)), side(size(a, 1)), x(size(a, 2)), y(size(a, 2)), remainder, expected, s(size(a, 2)), allowed

    call by_fronts%create(size(a, 1), size(a, 2), new_front_plan(structure))
    call full%create(size(a, 1), size(a, 2))
    b = reshape(random_matrix(random, size(b), 1), [size(b)])
    call test%near(by_fronts%distance(a, 3.0_wp*a), full%distance(a, 3.0_wp*a), 1.0e-14_wp, &
                   name//': two matrices are as far apart as full ones')
    call by_fronts%factorize(a)
    call full%factorize(a)
    side = b
    call by_fronts%solve(side, x, remainder)
    side = b
    call full%solve(side, y, expected)
    s = singular_values(a)
    ! round-off over the conditioning; where ranks are doubtful, both are solved in the same way
    allowed = 1.0e3_wp*epsilon(1.0_wp)*s(1)/max(s(size(s)), 1.0e-16_wp*s(1))
    if (allowed < 1.0e-3_wp) then
      call test%is_true(norm2(x - y) <= allowed*(norm2(y) + norm2(b)*s(1)/s(size(s))**2), &
                        name//': the solution is that of the full matrix')
      call test%is_true(abs(remainder - expected) <= allowed*norm2(b), name//': the remainder is that of the full matrix')
      call check_transposed(test, random, by_fronts, a, norm2(b), allowed, name//', by fronts')
      call check_transposed(test, random, full, a, norm2(b), allowed, name)
      call test%is_true(by_fronts%determinant_sign() == full%determinant_sign(), &
                        name//': the determinant has the sign of the full matrix')
    end if
    call test%is_true(by_fronts%rank(1.0e-9_wp) == full%rank(1.0e-9_wp), name//': the rank is that of the full matrix')
    associate (least => s(size(s)), pivot => by_fronts%least_pivot())
      ! below round-off of the largest singular value neither is known
      allowed = 1.0e-12_wp*s(1)
      call test%is_true(pivot >= least*(1.0_wp - 1.0e-10_wp) - allowed, name//': the least pivot is above the least singular value')
      ! fronts bound it by the root of the number of columns, exchange of columns hardly ever exceeds twice that
      call test%is_true(pivot <= 2.0_wp*least*sqrt(real(size(s), wp)) + allowed, &
                        name//': the least pivot is not far above the least singular value')
      call test%is_true(abs(by_fronts%largest_pivot() - full%largest_pivot()) <= 1.0e-14_wp*s(1), &
                        name//': the largest pivot is that of the full matrix')
      if (least > 1.0e-9_wp*s(1)) &
        call test%is_true(abs(by_fronts%least_singular_value() - least) <= 1.0e-5_wp*least, &
                          name//': the least singular value is that of the full matrix')
    end associate
  end subroutine check_matrix

  !> A solution of the transposed equations satisfies them, and is the shortest: it is a linear combination of the columns.
  subroutine check_transposed(test, random, factors, a, length, allowed, name)
    type(tester_type), intent(inout) :: test             !< counts the checks
    type(random_type), intent(inout) :: random           !< source of the numbers
    type(least_squares_type), intent(inout) :: factors   !< of the matrix
    real(wp), intent(in) :: a(:, :)                      !< the matrix
    real(wp), intent(in) :: length                       !< of a typical right-hand side
    real(wp), intent(in) :: allowed                      !< round-off over the conditioning
    character(len=*), intent(in) :: name                 !< for the report of a failure
    real(wp) :: b(size(a, 2)), side(max(size(a, 1), size(a, 2))), y(size(a, 1)), x(size(a, 2)), remainder

    b = reshape(random_matrix(random, size(b), 1), [size(b)])
    side(:size(b)) = b
    call factors%solve_transposed(side(:size(b)), y)
    call test%is_true(norm2(matmul(y, a) - b) <= allowed*length, name//': a^T y = b')
    side(:size(y)) = y
    call factors%solve(side(:size(y)), x, remainder)
    call test%is_true(remainder <= allowed*norm2(y), name//': y is a combination of columns')
  end subroutine check_transposed

  !> Singular values, the largest first.
  function singular_values(a) result(s)
    real(wp), intent(in) :: a(:, :)   !< any shape
    real(wp) :: s(min(size(a, 1), size(a, 2)))
    real(wp) :: copy(size(a, 1), size(a, 2)), u(size(a, 1), size(a, 1)), vt(1, 1), work(10*(size(a, 1) + size(a, 2)))
    integer :: info

    copy = a
    call dgesvd('A', 'N', size(a, 1), size(a, 2), copy, size(a, 1), s, u, size(a, 1), vt, 1, work, size(work), info)
    if (info /= 0) error stop 'singular values did not converge'
  end function singular_values
end module test_fronts
