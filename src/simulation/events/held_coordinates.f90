!> The partition of the coordinates in which closed stops and sticking pairs hold theirs, and the drives that hold them.
module mech9_held_coordinates
  use mech9_kinds, only: wp
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_partition, only: partition_type, free_coordinate, driven_coordinate
  use mech9_motion_system, only: motion_system_type
  use mech9_stop_forces, only: held_coordinate_type
  use mech9_stop_contacts, only: stop_contacts_type
  use mech9_jacobian, only: rates_by_independent
  implicit none
  private
  public :: choose_held, hold_by_drives

contains

  !> Choose the partition: held coordinates are driven, and those held so far that are not are free. A dependent coordinate that is held
  !> becomes independent in place of the free one by which it moves most.
  subroutine choose_held(system, contacts, sticking, partition)
    class(motion_system_type), intent(in) :: system     !< the system, with the columns of its frames
    type(stop_contacts_type), intent(in) :: contacts    !< all ends of stops, held or not
    integer, intent(in) :: sticking(:)                  !< coordinates that friction holds
    type(partition_type), intent(out) :: partition      !< the partition
    logical :: independent(system%plan%n_coordinates), held(system%plan%n_coordinates)
    integer :: k

    held = contacts%held_coordinates(size(held))
    held(sticking) = .true.
    independent = system%partition%independent()
    call exchange(system, held, [(is_held_now(k), k=1, size(held))], independent)
    partition = system%partition%in_same_order(independent)
    do k = 1, size(held)
      if (held(k)) then
        partition%kind(k) = driven_coordinate
      else if (system%plan%driven(k) .and. is_held_now(k)) then
        partition%kind(k) = free_coordinate
      end if
    end do
  contains
    !> Whether a stop or friction holds a coordinate in the present system.
    pure logical function is_held_now(coordinate)
      integer, intent(in) :: coordinate   !< its number

      is_held_now = .false.
      if (allocated(system%held)) is_held_now = any(system%held%coordinate == coordinate)
    end function is_held_now
  end subroutine choose_held

  !> Exchange free coordinates for dependent ones that are held, by elimination with column pivoting.
  subroutine exchange(system, held, held_now, independent)
    class(motion_system_type), intent(in) :: system   !< the system, with the columns of its frames
    logical, intent(in) :: held(:)                    !< (M) the coordinate is to be held
    logical, intent(in) :: held_now(:)                !< (M) it is held now, and free unless it is to be held
    logical, intent(inout) :: independent(:)          !< (M) the coordinate is independent
    real(wp), allocatable :: rows(:, :)
    integer, allocatable :: dependent(:)
    logical :: may_leave(size(system%plan%independent))
    integer :: i, j, pivot

    associate (plan => system%plan)
      dependent = pack([(i, i=1, size(held))], held .and. .not. independent)
      allocate (rows(size(plan%independent), size(dependent)))
      may_leave = .not. held(plan%independent) .and. (.not. plan%driven(plan%independent) .or. held_now(plan%independent))
      do i = 1, size(dependent)
        call rates_by_independent(plan, system%dynamics, system%work%jacobian, dependent(i), rows(:, i))
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

  !> The drives that hold coordinates at their limits, or where pairs stick, after all other drives.
  subroutine hold_by_drives(contacts, sticking, q, drives, held)
    type(stop_contacts_type), intent(in) :: contacts                         !< all ends of stops, held or not
    integer, intent(in) :: sticking(:)                                       !< coordinates that friction holds
    real(wp), intent(in) :: q(:)                                             !< (M) present coordinates [rad, m]
    type(drive_slot_type), allocatable, intent(inout) :: drives(:)           !< all drives; those that hold are made anew
    type(held_coordinate_type), allocatable, intent(inout) :: held(:)        !< the coordinates that are held; not allocated: none
    type(drive_slot_type), allocatable :: others(:)
    type(held_coordinate_type), allocatable :: now(:)
    logical :: stays(size(drives))
    integer :: i, n, m

    stays = .true.
    if (allocated(held)) stays = [(.not. any(held%coordinate == drives(i)%drive%coordinate), i=1, size(drives))]
    allocate (now(count(contacts%ends%held .and. contacts%ends%stop > 0) + size(sticking)))
    allocate (others(count(stays) + size(now)))
    n = 0
    do i = 1, size(drives)
      if (.not. stays(i)) cycle
      n = n + 1
      call move_alloc(drives(i)%drive, others(n)%drive)
    end do
    m = 0
    do i = 1, size(contacts%ends)
      associate (end => contacts%ends(i))
        if (end%held .and. end%is_stop()) call hold(end%stop, end%coordinate, end%limit)
      end associate
    end do
    do i = 1, size(sticking)
      call hold(0, sticking(i), q(sticking(i)))
    end do
    call move_alloc(others, drives)
    if (allocated(held)) deallocate (held)
    if (size(now) > 0) call move_alloc(now, held)
  contains
    !> Hold one coordinate.
    subroutine hold(stop, coordinate, at)
      integer, intent(in) :: stop         !< number of the stop that holds it; 0: friction does
      integer, intent(in) :: coordinate   !< its number
      real(wp), intent(in) :: at          !< its value from now on [rad, m]

      m = m + 1
      now(m)%stop = stop
      now(m)%coordinate = coordinate
      allocate (others(n + m)%drive, source=polynomial_law_type(coordinate=coordinate, coefficients=[at]))
    end subroutine hold
  end subroutine hold_by_drives
end module mech9_held_coordinates
