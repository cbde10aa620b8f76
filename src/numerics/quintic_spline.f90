!> Quintic spline through points in space, with continuous fourth derivative, open or periodic.
!>
!> The unknowns are the first and second derivatives at the points. At each inner point the third and the fourth derivatives of
!> both pieces are equal. At the ends of an open curve the first two derivatives are those of the polynomial through
!> the six points next to the end, so that polynomials of fifth degree are reproduced and the error is of sixth order.
module mech9_quintic_spline
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_spline_failures, only: failure_few_points, failure_points_order, failure_no_spline
  use mech9_lapack, only: dgbsv
  implicit none
  private
  public :: quintic_spline_type, build_quintic, fewest_points

  integer, parameter :: fewest_points = 4   !< fewest points of a curve; in a closed one the repeated point is not counted
  integer, parameter :: band = 5            !< diagonals on each side of the main one
  integer, parameter :: near_end = 6        !< points of the polynomial at an end

  !> Pieces of fifth degree between increasing values of a parameter.
  type :: quintic_spline_type
    real(wp), allocatable :: x(:)          !< (n) parameter at the points, increasing
    real(wp), allocatable :: c(:, :, :)    !< (0:5,3,n-1) coefficients of each piece in (x - x(i))/(x(i+1) - x(i))
  contains
    procedure :: evaluate
    procedure :: velocity
    procedure :: fourth_derivative
  end type quintic_spline_type

  !> The linear equations of the derivatives at the points, as a band.
  type :: equations_type
    integer :: points = 0                    !< number of the points
    logical :: periodic = .false.            !< the first point follows the last one
    real(wp), allocatable :: matrix(:, :)    !< (3 band + 1, 2 points) coefficients, by diagonals as LAPACK has them
    real(wp), allocatable :: right(:, :)     !< (2 points,3) right-hand sides, then the solution
  end type equations_type

contains

  !> The spline through points. A periodic one needs the first point again as the last one. Fails for fewer than four
  !> different points, and where the parameter does not increase.
  subroutine build_quintic(x, y, periodic, spline, err)
    real(wp), intent(in) :: x(:)                        !< (n) parameter at the points, increasing
    real(wp), intent(in) :: y(:, :)                     !< (3,n) the points
    logical, intent(in) :: periodic                     !< all derivatives up to the fourth are equal at both ends
    type(quintic_spline_type), intent(out) :: spline    !< the curve
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: h(size(x) - 1), slope(3, size(x)), bend(3, size(x))
    integer :: i, n, points

    n = size(x)
    points = n
    if (periodic) points = n - 1
    if (points < fewest_points) then
      call raise(err, exit_data, failure_few_points)
      err%failure%number = points
      return
    end if
    h = x(2:) - x(:n - 1)
    if (any(.not. h > 0.0_wp)) then
      call raise(err, exit_data, failure_points_order)
      err%failure%number = findloc(h > 0.0_wp, .false., dim=1)
      return
    end if
    call find_derivatives(h, x, y, periodic, slope(:, :points), bend(:, :points), err)
    if (allocated(err)) return
    if (periodic) then
      slope(:, n) = slope(:, 1)
      bend(:, n) = bend(:, 1)
    end if
    spline%x = x
    allocate (spline%c(0:5, 3, n - 1))
    do i = 1, n - 1
      call find_piece(h(i), reshape([y(:, i), slope(:, i), bend(:, i)], [3, 3]), &
                      reshape([y(:, i + 1), slope(:, i + 1), bend(:, i + 1)], [3, 3]), spline%c(:, :, i))
    end do
  end subroutine build_quintic

  !> First and second derivatives at the points, from banded linear equations.
  subroutine find_derivatives(h, x, y, periodic, slope, bend, err)
    real(wp), intent(in) :: h(:)                        !< (n-1) lengths of the pieces
    real(wp), intent(in) :: x(:)                        !< (n) parameter at the points
    real(wp), intent(in) :: y(:, :)                     !< (3,n) the points
    logical, intent(in) :: periodic                     !< the last point is the first one
    real(wp), intent(out) :: slope(:, :)                !< (3,points) first derivatives
    real(wp), intent(out) :: bend(:, :)                 !< (3,points) second derivatives
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(equations_type) :: equations
    integer, allocatable :: pivots(:)
    integer :: i, n, points, before, info

    n = size(x)
    points = size(slope, 2)
    equations%points = points
    equations%periodic = periodic
    allocate (equations%matrix(3*band + 1, 2*points), equations%right(2*points, 3), source=0.0_wp)
    allocate (pivots(2*points))
    do i = 1, points
      if (.not. periodic .and. i == 1) then
        call fix_end(equations, i, x(:min(n, near_end)), y(:, :min(n, near_end)))
      else if (.not. periodic .and. i == n) then
        call fix_end(equations, i, x(n:max(1, n - near_end + 1):-1), y(:, n:max(1, n - near_end + 1):-1))
      else
        before = merge(n - 1, i - 1, i == 1)
        call join_pieces(equations, i, h(before), h(i), (y(:, before + 1) - y(:, before))/h(before), &
                         (y(:, i + 1) - y(:, i))/h(i))
      end if
    end do
    call dgbsv(2*points, band, band, 3, equations%matrix, size(equations%matrix, 1), pivots, equations%right, &
               2*points, info)
    if (info /= 0) then
      call raise(err, exit_data, failure_no_spline)
      return
    end if
    do i = 1, points
      slope(:, i) = equations%right(first_row(equations, i), :)
      bend(:, i) = equations%right(first_row(equations, i) + 1, :)
    end do
    do i = 1, points
      if (all(abs(slope(:, i)) < huge(1.0_wp)) .and. all(abs(bend(:, i)) < huge(1.0_wp))) cycle
      call raise(err, exit_data, failure_no_spline)
      return
    end do
  end subroutine find_derivatives

  !> Number of the first of the two equations, and of the two unknowns, of a point. Those of a periodic curve are numbered from
  !> both sides of its first point at once, so that neighbours stay near each other and the matrix is a band.
  pure integer function first_row(equations, i)
    type(equations_type), intent(in) :: equations   !< the equations
    integer, intent(in) :: i                        !< number of a point

    first_row = 2*i - 1
    if (.not. equations%periodic) return
    if (2*i <= equations%points + 1) then
      first_row = 4*i - 3
    else
      first_row = 4*(equations%points - i) + 3
    end if
  end function first_row

  !> Add numbers to the coefficients of the two unknowns of a point in one equation.
  pure subroutine add(equations, row, i, of_slope, of_bend)
    type(equations_type), intent(inout) :: equations   !< the equations
    integer, intent(in) :: row                         !< number of the equation
    integer, intent(in) :: i                           !< number of the point
    real(wp), intent(in) :: of_slope                   !< coefficient of its first derivative
    real(wp), intent(in) :: of_bend                    !< coefficient of its second derivative
    integer :: column

    column = first_row(equations, i)
    associate (matrix => equations%matrix, diagonal => 2*band + 1)
      matrix(diagonal + row - column, column) = matrix(diagonal + row - column, column) + of_slope
      matrix(diagonal + row - column - 1, column + 1) = matrix(diagonal + row - column - 1, column + 1) + of_bend
    end associate
  end subroutine add

  !> Equal third and fourth derivatives of the pieces on both sides of a point.
  pure subroutine join_pieces(equations, i, a, b, slope_a, slope_b)
    type(equations_type), intent(inout) :: equations   !< gets two equations
    integer, intent(in) :: i                           !< number of the point
    real(wp), intent(in) :: a                          !< length of the piece before it
    real(wp), intent(in) :: b                          !< length of the piece after it
    real(wp), intent(in) :: slope_a(3)                 !< mean slope of the piece before it
    real(wp), intent(in) :: slope_b(3)                 !< mean slope of the piece after it
    integer :: row, previous, next
    real(wp) :: s, p, q

    row = first_row(equations, i)
    previous = merge(equations%points, i - 1, i == 1)
    next = merge(1, i + 1, i == equations%points)
    ! powers of s, by which the equations are multiplied, make their coefficients alike in size
    s = min(a, b)
    p = s/a
    q = s/b
    call add(equations, row, previous, 24.0_wp*p**2, 3.0_wp*p*s)
    call add(equations, row, i, 36.0_wp*(p**2 - q**2), -9.0_wp*(p + q)*s)
    call add(equations, row, next, -24.0_wp*q**2, 3.0_wp*q*s)
    equations%right(row, :) = 60.0_wp*(p**2*slope_a - q**2*slope_b)
    call add(equations, row + 1, previous, 168.0_wp*p**3, 24.0_wp*p**2*s)
    call add(equations, row + 1, i, 192.0_wp*(p**3 + q**3), 36.0_wp*(q**2 - p**2)*s)
    call add(equations, row + 1, next, 168.0_wp*q**3, -24.0_wp*q**2*s)
    equations%right(row + 1, :) = 360.0_wp*(p**3*slope_a + q**3*slope_b)
  end subroutine join_pieces

  !> The derivatives at an end are those of a polynomial through the points next to it, in Newton's form.
  pure subroutine fix_end(equations, i, x, y)
    type(equations_type), intent(inout) :: equations   !< gets two equations
    integer, intent(in) :: i                           !< number of the end point
    real(wp), intent(in) :: x(:)                       !< parameter at the points of the polynomial, from the end inwards
    real(wp), intent(in) :: y(:, :)                    !< (3, size of x) the points
    real(wp) :: c(3, size(x)), first(3), second(3), value(3)
    integer :: row, j, k, n

    n = size(x)
    c = y
    do k = 2, n
      do j = n, k, -1
        c(:, j) = (c(:, j) - c(:, j - 1))/(x(j) - x(j - k + 1))
      end do
    end do
    value = c(:, n)
    first = 0.0_wp
    second = 0.0_wp
    do k = n - 1, 1, -1
      second = second*(x(1) - x(k)) + 2.0_wp*first
      first = first*(x(1) - x(k)) + value
      value = value*(x(1) - x(k)) + c(:, k)
    end do
    row = first_row(equations, i)
    call add(equations, row, i, 1.0_wp, 0.0_wp)
    call add(equations, row + 1, i, 0.0_wp, 1.0_wp)
    equations%right(row, :) = first
    equations%right(row + 1, :) = second
  end subroutine fix_end

  !> Coefficients of a piece from its ends (Hermite's form).
  pure subroutine find_piece(h, first, last, c)
    real(wp), intent(in) :: h               !< length of the piece
    real(wp), intent(in) :: first(3, 0:2)   !< its beginning, with two derivatives
    real(wp), intent(in) :: last(3, 0:2)    !< its end, with two derivatives
    real(wp), intent(out) :: c(0:5, 3)      !< (0:5,3) coefficients of the powers of the part of h
    real(wp), dimension(3) :: rise, first0, first1, second0, second1

    first0 = h*first(:, 1)
    first1 = h*last(:, 1)
    second0 = h**2*first(:, 2)
    second1 = h**2*last(:, 2)
    rise = last(:, 0) - first(:, 0)
    c(0, :) = first(:, 0)
    c(1, :) = first0
    c(2, :) = 0.5_wp*second0
    c(3, :) = 10.0_wp*rise - 6.0_wp*first0 - 4.0_wp*first1 - 1.5_wp*second0 + 0.5_wp*second1
    c(4, :) = -15.0_wp*rise + 8.0_wp*first0 + 7.0_wp*first1 + 1.5_wp*second0 - second1
    c(5, :) = 6.0_wp*rise - 3.0_wp*(first0 + first1) - 0.5_wp*(second0 - second1)
  end subroutine find_piece

  !> A point of a piece, and three derivatives by the parameter.
  pure subroutine evaluate(self, piece, x, y, first, second, third)
    class(quintic_spline_type), intent(in) :: self   !< the spline
    integer, intent(in) :: piece                     !< number of the piece
    real(wp), intent(in) :: x                        !< parameter, in the piece or near it
    real(wp), intent(out) :: y(3)                    !< the point
    real(wp), intent(out) :: first(3)                !< first derivative
    real(wp), intent(out) :: second(3)               !< second derivative
    real(wp), intent(out) :: third(3)                !< third derivative
    real(wp) :: h, t, a(0:5)
    integer :: i

    h = self%x(piece + 1) - self%x(piece)
    t = (x - self%x(piece))/h
    do i = 1, 3
      a = self%c(:, i, piece)
      y(i) = a(0) + t*(a(1) + t*(a(2) + t*(a(3) + t*(a(4) + t*a(5)))))
      first(i) = (a(1) + t*(2.0_wp*a(2) + t*(3.0_wp*a(3) + t*(4.0_wp*a(4) + t*5.0_wp*a(5)))))/h
      second(i) = (2.0_wp*a(2) + t*(6.0_wp*a(3) + t*(12.0_wp*a(4) + t*20.0_wp*a(5))))/h**2
      third(i) = (6.0_wp*a(3) + t*(24.0_wp*a(4) + t*60.0_wp*a(5)))/h**3
    end do
  end subroutine evaluate

  !> The first derivative by the parameter alone.
  pure function velocity(self, piece, x) result(first)
    class(quintic_spline_type), intent(in) :: self   !< the spline
    integer, intent(in) :: piece                     !< number of the piece
    real(wp), intent(in) :: x                        !< parameter, in the piece or near it
    real(wp) :: first(3)
    real(wp) :: h, t
    integer :: i

    h = self%x(piece + 1) - self%x(piece)
    t = (x - self%x(piece))/h
    do i = 1, 3
      associate (b => self%c(1, i, piece), c => self%c(2, i, piece), d => self%c(3, i, piece), e => self%c(4, i, piece), &
                 f => self%c(5, i, piece))
        first(i) = (b + t*(2.0_wp*c + t*(3.0_wp*d + t*(4.0_wp*e + t*5.0_wp*f))))/h
      end associate
    end do
  end function velocity

  !> The fourth derivative by the parameter alone.
  pure function fourth_derivative(self, piece, x) result(fourth)
    class(quintic_spline_type), intent(in) :: self   !< the spline
    integer, intent(in) :: piece                     !< number of the piece
    real(wp), intent(in) :: x                        !< parameter, in the piece or near it
    real(wp) :: fourth(3)
    real(wp) :: h, t

    h = self%x(piece + 1) - self%x(piece)
    t = (x - self%x(piece))/h
    fourth = (24.0_wp*self%c(4, :, piece) + t*120.0_wp*self%c(5, :, piece))/h**4
  end function fourth_derivative
end module mech9_quintic_spline
