!> A number of a checked document by its name, as --set writes it: group.name, or group(2).name(3).
module mech9_named_number
  use mech9_kinds, only: wp, long
  use mech9_text, only: lower, nearest_name, to_text
  use mech9_source, only: span_type
  use mech9_grammar, only: item_table, find_group_row, names_of_groups, names_in_group
  use mech9_item_rows, only: find_item_rows
  use mech9_document, only: document_type, group_type, item_type, subscript_type, value_type, value_real, value_integer, add_item
  use mech9_lookup, only: find_item, get_reals, row_of
  use mech9_scanner, only: scan_word, scan_subscripts, is_letter
  use mech9_part_names, only: longest_part_name
  use mech9_part_name_check, only: find_called, words_about_called
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: takes_any, number_name_type, number_place_type, read_name, read_place, find_number, set_number

  !> The parts of a name.
  type :: number_name_type
    character(len=24) :: group = ''   !< in lower case
    integer :: number = 0             !< place among the groups of this name, from 1; 0: not given
    character(len=longest_part_name) :: called = ''   !< name of the group in place of the number, as in pair(B)
    character(len=24) :: item = ''    !< in lower case
    integer :: position = 0           !< of the number under the item's name, from 1; 0: not given
  end type number_name_type

  !> The place of a number in a checked document.
  type :: number_place_type
    integer :: group = 0              !< position of the group; 0: the number was not found
    integer :: item = 0               !< position of the item in the group
    integer :: value = 0              !< position of the number in the item
    integer :: row = 0                !< row of the item in item_table
    type(number_name_type) :: name    !< parts of its name, complete
  end type number_place_type

  character(len=*), parameter :: digits = '0123456789'
  real(wp), parameter :: most_whole = 2.0_wp**53   !< whole numbers beyond it have neighbours that are not whole
  !> Groups whose numbers describe studies, not a mechanism and its motion.
  character(len=9), parameter :: closed_groups(7) = [character(len=9) :: 'parameter', 'quantity', 'study', 'objective', &
                                                                   'limit', 'optimum', 'branch']

contains

  !> Take a name apart; `ok` is false where it does not have the form group(2).name(3), with or without the numbers.
  pure subroutine read_name(text, name, ok)
    character(len=*), intent(in) :: text           !< the name as the user wrote it
    type(number_name_type), intent(out) :: name    !< its parts
    logical, intent(out) :: ok                     !< the text has the form of a name
    integer :: at, first

    at = max(verify(text, ' '), 1)
    first = at
    ok = is_letter(text, at)
    if (ok) call scan_word(text, at)
    if (ok) name%group = lower(text(first:at - 1))
    if (ok) call read_place(text, at, name%number, name%called, ok)
    if (ok) ok = index(text(min(at, len(text) + 1):), '.') == 1
    at = at + 1
    first = at
    if (ok) ok = is_letter(text, at)
    if (ok) call scan_word(text, at)
    if (ok) name%item = lower(text(first:at - 1))
    if (ok) call read_position(text, at, name%position, ok)
    if (ok .and. at <= len(text)) ok = text(at:) == ''
  end subroutine read_name

  !> Read the number or the name of a group in parentheses, if they stand here. A name may have quotes.
  pure subroutine read_place(text, at, number, called, ok)
    character(len=*), intent(in) :: text       !< the name as the user wrote it
    integer, intent(inout) :: at               !< number of a byte: where to begin, then the first byte not taken
    integer, intent(out) :: number             !< place among the groups of this name, from 1; 0: not given
    character(len=*), intent(out) :: called    !< name of the group; blank where none is given
    logical, intent(out) :: ok                 !< parentheses, if there are any, hold one of them
    integer :: first, last, closing

    number = 0
    called = ''
    ok = .true.
    if (at > len(text)) return
    if (text(at:at) /= '(') return
    closing = index(text(at:), ')') + at - 1
    if (closing <= at + 1) then
      call read_position(text, at, number, ok)
      return
    end if
    first = at + 1
    last = closing - 1
    if (last - first >= 2) then
      if (scan(text(first:first), '''"') == 1 .and. text(first:first) == text(last:last)) then
        first = first + 1
        last = last - 1
      end if
    end if
    if (verify(text(first:last), digits//' :,') == 0) then
      call read_position(text, at, number, ok)
      return
    end if
    at = first
    call scan_word(text, at)
    ok = at == last + 1 .and. last - first < len(called)
    if (ok) called = text(first:last)
    at = closing + 1
  end subroutine read_place

  !> Read a position in parentheses, if one stands here.
  pure subroutine read_position(text, at, position, ok)
    character(len=*), intent(in) :: text    !< the name as the user wrote it
    integer, intent(inout) :: at            !< number of a byte: where to begin, then the first byte not taken
    integer, intent(out) :: position        !< from 1; 0 where none is given
    logical, intent(out) :: ok              !< parentheses, if there are any, hold one position
    type(subscript_type), allocatable :: subscripts(:)

    position = 0
    ok = .true.
    if (at > len(text)) return
    if (text(at:at) /= '(') return
    call scan_subscripts(text, at, subscripts, ok)
    if (ok) ok = size(subscripts) == 1
    if (ok) ok = .not. subscripts(1)%section
    if (ok) position = subscripts(1)%first
  end subroutine read_position

  !> Find the real number that a name means, of the mechanism or its motion. A name that the group does not give is added with its
  !> default. Errors are reported at the place of the name, and `place%group` is then 0; it is 0 without a report where the group
  !> holds other errors.
  pure subroutine find_number(document, text, span, alone, place, diagnostics, any_number)
    type(document_type), intent(inout) :: document        !< checked; gets an item for a default
    character(len=*), intent(in) :: text                  !< the name as the user wrote it
    type(span_type), intent(in) :: span                   !< its place
    logical, intent(in) :: alone                          !< the only number of a name is added where it has no default
    type(number_place_type), intent(out) :: place         !< of the number
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical, intent(in), optional :: any_number           !< whole numbers and those of all groups are meant, too
    type(number_name_type) :: name
    integer :: found, group, row
    logical :: ok, of_parameter

    found = diagnostics%count
    of_parameter = .true.
    if (present(any_number)) of_parameter = .not. any_number
    call read_name(text, name, ok)
    place%name = name
    if (.not. ok) call diagnostics%add(span, 'write the name of a number as group.name, or group(2).name(3) for the third '// &
                                       'number in the second group of this name')
    if (ok) call check_names(name, of_parameter, span, diagnostics)
    if (diagnostics%count > found) return
    call find_group(document, name, span, group, diagnostics)
    if (group == 0) return
    if (.not. document%groups(group)%sound) return
    call find_row(document%groups(group), name, of_parameter, span, row, diagnostics)
    if (row == 0) return
    call give_default(document%groups(group), name, row, alone, span, diagnostics)
    if (diagnostics%count > found) return
    call find_position(document%groups(group), name, row, span, diagnostics)
    if (diagnostics%count > found) return
    place = number_place_type(group, find_item(document%groups(group), trim(name%item)), name%position, row, name)
  end subroutine find_number

  !> Give a number that was found another value. Its range is judged when the document is checked.
  pure subroutine set_number(document, place, number)
    type(document_type), intent(inout) :: document        !< checked
    type(number_place_type), intent(in) :: place          !< of the number
    real(wp), intent(in) :: number                        !< the value, in the unit of the data file

    associate (value => document%groups(place%group)%items(place%item)%values(place%value))
      value%kind = value_real
      value%number = number
      if (item_table(place%row)%type == 'integer') call make_whole(value)
    end associate
  end subroutine set_number

  !> Whether a number may have any value.
  pure logical function takes_any(place)
    type(number_place_type), intent(in) :: place   !< of the number

    associate (row => item_table(place%row))
      takes_any = row%type == 'real' .and. row%range == ''
    end associate
  end function takes_any

  !> Report names of groups and items that the grammar does not have, with the nearest that it has.
  pure subroutine check_names(name, of_parameter, span, diagnostics)
    type(number_name_type), intent(in) :: name            !< parts of the name
    logical, intent(in) :: of_parameter                   !< a parameter is to set the number
    type(span_type), intent(in) :: span                   !< its place
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=80) :: hint

    hint = ''
    if (find_group_row(name%group) == 0) then
      hint = nearest_name(trim(name%group), names_of_groups())
      if (hint /= '') hint = '; did you mean '''//trim(hint)//'''?'
      call diagnostics%add(span, 'unknown group '''//trim(name%group)//''''//trim(hint))
    else if (of_parameter .and. any(closed_groups == name%group)) then
      call diagnostics%add(span, 'a parameter sets numbers of the mechanism and its motion, not of &'//trim(name%group))
    else if (size(find_item_rows(name%group, name%item)) == 0) then
      hint = nearest_name(trim(name%item), names_in_group(name%group))
      if (hint /= '') hint = '; did you mean '''//trim(hint)//'''?'
      call diagnostics%add(span, 'unknown name '''//trim(name%item)//''' in &'//trim(name%group)//trim(hint))
    end if
  end subroutine check_names

  !> Position of the group that a name means; 0, with a report, where there is none or it is not clear which.
  pure subroutine find_group(document, name, span, group, diagnostics)
    type(document_type), intent(in) :: document           !< checked
    type(number_name_type), intent(inout) :: name         !< parts of the name; gets the place of the only group
    type(span_type), intent(in) :: span                   !< its place
    integer, intent(out) :: group                         !< position of the group in the document
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=14) :: position
    integer :: i, count

    if (name%called /= '') then
      call find_group_called(document, name, span, group, diagnostics)
      return
    end if
    count = 0
    group = 0
    do i = 1, size(document%groups)
      if (document%groups(i)%name /= name%group) cycle
      count = count + 1
      if (count == max(name%number, 1)) group = i
    end do
    if (count == 0) then
      call diagnostics%add(span, 'there is no &'//trim(name%group)//' in this file')
    else if (name%number > count) then
      call diagnostics%add(span, 'this file has '//to_text(count)//trim(merge(' group ', ' groups', count == 1))//' &'// &
                           trim(name%group)//' only')
    else if (name%number == 0 .and. count > 1) then
      position = ''
      if (name%position > 0) position = '('//to_text(name%position)//')'
      call diagnostics%add(span, 'there are '//to_text(count)//' groups &'//trim(name%group)//'; say which one: '// &
                           trim(name%group)//'(2).'//trim(name%item)//trim(position))
      group = 0
    end if
    name%number = max(name%number, 1)
  end subroutine find_group

  !> Position of the group with a name, as in pair(B); 0, with a report, where there is none or several.
  pure subroutine find_group_called(document, name, span, group, diagnostics)
    type(document_type), intent(in) :: document           !< checked
    type(number_name_type), intent(inout) :: name         !< parts of the name; gets the place of the group
    type(span_type), intent(in) :: span                   !< its place
    integer, intent(out) :: group                         !< position of the group in the document
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: found(:)
    integer :: i

    group = 0
    call find_called(document, trim(name%group), trim(name%called), found)
    if (size(found) /= 1) then
      call diagnostics%add(span, trim(words_about_called(trim(name%group), trim(name%called), size(found))))
      return
    end if
    group = found(1)
    name%number = count([(document%groups(i)%name == name%group, i=1, group)])
  end subroutine find_group_called

  !> Row of the grammar for a name in its group; 0, with a report, where it does not belong there or takes no real numbers.
  pure subroutine find_row(group, name, of_parameter, span, row, diagnostics)
    type(group_type), intent(in) :: group                 !< without errors
    type(number_name_type), intent(in) :: name            !< parts of the name
    logical, intent(in) :: of_parameter                   !< a parameter is to set the number
    type(span_type), intent(in) :: span                   !< its place
    integer, intent(out) :: row                           !< row of item_table
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=60) :: reason
    character(len=*), parameter :: is_real = ', and a parameter is a real number'

    row = row_of(group, trim(name%item))
    if (row == 0) then
      call diagnostics%add(span, ''''//trim(name%item)//''' does not belong to this kind of &'//trim(name%group))
      return
    end if
    select case (item_table(row)%type)
    case ('real')
      return
    case ('integer')
      if (.not. of_parameter) return
      reason = ' takes whole numbers'
    case ('logical')
      reason = ' is .true. or .false.'
    case default
      reason = ' is a word'
    end select
    if (of_parameter) then
      reason = trim(reason)//is_real
    else
      reason = trim(reason)//', not a number'
    end if
    call diagnostics%add(span, ''''//trim(name%item)//''''//trim(reason))
    row = 0
  end subroutine find_row

  !> Give a group the default of a name that it does not give.
  pure subroutine give_default(group, name, row, alone, span, diagnostics)
    type(group_type), intent(inout) :: group              !< without errors; gets the item
    type(number_name_type), intent(in) :: name            !< parts of the name
    integer, intent(in) :: row                            !< row of item_table
    logical, intent(in) :: alone                          !< a number without default may be added where it is the only one
    type(span_type), intent(in) :: span                   !< place of the name
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(item_type) :: item
    integer :: i, count

    if (find_item(group, trim(name%item)) > 0) return
    associate (numbers => get_reals(group, trim(name%item)))
      if (size(numbers) == 0 .and. .not. (alone .and. item_table(row)%high == 1)) then
        call diagnostics%add(span, 'this &'//trim(name%group)//' does not give '''//trim(name%item)//'''; write it first')
        return
      end if
      item%name = trim(name%item)
      item%span = group%span
      allocate (item%subscripts(0), item%values(max(1, size(numbers))))
      do i = 1, size(item%values)
        item%values(i)%kind = value_real
        item%values(i)%span = group%span
        if (i <= size(numbers)) item%values(i)%number = numbers(i)
        if (item_table(row)%type == 'integer') call make_whole(item%values(i))
      end do
    end associate
    count = size(group%items)
    call append(group%items, count, item)
  end subroutine give_default

  !> Turn a value without a fraction into an integer.
  pure subroutine make_whole(value)
    type(value_type), intent(inout) :: value   !< a number

    if (abs(value%number - anint(value%number)) > 0.0_wp .or. abs(value%number) >= most_whole) return
    value%kind = value_integer
    value%whole = nint(value%number, long)
  end subroutine make_whole

  !> Append an item to all items of a group.
  pure subroutine append(items, count, item)
    type(item_type), allocatable, intent(inout) :: items(:)  !< all items of the group
    integer, intent(inout) :: count                          !< number of items
    type(item_type), intent(inout) :: item                   !< the item to append; its values are moved
    type(item_type), allocatable :: cut(:)

    call add_item(items, count, item)
    if (size(items) == count) return
    cut = items(:count)
    call move_alloc(cut, items)
  end subroutine append

  !> Report a position that is missing or does not exist; the only number of a name needs none.
  pure subroutine find_position(group, name, row, span, diagnostics)
    type(group_type), intent(in) :: group                 !< without errors, with the item
    type(number_name_type), intent(inout) :: name         !< parts of the name; gets the position of the only number
    integer, intent(in) :: row                            !< row of item_table
    type(span_type), intent(in) :: span                   !< place of the name
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: count

    count = size(group%items(find_item(group, trim(name%item)))%values)
    if (name%position == 0 .and. count > 1) then
      call diagnostics%add(span, ''''//trim(name%item)//''' has '//to_text(count)//' numbers; say which one: '''// &
                           trim(name%item)//'(2)''')
    else if (name%position > count) then
      call diagnostics%add(span, ''''//trim(name%item)//''' has '//to_text(count)// &
                           trim(merge(' number ', ' numbers', count == 1))//' only')
    end if
    name%position = max(name%position, 1)
  end subroutine find_position
end module mech9_named_number
