!> Objectives of an optimisation: what a motion should be, as targets that it should meet.
module mech9_objective
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: objective_type, optimum_type, path_objective, function_objective, timing_given, timing_free, timing_over

  integer, parameter :: path_objective = 1       !< a point meets other points
  integer, parameter :: function_objective = 2   !< a coordinate meets values
  integer, parameter :: timing_given = 1         !< each target has its time
  integer, parameter :: timing_free = 2          !< targets are met one after the other, at any times
  integer, parameter :: timing_over = 3          !< each target has its value of a driven coordinate

  !> A sum of squares: of the distances of targets from a point of the mechanism, or of differences of a coordinate from values.
  type :: objective_type
    integer :: kind = path_objective
    integer :: timing = timing_free
    integer :: point = 0                      !< number of the point that meets targets
    integer :: coordinate = 0                 !< number of the coordinate that meets values
    integer :: over = 0                       !< number of the driven coordinate over which values are given
    integer :: components = 3                 !< components of each target that count: 1, 2 or 3
    real(wp), allocatable :: targets(:, :)    !< (3,n) points [m], or values of the coordinate in the first row [rad, m]
    real(wp), allocatable :: at(:)            !< (n) times [s], or values of the driven coordinate [rad, m]; of no use where times are free
    real(wp) :: weight = 1.0_wp               !< factor of the sum of squares
    type(place_type) :: place                 !< place of its group in the data file
  end type objective_type

  !> The search for the best values of parameters.
  type :: optimum_type
    integer :: starts = 100    !< number of starts
    integer :: seed = 1        !< another seed gives other starts
  end type optimum_type
end module mech9_objective
