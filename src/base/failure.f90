!> Failures as numbers: kinds, and the numbers from which `wording` forms the sentences that users read.
module mech9_failure
  use mech9_kinds, only: wp
  implicit none
  private
  public :: failure_type, integration_stop_type
  public :: failure_wrong_choice, failure_undetermined_coordinates, failure_open_chain, failure_nearly_closed_chain
  public :: failure_locked_chain, failure_nearly_moving_chain
  public :: failure_large_block, failure_undetermined_block, failure_contradictory_inputs
  public :: failure_start_at_dead_point, failure_start_on_branches, failure_start_unclear, failure_start_locked
  public :: failure_start_not_left, failure_escape, failure_dead_point, failure_lost_branch
  public :: failure_singular_block, failure_singular_start_block, failure_no_inertia
  public :: failure_singular_step, failure_unclosed_step, failure_other_branch
  public :: failure_unknown_method, failure_no_jacobian, failure_tolerance_count, failure_relative_tolerance
  public :: failure_absolute_tolerance, failure_many_steps, failure_inaccurate_step, failure_unsolved_step
  public :: failure_accurate_step, failure_step_memory, failure_step_settings, failure_short_step
  public :: failure_infinite_rate, failure_infinite_jacobian, failure_open_position
  public :: failure_few_points, failure_points_order, failure_no_spline
  public :: failure_chain_dimensions, failure_nothing_turns, failure_pair_off_plane, failure_chain_off_plane
  public :: failure_no_initial_position, failure_not_started, failure_backwards, failure_interrupted
  public :: failure_accuracy, failure_gimbal_lock, failure_lost_angles, failure_drive_jumps, &
    failure_driven_dead_point, failure_unbalanced, failure_no_equilibrium, failure_lost_inertia, failure_sharp_curve, &
    failure_interrupted_starts, failure_off_curve, failure_no_fixed_axis, failure_open_coupling, failure_coupled, &
    failure_off_table, failure_no_neighbours, failure_unknown_derivative, failure_singular_sensitivity, &
    failure_opening_parameter, failure_jump_sensitivity, failure_angles_sensitivity, failure_shared_force, &
    failure_jumping_force, failure_lost_link, last_failure

  ! The assembled position and the choice of the independent coordinates

  !> The independent coordinates do not fit the mobility: number, coordinates (the independent ones), others (a choice that
  !> serves), idle (those that cannot move), replaces; chains and lines (couplings, and closed chains, that hold coordinates
  !> between them).
  integer, parameter :: failure_wrong_choice = 1
  !> The independent coordinates do not determine the others: coordinates (which would have to be independent as well).
  integer, parameter :: failure_undetermined_coordinates = 2
  !> A closed chain stays open: chains, link and coordinates of its closing, gap, size.
  integer, parameter :: failure_open_chain = 3
  !> The same, by so little that the digits of the data may be the cause.
  integer, parameter :: failure_nearly_closed_chain = 4
  !> A chain has redundant equations at the start only: chains, number (of them), displacement, gap, size.
  integer, parameter :: failure_locked_chain = 5
  !> The same, of dimensions that are near those of a chain that moves: distance as well.
  integer, parameter :: failure_nearly_moving_chain = 6
  !> A block is too large: number (of its unknowns), limit.
  integer, parameter :: failure_large_block = 7
  !> The chains of a block do not determine its unknowns: chains.
  integer, parameter :: failure_undetermined_block = 8
  !> The chains of a block do not stay closed at all rates of the independent coordinates: chains.
  integer, parameter :: failure_contradictory_inputs = 9

  ! Driven motions

  !> A start at a dead point: chains and coordinates of the block; the same for the following three.
  integer, parameter :: failure_start_at_dead_point = 10
  !> A start where two branches meet: values (unknown, branch), the rates by which it can go on, and angle_unit.
  integer, parameter :: failure_start_on_branches = 11
  integer, parameter :: failure_start_unclear = 12
  integer, parameter :: failure_start_locked = 13
  !> No position beside a singular start was found for certain.
  integer, parameter :: failure_start_not_left = 14
  !> A motion ends because a coordinate grows without bound: chains and coordinates of the block, number (of closures), t,
  !> others and values (the independent coordinates there), growing. The same for the following two.
  integer, parameter :: failure_escape = 15
  integer, parameter :: failure_dead_point = 16
  integer, parameter :: failure_lost_branch = 17

  ! Equations of motion and their integration

  !> A block is singular for the independent coordinates: chains, coordinates; at the start, the remedy is another one.
  integer, parameter :: failure_singular_block = 18
  integer, parameter :: failure_singular_start_block = 19
  !> No mass moves with an independent coordinate: coordinates.
  integer, parameter :: failure_no_inertia = 20
  integer, parameter :: failure_singular_step = 21
  !> A block cannot be closed after a step: chains, t.
  integer, parameter :: failure_unclosed_step = 22
  !> A coordinate would jump with other independent coordinates: coordinates.
  integer, parameter :: failure_other_branch = 23
  !> No method of integration has this name: name.
  integer, parameter :: failure_unknown_method = 24
  integer, parameter :: failure_no_jacobian = 25
  integer, parameter :: failure_tolerance_count = 26
  !> A relative tolerance is not between 0 and 1: tolerance.
  integer, parameter :: failure_relative_tolerance = 27
  integer, parameter :: failure_absolute_tolerance = 28
  !> An integration takes too many steps: t, t_stop, limit, step. The six kinds after it, of steps that cannot be made, name t.
  integer, parameter :: failure_many_steps = 29
  integer, parameter :: failure_inaccurate_step = 30
  integer, parameter :: failure_unsolved_step = 31
  integer, parameter :: failure_accurate_step = 32
  integer, parameter :: failure_step_memory = 33
  integer, parameter :: failure_step_settings = 34
  integer, parameter :: failure_short_step = 35
  !> A rate of change, or an entry of its Jacobian, is not finite: number (its place); of a motion, coordinates (the one that
  !> moves so).
  integer, parameter :: failure_infinite_rate = 36
  integer, parameter :: failure_infinite_jacobian = 37

  ! Splines

  !> Too few points for a spline: number (of them).
  integer, parameter :: failure_few_points = 38
  !> A point does not lie behind the one before it: number (of the one before).
  integer, parameter :: failure_points_order = 39
  integer, parameter :: failure_no_spline = 40

  ! Reasons why a mechanism is not planar

  !> The motions of a chain have not three dimensions: chains, number (of dimensions).
  integer, parameter :: failure_chain_dimensions = 41
  integer, parameter :: failure_nothing_turns = 42
  !> A pair does not move in the plane: coordinates.
  integer, parameter :: failure_pair_off_plane = 43
  !> A chain does not close in the plane: chains.
  integer, parameter :: failure_chain_off_plane = 44

  ! Simulations

  !> The chains of a position are open by more than is allowed: t, gap, tolerance (allowed [m]), size.
  integer, parameter :: failure_open_position = 45
  !> An independent coordinate of a free motion has no initial position: coordinates.
  integer, parameter :: failure_no_initial_position = 46
  !> A motion is to advance before its start.
  integer, parameter :: failure_not_started = 47
  !> A motion is to go back: t (where it stands), t_stop (where it is to go).
  integer, parameter :: failure_backwards = 48
  !> The user interrupted a motion: t (that comes next).
  integer, parameter :: failure_interrupted = 49
  !> A motion cannot be as accurate as was asked for: t (of the first position that is not), deviation (estimated error there),
  !> tolerance (allowed error).
  integer, parameter :: failure_accuracy = 50
  !> The rates of some coordinates no longer determine a motion of the links: coordinates, t.
  integer, parameter :: failure_gimbal_lock = 51
  !> The angles of a ball joint could not be followed through gimbal lock: coordinates, t.
  integer, parameter :: failure_lost_angles = 52
  !> A drive is elsewhere than its rates lead: coordinates (the driven one), t.
  integer, parameter :: failure_drive_jumps = 53
  !> The same as failure_dead_point in a motion with free coordinates; others and values are those of driven coordinates.
  integer, parameter :: failure_driven_dead_point = 54
  !> No finite forces in the pairs balance the links in a singular position: coordinates (of the closed chains), t.
  integer, parameter :: failure_unbalanced = 55

  ! Equilibrium

  !> No position of equilibrium was found: coordinates (the free ones), values (free coordinate; the force that is left on it [N m, N],
  !> the coordinate where the search ended).
  integer, parameter :: failure_no_equilibrium = 56
  !> The user interrupted a search for equilibria: number (of random starts so far), limit (number of all).
  integer, parameter :: failure_interrupted_starts = 57

  ! Trials of an integration

  !> No mass moves with an independent coordinate that had inertia at the start: coordinates.
  integer, parameter :: failure_lost_inertia = 58

  ! Curves

  !> A curve through points turns back on itself: number (of the point before the place).
  integer, parameter :: failure_sharp_curve = 59
  !> A coordinate goes beyond an end of its curve: coordinates, values (the coordinate, the length of the curve [m]), t.
  integer, parameter :: failure_off_curve = 60
  !> Planar arithmetic does not know a pair without a fixed axis: coordinates.
  integer, parameter :: failure_no_fixed_axis = 61

  ! Couplings

  !> Couplings, or a coupling and closed chains, contradict each other in the values of their coordinates: chains, lines,
  !> coordinates, gap.
  integer, parameter :: failure_open_coupling = 62
  !> A mechanism is executed in space because coordinates are coupled.
  integer, parameter :: failure_coupled = 63
  !> A coordinate goes beyond an end of the table of a coupling: chains, coordinates, values (the coordinate, both ends of the
  !> table), name (of their unit), t.
  integer, parameter :: failure_off_table = 64

  ! Sensitivities

  !> A parameter cannot be changed in both directions: name.
  integer, parameter :: failure_no_neighbours = 65
  !> A parameter sets numbers whose derivatives are not known: name.
  integer, parameter :: failure_unknown_derivative = 66
  !> Derivatives by parameters do not exist in a singular position: chains, coordinates, t.
  integer, parameter :: failure_singular_sensitivity = 67
  !> A change of a parameter opens a closed chain: chains, coordinates, name, t.
  integer, parameter :: failure_opening_parameter = 68
  !> Rates jump at a joint of laws whose time a parameter sets: name, t.
  integer, parameter :: failure_jump_sensitivity = 69
  !> Other angles are integrated in place of those of the data file, whose derivatives are not known: t.
  integer, parameter :: failure_angles_sensitivity = 70
  !> Equilibrium does not determine the force of a coupling, whose derivatives are not known: number (of the coupling).
  integer, parameter :: failure_shared_force = 71
  !> A parameter sets numbers of a law by which a force jumps, so that derivatives jump: name.
  integer, parameter :: failure_jumping_force = 72
  !> The chains of a position are open by much against a short link, whose motion is lost in the round-off of the largest
  !> lengths: t, gap, tolerance (allowed [m]), size, link, distance (between the pairs of the link).
  integer, parameter :: failure_lost_link = 73
  integer, parameter :: last_failure = failure_lost_link

  !> A failure: its kind, and the numbers that its kind names.
  type :: failure_type
    integer :: kind = 0                         !< one of the constants above
    integer, allocatable :: chains(:)           !< closed chains, and couplings with negative numbers
    integer, allocatable :: lines(:)            !< of the data file, on which each of `chains` begins; 0: on none
    integer, allocatable :: coordinates(:)      !< coordinates that fail
    integer, allocatable :: others(:)           !< coordinates that would serve, or the independent ones
    integer, allocatable :: idle(:)             !< coordinates that cannot move
    !> (coordinate, of `others`) whether the coordinate could be chosen in place of that one.
    logical, allocatable :: replaces(:, :)
    real(wp), allocatable :: values(:, :)       !< positions or rates, in the units of the data file
    character(len=:), allocatable :: name       !< as the user wrote it
    integer :: link = 0                         !< on which a chain closes
    integer :: growing = 0                      !< coordinate that grows without bound
    integer :: number = 0                       !< of things, or the place of one in its row
    integer :: limit = 0                        !< the largest number allowed
    real(wp) :: t = 0.0_wp                      !< time [s]
    real(wp) :: t_stop = 0.0_wp                 !< time that was to be reached [s]
    real(wp) :: step = 0.0_wp                   !< length of a step [s]
    real(wp) :: gap = 0.0_wp                    !< by which a chain stays open [m]
    real(wp) :: size = 1.0_wp                   !< length of the mechanism [m]
    real(wp) :: displacement = 0.0_wp           !< at which a chain opens [rad, lengths of the mechanism]
    real(wp) :: distance = 0.0_wp               !< from dimensions that let a chain move [rad, lengths of the mechanism], or length of a link [m]
    real(wp) :: deviation = 0.0_wp              !< estimated error of a position [rad, m]
    real(wp) :: tolerance = 0.0_wp              !< as the user gave it, or an error that is allowed [m; of positions rad, m]
    real(wp) :: angle_unit = 1.0_wp             !< unit of angles in the data file [rad]
  contains
    final :: free_failure
  end type failure_type

  !> The integration that a failure of its system ended.
  type :: integration_stop_type
    real(wp) :: t = 0.0_wp                      !< end of the last accepted step [s]
    real(wp) :: t_failed = 0.0_wp               !< of the trial that failed [s]
  end type integration_stop_type

contains

  !> Do nothing: with a final procedure the compiler frees the components by one call, which keeps the code of callers small.
  elemental subroutine free_failure(self)
    type(failure_type), intent(inout) :: self   !< a value that ends
  end subroutine free_failure
end module mech9_failure
