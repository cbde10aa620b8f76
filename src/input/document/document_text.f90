!> A document written as the text of a data file. Reading the text gives the same document, with the same bits of its numbers.
module mech9_document_text
  use mech9_text, only: to_text, exact_digits, string_type, join, in_apostrophes
  use mech9_document, only: document_type, group_type, item_type, value_type, subscript_type, value_integer, value_real, &
    value_logical, value_text, value_word
  implicit none
  private
  public :: text_of_document

  integer, parameter :: line_width = 100   !< after which the values of an item go on in the next line

contains

  !> Write the groups of a document in their order, each item in a line of its own. Comments of a file are not kept.
  pure subroutine text_of_document(document, text)
    type(document_type), intent(in) :: document               !< groups and items without errors
    character(len=:), allocatable, intent(out) :: text        !< of the data file
    type(string_type), allocatable :: groups(:)
    integer :: i

    allocate (groups(size(document%groups)))
    do i = 1, size(groups)
      call write_group(document%groups(i), groups(i)%text)
    end do
    text = join(groups, '')
  end subroutine text_of_document

  !> Write a group.
  pure subroutine write_group(group, text)
    type(group_type), intent(in) :: group                !< the group
    character(len=:), allocatable, intent(out) :: text   !< its lines
    character(len=:), allocatable :: item
    integer :: i

    text = '&'//group%name//new_line('a')
    do i = 1, size(group%items)
      call write_item(group%items(i), item)
      text = text//'  '//item//new_line('a')
    end do
    text = text//'/'//new_line('a')
  end subroutine write_group

  !> Write a name with its values.
  pure subroutine write_item(item, text)
    type(item_type), intent(in) :: item                  !< the item
    character(len=:), allocatable, intent(out) :: text   !< its lines, without the last line feed
    character(len=:), allocatable :: line, value
    integer :: i

    text = ''
    line = item%name
    if (allocated(item%subscripts)) call append_subscripts(item%subscripts, line)
    line = line//' = '
    do i = 1, size(item%values)
      call write_value(item%values(i), value)
      if (i < size(item%values)) value = value//', '
      if (len(line) + len(value) > line_width .and. i > 1) then
        text = text//line//new_line('a')
        line = '    '
      end if
      line = line//value
    end do
    text = text//line
  end subroutine write_item

  !> Append subscripts to a name.
  pure subroutine append_subscripts(subscripts, line)
    type(subscript_type), intent(in) :: subscripts(:)          !< in their order; there may be none
    character(len=:), allocatable, intent(inout) :: line       !< the name; gets them in parentheses
    integer :: i

    do i = 1, size(subscripts)
      line = line//trim(merge('(', ',', i == 1))
      if (subscripts(i)%first > 0) line = line//to_text(subscripts(i)%first)
      if (subscripts(i)%section) line = line//':'
      if (subscripts(i)%section .and. subscripts(i)%last > 0) line = line//to_text(subscripts(i)%last)
    end do
    if (size(subscripts) > 0) line = line//')'
  end subroutine append_subscripts

  !> Write a value. A place that is left empty has no text.
  pure subroutine write_value(value, text)
    type(value_type), intent(in) :: value                !< the value
    character(len=:), allocatable, intent(out) :: text   !< as a data file has it

    text = ''
    if (value%times > 1) text = to_text(value%times)//'*'
    select case (value%kind)
    case (value_integer)
      text = text//to_text(value%whole)
    case (value_real)
      text = text//to_text(value%number, exact_digits(value%number))
    case (value_logical)
      text = text//trim(merge('.true. ', '.false.', value%truth))
    case (value_word)
      text = text//value%text
    case (value_text)
      text = text//in_apostrophes(value%text)
    end select
  end subroutine write_value
end module mech9_document_text
