!> Where a step of following starts from, and the prediction from there: by the polynomial through the last two
!> positions with their rates and accelerations, or, without accelerations, from the motion at the last few times.
!> Uses kinds, plan, state, past_motion.
module mech9_departure
  use mech9_kinds, only: wp
  use mech9_plan, only: block_type
  use mech9_state, only: state_type
  use mech9_past_motion, only: past_motion_type, new_past_motion, forget_motion, take_motion, judge_past, weigh_past, &
    predict_from_past, acceleration_from_past
  implicit none
  private
  public :: departure_type, new_departure, begin_at, depart_from, aim_at, predict, know_accelerations, acceleration_of

  !> A prediction uses the polynomial through two positions up to this many times their distance.
  real(wp), parameter :: longest_prediction = 3.0_wp
  !> The highest term of the polynomial is nothing but round-off below this.
  real(wp), parameter :: only_round_off = 64.0_wp*epsilon(1.0_wp)

  type :: departure_type
    real(wp) :: t = 0.0_wp                      !< [s]
    real(wp), allocatable :: q(:), dq(:)        !< (M)
    real(wp), allocatable :: ddq(:)             !< (M), where accelerations are known: see acceleration_of
    logical :: complete = .true.                !< accelerations are known
    logical :: uses_past = .false.              !< predictions are made from the past
    real(wp) :: before = 0.0_wp                 !< distance of the position accepted before it [s]
    real(wp), allocatable :: higher(:, :)       !< (M,3) factors of h^3, h^4, h^5 of the prediction
    type(past_motion_type) :: past              !< of the steps without accelerations
  end type departure_type

contains

  !> Room for m coordinates.
  pure function new_departure(m) result(departure)
    integer, intent(in) :: m
    type(departure_type) :: departure

    allocate (departure%q(m), departure%dq(m), departure%ddq(m), departure%higher(m, 3), source=0.0_wp)
    departure%past = new_past_motion(m)
  end function new_departure

  !> A place with nothing known before it; its accelerations are.
  pure subroutine begin_at(state, departure)
    type(state_type), intent(in) :: state
    type(departure_type), intent(inout) :: departure

    departure%t = state%t
    departure%q = state%q
    departure%dq = state%dq
    departure%ddq = state%ddq
    departure%complete = .true.
    departure%uses_past = .false.
    departure%before = 0.0_wp
    departure%higher = 0.0_wp
    call forget_motion(departure%past)
  end subroutine begin_at

  !> The next place, after a step from the last one.
  pure subroutine depart_from(state, unit_of, complete, correction, departure)
    type(state_type), intent(in) :: state
    real(wp), intent(in) :: unit_of(:)          !< (M)
    logical, intent(in) :: complete             !< its accelerations are known
    real(wp), intent(in) :: correction          !< of the prediction, in units of the coordinates
    type(departure_type), intent(inout) :: departure
    real(wp) :: h
    integer :: k

    h = state%t - departure%t
    if (complete) then
      do k = 1, size(departure%q)
        departure%ddq(k) = acceleration_of(departure, k)
      end do
      call forget_motion(departure%past)
      call extrapolate(size(state%q), h, unit_of, state%q, state%dq, state%ddq, departure%q, departure%dq, departure%ddq, &
                       departure%higher)
    else
      if (departure%past%count == 0) call take_motion(departure%past, departure%t, departure%q, departure%dq)
      call take_motion(departure%past, state%t, state%q, state%dq)
      if (departure%uses_past) call judge_past(departure%past, abs(h), correction)
      call go_there(size(state%q), state%q, state%dq, departure%q, departure%dq)
    end if
    departure%t = state%t
    departure%complete = complete
    departure%uses_past = .not. complete
    departure%before = abs(h)
  end subroutine depart_from

  !> Prepare predictions for a time other than that of the departure.
  pure subroutine aim_at(t, departure)
    real(wp), intent(in) :: t                   !< [s]
    type(departure_type), intent(inout) :: departure

    if (departure%uses_past) call weigh_past(departure%past, t - departure%t)
  end subroutine aim_at

  !> Polynomial prediction of a block's dependent coordinates, for the time that was aimed at.
  pure subroutine predict(block, departure, state)
    type(block_type), intent(in) :: block
    type(departure_type), intent(in) :: departure
    type(state_type), intent(inout) :: state
    real(wp) :: h, near

    if (departure%uses_past) then
      call predict_from_past(departure%past, block%coordinates, state%q)
      return
    end if
    h = state%t - departure%t
    ! far beyond two positions that are close together their round-off would be all there is
    near = 0.0_wp
    if (abs(h) <= longest_prediction*departure%before) near = h
    call follow_polynomial(size(block%coordinates), block%coordinates, size(state%q), h, near, departure%q, departure%dq, &
                           departure%ddq, departure%higher, state%q)
  end subroutine predict

  !> The accelerations at the place have been found.
  pure subroutine know_accelerations(ddq, departure)
    real(wp), intent(in) :: ddq(:)              !< (M)
    type(departure_type), intent(inout) :: departure

    departure%ddq = ddq
    departure%complete = .true.
  end subroutine know_accelerations

  !> Acceleration of a coordinate at the place: as found, or else by the polynomial through the last rates.
  pure real(wp) function acceleration_of(departure, k) result(ddq)
    type(departure_type), intent(in) :: departure
    integer, intent(in) :: k                    !< number of the coordinate

    if (departure%complete) then
      ddq = departure%ddq(k)
    else
      ddq = acceleration_from_past(departure%past, k)
    end if
  end function acceleration_of

  ! Over arrays of known shape: the compiler then keeps their addresses in registers.

  !> Positions and rates of the place.
  pure subroutine go_there(m, q, dq, place_q, place_dq)
    integer, intent(in) :: m
    real(wp), intent(in) :: q(m), dq(m)
    real(wp), intent(out) :: place_q(m), place_dq(m)
    integer :: k

    do k = 1, m
      place_q(k) = q(k)
      place_dq(k) = dq(k)
    end do
  end subroutine go_there

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
