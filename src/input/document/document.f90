!> A data file as it is written: groups of items with values, each with its place.
!>
!> This module does not know the names of groups and items; mech9_checker checks them against the grammar.
module mech9_document
  use mech9_kinds, only: wp, long
  use mech9_part_names, only: part_names_type
  use mech9_source, only: source_type, span_type
  use mech9_registered_procedures, only: registered_procedures_type
  implicit none
  private
  public :: document_type, group_type, item_type, value_type, subscript_type
  public :: value_null, value_integer, value_real, value_logical, value_text, value_word, value_bad
  public :: add_group, add_item, add_value, trim_document

  !> Kinds of values by their form. A word is neither a number nor in quotes; a bad value was reported already.
  integer, parameter :: value_null = 0, value_integer = 1, value_real = 2, value_logical = 3
  integer, parameter :: value_text = 4, value_word = 5, value_bad = 6

  !> One value as it is written.
  type :: value_type
    integer :: kind = value_null
    integer :: times = 1         !< written as times*value
    integer(long) :: whole = 0   !< value of an integer
    real(wp) :: number = 0.0_wp  !< value of an integer or a real
    logical :: truth = .false.
    character(len=:), allocatable :: text  !< the text (without quotes) or the word
    type(span_type) :: span
  end type value_type

  !> One subscript of a name: an index, or a section first:last.
  type :: subscript_type
    integer :: first = 0  !< 0: not given
    integer :: last = 0   !< 0: not given
    logical :: section = .false.
  end type subscript_type

  !> One name with the values it is given.
  type :: item_type
    character(len=:), allocatable :: name  !< in lower case
    type(subscript_type), allocatable :: subscripts(:)
    type(value_type), allocatable :: values(:)
    type(span_type) :: span         !< place of the name
    logical :: overrides = .false.  !< comes from --set and replaces the value of the file
    integer :: row = 0              !< of item_table, where a parameter sets one of its values
    real(wp) :: scale = 1.0_wp      !< one unit of its numbers in SI, where the grammar alone tells their kind
  end type item_type

  !> One group with its items, in the order of the file.
  type :: group_type
    character(len=:), allocatable :: name  !< in lower case
    type(item_type), allocatable :: items(:)
    type(span_type) :: span     !< place of the & and the name
    integer :: row = 0          !< row of group_table; 0 while unchecked or unknown
    logical :: sound = .false.  !< checked and without errors
  end type group_type

  type :: document_type
    type(source_type) :: source  !< the data file
    type(group_type), allocatable :: groups(:)
    type(part_names_type) :: names        !< of links and pairs, once it is checked
    type(registered_procedures_type) :: procedures   !< for its groups of kind 'user', beside those that are linked
  end type document_type

contains

  !> Append a group. The first `count` elements of the array are in use; the array grows by doubling.
  pure subroutine add_group(groups, count, group)
    type(group_type), allocatable, intent(inout) :: groups(:)  !< the groups; the first `count` are in use
    integer, intent(inout) :: count                            !< how many elements are in use
    type(group_type), intent(inout) :: group                   !< the group to append; its items are moved, not copied
    type(group_type), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(groups)) allocate (groups(8))
    if (count == size(groups)) then
      allocate (grown(max(8, 2*count)))
      do i = 1, count
        call move_group(groups(i), grown(i))
      end do
      call move_alloc(grown, groups)
    end if
    count = count + 1
    call move_group(group, groups(count))
  end subroutine add_group

  !> Move the content of a group without copying it.
  pure subroutine move_group(from, to)
    type(group_type), intent(inout) :: from  !< the group that is emptied
    type(group_type), intent(inout) :: to    !< the group that gets its content

    call move_alloc(from%name, to%name)
    call move_alloc(from%items, to%items)
    to%span = from%span
    to%row = from%row
    to%sound = from%sound
  end subroutine move_group

  !> Append an item; see add_group.
  pure subroutine add_item(items, count, item)
    type(item_type), allocatable, intent(inout) :: items(:)  !< the items; the first `count` are in use
    integer, intent(inout) :: count                          !< how many elements are in use
    type(item_type), intent(inout) :: item                   !< the item to append; its values are moved, not copied
    type(item_type), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(items)) allocate (items(8))
    if (count == size(items)) then
      allocate (grown(max(8, 2*count)))
      do i = 1, count
        call move_item(items(i), grown(i))
      end do
      call move_alloc(grown, items)
    end if
    count = count + 1
    call move_item(item, items(count))
  end subroutine add_item

  !> Move the content of an item without copying it.
  pure subroutine move_item(from, to)
    type(item_type), intent(inout) :: from  !< the item that is emptied
    type(item_type), intent(inout) :: to    !< the item that gets its content

    call move_alloc(from%name, to%name)
    call move_alloc(from%subscripts, to%subscripts)
    call move_alloc(from%values, to%values)
    to%span = from%span
    to%overrides = from%overrides
    to%row = from%row
    to%scale = from%scale
  end subroutine move_item

  !> Append a value; see add_group.
  pure subroutine add_value(values, count, value)
    type(value_type), allocatable, intent(inout) :: values(:)  !< the values; the first `count` are in use
    integer, intent(inout) :: count                            !< how many elements are in use
    type(value_type), intent(in) :: value                      !< the value to append
    type(value_type), allocatable :: grown(:)

    if (.not. allocated(values)) allocate (values(4))
    if (count == size(values)) then
      allocate (grown(max(8, 2*count)))
      grown(:count) = values
      call move_alloc(grown, values)
    end if
    count = count + 1
    values(count) = value
  end subroutine add_value

  !> Cut the array of groups to the elements in use.
  pure subroutine trim_document(groups, count)
    type(group_type), allocatable, intent(inout) :: groups(:)  !< the groups, cut to their first `count`
    integer, intent(in) :: count                               !< how many elements are in use
    type(group_type), allocatable :: cut(:)
    integer :: i

    allocate (cut(count))
    do i = 1, count
      call move_group(groups(i), cut(i))
    end do
    call move_alloc(cut, groups)
  end subroutine trim_document
end module mech9_document
