!> Numbers by names: a hash table, so that the time for many names grows as their number does.
!>
!> As in comparisons of texts, blanks at the end of a name do not count.
module mech9_name_table
  use mech9_kinds, only: long
  implicit none
  private
  public :: name_table_type

  !> A name, with its number and its hash value.
  type :: entry_type
    character(len=:), allocatable :: name
    integer :: number = 0
    integer :: hash = 0
  end type entry_type

  !> The table. Entries stand in the order in which they were added; a slot holds the place of an entry, or 0. A name that finds its
  !> slot taken takes the next free one.
  type :: name_table_type
    private
    integer :: count = 0
    type(entry_type), allocatable :: entries(:)
    integer, allocatable :: slots(:)
  contains
    procedure :: add
    procedure :: set
    procedure :: find
    procedure, private :: slot_of
    procedure, private :: grow
  end type name_table_type

  integer, parameter :: first_size = 32                 !< entries of the first table; there are twice as many slots
  integer(long), parameter :: factor = 16777619_long    !< of the hash function, that of Fowler, Noll and Vo
  integer(long), parameter :: modulus = 2147483647_long !< a prime number: the product of two hash values is no larger than huge(1_long)

contains

  !> Add a name; one that is there keeps its number.
  pure subroutine add(self, name, number)
    class(name_table_type), intent(inout) :: self  !< the table
    character(len=*), intent(in) :: name           !< the name
    integer, intent(in) :: number                  !< its number, which is not 0
    integer :: slot

    if (.not. allocated(self%entries)) call self%grow()
    if (self%count == size(self%entries)) call self%grow()
    slot = self%slot_of(name, hash_of(name))
    if (self%slots(slot) > 0) return
    self%count = self%count + 1
    self%slots(slot) = self%count
    associate (entry => self%entries(self%count))
      entry%name = trim(name)
      entry%number = number
      entry%hash = hash_of(name)
    end associate
  end subroutine add

  !> Give a name a number, in the place of the one that it has.
  pure subroutine set(self, name, number)
    class(name_table_type), intent(inout) :: self  !< the table
    character(len=*), intent(in) :: name           !< the name
    integer, intent(in) :: number                  !< its number, which is not 0

    call self%add(name, number)
    self%entries(self%slots(self%slot_of(name, hash_of(name))))%number = number
  end subroutine set

  !> The number of a name; 0 where it is not in the table.
  pure integer function find(self, name) result(number)
    class(name_table_type), intent(in) :: self  !< the table
    character(len=*), intent(in) :: name        !< the name
    integer :: at

    number = 0
    if (self%count == 0) return
    at = self%slots(self%slot_of(name, hash_of(name)))
    if (at > 0) number = self%entries(at)%number
  end function find

  !> The slot of a name: the one that holds it, or the first free one behind the slot of its hash value.
  pure integer function slot_of(self, name, hash) result(slot)
    class(name_table_type), intent(in) :: self  !< a table with free slots
    character(len=*), intent(in) :: name        !< the name
    integer, intent(in) :: hash                 !< its hash value

    slot = modulo(hash, size(self%slots)) + 1
    do while (self%slots(slot) > 0)
      associate (entry => self%entries(self%slots(slot)))
        if (entry%hash == hash) then
          if (entry%name == name) return
        end if
      end associate
      slot = modulo(slot, size(self%slots)) + 1
    end do
  end function slot_of

  !> Make room for as many names more.
  pure subroutine grow(self)
    class(name_table_type), intent(inout) :: self  !< the table
    type(entry_type), allocatable :: longer(:)
    integer :: i, slot

    allocate (longer(max(first_size, 2*self%count)))
    do i = 1, self%count
      call move_alloc(self%entries(i)%name, longer(i)%name)
      longer(i)%number = self%entries(i)%number
      longer(i)%hash = self%entries(i)%hash
    end do
    call move_alloc(longer, self%entries)
    if (allocated(self%slots)) deallocate (self%slots)
    allocate (self%slots(2*size(self%entries)), source=0)
    do i = 1, self%count
      slot = modulo(self%entries(i)%hash, size(self%slots)) + 1
      do while (self%slots(slot) > 0)
        slot = modulo(slot, size(self%slots)) + 1
      end do
      self%slots(slot) = i
    end do
  end subroutine grow

  !> A number that differs for most names that differ.
  pure integer function hash_of(name) result(hash)
    character(len=*), intent(in) :: name  !< the name
    integer(long) :: sum
    integer :: i

    sum = 0
    do i = 1, len_trim(name)
      sum = modulo((sum + iachar(name(i:i)))*factor, modulus)
    end do
    hash = int(sum)
  end function hash_of
end module mech9_name_table
