!> Conversion of an existing data file to a draft: its values, and the comments above its groups.
module mech9_draft_source
  use mech9_error, only: place_type
  use mech9_text, only: to_text, join, string_type
  use mech9_source, only: source_type
  use mech9_document, only: document_type, group_type, item_type, value_type, value_bad, value_integer
  use mech9_checker, only: check_document
  use mech9_matrix_items, only: matrix_type, read_matrix
  use mech9_diagnostics, only: diagnostics_type
  use mech9_draft, only: draft_type
  implicit none
  private
  public :: draft_from_document, values_text

  character(len=*), parameter :: line_end = achar(10)

contains

  !> Copy the values of a document: one entry for each name, and the coincidence matrix by rows. Values that cannot be
  !> read are left out; they were reported when the document was read.
  pure subroutine draft_from_document(document, draft)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    type(draft_type), intent(out) :: draft       !< groups and names with their values as text
    type(document_type) :: checked
    type(diagnostics_type) :: ignored
    character(len=:), allocatable :: comment
    integer :: i, number

    call draft%clear()
    checked = document
    ! its errors are found again when the draft is checked, with places in the draft
    call ignored%add_source(document%source, number)
    call check_document(checked, ignored)
    do i = 1, size(checked%groups)
      call take_group(checked, checked%groups(i), draft)
    end do
    if (size(checked%groups) == 0) return
    call find_comment(document%source, checked%groups(1)%span%first, .true., comment)
    draft%head = comment
    draft%comments_left_out = count_comments(document%source%text) - count_comments(draft%head)
    do i = 1, size(draft%groups)
      draft%comments_left_out = draft%comments_left_out - count_comments(draft%groups(i)%comment)
    end do
  end subroutine draft_from_document

  !> Copy a group of a document, with the comment above it.
  pure subroutine take_group(document, group, draft)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    type(group_type), intent(in) :: group        !< the group of the data file
    type(draft_type), intent(inout) :: draft     !< draft to which the group is added
    character(len=:), allocatable :: comment
    integer :: i, place, number

    call draft%add(group%name)
    place = draft%count_of(group%name)
    number = draft%find(group%name, place)
    call find_comment(document%source, group%span%first, .false., comment)
    draft%groups(number)%comment = comment
    if (group%name == 'structure') call take_matrix(document, group, draft)
    do i = 1, size(group%items)
      associate (item => group%items(i))
        if (any(item%values%kind == value_bad) .or. (group%name == 'structure' .and. item%name == 'c')) cycle
        call draft%give(group%name, place, item%name, values_text(document%source%text, item%values), &
                        written_text(document%source%text, item))
      end associate
    end do
  end subroutine take_group

  !> Copy the coincidence matrix as rows, however it is given.
  pure subroutine take_matrix(document, group, draft)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    type(group_type), intent(in) :: group        !< the group of the data file
    type(draft_type), intent(inout) :: draft     !< draft to which the rows are added
    type(matrix_type) :: matrix
    type(diagnostics_type) :: ignored
    integer :: i, number
    logical :: ok

    if (.not. any([(group%items(i)%name == 'c', i=1, size(group%items))])) return
    if (all([(group%items(i)%name /= 'c' .or. is_row(group%items(i)), i=1, size(group%items))])) then
      ! rows are copied even if others are still missing
      do i = 1, size(group%items)
        if (group%items(i)%name == 'c') &
          call draft%give('structure', 1, 'c('//to_text(group%items(i)%subscripts(1)%first)//',:)', &
                          values_text(document%source%text, group%items(i)%values))
      end do
      return
    end if
    call ignored%add_source(document%source, number)
    call read_matrix(group, 0, matrix, ok, ignored)
    if (.not. ok) return
    do i = 1, size(matrix%c, 1)
      call draft%give('structure', 1, 'c('//to_text(i)//',:)', to_text(matrix%c(i, :)))
    end do
  end subroutine take_matrix

  !> Whether an item is a whole row of the matrix, such as c(2,:).
  pure logical function is_row(item)
    type(item_type), intent(in) :: item  !< one name of a group with its subscripts and values

    is_row = .false.
    if (size(item%subscripts) == 2) &
      is_row = .not. item%subscripts(1)%section .and. item%subscripts(2)%section .and. &
               item%subscripts(2)%first == 0 .and. item%subscripts(2)%last == 0
  end function is_row

  !> Values as they are written, with commas between them.
  pure function values_text(source_text, values) result(text)
    character(len=*), intent(in) :: source_text  !< text in which the values stand
    type(value_type), intent(in) :: values(:)    !< the values
    character(len=:), allocatable :: text
    type(string_type) :: words(size(values))
    integer :: i

    do i = 1, size(values)
      words(i)%text = source_text(values(i)%span%first:values(i)%span%last)
      ! a name of a link or a pair that stands for its number
      if (values(i)%kind == value_integer .and. scan(words(i)%text, '''"') == 1) words(i)%text = to_text(values(i)%whole)
      if (values(i)%times > 1) words(i)%text = to_text(values(i)%times)//'*'//words(i)%text
    end do
    text = join(words, ', ')
  end function values_text

  !> Values as they are written, where names of links or pairs are among them that stand for numbers; empty where there are none.
  pure function written_text(source_text, item) result(text)
    character(len=*), intent(in) :: source_text  !< text in which the values stand
    type(item_type), intent(in) :: item          !< name with its values
    character(len=:), allocatable :: text
    type(string_type) :: words(size(item%values))
    integer :: i

    text = ''
    if (any(item%values%kind /= value_integer .or. item%values%times > 1)) return
    do i = 1, size(words)
      words(i)%text = source_text(item%values(i)%span%first:item%values(i)%span%last)
    end do
    text = join(words, ', ')
  end function written_text

  !> Find the comment lines directly above a byte. With `to_the_top`, find those from the top of the file that stand
  !> above these and a blank line.
  pure subroutine find_comment(source, byte, to_the_top, comment)
    type(source_type), intent(in) :: source                !< text of the data file
    integer, intent(in) :: byte                            !< number of the byte below the comment
    logical, intent(in) :: to_the_top                      !< take the lines from the top of the file down to a blank line
    character(len=:), allocatable, intent(out) :: comment  !< comment lines with their line ends; empty: none
    type(place_type) :: position
    integer :: line, first, last

    position = source%place(byte)
    line = position%line - 1
    do while (line >= 1)
      call source%line_bounds(line, first, last)
      if (.not. is_comment(source%text(first:last))) exit
      line = line - 1
    end do
    if (to_the_top) then
      call take_lines(source, 1, line, comment)
    else
      call take_lines(source, line + 1, position%line - 1, comment)
    end if
  end subroutine find_comment

  !> Copy comment lines and blank lines, without a blank line at the end. The text is empty if any other line is among
  !> them.
  pure subroutine take_lines(source, from, to, text)
    type(source_type), intent(in) :: source             !< text of the data file
    integer, intent(in) :: from                         !< number of the first line
    integer, intent(in) :: to                           !< number of the last line
    character(len=:), allocatable, intent(out) :: text  !< the lines with their line ends; empty where another line is among them
    integer :: line, first, last

    text = ''
    do line = from, to
      call source%line_bounds(line, first, last)
      if (len_trim(source%text(first:last)) == 0) then
        if (line < to) text = text//line_end
      else if (is_comment(source%text(first:last))) then
        text = text//source%text(first:last)//line_end
      else
        text = ''
        return
      end if
    end do
  end subroutine take_lines

  !> The number of comments in a text. An exclamation mark in quotes begins none.
  pure integer function count_comments(text) result(count)
    character(len=*), intent(in) :: text  !< text of a data file
    character :: quote
    integer :: at

    count = 0
    quote = ' '
    at = 1
    do while (at <= len(text))
      if (quote /= ' ') then
        if (text(at:at) == quote .or. text(at:at) == line_end) quote = ' '
      else if (text(at:at) == '!') then
        count = count + 1
        at = at + index(text(at:)//line_end, line_end) - 1
      else if (scan(text(at:at), '''"') == 1) then
        quote = text(at:at)
      end if
      at = at + 1
    end do
  end function count_comments

  !> Whether a line is a comment.
  pure logical function is_comment(line)
    character(len=*), intent(in) :: line  !< one line

    is_comment = index(adjustl(line), '!') == 1
  end function is_comment
end module mech9_draft_source
