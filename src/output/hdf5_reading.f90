!> HDF5 files that are there: opened for reading, or for numbers to be written into their data sets.
module mech9_hdf5_reading
  use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_loc, c_null_ptr, c_null_char, c_associated, c_f_pointer
  use hdf5, only: hid_t, hsize_t, size_t, h5open_f, h5dont_atexit_f, h5eset_auto_f, h5fopen_f, h5f_acc_rdonly_f, h5f_acc_rdwr_f, &
                  h5f_close_strong_f, h5pcreate_f, h5pclose_f, h5pset_fclose_degree_f, h5pset_sieve_buf_size_f, &
                  h5p_file_access_f, h5p_default_f, h5lexists_f, h5dopen_f, h5dclose_f, h5dread_f, h5dget_space_f, h5dget_type_f, &
                  h5tget_class_f, h5tis_variable_str_f, h5tclose_f, h5t_string_f, h5sclose_f, h5sget_simple_extent_npoints_f, &
                  h5dvlen_reclaim_f, h5kind_to_type, h5_integer_kind
  use mech9_error, only: error_type, raise, exit_file
  use mech9_text, only: string_type
  use mech9_same_file, only: file_place_type, find_place, is_regular
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reason, only: last_reason
  implicit none
  private
  public :: open_existing, read_text, read_texts, read_integer, has_data_set

  !> Longest text that is read [bytes].
  integer, parameter :: longest_text = 100000000
  !> Most texts that are read together.
  integer, parameter :: most_texts = 1000000

contains

  !> Open a file that is there. Nothing in it changes before numbers are written. Fails with exit_file.
  subroutine open_existing(path, writable, file, err)
    character(len=*), intent(in) :: path                !< of the file
    logical, intent(in) :: writable                     !< numbers are going to be written
    type(hdf5_file_type), intent(out) :: file           !< the open file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(file_place_type) :: place
    integer(hid_t) :: access
    integer :: status

    file%path = path
    call find_place(path, place)
    if (.not. place%exists) then
      call raise(err, exit_file, "cannot open '"//path//"': there is no such file")
      return
    else if (.not. is_regular(place)) then
      call raise(err, exit_file, "cannot open '"//path//"': it is not a file of HDF5")
      return
    end if
    call h5dont_atexit_f(status)
    call h5open_f(status)
    call h5eset_auto_f(0, status)
    call h5pcreate_f(h5p_file_access_f, access, status)
    call h5pset_fclose_degree_f(access, h5f_close_strong_f, status)
    call h5pset_sieve_buf_size_f(access, 0_size_t, status)
    call h5fopen_f(path, merge(h5f_acc_rdwr_f, h5f_acc_rdonly_f, writable), file%id, status, access_prp=access)
    if (status < 0) then
      file%id = -1
      call raise(err, exit_file, "cannot open '"//path//"' as a file of HDF5: "//last_reason())
    end if
    call h5pclose_f(access, status)
  end subroutine open_existing

  !> Whether a file has a data set, or a group, of this path.
  logical function has_data_set(file, name) result(has)
    type(hdf5_file_type), intent(in) :: file   !< the open file
    character(len=*), intent(in) :: name       !< path of the data set
    integer :: slash, status

    ! the groups of the path must be there before the path itself may be asked for
    slash = 0
    do
      if (index(name(slash + 1:), '/') == 0) exit
      slash = slash + index(name(slash + 1:), '/')
      call h5lexists_f(file%id, name(:slash - 1), has, status)
      if (status < 0) has = .false.
      if (.not. has) return
    end do
    call h5lexists_f(file%id, name, has, status)
    if (status < 0) has = .false.
  end function has_data_set

  !> Read a data set that is one text. It is a failure of the file where there is none.
  subroutine read_text(file, name, text)
    type(hdf5_file_type), intent(inout) :: file                !< the open file
    character(len=*), intent(in) :: name                       !< path of the data set
    character(len=:), allocatable, intent(out) :: text         !< its text
    type(string_type), allocatable :: texts(:)

    text = ''
    call read_texts(file, name, texts)
    if (allocated(file%failure)) return
    if (size(texts) == 1) then
      text = texts(1)%text
    else
      call file%fail("data set '"//name//"' is not one text")
    end if
  end subroutine read_text

  !> Read a data set of texts. It is a failure of the file where there is none.
  subroutine read_texts(file, name, texts)
    type(hdf5_file_type), intent(inout) :: file                     !< the open file
    character(len=*), intent(in) :: name                            !< path of the data set
    type(string_type), allocatable, intent(out) :: texts(:)         !< its texts
    integer(hid_t) :: data_set, data_type, space
    type(c_ptr), allocatable, target :: addresses(:)
    type(c_ptr) :: place
    integer(hsize_t) :: points
    integer :: status, class, i
    logical :: sound

    allocate (texts(0))
    call open_data_set(file, name, data_set)
    if (allocated(file%failure)) return
    call h5dget_type_f(data_set, data_type, status)
    call h5dget_space_f(data_set, space, status)
    call h5tget_class_f(data_type, class, status)
    call h5sget_simple_extent_npoints_f(space, points, status)
    sound = class == h5t_string_f .and. points >= 0 .and. points <= most_texts
    if (sound) call h5tis_variable_str_f(data_type, sound, status)
    if (sound .and. points > 0) then
      allocate (addresses(points))
      addresses = c_null_ptr
      place = c_loc(addresses)
      call h5dread_f(data_set, data_type, place, status)
      call file%check(status)
      if (status >= 0) then
        deallocate (texts)
        allocate (texts(points))
        do i = 1, size(texts)
          call take_letters(addresses(i), texts(i)%text)
        end do
        call h5dvlen_reclaim_f(data_type, space, h5p_default_f, place, status)
      end if
    else if (.not. sound) then
      call file%fail("data set '"//name//"' is not a text")
    end if
    call h5sclose_f(space, status)
    call h5tclose_f(data_type, status)
    call h5dclose_f(data_set, status)
  end subroutine read_texts

  !> A text from its letters in memory, which end with a byte of zero.
  subroutine take_letters(address, text)
    type(c_ptr), intent(in) :: address                   !< of the first letter; null for an empty text
    character(len=:), allocatable, intent(out) :: text   !< the text
    character(kind=c_char), pointer :: letters(:)
    integer :: length, i

    text = ''
    if (.not. c_associated(address)) return
    call c_f_pointer(address, letters, [longest_text])
    length = 0
    do while (letters(length + 1) /= c_null_char)
      length = length + 1
      if (length == longest_text) exit
    end do
    deallocate (text)
    allocate (character(len=length) :: text)
    do i = 1, length
      text(i:i) = letters(i)
    end do
  end subroutine take_letters

  !> Read a data set that is one whole number. It is a failure of the file where there is none.
  subroutine read_integer(file, name, value)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    character(len=*), intent(in) :: name          !< path of the data set
    integer, intent(out) :: value                 !< its number; 0 where it cannot be read
    integer, target :: numbers(1)
    type(c_ptr) :: place
    integer(hid_t) :: data_set, space
    integer(hsize_t) :: points
    integer :: status

    value = 0
    call open_data_set(file, name, data_set)
    if (allocated(file%failure)) return
    call h5dget_space_f(data_set, space, status)
    call h5sget_simple_extent_npoints_f(space, points, status)
    call h5sclose_f(space, status)
    if (points == 1) then
      place = c_loc(numbers)
      call h5dread_f(data_set, h5kind_to_type(kind(value), h5_integer_kind), place, status)
      call file%check(status)
      if (status >= 0) value = numbers(1)
    else
      call file%fail("data set '"//name//"' is not one number")
    end if
    call h5dclose_f(data_set, status)
  end subroutine read_integer

  !> Open a data set. It is a failure of the file where there is none.
  subroutine open_data_set(file, name, data_set)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    character(len=*), intent(in) :: name          !< path of the data set
    integer(hid_t), intent(out) :: data_set       !< its handle
    integer :: status

    data_set = -1
    if (allocated(file%failure)) return
    if (.not. has_data_set(file, name)) then
      call file%fail("it has no data set '"//name//"'")
      return
    end if
    call h5dopen_f(file%id, name, data_set, status)
    call file%check(status)
  end subroutine open_data_set
end module mech9_hdf5_reading
