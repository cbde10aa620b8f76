!> Rest against rigid stops: their coordinates are held at the ends, like those of drives that do not move, and the others balance.
!>
!> The ends are tried one by one, then two together, and so on, in the order of the stops. The first choice counts in which all held ends
!> push and no other end is passed.
module mech9_rest_on_stops
  use mech9_model, only: model_type
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_partition, only: partition_type, free_coordinate, driven_coordinate
  implicit none
  private
  public :: end_type, rigid_ends, hold_ends, next_choice

  !> One end of a rigid stop.
  type :: end_type
    integer :: stop = 0            !< number of the stop
    integer :: end = 0             !< 1: the low one, 2: the high one
    integer :: direction = 1       !< of its force on the coordinate
  end type end_type

contains

  !> The ends of all rigid stops, in their order.
  pure subroutine rigid_ends(model, ends)
    type(model_type), intent(in) :: model                !< the model
    type(end_type), allocatable, intent(out) :: ends(:)  !< the ends
    integer :: i, end

    allocate (ends(0))
    do i = 1, size(model%mechanism%stops)
      if (.not. model%mechanism%stops(i)%is_rigid) cycle
      do end = 1, 2
        if (model%mechanism%stops(i)%has_end(end)) ends = [ends, end_type(i, end, 3 - 2*end)]
      end do
    end do
  end subroutine rigid_ends

  !> The model with the coordinates of some ends held there. A dependent coordinate becomes independent in place of a free one; which one,
  !> `exchange` tells. Fails where two ends hold one coordinate, or no free coordinate is left.
  subroutine hold_ends(model, ends, exchange, held, possible)
    type(model_type), intent(in) :: model        !< the model
    type(end_type), intent(in) :: ends(:)        !< the ends
    integer, intent(in) :: exchange              !< the first dependent coordinate takes the place of the free one with this place
    type(model_type), intent(out) :: held        !< the model with these drives
    logical, intent(out) :: possible             !< there is such a model
    type(partition_type) :: partition
    type(drive_slot_type), allocatable :: drives(:)
    logical :: independent(size(model%mechanism%pairs))
    integer :: free(count(model%problem%partition%kind == free_coordinate)), i, k, n, next

    possible = .false.
    independent = model%problem%partition%independent()
    free = pack([(k, k=1, size(independent))], model%problem%partition%kind == free_coordinate)
    next = exchange
    do i = 1, size(ends)
      k = model%mechanism%stops(ends(i)%stop)%coordinate
      if (any(model%mechanism%stops(ends(:i - 1)%stop)%coordinate == k)) return
      if (model%problem%partition%kind(k) == driven_coordinate) return
      if (independent(k)) cycle
      if (next > size(free)) return
      independent(free(next)) = .false.
      independent(k) = .true.
      next = next + 1
    end do
    held = model
    call model%problem%partition%with_independent(model%mechanism%structure, independent, partition)
    n = size(model%problem%drives)
    allocate (drives(n + size(ends)))
    do i = 1, n
      allocate (drives(i)%drive, source=model%problem%drives(i)%drive)
    end do
    do i = 1, size(ends)
      associate (stop => model%mechanism%stops(ends(i)%stop))
        partition%kind(stop%coordinate) = driven_coordinate
        allocate (drives(n + i)%drive, source=polynomial_law_type(coordinate=stop%coordinate, &
                                                                  coefficients=[stop%ends(ends(i)%end)]))
      end associate
    end do
    held%problem%partition = partition
    call move_alloc(drives, held%problem%drives)
    possible = .true.
  end subroutine hold_ends

  !> Go on to the next choice of some of several things, ascending; after the last one of its size, to the first one with one more.
  pure subroutine next_choice(n, choice)
    integer, intent(in) :: n                               !< how many things there are
    integer, allocatable, intent(inout) :: choice(:)       !< numbers of the chosen ones, ascending; of size n + 1 after the last choice
    integer :: i, j, k

    k = size(choice)
    do i = k, 1, -1
      if (choice(i) == n - k + i) cycle
      choice(i) = choice(i) + 1
      do j = i + 1, k
        choice(j) = choice(j - 1) + 1
      end do
      return
    end do
    choice = [(i, i=1, k + 1)]
  end subroutine next_choice
end module mech9_rest_on_stops
