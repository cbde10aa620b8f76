!> A draft is a data file in the making: groups of names with their values as text, in an order that reads well.
!>
!> A group is identified by its name and its place among the groups of that name, from 1 on.
module mech9_draft
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_grammar, only: find_group_row
  use mech9_item_rows, only: find_item_rows
  implicit none
  private
  public :: draft_type, draft_group_type, entry_type, plain_name, integer_of, unquoted

  !> One name and its values.
  type :: entry_type
    character(len=:), allocatable :: name    !< in lower case, with its subscript if it has one: c(1,:)
    character(len=:), allocatable :: text    !< its values, as a data file writes them; numbers for names of links and pairs
    character(len=:), allocatable :: written !< the values as the user wrote them, where these are names; not allocated: none is
  end type entry_type

  !> One group.
  type :: draft_group_type
    character(len=:), allocatable :: name
    character(len=:), allocatable :: comment       !< whole comment lines that stand above the group; empty: none
    type(entry_type), allocatable :: entries(:)
  end type draft_group_type

  type :: draft_type
    character(len=:), allocatable :: head          !< comment lines at the beginning of the file
    type(draft_group_type), allocatable :: groups(:)
    integer :: comments_left_out = 0               !< number of comments of the original data file that the draft does not hold
  contains
    procedure :: clear
    procedure :: find
    procedure :: find_entry
    procedure :: with_number
    procedure :: count_of
    procedure :: place_of
    procedure :: value
    procedure :: number
    procedure :: has
    procedure :: add
    procedure :: give
    procedure :: take_away
    procedure :: remove
  end type draft_type

contains

  !> Remove all groups and comments.
  pure subroutine clear(self)
    class(draft_type), intent(inout) :: self  !< groups and names with their values as text

    self%head = ''
    self%comments_left_out = 0
    if (allocated(self%groups)) deallocate (self%groups)
    allocate (self%groups(0))
  end subroutine clear

  !> The index of a group in the draft; 0 if there is none.
  pure integer function find(self, group, place) result(index)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    integer, intent(in) :: place           !< place among the groups of that name, from 1
    integer :: n

    n = 0
    do index = 1, size(self%groups)
      if (self%groups(index)%name == group) n = n + 1
      if (n == place .and. n > 0) return
    end do
    index = 0
  end function find

  !> The place of the group in which the name `key` has a given number; 0 if there is none.
  pure integer function with_number(self, group, key, number) result(place)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    character(len=*), intent(in) :: key    !< name whose value is the number
    integer, intent(in) :: number          !< the number that is looked for
    integer :: i

    place = 0
    do i = 1, size(self%groups)
      if (self%groups(i)%name /= group) cycle
      place = place + 1
      if (integer_of(value_in(self%groups(i), key)) == number) return
    end do
    place = 0
  end function with_number

  !> The number of groups of a name.
  pure integer function count_of(self, group) result(n)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    integer :: i

    n = 0
    do i = 1, size(self%groups)
      if (self%groups(i)%name == group) n = n + 1
    end do
  end function count_of

  !> The place of the group with this index among the groups of its name.
  pure integer function place_of(self, index) result(place)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    integer, intent(in) :: index           !< index of the group in the draft
    integer :: i

    place = 0
    do i = 1, index
      if (self%groups(i)%name == self%groups(index)%name) place = place + 1
    end do
  end function place_of

  !> The number of an entry in its group; 0 if the group does not have it.
  pure integer function find_entry(self, group, place, name) result(number)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    character(len=*), intent(in) :: name   !< name with its subscript
    integer, intent(in) :: place           !< place among the groups of that name, from 1
    integer :: i

    number = 0
    i = self%find(group, place)
    if (i > 0) number = entry_number(self%groups(i), name)
  end function find_entry

  !> The number of an entry in a group; 0 if the group does not have it.
  pure integer function entry_number(group, name) result(number)
    type(draft_group_type), intent(in) :: group  !< the group
    character(len=*), intent(in) :: name         !< name with its subscript

    do number = size(group%entries), 1, -1
      if (group%entries(number)%name == name) return
    end do
  end function entry_number

  !> The values of a name of a group as text; empty if the name is not given.
  pure function value_in(group, name) result(text)
    type(draft_group_type), intent(in) :: group  !< the group
    character(len=*), intent(in) :: name         !< name with its subscript
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    i = entry_number(group, name)
    if (i > 0) text = group%entries(i)%text
  end function value_in

  !> The values of a name as text; empty if the name is not given.
  pure function value(self, group, place, name) result(text)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    character(len=*), intent(in) :: name   !< name with its subscript
    integer, intent(in) :: place           !< place among the groups of that name, from 1
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    i = self%find(group, place)
    if (i > 0) text = value_in(self%groups(i), name)
  end function value

  !> The value of a name as a whole number; 0 if it is none.
  pure integer function number(self, group, place, name)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    character(len=*), intent(in) :: name   !< name with its subscript
    integer, intent(in) :: place           !< place among the groups of that name, from 1

    number = integer_of(self%value(group, place, name))
  end function number

  !> Whether a name is given.
  pure logical function has(self, group, place, name)
    class(draft_type), intent(in) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    character(len=*), intent(in) :: name   !< name with its subscript
    integer, intent(in) :: place           !< place among the groups of that name, from 1

    has = self%find_entry(group, place, name) > 0
  end function has

  !> Add an empty group behind the groups of its name, or at the place that the table of groups gives it.
  pure subroutine add(self, group)
    class(draft_type), intent(inout) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group     !< name of the group
    type(draft_group_type), allocatable :: longer(:)
    integer :: i, at

    at = 0
    do i = 1, size(self%groups)
      if (rank_of(self%groups(i)%name) <= rank_of(group)) at = i
    end do
    allocate (longer(size(self%groups) + 1))
    do i = 1, size(self%groups)
      call move_group(self%groups(i), longer(merge(i, i + 1, i <= at)))
    end do
    longer(at + 1)%name = group
    longer(at + 1)%comment = ''
    allocate (longer(at + 1)%entries(0))
    call move_alloc(longer, self%groups)
  end subroutine add

  !> The rank of a group in a file: its row in the table of groups. Unknown groups stand at the end.
  pure integer function rank_of(group) result(rank)
    character(len=*), intent(in) :: group  !< name of the group

    rank = find_group_row(group)
    if (rank == 0) rank = huge(rank)
  end function rank_of

  !> Move the content of a group to another group.
  pure subroutine move_group(from, to)
    type(draft_group_type), intent(inout) :: from  !< loses its contents
    type(draft_group_type), intent(inout) :: to    !< receives them

    call move_alloc(from%name, to%name)
    call move_alloc(from%comment, to%comment)
    call move_alloc(from%entries, to%entries)
  end subroutine move_group

  !> Set the value of a name, in the place of an earlier one. Add the group if it is not there yet.
  pure subroutine give(self, group, place, name, text, written)
    class(draft_type), intent(inout) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group     !< name of the group
    character(len=*), intent(in) :: name      !< name with its subscript
    character(len=*), intent(in) :: text      !< values as a data file writes them
    integer, intent(in) :: place              !< place among the groups of that name; at most one more than there are
    character(len=*), intent(in), optional :: written   !< the values with names of links and pairs in quotes, not numbers
    integer :: i, number

    if (place > self%count_of(group)) call self%add(group)
    i = self%find(group, place)
    number = entry_number(self%groups(i), name)
    if (number == 0) call add_entry(self%groups(i), name, number)
    associate (entry => self%groups(i)%entries(number))
      ! values that stay the same stay as they were written
      if (entry%text /= text .and. allocated(entry%written)) deallocate (entry%written)
      entry%text = text
      if (.not. present(written)) return
      if (scan(written, '''"') > 0) entry%written = written
    end associate
  end subroutine give

  !> Add an entry in the order of the table of names. Rows of a matrix stand in the order of their numbers.
  pure subroutine add_entry(group, name, number)
    type(draft_group_type), intent(inout) :: group  !< the group
    character(len=*), intent(in) :: name            !< name with its subscript
    integer, intent(out) :: number                  !< number of the new entry in the group
    type(entry_type), allocatable :: longer(:)
    integer :: i

    number = size(group%entries) + 1
    do i = size(group%entries), 1, -1
      if (stands_before(group%name, name, group%entries(i)%name)) number = i
    end do
    allocate (longer(size(group%entries) + 1))
    do i = 1, size(group%entries)
      associate (to => longer(merge(i, i + 1, i < number)))
        call move_alloc(group%entries(i)%name, to%name)
        call move_alloc(group%entries(i)%text, to%text)
        call move_alloc(group%entries(i)%written, to%written)
      end associate
    end do
    longer(number)%name = name
    longer(number)%text = ''
    call move_alloc(longer, group%entries)
  end subroutine add_entry

  !> Whether a name stands before another name of its group.
  pure logical function stands_before(group, name, other)
    character(len=*), intent(in) :: group  !< name of the group
    character(len=*), intent(in) :: name   !< name with its subscript
    character(len=*), intent(in) :: other  !< the other name with its subscript
    integer, allocatable :: rows(:), others(:)

    rows = find_item_rows(group, plain_name(name))
    others = find_item_rows(group, plain_name(other))
    stands_before = .false.
    if (size(rows) == 0 .or. size(others) == 0) return
    stands_before = rows(1) < others(1)
    if (rows(1) == others(1)) stands_before = subscript_of(name) < subscript_of(other)
  end function stands_before

  !> The first subscript of a name such as c(2,:); 0 if there is none.
  pure integer function subscript_of(name) result(subscript)
    character(len=*), intent(in) :: name  !< name with its subscript
    integer :: first

    first = index(name, '(')
    subscript = 0
    if (first > 0) subscript = integer_of(name(first + 1:first + scan(name(first + 1:)//')', ',:)') - 1))
  end function subscript_of

  !> Remove the entry of a name.
  pure subroutine take_away(self, group, place, name)
    class(draft_type), intent(inout) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group     !< name of the group
    character(len=*), intent(in) :: name      !< name with its subscript
    integer, intent(in) :: place              !< place among the groups of that name, from 1
    type(entry_type), allocatable :: shorter(:)
    integer :: i, j, number

    i = self%find(group, place)
    number = self%find_entry(group, place, name)
    if (number == 0) return
    associate (entries => self%groups(i)%entries)
      allocate (shorter(size(entries) - 1))
      do j = 1, size(entries)
        if (j == number) cycle
        call move_alloc(entries(j)%name, shorter(merge(j, j - 1, j < number))%name)
        call move_alloc(entries(j)%text, shorter(merge(j, j - 1, j < number))%text)
        call move_alloc(entries(j)%written, shorter(merge(j, j - 1, j < number))%written)
      end do
    end associate
    call move_alloc(shorter, self%groups(i)%entries)
  end subroutine take_away

  !> Remove a group with its entries.
  pure subroutine remove(self, group, place)
    class(draft_type), intent(inout) :: self  !< groups and names with their values as text
    character(len=*), intent(in) :: group     !< name of the group
    integer, intent(in) :: place              !< place among the groups of that name, from 1
    type(draft_group_type), allocatable :: shorter(:)
    integer :: i, index

    index = self%find(group, place)
    if (index == 0) return
    allocate (shorter(size(self%groups) - 1))
    do i = 1, size(self%groups)
      if (i /= index) call move_group(self%groups(i), shorter(merge(i, i - 1, i < index)))
    end do
    call move_alloc(shorter, self%groups)
  end subroutine remove

  !> A name without its subscript.
  pure function plain_name(name) result(plain)
    character(len=*), intent(in) :: name  !< name with its subscript
    character(len=:), allocatable :: plain

    plain = name(:index(name//'(', '(') - 1)
  end function plain_name

  !> The whole number that a text holds; 0 if it holds none.
  pure integer function integer_of(text) result(number)
    character(len=*), intent(in) :: text  !< any text
    type(numeral_type) :: numeral

    number = 0
    if (text == '') return
    call read_numeral(trim(adjustl(text)), numeral)
    if (allocated(numeral%problem) .or. .not. numeral%is_integer) return
    if (abs(numeral%whole) < huge(number)) number = int(numeral%whole)
  end function integer_of

  !> A text value, or a list of them, without the quotes: 'dwell', 'harmonic' gives dwell, harmonic. A value without quotes stays as
  !> it is.
  pure function unquoted(text) result(plain)
    character(len=*), intent(in) :: text  !< value as a data file writes it
    character(len=:), allocatable :: plain
    character :: quote
    logical :: inside
    integer :: i

    plain = text
    if (len(text) < 2) return
    quote = text(1:1)
    if (quote /= '''' .and. quote /= '"') return
    plain = ''
    inside = .false.
    i = 1
    do while (i <= len(text))
      if (text(i:i) /= quote) then
        plain = plain//text(i:i)
      else if (inside .and. text(min(i + 1, len(text)):min(i + 1, len(text))) == quote .and. i < len(text)) then
        plain = plain//quote
        i = i + 1
      else
        inside = .not. inside
      end if
      i = i + 1
    end do
  end function unquoted
end module mech9_draft
