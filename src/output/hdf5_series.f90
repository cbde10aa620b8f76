!> Quantities over time, or over the runs of a study, in an HDF5 file: data sets that are written by blocks of rows.
!>
!> Data sets over time grow. They grow together. Rows are gathered in memory, each quantity by itself, and written to the file in
!> blocks; readers see them only after a flush has written the new lengths. A run may be killed in the middle
!> of a flush: hence the lengths of all data sets stand side by side, in one piece of metadata that is written
!> at once, and chunks are so large that their index seldom changes, for most runs never.
!>
!> Data sets over runs have places for all their rows from the beginning. No metadata change when these are written, and rows go to
!> the file in the order in which they are written, the last quantity last.
module mech9_hdf5_series
  use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use hdf5, only: hid_t, hsize_t, size_t, h5pcreate_f, h5pclose_f, h5pset_chunk_f, h5pset_fill_time_f, h5pset_deflate_f, &
                  h5pset_shuffle_f, h5pset_chunk_cache_f, h5p_dataset_create_f, h5p_dataset_access_f, &
                  h5d_fill_time_never_f, h5pset_alloc_time_f, h5d_alloc_time_early_f, h5pset_fill_value_f, &
                  h5screate_simple_f, h5sclose_f, h5s_unlimited_f, &
                  h5sselect_hyperslab_f, h5s_select_set_f, h5dcreate_anon_f, h5olink_f, h5dset_extent_f, h5dget_space_f, &
                  h5dopen_f, h5dwrite_f, h5dread_f, h5dclose_f, h5sget_simple_extent_ndims_f, h5sget_simple_extent_dims_f, &
                  h5t_ieee_f64le, h5t_std_i32le, h5t_native_double, h5t_native_integer
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type
  use mech9_hdf5_file, only: hdf5_file_type
  implicit none
  private
  public :: hdf5_series_type

  !> Number of chunks of a complete compressed run; each is written as a whole.
  integer, parameter :: compressed_chunks = 60
  integer, parameter :: least_chunk_rows = 1024
  !> Size of the chunks of all quantities together, and of the rows gathered before they are written [bytes].
  integer(long), parameter :: largest_chunk = 67108864, buffer_size = 8388608
  integer, parameter :: most_buffered = 4096
  !> Columns that are copied as one piece, on the average.
  integer, parameter :: shortest_piece = 8

  !> One quantity.
  type :: quantity_type
    integer(hid_t) :: data_set = -1
    character(len=:), allocatable :: name, long_name, unit
    logical :: whole = .false.                   !< whether its numbers are whole
    character(len=:), allocatable :: scales(:)   !< paths of the dimension scales, time first; none: the quantity is a scale itself
    integer, allocatable :: columns(:)           !< numbers of its columns in a row
    integer, allocatable :: pieces(:, :)         !< (2,pieces) first column and number of columns that stand side by side; none: the
                                                 !< pieces would be short
    integer(hsize_t), allocatable :: extents(:)  !< extents of its part of a row, Fortran order; empty: one number
    real(wp), allocatable :: buffer(:, :)        !< (columns, rows) numbers of all rows
  end type quantity_type

  !> The quantities of one file.
  type :: hdf5_series_type
    private
    type(quantity_type), allocatable :: quantities(:)
    integer :: count = 0        !< how many quantities there are
    integer :: compression = 0  !< compression: from 0, none, to 9, the most
    integer :: chunk_rows = 0
    integer :: capacity = 0          !< how many rows a buffer holds
    integer :: waiting = 0           !< how many rows wait in the buffers
    integer(hsize_t) :: written = 0  !< how many rows are in the file; of a fixed number of rows, those before the next one
    logical :: fixed = .false.       !< the data sets have all their rows from the beginning
    integer(hsize_t) :: rows = 0     !< how many these are
  contains
    procedure :: start
    procedure :: start_fixed
    procedure :: add
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
    integer :: chunks

    allocate (self%quantities(n_quantities))
    self%compression = compression
    ! equal chunks, so that the last one is nearly full
    chunks = 1 + (max(expected_rows, 1) - 1)/rows_within(largest_chunk, n_columns)
    self%chunk_rows = 1 + (max(expected_rows, 1) - 1)/chunks
    if (compression > 0) self%chunk_rows = min(self%chunk_rows, &
                                               max(least_chunk_rows, 1 + (expected_rows - 1)/compressed_chunks))
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
  end subroutine start_fixed

  !> The number of rows that fit into a memory of the given size; at least one.
  pure integer function rows_within(bytes, n_columns) result(rows)
    integer(long), intent(in) :: bytes  !< size of the memory [bytes]
    integer, intent(in) :: n_columns    !< numbers in each row, 8 bytes each

    rows = int(max(1_long, bytes/(8_long*n_columns)))
  end function rows_within

  !> Add a quantity.
  subroutine add(self, name, columns, extents, long_name, unit, scales, whole)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    character(len=*), intent(in) :: name            !< path of the data set
    character(len=*), intent(in) :: long_name       !< a few words that describe it
    character(len=*), intent(in) :: unit            !< unit of its numbers
    integer, intent(in) :: columns(:)               !< numbers of its columns in a row
    integer, intent(in) :: extents(:)               !< extents of its part of a row, Fortran order; empty: one number
    character(len=*), intent(in) :: scales(:)  !< paths of the dimension scales, time first; none: the quantity is a scale itself
    logical, intent(in), optional :: whole          !< whether its numbers are whole; false if absent

    self%count = self%count + 1
    associate (quantity => self%quantities(self%count))
      quantity%name = name
      quantity%long_name = long_name
      quantity%unit = unit
      quantity%scales = scales
      if (present(whole)) quantity%whole = whole
      quantity%columns = columns
      quantity%pieces = pieces_of(columns)
      quantity%extents = extents
      allocate (quantity%buffer(size(columns), self%capacity), source=0.0_wp)
    end associate
  end subroutine add

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

  !> The pieces of a list of columns that stand side by side in a row: the first column of each, and their number; none where they are
  !> short on the average.
  pure function pieces_of(columns) result(pieces)
    integer, intent(in) :: columns(:)   !< numbers of the columns
    integer, allocatable :: pieces(:, :)
    integer :: i, n, follower

    allocate (pieces(2, size(columns)))
    n = 0
    follower = 0
    do i = 1, size(columns)
      if (n > 0 .and. columns(i) == follower) then
        pieces(2, n) = pieces(2, n) + 1
      else
        n = n + 1
        pieces(:, n) = [columns(i), 1]
      end if
      follower = columns(i) + 1
    end do
    if (n*shortest_piece > size(columns)) n = 0
    pieces = pieces(:, :n)
  end function pieces_of

  !> Make all data sets first and name them afterwards. This is called before anything else is written to
  !> the file, so that one page of memory holds the lengths of all of them.
  subroutine create(self, file)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer :: i, status

    do i = 1, self%count
      call create_data_set(self, self%quantities(i), file)
    end do
    do i = 1, self%count
      if (allocated(file%failure)) return
      associate (quantity => self%quantities(i))
        call h5olink_f(quantity%data_set, file%id, quantity%name, status, lcpl_id=file%link_properties())
        call file%check(status)
        call file%describe(quantity%name, quantity%long_name, quantity%unit)
        if (size(quantity%scales) == 0) call file%make_scale(quantity%name)
      end associate
    end do
  end subroutine create

  !> Open the data sets of a file that is there, in place of `create`. It is a failure of the file where they have another form.
  subroutine open_series(self, file)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over runs, of a fixed number of rows
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer(hid_t) :: space
    integer(hsize_t), allocatable :: extents(:), most(:)
    integer :: i, status, rank

    do i = 1, self%count
      if (allocated(file%failure)) return
      associate (quantity => self%quantities(i))
        call h5dopen_f(file%id, quantity%name, quantity%data_set, status)
        call file%check(status)
        if (allocated(file%failure)) return
        call h5dget_space_f(quantity%data_set, space, status)
        call h5sget_simple_extent_ndims_f(space, rank, status)
        allocate (extents(rank), most(rank))
        call h5sget_simple_extent_dims_f(space, extents, most, status)
        call h5sclose_f(space, status)
        if (.not. has_extents(extents, [quantity%extents, self%rows])) &
          call file%fail("data set '"//quantity%name//"' has other dimensions than this study gives it")
        deallocate (extents, most)
      end associate
    end do
  end subroutine open_series

  !> Whether extents are those that are expected.
  pure logical function has_extents(extents, expected)
    integer(hsize_t), intent(in) :: extents(:)   !< of a data set, in Fortran order
    integer(hsize_t), intent(in) :: expected(:)  !< those that it should have

    has_extents = size(extents) == size(expected)
    if (has_extents) has_extents = all(extents == expected)
  end function has_extents

  !> Make an empty data set without a name.
  subroutine create_data_set(self, quantity, file)
    class(hdf5_series_type), intent(in) :: self     !< the quantities over time
    type(quantity_type), intent(inout) :: quantity  !< the quantity, which gets its data set
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer(hid_t) :: creation, access, space
    integer(hsize_t), dimension(size(quantity%extents) + 1) :: none, most, chunk
    integer :: status, rank

    if (allocated(file%failure)) return
    if (self%fixed) then
      call create_fixed(self, quantity, file)
      return
    end if
    rank = size(none)
    none = [quantity%extents, 0_hsize_t]
    most = [quantity%extents, h5s_unlimited_f]
    chunk = [quantity%extents, int(self%chunk_rows, hsize_t)]
    call h5pcreate_f(h5p_dataset_create_f, creation, status)
    call h5pset_chunk_f(creation, rank, chunk, status)
    call file%check(status)
    call h5pset_fill_time_f(creation, h5d_fill_time_never_f, status)
    if (self%compression > 0) call h5pset_shuffle_f(creation, status)
    if (self%compression > 0) call h5pset_deflate_f(creation, self%compression, status)
    call file%check(status)
    ! no cache: blocks go to the file when they are written, not later
    call h5pcreate_f(h5p_dataset_access_f, access, status)
    call h5pset_chunk_cache_f(access, 0_size_t, 0_size_t, 0.0, status)
    call h5screate_simple_f(rank, none, space, status, most)
    call h5dcreate_anon_f(file%id, merge(h5t_std_i32le, h5t_ieee_f64le, quantity%whole), space, quantity%data_set, &
                          status, dcpl_id=creation, dapl_id=access)
    call file%check(status)
    call h5sclose_f(space, status)
    call h5pclose_f(access, status)
    call h5pclose_f(creation, status)
  end subroutine create_data_set

  !> Make a data set with places for all its rows, without a name. They have no numbers yet: the caller fills all of them.
  subroutine create_fixed(self, quantity, file)
    class(hdf5_series_type), intent(in) :: self     !< the quantities over runs
    type(quantity_type), intent(inout) :: quantity  !< the quantity, which gets its data set
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer(hid_t) :: creation, space
    integer :: status

    call h5pcreate_f(h5p_dataset_create_f, creation, status)
    if (quantity%whole) then
      call h5pset_fill_value_f(creation, h5t_native_integer, -1, status)
    else
      call h5pset_fill_value_f(creation, h5t_native_double, ieee_value(1.0_wp, ieee_quiet_nan), status)
    end if
    call h5pset_alloc_time_f(creation, h5d_alloc_time_early_f, status)
    call h5pset_fill_time_f(creation, h5d_fill_time_never_f, status)
    call file%check(status)
    call h5screate_simple_f(size(quantity%extents) + 1, [quantity%extents, self%rows], space, status)
    call h5dcreate_anon_f(file%id, merge(h5t_std_i32le, h5t_ieee_f64le, quantity%whole), space, quantity%data_set, &
                          status, dcpl_id=creation)
    call file%check(status)
    call h5sclose_f(space, status)
    call h5pclose_f(creation, status)
  end subroutine create_fixed

  !> Attach the scales, which are in the file by now.
  subroutine attach(self, file)
    class(hdf5_series_type), intent(in) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file  !< the open file
    integer :: i

    do i = 1, self%count
      if (size(self%quantities(i)%scales) > 0) &
        call file%attach_scales(self%quantities(i)%name, self%quantities(i)%scales)
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
      call take(self, rows(:, next:next + together - 1))
      next = next + together
      if (self%waiting == self%capacity) call self%hand_over(file)
    end do
  end subroutine append_rows

  !> Write a row at its place among a fixed number of rows. Rows that follow each other are written together.
  subroutine write_row_at(self, file, place, row)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over runs
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer, intent(in) :: place                    !< of the row, from 1
    real(wp), intent(in) :: row(:)                  !< (columns) its numbers

    if (place /= self%written + self%waiting + 1) then
      call self%hand_over(file)
      self%written = place - 1
    end if
    call self%append_rows(file, reshape(row, [size(row), 1]))
  end subroutine write_row_at

  !> Read rows of a fixed number of rows that follow each other.
  subroutine read_rows(self, file, first, rows)
    class(hdf5_series_type), intent(in) :: self    !< the quantities over runs
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    integer, intent(in) :: first                   !< place of the first row, from 1
    real(wp), intent(inout) :: rows(:, :)          !< (columns, rows) numbers of all rows
    integer :: i

    do i = 1, self%count
      if (allocated(file%failure)) return
      call read_block(self%quantities(i), file, first, rows)
    end do
  end subroutine read_rows

  !> Read the rows of one quantity.
  subroutine read_block(quantity, file, first, rows)
    type(quantity_type), intent(in) :: quantity    !< the quantity
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    integer, intent(in) :: first                   !< place of the first row, from 1
    real(wp), intent(inout) :: rows(:, :)          !< (columns, rows) gets the columns of the quantity
    real(wp), target :: block(size(quantity%columns), size(rows, 2))
    type(c_ptr) :: place
    integer(hsize_t), dimension(size(quantity%extents) + 1) :: offset, extents
    integer(hid_t) :: in_file, in_memory
    integer :: status

    offset = 0
    offset(size(offset)) = first - 1
    extents = [quantity%extents, size(rows, 2, kind=hsize_t)]
    call h5dget_space_f(quantity%data_set, in_file, status)
    call h5sselect_hyperslab_f(in_file, h5s_select_set_f, offset, extents, status)
    call h5screate_simple_f(size(extents), extents, in_memory, status)
    place = c_loc(block)
    call h5dread_f(quantity%data_set, h5t_native_double, place, status, mem_space_id=in_memory, file_space_id=in_file)
    call file%check(status)
    call h5sclose_f(in_memory, status)
    call h5sclose_f(in_file, status)
    rows(quantity%columns, :) = block
  end subroutine read_block

  !> Copy rows to the buffers of the quantities.
  pure subroutine take(self, rows)
    class(hdf5_series_type), intent(inout) :: self       !< the quantities over time
    real(wp), intent(in), contiguous :: rows(:, :)       !< (columns, rows) the rows to keep
    integer :: i

    do i = 1, self%count
      associate (quantity => self%quantities(i))
        if (size(quantity%pieces) > 0) then
          call pick_pieces(size(rows, 1), size(rows, 2), rows, size(quantity%columns), size(quantity%pieces, 2), quantity%pieces, &
                           quantity%buffer(1, self%waiting + 1))
        else
          call pick(size(rows, 1), size(rows, 2), rows, size(quantity%columns), quantity%columns, &
                    quantity%buffer(1, self%waiting + 1))
        end if
      end associate
    end do
    self%waiting = self%waiting + size(rows, 2)
  end subroutine take

  !> Copy some columns of rows. The arrays have known shapes, so that the compiler keeps their addresses in registers.
  pure subroutine pick(width, n, rows, count, columns, picked)
    integer, intent(in) :: width                    !< number of all columns
    integer, intent(in) :: n                        !< number of rows
    real(wp), intent(in) :: rows(width, n)          !< the rows
    integer, intent(in) :: count                    !< number of columns to be copied
    integer, intent(in) :: columns(count)           !< their numbers
    real(wp), intent(inout) :: picked(count, n)     !< gets them
    integer :: j, k

    do j = 1, n
      do k = 1, count
        picked(k, j) = rows(columns(k), j)
      end do
    end do
  end subroutine pick

  !> The same by pieces.
  pure subroutine pick_pieces(width, n, rows, count, n_pieces, pieces, picked)
    integer, intent(in) :: width                    !< number of all columns
    integer, intent(in) :: n                        !< number of rows
    real(wp), intent(in) :: rows(width, n)          !< the rows
    integer, intent(in) :: count                    !< number of columns to be copied
    integer, intent(in) :: n_pieces                 !< number of pieces
    integer, intent(in) :: pieces(2, n_pieces)      !< first column and number of columns of each
    real(wp), intent(inout) :: picked(count, n)     !< gets them
    integer :: i, j, k, at

    do j = 1, n
      at = 0
      do i = 1, n_pieces
        do k = 1, pieces(2, i)
          picked(at + k, j) = rows(pieces(1, i) + k - 1, j)
        end do
        at = at + pieces(2, i)
      end do
    end do
  end subroutine pick_pieces

  !> Write the rows in the buffers. Compressed rows are written only as whole chunks, except at the end.
  subroutine hand_over(self, file, at_end)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    logical, intent(in), optional :: at_end         !< present: write rows that do not fill a chunk, too
    integer :: i

    if (self%waiting == 0) return
    if (self%compression > 0 .and. self%waiting < self%capacity .and. .not. present(at_end)) return
    do i = 1, self%count
      call write_block(self, self%quantities(i), file)
    end do
    self%written = self%written + self%waiting
    self%waiting = 0
  end subroutine hand_over

  !> Write the rows in the buffer of one quantity.
  subroutine write_block(self, quantity, file)
    class(hdf5_series_type), intent(in) :: self          !< the quantities over time
    type(quantity_type), intent(in), target :: quantity  !< the quantity whose buffer is written
    type(hdf5_file_type), intent(inout) :: file          !< the open file
    integer(hsize_t), dimension(size(quantity%extents) + 1) :: whole, first, block
    integer(hid_t) :: in_file, in_memory
    integer :: status, rank

    if (allocated(file%failure)) return
    status = 0
    rank = size(quantity%extents) + 1
    whole = [quantity%extents, self%written + self%waiting]
    first = 0
    first(rank) = self%written
    block = [quantity%extents, int(self%waiting, hsize_t)]
    if (.not. self%fixed) call h5dset_extent_f(quantity%data_set, whole, status)
    call file%check(status)
    call h5dget_space_f(quantity%data_set, in_file, status)
    call h5sselect_hyperslab_f(in_file, h5s_select_set_f, first, block, status)
    call h5screate_simple_f(rank, block, in_memory, status)
    call h5dwrite_f(quantity%data_set, h5t_native_double, c_loc(quantity%buffer), status, &
                    mem_space_id=in_memory, file_space_id=in_file)
    call file%check(status)
    call h5sclose_f(in_memory, status)
    call h5sclose_f(in_file, status)
  end subroutine write_block

  !> Write the rows in the buffers and close the data sets.
  subroutine close_series(self, file)
    class(hdf5_series_type), intent(inout) :: self  !< the quantities over time
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer :: i, status

    call self%hand_over(file, at_end=.true.)
    do i = 1, self%count
      if (self%quantities(i)%data_set >= 0) call h5dclose_f(self%quantities(i)%data_set, status)
    end do
    self%count = 0
  end subroutine close_series
end module mech9_hdf5_series
