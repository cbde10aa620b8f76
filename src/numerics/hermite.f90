!> Polynomials through points with two derivatives each, for many quantities at once.
module mech9_hermite
  use mech9_kinds, only: wp
  implicit none
  private
  public :: hermite_type, build_hermite, cubic_between

  !> Newton's form with every abscissa three times over.
  type :: hermite_type
    real(wp), allocatable :: x(:)      !< (3 points)
    real(wp), allocatable :: d(:, :)   !< (quantities, 3 points): divided differences
  contains
    procedure :: evaluate
    procedure :: first_at
  end type hermite_type

contains

  !> The polynomials of least degree that have these values and first two derivatives.
  pure subroutine build_hermite(x, y, dy, ddy, hermite)
    real(wp), intent(in) :: x(:)                 !< (points), all different
    real(wp), intent(in) :: y(:, :)              !< (quantities, points) values
    real(wp), intent(in) :: dy(:, :)             !< (quantities, points) first derivatives
    real(wp), intent(in) :: ddy(:, :)            !< (quantities, points) second derivatives
    type(hermite_type), intent(out) :: hermite   !< the polynomials
    integer :: i, j, n

    n = 3*size(x)
    allocate (hermite%x(n), hermite%d(size(y, 1), n))
    do i = 1, n
      hermite%x(i) = x((i + 2)/3)
      hermite%d(:, i) = y(:, (i + 2)/3)
    end do
    do j = 1, n - 1
      do i = n, j + 1, -1
        if ((i + 2)/3 /= (i - j + 2)/3) then
          hermite%d(:, i) = (hermite%d(:, i) - hermite%d(:, i - 1))/(hermite%x(i) - hermite%x(i - j))
        else if (j == 1) then
          hermite%d(:, i) = dy(:, (i + 2)/3)
        else
          hermite%d(:, i) = 0.5_wp*ddy(:, (i + 2)/3)
        end if
      end do
    end do
  end subroutine build_hermite

  !> Values and first two derivatives at x.
  pure subroutine evaluate(self, x, y, dy, ddy, points)
    class(hermite_type), intent(in) :: self   !< the polynomials
    real(wp), intent(in) :: x                 !< the abscissa
    real(wp), intent(out) :: y(:)             !< (quantities) values at x
    real(wp), intent(out) :: dy(:)            !< (quantities) first derivatives at x
    real(wp), intent(out) :: ddy(:)           !< (quantities) second derivatives at x
    integer, intent(in), optional :: points   !< of the polynomials through so many of the first points
    integer :: i, n

    n = size(self%x)
    if (present(points)) n = 3*points
    y = 0.0_wp
    dy = 0.0_wp
    ddy = 0.0_wp
    do i = n, 1, -1
      ddy = ddy*(x - self%x(i)) + 2.0_wp*dy
      dy = dy*(x - self%x(i)) + y
      y = y*(x - self%x(i)) + self%d(:, i)
    end do
  end subroutine evaluate

  !> Values of the first polynomial, or of a derivative of it, at several abscissas: by the operations of `evaluate`.
  pure subroutine first_at(self, x, order, values)
    class(hermite_type), intent(in) :: self   !< the polynomials
    real(wp), intent(in) :: x(:)              !< the abscissas
    integer, intent(in) :: order              !< 0 to 2: order of the derivative
    real(wp), intent(out) :: values(:)        !< at these abscissas
    real(wp), dimension(size(x)) :: y, dy, ddy
    integer :: i

    y = 0.0_wp
    dy = 0.0_wp
    ddy = 0.0_wp
    do i = size(self%x), 1, -1
      if (order > 1) ddy = ddy*(x - self%x(i)) + 2.0_wp*dy
      if (order > 0) dy = dy*(x - self%x(i)) + y
      y = y*(x - self%x(i)) + self%d(1, i)
    end do
    select case (order)
    case (0)
      values = y
    case (1)
      values = dy
    case default
      values = ddy
    end select
  end subroutine first_at

  !> The cubic polynomial with given values and derivatives at 0 and 1.
  pure real(wp) function cubic_between(start, slope, end, end_slope, x)
    real(wp), intent(in) :: start       !< value at 0
    real(wp), intent(in) :: slope       !< derivative at 0
    real(wp), intent(in) :: end         !< value at 1
    real(wp), intent(in) :: end_slope   !< derivative at 1
    real(wp), intent(in) :: x           !< from 0 to 1

    cubic_between = start + x*(slope + x*(3.0_wp*(end - start) - 2.0_wp*slope - end_slope &
                                          + x*(2.0_wp*(start - end) + slope + end_slope)))
  end function cubic_between
end module mech9_hermite
