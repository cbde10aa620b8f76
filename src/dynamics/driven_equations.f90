!> Equations of motion in which some accelerations are given.
!>
!> Their unknowns are the accelerations beside those that rates and drives give, so that those of driven coordinates are zero.
module mech9_driven_equations
  use mech9_kinds, only: wp
  implicit none
  private
  public :: hold

contains

  !> Let the unknowns of driven coordinates be zero: their rows and columns become those of the unit matrix, and the right side
  !> zero. The other unknowns are then those of the equations of the free coordinates alone.
  pure subroutine hold(n, driven, matrix, right)
    integer, intent(in) :: n                     !< number of independent coordinates
    integer, intent(in) :: driven(:)             !< places of the driven ones among them
    real(wp), intent(inout) :: matrix(n, n)      !< lower triangle of the coefficients [kg m^2, kg m, kg]
    real(wp), intent(inout) :: right(n)          !< right side [N m or N]
    integer :: i, k

    do i = 1, size(driven)
      k = driven(i)
      matrix(k, :k - 1) = 0.0_wp
      matrix(k + 1:, k) = 0.0_wp
      matrix(k, k) = 1.0_wp
      right(k) = 0.0_wp
    end do
  end subroutine hold
end module mech9_driven_equations
