!> Predictions of the predictor, on motions that are polynomials: they are exact up to the degree that the known positions, rates
!> and accelerations determine.
module test_predictor
  use mech9_kinds, only: wp
  use mech9_plan, only: block_type
  use mech9_state, only: state_type
  use mech9_predictor, only: predictor_type, new_predictor, begin_prediction, add_position, prepare_prediction, predict, &
    set_accelerations, acceleration_of
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A prediction sums about ten terms of order one, which the distance to the prediction multiplies by up to some thousand.
  real(wp), parameter :: round_off = 1.0e-12_wp
  real(wp), parameter :: units(3) = 1.0_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_two_positions')) call check_two_positions(test)
    if (test%runs('check_one_position')) call check_one_position(test)
    if (test%runs('check_long_prediction')) call check_long_prediction(test)
    if (test%runs('check_without_accelerations')) call check_without_accelerations(test)
  end subroutine run

  !> Position, rate and acceleration of two coordinates, polynomials of a degree; the third coordinate is an input.
  pure function motion(degree, t) result(state)
    integer, intent(in) :: degree   !< degree of the polynomials
    real(wp), intent(in) :: t       !< time [s]
    type(state_type) :: state
    real(wp) :: c
    integer :: i

    state%t = t
    allocate (state%q(3), state%dq(3), state%ddq(3), source=0.0_wp)
    do i = 0, degree
      c = 1.0_wp - 0.2_wp*i
      state%q(1) = state%q(1) + c*t**i
      if (i > 0) state%dq(1) = state%dq(1) + c*i*t**(i - 1)
      if (i > 1) state%ddq(1) = state%ddq(1) + c*i*(i - 1)*t**(i - 2)
    end do
    state%q(2) = -2.0_wp*state%q(1)
    state%dq(2) = -2.0_wp*state%dq(1)
    state%ddq(2) = -2.0_wp*state%ddq(1)
  end function motion

  !> Largest error of the prediction of the first two coordinates at a time.
  real(wp) function error_of(test, predictor, degree, t) result(error)
    type(tester_type), intent(inout) :: test           !< counts the checks
    type(predictor_type), intent(inout) :: predictor   !< the predictor
    integer, intent(in) :: degree                      !< degree of the motion
    real(wp), intent(in) :: t                          !< time [s]
    type(block_type) :: block
    type(state_type) :: state, true

    block%unknowns = [1, 2]
    block%coordinates = [1, 2]
    true = motion(degree, t)
    state = true
    state%q = 7.0_wp
    call prepare_prediction(t, predictor)
    call predict(block, predictor, state)
    error = maxval(abs(state%q(:2) - true%q(:2)))
    call test%is_true(abs(state%q(3) - 7.0_wp) <= 0.0_wp, 'the coordinates of other blocks stay')
  end function error_of

  !> Six data of two positions determine a polynomial of fifth degree, and not one of sixth.
  subroutine check_two_positions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(predictor_type) :: predictor
    integer :: degree

    do degree = 1, 6
      predictor = new_predictor(3)
      call begin_prediction(motion(degree, 0.2_wp), predictor)
      call add_position(motion(degree, 0.5_wp), units, .true., 0.0_wp, predictor)
      if (degree <= 5) then
        call test%near(error_of(test, predictor, degree, 0.9_wp), 0.0_wp, round_off, &
                       'a motion of fifth degree is predicted exactly beyond two positions')
        call test%near(error_of(test, predictor, degree, 0.3_wp), 0.0_wp, round_off, &
                       'a motion of fifth degree is predicted exactly between two positions')
      else
        call test%is_true(error_of(test, predictor, degree, 0.9_wp) > 1.0e-4_wp, &
                          'two positions do not determine a motion of sixth degree')
      end if
    end do
  end subroutine check_two_positions

  !> At the first position only its own rate and acceleration are known.
  subroutine check_one_position(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(predictor_type) :: predictor

    predictor = new_predictor(3)
    call begin_prediction(motion(2, 0.2_wp), predictor)
    call test%near(error_of(test, predictor, 2, 0.6_wp), 0.0_wp, round_off, &
                   'a motion of second degree is predicted exactly from its first position')
    call test%near(acceleration_of(predictor, 1), 1.2_wp, round_off, 'the acceleration of the first position is the given one')
    call add_position(motion(5, 0.5_wp), units, .true., 0.0_wp, predictor)
    call begin_prediction(motion(2, 0.2_wp), predictor)
    call test%near(error_of(test, predictor, 2, 0.6_wp), 0.0_wp, round_off, 'a new beginning forgets the motion before')
  end subroutine check_one_position

  !> More than three times the distance of the two positions beyond them, their round-off would dominate the higher terms.
  subroutine check_long_prediction(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(predictor_type) :: predictor

    predictor = new_predictor(3)
    call begin_prediction(motion(2, 0.2_wp), predictor)
    call add_position(motion(2, 0.2_wp + 1.0e-9_wp), units, .true., 0.0_wp, predictor)
    call test%near(error_of(test, predictor, 2, 1.2_wp), 0.0_wp, round_off, 'a long prediction is made without the higher terms')
  end subroutine check_long_prediction

  !> Rates at five times determine a motion of fifth degree; accelerations follow from them, or are set.
  subroutine check_without_accelerations(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(predictor_type) :: predictor
    type(state_type) :: last
    integer :: i

    predictor = new_predictor(3)
    call begin_prediction(motion(5, 0.0_wp), predictor)
    do i = 1, 4
      call add_position(motion(5, 0.1_wp*i), units, .false., 0.0_wp, predictor)
    end do
    call test%near(error_of(test, predictor, 5, 0.5_wp), 0.0_wp, round_off, &
                   'a motion of fifth degree is predicted exactly from five rates')
    last = motion(5, 0.4_wp)
    ! differences of rates over 0.1 s lose two digits
    call test%near(acceleration_of(predictor, 1), last%ddq(1), 1.0e-11_wp, 'the acceleration follows from five rates')
    call set_accelerations([1.0_wp, 2.0_wp, 3.0_wp], predictor)
    call test%near(acceleration_of(predictor, 3), 3.0_wp, 0.0_wp, 'accelerations that are set are used')
  end subroutine check_without_accelerations
end module test_predictor
