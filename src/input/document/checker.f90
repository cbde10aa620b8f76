!> Check of a document against the grammar: groups, names, values, missing names and repeated ones.
!>
!> A document that passes can be read by mech9_lookup without further checks.
module mech9_checker
  use mech9_text, only: to_text, lower, nearest_name
  use mech9_counted, only: counted
  use mech9_name_table, only: name_table_type
  use mech9_source, only: span_type
  use mech9_grammar, only: group_table, item_table, find_group_row, rows_of_group, names_of_groups, names_in_group
  use mech9_item_rows, only: find_item_rows, item_row_for_kind, takes_kind
  use mech9_document, only: document_type, group_type, item_type, value_type, value_bad, value_null, value_text, &
                            value_integer, add_item
  use mech9_part_names, only: part_names_type
  use mech9_part_name_check, only: find_part_names, number_references
  use mech9_item_merge, only: merge_items, expand_repeats
  use mech9_item_check, only: check_item, known_word
  use mech9_item_units, only: scale_items
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: check_document, check_alone

  integer, parameter :: kind_length = 36  !< length of the longest kind of a group with its law

contains

  !> Check all groups. Each group gets its row of the grammar, one plain item for each name, and the
  !> mark `sound` where nothing is wrong with it.
  pure subroutine check_document(document, diagnostics)
    type(document_type), intent(inout) :: document        !< the data file as groups and items
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i, found

    found = diagnostics%count
    call find_part_names(document, document%names, diagnostics)
    diagnostics%names = document%names
    call number_references(document, document%names, diagnostics%count == found, diagnostics)
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
        if (.not. group%sound .and. diagnostics%is_setting(group%span)) call explain_added(document, i, diagnostics)
      end associate
    end do
    do i = 1, size(group_table)
      call check_repeated(document, i, diagnostics)
    end do
    call scale_items(document)
  end subroutine check_document

  !> Hold groups against the grammar that need not make sense together yet. Names of links and pairs may come with other groups, or
  !> later.
  pure subroutine check_alone(document, groups, diagnostics)
    type(document_type), intent(inout) :: document           !< the groups, which are checked
    type(group_type), intent(in) :: groups(:)                !< all groups so far, with names
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the errors
    type(document_type) :: whole
    type(part_names_type) :: names

    whole%groups = groups
    call find_part_names(whole, names)
    call number_references(document, names, .false., diagnostics)
    call check_document(document, diagnostics)
  end subroutine check_alone

  !> Tell that --set adds a group that has errors, beside those of the file: its number may be a mistake.
  pure subroutine explain_added(document, number, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: number                         !< number of the group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the words
    integer :: i, count

    associate (group => document%groups(number))
      count = 0
      do i = 1, number - 1
        if (document%groups(i)%name == group%name) count = count + 1
      end do
      if (count > 0) call diagnostics%add(group%span, 'this file has '//counted(count, 'group')//' &'//group%name// &
                                          ', and --set adds another one; change a group of the file by its number')
    end associate
  end subroutine explain_added

  !> Report a group that is not in the grammar, with the nearest known name.
  pure subroutine report_unknown_group(group, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
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
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=kind_length) :: kind

    call merge_group(group, diagnostics)
    kind = kind_of(group)
    call check_items(group, kind, diagnostics)
    call check_missing(group, kind, diagnostics)
  end subroutine check_group

  !> Make one item of each name. The coincidence matrix keeps its rows and columns apart.
  pure subroutine merge_group(group, diagnostics)
    type(group_type), intent(inout) :: group              !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
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
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
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
          call diagnostics%add(item%span, ''''//item%name//''' needs '//trim(laws_of(item_table(rows(1))%kinds)))
        else if (kind /= '') then
          call diagnostics%add(item%span, ''''//item%name//''' does not belong to '//trim(plural_of(group%name))// &
                               ' of kind '''//trim(in_words(kind))//'''')
        end if
      end associate
    end do
  end subroutine check_items

  !> The laws that a name belongs to, in words.
  pure function laws_of(kinds) result(words)
    character(len=*), intent(in) :: kinds     !< as law:table law:segments
    character(len=2*len(kinds) + 20) :: words
    integer :: at, next

    words = 'law='''
    at = 5
    do
      next = index(kinds(at:), ' law:')
      if (next == 0) exit
      words = trim(words)//kinds(at:at + next - 2)//''' or '''
      at = at + next + 4
    end do
    words = trim(words)//trim(kinds(at:))//''''
  end function laws_of

  !> The plural of the name of a group.
  pure function plural_of(name) result(plural)
    character(len=*), intent(in) :: name     !< of the group
    character(len=len(name) + 3) :: plural

    plural = trim(name)//'s'
    if (name(len_trim(name):) == 'y') plural = name(:len_trim(name) - 1)//'ies'
  end function plural_of

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
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
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
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
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
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: members(:)
    integer :: i

    members = pack([(i, i=1, size(document%groups))], document%groups%row == row)
    if (.not. group_table(row)%repeats) then
      do i = 2, size(members)
        call report_repeated(document%groups(members(i)), document%groups(members(1)), diagnostics)
        document%groups(members(i))%sound = .false.
      end do
    else if (group_table(row)%key /= '') then
      call check_keys(document, members, trim(group_table(row)%key), diagnostics)
    end if
  end subroutine check_repeated

  !> Report keys that stand in two groups, or twice in one. A group has one key, or a list of them under the plural of its name.
  pure subroutine check_keys(document, members, key, diagnostics)
    type(document_type), intent(inout) :: document        !< the data file as groups and items
    integer, intent(in) :: members(:)                     !< numbers of all groups of a kind
    character(len=*), intent(in) :: key                   !< name of the key
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(value_type), allocatable :: values(:)
    type(name_table_type) :: owners
    character(len=:), allocatable :: name
    integer :: i, k, owner, found

    do i = 1, size(members)
      if (.not. document%groups(members(i))%sound) cycle
      values = keys_of(document%groups(members(i)), key)
      found = diagnostics%count
      do k = 1, size(values)
        call name_key(values(k), name)
        owner = owners%find(name)
        if (owner == 0) then
          call owners%add(name, members(i))
        else if (owner == members(i)) then
          call diagnostics%add(values(k)%span, key//' '//diagnostics%text_of(values(k)%span)//' is named twice')
        else
          call report_second_key(document%groups(members(i)), document%groups(owner), key, values(k)%span, diagnostics)
        end if
      end do
      if (diagnostics%count > found) document%groups(members(i))%sound = .false.
    end do
  end subroutine check_keys

  !> Form a name that is equal for equal keys only.
  pure subroutine name_key(value, name)
    type(value_type), intent(in) :: value                !< the key: a whole number or a text
    character(len=:), allocatable, intent(out) :: name   !< the name

    if (value%kind == value_integer) then
      name = to_text(value%whole)
    else
      name = "'"//value%text
    end if
  end subroutine name_key

  !> The keys of a group: the value of the name that tells groups of its kind apart, or the values under the plural of this name.
  pure function keys_of(group, key) result(values)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: key    !< name of the key
    type(value_type), allocatable :: values(:)
    integer :: i

    allocate (values(0))
    do i = 1, size(group%items)
      if (group%items(i)%name == key .or. group%items(i)%name == key//'s') values = group%items(i)%values
    end do
    values = pack(values, values%kind == value_integer .or. values%kind == value_text)
  end function keys_of

  !> Report a key that a group before has too, with the line of that group.
  pure subroutine report_second_key(group, first, key, span, diagnostics)
    type(group_type), intent(in) :: group                 !< the group
    type(group_type), intent(in) :: first                 !< the group before
    character(len=*), intent(in) :: key                   !< name of the key
    type(span_type), intent(in) :: span                   !< place of the key in the later group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    call diagnostics%add(span, 'a second &'//group%name//' for '//key//' '//diagnostics%text_of(span)// &
                         trim(line_of_first(first, diagnostics)))
  end subroutine report_second_key

  !> Report a group that must not be repeated, with the line of the first one.
  pure subroutine report_repeated(group, first, diagnostics)
    type(group_type), intent(in) :: group                 !< the group that stands there again
    type(group_type), intent(in) :: first                 !< the group that stands there first
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    call diagnostics%add(group%span, '&'//group%name//' may stand only once'//trim(line_of_first(first, diagnostics)))
  end subroutine report_repeated

  !> The words about the line of a group that stands first: "; the first stands in line 4"; empty where it is not in the file.
  pure function line_of_first(first, diagnostics) result(words)
    type(group_type), intent(in) :: first               !< the group that stands there first
    type(diagnostics_type), intent(in) :: diagnostics   !< knows the places in the file
    character(len=48) :: words

    words = ''
    if (first%span%source /= 1) return
    associate (position => diagnostics%place(first%span))
      words = '; the first stands in line '//to_text(position%line)
    end associate
  end function line_of_first
end module mech9_checker
