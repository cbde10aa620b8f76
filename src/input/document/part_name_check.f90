!> Names of links and pairs in a document: the groups that give them, and the places where they stand for numbers.
!>
!> Names are replaced by numbers before the groups are held against the grammar, so that readers know numbers alone.
module mech9_part_name_check
  use mech9_text, only: to_text, nearest_name
  use mech9_kinds, only: wp, long
  use mech9_part_names, only: part_names_type, longest_part_name, longest_called, has_names, lengthen, link_named, &
    coordinate_named, number_columns
  use mech9_name_table, only: name_table_type
  use mech9_source, only: span_type
  use mech9_grammar_rows, only: refers_to, refers_to_link, refers_to_coordinate
  use mech9_document, only: document_type, group_type, value_type, value_integer, value_text, value_word, value_bad
  use mech9_diagnostics, only: diagnostics_type, printable
  implicit none
  private
  public :: find_part_names, number_references, find_called, words_about_called

  character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_'
  character(len=*), parameter :: name_letters = letters//'0123456789'
  integer, parameter :: most_freedoms = 6          !< coordinates of a joint
  integer, parameter :: most_links_by_matrix = 1000   !< beside those that pairs may join

contains

  !> Find the names that the groups &link and &pair give. Wrong names are reported where diagnostics are given.
  pure subroutine find_part_names(document, names, diagnostics)
    type(document_type), intent(inout) :: document                  !< as it is written; wrong names become bad values
    type(part_names_type), intent(out) :: names                     !< by numbers
    type(diagnostics_type), intent(inout), optional :: diagnostics  !< gets the errors
    character(len=longest_part_name), allocatable :: links(:)
    character(len=longest_called), allocatable :: coordinates(:)
    type(name_table_type) :: owners(2)
    integer :: i, most

    most = most_freedoms*count([(document%groups(i)%name == 'pair', i=1, size(document%groups))])
    allocate (links(0), coordinates(0))
    do i = 1, size(document%groups)
      if (document%groups(i)%name == 'link') then
        call take_name(document, i, 'number', most + most_links_by_matrix, links, owners(1), diagnostics)
      else if (document%groups(i)%name == 'pair') then
        call take_name(document, i, 'coordinate', most, coordinates, owners(2), diagnostics)
      end if
    end do
    if (size(links) > 0) call move_alloc(links, names%links)
    if (size(coordinates) > 0) call move_alloc(coordinates, names%coordinates)
  end subroutine find_part_names

  !> Take the name of one group, for the numbers that it gives.
  pure subroutine take_name(document, number, key, most, list, owners, diagnostics)
    type(document_type), intent(inout) :: document                   !< with the group
    integer, intent(in) :: number                                    !< position of the group
    character(len=*), intent(in) :: key                              !< under which the group gives its numbers, or under its plural
    integer, intent(in) :: most                                      !< largest number that may exist
    character(len=*), allocatable, intent(inout) :: list(:)          !< names by numbers; grows
    type(name_table_type), intent(inout) :: owners                   !< positions of groups by their names; grows
    type(diagnostics_type), intent(inout), optional :: diagnostics   !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: item, i
    logical :: is_right

    item = last_item(document%groups(number), 'name')
    if (item == 0) return
    associate (values => document%groups(number)%items(item)%values)
      if (size(values) /= 1) return
      if (values(1)%kind /= value_text) return
      if (present(diagnostics)) then
        call judge_name(document, number, values(1)%text, values(1)%span, owners%find(values(1)%text), is_right, &
                        diagnostics)
        if (.not. is_right) values(1)%kind = value_bad
        if (.not. is_right) return
      end if
      call owners%add(values(1)%text, number)
      numbers = numbers_under(document%groups(number), key)
      do i = 1, size(numbers)
        if (numbers(i) < 1 .or. numbers(i) > most) cycle
        call lengthen(list, numbers(i))
        ! a second group for a number is reported as such, so that the first name still means it
        if (list(numbers(i)) /= '') cycle
        list(numbers(i)) = values(1)%text
        if (size(numbers) > 1) list(numbers(i)) = values(1)%text//'('//to_text(i)//')'
      end do
    end associate
  end subroutine take_name

  !> Report a name that is none, or that another group has.
  pure subroutine judge_name(document, number, name, span, owner, is_right, diagnostics)
    type(document_type), intent(in) :: document            !< with the groups
    integer, intent(in) :: number                          !< position of the group with the name
    character(len=*), intent(in) :: name                   !< the name
    type(span_type), intent(in) :: span                    !< its place
    integer, intent(in) :: owner                           !< position of a group before that has it; 0: none
    logical, intent(out) :: is_right                       !< nothing is reported
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors

    is_right = is_part_name(name)
    associate (group => document%groups(number)%name)
      if (.not. is_right) then
        call diagnostics%add(span, 'the name of a '//group//' is of letters (a to z), digits and _, at most '// &
                             to_text(longest_part_name)//' of them, and begins with no digit: not '''// &
                             printable(name, longest_part_name)//'''')
        return
      end if
      if (is_of_another(document%groups(number), name)) then
        call diagnostics%add(span, 'columns of '//group//' '//name(2:)//' begin with '//name//'; give another name')
        is_right = .false.
        return
      end if
      if (owner == 0) return
      call diagnostics%add(span, 'a second '//group//' has the name '''//name//''''// &
                           trim(line_of(document%groups(owner), diagnostics)))
      is_right = .false.
    end associate
  end subroutine judge_name

  !> Whether a name begins columns of another part: L2 those of link 2, R2 those of pair 2.
  pure logical function is_of_another(group, name)
    type(group_type), intent(in) :: group     !< &link or &pair with this name
    character(len=*), intent(in) :: name      !< the name
    integer, allocatable :: numbers(:)
    character(len=1) :: letter

    letter = merge('L', 'R', group%name == 'link')
    is_of_another = .false.
    if (len(name) < 2) return
    if (name(1:1) /= letter .or. verify(name(2:), '0123456789') > 0) return
    numbers = numbers_under(group, trim(merge('number    ', 'coordinate', group%name == 'link')))
    is_of_another = .true.
    if (size(numbers) > 0) is_of_another = name(2:) /= to_text(numbers(1))
  end function is_of_another

  !> Whether a text may be the name of a part.
  pure logical function is_part_name(name)
    character(len=*), intent(in) :: name     !< any text

    is_part_name = len(name) > 0 .and. len(name) <= longest_part_name
    if (is_part_name) is_part_name = scan(name(1:1), letters) == 1 .and. verify(name, name_letters) == 0
  end function is_part_name

  !> Whether values are one text, this one.
  pure logical function is_text(values, name)
    type(value_type), intent(in) :: values(:)    !< of an item
    character(len=*), intent(in) :: name         !< the text

    is_text = .false.
    if (size(values) /= 1) return
    if (values(1)%kind == value_text) is_text = values(1)%text == name
  end function is_text

  !> The words about the line of a group that stands first; empty where it is not in the file.
  pure function line_of(group, diagnostics) result(words)
    type(group_type), intent(in) :: group               !< the group that stands first
    type(diagnostics_type), intent(in) :: diagnostics   !< knows the places in the file
    character(len=48) :: words

    words = ''
    if (group%span%source /= 1) return
    associate (position => diagnostics%place(group%span))
      words = '; the first stands in line '//to_text(position%line)
    end associate
  end function line_of

  !> Position of the last item of a name; 0 where there is none.
  pure integer function last_item(group, name) result(item)
    type(group_type), intent(in) :: group    !< as it is written
    character(len=*), intent(in) :: name     !< of the item

    do item = size(group%items), 1, -1
      if (group%items(item)%name == name) return
    end do
  end function last_item

  !> The whole numbers under a name or its plural.
  pure function numbers_under(group, key) result(numbers)
    type(group_type), intent(in) :: group    !< as it is written
    character(len=*), intent(in) :: key      !< the name
    integer, allocatable :: numbers(:)
    integer :: item

    allocate (numbers(0))
    item = max(last_item(group, key), last_item(group, key//'s'))
    if (item == 0) return
    associate (values => group%items(item)%values)
      if (any(values%kind /= value_integer) .or. size(values) > most_freedoms) return
      numbers = int(min(max(values%whole, -1_long), 1000000000_long))
    end associate
  end function numbers_under

  !> Replace the names of links and pairs that stand for numbers, and those in names of columns. Unknown ones are reported and become
  !> bad values.
  pure subroutine number_references(document, names, are_known, diagnostics)
    type(document_type), intent(inout) :: document           !< as it is written
    type(part_names_type), intent(in) :: names               !< by numbers
    logical, intent(in) :: are_known                         !< no name was wrong, so that unknown ones are reported
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the errors
    integer :: i, j, k, kind

    do i = 1, size(document%groups)
      do j = 1, size(document%groups(i)%items)
        associate (item => document%groups(i)%items(j))
          kind = refers_to(document%groups(i)%name, item%name)
          if (any(item%name == [character(len=6) :: 'of', 'over', 'column'])) then
            do k = 1, size(item%values)
              if (item%values(k)%kind == value_text) call number_columns(names, item%values(k)%text)
            end do
          else if (kind > 0) then
            do k = 1, size(item%values)
              if (item%values(k)%kind == value_text .or. (item%values(k)%kind == value_word .and. item%overrides)) &
                call number_reference(names, kind, item%values(k), are_known, diagnostics)
            end do
          end if
        end associate
      end do
    end do
  end subroutine number_references

  !> Replace one name by its number.
  pure subroutine number_reference(names, kind, value, are_known, diagnostics)
    type(part_names_type), intent(in) :: names               !< by numbers
    integer, intent(in) :: kind                              !< refers_to_link or refers_to_coordinate
    type(value_type), intent(inout) :: value                 !< the name; becomes a number, or a bad value
    logical, intent(in) :: are_known                         !< an unknown one is reported
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets an error
    integer :: number

    if (kind == refers_to_link) then
      number = link_named(names, value%text)
    else
      number = coordinate_named(names, value%text)
    end if
    if (number > 0) then
      value%kind = value_integer
      value%whole = number
      value%number = real(number, wp)
    else
      if (are_known) call refuse_name(names, kind, value, diagnostics)
      value%kind = value_bad
    end if
  end subroutine number_reference

  !> Report a name that no link or pair has, or that a joint with several coordinates has.
  pure subroutine refuse_name(names, kind, value, diagnostics)
    type(part_names_type), intent(in) :: names               !< by numbers
    integer, intent(in) :: kind                              !< refers_to_link or refers_to_coordinate
    type(value_type), intent(in) :: value                    !< the name
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the error
    character(len=:), allocatable :: hint
    integer :: several

    if (kind == refers_to_link) then
      hint = ''
      if (allocated(names%links)) hint = nearest_name(value%text, names%links)
      if (hint /= '') hint = '; did you mean '''//trim(hint)//'''?'
      if (hint == '') hint = '; a group &link gives a link its name'
      call diagnostics%add(value%span, 'there is no link with the name '''//printable(value%text, longest_called)//''''//hint)
      return
    end if
    several = 1
    do while (coordinate_named(names, value%text//'('//to_text(several)//')') > 0)
      several = several + 1
    end do
    if (several > 1) then
      call diagnostics%add(value%span, 'pair '''//value%text//''' has '//to_text(several - 1)//' coordinates; write '''// &
                           value%text//'(1)'' for the first one')
      return
    end if
    hint = ''
    if (allocated(names%coordinates)) hint = nearest_name(value%text, names%coordinates)
    if (hint /= '') hint = '; did you mean '''//trim(hint)//'''?'
    if (hint == '') hint = '; ''name'' in a group &pair gives a pair its name'
    call diagnostics%add(value%span, 'there is no pair with the name '''//printable(value%text, longest_called)//''''//hint)
  end subroutine refuse_name

  !> Positions of the groups of a kind that a name means: those with this name, or, where such groups have no names, those of the link
  !> or the pair that has it.
  pure subroutine find_called(document, kind, called, found)
    type(document_type), intent(in) :: document          !< as it is written, or checked
    character(len=*), intent(in) :: kind                 !< name of the groups, in lower case
    character(len=*), intent(in) :: called               !< the name
    integer, allocatable, intent(out) :: found(:)        !< positions in the document
    type(document_type) :: copy
    type(part_names_type) :: names
    integer :: i

    allocate (found(0))
    names = document%names
    if (.not. has_names(names)) then       ! it is not checked
      copy = document
      call find_part_names(copy, names)
    end if
    do i = 1, size(document%groups)
      if (document%groups(i)%name /= kind) cycle
      if (is_called(document%groups(i), called, names)) found = [found, i]
    end do
  end subroutine find_called

  !> The words about a name that no group of a kind has, or several.
  pure function words_about_called(kind, called, several) result(words)
    character(len=*), intent(in) :: kind         !< name of the groups, in lower case
    character(len=*), intent(in) :: called       !< the name
    integer, intent(in) :: several               !< how many groups have it
    character(len=2*len(kind) + len(called) + 60) :: words

    if (several == 0) then
      words = 'there is no &'//kind//' of the name '''//called//''''
    else
      words = to_text(several)//' groups &'//kind//' belong to '''//called//'''; say which one by its number, as in '//kind//'(2)'
    end if
  end function words_about_called

  !> Whether a group has a name, or belongs to the link or the pair that has it.
  pure logical function is_called(group, called, names)
    type(group_type), intent(in) :: group                !< as it is written, or checked
    character(len=*), intent(in) :: called               !< the name
    type(part_names_type), intent(in) :: names           !< of links and pairs
    integer :: i, item, number

    is_called = .false.
    item = last_item(group, 'name')
    if (item > 0) then
      is_called = is_text(group%items(item)%values, called)
      return
    end if
    do i = 1, size(group%items)
      associate (values => group%items(i)%values)
        if (all(group%items(i)%name /= [character(len=10) :: 'link', 'coordinate']) .or. size(values) /= 1) cycle
        number = link_named(names, called)
        if (refers_to(group%name, group%items(i)%name) == refers_to_coordinate) number = coordinate_named(names, called)
        if (number == 0) cycle
        is_called = is_text(values, called)
        if (values(1)%kind == value_integer) is_called = values(1)%whole == number
        if (is_called) return
      end associate
    end do
  end function is_called
end module mech9_part_name_check
