!> The predictor: the position accepted last and the prediction of the next one, by the polynomial through the last two
!> positions with their rates and accelerations (Hermite's) or, without accelerations, from the motion at the last few times.
module mech9_predictor
  use mech9_kinds, only: wp
  use mech9_tracking_tolerances, only: longest_prediction, round_off_term
  use mech9_plan, only: block_type
  use mech9_state, only: state_type
  use mech9_past_motion, only: past_motion_type, new_past_motion, clear_past, add_to_past, choose_formula, find_weights, &
    predict_from_past, acceleration_from_past
  implicit none
  private
  public :: predictor_type, new_predictor, begin_prediction, add_position, prepare_prediction, predict, set_accelerations, &
    acceleration_of


  !> The position accepted last, and all that a prediction needs.
  type :: predictor_type
    real(wp) :: t = 0.0_wp                      !< time of the position accepted last [s]
    real(wp), allocatable :: q(:)               !< (M) coordinates there [rad, m]
    real(wp), allocatable :: dq(:)              !< (M) rates there
    real(wp), allocatable :: ddq(:)             !< (M) accelerations there, valid where `complete`; see acceleration_of
    logical :: complete = .true.                !< the accelerations are known
    logical :: uses_past = .false.              !< predictions are made from the motion at the last few times
    real(wp) :: before = 0.0_wp                 !< time between this position and the one accepted before it [s]
    real(wp), allocatable :: higher(:, :)       !< (M,3) factors of h^3, h^4, h^5 of the polynomial
    type(past_motion_type) :: past              !< motion at the last times, of steps without accelerations
  end type predictor_type

contains

  !> A predictor of m coordinates, with no position yet.
  pure function new_predictor(m) result(predictor)
    integer, intent(in) :: m   !< number of coordinates
    type(predictor_type) :: predictor

    allocate (predictor%q(m), predictor%dq(m), predictor%ddq(m), predictor%higher(m, 3), source=0.0_wp)
    predictor%past = new_past_motion(m)
  end function new_predictor

  !> Begin at a position with its rates and accelerations; nothing is known of the motion before it.
  pure subroutine begin_prediction(state, predictor)
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(predictor_type), intent(inout) :: predictor   !< the predictor

    predictor%t = state%t
    predictor%q = state%q
    predictor%dq = state%dq
    predictor%ddq = state%ddq
    predictor%complete = .true.
    predictor%uses_past = .false.
    predictor%before = 0.0_wp
    predictor%higher = 0.0_wp
    call clear_past(predictor%past)
  end subroutine begin_prediction

  !> Take the position at the end of an accepted step.
  pure subroutine add_position(state, unit_of, complete, correction, predictor)
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    real(wp), intent(in), contiguous :: unit_of(:)   !< (M) units of the coordinates
    logical, intent(in) :: complete             !< its accelerations are known
    real(wp), intent(in) :: correction          !< largest correction of the prediction, in units of the coordinates
    type(predictor_type), intent(inout) :: predictor   !< the predictor
    real(wp) :: h
    integer :: k, m

    h = state%t - predictor%t
    m = size(state%q)
    if (complete) then
      if (.not. predictor%complete) then
        do k = 1, size(predictor%q)
          predictor%ddq(k) = acceleration_from_past(predictor%past, k)
        end do
      end if
      call clear_past(predictor%past)
      call fit_polynomial(state%q, state%dq, state%ddq, predictor%q, predictor%dq, predictor%ddq, predictor%higher)
    else
      if (predictor%past%count == 0) call add_to_past(predictor%past, predictor%t, predictor%q, predictor%dq)
      call add_to_past(predictor%past, state%t, state%q, state%dq)
      if (predictor%uses_past) call choose_formula(predictor%past, abs(h), correction)
      call copy_motion(state%q, state%dq, predictor%q, predictor%dq)
    end if
    predictor%t = state%t
    predictor%complete = complete
    predictor%uses_past = .not. complete
    predictor%before = abs(h)

    ! the procedures below work on arrays of explicit shape, whose addresses the compiler keeps in registers

  contains

    !> Copy positions and rates.
    pure subroutine copy_motion(q, dq, place_q, place_dq)
      real(wp), dimension(m), intent(in) :: q           !< coordinates [rad, m]
      real(wp), dimension(m), intent(in) :: dq          !< their rates
      real(wp), dimension(m), intent(out) :: place_q    !< copy of the coordinates
      real(wp), dimension(m), intent(out) :: place_dq   !< copy of their rates
      integer :: i

      do i = 1, m
        place_q(i) = q(i)
        place_dq(i) = dq(i)
      end do
    end subroutine copy_motion

    !> The polynomial through two positions at distance h, about the later one: its terms of third to fifth
    !> order. The later position replaces the earlier one.
    pure subroutine fit_polynomial(q, dq, ddq, last_q, last_dq, last_ddq, higher)
      real(wp), dimension(m), intent(in) :: q             !< coordinates at the later position [rad, m]
      real(wp), dimension(m), intent(in) :: dq            !< rates there
      real(wp), dimension(m), intent(in) :: ddq           !< accelerations there
      real(wp), dimension(m), intent(inout) :: last_q     !< coordinates at the earlier position, then at the later one
      real(wp), dimension(m), intent(inout) :: last_dq    !< rates at the earlier position, then at the later one
      real(wp), dimension(m), intent(inout) :: last_ddq   !< accelerations at the earlier position, then at the later one
      real(wp), intent(out) :: higher(m, 3)               !< factors of h^3, h^4, h^5 about the later position
      real(wp) :: d0, d1, d2, x, y, z, x_without, y_without, part, per_h, per_cube
      integer :: i

      per_h = 1.0_wp/h
      per_cube = per_h**3
      ! without a branch, so that the compiler can compute several at once
      do i = 1, m
        ! the terms at h
        d0 = last_q(i) - (q(i) - h*(dq(i) - 0.5_wp*h*ddq(i)))
        d1 = h*(last_dq(i) - dq(i) + h*ddq(i))
        d2 = h**2*(last_ddq(i) - ddq(i))
        x = -(10.0_wp*d0 + 4.0_wp*d1 + 0.5_wp*d2)
        z = x + d1 + 4.0_wp*d0
        y = d0 + x + z
        ! the polynomial goes without the positions where its last term is only their round-off: `part` is 0 there, and 1 elsewhere
        part = 0.5_wp + sign(0.5_wp, abs(z) - round_off_term*max(unit_of(i), abs(q(i))))
        x_without = d1 + (1.0_wp/3.0_wp)*d2
        y_without = 0.25_wp*d2 + 0.5_wp*d1
        higher(i, 1) = (x_without + part*(x - x_without))*per_cube
        higher(i, 2) = (y_without + part*(y - y_without))*per_cube*per_h
        higher(i, 3) = part*z*per_cube*per_h**2
        last_q(i) = q(i)
        last_dq(i) = dq(i)
        last_ddq(i) = ddq(i)
      end do
    end subroutine fit_polynomial
  end subroutine add_position

  !> Prepare predictions for a time other than that of the last position.
  pure subroutine prepare_prediction(t, predictor)
    real(wp), intent(in) :: t                   !< time to predict for [s]
    type(predictor_type), intent(inout) :: predictor   !< the predictor

    if (predictor%uses_past) call find_weights(predictor%past, t - predictor%t)
  end subroutine prepare_prediction

  !> Predict a block's dependent coordinates at the time in `state`, for which predictions were prepared.
  pure subroutine predict(block, predictor, state)
    type(block_type), intent(in) :: block   !< the block
    type(predictor_type), intent(in) :: predictor   !< the predictor
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    real(wp) :: h, near
    integer :: m

    if (predictor%uses_past) then
      call predict_from_past(predictor%past, block%coordinates, state%q)
      return
    end if
    h = state%t - predictor%t
    ! far beyond two positions that are close together the higher terms would be only the round-off of these positions
    near = 0.0_wp
    if (abs(h) <= longest_prediction*predictor%before) near = h
    m = size(state%q)
    call evaluate_polynomial(predictor%q, predictor%dq, predictor%ddq, predictor%higher, state%q)

  contains

    !> The polynomial at time h, with its higher terms at time `near`. Arrays have explicit shapes, as above.
    pure subroutine evaluate_polynomial(q, dq, ddq, higher, q_then)
      real(wp), intent(in) :: q(m)              !< coordinates at the last position [rad, m]
      real(wp), intent(in) :: dq(m)             !< rates there
      real(wp), intent(in) :: ddq(m)            !< accelerations there
      real(wp), intent(in) :: higher(m, 3)      !< factors of h^3, h^4, h^5
      real(wp), intent(inout) :: q_then(m)      !< gets the predicted coordinates [rad, m]
      integer :: i, k

      do i = 1, size(block%coordinates)
        k = block%coordinates(i)
        q_then(k) = q(k) + h*(dq(k) + h*(0.5_wp*ddq(k) + near*(higher(k, 1) + near*(higher(k, 2) + near*higher(k, 3)))))
      end do
    end subroutine evaluate_polynomial
  end subroutine predict

  !> Take the accelerations at the last position, which have been found after it was accepted.
  pure subroutine set_accelerations(ddq, predictor)
    real(wp), intent(in) :: ddq(:)              !< (M) accelerations [rad/s^2, m/s^2]
    type(predictor_type), intent(inout) :: predictor   !< the predictor

    predictor%ddq = ddq
    predictor%complete = .true.
  end subroutine set_accelerations

  !> Acceleration of a coordinate at the last position: exact where it is known, else from the polynomial through the last rates.
  pure real(wp) function acceleration_of(predictor, k) result(ddq)
    type(predictor_type), intent(in) :: predictor   !< the predictor
    integer, intent(in) :: k                    !< number of the coordinate

    if (predictor%complete) then
      ddq = predictor%ddq(k)
    else
      ddq = acceleration_from_past(predictor%past, k)
    end if
  end function acceleration_of
end module mech9_predictor
