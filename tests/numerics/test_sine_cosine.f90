!> Cosines and sines of many angles, against those in quadruple precision.
module test_sine_cosine
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_sine_cosine, only: cosines_and_sines
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: quad = selected_real_kind(30)
  !> The greatest term is added last: half of the last digit of numbers below one for that sum, which is a quarter of
  !> epsilon, and as much again at most for the small terms.
  real(wp), parameter :: allowed = 0.5_wp*epsilon(1.0_wp)

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('all_sizes')) call all_sizes(test)
    if (test%runs('about_quarter_turns')) call about_quarter_turns(test)
    if (test%runs('known_angles')) call known_angles(test)
    if (test%runs('too_large')) call too_large(test)
  end subroutine run

  !> Largest error of either.
  real(wp) function error_of(angles, turned) result(worst)
    real(wp), intent(in) :: angles(:)      !< [rad]
    real(wp), intent(in) :: turned(:, :)   !< (2,n) cosine and sine of each angle
    integer :: i

    worst = 0.0_wp
    do i = 1, size(angles)
      worst = max(worst, real(abs(turned(1, i) - cos(real(angles(i), quad))), wp), &
                  real(abs(turned(2, i) - sin(real(angles(i), quad))), wp))
    end do
  end function error_of

  !> Angles from a thousandth of a radian to a million, any number at once.
  subroutine all_sizes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: angles(97), turned(2, 97)
    integer :: power, trial, n, i

    do power = -3, 6
      do trial = 1, 100
        n = 1 + mod(trial, size(angles))
        do i = 1, n
          angles(i) = 10.0_wp**power*random%symmetric()
        end do
        call cosines_and_sines(n, angles(:n), turned(:, :n))
        call test%near(error_of(angles(:n), turned(:, :n)), 0.0_wp, allowed, 'cosine and sine are those of quadruple precision')
      end do
    end do
  end subroutine all_sizes

  !> Angles at which one of them vanishes, and at which the nearest whole quarter changes.
  subroutine about_quarter_turns(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: angles(7), turned(2, 7)
    integer :: eighths

    do eighths = -200000, 200000, 41
      angles = eighths*acos(-1.0_wp)/4.0_wp
      angles = angles + max(1.0_wp, abs(angles(1)))*epsilon(1.0_wp)*[-1.0e6_wp, -10.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, &
                                                                     10.0_wp, 1.0e6_wp]
      call cosines_and_sines(size(angles), angles, turned)
      call test%near(error_of(angles, turned), 0.0_wp, allowed, 'cosine and sine are right beside eighths of a turn')
    end do
  end subroutine about_quarter_turns

  subroutine known_angles(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: turned(2, 2)

    call cosines_and_sines(2, [0.0_wp, 1.0e-300_wp], turned)
    call test%near(maxval(abs(turned(1, :) - 1.0_wp)), 0.0_wp, 0.0_wp, 'the cosine of zero is one')
    call test%near(turned(2, 1), 0.0_wp, 0.0_wp, 'the sine of zero is zero')
    call test%near(turned(2, 2)*1.0e300_wp, 1.0_wp, epsilon(1.0_wp), 'the sine of a tiny angle is the angle')
  end subroutine known_angles

  !> Beyond what can be reduced, the intrinsic functions answer.
  subroutine too_large(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: angles(3), turned(2, 3)

    angles = [1.0_wp, 1.0e9_wp, -1.0e15_wp]
    call cosines_and_sines(3, angles, turned)
    call test%near(error_of(angles, turned), 0.0_wp, allowed, 'cosine and sine of large angles are right')
  end subroutine too_large
end module test_sine_cosine
