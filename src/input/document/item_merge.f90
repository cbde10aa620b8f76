!> One plain list of all values that a group gives under one name: repeats are written out, and subscripts determine positions.
module mech9_item_merge
  use mech9_text, only: to_text
  use mech9_source, only: span_type
  use mech9_document, only: item_type, value_type, value_null
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: merge_items, expand_repeats

  !> Most values allowed under one name; no mechanism has more.
  integer, parameter :: most_values = 10000000

contains

  !> Merge the items of a name, in the order in which they are written. Contradictions are reported;
  !> the merged item then holds the values that were understood.
  pure subroutine merge_items(items, name, merged, diagnostics)
    type(item_type), intent(in) :: items(:)               !< items of a group, of which at least one has the name
    character(len=*), intent(in) :: name                  !< name of the items that are merged
    type(item_type), intent(out) :: merged                !< one item with all values of the name and no subscripts
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(value_type), allocatable :: values(:)
    logical, allocatable :: filled(:)
    integer :: i, first, number, count

    merged%name = name
    allocate (merged%subscripts(0), merged%values(0), filled(0))
    number = 0
    count = 0
    do i = 1, size(items)
      if (items(i)%name /= name) cycle
      number = number + 1
      if (size(items(i)%subscripts) == 0 .and. is_alone(items, i)) then
        merged%span = items(i)%span
        call expand_repeats(items(i), merged%values, diagnostics)
        return
      end if
      call check_subscripts(items(i), merged%span, number, first, diagnostics)
      merged%span = items(i)%span
      if (first == 0) cycle
      call expand_repeats(items(i), values, diagnostics)
      call place_values(items(i), values, first, merged%values, filled, count, diagnostics)
    end do
    merged%values = merged%values(:count)
    if (.not. all(filled(:count))) &
      call diagnostics%add(merged%span, ''''//name//'('//to_text(findloc(filled, .false., dim=1))//')'' is missing')
  end subroutine merge_items

  !> Whether no other item has the name of this one.
  pure logical function is_alone(items, number)
    type(item_type), intent(in) :: items(:)  !< all items of a group
    integer, intent(in) :: number            !< position of the item in the list
    integer :: i

    is_alone = .false.
    do i = 1, size(items)
      if (i /= number .and. items(i)%name == items(number)%name) return
    end do
    is_alone = .true.
  end function is_alone

  !> The position of an item's first value; 0, with a report, where its subscripts are wrong.
  pure subroutine check_subscripts(item, before, number, first, diagnostics)
    type(item_type), intent(in) :: item                   !< the item whose subscripts are read
    type(span_type), intent(in) :: before                 !< place of the name where it is given before this item
    integer, intent(in) :: number                         !< position of the item among those of its name
    integer, intent(out) :: first                         !< position of the item's first value; 0 where the subscripts are wrong
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    first = 0
    select case (size(item%subscripts))
    case (0)
      if (number == 1) then
        first = 1
      else
        call diagnostics%add(item%span, ''''//item%name//''' is given twice in this group'// &
                             trim(line_of(before, diagnostics)))
      end if
    case (1)
      first = max(item%subscripts(1)%first, 1)
    case default
      call diagnostics%add(item%span, ''''//item%name//''' is a list and takes one subscript, as in '// &
                           item%name//'(2)')
    end select
  end subroutine check_subscripts

  !> The line of an earlier item, in words; empty where it does not stand in the data file.
  pure function line_of(span, diagnostics) result(text)
    type(span_type), intent(in) :: span                !< place of the earlier item
    type(diagnostics_type), intent(in) :: diagnostics  !< gets the errors
    character(len=60) :: text

    text = ''
    if (span%source /= 1) return
    associate (position => diagnostics%place(span))
      text = '; it stands in line '//to_text(position%line)//' already'
    end associate
  end function line_of

  !> Put values at their positions. The arrays grow by doubling.
  pure subroutine place_values(item, new, first, values, filled, count, diagnostics)
    type(item_type), intent(in) :: item                        !< the item that gives the values
    type(value_type), intent(in) :: new(:)                     !< its values, repeats written out
    integer, intent(in) :: first                               !< position of the first value
    type(value_type), allocatable, intent(inout) :: values(:)  !< values of the items before; the first `count` are in use
    logical, allocatable, intent(inout) :: filled(:)           !< whether each position has its value; of the same size
    integer, intent(inout) :: count                            !< how many elements of these arrays are in use
    type(diagnostics_type), intent(inout) :: diagnostics       !< gets the errors
    integer :: i, last

    last = first + size(new) - 1
    if (last > most_values) then
      call diagnostics%add(item%span, 'the subscript of '''//item%name//''' is too large')
      return
    end if
    if (size(item%subscripts) == 1) then
      if (item%subscripts(1)%last > 0 .and. item%subscripts(1)%last /= last) then
        call diagnostics%add(item%span, to_text(size(new))//' values for '''//item%name//''' where its subscripts mean '// &
                             to_text(max(item%subscripts(1)%last - first + 1, 0)))
        return
      end if
    end if
    if (last > size(values)) call lengthen(values, filled, count, max(last, 2*size(values)))
    count = max(count, last)
    do i = first, last
      if (new(i - first + 1)%kind == value_null) cycle
      if (filled(i) .and. .not. item%overrides) then
        call diagnostics%add(item%span, ''''//item%name//'('//to_text(i)//')'' is given twice in this group')
        return
      end if
      values(i) = new(i - first + 1)
      filled(i) = .true.
    end do
  end subroutine place_values

  !> Make room for more values.
  pure subroutine lengthen(values, filled, count, length)
    type(value_type), allocatable, intent(inout) :: values(:)  !< the values; the first `count` are in use
    logical, allocatable, intent(inout) :: filled(:)           !< whether each position has its value
    integer, intent(in) :: count                               !< how many elements are in use
    integer, intent(in) :: length                              !< size of the arrays afterwards
    type(value_type), allocatable :: more(:)
    logical, allocatable :: more_filled(:)

    allocate (more(length))
    allocate (more_filled(length), source=.false.)
    more(:count) = values(:count)
    more_filled(:count) = filled(:count)
    call move_alloc(more, values)
    call move_alloc(more_filled, filled)
  end subroutine lengthen

  !> Write out r*value. Too long a list is reported and left empty.
  pure subroutine expand_repeats(item, values, diagnostics)
    type(item_type), intent(in) :: item                      !< the item as it is written
    type(value_type), allocatable, intent(out) :: values(:)  !< its values, each repeated one written out
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the errors
    integer :: i, n, times

    n = 0
    do i = 1, size(item%values)
      times = item%values(i)%times
      if (times > most_values - n) then
        call diagnostics%add(item%values(i)%span, 'there are too many values for '''//item%name//'''')
        allocate (values(0))
        return
      end if
      n = n + times
    end do
    if (n == size(item%values)) then
      values = item%values
      return
    end if
    allocate (values(n))
    n = 0
    do i = 1, size(item%values)
      times = item%values(i)%times
      values(n + 1:n + times) = item%values(i)
      values(n + 1:n + times)%times = 1
      n = n + times
    end do
  end subroutine expand_repeats
end module mech9_item_merge
