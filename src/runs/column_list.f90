!> A list of columns of results: names, units, and the factors from the program's units to these.
module mech9_column_list
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_units, only: units_type
  implicit none
  private
  public :: column_list_type

  type :: column_list_type
    type(string_type), allocatable :: names(:)
    type(string_type), allocatable :: units(:)
    type(string_type), allocatable :: long_names(:)  !< a few words that describe each column; the name where none were given
    real(wp), allocatable :: scales(:)      !< factor of each column from the program's units to those of the results
    logical :: converts = .false.           !< some of these factors are not 1
    type(units_type) :: system              !< units of the results
    integer :: count = 0
  contains
    procedure :: append
    procedure :: append_in
  end type column_list_type

contains

  !> Append a column.
  pure subroutine append(self, name, unit, long_name)
    class(column_list_type), intent(inout) :: self           !< the list
    character(len=*), intent(in) :: name                 !< heading of the column
    character(len=*), intent(in) :: unit                 !< unit of its numbers in the results
    character(len=*), intent(in), optional :: long_name  !< a few words that describe it; absent: the heading

    if (self%count == size(self%names)) then
      call grow(self%names)
      call grow(self%units)
      call grow(self%long_names)
    end if
    if (.not. allocated(self%scales)) allocate (self%scales(0))
    if (size(self%scales) < size(self%names)) &
      self%scales = [self%scales, spread(1.0_wp, 1, size(self%names) - size(self%scales))]
    self%count = self%count + 1
    self%names(self%count)%text = name
    self%units(self%count)%text = trim(unit)
    self%long_names(self%count)%text = name
    if (present(long_name)) self%long_names(self%count)%text = long_name
  end subroutine append

  !> Append a column that is in the units of the results.
  pure subroutine append_in(self, name, unit, long_name)
    class(column_list_type), intent(inout) :: self           !< the list, with its units
    character(len=*), intent(in) :: name                 !< heading of the column
    character(len=*), intent(in) :: unit                 !< SI unit of its numbers
    character(len=*), intent(in), optional :: long_name  !< a few words that describe it; absent: the heading

    call self%append(name, trim(self%system%name_of(trim(unit))), long_name)
    self%scales(self%count) = 1.0_wp/self%system%size_of(trim(unit))
    self%converts = .not. self%system%are_si()
  end subroutine append_in

  !> Make room for as many texts again.
  pure subroutine grow(texts)
    type(string_type), allocatable, intent(inout) :: texts(:)  !< texts, with more places afterwards
    type(string_type), allocatable :: grown(:)
    integer :: i

    allocate (grown(2*size(texts) + 8))
    do i = 1, size(texts)
      call move_alloc(texts(i)%text, grown(i)%text)
    end do
    call move_alloc(grown, texts)
  end subroutine grow
end module mech9_column_list
