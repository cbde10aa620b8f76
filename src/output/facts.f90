!> Facts about a run besides its rows: named numbers and texts, collected once and written to every report.
module mech9_facts
  use mech9_kinds, only: wp, long
  use mech9_json, only: json_type
  implicit none
  private
  public :: facts_type, fact_type, a_number, a_count, a_text

  !> Kinds of facts.
  integer, parameter :: a_number = 1, a_count = 2, a_text = 3

  !> A number or a text with its name.
  type :: fact_type
    character(len=:), allocatable :: name       !< a word of lower-case letters and underscores
    character(len=:), allocatable :: long_name  !< a few words for the reader of the report
    character(len=:), allocatable :: unit       !< unit of the number; empty where it has none
    integer :: kind = a_number
    real(wp) :: number = 0.0_wp
    integer(long) :: whole = 0
    character(len=:), allocatable :: text
  end type fact_type

  !> The facts in their order.
  type :: facts_type
    type(fact_type), allocatable :: items(:)
    integer :: count = 0
  contains
    procedure, private :: add_number, add_count, add_whole, add_text, next_item
    !> add(name, value, long_name [, unit])
    generic :: add => add_number, add_count, add_whole, add_text
    procedure :: to_json
  end type facts_type

contains

  !> Add a real number.
  subroutine add_number(self, name, value, long_name, unit)
    class(facts_type), intent(inout) :: self   !< the facts
    character(len=*), intent(in) :: name       !< a word of lower-case letters and underscores
    character(len=*), intent(in) :: long_name  !< a few words that describe it
    real(wp), intent(in) :: value              !< the number, in the unit
    character(len=*), intent(in) :: unit       !< unit of the number; empty where it has none

    call self%next_item(name, long_name, unit, a_number)
    self%items(self%count)%number = value
  end subroutine add_number

  !> Add a whole number.
  subroutine add_count(self, name, value, long_name)
    class(facts_type), intent(inout) :: self   !< the facts
    character(len=*), intent(in) :: name       !< a word of lower-case letters and underscores
    character(len=*), intent(in) :: long_name  !< a few words that describe it
    integer, intent(in) :: value               !< the number

    call self%add_whole(name, int(value, long), long_name)
  end subroutine add_count

  !> Add a whole number of long kind.
  subroutine add_whole(self, name, value, long_name)
    class(facts_type), intent(inout) :: self   !< the facts
    character(len=*), intent(in) :: name       !< a word of lower-case letters and underscores
    character(len=*), intent(in) :: long_name  !< a few words that describe it
    integer(long), intent(in) :: value         !< the number

    call self%next_item(name, long_name, '', a_count)
    self%items(self%count)%whole = value
  end subroutine add_whole

  !> Add a text.
  subroutine add_text(self, name, value, long_name)
    class(facts_type), intent(inout) :: self   !< the facts
    character(len=*), intent(in) :: name       !< a word of lower-case letters and underscores
    character(len=*), intent(in) :: value      !< the text
    character(len=*), intent(in) :: long_name  !< a few words that describe it

    call self%next_item(name, long_name, '', a_text)
    self%items(self%count)%text = value
  end subroutine add_text

  !> Append an item without a value. The array grows in a loop: an array constructor of such items would leak (gfortran 12).
  subroutine next_item(self, name, long_name, unit, kind)
    class(facts_type), intent(inout) :: self   !< the facts
    character(len=*), intent(in) :: name       !< a word of lower-case letters and underscores
    character(len=*), intent(in) :: long_name  !< a few words that describe it
    character(len=*), intent(in) :: unit       !< unit of the number; empty where it has none
    integer, intent(in) :: kind                !< a_number, a_count or a_text
    type(fact_type), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(self%items)) allocate (self%items(16))
    if (self%count == size(self%items)) then
      allocate (grown(2*self%count))
      do i = 1, self%count
        grown(i) = self%items(i)
      end do
      call move_alloc(grown, self%items)
    end if
    self%count = self%count + 1
    self%items(self%count)%name = name
    self%items(self%count)%long_name = long_name
    self%items(self%count)%unit = unit
    self%items(self%count)%kind = kind
  end subroutine next_item

  !> Add the facts to the object that is being composed, each under its name.
  subroutine to_json(self, json)
    class(facts_type), intent(in) :: self   !< the facts
    type(json_type), intent(inout) :: json  !< the report, inside an open object
    integer :: i

    do i = 1, self%count
      associate (item => self%items(i))
        select case (item%kind)
        case (a_number)
          call json%add(item%name, item%number)
        case (a_count)
          call json%add(item%name, item%whole)
        case (a_text)
          call json%add(item%name, item%text)
        end select
      end associate
    end do
  end subroutine to_json

end module mech9_facts
