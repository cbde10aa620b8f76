!> Numbers that are made zero again in every evaluation.
module mech9_zero
  use mech9_kinds, only: wp
  implicit none
  private
  public :: make_zero

contains

  !> Make numbers zero. The shape is explicit, so that the loop needs no strides.
  pure subroutine make_zero(n, numbers)
    integer, intent(in) :: n              !< number of elements
    real(wp), intent(out) :: numbers(n)   !< all zero afterwards
    integer :: i

    do i = 1, n
      numbers(i) = 0.0_wp
    end do
  end subroutine make_zero
end module mech9_zero
