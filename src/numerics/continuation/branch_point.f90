!> Branch points of a curve: their exact place, and the direction of the branch that crosses there.
!>
!> At a simple branch point the derivatives of the equations have one left null vector. With it the point is a regular solution of larger
!> equations, which Newton's method solves; second derivatives come from central differences of the exact first ones, and only decide how
!> fast it converges. Directions follow from the algebraic branching equation (Keller; Govaerts in docs/reference/bibliography.md).
module mech9_branch_point
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_lapack, only: dgetrf, dgetrs
  use mech9_curve_tolerances, only: difference_step, polished_step, second_order, stagnated_step, least_contraction
  use mech9_curve, only: curve_type, curve_point_type
  use mech9_curve_step, only: null_vectors
  implicit none
  private
  public :: branch_point_type, polish_branch_point, find_crossing

  !> A branch point with what its branches need.
  type :: branch_point_type
    type(curve_point_type) :: point               !< with the direction of the branch on which it was found
    real(wp), allocatable :: left(:)              !< (n) left null vector
    real(wp), allocatable :: second(:, :)         !< (n+1,n+1) second derivatives of the equations along it
    real(wp), allocatable :: directions(:, :)     !< (m,branches) of the branches through it that are known, as images
    logical :: is_polished = .false.              !< it is exact
    logical :: doubles = .false.                  !< periods double there: the point has the single period
    logical :: knows_single = .false.             !< the branch with the single period has been followed
    logical :: knows_double = .false.             !< the branch with the doubled period has been
    integer :: doublings = 0                      !< times by which the period doubled on the way to it
  end type branch_point_type

  !> Steps beyond this come from equations that are singular.
  real(wp), parameter :: farthest_step = 1.0e6_wp
  !> Largest number of steps to it.
  integer, parameter :: most_steps = 12

contains

  !> Find the exact place of a branch point from a point near by.
  subroutine polish_branch_point(curve, near, found)
    class(curve_type), intent(inout) :: curve           !< the problem
    type(curve_point_type), intent(in) :: near          !< near it, with its direction
    type(branch_point_type), intent(out) :: found       !< the branch point
    type(curve_point_type) :: point
    real(wp), allocatable :: vectors(:, :)
    real(wp) :: left(size(near%residual)), second(size(near%place), size(near%place)), step(2*size(near%place))
    real(wp) :: beta, length, before
    type(error_type), allocatable :: err
    integer :: i, n

    n = size(left)
    point = near
    found%point = near
    allocate (found%directions(size(near%z), 1))
    found%directions(:, 1) = near%direction
    call null_vectors(point, curve%scale, vectors, left)
    beta = 0.0_wp
    before = huge(before)
    do i = 1, most_steps
      call differentiate(curve, point, left, second, err)
      if (allocated(err)) return
      call find_step(point, left, beta, second, step)
      ! several null vectors: the point is not simple
      if (.not. all(abs(step) < farthest_step)) return
      length = norm2(matmul(point%slopes, step(:n + 1)))
      if (length <= polished_step .or. (length <= stagnated_step .and. length > least_contraction*before)) exit
      if (.not. length < before) return
      before = length
      beta = beta + step(n + 2)
      left = left + step(n + 3:)
      call move(curve, point, step(:n + 1), err)
      if (allocated(err)) return
    end do
    if (i > most_steps) return
    found%point = point
    found%point%tangent = near%tangent
    found%point%direction = near%direction
    found%left = left/norm2(left)
    found%second = second/norm2(left)
    found%is_polished = .true.
  end subroutine polish_branch_point

  !> Move a point by a change of its unknowns.
  subroutine move(curve, point, change, err)
    class(curve_type), intent(inout) :: curve           !< the problem
    type(curve_point_type), intent(inout) :: point      !< the point
    real(wp), intent(in) :: change(:)                   !< (n+1) of its unknowns
    type(error_type), allocatable, intent(out) :: err   !< allocated if the equations have no value there
    type(curve_point_type) :: other
    real(wp) :: guess(size(point%z))

    guess = point%z + matmul(point%slopes, change)
    guess(point%place) = point%z(point%place) + change
    curve%equations = point%equations
    call curve%evaluate(point%place, guess, other, err)
    if (.not. allocated(err)) point = other
  end subroutine move

  !> Second derivatives of the equations along a left vector, by central differences.
  subroutine differentiate(curve, point, left, second, err)
    class(curve_type), intent(inout) :: curve           !< the problem
    type(curve_point_type), intent(in) :: point         !< the point
    real(wp), intent(in) :: left(:)                     !< (n) the vector
    real(wp), intent(out) :: second(:, :)               !< (n+1,n+1) the derivatives
    type(error_type), allocatable, intent(out) :: err   !< allocated if the equations have no value beside the point
    type(curve_point_type) :: ahead, behind
    real(wp) :: change(size(point%place))
    integer :: j

    do j = 1, size(change)
      change = 0.0_wp
      change(j) = difference_step/norm2(point%slopes(:, j))
      ahead = point
      behind = point
      call move(curve, ahead, change, err)
      if (.not. allocated(err)) call move(curve, behind, -change, err)
      if (allocated(err)) return
      second(:, j) = matmul(left, ahead%jacobian - behind%jacobian)/(2.0_wp*change(j))
    end do
    second = 0.5_wp*(second + transpose(second))
  end subroutine differentiate

  !> A step to the solution of: equations + beta left = 0, left . jacobian = 0, left . left = 1.
  subroutine find_step(point, left, beta, second, step)
    type(curve_point_type), intent(in) :: point   !< the point
    real(wp), intent(in) :: left(:)               !< (n) left vector
    real(wp), intent(in) :: beta                  !< its part of the equations
    real(wp), intent(in) :: second(:, :)          !< (n+1,n+1) second derivatives along the vector
    real(wp), intent(out) :: step(:)              !< (2n+2) of unknowns, beta and vector; huge where there is none
    real(wp) :: a(size(step), size(step)), b(size(step), 1)
    integer :: pivots(size(step)), n, i, info

    n = size(left)
    a = 0.0_wp
    a(:n, :n + 1) = point%jacobian
    a(:n, n + 2) = left
    do i = 1, n
      a(i, n + 2 + i) = beta
    end do
    a(n + 1:2*n + 1, :n + 1) = second
    a(n + 1:2*n + 1, n + 3:) = transpose(point%jacobian)
    a(2*n + 2, n + 3:) = 2.0_wp*left
    b(:n, 1) = -point%residual - beta*left
    b(n + 1:2*n + 1, 1) = -matmul(left, point%jacobian)
    b(2*n + 2, 1) = 1.0_wp - dot_product(left, left)
    call dgetrf(size(step), size(step), a, size(step), pivots, info)
    step = huge(1.0_wp)
    if (info /= 0) return
    call dgetrs('N', size(step), 1, a, size(step), pivots, b, size(step), info)
    step = b(:, 1)
  end subroutine find_step

  !> The directions of the two branches that cross at a branch point. `found` is false where none crosses, or several do.
  subroutine find_crossing(branch_point, scale, along, known, crossing, found)
    type(branch_point_type), intent(in) :: branch_point   !< exact
    real(wp), intent(in) :: scale                         !< size of the derivatives of the equations
    real(wp), intent(in) :: along(:)                      !< (m) near the direction of the known branch, as an image
    real(wp), intent(out) :: known(:)                     !< (m) of the known branch, of length 1
    real(wp), intent(out) :: crossing(:)                  !< (m) of the other one, of length 1
    logical, intent(out) :: found                         !< there is one
    real(wp), allocatable :: vectors(:, :)
    real(wp) :: left(size(branch_point%left)), images(size(along), 2), a, b, c, largest, root
    real(wp) :: weights(2, 2)
    integer :: i

    known = along
    crossing = 0.0_wp
    call null_vectors(branch_point%point, scale, vectors, left)
    found = size(vectors, 2) == 2
    if (.not. found) return
    associate (second => branch_point%second, slopes => branch_point%point%slopes)
      vectors(:, 1) = vectors(:, 1)/norm2(matmul(slopes, vectors(:, 1)))
      images(:, 1) = matmul(slopes, vectors(:, 1))
      vectors(:, 2) = vectors(:, 2) - dot_product(images(:, 1), matmul(slopes, vectors(:, 2)))*vectors(:, 1)
      vectors(:, 2) = vectors(:, 2)/norm2(matmul(slopes, vectors(:, 2)))
      images(:, 2) = matmul(slopes, vectors(:, 2))
      ! a direction x first + y second has a x^2 + 2 b x y + c y^2 = 0
      a = dot_product(vectors(:, 1), matmul(second, vectors(:, 1)))
      b = dot_product(vectors(:, 1), matmul(second, vectors(:, 2)))
      c = dot_product(vectors(:, 2), matmul(second, vectors(:, 2)))
    end associate
    largest = max(abs(a), abs(b), abs(c))
    found = b**2 - a*c > (second_order*largest)**2
    if (.not. found) return
    ! the root of the larger sum, and the other one by the product of both
    root = -(b + sign(sqrt(b**2 - a*c), b))
    weights = reshape([root, a, c, root], [2, 2])
    images = matmul(images, weights)
    do i = 1, 2
      images(:, i) = unit(images(:, i))
    end do
    i = maxloc(abs(matmul(along, images)), dim=1)
    known = images(:, i)*sign(1.0_wp, dot_product(along, images(:, i)))
    crossing = images(:, 3 - i)
  end subroutine find_crossing

  !> A vector of length 1.
  pure function unit(vector)
    real(wp), intent(in) :: vector(:)   !< any
    real(wp) :: unit(size(vector))

    unit = vector/norm2(vector)
  end function unit
end module mech9_branch_point
