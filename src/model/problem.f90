!> The problem that is posed on a mechanism: the motion of its driven coordinates, and the start of the others.
module mech9_problem
  use mech9_kinds, only: wp
  use mech9_partition, only: partition_type, dependent_coordinate, driven_coordinate
  use mech9_law, only: drive_slot_type
  implicit none
  private
  public :: problem_type, initial_type

  !> Coordinates and rates at the start.
  type :: initial_type
    real(wp), allocatable :: position(:)         !< (M) values of independent, guesses of dependent coordinates [rad, m]
    real(wp), allocatable :: velocity(:)         !< (M) of independent coordinates [rad/s, m/s]
    logical, allocatable :: position_given(:)    !< (M) the data file gives the position
    logical, allocatable :: velocity_given(:)    !< (M) the data file gives the velocity
  end type initial_type

  type :: problem_type
    type(partition_type) :: partition                 !< driven, free and dependent coordinates
    type(drive_slot_type), allocatable :: drives(:)   !< in the order of the data file
    type(initial_type) :: initial
    integer, allocatable :: given(:)                  !< cq of the data file: independent coordinates in its order; not allocated: without
  contains
    procedure :: has_drive
    procedure :: in_given_order
  end type problem_type

contains

  !> Whether a drive of the data file moves a coordinate. Angles that the program itself holds have none.
  pure function has_drive(self) result(has)
    class(problem_type), intent(in) :: self         !< the problem
    logical :: has(size(self%partition%kind))       !< (M)
    integer :: i

    has = .false.
    do i = 1, size(self%drives)
      associate (drive => self%drives(i)%drive)
        if (drive%coordinate > 0 .and. drive%place%line > 0) has(drive%coordinate) = .true.
      end associate
    end do
  end function has_drive

  !> The independent coordinates in the order of cq, the others behind these by their numbers. Angles that the program itself holds are
  !> left out.
  pure function in_given_order(self) result(coordinates)
    class(problem_type), intent(in) :: self       !< the problem
    integer, allocatable :: coordinates(:)        !< their numbers
    logical :: is_left(size(self%partition%kind))
    integer :: i

    is_left = self%partition%kind /= dependent_coordinate
    is_left = is_left .and. (self%partition%kind /= driven_coordinate .or. self%has_drive())
    allocate (coordinates(0))
    if (allocated(self%given)) then
      do i = 1, size(self%given)
        if (.not. is_left(self%given(i))) cycle
        coordinates = [coordinates, self%given(i)]
        is_left(self%given(i)) = .false.
      end do
    end if
    coordinates = [coordinates, pack([(i, i=1, size(is_left))], is_left)]
  end function in_given_order
end module mech9_problem
