!> Rarely used names of the data file, for which a conversation asks on request only.
module mech9_seldom
  use mech9_program_kind, only: belongs_to
  use mech9_grammar, only: group_table, item_table, item_row_type, rows_of_group
  use mech9_outline, only: outline_type
  implicit none
  private
  public :: is_seldom, is_used, seldom_rows

contains

  !> Whether a name is a rarely used one, about which there are questions only on request. The links of pairs are, if the
  !> structure gives them.
  pure logical function is_seldom(outline, row)
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    type(item_row_type), intent(in) :: row     !< row of the table of names

    is_seldom = row%seldom .or. (row%group == 'pair' .and. row%name == 'links' .and. outline%way /= 'pairs')
    is_seldom = is_seldom .and. is_used(outline, row)
  end function is_seldom

  !> Rows in item_table of the rarely used names of a group.
  pure function seldom_rows(outline, group_row) result(rows)
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer, intent(in) :: group_row           !< row of the group in group_table
    integer, allocatable :: rows(:)
    integer :: i

    rows = rows_of_group(group_table(group_row)%name)
    rows = pack(rows, [(is_seldom(outline, item_table(rows(i))), i=1, size(rows))])
  end function seldom_rows

  !> Whether the program of the conversation uses a name.
  pure logical function is_used(outline, row)
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    type(item_row_type), intent(in) :: row     !< row of the table of names

    is_used = belongs_to(row%program, outline%program)
  end function is_used
end module mech9_seldom
