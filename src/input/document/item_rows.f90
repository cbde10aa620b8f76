!> The rows that names of groups have in the table of names.
module mech9_item_rows
  use mech9_text, only: lower
  use mech9_grammar, only: item_row_type, group_table, item_table, row_of_group
  implicit none
  private
  public :: find_item_rows, only_item_row, item_row_for_kind, takes_kind

contains

  !> First and last row of a group's names in item_table; they stand together. The rows are found when this is compiled.
  pure subroutine range_of_group(group, first, last)
    character(len=*), intent(in) :: group  !< name of a group, in lower case
    integer, intent(out) :: first          !< first row; after the last one where there is no such group
    integer, intent(out) :: last           !< last row
    integer :: g
    character(len=10), parameter :: groups(*) = item_table%group
    integer, parameter :: firsts(*) = [(findloc(groups, group_table(g)%name, dim=1), g=1, size(group_table))]
    integer, parameter :: lasts(*) = [(findloc(groups, group_table(g)%name, dim=1, back=.true.), g=1, size(group_table))]

    first = 1
    last = 0
    g = row_of_group(group)
    if (g == 0) return
    first = firsts(g)
    last = lasts(g)
  end subroutine range_of_group

  !> Rows of one name of a group: none where it is unknown, several where its kinds differ.
  pure function find_item_rows(group, name) result(rows)
    character(len=*), intent(in) :: group  !< name of a group, in any case
    character(len=*), intent(in) :: name   !< name of an item, in any case
    integer, allocatable :: rows(:)
    character(len=len(name)) :: lowered
    integer :: found(size(item_table)), first, last, i, n

    call range_of_group(lower(group), first, last)
    lowered = lower(name)
    n = 0
    do i = first, last
      if (.not. is_name(item_table(i), lowered)) cycle
      n = n + 1
      found(n) = i
    end do
    rows = found(:n)
  end function find_item_rows

  !> The row of one name of a group where it has only one, which belongs to all kinds; else 0.
  pure integer function only_item_row(group, name) result(row)
    character(len=*), intent(in) :: group  !< name of a group, in lower case
    character(len=*), intent(in) :: name   !< name of an item, in lower case
    integer :: first, last, i

    row = 0
    call range_of_group(group, first, last)
    do i = first, last
      if (.not. is_name(item_table(i), name)) cycle
      if (row > 0) then
        row = 0
        return
      end if
      row = i
    end do
    if (row == 0) return
    if (item_table(row)%kinds(1:1) /= ' ') row = 0
  end function only_item_row

  !> Whether a row has this name. Most have another first letter.
  pure logical function is_name(row, name)
    type(item_row_type), intent(in) :: row   !< the row
    character(len=*), intent(in) :: name     !< the name, in lower case

    is_name = .false.
    if (len(name) == 0) return
    if (row%name(1:1) == name(1:1)) is_name = row%name == name
  end function is_name

  !> Row of a name of a group of this kind; 0 where the name does not belong to the kind.
  pure integer function item_row_for_kind(group, name, kind) result(row)
    character(len=*), intent(in) :: group  !< name of a group, in any case
    character(len=*), intent(in) :: name   !< name of an item, in any case
    character(len=*), intent(in) :: kind   !< kind of the group; empty: unknown
    character(len=len(name)) :: lowered
    integer :: first, last, i

    row = 0
    call range_of_group(lower(group), first, last)
    lowered = lower(name)
    do i = first, last
      if (.not. is_name(item_table(i), lowered)) cycle
      if (takes_kind(item_table(i), kind)) row = i
    end do
  end function item_row_for_kind

  !> Whether a name belongs to groups of this kind; where no kind is known, to groups of any kind.
  pure logical function takes_kind(row, kind)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=*), intent(in) :: kind    !< kind of the group, and after a blank its law, as in law:harmonic; empty: unknown
    integer :: blank

    takes_kind = row%kinds(1:1) == ' '
    if (kind == '' .or. takes_kind) return
    blank = index(kind, ' ')
    if (blank == 0) blank = len(kind) + 1
    takes_kind = has_word(row%kinds, kind(:blank - 1))
    if (blank > len_trim(kind) .or. takes_kind) return
    takes_kind = has_word(row%kinds, kind(blank + 1:len_trim(kind)))
  end function takes_kind

  !> Whether a word is one of a list.
  pure logical function has_word(list, word)
    character(len=*), intent(in) :: list  !< words with a blank between them
    character(len=*), intent(in) :: word  !< the word
    integer :: first, last, found

    has_word = .false.
    first = 1
    do
      found = index(list(first:), word)
      if (found == 0) return
      first = first + found - 1
      last = first + len(word) - 1
      has_word = .true.
      if (first > 1) has_word = list(first - 1:first - 1) == ' '
      if (last < len(list)) has_word = has_word .and. list(last + 1:last + 1) == ' '
      first = first + 1
      if (has_word .or. first > len(list)) return
    end do
  end function has_word
end module mech9_item_rows
