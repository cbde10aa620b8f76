!> The problem that is posed on a mechanism: the motion of its driven coordinates, and the start of the others.
module mech9_problem
  use mech9_kinds, only: wp
  use mech9_partition, only: partition_type
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
  contains
    procedure :: has_drive
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
end module mech9_problem
