!> Changes to a document from the command line: --set group.name=value.
module mech9_setting
  use mech9_kinds, only: wp, long, radians_per_degree
  use mech9_text, only: lower, to_text
  use mech9_formula, only: formula_problem_type
  use mech9_formula_value, only: evaluate_number, looks_like_formula
  use mech9_part_names, only: longest_part_name
  use mech9_counted, only: counted
  use mech9_source, only: source_type, span_type, source_from_text
  use mech9_grammar, only: item_table
  use mech9_grammar_rows, only: refers_to
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_named_number, only: read_place
  use mech9_part_name_check, only: find_called, words_about_called
  use mech9_item_rows, only: find_item_rows
  use mech9_document, only: document_type, group_type, item_type, value_type, value_text, value_integer, value_real, value_bad, &
                            add_group, add_item, add_value, trim_document
  use mech9_scanner, only: scan_word, scan_value, skip_blanks, next_is_name, is_letter
  use mech9_parser, only: parse_item
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: apply_setting, has_formula, is_formula, element_end

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
    character(len=longest_part_name) :: called
    integer :: number, occurrence, at, found, i

    source = source_from_text('--set', setting, is_file=.false.)
    call diagnostics%add_source(source, number)
    found = diagnostics%count
    call read_group_name(setting, at, number, group_span, occurrence, called, diagnostics)
    if (diagnostics%count > found) return
    call read_item(setting, at, number, lower(setting(group_span%first:group_span%last)), raw_angle_unit(document), item, &
                   diagnostics)
    if (diagnostics%count > found) return
    if (called /= '') then
      call find_group_called(document, setting, group_span, trim(called), i, diagnostics)
    else
      call find_or_add_group(document, setting, group_span, occurrence, i, diagnostics)
    end if
    if (i > 0) call replace_item(document%groups(i), item)
  end subroutine apply_setting

  !> Read "group.", "group(2)." or "group(name)."; `occurrence` is 0 where no number is given.
  pure subroutine read_group_name(text, at, source, span, occurrence, called, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole setting
    integer, intent(out) :: at                            !< number of the first byte after the point
    integer, intent(in) :: source                         !< number of the setting as a source, for spans
    type(span_type), intent(out) :: span                  !< place of the name of the group in the setting
    integer, intent(out) :: occurrence                    !< place among the groups of that name, from 1; 0: not given
    character(len=*), intent(out) :: called               !< name of the group; blank where none is given
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical :: ok

    occurrence = 0
    called = ''
    at = 1
    if (len(text) > 0) at = max(verify(text, ' '), 1)
    span = span_type(source, at, at)
    ok = is_letter(text, at)
    if (ok) then
      call scan_word(text, at)
      span%last = at - 1
      call read_place(text, at, occurrence, called, ok)
    end if
    if (ok) ok = index(text(at:), '.') == 1
    if (ok) ok = next_is_name(text, at + 1)
    if (.not. ok) call diagnostics%add(span_type(source, 1, max(len(text), 1)), &
                                       'write --set group.name=value, group(2).name=value for the second group, or '// &
                                       'group(B).name=value for the one of the name B')
    at = at + 1
  end subroutine read_group_name

  !> Read the name and its values, up to the end of the setting.
  pure subroutine read_item(text, start, source, group, angle_unit, item, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole setting
    integer, intent(in) :: start                          !< number of the byte where the name begins
    integer, intent(in) :: source                         !< number of the setting as a source, for spans
    character(len=*), intent(in) :: group                 !< name of the group, in lower case
    real(wp), intent(in) :: angle_unit                    !< of the data file [rad]
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
      call read_formulas(text, start, equals, source, group, angle_unit, item, diagnostics)
      if (.not. allocated(item%values)) call parse_item(text, at, source, item, diagnostics)
      if (at <= len(text) .and. at > start) &
        call diagnostics%add(span_type(source, at, len(text)), 'the setting ends before this; give one --set for each name')
    end if
    item%overrides = .true.
  end subroutine read_item

  !> Read values of which some are formulas of numbers: 35*sqrt(2). Where none is, the item gets no values. 3*0.5 repeats a number in a
  !> list, and is a product where there is one number alone.
  pure subroutine read_formulas(text, start, equals, source, group, angle_unit, item, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole setting
    integer, intent(in) :: start                          !< number of the byte where the name begins
    integer, intent(in) :: equals                         !< number of the byte with the equals sign
    integer, intent(in) :: source                         !< number of the setting as a source, for spans
    character(len=*), intent(in) :: group                 !< name of the group, in lower case
    real(wp), intent(in) :: angle_unit                    !< of the data file [rad]
    type(item_type), intent(out) :: item                  !< the name with its values, or without them
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(item_type) :: head
    type(diagnostics_type) :: unused
    type(value_type) :: value
    integer, allocatable :: rows(:)
    integer :: first, last, at, count
    logical :: alone

    at = start
    unused = diagnostics
    call parse_item(text(:equals)//'0', at, source, head, unused)
    if (unused%count > diagnostics%count) return
    rows = find_item_rows(group, head%name)
    if (size(rows) == 0) return
    if (all(item_table(rows(1))%type /= [character(len=7) :: 'real', 'integer']) .or. refers_to(group, head%name) > 0) return
    alone = item_table(rows(1))%high == 1
    if (size(head%subscripts) == 1) alone = alone .or. .not. head%subscripts(1)%section
    if (.not. has_formula(text, equals, alone)) return
    count = 0
    last = equals
    do while (last <= len(text))
      first = last + 1
      last = element_end(text, first)
      if (is_formula(text(first:last - 1), alone)) then
        call read_formula(text, first, last - 1, source, angle_unit, value, diagnostics)
        call add_value(head%values, count, value)
      else
        at = first
        call skip_blanks(text, at)
        value = value_type(span=span_type(source, min(first, len(text)), min(first, len(text))))
        if (at >= last) call add_value(head%values, count, value)
        do while (at < last)
          call scan_value(text(:last - 1), at, source, value, diagnostics)
          call add_value(head%values, count, value)
          call skip_blanks(text, at)
        end do
      end if
    end do
    head%values = head%values(:count)
    item = head
  end subroutine read_formulas

  !> Whether any element of a list is a formula.
  pure logical function has_formula(text, equals, alone)
    character(len=*), intent(in) :: text        !< the whole setting
    integer, intent(in) :: equals               !< number of the byte with the equals sign
    logical, intent(in) :: alone                !< there is one number alone, and nothing to repeat
    integer :: first, last

    has_formula = .false.
    last = equals
    do while (last <= len(text))
      first = last + 1
      last = element_end(text, first)
      has_formula = has_formula .or. is_formula(text(first:last - 1), alone)
    end do
  end function has_formula

  !> Whether an element of a list is a formula.
  pure logical function is_formula(element, alone)
    character(len=*), intent(in) :: element     !< between two commas
    logical, intent(in) :: alone                !< there is one number alone, and nothing to repeat
    type(numeral_type) :: numeral
    integer :: at, star, blank

    is_formula = .false.
    if (.not. looks_like_formula(trim(adjustl(element)))) return
    is_formula = .true.
    ! numbers with blanks between them, and repeats, are none
    at = 1
    do
      at = at + verify(element(at:)//'x', ' ') - 1
      if (at > len(element)) exit
      blank = at + scan(element(at:)//' ', ' ') - 2
      star = index(element(at:blank), '*')
      if (star > 0 .and. alone) return
      if (star > 1) then
        if (verify(element(at:at + star - 2), '0123456789') > 0) return
        at = at + star
        if (at > blank) cycle
      end if
      call read_numeral(element(at:blank), numeral)
      if (allocated(numeral%problem)) return
      at = blank + 1
    end do
    is_formula = .false.
  end function is_formula

  !> Read one formula.
  pure subroutine read_formula(text, first, last, source, angle_unit, value, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole setting
    integer, intent(in) :: first                          !< first byte of the formula
    integer, intent(in) :: last                           !< last byte
    integer, intent(in) :: source                         !< number of the setting as a source, for spans
    real(wp), intent(in) :: angle_unit                    !< of the data file [rad]
    type(value_type), intent(out) :: value                !< its value
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets an error
    type(formula_problem_type) :: problem

    value%span = span_type(source, first + verify(text(first:last), ' ') - 1, first + len_trim(text(first:last)) - 1)
    value%kind = value_real
    call evaluate_number(text(first:last), angle_unit, value%number, problem)
    if (allocated(problem%words)) then
      call diagnostics%add(span_type(source, first + problem%first - 1, first + problem%last - 1), problem%words)
      value%kind = value_bad
    else if (abs(value%number - anint(value%number)) <= 0.0_wp .and. abs(value%number) < 1.0e15_wp) then
      value%kind = value_integer
      value%whole = nint(value%number, long)
    end if
  end subroutine read_formula

  !> Number of the byte behind an element of a list: a comma that is in no parentheses, or the end.
  pure integer function element_end(text, first) result(at)
    character(len=*), intent(in) :: text     !< the whole setting
    integer, intent(in) :: first             !< first byte of the element
    integer :: depth

    depth = 0
    do at = first, len(text)
      if (text(at:at) == '(') depth = depth + 1
      if (text(at:at) == ')') depth = depth - 1
      if (text(at:at) == ',' .and. depth <= 0) return
    end do
    at = len(text) + 1
  end function element_end

  !> One unit of angle of a data file as it is written [rad].
  pure real(wp) function raw_angle_unit(document) result(unit)
    type(document_type), intent(in) :: document     !< not checked
    integer :: i, j

    unit = 1.0_wp
    do i = 1, size(document%groups)
      if (document%groups(i)%name /= 'mechanism') cycle
      do j = 1, size(document%groups(i)%items)
        associate (item => document%groups(i)%items(j))
          if (item%name /= 'angle_unit' .or. size(item%values) /= 1) cycle
          if (item%values(1)%kind /= value_text) cycle
          unit = merge(radians_per_degree, 1.0_wp, lower(item%values(1)%text) == 'deg')
        end associate
      end do
    end do
  end function raw_angle_unit

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

  !> Position of the group with a name; 0, with a report, where there is none or several.
  pure subroutine find_group_called(document, text, span, called, number, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    character(len=*), intent(in) :: text                  !< the whole setting
    type(span_type), intent(in) :: span                   !< place of the name of the group in the setting
    character(len=*), intent(in) :: called                !< name of the group
    integer, intent(out) :: number                        !< position of the group in the document; 0 where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: found(:)

    number = 0
    call find_called(document, lower(text(span%first:span%last)), called, found)
    if (size(found) == 1) number = found(1)
    if (size(found) /= 1) &
      call diagnostics%add(span, trim(words_about_called(lower(text(span%first:span%last)), called, size(found))))
  end subroutine find_group_called

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
