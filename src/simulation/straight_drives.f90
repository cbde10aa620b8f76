!> Drives that move the independent coordinates along a straight line.
module mech9_straight_drives
  use mech9_kinds, only: wp
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  implicit none
  private
  public :: straight_drives

contains

  !> Drives that move coordinates from their values at t = 0 by given distances within 1 s.
  subroutine straight_drives(coordinates, from, distances, drives)
    integer, intent(in) :: coordinates(:)                          !< (n) their numbers
    real(wp), intent(in) :: from(:)                                !< (n) their values at t = 0 [rad, m]
    real(wp), intent(in) :: distances(:)                           !< (n) how far they move; zero: held [rad, m]
    type(drive_slot_type), allocatable, intent(out) :: drives(:)   !< (n) one for each of them
    type(polynomial_law_type) :: drive
    integer :: i

    allocate (drives(size(coordinates)))
    do i = 1, size(coordinates)
      drive%coordinate = coordinates(i)
      drive%coefficients = [from(i), distances(i)]
      allocate (drives(i)%drive, source=drive)
    end do
  end subroutine straight_drives
end module mech9_straight_drives
