!> An HDF5 file being written: data sets written as a whole, attributes, dimension scales.
!>
!> The first failure is kept and later calls do nothing, so that a caller can make many calls before it looks
!> at the failure. Names are paths; missing groups of a path are made.
module mech9_hdf5_file
  use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_null_char, c_char
  use hdf5, only: hid_t, hsize_t, size_t, h5open_f, h5dont_atexit_f, h5eset_auto_f, h5get_libversion_f, &
                  h5fcreate_f, h5fflush_f, h5fclose_f, h5f_acc_trunc_f, h5f_close_strong_f, h5f_scope_local_f, &
                  h5pcreate_f, h5pclose_f, h5pset_fclose_degree_f, h5pset_meta_block_size_f, h5pset_sieve_buf_size_f, &
                  h5pset_create_inter_group_f, &
                  h5p_file_access_f, h5p_link_create_f, &
                  h5screate_f, h5screate_simple_f, h5sclose_f, h5s_scalar_f, &
                  h5tcopy_f, h5tset_cset_f, h5tclose_f, h5t_string, h5t_cset_utf8_f, &
                  h5t_ieee_f64le, h5t_std_i32le, h5t_std_i64le, h5t_native_double, h5kind_to_type, h5_integer_kind, &
                  h5lexists_f, h5dcreate_f, h5dopen_f, h5dwrite_f, h5dclose_f, &
                  h5acreate_by_name_f, h5awrite_f, h5aclose_f
  use h5ds, only: h5dsset_scale_f, h5dsattach_scale_f
  use mech9_kinds, only: long
  use mech9_error, only: error_type, raise, exit_file
  use mech9_text, only: string_type, to_text
  use mech9_replacement, only: replacement_type, begin_replacement
  use mech9_data_set_store, only: data_set_store_type, real_values, whole_values
  use mech9_hdf5_reason, only: last_reason
  implicit none
  private
  public :: hdf5_file_type, hdf5_version

  !> Size of the block for metadata at the beginning of the file [bytes]. A flush writes the block at once, so that
  !> a run that is killed leaves either the old state or the new one.
  integer(hsize_t), parameter :: metadata_block = 131072
  !> Kind of whole numbers of 32 bits.
  integer, parameter :: kind_of_whole = kind(1)

  type, extends(data_set_store_type) :: hdf5_file_type
    character(len=:), allocatable :: path
    integer(hid_t) :: id = -1
    type(error_type), allocatable :: failure     !< the first failure
    integer(hid_t), private :: text_type = -1    !< type of texts: UTF-8 of any length
    integer(hid_t), private :: make_groups = -1  !< property of links: missing groups of a path are made
    type(replacement_type), private :: replacement
  contains
    procedure :: create => create_file
    procedure :: flush => flush_file
    procedure :: close => close_file
    procedure :: is_open
    procedure :: link_properties
    procedure :: check
    procedure :: fail
    procedure :: put_numbers
    procedure :: put_text_values
    procedure :: add_attribute
    procedure :: make_scale
    procedure :: attach_scales
    procedure, private :: put_values
  end type hdf5_file_type

contains

  !> The library's name and version.
  function hdf5_version() result(text)
    character(len=40) :: text
    integer :: major, minor, release, status

    call h5get_libversion_f(major, minor, release, status)
    text = 'HDF5 '//to_text(major)//'.'//to_text(minor)//'.'//to_text(release)
  end function hdf5_version

  !> Create the file. It gets its name at the first flush: until then it cannot be opened,
  !> and an older file of that name remains.
  subroutine create_file(self, path, err)
    class(hdf5_file_type), intent(inout) :: self       !< the HDF5 file
    character(len=*), intent(in) :: path               !< path of the file
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer(hid_t) :: access
    integer :: status

    self%path = path
    if (path == '' .or. path == '-' .or. index(path, c_null_char) > 0) then
      call raise(err, exit_file, "'"//path//"' is not the name of a file for HDF5 results")
      return
    end if
    call begin_replacement(path, self%replacement, err)
    if (allocated(err)) return
    ! we close everything ourselves; failures of HDF5's own closing at the end of the program would print its messages
    call h5dont_atexit_f(status)
    call h5open_f(status)
    call h5eset_auto_f(0, status)
    call h5pcreate_f(h5p_file_access_f, access, status)
    call h5pset_fclose_degree_f(access, h5f_close_strong_f, status)
    call h5pset_meta_block_size_f(access, metadata_block, status)
    ! numbers go to the file when they are written, in this order
    call h5pset_sieve_buf_size_f(access, 0_size_t, status)
    call h5fcreate_f(self%replacement%path, h5f_acc_trunc_f, self%id, status, access_prp=access)
    if (status < 0) then
      self%id = -1
      call raise(err, exit_file, "cannot open '"//path//"' for writing: "//last_reason())
      call self%replacement%abandon()
    end if
    call h5pclose_f(access, status)
    if (allocated(err)) return
    call h5tcopy_f(h5t_string, self%text_type, status)
    call h5tset_cset_f(self%text_type, h5t_cset_utf8_f, status)
    call h5pcreate_f(h5p_link_create_f, self%make_groups, status)
    call h5pset_create_inter_group_f(self%make_groups, 1, status)
  end subroutine create_file

  !> Whether the file is open.
  pure logical function is_open(self)
    class(hdf5_file_type), intent(in) :: self  !< the HDF5 file

    is_open = self%id >= 0
  end function is_open

  !> Properties for making data sets by path.
  pure integer(hid_t) function link_properties(self)
    class(hdf5_file_type), intent(in) :: self  !< the HDF5 file

    link_properties = self%make_groups
  end function link_properties

  !> Keep the first failure, which a negative status of a call tells. A file that has no name yet will not be whole, and is removed.
  subroutine check(self, status)
    class(hdf5_file_type), intent(inout) :: self  !< the HDF5 file
    integer, intent(in) :: status                 !< answer of a call of HDF5; negative: it failed

    if (status >= 0 .or. allocated(self%failure)) return
    call raise(self%failure, exit_file, "cannot write to '"//self%path//"': "//last_reason())
    call self%replacement%abandon()
  end subroutine check

  !> Keep a failure that is not one of a call, unless there was one before.
  subroutine fail(self, message)
    class(hdf5_file_type), intent(inout) :: self  !< the HDF5 file
    character(len=*), intent(in) :: message       !< error in words

    if (.not. allocated(self%failure)) call raise(self%failure, exit_file, "cannot use '"//self%path//"': "//message)
  end subroutine fail

  !> Write everything to the file: a run that is killed later leaves at least the present state.
  subroutine flush_file(self)
    class(hdf5_file_type), intent(inout) :: self  !< the HDF5 file
    integer :: status

    if (allocated(self%failure)) return
    call h5fflush_f(self%id, h5f_scope_local_f, status)
    call self%check(status)
    if (.not. allocated(self%failure)) call self%replacement%finish(self%failure)
  end subroutine flush_file

  !> Close the file and all objects open in it; a file that was never flushed is removed. Does nothing to a file that
  !> is not open.
  subroutine close_file(self)
    class(hdf5_file_type), intent(inout) :: self  !< the HDF5 file
    integer :: status

    if (.not. self%is_open()) return
    call h5tclose_f(self%text_type, status)
    call h5pclose_f(self%make_groups, status)
    call h5fclose_f(self%id, status)
    call self%check(status)
    self%id = -1
    call self%replacement%abandon()
  end subroutine close_file

  !> Write numbers as a data set.
  subroutine put_numbers(self, name, kind, extents, values, is_new)
    class(hdf5_file_type), intent(inout) :: self   !< the HDF5 file
    character(len=*), intent(in) :: name           !< path of the data set
    integer, intent(in) :: kind                    !< real_values, whole_values or long_values
    integer, intent(in) :: extents(:)              !< extents of the data set, in Fortran order; empty for a single value
    type(c_ptr), intent(in) :: values              !< address of the first value
    logical, intent(out) :: is_new                 !< the data set was made; it has no description yet

    select case (kind)
    case (real_values)
      call self%put_values(name, [h5t_ieee_f64le, h5t_native_double], extents, values, is_new)
    case (whole_values)
      call self%put_values(name, [h5t_std_i32le, h5kind_to_type(kind_of_whole, h5_integer_kind)], extents, values, is_new)
    case default
      call self%put_values(name, [h5t_std_i64le, h5kind_to_type(long, h5_integer_kind)], extents, values, is_new)
    end select
  end subroutine put_numbers

  !> Write texts as a data set.
  subroutine put_text_values(self, name, texts, extents, is_new)
    class(hdf5_file_type), intent(inout) :: self   !< the HDF5 file
    character(len=*), intent(in) :: name           !< path of the data set
    type(string_type), intent(in) :: texts(:)      !< the texts, in their order
    integer, intent(in) :: extents(:)              !< extents of the data set, in Fortran order; empty for a single value
    logical, intent(out) :: is_new                 !< the data set was made; it has no description yet
    character(kind=c_char), allocatable, target :: letters(:)
    type(c_ptr), allocatable, target :: starts(:)

    call lay_out(texts, letters, starts)
    call self%put_values(name, [self%text_type, self%text_type], extents, c_loc(starts), is_new)
  end subroutine put_text_values

  !> Write a data set of any type.
  subroutine put_values(self, name, types, extents, values, is_new)
    class(hdf5_file_type), intent(inout) :: self    !< the HDF5 file
    character(len=*), intent(in) :: name            !< path of the data set
    integer(hid_t), intent(in) :: types(2)          !< types of the values in the file and in memory
    integer, intent(in) :: extents(:)               !< extents of the data set, in Fortran order; empty for a single value
    type(c_ptr), intent(in) :: values               !< address of the first value
    logical, intent(out) :: is_new                  !< the data set was made
    integer(hid_t) :: space, data_set
    integer :: status
    logical :: exists

    is_new = .false.
    if (allocated(self%failure)) return
    ! this call fails if the group of the data set does not exist either
    call h5lexists_f(self%id, name, exists, status)
    if (exists .and. status >= 0) then
      call h5dopen_f(self%id, name, data_set, status)
      call h5dwrite_f(data_set, types(2), values, status)
      call self%check(status)
      call h5dclose_f(data_set, status)
      return
    end if
    if (size(extents) == 0) then
      call h5screate_f(h5s_scalar_f, space, status)
    else
      call h5screate_simple_f(size(extents), int(extents, hsize_t), space, status)
    end if
    call h5dcreate_f(self%id, name, types(1), space, data_set, status, lcpl_id=self%make_groups)
    call self%check(status)
    call h5sclose_f(space, status)
    if (allocated(self%failure)) return
    if (all(extents > 0)) call h5dwrite_f(data_set, types(2), values, status)
    call self%check(status)
    call h5dclose_f(data_set, status)
    is_new = .true.
  end subroutine put_values

  !> Add an attribute that is a text to a data set or group; `/` is the file itself.
  subroutine add_attribute(self, name, attribute, text)
    class(hdf5_file_type), intent(inout) :: self  !< the HDF5 file
    character(len=*), intent(in) :: name          !< path of the data set or group
    character(len=*), intent(in) :: attribute     !< name of the attribute
    character(len=*), intent(in) :: text          !< value of the attribute
    character(kind=c_char), allocatable, target :: letters(:)
    type(c_ptr), allocatable, target :: starts(:)
    type(string_type) :: texts(1)
    integer(hid_t) :: space, id
    integer :: status

    if (allocated(self%failure)) return
    texts(1)%text = text
    call lay_out(texts, letters, starts)
    call h5screate_f(h5s_scalar_f, space, status)
    call h5acreate_by_name_f(self%id, name, attribute, self%text_type, space, id, status)
    call self%check(status)
    call h5sclose_f(space, status)
    if (allocated(self%failure)) return
    call h5awrite_f(id, self%text_type, c_loc(starts), status)
    call self%check(status)
    call h5aclose_f(id, status)
  end subroutine add_attribute

  !> Convert texts to the form of C: characters with a zero after each text, and the address of each text.
  subroutine lay_out(texts, letters, starts)
    type(string_type), intent(in) :: texts(:)                               !< the texts, in their order
    character(kind=c_char), allocatable, target, intent(out) :: letters(:)  !< characters of all texts, each ended by a zero
    type(c_ptr), allocatable, target, intent(out) :: starts(:)  !< address of the first letter of each text, in `letters`
    integer :: i, k, at

    allocate (letters(sum([(len(texts(i)%text) + 1, i=1, size(texts))])))
    allocate (starts(size(texts)))
    at = 0
    do i = 1, size(texts)
      starts(i) = c_loc(letters(at + 1))
      do k = 1, len(texts(i)%text)
        letters(at + k) = texts(i)%text(k:k)
      end do
      at = at + len(texts(i)%text) + 1
      letters(at) = c_null_char
    end do
  end subroutine lay_out

  !> Make a data set of one dimension a dimension scale of the same name.
  subroutine make_scale(self, name)
    class(hdf5_file_type), intent(inout) :: self  !< the HDF5 file
    character(len=*), intent(in) :: name          !< path of the data set
    integer(hid_t) :: data_set
    integer :: status

    if (allocated(self%failure)) return
    call h5dopen_f(self%id, name, data_set, status)
    call self%check(status)
    if (allocated(self%failure)) return
    call h5dsset_scale_f(data_set, status, name(index(name, '/', back=.true.) + 1:))
    call self%check(status)
    call h5dclose_f(data_set, status)
  end subroutine make_scale

  !> Attach a scale to each dimension of a data set. A scale is not attached to others.
  subroutine attach_scales(self, name, scales)
    class(hdf5_file_type), intent(inout) :: self  !< the HDF5 file
    character(len=*), intent(in) :: name          !< path of the data set
    character(len=*), intent(in) :: scales(:)     !< paths of the scales, that of the slowest dimension first
    integer(hid_t) :: data_set, scale
    integer :: status, i

    if (allocated(self%failure)) return
    call h5dopen_f(self%id, name, data_set, status)
    call self%check(status)
    do i = 1, size(scales)
      if (allocated(self%failure)) exit
      call h5dopen_f(self%id, trim(scales(i)), scale, status)
      call self%check(status)
      if (allocated(self%failure)) exit
      ! the dimensions are in the order of C, the slowest first, but counted from 1
      call h5dsattach_scale_f(data_set, scale, i, status)
      call self%check(status)
      call h5dclose_f(scale, status)
    end do
    call h5dclose_f(data_set, status)
  end subroutine attach_scales
end module mech9_hdf5_file
