!> The HDF5 file of a run for C: its data sets and attributes as a table, for who writes the file (include/mech9.h).
module mech9_api_data_sets
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_int32_t, c_int64_t, c_ptr, c_null_ptr, c_f_pointer
  use mech9_data_set_store, only: real_values, whole_values, long_values, text_values
  use mech9_data_set_table, only: data_set_type
  use mech9_api_error, only: begin_call, end_call, refuse
  use mech9, only: error_type, mechanism_type
  use mech9_api_mechanism, only: find_mechanism
  use mech9_api_results, only: results_type, find_results
  implicit none
  private
  public :: data_sets

contains

  !> Make the table of the data sets of a run. Nothing is done where there is one.
  integer(c_int) function lay_out(address, mechanism, error) bind(c, name='mech9_results_lay_out') result(code)
    type(c_ptr), value, intent(in) :: address     !< of the results
    type(c_ptr), value, intent(in) :: mechanism   !< of the run, as it was then; its text becomes one of the data sets
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(results_type), pointer :: results
    type(mechanism_type), pointer :: moved
    type(error_type), allocatable :: err

    call begin_call(error)
    call find_results(address, results)
    call find_mechanism(mechanism, moved, err)
    if (.not. associated(results)) then
      call refuse('these are no results', err)
    else if (.not. associated(results%run)) then
      call refuse('only the results of kinematics and dynamics can be written', err)
    else if (.not. allocated(err) .and. results%layout%count == 0) then
      call results%run%lay_out(moved, results%layout)
    end if
    code = end_call(error, err)
  end function lay_out

  !> Number of data sets; 0 where there is no table.
  integer(c_int) function data_sets(address) bind(c, name='mech9_results_data_sets')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    data_sets = 0
    call find_results(address, results)
    if (associated(results)) data_sets = results%layout%count
  end function data_sets

  !> Path of a data set; null where there is none.
  type(c_ptr) function path_of(address, i) bind(c, name='mech9_results_data_set_path')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    path_of = c_null_ptr
    call find_set(address, i, results, set)
    if (associated(set)) path_of = shown(results, set%path)
  end function path_of

  !> Kind of the values of a data set: 1 double, 2 int32_t, 3 int64_t, 4 texts; 0 where there is none.
  integer(c_int) function kind_of(address, i) bind(c, name='mech9_results_data_set_kind')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    kind_of = 0
    call find_set(address, i, results, set)
    if (associated(set)) kind_of = set%kind
  end function kind_of

  !> Number of the dimensions of a data set; 0: it is a single value.
  integer(c_int) function rank_of(address, i) bind(c, name='mech9_results_data_set_rank')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    rank_of = 0
    call find_set(address, i, results, set)
    if (associated(set)) rank_of = dimensions(set)
  end function rank_of

  !> Extent of a data set in a dimension, the slowest one first; 0 where there is none.
  integer(c_int) function extent_of(address, i, dimension) bind(c, name='mech9_results_data_set_extent')
    type(c_ptr), value, intent(in) :: address          !< of the results
    integer(c_int), value, intent(in) :: i             !< position of the data set, from 0
    integer(c_int), value, intent(in) :: dimension     !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set
    integer :: place

    extent_of = 0
    call find_set(address, i, results, set)
    if (.not. associated(set)) return
    if (dimension < 0 .or. dimension >= dimensions(set)) return
    place = dimensions(set) - dimension
    if (place > size(set%extents)) then
      extent_of = results%count
    else
      extent_of = set%extents(place)
    end if
  end function extent_of

  !> Rows of a chunk of a data set that can grow along its slowest dimension; 0: it cannot.
  integer(c_int) function chunk_of(address, i) bind(c, name='mech9_results_data_set_chunk')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    chunk_of = 0
    call find_set(address, i, results, set)
    if (associated(set)) chunk_of = set%chunk_rows
  end function chunk_of

  !> Compression of a data set, from 0, none, to 9, the most.
  integer(c_int) function compression_of(address, i) bind(c, name='mech9_results_data_set_compression')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    compression_of = 0
    call find_set(address, i, results, set)
    if (associated(set)) compression_of = set%compression
  end function compression_of

  !> Whether a data set is a dimension scale.
  integer(c_int) function is_scale(address, i) bind(c, name='mech9_results_data_set_is_scale')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    is_scale = 0
    call find_set(address, i, results, set)
    if (associated(set)) is_scale = merge(1_c_int, 0_c_int, set%is_scale)
  end function is_scale

  !> Path of the scale of a dimension, the slowest one first; null where it has none.
  type(c_ptr) function scale_of(address, i, dimension) bind(c, name='mech9_results_data_set_scale')
    type(c_ptr), value, intent(in) :: address          !< of the results
    integer(c_int), value, intent(in) :: i             !< position of the data set, from 0
    integer(c_int), value, intent(in) :: dimension     !< its position, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    scale_of = c_null_ptr
    call find_set(address, i, results, set)
    if (.not. associated(set)) return
    if (.not. allocated(set%scales)) return
    if (dimension >= 0 .and. dimension < size(set%scales)) scale_of = shown(results, set%scales(dimension + 1)%text)
  end function scale_of

  !> A text of a data set of texts; null where there is none.
  type(c_ptr) function text_of(address, i, k) bind(c, name='mech9_results_data_set_text')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< position of the data set, from 0
    integer(c_int), value, intent(in) :: k       !< position of the text, from 0
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set

    text_of = c_null_ptr
    call find_set(address, i, results, set)
    if (.not. associated(set)) return
    if (.not. allocated(set%texts)) return
    if (k >= 0 .and. k < size(set%texts)) text_of = shown(results, set%texts(k + 1)%text)
  end function text_of

  !> Take numbers of a data set: all of some rows, which are the steps of its slowest dimension.
  integer(c_int) function take(address, i, first, n, numbers, error) bind(c, name='mech9_results_data_set_take') result(code)
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< position of the data set, from 0
    integer(c_int), value, intent(in) :: first   !< position of the first row, from 0
    integer(c_int), value, intent(in) :: n       !< how many rows; of a single value 1
    type(c_ptr), value, intent(in) :: numbers    !< address of room for them, in the kind of the data set
    type(c_ptr), value, intent(in) :: error      !< handle of errors, or null
    type(results_type), pointer :: results
    type(data_set_type), pointer :: set
    type(error_type), allocatable :: err
    integer :: rows, each

    call begin_call(error)
    call find_set(address, i, results, set)
    if (.not. associated(set)) then
      call refuse('there is no such data set', err)
    else if (set%kind == text_values) then
      call refuse('this data set has texts', err)
    else
      rows = 1
      if (dimensions(set) > 0) rows = extent_of(address, i, 0_c_int)
      if (first < 0 .or. n < 0 .or. first > rows - n) call refuse('the data set has no such rows', err)
    end if
    if (.not. allocated(err) .and. n > 0) then
      each = product(set%extents)
      if (allocated(set%columns)) then
        call gather(results, set, first, n, each, numbers)
      else
        each = each/max(1, rows)
        call copy(set, first*each, n*each, numbers)
      end if
    end if
    code = end_call(error, err)
  end function take

  !> Copy numbers of a data set that has values.
  subroutine copy(set, before, n, numbers)
    type(data_set_type), intent(in) :: set     !< the data set
    integer, intent(in) :: before              !< how many numbers stand before those that are wanted
    integer, intent(in) :: n                   !< how many
    type(c_ptr), intent(in) :: numbers         !< address of room for them
    real(c_double), pointer :: reals(:)
    integer(c_int32_t), pointer :: wholes(:)
    integer(c_int64_t), pointer :: longs(:)

    select case (set%kind)
    case (real_values)
      call c_f_pointer(numbers, reals, [n])
      reals = set%numbers(before + 1:before + n)
    case (whole_values)
      call c_f_pointer(numbers, wholes, [n])
      wholes = int(set%wholes(before + 1:before + n), c_int32_t)
    case (long_values)
      call c_f_pointer(numbers, longs, [n])
      longs = set%wholes(before + 1:before + n)
    end select
  end subroutine copy

  !> Gather numbers of a data set over the outputs from the rows of the run.
  subroutine gather(results, set, first, n, each, numbers)
    type(results_type), intent(in) :: results   !< with the rows
    type(data_set_type), intent(in) :: set      !< the data set
    integer, intent(in) :: first                !< position of the first row, from 0
    integer, intent(in) :: n                    !< how many rows
    integer, intent(in) :: each                 !< numbers in a row
    type(c_ptr), intent(in) :: numbers          !< address of room for them
    real(c_double), pointer :: reals(:, :)
    integer :: i, k, width

    call c_f_pointer(numbers, reals, [each, n])
    width = size(results%rows, 1)
    do i = 1, n
      do k = 1, each
        if (set%columns(k) <= width) then
          reals(k, i) = results%rows(set%columns(k), first + i)
        else
          reals(k, i) = results%poses(set%columns(k) - width, first + i)
        end if
      end do
    end do
  end subroutine gather

  !> Number of attributes: texts that describe data sets and groups.
  integer(c_int) function attributes(address) bind(c, name='mech9_results_attributes')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    attributes = 0
    call find_results(address, results)
    if (associated(results)) attributes = results%layout%attribute_count
  end function attributes

  !> Path of the data set or group that an attribute describes, empty for the file; null where there is no such attribute.
  type(c_ptr) function attribute_path(address, i) bind(c, name='mech9_results_attribute_path')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results

    attribute_path = c_null_ptr
    call find_results(address, results)
    if (has_attribute(results, i)) attribute_path = shown(results, results%layout%attributes(i + 1)%path)
  end function attribute_path

  !> Name of an attribute; null where there is none.
  type(c_ptr) function attribute_name(address, i) bind(c, name='mech9_results_attribute_name')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results

    attribute_name = c_null_ptr
    call find_results(address, results)
    if (has_attribute(results, i)) attribute_name = shown(results, results%layout%attributes(i + 1)%name)
  end function attribute_name

  !> Text of an attribute; null where there is none.
  type(c_ptr) function attribute_text(address, i) bind(c, name='mech9_results_attribute_text')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results

    attribute_text = c_null_ptr
    call find_results(address, results)
    if (has_attribute(results, i)) attribute_text = shown(results, results%layout%attributes(i + 1)%text)
  end function attribute_text

  !> Whether there is an attribute.
  pure logical function has_attribute(results, i)
    type(results_type), pointer, intent(in) :: results   !< the results, or null
    integer(c_int), intent(in) :: i                      !< its position, from 0

    has_attribute = .false.
    if (associated(results)) has_attribute = i >= 0 .and. i < results%layout%attribute_count
  end function has_attribute

  !> One of the data sets of results; null where there is none.
  subroutine find_set(address, i, results, set)
    type(c_ptr), intent(in) :: address                       !< of the results
    integer(c_int), intent(in) :: i                          !< its position, from 0
    type(results_type), pointer, intent(out) :: results      !< the results
    type(data_set_type), pointer, intent(out) :: set         !< the data set

    set => null()
    call find_results(address, results)
    if (.not. associated(results)) return
    if (i >= 0 .and. i < results%layout%count) set => results%layout%sets(i + 1)
  end subroutine find_set

  !> Number of the dimensions of a data set, with that of the outputs.
  pure integer function dimensions(set)
    type(data_set_type), intent(in) :: set   !< the data set

    dimensions = size(set%extents)
    if (allocated(set%columns)) dimensions = dimensions + 1
  end function dimensions

  !> Address of a text, which holds until the next one is asked for.
  type(c_ptr) function shown(results, text)
    type(results_type), pointer, intent(in) :: results   !< keep the text
    character(len=*), intent(in) :: text                 !< the text

    call results%shown%put(text)
    shown = results%shown%address()
  end function shown
end module mech9_api_data_sets
