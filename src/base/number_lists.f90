!> Lists of whole numbers.
module mech9_number_lists
  implicit none
  private
  public :: same_numbers

contains

  !> Whether two lists have the same numbers in the same order.
  pure logical function same_numbers(a, b)
    integer, intent(in) :: a(:)   !< one list
    integer, intent(in) :: b(:)   !< the other

    same_numbers = size(a) == size(b)
    if (same_numbers) same_numbers = all(a == b)
  end function same_numbers
end module mech9_number_lists
