!> The share of each parameter in the variance of a quantity, from runs whose values were drawn.
!>
!> The share of first order of a parameter is the variance of the expectation of the quantity when this parameter alone is known,
!> over the whole variance (I. M. Sobol', 1993). The expectations are sums of polynomials of one parameter each, orthogonal and of
!> variance one under the distribution of the parameter: Hermite's for normal values, Legendre's for uniform ones. The coefficients
!> are found by least squares, so that their squares are the variances (B. Sudret, "Global sensitivity analysis using polynomial
!> chaos expansions", Reliability Engineering and System Safety 93, 964-979, 2008). The rest of the variance belongs to several
!> parameters together, or to polynomials of higher degree. It may be larger for some values than for others; the variances of the
!> coefficients are those of the method HC3 of J. G. MacKinnon and H. White, "Some heteroskedasticity-consistent covariance matrix
!> estimators with improved finite sample properties", Journal of Econometrics 29, 305-325, 1985.
module mech9_main_effects
  use mech9_kinds, only: wp
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_parameter, only: parameter_type
  implicit none
  private
  public :: shares_type, find_shares

  integer, parameter :: highest_degree = 4      !< of the polynomials
  integer, parameter :: most_functions = 128    !< polynomials, where more would only make the error larger
  integer, parameter :: runs_per_function = 10  !< fewer runs determine polynomials of a lower degree

  !> The shares in the variance of one quantity.
  type :: shares_type
    logical :: known = .false.               !< there are enough runs, and the quantity varies
    real(wp), allocatable :: share(:)        !< (parameters) of first order
    real(wp), allocatable :: error(:)        !< (parameters) standard errors of these for runs that are drawn independently
    real(wp) :: rest = 0.0_wp                !< of the variance that no parameter has alone
  end type shares_type

  !> The fit of quantities by polynomials.
  type :: fit_type
    integer :: degree = 0                              !< highest degree of the polynomials; 0: there are too few runs
    real(wp), allocatable :: factors(:, :)             !< (functions,functions) Cholesky factors of their products over all runs
    real(wp), allocatable :: coefficients(:, :)        !< (functions,quantities)
    real(wp), allocatable :: variances(:, :)           !< (functions,quantities) of the coefficients
    real(wp), allocatable :: second(:)                 !< (quantities) sum of the squares of the deviations from the fit
    real(wp), allocatable :: fourth(:)                 !< (quantities) sum of their fourth powers
  end type fit_type

contains

  !> The shares of the parameters in the variances of quantities, by polynomials of the highest degree that the runs determine.
  pure subroutine find_shares(parameters, values, numbers, shares)
    type(parameter_type), intent(in) :: parameters(:)            !< with their distributions
    real(wp), intent(in) :: values(:, :)                         !< (parameters,runs)
    real(wp), intent(in) :: numbers(:, :)                        !< (quantities,runs)
    type(shares_type), allocatable, intent(out) :: shares(:)     !< (quantities)
    type(fit_type) :: fit
    type(parameter_type), allocatable :: chosen(:)
    integer, allocatable :: varied(:)
    real(wp), allocatable :: scaled(:, :)
    integer :: i

    allocate (shares(size(numbers, 1)))
    varied = pack([(i, i=1, size(parameters))], [(.not. is_constant(parameters(i)), i=1, size(parameters))])
    if (size(varied) == 0 .or. size(numbers, 2) == 0) return
    allocate (chosen(size(varied)))
    do i = 1, size(varied)
      chosen(i) = parameters(varied(i))
    end do
    call factorize_products(chosen, values(varied, :), fit)
    if (fit%degree == 0) return
    ! shares have no unit: powers of two keep the fourth powers of large numbers finite, and change no digit
    allocate (scaled, source=numbers)
    do i = 1, size(shares)
      scaled(i, :) = scale(scaled(i, :), -exponent(maxval(abs(numbers(i, :)))))
    end do
    call find_coefficients(chosen, values(varied, :), scaled, fit)
    call judge_coefficients(chosen, values(varied, :), scaled, fit)
    do i = 1, size(shares)
      call find_shares_of(fit, i, size(numbers, 2), maxval(abs(scaled(i, :))), varied, size(parameters), shares(i))
    end do
  end subroutine find_shares

  !> Choose the degree of the polynomials, and factorize the matrix of their products.
  pure subroutine factorize_products(parameters, values, fit)
    type(parameter_type), intent(in) :: parameters(:)   !< with their distributions
    real(wp), intent(in) :: values(:, :)                !< (parameters,runs)
    type(fit_type), intent(inout) :: fit                !< gets degree and factors
    real(wp), allocatable :: functions(:)
    integer :: degree, n, i, j, failed_at

    fit%degree = 0
    do degree = max(1, min(highest_degree, (most_functions - 1)/size(parameters))), 1, -1
      n = 1 + degree*size(parameters)
      if (size(values, 2) < runs_per_function*n) cycle
      if (allocated(functions)) deallocate (functions, fit%factors)
      allocate (functions(n))
      allocate (fit%factors(n, n), source=0.0_wp)
      do j = 1, size(values, 2)
        call find_functions(parameters, degree, values(:, j), functions)
        do i = 1, n
          fit%factors(i:, i) = fit%factors(i:, i) + functions(i:)*functions(i)
        end do
      end do
      call cholesky_factorize(n, fit%factors, failed_at)
      if (failed_at > 0) cycle
      fit%degree = degree
      return
    end do
  end subroutine factorize_products

  !> Find the coefficients of the polynomials by least squares.
  pure subroutine find_coefficients(parameters, values, numbers, fit)
    type(parameter_type), intent(in) :: parameters(:)   !< with their distributions
    real(wp), intent(in) :: values(:, :)                !< (parameters,runs)
    real(wp), intent(in) :: numbers(:, :)               !< (quantities,runs)
    type(fit_type), intent(inout) :: fit                !< gets the coefficients
    real(wp) :: functions(size(fit%factors, 1))
    integer :: i, j

    allocate (fit%coefficients(size(functions), size(numbers, 1)), source=0.0_wp)
    do j = 1, size(values, 2)
      call find_functions(parameters, fit%degree, values(:, j), functions)
      do i = 1, size(numbers, 1)
        ! the differences from the first run have more digits than the numbers
        fit%coefficients(:, i) = fit%coefficients(:, i) + functions*(numbers(i, j) - numbers(i, 1))
      end do
    end do
    do i = 1, size(numbers, 1)
      call cholesky_solve(size(functions), fit%factors, fit%coefficients(:, i))
    end do
  end subroutine find_coefficients

  !> Find the variances of the coefficients from the deviations of the runs from a fit without them.
  pure subroutine judge_coefficients(parameters, values, numbers, fit)
    type(parameter_type), intent(in) :: parameters(:)   !< with their distributions
    real(wp), intent(in) :: values(:, :)                !< (parameters,runs)
    real(wp), intent(in) :: numbers(:, :)               !< (quantities,runs)
    type(fit_type), intent(inout) :: fit                !< with coefficients; gets the variances
    real(wp), dimension(size(fit%factors, 1)) :: functions, weights
    real(wp) :: leverage, deviation
    integer :: i, j

    allocate (fit%variances(size(functions), size(numbers, 1)), source=0.0_wp)
    allocate (fit%second(size(numbers, 1)), fit%fourth(size(numbers, 1)), source=0.0_wp)
    do j = 1, size(values, 2)
      call find_functions(parameters, fit%degree, values(:, j), functions)
      weights = functions
      call cholesky_solve(size(functions), fit%factors, weights)
      ! the share of a run in its own fitted number
      leverage = min(dot_product(functions, weights), 1.0_wp - sqrt(epsilon(leverage)))
      do i = 1, size(numbers, 1)
        deviation = numbers(i, j) - numbers(i, 1) - dot_product(functions, fit%coefficients(:, i))
        fit%second(i) = fit%second(i) + deviation**2
        fit%fourth(i) = fit%fourth(i) + deviation**4
        fit%variances(:, i) = fit%variances(:, i) + (deviation/(1.0_wp - leverage)*weights)**2
      end do
    end do
  end subroutine judge_coefficients

  !> One, then the polynomials of first degree of all parameters, then those of second degree and so on.
  pure subroutine find_functions(parameters, degree, values, functions)
    type(parameter_type), intent(in) :: parameters(:)   !< with their distributions
    integer, intent(in) :: degree                       !< highest degree
    real(wp), intent(in) :: values(:)                   !< (parameters) of a run
    real(wp), intent(out) :: functions(:)               !< (1+degree*parameters) mean 0 and variance 1, but for the first
    real(wp) :: x, before, present, next
    integer :: i, k, n

    n = size(parameters)
    functions(1) = 1.0_wp
    do i = 1, n
      x = standard_value(parameters(i), values(i))
      before = 0.0_wp
      present = 1.0_wp
      do k = 1, degree
        if (is_normal(parameters(i))) then
          ! over the root of the factorial of the degree
          next = (x*present - sqrt(real(k - 1, wp))*before)/sqrt(real(k, wp))
          functions(1 + (k - 1)*n + i) = next
        else
          next = ((2*k - 1)*x*present - (k - 1)*before)/k
          functions(1 + (k - 1)*n + i) = next*sqrt(2.0_wp*k + 1.0_wp)
        end if
        before = present
        present = next
      end do
    end do
  end subroutine find_functions

  !> Whether the values of a parameter are drawn from a normal distribution.
  pure logical function is_normal(parameter)
    type(parameter_type), intent(in) :: parameter   !< with a spread or a range

    is_normal = parameter%spread > 0.0_wp .and. .not. parameter%uniform
  end function is_normal

  !> A value in deviations from the mean of a normal distribution, or from -1 to 1 over a uniform one.
  pure real(wp) function standard_value(parameter, value) result(x)
    type(parameter_type), intent(in) :: parameter   !< with a spread or a range
    real(wp), intent(in) :: value                   !< in the units of the file

    if (parameter%spread > 0.0_wp) then
      x = (value - parameter%value)/parameter%spread
    else
      x = (2.0_wp*value - parameter%low - parameter%high)/(parameter%high - parameter%low)
    end if
  end function standard_value

  !> Whether a parameter has one value in all runs, so that its polynomials are left zero.
  pure logical function is_constant(parameter)
    type(parameter_type), intent(in) :: parameter   !< with a spread or a range

    is_constant = .not. (parameter%spread > 0.0_wp .or. parameter%high > parameter%low)
  end function is_constant

  !> The shares of the parameters in the variance of one quantity. The square of a coefficient is too large by its variance, on
  !> average.
  pure subroutine find_shares_of(fit, quantity, runs, level, varied, n_parameters, shares)
    type(fit_type), intent(in) :: fit           !< the fit of all quantities
    integer, intent(in) :: quantity             !< its number
    integer, intent(in) :: runs                 !< how many there are
    real(wp), intent(in) :: level               !< largest magnitude of the quantity
    integer, intent(in) :: varied(:)            !< numbers of the parameters that vary
    integer, intent(in) :: n_parameters         !< how many there are with the others
    type(shares_type), intent(inout) :: shares  !< of this quantity
    real(wp), dimension(size(varied)) :: parts, of_parts
    real(wp) :: rest, total, of_rest
    integer :: n, functions, i

    n = size(varied)
    functions = size(fit%factors, 1)
    do i = 1, n
      associate (c => fit%coefficients(1 + i::n, quantity), v => fit%variances(1 + i::n, quantity))
        parts(i) = max(0.0_wp, sum(c**2 - v))
        of_parts(i) = 4.0_wp*sum(c**2*v) + 2.0_wp*sum(v**2)
      end associate
    end do
    rest = fit%second(quantity)/(runs - functions)
    of_rest = max(0.0_wp, fit%fourth(quantity)/runs - (fit%second(quantity)/runs)**2)/runs
    total = sum(parts) + rest
    ! a quantity that varies by round-off alone has no shares
    shares%known = sqrt(total) > 1e3_wp*epsilon(level)*level
    if (.not. shares%known) return
    allocate (shares%share(n_parameters), shares%error(n_parameters), source=0.0_wp)
    shares%rest = rest/total
    parts = parts/total
    shares%share(varied) = parts
    shares%error(varied) = sqrt(max(0.0_wp, (1.0_wp - 2.0_wp*parts)*of_parts + parts**2*(sum(of_parts) + of_rest)))/total
  end subroutine find_shares_of
end module mech9_main_effects
