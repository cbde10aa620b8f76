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
end module mech9_polynomial_drive
