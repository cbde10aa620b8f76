!> A draft as the text of a data file, with the place of each group and entry in it.
module mech9_draft_text
  use mech9_text, only: string_type, starts_with
  use mech9_grammar, only: group_table, find_group_row
  use mech9_part_names, only: part_names_type
  use mech9_draft, only: draft_type, draft_group_type
  use mech9_draft_names, only: names_in_draft, text_with_names
  implicit none
  private
  public :: draft_text_type, write_draft, locate

  !> A group is written in one line if the line is not longer than this.
  integer, parameter :: longest_line = 120
  character(len=*), parameter :: line_end = achar(10)

  !> The text, and the range of bytes of each entry and of each group.
  type :: draft_text_type
    character(len=:), allocatable :: text
    integer, allocatable :: group(:)       !< index in the draft of the group of each range
    integer, allocatable :: entry(:)       !< number of the entry of each range; 0: the whole group
    integer, allocatable :: first(:)       !< first byte of each range
    integer, allocatable :: last(:)
    integer :: count = 0                   !< number of ranges in use
    integer, private :: used = 0           !< bytes of the text in use, while it is written
  end type draft_text_type

contains

  !> Write a draft as text. `remark` is a comment line for its end; empty: none.
  pure subroutine write_draft(draft, remark, written)
    type(draft_type), intent(in) :: draft          !< groups and names with their values as text
    character(len=*), intent(in) :: remark         !< comment line for the end of the text; empty: none
    type(draft_text_type), intent(out) :: written  !< text of the draft, with the place of each entry
    type(part_names_type) :: names
    integer :: i, n
    character(len=:), allocatable :: before

    n = size(draft%groups)
    do i = 1, size(draft%groups)
      n = n + size(draft%groups(i)%entries)
    end do
    allocate (written%group(n), written%entry(n), written%first(n), written%last(n))
    allocate (character(len=len(draft%head) + 4096) :: written%text)
    call append(written, draft%head)
    before = ''
    names = names_in_draft(draft)
    do i = 1, size(draft%groups)
      if (draft%groups(i)%name /= before) call begin_kind(draft%groups(i), written)
      before = draft%groups(i)%name
      call append(written, draft%groups(i)%comment)
      call write_group(draft%groups(i), i, names, written)
    end do
    if (remark /= '') call append(written, line_end//remark//line_end)
    written%text = written%text(:written%used)
  end subroutine write_draft

  !> Append a blank line, and a comment on the groups of this name unless the group has a comment of its own.
  pure subroutine begin_kind(group, written)
    type(draft_group_type), intent(in) :: group      !< the group
    type(draft_text_type), intent(inout) :: written  !< text to which the heading is appended
    integer :: row

    if (written%used > 0) call append(written, line_end)
    row = find_group_row(group%name)
    if (group%comment == '' .and. row > 0) call append(written, '! '//trim(group_table(row)%help)//line_end)
  end subroutine begin_kind

  !> Append a piece to the text, which gets room for twice as much where it has none.
  pure subroutine append(written, piece)
    type(draft_text_type), intent(inout) :: written  !< the text
    character(len=*), intent(in) :: piece            !< the piece
    character(len=:), allocatable :: longer

    if (written%used + len(piece) > len(written%text)) then
      allocate (character(len=2*(written%used + len(piece))) :: longer)
      longer(:written%used) = written%text(:written%used)
      call move_alloc(longer, written%text)
    end if
    written%text(written%used + 1:written%used + len(piece)) = piece
    written%used = written%used + len(piece)
  end subroutine append

  !> Append a group to the text, and note the ranges of bytes.
  pure subroutine write_group(group, number, names, written)
    type(draft_group_type), intent(in) :: group      !< the group
    integer, intent(in) :: number                    !< index of the group in the draft
    type(part_names_type), intent(in) :: names       !< of links and pairs
    type(draft_text_type), intent(inout) :: written  !< text to which the group is appended, with the place of each entry
    type(string_type) :: parts(size(group%entries))
    character(len=:), allocatable :: separator, equals
    integer :: i, whole, length

    do i = 1, size(parts)
      parts(i)%text = text_with_names(group%name, group%entries(i), names)
    end do
    length = len(group%name) + 4 + sum([(len(group%entries(i)%name) + len(parts(i)%text) + 3, i=1, size(parts))])
    separator = line_end//'  '
    equals = ' = '
    if (length <= longest_line .and. .not. is_matrix(group)) then
      separator = ' '
      equals = '='
    end if
    do i = 1, size(parts)
      parts(i)%text = group%entries(i)%name//equals//parts(i)%text
    end do
    whole = written%count + 1
    call note(written, number, 0, written%used + 1)
    call append(written, '&'//group%name)
    do i = 1, size(parts)
      if (i > 1 .and. separator == ' ') call append(written, ',')
      call append(written, separator)
      call note(written, number, i, written%used + 1)
      call append(written, parts(i)%text)
      written%last(written%count) = written%used
    end do
    if (separator /= ' ') separator = line_end
    call append(written, separator//'/')
    written%last(whole) = written%used
    call append(written, line_end)
  end subroutine write_group

  !> Whether a group holds rows of a matrix, which are easier to read one below the other.
  pure logical function is_matrix(group)
    type(draft_group_type), intent(in) :: group  !< the group
    integer :: i

    is_matrix = .true.
    do i = 1, size(group%entries)
      if (starts_with(group%entries(i)%name, 'c(')) return
    end do
    is_matrix = .false.
  end function is_matrix

  !> Note the beginning of a range of bytes; its end follows later.
  pure subroutine note(written, group, entry, first)
    type(draft_text_type), intent(inout) :: written  !< text to which the group is appended, with the place of each entry
    integer, intent(in) :: group                     !< index of the group in the draft
    integer, intent(in) :: entry                     !< number of the entry in the group; 0: the whole group
    integer, intent(in) :: first                     !< number of its first byte in the text

    written%count = written%count + 1
    written%group(written%count) = group
    written%entry(written%count) = entry
    written%first(written%count) = first
  end subroutine note

  !> Find the group and the entry to which a byte of the text belongs. The group is 0 if there is none; the entry is 0
  !> for the group as a whole.
  pure subroutine locate(written, byte, group, entry)
    type(draft_text_type), intent(in) :: written  !< text of the draft, with the place of each entry
    integer, intent(in) :: byte                   !< number of the byte in the text
    integer, intent(out) :: group                 !< index of the group in the draft; 0: none
    integer, intent(out) :: entry                 !< number of the entry in the group; 0: the whole group
    integer :: i

    group = 0
    entry = 0
    do i = 1, written%count
      if (byte < written%first(i) .or. byte > written%last(i)) cycle
      group = written%group(i)
      if (written%entry(i) > 0) entry = written%entry(i)
    end do
  end subroutine locate
end module mech9_draft_text
