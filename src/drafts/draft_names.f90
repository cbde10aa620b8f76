!> Names of links and pairs in a draft. Its values are numbers; where the user wrote names for them, the data file has names again.
module mech9_draft_names
  use mech9_part_names, only: part_names_type, longest_part_name, longest_called, name_in, lengthen
  use mech9_text, only: to_text, string_type, join
  use mech9_grammar_rows, only: refers_to, refers_to_link
  use mech9_draft, only: draft_type, draft_group_type, entry_type, integer_of, unquoted
  implicit none
  private
  public :: names_in_draft, text_with_names, shown_text

contains

  !> The names that the groups of a draft give to links and pairs now.
  pure type(part_names_type) function names_in_draft(draft) result(names)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    integer :: i

    do i = 1, size(draft%groups)
      if (draft%groups(i)%name == 'link') call take_link(draft%groups(i), names)
      if (draft%groups(i)%name == 'pair') call take_pair(draft%groups(i), names)
    end do
  end function names_in_draft

  !> Take the name that a group gives to a link.
  pure subroutine take_link(group, names)
    type(draft_group_type), intent(in) :: group        !< the group
    type(part_names_type), intent(inout) :: names      !< gets the name
    character(len=:), allocatable :: name
    integer :: number

    name = unquoted(value_of(group, 'name'))
    number = integer_of(value_of(group, 'number'))
    if (name == '' .or. len(name) > longest_part_name .or. number < 1) return
    if (.not. allocated(names%links)) allocate (names%links(0))
    call lengthen(names%links, number)
    names%links(number) = name
  end subroutine take_link

  !> Take the name that a group gives to a pair, for each of its coordinates.
  pure subroutine take_pair(group, names)
    type(draft_group_type), intent(in) :: group        !< the group
    type(part_names_type), intent(inout) :: names      !< gets the names
    type(string_type), allocatable :: numbers(:)
    character(len=:), allocatable :: name
    integer :: i, number

    name = unquoted(value_of(group, 'name'))
    if (name == '' .or. len(name) > longest_part_name) return
    call parts_of(value_of(group, 'coordinates')//value_of(group, 'coordinate'), numbers)
    if (.not. allocated(names%coordinates)) allocate (names%coordinates(0))
    do i = 1, size(numbers)
      number = integer_of(numbers(i)%text)
      if (number < 1) cycle
      call lengthen(names%coordinates, number)
      names%coordinates(number) = name
      if (size(numbers) > 1) names%coordinates(number) = name//'('//to_text(i)//')'
    end do
  end subroutine take_pair

  !> The values of an entry as text; empty where the group does not have it.
  pure function value_of(group, name) result(text)
    type(draft_group_type), intent(in) :: group        !< the group
    character(len=*), intent(in) :: name               !< of the entry
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(group%entries)
      if (group%entries(i)%name == name) text = group%entries(i)%text
    end do
  end function value_of

  !> The values of an entry as the data file has them. A number that the user wrote as a name becomes the name that its link or pair
  !> has now, and stays a number where there is none any more.
  pure function text_with_names(group, entry, names) result(text)
    character(len=*), intent(in) :: group              !< name of the group
    type(entry_type), intent(in) :: entry              !< one of its names with its values
    type(part_names_type), intent(in) :: names         !< of links and pairs
    character(len=:), allocatable :: text
    type(string_type), allocatable :: values(:), written(:)
    character(len=longest_called) :: name
    integer :: i, kind

    text = entry%text
    if (.not. allocated(entry%written)) return
    kind = refers_to(group, entry%name)
    if (kind == 0) return
    call parts_of(entry%text, values)
    call parts_of(entry%written, written)
    if (size(values) /= size(written)) return
    do i = 1, size(values)
      if (scan(written(i)%text, '''"') /= 1 .or. integer_of(values(i)%text) < 1) cycle
      if (kind == refers_to_link) then
        name = name_in(names%links, integer_of(values(i)%text))
      else
        name = name_in(names%coordinates, integer_of(values(i)%text))
      end if
      if (name /= '') values(i)%text = ''''//trim(name)//''''
    end do
    text = join(values, ', ')
  end function text_with_names

  !> The values of an entry for people: without quotes, and with names where the user wrote them.
  pure function shown_text(group, entry, names) result(text)
    character(len=*), intent(in) :: group              !< name of the group
    type(entry_type), intent(in) :: entry              !< one of its names with its values
    type(part_names_type), intent(in) :: names         !< of links and pairs
    character(len=:), allocatable :: text
    type(string_type), allocatable :: values(:)
    integer :: i

    if (.not. allocated(entry%written)) then
      text = unquoted(entry%text)
      return
    end if
    call parts_of(text_with_names(group, entry, names), values)
    do i = 1, size(values)
      values(i)%text = unquoted(values(i)%text)
    end do
    text = join(values, ', ')
  end function shown_text

  !> The values of a list with commas between them. Names of links and pairs hold no comma.
  pure subroutine parts_of(text, parts)
    character(len=*), intent(in) :: text                           !< the list
    type(string_type), allocatable, intent(out) :: parts(:)        !< its values, without blanks around them
    integer :: i, first, last

    allocate (parts(count([(text(i:i) == ',', i=1, len(text))]) + 1))
    first = 1
    do i = 1, size(parts)
      last = first + index(text(first:)//',', ',') - 2
      parts(i)%text = trim(adjustl(text(first:last)))
      first = last + 2
    end do
  end subroutine parts_of
end module mech9_draft_names
