!> How the quantities of a study scatter: a sample of its runs for quantiles and plots, and the shares of the parameters in the
!> variances. Runs come in the order of their numbers, so that threads, parts and processes change nothing.
module mech9_study_statistics
  use mech9_kinds, only: wp
  use mech9_model, only: model_type
  use mech9_kept_sample, only: kept_sample_type
  use mech9_parameter, only: parameter_type
  use mech9_main_effects, only: shares_type, find_shares
  use mech9_sample_quantiles, only: sample_quantile, sort_numbers
  implicit none
  private
  public :: study_statistics_type, shares_type, quantile_type, n_levels, quantile_levels

  integer, parameter :: n_levels = 3
  !> The shares of the runs that quantiles are told of.
  real(wp), parameter :: quantile_levels(n_levels) = [0.05_wp, 0.5_wp, 0.95_wp]

  !> A value that a share of the runs does not exceed.
  type :: quantile_type
    real(wp) :: value = 0.0_wp
    real(wp) :: error = 0.0_wp    !< its standard error for runs that are drawn independently; 0 where it is not known
    logical :: known = .false.    !< the error is known
  end type quantile_type

  type :: study_statistics_type
    logical :: drawn = .false.                     !< the values are drawn at random
    type(kept_sample_type) :: sample               !< rows of parameters and quantities of runs that went to their end
    type(parameter_type), allocatable, private :: parameters(:)
  contains
    procedure :: begin
    procedure :: add
    procedure :: quantiles
    procedure :: shares
  end type study_statistics_type

contains

  !> Begin without runs. Of values that are not drawn, a sample is kept only for plots.
  subroutine begin(self, model, runs, with_sample)
    class(study_statistics_type), intent(inout) :: self   !< the statistics
    type(model_type), intent(in) :: model                 !< with its study
    integer, intent(in) :: runs                           !< the most runs that will come
    logical, intent(in) :: with_sample                    !< a sample is kept for plots
    integer :: kept

    self%drawn = all(model%request%study%kind /= ['grid', 'list'])
    self%parameters = model%parameters
    kept = 0
    if (self%drawn .or. with_sample) kept = max(0, runs)
    call self%sample%begin(size(model%parameters) + size(model%request%quantities), kept, model%request%study%seed)
  end subroutine begin

  !> Add a run that went to its end.
  pure subroutine add(self, values, numbers)
    class(study_statistics_type), intent(inout) :: self   !< the statistics
    real(wp), intent(in) :: values(:)                     !< (parameters) of the run
    real(wp), intent(in) :: numbers(:)                    !< (quantities) of the run

    if (size(self%sample%rows, 2) > 0) call self%sample%take([values, numbers])
  end subroutine add

  !> Compute the quantiles of a quantity. There is at least one run.
  subroutine quantiles(self, quantity, found)
    class(study_statistics_type), intent(in) :: self    !< the statistics
    integer, intent(in) :: quantity                     !< its number
    type(quantile_type), intent(out) :: found(n_levels) !< in the order of the levels
    real(wp), allocatable :: sorted(:)
    integer :: i

    sorted = self%sample%rows(size(self%parameters) + quantity, :self%sample%kept)
    call sort_numbers(sorted)
    do i = 1, n_levels
      call sample_quantile(sorted, quantile_levels(i), found(i)%value, found(i)%error, found(i)%known)
    end do
  end subroutine quantiles

  !> Compute the shares of the parameters in the variance of each quantity.
  subroutine shares(self, found)
    class(study_statistics_type), intent(in) :: self               !< the statistics
    type(shares_type), allocatable, intent(out) :: found(:)        !< (quantities)

    integer :: n

    n = size(self%parameters)
    associate (rows => self%sample%rows(:, :self%sample%kept))
      call find_shares(self%parameters, rows(:n, :), rows(n + 1:, :), found)
    end associate
  end subroutine shares
end module mech9_study_statistics
