!> Data sets over rows of numbers, as over the outputs of a run: which columns each takes, and how it is described.
module mech9_column_sets
  use mech9_kinds, only: long
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: column_set_type, column_set_list_type, new_column_set, scale_length, chunk_rows_for, rows_within

  !> Longest path of a dimension scale.
  integer, parameter :: scale_length = 27
  !> Number of chunks of a complete compressed run; each is written as a whole.
  integer, parameter :: compressed_chunks = 60
  integer, parameter :: least_chunk_rows = 1024
  !> Size of the chunks of all data sets together [bytes].
  integer(long), parameter :: largest_chunk = 67108864

  !> A data set over rows, which takes some of their columns.
  type :: column_set_type
    character(len=:), allocatable :: name, long_name, unit
    logical :: whole = .false.                   !< whether its numbers are whole
    !> Paths of the dimension scales, that of the rows first; none: the data set is a scale itself.
    character(len=scale_length), allocatable :: scales(:)
    integer, allocatable :: columns(:)           !< numbers of its columns in a row
    integer, allocatable :: extents(:)           !< extents of its part of a row, Fortran order; empty: one number
  contains
    procedure :: describe_in
    procedure :: attach_in
  end type column_set_type

  !> Data sets over the same rows.
  type :: column_set_list_type
    type(column_set_type), allocatable :: sets(:)
    integer :: count = 0                         !< how many there are
  contains
    procedure :: add
  end type column_set_list_type

contains

  !> A data set over rows.
  pure function new_column_set(name, columns, extents, long_name, unit, scales, whole) result(set)
    character(len=*), intent(in) :: name        !< path of the data set
    integer, intent(in) :: columns(:)           !< numbers of its columns in a row
    integer, intent(in) :: extents(:)           !< extents of its part of a row, Fortran order; empty: one number
    character(len=*), intent(in) :: long_name   !< a few words that describe it
    character(len=*), intent(in) :: unit        !< unit of its numbers
    character(len=*), intent(in) :: scales(:)   !< paths of the scales, that of the rows first; none: the data set is a scale itself
    logical, intent(in), optional :: whole      !< whether its numbers are whole; false if absent
    type(column_set_type) :: set

    set%name = name
    set%columns = columns
    set%extents = extents
    set%long_name = long_name
    set%unit = unit
    set%scales = scales
    if (present(whole)) set%whole = whole
  end function new_column_set

  !> Describe the data set where it has been made; one without scales becomes a scale.
  subroutine describe_in(self, store)
    class(column_set_type), intent(in) :: self             !< the data set
    class(data_set_store_type), intent(inout) :: store     !< the storage that has it

    call store%describe(self%name, self%long_name, self%unit)
    if (size(self%scales) == 0) call store%make_scale(self%name)
  end subroutine describe_in

  !> Attach the scales, which have been made.
  subroutine attach_in(self, store)
    class(column_set_type), intent(in) :: self             !< the data set
    class(data_set_store_type), intent(inout) :: store     !< the storage that has it and its scales

    if (size(self%scales) > 0) call store%attach_scales(self%name, self%scales)
  end subroutine attach_in

  !> Add a data set. The list grows in a loop: an array constructor of such items would leak (gfortran 12).
  pure subroutine add(self, set)
    class(column_set_list_type), intent(inout) :: self     !< the list
    type(column_set_type), intent(in) :: set               !< the data set
    type(column_set_type), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(self%sets)) allocate (self%sets(16))
    if (self%count == size(self%sets)) then
      allocate (grown(2*self%count))
      do i = 1, self%count
        grown(i) = self%sets(i)
      end do
      call move_alloc(grown, self%sets)
    end if
    self%count = self%count + 1
    self%sets(self%count) = set
  end subroutine add

  !> Rows of a chunk of data sets that grow.
  pure integer function chunk_rows_for(n_columns, expected_rows, compression) result(rows)
    integer, intent(in) :: n_columns          !< columns of the rows
    integer, intent(in) :: expected_rows      !< expected number of rows; there may be more or fewer
    integer, intent(in) :: compression        !< from 0, none, to 9, the most
    integer :: chunks

    ! equal chunks, so that the last one is nearly full
    chunks = 1 + (max(expected_rows, 1) - 1)/rows_within(largest_chunk, n_columns)
    rows = 1 + (max(expected_rows, 1) - 1)/chunks
    if (compression > 0) rows = min(rows, max(least_chunk_rows, 1 + (expected_rows - 1)/compressed_chunks))
  end function chunk_rows_for

  !> The number of rows that fit into a memory of the given size; at least one.
  pure integer function rows_within(bytes, n_columns) result(rows)
    integer(long), intent(in) :: bytes  !< size of the memory [bytes]
    integer, intent(in) :: n_columns    !< numbers in each row, 8 bytes each

    rows = int(max(1_long, bytes/(8_long*n_columns)))
  end function rows_within
end module mech9_column_sets
