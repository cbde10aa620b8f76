!> The values of a checked document by group and name, with the defaults of the grammar.
!>
!> The functions need groups without errors: mech9_checker checks a document before a mechanism is read from it.
module mech9_lookup
  use mech9_kinds, only: wp
  use mech9_text, only: lower
  use mech9_source, only: span_type
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_grammar, only: item_table
  use mech9_item_rows, only: only_item_row, item_row_for_kind
  use mech9_document, only: document_type, group_type
  implicit none
  private
  public :: groups_named, group_or_empty, has_group, has_unsound, has_name, find_item, span_of
  public :: row_of, get_integer, get_integers, get_real, get_reals, get_logical, get_text, count_values, get_word

contains

  !> Positions in the document of the sound groups of a name, in the order of the file.
  pure function groups_named(document, name) result(numbers)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    character(len=*), intent(in) :: name         !< name of the groups, in lower case
    integer, allocatable :: numbers(:)
    integer :: i, n, pass

    do pass = 1, 2
      n = 0
      do i = 1, size(document%groups)
        if (.not. document%groups(i)%sound .or. document%groups(i)%name /= name) cycle
        n = n + 1
        if (pass == 2) numbers(n) = i
      end do
      if (pass == 1) allocate (numbers(n))
    end do
  end function groups_named

  !> The first sound group of a name, or an empty one, which has the defaults.
  pure function group_or_empty(document, name) result(group)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    character(len=*), intent(in) :: name         !< name of the group, in lower case
    type(group_type) :: group
    integer, allocatable :: numbers(:)

    numbers = groups_named(document, name)
    if (size(numbers) > 0) then
      group = document%groups(numbers(1))
    else
      group%name = name
      allocate (group%items(0))
    end if
  end function group_or_empty

  !> Whether the file has a group of this name, sound or not.
  pure logical function has_group(document, name)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    character(len=*), intent(in) :: name         !< name of the groups, in lower case
    integer :: i

    has_group = .true.
    do i = 1, size(document%groups)
      if (document%groups(i)%name == name) return
    end do
    has_group = .false.
  end function has_group

  !> Whether an error was found in a group of this name, so that its meaning is unknown.
  pure logical function has_unsound(document, name)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    character(len=*), intent(in) :: name         !< name of the groups, in lower case
    integer :: i

    has_unsound = .true.
    do i = 1, size(document%groups)
      if (document%groups(i)%name == name .and. .not. document%groups(i)%sound) return
    end do
    has_unsound = .false.
  end function has_unsound

  !> Number of an item in its group; 0 where the name is not given.
  pure integer function find_item(group, name) result(number)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case

    do number = size(group%items), 1, -1
      associate (given => group%items(number)%name)
        ! most names differ in the first letter, which is compared much faster
        if (len(given) == 0 .or. len(name) == 0) cycle
        if (given(1:1) /= name(1:1)) cycle
        if (given == name) return
      end associate
    end do
  end function find_item

  !> Whether the group gives this name.
  pure logical function has_name(group, name)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case

    has_name = find_item(group, name) > 0
  end function has_name

  !> Place of a value; that of the name if no value is meant; that of the group if the name is not given.
  pure type(span_type) function span_of(group, name, value_number) result(span)
    type(group_type), intent(in) :: group          !< the group of the data file
    character(len=*), intent(in) :: name           !< name of the item, in lower case
    integer, intent(in), optional :: value_number  !< position of the value in its list; absent: the name is meant
    integer :: i

    span = group%span
    i = find_item(group, name)
    if (i == 0) return
    span = group%items(i)%span
    if (.not. present(value_number)) return
    if (value_number >= 1 .and. value_number <= size(group%items(i)%values)) &
      span = group%items(i)%values(value_number)%span
  end function span_of

  !> The numbers given under a name, or those of its default; in SI where the grammar alone tells their kind.
  pure function get_reals(group, name) result(numbers)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    real(wp), allocatable :: numbers(:)
    integer :: i

    i = find_item(group, name)
    if (i > 0) then
      numbers = group%items(i)%scale*group%items(i)%values%number
    else
      numbers = default_numbers(group, name)
    end if
  end function get_reals

  !> The number given under a name that takes one, or its default; see get_reals.
  pure real(wp) function get_real(group, name)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    real(wp), allocatable :: numbers(:)
    integer :: i

    i = find_item(group, name)
    if (i > 0) then
      get_real = group%items(i)%scale*group%items(i)%values(1)%number
    else
      numbers = default_numbers(group, name)
      get_real = numbers(1)
    end if
  end function get_real

  !> Whole numbers given under a name, or those of its default.
  pure function get_integers(group, name) result(numbers)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    integer, allocatable :: numbers(:)

    numbers = nint(get_reals(group, name))
  end function get_integers

  !> The whole number given under a name that takes one, or its default.
  pure integer function get_integer(group, name)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case

    get_integer = nint(get_real(group, name))
  end function get_integer

  !> Whether a switch is on.
  pure logical function get_logical(group, name)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    integer :: i

    i = find_item(group, name)
    if (i > 0) then
      get_logical = group%items(i)%values(1)%truth
    else
      get_logical = item_table(row_of(group, name))%default == '.true.'
    end if
  end function get_logical

  !> Length of a text that is given, or of its default, which stands in quotes.
  pure integer function text_length(group, name) result(length)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    integer :: i, row

    i = find_item(group, name)
    if (i > 0) then
      length = len_trim(group%items(i)%values(1)%text)
    else
      row = row_of(group, name)
      associate (default => item_table(row)%default)
        length = 0
        if (index(default, '''') == 1) length = len_trim(default) - 2
      end associate
    end if
  end function text_length

  !> A text without blanks at its end; words of a list in lower case.
  pure function get_text(group, name) result(text)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    character(len=text_length(group, name)) :: text
    integer :: i

    i = find_item(group, name)
    if (i > 0) then
      text = group%items(i)%values(1)%text
      if (.not. has_capital(text)) return
      if (item_table(row_of(group, name))%words /= '') text = lower(text)
    else if (len(text) > 0) then
      text = item_table(row_of(group, name))%default(2:)
    end if
  end function get_text

  !> Whether a text has a capital letter.
  pure logical function has_capital(text)
    character(len=*), intent(in) :: text   !< any text
    integer :: i

    has_capital = .true.
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') return
    end do
    has_capital = .false.
  end function has_capital

  !> How many values a group gives under a name; 0 where it gives none.
  pure integer function count_values(group, name)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    integer :: i

    count_values = 0
    i = find_item(group, name)
    if (i > 0) count_values = size(group%items(i)%values)
  end function count_values

  !> One of the words that a group gives under a name, in lower case.
  pure function get_word(group, name, number) result(word)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    integer, intent(in) :: number          !< of the value
    character(len=20) :: word

    word = lower(group%items(find_item(group, name))%values(number)%text)
  end function get_word

  !> The numbers of the grammar's default; none where the default is a rule in parentheses.
  pure function default_numbers(group, name) result(numbers)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    real(wp), allocatable :: numbers(:)
    type(numeral_type) :: numeral
    character(len=:), allocatable :: rest
    integer :: comma

    allocate (numbers(0))
    rest = trim(item_table(row_of(group, name))%default)
    if (index(rest, '(') == 1) return
    do while (rest /= '')
      comma = index(rest//',', ',')
      call read_numeral(trim(adjustl(rest(:comma - 1))), numeral)
      numbers = [numbers, numeral%number]
      rest = rest(min(comma, len(rest)) + 1:)
    end do
  end function default_numbers

  !> Row of a name, for the kind of its group where it has one.
  pure integer function row_of(group, name) result(row)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item, in lower case
    character(len=:), allocatable :: kind
    integer :: i

    row = only_item_row(group%name, name)
    if (row > 0) return
    kind = ''
    i = find_item(group, 'kind')
    if (i > 0 .and. name /= 'kind') kind = lower(trim(group%items(i)%values(1)%text))
    i = find_item(group, 'law')
    if (i > 0 .and. name /= 'kind') kind = kind//' law:'//lower(trim(group%items(i)%values(1)%text))
    row = item_row_for_kind(group%name, name, kind)
  end function row_of
end module mech9_lookup
