!> Where a step of following starts from, and the prediction from there: by the polynomial through the last two
!> positions with their rates and accelerations, or, without accelerations, through the last rates.
!> Uses kinds, plan, state, past_rates.
module mech9_departure
  use mech9_kinds, only: wp
  use mech9_plan, only: block_type
  use mech9_state, only: state_type
  use mech9_past_rates, only: past_rates_type, new_past_rates, forget_rates, take_rates
  implicit none
  private
  public :: departure_type, new_departure, begin_at, depart_from, predict

  !> A prediction uses the polynomial through two positions up to this many times their distance.
  real(wp), parameter :: longest_prediction = 3.0_wp
  !> The highest term of the polynomial is nothing but round-off below this.
  real(wp), parameter :: only_round_off = 64.0_wp*epsilon(1.0_wp)
  type :: departure_type
    real(wp) :: t = 0.0_wp                      !< [s]
    real(wp), allocatable :: q(:), dq(:), ddq(:)   !< (M); without accelerations `ddq` is that of the polynomial
    real(wp) :: before = 0.0_wp                 !< distance of the position accepted before it [s]
    real(wp), allocatable :: higher(:, :)       !< (M,3) factors of h^3, h^4, h^5 of the prediction
    type(past_rates_type) :: past               !< without accelerations predictions are made from it
  end type departure_type

contains

  !> Room for m coordinates.
  pure function new_departure(m) result(departure)
    integer, intent(in) :: m
    type(departure_type) :: departure

    allocate (departure%q(m), departure%dq(m), departure%ddq(m), departure%higher(m, 3), source=0.0_wp)
    departure%past = new_past_rates(m)
  end function new_departure

  !> A place with nothing known before it; its accelerations are.
  pure subroutine begin_at(state, departure)
    type(state_type), intent(in) :: state
    type(departure_type), intent(inout) :: departure

    departure%t = state%t
    departure%q = state%q
    departure%dq = state%dq
    departure%ddq = state%ddq
    departure%before = 0.0_wp
    departure%higher = 0.0_wp
    call forget_rates(departure%past)
  end subroutine begin_at

  !> The next place, after a step from the last one.
  pure subroutine depart_from(state, unit_of, complete, departure)
    type(state_type), intent(in) :: state
    real(wp), intent(in) :: unit_of(:)          !< (M)
    logical, intent(in) :: complete             !< its accelerations are known
    type(departure_type), intent(inout) :: departure
    real(wp) :: h

    h = state%t - departure%t
    if (complete) then
      call forget_rates(departure%past)
      call extrapolate(size(state%q), h, unit_of, state%q, state%dq, state%ddq, departure%q, departure%dq, departure%ddq, &
                       departure%higher)
    else
      call take_rates(departure%past, state%t, state%dq, departure%ddq, departure%higher)
      departure%q = state%q
      departure%dq = state%dq
    end if
    departure%t = state%t
    departure%before = abs(h)
  end subroutine depart_from

  !> Polynomial prediction of a block's dependent coordinates.
  pure subroutine predict(block, departure, state)
    type(block_type), intent(in) :: block
    type(departure_type), intent(in) :: departure
    type(state_type), intent(inout) :: state
    real(wp) :: h, near

    h = state%t - departure%t
    ! far beyond two positions that are close together their round-off would be all there is
    near = 0.0_wp
    if (abs(h) <= longest_prediction*departure%before) near = h
    call follow_polynomial(size(block%coordinates), block%coordinates, size(state%q), h, near, departure%q, departure%dq, &
                           departure%ddq, departure%higher, state%q)
  end subroutine predict

  ! Over arrays of known shape: the compiler then keeps their addresses in registers.

  !> The polynomial of some coordinates at time h, its higher terms at time `near`.
  pure subroutine follow_polynomial(n, coordinates, m, h, near, q, dq, ddq, higher, q_then)
    integer, intent(in) :: n, coordinates(n), m
    real(wp), intent(in) :: h, near, q(m), dq(m), ddq(m), higher(m, 3)
    real(wp), intent(inout) :: q_then(m)
    integer :: i, k

    do i = 1, n
      k = coordinates(i)
      q_then(k) = q(k) + h*(dq(k) + h*(0.5_wp*ddq(k) + near*(higher(k, 1) + near*(higher(k, 2) + near*higher(k, 3)))))
    end do
  end subroutine follow_polynomial

  !> The polynomial through two positions at distance h, about the later one: its terms of third to fifth
  !> order. The later position takes the place of the earlier one.
  pure subroutine extrapolate(m, h, unit_of, q, dq, ddq, last_q, last_dq, last_ddq, higher)
    integer, intent(in) :: m
    real(wp), intent(in) :: h
    real(wp), dimension(m), intent(in) :: unit_of, q, dq, ddq
    real(wp), dimension(m), intent(inout) :: last_q, last_dq, last_ddq
    real(wp), intent(out) :: higher(m, 3)
    real(wp) :: d0, d1, d2, x, y, z, per_h, per_cube
    logical :: is_noise
    integer :: k

    per_h = 1.0_wp/h
    per_cube = per_h**3
    do k = 1, m
      ! the terms at h
      d0 = last_q(k) - (q(k) - h*(dq(k) - 0.5_wp*h*ddq(k)))
      d1 = h*(last_dq(k) - dq(k) + h*ddq(k))
      d2 = h**2*(last_ddq(k) - ddq(k))
      x = -(10.0_wp*d0 + 4.0_wp*d1 + 0.5_wp*d2)
      z = x + d1 + 4.0_wp*d0
      y = d0 + x + z
      ! without the positions, where their round-off is all there is to the last term
      is_noise = abs(z) <= only_round_off*max(unit_of(k), abs(q(k)))
      x = merge(d1 + (1.0_wp/3.0_wp)*d2, x, is_noise)
      y = merge(0.25_wp*d2 + 0.5_wp*d1, y, is_noise)
      z = merge(0.0_wp, z, is_noise)
      higher(k, 1) = x*per_cube
      higher(k, 2) = y*per_cube*per_h
      higher(k, 3) = z*per_cube*per_h**2
      last_q(k) = q(k)
      last_dq(k) = dq(k)
      last_ddq(k) = ddq(k)
    end do
  end subroutine extrapolate
end module mech9_departure
