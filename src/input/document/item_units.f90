!> The units of the numbers of a document: each number of a kind that the grammar names alone gets its factor to SI.
!>
!> Numbers whose kind depends on a coordinate are converted by their readers.
module mech9_item_units
  use mech9_units, only: units_type, units_of_words
  use mech9_grammar, only: item_table
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: group_or_empty, has_name, get_text, row_of
  implicit none
  private
  public :: units_of_document, scale_items, si_unit_of

contains

  !> The units that a checked document names.
  pure type(units_type) function units_of_document(document) result(units)
    type(document_type), intent(in) :: document   !< the data file as groups and items
    type(group_type) :: group
    character(len=5) :: rate

    group = group_or_empty(document, 'mechanism')
    rate = ''
    if (has_name(group, 'rate_unit')) rate = get_text(group, 'rate_unit')
    units = units_of_words(get_text(group, 'length_unit'), get_text(group, 'angle_unit'), get_text(group, 'force_unit'), &
                           get_text(group, 'mass_unit'), trim(rate))
    units%names_length = has_name(group, 'length_unit')
  end function units_of_document

  !> Give the items of all sound groups their factors to SI.
  pure subroutine scale_items(document)
    type(document_type), intent(inout) :: document   !< checked
    type(units_type) :: units
    integer :: i, j, row

    units = units_of_document(document)
    if (units%are_si()) return
    do i = 1, size(document%groups)
      if (.not. document%groups(i)%sound) cycle
      do j = 1, size(document%groups(i)%items)
        row = row_of(document%groups(i), document%groups(i)%items(j)%name)
        if (row == 0) cycle
        if (item_table(row)%type == 'real') &
          document%groups(i)%items(j)%scale = units%size_of(trim(si_unit_of(item_table(row)%unit)))
      end do
    end do
  end subroutine scale_items

  !> The SI unit of a name of the grammar; empty where it is a plain number, or depends on a coordinate or a place in a list.
  pure character(len=13) function si_unit_of(unit) result(si)
    character(len=*), intent(in) :: unit   !< as it stands in the grammar

    select case (unit)
    case ('angle')
      si = 'rad'
    case ('angle/s')
      si = 'rad/s'
    case ('m', 'kg', 'kg m^2', 'm/s^2', 'N', 'N m', 'N/m', 'N s/m')
      si = unit
    case default
      si = ''
    end select
  end function si_unit_of
end module mech9_item_units
