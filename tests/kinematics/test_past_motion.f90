!> Predictions from past positions and rates: exact for polynomials up to the degree that so many of them determine.
module test_past_motion
  use mech9_kinds, only: wp
  use mech9_past_motion, only: past_motion_type, new_past_motion, clear_past, add_to_past, choose_formula, find_weights, &
    predict_from_past, acceleration_from_past
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Sums of some ten terms of order one, times weights of some hundred where the times lie unevenly.
  real(wp), parameter :: round_off = 1.0e-12_wp
  real(wp), parameter :: even(5) = [0.0_wp, 0.1_wp, 0.2_wp, 0.3_wp, 0.4_wp]
  real(wp), parameter :: uneven(5) = [0.0_wp, 0.13_wp, 0.2_wp, 0.32_wp, 0.4_wp]
  real(wp), parameter :: clustered(5) = [0.0_wp, 0.1_wp, 0.1_wp + 1.0e-9_wp, 0.3_wp, 0.4_wp]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('rates')) call check_degree(test, even, .false., 0.5_wp, 5, 'five rates')
    if (test%runs('uneven_rates')) call check_degree(test, uneven, .false., 0.47_wp, 5, 'five rates at uneven times')
    if (test%runs('backwards')) call check_degree(test, -uneven, .false., -0.52_wp, 5, 'five rates backwards')
    if (test%runs('three_rates')) call check_degree(test, even(:3), .false., 0.3_wp, 3, 'three rates')
    if (test%runs('positions')) call check_degree(test, even, .true., 0.5_wp, 7, 'positions and rates')
    if (test%runs('uneven_positions')) call check_degree(test, uneven, .true., 0.45_wp, 7, 'positions and rates at uneven times')
    if (test%runs('two_positions')) call check_degree(test, even(:2), .true., 0.2_wp, 3, 'two positions and rates')
    ! of two times that nearly coincide the earlier ones are not used
    if (test%runs('clustered_rates')) call check_degree(test, clustered, .false., 0.5_wp, 3, 'clustered times')
    if (test%runs('clustered_positions')) call check_degree(test, clustered, .true., 0.5_wp, 5, 'clustered times, with positions')
    ! far beyond the last step: by the mean slope of the rates
    if (test%runs('far_beyond')) call check_degree(test, [0.0_wp, 0.3_wp, 0.300001_wp], .true., 0.5_wp, 2, 'far beyond')
    ! back over the turning point, from which only two times are kept
    if (test%runs('turned_back')) &
      call check_degree(test, [0.0_wp, 0.1_wp, 0.2_wp, 0.3_wp, 0.25_wp], .false., 0.2_wp, 2, 'turned back')
    if (test%runs('check_even_steps')) call check_even_steps(test)
    if (test%runs('check_choice')) call check_choice(test)
  end subroutine run

  !> A polynomial with all powers up to one.
  pure real(wp) function value(degree, t)
    integer, intent(in) :: degree   !< of the polynomial
    real(wp), intent(in) :: t       !< time [s]
    integer :: i

    value = 0.0_wp
    do i = 0, degree
      value = value + (1.0_wp + 0.3_wp*i)*t**i
    end do
  end function value

  !> Its derivative of some order.
  pure real(wp) function derivative(degree, order, t)
    integer, intent(in) :: degree   !< of the polynomial
    integer, intent(in) :: order    !< of the derivative
    real(wp), intent(in) :: t       !< time [s]
    integer :: i, k
    real(wp) :: factor

    derivative = 0.0_wp
    do i = order, degree
      factor = 1.0_wp + 0.3_wp*i
      do k = 0, order - 1
        factor = factor*(i - k)
      end do
      derivative = derivative + factor*t**(i - order)
    end do
  end function derivative

  !> Take positions and rates of a polynomial.
  subroutine take(past, degree, times)
    type(past_motion_type), intent(inout) :: past   !< takes them
    integer, intent(in) :: degree                   !< of the polynomial
    real(wp), intent(in) :: times(:)                !< in order [s]
    integer :: i

    do i = 1, size(times)
      call add_to_past(past, times(i), [value(degree, times(i)), -value(degree, times(i))], &
                       [derivative(degree, 1, times(i)), -derivative(degree, 1, times(i))])
    end do
  end subroutine take

  !> A prediction is exact for polynomials of a degree, and not for the next.
  subroutine check_degree(test, times, with_positions, t, degree, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: times(:)           !< times that are kept, in order [s]
    logical, intent(in) :: with_positions      !< positions are used, not rates alone
    real(wp), intent(in) :: t                  !< of the prediction
    integer, intent(in) :: degree              !< degree of a polynomial that is predicted exactly
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(past_motion_type) :: past
    real(wp) :: q(2)
    integer :: d, last

    last = size(times)
    do d = 0, degree + 1
      past = new_past_motion(2)
      call take(past, d, times)
      if (with_positions) call choose_formula(past, abs(t - times(last)), 1.0_wp)
      call find_weights(past, t - times(last))
      q = 7.0_wp
      call predict_from_past(past, [2], q)
      call test%near(q(1), 7.0_wp, 0.0_wp, why//': the other coordinates stay')
      if (d <= degree) then
        call test%near(q(2), -value(d, t), round_off, why//': a motion of this degree is continued exactly')
      else
        call test%is_true(abs(q(2) + value(d, t)) > 1.0e-9_wp, why//': a motion of a higher degree is not continued exactly')
      end if
    end do
    ! rates at times that are not too close give the acceleration, too
    if (minval(abs(times(2:) - times(:last - 1))) < 0.01_wp .or. times(last) < times(last - 1)) return
    past = new_past_motion(2)
    call take(past, last, times)
    call test%near(acceleration_from_past(past, 1), derivative(last, 2, times(last)), 1.0e-11_wp, &
                   why//': the acceleration is found')
  end subroutine check_degree

  !> Weights are shared by even steps, also where round-off makes them uneven; not by others.
  subroutine check_even_steps(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(past_motion_type) :: past
    real(wp) :: t, q(2), h
    integer :: i

    past = new_past_motion(2)
    h = 0.01_wp
    t = 0.0_wp
    do i = 1, 60
      if (i > 5) then
        call find_weights(past, h)
        call predict_from_past(past, [1, 2], q)
        call test%near(q(1), value(5, t + h), 1.0e-14_wp, 'a motion is continued exactly step after step')
      end if
      t = t + h
      call take(past, 5, [t])
      if (i == 30) h = 0.004_wp
      h = h*(1.0_wp + 1.0e-13_wp)
    end do
    call clear_past(past)
    call test%is_true(past%count == 0, 'a motion that is forgotten has no steps')
  end subroutine check_even_steps

  !> Positions are used from a long step on that rates did not predict, until steps are half as long.
  subroutine check_choice(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(past_motion_type) :: past

    past = new_past_motion(2)
    call choose_formula(past, 0.1_wp, 1.0e-12_wp)
    call test%is_true(.not. past%with_positions, 'rates alone serve for steps of one length')
    call choose_formula(past, 0.1_wp, 1.0e-8_wp)
    call test%is_true(past%with_positions, 'positions are taken with rates after a long step')
    call choose_formula(past, 0.06_wp, 1.0e-16_wp)
    call test%is_true(past%with_positions, 'positions are taken with rates after a step that is not much shorter')
    call choose_formula(past, 0.04_wp, 1.0e-16_wp)
    call test%is_true(.not. past%with_positions, 'rates alone serve after a step half as long')
  end subroutine check_choice
end module test_past_motion
