!> Data sets of one HDF5 file described, and copied, for another file.
module mech9_hdf5_copying
  use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_loc, c_f_pointer, c_null_ptr, c_null_char, c_associated
  use hdf5, only: hid_t, hsize_t, h5dopen_f, h5dclose_f, h5dget_space_f, h5sclose_f, h5sget_simple_extent_ndims_f, &
                  h5sget_simple_extent_dims_f, h5aexists_by_name_f, h5aopen_by_name_f, h5aget_type_f, h5aget_space_f, h5aread_f, &
                  h5aclose_f, &
                  h5dvlen_reclaim_f, h5p_default_f, &
                  h5tclose_f, h5tis_variable_str_f, h5pcreate_f, h5pclose_f, h5pset_copy_object_f, h5p_object_copy_f, &
                  h5o_copy_without_attr_flag_f, h5ocopy_f, h5fflush_f, h5f_scope_local_f
  use h5ds, only: h5dsis_scale_f, h5dsis_attached_f
  use mech9_text, only: string_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: has_data_set
  implicit none
  private
  public :: copy_data_sets, extents_of, scales_of, attribute_of, read_attribute

  !> Longest text of an attribute that is read [bytes].
  integer, parameter :: longest_text = 10000

contains

  !> Copy those of some data sets that a file has, with their descriptions; scales stay scales, and are attached as they were.
  subroutine copy_data_sets(from, to, names)
    type(hdf5_file_type), intent(inout) :: from   !< the open file that has them
    type(hdf5_file_type), intent(inout) :: to     !< the open file that gets them
    character(len=*), intent(in) :: names(:)      !< their paths
    type(string_type), allocatable :: scales(:)
    logical :: there(size(names))
    integer :: i

    there = [(has_data_set(from, trim(names(i))), i=1, size(names))]
    do i = 1, size(names)
      if (there(i)) call copy_one(from, to, trim(names(i)))
    end do
    do i = 1, size(names)
      if (.not. there(i) .or. allocated(to%failure)) cycle
      if (is_scale(from, trim(names(i)))) cycle
      call scales_of(from, trim(names(i)), names, scales)
      call attach(to, trim(names(i)), scales)
    end do
  end subroutine copy_data_sets

  !> Copy one data set, without its attachments.
  subroutine copy_one(from, to, name)
    type(hdf5_file_type), intent(inout) :: from   !< the open file that has it
    type(hdf5_file_type), intent(inout) :: to     !< the open file that gets it
    character(len=*), intent(in) :: name          !< its path
    integer(hid_t) :: properties
    integer :: status

    if (allocated(to%failure)) return
    ! HDF5 1.10 crashes within the copy where what is waiting to be written does not fit on the disk
    call h5fflush_f(to%id, h5f_scope_local_f, status)
    call to%check(status)
    if (allocated(to%failure)) return
    call h5pcreate_f(h5p_object_copy_f, properties, status)
    call h5pset_copy_object_f(properties, h5o_copy_without_attr_flag_f, status)
    call h5ocopy_f(from%id, name, to%id, name, status, ocpypl_id=properties, lcpl_id=to%link_properties())
    call to%check(status)
    call h5pclose_f(properties, status)
    if (attribute_of(from, name, 'units') /= '') then
      call to%describe(name, attribute_of(from, name, 'long_name'), attribute_of(from, name, 'units'))
    else
      call to%describe(name, attribute_of(from, name, 'long_name'))
    end if
    if (is_scale(from, name)) call to%make_scale(name)
  end subroutine copy_one

  !> Attach scales to the dimensions of a data set.
  subroutine attach(file, name, scales)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    character(len=*), intent(in) :: name          !< path of the data set
    type(string_type), intent(in) :: scales(:)    !< paths of the scales, that of the slowest dimension first
    character(len=64) :: paths(size(scales))
    integer :: i

    do i = 1, size(scales)
      paths(i) = scales(i)%text
    end do
    if (size(paths) > 0) call file%attach_scales(name, paths)
  end subroutine attach

  !> Whether a data set is a scale.
  logical function is_scale(file, name)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    character(len=*), intent(in) :: name          !< path of the data set
    integer(hid_t) :: data_set
    integer :: status

    is_scale = .false.
    call h5dopen_f(file%id, name, data_set, status)
    call file%check(status)
    if (status < 0) return
    call h5dsis_scale_f(data_set, is_scale, status)
    call h5dclose_f(data_set, status)
  end function is_scale

  !> The scales of a data set, that of the slowest dimension first. It is a failure of the file where a dimension has none.
  subroutine scales_of(file, name, names, scales)
    type(hdf5_file_type), intent(inout) :: file               !< the open file
    character(len=*), intent(in) :: name                      !< path of the data set
    character(len=*), intent(in) :: names(:)                  !< paths of all data sets that may be its scales
    type(string_type), allocatable, intent(out) :: scales(:)  !< (dimensions) their paths
    integer, allocatable :: extents(:)
    integer(hid_t) :: data_set, scale
    integer :: status, i, k
    logical :: attached

    allocate (scales(0))
    call extents_of(file, name, extents)
    if (allocated(file%failure)) return
    deallocate (scales)
    allocate (scales(size(extents)))
    call h5dopen_f(file%id, name, data_set, status)
    do i = 1, size(scales)
      do k = 1, size(names)
        if (.not. has_data_set(file, trim(names(k)))) cycle
        if (.not. is_scale(file, trim(names(k)))) cycle
        call h5dopen_f(file%id, trim(names(k)), scale, status)
        call h5dsis_attached_f(data_set, scale, i, attached, status)
        if (status >= 0 .and. attached) scales(i)%text = '/'//trim(names(k))
        call h5dclose_f(scale, status)
      end do
      if (.not. allocated(scales(i)%text)) call file%fail("a dimension of data set '"//name//"' has no scale")
    end do
    call h5dclose_f(data_set, status)
    if (.not. allocated(file%failure)) return
    deallocate (scales)
    allocate (scales(0))
  end subroutine scales_of

  !> The extents of a data set, in Fortran order. It is a failure of the file where there is none.
  subroutine extents_of(file, name, extents)
    type(hdf5_file_type), intent(inout) :: file                   !< the open file
    character(len=*), intent(in) :: name                          !< path of the data set
    integer, allocatable, intent(out) :: extents(:)               !< fastest dimension first; none where it cannot be read
    integer(hsize_t), allocatable :: present(:), most(:)
    integer(hid_t) :: data_set, space
    integer :: status, rank

    allocate (extents(0))
    if (allocated(file%failure)) return
    if (.not. has_data_set(file, name)) then
      call file%fail("it has no data set '"//name//"'")
      return
    end if
    call h5dopen_f(file%id, name, data_set, status)
    call file%check(status)
    if (status < 0) return
    call h5dget_space_f(data_set, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    allocate (present(rank), most(rank))
    if (rank > 0) call h5sget_simple_extent_dims_f(space, present, most, status)
    extents = int(present)
    call h5sclose_f(space, status)
    call h5dclose_f(data_set, status)
  end subroutine extents_of

  !> Read an attribute of a data set that is a text; it is empty where there is none.
  subroutine read_attribute(file, name, attribute, text)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    character(len=*), intent(in) :: name          !< path of the data set
    character(len=*), intent(in) :: attribute     !< name of the attribute
    character(len=:), allocatable, intent(out) :: text   !< its text
    type(c_ptr), target :: addresses(1)
    type(c_ptr) :: place
    character(kind=c_char), pointer :: letters(:)
    integer(hid_t) :: id, text_type, space
    integer :: status, length
    logical :: sound

    text = ''
    call h5aexists_by_name_f(file%id, name, attribute, sound, status)
    if (status < 0 .or. .not. sound) return
    call h5aopen_by_name_f(file%id, name, attribute, id, status)
    if (status < 0) return
    call h5aget_type_f(id, text_type, status)
    call h5tis_variable_str_f(text_type, sound, status)
    addresses = c_null_ptr
    place = c_loc(addresses)
    if (sound .and. status >= 0) call h5aread_f(id, text_type, place, status)
    if (c_associated(addresses(1))) then
      call c_f_pointer(addresses(1), letters, [longest_text])
      do length = 0, longest_text - 1
        if (letters(length + 1) == c_null_char) exit
        text = text//letters(length + 1)
      end do
      call h5aget_space_f(id, space, status)
      call h5dvlen_reclaim_f(text_type, space, h5p_default_f, place, status)
      call h5sclose_f(space, status)
    end if
    call h5tclose_f(text_type, status)
    call h5aclose_f(id, status)
  end subroutine read_attribute

  !> The text of an attribute, as read_attribute reads it.
  function attribute_of(file, name, attribute) result(text)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    character(len=*), intent(in) :: name          !< path of the data set
    character(len=*), intent(in) :: attribute     !< name of the attribute
    character(len=:), allocatable :: text

    call read_attribute(file, name, attribute, text)
  end function attribute_of
end module mech9_hdf5_copying
