!> Positions and rates at the last few times, and the prediction by the polynomial through them.
!>
!> A prediction from several times is cheaper than finding accelerations where these are not recorded. It is a weighted
!> sum of rates and positions, and the weights depend on the times alone: steps of equal length share them. Where steps are
!> short, the rates at the last five times predict to round-off. Where steps are long, positions and rates at the last four
!> times leave a smaller correction.
module mech9_past_motion
  use mech9_kinds, only: wp
  use mech9_tracking_tolerances, only: least_spacing, longest_prediction, same_spacing, worth_positions
  implicit none
  private
  public :: past_motion_type, new_past_motion, clear_past, add_to_past, choose_formula, find_weights, predict_from_past, &
    acceleration_from_past

  !> Number of times before the latest one that are kept, and number of those whose positions are used.
  integer, parameter :: most = 4, most_with_positions = 3

  !> The motion at the last times, in a ring of slots, and the weights of a prediction.
  type :: past_motion_type
    integer :: count = 0                      !< number of times that are kept
    integer :: latest = 0                     !< slot of the latest time; each earlier time is in the slot before
    real(wp) :: t(0:most) = 0.0_wp            !< times [s]
    real(wp), allocatable :: q(:, :)          !< (M,0:most) coordinates at these times [rad, m]
    real(wp), allocatable :: dq(:, :)         !< (M,0:most) rates at these times
    logical :: with_positions = .false.       !< predictions use positions and rates, not rates alone
    real(wp) :: long_step = 0.0_wp            !< length of the step that made predictions use positions [s]
    logical :: weighed = .false.              !< the weights below are valid
    logical :: even = .false.                 !< they are those of equal steps
    real(wp) :: h = 0.0_wp                    !< step of the prediction from the latest time [s]
    real(wp) :: nodes(most) = 0.0_wp          !< times of the weights, counted from the latest one in steps of the prediction
    real(wp) :: of_positions(most) = 0.0_wp   !< weights of differences to the latest position
    real(wp) :: of_rates(0:most) = 0.0_wp     !< weights of rates times h
  end type past_motion_type

contains

  !> Storage for the motion of m coordinates, with no time yet.
  pure function new_past_motion(m) result(past)
    integer, intent(in) :: m   !< number of coordinates
    type(past_motion_type) :: past

    allocate (past%q(m, 0:most), past%dq(m, 0:most), source=0.0_wp)
  end function new_past_motion

  !> Forget all times, because the motion to come does not continue them.
  pure subroutine clear_past(past)
    type(past_motion_type), intent(inout) :: past   !< positions and rates at the last times

    past%count = 0
    past%with_positions = .false.
    past%weighed = .false.
  end subroutine clear_past

  !> Take positions and rates at the next time. Where the motion turns back, only the turning point is kept of what was before.
  pure subroutine add_to_past(past, t, q, dq)
    type(past_motion_type), intent(inout) :: past   !< positions and rates at the last times
    real(wp), intent(in) :: t                 !< time [s]
    real(wp), intent(in) :: q(:)              !< (M) coordinates [rad, m]
    real(wp), intent(in) :: dq(:)             !< (M) their rates

    if (past%count >= 2) then
      if ((t - past%t(past%latest))*(past%t(past%latest) - past%t(slot(past, 1))) < 0.0_wp) past%count = 1
    end if
    past%count = min(past%count, most) + 1
    past%latest = past%latest + 1
    if (past%latest > most) past%latest = 0
    past%t(past%latest) = t
    call copy(size(q), q, dq, past%q(:, past%latest), past%dq(:, past%latest))
  end subroutine add_to_past

  !> Copy positions and rates; arrays of explicit shape need no strides.
  pure subroutine copy(m, q, dq, kept_q, kept_dq)
    integer, intent(in) :: m   !< number of coordinates
    real(wp), intent(in) :: q(m)   !< (M) coordinates [rad, m]
    real(wp), intent(in) :: dq(m)   !< (M) their rates
    real(wp), intent(out) :: kept_q(m)   !< (M) copy of the coordinates
    real(wp), intent(out) :: kept_dq(m)   !< (M) copy of their rates
    integer :: k

    do k = 1, m
      kept_q(k) = q(k)
      kept_dq(k) = dq(k)
    end do
  end subroutine copy

  !> Slot of the time that lies `back` times before the latest.
  pure integer function slot(past, back)
    type(past_motion_type), intent(in) :: past   !< positions and rates at the last times
    integer, intent(in) :: back   !< number of times back from the latest, 0 ... most

    slot = past%latest - back
    if (slot < 0) slot = slot + most + 1
  end function slot

  !> Choose whether predictions use positions from now on: they do after a step whose prediction from rates needed a large
  !> correction, until steps are half as long as that one.
  pure subroutine choose_formula(past, h, correction)
    type(past_motion_type), intent(inout) :: past   !< positions and rates at the last times
    real(wp), intent(in) :: h                 !< length of the step that was accepted [s]
    real(wp), intent(in) :: correction        !< largest correction of its prediction, in units of the coordinates

    if (past%with_positions) then
      past%with_positions = 2.0_wp*h > past%long_step
    else if (correction > worth_positions) then
      past%with_positions = .true.
      past%long_step = h
    else
      return
    end if
    past%weighed = .false.
  end subroutine choose_formula

  !> Find the weights of a prediction, unless those of the last one serve again.
  pure subroutine find_weights(past, h)
    type(past_motion_type), intent(inout) :: past   !< positions and rates at the last times
    real(wp), intent(in) :: h                 !< step from the latest time [s], not 0
    real(wp) :: nodes(most), per_h
    integer :: i, n

    per_h = 1.0_wp/h
    past%h = h
    ! outputs are mostly equidistant except for round-off: then the latest step shows whether the weights are valid
    if (past%weighed .and. past%even .and. past%count > most) then
      if (abs((past%t(slot(past, 1)) - past%t(past%latest))*per_h + 1.0_wp) <= same_spacing) return
    end if
    nodes = 0.0_wp
    do i = 1, past%count - 1
      nodes(i) = (past%t(slot(past, i)) - past%t(past%latest))*per_h
    end do
    if (past%weighed .and. all(abs(nodes - past%nodes) <= same_spacing)) return
    past%nodes = nodes
    past%weighed = past%count > most
    past%even = all(abs(nodes + [1, 2, 3, 4]) <= same_spacing)
    past%of_positions = 0.0_wp
    past%of_rates = 0.0_wp
    n = times_to_use(past%count - 1, nodes)
    if (n == 0) then
      call weigh_slope(past%count - 1, nodes, past%of_rates)
    else if (past%with_positions) then
      n = min(n, most_with_positions)
      call weigh_positions(n, nodes, past%of_positions, past%of_rates)
    else
      call weigh_rates(n, nodes, past%of_rates)
    end if
  end subroutine find_weights

  !> The number of times before the latest that serve a prediction. Times that are close together do not serve one far beyond
  !> them, where the result would be their round-off.
  pure integer function times_to_use(kept, nodes) result(n)
    integer, intent(in) :: kept               !< number of times before the latest that are kept
    real(wp), intent(in) :: nodes(most)       !< these times, counted from the latest one in steps of the prediction
    integer :: i

    n = 0
    if (kept == 0 .or. longest_prediction*abs(nodes(1)) < 1.0_wp) return
    n = 1
    do i = 2, kept
      if (abs(nodes(i) - nodes(i - 1)) < least_spacing*abs(nodes(1))) return
      n = i
    end do
  end function times_to_use

  !> Weights of a prediction from the latest rates and their mean slope since the earliest time that is kept.
  pure subroutine weigh_slope(kept, nodes, of_rates)
    integer, intent(in) :: kept   !< number of times before the latest that are kept
    real(wp), intent(in) :: nodes(most)   !< the times before, counted from the latest one in steps of the prediction; negative
    real(wp), intent(inout) :: of_rates(0:most)   !< gets the weights of the rates, the latest first, in parts of the step

    of_rates(0) = 1.0_wp
    if (kept == 0) return
    of_rates(0) = 1.0_wp - 0.5_wp/nodes(kept)
    of_rates(kept) = 0.5_wp/nodes(kept)
  end subroutine weigh_slope

  !> Weights of the integral from 0 to 1 of the polynomial through the rates at the latest time, 0, and at n times before it.
  pure subroutine weigh_rates(n, nodes, of_rates)
    integer, intent(in) :: n   !< number of times before the latest that are used
    real(wp), intent(in) :: nodes(most)   !< the times before, counted from the latest one in steps of the prediction; negative
    real(wp), intent(inout) :: of_rates(0:most)   !< gets the weights of the rates, the latest first, in parts of the step
    real(wp) :: x(0:most), product(0:most), denominator
    integer :: i, j, k, degree

    x = [0.0_wp, nodes]
    do i = 0, n
      product = 0.0_wp
      product(0) = 1.0_wp
      denominator = 1.0_wp
      degree = 0
      do k = 0, n
        if (k == i) cycle
        degree = degree + 1
        denominator = denominator*(x(i) - x(k))
        do j = degree, 1, -1
          product(j) = product(j - 1) - x(k)*product(j)
        end do
        product(0) = -x(k)*product(0)
      end do
      do j = 0, n
        of_rates(i) = of_rates(i) + product(j)/(denominator*(j + 1))
      end do
    end do
  end subroutine weigh_rates

  !> Weights of the value at 1 of Hermite's polynomial, through positions and rates at the latest time, 0, and at n times before.
  pure subroutine weigh_positions(n, nodes, of_positions, of_rates)
    integer, intent(in) :: n   !< number of times before the latest that are used
    real(wp), intent(in) :: nodes(most)   !< the times before, counted from the latest one in steps of the prediction; negative
    real(wp), intent(inout) :: of_positions(most)   !< gets the weights of differences from the latest position
    real(wp), intent(inout) :: of_rates(0:most)   !< gets the weights of the rates, the latest first, in parts of the step
    real(wp) :: x(0:most), all_positions(0:most), lagrange, slope
    integer :: i, k

    x = [0.0_wp, nodes]
    do i = 0, n
      lagrange = 1.0_wp
      slope = 0.0_wp
      do k = 0, n
        if (k == i) cycle
        lagrange = lagrange*(1.0_wp - x(k))/(x(i) - x(k))
        slope = slope + 1.0_wp/(x(i) - x(k))
      end do
      of_rates(i) = (1.0_wp - x(i))*lagrange**2
      all_positions(i) = (1.0_wp - 2.0_wp*slope*(1.0_wp - x(i)))*lagrange**2
    end do
    ! the weights of all positions have the sum 1, so that of the latest is not stored
    of_positions(:n) = all_positions(1:n)
  end subroutine weigh_positions

  !> Predict some coordinates for the step whose weights were found.
  pure subroutine predict_from_past(past, coordinates, q)
    type(past_motion_type), intent(in) :: past   !< positions and rates at the last times
    integer, intent(in), contiguous :: coordinates(:)   !< numbers of the coordinates to predict
    real(wp), intent(inout) :: q(:)   !< (M) gets the predicted coordinates [rad, m]

    call sum_weighed(past, size(past%q, 1), past%q, past%dq, size(coordinates), coordinates, q)
  end subroutine predict_from_past

  !> The latest position and the contributions of rates and positions. The sums are written out, over arrays of explicit shape,
  !> whose addresses the compiler keeps in registers.
  pure subroutine sum_weighed(past, m, positions, rates, n, coordinates, q)
    type(past_motion_type), intent(in) :: past      !< with the weights
    integer, intent(in) :: m                        !< number of all coordinates
    real(wp), intent(in) :: positions(m, 0:most)    !< coordinates at the last times [rad, m]
    real(wp), intent(in) :: rates(m, 0:most)        !< rates at these times
    integer, intent(in) :: n                        !< number of coordinates to predict
    integer, intent(in) :: coordinates(n)           !< their numbers
    real(wp), intent(inout) :: q(m)                 !< gets the predicted coordinates [rad, m]
    real(wp) :: w(0:most), h
    integer :: a, b, c, d, e, i, k

    a = past%latest
    b = slot(past, 1)
    c = slot(past, 2)
    d = slot(past, 3)
    e = slot(past, 4)
    h = past%h
    w = past%of_rates
    do i = 1, n
      k = coordinates(i)
      q(k) = positions(k, a) + h*(w(0)*rates(k, a) + w(1)*rates(k, b) + w(2)*rates(k, c) + w(3)*rates(k, d) + w(4)*rates(k, e))
    end do
    if (.not. past%with_positions) return
    w(1:) = past%of_positions
    do i = 1, n
      k = coordinates(i)
      q(k) = q(k) + (w(1)*(positions(k, b) - positions(k, a)) + w(2)*(positions(k, c) - positions(k, a)) &
                     + w(3)*(positions(k, d) - positions(k, a)))
    end do
  end subroutine sum_weighed

  !> Acceleration of a coordinate at the latest time, by the polynomial through its rates; 0 where only that time is known.
  pure real(wp) function acceleration_from_past(past, k) result(ddq)
    type(past_motion_type), intent(in) :: past   !< positions and rates at the last times
    integer, intent(in) :: k   !< number of the coordinate
    real(wp) :: x(0:most), product
    integer :: i, j, n

    ddq = 0.0_wp
    n = past%count - 1
    do i = 0, n
      x(i) = past%t(slot(past, i)) - past%t(past%latest)
    end do
    do i = 1, n
      product = 1.0_wp
      do j = 1, n
        if (j /= i) product = product*x(j)/(x(j) - x(i))
      end do
      ddq = ddq + product*(past%dq(k, slot(past, i)) - past%dq(k, past%latest))/x(i)
    end do
  end function acceleration_from_past
end module mech9_past_motion
