!> Quantities over time, or over the runs of a study, in an HDF5 file: data sets that are written by blocks of rows.
!>
!> Data sets over time grow. They grow together. Rows are gathered in memory, each quantity by itself, and written to the file in
!> blocks; readers see them only after a flush has written the new lengths. A run may be killed in the middle
!> of a flush: hence the lengths of all data sets stand side by side, in one piece of metadata that is written
!> at once, and chunks are so large that their index seldom changes, for most runs never.
!>
!> Data sets over runs have places for all their rows from the beginning. No metadata change when these are written. Rows come nearly
!> in the order of their places: threads finish one a little before another. The buffers hold rows of neighbouring places, and go to
!> the file together, the last quantity last.
module mech9_hdf5_series
  use hdf5, only: hsize_t, h5olink_f
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type
  use mech9_column_sets, only: column_set_type, column_set_list_type, chunk_rows_for, rows_within
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_quantity, only: quantity_type
  implicit none
  private
  public :: hdf5_series_type

  !> Size of the rows gathered before they are written [bytes].
  integer(long), parameter :: buffer_size = 8388608
  integer, parameter :: most_buffered = 4096

  !> The quantities of one file.
  type :: hdf5_series_type
    private
    type(quantity_type), allocatable :: quantities(:)
    integer :: count = 0        !< how many quantities there are
    integer :: compression = 0  !< compression: from 0, none, to 9, the most
    integer :: chunk_rows = 0
    integer :: capacity = 0          !< how many rows a buffer holds
    integer :: waiting = 0           !< place in the buffers of the last row that waits there
    integer(hsize_t) :: written = 0  !< how many rows of the data sets stand before the first place in the buffers
    logical, allocatable :: is_waiting(:)  !< (capacity) which places of the buffers have a row, of a fixed number of rows
    logical :: fixed = .false.       !< the data sets have all their rows from the beginning
    integer(hsize_t) :: rows = 0     !< how many these are
  contains
    procedure :: start
    procedure :: start_fixed
    procedure :: add
    procedure :: add_all
    procedure :: create
    procedure :: open => open_series
    procedure :: list_names
    procedure :: attach
    procedure :: append_rows
    procedure :: write_row_at
    procedure :: read_rows
    procedure :: hand_over
    procedure :: close => close_series
  end type hdf5_series_type

contains

  !> Set sizes of chunks and buffers, before the first quantity is added.
  subroutine start(self, n_quantities, n_columns, expected_rows, compression)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    integer, intent(in) :: n_quantities             !< most quantities
    integer, intent(in) :: n_columns                !< most columns of the rows
    integer, intent(in) :: expected_rows            !< expected number of rows; there may be more or fewer
    integer, intent(in) :: compression              !< compression: from 0, none, to 9, the most

    allocate (self%quantities(n_quantities))
    self%compression = compression
    self%chunk_rows = chunk_rows_for(n_columns, expected_rows, compression)
    self%capacity = min(most_buffered, rows_within(buffer_size, n_columns))
    ! compressed rows are written only once, in whole chunks
    if (compression > 0) self%capacity = self%chunk_rows
  end subroutine start

  !> Set the number of rows and the size of buffers, in place of `start`, for data sets with all their rows from the beginning.
  subroutine start_fixed(self, n_quantities, n_columns, rows, one_by_one)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over runs
    integer, intent(in) :: n_quantities             !< most quantities
    integer, intent(in) :: n_columns                !< most columns of the rows
    integer, intent(in) :: rows                     !< number of rows
    logical, intent(in) :: one_by_one               !< rows do not wait for others in a buffer

    allocate (self%quantities(n_quantities))
    self%fixed = .true.
    self%rows = rows
    self%capacity = min(most_buffered, rows_within(buffer_size, n_columns))
    if (one_by_one) self%capacity = 1
    allocate (self%is_waiting(self%capacity), source=.false.)
  end subroutine start_fixed

  !> Add a quantity.
  pure subroutine add(self, quantity)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(column_set_type), intent(in) :: quantity   !< its name, its columns and its description

    self%count = self%count + 1
    self%quantities(self%count)%column_set_type = quantity
    call self%quantities(self%count)%reserve(self%capacity)
  end subroutine add

  !> Add the quantities of a list.
  pure subroutine add_all(self, list)
    class(hdf5_series_type), intent(inout) :: self    !< the quantities over time
    type(column_set_list_type), intent(in) :: list    !< their names, columns and descriptions
    integer :: i

    do i = 1, list%count
      call self%add(list%sets(i))
    end do
  end subroutine add_all

  !> The paths of all data sets.
  pure subroutine list_names(self, names)
    class(hdf5_series_type), intent(in) :: self                    !< the quantities
    type(string_type), allocatable, intent(out) :: names(:)        !< their paths
    integer :: i

    allocate (names(self%count))
    do i = 1, self%count
      names(i)%text = self%quantities(i)%name
    end do
  end subroutine list_names

  !> Make all data sets first and name them afterwards. This is called before anything else is written to
  !> the file, so that one page of memory holds the lengths of all of them.
  subroutine create(self, file)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer :: i, status

    do i = 1, self%count
      if (self%fixed) then
        call self%quantities(i)%create_fixed(self%rows, file)
      else
        call self%quantities(i)%create_growing(self%chunk_rows, self%compression, file)
      end if
    end do
    do i = 1, self%count
      if (allocated(file%failure)) return
      associate (quantity => self%quantities(i))
        call h5olink_f(quantity%data_set, file%id, quantity%name, status, lcpl_id=file%link_properties())
        call file%check(status)
        call quantity%describe_in(file)
      end associate
    end do
  end subroutine create

  !> Open the data sets of a file that is there, in place of `create`. It is a failure of the file where they have another form.
  subroutine open_series(self, file)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over runs, of a fixed number of rows
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer :: i

    do i = 1, self%count
      call self%quantities(i)%open_fixed(self%rows, file)
    end do
  end subroutine open_series

  !> Attach the scales, which are in the file by now.
  subroutine attach(self, file)
    class(hdf5_series_type), intent(in) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file  !< the open file
    integer :: i

    do i = 1, self%count
      call self%quantities(i)%attach_in(file)
    end do
  end subroutine attach

  !> Append rows. They are written to the file when the buffers are full.
  subroutine append_rows(self, file, rows)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    real(wp), intent(in), contiguous :: rows(:, :)  !< (columns, rows) numbers of all rows
    integer :: next, together

    next = 1
    do while (next <= size(rows, 2))
      together = min(size(rows, 2) - next + 1, self%capacity - self%waiting)
      call take(self, rows(:, next:next + together - 1), self%waiting + 1)
      self%waiting = self%waiting + together
      next = next + together
      if (self%waiting == self%capacity) call self%hand_over(file)
    end do
  end subroutine append_rows

  !> Write a row at its place among a fixed number of rows, soon after or soon before the one that was written last.
  subroutine write_row_at(self, file, place, row)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over runs
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer, intent(in) :: place                    !< of the row, from 1
    real(wp), intent(in) :: row(:)                  !< (columns) its numbers
    integer(hsize_t) :: in_buffer

    in_buffer = place - self%written
    if (in_buffer < 1 .or. in_buffer > self%capacity) then
      call self%hand_over(file)
      self%written = place - 1
      in_buffer = 1
    end if
    call take(self, reshape(row, [size(row), 1]), int(in_buffer))
    self%waiting = max(self%waiting, int(in_buffer))
    if (self%capacity == 1) call self%hand_over(file)
  end subroutine write_row_at

  !> Read rows of a fixed number of rows that follow each other.
  subroutine read_rows(self, file, first, rows)
    class(hdf5_series_type), intent(in) :: self    !< the quantities over runs
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    integer, intent(in) :: first                   !< place of the first row, from 1
    real(wp), intent(inout) :: rows(:, :)          !< (columns, rows) numbers of all rows
    integer :: i

    do i = 1, self%count
      call self%quantities(i)%read_block(file, first, rows)
    end do
  end subroutine read_rows

  !> Copy rows to the buffers of the quantities.
  pure subroutine take(self, rows, first)
    class(hdf5_series_type), intent(inout) :: self       !< the quantities over time
    real(wp), intent(in), contiguous :: rows(:, :)       !< (columns, rows) the rows to keep
    integer, intent(in) :: first                         !< place of the first one in the buffers, from 1
    integer :: i

    do i = 1, self%count
      call self%quantities(i)%take(rows, first)
    end do
    if (self%fixed) self%is_waiting(first:first + size(rows, 2) - 1) = .true.
  end subroutine take

  !> Write the rows in the buffers. Compressed rows are written only as whole chunks, except at the end.
  subroutine hand_over(self, file, at_end)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    logical, intent(in), optional :: at_end         !< present: write rows that do not fill a chunk, too
    integer :: i

    if (self%waiting == 0) return
    if (self%compression > 0 .and. self%waiting < self%capacity .and. .not. present(at_end)) return
    do i = 1, self%count
      if (self%fixed) then
        call write_waiting(self, self%quantities(i), file)
      else
        call self%quantities(i)%write_block(1, self%waiting, self%written, .true., file)
      end if
    end do
    if (self%fixed) self%is_waiting = .false.
    self%written = self%written + self%waiting
    self%waiting = 0
  end subroutine hand_over

  !> Write the rows of a quantity that wait, those of neighbouring places together.
  subroutine write_waiting(self, quantity, file)
    class(hdf5_series_type), intent(in) :: self     !< the quantities over runs
    type(quantity_type), intent(in) :: quantity     !< one of them
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer :: first, last

    first = findloc(self%is_waiting, .true., dim=1)
    do while (first > 0)
      last = first + findloc([self%is_waiting(first + 1:), .false.], .false., dim=1) - 1
      call quantity%write_block(first, last, self%written + first - 1, .false., file)
      first = findloc(self%is_waiting(last + 1:), .true., dim=1)
      if (first > 0) first = last + first
    end do
  end subroutine write_waiting

  !> Write the rows in the buffers and close the data sets.
  subroutine close_series(self, file)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer :: i

    call self%hand_over(file, at_end=.true.)
    do i = 1, self%count
      call self%quantities(i)%close()
    end do
    self%count = 0
  end subroutine close_series
end module mech9_hdf5_series
