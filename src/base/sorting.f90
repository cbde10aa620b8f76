!> Sorting by keys.
module mech9_sorting
  use mech9_kinds, only: wp
  implicit none
  private
  public :: sort_by

contains

  !> Sort numbers of things by the keys of these, ascending; those with equal keys keep their order. Keys are finite. It is a merge
  !> sort from the bottom up (Knuth, The Art of Computer Programming, vol. 3, section 5.2.4).
  pure subroutine sort_by(keys, order)
    real(wp), intent(in) :: keys(:)        !< key of each thing, by its number
    integer, intent(inout) :: order(:)     !< numbers of things, some or all of them
    integer :: other(size(order)), width, first, middle, last, left, right, i

    do i = 2, size(order)
      if (keys(order(i - 1)) > keys(order(i))) exit
    end do
    if (i > size(order)) return
    width = 1
    do while (width < size(order))
      do first = 1, size(order), 2*width
        middle = min(first + width, size(order) + 1)
        last = min(first + 2*width, size(order) + 1)
        left = first
        right = middle
        do i = first, last - 1
          if (takes_left()) then
            other(i) = order(left)
            left = left + 1
          else
            other(i) = order(right)
            right = right + 1
          end if
        end do
      end do
      order = other
      width = 2*width
    end do

  contains

    !> Whether the next number comes from the left part.
    pure logical function takes_left()
      takes_left = left < middle
      if (takes_left .and. right < last) takes_left = .not. keys(order(left)) > keys(order(right))
    end function takes_left
  end subroutine sort_by
end module mech9_sorting
