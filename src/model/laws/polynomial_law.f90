!> A law with the function q = c0 + c1 t + c2 t^2 + ...
module mech9_polynomial_law
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_law, only: law_type, repetition_type, stands_still, moves_steadily, never_repeats
  implicit none
  private
  public :: polynomial_law_type

  !> Terms of the Taylor series about a time are computed one by one up to this power.
  integer, parameter :: highest = 12

  !> A polynomial law by its coefficients.
  type, extends(law_type) :: polynomial_law_type
    real(wp), allocatable :: coefficients(:)   !< c0, c1, ... [rad or m, per s^i]
  contains
    procedure :: evaluate
    procedure :: greatest_rate
    procedure :: repetition
    procedure :: constants
    procedure :: vary
    procedure :: antiderivatives
    procedure :: vary_antiderivatives
  end type polynomial_law_type

contains

  !> Horner's rule gives the value and its derivatives at once.
  subroutine evaluate(self, t, q, dq, ddq, err)
    class(polynomial_law_type), intent(in) :: self    !< the polynomial law
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(out) :: q                          !< the coordinate [rad, m]
    real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call sum_terms(self%coefficients, t, q, dq, ddq)
    if (.not. (ieee_is_finite(q) .and. ieee_is_finite(dq) .and. ieee_is_finite(ddq))) &
      call raise(err, exit_data, 'the polynomial of the '//trim(self%owner())//' or a derivative of it is beyond all '// &
                 'numbers at '//trim(self%wording_at(t, 12))//'; correct its coefficients', self%place)
  end subroutine evaluate

  !> A polynomial and its first two derivatives.
  pure subroutine sum_terms(coefficients, t, q, dq, ddq)
    real(wp), intent(in) :: coefficients(:)   !< of 1, t, t^2, ...
    real(wp), intent(in) :: t                 !< [s]
    real(wp), intent(out) :: q                !< the polynomial at t
    real(wp), intent(out) :: dq               !< its first derivative
    real(wp), intent(out) :: ddq              !< its second derivative
    integer :: i

    q = 0.0_wp
    dq = 0.0_wp
    ddq = 0.0_wp
    do i = size(coefficients), 1, -1
      ddq = ddq*t + dq
      dq = dq*t + q
      q = q*t + coefficients(i)
    end do
    ddq = 2.0_wp*ddq
  end subroutine sum_terms

  !> How the polynomial repeats: a constant stands still, and one of the first degree moves steadily.
  pure type(repetition_type) function repetition(self) result(found)
    class(polynomial_law_type), intent(in) :: self   !< the polynomial law
    integer :: degree

    do degree = size(self%coefficients) - 1, 1, -1
      if (abs(self%coefficients(degree + 1)) > 0.0_wp) exit
    end do
    found%kind = never_repeats
    if (degree <= 0) found%kind = stands_still
    if (degree == 1) found%kind = moves_steadily
    if (degree == 1) found%rate = self%coefficients(2)
  end function repetition

  !> The coefficients.
  pure subroutine constants(self, values)
    class(polynomial_law_type), intent(in) :: self   !< the polynomial law
    real(wp), allocatable, intent(out) :: values(:)  !< c0, c1, ...

    values = self%coefficients
  end subroutine constants

  !> The derivatives by one parameter: a polynomial with the derivatives of the coefficients.
  subroutine vary(self, change, t, q, dq, ddq)
    class(polynomial_law_type), intent(in) :: self   !< the polynomial law
    real(wp), intent(in) :: change(:)                !< derivatives of the coefficients
    real(wp), intent(in) :: t                        !< time [s]
    real(wp), intent(out) :: q                       !< derivative of the coordinate [rad, m]
    real(wp), intent(out) :: dq                      !< derivative of its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                     !< derivative of its acceleration [rad/s^2, m/s^2]

    call sum_terms(change, t, q, dq, ddq)
  end subroutine vary

  !> The bound is the sum of the sizes of the terms of the Taylor series of the rate at t, k |q^(k)|/k! |h|^(k-1) for k up
  !> to `highest`, and of a bound of the remainder, from the next derivative of the polynomial with the sizes of the
  !> coefficients. It is never too small, exact for a constant rate, and close for small h. The work is linear in the
  !> number of coefficients.
  function greatest_rate(self, t, h) result(rate)
    class(polynomial_law_type), intent(in) :: self   !< the polynomial law
    real(wp), intent(in) :: t   !< beginning of the interval [s]
    real(wp), intent(in) :: h   !< length of the interval [s]; may be negative
    real(wp) :: rate                 !< [rad/s or m/s]
    real(wp) :: terms(0:highest), sizes(0:highest + 1)
    integer :: k, last

    rate = 0.0_wp
    if (size(self%coefficients) <= 2) then
      if (size(self%coefficients) == 2) rate = abs(self%coefficients(2))
      return
    end if
    last = max(min(highest, size(self%coefficients) - 1), 0)
    if (size(self%coefficients) > highest + 1) then
      call find_terms(self%coefficients, .true., max(abs(t), abs(t + h)), highest + 1, sizes)
      rate = (highest + 1)*sizes(highest + 1)
    end if
    call find_terms(self%coefficients, .false., t, last, terms)
    do k = last, 1, -1
      rate = rate*abs(h) + k*abs(terms(k))
    end do
  end function greatest_rate

  !> Value and derivatives of a polynomial, divided by the factorials of their orders, by Horner's rule.
  pure subroutine find_terms(coefficients, of_sizes, t, last, terms)
    real(wp), intent(in) :: coefficients(:)   !< of 1, t, t^2, ...
    logical, intent(in) :: of_sizes           !< take the sizes of the coefficients instead of the coefficients
    real(wp), intent(in) :: t                 !< [s]
    integer, intent(in) :: last               !< highest order
    real(wp), intent(out) :: terms(0:last)    !< k-th derivative at t over k!
    real(wp) :: c
    integer :: i, k

    terms = 0.0_wp
    do i = size(coefficients), 1, -1
      c = coefficients(i)
      if (of_sizes) c = abs(c)
      do k = last, 1, -1
        terms(k) = terms(k)*t + terms(k - 1)
      end do
      terms(0) = terms(0)*t + c
    end do
  end subroutine find_terms

  !> The law, its integral from 0, and the integral of this one, by Horner's rule.
  pure subroutine antiderivatives(self, x, value, first, second)
    class(polynomial_law_type), intent(in) :: self   !< the polynomial law
    real(wp), intent(in) :: x                        !< its variable [s, or its unit]
    real(wp), intent(out) :: value                   !< the law
    real(wp), intent(out) :: first                   !< its integral
    real(wp), intent(out) :: second                  !< the integral of the integral

    call integrate_terms(self%coefficients, x, value, first, second)
  end subroutine antiderivatives

  !> The derivatives of both integrals by one parameter: integrals of a polynomial with the derivatives of the coefficients.
  pure subroutine vary_antiderivatives(self, change, x, first, second)
    class(polynomial_law_type), intent(in) :: self   !< the polynomial law
    real(wp), intent(in) :: change(:)                !< derivatives of the coefficients
    real(wp), intent(in) :: x                        !< its variable [s, or its unit]
    real(wp), intent(out) :: first                   !< derivative of the integral
    real(wp), intent(out) :: second                  !< derivative of the integral of the integral
    real(wp) :: value

    call integrate_terms(change, x, value, first, second)
  end subroutine vary_antiderivatives

  !> A polynomial and its integrals from 0.
  pure subroutine integrate_terms(coefficients, x, value, first, second)
    real(wp), intent(in) :: coefficients(:)   !< of 1, x, x^2, ...
    real(wp), intent(in) :: x                 !< the variable
    real(wp), intent(out) :: value            !< the polynomial
    real(wp), intent(out) :: first            !< its integral
    real(wp), intent(out) :: second           !< the integral of the integral
    integer :: i

    value = 0.0_wp
    first = 0.0_wp
    second = 0.0_wp
    do i = size(coefficients), 1, -1
      value = value*x + coefficients(i)
      first = first*x + coefficients(i)/i
      second = second*x + coefficients(i)/(i*(i + 1))
    end do
    first = first*x
    second = second*x**2
  end subroutine integrate_terms
end module mech9_polynomial_law
