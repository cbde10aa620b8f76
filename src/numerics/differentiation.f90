!> Derivatives of a smooth function of one variable from its values alone, to near round-off.
!>
!> Central differences over a wide symmetric stencil: the interpolating polynomial of degree 16
!> through x +- h, +- 2h, ... +- 8h. With h around 1/16 of the length over which the function changes,
!> truncation decreases to round-off while the differences stay large, so that both derivatives keep
!> twelve and more digits. A few steps h are tried; the one whose two highest orders agree best wins.
module mech9_differentiation
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  implicit none
  private
  public :: half_width, stencil_size, beside, step_count, trial_step, derivatives_from_stencil, best_slopes_type, &
    best_derivatives_type, length_along

  !> Points of the stencil on either side of its middle.
  integer, parameter :: half_width = 8
  !> Values on one stencil: x - 8h ... x + 8h, and one between them that tells whether the polynomial is the function.
  integer, parameter :: stencil_size = 2*half_width + 2
  !> Place of the value between the others, in steps from the middle. A function whose period is a step is seen there.
  real(wp), parameter :: beside = 0.40625_wp
  !> Values of Lagrange's polynomials of the stencil at this place.
  real(wp), parameter :: beside_weights(-half_width:half_width) = [ &
    2.8706488404701022e-06_wp, -5.213195193832624e-05_wp, 0.0004520221686359751_wp, -0.002499621626175816_wp, &
    0.009967462832037961_wp, -0.03094485708588666_wp, 0.08030927196099158_wp, -0.19631155368242387_wp, 0.7644824927055929_wp, &
    0.464948416616267_wp, -0.1212512537450265_wp, 0.04063842677544152_wp, -0.01222097616797698_wp, 0.002941731573662695_wp, &
    -0.0005176790199462284_wp, 5.855579435726692e-05_wp, -3.1777964530306893e-06_wp]
  !> Number of steps h that are tried.
  integer, parameter :: step_count = 7

  !> Errors of a derivative that always count as small, and a thousandth of what counts so for values of one.
  real(wp), parameter :: least_error = 1.0e-9_wp

  !> First derivatives of several functions by the best one of the stencils that were offered.
  type :: best_slopes_type
    real(wp), allocatable :: slopes(:)   !< (functions) first derivatives; not allocated before the first stencil
    real(wp) :: error = huge(1.0_wp)     !< estimated error of the worst of them
  contains
    procedure :: offer
  end type best_slopes_type

  !> Most functions whose derivatives are looked for together.
  integer, parameter :: most_functions = 9

  !> First and second derivatives of several functions by the best one of the stencils that were offered: the widest one whose error is
  !> round-off, or else the one with the least error.
  type :: best_derivatives_type
    real(wp) :: value(most_functions) = 0.0_wp
    real(wp) :: first(most_functions) = 0.0_wp
    real(wp) :: second(most_functions) = 0.0_wp
    real(wp), private :: error = huge(1.0_wp)   !< estimated error of the worst derivative
    logical :: is_found = .false.               !< there was a stencil of finite values
    logical :: is_smooth = .false.              !< the derivatives are known
  contains
    procedure :: offer => offer_checked
  end type best_derivatives_type

contains

  !> Take a stencil if it is better than those before. Values that are not finite are no stencil.
  pure subroutine offer_checked(self, values, between, h, good)
    class(best_derivatives_type), intent(inout) :: self         !< the derivatives so far
    real(wp), intent(in) :: values(:, -half_width:)             !< (functions, stencil) at x + i h, i = -8 .. 8
    real(wp), intent(in) :: between(:)                          !< (functions) at x + beside h
    real(wp), intent(in) :: h                                   !< step [unit of x]
    logical, intent(out) :: good                                !< the error is small, or near round-off: narrower ones are no better
    real(wp) :: first(size(values, 1)), second(size(values, 1)), error, worst
    integer :: i
    logical :: is_smooth, all_smooth

    good = .false.
    if (.not. (all(ieee_is_finite(values)) .and. all(ieee_is_finite(between)))) return
    worst = 0.0_wp
    all_smooth = .true.
    do i = 1, size(first)
      call derivatives_from_stencil(values(i, :), h, first(i), second(i), error, between(i), is_smooth)
      worst = max(worst, error)
      all_smooth = all_smooth .and. is_smooth
    end do
    if (worst < self%error) then
      self%error = worst
      self%is_found = .true.
      self%is_smooth = all_smooth
      self%value(:size(first)) = values(:, 0)
      self%first(:size(first)) = first
      self%second(:size(first)) = second
    end if
    good = worst <= max(1.0e-12_wp, 16.0_wp*epsilon(h)/h**2)*maxval(abs(values))
  end subroutine offer_checked

  !> Take a stencil if it is better than those before. Values that are not finite are no stencil.
  pure subroutine offer(self, values, h, good)
    class(best_slopes_type), intent(inout) :: self              !< the derivatives so far
    real(wp), intent(in) :: values(:, -half_width:)             !< (functions, stencil) at x + i h, i = -8 .. 8
    real(wp), intent(in) :: h                                   !< step [unit of x]
    logical, intent(out) :: good                                !< the error is near round-off: narrower stencils are no better
    real(wp) :: trial(size(values, 1)), second, error, worst
    integer :: i

    good = .false.
    if (.not. all(ieee_is_finite(values))) return
    worst = 0.0_wp
    do i = 1, size(trial)
      call derivatives_from_stencil(values(i, :), h, trial(i), second, error)
      worst = max(worst, h*error)
    end do
    if (worst < self%error) then
      self%error = worst
      self%slopes = trial
    end if
    good = worst <= 64.0_wp*epsilon(h)*maxval(abs(values))/h
  end subroutine offer

  !> The length over which a function of several numbers is expected to change if these go on in a given direction: half of that in
  !> which one of them would come to zero, so that no stencil reaches zero, where functions may not exist.
  pure real(wp) function length_along(numbers, direction) result(length)
    real(wp), intent(in) :: numbers(:)     !< the numbers
    real(wp), intent(in) :: direction(:)   !< their changes per unit of length, not all zero
    integer :: i

    length = huge(length)
    do i = 1, size(numbers)
      if (.not. abs(direction(i)) > 0.0_wp) cycle
      length = min(length, 0.5_wp*merge(abs(numbers(i)), 1.0_wp, abs(numbers(i)) > 0.0_wp)/abs(direction(i)))
    end do
  end function length_along

  !> The trial step of this number (1 .. step_count), for a function that varies over lengths of `scale`,
  !> from 1/8 of it down by factors of 4.
  pure real(wp) function trial_step(number, scale) result(h)
    integer, intent(in) :: number   !< 1 for the longest step, to step_count
    real(wp), intent(in) :: scale   !< length over which the function changes, greater than 0 [unit of x]

    ! powers of two: x + i h is then exact for moderate x
    h = 2.0_wp**exponent(scale)*2.0_wp**(-2 - 2*number)
  end function trial_step

  !> First and second derivative from values on a stencil of step h, with an estimate of the error of the worse one: the
  !> difference between degrees 16 and 14 together with the round-off of the values, and where a value between them is given, its
  !> distance from the polynomial, per h.
  pure subroutine derivatives_from_stencil(values, h, first, second, error, between, is_smooth)
    real(wp), intent(in) :: values(-half_width:half_width)   !< at x + i h, i = -8 .. 8
    real(wp), intent(in) :: h   !< step [unit of x]
    real(wp), intent(out) :: first   !< derivative at x
    real(wp), intent(out) :: second   !< second derivative at x
    real(wp), intent(out) :: error   !< estimated error of the worse derivative
    real(wp), intent(in), optional :: between   !< value at x + beside h
    logical, intent(out), optional :: is_smooth   !< with `between`: errors are below a thousandth of the derivatives, or mean nothing
    real(wp) :: odd(half_width), even(half_width), first_lower, second_lower, round_off, deviation, strictest
    integer :: i

    do i = 1, half_width
      odd(i) = values(i) - values(-i)
      even(i) = (values(i) - values(0)) + (values(-i) - values(0))
    end do
    first = 0.0_wp
    second = 0.0_wp
    first_lower = 0.0_wp
    second_lower = 0.0_wp
    do i = half_width, 1, -1
      first = first + weight(half_width, i)*odd(i)/i
      second = second + 2.0_wp*weight(half_width, i)*even(i)/i**2
      if (i == half_width) cycle
      first_lower = first_lower + weight(half_width - 1, i)*odd(i)/i
      second_lower = second_lower + 2.0_wp*weight(half_width - 1, i)*even(i)/i**2
    end do
    first = first/h
    second = second/h**2
    second_lower = second_lower/h**2
    round_off = 8.0_wp*epsilon(h)*maxval(abs(values))/h**2
    error = max(abs(second - second_lower), abs(first - first_lower/h)) + round_off
    if (.not. (present(between) .and. present(is_smooth))) return
    deviation = abs(between - dot_product(beside_weights, values))
    error = max(error, deviation/h)
    ! degrees agree on the mean of a second derivative that jumps, but not on the first derivative
    strictest = max(abs(second - second_lower), abs(first - first_lower/h)/h, deviation/h**2)
    is_smooth = strictest <= 1.0e-3_wp*max(abs(first), abs(second)) + 2.0_wp*round_off + &
                least_error*(1.0_wp + 1.0e3_wp*maxval(abs(values)))
  end subroutine derivatives_from_stencil

  !> (-1)^(i+1) (n!)^2 / ((n-i)! (n+i)!): the central-difference weight of order 2n at i.
  pure real(wp) function weight(n, i)
    integer, intent(in) :: n   !< half width of the stencil, 1 or more
    integer, intent(in) :: i   !< number of the point beside the middle, 1 .. n
    integer :: k

    weight = merge(1.0_wp, -1.0_wp, mod(i, 2) == 1)
    do k = 1, i
      weight = weight*(n - i + k)/real(n + k, wp)
    end do
  end function weight
end module mech9_differentiation
