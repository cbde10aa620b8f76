!> Drive q = c0 + c1 t + c2 t^2 + ... Uses kinds, error, drive.
module mech9_polynomial_drive
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_drive, only: drive_type
  implicit none
  private
  public :: polynomial_drive_type

  type, extends(drive_type) :: polynomial_drive_type
    real(wp), allocatable :: coefficients(:)   !< c0, c1, ... [rad or m, per s^i]
  contains
    procedure :: evaluate
    procedure :: greatest_rate
  end type polynomial_drive_type

contains

  subroutine evaluate(self, t, q, dq, ddq, err)
    class(polynomial_drive_type), intent(in) :: self
    real(wp), intent(in) :: t
    real(wp), intent(out) :: q, dq, ddq
    type(error_type), allocatable, intent(out) :: err
    integer :: i

    q = 0.0_wp
    dq = 0.0_wp
    ddq = 0.0_wp
    do i = size(self%coefficients), 1, -1
      ddq = ddq*t + 2.0_wp*dq
      dq = dq*t + q
      q = q*t + self%coefficients(i)
    end do
  end subroutine evaluate

  !> By the sizes of all terms of its Taylor series at t, k |q^(k)|/k! |h|^(k-1): exact for a constant
  !> rate, close for small h, never too small.
  function greatest_rate(self, t, h) result(rate)
    class(polynomial_drive_type), intent(in) :: self
    real(wp), intent(in) :: t, h
    real(wp) :: rate, term, binomial
    integer :: i, k, n

    n = size(self%coefficients) - 1
    rate = 0.0_wp
    do k = n, 1, -1
      ! q^(k)/k! by Horner's rule, with i over k as factors of the coefficients
      binomial = 1.0_wp
      do i = 1, k
        binomial = binomial*real(n - k + i, wp)/i
      end do
      term = 0.0_wp
      do i = n, k, -1
        term = term*t + binomial*self%coefficients(i + 1)
        binomial = binomial*real(i - k, wp)/i
      end do
      rate = rate*abs(h) + k*abs(term)
    end do
  end function greatest_rate
end module mech9_polynomial_drive
