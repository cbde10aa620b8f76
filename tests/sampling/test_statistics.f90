!> Quantiles and their errors, the sample that is kept of many rows, and shares of variance of functions whose shares are known.
module test_statistics
  use mech9_kinds, only: wp, pi
  use mech9_parameter, only: parameter_type
  use mech9_study, only: study_type
  use mech9_study_values, only: values_of_run
  use mech9_counted_random, only: uniform_at
  use mech9_kept_sample, only: kept_sample_type, most_kept
  use mech9_sample_quantiles, only: sample_quantile, sort_numbers
  use mech9_main_effects, only: shares_type, find_shares
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('sorted_numbers')) call sorted_numbers(tester)
    if (tester%runs('quantile_errors')) call quantile_errors(tester)
    if (tester%runs('kept_rows')) call kept_rows(tester)
    if (tester%runs('linear_shares')) call linear_shares(tester)
    if (tester%runs('ishigami_shares')) call ishigami_shares(tester)
    if (tester%runs('share_errors')) call share_errors(tester)
    if (tester%runs('left_out_runs')) call left_out_runs(tester)
    if (tester%runs('unknown_shares')) call unknown_shares(tester)
  end subroutine run

  !> Numbers in any order, with equal ones among them, are ascending afterwards, and none is lost.
  subroutine sorted_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp) :: numbers(1000)
    integer :: n, i

    do n = 0, 1000, 37
      do i = 1, n
        numbers(i) = aint(50.0_wp*uniform_at(3, i, n))
      end do
      associate (all_of_them => sum(numbers(:n)), squares => sum(numbers(:n)**2))
        call sort_numbers(numbers(:n))
        call tester%is_true(all(numbers(2:n) >= numbers(:n - 1)), 'sorted numbers ascend')
        call tester%is_true(abs(sum(numbers(:n)) - all_of_them) + abs(sum(numbers(:n)**2) - squares) <= 0.0_wp, &
                            'no number is lost')
      end associate
    end do
  end subroutine sorted_numbers

  !> The errors of quantiles tell how they scatter: over many samples of uniform numbers, the deviation of each quantile is the root
  !> of the mean square of its errors. A few samples only leave 10 % of doubt.
  subroutine quantile_errors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 400, samples = 300
    real(wp), parameter :: levels(3) = [0.05_wp, 0.5_wp, 0.95_wp]
    real(wp) :: numbers(n), quantile, error, squares(3), errors(3)
    logical :: known
    integer :: sample, i, k

    squares = 0.0_wp
    errors = 0.0_wp
    do sample = 1, samples
      do i = 1, n
        numbers(i) = uniform_at(sample, i, 1)
      end do
      call sort_numbers(numbers)
      do k = 1, 3
        call sample_quantile(numbers, levels(k), quantile, error, known)
        call tester%is_true(known, 'the error of a quantile of 400 numbers is known')
        squares(k) = squares(k) + (quantile - levels(k))**2/samples
        errors(k) = errors(k) + error**2/samples
      end do
    end do
    call tester%is_true(all(abs(sqrt(errors/squares) - 1.0_wp) < 0.15_wp), 'errors of quantiles are their deviations')
    call sample_quantile(numbers(:10), 0.05_wp, quantile, error, known)
    call tester%is_true(.not. known .and. error <= 0.0_wp, 'ten numbers do not tell the error of an outer quantile')
    call sample_quantile([1.0_wp, 2.0_wp, 4.0_wp], 0.75_wp, quantile, error, known)
    call tester%near(quantile, 3.0_wp, 1e-15_wp, 'a quantile between two numbers')
    call sample_quantile([7.0_wp], 0.05_wp, quantile, error, known)
    call tester%near(quantile, 7.0_wp, 0.0_wp, 'the quantile of one number')
  end subroutine quantile_errors

  !> As many rows as are kept stay in their order; of more, each is kept with the same probability: the mean place of the kept
  !> ones is the middle, within four deviations of a mean of so many.
  subroutine kept_rows(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(kept_sample_type) :: sample, again
    integer, parameter :: rows = 5*most_kept
    integer :: i

    call sample%begin(1, rows, 4)
    call again%begin(1, rows, 4)
    do i = 1, rows
      call sample%take([real(i, wp)])
      call again%take([real(i, wp)])
      if (i == most_kept) call tester%is_true(all(nint(sample%rows(1, 2:) - sample%rows(1, :most_kept - 1)) == 1), &
                                              'all rows of a short study are kept')
    end do
    call tester%is_true(sample%kept == most_kept .and. sample%seen == rows, 'the sample is bounded')
    call tester%near(sum(sample%rows(1, :))/most_kept/rows, 0.5_wp, 4.0_wp/sqrt(12.0_wp*most_kept), 'rows are kept evenly')
    call tester%near(real(count(sample%rows(1, :) <= 0.2_wp*rows), wp)/most_kept, 0.2_wp, 4.0_wp*sqrt(0.16_wp/most_kept), &
                     'early rows are kept as often as others')
    call tester%is_true(maxval(abs(sample%rows - again%rows)) <= 0.0_wp, 'the same rows leave the same sample')
  end subroutine kept_rows

  !> Three parameters with other distributions.
  subroutine make_parameters(parameters)
    type(parameter_type), intent(out) :: parameters(3)   !< normal, uniform about a value, uniform over a range

    parameters(1)%value = 2.0_wp
    parameters(1)%spread = 0.1_wp
    parameters(2)%value = 5.0_wp
    parameters(2)%spread = 0.6_wp
    parameters(2)%uniform = .true.
    parameters(3)%low = -1.0_wp
    parameters(3)%high = 3.0_wp
  end subroutine make_parameters

  !> Shares of linear functions are exact whatever the runs are: squares of the slopes times the variances. A number that is far
  !> from zero loses digits, no more.
  subroutine linear_shares(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(parameter_type) :: parameters(3)
    real(wp), allocatable :: drawn(:, :), numbers(:, :)
    type(shares_type), allocatable :: shares(:)
    type(study_type) :: study
    real(wp) :: values(3), parts(3)
    integer :: run

    call make_parameters(parameters)
    study%kind = 'random'
    study%runs = 100
    allocate (drawn(3, study%runs), numbers(2, study%runs))
    do run = 1, study%runs
      call values_of_run(study, parameters, run, values)
      drawn(:, run) = values
      numbers(:, run) = [dot_product([3.0_wp, -1.0_wp, 0.5_wp], values), 1e6_wp + 1e-2_wp*values(2)]
    end do
    call find_shares(parameters, drawn, numbers, shares)
    parts = [9.0_wp*0.01_wp, 0.36_wp/3.0_wp, 0.25_wp*4.0_wp/3.0_wp]
    parts = parts/sum(parts)
    call tester%near(maxval(abs(shares(1)%share - parts)), 0.0_wp, 1e-12_wp, 'shares of a linear function')
    call tester%near(shares(1)%rest, 0.0_wp, 1e-12_wp, 'a linear function leaves no rest')
    call tester%near(shares(2)%share(2), 1.0_wp, 1e-6_wp, 'the share of the only cause')
  end subroutine linear_shares

  !> Ishigami's function, whose shares are known in closed form (0.3139, 0.4424, 0). Polynomials of fourth degree
  !> have 0.3111 and 0.3008 of them, by Gauss' quadrature; the third parameter has a share only together with the first one.
  subroutine ishigami_shares(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(parameter_type) :: parameters(3)
    real(wp), allocatable :: drawn(:, :), numbers(:, :)
    type(shares_type), allocatable :: shares(:)
    type(study_type) :: study
    real(wp) :: values(3)
    integer :: run

    parameters%low = -pi
    parameters%high = pi
    study%kind = 'sobol'
    study%runs = 4096
    allocate (drawn(3, study%runs), numbers(1, study%runs))
    do run = 1, study%runs
      call values_of_run(study, parameters, run, values)
      drawn(:, run) = values
      numbers(:, run) = [sin(values(1)) + 7.0_wp*sin(values(2))**2 + 0.1_wp*values(3)**4*sin(values(1))]
    end do
    call find_shares(parameters, drawn, numbers, shares)
    call tester%near(shares(1)%share(1), 0.3111_wp, 0.02_wp, 'first share of Ishigami')
    call tester%near(shares(1)%share(2), 0.3008_wp, 0.02_wp, 'second share of Ishigami')
    call tester%near(shares(1)%share(3), 0.0_wp, 0.01_wp, 'third share of Ishigami')
    call tester%near(sum(shares(1)%share) + shares(1)%rest, 1.0_wp, 1e-12_wp, 'shares and rest are the whole')
  end subroutine ishigami_shares

  !> The errors of shares tell how they scatter, for a function with a product of two parameters, which makes the deviations from
  !> the polynomials uneven: over many studies the deviation of a share from its value is its error, or up to a third less.
  subroutine share_errors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: studies = 200
    type(parameter_type) :: parameters(3)
    real(wp), allocatable :: drawn(:, :), numbers(:, :)
    type(shares_type), allocatable :: shares(:)
    type(study_type) :: study
    real(wp) :: values(3), x(3), exact(3), squares(3), errors(3), bias(3)
    integer :: run, seed

    call make_parameters(parameters)
    study%kind = 'random'
    study%runs = 300
    ! x of deviation 1; variances 1, 4 and 1/4, and 1 for the product
    exact = [1.0_wp, 4.0_wp, 0.25_wp]/6.25_wp
    allocate (drawn(3, study%runs), numbers(1, study%runs))
    squares = 0.0_wp
    errors = 0.0_wp
    bias = 0.0_wp
    do seed = 1, studies
      study%seed = seed
      do run = 1, study%runs
        call values_of_run(study, parameters, run, values)
        x = [(values(1) - 2.0_wp)/0.1_wp, (values(2) - 5.0_wp)/0.6_wp*sqrt(3.0_wp), (values(3) - 1.0_wp)/2.0_wp*sqrt(3.0_wp)]
        drawn(:, run) = values
        numbers(:, run) = [x(1) + 2.0_wp*x(2) + 0.5_wp*x(3) + x(1)*x(3)]
      end do
      call find_shares(parameters, drawn, numbers, shares)
      squares = squares + (shares(1)%share - exact)**2/studies
      bias = bias + (shares(1)%share - exact)/studies
      errors = errors + shares(1)%error**2/studies
    end do
    call tester%is_true(all(abs(bias) < 0.5_wp*sqrt(errors)), 'shares have hardly any bias')
    call tester%is_true(all(sqrt(squares/errors) < 1.2_wp) .and. all(sqrt(squares/errors) > 0.6_wp), 'errors of shares')
  end subroutine share_errors

  !> The share of one parameter with a straight line through few runs, from another computation: the variance by which the square of
  !> the slope is too large comes from the slopes that are found where each run is left out in turn. It is that of the method HC3.
  subroutine left_out_runs(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 25                 ! of which ten determine each number of a straight line, and too few those of a parabola
    type(parameter_type) :: parameters(1)
    type(shares_type), allocatable :: shares(:)
    real(wp) :: values(1, n), numbers(1, n), x(n), slope, rest, variance, part
    integer :: i

    parameters(1)%value = 2.0_wp
    parameters(1)%spread = 0.1_wp
    do i = 1, n
      x(i) = 4.0_wp*uniform_at(7, i, 1) - 2.0_wp
      values(1, i) = 2.0_wp + 0.1_wp*x(i)
      numbers(1, i) = 0.5_wp*x(i) + x(i)**2 + uniform_at(7, i, 2)
    end do
    call find_shares(parameters, values, numbers, shares)
    slope = slope_of(x, numbers(1, :))
    rest = sum((numbers(1, :) - sum(numbers)/n - slope*(x - sum(x)/n))**2)/(n - 2)
    variance = 0.0_wp
    do i = 1, n
      associate (others => [x(:i - 1), x(i + 1:)])
        variance = variance + (slope_of(others, [numbers(1, :i - 1), numbers(1, i + 1:)]) - slope)**2
      end associate
    end do
    part = slope**2 - variance
    call tester%is_true(part > 0.1_wp*slope**2 .and. variance > 0.1_wp*slope**2, 'the variance matters, and leaves a share')
    call tester%near(shares(1)%share(1), part/(part + rest), 1e-12_wp, 'the share of a slope less its variance')

  contains

    !> The slope of the straight line through points by least squares.
    pure real(wp) function slope_of(x, y) result(slope)
      real(wp), intent(in) :: x(:)   !< (n) abscissas [1]
      real(wp), intent(in) :: y(:)   !< (n) values [1]

      associate (distances => x - sum(x)/size(x))
        slope = dot_product(distances, y)/dot_product(distances, distances)
      end associate
    end function slope_of
  end subroutine left_out_runs

  !> Too few runs, and a quantity that does not vary, have no shares. A parameter of one value has none of the variance.
  subroutine unknown_shares(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(parameter_type) :: parameters(3)
    real(wp), allocatable :: drawn(:, :), numbers(:, :)
    type(shares_type), allocatable :: shares(:)
    type(study_type) :: study
    real(wp) :: values(3)
    integer :: run

    call make_parameters(parameters)
    parameters(3)%high = parameters(3)%low
    study%kind = 'random'
    study%runs = 1000
    allocate (drawn(3, study%runs), numbers(2, study%runs))
    call find_shares(parameters, drawn(:, :0), numbers(:, :0), shares)
    call tester%is_true(.not. any(shares%known), 'no runs have no shares')
    do run = 1, study%runs
      call values_of_run(study, parameters, run, values)
      drawn(:, run) = values
      numbers(:, run) = [sum(values), 3.0_wp + epsilon(1.0_wp)*mod(run, 3)]
    end do
    call find_shares(parameters, drawn(:, :20), numbers(:, :20), shares)
    call tester%is_true(.not. any(shares%known), 'twenty runs have no shares')
    call find_shares(parameters, drawn, numbers, shares)
    call tester%is_true(shares(1)%known .and. .not. shares(2)%known, 'a constant has no shares')
    call tester%near(shares(1)%share(3), 0.0_wp, 0.0_wp, 'a parameter of one value has no share')
    call tester%near(shares(1)%share(1), 0.01_wp/0.13_wp, 1e-12_wp, 'the other ones have all')
  end subroutine unknown_shares
end module test_statistics
