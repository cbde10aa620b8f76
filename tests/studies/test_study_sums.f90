!> Sums over the runs of a study, against moments of numbers that are added up directly, also where numbers are very large or differ
!> little.
module test_study_sums
  use mech9_kinds, only: wp
  use mech9_study_sums, only: study_sums_type
  use mech9_checks, only: near_vector
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('small_numbers')) call small_numbers(tester)
    if (tester%runs('scales')) call scales(tester)
    if (tester%runs('far_from_zero')) call far_from_zero(tester)
    if (tester%runs('equal_numbers')) call equal_numbers(tester)
    if (tester%runs('failures')) call failures(tester)
  end subroutine run

  !> Sums of numbers that come one after the other.
  function sums_of(numbers) result(sums)
    real(wp), intent(in) :: numbers(:)   !< of one quantity
    type(study_sums_type) :: sums
    integer :: i

    call sums%begin(1)
    do i = 1, size(numbers)
      call sums%add(numbers(i:i))
    end do
  end function sums_of

  !> 1, 2, 3, 4, 10: the mean is 4; the deviations -3, -2, -1, 0, 6 have squares of 50 and fourth powers of 1394 together.
  subroutine small_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_sums_type) :: sums
    real(wp), parameter :: tol = 1.0e-14_wp   ! five updates of numbers of order ten

    sums = sums_of([4.0_wp, 10.0_wp, 1.0_wp, 3.0_wp, 2.0_wp])
    call tester%is_true(sums%done == 5 .and. sums%made() == 5, 'five runs')
    call near_vector(tester, [sums%mean, sums%low, sums%high], [4.0_wp, 1.0_wp, 10.0_wp], tol, 'mean and range')
    call near_vector(tester, sums%deviation(), [sqrt(50.0_wp/4.0_wp)], tol, 'the deviation')
    call near_vector(tester, sums%error_of_mean(), [sqrt(50.0_wp/4.0_wp/5.0_wp)], tol, 'the standard error of the mean')
    ! the variance of a variance is (m4 - m2^2)/n, and that of its root is this over 4 m2
    call near_vector(tester, sums%error_of_deviation(), [sqrt((1394.0_wp/5.0_wp - 100.0_wp)/5.0_wp/10.0_wp)/2.0_wp], tol, &
                     'the standard error of the deviation')
  end subroutine small_numbers

  !> Numbers times a power of two have means and deviations times the same power, to the last bit.
  subroutine scales(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: numbers(6) = [0.3_wp, -1.7_wp, 2.2_wp, 0.9_wp, -5.1_wp, 40.0_wp]
    type(study_sums_type) :: sums, scaled
    integer, parameter :: powers(4) = [900, 500, -300, -900]
    integer :: i

    sums = sums_of(numbers)
    do i = 1, size(powers)
      scaled = sums_of(scale(numbers, powers(i)))
      call near_vector(tester, scale(scaled%mean, -powers(i)), sums%mean, 0.0_wp, 'the mean of scaled numbers')
      call near_vector(tester, scale(scaled%deviation(), -powers(i)), sums%deviation(), 0.0_wp, 'their deviation')
      call near_vector(tester, scale(scaled%error_of_deviation(), -powers(i)), sums%error_of_deviation(), 0.0_wp, 'its error')
    end do
  end subroutine scales

  !> A large constant does not spoil the deviation: 1e8 + (0, 1) have a deviation of sqrt(1/2).
  subroutine far_from_zero(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_sums_type) :: sums

    sums = sums_of([1.0e8_wp, 1.0e8_wp + 1.0_wp])
    ! the numbers themselves have a relative error of 1e-16, hence their difference one of 1e-8
    call near_vector(tester, sums%deviation(), [sqrt(0.5_wp)], 1.0e-8_wp, 'the deviation of numbers far from zero')
    call near_vector(tester, sums%mean, [1.0e8_wp + 0.5_wp], 1.0e-15_wp, 'their mean')
  end subroutine far_from_zero

  subroutine equal_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_sums_type) :: sums

    sums = sums_of([2.5_wp, 2.5_wp, 2.5_wp])
    call near_vector(tester, [sums%deviation(), sums%error_of_mean(), sums%error_of_deviation()], [0.0_wp, 0.0_wp, 0.0_wp], &
                     0.0_wp, 'equal numbers do not scatter')
    sums = sums_of([7.0_wp])
    call near_vector(tester, [sums%mean, sums%deviation()], [7.0_wp, 0.0_wp], 0.0_wp, 'one number does not scatter')
    sums = sums_of([0.0_wp, 0.0_wp])
    call near_vector(tester, [sums%mean, sums%deviation()], [0.0_wp, 0.0_wp], 0.0_wp, 'zeros')
  end subroutine equal_numbers

  subroutine failures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_sums_type) :: sums

    call sums%begin(0)
    call sums%add([real(wp) ::])
    call sums%add_failure(2, 6)
    call sums%add_failure(3, 5)
    call sums%add_failure(4, 6)
    call tester%is_true(sums%made() == 4 .and. sums%done == 1, 'runs that failed are counted apart')
    call tester%is_true(sums%n_codes == 2 .and. all(sums%codes(:2) == [6, 5]), 'codes in the order in which they came')
    call tester%is_true(all(sums%failed(:2) == [2, 1]) .and. all(sums%first_failed(:2) == [2, 3]), 'how many, and the first ones')
  end subroutine failures
end module test_study_sums
