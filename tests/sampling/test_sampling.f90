!> Values of studies: known answers of the random numbers, strata of Latin hypercubes, evenness of Sobol's points, quantiles, grids.
module test_sampling
  use mech9_kinds, only: wp, long
  use mech9_counted_random, only: philox, uniform_at
  use mech9_latin_hypercube, only: latin_at, permuted
  use mech9_sobol, only: sobol_at, sobol_bits, most_sobol_dimensions
  use mech9_normal_quantile, only: normal_quantile
  use mech9_parameter, only: parameter_type
  use mech9_study, only: study_type
  use mech9_study_values, only: values_of_run
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('known_answers')) call known_answers(tester)
    if (tester%runs('strata')) call strata(tester)
    if (tester%runs('even_points')) call even_points(tester)
    if (tester%runs('quantiles')) call quantiles(tester)
    if (tester%runs('grids')) call grids(tester)
    if (tester%runs('moments')) call moments(tester)
  end subroutine run

  !> The answers that the authors of Philox publish for tests of it (Random123, kat_vectors).
  subroutine known_answers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer(long), parameter :: ones = 4294967295_long
    integer(long) :: words(2)

    call philox([0_long, 0_long], 0_long, words)
    call tester%is_true(all(words == [int(z'ff1dae59', long), int(z'6cd10df2', long)]), 'Philox of zeros')
    call philox([ones, ones], ones, words)
    call tester%is_true(all(words == [int(z'2c3f628b', long), int(z'ab4fd7ad', long)]), 'Philox of ones')
    call philox([int(z'243f6a88', long), int(z'85a308d3', long)], int(z'13198a2e', long), words)
    call tester%is_true(all(words == [int(z'dd7ce038', long), int(z'f62a4c12', long)]), 'Philox of digits of pi')
  end subroutine known_answers

  !> Each stratum of each dimension holds one run, for numbers of runs on both sides of powers of four.
  subroutine strata(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: counts(*) = [1, 2, 3, 4, 5, 15, 16, 17, 63, 64, 65, 300]
    integer :: i, k, n, dimension
    logical :: hit(300)

    do k = 1, size(counts)
      n = counts(k)
      do dimension = 1, 3
        hit = .false.
        do i = 1, n
          hit(1 + int(n*latin_at(5, i, dimension, n))) = .true.
        end do
        call tester%is_true(all(hit(:n)), 'each stratum holds a run')
      end do
    end do
    call tester%is_true(any([(permuted(5, 1, i, 300) /= permuted(5, 2, i, 300), i=0, 9)]), 'dimensions have different strata')
    call tester%is_true(any([(permuted(5, 1, i, 300) /= permuted(6, 1, i, 300), i=0, 9)]), 'seeds have different strata')
  end subroutine strata

  !> Of 2**m points, each interval of length 2**-m holds one in each dimension; in the first two dimensions each cell of 2**-k by
  !> 2**(k-m), too: they form a net with t = 0. Shifted points are as even.
  subroutine even_points(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: m = 8
    integer(long), allocatable :: digits(:, :)
    logical :: hit(0:2**m - 1)
    integer :: i, k, dimension, cell

    allocate (digits(0:2**m - 1, most_sobol_dimensions))
    do dimension = 1, most_sobol_dimensions
      do i = 0, 2**m - 1
        digits(i, dimension) = sobol_bits(i, dimension)
      end do
      hit = .false.
      hit(int(shiftr(digits(:, dimension), 32 - m))) = .true.
      call tester%is_true(all(hit), 'each interval holds a point')
      hit = .false.
      do i = 1, 2**m
        hit(int(2**m*sobol_at(3, i, dimension))) = .true.
      end do
      call tester%is_true(all(hit), 'each interval holds a shifted point')
    end do
    do k = 0, m
      hit = .false.
      do i = 0, 2**m - 1
        cell = int(shiftr(digits(i, 1), 32 - k)*2**(m - k) + shiftr(digits(i, 2), 32 - (m - k)))
        hit(cell) = .true.
      end do
      call tester%is_true(all(hit), 'each cell of the first two dimensions holds a point')
    end do
  end subroutine even_points

  !> The quantile of the probability of x is x.
  subroutine quantiles(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp) :: x
    integer :: i

    do i = -160, 160
      x = 0.05_wp*i
      ! the probability of the upper tail has lost digits: its error is some 1e-16 over the density
      call tester%near(normal_quantile(0.5_wp*erfc(-x/sqrt(2.0_wp))), x, 1e-15_wp + 6e-16_wp*exp(0.5_wp*max(x, 0.0_wp)**2), &
                       'the quantile of a probability')
    end do
  end subroutine quantiles

  !> The last parameter changes fastest; ends are met exactly.
  subroutine grids(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(parameter_type) :: parameters(2)
    type(study_type) :: study
    real(wp) :: values(2)

    parameters%has_range = .true.
    parameters%low = [0.1_wp, -1.0_wp]
    parameters%high = [0.7_wp, 1.0_wp]
    parameters%count = [3, 5]
    study%kind = 'grid'
    study%runs = 15
    call values_of_run(study, parameters, 1, values)
    call near_all(tester, values, [0.1_wp, -1.0_wp], 0.0_wp, 'the first point')
    call values_of_run(study, parameters, 2, values)
    call near_all(tester, values, [0.1_wp, -0.5_wp], 0.0_wp, 'the last parameter changes first')
    call values_of_run(study, parameters, 8, values)
    call near_all(tester, values, [0.4_wp, 0.0_wp], 1e-16_wp, 'the middle')
    call values_of_run(study, parameters, 15, values)
    call near_all(tester, values, [0.7_wp, 1.0_wp], 0.0_wp, 'the last point')
  end subroutine grids

  !> Check several numbers.
  subroutine near_all(tester, numbers, expected, tolerance, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), intent(in) :: numbers(:)           !< found
    real(wp), intent(in) :: expected(:)          !< as many, the right ones
    real(wp), intent(in) :: tolerance            !< largest difference
    character(len=*), intent(in) :: why          !< words for the check
    integer :: i

    do i = 1, size(numbers)
      call tester%near(numbers(i), expected(i), tolerance, why)
    end do
  end subroutine near_all

  !> Means and deviations of drawn values, within five standard errors where they are independent; better where they are not.
  subroutine moments(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 4096
    character(len=6), parameter :: kinds(3) = ['random', 'latin ', 'sobol ']
    type(parameter_type) :: parameters(3)
    type(study_type) :: study
    real(wp), allocatable :: values(:, :)
    real(wp) :: mean(3), deviation(3), tolerance
    integer :: i, k

    allocate (values(3, n))
    parameters%value = [2.0_wp, 1.0_wp, 0.0_wp]
    parameters%spread = [0.5_wp, 0.25_wp, 0.0_wp]
    parameters%uniform = [.false., .true., .false.]
    parameters%low = [0.0_wp, 0.0_wp, 3.0_wp]
    parameters%high = [0.0_wp, 0.0_wp, 4.0_wp]
    study%runs = n
    study%seed = 11
    do k = 1, 3
      study%kind = kinds(k)
      do i = 1, n
        call values_of_run(study, parameters, i, values(:, i))
      end do
      mean = sum(values, dim=2)/n
      deviation = sqrt(sum((values - spread(mean, 2, n))**2, dim=2)/(n - 1))
      tolerance = merge(5.0_wp/sqrt(real(n, wp)), 0.01_wp, k == 1)
      call near_all(tester, (mean - [2.0_wp, 1.0_wp, 3.5_wp])/[0.5_wp, 0.25_wp, 0.5_wp], [0.0_wp, 0.0_wp, 0.0_wp], tolerance, &
                    kinds(k)//': means')
      call near_all(tester, deviation/[0.5_wp, 0.25_wp/sqrt(3.0_wp), 1.0_wp/sqrt(12.0_wp)], [1.0_wp, 1.0_wp, 1.0_wp], tolerance, &
                       kinds(k)//': deviations')
    end do
    call tester%is_true(abs(uniform_at(1, 1, 1) - uniform_at(1, 2, 1)) > 0.0_wp, 'runs differ')
  end subroutine moments
end module test_sampling
