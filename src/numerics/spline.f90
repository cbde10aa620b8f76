!> Cubic spline through points, with continuous second derivative.
module mech9_spline
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_spline_failures, only: failure_few_points, failure_points_order, failure_no_spline
  use mech9_lapack, only: dgtsv
  implicit none
  private
  public :: spline_type, build_spline, build_periodic_spline

  !> Piecewise cubic; on [x(i), x(i+1)] it is given by the values and second derivatives at the ends.
  type :: spline_type
    real(wp), allocatable :: x(:)        !< increasing
    real(wp), allocatable :: y(:)        !< values at x
    real(wp), allocatable :: second(:)   !< second derivatives at x
  contains
    procedure :: evaluate
    procedure :: steepest
    procedure :: integrate
    procedure, private :: piece
  end type spline_type

contains

  !> The spline through (x, y) whose third derivative is continuous at the second and the last but
  !> one point ("not a knot"), so that a cubic is reproduced exactly. Needs at least four points
  !> with increasing x.
  subroutine build_spline(x, y, spline, err)
    real(wp), intent(in) :: x(:)                        !< abscissae, increasing, at least four
    real(wp), intent(in) :: y(:)                        !< values at x
    type(spline_type), intent(out) :: spline            !< the curve
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: h(size(x) - 1), slope(size(x) - 1)
    real(wp) :: below(size(x) - 3), diagonal(size(x) - 2), above(size(x) - 3), right(size(x) - 2, 1)
    integer :: n, i, info

    n = size(x)
    if (n < 4) then
      call raise(err, exit_data, failure_few_points)
      err%failure%number = n
      return
    end if
    h = x(2:) - x(:n - 1)
    if (any(.not. h > 0.0_wp)) then
      i = findloc(h > 0.0_wp, .false., dim=1)
      call raise(err, exit_data, failure_points_order)
      err%failure%number = i
      return
    end if
    slope = (y(2:) - y(:n - 1))/h

    ! unknown: second derivatives at points 2 .. n-1; those at the ends follow from the condition there
    do i = 1, n - 2
      diagonal(i) = 2.0_wp*(h(i) + h(i + 1))
      right(i, 1) = 6.0_wp*(slope(i + 1) - slope(i))
    end do
    below = h(2:n - 2)
    above = h(2:n - 2)
    diagonal(1) = diagonal(1) + h(1)*(h(1) + h(2))/h(2)
    above(1) = above(1) - h(1)**2/h(2)
    diagonal(n - 2) = diagonal(n - 2) + h(n - 1)*(h(n - 1) + h(n - 2))/h(n - 2)
    below(n - 3) = below(n - 3) - h(n - 1)**2/h(n - 2)
    call dgtsv(n - 2, 1, below, diagonal, above, right, n - 2, info)
    if (info /= 0) then
      call raise(err, exit_data, failure_no_spline)
      return
    end if
    spline%x = x
    spline%y = y
    allocate (spline%second(n))
    spline%second(2:n - 1) = right(:, 1)
    spline%second(1) = right(1, 1) - (right(2, 1) - right(1, 1))*h(1)/h(2)
    spline%second(n) = right(n - 2, 1) + (right(n - 2, 1) - right(n - 3, 1))*h(n - 1)/h(n - 2)
  end subroutine build_spline

  !> The spline through (x, y) whose slope and second derivative are the same at both ends, so that it goes on smoothly where it
  !> repeats. The values at the ends may differ by a jump that each repetition adds. A cyclic system of three bands is one of three
  !> bands with a change of rank one (Sherman and Morrison). Needs at least four points with increasing x.
  subroutine build_periodic_spline(x, y, spline, err)
    real(wp), intent(in) :: x(:)                        !< abscissae, increasing, at least four; the last one ends the period
    real(wp), intent(in) :: y(:)                        !< values at x
    type(spline_type), intent(out) :: spline            !< the curve
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: h(0:size(x) - 1), slope(0:size(x) - 1)
    real(wp) :: below(size(x) - 2), diagonal(size(x) - 1), above(size(x) - 2), right(size(x) - 1, 2), part
    integer :: n, i, info

    call build_spline(x, y, spline, err)
    if (allocated(err)) return
    n = size(x) - 1
    h(1:) = x(2:) - x(:n)
    slope(1:) = (y(2:) - y(:n))/h(1:)
    h(0) = h(n)
    slope(0) = slope(n)
    do i = 1, n
      diagonal(i) = 2.0_wp*(h(i - 1) + h(i))
      right(i, 1) = 6.0_wp*(slope(i) - slope(i - 1))
    end do
    below = h(1:n - 1)
    above = h(1:n - 1)
    ! both corners h(n) of the cyclic matrix are in u v^T with u = (1, 0 .. 0, 1) h(n) and v = (1, 0 .. 0, 1)
    diagonal(1) = diagonal(1) - h(n)
    diagonal(n) = diagonal(n) - h(n)
    right(:, 2) = 0.0_wp
    right([1, n], 2) = h(n)
    call dgtsv(n, 2, below, diagonal, above, right, n, info)
    if (info /= 0) then
      call raise(err, exit_data, failure_no_spline)
      return
    end if
    part = (right(1, 1) + right(n, 1))/(1.0_wp + right(1, 2) + right(n, 2))
    spline%second(:n) = right(:, 1) - part*right(:, 2)
    spline%second(n + 1) = spline%second(1)
  end subroutine build_periodic_spline

  !> Value and first two derivatives at x; outside its points the end pieces are continued.
  pure subroutine evaluate(self, x, y, dy, ddy)
    class(spline_type), intent(in) :: self   !< the spline
    real(wp), intent(in) :: x                !< the abscissa
    real(wp), intent(out) :: y               !< value at x
    real(wp), intent(out) :: dy              !< first derivative at x
    real(wp), intent(out) :: ddy             !< second derivative at x
    integer :: low, high
    real(wp) :: h, a, b

    low = self%piece(x)
    high = low + 1
    h = self%x(high) - self%x(low)
    a = (self%x(high) - x)/h
    b = (x - self%x(low))/h
    associate (m0 => self%second(low), m1 => self%second(high), y0 => self%y(low), y1 => self%y(high))
      y = a*y0 + b*y1 + ((a**3 - a)*m0 + (b**3 - b)*m1)*h**2/6.0_wp
      dy = (y1 - y0)/h + ((3.0_wp*b**2 - 1.0_wp)*m1 - (3.0_wp*a**2 - 1.0_wp)*m0)*h/6.0_wp
      ddy = a*m0 + b*m1
    end associate
  end subroutine evaluate

  !> The integral of the spline from its first point, and the integral of this one.
  pure subroutine integrate(self, x, first, second)
    class(spline_type), intent(in) :: self   !< the spline
    real(wp), intent(in) :: x                !< the abscissa
    real(wp), intent(out) :: first           !< the integral
    real(wp), intent(out) :: second          !< the integral of the integral
    real(wp) :: h, a, b
    integer :: i, last

    first = 0.0_wp
    second = 0.0_wp
    last = self%piece(x)
    do i = 1, last
      h = self%x(i + 1) - self%x(i)
      b = 1.0_wp
      if (i == last) b = (x - self%x(i))/h
      a = 1.0_wp - b
      associate (m0 => self%second(i), m1 => self%second(i + 1), y0 => self%y(i), y1 => self%y(i + 1))
        second = second + b*h*first + h**2*(y0*(0.5_wp*b - (1.0_wp - a**3)/6.0_wp) + y1*b**3/6.0_wp &
                 + h**2/6.0_wp*(m0*((1.0_wp - a**3)/6.0_wp - (1.0_wp - a**5)/20.0_wp - 0.25_wp*b) &
                                + m1*(b**5/20.0_wp - b**3/6.0_wp)))
        first = first + h*(0.5_wp*y0*(1.0_wp - a**2) + 0.5_wp*y1*b**2 &
                + h**2/6.0_wp*(m0*(0.25_wp*(1.0_wp - a**4) - 0.5_wp*(1.0_wp - a**2)) + m1*(0.25_wp*b**4 - 0.5_wp*b**2)))
      end associate
    end do
  end subroutine integrate

  !> A bound of |dy/dx| for x between two values, from the slope and the bending of each piece there.
  pure real(wp) function steepest(self, from, to)
    class(spline_type), intent(in) :: self   !< the spline
    real(wp), intent(in) :: from             !< beginning of the interval of x
    real(wp), intent(in) :: to               !< its end, not before its beginning
    integer :: i
    real(wp) :: h

    steepest = 0.0_wp
    do i = self%piece(from), self%piece(to)
      h = self%x(i + 1) - self%x(i)
      steepest = max(steepest, abs(self%y(i + 1) - self%y(i))/h &
                     + h*(abs(self%second(i)) + abs(self%second(i + 1)))/3.0_wp)
    end do
  end function steepest

  !> Number of the piece in which x lies; the first or the last one for x outside.
  pure integer function piece(self, x) result(low)
    class(spline_type), intent(in) :: self   !< the spline
    real(wp), intent(in) :: x                !< the abscissa
    integer :: high, middle

    low = 1
    high = size(self%x)
    do while (high - low > 1)
      middle = (low + high)/2
      if (self%x(middle) > x) then
        high = middle
      else
        low = middle
      end if
    end do
  end function piece
end module mech9_spline
