!> The text of a data file with other numbers, as programs change it: all else stays as its author wrote it.
module mech9_changed_text
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, exact_digits
  use mech9_source, only: span_type
  use mech9_document, only: group_type
  use mech9_lookup, only: find_item
  implicit none
  private
  public :: set_number, full_number

contains

  !> A number as data files hold it, without loss.
  pure function full_number(number) result(text)
    real(wp), intent(in) :: number   !< the number
    character(len=:), allocatable :: text

    text = to_text(number, exact_digits(number))
  end function full_number

  !> Set a number of a group: in the place of the one that stands there, or directly behind the name of the group. Groups are changed
  !> from the end of the file on, so that the places of those before stay right.
  pure subroutine set_number(group, name, number, text)
    type(group_type), intent(in) :: group                      !< the group of the data file
    character(len=*), intent(in) :: name                       !< of the item
    real(wp), intent(in) :: number                             !< the number
    character(len=:), allocatable, intent(inout) :: text       !< of the data file
    type(span_type) :: span
    integer :: i

    i = find_item(group, name)
    if (i > 0) then
      span = group%items(i)%values(1)%span
      text = text(:span%first - 1)//to_text(number, exact_digits(number))//text(span%last + 1:)
    else
      text = text(:group%span%last)//' '//name//'='//to_text(number, exact_digits(number))//','//text(group%span%last + 1:)
    end if
  end subroutine set_number
end module mech9_changed_text
