!> The partition of the coordinates in which closed stops hold theirs, and the drives that hold them.
module mech9_held_stops
  use mech9_kinds, only: wp
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_partition, only: partition_type, free_coordinate, driven_coordinate
  use mech9_motion_system, only: motion_system_type
  use mech9_stop_forces, only: held_stop_type
  use mech9_stop_contacts, only: stop_contacts_type
  use mech9_contact_equations, only: rates_by_independent
  implicit none
  private
  public :: choose_held, hold_by_drives

contains

  !> Choose the partition: held coordinates are driven, and those held so far that are not are free. A dependent coordinate that is held
  !> becomes independent in place of the free one by which it moves most.
  subroutine choose_held(system, contacts, partition)
    class(motion_system_type), intent(in) :: system     !< the system, with the columns of its frames
    type(stop_contacts_type), intent(in) :: contacts    !< all ends of stops, held or not
    type(partition_type), intent(out) :: partition      !< the partition
    logical :: independent(system%plan%n_coordinates), held(system%plan%n_coordinates)
    integer :: k

    held = contacts%held_coordinates(size(held))
    independent = system%partition%independent()
    call exchange(system, held, independent)
    partition = system%partition%in_same_order(independent)
    do k = 1, size(contacts%ends)
      associate (kind => partition%kind(contacts%ends(k)%coordinate), drive => system%plan%driven(contacts%ends(k)%coordinate))
        if (held(contacts%ends(k)%coordinate)) then
          kind = driven_coordinate
        else if (drive .and. is_held_now(contacts%ends(k)%coordinate)) then
          kind = free_coordinate
        end if
      end associate
    end do
  contains
    !> Whether a stop holds a coordinate in the present system.
    pure logical function is_held_now(coordinate)
      integer, intent(in) :: coordinate   !< its number

      is_held_now = .false.
      if (allocated(system%held_stops)) is_held_now = any(system%held_stops%coordinate == coordinate)
    end function is_held_now
  end subroutine choose_held

  !> Exchange free coordinates for dependent ones that are held, by elimination with column pivoting.
  subroutine exchange(system, held, independent)
    class(motion_system_type), intent(in) :: system   !< the system, with the columns of its frames
    logical, intent(in) :: held(:)                    !< (M) the coordinate is to be held
    logical, intent(inout) :: independent(:)          !< (M) the coordinate is independent
    real(wp), allocatable :: rows(:, :)
    integer, allocatable :: dependent(:)
    logical :: may_leave(size(system%plan%independent))
    integer :: i, j, pivot

    associate (plan => system%plan)
      dependent = pack([(i, i=1, size(held))], held .and. .not. independent)
      allocate (rows(size(plan%independent), size(dependent)))
      may_leave = .not. (plan%driven(plan%independent) .or. held(plan%independent))
      do i = 1, size(dependent)
        call rates_by_independent(system, dependent(i), rows(:, i))
        rows(:, i) = rows(:, i)*plan%unit_of(plan%independent)/plan%unit_of(dependent(i))
        where (.not. may_leave) rows(:, i) = 0.0_wp
      end do
      do i = 1, size(dependent)
        pivot = maxloc(abs(rows(:, i)), dim=1)
        if (.not. abs(rows(pivot, i)) > 0.0_wp) cycle
        independent(plan%independent(pivot)) = .false.
        independent(dependent(i)) = .true.
        do j = i + 1, size(dependent)
          rows(:, j) = rows(:, j) - rows(pivot, j)/rows(pivot, i)*rows(:, i)
          rows(pivot, j) = 0.0_wp
        end do
      end do
    end associate
  end subroutine exchange

  !> The drives that hold coordinates at their limits, after all other drives.
  subroutine hold_by_drives(contacts, drives, held_stops)
    type(stop_contacts_type), intent(in) :: contacts                         !< all ends of stops, held or not
    type(drive_slot_type), allocatable, intent(inout) :: drives(:)           !< all drives; those of stops are made anew
    type(held_stop_type), allocatable, intent(inout) :: held_stops(:)        !< the stops that hold; not allocated: none
    type(drive_slot_type), allocatable :: others(:)
    logical :: stays(size(drives))
    integer :: i, n

    stays = .true.
    if (allocated(held_stops)) then
      stays = [(.not. any(held_stops%coordinate == drives(i)%drive%coordinate), i=1, size(drives))]
      deallocate (held_stops)
    end if
    allocate (others(count(stays) + count(contacts%ends%held)))
    n = 0
    do i = 1, size(drives)
      if (.not. stays(i)) cycle
      n = n + 1
      call move_alloc(drives(i)%drive, others(n)%drive)
    end do
    do i = 1, size(contacts%ends)
      associate (end => contacts%ends(i))
        if (.not. end%held) cycle
        n = n + 1
        allocate (others(n)%drive, source=polynomial_law_type(coordinate=end%coordinate, coefficients=[end%limit]))
      end associate
    end do
    call move_alloc(others, drives)
    if (.not. any(contacts%ends%held)) return
    allocate (held_stops(count(contacts%ends%held)))
    held_stops%stop = pack(contacts%ends%stop, contacts%ends%held)
    held_stops%coordinate = pack(contacts%ends%coordinate, contacts%ends%held)
  end subroutine hold_by_drives
end module mech9_held_stops
