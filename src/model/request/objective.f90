!> Objectives and limits of an optimisation: targets that a motion should meet, quantities that should be small, and the designs
!> that are allowed.
module mech9_objective
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: objective_type, limit_type, optimum_type, path_objective, function_objective, pose_objective, quantity_objective
  public :: timing_given, timing_free, timing_over, quantity_limit, assembles_limit, crank_limit, transmission_limit

  integer, parameter :: path_objective = 1       !< a point meets other points
  integer, parameter :: function_objective = 2   !< a coordinate meets values
  integer, parameter :: pose_objective = 3       !< a link meets poses
  integer, parameter :: quantity_objective = 4   !< a quantity meets a value, or is least or largest
  integer, parameter :: timing_given = 1         !< each target has its time
  integer, parameter :: timing_free = 2          !< targets are met one after the other, at any times
  integer, parameter :: timing_over = 3          !< each target has its value of a driven coordinate

  integer, parameter :: quantity_limit = 1       !< a quantity lies in a range
  integer, parameter :: assembles_limit = 2      !< the mechanism can be assembled through the whole run
  integer, parameter :: crank_limit = 3          !< a driven coordinate can turn fully
  integer, parameter :: transmission_limit = 4   !< the transmission angle at a coordinate is large enough

  !> A sum of squares: of the distances of targets from a point of the mechanism, or of differences of a coordinate from values; or
  !> a quantity.
  type :: objective_type
    integer :: kind = path_objective
    integer :: timing = timing_free
    integer :: point = 0                      !< number of the point that meets targets
    integer :: coordinate = 0                 !< number of the coordinate that meets values
    integer :: over = 0                       !< number of the driven coordinate over which values are given
    integer :: link = 0                       !< number of the link that meets poses
    integer :: quantity = 0                   !< number of the quantity
    logical :: has_goal = .false.             !< the quantity should have a value; otherwise it should be least or largest
    real(wp) :: goal = 0.0_wp                 !< this value, in the unit of the results
    real(wp) :: direction = 1.0_wp            !< 1: the quantity should be least; -1: largest
    integer :: components = 3                 !< components of each target that count: 1, 2 or 3
    real(wp), allocatable :: targets(:, :)    !< (3,n) points [m], or values of the coordinate in the first row [rad, m]
    real(wp), allocatable :: turns(:, :)      !< (3,n) rotation vectors of poses [rad]
    real(wp) :: length = 0.0_wp               !< an angle of 1 rad counts as this distance [m]; 0: the size of the targets
    real(wp), allocatable :: at(:)            !< (n) times [s], or values of the driven coordinate [rad, m]; of no use where times are free
    real(wp) :: weight = 1.0_wp               !< factor of the sum of squares, or of the quantity
    type(place_type) :: place                 !< place of its group in the data file
  end type objective_type

  !> A condition that a design must meet.
  type :: limit_type
    integer :: kind = quantity_limit
    integer :: quantity = 0                   !< number of the quantity
    real(wp) :: low = -huge(1.0_wp)           !< its least value, in the unit of the results
    real(wp) :: high = huge(1.0_wp)           !< its largest value
    integer :: coordinate = 0                 !< the coordinate that turns, or at which the transmission angle is measured
    real(wp) :: at_least = 0.0_wp             !< least transmission angle [rad]
    type(place_type) :: place                 !< place of its group in the data file
  end type limit_type

  !> The search for the best values of parameters.
  type :: optimum_type
    integer :: starts = 100    !< number of starts
    integer :: seed = 1        !< another seed gives other starts
    character(len=20) :: method = 'auto'   !< of the search: auto, levenberg-marquardt, or one of NLopt's
    type(place_type) :: place  !< place of the method in the data file
  end type optimum_type
end module mech9_objective
