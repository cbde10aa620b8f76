!> How to compute and what to record.
module mech9_settings
  use mech9_kinds, only: wp
  implicit none
  private
  public :: time_grid_type, solver_settings_type, output_settings_type

  !> Results are given at start + (end - start) i/intervals, i = 0 .. intervals.
  type :: time_grid_type
    real(wp) :: start = 0.0_wp    !< [s]
    real(wp) :: end = 1.0_wp      !< [s]
    integer :: intervals = 100
  contains
    procedure :: time
  end type time_grid_type

  !> Of &solver. An empty method means the program's default.
  type :: solver_settings_type
    character(len=:), allocatable :: method
    real(wp) :: relative_tolerance = 1.0e-8_wp
    real(wp) :: absolute_tolerance = 1.0e-10_wp
    integer :: maximum_steps = 1000000        !< between two outputs
  end type solver_settings_type

  !> Of &output. An empty name means: not written.
  type :: output_settings_type
    character(len=:), allocatable :: table
    character(len=:), allocatable :: hdf5
    character(len=:), allocatable :: sketch
    character(len=:), allocatable :: animation
    character(len=:), allocatable :: view     !< of both; empty: the best one
    logical :: poses = .false.                !< the HDF5 file holds the poses of links
    integer :: compression = 0                !< of the HDF5 file: 0 none to 9 most
    logical :: conditioning = .false.         !< a column of the least singular value
    integer, allocatable :: coordinates(:)    !< that have columns; none listed: all
    integer :: derivatives = 2                !< the highest in time that is recorded
    logical :: energies = .true.              !< columns of the energies
  contains
    procedure :: recorded
  end type output_settings_type

contains

  !> Whether each of so many coordinates is recorded: all are, unless some are named.
  pure function recorded(self, n_coordinates)
    class(output_settings_type), intent(in) :: self   !< the output settings
    integer, intent(in) :: n_coordinates
    logical :: recorded(n_coordinates)

    recorded = .true.
    if (.not. allocated(self%coordinates)) return
    if (size(self%coordinates) == 0) return
    recorded = .false.
    recorded(self%coordinates) = .true.
  end function recorded

  !> Time of output i; the last one is exactly the end.
  pure real(wp) function time(self, i)
    class(time_grid_type), intent(in) :: self   !< the time grid
    integer, intent(in) :: i

    if (i == self%intervals) then
      time = self%end
    else
      time = self%start + (self%end - self%start)*i/real(self%intervals, wp)
    end if
  end function time
end module mech9_settings
