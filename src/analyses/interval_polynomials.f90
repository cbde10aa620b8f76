!> Columns of results in an interval between outputs, by polynomials with two derivatives at outputs; and extremes at its ends.
module mech9_interval_polynomials
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type
  use mech9_hermite, only: hermite_type, build_hermite, cubic_between
  implicit none
  private
  public :: polynomial, values_between, changes_between, changes_at, moved_with
  public :: by_positions, by_rates, by_accelerations, best_known, value_between

  !> An extreme within this part of an interval from its end is at the end.
  real(wp), parameter :: end_of_interval = 1.0e-12_wp

  !> From what a column between two outputs is known: a polynomial through positions, rates and accelerations, or through the last two, or
  !> through accelerations alone.
  integer, parameter :: by_positions = 0, by_rates = 1, by_accelerations = 2
  !> A polynomial through four outputs enlarges some units of round-off in its values by no more in its first and second derivative, over
  !> the length of its interval, and one of third degree in its first.
  real(wp), parameter :: enlarged(2) = [256.0_wp, 8192.0_wp], enlarged_by_cubic = 64.0_wp
  !> A column is a straight line, but for 1e-9 of what it changes in other intervals, in one that is shorter than this part of the longest.
  real(wp), parameter :: hardly_any = 1.0e-4_wp

contains

  !> The polynomial through outputs with two derivatives each.
  pure subroutine polynomial(t, y, hermite)
    real(wp), intent(in) :: t(:)                 !< (outputs) times [s]
    real(wp), intent(in) :: y(0:, :)             !< (0:2,outputs) position, rate and acceleration
    type(hermite_type), intent(out) :: hermite   !< the polynomial

    call build_hermite(t, y(0:0, :), y(1:1, :), y(2:2, :), hermite)
  end subroutine polynomial

  !> Values of a polynomial, or of a derivative of it, at the points of an interval.
  pure subroutine values_between(hermite, from, to, rule, order, values)
    type(hermite_type), intent(in) :: hermite   !< the polynomial
    real(wp), intent(in) :: from                !< beginning of the interval [s]
    real(wp), intent(in) :: to                  !< end of the interval [s]
    type(chebyshev_type), intent(in) :: rule    !< its points
    integer, intent(in) :: order                !< 0 to 2: order of the derivative
    real(wp), intent(out) :: values(:)          !< (rule%n) at the points

    call hermite%first_at(from + 0.5_wp*(to - from)*(1.0_wp + rule%points), order, values)
  end subroutine values_between

  !> Values of several polynomials, or of derivatives of them in time, at the points of an interval.
  pure subroutine changes_between(hermite, from, to, rule, order, changes)
    type(hermite_type), intent(in) :: hermite   !< the polynomials
    real(wp), intent(in) :: from                !< beginning of the interval [s]
    real(wp), intent(in) :: to                  !< end of the interval [s]
    type(chebyshev_type), intent(in) :: rule    !< its points
    integer, intent(in) :: order                !< 0 to 2: order of the derivative
    real(wp), intent(out) :: changes(:, :)      !< (polynomials,rule%n) at the points
    integer :: i

    do i = 1, rule%n
      call changes_at(hermite, from + 0.5_wp*(to - from)*(1.0_wp + rule%points(i)), order, changes(:, i))
    end do
  end subroutine changes_between

  !> Values of several polynomials, or of derivatives of them in time, at a time.
  pure subroutine changes_at(hermite, t, order, changes)
    type(hermite_type), intent(in) :: hermite   !< the polynomials
    real(wp), intent(in) :: t                   !< the time [s]
    integer, intent(in) :: order                !< 0 to 2: order of the derivative
    real(wp), intent(out) :: changes(:)         !< (polynomials) at this time
    real(wp), dimension(size(changes)) :: y, dy, ddy

    call hermite%evaluate(t, y, dy, ddy)
    select case (order)
    case (0)
      changes = y
    case (1)
      changes = dy
    case default
      changes = ddy
    end select
  end subroutine changes_at

  !> From what a rate or an acceleration between two outputs is known best. Round-off of positions, and of times, is divided by the length of the
  !> interval, or by its square: in a short one, polynomials that use less are as exact and have less of it.
  pure integer function best_known(rule, t, longest, order, a, b, values) result(known)
    type(chebyshev_type), intent(in) :: rule    !< points in the interval
    real(wp), intent(in) :: t(2)                !< its ends [s]
    real(wp), intent(in) :: longest             !< length of the longest interval so far [s]
    integer, intent(in) :: order                !< of the column: 1 rate, 2 acceleration
    real(wp), intent(in) :: a(0:)               !< (0:2) position, rate and acceleration at its beginning
    real(wp), intent(in) :: b(0:)               !< (0:2) the same at its end
    real(wp), intent(in) :: values(:)           !< (rule%n) at the points by positions
    real(wp) :: round_off, h, better(rule%n), best(rule%n), x(rule%n)
    integer :: i

    known = by_positions
    if (order == 0) return
    h = t(2) - t(1)
    known = order
    if (abs(h) <= hardly_any*longest) return
    known = by_positions
    round_off = enlarged(order)*epsilon(h)/abs(h)**order*(max(abs(a(0)), abs(b(0))) + maxval(abs(t))*max(abs(a(1)), abs(b(1))))
    x = 0.5_wp*(1.0_wp + rule%points)
    better = [(value_between(by_rates, order, h, x(i), a, b), i=1, rule%n)]
    if (maxval(abs(values - better)) > round_off) return
    known = by_rates
    if (order == 1) return
    best = [(value_between(by_accelerations, order, h, x(i), a, b), i=1, rule%n)]
    round_off = enlarged_by_cubic*epsilon(h)/abs(h)*(max(abs(a(1)), abs(b(1))) + maxval(abs(t))*max(abs(a(2)), abs(b(2))))
    if (maxval(abs(better - best)) <= round_off) known = by_accelerations
  end function best_known

  !> A rate or an acceleration between two outputs that is known by rates or by accelerations.
  pure real(wp) function value_between(known, order, h, x, a, b) result(value)
    integer, intent(in) :: known     !< by_rates or by_accelerations
    integer, intent(in) :: order     !< of the column: 1 rate, 2 acceleration
    real(wp), intent(in) :: h        !< length of the interval [s]
    real(wp), intent(in) :: x        !< part of it, 0 to 1
    real(wp), intent(in) :: a(0:)    !< (0:2) position, rate and acceleration at its beginning
    real(wp), intent(in) :: b(0:)    !< (0:2) the same at its end
    real(wp) :: mean

    if (order == 1) then
      value = cubic_between(a(1), h*a(2), b(1), h*b(2), x)
    else
      value = a(2) + x*(b(2) - a(2))
      if (known == by_accelerations) return
      ! the mean of the accelerations is known by the rates, too
      mean = (b(1) - a(1))/h
      value = value + 6.0_wp*x*(1.0_wp - x)*(mean - 0.5_wp*(a(2) + b(2)))
    end if
  end function value_between

  !> The change of an extreme with the time of a joint, where it lies there.
  pure function moved_with(rate, slope, t, joint, other) result(moved)
    real(wp), intent(in) :: rate(:)  !< (P) derivatives of the time of the joint
    real(wp), intent(in) :: slope    !< of the column at the joint [1/s]
    real(wp), intent(in) :: t        !< time of the extreme [s]
    real(wp), intent(in) :: joint    !< time of one end of the interval, which is at the joint [s]
    real(wp), intent(in) :: other    !< time of its other end [s]
    real(wp) :: moved(size(rate))

    moved = 0.0_wp
    ! times of points in an interval have its round-off
    if (abs(t - joint) <= end_of_interval*abs(other - joint) + 4.0_wp*spacing(joint)) moved = slope*rate
  end function moved_with
end module mech9_interval_polynomials
