!> Data sets as a table in memory, for who writes a file of their own: paths, kinds, extents, descriptions, scales.
!>
!> Data sets over the outputs of a run have no values here: these stand in the rows of the run, and the table knows their columns.
module mech9_data_set_table
  use, intrinsic :: iso_c_binding, only: c_ptr, c_f_pointer
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type
  use mech9_data_set_store, only: data_set_store_type, real_values, whole_values, text_values
  use mech9_column_sets, only: column_set_type, column_set_list_type
  implicit none
  private
  public :: data_set_table_type, data_set_type, attribute_type

  !> A data set.
  type :: data_set_type
    character(len=:), allocatable :: path         !< without a slash at its beginning
    integer :: kind = real_values                 !< of its values: real_values, whole_values, long_values or text_values
    integer, allocatable :: extents(:)            !< in Fortran order; of one over the outputs of a run without these
    real(wp), allocatable :: numbers(:)           !< its values, if they are real
    integer(long), allocatable :: wholes(:)       !< its values, if they are whole
    type(string_type), allocatable :: texts(:)    !< its values, if they are texts
    integer, allocatable :: columns(:)            !< its columns in the rows of the run; not allocated: it has values
    integer :: chunk_rows = 0                     !< of a chunk, if it can grow along its slowest dimension; 0: it cannot
    integer :: compression = 0                    !< from 0, none, to 9, the most
    logical :: is_scale = .false.
    type(string_type), allocatable :: scales(:)   !< paths of the scales, that of the slowest dimension first; not allocated: none
  end type data_set_type

  !> A text that describes a data set or a group.
  type :: attribute_type
    character(len=:), allocatable :: path         !< of the data set or group, without a slash at its beginning; empty: of the file
    character(len=:), allocatable :: name
    character(len=:), allocatable :: text
  end type attribute_type

  type, extends(data_set_store_type) :: data_set_table_type
    type(data_set_type), allocatable :: sets(:)
    type(attribute_type), allocatable :: attributes(:)
    integer :: count = 0                          !< how many data sets there are
    integer :: attribute_count = 0                !< how many attributes there are
  contains
    procedure :: put_numbers
    procedure :: put_text_values
    procedure :: add_attribute
    procedure :: make_scale
    procedure :: attach_scales
    procedure :: add_columns
    procedure :: add_rows
    procedure, private :: find
    procedure, private :: find_or_add
  end type data_set_table_type

contains

  !> Take numbers as a data set.
  subroutine put_numbers(self, name, kind, extents, values, is_new)
    class(data_set_table_type), intent(inout) :: self   !< the table
    character(len=*), intent(in) :: name                !< path of the data set
    integer, intent(in) :: kind                         !< real_values, whole_values or long_values
    integer, intent(in) :: extents(:)                   !< extents of the data set, in Fortran order; empty for a single value
    type(c_ptr), intent(in) :: values                   !< address of the first value
    logical, intent(out) :: is_new                      !< the data set was made; it has no description yet
    real(wp), pointer :: numbers(:)
    integer, pointer :: wholes(:)
    integer(long), pointer :: longs(:)
    integer :: i

    call self%find_or_add(name, kind, extents, i, is_new)
    associate (set => self%sets(i), n => product(extents))
      if (kind == real_values) then
        call c_f_pointer(values, numbers, [n])
        set%numbers = numbers
      else if (kind == whole_values) then
        call c_f_pointer(values, wholes, [n])
        set%wholes = int(wholes, long)
      else
        call c_f_pointer(values, longs, [n])
        set%wholes = longs
      end if
    end associate
  end subroutine put_numbers

  !> Take texts as a data set.
  subroutine put_text_values(self, name, texts, extents, is_new)
    class(data_set_table_type), intent(inout) :: self   !< the table
    character(len=*), intent(in) :: name                !< path of the data set
    type(string_type), intent(in) :: texts(:)           !< the texts, in their order
    integer, intent(in) :: extents(:)                   !< extents of the data set, in Fortran order; empty for a single value
    logical, intent(out) :: is_new                      !< the data set was made; it has no description yet
    integer :: i

    call self%find_or_add(name, text_values, extents, i, is_new)
    self%sets(i)%texts = texts
  end subroutine put_text_values

  !> Add an attribute that is a text to a data set or group; `/` is the file itself.
  subroutine add_attribute(self, name, attribute, text)
    class(data_set_table_type), intent(inout) :: self   !< the table
    character(len=*), intent(in) :: name                !< path of the data set or group
    character(len=*), intent(in) :: attribute           !< name of the attribute
    character(len=*), intent(in) :: text                !< value of the attribute
    type(attribute_type), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(self%attributes)) allocate (self%attributes(128))
    if (self%attribute_count == size(self%attributes)) then
      allocate (grown(2*self%attribute_count))
      do i = 1, self%attribute_count
        call move_alloc(self%attributes(i)%path, grown(i)%path)
        call move_alloc(self%attributes(i)%name, grown(i)%name)
        call move_alloc(self%attributes(i)%text, grown(i)%text)
      end do
      call move_alloc(grown, self%attributes)
    end if
    self%attribute_count = self%attribute_count + 1
    associate (added => self%attributes(self%attribute_count))
      added%path = name(first_letter(name):)
      added%name = attribute
      added%text = text
    end associate
  end subroutine add_attribute

  !> Make a data set a dimension scale.
  subroutine make_scale(self, name)
    class(data_set_table_type), intent(inout) :: self   !< the table
    character(len=*), intent(in) :: name                !< path of the data set
    integer :: i

    i = self%find(name)
    if (i > 0) self%sets(i)%is_scale = .true.
  end subroutine make_scale

  !> Attach a scale to each dimension of a data set.
  subroutine attach_scales(self, name, scales)
    class(data_set_table_type), intent(inout) :: self   !< the table
    character(len=*), intent(in) :: name                !< path of the data set
    character(len=*), intent(in) :: scales(:)           !< paths of the scales, that of the slowest dimension first
    integer :: i, k

    i = self%find(name)
    if (i == 0) return
    associate (set => self%sets(i))
      if (allocated(set%scales)) deallocate (set%scales)
      allocate (set%scales(size(scales)))
      do k = 1, size(scales)
        set%scales(k)%text = trim(scales(k)(first_letter(scales(k)):))
      end do
    end associate
  end subroutine attach_scales

  !> Add data sets over the outputs of a run, whose values stand in its rows.
  subroutine add_columns(self, list, chunk_rows, compression)
    class(data_set_table_type), intent(inout) :: self   !< the table
    type(column_set_list_type), intent(in) :: list      !< the data sets
    integer, intent(in) :: chunk_rows                   !< rows of a chunk
    integer, intent(in) :: compression                  !< from 0, none, to 9, the most
    integer :: i, at

    do i = 1, list%count
      call add_one(self, list%sets(i), list%sets(i)%extents, chunk_rows, at)
      self%sets(at)%columns = list%sets(i)%columns
      self%sets(at)%compression = compression
    end do
  end subroutine add_columns

  !> Add data sets over rows that are known, and that could be more.
  subroutine add_rows(self, list, rows, chunk_rows)
    class(data_set_table_type), intent(inout) :: self   !< the table
    type(column_set_list_type), intent(in) :: list      !< the data sets
    real(wp), intent(in) :: rows(:, :)                  !< (columns, rows) their values
    integer, intent(in) :: chunk_rows                   !< rows of a chunk
    integer :: i, at

    do i = 1, list%count
      associate (set => list%sets(i))
        call add_one(self, set, [set%extents, size(rows, 2)], chunk_rows, at)
        if (set%whole) then
          self%sets(at)%wholes = nint(reshape(rows(set%columns, :), [size(set%columns)*size(rows, 2)]), long)
        else
          self%sets(at)%numbers = reshape(rows(set%columns, :), [size(set%columns)*size(rows, 2)])
        end if
      end associate
    end do
  end subroutine add_rows

  !> Add a data set over rows with its description.
  subroutine add_one(self, set, extents, chunk_rows, at)
    class(data_set_table_type), intent(inout) :: self   !< the table
    type(column_set_type), intent(in) :: set            !< the data set
    integer, intent(in) :: extents(:)                   !< in Fortran order
    integer, intent(in) :: chunk_rows                   !< rows of a chunk
    integer, intent(out) :: at                          !< its place in the table
    logical :: is_new

    call self%find_or_add(set%name, merge(whole_values, real_values, set%whole), extents, at, is_new)
    self%sets(at)%chunk_rows = chunk_rows
    if (is_new) call set%describe_in(self)
  end subroutine add_one

  !> Place of a data set in the table; 0 where there is none.
  pure integer function find(self, name)
    class(data_set_table_type), intent(in) :: self      !< the table
    character(len=*), intent(in) :: name                !< path of the data set

    do find = self%count, 1, -1
      if (self%sets(find)%path == name(first_letter(name):)) return
    end do
  end function find

  !> Find a data set, or add one without values. The table grows in a loop: an array constructor would leak (gfortran 12).
  subroutine find_or_add(self, name, kind, extents, i, is_new)
    class(data_set_table_type), intent(inout) :: self   !< the table
    character(len=*), intent(in) :: name                !< path of the data set
    integer, intent(in) :: kind                         !< of its values
    integer, intent(in) :: extents(:)                   !< in Fortran order
    integer, intent(out) :: i                           !< its place in the table
    logical, intent(out) :: is_new                      !< it was added
    type(data_set_type), allocatable :: grown(:)
    integer :: k

    if (.not. allocated(self%sets)) allocate (self%sets(64))
    i = self%find(name)
    is_new = i == 0
    if (.not. is_new) return
    if (self%count == size(self%sets)) then
      allocate (grown(2*self%count))
      do k = 1, self%count
        grown(k) = self%sets(k)
      end do
      call move_alloc(grown, self%sets)
    end if
    self%count = self%count + 1
    i = self%count
    self%sets(i)%path = name(first_letter(name):)
    self%sets(i)%kind = kind
    self%sets(i)%extents = extents
  end subroutine find_or_add

  !> Number of the first letter of a path behind a slash at its beginning.
  pure integer function first_letter(path)
    character(len=*), intent(in) :: path   !< the path

    first_letter = 1
    if (index(path, '/') == 1) first_letter = 2
  end function first_letter
end module mech9_data_set_table
