!> A priority queue of integers: the item with the least key comes out first.
module mech9_priority_queue
  use mech9_kinds, only: long
  implicit none
  private
  public :: queue_item_type, priority_queue_type

  !> An item; keys are compared number by number, so `minor` decides where `major` is equal.
  type :: queue_item_type
    integer(long) :: major = 0   !< first key
    integer(long) :: minor = 0   !< second key
    integer :: what = 0          !< number of the pair or link that is queued
  end type queue_item_type

  !> A binary heap: item i stands before items 2i and 2i + 1.
  type :: priority_queue_type
    private
    integer :: count = 0
    type(queue_item_type), allocatable :: heap(:)
  contains
    procedure :: is_empty
    procedure :: push
    procedure :: top
    procedure :: pop
  end type priority_queue_type

contains

  !> Whether the queue has no items.
  pure logical function is_empty(self)
    class(priority_queue_type), intent(in) :: self   !< the priority queue

    is_empty = self%count == 0
  end function is_empty

  !> Put an item in.
  pure subroutine push(self, item)
    class(priority_queue_type), intent(inout) :: self   !< the priority queue
    type(queue_item_type), intent(in) :: item           !< the item
    type(queue_item_type), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(self%heap)) allocate (self%heap(64))
    if (self%count == size(self%heap)) then
      allocate (grown(2*self%count))
      grown(:self%count) = self%heap
      call move_alloc(grown, self%heap)
    end if
    self%count = self%count + 1
    i = self%count
    do while (i > 1)
      if (.not. before(item, self%heap(i/2))) exit
      self%heap(i) = self%heap(i/2)
      i = i/2
    end do
    self%heap(i) = item
  end subroutine push

  !> The item with the least key, which stays in. The queue must not be empty.
  pure function top(self) result(item)
    class(priority_queue_type), intent(in) :: self   !< the priority queue
    type(queue_item_type) :: item

    item = self%heap(1)
  end function top

  !> Take out the item with the least key. The queue must not be empty.
  pure subroutine pop(self)
    class(priority_queue_type), intent(inout) :: self   !< the priority queue
    type(queue_item_type) :: last
    integer :: i, child

    last = self%heap(self%count)
    self%count = self%count - 1
    i = 1
    do
      child = 2*i
      if (child > self%count) exit
      if (child < self%count) then
        if (before(self%heap(child + 1), self%heap(child))) child = child + 1
      end if
      if (.not. before(self%heap(child), last)) exit
      self%heap(i) = self%heap(child)
      i = child
    end do
    self%heap(i) = last
  end subroutine pop

  !> Whether the key of the first item is less than that of the second.
  pure logical function before(a, b)
    type(queue_item_type), intent(in) :: a   !< one item
    type(queue_item_type), intent(in) :: b   !< the other item

    if (a%major /= b%major) then
      before = a%major < b%major
    else
      before = a%minor < b%minor
    end if
  end function before
end module mech9_priority_queue
