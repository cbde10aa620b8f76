!> Steps along a curve: from a guess to the curve by Newton's method, and directions (pseudo-arclength continuation, Keller in
!> docs/reference/bibliography.md).
module mech9_curve_step
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_lapack, only: dgetrf, dgetrs
  use mech9_singular_values, only: decompose
  use mech9_curve_tolerances, only: round_off_step, stagnated_step, least_contraction, null_direction
  use mech9_curve, only: curve_type, curve_point_type
  implicit none
  private
  public :: correction_type, correct, correct_along, set_direction, first_direction, branch_test, null_vectors, solve

  !> How Newton's method went.
  type :: correction_type
    logical :: done = .false.                          !< it converged
    integer :: steps = 0                               !< number of its steps
    real(wp) :: last_step = huge(1.0_wp)               !< length of the last one, as an image
    type(error_type), allocatable :: err               !< why the equations had no value, where they had none
  end type correction_type

  !> Largest number of steps.
  integer, parameter :: most_steps = 12
  !> Singular values below this part of the largest one are zero.
  real(wp), parameter :: singular = 1.0e-14_wp

contains

  !> The point on the curve at a distance along the direction of another one.
  subroutine correct_along(curve, from, distance, point, correction)
    class(curve_type), intent(inout) :: curve               !< the problem
    type(curve_point_type), intent(in) :: from              !< a point with its direction
    real(wp), intent(in) :: distance                        !< along this direction, as an image
    type(curve_point_type), intent(inout) :: point          !< the point, without a direction; of use where the method converged
    type(correction_type), intent(out) :: correction        !< whether it did

    call correct(curve, from, matmul(from%direction, from%slopes), distance, from%tangent*distance, point, correction)
  end subroutine correct_along

  !> The point on the curve in a plane: normal . (unknowns - those of another point) = distance.
  subroutine correct(curve, from, normal, distance, step, point, correction)
    class(curve_type), intent(inout) :: curve               !< the problem
    type(curve_point_type), intent(in) :: from              !< the other point
    real(wp), intent(in) :: normal(:)                       !< (n+1) of the plane, in its unknowns
    real(wp), intent(in) :: distance                        !< of the plane, times the length of the normal
    real(wp), intent(in) :: step(:)                         !< (n+1) from it to the guess
    type(curve_point_type), intent(inout) :: point          !< the point, without a direction; of use where the method converged
    type(correction_type), intent(out) :: correction        !< whether it did
    type(curve_point_type) :: trial
    real(wp), dimension(size(normal)) :: start, change
    real(wp) :: before, length
    logical :: solved
    integer :: i

    start = from%z(from%place)
    curve%equations = from%equations
    call curve%evaluate(from%place, from%z + matmul(from%slopes, step), trial, correction%err)
    before = huge(before)
    do i = 1, most_steps
      if (allocated(correction%err)) return
      call solve(trial%jacobian, normal, [-trial%residual, distance - dot_product(normal, trial%z(trial%place) - start)], change, &
                 solved)
      if (.not. solved) return
      length = norm2(matmul(trial%slopes, change))
      correction%steps = i
      correction%last_step = length
      correction%done = length <= round_off_step .or. (length <= stagnated_step .and. length > least_contraction*before)
      if (correction%done) then
        point = trial
        ! the last step is round-off of the equations, but not always of the numbers
        if (length <= round_off_step) point%z = trial%z + matmul(trial%slopes, change)
        return
      end if
      if (length > least_contraction*before) return
      before = length
      call step_to(trial%z + matmul(trial%slopes, change), trial%z(trial%place) + change)
    end do
  contains

    !> Evaluate the equations at other unknowns.
    subroutine step_to(guess, unknowns)
      real(wp), intent(in) :: guess(:)      !< (m) image
      real(wp), intent(in) :: unknowns(:)   !< (n+1) exact in them
      real(wp) :: exact(size(guess))

      exact = guess
      exact(from%place) = unknowns
      call curve%evaluate(from%place, exact, trial, correction%err)
    end subroutine step_to
  end subroutine correct

  !> Solve the equations of a point with one more row; where they are singular, by the shortest solution.
  subroutine solve(jacobian, row, right, x, solved)
    real(wp), intent(in) :: jacobian(:, :)   !< (n,n+1)
    real(wp), intent(in) :: row(:)           !< (n+1) the last row
    real(wp), intent(in) :: right(:)         !< (n+1) right-hand sides
    real(wp), intent(out) :: x(:)            !< (n+1) the solution
    logical, intent(out) :: solved           !< it is finite
    real(wp), dimension(size(row), size(row)) :: a, u, v
    real(wp) :: b(size(row), 1), s(size(row))
    integer :: pivots(size(row)), n, info

    n = size(row)
    a(:n - 1, :) = jacobian
    a(n, :) = row
    b(:, 1) = right
    call dgetrf(n, n, a, n, pivots, info)
    if (info == 0) then
      call dgetrs('N', n, 1, a, n, pivots, b, n, info)
      x = b(:, 1)
    else
      ! exactly at a branch point
      a(:n - 1, :) = jacobian
      a(n, :) = row
      call decompose(a, u, s, v)
      x = 0.0_wp
      do info = 1, n
        if (s(info) > singular*s(1)) x = x + v(:, info)*(dot_product(u(:, info), right)/s(info))
      end do
    end if
    solved = all(abs(x) <= huge(x))
  end subroutine solve

  !> Give a point its direction: that of the curve which is nearest to another one. `found` is false where there is none.
  subroutine set_direction(point, toward, found)
    type(curve_point_type), intent(inout) :: point   !< on the curve
    real(wp), intent(in) :: toward(:)                !< (m) a direction, as an image
    logical, intent(out) :: found                    !< there is one
    real(wp) :: right(size(point%place)), tangent(size(point%place))

    right = 0.0_wp
    right(size(right)) = 1.0_wp
    call solve(point%jacobian, matmul(toward, point%slopes), right, tangent, found)
    if (found) call take_tangent(point, tangent)
  end subroutine set_direction

  !> Take a tangent, whatever its length.
  subroutine take_tangent(point, tangent)
    type(curve_point_type), intent(inout) :: point   !< gets tangent and direction
    real(wp), intent(in) :: tangent(:)               !< (n+1) in its unknowns
    real(wp) :: direction(size(point%z))

    direction = matmul(point%slopes, tangent)
    point%tangent = tangent/norm2(direction)
    point%direction = direction/norm2(direction)
  end subroutine take_tangent

  !> Give a point the direction in which the parameter grows, or any where it does not change. `count` is the number of directions.
  subroutine first_direction(point, count)
    type(curve_point_type), intent(inout) :: point   !< on the curve
    integer, intent(out) :: count                    !< 1 but at a singular point, where branches meet
    real(wp), allocatable :: vectors(:, :)
    real(wp) :: left(size(point%residual))

    call null_vectors(point, maxval(abs(point%jacobian)), vectors, left)
    count = size(vectors, 2)
    call take_tangent(point, vectors(:, 1)*sign(1.0_wp, vectors(size(point%place), 1)))
  end subroutine first_direction

  !> Vectors that the derivatives of the equations make zero, the most exact one first, and the left vector of the least singular value.
  subroutine null_vectors(point, scale, vectors, left)
    type(curve_point_type), intent(in) :: point              !< on the curve
    real(wp), intent(in) :: scale                            !< size of the derivatives of the equations
    real(wp), allocatable, intent(out) :: vectors(:, :)      !< (n+1,count)
    real(wp), intent(out) :: left(:)                         !< (n) of length 1
    real(wp), dimension(size(point%place), size(point%place)) :: a, u, v
    real(wp) :: s(size(point%place))
    integer :: n, i

    n = size(point%residual)
    a = 0.0_wp
    a(:n, :) = point%jacobian
    call decompose(a, u, s, v)
    vectors = v(:, [(i, i=n + 1, n + 1 - count(s(:n) <= null_direction*scale), -1)])
    ! the row of zeros has a left vector of its own, which mixes with others of no singular value
    left = u(:n, n)*u(n + 1, n + 1) - u(:n, n + 1)*u(n + 1, n)
    left = left/norm2(left)
  end subroutine null_vectors

  !> A number that changes its sign where branches cross at one point: the determinant of the equations with the direction. Both ends of
  !> a step must have the same unknowns.
  real(wp) function branch_test(point, scale) result(determinant)
    type(curve_point_type), intent(in) :: point   !< on the curve, with its direction
    real(wp), intent(in) :: scale                 !< size of the derivatives, the same at all points
    real(wp) :: a(size(point%place), size(point%place))
    integer :: pivots(size(point%place)), n, i, info

    n = size(point%place)
    a(:n - 1, :) = point%jacobian/scale
    a(n, :) = matmul(point%direction, point%slopes)
    call dgetrf(n, n, a, n, pivots, info)
    determinant = 1.0_wp
    do i = 1, n
      determinant = determinant*a(i, i)
      if (pivots(i) /= i) determinant = -determinant
    end do
  end function branch_test
end module mech9_curve_step
