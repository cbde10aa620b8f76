!> Columns of results in an interval between outputs, by polynomials with two derivatives at outputs; and extremes at its ends.
module mech9_interval_polynomials
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type
  use mech9_hermite, only: hermite_type, build_hermite
  implicit none
  private
  public :: polynomial, values_between, changes_between, changes_at, moved_with

  !> An extreme within this part of an interval from its end is at the end.
  real(wp), parameter :: end_of_interval = 1.0e-12_wp

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
