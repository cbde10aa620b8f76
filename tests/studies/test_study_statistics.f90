!> Quantiles and shares of the variance of the runs of a study, for quantities whose distributions are known.
module test_study_statistics
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_model, only: model_type
  use mech9_main_effects, only: shares_type
  use mech9_study_values, only: values_of_run
  use mech9_study_statistics, only: study_statistics_type, quantile_type, n_levels, quantile_levels
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: n_runs = 2000

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('uniform_sum')) call uniform_sum(tester)
    if (tester%runs('grid_without_sample')) call grid_without_sample(tester)
  end subroutine run

  !> Two parameters between 0 and 1, and one quantity.
  subroutine study(tester, kind, model)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: kind         !< of the study
    type(model_type), intent(out) :: model       !< the model

    call model_from_text(tester, slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol// &
      "&time end=1, intervals=4 /"//eol// &
      "&parameter name='a', value=0.3, low=0, high=1, count=3, sets='pair(2).point(1)' /"//eol// &
      "&parameter name='b', value=1, low=0, high=1, count=3, sets='pair(3).point(1)' /"//eol// &
      "&quantity name='s', of='q4', take='max' /"//eol// &
      "&study kind='"//kind//"'"//trim(merge(', runs=2000', '           ', kind /= 'grid'))//" /"//eol, kinematics, model)
  end subroutine study

  !> s = a + 3 b of independent uniform numbers: shares of 1/10 and 9/10, and a median of 2. Latin hypercubes fill the range evenly,
  !> so that the mean of each parameter is right to a thousandth.
  subroutine uniform_sum(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(study_statistics_type) :: statistics
    type(quantile_type) :: found(n_levels)
    type(shares_type), allocatable :: shares(:)
    real(wp) :: values(2)
    integer :: i

    call study(tester, 'latin', model)
    call statistics%begin(model, n_runs, .false.)
    call tester%is_true(statistics%drawn, 'values of a hypercube are drawn')
    do i = 1, n_runs
      call values_of_run(model%request%study, model%parameters, i, values)
      call statistics%add(values, [values(1) + 3.0_wp*values(2)])
    end do
    call statistics%quantiles(1, found)
    ! the density of the median is 1/3, so that its standard error is 3/2/sqrt(2000) = 0.034
    call tester%near(found(2)%value, 2.0_wp, 0.06_wp, 'the median')
    call tester%is_true(found(2)%known .and. found(2)%error < 0.07_wp, 'its standard error')
    call tester%is_true(found(1)%value < found(2)%value .and. found(2)%value < found(3)%value, 'quantiles ascend')
    ! P(s < x) = x^2/6 below 1
    call tester%near(found(1)%value, sqrt(6.0_wp*quantile_levels(1)), 0.1_wp, 'the quantile of 5 %')
    call tester%near(found(3)%value, 4.0_wp - sqrt(6.0_wp*quantile_levels(1)), 0.03_wp, 'the quantile of 95 %')
    call statistics%shares(shares)
    call tester%is_true(shares(1)%known, 'the shares are known')
    if (.not. shares(1)%known) return
    ! the method sorts runs into classes: its own errors are of a few hundredths
    call tester%near(shares(1)%share(1), 0.1_wp, 0.04_wp, 'the share of a')
    call tester%near(shares(1)%share(2), 0.9_wp, 0.04_wp, 'the share of b')
  end subroutine uniform_sum

  !> Values of a grid are not drawn; a sample is kept for plots alone.
  subroutine grid_without_sample(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(study_statistics_type) :: statistics

    call study(tester, 'grid', model)
    call statistics%begin(model, 9, .false.)
    call statistics%add([0.0_wp, 0.0_wp], [1.0_wp])
    call tester%is_true(.not. statistics%drawn .and. statistics%sample%kept == 0, 'no sample')
    call statistics%begin(model, 9, .true.)
    call statistics%add([0.0_wp, 0.5_wp], [1.0_wp])
    call tester%is_true(statistics%sample%kept == 1, 'a sample for plots')
    call tester%is_true(all(abs(statistics%sample%rows(:, 1) - [0.0_wp, 0.5_wp, 1.0_wp]) <= 0.0_wp), 'parameters, then quantities')
  end subroutine grid_without_sample
end module test_study_statistics
