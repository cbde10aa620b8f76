!> Masks, which mark some of the numbers 1, 2, ...
module mech9_masks
  implicit none
  private
  public :: numbers_of

contains

  !> The numbers that a mask marks.
  pure function numbers_of(mask) result(numbers)
    logical, intent(in) :: mask(:)    !< (n) true for the numbers that are marked
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = pack([(i, i=1, size(mask))], mask)
  end function numbers_of
end module mech9_masks
