!> Failures as numbers: a kind, and the numbers from which `wording` forms the sentences that users read.
!>
!> Each floor that fails with kinds of its own has a module of them and a range of numbers, used from its beginning without gaps. A
!> kind that several floors raise stands in the lowest of them. Kinds stand here where a floor asks for them that uses none of
!> those that raise them.
!>
!>      1 to   99   src/base/failure.f90
!>    101 to  199   src/numerics/spline_failures.f90
!>    201 to  299   src/spatial/curve_failures.f90
!>    301 to  399   src/kinematics/assembly/assembly_failures.f90
!>    401 to  499   src/kinematics/planning/planning_failures.f90
!>    501 to  599   src/kinematics/tracking/tracking_failures.f90
!>    601 to  699   src/ode/ode_failures.f90
!>    701 to  799   src/dynamics/dynamics_failures.f90
!>    801 to  899   src/analyses/sensitivity/sensitivity_failures.f90
!>    901 to  999   src/dynamics/sensitivity/force_gradient_failures.f90
!>   1001 to 1099   src/simulation/simulation_failures.f90
!>   1101 to 1199   src/reactions/reaction_failures.f90
!>   1201 to 1299   src/analyses/equilibrium/equilibrium_failures.f90
!>   1301 to 1399   src/simulation/integration/integration_failures.f90
!>   1401 to 1499   src/simulation/events/event_failures.f90
!>   1501 to 1599   src/simulation/driven/driven_failures.f90
module mech9_failure
  use mech9_kinds, only: wp
  implicit none
  private
  public :: failure_type, integration_stop_type, failure_off_curve, failure_off_table, last_shared_failure

  !> A coordinate goes beyond an end of its curve: coordinates, values (the coordinate, the length of the curve [m]), t.
  integer, parameter :: failure_off_curve = 1
  !> A coordinate goes beyond an end of the table of a coupling: chains, coordinates, values (the coordinate, both ends of
  !> the table), name (of their unit), t.
  integer, parameter :: failure_off_table = 2
  integer, parameter :: last_shared_failure = failure_off_table

  !> A failure: its kind, and the numbers that its kind names.
  type :: failure_type
    integer :: kind = 0                         !< one of the failure_ constants
    integer, allocatable :: chains(:)           !< closed chains, and couplings with negative numbers
    integer, allocatable :: lines(:)            !< of the data file, on which each of `chains` begins; 0: on none
    integer, allocatable :: coordinates(:)      !< coordinates that fail
    integer, allocatable :: others(:)           !< coordinates that would serve, or the independent ones
    integer, allocatable :: idle(:)             !< coordinates that cannot move
    !> (coordinate, of `others`) whether the coordinate could be chosen in place of that one.
    logical, allocatable :: replaces(:, :)
    real(wp), allocatable :: values(:, :)       !< positions or rates, in the units of the data file
    character(len=:), allocatable :: name       !< as the user wrote it; else the unit in which lengths are told, or units of values
    integer :: link = 0                         !< on which a chain closes
    integer :: growing = 0                      !< coordinate that grows without bound, or number of frictions that slip
    integer :: number = 0                       !< of things, or the place of one in its row
    integer :: limit = 0                        !< the largest number allowed
    real(wp) :: t = 0.0_wp                      !< time [s]
    real(wp) :: t_stop = 0.0_wp                 !< time that was to be reached [s]
    real(wp) :: step = 0.0_wp                   !< length of a step [s]
    real(wp) :: gap = 0.0_wp                    !< by which a chain stays open [m]
    real(wp) :: size = 1.0_wp                   !< length of the mechanism [m]
    real(wp) :: displacement = 0.0_wp           !< at which a chain opens [rad, lengths of the mechanism]
    real(wp) :: distance = 0.0_wp               !< from dimensions that let a chain move [rad, lengths of the mechanism], or length of a link [m]
    real(wp) :: deviation = 0.0_wp              !< estimated error of a position [unit of the file]
    real(wp) :: tolerance = 0.0_wp              !< as the user gave it, or an error that is allowed [m; of positions unit of the file]
  end type failure_type

  !> The integration that a failure of its system ended.
  type :: integration_stop_type
    real(wp) :: t = 0.0_wp                      !< end of the last accepted step [s]
    real(wp) :: t_failed = 0.0_wp               !< of the trial that failed [s]
  end type integration_stop_type
end module mech9_failure
