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
  integer, parameter :: most = 3
  !> Distances are the same within this part of the shortest.
  real(wp), parameter :: same = 1.0e-11_wp
  !> Of t, t^2, ... in the rates: t^2/2, t^3/3, ... in the coordinates, the first of these the acceleration.
  real(wp), parameter :: per_power(most) = [1.0_wp, 1.0_wp/3.0_wp, 0.25_wp]

  type :: past_rates_type
    integer :: count = 0                      !< rates that are kept
    real(wp) :: t(0:most) = 0.0_wp            !< of these, the latest first [s]
    real(wp), allocatable :: dq(:, :)         !< (M,0:most)
    real(wp) :: nodes(0:most) = 0.0_wp        !< these times less the latest, for which the weights were found
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
  !> h^3 + higher(:, 2) h^4, and no term of h^5. Without a past, what stands in `ddq` and `higher` is left.
  pure subroutine take_rates(past, t, dq, ddq, higher)
    type(past_rates_type), intent(inout) :: past
    real(wp), intent(in) :: t
    real(wp), intent(in) :: dq(:)             !< (M)
    real(wp), intent(inout) :: ddq(:)         !< (M)
    real(wp), intent(inout) :: higher(:, :)   !< (M,3)
    real(wp) :: nodes(0:most)
    integer :: i, n

    do i = min(past%count, most), 1, -1
      past%t(i) = past%t(i - 1)
      past%dq(:, i) = past%dq(:, i - 1)
    end do
    past%t(0) = t
    past%dq(:, 0) = dq
    past%count = min(past%count + 1, most + 1)
    if (past%count == 1) return
    n = past%count - 1
    nodes = past%t - t
    ! outputs mostly come at even distances, but for round-off
    if (any(abs(nodes(:n) - past%nodes(:n)) > same*abs(nodes(1)))) then
      call find_weights(n, nodes, past%weights)
      past%nodes = huge(1.0_wp)
      past%nodes(:n) = nodes(:n)
    end if
    call combine(size(dq), n, past%weights, past%dq, ddq, higher)
  end subroutine take_rates

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
  pure subroutine combine(m, n, weights, dq, ddq, higher)
    integer, intent(in) :: m, n
    real(wp), intent(in) :: weights(most, 0:n), dq(m, 0:n)
    real(wp), intent(out) :: ddq(m), higher(m, 3)
    real(wp) :: c(most)
    integer :: i, k

    do k = 1, m
      c = 0.0_wp
      do i = 0, n
        c = c + weights(:, i)*dq(k, i)
      end do
      ddq(k) = c(1)
      higher(k, 1) = c(2)
      higher(k, 2) = c(3)
      higher(k, 3) = 0.0_wp
    end do
  end subroutine combine
end module mech9_past_rates
