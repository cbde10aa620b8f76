!> Changes to a document from the command line: --set group.name=value.
module mech9_setting
  use mech9_text, only: lower, to_text
  use mech9_counted, only: counted
  use mech9_source, only: source_type, span_type, source_from_text
  use mech9_grammar, only: item_table
  use mech9_item_rows, only: find_item_rows
  use mech9_document, only: document_type, group_type, item_type, subscript_type, value_text, &
                            add_group, add_item, trim_document
  use mech9_scanner, only: scan_word, scan_subscripts, next_is_name, is_letter
  use mech9_parser, only: parse_item
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: apply_setting

contains

  !> Replace the value of a name in the data file: "time.intervals=200", "pair(3).axis=1,0,0",
  !> where pair(3) is the third &pair. A group or a name that the file does not have is added. Texts
  !> need no quotes. The diagnostics get the errors, now or when the document is checked.
  pure subroutine apply_setting(document, setting, diagnostics)
    type(document_type), intent(inout) :: document        !< the data file as groups and items
    character(len=*), intent(in) :: setting               !< the argument of --set, such as time.intervals=200
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(source_type) :: source
    type(span_type) :: group_span
    type(item_type) :: item
    integer :: number, occurrence, at, found, i

    source = source_from_text('--set', setting, is_file=.false.)
    call diagnostics%add_source(source, number)
    found = diagnostics%count
    call read_group_name(setting, at, number, group_span, occurrence, diagnostics)
    if (diagnostics%count > found) return
    call read_item(setting, at, number, lower(setting(group_span%first:group_span%last)), item, diagnostics)
    if (diagnostics%count > found) return
    call find_or_add_group(document, setting, group_span, occurrence, i, diagnostics)
    if (i > 0) call replace_item(document%groups(i), item)
  end subroutine apply_setting

  !> Read "group." or "group(2)."; `occurrence` is 0 where no number is given.
  pure subroutine read_group_name(text, at, source, span, occurrence, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole setting
    integer, intent(out) :: at                            !< number of the first byte after the point
    integer, intent(in) :: source                         !< number of the setting as a source, for spans
    type(span_type), intent(out) :: span                  !< place of the name of the group in the setting
    integer, intent(out) :: occurrence                    !< place among the groups of that name, from 1; 0: not given
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(subscript_type), allocatable :: subscripts(:)
    logical :: ok

    occurrence = 0
    at = 1
    if (len(text) > 0) at = max(verify(text, ' '), 1)
    span = span_type(source, at, at)
    ok = is_letter(text, at)
    if (ok) then
      call scan_word(text, at)
      span%last = at - 1
      if (index(text(at:), '(') == 1) then
        call scan_subscripts(text, at, subscripts, ok)
        if (ok) ok = size(subscripts) == 1
        if (ok) ok = .not. subscripts(1)%section
        if (ok) occurrence = subscripts(1)%first
      end if
    end if
    if (ok) ok = index(text(at:), '.') == 1
    if (ok) ok = next_is_name(text, at + 1)
    if (.not. ok) call diagnostics%add(span_type(source, 1, max(len(text), 1)), &
                                       'write --set group.name=value, or group(2).name=value for the second group')
    at = at + 1
  end subroutine read_group_name

  !> Read the name and its values, up to the end of the setting.
  pure subroutine read_item(text, start, source, group, item, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole setting
    integer, intent(in) :: start                          !< number of the byte where the name begins
    integer, intent(in) :: source                         !< number of the setting as a source, for spans
    character(len=*), intent(in) :: group                 !< name of the group, in lower case
    type(item_type), intent(out) :: item                  !< the name with its values
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: at, equals

    at = start
    equals = start + index(text(start:), '=') - 1
    call scan_word(text, at)
    if (text(equals + 1:) == '') then
      call diagnostics%add(span_type(source, equals, equals), "a value is missing after this; an empty text is written ''")
      return
    end if
    if (takes_text(group, text(start:at - 1)) .and. is_unquoted(text(equals + 1:))) then
      item%name = lower(text(start:at - 1))
      item%span = span_type(source, start, at - 1)
      allocate (item%subscripts(0), item%values(1))
      item%values(1)%kind = value_text
      item%values(1)%text = trim(adjustl(text(equals + 1:)))
      item%values(1)%span = span_type(source, equals + 1, len(text))
    else
      at = start
      call parse_item(text, at, source, item, diagnostics)
      if (at <= len(text)) &
        call diagnostics%add(span_type(source, at, len(text)), 'the setting ends before this; give one --set for each name')
    end if
    item%overrides = .true.
  end subroutine read_item

  !> Whether a name takes a text.
  pure logical function takes_text(group, name)
    character(len=*), intent(in) :: group  !< name of the group
    character(len=*), intent(in) :: name   !< name of the item
    integer, allocatable :: rows(:)

    rows = find_item_rows(group, name)
    takes_text = .false.
    if (size(rows) > 0) takes_text = item_table(rows(1))%type == 'text'
  end function takes_text

  !> Whether a value is given without quotes.
  pure logical function is_unquoted(value)
    character(len=*), intent(in) :: value  !< the setting after its equals sign

    is_unquoted = len_trim(value) > 0 .and. scan(trim(adjustl(value)), '''"') /= 1
  end function is_unquoted

  !> Position of the group that a setting means; 0, with a report, where that is unclear.
  pure subroutine find_or_add_group(document, text, span, occurrence, number, diagnostics)
    type(document_type), intent(inout) :: document        !< the data file as groups and items
    character(len=*), intent(in) :: text                  !< the whole setting
    type(span_type), intent(in) :: span                   !< place of the name of the group in the setting
    integer, intent(in) :: occurrence                     !< place among the groups of that name, from 1; 0: not given
    integer, intent(out) :: number                        !< position of the group in the document; 0 where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: name
    type(group_type) :: group
    integer, allocatable :: same(:)
    integer :: i, count

    name = lower(text(span%first:span%last))
    same = pack([(i, i=1, size(document%groups))], [(document%groups(i)%name == name, i=1, size(document%groups))])
    number = 0
    if (occurrence == 0 .and. size(same) > 1) then
      call diagnostics%add(span, 'there are '//to_text(size(same))//' groups &'//name//'; say which one: '//name//'(2)')
    else if (max(occurrence, 1) <= size(same)) then
      number = same(max(occurrence, 1))
    else if (occurrence > size(same) + 1) then
      call diagnostics%add(span, 'this file has '//counted(size(same), 'group')//' &'//name//' only')
    else
      group%name = name
      group%span = span
      allocate (group%items(0))
      count = size(document%groups)
      call add_group(document%groups, count, group)
      call trim_document(document%groups, count)
      number = count
    end if
  end subroutine find_or_add_group

  !> Replace the items of the same name by this one; an item with subscripts is added to them.
  pure subroutine replace_item(group, item)
    type(group_type), intent(inout) :: group  !< the group of the data file
    type(item_type), intent(inout) :: item    !< the name with its values
    type(item_type), allocatable :: items(:)
    integer :: i, count

    count = 0
    do i = 1, size(group%items)
      if (group%items(i)%name == item%name .and. size(item%subscripts) == 0) cycle
      call add_item(items, count, group%items(i))
    end do
    call add_item(items, count, item)
    group%items = items(:count)
  end subroutine replace_item
end module mech9_setting
