!> The polynomial through the rates at the last few positions. Uses kinds only.
!>
!> Where accelerations are not asked for it is cheaper to predict from several positions than to find them. Rates bring no
!> round-off into it that positions would.
module mech9_past_rates
  use mech9_kinds, only: wp
  implicit none
  private
  public :: past_rates_type, new_past_rates, forget_rates, take_rates

  !> Positions before the last one that are kept.
  integer, parameter :: most = 4
  !> Distances are the same within this part of the shortest.
  real(wp), parameter :: same = 1.0e-11_wp
  !> Of t, t^2, ... in the rates: t^2/2, t^3/3, ... in the coordinates, the first of these the acceleration.
  real(wp), parameter :: per_power(most) = [1.0_wp, 1.0_wp/3.0_wp, 0.25_wp, 0.2_wp]

  type :: past_rates_type
    integer :: count = 0                      !< rates that are kept
    integer :: latest = 0                     !< slot of the last ones; those before are in the slots before, in a ring
    real(wp) :: t(0:most) = 0.0_wp            !< [s]
    real(wp), allocatable :: dq(:, :)         !< (M,0:most)
    real(wp) :: nodes(0:most) = 0.0_wp        !< times less the latest, for which the weights were found
    real(wp) :: weights(most, 0:most) = 0.0_wp
  end type past_rates_type

contains

  !> Room for the rates of m coordinates.
  pure function new_past_rates(m) result(past)
    integer, intent(in) :: m
    type(past_rates_type) :: past

    allocate (past%dq(m, 0:most), source=0.0_wp)
  end function new_past_rates

  !> The past is not what comes now.
  pure subroutine forget_rates(past)
    type(past_rates_type), intent(inout) :: past

    past%count = 0
  end subroutine forget_rates

  !> Take the rates at time t, and give the polynomial of the coordinates about it: q + dq h + ddq h^2/2 + higher(:, 1)
  !> h^3 + higher(:, 2) h^4 + higher(:, 3) h^5. Without a past, what stands in `ddq` and `higher` is left.
  pure subroutine take_rates(past, t, dq, ddq, higher)
    type(past_rates_type), intent(inout) :: past
    real(wp), intent(in) :: t
    real(wp), intent(in) :: dq(:)             !< (M)
    real(wp), intent(inout) :: ddq(:)         !< (M)
    real(wp), intent(inout) :: higher(:, :)   !< (M,3)
    real(wp) :: nodes(0:most)
    integer :: slots(0:most), i, n

    n = min(past%count, most)
    past%count = n + 1
    past%latest = modulo(past%latest + 1, most + 1)
    past%t(past%latest) = t
    call copy(size(dq), dq, past%dq(:, past%latest))
    if (n == 0) return
    do i = 0, n
      slots(i) = modulo(past%latest - i, most + 1)
      nodes(i) = past%t(slots(i)) - t
    end do
    ! outputs mostly come at even distances, but for round-off
    if (any(abs(nodes(:n) - past%nodes(:n)) > same*abs(nodes(1)))) then
      call find_weights(n, nodes, past%weights)
      past%nodes = huge(1.0_wp)
      past%nodes(:n) = nodes(:n)
    end if
    if (n == most) then
      call combine_all(size(dq), past%weights, past%dq(:, slots(0)), past%dq(:, slots(1)), past%dq(:, slots(2)), &
                       past%dq(:, slots(3)), past%dq(:, slots(4)), ddq, higher)
    else
      call combine(size(dq), n, past%weights, slots, past%dq, ddq, higher)
    end if
  end subroutine take_rates

  pure subroutine copy(m, from, to)
    integer, intent(in) :: m
    real(wp), intent(in) :: from(m)
    real(wp), intent(out) :: to(m)

    to = from
  end subroutine copy

  !> weights(j, i): part of the rate at node i in the factor of t^(j+1), integrated.
  pure subroutine find_weights(n, nodes, weights)
    integer, intent(in) :: n                  !< nodes 0 .. n
    real(wp), intent(in) :: nodes(0:n)
    real(wp), intent(out) :: weights(most, 0:n)
    real(wp) :: product(0:most), denominator
    integer :: i, j, k, degree

    do i = 0, n
      product = 0.0_wp
      product(0) = 1.0_wp
      denominator = 1.0_wp
      degree = 0
      do k = 0, n
        if (k == i) cycle
        degree = degree + 1
        denominator = denominator*(nodes(i) - nodes(k))
        do j = degree, 1, -1
          product(j) = product(j - 1) - nodes(k)*product(j)
        end do
        product(0) = -nodes(k)*product(0)
      end do
      weights(:, i) = product(1:)*per_power/denominator
    end do
  end subroutine find_weights

  !> The factors for all coordinates.
  pure subroutine combine(m, n, weights, slots, dq, ddq, higher)
    integer, intent(in) :: m, n
    integer, intent(in) :: slots(0:n)
    real(wp), intent(in) :: weights(most, 0:n), dq(m, 0:most)
    real(wp), intent(out) :: ddq(m), higher(m, 3)
    real(wp) :: c(most)
    integer :: i, k

    do k = 1, m
      c = 0.0_wp
      do i = 0, n
        c = c + weights(:, i)*dq(k, slots(i))
      end do
      ddq(k) = c(1)
      higher(k, :) = c(2:)
    end do
  end subroutine combine

  !> The same from all that are kept, written out: the rule in the time loop.
  pure subroutine combine_all(m, w, a, b, c, d, e, ddq, higher)
    integer, intent(in) :: m
    real(wp), intent(in) :: w(most, 0:most)
    real(wp), dimension(m), intent(in) :: a, b, c, d, e      !< rates, the latest first
    real(wp), intent(out) :: ddq(m), higher(m, 3)
    integer :: k

    do k = 1, m
      ddq(k) = w(1, 0)*a(k) + w(1, 1)*b(k) + w(1, 2)*c(k) + w(1, 3)*d(k) + w(1, 4)*e(k)
      higher(k, 1) = w(2, 0)*a(k) + w(2, 1)*b(k) + w(2, 2)*c(k) + w(2, 3)*d(k) + w(2, 4)*e(k)
      higher(k, 2) = w(3, 0)*a(k) + w(3, 1)*b(k) + w(3, 2)*c(k) + w(3, 3)*d(k) + w(3, 4)*e(k)
      higher(k, 3) = w(4, 0)*a(k) + w(4, 1)*b(k) + w(4, 2)*c(k) + w(4, 3)*d(k) + w(4, 4)*e(k)
    end do
  end subroutine combine_all
end module mech9_past_rates
