!> The coincidence matrix from its rows, columns and elements in a data file.
module mech9_matrix_items
  use mech9_text, only: to_text
  use mech9_source, only: span_type
  use mech9_document, only: group_type, item_type, subscript_type
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: matrix_type, read_matrix

  !> The coincidence matrix as the data file gives it.
  type :: matrix_type
    integer, allocatable :: c(:, :)
    type(span_type), allocatable :: spans(:, :)  !< place of each element in the file; source 0: not given
  end type matrix_type

  !> Most links of a matrix; for more, the links of the pairs describe a structure in far less text.
  integer, parameter :: most_links = 3000

contains

  !> Collect all items `c` of the group. Each element must be given once; elements never named are 0,
  !> unless rows or columns are given: then all must be given. `ok` is false where an error was reported.
  pure subroutine read_matrix(group, n_links, matrix, ok, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: n_links                        !< number of links by &mechanism; 0: taken from the matrix
    type(matrix_type), intent(out) :: matrix              !< the coincidence matrix with the places of its elements
    logical, intent(out) :: ok                            !< whether no error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical :: in_rows
    integer :: i, n, found

    found = diagnostics%count
    n = n_links
    if (n == 0) n = size_of_items(group)
    if (n > most_links) then
      call diagnostics%add(first_span(group), 'a matrix c of '//to_text(n)//' links is too large; leave c out and let '// &
                           'the links of the pairs define the structure')
    else
      allocate (matrix%c(n, n), source=0)
      allocate (matrix%spans(n, n))
      in_rows = .false.
      do i = 1, size(group%items)
        if (group%items(i)%name /= 'c') cycle
        call place_item(group%items(i), matrix, diagnostics)
        in_rows = in_rows .or. any(group%items(i)%subscripts%section) .or. size(group%items(i)%subscripts) == 0
      end do
      if (in_rows .and. diagnostics%count == found) call check_complete(group, matrix, diagnostics)
    end if
    ok = diagnostics%count == found
  end subroutine read_matrix

  !> The place of the first item of the matrix.
  pure type(span_type) function first_span(group)
    type(group_type), intent(in) :: group  !< the group of the data file
    integer :: i

    do i = size(group%items), 1, -1
      if (group%items(i)%name == 'c') first_span = group%items(i)%span
    end do
  end function first_span

  !> The number of links that the subscripts of rows, columns and elements imply.
  pure integer function size_of_items(group) result(n)
    type(group_type), intent(in) :: group  !< the group of the data file
    integer :: i, k

    n = 1
    do i = 1, size(group%items)
      associate (item => group%items(i))
        if (item%name /= 'c') cycle
        if (size(item%subscripts) == 0) n = max(n, nint(sqrt(real(size(item%values)))))
        if (size(item%subscripts) == 2) then
          if (count(item%subscripts%section) == 1) n = max(n, size(item%values))
        end if
        do k = 1, size(item%subscripts)
          n = max(n, item%subscripts(k)%first, item%subscripts(k)%last)
        end do
      end associate
    end do
  end function size_of_items

  !> Put the values of one item at their places.
  pure subroutine place_item(item, matrix, diagnostics)
    type(item_type), intent(in) :: item                   !< a row, column or element of the matrix
    type(matrix_type), intent(inout) :: matrix            !< the coincidence matrix with the places of its elements
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: rows(2), columns(2), i, j, n, expected

    n = size(matrix%c, 1)
    rows = [1, n]
    columns = [1, n]
    if (size(item%subscripts) == 1) then
      call diagnostics%add(item%span, '''c'' takes two subscripts: write its row 1 as c(1,:) = ...')
      return
    else if (size(item%subscripts) == 2) then
      rows = bounds(item%subscripts(1), n)
      columns = bounds(item%subscripts(2), n)
    end if
    if (max(rows(2), columns(2)) > n) then
      call diagnostics%add(item%span, 'the subscripts of '''//trim(label(item))//''' go beyond the '//to_text(n)//' links')
      return
    end if
    expected = max(rows(2) - rows(1) + 1, 0)*max(columns(2) - columns(1) + 1, 0)
    if (expected /= size(item%values)) then
      call diagnostics%add(item%span, trim(label(item))//' has '//to_text(size(item%values))//merge(' value ', ' values', &
                           size(item%values) == 1)//' where '//to_text(n)//' links need '//to_text(expected))
      return
    end if
    expected = 0
    do j = columns(1), columns(2)
      do i = rows(1), rows(2)
        expected = expected + 1
        if (matrix%spans(i, j)%source /= 0 .and. .not. item%overrides) then
          call diagnostics%add(item%values(expected)%span, 'c('//to_text(i)//','//to_text(j)//') is given twice')
          return
        end if
        matrix%c(i, j) = int(item%values(expected)%whole)
        matrix%spans(i, j) = item%values(expected)%span
      end do
    end do
  end subroutine place_item

  !> First and last index of a subscript.
  pure function bounds(subscript, n)
    type(subscript_type), intent(in) :: subscript  !< one subscript of an item
    integer, intent(in) :: n                       !< number of links, which a section without an end runs to
    integer :: bounds(2)

    bounds = max(subscript%first, 1)
    if (.not. subscript%section) return
    bounds(2) = n
    if (subscript%last > 0) bounds(2) = subscript%last
  end function bounds

  !> "row 2 of c", "column 3 of c", or the item as it is called.
  pure function label(item) result(text)
    type(item_type), intent(in) :: item  !< a row, column or element of the matrix
    character(len=32) :: text

    text = 'c'
    if (size(item%subscripts) /= 2) return
    associate (row => item%subscripts(1), column => item%subscripts(2))
      if (column%section .and. .not. row%section) then
        text = 'row '//to_text(row%first)//' of c'
      else if (row%section .and. .not. column%section) then
        text = 'column '//to_text(column%first)//' of c'
      end if
    end associate
  end function label

  !> Report elements of the matrix that are not given.
  pure subroutine check_complete(group, matrix, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(matrix_type), intent(in) :: matrix               !< the coincidence matrix with the places of its elements
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i, j

    do i = 1, size(matrix%c, 1)
      j = findloc(matrix%spans(i, :)%source, 0, dim=1)
      if (j == 0) cycle
      if (all(matrix%spans(i, :)%source == 0)) then
        call diagnostics%add(first_span(group), 'row '//to_text(i)//' of c is missing')
      else
        call diagnostics%add(first_span(group), 'c('//to_text(i)//','//to_text(j)//') is missing')
      end if
    end do
  end subroutine check_complete
end module mech9_matrix_items
