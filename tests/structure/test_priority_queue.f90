!> Priority queues: items come out in the order of their two keys, also while others are put in.
module test_priority_queue
  use mech9_kinds, only: wp, long
  use mech9_random, only: random_type
  use mech9_priority_queue, only: priority_queue_type, queue_item_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('sorting')) call sorting(tester)
    if (tester%runs('in_and_out')) call in_and_out(tester)
  end subroutine run

  !> An item with keys from 0 to 9, at random.
  function any_item(random) result(item)
    type(random_type), intent(inout) :: random   !< source of the numbers
    type(queue_item_type) :: item

    item%major = int(5.0_wp*(1.0_wp + random%symmetric()), long)
    item%minor = int(5.0_wp*(1.0_wp + random%symmetric()), long)
  end function any_item

  !> Whether the key of an item is below that of another one.
  pure logical function is_below(a, b)
    type(queue_item_type), intent(in) :: a   !< first item
    type(queue_item_type), intent(in) :: b   !< second item

    is_below = a%major < b%major .or. (a%major == b%major .and. a%minor < b%minor)
  end function is_below

  !> All items that were put in come out, each once, in ascending order.
  subroutine sorting(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 300
    type(priority_queue_type) :: queue
    type(queue_item_type) :: item, before
    type(random_type) :: random
    logical :: seen(n)
    integer :: i

    call tester%is_true(queue%is_empty(), 'a new queue is empty')
    do i = 1, n
      item = any_item(random)
      item%what = i
      call queue%push(item)
    end do
    seen = .false.
    do i = 1, n
      call tester%is_true(.not. queue%is_empty(), 'there are items left')
      item = queue%top()
      call queue%pop()
      if (i > 1) call tester%is_true(.not. is_below(item, before), 'keys do not fall')
      call tester%is_true(.not. seen(item%what), 'an item comes once')
      seen(item%what) = .true.
      before = item
    end do
    call tester%is_true(queue%is_empty() .and. all(seen), 'all items came out')
  end subroutine sorting

  !> While items come and go, the one that comes out is a least one of those that are in, by a plain list.
  subroutine in_and_out(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(priority_queue_type) :: queue
    type(queue_item_type), allocatable :: list(:)
    type(queue_item_type) :: item
    type(random_type) :: random
    integer :: i, k, at
    logical :: grows

    allocate (list(0))
    do i = 1, 1000
      grows = random%symmetric() > -0.1_wp
      if (size(list) == 0 .or. grows) then
        item = any_item(random)
        item%what = i
        call queue%push(item)
        list = [list, item]
      else
        item = queue%top()
        call queue%pop()
        at = findloc(list%what, item%what, dim=1)
        call tester%is_true(at > 0, 'it is one of those that are in')
        if (at == 0) return
        call tester%is_true(.not. any([(is_below(list(k), item), k=1, size(list))]), 'none of them has a lower key')
        list = [list(:at - 1), list(at + 1:)]
      end if
      call tester%is_true(queue%is_empty() .eqv. size(list) == 0, 'the queue is as full as the list')
    end do
  end subroutine in_and_out
end module test_priority_queue
