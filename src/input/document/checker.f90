!> Check of a document against the grammar: groups, names, values, missing names and repeated ones.
!>
!> A document that passes can be read by mech9_lookup without further checks.
module mech9_checker
  use mech9_text, only: to_text, lower, nearest_name
  use mech9_source, only: span_type
  use mech9_grammar, only: group_table, item_table, find_group_row, rows_of_group, find_item_rows, &
                           item_row_for_kind, takes_kind, names_of_groups, names_in_group
  use mech9_document, only: document_type, group_type, item_type, value_type, value_bad, value_null, value_text, &
                            value_integer, add_item
  use mech9_item_merge, only: merge_items, expand_repeats
  use mech9_item_check, only: check_item, known_word
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: check_document

  integer, parameter :: kind_length = 36  !< length of the longest kind of a group with its law

contains

  !> Check all groups. Each group gets its row of the grammar, one plain item for each name, and the
  !> mark `sound` where nothing is wrong with it.
  pure subroutine check_document(document, diagnostics)
    type(document_type), intent(inout) :: document        !< the data file as groups and items
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    integer :: i, found

    do i = 1, size(document%groups)
      associate (group => document%groups(i))
        group%row = find_group_row(group%name)
        if (group%row == 0) then
          call report_unknown_group(group, diagnostics)
          cycle
        end if
        found = diagnostics%count
        group%sound = .not. has_bad_value(group)
        call check_group(group, diagnostics)
        group%sound = group%sound .and. diagnostics%count == found
      end associate
    end do
    do i = 1, size(group_table)
      call check_repeated(document, i, diagnostics)
    end do
  end subroutine check_document

  !> Report a group that is not in the grammar, with the nearest known name.
  pure subroutine report_unknown_group(group, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    character(len=:), allocatable :: hint

    if (group%name == '') return          ! this error was reported when the file was read
    hint = nearest_name(group%name, names_of_groups())
    if (hint /= '') hint = '; did you mean &'//hint//'?'
    call diagnostics%add(group%span, 'unknown group '//diagnostics%text_of(group%span)//hint)
  end subroutine report_unknown_group

  !> Whether the group holds a value that was reported when it was read.
  pure logical function has_bad_value(group)
    type(group_type), intent(in) :: group  !< the group of the data file
    integer :: i

    has_bad_value = .true.
    do i = 1, size(group%items)
      if (any(group%items(i)%values%kind == value_bad)) return
    end do
    has_bad_value = .false.
  end function has_bad_value

  !> Check the names and values of one group.
  pure subroutine check_group(group, diagnostics)
    type(group_type), intent(inout) :: group              !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    character(len=kind_length) :: kind

    call merge_group(group, diagnostics)
    kind = kind_of(group)
    call check_items(group, kind, diagnostics)
    call check_missing(group, kind, diagnostics)
  end subroutine check_group

  !> Make one item of each name. The coincidence matrix keeps its rows and columns apart.
  pure subroutine merge_group(group, diagnostics)
    type(group_type), intent(inout) :: group              !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    type(item_type), allocatable :: merged(:)
    type(item_type) :: one
    integer :: firsts(size(group%items)), i, j, count, names

    count = 0
    names = 0
    do i = 1, size(group%items)
      if (is_matrix(group, group%items(i))) then
        one = group%items(i)
        call expand_repeats(group%items(i), one%values, diagnostics)
      else
        do j = 1, names
          if (group%items(firsts(j))%name == group%items(i)%name) exit
        end do
        if (j <= names) cycle
        names = names + 1
        firsts(names) = i   ! positions of the first items of each name
        call merge_items(group%items, group%items(i)%name, one, diagnostics)
      end if
      if (all(one%values%kind == value_null)) cycle   ! "name = ," gives no value: the default holds
      call add_item(merged, count, one)
    end do
    if (.not. allocated(merged)) allocate (merged(0))
    group%items = merged(:count)
  end subroutine merge_group

  !> Whether an item belongs to the coincidence matrix.
  pure logical function is_matrix(group, item)
    type(group_type), intent(in) :: group  !< the group of the data file
    type(item_type), intent(in) :: item    !< the item that may be the coincidence matrix

    is_matrix = group%name == 'structure' .and. item%name == 'c'
  end function is_matrix

  !> The kind that a group gives, and after a blank its law, as in law:harmonic; empty where it gives none, or an unknown one.
  pure function kind_of(group) result(kind)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=kind_length) :: kind, law

    kind = word_in(group, 'kind')
    law = word_in(group, 'law')
    if (law /= '') kind = trim(kind)//' law:'//law
  end function kind_of

  !> The word that a group gives under a name, in lower case; empty where it gives none, or an unknown one.
  pure function word_in(group, name) result(word)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< a name with a list of words
    character(len=kind_length) :: word
    integer, allocatable :: rows(:)
    integer :: i

    word = ''
    rows = find_item_rows(group%name, name)
    if (size(rows) == 0) return
    do i = 1, size(group%items)
      if (group%items(i)%name /= name .or. size(group%items(i)%values) /= 1) cycle
      if (group%items(i)%values(1)%kind /= value_text) cycle
      if (known_word(group%items(i)%values(1)%text, item_table(rows(1)))) word = lower(trim(group%items(i)%values(1)%text))
    end do
  end function word_in

  !> Check each item of a group against the row of its name.
  pure subroutine check_items(group, kind, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: kind                  !< the kind of the group; empty where it has none
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    integer, allocatable :: rows(:)
    integer :: i, row

    do i = 1, size(group%items)
      associate (item => group%items(i))
        rows = find_item_rows(group%name, item%name)
        row = item_row_for_kind(group%name, item%name, kind)
        if (size(rows) == 0) then
          call report_unknown_name(group, item, diagnostics)
        else if (row > 0) then
          call check_item(item, item_table(row), diagnostics)
        else if (index(item_table(rows(1))%kinds, 'law:') == 1 .and. index(kind, 'law:') == 0) then
          call diagnostics%add(item%span, ''''//item%name//''' needs law='''//trim(item_table(rows(1))%kinds(5:))//'''')
        else if (kind /= '') then
          call diagnostics%add(item%span, ''''//item%name//''' does not belong to '//trim(group%name)// &
                               's of kind '''//trim(in_words(kind))//'''')
        end if
      end associate
    end do
  end subroutine check_items

  !> A kind with its law, for a message: coordinate' with law='harmonic.
  pure function in_words(kind) result(words)
    character(len=*), intent(in) :: kind   !< as kind_of gives it
    character(len=len(kind) + 20) :: words
    integer :: i

    words = kind
    i = index(kind, ' law:')
    if (i > 0) words = kind(:i - 1)//''' with law='''//kind(i + 5:)
  end function in_words

  !> Report a name that is not in the group, with the nearest known name or the group to which it belongs.
  pure subroutine report_unknown_name(group, item, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(item_type), intent(in) :: item                   !< the item whose name is unknown
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    character(len=:), allocatable :: hint
    integer :: i

    hint = nearest_name(item%name, names_in_group(group%name))
    if (hint /= '') then
      hint = '; did you mean '''//hint//'''?'
    else
      do i = 1, size(item_table)
        if (item_table(i)%name /= item%name) cycle
        hint = '; it belongs to &'//trim(item_table(i)%group)
        exit
      end do
    end if
    call diagnostics%add(item%span, 'unknown name '''//diagnostics%text_of(item%span)//''' in &'//trim(group%name)//hint)
  end subroutine report_unknown_name

  !> Report each missing name that must be given.
  pure subroutine check_missing(group, kind, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: kind                  !< the kind of the group; empty where it has none
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    integer, allocatable :: rows(:)
    integer :: i

    rows = rows_of_group(group%name)
    do i = 1, size(rows)
      associate (row => item_table(rows(i)))
        if (.not. row%needed .or. .not. takes_kind(row, kind) .or. is_given(group, trim(row%name))) cycle
        call diagnostics%add(group%span, '&'//group%name//' needs '''//trim(row%name)//''': '//trim(row%help))
      end associate
    end do
  end subroutine check_missing

  !> Whether a group gives a name.
  pure logical function is_given(group, name)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item that is sought
    integer :: i

    is_given = .true.
    do i = 1, size(group%items)
      if (group%items(i)%name == name) return
    end do
    is_given = .false.
  end function is_given

  !> Report groups that stand twice though they may stand only once, and groups whose key stands twice.
  pure subroutine check_repeated(document, row, diagnostics)
    type(document_type), intent(inout) :: document        !< the data file as groups and items
    integer, intent(in) :: row                            !< row of the groups in group_table
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    integer, allocatable :: members(:), keys(:)
    integer :: i, j

    members = pack([(i, i=1, size(document%groups))], document%groups%row == row)
    if (size(members) < 2) return
    if (.not. group_table(row)%repeats) then
      do i = 2, size(members)
        call report_repeated(document%groups(members(i)), document%groups(members(1)), '', diagnostics)
        document%groups(members(i))%sound = .false.
      end do
    else if (group_table(row)%key /= '') then
      allocate (keys(size(members)))
      do i = 1, size(members)
        keys(i) = key_number(document%groups(members(i)), i, members, row, document)
      end do
      do i = 2, size(members)
        j = findloc(keys(:i - 1), keys(i), dim=1)
        if (j == 0) cycle
        call report_repeated(document%groups(members(i)), document%groups(members(j)), trim(group_table(row)%key), diagnostics)
        document%groups(members(i))%sound = .false.
      end do
    end if
  end subroutine check_repeated

  !> A number that is equal for groups of the same key and for no others; negative and of its own
  !> where the key is missing or wrong.
  pure integer function key_number(group, number, members, row, document)
    type(group_type), intent(in) :: group        !< the group of the data file
    integer, intent(in) :: number                !< position of the group among those of its kind
    integer, intent(in) :: members(:)            !< numbers of all groups of this kind in the document
    integer, intent(in) :: row                   !< row of these groups in group_table
    type(document_type), intent(in) :: document  !< the data file as groups and items
    type(value_type) :: value, other
    integer :: j

    key_number = -number
    if (.not. group%sound) return
    value = key_value(group, trim(group_table(row)%key))
    if (value%kind == value_integer) then
      key_number = int(value%whole)
    else if (value%kind == value_text) then
      do j = 1, number - 1
        other = key_value(document%groups(members(j)), trim(group_table(row)%key))
        if (other%kind /= value_text) cycle
        if (other%text == value%text) key_number = -j
        if (key_number == -j) return
      end do
    end if
  end function key_number

  !> The value of the name that tells groups of a kind apart.
  pure function key_value(group, key) result(value)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: key    !< the name whose value is returned
    type(value_type) :: value
    integer :: i

    do i = 1, size(group%items)
      if (group%items(i)%name == key .and. size(group%items(i)%values) == 1) value = group%items(i)%values(1)
    end do
  end function key_value

  !> Report a group that must not be repeated, with the line of the first one.
  pure subroutine report_repeated(group, first, key, diagnostics)
    type(group_type), intent(in) :: group                 !< the group that stands there again
    type(group_type), intent(in) :: first                 !< the group that stands there first
    character(len=*), intent(in) :: key  !< the name that tells the groups apart; empty where the group may stand only once
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    character(len=:), allocatable :: text
    type(value_type) :: value
    type(span_type) :: span

    span = group%span
    text = '&'//group%name//' may stand only once'
    if (key /= '') then
      value = key_value(group, key)
      span = value%span
      text = 'a second &'//group%name//' for '//key//' '//diagnostics%text_of(value%span)
    end if
    if (first%span%source == 1) then
      associate (position => diagnostics%place(first%span))
        text = text//'; the first stands in line '//to_text(position%line)
      end associate
    end if
    call diagnostics%add(span, text)
  end subroutine report_repeated
end module mech9_checker
