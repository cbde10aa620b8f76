!> The content of a draft as a list of numbered answers, and the words by which an answer can be named.
module mech9_summary
  use mech9_text, only: to_text, lower
  use mech9_grammar, only: group_table, find_group_row, words_of
  use mech9_part_names, only: part_names_type
  use mech9_draft, only: draft_type, integer_of
  use mech9_draft_names, only: names_in_draft, shown_text
  use mech9_draft_joints, only: number_in, pair_with
  use mech9_paragraph, only: print_paragraph
  use mech9_topics, only: is_numbered
  implicit none
  private
  public :: print_summary, number_of_entry, entry_meant, title_of

  integer, parameter :: line_width = 79, indent = 4
  !> Longer texts name no entry.
  integer, parameter :: longest_words = 100

contains

  !> Print all answers with their numbers. Each group has one line or more.
  subroutine print_summary(unit, draft)
    integer, intent(in) :: unit            !< number of the output unit
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=:), allocatable :: line, piece
    type(part_names_type) :: names
    integer :: i, j, number

    number = 0
    piece = ''
    names = names_in_draft(draft)
    do i = 1, size(draft%groups)
      ! a group with nothing but its coordinate is not printed
      if (all([(is_hidden(draft, i, j), j=1, size(draft%groups(i)%entries))])) cycle
      line = '  '//title_of(draft, i)//':'
      do j = 1, size(draft%groups(i)%entries)
        if (is_hidden(draft, i, j)) cycle
        number = number + 1
        associate (entry => draft%groups(i)%entries(j))
          piece = '  ['//to_text(number)//'] '//entry%name//' '//shown_text(draft%groups(i)%name, entry, names)
        end associate
        if (len(line) + len(piece) > line_width .and. len(line) > indent) then
          call print_paragraph(unit, trim(adjustl(line)), verify(line, ' ') - 1)
          line = repeat(' ', indent)
        end if
        line = line//piece
      end do
      call print_paragraph(unit, trim(adjustl(line)), verify(line, ' ') - 1)
    end do
  end subroutine print_summary

  !> Whether an entry is not listed, since the title of its group already gives the number of the coordinate.
  pure logical function is_hidden(draft, group, entry)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: group           !< index of the group in the draft
    integer, intent(in) :: entry           !< number of the entry in the group
    integer :: row

    is_hidden = .false.
    row = find_group_row(draft%groups(group)%name)
    if (row > 0) is_hidden = is_numbered(row) .and. draft%groups(group)%entries(entry)%name == 'coordinate'
  end function is_hidden

  !> The title of a group, such as "pair 5", "load 2" or "time".
  pure function title_of(draft, group) result(title)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: group           !< index of the group in the draft
    character(len=:), allocatable :: title
    integer :: row

    title = draft%groups(group)%name
    row = find_group_row(title)
    if (row == 0) return
    if (is_numbered(row)) then
      title = title//' '//to_text(number_in(draft, title, draft%place_of(group)))
    else if (group_table(row)%repeats) then
      title = title//' '//to_text(draft%place_of(group))
    end if
  end function title_of

  !> Find the entry with a number of the list; the group is 0 if there is none.
  pure subroutine entry_with_number(draft, number, group, entry)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: number          !< the number that the list shows
    integer, intent(out) :: group          !< index of the group in the draft; 0: none
    integer, intent(out) :: entry          !< number of the entry in the group; 0: none
    integer :: n

    n = 0
    do group = 1, size(draft%groups)
      do entry = 1, size(draft%groups(group)%entries)
        if (is_hidden(draft, group, entry)) cycle
        n = n + 1
        if (n == number) return
      end do
    end do
    group = 0
    entry = 0
  end subroutine entry_with_number

  !> The number of an entry in the list; 0 if it has none.
  pure integer function number_of_entry(draft, group, entry) result(number)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: group           !< index of the group in the draft
    integer, intent(in) :: entry           !< number of the entry in the group
    integer :: i, j

    number = 0
    if (group == 0 .or. entry == 0) return
    if (is_hidden(draft, group, entry)) return
    do i = 1, group
      do j = 1, merge(entry, size(draft%groups(i)%entries), i == group)
        if (.not. is_hidden(draft, i, j)) number = number + 1
      end do
    end do
  end function number_of_entry

  !> Find the entry that is named by the number of an answer or by words. It is a group, its place, and a name, which is
  !> empty if only a group is named. The argument `group` is empty if the text names nothing.
  pure subroutine entry_meant(draft, which, group, place, name, by_number)
    type(draft_type), intent(in) :: draft                !< groups and names with their values as text
    character(len=*), intent(in) :: which                !< the words that were typed
    character(len=:), allocatable, intent(out) :: group  !< name of the group; empty: the words mean nothing
    character(len=:), allocatable, intent(out) :: name   !< name with its subscript; empty: the group as a whole
    integer, intent(out) :: place                        !< place among the groups of that name, from 1
    logical, intent(out), optional :: by_number          !< the words are the number of an answer
    integer :: i, entry

    i = 0
    if (integer_of(which) > 0) call entry_with_number(draft, integer_of(which), i, entry)
    if (present(by_number)) by_number = i > 0
    if (i > 0) then
      group = draft%groups(i)%name
      place = draft%place_of(i)
      name = draft%groups(i)%entries(entry)%name
    else
      call named_entry(draft, which, group, place, name)
    end if
  end subroutine entry_meant

  !> Find the entry that is named by words such as "pair 3 axis", "time end" or "load 2". It is a group, its place, and
  !> a name, which is empty if none is given. A group for each coordinate is named by the number of the coordinate.
  !> `group` is empty if the words name nothing.
  pure subroutine named_entry(draft, line, group, place, name)
    type(draft_type), intent(in) :: draft                !< groups and names with their values as text
    character(len=*), intent(in) :: line                 !< the words that were typed
    character(len=:), allocatable, intent(out) :: group  !< name of the group; empty: the words mean nothing
    character(len=:), allocatable, intent(out) :: name   !< name with its subscript; empty: the group as a whole
    integer, intent(out) :: place                        !< place among the groups of that name, from 1
    integer :: row, next

    group = ''
    name = ''
    place = 1
    if (len(line) > longest_words) return
    associate (words => words_of(lower(line)))
      if (size(words) < 1 .or. size(words) > 3) return
      row = find_group_row(trim(words(1)))
      if (row == 0) return
      next = 2
      if (size(words) > 1) then
        if (integer_of(trim(words(2))) > 0) then
          place = integer_of(trim(words(2)))
          if (trim(words(1)) == 'pair') then
            place = pair_with(draft, place)
          else if (is_numbered(row)) then
            place = draft%with_number(trim(words(1)), 'coordinate', place)
          end if
          next = 3
        end if
      end if
      if (size(words) > next) return
      if (draft%find(trim(words(1)), place) == 0 .and. (group_table(row)%repeats .or. place > 1)) return
      group = trim(words(1))
      if (size(words) == next) name = trim(words(next))
    end associate
  end subroutine named_entry
end module mech9_summary
