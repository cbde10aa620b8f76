!> A quantity over time, or over the runs of a study, in an HDF5 file: a data set and the rows that wait to be written to it.
module mech9_hdf5_quantity
  use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_ptr
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use hdf5, only: hid_t, hsize_t, size_t, h5pcreate_f, h5pclose_f, h5pset_chunk_f, h5pset_fill_time_f, h5pset_deflate_f, &
                  h5pset_shuffle_f, h5pset_chunk_cache_f, h5p_dataset_create_f, h5p_dataset_access_f, &
                  h5d_fill_time_never_f, h5pset_alloc_time_f, h5d_alloc_time_early_f, h5pset_fill_value_f, &
                  h5screate_simple_f, h5sclose_f, h5s_unlimited_f, &
                  h5sselect_hyperslab_f, h5s_select_set_f, h5dcreate_anon_f, h5dset_extent_f, h5dget_space_f, &
                  h5dopen_f, h5dwrite_f, h5dread_f, h5dclose_f, h5sget_simple_extent_ndims_f, h5sget_simple_extent_dims_f, &
                  h5t_ieee_f64le, h5t_std_i32le, h5t_native_double, h5t_native_integer
  use mech9_kinds, only: wp
  use mech9_column_sets, only: column_set_type
  use mech9_hdf5_file, only: hdf5_file_type
  implicit none
  private
  public :: quantity_type

  !> Columns that are copied as one piece, on the average.
  integer, parameter :: shortest_piece = 8

  !> A data set over the rows of a series, which takes some of their columns.
  type, extends(column_set_type) :: quantity_type
    integer(hid_t) :: data_set = -1
    integer, allocatable, private :: pieces(:, :)     !< (2,pieces) first column and number of columns that stand side by side; none:
                                                      !< the pieces would be short
    real(wp), allocatable, private :: buffer(:, :)    !< (columns, rows) numbers of rows that wait
  contains
    procedure :: reserve
    procedure :: create_growing
    procedure :: create_fixed
    procedure :: open_fixed
    procedure :: take
    procedure :: write_block
    procedure :: read_block
    procedure :: close => close_quantity
  end type quantity_type

contains

  !> Make room for rows that wait to be written.
  pure subroutine reserve(self, capacity)
    class(quantity_type), intent(inout) :: self   !< the quantity, with its columns
    integer, intent(in) :: capacity               !< how many rows wait at most

    self%pieces = pieces_of(self%columns)
    allocate (self%buffer(size(self%columns), capacity), source=0.0_wp)
  end subroutine reserve

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

  !> Make an empty data set without a name, to which rows are appended.
  subroutine create_growing(self, chunk_rows, compression, file)
    class(quantity_type), intent(inout) :: self      !< the quantity, which gets its data set
    integer, intent(in) :: chunk_rows                !< rows of a chunk
    integer, intent(in) :: compression               !< compression: from 0, none, to 9, the most
    type(hdf5_file_type), intent(inout) :: file      !< the open file
    integer(hid_t) :: creation, access, space
    integer(hsize_t), dimension(size(self%extents) + 1) :: none, most, chunk
    integer :: status, rank

    if (allocated(file%failure)) return
    rank = size(none)
    none = [int(self%extents, hsize_t), 0_hsize_t]
    most = [int(self%extents, hsize_t), h5s_unlimited_f]
    chunk = [int(self%extents, hsize_t), int(chunk_rows, hsize_t)]
    call h5pcreate_f(h5p_dataset_create_f, creation, status)
    call h5pset_chunk_f(creation, rank, chunk, status)
    call file%check(status)
    call h5pset_fill_time_f(creation, h5d_fill_time_never_f, status)
    if (compression > 0) call h5pset_shuffle_f(creation, status)
    if (compression > 0) call h5pset_deflate_f(creation, compression, status)
    call file%check(status)
    ! no cache: blocks go to the file when they are written, not later
    call h5pcreate_f(h5p_dataset_access_f, access, status)
    call h5pset_chunk_cache_f(access, 0_size_t, 0_size_t, 0.0, status)
    call h5screate_simple_f(rank, none, space, status, most)
    call h5dcreate_anon_f(file%id, type_in_file(self), space, self%data_set, status, dcpl_id=creation, dapl_id=access)
    call file%check(status)
    call h5sclose_f(space, status)
    call h5pclose_f(access, status)
    call h5pclose_f(creation, status)
  end subroutine create_growing

  !> Make a data set with places for all its rows, without a name. They have no numbers yet: the caller fills all of them.
  subroutine create_fixed(self, rows, file)
    class(quantity_type), intent(inout) :: self     !< the quantity, which gets its data set
    integer(hsize_t), intent(in) :: rows            !< how many
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer(hid_t) :: creation, space
    integer :: status

    if (allocated(file%failure)) return
    call h5pcreate_f(h5p_dataset_create_f, creation, status)
    if (self%whole) then
      call h5pset_fill_value_f(creation, h5t_native_integer, -1, status)
    else
      call h5pset_fill_value_f(creation, h5t_native_double, ieee_value(1.0_wp, ieee_quiet_nan), status)
    end if
    call h5pset_alloc_time_f(creation, h5d_alloc_time_early_f, status)
    call h5pset_fill_time_f(creation, h5d_fill_time_never_f, status)
    call file%check(status)
    call h5screate_simple_f(size(self%extents) + 1, [int(self%extents, hsize_t), rows], space, status)
    call h5dcreate_anon_f(file%id, type_in_file(self), space, self%data_set, status, dcpl_id=creation)
    call file%check(status)
    call h5sclose_f(space, status)
    call h5pclose_f(creation, status)
  end subroutine create_fixed

  !> The type of its numbers in the file.
  integer(hid_t) function type_in_file(self)
    class(quantity_type), intent(in) :: self   !< the quantity

    type_in_file = merge(h5t_std_i32le, h5t_ieee_f64le, self%whole)
  end function type_in_file

  !> Open the data set of a file that is there. It is a failure of the file where the set has another form.
  subroutine open_fixed(self, rows, file)
    class(quantity_type), intent(inout) :: self     !< the quantity, which gets its data set
    integer(hsize_t), intent(in) :: rows            !< how many rows it has
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    integer(hid_t) :: space
    integer(hsize_t), allocatable :: extents(:), most(:)
    integer :: status, rank

    if (allocated(file%failure)) return
    call h5dopen_f(file%id, self%name, self%data_set, status)
    call file%check(status)
    if (allocated(file%failure)) return
    call h5dget_space_f(self%data_set, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    allocate (extents(rank), most(rank))
    call h5sget_simple_extent_dims_f(space, extents, most, status)
    call h5sclose_f(space, status)
    if (.not. has_extents(extents, [int(self%extents, hsize_t), rows])) &
      call file%fail("data set '"//self%name//"' has other dimensions than this study gives it")
  end subroutine open_fixed

  !> Whether extents are those that are expected.
  pure logical function has_extents(extents, expected)
    integer(hsize_t), intent(in) :: extents(:)   !< of a data set, in Fortran order
    integer(hsize_t), intent(in) :: expected(:)  !< those that it should have

    has_extents = size(extents) == size(expected)
    if (has_extents) has_extents = all(extents == expected)
  end function has_extents

  !> Copy its columns of rows to the buffer.
  pure subroutine take(self, rows, first)
    class(quantity_type), intent(inout) :: self          !< the quantity
    real(wp), intent(in), contiguous :: rows(:, :)       !< (columns of all quantities, rows) the rows to keep
    integer, intent(in) :: first                         !< place of the first one in the buffer, from 1

    if (size(self%pieces) > 0) then
      call pick_pieces(size(rows, 1), size(rows, 2), rows, size(self%columns), size(self%pieces, 2), self%pieces, &
                       self%buffer(1, first))
    else
      call pick(size(rows, 1), size(rows, 2), rows, size(self%columns), self%columns, self%buffer(1, first))
    end if
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

  !> Write rows of the buffer to the file. Whole numbers are converted here: HDF5 would clear a buffer of 1 MB for each call.
  subroutine write_block(self, first, last, offset, grows, file)
    class(quantity_type), intent(in), target :: self     !< the quantity
    integer, intent(in) :: first                         !< place of the first of these rows in the buffer, from 1
    integer, intent(in) :: last                          !< place of the last one
    integer(hsize_t), intent(in) :: offset               !< how many rows of the data set stand before them
    logical, intent(in) :: grows                         !< they are appended to the data set
    type(hdf5_file_type), intent(inout) :: file          !< the open file
    integer(hsize_t), dimension(size(self%extents) + 1) :: start, block
    integer(c_int), allocatable, target :: whole(:, :)
    integer(hid_t) :: in_file, in_memory
    integer :: status, rank

    if (allocated(file%failure)) return
    status = 0
    rank = size(self%extents) + 1
    start = 0
    start(rank) = offset
    block = [int(self%extents, hsize_t), int(last - first + 1, hsize_t)]
    if (grows) call h5dset_extent_f(self%data_set, [int(self%extents, hsize_t), offset + block(rank)], status)
    call file%check(status)
    call h5dget_space_f(self%data_set, in_file, status)
    call h5sselect_hyperslab_f(in_file, h5s_select_set_f, start, block, status)
    call h5screate_simple_f(rank, block, in_memory, status)
    if (self%whole) then
      whole = nint(self%buffer(:, first:last), c_int)
      call h5dwrite_f(self%data_set, h5t_native_integer, c_loc(whole), status, mem_space_id=in_memory, file_space_id=in_file)
    else
      call h5dwrite_f(self%data_set, h5t_native_double, c_loc(self%buffer(1, first)), status, mem_space_id=in_memory, &
                      file_space_id=in_file)
    end if
    call file%check(status)
    call h5sclose_f(in_memory, status)
    call h5sclose_f(in_file, status)
  end subroutine write_block

  !> Read rows that follow each other.
  subroutine read_block(self, file, first, rows)
    class(quantity_type), intent(in) :: self       !< the quantity
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    integer, intent(in) :: first                   !< place of the first row, from 1
    real(wp), intent(inout) :: rows(:, :)          !< (columns of all quantities, rows) gets the columns of this one
    real(wp), target :: block(size(self%columns), size(rows, 2))
    type(c_ptr) :: place
    integer(hsize_t), dimension(size(self%extents) + 1) :: offset, extents
    integer(hid_t) :: in_file, in_memory
    integer :: status

    if (allocated(file%failure)) return
    offset = 0
    offset(size(offset)) = first - 1
    extents = [int(self%extents, hsize_t), size(rows, 2, kind=hsize_t)]
    call h5dget_space_f(self%data_set, in_file, status)
    call h5sselect_hyperslab_f(in_file, h5s_select_set_f, offset, extents, status)
    call h5screate_simple_f(size(extents), extents, in_memory, status)
    place = c_loc(block)
    call h5dread_f(self%data_set, h5t_native_double, place, status, mem_space_id=in_memory, file_space_id=in_file)
    call file%check(status)
    call h5sclose_f(in_memory, status)
    call h5sclose_f(in_file, status)
    rows(self%columns, :) = block
  end subroutine read_block

  !> Close the data set, if it is open.
  subroutine close_quantity(self)
    class(quantity_type), intent(inout) :: self    !< the quantity
    integer :: status

    if (self%data_set >= 0) call h5dclose_f(self%data_set, status)
    self%data_set = -1
  end subroutine close_quantity
end module mech9_hdf5_quantity
