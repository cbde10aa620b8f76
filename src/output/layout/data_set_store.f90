!> Storage of data sets: the interface of everything that takes named numbers and texts with their descriptions and the scales of
!> their dimensions, as an HDF5 file does.
!>
!> Names are paths. A failure is one of the storage: it is kept there, and later calls do nothing.
module mech9_data_set_store
  use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type
  implicit none
  private
  public :: data_set_store_type, real_values, whole_values, long_values, text_values

  !> Kinds of the values of data sets: numbers of 64 bits, whole numbers of 32 and of 64 bits, texts.
  integer, parameter :: real_values = 1, whole_values = 2, long_values = 3, text_values = 4

  !> Extents of a data set that is a single value.
  integer, parameter :: no_extents(0) = [integer ::]

  !> Storage that is open.
  type, abstract :: data_set_store_type
  contains
    !> A data set with its values: put(name, values, long_name [, unit]). One that exists already gets the new values.
    generic :: put => put_text, put_texts, put_real, put_reals, put_matrix, put_block, put_integer, put_integers, &
      put_integer_matrix, put_long
    procedure :: describe
    procedure(numbers_interface), deferred :: put_numbers
    procedure(texts_interface), deferred :: put_text_values
    procedure(attribute_interface), deferred :: add_attribute
    procedure(scale_interface), deferred :: make_scale
    procedure(scales_interface), deferred :: attach_scales
    procedure, private :: put_text, put_texts, put_real, put_reals, put_matrix, put_block, put_integer, put_integers, &
      put_integer_matrix, put_long, put_described
  end type data_set_store_type

  abstract interface
    !> Write numbers as a data set.
    subroutine numbers_interface(self, name, kind, extents, values, is_new)
      import :: data_set_store_type, c_ptr
      class(data_set_store_type), intent(inout) :: self   !< the storage
      character(len=*), intent(in) :: name                !< path of the data set
      integer, intent(in) :: kind                         !< real_values, whole_values or long_values
      integer, intent(in) :: extents(:)                   !< extents of the data set, in Fortran order; empty for a single value
      type(c_ptr), intent(in) :: values                   !< address of the first value
      logical, intent(out) :: is_new                      !< the data set was made; it has no description yet
    end subroutine numbers_interface

    !> Write texts as a data set.
    subroutine texts_interface(self, name, texts, extents, is_new)
      import :: data_set_store_type, string_type
      class(data_set_store_type), intent(inout) :: self   !< the storage
      character(len=*), intent(in) :: name                !< path of the data set
      type(string_type), intent(in) :: texts(:)           !< the texts, in their order
      integer, intent(in) :: extents(:)                   !< extents of the data set, in Fortran order; empty for a single value
      logical, intent(out) :: is_new                      !< the data set was made; it has no description yet
    end subroutine texts_interface

    !> Add an attribute that is a text to a data set or group; `/` is the storage itself.
    subroutine attribute_interface(self, name, attribute, text)
      import :: data_set_store_type
      class(data_set_store_type), intent(inout) :: self   !< the storage
      character(len=*), intent(in) :: name                !< path of the data set or group
      character(len=*), intent(in) :: attribute           !< name of the attribute
      character(len=*), intent(in) :: text                !< value of the attribute
    end subroutine attribute_interface

    !> Make a data set of one dimension a dimension scale of the same name.
    subroutine scale_interface(self, name)
      import :: data_set_store_type
      class(data_set_store_type), intent(inout) :: self   !< the storage
      character(len=*), intent(in) :: name                !< path of the data set
    end subroutine scale_interface

    !> Attach a scale to each dimension of a data set. A scale is not attached to others.
    subroutine scales_interface(self, name, scales)
      import :: data_set_store_type
      class(data_set_store_type), intent(inout) :: self   !< the storage
      character(len=*), intent(in) :: name                !< path of the data set
      character(len=*), intent(in) :: scales(:)           !< paths of the scales, that of the slowest dimension first
    end subroutine scales_interface
  end interface

contains

  subroutine put_text(self, name, text, long_name)
    class(data_set_store_type), intent(inout) :: self   !< the storage
    character(len=*), intent(in) :: name                !< path of the data set
    character(len=*), intent(in) :: text                !< the text
    character(len=*), intent(in) :: long_name           !< a few words that describe it
    type(string_type) :: texts(1)
    logical :: is_new

    texts(1)%text = text
    call self%put_text_values(name, texts, no_extents, is_new)
    if (is_new) call self%describe(name, long_name)
  end subroutine put_text

  subroutine put_texts(self, name, texts, long_name)
    class(data_set_store_type), intent(inout) :: self   !< the storage
    character(len=*), intent(in) :: name                !< path of the data set
    type(string_type), intent(in) :: texts(:)           !< the texts, in their order
    character(len=*), intent(in) :: long_name           !< a few words that describe it
    logical :: is_new

    call self%put_text_values(name, texts, [size(texts)], is_new)
    if (is_new) call self%describe(name, long_name)
  end subroutine put_texts

  subroutine put_real(self, name, value, long_name, unit)
    class(data_set_store_type), intent(inout) :: self   !< the storage
    character(len=*), intent(in) :: name                !< path of the data set
    real(wp), intent(in), target :: value               !< the number
    character(len=*), intent(in) :: long_name           !< a few words that describe it
    character(len=*), intent(in), optional :: unit      !< unit of the number; absent for none

    call self%put_described(name, real_values, no_extents, c_loc(value), long_name, unit)
  end subroutine put_real

  subroutine put_reals(self, name, values, long_name, unit)
    class(data_set_store_type), intent(inout) :: self      !< the storage
    character(len=*), intent(in) :: name                   !< path of the data set
    real(wp), intent(in), contiguous, target :: values(:)  !< the numbers
    character(len=*), intent(in) :: long_name              !< a few words that describe it
    character(len=*), intent(in), optional :: unit         !< unit of the numbers; absent for none

    call self%put_described(name, real_values, shape(values), c_loc(values), long_name, unit)
  end subroutine put_reals

  subroutine put_matrix(self, name, values, long_name, unit)
    class(data_set_store_type), intent(inout) :: self         !< the storage
    character(len=*), intent(in) :: name                      !< path of the data set
    real(wp), intent(in), contiguous, target :: values(:, :)  !< the numbers; their dimensions are those of the data set in reverse
    character(len=*), intent(in) :: long_name                 !< a few words that describe it
    character(len=*), intent(in), optional :: unit            !< unit of the numbers; absent for none

    call self%put_described(name, real_values, shape(values), c_loc(values), long_name, unit)
  end subroutine put_matrix

  subroutine put_block(self, name, values, long_name, unit)
    class(data_set_store_type), intent(inout) :: self            !< the storage
    character(len=*), intent(in) :: name                         !< path of the data set
    real(wp), intent(in), contiguous, target :: values(:, :, :)  !< the numbers; dimensions are those of the data set in reverse
    character(len=*), intent(in) :: long_name                    !< a few words that describe it
    character(len=*), intent(in), optional :: unit               !< unit of the numbers; absent for none

    call self%put_described(name, real_values, shape(values), c_loc(values), long_name, unit)
  end subroutine put_block

  subroutine put_integer(self, name, value, long_name)
    class(data_set_store_type), intent(inout) :: self   !< the storage
    character(len=*), intent(in) :: name                !< path of the data set
    integer, intent(in), target :: value                !< the number
    character(len=*), intent(in) :: long_name           !< a few words that describe it

    call self%put_described(name, whole_values, no_extents, c_loc(value), long_name)
  end subroutine put_integer

  subroutine put_integers(self, name, values, long_name)
    class(data_set_store_type), intent(inout) :: self     !< the storage
    character(len=*), intent(in) :: name                  !< path of the data set
    integer, intent(in), contiguous, target :: values(:)  !< the numbers
    character(len=*), intent(in) :: long_name             !< a few words that describe it

    call self%put_described(name, whole_values, shape(values), c_loc(values), long_name)
  end subroutine put_integers

  subroutine put_integer_matrix(self, name, values, long_name)
    class(data_set_store_type), intent(inout) :: self        !< the storage
    character(len=*), intent(in) :: name                     !< path of the data set
    integer, intent(in), contiguous, target :: values(:, :)  !< the numbers; their dimensions are those of the data set in reverse
    character(len=*), intent(in) :: long_name                !< a few words that describe it

    call self%put_described(name, whole_values, shape(values), c_loc(values), long_name)
  end subroutine put_integer_matrix

  subroutine put_long(self, name, value, long_name)
    class(data_set_store_type), intent(inout) :: self   !< the storage
    character(len=*), intent(in) :: name                !< path of the data set
    integer(long), intent(in), target :: value          !< the number
    character(len=*), intent(in) :: long_name           !< a few words that describe it

    call self%put_described(name, long_values, no_extents, c_loc(value), long_name)
  end subroutine put_long

  !> Write numbers of any kind, with their description where the data set is new.
  subroutine put_described(self, name, kind, extents, values, long_name, unit)
    class(data_set_store_type), intent(inout) :: self   !< the storage
    character(len=*), intent(in) :: name                !< path of the data set
    integer, intent(in) :: kind                         !< real_values, whole_values or long_values
    integer, intent(in) :: extents(:)                   !< extents of the data set, in Fortran order; empty for a single value
    type(c_ptr), intent(in) :: values                   !< address of the first value
    character(len=*), intent(in) :: long_name           !< a few words that describe it
    character(len=*), intent(in), optional :: unit      !< unit of the numbers; absent for none
    logical :: is_new

    call self%put_numbers(name, kind, extents, values, is_new)
    if (is_new) call self%describe(name, long_name, unit)
  end subroutine put_described

  !> Set the description of a data set, and its unit.
  subroutine describe(self, name, long_name, unit)
    class(data_set_store_type), intent(inout) :: self   !< the storage
    character(len=*), intent(in) :: name                !< path of the data set
    character(len=*), intent(in) :: long_name           !< a few words that describe it
    character(len=*), intent(in), optional :: unit      !< unit of the numbers; absent for none

    call self%add_attribute(name, 'long_name', long_name)
    if (present(unit)) call self%add_attribute(name, 'units', unit)
  end subroutine describe
end module mech9_data_set_store
