!> Polynomials by their values at Chebyshev's points of an interval: integrals, derivatives, values between the points, extremes.
module mech9_chebyshev
  use mech9_kinds, only: wp, pi
  implicit none
  private
  public :: chebyshev_type, new_chebyshev

  type :: chebyshev_type
    integer :: n = 0                             !< number of points
    real(wp), allocatable :: points(:)           !< (n) from -1 to 1, both included
    real(wp), allocatable :: weights(:)          !< (n) of the integral from -1 to 1 (Clenshaw and Curtis)
    real(wp), allocatable :: barycentric(:)      !< (n) weights of the values in the barycentric formula
    real(wp), allocatable :: derivative(:, :)    !< (n,n) leads from values to derivatives at the points
  contains
    procedure :: value_at
    procedure :: zero_between
  end type chebyshev_type

contains

  !> The rule with n points, 2 or more.
  pure subroutine new_chebyshev(n, rule)
    integer, intent(in) :: n                    !< number of points
    type(chebyshev_type), intent(out) :: rule   !< its points and weights
    integer :: i, j

    rule%n = n
    allocate (rule%points(n), rule%weights(n), rule%barycentric(n), rule%derivative(n, n))
    do i = 1, n
      rule%points(i) = sin(pi*(2*i - n - 1)/(2.0_wp*(n - 1)))
      rule%barycentric(i) = merge(1.0_wp, -1.0_wp, mod(i, 2) == 0)
    end do
    rule%barycentric([1, n]) = 0.5_wp*rule%barycentric([1, n])
    do i = 1, n
      rule%weights(i) = 1.0_wp
      do j = 1, (n - 1)/2
        rule%weights(i) = rule%weights(i) - merge(1.0_wp, 2.0_wp, 2*j == n - 1)*cos(2.0_wp*pi*j*(i - 1)/(n - 1))/(4*j**2 - 1)
      end do
      rule%weights(i) = rule%weights(i)*merge(1.0_wp, 2.0_wp, i == 1 .or. i == n)/(n - 1)
      rule%derivative(i, i) = 0.0_wp
      do j = 1, n
        if (j == i) cycle
        rule%derivative(i, j) = rule%barycentric(j)/(rule%barycentric(i)*(rule%points(i) - rule%points(j)))
        rule%derivative(i, i) = rule%derivative(i, i) - rule%derivative(i, j)
      end do
    end do
  end subroutine new_chebyshev

  !> The polynomial through values at the points.
  pure real(wp) function value_at(self, values, x)
    class(chebyshev_type), intent(in) :: self   !< the rule
    real(wp), intent(in) :: values(:)           !< (n) at the points
    real(wp), intent(in) :: x                   !< from -1 to 1
    real(wp) :: above, below, weight
    integer :: i

    above = 0.0_wp
    below = 0.0_wp
    do i = 1, self%n
      if (.not. abs(x - self%points(i)) > 0.0_wp) then
        value_at = values(i)
        return
      end if
      weight = self%barycentric(i)/(x - self%points(i))
      above = above + weight*values(i)
      below = below + weight
    end do
    value_at = above/below
  end function value_at

  !> The zero between two neighbouring points at which the values have different signs.
  pure real(wp) function zero_between(self, values, i) result(x)
    class(chebyshev_type), intent(in) :: self   !< the rule
    real(wp), intent(in) :: values(:)           !< (n) at the points
    integer, intent(in) :: i                    !< number of the first of the two points
    real(wp) :: a, b, at_a, at_b, at_x
    integer :: pass

    a = self%points(i)
    b = self%points(i + 1)
    at_a = values(i)
    at_b = values(i + 1)
    x = a
    do pass = 1, 60
      ! false position; the value of an end that stays is halved, so that both ends move
      x = (a*at_b - b*at_a)/(at_b - at_a)
      at_x = self%value_at(values, x)
      if (abs(b - a) <= 4.0_wp*epsilon(x) .or. .not. abs(at_x) > 0.0_wp) return
      if (at_x*at_b < 0.0_wp) then
        a = b
        at_a = at_b
      else
        at_a = 0.5_wp*at_a
      end if
      if (abs(x - b) <= 2.0_wp*epsilon(x)) return
      b = x
      at_b = at_x
    end do
  end function zero_between
end module mech9_chebyshev
